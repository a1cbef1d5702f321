//! Solids of one quadric each: the first places of many rays at once.
//!
//! Input: rays, and leaves that are solids by themselves. Output: for each ray the first place where it enters one of them.
//! Nothing has to be kept up to date between places, and the rays do not wait for each other. Where the answer takes more
//! than that, as for a ray that starts inside, none is given. The places are those of `cast.rs`, to the last bit.

use crate::bounds::BoundingBox;
use crate::leaf::Leaf;
use crate::line::{Ray, UnitLine, quadratic_changes_in_t};
use crate::low::{LowEquation, LowPiece};
use crate::roots::QuadraticChanges;

/// The first place of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FirstPlace {
    /// The ray enters this leaf at t.
    Enters(f64, u32),
    Nothing,
    /// The answer takes a sweep.
    Unknown,
}

impl FirstPlace {
    /// The nearer of two; unknown where both are as near.
    #[inline]
    fn nearer(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unknown, _) | (_, Self::Unknown) => Self::Unknown,
            (Self::Nothing, place) | (place, Self::Nothing) => place,
            (Self::Enters(s, _), Self::Enters(t, _)) => {
                if s < t {
                    self
                } else if t < s {
                    other
                } else {
                    Self::Unknown
                }
            }
        }
    }
}

/// Brings the first places of rays up to date with a leaf, which is a solid by itself; `bounds` is its box.
pub(crate) fn add_lone(
    leaves: &[Leaf],
    (leaf, low): (u32, &LowPiece),
    bounds: Option<&BoundingBox>,
    rays: &[Ray],
    first: &mut [FirstPlace],
) {
    let opposite = low.opposite;
    match &low.equation {
        LowEquation::Plane(plane) => {
            for (ray, first) in rays.iter().zip(first) {
                let changes = |ray: &Ray| Some(plane.changes(ray, false));
                let place = lone_place((leaf, opposite), bounds, ray, changes);
                *first = first.nearer(place);
            }
        }
        LowEquation::Quadric { frame, form } => {
            let frame = &leaves[*frame as usize];
            for (ray, first) in rays.iter().zip(first) {
                let changes = |ray: &Ray| {
                    let line = UnitLine::new(frame, ray);
                    let is_line = line.speed.is_finite() && line.speed > 0.0;
                    is_line.then(|| quadratic_changes_in_t(&line, form, false))
                };
                let place = lone_place((leaf, opposite), bounds, ray, changes);
                *first = first.nearer(place);
            }
        }
    }
}

#[inline]
fn lone_place(
    (leaf, opposite): (u32, bool),
    bounds: Option<&BoundingBox>,
    ray: &Ray,
    changes: impl Fn(&Ray) -> Option<QuadraticChanges>,
) -> FirstPlace {
    let mut range = [0.0, f64::INFINITY];
    if let Some(bounds) = bounds {
        let [entry, exit] = bounds.part(ray.origin, ray.direction.recip());
        if !(entry <= exit && exit >= 0.0) {
            return FirstPlace::Nothing;
        }
        range = [entry.max(0.0), exit];
    }
    let [from, to] = range;
    let Some(changes) = changes(ray) else {
        return FirstPlace::Unknown;
    };
    if changes.inside_after(from) != opposite {
        return FirstPlace::Unknown;
    }
    let within = |t: f64| t > from && t <= to;
    match *changes.places() {
        [s, t] if s == t => FirstPlace::Unknown,
        [s, _] | [s] if within(s) => FirstPlace::Enters(s, leaf),
        [_, t] if within(t) => FirstPlace::Enters(t, leaf),
        [] | [_] | [_, _] => FirstPlace::Nothing,
        _ => FirstPlace::Unknown,
    }
}
