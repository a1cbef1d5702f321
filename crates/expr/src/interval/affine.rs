//! Values on a rectangle, near a linear function of its two coordinates.
//!
//! Input: for each input its range, or the coordinate that it is. Output: for the operations an interval of values, and a
//! linear function with the most by which values differ from it. Operands that depend on the same coordinate do not widen
//! the result in the first order, as they do in intervals alone: the error shrinks by the square of the rectangle's size
//! (J. Stolfi, L. H. de Figueiredo, *Self-Validated Numerical Methods and Applications*, 1997, §3).

use crate::interval::{Interval, Rules};
use crate::ops::{Binary, Unary};

/// Values in an interval, each near middle + a·x + b·y where x and y go from −1 to 1 on the rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    value: Interval,
    middle: f64,
    slopes: [f64; 2],
    /// The most by which a value differs from the linear function.
    error: f64,
}

/// More than the share by which the operations of one step are rounded, and those of the mathematical library.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

impl Affine {
    /// A constant.
    pub fn constant(x: f64) -> Self {
        Self {
            value: Interval::point(x),
            middle: x,
            slopes: [0.0; 2],
            error: if x.is_finite() { 0.0 } else { f64::INFINITY },
        }
    }

    /// The numbers from `a` to `b`, as the first or the second coordinate of the rectangle.
    pub fn coordinate(k: usize, [a, b]: [f64; 2]) -> Self {
        let mut slopes = [0.0; 2];
        slopes[k] = 0.5 * (b - a);
        let size = a.abs() + b.abs();
        Self::new(Interval::new(a, b), 0.5 * (a + b), slopes, 0.0, size)
    }

    /// The interval of the values.
    pub fn value(&self) -> Interval {
        self.value
    }

    /// The value of the linear function in the middle of the rectangle.
    pub fn middle(&self) -> f64 {
        self.middle
    }

    /// The linear function's change from the middle to the greatest x, and to the greatest y.
    pub fn slopes(&self) -> [f64; 2] {
        self.slopes
    }

    /// The most by which a value differs from the linear function where it is defined; infinite if nothing is known.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// With the error of rounding numbers whose sizes have this sum.
    fn new(value: Interval, middle: f64, slopes: [f64; 2], error: f64, size: f64) -> Self {
        let error = error * (1.0 + ROUNDING) + ROUNDING * size + f64::MIN_POSITIVE;
        let spread = (slopes[0].abs() + slopes[1].abs() + error) * (1.0 + ROUNDING);
        let [lower, upper] = [(middle - spread).next_down(), (middle + spread).next_up()];
        let bounded = lower.is_finite() && upper.is_finite();
        if !bounded || value.is_empty() {
            return Self::within(value);
        }
        let mut value = value;
        if lower > value.lower {
            value.lower = if lower == 0.0 { -0.0 } else { lower };
        }
        if upper < value.upper {
            value.upper = if upper == 0.0 { 0.0 } else { upper };
        }
        if value.is_empty() {
            return Self::within(Interval::UNDEFINED);
        }
        let known = Self {
            value,
            middle,
            slopes,
            error,
        };
        let other = Self::within(value);
        if other.error < error { other } else { known }
    }

    /// The form of values of which only the interval is known.
    fn within(value: Interval) -> Self {
        let middle = 0.5 * value.lower + 0.5 * value.upper;
        let error = (value.upper - middle).max(middle - value.lower) * (1.0 + ROUNDING);
        let bounded = error >= 0.0 && error.is_finite();
        Self {
            value,
            middle: if bounded { middle } else { 0.0 },
            slopes: [0.0; 2],
            error: if bounded { error } else { f64::INFINITY },
        }
    }

    /// The most by which a value differs from the middle.
    fn spread(&self) -> f64 {
        self.slopes[0].abs() + self.slopes[1].abs() + self.error
    }

    /// The sum of the sizes of its numbers.
    fn size(&self) -> f64 {
        self.middle.abs() + self.spread()
    }

    /// True if the linear function tells of all values.
    fn is_sound(&self) -> bool {
        self.error < f64::INFINITY && !self.value.partial
    }

    fn negative(self) -> Self {
        Self {
            value: self.value.negative(),
            middle: -self.middle,
            slopes: self.slopes.map(|slope| -slope),
            error: self.error,
        }
    }

    /// The value of an operation on one number.
    pub fn unary(op: Unary, x: Self) -> Self {
        match op {
            Unary::Neg => return x.negative(),
            Unary::Abs if x.is_sound() && x.value.lower > 0.0 => return x,
            Unary::Abs if x.is_sound() && x.value.upper < 0.0 => return x.negative(),
            Unary::Sin => return x.waves()[0],
            Unary::Cos => return x.waves()[1],
            _ => {}
        }
        let value = Interval::unary(op, x.value);
        // These have no slope everywhere.
        if matches!(op, Unary::Abs | Unary::Sign) {
            return Self::within(value);
        }
        let slopes = |x: Interval, y: Interval| {
            let mut rules = Rules::default();
            let [x, y] = [x, y].map(|interval| rules.name(interval));
            op.slopes(&mut rules, x, y).map(|slope| slope.interval)
        };
        x.smooth(value, |x| Interval::unary(op, x), slopes)
    }

    /// Sine and cosine.
    pub(crate) fn waves(self) -> [Self; 2] {
        let values = self.value.waves();
        if !self.is_sound() {
            return values.map(Self::within);
        }
        let wide = self.hull();
        let [at, on] = [Interval::point(self.middle).waves(), wide.waves()];
        [
            self.expanded(values[0], [at[0], at[1], on[0].negative()]),
            self.expanded(values[1], [at[1], at[0].negative(), on[1].negative()]),
        ]
    }

    /// The values of a function with two derivatives, which `slopes` takes from operand and value.
    fn smooth(
        self,
        value: Interval,
        function: impl Fn(Interval) -> Interval,
        slopes: impl Fn(Interval, Interval) -> [Interval; 2],
    ) -> Self {
        if !self.is_sound() {
            return Self::within(value);
        }
        let point = Interval::point(self.middle);
        let at = function(point);
        let [first, _] = slopes(point, at);
        let wide = self.hull();
        let [_, second] = slopes(wide, function(wide));
        self.expanded(value, [at, first, second])
    }

    /// The values with the middle, in which they need not lie.
    fn hull(&self) -> Interval {
        self.value.union(Interval::point(self.middle))
    }

    /// f(m) + f'(m)(x − m) + ½f''(ξ)(x − m)², where the values are of f, and the terms lie in these intervals.
    fn expanded(self, value: Interval, [at, first, second]: [Interval; 3]) -> Self {
        let unsure = |of: Interval| of.partial || of.is_empty() || of.is_unbounded();
        if unsure(at) || unsure(first) || unsure(second) {
            return Self::within(value);
        }
        let middle = |of: Interval| 0.5 * of.lower + 0.5 * of.upper;
        let radius = |of: Interval| 0.5 * (of.upper - of.lower);
        let spread = self.spread();
        let square = 0.5 * spread * spread;
        let bend = [
            second.lower.min(0.0) * square,
            second.upper.max(0.0) * square,
        ];
        let slope = middle(first);
        let error = radius(at)
            + radius(first) * spread
            + slope.abs() * self.error
            + 0.5 * (bend[1] - bend[0]);
        let size = at.lower.abs().max(at.upper.abs())
            + first.lower.abs().max(first.upper.abs()) * self.size()
            + bend[1]
            - bend[0];
        let centre = middle(at) + 0.5 * (bend[0] + bend[1]);
        let slopes = self.slopes.map(|side| slope * side);
        Self::new(value, centre, slopes, error, size)
    }

    /// The value of an operation on two numbers.
    pub fn binary(op: Binary, a: Self, b: Self) -> Self {
        let value = Interval::binary(op, a.value, b.value);
        if !(a.is_sound() && b.is_sound()) {
            return Self::within(value);
        }
        match op {
            Binary::Add => Self::sum(value, a, b),
            Binary::Sub => Self::sum(value, a, b.negative()),
            Binary::Mul | Binary::Zmul => Self::product(value, a, b),
            Binary::Div => {
                let one = Self::constant(1.0);
                let reciprocal = |x| Interval::binary(Binary::Div, one.value, x);
                let inverse = b.smooth(reciprocal(b.value), reciprocal, |_, y| {
                    let square = y.square();
                    let twice = Interval::point(2.0).product(square.product(y));
                    [square.negative(), twice]
                });
                if !inverse.is_sound() {
                    return Self::within(value);
                }
                Self::product(value, a, inverse)
            }
            Binary::Pow => a.power(value, b),
            Binary::Min | Binary::Max => {
                let difference = Self::binary(Binary::Sub, a, b).value;
                let chosen = if difference.lower > 0.0 {
                    [b, a]
                } else if difference.upper < 0.0 {
                    [a, b]
                } else {
                    return Self::within(value);
                };
                chosen[usize::from(op == Binary::Max)]
            }
            Binary::AtMost => Self::within(value),
        }
    }

    fn sum(value: Interval, a: Self, b: Self) -> Self {
        let slopes = [0, 1].map(|k| a.slopes[k] + b.slopes[k]);
        let size = a.size() + b.size();
        Self::new(value, a.middle + b.middle, slopes, a.error + b.error, size)
    }

    fn product(value: Interval, a: Self, b: Self) -> Self {
        let [p, q] = [a.slopes, b.slopes];
        // x² and y² go from 0 to 1, x·y from −1 to 1.
        let squares = [p[0] * q[0], p[1] * q[1]];
        let mixed = p[0] * q[1] + p[1] * q[0];
        let middle = a.middle * b.middle + 0.5 * (squares[0] + squares[1]);
        let slopes = [0, 1].map(|k| a.middle * q[k] + b.middle * p[k]);
        let quadratic = 0.5 * (squares[0].abs() + squares[1].abs()) + mixed.abs();
        let error = quadratic + a.size() * b.error + a.error * (b.size() - b.error);
        Self::new(value, middle, slopes, error, a.size() * b.size())
    }

    /// a².
    pub fn square(self) -> Self {
        let value = self.value.square();
        if !self.is_sound() {
            return Self::within(value);
        }
        Self::product(value, self, self)
    }

    /// a^n, see [`crate::ops::integer_power`].
    pub fn integer_power(self, n: i32) -> Self {
        let value = self.value.integer_power(n);
        match n {
            1 => return self,
            2 => return self.square(),
            _ => {}
        }
        let (Some(less), Some(least)) = (n.checked_sub(1), n.checked_sub(2)) else {
            return Self::within(value);
        };
        let factor = f64::from(n);
        let factors = [factor, factor * f64::from(less)].map(Interval::point);
        self.smooth(
            value,
            |x| x.integer_power(n),
            |x, _| {
                let [first, second] = [less, least].map(|n| x.integer_power(n));
                [factors[0].product(first), factors[1].product(second)]
            },
        )
    }

    /// a^b, see [`crate::ops::power`].
    fn power(self, value: Interval, exponent: Self) -> Self {
        let b = exponent.value;
        if b.lower != b.upper {
            return Self::within(value);
        }
        if let Some(n) = crate::ops::small_integer(b.lower) {
            return self.integer_power(n);
        }
        if self.hull().lower <= 0.0 {
            return Self::within(value);
        }
        let less = Interval::binary(Binary::Sub, b, Interval::point(1.0));
        let least = Interval::binary(Binary::Sub, b, Interval::point(2.0));
        let power = |x, exponent| Interval::binary(Binary::Pow, x, exponent);
        self.smooth(
            value,
            |x| power(x, b),
            |x, _| {
                let first = b.product(power(x, less));
                [first, b.product(less).product(power(x, least))]
            },
        )
    }
}
