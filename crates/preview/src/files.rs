//! Pictures that are written, each on a thread of its own.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::RgbaImage;
use render::Request;
use scene::scene::Scene;
use scene::values::Settings;

use crate::atomic::write_whole;
use crate::mail::{Letter, Mail};

/// Writes a file, on a thread, by `write`, which gives the sentence to be told.
pub(crate) fn write_to(
    mail: Mail,
    path: PathBuf,
    write: impl FnOnce(&Path) -> Result<String, String> + Send + 'static,
) {
    std::thread::spawn(move || tell(&mail, write(&path)));
}

fn tell(mail: &Mail, result: Result<String, String>) {
    let (error, text) = match result {
        Ok(text) => (false, text),
        Err(text) => (true, text),
    };
    mail.send(Letter::Say { error, text });
}

/// Draws a picture and writes it as PNG.
///
/// # Errors
/// A sentence; nothing is written.
pub(crate) fn save_picture(
    path: &Path,
    scene: &Arc<Scene>,
    settings: &Arc<Settings>,
    request: &Request,
) -> Result<String, String> {
    let picture = render::render(scene, settings, request, &|_| {});
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
