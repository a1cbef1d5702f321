//! The functions of [`expr::elementary`] in f32: shorter polynomials, no rounding errors carried along.
//!
//! Greatest errors found, in units in the last place of the true value: `sin`, `cos`, `exp`, `log` 2, `sinh`, `cosh`,
//! `tan`, `tanh` 4. Angles beyond [`LARGEST_ANGLE`] are handed to `std` lane by lane.

/// The largest angle, in absolute value, that is reduced here.
pub(super) const LARGEST_ANGLE: f32 = 300.0;

/// 1.5·2²³: added to a number of moderate size, it leaves its nearest integer in the lowest bits.
const ROUND: f32 = 12_582_912.0;

/// π/2 in three parts: the first two have 11 bits, so that their products with a quarter turn's number are exact.
const QUARTER: [f32; 3] = [1.570_312_5, 0.000_483_751_3, 7.549_79e-8];

/// (sin y − y)/y³ in y².
const SIN: [f32; 3] = [-0.166_666_55, 0.008_332_18, -0.000_195_17];

/// (cos y − 1 + y²/2)/y⁴ in y².
const COS: [f32; 3] = [0.041_666_646, -0.001_388_731_3, 2.443_278_3e-5];

/// ln 2 in two parts: the first has 14 bits, so that its product with an exponent is exact.
const LN_2: [f32; 2] = [0.693_115_23, 3.194_618_3e-5];

/// (eʳ − 1 − r)/r².
const EXP: [f32; 5] = [
    0.499_999_93,
    0.166_665_2,
    0.041_668_39,
    0.008_368_78,
    0.001_381_45,
];

/// (2 artanh s − 2s)/s³ in s².
const LOG: [f32; 3] = [0.666_667_8, 0.399_774_95, 0.298_730_77];

/// (sinh x − x)/x³ in x², up to x = 1.
const SINH: [f32; 4] = [0.166_666_67, 0.008_333_35, 0.000_198_360_66, 2.817_439_6e-6];

/// Sine and cosine.
#[inline(always)]
pub(super) fn sin_cos<const W: usize>(x: &[f32; W]) -> ([f32; W], [f32; W]) {
    let (mut sin, mut cos) = ([0.0; W], [0.0; W]);
    for lane in 0..W {
        (sin[lane], cos[lane]) = reduced_sin_cos(x[lane]);
    }
    if has_large_angle(x) {
        for lane in 0..W {
            if x[lane].abs() > LARGEST_ANGLE {
                (sin[lane], cos[lane]) = x[lane].sin_cos();
            }
        }
    }
    (sin, cos)
}

/// Tangent.
#[inline(always)]
pub(super) fn tan<const W: usize>(x: &[f32; W]) -> [f32; W] {
    let (sin, cos) = sin_cos(x);
    let mut out = [0.0; W];
    for lane in 0..W {
        out[lane] = sin[lane] / cos[lane];
    }
    out
}

/// The exponential function.
#[inline(always)]
pub(super) fn exp<const W: usize>(x: &[f32; W]) -> [f32; W] {
    each(x, |x| scaled_exp(x, 0.0))
}

/// Natural logarithm; undefined below zero, minus infinity at zero.
#[inline(always)]
pub(super) fn log<const W: usize>(x: &[f32; W]) -> [f32; W] {
    each(x, ln)
}

/// Hyperbolic sine and cosine.
#[inline(always)]
pub(super) fn sinh_cosh<const W: usize>(x: &[f32; W]) -> ([f32; W], [f32; W]) {
    let (mut sinh, mut cosh) = ([0.0; W], [0.0; W]);
    for lane in 0..W {
        (sinh[lane], cosh[lane]) = hyperbolic(x[lane]);
    }
    (sinh, cosh)
}

/// Hyperbolic tangent.
#[inline(always)]
pub(super) fn tanh<const W: usize>(x: &[f32; W]) -> [f32; W] {
    each(x, |x| {
        // Beyond, the tangent is ±1.
        let (sinh, cosh) = hyperbolic(clamp(x, 20.0));
        sinh / cosh
    })
}

#[inline(always)]
fn each<const W: usize>(x: &[f32; W], f: impl Fn(f32) -> f32) -> [f32; W] {
    let mut out = [0.0; W];
    for lane in 0..W {
        out[lane] = f(x[lane]);
    }
    out
}

/// A polynomial, the constant first: even and odd powers by Horner's scheme in x², so that a processor can work on
/// both at a time.
#[inline(always)]
fn polynomial<const K: usize>(coefficients: &[f32; K], x: f32) -> f32 {
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
fn select(condition: bool, yes: f32, no: f32) -> f32 {
    if condition { yes } else { no }
}

/// Within ±`limit`; NaN stays.
#[inline(always)]
fn clamp(x: f32, limit: f32) -> f32 {
    let x = select(x > limit, limit, x);
    select(x < -limit, -limit, x)
}

#[inline(always)]
fn has_large_angle<const W: usize>(x: &[f32; W]) -> bool {
    let mut any = false;
    for &x in x {
        any |= x.abs() > LARGEST_ANGLE;
    }
    any
}

/// Cody and Waite's reduction to |y| ≤ π/4.
#[inline(always)]
fn reduced_sin_cos(x: f32) -> (f32, f32) {
    let turns = x * std::f32::consts::FRAC_2_PI + ROUND;
    let quadrant = turns.to_bits();
    let n = turns - ROUND;
    let y = ((x - n * QUARTER[0]) - n * QUARTER[1]) - n * QUARTER[2];

    let z = y * y;
    let sin = y + z * y * polynomial(&SIN, z);
    let cos = (1.0 - 0.5 * z) + z * z * polynomial(&COS, z);

    let odd = quadrant & 1 == 1;
    let (s, c) = (select(odd, cos, sin), select(odd, sin, cos));
    let sign_of_sin = (quadrant & 2) << 30;
    let sign_of_cos = (quadrant.wrapping_add(1) & 2) << 30;
    (
        f32::from_bits(s.to_bits() ^ sign_of_sin),
        f32::from_bits(c.to_bits() ^ sign_of_cos),
    )
}

/// eˣ·2^`doublings`.
#[inline(always)]
fn scaled_exp(x: f32, doublings: f32) -> f32 {
    // Far beyond both ends of the range: the scaling over- or underflows by itself.
    let x = clamp(x, 110.0);
    let k = (x * std::f32::consts::LOG2_E + ROUND) - ROUND;
    let r = (x - k * LN_2[0]) - k * LN_2[1];
    let value = 1.0 + (r + r * r * polynomial(&EXP, r));
    // In two factors, since 2^k itself may be out of range.
    let k = k + doublings;
    let half = (0.5 * k + ROUND) - ROUND;
    value * power_of_two(half) * power_of_two(k - half)
}

/// 2^k for an integer |k| ≤ 126.
#[inline(always)]
fn power_of_two(k: f32) -> f32 {
    f32::from_bits((k + ROUND).to_bits().wrapping_add(127) << 23)
}

/// x = 2^k·m with m from √½ to √2, and ln m by s = (m − 1)/(m + 1).
#[inline(always)]
fn ln(x: f32) -> f32 {
    const TWO_25: f32 = 33_554_432.0;
    /// The bits of √½.
    const LEAST: u32 = 0x3F35_04F3;
    let subnormal = x < f32::MIN_POSITIVE;
    let normal = select(subnormal, x * TWO_25, x);
    // Moved up by 256 exponents, so that the difference is not negative.
    let moved = normal.to_bits().wrapping_sub(LEAST).wrapping_add(256 << 23) >> 23;
    let exponent = moved.wrapping_sub(256);
    let m = f32::from_bits(normal.to_bits().wrapping_sub(exponent << 23));
    let k = exponent.cast_signed() as f32 - select(subnormal, 25.0, 0.0);

    let f = m - 1.0;
    let s = f / (2.0 + f);
    let w = s * s;
    let half = 0.5 * f * f;
    let r = w * polynomial(&LOG, w);
    let value = k * LN_2[0] - ((half - (s * (half + r) + k * LN_2[1])) - f);

    let value = select(x == 0.0, f32::NEG_INFINITY, value);
    let value = select(x < 0.0, f32::NAN, value);
    // Infinity and NaN hand themselves on.
    select(x < f32::INFINITY, value, x)
}

#[inline(always)]
fn hyperbolic(x: f32) -> (f32, f32) {
    let size = x.abs();
    // eˣ/2, so that nothing overflows before the result does.
    let half = scaled_exp(size, -1.0);
    let quarter = 0.25 / half;
    let z = x * x;
    let small = size + size * z * polynomial(&SINH, z);
    let sinh = select(size < 1.0, small, half - quarter);
    (select(x < 0.0, -sinh, sinh), half + quarter)
}

#[cfg(test)]
mod tests {
    /// Numbers spread evenly over a range, on no lattice; then any, and those that are special.
    fn arguments(low: f64, high: f64) -> Vec<f64> {
        let spread = |n: u32| (f64::from(n) * 0.754_877_666_246_693).fract();
        let within = (0..100_000).map(|n| low + (high - low) * spread(n));
        let any = (0..50_000_u32).map(|n| f32::from_bits(n.wrapping_mul(2_654_435_761)).into());
        let special = [0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e-45];
        within.chain(any).chain(special).collect()
    }

    /// The greatest distance of a function in f32 from the true value, in units in the last place of f32, at most `bound`.
    #[track_caller]
    fn check_single(
        what: &str,
        bound: f64,
        arguments: &[f64],
        f: impl Fn(f32) -> f32,
        g: impl Fn(f64) -> f64,
    ) {
        let error = |x: f64| {
            let x = x as f32;
            let (is, should) = (f(x), g(f64::from(x)));
            if is.is_nan() && should.is_nan() || is == should as f32 {
                return 0.0;
            }
            let size = (should as f32).abs();
            let unit = f64::from(size.next_up() - size).max(f64::from(f32::MIN_POSITIVE));
            let error = (f64::from(is) - should).abs() / unit;
            assert!(!error.is_nan(), "{what}({x:?}): {is:?}, not {should:?}");
            error
        };
        let worst = arguments.iter().copied().map(error).fold(0.0, f64::max);
        assert!(worst <= bound, "{what}: {worst}");
    }

    #[test]
    fn functions_in_single_precision_are_those_of_double_precision() {
        let mut angles = arguments(-40.0, 40.0);
        angles.extend(arguments(-400.0, 400.0));
        check_single("sin", 2.0, &angles, |x| super::sin_cos(&[x]).0[0], f64::sin);
        check_single("cos", 2.0, &angles, |x| super::sin_cos(&[x]).1[0], f64::cos);
        check_single("tan", 4.0, &angles, |x| super::tan(&[x])[0], f64::tan);
        let mut all = arguments(-100.0, 90.0);
        all.extend([88.722, 88.73, -87.3, -87.4, -103.9, -104.1]);
        check_single("exp", 2.0, &all, |x| super::exp(&[x])[0], f64::exp);
        let mut all = arguments(0.0, 4.0);
        all.extend(arguments(0.99, 1.01));
        all.extend([1e-40, 1e-45, 1e38]);
        check_single("log", 2.0, &all, |x| super::log(&[x])[0], f64::ln);
        let mut all = arguments(-90.0, 90.0);
        all.extend(arguments(-2.0, 2.0));
        check_single(
            "sinh",
            4.0,
            &all,
            |x| super::sinh_cosh(&[x]).0[0],
            f64::sinh,
        );
        check_single(
            "cosh",
            4.0,
            &all,
            |x| super::sinh_cosh(&[x]).1[0],
            f64::cosh,
        );
        check_single("tanh", 4.0, &all, |x| super::tanh(&[x])[0], f64::tanh);
    }
}
