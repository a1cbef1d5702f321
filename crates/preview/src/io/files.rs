//! Pictures that are written.

use std::path::Path;

use export::whole_file::write_whole;
use image::RgbaImage;
use render::{Backend, PictureRequest, Views};

/// Draws a picture and writes it as PNG.
///
/// # Errors
/// A sentence; nothing is written.
pub(crate) fn save_picture(
    path: &Path,
    views: &Views,
    request: &PictureRequest,
) -> Result<String, String> {
    let picture = render::render(views, request, Backend::Auto, &|_| {});
    let image = picture.map_err(|error| error.to_string())?.image;
    let bytes = png(&image)?;
    write_whole(path, &bytes)
        .map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
    let [width, height] = request.size;
    Ok(format!(
        "{width}×{height} pixels are in `{}`",
        path.display()
    ))
}

/// An image as a PNG file.
///
/// # Errors
/// A sentence.
pub(crate) fn png(image: &RgbaImage) -> Result<Vec<u8>, String> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, image::ImageFormat::Png)
        .map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}
