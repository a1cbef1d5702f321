//! The software path: both views on the CPU, on all cores, for machines without a GPU. It never touches wgpu.
//!
//! ```text
//! samples ──points, vectors, curves, surfaces──▶ mesh.rs: triangles in clip space ──clipped, projected──▶
//! raster.rs: tiles with four samples a pixel ──shade.rs──▶ picture
//! ```
//!
//! The same picture comes out on every run and for every number of cores: triangles keep their order, and each tile
//! is one task.

mod curves;
mod inside;
mod mesh;
mod pick;
mod points;
mod raster;
mod shade;
mod space;
mod surfaces;
mod vectors;

pub(crate) use inside::paint;
pub use pick::{NEAR, Picked, pick};
pub use space::{Painted, draw};

use scene::{ParamValues, Scene};

use crate::request::{Picture, RenderError, Request, View};

/// Draws a picture; the request has been checked.
///
/// # Errors
/// [`RenderError::Camera`], [`RenderError::UndefinedCamera`], [`RenderError::CameraOutside`].
pub fn render(
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Picture, RenderError> {
    match request.view {
        View::Space { eye, target } => {
            space::render(scene, settings, request, eye, target, progress)
        }
        View::Geodesic { .. } => inside::render(scene, settings, request, progress),
    }
}
