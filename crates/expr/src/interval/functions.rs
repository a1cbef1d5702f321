//! Functions of one number on intervals.
//!
//! In: an interval. Out: the values of the function on it, widened by the rounding of the mathematical library.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

use crate::arithmetic::sign;
use crate::interval::{Interval, above, below};
use crate::ops::Unary;

/// The number of ulps by which values of the mathematical library are widened.
const ULPS: f64 = 4.0;

impl Interval {
    /// Returns the values of an operation on one number.
    pub fn unary(op: Unary, x: Self) -> Self {
        let result = match op {
            Unary::Neg => return x.negative(),
            Unary::Abs => {
                let (least, most) = x.sizes();
                Self::exact(least, most)
            }
            Unary::Sign => Self::new(sign(x.lower), sign(x.upper)),
            Unary::Sin => x.waves()[0],
            Unary::Cos => x.waves()[1],
            Unary::Tan => x.tangent(),
            Unary::Exp => x.rising(f64::exp).at_least(0.0),
            // The root of −0, which is in every interval that extends below zero, is −0.
            Unary::Sqrt => x.restricted(-0.0, f64::INFINITY, |x| {
                let root = |x: f64| if x == 0.0 { x } else { x.sqrt().next_down() };
                Self::exact(root(x.lower), x.upper.sqrt().next_up())
            }),
            Unary::Log => x.restricted(0.0, f64::INFINITY, |x| {
                let lower = if x.lower == 0.0 {
                    f64::NEG_INFINITY
                } else {
                    below(x.lower.ln(), ULPS)
                };
                Self::new(lower, above(x.upper.ln(), ULPS))
            }),
            Unary::Asin => x.restricted(-1.0, 1.0, |x| x.rising(f64::asin)),
            Unary::Acos => x.restricted(-1.0, 1.0, |x| {
                let lower = below(x.upper.acos(), ULPS);
                Self::new(lower, above(x.lower.acos(), ULPS)).at_least(0.0)
            }),
            Unary::Atan => x.rising(f64::atan),
            Unary::Sinh => x.rising(f64::sinh),
            Unary::Cosh => {
                let (least, most) = x.sizes();
                Self::new(below(least.cosh(), ULPS), above(most.cosh(), ULPS)).at_least(1.0)
            }
            Unary::Sech => {
                let (least, most) = x.sizes();
                let sech = |x: f64| Unary::Sech.eval(x);
                let y = Self::new(below(sech(most), ULPS), above(sech(least), ULPS));
                Self::exact(y.lower.max(0.0), y.upper.min(1.0))
            }
            Unary::Tanh => {
                let y = x.rising(f64::tanh);
                Self::exact(y.lower.max(-1.0), y.upper.min(1.0))
            }
        };
        result.of([x, x])
    }

    /// Returns the values of an increasing function.
    fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        Self::new(below(f(self.lower), ULPS), above(f(self.upper), ULPS))
    }

    fn at_least(self, least: f64) -> Self {
        Self::exact(self.lower.max(least), self.upper)
    }

    /// Returns the values of a function that is defined from `least` to `most`.
    fn restricted(self, least: f64, most: f64, f: impl Fn(Self) -> Self) -> Self {
        let domain = Self::exact(
            if self.lower < least {
                least
            } else {
                self.lower
            },
            if self.upper > most { most } else { self.upper },
        );
        if domain.is_empty() {
            return Self::UNDEFINED;
        }
        f(domain).partially(self.lower < least || self.upper > most)
    }

    /// Returns the values of sine and cosine.
    pub(crate) fn waves(self) -> [Self; 2] {
        if self.is_empty() {
            return [Self::UNDEFINED; 2];
        }
        let all = Self::exact(-1.0, 1.0).partially(self.partial);
        let short = self.width() < 2.0 * PI;
        if !short {
            return [all.partially(self.is_unbounded()); 2];
        }
        // In quarter turns, the sine has its maxima at 1 + 4k and its minima at 3 + 4k, the cosine at 4k and 2 + 4k.
        let [from, to] = [self.lower, self.upper].map(|x| x * FRAC_2_PI);
        let slack = 4.0 * f64::EPSILON * (1.0 + from.abs().max(to.abs()));
        let (from, to) = (from - slack, to + slack);
        let precise = slack < 0.25;
        if !precise {
            return [all; 2];
        }
        let first = {
            let below = from as i64;
            below + i64::from((below as f64) < from)
        };
        let mut passed = [false; 4];
        let mut quarter = first;
        while quarter as f64 <= to {
            passed[(quarter & 3) as usize] = true;
            quarter += 1;
        }
        let (a, b) = (self.lower.sin_cos(), self.upper.sin_cos());
        let wave = |a: f64, b: f64, crest: bool, trough: bool| {
            Self::exact(
                if trough {
                    -1.0
                } else {
                    below(a.min(b), ULPS).max(-1.0)
                },
                if crest {
                    1.0
                } else {
                    above(a.max(b), ULPS).min(1.0)
                },
            )
            .partially(self.partial)
        };
        [
            wave(a.0, b.0, passed[1], passed[3]),
            wave(a.1, b.1, passed[0], passed[2]),
        ]
    }

    fn tangent(self) -> Self {
        if self.meets(FRAC_PI_2, PI) {
            return Self::WHOLE.partially(self.is_unbounded());
        }
        self.rising(f64::tan)
    }

    /// Returns false only if no `place` + k·period, k an integer, is in the interval.
    pub(super) fn meets(self, place: f64, period: f64) -> bool {
        let turns = |x: f64| (x - place) / period;
        let (from, to) = (turns(self.lower), turns(self.upper));
        let slack = 4.0 * f64::EPSILON * (1.0 + from.abs().max(to.abs()));
        // Also true for NaN and infinities.
        let between = (from - slack).ceil() > to + slack;
        !between
    }
}
