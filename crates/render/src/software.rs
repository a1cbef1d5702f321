//! The software path: the 3D view on the CPU, on all cores, for machines without a GPU. It never uses wgpu.
//!
//! ```text
//! samples ──points, vectors, curves, surfaces──▶ mesh.rs: triangles in clip space ──clipped, projected──▶
//! raster.rs: tiles with four samples a pixel ──shade.rs──▶ picture
//! ```
//!
//! The picture is the same on every run and for every number of cores: triangles keep their order, and each tile is one
//! task.

mod curves;
mod mesh;
mod pick;
mod points;
mod raster;
mod shade;
mod space;
mod strokes;
mod surfaces;
mod thinning;
mod vectors;

pub use pick::{NEAR, Picked, pick};
pub use space::{Drawable, draw};
pub(crate) use space::{draw_beside, draw_with_depths};
pub(crate) use strokes::{LineCover, strokes};
pub(crate) use thinning::moving_stride;
