//! Interval arithmetic, rounded outward.
//!
//! In: intervals of operands. Out: an interval that contains every value of the operation on them, in exact arithmetic
//! and in f64, and a flag that is set if it may be undefined. The functions of one number are in
//! `interval/functions.rs`, values with slopes along a line in `interval/slope.rs`, values near a linear function in
//! `interval/affine.rs`.
//!
//! Sums, products, quotients and roots, which f64 rounds correctly, are widened by one ulp; functions of the
//! mathematical library by four. The library `inari` has tighter bounds, but requires a processor of 2013 or newer to be
//! chosen at build time, and MPFR for the functions; `fidget` evaluates intervals in f32.
//!
//! A lower bound of 0 that is written −0 may be the value −0, whose reciprocal is −∞; +0 may not. For upper bounds the
//! signs are reversed.

use crate::ops::{Arithmetic, Binary, Operation, Unary};

mod affine;
mod functions;
mod slope;
pub use affine::Affine;
pub use slope::Slope;

/// All numbers from a lower to an upper bound, infinities included; empty if no value is defined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lower: f64,
    upper: f64,
    partial: bool,
}

/// Interval arithmetic as an [`Arithmetic`], in which the rules of the table of operations are evaluated.
#[derive(Debug, Default)]
struct Rules {
    names: u32,
}

/// An interval with an identity, so that the product of a number with itself is recognised as a square.
#[derive(Clone, Copy, Debug)]
struct Named {
    interval: Interval,
    name: u32,
}

impl Rules {
    fn name(&mut self, interval: Interval) -> Named {
        self.names += 1;
        let name = self.names;
        Named { interval, name }
    }
}

impl Interval {
    /// All numbers.
    pub const WHOLE: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        partial: false,
    };
    /// No number: undefined everywhere.
    pub const UNDEFINED: Self = Self {
        lower: f64::INFINITY,
        upper: f64::NEG_INFINITY,
        partial: true,
    };

    /// Returns the numbers from `lower` to `upper`; undefined if they are not in this order, or either is NaN.
    pub fn new(lower: f64, upper: f64) -> Self {
        if lower <= upper {
            Self::hull(lower, upper)
        } else {
            Self::UNDEFINED
        }
    }

    /// Returns one number; undefined if it is NaN.
    pub fn point(x: f64) -> Self {
        Self::new(x, x)
    }

    /// Returns the lower bound.
    pub fn lower(self) -> f64 {
        self.lower
    }

    /// Returns the upper bound.
    pub fn upper(self) -> f64 {
        self.upper
    }

    /// Returns true if it may be undefined somewhere.
    pub fn is_partial(self) -> bool {
        self.partial
    }

    /// Returns true if no value is defined.
    pub fn is_empty(self) -> bool {
        self.lower > self.upper
    }

    /// Returns true if the number is among its values; for NaN, if it may be undefined.
    pub fn contains(self, x: f64) -> bool {
        if x.is_nan() {
            self.partial
        } else {
            self.lower <= x && x <= self.upper
        }
    }

    /// Returns the difference of its bounds.
    pub fn width(self) -> f64 {
        self.upper - self.lower
    }

    /// Returns the smallest interval that contains both.
    pub fn union(self, other: Self) -> Self {
        Self {
            lower: lower_bound(f64::min, self.lower, other.lower),
            upper: upper_bound(f64::max, self.upper, other.upper),
            partial: self.partial || other.partial,
        }
    }

    /// Returns the values of any operation; for an operation on one number, `b` is ignored.
    pub fn operation(operation: Operation, a: Self, b: Self) -> Self {
        match operation {
            Operation::Unary(op) => Self::unary(op, a),
            Operation::Power(n) => a.integer_power(n),
            Operation::Binary(op) => Self::binary(op, a, b),
        }
    }

    /// Returns the values of an operation on two numbers.
    pub fn binary(op: Binary, a: Self, b: Self) -> Self {
        let result = match op {
            Binary::Add => a.plus(b),
            Binary::Sub => a.plus(b.negative()),
            Binary::Mul => a.times(b),
            Binary::Div => a.over(b),
            // A power may be defined where only one of its operands is, so the rule of `of` does not hold.
            Binary::Pow => return a.power(b).partially(a.partial || b.partial),
            Binary::Zmul => return a.annihilating(b),
            Binary::Min => Self::exact(
                lower_bound(f64::min, a.lower, b.lower),
                upper_bound(f64::min, a.upper, b.upper),
            ),
            Binary::Max => Self::exact(
                lower_bound(f64::max, a.lower, b.lower),
                upper_bound(f64::max, a.upper, b.upper),
            ),
            Binary::AtMost => Self::exact(
                if a.upper <= b.lower { 1.0 } else { 0.0 },
                if a.lower > b.upper { 0.0 } else { 1.0 },
            ),
        };
        result.of([a, b])
    }

    /// Returns a².
    pub fn square(self) -> Self {
        let (least, most) = self.sizes();
        let lower = if least == 0.0 {
            0.0
        } else {
            (least * least).next_down().max(0.0)
        };
        Self::exact(lower, (most * most).next_up()).of([self, self])
    }

    /// Returns a^n, see [`crate::ops::integer_power`].
    pub fn integer_power(self, n: i32) -> Self {
        let count = n.unsigned_abs();
        let positive = match count {
            0 => return Self::point(1.0),
            1 => self,
            2 => self.square(),
            _ => {
                // Each multiplication adds at most one rounding, in addition to those of its operands.
                let power = |x: f64| {
                    let mut power = 1.0;
                    let mut square = x;
                    let mut rest = count;
                    while rest != 0 {
                        if rest & 1 == 1 {
                            power *= square;
                        }
                        square *= square;
                        rest >>= 1;
                    }
                    power
                };
                let ulps = f64::from(count);
                if count.is_multiple_of(2) {
                    let (least, most) = self.sizes();
                    Self::exact(below(power(least), ulps).max(0.0), above(power(most), ulps))
                } else {
                    Self::exact(
                        below(power(self.lower), ulps),
                        above(power(self.upper), ulps),
                    )
                }
                .of([self, self])
            }
        };
        if n < 0 {
            Self::point(1.0).over(positive)
        } else {
            positive
        }
    }

    fn hull(lower: f64, upper: f64) -> Self {
        Self {
            // A zero bound may have either sign.
            lower: if lower == 0.0 { -0.0 } else { lower },
            upper: if upper == 0.0 { 0.0 } else { upper },
            partial: false,
        }
    }

    /// Returns the bounds unchanged, including the signs of zeros.
    fn exact(lower: f64, upper: f64) -> Self {
        Self {
            lower,
            upper,
            partial: false,
        }
    }

    fn partially(self, partial: bool) -> Self {
        Self {
            partial: self.partial || partial,
            ..self
        }
    }

    /// Returns the result of an operation on these operands: undefined where they are.
    #[inline]
    fn of(self, operands: [Self; 2]) -> Self {
        let [a, b] = operands;
        if a.is_empty() || b.is_empty() {
            return Self::UNDEFINED;
        }
        self.partially(a.partial || b.partial)
    }

    /// Returns the smallest and the largest absolute value.
    fn sizes(self) -> (f64, f64) {
        let (a, b) = (self.lower.abs(), self.upper.abs());
        let least = if self.contains(0.0) { 0.0 } else { a.min(b) };
        (least, a.max(b))
    }

    fn is_zero(self) -> bool {
        self.lower == 0.0 && self.upper == 0.0
    }

    fn is_unbounded(self) -> bool {
        self.lower == f64::NEG_INFINITY || self.upper == f64::INFINITY
    }

    fn negative(self) -> Self {
        Self {
            lower: -self.upper,
            upper: -self.lower,
            partial: self.partial,
        }
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        let opposed = |a: f64, b: f64| a.is_infinite() && b == -a;
        let lower = self.lower + other.lower;
        let upper = self.upper + other.upper;
        // A sum that is zero, or too small to be normal, is exact.
        let lower = if lower == 0.0 {
            lower
        } else {
            lower.next_down()
        };
        let upper = if upper == 0.0 { upper } else { upper.next_up() };
        Self::exact(
            if lower.is_nan() {
                f64::NEG_INFINITY
            } else {
                lower
            },
            if upper.is_nan() { f64::INFINITY } else { upper },
        )
        .partially(opposed(self.lower, other.upper) || opposed(self.upper, other.lower))
    }

    /// Returns the sum, undefined where an operand is.
    #[inline]
    fn sum(self, other: Self) -> Self {
        self.plus(other).of([self, other])
    }

    /// Returns the product, undefined where an operand is.
    #[inline]
    fn product(self, other: Self) -> Self {
        self.times(other).of([self, other])
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        let size = self.lower.abs() + self.upper.abs() + other.lower.abs() + other.upper.abs();
        let bounded = size < f64::INFINITY;
        if !bounded {
            return self.times_unbounded(other);
        }
        let [a, b, c, d] = [
            self.lower * other.lower,
            self.lower * other.upper,
            self.upper * other.lower,
            self.upper * other.upper,
        ];
        let least = |a: f64, b: f64| if a < b { a } else { b };
        let most = |a: f64, b: f64| if a > b { a } else { b };
        let lower = least(least(a, b), least(c, d));
        let upper = most(most(a, b), most(c, d));
        // A bound of 0 is exact if a factor is 0, and otherwise an underflow.
        let exact =
            (lower == 0.0 || upper == 0.0) && (self.has_zero_bound() || other.has_zero_bound());
        Self::hull(
            if lower == 0.0 && exact {
                lower
            } else {
                lower.next_down()
            },
            if upper == 0.0 && exact {
                upper
            } else {
                upper.next_up()
            },
        )
    }

    /// Returns the product where a bound is infinite, or too large for a sum.
    fn times_unbounded(self, other: Self) -> Self {
        // A zero annihilates even an infinite bound; that the product may be undefined there is recorded.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let [a, b] = [self.lower, self.upper].map(|x| [x, other.lower, other.upper]);
        let corners = [
            product(a[0], a[1]),
            product(a[0], a[2]),
            product(b[0], b[1]),
            product(b[0], b[2]),
        ];
        let least = |a: f64, b: f64| if a < b { a } else { b };
        let most = |a: f64, b: f64| if a > b { a } else { b };
        let lower = least(least(corners[0], corners[1]), least(corners[2], corners[3]));
        let upper = most(most(corners[0], corners[1]), most(corners[2], corners[3]));
        // A bound of 0 is exact if a factor is 0, and otherwise an underflow.
        let exact = self.has_zero_bound() || other.has_zero_bound();
        let lower = if lower == 0.0 && exact {
            lower
        } else {
            lower.next_down()
        };
        let upper = if upper == 0.0 && exact {
            upper
        } else {
            upper.next_up()
        };
        let infinite = |zero: Self, large: Self| large.is_unbounded() && zero.contains(0.0);
        Self::hull(lower, upper).partially(infinite(self, other) || infinite(other, self))
    }

    fn has_zero_bound(self) -> bool {
        self.lower == 0.0 || self.upper == 0.0
    }

    fn over(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::UNDEFINED;
        }
        let partial = self.partial || other.partial;
        let zero_over_zero = self.contains(0.0) && other.contains(0.0);
        let result = if self.is_zero() && !other.is_unbounded() {
            Self::hull(0.0, 0.0)
        } else if other.lower > 0.0 || other.lower == 0.0 && other.lower.is_sign_positive() {
            self.over_positive(other)
        } else if other.upper < 0.0 || other.upper == 0.0 && other.upper.is_sign_negative() {
            self.negative().over_positive(other.negative())
        } else {
            Self::WHOLE
        };
        let infinities = self.is_unbounded() && other.is_unbounded();
        result.partially(partial || zero_over_zero || infinities)
    }

    /// Returns the quotient by an interval that is positive, or +0.
    fn over_positive(self, other: Self) -> Self {
        let quotient = |a: f64, b: f64| match (a == 0.0, b == 0.0) {
            (true, _) => 0.0,
            (false, true) => a * f64::INFINITY,
            (false, false) => a / b,
        };
        let (mut lower, mut upper) = (f64::INFINITY, f64::NEG_INFINITY);
        for a in [self.lower, self.upper] {
            for b in [other.lower, other.upper] {
                let value = quotient(a, b);
                if value.is_nan() {
                    // ∞/∞: everything of this sign.
                    lower = lower.min(if a < 0.0 { f64::NEG_INFINITY } else { 0.0 });
                    upper = upper.max(if a < 0.0 { 0.0 } else { f64::INFINITY });
                } else {
                    let exact = a == 0.0;
                    lower = lower.min(if exact { value } else { value.next_down() });
                    upper = upper.max(if exact { value } else { value.next_up() });
                }
            }
        }
        Self::hull(lower, upper).partially(self.is_unbounded() && other.is_unbounded())
    }

    /// Returns the product that a zero first factor annihilates, see [`crate::ops::zmul`].
    fn annihilating(self, other: Self) -> Self {
        if self.is_zero() {
            return self;
        }
        let product = self.times(other).of([self, other]);
        if self.is_empty() || !self.contains(0.0) {
            return product;
        }
        let zero = Self::hull(0.0, 0.0);
        if product.is_empty() {
            return zero.partially(true);
        }
        product.union(zero)
    }

    /// Returns a^b, see [`crate::ops::power`].
    fn power(self, exponent: Self) -> Self {
        if self.is_empty() || exponent.is_empty() {
            // 1^y and x^0 are 1, whatever the other operand is.
            return Self::WHOLE.partially(true);
        }
        if exponent.lower == exponent.upper
            && let Some(n) = crate::ops::small_integer(exponent.lower)
        {
            return self.integer_power(n);
        }
        let positive = Self::exact(self.lower.max(0.0), self.upper);
        let mut result = Self::UNDEFINED;
        result.partial = false;
        if !positive.is_empty() {
            let (lower, upper) = positive.corner_powers(exponent);
            result = result.union(Self::exact(lower.max(0.0), upper));
        }
        if self.lower < 0.0 || self.lower == 0.0 && self.lower.is_sign_negative() {
            let sizes = Self::exact((-self.upper).max(0.0), -self.lower);
            if exponent.lower.ceil() <= exponent.upper {
                let (_, most) = sizes.corner_powers(exponent);
                result = result.union(Self::exact(-most, most));
            }
            result.partial |= self.lower < 0.0;
        }
        if self.lower == f64::NEG_INFINITY {
            // Any power of −∞ is treated as a power of ∞.
            result = result.union(Self::exact(0.0, f64::INFINITY));
        }
        result.partially(self.is_unbounded() || exponent.is_unbounded())
    }

    /// Returns the bounds of a^b for a ≥ 0: monotone in either operand, so attained at corners.
    fn corner_powers(self, exponent: Self) -> (f64, f64) {
        let (mut lower, mut upper) = (f64::INFINITY, f64::NEG_INFINITY);
        // Repeated multiplication rounds up to 2·1024 times.
        let multiplies = exponent.lower.ceil() <= exponent.upper;
        let ulps = if multiplies { 2048.0 } else { 8.0 };
        for a in [self.lower.abs(), self.upper] {
            for b in [exponent.lower, exponent.upper] {
                let value = a.powf(b);
                lower = lower.min(below(value, ulps));
                upper = upper.max(above(value, ulps));
            }
        }
        // Where the exponent passes 0 the power is 1; at the base 1 too.
        if exponent.contains(0.0) || self.contains(1.0) {
            (lower, upper) = (lower.min(1.0), upper.max(1.0));
        }
        (lower, upper)
    }
}

/// Returns the number lowered by `ulps` units in the last place.
fn below(x: f64, ulps: f64) -> f64 {
    if x.is_infinite() {
        return x.next_down();
    }
    (x - x.abs() * (ulps * f64::EPSILON)).next_down()
}

/// Returns the number raised by `ulps` units in the last place.
fn above(x: f64, ulps: f64) -> f64 {
    -below(-x, ulps)
}

impl Arithmetic for Rules {
    type Number = Named;

    fn constant(&mut self, value: f64) -> Named {
        self.name(Interval::point(value))
    }

    fn neg(&mut self, a: Named) -> Named {
        self.name(a.interval.negative())
    }

    fn add(&mut self, a: Named, b: Named) -> Named {
        self.name(Interval::binary(Binary::Add, a.interval, b.interval))
    }

    fn sub(&mut self, a: Named, b: Named) -> Named {
        self.name(Interval::binary(Binary::Sub, a.interval, b.interval))
    }

    fn mul(&mut self, a: Named, b: Named) -> Named {
        self.name(if a.name == b.name {
            a.interval.square()
        } else {
            Interval::binary(Binary::Mul, a.interval, b.interval)
        })
    }

    fn div(&mut self, a: Named, b: Named) -> Named {
        self.name(Interval::binary(Binary::Div, a.interval, b.interval))
    }

    fn at_most(&mut self, a: Named, b: Named) -> Named {
        self.name(Interval::binary(Binary::AtMost, a.interval, b.interval))
    }

    fn unary(&mut self, op: Unary, a: Named) -> Named {
        self.name(Interval::unary(op, a.interval))
    }
}

/// Returns one of two lower bounds. Of two zeros it is the negative one: the library may choose either.
#[inline]
fn lower_bound(choice: fn(f64, f64) -> f64, a: f64, b: f64) -> f64 {
    match a == 0.0 && b == 0.0 {
        true if a.is_sign_negative() => a,
        true => b,
        false => choice(a, b),
    }
}

/// Returns one of two upper bounds. Of two zeros it is the positive one.
#[inline]
fn upper_bound(choice: fn(f64, f64) -> f64, a: f64, b: f64) -> f64 {
    match a == 0.0 && b == 0.0 {
        true if a.is_sign_positive() => a,
        true => b,
        false => choice(a, b),
    }
}
