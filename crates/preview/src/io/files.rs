//! Files that are read up to a limit, and pictures that are written.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use export::print::PrintFormat;
use export::whole_file::write_whole;
use image::RgbaImage;
use render::{Backend, PictureRequest, Views};

/// Reads a regular file of at most so many bytes: a device or a pipe might never end.
///
/// # Errors
/// The system's, and sentences for another kind of file and a longer one.
pub(crate) fn read_limited(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    let mut bytes = Vec::new();
    // It may grow while it is read.
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let sentence = format!("it is longer than {} MB", most >> 20);
        return Err(io::Error::other(sentence));
    }
    Ok(bytes)
}

/// Draws a picture and writes it: as PNG, SVG or PDF, as the file is called.
///
/// # Errors
/// A sentence, also where the file is called otherwise; nothing is written.
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

#[cfg(test)]
mod tests {
    use super::read_limited;

    #[test]
    fn only_regular_files_of_some_length_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        std::fs::write(&path, [7; 10]).expect("written");
        assert_eq!(read_limited(&path, 10).expect("ten bytes"), [7; 10]);
        let error = read_limited(&path, 9).expect_err("too long");
        assert!(
            error.to_string().starts_with("it is longer than"),
            "{error}"
        );
        assert!(read_limited(folder.path(), 10).is_err());
        #[cfg(unix)]
        assert!(read_limited("/dev/zero".as_ref(), 10).is_err());
    }
}
