//! Geodesics of a parametrised surface: the first fundamental form, the exponential map, transport.
//!
//! ```text
//! expr::Tape ──surface.rs──▶ jets ──metric.rs──▶ acceleration ──integrate──▶ trace.rs: an end and a status
//!                                                                      └──▶ map.rs: a picture's pixels
//! ```
//!
//! No GPU, no syntax. Lengths are in the surface's own units, angles in radians, `u`, `v` in the chart's units.

pub mod frame;
pub mod map;
pub mod surface;
pub mod trace;
