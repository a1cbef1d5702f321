//! A picture for print in layers: pixels below; above them lines and words as vectors, which stay sharp at any size.
//!
//! Lengths are in pixels of the picture, x to the right and y down from its upper left corner.

use image::RgbaImage;

use crate::rendered::RenderedImage;

pub use crate::overlay::{Contour, PlacedWords, outlines};

/// A picture in layers.
#[derive(Clone, Debug)]
pub struct Layers {
    /// Everything that is not a vector.
    pub below: RenderedImage<RgbaImage>,
    /// The lines above it, in drawing order, without hidden parts unless
    /// [`Overlays::hidden_lines`](crate::request::Overlays::hidden_lines) requests them.
    pub strokes: Vec<Stroke>,
    /// The words above the lines.
    pub words: Vec<PlacedWords>,
}

/// A line of one width and colour, with round joins and ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// The points that it joins, at least two; those of a dot are equal.
    pub points: Vec<[f32; 2]>,
    /// Its width.
    pub width: f32,
    /// Its colour, sRGB.
    pub colour: [u8; 3],
    /// True if something hides it: then it is dashed.
    pub is_hidden: bool,
    /// Greater if it is nearer; of two lines, the nearer one is drawn above the other.
    pub(crate) nearness: f32,
}

/// The length of a dash of a hidden line, and of the gap behind it, in widths of the line.
const DASH: [f32; 2] = [3.0, 2.0];

impl Stroke {
    /// Returns the length of its dashes and of the gaps between them; dashes have straight ends. `None` if it is not dashed.
    pub fn dashes(&self) -> Option<[f32; 2]> {
        self.is_hidden.then(|| DASH.map(|part| part * self.width))
    }
}

impl Layers {
    /// Returns a picture without vectors.
    pub(crate) fn flat(below: RenderedImage<RgbaImage>) -> Self {
        Self {
            below,
            strokes: Vec::new(),
            words: Vec::new(),
        }
    }
}
