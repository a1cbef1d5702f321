//! Functions of one number on intervals.
//!
//! Input: an interval. Output: the values of the function on it, widened by what the mathematical library may round.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::arithmetic::sign;
use crate::interval::{Interval, above, below};
use crate::ops::Unary;

/// The number of units in the last place by which values of the mathematical library are widened.
const ULPS: f64 = 4.0;

impl Interval {
    /// The value of an operation on one number.
    pub fn unary(op: Unary, x: Self) -> Self {
        let result = match op {
            Unary::Neg => return x.negative(),
            Unary::Abs => {
                let (least, most) = x.sizes();
                Self::exact(least, most)
            }
            Unary::Sign => Self::new(sign(x.lower), sign(x.upper)),
            Unary::Sin => x.wave(f64::sin, FRAC_PI_2),
            Unary::Cos => x.wave(f64::cos, 0.0),
            Unary::Tan => x.tangent(),
            Unary::Exp => x.rising(f64::exp).at_least(0.0),
            Unary::Sqrt => x.restricted(0.0, f64::INFINITY, |x| {
                let root = |x: f64| if x == 0.0 { x } else { x.sqrt().next_down() };
                Self::exact(root(x.lower).max(0.0), x.upper.sqrt().next_up())
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
            Unary::Tanh => {
                let y = x.rising(f64::tanh);
                Self::exact(y.lower.max(-1.0), y.upper.min(1.0))
            }
        };
        result.of([x, x])
    }

    /// The values of a function that rises.
    fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        Self::new(below(f(self.lower), ULPS), above(f(self.upper), ULPS))
    }

    fn at_least(self, least: f64) -> Self {
        Self::exact(self.lower.max(least), self.upper)
    }

    /// The values of a function that is defined from `least` to `most`.
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

    /// The values of a sine whose crests are at `crest` and every full turn from there.
    fn wave(self, f: impl Fn(f64) -> f64, crest: f64) -> Self {
        let short = self.width() < 2.0 * PI;
        if !short {
            return Self::new(-1.0, 1.0).partially(self.is_unbounded());
        }
        let (a, b) = (f(self.lower), f(self.upper));
        Self::new(
            if self.meets(crest + PI, 2.0 * PI) {
                -1.0
            } else {
                below(a.min(b), ULPS).max(-1.0)
            },
            if self.meets(crest, 2.0 * PI) {
                1.0
            } else {
                above(a.max(b), ULPS).min(1.0)
            },
        )
    }

    fn tangent(self) -> Self {
        if self.meets(FRAC_PI_2, PI) {
            return Self::WHOLE.partially(self.is_unbounded());
        }
        self.rising(f64::tan)
    }

    /// False only if no place + k·period, k an integer, lies in the interval.
    pub(super) fn meets(self, place: f64, period: f64) -> bool {
        let turns = |x: f64| (x - place) / period;
        let (from, to) = (turns(self.lower), turns(self.upper));
        let slack = 4.0 * f64::EPSILON * (1.0 + from.abs().max(to.abs()));
        // Also for NaN and infinities.
        let between = (from - slack).ceil() > to + slack;
        !between
    }
}
