//! The step from a scene's objects to manifolds for geodesics, and to solids and surfaces for rays.
//!
//! ```text
//! Scene + ObjectId + uniforms ──manifold.rs──▶ Manifold: a surface or a metric with its numbers in place
//! curve or surface + uniforms ──breaks.rs──▶ Breaks: the samples between which it is interrupted, at poles and jumps
//! Scene + ParamValues ──declared.rs──▶ the declared geodesics, as knots
//! Manifold + GeodesicSegment ──polyline_cache.rs──▶ points of the chart, cached between pictures
//! Scene + ParamValues + ObjectId ──solid_surface.rs──▶ SolidSurface: a solid for geodesics in space
//! Scene + ParamValues ──solids.rs──▶ RayScene: solids, surfaces, looks, lights and cameras for rays
//! ```
//!
//! This crate is independent of pictures, of text, and of its callers.

mod breaks;
mod declared;
mod manifold;
mod polyline;
mod polyline_cache;
mod solid_surface;
pub mod solids;

pub use breaks::{Break, Breaks, Interruptions, MOST_BREAK_CELLS, jumps_along_geodesics};
pub use declared::{
    FollowedGeodesic, MAX_DECLARED_EVALUATIONS, MAX_POINTS, cut_note, evaluations_per_line,
    follow_declared, follow_declared_over, lies_in_space,
};
pub use manifold::{Manifold, ManifoldError};
pub use polyline::{GeodesicStart, Knot, KnotLine, MAX_LINE_EVALUATIONS, knots_at};
pub use polyline_cache::{ChartPolyline, GeodesicSegment};
pub use solid_surface::SolidSurface;
