//! Measures on a surface: curvatures at a point, circles, geodesics between two points, triangles, walks.
//!
//! ```text
//! surface, (u, v) ──place.rs──▶ E, F, G, K, H
//! surface, (u, v) ──source.rs──▶ rays by their angle ──circle.rs (quadrature.rs)──▶ circumference and area
//! fan of a source, target ──search.rs──▶ candidates ──shoot.rs (gap.rs)──▶ connections ──between.rs──▶ the shortest ones
//! connections of three corners ──triangle.rs──▶ sides, angles, area, ∫K
//! curve, frames ──walk.rs──▶ length and holonomy
//! ```
//!
//! Where a parameter crosses a seam unevenly, connections and triangles are found in even parameters
//! (`reparametrised.rs`), and on surfaces of extreme sizes in other units (`rescaled.rs`).
//!
//! The fan only finds candidates; every length and angle returned is that of a ray integrated on its own. All work is
//! limited, and results report whether something may be missing.

mod between;
mod circle;
mod gap;
mod place;
mod quadrature;
mod rescaled;
mod search;
mod shoot;
mod source;
mod triangle;
mod walk;

use std::fmt;

use crate::point::Uv;
use crate::reparametrised::Reparametrised;
use crate::trace::TraceError;

pub use between::{Connection, Connections, FAMILY_REMARK, MOST_CONNECTIONS, between, distance};
pub use circle::{Circle, RayStop, circle};
pub use gap::{components, is_one_place, shortest_step};
pub use place::{PlaceMeasures, Principal, place};
pub use triangle::{NoRegion, Triangle, TriangleRegion, triangle};
pub use walk::{Closing, Transport, closing, transport};

/// The reason why nothing can be measured at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeasureError {
    /// A coordinate is not a finite number.
    NotFinite,
    /// The point is outside the domain, beyond a side that does not wrap.
    Outside {
        /// The point.
        at: [f64; 2],
        /// The domain.
        domain: [[f64; 2]; 2],
    },
    /// The surface is undefined there.
    Undefined {
        /// The point.
        at: [f64; 2],
    },
    /// The surface has no tangent plane there.
    Degenerate {
        /// The point.
        at: [f64; 2],
    },
    /// The point is on a crease, such as that of |u| at u = 0: the tangent planes of the two sides differ.
    Crease {
        /// The point.
        at: [f64; 2],
    },
    /// A length is negative or not a finite number.
    BadLength {
        /// The length.
        length: f64,
    },
}

impl MeasureError {
    /// Converts an error on a reparametrised surface: its point is in the parameters of the surface itself.
    fn restored(self, even: &Reparametrised<'_>) -> Self {
        let restored = |at: [f64; 2]| even.restored(Uv(at)).0.0;
        match self {
            Self::Outside { at, domain } => Self::Outside {
                at: restored(at),
                domain,
            },
            Self::Undefined { at } => Self::Undefined { at: restored(at) },
            Self::Degenerate { at } => Self::Degenerate { at: restored(at) },
            Self::Crease { at } => Self::Crease { at: restored(at) },
            Self::NotFinite | Self::BadLength { .. } => self,
        }
    }
}

impl From<TraceError> for MeasureError {
    fn from(error: TraceError) -> Self {
        match error {
            TraceError::OutsideDomain { at, domain } => Self::Outside { at, domain },
            TraceError::UndefinedStart { at } => Self::Undefined { at },
            TraceError::DegenerateStart { at } => Self::Degenerate { at },
            TraceError::BadLength { length } | TraceError::BadTolerance { tolerance: length } => {
                Self::BadLength { length }
            }
            TraceError::StartNotFinite
            | TraceError::DirectionNotFinite
            | TraceError::ZeroDirection => Self::NotFinite,
        }
    }
}

impl fmt::Display for MeasureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite => f.write_str("the point is not a pair of numbers"),
            Self::Outside {
                at: [u, v],
                domain: [[u0, u1], [v0, v1]],
            } => write!(
                f,
                "the point ({u}, {v}) lies outside the domain [{u0}, {u1}] × [{v0}, {v1}]"
            ),
            Self::Undefined { at: [u, v] } => {
                write!(f, "the surface is undefined at the point ({u}, {v})")
            }
            Self::Degenerate { at: [u, v] } => write!(
                f,
                "the surface has no tangent plane at the point ({u}, {v}): σu and σv are parallel or undefined, or the metric is \
                 not positive definite"
            ),
            Self::Crease { at: [u, v] } => write!(
                f,
                "the point ({u}, {v}) lies on a crease: the tangent planes of both sides differ"
            ),
            Self::BadLength { length } => {
                write!(f, "the length {length} is not a number of at least 0")
            }
        }
    }
}

impl std::error::Error for MeasureError {}
