//! Writes pictures.

use std::path::Path;

use export::print::PrintFormat;
use export::whole_file::write_whole;
use image::RgbaImage;
use render::{Backend, PictureRequest, Views};

/// Draws a picture and writes it: as PNG, SVG or PDF, by the file's extension.
///
/// # Errors
/// A sentence, also for another extension; nothing is written.
pub(crate) fn save_picture(
    path: &Path,
    views: &Views,
    request: &PictureRequest,
) -> Result<String, String> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let bytes = match PrintFormat::of_extension(&extension) {
        Some(format) => {
            let layers = render::render_layers(views, request, &|_| {});
            let layers = layers.map_err(|error| error.to_string())?;
            let title = path.file_stem().unwrap_or_default().to_string_lossy();
            format.bytes(&layers, &title)?
        }
        None if extension.eq_ignore_ascii_case("png") => {
            let picture = render::render(views, request, Backend::Auto, &|_| {});
            png(&picture.map_err(|error| error.to_string())?.image)?
        }
        None => {
            let name = path.display();
            return Err(format!("`{name}` does not end in one of png, svg, pdf"));
        }
    };
    write_whole(path, &bytes)
        .map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
    let [width, height] = request.size;
    Ok(format!(
        "{width}×{height} pixels were saved in `{}`",
        path.display()
    ))
}

/// Encodes an image as a PNG file.
///
/// # Errors
/// A sentence.
fn png(image: &RgbaImage) -> Result<Vec<u8>, String> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, image::ImageFormat::Png)
        .map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}
