//! Pieces of degree at most two, prepared for rays.
//!
//! In: the leaves of a world and the surfaces that they share. Out: for each such piece the equation that is solved, which
//! is that of the first piece of its surface, and the leaf whose frame the equation uses; and the leaves that are convex,
//! which a ray never meets again after it has left them.

use glam::DVec3;

use crate::bundle::RayBundle;
use crate::leaf::Leaf;
use crate::line::Ray;
use crate::roots::QuadraticChanges;
use crate::shape::{FramedShape, LeafSurface};
use crate::shared::Surfaces;
use crate::surface::QuadraticForm;
use expr::polynomial::Region;

/// A piece of degree at most two.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LowPiece {
    /// The unit normal of a plane, if it has one.
    pub(crate) normal: Option<DVec3>,
    /// True if the piece is on the other side of the surface.
    pub(crate) opposite: bool,
    pub(crate) equation: LowEquation,
}

/// The equation of a surface of degree at most two.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LowEquation {
    Plane(WorldPlane),
    Quadric {
        /// The leaf whose frame the equation uses.
        frame: u32,
        form: QuadraticForm,
    },
}

/// A plane in world coordinates: its value is `normal`·(point − `centre`) + `offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WorldPlane {
    pub(crate) normal: DVec3,
    /// The centre of the leaf's frame: differences from it lose no digits far from the origin.
    pub(crate) centre: DVec3,
    pub(crate) offset: f64,
}

impl WorldPlane {
    fn new(leaf: &Leaf, normal: DVec3, offset: f64) -> Self {
        Self {
            normal: leaf.unit_from_world.matrix3.transpose() * normal,
            centre: leaf.unit_from_world.inverse().translation,
            offset,
        }
    }

    /// Returns the sign change along a ray; none if the ray leaves the plane.
    #[inline]
    pub(crate) fn changes(&self, ray: &Ray, leaving: bool) -> QuadraticChanges {
        let slope = self.normal.dot(ray.direction);
        if leaving {
            return QuadraticChanges::of_linear([slope, 0.0]);
        }
        let value = self.normal.dot(ray.origin - self.centre) + self.offset;
        QuadraticChanges::of_linear([value, slope])
    }
}

/// Returns the pieces of a world by their numbers; `None` for those of higher degree and for fields.
pub(crate) fn low_pieces(leaves: &[Leaf], surfaces: &Surfaces) -> Vec<Option<LowPiece>> {
    let form = |leaf: u32, piece: u32| match &leaves[leaf as usize].compiled.pieces[piece as usize]
    {
        LeafSurface::Polynomial(surface) => surface.quadratic(),
        LeafSurface::Field(..) => None,
    };
    let count = leaves
        .last()
        .map_or(0, |last| last.first_piece + last.compiled.pieces.len());
    let mut pieces = Vec::with_capacity(count);
    for (l, leaf) in leaves.iter().enumerate() {
        for p in 0..leaf.compiled.pieces.len() {
            let own = (l as u32, p as u32);
            let (opposite, (frame, piece)) = match surfaces.group(leaf.first_piece + p) {
                Some(member) => (member.opposite, surfaces.first[member.group as usize]),
                None => (false, own),
            };
            // Both have the same degree.
            let own_form = form(own.0, own.1);
            let normal = match own_form {
                Some(QuadraticForm::Plane { normal, .. }) => {
                    (leaf.unit_from_world.matrix3.transpose() * normal).try_normalize()
                }
                _ => None,
            };
            let form = own_form.and_then(|_| form(frame, piece));
            pieces.push(form.map(|form| LowPiece {
                normal,
                opposite,
                equation: match form {
                    QuadraticForm::Plane { normal, offset } => {
                        let leaf = &leaves[frame as usize];
                        LowEquation::Plane(WorldPlane::new(leaf, normal, offset))
                    }
                    QuadraticForm::Quadric { .. } => LowEquation::Quadric { frame, form },
                },
            }));
        }
    }
    pieces
}

/// Returns true if the leaf is an intersection of half-spaces and of quadrics without mixed terms and with no negative
/// coefficients of squares.
pub(crate) fn is_convex(shape: &FramedShape) -> bool {
    let all = match &shape.region {
        Region::Polynomial(_) => true,
        Region::All(parts) => parts
            .iter()
            .all(|part| matches!(part, Region::Polynomial(_))),
        _ => false,
    };
    all && !shape.pieces.is_empty()
        && shape.pieces.iter().all(|piece| match piece {
            LeafSurface::Polynomial(surface) => {
                surface.quadratic().is_some_and(|form| form.is_convex())
            }
            LeafSurface::Field(..) => false,
        })
}

/// Returns true if the leaf is convex, or the set where one piece of degree at most two is not positive.
pub(crate) fn is_simple(leaf: &Leaf) -> bool {
    let is_quadric = matches!(leaf.compiled.region, Region::Polynomial(_))
        && matches!(
            &leaf.compiled.pieces[..],
            [LeafSurface::Polynomial(surface)] if surface.degree() <= 2
        );
    is_quadric || is_convex(&leaf.compiled)
}

/// The computed sign of a slope is trusted above this fraction of its terms.
const CLEAR: f64 = 1e-9;

/// Returns true if all rays of the bundle start outside of a half-space that contains a convex leaf, and stay outside.
pub(crate) fn passes(leaf: &Leaf, bundle: &RayBundle) -> bool {
    leaf.compiled.pieces.iter().any(|piece| {
        let LeafSurface::Polynomial(surface) = piece else {
            return false;
        };
        let Some(QuadraticForm::Plane { normal, offset }) = surface.quadratic() else {
            return false;
        };
        let ([origin, origin_half], [direction, direction_half]) = in_frame(leaf, bundle);
        let least = |middle: DVec3, half: DVec3| normal.dot(middle) - normal.abs().dot(half);
        let most = |middle: DVec3, half: DVec3| normal.abs().dot(middle.abs() + half);
        let value = least(origin, origin_half) + offset;
        let mut terms = most(origin, origin_half) + offset.abs();
        let starts_outside = value > CLEAR * terms;
        if !starts_outside {
            return false;
        }
        let slope = least(direction, direction_half);
        let reach = bundle.reach();
        terms += reach * most(direction, direction_half);
        slope >= 0.0 || value + reach * slope > CLEAR * terms
    })
}

/// Returns the starts and the directions in the frame of a leaf, each as a centre with the maximum distance from it.
fn in_frame(leaf: &Leaf, bundle: &RayBundle) -> ([DVec3; 2], [DVec3; 2]) {
    let map = &leaf.unit_from_world;
    let size = |v: DVec3| {
        let m = &map.matrix3;
        v.x * m.x_axis.abs() + v.y * m.y_axis.abs() + v.z * m.z_axis.abs()
    };
    let ([origin, origin_half], [direction, direction_half]) =
        (bundle.origins(), bundle.directions());
    (
        [map.transform_point3(origin), size(origin_half)],
        [map.transform_vector3(direction), size(direction_half)],
    )
}

/// Returns true if all rays of the bundle, which start on this piece of a convex leaf, clearly lead away from it.
pub(crate) fn departs(leaf: &Leaf, piece: u32, bundle: &RayBundle) -> bool {
    let LeafSurface::Polynomial(surface) = &leaf.compiled.pieces[piece as usize] else {
        return false;
    };
    let Some(form) = surface.quadratic() else {
        return false;
    };
    let ([origin, origin_half], [direction, direction_half]) = in_frame(leaf, bundle);
    // The gradient is affine.
    let gradient = form.gradient(origin);
    let gradient_half = form.gradient_spread(origin_half);
    let spread = gradient.abs().dot(direction_half)
        + gradient_half.dot(direction.abs())
        + gradient_half.dot(direction_half);
    let terms = (gradient.abs() + gradient_half).dot(direction.abs() + direction_half);
    gradient.dot(direction) - spread > CLEAR * terms
}
