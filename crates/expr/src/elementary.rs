//! Elementary functions over lanes of f64, free of branches so that loops over them are vectorised.
//!
//! In: an array of numbers. Out: an array of values. Only additions, products, quotients and comparisons are used, none
//! of them fused, so that the bits are the same on every processor. Polynomials are minimax (Remez, relative to the
//! function), rounded to f64. Argument reduction follows Cody and Waite, *Software Manual for the Elementary
//! Functions*, 1980. The largest errors found over millions of arguments, in ulps of the true value: `sin`, `cos`,
//! `exp`, `log` 1, `sinh`, `cosh` 2, `tan`, `tanh`, `sech` 3. The sign of a zero is not preserved.
//!
//! Angles beyond [`LARGEST_ANGLE`] are passed to `std` lane by lane; so are the inverse trigonometric functions.

/// The largest angle, in absolute value, that is reduced here.
pub const LARGEST_ANGLE: f64 = 1e5;

/// 1.5·2⁵²: added to a number of moderate magnitude, it leaves the nearest integer in the lowest bits.
pub(crate) const ROUND: f64 = 6_755_399_441_055_744.0;

/// π/2 in three parts: the first two have 36 bits, so that their products with the number of quarter turns are exact.
const QUARTER: [f64; 3] = [
    1.5707963267923333,
    2.5633441515839558e-12,
    1.0562999066987428e-23,
];

/// (sin y − y)/y³ in y².
const SIN: [f64; 6] = [
    -0.1666666666666664,
    0.008333333333323662,
    -0.00019841269830144396,
    2.755731365185325e-06,
    -2.5050734571080193e-08,
    1.589471058223421e-10,
];

/// (cos y − 1 + y²/2)/y⁴ in y².
const COS: [f64; 6] = [
    0.04166666666666665,
    -0.001388888888888284,
    2.4801587294628004e-05,
    -2.7557315738613256e-07,
    2.0875897738680502e-09,
    -1.1367981880350472e-11,
];

/// ln 2 in two parts: the first has 40 bits, so that its product with an exponent is exact.
const LN_2: [f64; 2] = [0.6931471805592082, 7.371002565167799e-13];

/// (eʳ − 1 − r)/r².
const EXP: [f64; 11] = [
    0.5,
    0.16666666666666682,
    0.04166666666666613,
    0.008333333333317388,
    0.001388888888910686,
    0.0001984126989555058,
    2.4801586934713764e-05,
    2.7557235646084145e-06,
    2.7557579152594067e-07,
    2.5111780675801726e-08,
    2.0826708719221363e-09,
];

/// (2 artanh s − 2s)/s³ in s².
const LOG: [f64; 7] = [
    0.666666666666671,
    0.3999999999951953,
    0.285714287293653,
    0.22222199081413918,
    0.18183572083558244,
    0.1531314948261098,
    0.14810677229018768,
];

/// (sinh x − x)/x³ in x², for |x| ≤ 1.
const SINH: [f64; 7] = [
    0.16666666666666669,
    0.008333333333333174,
    0.00019841269841425354,
    2.7557319156695965e-06,
    2.5052123477359524e-08,
    1.6057217076490285e-10,
    7.760411617429788e-13,
];

/// Sine and cosine.
#[inline(always)]
pub fn sin_cos<const W: usize>(x: &[f64; W]) -> ([f64; W], [f64; W]) {
    let (mut sin, mut cos) = ([0.0; W], [0.0; W]);
    for lane in 0..W {
        (sin[lane], cos[lane]) = reduced_sin_cos(x[lane]);
    }
    if has_large_angle(x) {
        for lane in 0..W {
            if is_large_angle(x[lane]) {
                (sin[lane], cos[lane]) = x[lane].sin_cos();
            }
        }
    }
    (sin, cos)
}

/// Tangent.
#[inline(always)]
pub fn tan<const W: usize>(x: &[f64; W]) -> [f64; W] {
    let mut out = [0.0; W];
    for lane in 0..W {
        let (sin, cos) = reduced_sin_cos(x[lane]);
        out[lane] = sin / cos;
    }
    if has_large_angle(x) {
        for lane in 0..W {
            if is_large_angle(x[lane]) {
                out[lane] = x[lane].tan();
            }
        }
    }
    out
}

/// The exponential function.
#[inline(always)]
pub fn exp<const W: usize>(x: &[f64; W]) -> [f64; W] {
    each(x, |x| scaled_exp(x, 0.0))
}

/// Natural logarithm; undefined below zero, minus infinity at zero.
#[inline(always)]
pub fn log<const W: usize>(x: &[f64; W]) -> [f64; W] {
    each(x, ln)
}

/// Hyperbolic sine and cosine.
#[inline(always)]
pub fn sinh_cosh<const W: usize>(x: &[f64; W]) -> ([f64; W], [f64; W]) {
    let (mut sinh, mut cosh) = ([0.0; W], [0.0; W]);
    for lane in 0..W {
        (sinh[lane], cosh[lane]) = hyperbolic(x[lane]);
    }
    (sinh, cosh)
}

/// Hyperbolic tangent.
#[inline(always)]
pub fn tanh<const W: usize>(x: &[f64; W]) -> [f64; W] {
    each(x, |x| {
        // Beyond, the result is ±1, and the quotient of two infinities must be avoided.
        let x = clamp(x, 40.0);
        let (sinh, cosh) = hyperbolic(x);
        sinh / cosh
    })
}

/// Hyperbolic secant.
#[inline(always)]
pub fn sech<const W: usize>(x: &[f64; W]) -> [f64; W] {
    each(x, |x| 1.0 / hyperbolic(x).1)
}

#[inline(always)]
fn each<const W: usize>(x: &[f64; W], f: impl Fn(f64) -> f64) -> [f64; W] {
    let mut out = [0.0; W];
    for lane in 0..W {
        out[lane] = f(x[lane]);
    }
    out
}

/// False for NaN, which the reduction propagates, true for infinities.
#[inline(always)]
fn is_large_angle(x: f64) -> bool {
    x.abs() > LARGEST_ANGLE
}

#[inline(always)]
fn has_large_angle<const W: usize>(x: &[f64; W]) -> bool {
    let mut any = false;
    for &x in x {
        any |= is_large_angle(x);
    }
    any
}

/// Evaluates a polynomial, the constant first: even and odd powers separately by Horner's scheme in x², so that a
/// processor can compute both at a time.
#[inline(always)]
fn polynomial<const K: usize>(coefficients: &[f64; K], x: f64) -> f64 {
    let square = x * x;
    let mut even = coefficients[(K - 1) / 2 * 2];
    for k in (0..(K - 1) / 2).rev() {
        even = even * square + coefficients[2 * k];
    }
    let mut odd = coefficients[K / 2 * 2 - 1];
    for k in (0..K / 2 - 1).rev() {
        odd = odd * square + coefficients[2 * k + 1];
    }
    even + x * odd
}

#[inline(always)]
fn select(condition: bool, yes: f64, no: f64) -> f64 {
    if condition { yes } else { no }
}

/// Clamps to ±`limit`; NaN is unchanged.
#[inline(always)]
fn clamp(x: f64, limit: f64) -> f64 {
    let x = select(x > limit, limit, x);
    select(x < -limit, -limit, x)
}

/// Cody and Waite's reduction to |y| ≤ π/4, with the rounding error of y as the second result.
#[inline(always)]
fn reduced_sin_cos(x: f64) -> (f64, f64) {
    let turns = x * std::f64::consts::FRAC_2_PI + ROUND;
    let quadrant = turns.to_bits();
    let n = turns - ROUND;
    let first = x - n * QUARTER[0];
    let second = n * QUARTER[1];
    let high = first - second;
    let low = ((first - high) - second) - n * QUARTER[2];
    let y = high + low;
    let rest = (high - y) + low;

    let z = y * y;
    let cube = z * y;
    // sin (y + rest) ≈ sin y + rest (1 − y²/2), cos (y + rest) ≈ cos y − y·rest.
    let sin = y + (cube * polynomial(&SIN, z) + (rest - 0.5 * z * rest));
    let half = 0.5 * z;
    let most = 1.0 - half;
    let cos = most + (((1.0 - most) - half) + (z * z * polynomial(&COS, z) - y * rest));

    let odd = quadrant & 1 == 1;
    let (s, c) = (select(odd, cos, sin), select(odd, sin, cos));
    let sign_of_sin = (quadrant & 2) << 62;
    let sign_of_cos = (quadrant.wrapping_add(1) & 2) << 62;
    (
        f64::from_bits(s.to_bits() ^ sign_of_sin),
        f64::from_bits(c.to_bits() ^ sign_of_cos),
    )
}

/// eˣ·2^`doublings`.
#[inline(always)]
fn scaled_exp(x: f64, doublings: f64) -> f64 {
    // Far beyond both ends of the range: the scaling itself overflows or underflows.
    let x = clamp(x, 800.0);
    let k = (x * std::f64::consts::LOG2_E + ROUND) - ROUND;
    let high = x - k * LN_2[0];
    let low = k * LN_2[1];
    let r = high - low;
    let rest = (high - r) - low;
    let tail = r * r * polynomial(&EXP, r) + (rest + rest * r);
    let value = 1.0 + (r + tail);
    // In two factors, since 2^k itself may overflow or underflow.
    let k = k + doublings;
    let half = (0.5 * k + ROUND) - ROUND;
    value * power_of_two(half) * power_of_two(k - half)
}

/// 2^k for an integer |k| ≤ 1022.
#[inline(always)]
fn power_of_two(k: f64) -> f64 {
    let bits = (k + ROUND).to_bits();
    f64::from_bits(bits.wrapping_add(1023) << 52)
}

/// x = 2^k·m with m from √½ to √2, and ln m as a series in s = (m − 1)/(m + 1).
#[inline(always)]
fn ln(x: f64) -> f64 {
    const TWO_54: f64 = 18_014_398_509_481_984.0;
    /// The bits of √½.
    const LEAST: u64 = 0x3FE6_A09E_667F_3BCD;
    /// 2⁵²: or-ed onto the bits of a smaller integer, it yields the f64 of their sum.
    const TWO_52: f64 = 4_503_599_627_370_496.0;
    let subnormal = x < f64::MIN_POSITIVE;
    let normal = select(subnormal, x * TWO_54, x);
    // Shifted up by 2048 exponents, so that the difference is not negative.
    let moved = normal
        .to_bits()
        .wrapping_sub(LEAST)
        .wrapping_add(2048 << 52)
        >> 52;
    let exponent = f64::from_bits(moved | TWO_52.to_bits()) - (TWO_52 + 2048.0);
    let m = f64::from_bits(
        normal
            .to_bits()
            .wrapping_sub(moved.wrapping_sub(2048) << 52),
    );
    let k = exponent - select(subnormal, 54.0, 0.0);

    let f = m - 1.0;
    let s = f / (2.0 + f);
    let w = s * s;
    let half = 0.5 * f * f;
    let r = w * polynomial(&LOG, w);
    let value = k * LN_2[0] - ((half - (s * (half + r) + k * LN_2[1])) - f);

    let value = select(x == 0.0, f64::NEG_INFINITY, value);
    let value = select(x < 0.0, f64::NAN, value);
    // Infinity and NaN propagate.
    select(x < f64::INFINITY, value, x)
}

#[inline(always)]
fn hyperbolic(x: f64) -> (f64, f64) {
    let size = x.abs();
    // eˣ/2, so that nothing overflows before the result does.
    let half = scaled_exp(size, -1.0);
    let quarter = 0.25 / half;
    let z = x * x;
    let small = size + size * z * polynomial(&SINH, z);
    let large = half - quarter;
    let sinh = select(size < 1.0, small, large);
    (select(x < 0.0, -sinh, sinh), half + quarter)
}
