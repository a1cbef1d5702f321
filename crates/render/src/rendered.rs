//! The result of rendering: a picture with all that belongs to it.

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
        /// The reason for which it was this one, as it stands behind a comma: "because this machine has no GPU".
        reason: Option<String>,
    },
}

impl BackendUsed {
    /// The software path, for no reason that a reader need know.
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

/// A picture that has been drawn. `P` is where its pixels are: an `RgbaImage` in memory, or wherever a renderer has left
/// them ([`Pixels`]).
#[derive(Clone, Debug)]
pub struct RenderedImage<P = Pixels> {
    /// The pixels: sRGB, top row first; opaque but for a background with an alpha. In memory, alpha is not multiplied
    /// into the colours.
    pub image: P,
    /// The backend that drew it; for a picture in a file also why it was this one.
    pub backend: BackendUsed,
    /// The notes for a reader of the picture.
    pub notes: Vec<Note>,
    /// The names of what has been drawn over it: nothing unless the request has overlays, or the scene declares
    /// geodesics on the surface that is seen from inside.
    pub overlays: Vec<&'static str>,
    /// The work that a geodesic view took, and the greatest estimated error of its geodesics, in pixels.
    pub geodesics: Option<(GeodesicWork, Option<Estimate>)>,
    /// Of a 3D picture or a traced one: the place of its legend, left, top, right and bottom in pixels, if it has one.
    pub legend: Option<[f32; 4]>,
    /// Of a traced picture: the samples of each pixel, and those of them that are new.
    pub samples: Option<[u32; 2]>,
    /// The time from the request to the picture (on a GPU: until it was handed over).
    pub took: Duration,
}

impl<P> RenderedImage<P> {
    /// A picture of the software path of which there is nothing to be said.
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

    /// Returns the notes about what is seen: without those that say what the picture took and how exact it is.
    pub fn remarks(&self) -> impl Iterator<Item = &str> {
        self.notes.iter().filter_map(|note| match note {
            Note::Remark(text) => Some(&**text),
            Note::Cost(_) => None,
        })
    }

    /// Returns the picture with its pixels elsewhere.
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
