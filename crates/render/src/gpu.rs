//! The GPU path: wgpu painters and generated kernels. wgpu is not used anywhere else.
//!
//! ```text
//! samples.rs: buffers (f64 blocks or a kernel) ──one painter a file──▶ space.rs ──▶ canvas, or tiles in memory
//! traced scene, lens ──trace.rs: tables, one pass──▶ sums of light in memory, samples that are left to f64
//! ends of geodesics (f64) ──geodesic.rs: table of polynomials, resolve pass──▶ canvas, or slabs in memory
//! ```
//!
//! Every resource that is built is counted ([`Built`](crate::plan::Built)), and the counts equal
//! [`crate::plan::Plan::built`].

mod background;
mod blit;
mod canvas;
mod curves;
mod device;
mod evaluate;
pub(crate) mod geodesic;
mod glyphs;
mod kernels;
mod layout;
mod pipelines;
mod platform;
mod points;
pub(crate) mod renderer;
mod samples;
mod solids;
mod space;
mod surfaces;
pub(crate) mod trace;
mod vectors;

use scene::ParamValues;
use scene::{ObjectId, Scene};
use wgsl::GenerateError;

pub use blit::{Blit, Blitter};
pub use canvas::{Canvas, Pixels};
pub use device::Gpu;
pub use evaluate::{EvaluateError, evaluate};
// Re-exports for a window that shares its device.
pub use wgpu::{Backend as GraphicsApi, DeviceType, PollType, RenderPass};

use crate::error::RenderError;
use crate::gpu::pipelines::PipelineFactory;
use crate::placement::Placement;
use crate::sample::Samples;

/// Computes the samples of an object by its generated kernel: for tests, which compare them with those of
/// [`crate::sample::sample`]. Returns `None` if its expressions are too large for a shader.
///
/// # Errors
/// [`RenderError::NoGpu`], [`RenderError::Gpu`], [`RenderError::Internal`].
pub fn kernel_samples(
    scene: &Scene,
    params: &ParamValues,
    object: ObjectId,
    placement: &Placement,
) -> Result<Option<Samples>, RenderError> {
    let gpu = device::open()?;
    gpu.guarded(|| {
        let mut factory = PipelineFactory::new(gpu);
        samples::computed(&mut factory, scene, params, object, placement)
    })
}

/// Converts a fault in generated text to an error of rendering; `None` if the expression is only too large for a shader.
fn internal(error: GenerateError) -> Option<RenderError> {
    match error {
        GenerateError::TooLarge { .. } => None,
        GenerateError::Internal(error) => Some(error.into()),
    }
}
