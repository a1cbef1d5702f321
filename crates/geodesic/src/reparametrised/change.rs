//! A change of one parameter. In: a density on its interval. Out: the parameter in which equal steps contain equal shares
//! of it.

use std::array::from_fn;

use expr::processor::{Processor, Work};

use crate::chebyshev::{ChebyshevSeries, SeriesGroup};
use crate::surface::{LANES, Lanes};

/// u = ψ(w), an increasing map of an interval to itself, smooth inside; beyond, ψ(w + n width) = ψ(w) + n width.
#[derive(Clone, Debug)]
pub(super) struct ParameterChange {
    interval: [f64; 2],
    /// ψ.
    forward: SeriesGroup<1>,
    /// ψ⁻¹.
    inverse: ChebyshevSeries,
    /// The first and second derivatives of ψ⁻¹. Those of ψ follow from them, with more digits at the ends than its own
    /// series has.
    rates: SeriesGroup<2>,
}

/// The maximum number of terms of the density and of ψ.
const OF_DENSITY: usize = 128;
const OF_CHANGE: usize = 64;
/// The size that the last terms of the density and of ψ may have, relative to the largest. The terms of the density's
/// integral are much smaller.
const DENSITY_TAIL: f64 = 1e-13;
const CHANGE_TAIL: f64 = 1e-14;
/// The maximum number of steps to a point with a given share of the integral.
const STEPS: usize = 60;

impl ParameterChange {
    /// Creates the change with ψ' = c / `density`(ψ). `None` where the density is not positive, or either has no
    /// series.
    pub(super) fn of_density(
        interval: [f64; 2],
        mut density: impl FnMut(f64) -> f64,
    ) -> Option<Self> {
        let [low, high] = interval;
        let positive = |x: f64| Some(density(x)).filter(|density| *density > 0.0);
        let density = ChebyshevSeries::fit(interval, OF_DENSITY, DENSITY_TAIL, positive)?;
        let integral = density.integral();
        let total = integral.value(high);
        let scale = (high - low) / total;
        let rate = density.scaled(scale, 0.0);
        let inverse = integral.scaled(scale, low);
        let mut guess = high;
        let forward = ChebyshevSeries::fit(interval, OF_CHANGE, CHANGE_TAIL, |w| {
            guess = solve(interval, guess, |u| [inverse.value(u) - w, rate.value(u)])?;
            Some(guess)
        })?;
        Some(Self {
            interval,
            forward: SeriesGroup::of([&forward]),
            inverse,
            rates: SeriesGroup::of([&rate, &rate.derivative()]),
        })
    }

    /// Returns ψ, ψ' and ψ'' at a point that may be beyond the interval.
    pub(super) fn forward(&self, w: f64) -> [f64; 3] {
        self.several(&[w]).map(|[value]| value)
    }

    /// The same at several points.
    pub(super) fn forward_all(&self, w: &Lanes) -> [Lanes; 3] {
        Processor::here().run(Several { change: self, w })
    }

    #[inline(always)]
    fn several<const N: usize>(&self, w: &[f64; N]) -> [[f64; N]; 3] {
        let [low, high] = self.interval;
        let turns = w.map(|w| self.turns(w));
        let inside: [f64; N] = from_fn(|lane| w[lane] - turns[lane]);
        let [value] = self.forward.values(&inside);
        let value = value.map(|u| u.clamp(low, high));
        let [rate, slope] = self.rates.values(&value);
        let first = rate.map(|rate| 1.0 / rate);
        [
            from_fn(|lane| value[lane] + turns[lane]),
            first,
            from_fn(|lane| -slope[lane] * first[lane] * first[lane] * first[lane]),
        ]
    }

    /// Returns the point of the interval, or beyond it, with the given ψ.
    pub(super) fn inverse(&self, u: f64) -> f64 {
        let [low, high] = self.interval;
        let turns = self.turns(u);
        let u = u - turns;
        if u == low || u == high {
            return u + turns;
        }
        let mut w = self.inverse.value(u).clamp(low, high);
        for _ in 0..2 {
            let [value, slope, _] = self.forward(w);
            w = (w + (u - value) / slope).clamp(low, high);
        }
        w + turns
    }

    /// Returns the distance of a point beyond the interval, in whole widths; NaN for NaN.
    #[inline(always)]
    fn turns(&self, x: f64) -> f64 {
        let [low, high] = self.interval;
        if (low..=high).contains(&x) {
            0.0
        } else {
            ((x - low) / (high - low)).floor() * (high - low)
        }
    }
}

/// The values at several lanes, compiled for the processor's vector instructions.
struct Several<'a> {
    change: &'a ParameterChange,
    w: &'a Lanes,
}

impl Work for Several<'_> {
    type Output = [Lanes; 3];

    #[inline(always)]
    fn run(self) -> [Lanes; 3] {
        self.change.several::<LANES>(self.w)
    }
}

/// Returns the zero of an increasing function, given with its derivative, by bracketed Newton's method.
fn solve(
    [mut low, mut high]: [f64; 2],
    guess: f64,
    function: impl Fn(f64) -> [f64; 2],
) -> Option<f64> {
    let rounding = f64::EPSILON * low.abs().max(high.abs()).max(high - low);
    let mut at = guess;
    for _ in 0..STEPS {
        let [value, slope] = function(at);
        if value > 0.0 {
            high = at;
        } else {
            low = at;
        }
        let step = value / slope;
        let next = at - step;
        at = if next > low && next < high {
            next
        } else if step.abs() <= rounding {
            return Some(at);
        } else {
            0.5 * (low + high)
        };
        if step.abs() <= rounding || high - low <= rounding {
            return Some(at);
        }
    }
    None
}
