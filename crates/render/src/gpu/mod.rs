//! The GPU path.

use scene::{scene::Scene, values::Settings};

use crate::request::{Picture, RenderError, Request};

/// Draws a picture on a GPU; the request has been checked.
///
/// # Errors
/// [`RenderError::NoGpu`], [`RenderError::Gpu`], [`RenderError::Internal`] and those of the camera.
pub fn render(
    scene: &Scene,
    settings: &Settings,
    request: &Request,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Picture, RenderError> {
    let _ = (scene, settings, request, progress);
    Err(RenderError::NoGpu {
        reason: "the GPU path is not there yet".to_owned(),
    })
}
