//! Both sides of a crease at one point of it. In: the jets of both sides, a velocity. Out: the velocity behind the crease,
//! and the change of the Jacobi field.
//!
//! Unfolded about the crease both sides are one plane to first order, and a geodesic is a straight line in it: the
//! components of the velocity along and across the crease keep their lengths. This is the rule for the edges of a polyhedron
//! (Mitchell, Mount, Papadimitriou, *The discrete geodesic problem*, SIAM J. Comput. 16, 1987, pages 647–668).
//!
//! A neighbouring geodesic meets the crease at the distance m/sin α along it, where α is the angle between the crease and
//! the ray. There the crease has turned by κ m/sin α, with its geodesic curvature κ, which differs between the sides. Both
//! geodesics preserve their angles to it, so that m is continuous and m' changes by (κ₂ − κ₁) m/sin α. This is ∫K over a
//! strip about the crease, by the Gauss–Bonnet theorem (do Carmo, *Differential Geometry of Curves and Surfaces*, 1976,
//! section 4-5).

use crate::jet::Jet;
use crate::metric::{Metric, acceleration, speed};
use crate::vector::{combine, dot, norm};

/// The maximum relative difference of the quantities that both sides must have in common.
const COMMON: f64 = 1e-6;
/// Tangents, or metrics, whose relative difference is at most this are the same.
const EQUAL: f64 = 1e-9;
/// The sine of the angle to the crease below which a ray is along it.
const GRAZING: f64 = 1e-9;
/// The relative rounding error of a metric beside a crease.
const ROUNDED: f64 = 1e-13;
/// A jump of the metric has rank one if its mixed component is smaller than the other by this factor.
const RANK_ONE: f64 = 1e-4;

/// The continuation of a ray behind a crease.
pub(super) struct Passage {
    pub(super) velocity: [f64; 2],
    /// The change of m' for m = 1.
    pub(super) field_change: f64,
    /// True if the tangents, or the coefficients of the metric, jump.
    pub(super) refracts: bool,
}

/// Both sides of a crease.
pub(super) struct BothSides<'a> {
    pub(super) jets: &'a [Jet; 2],
    metrics: [Metric; 2],
    /// The kind of the jump.
    jump: Jump,
}

/// The kind of difference between the sides.
enum Jump {
    /// The derivatives of σ, all along one vector in space.
    Tangents([f64; 3]),
    /// The coefficients of a metric.
    Form,
    /// At most the derivatives of the metric.
    Slopes,
}

impl<'a> BothSides<'a> {
    pub(super) fn new(jets: &'a [Jet; 2], is_embedded: bool) -> Self {
        let metrics = [0, 1].map(|k| Metric::of(&jets[k]));
        let [near, far] = jets;
        let jump = if is_embedded {
            let [u, v] = [(near.du, far.du), (near.dv, far.dv)]
                .map(|(before, behind)| combine(1.0, behind, -1.0, before));
            let shares = [norm(u) / norm(near.du), norm(v) / norm(near.dv)];
            let largest = if shares[0] >= shares[1] { u } else { v };
            let size = norm(largest);
            if shares[0].max(shares[1]) > EQUAL {
                Jump::Tangents(largest.map(|x| x / size))
            } else {
                Jump::Slopes
            }
        } else {
            let [before, behind] = &metrics;
            let off = [
                behind.e / before.e - 1.0,
                (behind.f - before.f) / before.r,
                behind.g / before.g - 1.0,
            ];
            if off.iter().any(|off| off.abs() > EQUAL) {
                Jump::Form
            } else {
                Jump::Slopes
            }
        };
        Self {
            jets,
            metrics,
            jump,
        }
    }

    /// Returns whether the metric of a side changes much, or is undefined, within the gap between the two points.
    pub(super) fn are_steep(&self, gap: [f64; 2]) -> bool {
        let is_flat = |side: usize| {
            let Metric { e, g, .. } = self.metrics[side];
            let [e1, f1, g1] = self.slope(side, gap);
            let change = (e1 / e).abs() + (f1 / (e * g).sqrt()).abs() + (g1 / g).abs();
            change <= COMMON
        };
        !(is_flat(0) && is_flat(1))
    }

    /// Returns the direction in (u,v) in which the crease runs, and where both sides agree in two directions, the other one.
    /// `None` where they agree in none.
    pub(super) fn common_directions(&self) -> Option<([f64; 2], Option<[f64; 2]>)> {
        match self.jump {
            Jump::Tangents(unit) => {
                let [near, far] = self.jets;
                let [u, v] = [(near.du, far.du), (near.dv, far.dv)]
                    .map(|(before, behind)| combine(1.0, behind, -1.0, before));
                let (a, b) = (dot(u, unit), dot(v, unit));
                // The difference must have rank one.
                let rest = [
                    norm(combine(1.0, u, -a, unit)) / norm(near.du),
                    norm(combine(1.0, v, -b, unit)) / norm(near.dv),
                ];
                (rest[0].max(rest[1]) <= COMMON).then_some(([b, -a], None))
            }
            Jump::Form => common_lengths(self.metrics),
            Jump::Slopes => {
                // Only the derivative across the crease jumps.
                let [near, far] =
                    [0, 1].map(|k| [[1.0, 0.0], [0.0, 1.0]].map(|w| self.slope(k, w)));
                let [by_u, by_v] = [0, 1].map(|k| {
                    let jump: [f64; 3] = std::array::from_fn(|n| far[k][n] - near[k][n]);
                    jump
                });
                let Metric { e, g, .. } = self.metrics[0];
                let units = [e, (e * g).sqrt(), g];
                let size = |n: usize| (by_u[n] / units[n]).hypot(by_v[n] / units[n]);
                let largest = (1..3).fold(0, |best, n| if size(n) > size(best) { n } else { best });
                Some(([by_v[largest], -by_u[largest]], None))
            }
        }
    }

    /// Returns the continuation behind a crease that runs in the direction `along`. `None` where the sides give it different
    /// lengths.
    pub(super) fn passage(&self, velocity: [f64; 2], along: [f64; 2]) -> Option<Passage> {
        let straight = |field_change: f64| Passage {
            velocity,
            field_change,
            refracts: false,
        };
        let [near, far] = &self.metrics;
        let size = speed(&self.jets[0], along);
        if matches!(self.jump, Jump::Slopes) && size == 0.0 {
            return Some(straight(0.0));
        }
        if (speed(&self.jets[1], along) / size - 1.0).abs() > COMMON {
            return None;
        }
        let along = along.map(|x| x / size);
        let rate = self.field_change(velocity, along);
        if !rate.is_finite() {
            return None;
        }
        if matches!(self.jump, Jump::Slopes) {
            return Some(straight(rate));
        }
        let share = near.inner(velocity, along);
        let across = [0, 1].map(|k| velocity[k] - share * along[k]);
        let height = speed(&self.jets[0], across);
        let tilt = far.inner(across, along);
        let upright = [0, 1].map(|k| across[k] - tilt * along[k]);
        let size = speed(&self.jets[1], upright);
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        Some(Passage {
            velocity: [0, 1].map(|k| share * along[k] + height / size * upright[k]),
            field_change: rate,
            refracts: true,
        })
    }

    /// Returns the change of m' for m = 1: the difference of the crease's geodesic curvatures over the sine of the angle to
    /// it. `along` has unit length.
    fn field_change(&self, velocity: [f64; 2], along: [f64; 2]) -> f64 {
        let sine = self.metrics[0].r * determinant(velocity, along);
        if sine.abs() < GRAZING {
            return 0.0;
        }
        let left = self.metrics[0].turn_left(along).0;
        let bend = self.bend(along, left);
        let curvatures = [0, 1].map(|k| {
            let straight = acceleration(&self.jets[k], along);
            let off = [0, 1].map(|n| bend * left[n] - straight[n]);
            self.metrics[k].r * determinant(along, off)
        });
        (curvatures[1] - curvatures[0]) / sine
    }

    /// Returns the second derivative of the crease's coordinates by its length, as a multiple of `left`; a part along the
    /// crease does not matter. What is the same on both sides remains so along the crease.
    fn bend(&self, along: [f64; 2], left: [f64; 2]) -> f64 {
        let [near, far] = self.jets;
        match self.jump {
            Jump::Tangents(unit) => {
                let difference = |before: [f64; 3], behind: [f64; 3]| {
                    dot(combine(1.0, behind, -1.0, before), unit)
                };
                let [x, y] = along;
                let second = x * x * difference(near.duu, far.duu)
                    + 2.0 * x * y * difference(near.duv, far.duv)
                    + y * y * difference(near.dvv, far.dvv);
                let first =
                    left[0] * difference(near.du, far.du) + left[1] * difference(near.dv, far.dv);
                -second / first
            }
            Jump::Form => {
                let [before, behind] = [0, 1].map(|k| self.slope(k, along));
                let slope: [f64; 3] = std::array::from_fn(|n| behind[n] - before[n]);
                let form: [f64; 3] = {
                    let [near, far] = &self.metrics;
                    [far.e - near.e, far.f - near.f, far.g - near.g]
                };
                let mixed = product(form, along, left);
                let across = product(form, left, left);
                if mixed.abs() > RANK_ONE * across.abs() {
                    -0.5 * product(slope, along, along) / mixed
                } else {
                    -product(slope, along, left) / across
                }
            }
            // The same on both sides: it cancels.
            Jump::Slopes => 0.0,
        }
    }

    /// Returns the derivatives of E, F, G on a side, in a direction in (u,v).
    fn slope(&self, side: usize, [x, y]: [f64; 2]) -> [f64; 3] {
        let Jet {
            du,
            dv,
            duu,
            duv,
            dvv,
            ..
        } = self.jets[side];
        let by = [combine(x, duu, y, duv), combine(x, duv, y, dvv)];
        [
            2.0 * dot(by[0], du),
            dot(by[0], dv) + dot(du, by[1]),
            2.0 * dot(by[1], dv),
        ]
    }
}

fn determinant(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Returns a form's value at two vectors.
fn product([e, f, g]: [f64; 3], a: [f64; 2], b: [f64; 2]) -> f64 {
    e * a[0] * b[0] + f * (a[0] * b[1] + a[1] * b[0]) + g * a[1] * b[1]
}

/// Returns the directions in (u,v) to which both metrics assign the same length.
fn common_lengths([near, far]: [Metric; 2]) -> Option<([f64; 2], Option<[f64; 2]>)> {
    let [e, f, g] = [far.e - near.e, far.f - near.f, far.g - near.g];
    let square = f * f - e * g;
    let size = (f * f).max((e * g).abs());
    if square < -COMMON * size {
        return None;
    }
    // Where the difference has rank one, rounding must not split its one direction into two.
    let mixed = 2.0 * f.abs() * (near.e * near.g).sqrt();
    let noise = ROUNDED * (e.abs() * near.g + g.abs() * near.e + mixed);
    let root = if square > noise { square.sqrt() } else { 0.0 };
    let pair = |sign: f64| {
        if e.abs() >= g.abs() {
            [-f + sign * root, e]
        } else {
            [g, -f + sign * root]
        }
    };
    Some((pair(1.0), (root > 0.0).then(|| pair(-1.0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_give_the_same_length_to_the_common_directions() {
        let metric = |[u, v]: [[f64; 3]; 2]| {
            Metric::of(&Jet {
                du: u,
                dv: v,
                ..Jet::default()
            })
        };
        let here = [[1.0, 0.0, 0.0], [0.2, 1.0, 0.0]];
        for there in [
            [[0.7, 0.0, 0.1], [0.4, 1.3, 0.0]],
            [[1.3, 0.0, 0.1], [0.4, 0.8, 0.0]],
            [[0.9, 0.0, 0.1], [0.4, 1.8, 0.0]],
        ] {
            let metrics = [here, there].map(metric);
            let (first, second) = common_lengths(metrics).expect("lengths that agree somewhere");
            for direction in [first, second.expect("another one")] {
                let lengths = metrics.map(|metric| metric.inner(direction, direction).sqrt());
                assert!(lengths[0] > 0.1, "{direction:?}");
                assert!((lengths[1] / lengths[0] - 1.0).abs() < 1e-12, "{lengths:?}");
            }
        }
        // Longer in every direction.
        let there = here.map(|tangent| tangent.map(|x| 2.0 * x));
        assert_eq!(common_lengths([here, there].map(metric)), None);
    }
}
