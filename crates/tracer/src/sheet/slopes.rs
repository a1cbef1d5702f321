//! The slopes of a parametric surface on a cell.
//!
//! Input: the ranges of σu and σv on a cell. Output: for a ray, whether it meets the cell once at most, and whether it passes it
//! by. By the mean value theorem every place of the cell is σ(m) + JΔ from a place m of it, where the columns of J lie in the
//! ranges of σu and σv; with r = origin − σ(m) a ray meets it where JΔ = r + t·d. Cramer's rule gives Δu = σv·(d×r)/D and
//! Δv = −σu·(d×r)/D with D = (σu×σv)·d: one step of the interval Newton method (R. E. Moore, *Interval Analysis*, 1966,
//! §7.2).

use expr::interval::{Affine, Interval};
use expr::ops::Binary;
use glam::DVec3;

/// A ray with what all cells need of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SheetRay {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) reciprocal: DVec3,
    /// The sizes of the direction's components.
    pub(super) sizes: DVec3,
    /// Their sum.
    pub(super) sum: f64,
    /// The square of the direction's length.
    square: f64,
    /// True if its start lies on a surface.
    pub(super) leaves: bool,
}

impl SheetRay {
    pub(crate) fn new(origin: DVec3, direction: DVec3, leaves: bool) -> Self {
        Self {
            leaves,
            origin,
            direction,
            reciprocal: direction.recip(),
            sizes: direction.abs(),
            sum: direction.abs().element_sum(),
            square: direction.length_squared(),
        }
    }

    /// The square of the direction's length.
    pub(super) fn square(&self) -> f64 {
        self.square
    }
}

/// Vectors around a middle one: each component differs by a reach at most.
#[derive(Clone, Copy, Debug)]
struct VectorRange {
    middle: DVec3,
    reach: DVec3,
}

impl VectorRange {
    fn new(sides: &[Interval]) -> Self {
        let side = |k: usize| (sides[k].lower(), sides[k].upper());
        let lower = DVec3::new(side(0).0, side(1).0, side(2).0);
        let upper = DVec3::new(side(0).1, side(1).1, side(2).1);
        let middle = 0.5 * (lower + upper);
        let reach = (upper - middle).max(middle - lower);
        Self {
            middle,
            // The middle and the differences have been rounded.
            reach: reach * (1.0 + ROUNDING) + ROUNDING * middle.abs(),
        }
    }

    /// The product with a vector: its middle, and how far it may be from that. `sizes` are those of the vector's components.
    #[inline]
    fn dot(&self, vector: DVec3, sizes: DVec3) -> [f64; 2] {
        let reach = self.reach + ROUNDING * self.middle.abs();
        [self.middle.dot(vector), reach.dot(sizes)]
    }
}

/// More than the share by which a few operations are rounded.
pub(super) const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Cells are taken to be larger by this share, so that none is missed where two meet.
pub(super) const MARGIN: f64 = 1e-9;

/// The ranges of σu and σv on a cell, and of their cross product.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellSlopes {
    along: [VectorRange; 2],
    normal: VectorRange,
    /// The changes of the cross product along u and along v.
    turns: [f64; 2],
    /// σuu, σuv and σvv in the middle, times the products of half the sides.
    bends: [DVec3; 3],
}

impl CellSlopes {
    /// With σ, σu and σv on the cell. `None` where one of them may be undefined or endless.
    pub(super) fn new(sides: [[f64; 2]; 2], frame: &[Affine; 9]) -> Option<Self> {
        let is_sound = |side: &Interval| {
            !side.is_partial() && side.lower().is_finite() && side.upper().is_finite()
        };
        let values = frame.map(|it| it.value());
        if !values.iter().all(is_sound) {
            return None;
        }
        let product = |a, b| Interval::binary(Binary::Mul, a, b);
        let difference = |a, b| Interval::binary(Binary::Sub, a, b);
        let [su, sv] = [&values[3..6], &values[6..9]];
        // The components of a difference of two places have slopes of different places.
        let normal = [0, 1, 2].map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            difference(product(su[i], sv[j]), product(su[j], sv[i]))
        });
        let vector = |first: usize, of: &dyn Fn(&Affine) -> f64| {
            DVec3::from_array([0, 1, 2].map(|k| of(&frame[first + k])))
        };
        let [u, v] = [3, 6].map(|first| vector(first, &Affine::middle));
        let changes = [0, 1].map(|k| [3, 6].map(|first| vector(first, &|it| it.slopes()[k])));
        let turns = changes.map(|[du, dv]| (du.cross(v) + u.cross(dv)).length());
        let half = sides.map(|[a, b]| 0.5 * (b - a));
        let [[uu, _], [uv, vv]] = changes;
        normal.iter().all(is_sound).then(|| Self {
            along: [VectorRange::new(su), VectorRange::new(sv)],
            normal: VectorRange::new(&normal),
            turns,
            bends: [half[0] * uu, half[0] * uv, half[1] * vv],
        })
    }

    /// True if the ray cannot meet the cell twice.
    #[inline]
    pub(super) fn meets_once_at_most(&self, ray: &SheetRay) -> bool {
        let [determinant, unsure] = self.normal.dot(ray.direction, ray.sizes);
        determinant.abs() > unsure
    }

    /// The way from the parallelogram to the surface at these shares of the half sides, but for terms of the third order.
    pub(super) fn bend(&self, [x, y]: [f64; 2]) -> DVec3 {
        let [uu, uv, vv] = self.bends;
        // The parallelogram lies in the middle of the places between the least and the greatest of x² and y².
        (0.5 * x * x - 0.25) * uu + x * y * uv + (0.5 * y * y - 0.25) * vv
    }

    /// The side along which the surface turns more.
    pub(super) fn more_turned(&self) -> Option<usize> {
        let [u, v] = self.turns;
        ((u - v).is_finite() && u != v).then(|| usize::from(v > u))
    }

    /// Returns true if a ray that meets the cell once at most does not meet it: from a place on its edge all solutions lie beyond
    /// one of the sides that `beyond` names, 1 for the greatest u or v and −1 for the least. `place` contains σ there.
    pub(super) fn is_passed(
        &self,
        ray: &SheetRay,
        beyond: [f64; 2],
        place: &[Interval; 3],
    ) -> bool {
        let place = VectorRange::new(place);
        let offset = ray.origin - place.middle;
        let slack = self.slack(ray, &place, offset);
        let [determinant, _] = self.normal.dot(ray.direction, ray.sizes);
        let steps = self.steps(ray, offset, slack);
        (0..2).any(|k| {
            let [step, reach] = steps[k];
            beyond[k] != 0.0 && beyond[k] * step * determinant.signum() > reach
        })
    }

    /// The numerators of Δu and Δv from a place, each with how far it may be off.
    #[inline]
    fn steps(&self, ray: &SheetRay, offset: DVec3, slack: DVec3) -> [[f64; 2]; 2] {
        let turned = ray.direction.cross(offset);
        let sizes = turned.abs();
        // A component of the cross product is a sum of two products of what is off by the slack.
        let [d, s] = [ray.sizes, slack];
        let off = DVec3::new(
            d.y * s.z + d.z * s.y,
            d.z * s.x + d.x * s.z,
            d.x * s.y + d.y * s.x,
        );
        let product = |range: &VectorRange| {
            let [middle, reach] = range.dot(turned, sizes);
            [middle, reach + (range.middle.abs() + range.reach).dot(off)]
        };
        let [u, v] = [product(&self.along[1]), product(&self.along[0])];
        [u, [-v[0], v[1]]]
    }

    /// The error of the offset of a ray's start from a place, at most.
    #[inline]
    fn slack(&self, ray: &SheetRay, place: &VectorRange, offset: DVec3) -> DVec3 {
        place.reach + ROUNDING * (ray.origin.abs() + place.middle.abs() + offset.abs())
    }
}
