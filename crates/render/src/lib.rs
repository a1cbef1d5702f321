//! Views of a scene as pictures, in memory or on a window's GPU: wgpu painters, and a software path for machines without a
//! GPU.
//!
//! ```text
//! PictureRequest ──renderer──▶ view/space.rs     samples ──gpu/ or software/──▶ RenderedImage
//!                          └─▶ view/geodesic.rs  ends of geodesics ──resolve──▶ RenderedImage
//! ```
//!
//! A picture is planned before anything is built for it ([`plan`](mod@plan)). Both backends use the same samples, the same
//! camera ([`camera`]) and the same constants ([`style`]). All filtering, shading and averaging is done in linear light;
//! textures and pictures store sRGB.

pub mod bounds;
mod cache;
pub mod camera;
mod closed;
mod content;
pub mod counters;
mod declared_camera;
pub mod error;
pub mod figure;
mod framing;
pub mod geodesic_view;
pub mod gpu;
pub mod layers;
pub mod measured;
mod note;
mod occlusion;
mod overlay;
pub mod placement;
pub mod plan;
pub mod point;
pub mod rendered;
pub mod renderer;
pub mod request;
pub mod sample;
mod sample_store;
pub mod shared;
pub mod software;
mod solids;
mod stated_colours;
pub mod style;
pub mod texture;
mod tips;
pub mod trail;
pub mod view;
pub mod viewpoint;

pub use error::{MAX_SIDE, RenderError};
pub use geodesic_view::PictureMethod;
pub use note::Note;
pub use rendered::{BackendUsed, RenderedImage};
pub use renderer::{Renderer, render, render_layers, render_until};
pub use request::{Backend, PictureRequest};
pub use solids::{
    MOST_OPERATIONS, MOST_SPACE_PIXEL_OPERATIONS, MOST_TRACED_PIXEL_OPERATIONS,
    most_traced_operations,
};
pub use view::{ViewId, Views};
