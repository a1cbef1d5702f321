//! The Jacobi field along a geodesic as a function of its length. In: knots of an integration. Out: integrals.
//!
//! m is the field across the geodesic with m = 0, m' = 1 at its start and m'' = −K m (do Carmo, *Differential Geometry of
//! Curves and Surfaces*, 1976, section 5-5). Between two knots it is the quintic with their values, slopes and second
//! derivatives.

use crate::interpolate::{quintic, value};

/// The field after a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JacobiKnot {
    /// The arc length from the start.
    pub length: f64,
    /// m.
    pub m: f64,
    /// m'.
    pub rate: f64,
    /// The Gaussian curvature K there.
    pub curvature: f64,
}

/// The length of a step in units of 1/√|K|: the quintic's integral then has a relative error of about 10⁻¹¹.
const SHORT: f64 = 0.12;

/// Returns the longest step from a point with this curvature.
pub(crate) fn longest_step(curvature: f64) -> f64 {
    SHORT / curvature.abs().sqrt()
}

/// Returns the integral of |m| over the arc length: the area that neighbouring geodesics sweep per unit of the angle
/// between them, counted as often as it is swept.
pub(crate) fn absolute_integral(knots: &[JacobiKnot]) -> f64 {
    let mut sum = 0.0;
    for pair in knots.windows(2) {
        let quintic = Quintic::between(&pair[0], &pair[1]);
        if (pair[0].m < 0.0) == (pair[1].m < 0.0) || pair[0].m == 0.0 {
            sum += quintic.integral(1.0).abs();
            continue;
        }
        let zero = quintic.zero();
        let first = quintic.integral(zero);
        sum += first.abs() + (quintic.integral(1.0) - first).abs();
    }
    sum
}

/// Returns the signed integral of m over the arc length.
pub(crate) fn integral(knots: &[JacobiKnot]) -> f64 {
    let of = |pair: &[JacobiKnot]| Quintic::between(&pair[0], &pair[1]).integral(1.0);
    knots.windows(2).map(of).sum()
}

/// A polynomial in the fraction x ∈ [0, 1] of the way from one knot to the next.
struct Quintic {
    length: f64,
    coefficients: [f64; 6],
}

impl Quintic {
    fn between(a: &JacobiKnot, b: &JacobiKnot) -> Self {
        let h = b.length - a.length;
        let ends = |knot: &JacobiKnot| [knot.m, knot.rate, -knot.curvature * knot.m];
        Self {
            length: h,
            coefficients: quintic(h, ends(a), ends(b)),
        }
    }

    /// Returns the integral from the first knot to a fraction of the way.
    fn integral(&self, x: f64) -> f64 {
        let terms = (1..=6_u32).rev().zip(self.coefficients.iter().rev());
        let sum = terms.fold(0.0, |sum, (n, c)| sum * x + c / f64::from(n));
        sum * x * self.length
    }

    /// Returns the fraction at which the polynomial changes sign, if it does between the ends, by bisection.
    fn zero(&self) -> f64 {
        let negative = value(&self.coefficients, 0.0) < 0.0;
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if (value(&self.coefficients, middle) < 0.0) == negative {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The field of the unit sphere, sin s.
    fn sphere(to: f64) -> Vec<JacobiKnot> {
        let count = (to / SHORT).ceil();
        (0..=count as u32)
            .map(|n| {
                let length = to * f64::from(n) / count;
                let (m, rate) = length.sin_cos();
                JacobiKnot {
                    length,
                    m,
                    rate,
                    curvature: 1.0,
                }
            })
            .collect()
    }

    #[test]
    fn the_integrals_of_a_sphere_are_those_of_the_sine() {
        for to in [0.5, 3.0, 4.0, 10.0_f64] {
            let knots = sphere(to);
            let signed = 1.0 - to.cos();
            let off = (integral(&knots) - signed).abs();
            assert!(off < 5e-11 * signed.max(1.0), "{to}: {off:e}");
            let turns = (to / std::f64::consts::PI).floor();
            let rest = to - turns * std::f64::consts::PI;
            let absolute = 2.0 * turns + 1.0 - rest.cos();
            let off = (absolute_integral(&knots) - absolute).abs();
            assert!(off < 5e-11 * absolute.max(1.0), "{to}: {off:e}");
        }
        assert_eq!(integral(&[]), 0.0);
    }
}
