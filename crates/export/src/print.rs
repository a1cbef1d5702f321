//! Pictures for print. In: a picture in layers. Out: an SVG or a PDF file.
//!
//! The pixels are embedded; the lines and words on top are vectors, which stay sharp in print and can be edited.

mod pdf;
mod svg;

use std::io::Cursor;

use image::{ImageFormat, RgbaImage};
use render::layers::Layers;

/// A format for print.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum PrintFormat {
    /// Scalable Vector Graphics; words are text.
    Svg,
    /// Portable Document Format, one page of the picture's size; words are outlines, so that no font is needed.
    Pdf,
}

impl PrintFormat {
    /// Returns the format for a file's extension.
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "svg" => Some(Self::Svg),
            "pdf" => Some(Self::Pdf),
            _ => None,
        }
    }

    /// Returns the bytes of a file.
    ///
    /// # Errors
    /// The error sentence of the pixels' encoder.
    pub fn bytes(self, layers: &Layers, title: &str) -> Result<Vec<u8>, String> {
        match self {
            Self::Svg => Ok(svg::text(layers, title)?.into_bytes()),
            Self::Pdf => Ok(pdf::bytes(layers, title)),
        }
    }
}

fn png(image: &RgbaImage) -> Result<Vec<u8>, String> {
    let mut bytes = Cursor::new(Vec::new());
    let written = image.write_to(&mut bytes, ImageFormat::Png);
    written.map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}
