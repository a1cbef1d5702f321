//! What a window draws with: views of a scene again and again, while the scene is edited, its params move and its
//! cameras walk.
//!
//! A [`Stage`] keeps from one picture to the next what both need: samples, pipelines, textures, geodesics. What is kept
//! is known by its content, so that an edit of one object leaves those of all others alone. A stage belongs to one
//! thread at a time; it never draws a picture by itself.

use std::sync::Arc;
use std::time::{Duration, Instant};

use geodesic::ends::{Estimate, Work};
use image::RgbaImage;
use scene::scene::{ObjectId, Scene};
use scene::values::Settings;

use crate::request::{Backend, RenderError, Request};

/// Draws the views of one window.
#[derive(Debug, Default)]
pub struct Stage {
    counters: Counters,
}

/// A picture of a view.
#[derive(Debug)]
pub struct Shot {
    /// The picture.
    pub pixels: Pixels,
    /// What a reader of the picture should know, as in [`crate::Picture`].
    pub notes: Vec<String>,
    /// What has been drawn over it, as in [`crate::Picture`].
    pub overlays: Vec<&'static str>,
    /// Of a geodesic view: what following its geodesics has cost, and how far off they are at most, in pixels.
    pub inside: Option<(Work, Option<Estimate>)>,
    /// From the request to the picture (on a GPU: until it was handed over).
    pub took: Duration,
}

/// Where a picture's pixels are.
#[derive(Debug)]
pub enum Pixels {
    /// sRGB, top row first, in memory: drawn by the software path.
    Image(RgbaImage),
}

/// What has been made so far, counted; nothing is ever taken back.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Counters {
    /// Pictures.
    pub pictures: u64,
    /// Pipelines of painters and passes, and kernels: whatever a driver compiles.
    pub pipelines: u64,
    /// Of these, kernels that follow geodesics.
    pub geodesic_kernels: u64,
    /// Objects whose samples were computed.
    pub sampled: u64,
    /// Geodesic views whose geodesics were followed.
    pub looks: u64,
}

/// What is under a pixel of the 3D view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object.
    pub object: ObjectId,
    /// The place, in the scene's units.
    pub position: [f64; 3],
    /// (u, v) of a surface, (t, 0) of a curve, zero otherwise.
    pub parameters: [f64; 2],
    /// Which of the object's instances, counted from 0.
    pub instance: u64,
}

impl Stage {
    /// A stage that draws by the software path.
    pub fn software() -> Self {
        Self::default()
    }

    /// Draws a view. The request's backend is not heeded: a stage has its own.
    ///
    /// # Errors
    /// As [`crate::render`].
    pub fn draw(
        &mut self,
        scene: &Arc<Scene>,
        settings: &Settings,
        request: &Request,
    ) -> Result<Shot, RenderError> {
        let start = Instant::now();
        let request = Request {
            backend: Backend::Software,
            ..request.clone()
        };
        let picture = crate::render(scene, settings, &request, &|_| {})?;
        self.counters.pictures += 1;
        Ok(Shot {
            pixels: Pixels::Image(picture.image),
            notes: picture.notes,
            overlays: picture.overlays,
            inside: None,
            took: start.elapsed(),
        })
    }

    /// What is drawn nearest to the eye within a few pixels of the place (x, y) of the 3D view that a request describes,
    /// in pixels from its top left corner.
    ///
    /// # Errors
    /// As [`Stage::draw`].
    pub fn pick(
        &mut self,
        _scene: &Arc<Scene>,
        _settings: &Settings,
        _request: &Request,
        _at: [f64; 2],
    ) -> Result<Option<Hit>, RenderError> {
        Ok(None)
    }

    /// What has been made so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }
}
