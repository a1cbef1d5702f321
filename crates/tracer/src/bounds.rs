//! Boxes, and the search for a box that contains a set.
//!
//! In: an interval evaluator of an expression. Out: a box outside which the expression is positive or undefined, found side
//! by side. A side beyond which this cannot be shown stays where it was, perhaps at infinity: for unbounded sets, and where
//! intervals are too coarse.

use std::cell::Cell;

use expr::interval::Interval;
use glam::{DAffine3, DVec3};

/// A box with sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingBox {
    /// The smallest coordinates.
    pub lower: DVec3,
    /// The largest coordinates.
    pub upper: DVec3,
}

/// The search for boxes covers magnitudes from 2^SMALLEST_EXPONENT.
pub(crate) const SMALLEST_EXPONENT: i32 = -40;
/// The search for boxes covers magnitudes to 2^LARGEST_EXPONENT.
pub const LARGEST_EXPONENT: i32 = 200;
/// Usual boxes are at most 2^USUAL_EXPONENT large.
pub(crate) const USUAL_EXPONENT: i32 = 40;
/// The number of passes in which all sides are moved.
const PASSES: usize = 3;
/// The number of halvings by which a side is moved inward.
const STEPS: usize = 8;
/// A side is not moved by less than this fraction of the length of the box.
const CLOSE: f64 = 1.0 / 128.0;
/// The number of parts into which a slab is divided before it counts as intersecting the set.
const PARTS: usize = 32;

impl BoundingBox {
    /// The box that contains no point.
    pub const EMPTY: Self = Self {
        lower: DVec3::INFINITY,
        upper: DVec3::NEG_INFINITY,
    };

    /// The whole space.
    pub(crate) const WHOLE: Self = Self {
        lower: DVec3::NEG_INFINITY,
        upper: DVec3::INFINITY,
    };

    /// Returns the box if all its sides are finite.
    pub(crate) fn if_finite(self) -> Option<Self> {
        (self.is_empty() || self.lower.is_finite() && self.upper.is_finite()).then_some(self)
    }

    /// Returns true if it contains no point.
    pub fn is_empty(&self) -> bool {
        !self.lower.cmple(self.upper).all()
    }

    /// Returns the smallest box that contains both.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            lower: self.lower.min(other.lower),
            upper: self.upper.max(other.upper),
        }
    }

    /// Returns the box enlarged on all sides by this fraction of half its longest side.
    pub(crate) fn with_room(&self, share: f64) -> Self {
        if self.is_empty() {
            return *self;
        }
        let room = share * (0.5 * (self.upper - self.lower)).max_element();
        Self {
            lower: self.lower - room,
            upper: self.upper + room,
        }
    }

    /// Returns the box between the smallest and the largest coordinates.
    pub(crate) fn of_ranges(ranges: [[f64; 2]; 3]) -> Self {
        Self {
            lower: DVec3::from_array(ranges.map(|[lower, _]| lower)),
            upper: DVec3::from_array(ranges.map(|[_, upper]| upper)),
        }
    }

    /// Enlarges the box to contain a point.
    #[inline]
    pub(crate) fn include(&mut self, point: DVec3) {
        self.lower = self.lower.min(point);
        self.upper = self.upper.max(point);
    }

    /// Returns the centre and half the side lengths; these contain the box despite rounding.
    pub(crate) fn middle(&self) -> [DVec3; 2] {
        let centre = self.centre();
        [centre, (self.upper - centre).max(centre - self.lower)]
    }

    /// Returns the intersection of both.
    pub fn common(&self, other: &Self) -> Self {
        let common = Self {
            lower: self.lower.max(other.lower),
            upper: self.upper.min(other.upper),
        };
        if common.is_empty() {
            Self::EMPTY
        } else {
            common
        }
    }

    /// Returns the centre.
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.lower + self.upper)
    }

    /// Returns the smallest box that contains the image.
    pub fn transformed(&self, map: &DAffine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let columns = map.matrix3;
        if self.if_finite().is_none() {
            let rows = columns.transpose();
            let sides = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| self.along(row));
            let [lower, upper] = [0, 1].map(|end| DVec3::from_array(sides.map(|side| side[end])));
            let slack = [lower, upper].map(|end| 1e-12 * (end.abs() + map.translation.abs()));
            return Self {
                lower: map.translation + lower - slack[0],
                upper: map.translation + upper + slack[1],
            };
        }
        let (centre, half) = (self.centre(), 0.5 * (self.upper - self.lower));
        let reach = columns.x_axis.abs() * half.x
            + columns.y_axis.abs() * half.y
            + columns.z_axis.abs() * half.z;
        let centre = map.transform_point3(centre);
        let slack = 1e-12 * (centre.abs() + reach);
        Self {
            lower: centre - reach - slack,
            upper: centre + reach + slack,
        }
    }

    /// Returns the smallest and the largest dot product of a vector with a point of the box. An axis along which the vector
    /// is 0 contributes nothing, even if the box is unbounded along it.
    fn along(&self, vector: DVec3) -> [f64; 2] {
        let mut all = [0.0; 2];
        for k in (0..3).filter(|&k| vector[k] != 0.0) {
            let [a, b] = [vector[k] * self.lower[k], vector[k] * self.upper[k]];
            all = [all[0] + a.min(b), all[1] + a.max(b)];
        }
        all
    }

    /// Returns the interval of the ray's parameter within the box, from the start of the ray on. A ray that only touches a
    /// side, an edge or a corner also meets the box, whatever the rounding.
    #[inline]
    pub(crate) fn met(&self, origin: DVec3, reciprocal: DVec3) -> Option<[f64; 2]> {
        let [near, far] = self.part(origin, reciprocal);
        // A difference, a reciprocal and a product have been rounded; infinite values have no rounding error.
        let size = near.abs() + far.abs();
        let slack = if size.is_finite() {
            4.0 * f64::EPSILON * size
        } else {
            0.0
        };
        (near <= far + slack && far >= -slack).then_some([near, far])
    }

    /// Returns the interval of a line's parameter within the box; empty if the first bound exceeds the second.
    #[inline]
    pub(crate) fn part(&self, origin: DVec3, reciprocal: DVec3) -> [f64; 2] {
        let a = (self.lower - origin) * reciprocal;
        let b = (self.upper - origin) * reciprocal;
        let sum = a + b;
        if !(sum.x + sum.y + sum.z).is_nan() {
            let less = |a: f64, b: f64| if a < b { a } else { b };
            let more = |a: f64, b: f64| if a > b { a } else { b };
            return [
                more(more(less(a.x, b.x), less(a.y, b.y)), less(a.z, b.z)),
                less(less(more(a.x, b.x), more(a.y, b.y)), more(a.z, b.z)),
            ];
        }
        // 0·∞: the line runs in the plane of a side, and counts as inside.
        let near = |a: f64, b: f64| {
            if a.is_nan() || b.is_nan() {
                f64::NEG_INFINITY
            } else {
                a.min(b)
            }
        };
        let far = |a: f64, b: f64| {
            if a.is_nan() || b.is_nan() {
                f64::INFINITY
            } else {
                a.max(b)
            }
        };
        [
            near(a.x, b.x).max(near(a.y, b.y)).max(near(a.z, b.z)),
            far(a.x, b.x).min(far(a.y, b.y)).min(far(a.z, b.z)),
        ]
    }
}

/// The remaining work, in operations.
#[derive(Debug)]
pub struct WorkBudget(Cell<u64>);

impl WorkBudget {
    /// Creates a budget of this much work.
    pub fn new(most: u64) -> Self {
        Self(Cell::new(most))
    }

    /// Consumes this much work, or all that is left if that is less; returns true if some is left.
    pub(crate) fn take(&self, operations: u64) -> bool {
        self.0.set(self.0.get().saturating_sub(operations));
        !self.is_used_up()
    }

    /// Returns the remaining work.
    pub fn left(&self) -> u64 {
        self.0.get()
    }

    /// Returns true if no work is left.
    pub(crate) fn is_used_up(&self) -> bool {
        self.0.get() == 0
    }
}

/// Finds a box outside which `range` is positive or undefined, within `limits`; [`BoundingBox::EMPTY`] if that holds
/// everywhere. A side beyond which it cannot be shown stays that of `limits`, perhaps infinite.
pub(crate) fn enclose(
    limits: [Interval; 3],
    range: &mut dyn FnMut([Interval; 3]) -> Interval,
) -> BoundingBox {
    let mut outside = |sides: [Interval; 3]| {
        let value = range(sides);
        value.is_empty() || value.lower() > 0.0
    };
    if outside(limits) {
        return BoundingBox::EMPTY;
    }
    let mut sides = limits;
    // A smaller side helps to reduce the others.
    for _ in 0..PASSES {
        let before = sides;
        for axis in 0..3 {
            for upward in [true, false] {
                let found = side(&mut outside, sides, axis, upward);
                let [lower, upper] = [sides[axis].lower(), sides[axis].upper()];
                sides[axis] = match (found, upward) {
                    (Some(place), true) if place >= lower => Interval::new(lower, place.min(upper)),
                    (Some(place), false) if place <= upper => {
                        Interval::new(place.max(lower), upper)
                    }
                    (Some(_), _) => return BoundingBox::EMPTY,
                    (None, _) => sides[axis],
                };
            }
        }
        // For an infinite side the difference is NaN or infinite.
        let still = |k: usize| before[k].width() - sides[k].width() <= CLOSE * sides[k].width();
        if (0..3).all(still) {
            break;
        }
    }
    BoundingBox {
        lower: DVec3::from_array(sides.map(Interval::lower)),
        upper: DVec3::from_array(sides.map(Interval::upper)),
    }
}

/// Returns the coordinate beyond which, upward or downward, everything is outside.
fn side(
    outside: &mut impl FnMut([Interval; 3]) -> bool,
    sides: [Interval; 3],
    axis: usize,
    upward: bool,
) -> Option<f64> {
    let sign = if upward { 1.0 } else { -1.0 };
    let [least, most] = if upward {
        [sides[axis].lower(), sides[axis].upper()]
    } else {
        [-sides[axis].upper(), -sides[axis].lower()]
    };
    let slab = |from: f64, to: f64| {
        let mut slab = sides;
        slab[axis] = if upward {
            Interval::new(from, to)
        } else {
            Interval::new(-to, -from)
        };
        slab
    };
    // A coordinate beyond which everything is outside: the limit itself, or the smallest suitable candidate.
    let mut place = most;
    if most == f64::INFINITY {
        let places = (SMALLEST_EXPONENT..=LARGEST_EXPONENT).step_by(4);
        let places = places.map(|k| f64::from(k).exp2());
        let places: Vec<f64> = places.filter(|place| *place >= least).collect();
        let usual = f64::from(USUAL_EXPONENT).exp2();
        let (usual, large) = places.split_at(places.partition_point(|place| *place <= usual));
        let mut is_crossed = |at: &f64| !divided(outside, slab(*at, most), axis, upward);
        place = match usual.get(usual.partition_point(&mut is_crossed)) {
            Some(place) => *place,
            // An unbounded set takes one more test.
            None if is_crossed(large.last()?) => return None,
            None => *large.get(large.partition_point(&mut is_crossed))?,
        };
    }
    // Move inward by growing steps as long as everything beyond is outside.
    let mut step = if least.is_finite() {
        CLOSE * (place - least)
    } else {
        place.abs().max(1.0)
    };
    let mut inner = (place - step).max(least);
    while inner > least && divided(outside, slab(inner, place), axis, upward) {
        if place < -f64::from(LARGEST_EXPONENT).exp2() {
            return Some(sign * place);
        }
        place = inner;
        step *= 2.0;
        inner = (place - step).max(least);
    }
    for _ in 0..STEPS {
        let middle = 0.5 * (inner + place);
        if !(middle > inner && middle < place) || place - inner <= CLOSE * (place - least) {
            break;
        }
        if divided(outside, slab(middle, place), axis, upward) {
            place = middle;
        } else {
            inner = middle;
        }
    }
    // Sides leave a margin, in case rounding moves a surface.
    let margin = 1e-9 * (1e-3 + place.abs());
    Some(sign * (place + margin))
}

/// Returns the midpoint of an interval; of an infinite one, its number nearest to 0.
fn middle(side: Interval) -> f64 {
    let middle = 0.5 * (side.lower() + side.upper());
    if middle.is_finite() {
        middle
    } else {
        0.0f64.max(side.lower()).min(side.upper())
    }
}

/// Returns true if the slab, which extends upward or downward along an axis, is outside, as a whole or after division across
/// its longer sides.
fn divided(
    outside: &mut impl FnMut([Interval; 3]) -> bool,
    slab: [Interval; 3],
    axis: usize,
    upward: bool,
) -> bool {
    // If some point is not outside, no division helps.
    let point = [0, 1, 2].map(|k| match (k == axis, upward) {
        (true, true) => slab[k].lower(),
        (true, false) => slab[k].upper(),
        (false, _) => middle(slab[k]),
    });
    if !outside(point.map(Interval::point)) {
        return false;
    }
    let mut rest = vec![slab];
    let mut budget = PARTS;
    while let Some(part) = rest.pop() {
        if budget == 0 {
            return false;
        }
        budget -= 1;
        if outside(part) {
            continue;
        }
        // An infinite side is halved once, at 0.
        let longest = (0..3)
            .filter(|&k| k != axis)
            .filter(|&k| {
                part[k].width().is_finite() || part[k].contains(0.0) && part[k].lower() != 0.0
            })
            .max_by(|&j, &k| part[j].width().total_cmp(&part[k].width()));
        let Some(k) = longest else {
            return false;
        };
        let ([a, b], middle) = ([part[k].lower(), part[k].upper()], middle(part[k]));
        if !(a < middle && middle < b) {
            return false;
        }
        for half in [Interval::new(a, middle), Interval::new(middle, b)] {
            let mut part = part;
            part[k] = half;
            rest.push(part);
        }
    }
    true
}
