//! Geodesics of a parametrised surface: the first fundamental form, the exponential map, transport.
//!
//! ```text
//! expr ──surface.rs (or intrinsic.rs)──▶ jets ──topology.rs──▶ the kinds of the sides
//!                                         │
//!                               metric.rs, chart.rs ──▶ acceleration ──runge_kutta──▶ one step
//!                                         │                                           │
//!  frame.rs (camera) ◀─ trace.rs: an end and a status ◀─────────── integrate.rs: many steps
//!         │                                                                           │
//!         └──▶ fan.rs: shared rays ──ends.rs──▶ piecewise.rs: polynomials ──▶ map.rs: a picture's pixels
//!                                                     └──▶ a table for the GPU        │
//!                                                     reference.rs: the true errors of the pixels
//! ```
//!
//! Measures along geodesics (distances, circles, triangles, holonomy) are in `measure.rs`, which builds on all of
//! these.
//!
//! Surfaces that are given by a field in space and have no chart have their own rays in `implicit.rs`, which use the same
//! steps and yield ends with three coordinates.
//!
//! Two modules wrap a surface in other coordinates: `moved.rs`, relative to the camera, for deep zooms, and
//! `reparametrised.rs`, for seams that a parameter crosses unevenly.
//!
//! No GPU, no syntax. Lengths are in the surface's own units, angles in radians, `u`, `v` in the chart's units.

mod chart;
mod chebyshev;
mod conjugate_search;
pub mod ends;
pub mod fan;
pub mod frame;
pub mod implicit;
mod integrate;
mod interpolate;
pub mod intrinsic;
pub mod jacobi;
pub mod jet;
pub mod map;
pub mod measure;
pub mod metric;
pub mod moved;
pub mod piecewise;
pub mod pixels;
pub mod point;
pub mod reference;
pub mod reparametrised;
mod runge_kutta;
pub mod scale;
pub mod sides;
mod smooth_pieces;
pub mod status;
mod step_control;
pub mod step_path;
pub mod surface;
pub mod topology;
pub mod trace;
pub mod vector;
