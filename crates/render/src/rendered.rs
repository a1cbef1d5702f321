//! The result of rendering: a picture with all that belongs to it.

use std::time::Duration;

use geodesic::ends::{Estimate, GeodesicWork};

use crate::gpu::Pixels;

/// The name of the software path, as a backend.
pub(crate) const SOFTWARE: &str = "software";

/// A picture that has been drawn. `P` is where its pixels are: an `RgbaImage` in memory, or wherever a renderer has left
/// them ([`Pixels`]).
#[derive(Clone, Debug)]
pub struct RenderedImage<P = Pixels> {
    /// The pixels: sRGB, top row first; opaque but for a background with an alpha. In memory, alpha is not multiplied
    /// into the colours.
    pub image: P,
    /// The backend that drew it, in words; for a picture in a file also why it was this one. A view may leave it empty:
    /// then it is the renderer's.
    pub backend: String,
    /// Notes for a reader of the picture: sentences such as "`p` is undefined at the current params and is not drawn".
    pub notes: Vec<String>,
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
    /// A picture of which there is nothing to be said.
    pub fn new(image: P) -> Self {
        Self {
            image,
            backend: String::new(),
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
        let is_figure = |note: &str| {
            note.contains("evaluations of the surface") || note.starts_with("the error ")
        };
        let notes = self.notes.iter().map(String::as_str);
        notes.filter(move |note| !is_figure(note))
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
