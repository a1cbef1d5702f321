//! Values on an interval of a line, with their derivatives along it.
//!
//! In: for each input its values on an interval of t, and its derivatives by t. Out: the same for the operations. Where
//! a slope excludes 0 and the value is defined throughout, the function is continuous and strictly monotone: the slope
//! of a jump is the whole line.

use crate::interval::{Interval, Rules};
use crate::ops::{Binary, Unary};

/// Values and derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// The values.
    pub value: Interval,
    /// The derivatives, one-sided ones at kinks.
    pub slope: Interval,
}

impl Slope {
    /// A constant.
    pub fn constant(x: f64) -> Self {
        Self {
            value: Interval::point(x),
            slope: Interval::point(0.0),
        }
    }

    /// Returns `origin` + t·`direction` for t in `t`.
    pub fn line(origin: f64, direction: f64, t: Interval) -> Self {
        let step = t.product(Interval::point(direction));
        Self {
            value: Interval::point(origin).sum(step),
            slope: Interval::point(direction),
        }
    }

    /// Returns true if the function is defined, continuous and strictly monotone on the interval.
    pub fn is_monotone(self) -> bool {
        let steep = self.slope.lower > 0.0 || self.slope.upper < 0.0;
        steep && !self.slope.is_empty() && !self.value.partial && !self.value.is_empty()
    }

    fn is_constant(self) -> bool {
        self.slope.is_zero()
    }

    /// Returns the values and slopes of an operation on one number.
    pub fn unary(op: Unary, x: Self) -> Self {
        match op {
            Unary::Sin => return x.waves()[0],
            Unary::Cos => return x.waves()[1],
            _ => {}
        }
        let value = Interval::unary(op, x.value);
        if x.is_constant() {
            return Self {
                value,
                slope: x.slope,
            };
        }
        let jumps = match op {
            Unary::Tan => x
                .value
                .meets(std::f64::consts::FRAC_PI_2, std::f64::consts::PI),
            Unary::Sign => x.value.contains(0.0) && !x.value.is_zero(),
            _ => false,
        };
        if jumps {
            return Self {
                value,
                slope: Interval::WHOLE,
            };
        }
        let mut rules = Rules::default();
        let [operand, result] = [x.value, value].map(|interval| rules.name(interval));
        let [first, _] = op.slopes(&mut rules, operand, result);
        Self {
            value,
            slope: product(first.interval, x.slope),
        }
    }

    /// Returns sine and cosine, each of which determines the other's slope.
    pub(crate) fn waves(self) -> [Self; 2] {
        let [sine, cosine] = self.value.waves();
        let slope = |first: Interval| match self.is_constant() {
            true => self.slope,
            false => product(first, self.slope),
        };
        let slopes = [slope(cosine), slope(sine.negative())];
        [(sine, slopes[0]), (cosine, slopes[1])].map(|(value, slope)| Self { value, slope })
    }

    /// Returns the values and slopes of an operation on two numbers.
    pub fn binary(op: Binary, a: Self, b: Self) -> Self {
        let value = match op {
            Binary::Add => a.value.sum(b.value),
            Binary::Sub => a.value.sum(b.value.negative()),
            Binary::Mul => a.value.product(b.value),
            _ => Interval::binary(op, a.value, b.value),
        };
        if a.is_constant() && b.is_constant() {
            let slope = a.slope;
            return Self { value, slope };
        }
        let slope = match op {
            Binary::Add => a.slope.sum(b.slope),
            Binary::Sub => a.slope.sum(b.slope.negative()),
            Binary::Mul | Binary::Zmul => product(a.slope, b.value).sum(product(a.value, b.slope)),
            Binary::Div if b.value.contains(0.0) => Interval::WHOLE,
            Binary::Div => {
                let share = product(value, b.slope);
                let rest = Interval::binary(Binary::Sub, a.slope, share);
                Interval::binary(Binary::Div, rest, b.value)
            }
            Binary::Pow => power_slope(a, b, value),
            Binary::Min if a.value.upper <= b.value.lower => a.slope,
            Binary::Min if b.value.upper < a.value.lower => b.slope,
            Binary::Max if a.value.lower >= b.value.upper => a.slope,
            Binary::Max if b.value.lower > a.value.upper => b.slope,
            Binary::Min | Binary::Max => a.slope.union(b.slope),
            Binary::AtMost if value.lower == value.upper => Interval::point(0.0),
            Binary::AtMost => Interval::WHOLE,
        };
        Self { value, slope }
    }

    /// Returns a².
    pub fn square(self) -> Self {
        let slope = product(self.value, self.slope);
        Self {
            value: self.value.square(),
            slope: product(Interval::point(2.0), slope),
        }
    }

    /// Returns a^n, see [`crate::ops::integer_power`].
    pub fn integer_power(self, n: i32) -> Self {
        let value = self.value.integer_power(n);
        if n < 0 && self.value.contains(0.0) && !self.is_constant() {
            return Self {
                value,
                slope: Interval::WHOLE,
            };
        }
        let lower = match n.checked_sub(1) {
            Some(lower) => self.value.integer_power(lower),
            None => Interval::WHOLE,
        };
        let first = product(Interval::point(f64::from(n)), lower);
        Self {
            value,
            slope: product(first, self.slope),
        }
    }
}

/// Returns a product in which zero annihilates: a constant has no slope.
fn product(a: Interval, b: Interval) -> Interval {
    if a.is_zero() || b.is_zero() {
        return Interval::point(0.0);
    }
    a.product(b)
}

/// Returns b a^(b−1) a' + a^b log a b'.
fn power_slope(a: Slope, b: Slope, value: Interval) -> Interval {
    let integer =
        b.is_constant() && b.value.lower == b.value.upper && b.value.lower == b.value.lower.trunc();
    if a.value.lower <= 0.0 && !(integer && b.value.lower >= 0.0) {
        return Interval::WHOLE;
    }
    let less = Interval::binary(Binary::Sub, b.value, Interval::point(1.0));
    let lower = Interval::binary(Binary::Pow, a.value, less);
    let first = product(b.value, lower);
    let by_base = product(first, a.slope);
    let log = Interval::unary(Unary::Log, a.value);
    let growth = product(value, log);
    let by_exponent = product(growth, b.slope);
    Interval::binary(Binary::Add, by_base, by_exponent)
}
