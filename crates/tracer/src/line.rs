//! Rays, and rays in the frames of leaves.
//!
//! In: a ray and a leaf. Out: the ray in the leaf's coordinates, and the parameters at which polynomials change their sign
//! along it.

use glam::DVec3;

use crate::field::Line;
use crate::leaf::Leaf;
use crate::roots::{QuadraticChanges, SignChanges, deflated};
use crate::surface::{PolynomialSurface, QuadraticForm};

/// Identifies a surface that bounds a leaf.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct SurfaceId {
    pub(crate) leaf: u32,
    pub(crate) piece: u32,
}

impl SurfaceId {
    /// Returns the first surface of a leaf.
    pub fn of_leaf(leaf: usize) -> Self {
        Self {
            leaf: leaf as u32,
            piece: 0,
        }
    }
}

/// A half-line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The start.
    pub origin: DVec3,
    /// The direction; its length is the unit of t.
    pub direction: DVec3,
    /// The surface on which it starts, if any.
    pub leaving: Option<SurfaceId>,
}

impl Ray {
    /// Returns true if it is a half-line: its numbers are finite and its direction is not 0.
    #[inline]
    pub(crate) fn is_usable(&self) -> bool {
        self.origin.is_finite() && self.direction.is_finite() && self.direction != DVec3::ZERO
    }
}

/// A ray in the frame of a leaf, from its point nearest to the frame's centre.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct UnitLine {
    pub(crate) point: DVec3,
    pub(crate) direction: DVec3,
    /// The t of that point.
    middle: f64,
    /// The length in the frame of one unit of t, and its reciprocal.
    pub(crate) speed: f64,
    slowness: f64,
}

impl UnitLine {
    #[inline]
    pub(crate) fn new(leaf: &Leaf, ray: &Ray) -> Self {
        let origin = leaf.unit_from_world.transform_point3(ray.origin);
        let velocity = leaf.unit_from_world.transform_vector3(ray.direction);
        let speed = velocity.length();
        let slowness = speed.recip();
        let direction = slowness * velocity;
        let middle = -origin.dot(direction);
        let point = origin + middle * direction;
        Self {
            // Repeat the projection: for distant origins the first difference has lost digits.
            point: point - point.dot(direction) * direction,
            direction,
            middle: middle * slowness,
            speed,
            slowness,
        }
    }

    /// Returns true if it is a line.
    #[inline]
    pub(crate) fn is_usable(&self) -> bool {
        self.speed.is_finite() && self.slowness.is_finite()
    }

    pub(crate) fn place(&self, t: f64) -> f64 {
        (t - self.middle) * self.speed
    }

    pub(crate) fn t(&self, place: f64) -> f64 {
        self.middle + place * self.slowness
    }
}

/// Returns the ray in the coordinates of a leaf's shape.
pub(crate) fn field_line(leaf: &Leaf, ray: &Ray) -> Line {
    Line {
        origin: leaf.shape_from_world.transform_point3(ray.origin),
        direction: leaf.shape_from_world.transform_vector3(ray.direction),
    }
}

/// Returns the sign changes of a polynomial of degree at most two along a line, in t; if the ray leaves the surface, without
/// the change at t = 0.
#[inline]
pub(crate) fn quadratic_changes_in_t(
    line: &UnitLine,
    form: &QuadraticForm,
    leaving: bool,
) -> QuadraticChanges {
    let mut p = form.along(line.point, line.direction);
    if leaving {
        p = deflated(&p, line.place(0.0));
    }
    let mut changes = QuadraticChanges::of_quadratic(p);
    changes.map(|place| line.t(place));
    changes
}

/// Returns the sign changes of a polynomial along a line, in t; if the ray leaves the surface, without the change at t = 0.
pub(crate) fn changes_in_t(
    line: &UnitLine,
    surface: &PolynomialSurface,
    leaving: bool,
    range: Option<[f64; 2]>,
) -> SignChanges {
    let mut p = surface.along(line.point, line.direction);
    if leaving {
        p = deflated(&p, line.place(0.0));
    }
    let mut changes = match range {
        Some([from, to]) if surface.degree() > 2 => {
            SignChanges::between(&p, line.place(from), line.place(to))
        }
        _ => SignChanges::everywhere(&p),
    };
    changes.map(|place| line.t(place));
    changes
}
