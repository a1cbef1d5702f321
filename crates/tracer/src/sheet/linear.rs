//! A cell of a parametric surface as a linear map with bounds of its error.
//!
//! Input: intervals that contain σu and σv on a cell, and σ in its middle m. Output: for a ray, whether it can meet the cell
//! at all, and whether it meets it once at most. By the mean value theorem every place of the cell is σ(m) + JΔ, where the
//! columns of J lie in the intervals of σu and σv, and Δ within the half sides; with r = origin − σ(m) a ray meets it where
//! JΔ = r + t·d. Cramer's rule gives Δu = σv·(d×r)/D and Δv = −σu·(d×r)/D with D = (σu×σv)·d: one step of the interval
//! Newton method (R. E. Moore, *Interval Analysis*, 1966, §7.2).

use expr::interval::Interval;
use expr::ops::Binary;
use glam::DVec3;

/// A ray with what all cells need of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct SheetRay {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) reciprocal: DVec3,
    /// The sizes of the direction's components.
    sizes: DVec3,
    /// The square of the direction's length.
    square: f64,
}

impl SheetRay {
    pub(super) fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            reciprocal: direction.recip(),
            sizes: direction.abs(),
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

/// A cell of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinearCell {
    middle: [f64; 2],
    half: [f64; 2],
    /// σ in the middle, and how far it may be from that.
    place: VectorRange,
    along: [VectorRange; 2],
    normal: VectorRange,
}

/// The number of times that a ray meets a cell, as far as its linear map tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meetings {
    None,
    /// One at most; if there is one, then near these parameters.
    AtMostOne([f64; 2]),
    Unknown,
}

impl LinearCell {
    /// The cell between these sides. `frame` contains σ, σu and σv on it, `place` σ in its middle. `None` where one of them may
    /// be undefined or endless.
    pub(super) fn new(
        sides: [[f64; 2]; 2],
        frame: &[Interval; 9],
        place: &[Interval; 3],
    ) -> Option<Self> {
        let is_sound = |side: &Interval| {
            !side.is_partial() && side.lower().is_finite() && side.upper().is_finite()
        };
        if !frame.iter().chain(place).all(is_sound) {
            return None;
        }
        let product = |a, b| Interval::binary(Binary::Mul, a, b);
        let difference = |a, b| Interval::binary(Binary::Sub, a, b);
        let normal = [0, 1, 2].map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let [su, sv] = [&frame[3..6], &frame[6..9]];
            difference(product(su[i], sv[j]), product(su[j], sv[i]))
        });
        let half = sides.map(|[a, b]| 0.5 * (b - a));
        if !normal.iter().all(is_sound) {
            return None;
        }
        Some(Self {
            middle: sides.map(middle),
            half,
            place: VectorRange::new(place),
            along: [
                VectorRange::new(&frame[3..6]),
                VectorRange::new(&frame[6..9]),
            ],
            normal: VectorRange::new(&normal),
        })
    }

    /// The number of times that a ray meets the cell.
    #[inline]
    pub(super) fn meetings(&self, ray: &SheetRay) -> Meetings {
        let offset = ray.origin - self.place.middle;
        let slack = self.slack(ray, &self.place, offset);
        // Across the ray the cell reaches from its middle no farther than its half sides let it.
        let across = offset - (offset.dot(ray.direction) / ray.square) * ray.direction;
        let sizes = across.abs();
        let [u, v] = [0, 1].map(|k| {
            let [middle, reach] = self.along[k].dot(across, sizes);
            self.half[k] * (middle.abs() + reach)
        });
        let rounded = sizes.dot(slack) + ROUNDING * sizes.dot(offset.abs());
        if across.dot(offset) - rounded > (1.0 + MARGIN) * (u + v) {
            return Meetings::None;
        }
        let [determinant, unsure] = self.normal.dot(ray.direction, ray.sizes);
        let size = determinant.abs();
        if size <= unsure {
            return Meetings::Unknown;
        }
        let steps = self.steps(ray, offset, slack);
        let limit = (1.0 + MARGIN) * (size + unsure);
        if (0..2).any(|k| steps[k][0].abs() - steps[k][1] > limit * self.half[k]) {
            return Meetings::None;
        }
        let start = [0, 1].map(|k| {
            let step = steps[k][0] / determinant;
            self.middle[k] + step.clamp(-self.half[k], self.half[k])
        });
        Meetings::AtMostOne(start)
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

    /// The side along which the cell is longer.
    pub(super) fn longer(&self) -> usize {
        let [u, v] = [0, 1].map(|k| self.half[k] * self.along[k].middle.length());
        usize::from(v > u)
    }
}

pub(super) fn middle([a, b]: [f64; 2]) -> f64 {
    0.5 * (a + b)
}
