//! Vectors of three numbers: products, lengths and combinations.

/// The dot product.
#[inline(always)]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product.
#[inline(always)]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Returns the length, without overflow or underflow if the result is in range.
#[inline(always)]
pub fn norm(a: [f64; 3]) -> f64 {
    let square = dot(a, a);
    if square > 1e-280 && square < 1e280 {
        square.sqrt()
    } else {
        extreme_norm(a)
    }
}

/// The same for a vector whose squared length may be out of range.
#[cold]
fn extreme_norm(a: [f64; 3]) -> f64 {
    let largest = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return a.iter().map(|x| x.abs()).sum();
    }
    let b = a.map(|x| x / largest);
    largest * dot(b, b).sqrt()
}

/// Returns `s·a + t·b`.
#[inline(always)]
pub fn combine(s: f64, a: [f64; 3], t: f64, b: [f64; 3]) -> [f64; 3] {
    [
        s * a[0] + t * b[0],
        s * a[1] + t * b[1],
        s * a[2] + t * b[2],
    ]
}
