//! The result of rendering: a picture with its notes and costs.

use std::fmt;
use std::time::Duration;

use geodesic::ends::{Estimate, GeodesicWork};

use crate::gpu::Pixels;
use crate::note::Note;

/// The backend that drew a picture.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum BackendUsed {
    /// A GPU, by its name.
    Gpu(String),
    /// The software path.
    Software {
        /// The reason for this backend, as it follows a comma: "because this machine has no GPU".
        reason: Option<String>,
    },
}

impl BackendUsed {
    /// The software path, without a reason that the reader needs to know.
    pub const SOFTWARE: Self = Self::Software { reason: None };
}

impl fmt::Display for BackendUsed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gpu(name) => write!(f, "GPU: {name}"),
            Self::Software { reason: None } => f.write_str("software"),
            Self::Software {
                reason: Some(reason),
            } => write!(f, "software, {reason}"),
        }
    }
}

/// A picture that has been drawn. `P` stores the pixels: an `RgbaImage` in memory, or the storage of a renderer
/// ([`Pixels`]).
#[derive(Clone, Debug)]
pub struct RenderedImage<P = Pixels> {
    /// The pixels: sRGB, top row first; opaque except for a background with an alpha. In memory, alpha is straight.
    pub image: P,
    /// The backend that drew it; for a picture in a file, with the reason.
    pub backend: BackendUsed,
    /// The notes for the reader of the picture.
    pub notes: Vec<Note>,
    /// The names of its overlays: empty unless the request has overlays, or the scene declares geodesics on the surface that
    /// is seen from inside.
    pub overlays: Vec<&'static str>,
    /// The work for a geodesic view, and the largest estimated error of its geodesics, in pixels.
    pub geodesics: Option<(GeodesicWork, Option<Estimate>)>,
    /// For a 3D picture or a traced one, the rectangle of its legend, if it has one: left, top, right and bottom in pixels.
    pub legend: Option<[f32; 4]>,
    /// For a traced picture, the number of samples of each pixel, and of those that are new.
    pub samples: Option<[u32; 2]>,
    /// The time from the request to the picture (on a GPU: until it was submitted).
    pub took: Duration,
}

impl<P> RenderedImage<P> {
    /// Creates a picture of the software path without notes.
    pub fn new(image: P) -> Self {
        Self {
            image,
            backend: BackendUsed::SOFTWARE,
            notes: Vec::new(),
            overlays: Vec::new(),
            geodesics: None,
            legend: None,
            samples: None,
            took: Duration::ZERO,
        }
    }

    /// Returns the notes on the content of the picture, without those on its cost and accuracy.
    pub fn remarks(&self) -> impl Iterator<Item = &str> {
        self.notes.iter().filter_map(|note| match note {
            Note::Remark(text) => Some(&**text),
            Note::Cost(_) => None,
        })
    }

    /// Returns the picture with other storage for its pixels.
    pub fn with_pixels<Q>(self, image: Q) -> RenderedImage<Q> {
        RenderedImage {
            image,
            backend: self.backend,
            notes: self.notes,
            overlays: self.overlays,
            geodesics: self.geodesics,
            legend: self.legend,
            samples: self.samples,
            took: self.took,
        }
    }
}
