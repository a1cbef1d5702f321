//! The operations that `std` does not provide: powers, the annihilating product, the sign.
//!
//! In: numbers. Out: numbers. These are the definitions that shaders follow step by step.

/// The maximum absolute value of an exponent for which [`power`] multiplies. The rounding error of repeated squaring
/// grows with the exponent; beyond this the library's function is more accurate.
pub const LARGEST_INTEGER_POWER: i32 = 1024;

/// Returns x^n by repeated squaring from the lowest bit of |n| up, with the same multiplications in every evaluator.
/// 0^0 is 1; a negative exponent gives the reciprocal of the positive power.
#[inline]
pub fn integer_power(x: f64, n: i32) -> f64 {
    let mut remaining = n.unsigned_abs();
    let mut square = x;
    let mut result = 1.0;
    while remaining != 0 {
        if remaining & 1 == 1 {
            result *= square;
        }
        square *= square;
        remaining >>= 1;
    }
    if n < 0 { 1.0 / result } else { result }
}

/// [`integer_power`] in each lane.
pub(crate) fn integer_power_lanes<const N: usize>(x: &[f64; N], n: i32, out: &mut [f64; N]) {
    let mut remaining = n.unsigned_abs();
    let mut square = *x;
    *out = [1.0; N];
    while remaining != 0 {
        if remaining & 1 == 1 {
            for (result, square) in out.iter_mut().zip(&square) {
                *result *= square;
            }
        }
        for square in &mut square {
            *square *= *square;
        }
        remaining >>= 1;
    }
    if n < 0 {
        for result in out {
            *result = 1.0 / *result;
        }
    }
}

/// Returns x^y. For an integer exponent up to [`LARGEST_INTEGER_POWER`] in absolute value this is [`integer_power`], so
/// 0^0 is 1 and negative bases have powers; larger integers also accept negative bases. Other powers of a negative base
/// are undefined. In f32 the exponent is first rounded to f32, which represents every integer up to 2^24 and only even
/// ones beyond; shaders multiply for all of the former.
#[inline]
pub fn power(x: f64, y: f64) -> f64 {
    match small_integer(y) {
        Some(n) => integer_power(x, n),
        None => x.powf(y),
    }
}

/// The product that a zero first factor annihilates: 0 where `a` is 0, whatever `b` is. Derivative rules use it:
/// n·x^(n−1) is 0 for n = 0, even at x = 0.
#[inline(always)]
pub fn zmul(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a * b }
}

/// Returns −1, 0 or 1; 0 for both zeros, NaN for NaN.
#[inline(always)]
pub fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else if x == 0.0 {
        0.0
    } else {
        x
    }
}

/// Returns the smaller of two numbers, the first if they are equal; undefined if either is.
#[inline(always)]
pub fn least(a: f64, b: f64) -> f64 {
    if a <= b {
        a
    } else if b < a {
        b
    } else {
        a + b
    }
}

/// Returns the larger of two numbers, the first if they are equal; undefined if either is.
#[inline(always)]
pub fn greatest(a: f64, b: f64) -> f64 {
    if a >= b {
        a
    } else if b > a {
        b
    } else {
        a + b
    }
}

/// Returns 1 where a ≤ b, else 0; undefined if either is.
#[inline(always)]
pub fn at_most(a: f64, b: f64) -> f64 {
    if a <= b {
        1.0
    } else if b < a {
        0.0
    } else {
        a + b
    }
}

/// Returns the exponent with which [`power`] multiplies, if `y` is one.
#[inline]
pub(crate) fn small_integer(y: f64) -> Option<i32> {
    let is_small = y.abs() <= f64::from(LARGEST_INTEGER_POWER) && y == y.trunc();
    is_small.then_some(y as i32)
}
