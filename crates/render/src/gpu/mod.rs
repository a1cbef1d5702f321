//! The GPU path: wgpu painters and generated kernels.
//!
//! ```text
//! plan ──samples.rs──▶ sample buffers (f64 blocks or a kernel) ──one painter a file──▶ space.rs: tiles ──▶ picture
//! ends of geodesics (f64) ──geodesic.rs: table of polynomials, resolve pass──▶ picture
//! ```
//!
//! What is built is counted ([`Built`]) and equals [`crate::plan::Plan::built`]. wgpu is used nowhere else.

mod blit;
mod canvas;
mod curves;
mod device;
mod evaluate;
mod geodesic;
mod glyphs;
mod inside;
mod kernels;
mod layout;
mod points;
mod samples;
mod space;
pub(crate) mod studio;
mod surfaces;
mod vectors;
mod workshop;

use scene::ParamValues;
use scene::{ObjectId, Scene};
use wgsl::GenerateError;

pub use blit::{Blit, Blitter};
pub use canvas::Canvas;
pub use device::Gpu;
pub use evaluate::{EvaluateError, evaluate};
// What a window opens its device with, so that there is one version of it.
pub use wgpu;

use crate::bounds::Placement;
use crate::gpu::workshop::Workshop;
use crate::plan::{Built, plan};
use crate::request::{Picture, RenderError, Request, View};
use crate::sample::Samples;

/// Draws a picture on a GPU; the request has been checked.
///
/// # Errors
/// [`RenderError::NoGpu`], [`RenderError::Gpu`], [`RenderError::Internal`] and those of the camera.
pub fn render(
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Picture, RenderError> {
    render_counted(scene, settings, request, progress).map(|(picture, _)| picture)
}

/// As [`render`], with what was built for it.
///
/// # Errors
/// As [`render`].
pub fn render_counted(
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<(Picture, Built), RenderError> {
    let gpu = device::open()?;
    let plan = plan(scene, settings, request);
    gpu.guarded(|| {
        let mut workshop = Workshop::new(gpu);
        let drawn = match &request.view {
            View::Space { eye, target } => space::render(
                &mut workshop,
                scene,
                settings,
                request,
                &plan,
                [*eye, *target],
                progress,
            )?,
            View::Geodesic { .. } => {
                geodesic::render(&mut workshop, scene, settings, request, &plan, progress)?
            }
        };
        let backend = format!("GPU: {}", gpu.name);
        Ok((
            Picture {
                image: drawn.image,
                backend,
                notes: drawn.notes,
                overlays: drawn.overlays,
            },
            workshop.built,
        ))
    })
}

/// A picture with what belongs to it.
struct Drawn {
    image: image::RgbaImage,
    notes: Vec<String>,
    overlays: Vec<&'static str>,
}

/// The samples of an object as its generated kernel computes them: for comparing them with [`crate::sample::sample`].
/// `None` if its expressions are too large for a shader.
///
/// # Errors
/// As [`render`].
pub fn kernel_samples(
    scene: &Scene,
    settings: &ParamValues,
    object: ObjectId,
    placement: &Placement,
) -> Result<Option<Samples>, RenderError> {
    let gpu = device::open()?;
    gpu.guarded(|| samples::computed(&mut Workshop::new(gpu), scene, settings, object, placement))
}

/// The name of the GPU that pictures are drawn on.
///
/// # Errors
/// [`RenderError::NoGpu`].
pub fn adapter_name() -> Result<&'static str, RenderError> {
    device::open().map(|gpu| gpu.name.as_str())
}

/// A fault in generated text as an error of rendering; `None` if the expression is only too large for a shader.
fn internal(error: GenerateError) -> Option<RenderError> {
    match error {
        GenerateError::TooLarge { .. } => None,
        GenerateError::Internal(error) => Some(error.into()),
    }
}

impl From<wgsl::InternalError> for RenderError {
    fn from(error: wgsl::InternalError) -> Self {
        Self::Internal {
            message: error.message,
            source: error.source,
        }
    }
}
