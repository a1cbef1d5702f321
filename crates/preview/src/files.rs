//! Files that the user chooses in the desktop's dialogs, and pictures that are written: each on a thread of its own.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::RgbaImage;
use render::Request;
use scene::scene::Scene;
use scene::values::Settings;

use crate::mail::{Letter, Mail};
use crate::memory::write_whole;

/// Lets the user choose image files.
pub(crate) fn choose_images(mail: Mail, folder: Option<PathBuf>) {
    std::thread::spawn(move || {
        let mut dialog = rfd::FileDialog::new()
            .set_title("Open textures")
            .add_filter("Images", &["png", "jpg", "jpeg"]);
        if let Some(folder) = folder {
            dialog = dialog.set_directory(folder);
        }
        if let Some(paths) = dialog.pick_files() {
            mail.send(Letter::Images(paths));
        }
    });
}

/// Lets the user choose where a file is written, then has it written by `write`, which gives the sentence to be told.
pub(crate) fn choose_target(
    mail: Mail,
    title: &'static str,
    proposed: PathBuf,
    write: impl FnOnce(&Path) -> Result<String, String> + Send + 'static,
) {
    std::thread::spawn(move || match ask_target(title, &proposed) {
        Ok(Some(path)) => tell(&mail, write(&path)),
        Ok(None) => {}
        Err(sentence) => tell(&mail, Err(sentence)),
    });
}

/// Lets the user choose where a file is written, and waits; nothing if that was called off.
///
/// # Errors
/// A sentence where no dialog can be opened.
pub(crate) fn ask_target(title: &str, proposed: &Path) -> Result<Option<PathBuf>, String> {
    let name = proposed.file_name().unwrap_or_default().to_string_lossy();
    let mut dialog = rfd::FileDialog::new().set_title(title).set_file_name(name);
    if let Some(folder) = proposed.parent() {
        dialog = dialog.set_directory(folder);
    }
    Ok(dialog.save_file())
}

/// Writes to a place that is known, on a thread.
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
