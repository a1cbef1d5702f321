//! A picture for print in layers: pixels below, lines and words as vectors above them, which stay sharp at any size.
//!
//! Lengths are in pixels of the picture, x to the right and y down from its upper left corner.

use image::RgbaImage;

use crate::rendered::RenderedImage;

pub use crate::overlay::{Contour, PlacedWords, outlines};

/// A picture in layers.
#[derive(Clone, Debug)]
pub struct Layers {
    /// All that is no vector.
    pub below: RenderedImage<RgbaImage>,
    /// The lines above it, in the order in which they are drawn; the hidden parts are left out, unless
    /// [`Overlays::hidden_lines`](crate::request::Overlays::hidden_lines) asks for them.
    pub strokes: Vec<Stroke>,
    /// The words above the lines.
    pub words: Vec<PlacedWords>,
}

/// A line of one width and colour, with round joins and ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// The places that it joins, at least two; of a dot they are equal.
    pub points: Vec<[f32; 2]>,
    /// Its width.
    pub width: f32,
    /// Its colour, sRGB.
    pub colour: [u8; 3],
    /// Set if something hides it: then it is dashed.
    pub is_hidden: bool,
    /// Greater where it is nearer; of two lines, the nearer one lies above the other.
    pub(crate) nearness: f32,
}

/// The length of a dash of a line that is hidden, and of the gap behind it, in its widths.
const DASH: [f32; 2] = [3.0, 2.0];

impl Stroke {
    /// The length of its dashes and of the gaps between them, whose ends are straight; `None` if it is not dashed.
    pub fn dashes(&self) -> Option<[f32; 2]> {
        self.is_hidden.then(|| DASH.map(|part| part * self.width))
    }
}

impl Layers {
    /// A picture without vectors.
    pub(crate) fn flat(below: RenderedImage<RgbaImage>) -> Self {
        Self {
            below,
            strokes: Vec::new(),
            words: Vec::new(),
        }
    }
}
