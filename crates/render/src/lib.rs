//! Both views of a scene as pictures, offscreen: wgpu painters, and a software path for machines without a GPU.
//!
//! ```text
//! Scene + Settings ──sample.rs (f64 blocks) or a generated kernel──▶ samples ──gpu/ or software/──▶ 3D picture
//! surface + Frame ──geodesic kernel (gpu/) or geodesic::map──▶ Map ──resolve: texture──▶ geodesic picture
//! ```
