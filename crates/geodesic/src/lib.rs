//! Geodesics of a parametrised surface: the first fundamental form, the exponential map, transport.
//!
//! ```text
//! expr ──surface.rs (or intrinsic.rs)──▶ jets ──topology.rs──▶ what lies beyond the sides
//!                                         │
//!                               metric.rs, chart.rs ──▶ acceleration ──integrate──▶ one step
//!                                         │                                           │
//!  frame.rs (camera) ◀─ trace.rs: an end and a status ◀─────────── follow.rs: many steps
//!         │                                                                           │
//!         └──▶ fan.rs: shared rays ──ends.rs──▶ patchwork.rs: polynomials ──▶ map.rs: a picture's pixels
//!                                                     └──▶ a table for the GPU        │
//!                                                     reference.rs: how far they are off
//! ```
//!
//! Beside them stand `accelerations.rs`, several geodesics at once for the thesis' method, and `moved.rs`, coordinates that
//! count from the camera, for deep zooms.
//!
//! No GPU, no syntax. Lengths are in the surface's own units, angles in radians, `u`, `v` in the chart's units.

mod accelerations;
mod chart;
pub mod ends;
pub mod fan;
mod follow;
pub mod frame;
mod integrate;
pub mod intrinsic;
pub mod map;
pub mod metric;
pub mod moved;
pub mod patchwork;
pub mod reference;
pub mod surface;
pub mod topology;
pub mod trace;
