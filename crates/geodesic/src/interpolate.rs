//! Polynomials through values and derivatives at both ends of an interval (Stoer, Bulirsch, *Introduction to Numerical
//! Analysis*, section 2.1.5).

/// Returns the cubic with these values and derivatives at the ends of an interval of length `h`, at a fraction `t` of
/// it.
#[inline(always)]
pub(crate) fn cubic(t: f64, h: f64, [a, a1]: [f64; 2], [b, b1]: [f64; 2]) -> f64 {
    let rest = 1.0 - t;
    (1.0 + 2.0 * t) * rest * rest * a
        + t * t * (3.0 - 2.0 * t) * b
        + h * t * rest * (rest * a1 - t * b1)
}

/// Returns the fractions inside the interval at which the same cubic has an extremum.
pub(crate) fn turning_points(
    h: f64,
    [a, a1]: [f64; 2],
    [b, b1]: [f64; 2],
) -> impl Iterator<Item = f64> {
    let (start, end, rise) = (h * a1, h * b1, b - a);
    // The derivative is p t² − 2 q t + start.
    let p = 3.0 * (start + end - 2.0 * rise);
    let q = 2.0 * start + end - 3.0 * rise;
    let root = (q * q - p * start).sqrt();
    // Without cancellation; a NaN is not inside.
    let sum = q + root.copysign(q);
    [sum / p, start / sum]
        .into_iter()
        .filter(|t| *t > 0.0 && *t < 1.0)
}

/// Returns the coefficients, by powers of the fraction, of the quintic with these values, first and second derivatives at
/// the ends of an interval of length `h`.
pub(crate) fn quintic(h: f64, a: [f64; 3], b: [f64; 3]) -> [f64; 6] {
    let (c0, c1, c2) = (a[0], h * a[1], 0.5 * h * h * a[2]);
    let x = b[0] - c0 - c1 - c2;
    let y = h * b[1] - c1 - 2.0 * c2;
    let z = h * h * b[2] - 2.0 * c2;
    [
        c0,
        c1,
        c2,
        10.0 * x - 4.0 * y + 0.5 * z,
        -15.0 * x + 7.0 * y - z,
        6.0 * x - 3.0 * y + 0.5 * z,
    ]
}

/// Returns a polynomial's value at `x`, from its coefficients by powers (Horner's scheme).
pub(crate) fn value(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// The weights of Lagrange interpolation at the midpoint from ±1 and ±2 equal steps, the same on both sides: (4, −1)/6.
pub(crate) const MIDDLE_OF_FOUR: [f64; 2] = [2.0 / 3.0, -1.0 / 6.0];
/// The weights of Lagrange interpolation at the midpoint from ±1, ±2 and ±3 equal steps, the same on both sides: (15,
/// −6, 1)/20.
pub(crate) const MIDDLE_OF_SIX: [f64; 3] = [0.75, -0.3, 0.05];
