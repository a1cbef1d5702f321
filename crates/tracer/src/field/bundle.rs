//! Rays that go nearly the same way, read together.
//!
//! Input: an expression and the rays of a bundle in its coordinates. Output: the range of t divided into parts, each with
//! what interval arithmetic shows for all rays of the bundle at once. Most of space is decided once for a bundle in place of
//! once for each ray, and a part on which the value is monotone along each ray needs nothing but the signs at its ends.

use expr::interval::{Interval, Slope};
use expr::ops::Binary;

use crate::field::{Field, FieldScratch, Line};

/// A part of a range of t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BundlePart {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) finding: PartFinding,
}

/// The knowledge about a part, for each ray.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum PartFinding {
    /// The value is positive or undefined throughout.
    Outside,
    /// The value is defined and not positive throughout.
    Inside,
    /// The value is defined, continuous and strictly monotone; of a shell, that of the expression in it.
    Monotone,
    /// The part is too short to be halved.
    Shortest,
    Open,
}

/// Rays in the coordinates of a field: intervals that contain their starts and directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LineBundle {
    origin: [Interval; 3],
    direction: [Interval; 3],
}

/// The number of evaluations for a bundle and a field.
const MOST_EVALUATIONS: usize = 128;

impl LineBundle {
    /// The rays.
    pub(crate) fn new(lines: impl Iterator<Item = Line>) -> Self {
        let mut bundle = Self {
            origin: [Interval::UNDEFINED; 3],
            direction: [Interval::UNDEFINED; 3],
        };
        let [mut least, mut most] = [[f64::INFINITY; 6], [f64::NEG_INFINITY; 6]];
        for line in lines {
            let all = line.origin.to_array().into_iter();
            for (k, x) in all.chain(line.direction.to_array()).enumerate() {
                least[k] = least[k].min(x);
                most[k] = most[k].max(x);
            }
        }
        for k in 0..3 {
            bundle.origin[k] = Interval::new(least[k], most[k]);
            bundle.direction[k] = Interval::new(least[k + 3], most[k + 3]);
        }
        bundle
    }

    fn coordinate(&self, k: usize, t: Interval) -> Slope {
        let step = Interval::binary(Binary::Mul, t, self.direction[k]);
        Slope {
            value: Interval::binary(Binary::Add, self.origin[k], step),
            slope: self.direction[k],
        }
    }

    /// True if the part is shorter than the bundle is wide: shorter parts say little more.
    fn is_wider_than(&self, [a, b]: [f64; 2]) -> bool {
        let middle = Interval::point(0.5 * (a + b));
        let widths = (0..3).map(|k| self.coordinate(k, middle).value.width());
        let lengths = (0..3).map(|k| {
            let direction = self.direction[k];
            (b - a) * direction.lower().abs().max(direction.upper().abs())
        });
        lengths.fold(0.0, f64::max) <= 0.5 * widths.fold(0.0, f64::max)
    }
}

impl Field {
    /// Divides the range into parts, in ascending order.
    pub(crate) fn divide(
        &self,
        scratch: &mut FieldScratch,
        bundle: &LineBundle,
        [from, to]: [f64; 2],
    ) -> Vec<BundlePart> {
        let mut found: Vec<BundlePart> = Vec::new();
        let mut budget = MOST_EVALUATIONS;
        scratch.parts.clear();
        scratch.parts.push((from, to));
        while let Some((a, b)) = scratch.parts.pop() {
            let mut finding = PartFinding::Open;
            if budget > 0 {
                budget -= 1;
                let t = Interval::new(a, b);
                let range = self.range(scratch, &|k| bundle.coordinate(k, t));
                if let Some(found) = self.finding(range) {
                    finding = found;
                } else if !bundle.is_wider_than([a, b]) && b - a > 0.0 {
                    let middle = 0.5 * (a + b);
                    scratch.parts.push((middle, b));
                    scratch.parts.push((a, middle));
                    continue;
                }
            }
            match found.last_mut() {
                // Two parts that are both decided alike, or both open, are one.
                Some(last) if last.finding == finding && finding != PartFinding::Monotone => {
                    last.to = b;
                }
                _ => found.push(BundlePart {
                    from: a,
                    to: b,
                    finding,
                }),
            }
        }
        found
    }
}
