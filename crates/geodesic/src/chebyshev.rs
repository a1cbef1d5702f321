//! Functions of one variable as Chebyshev series. In: a function on an interval. Out: its integral, values and
//! derivatives.
//!
//! The sums over the zeros of T_n, integrals, derivatives and Clenshaw's recurrence follow Press, Teukolsky, Vetterling,
//! Flannery, *Numerical Recipes*, 3rd edition, sections 5.8 and 5.9. A picture's patches have a fixed degree in two variables
//! and use tables instead: `piecewise/fit.rs`.

#![allow(clippy::needless_range_loop)] // Several arrays are traversed together, lane by lane.

use std::array::from_fn;
use std::f64::consts::PI;

/// Σ cₙ Tₙ, over an interval mapped to [−1, 1].
#[derive(Clone, Debug)]
pub(crate) struct ChebyshevSeries {
    interval: [f64; 2],
    /// The coefficients from degree 0 up; at least one.
    coefficients: Vec<f64>,
}

/// The numbers of terms that are tried, each a multiple of [`LAST`].
const TERMS: [usize; 4] = [16, 32, 64, 128];
/// The last 1/`LAST` of a series' terms, the highest degrees, estimate its error.
const LAST: usize = 4;

impl ChebyshevSeries {
    /// Fits a series of at most `most` terms whose last quarter is below `tail` times its largest term. Returns `None`
    /// if there is no such series, or a value is not finite.
    pub(crate) fn fit(
        interval: [f64; 2],
        most: usize,
        tail: f64,
        mut function: impl FnMut(f64) -> Option<f64>,
    ) -> Option<Self> {
        let [middle, half] = middle_and_half(interval);
        for terms in TERMS.into_iter().filter(|terms| *terms <= most) {
            let cosines: Vec<f64> = (0..4 * terms)
                .map(|n| (PI * n as f64 / (2 * terms) as f64).cos())
                .collect();
            let mut values = Vec::with_capacity(terms);
            for k in 0..terms {
                let value = function(middle + half * cosines[2 * k + 1])?;
                values.push(Some(value).filter(|x| x.is_finite())?);
            }
            let coefficient = |n: usize| -> f64 {
                let sum: f64 = (values.iter().enumerate())
                    .map(|(k, x)| x * cosines[n * (2 * k + 1) % (4 * terms)])
                    .sum();
                sum * if n == 0 { 1.0 } else { 2.0 } / terms as f64
            };
            let mut coefficients: Vec<f64> = (0..terms).map(coefficient).collect();
            let largest = largest(&coefficients);
            if largest > 0.0
                && self::largest(&coefficients[terms - terms / LAST..]) < tail * largest
            {
                // Smaller terms are rounding, which the derivatives would amplify.
                let least = 0.5 * f64::EPSILON * largest;
                while coefficients.last().is_some_and(|c| c.abs() <= least) {
                    coefficients.pop();
                }
                return Some(Self {
                    interval,
                    coefficients,
                });
            }
        }
        None
    }

    /// Returns the integral from the interval's minimum.
    pub(crate) fn integral(&self) -> Self {
        let [_, half] = middle_and_half(self.interval);
        let count = self.coefficients.len();
        let at = |n: usize| self.coefficients.get(n).copied().unwrap_or(0.0);
        let mut coefficients = vec![0.0; count + 1];
        for n in 1..=count {
            let below = if n == 1 { 2.0 * at(0) } else { at(n - 1) };
            coefficients[n] = half * (below - at(n + 1)) / (2 * n) as f64;
        }
        // Tₙ(−1) = (−1)ⁿ.
        let low: f64 = (1..=count)
            .map(|n| if n % 2 == 0 { 1.0 } else { -1.0 } * coefficients[n])
            .sum();
        coefficients[0] = -low;
        Self {
            interval: self.interval,
            coefficients,
        }
    }

    pub(crate) fn derivative(&self) -> Self {
        let [_, half] = middle_and_half(self.interval);
        let count = self.coefficients.len();
        let mut coefficients = vec![0.0; (count - 1).max(1)];
        for n in (1..count).rev() {
            let above = coefficients.get(n + 1).copied().unwrap_or(0.0);
            coefficients[n - 1] = above + (2 * n) as f64 / half * self.coefficients[n];
        }
        coefficients[0] *= 0.5;
        Self {
            interval: self.interval,
            coefficients,
        }
    }

    /// Returns `scale` times the series, plus `offset`.
    pub(crate) fn scaled(mut self, scale: f64, offset: f64) -> Self {
        for c in &mut self.coefficients {
            *c *= scale;
        }
        self.coefficients[0] += offset;
        self
    }

    pub(crate) fn value(&self, at: f64) -> f64 {
        let [middle, half] = middle_and_half(self.interval);
        let x = (at - middle) / half;
        let [mut next, mut after] = [0.0; 2];
        for &c in self.coefficients[1..].iter().rev() {
            let here = 2.0 * x * next + (c - after);
            after = next;
            next = here;
        }
        x * next - after + self.coefficients[0]
    }
}

/// Several series over one interval, evaluated together.
#[derive(Clone, Debug)]
pub(crate) struct SeriesGroup<const K: usize> {
    middle: f64,
    /// The reciprocal of half the interval's width.
    share: f64,
    /// The coefficients of all series from degree 0 up; at least one.
    terms: Vec<[f64; K]>,
}

impl<const K: usize> SeriesGroup<K> {
    pub(crate) fn of(series: [&ChebyshevSeries; K]) -> Self {
        let [middle, half] = middle_and_half(series[0].interval);
        let count = series.iter().map(|it| it.coefficients.len()).max();
        let term = |n: usize| series.map(|it| it.coefficients.get(n).copied().unwrap_or(0.0));
        Self {
            middle,
            share: 1.0 / half,
            terms: (0..count.unwrap_or(1)).map(term).collect(),
        }
    }

    /// Evaluates each series at several points side by side.
    #[inline(always)]
    pub(crate) fn values<const N: usize>(&self, at: &[f64; N]) -> [[f64; N]; K] {
        let x = at.map(|x| (x - self.middle) * self.share);
        let twice = x.map(|x| 2.0 * x);
        let [mut next, mut after] = [[[0.0; N]; K]; 2];
        for term in self.terms[1..].iter().rev() {
            for k in 0..K {
                for lane in 0..N {
                    let here = twice[lane] * next[k][lane] + (term[k] - after[k][lane]);
                    after[k][lane] = next[k][lane];
                    next[k][lane] = here;
                }
            }
        }
        let lowest = self.terms[0];
        from_fn(|k| from_fn(|lane| x[lane] * next[k][lane] - after[k][lane] + lowest[k]))
    }
}

fn middle_and_half([low, high]: [f64; 2]) -> [f64; 2] {
    [0.5 * (low + high), 0.5 * (high - low)]
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| most.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_integrals_and_derivatives_are_those_of_the_function() {
        let series =
            ChebyshevSeries::fit([0.5, 3.0], 64, 1e-14, |x| Some(x.sin())).expect("smooth");
        let (integral, both) = (
            series.integral(),
            SeriesGroup::of([&series, &series.derivative()]),
        );
        for x in [0.5, 0.7, 1.9, 3.0_f64] {
            assert!((series.value(x) - x.sin()).abs() < 1e-14);
            assert!((integral.value(x) - (0.5_f64.cos() - x.cos())).abs() < 1e-14);
            let [[value], [slope]] = both.values(&[x]);
            assert!((value - x.sin()).abs() < 1e-14);
            assert!((slope - x.cos()).abs() < 1e-12);
        }
    }

    #[test]
    fn functions_with_a_kink_or_a_gap_have_none() {
        assert!(ChebyshevSeries::fit([-1.0, 2.0], 128, 1e-13, |x| Some(x.abs())).is_none());
        assert!(ChebyshevSeries::fit([-1.0, 2.0], 128, 1e-13, |x| Some(x.sqrt())).is_none());
    }
}
