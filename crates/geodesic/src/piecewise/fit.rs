//! Polynomials through values. In: values at Chebyshev nodes. Out: coefficients, by Chebyshev series.
//!
//! The sums over the zeros of T_n follow Press, Teukolsky, Vetterling, Flannery, *Numerical Recipes*, 3rd edition, section
//! 5.8. The terms of highest degree estimate the error: see Trefethen, *Approximation Theory and Approximation Practice*,
//! 2013.

use std::f64::consts::PI;

use super::DEGREE;

/// The number of values, or coefficients, in each direction.
pub(super) const COUNT: usize = DEGREE + 1;

/// A value at each node, `[j][i]`: the j-th in Y, the i-th in X.
pub(super) type Grid = [[f64; COUNT]; COUNT];

/// The number of points at which a polynomial is checked.
pub(super) const CHECKS: usize = 12;

/// The tables of a fit.
pub(super) struct Fit {
    /// The points at which a polynomial is compared with the ends, the corners first: where the errors of interpolation at
    /// these nodes have their extremes.
    pub(super) checks: [[f64; 2]; CHECKS],
    /// The nodes at which values are sampled, in [−1, 1].
    pub(super) nodes: [f64; COUNT],
    /// The matrix from values at the nodes to the coefficients of the Chebyshev series.
    series: Grid,
    /// `[n][i]`: the coefficient of x^i in the n-th Chebyshev polynomial.
    powers: Grid,
}

impl Fit {
    pub(super) fn new() -> Self {
        let angle = |k: usize| PI * (k as f64 + 0.5) / COUNT as f64;
        let nodes = std::array::from_fn(|k| -angle(k).cos());
        let series = std::array::from_fn(|n| {
            let norm = if n == 0 { 1.0 } else { 2.0 } / COUNT as f64;
            // Nodes in ascending order: T_n(−x) = (−1)^n T_n(x).
            let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
            std::array::from_fn(|k| sign * norm * (n as f64 * angle(k)).cos())
        });
        let mut powers = [[0.0; COUNT]; COUNT];
        powers[0][0] = 1.0;
        powers[1][1] = 1.0;
        for n in 2..COUNT {
            for i in 0..COUNT {
                let shifted = if i > 0 {
                    2.0 * powers[n - 1][i - 1]
                } else {
                    0.0
                };
                powers[n][i] = shifted - powers[n - 2][i];
            }
        }
        // The extremes of the polynomial whose zeros are the nodes, except at the ends.
        let extreme = |k: usize| (PI * k as f64 / COUNT as f64).cos();
        let (near, far) = (extreme(COUNT / 2), extreme(COUNT / 2 - 1));
        let checks = [
            [-1.0, -1.0],
            [1.0, -1.0],
            [-1.0, 1.0],
            [1.0, 1.0],
            [near, -1.0],
            [1.0, near],
            [-near, 1.0],
            [-1.0, -near],
            [far, near],
            [-near, far],
            [-far, -near],
            [near, -far],
        ];
        Self {
            checks,
            nodes,
            series,
            powers,
        }
    }

    /// Returns the coefficients of the Chebyshev series, T_i(X) T_j(Y) at `[j][i]`.
    pub(super) fn series(&self, values: &Grid) -> Grid {
        // Along X, then along Y.
        let mut half = [[0.0; COUNT]; COUNT];
        for (row, values) in half.iter_mut().zip(values) {
            for (sum, weights) in row.iter_mut().zip(&self.series) {
                *sum = weights.iter().zip(values).map(|(w, x)| w * x).sum();
            }
        }
        let mut both = [[0.0; COUNT]; COUNT];
        for (row, weights) in both.iter_mut().zip(&self.series) {
            for (weight, from) in weights.iter().zip(&half) {
                for (sum, x) in row.iter_mut().zip(from) {
                    *sum += weight * x;
                }
            }
        }
        both
    }

    /// Returns the coefficients of X^i Y^j at `[j][i]`.
    pub(super) fn powers(&self, series: &Grid) -> Grid {
        let mut half = [[0.0; COUNT]; COUNT];
        for (row, coefficients) in half.iter_mut().zip(series) {
            for (coefficient, powers) in coefficients.iter().zip(&self.powers) {
                for (sum, power) in row.iter_mut().zip(powers) {
                    *sum += coefficient * power;
                }
            }
        }
        let mut both = [[0.0; COUNT]; COUNT];
        for (from, powers) in half.iter().zip(&self.powers) {
            for (row, power) in both.iter_mut().zip(powers) {
                for (sum, x) in row.iter_mut().zip(from) {
                    *sum += power * x;
                }
            }
        }
        both
    }
}

/// Returns the sums of a series' terms of the highest degree in a variable, and of the next lower one.
pub(super) fn highest(series: &Grid) -> [f64; 2] {
    [COUNT - 1, COUNT - 2].map(|degree| {
        (0..=degree)
            .map(|k| series[degree][k].abs() + series[k][degree].abs())
            .sum()
    })
}

/// Drops the highest terms of a series that together are at most `allowed`: where a lower degree suffices, the rounding
/// of the values is averaged over many of them.
pub(super) fn truncate(series: &mut Grid, allowed: f64) {
    let mut sum = 0.0;
    for degree in (1..COUNT).rev() {
        let terms = |series: &Grid| -> f64 {
            (0..=degree)
                .map(|k| {
                    let corner = if k == degree {
                        0.0
                    } else {
                        series[k][degree].abs()
                    };
                    series[degree][k].abs() + corner
                })
                .sum()
        };
        sum += terms(series);
        if sum.is_nan() || sum > allowed {
            return;
        }
        series[degree][..=degree].fill(0.0);
        for row in &mut series[..=degree] {
            row[degree] = 0.0;
        }
    }
}

/// Returns the value of Σ c[j][i] X^i Y^j.
pub(super) fn value(powers: &Grid, [x, y]: [f64; 2]) -> f64 {
    powers.iter().rev().fold(0.0, |sum, row| {
        sum * y + row.iter().rev().fold(0.0, |s, c| s * x + c)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_the_degree_are_met_everywhere() {
        let fit = Fit::new();
        let f = |x: f64, y: f64| (1.0 + x - 0.3 * y).powi(DEGREE as i32) - 2.0 * x * y * y;
        let values = fit.nodes.map(|y| fit.nodes.map(|x| f(x, y)));
        let powers = fit.powers(&fit.series(&values));
        for (x, y) in [(-1.0, 1.0), (0.3, -0.2), (0.99, 0.5), (0.0, 0.0)] {
            // Total degree and degree in each variable differ: only the latter is met exactly.
            let off = value(&powers, [x, y]) - f(x, y);
            assert!(off.abs() < 1e-12, "{off} at {x}, {y}");
        }
    }

    #[test]
    fn what_is_linear_but_for_rounding_becomes_linear() {
        let fit = Fit::new();
        let mut n = 0_u32;
        let values = fit.nodes.map(|y| {
            fit.nodes.map(|x| {
                n = n.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                3.0 + 2.0 * x - y + 1e-3 * (f64::from(n) / f64::from(u32::MAX) - 0.5)
            })
        });
        let mut series = fit.series(&values);
        truncate(&mut series, 0.01);
        let powers = fit.powers(&series);
        let high = powers.iter().enumerate().flat_map(|(j, row)| {
            let high = move |&(i, _): &(usize, &f64)| i > 1 || j > 1;
            row.iter().enumerate().filter(high).map(|(_, c)| *c)
        });
        assert!(high.into_iter().all(|c| c == 0.0));
        assert!((value(&powers, [0.5, 0.5]) - 3.5).abs() < 3e-4);
    }
}
