//! Comparison of numbers to a stated tolerance, with a message that gives both.

/// Whether two numbers agree: `|actual − expected| ≤ tolerance · max(1, |expected|)`. Two NaN agree, and two
/// infinities of one sign.
pub fn close(actual: f64, expected: f64, tolerance: f64) -> bool {
    if actual.is_nan() || expected.is_nan() {
        return actual.is_nan() && expected.is_nan();
    }
    actual == expected || (actual - expected).abs() <= tolerance * expected.abs().max(1.0)
}

/// Panics with both numbers unless they are [`close`].
#[track_caller]
pub fn assert_close(what: &str, actual: f64, expected: f64, tolerance: f64) {
    assert!(
        close(actual, expected, tolerance),
        "{what}: {actual:?} is not {expected:?} (difference {:e}, tolerance {tolerance:e})",
        (actual - expected).abs()
    );
}

/// Panics with both vectors unless they lie within `tolerance` of each other (Euclidean, absolute).
#[track_caller]
pub fn assert_near(what: &str, actual: &[f64], expected: &[f64], tolerance: f64) {
    let distance = distance(actual, expected);
    assert!(
        distance <= tolerance,
        "{what}: {actual:?} is not {expected:?} (distance {distance:e}, tolerance {tolerance:e})"
    );
}

/// The Euclidean distance; NaN where a component is, infinite where the dimensions differ.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    if a.len() != b.len() {
        return f64::INFINITY;
    }
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        .sqrt()
}

#[cfg(test)]
mod tests {
    use super::{assert_close, assert_near, close};

    #[test]
    fn near_numbers_are_close_and_others_are_not() {
        assert!(close(1.0, 1.0 + 1e-14, 1e-13));
        assert!(!close(1.0, 1.0 + 1e-12, 1e-13));
        assert!(close(1e300, 1e300 * (1.0 + 1e-14), 1e-13));
        assert!(!close(0.0, f64::NAN, 1.0));
        assert!(close(f64::NAN, f64::NAN, 0.0));
        assert!(close(f64::INFINITY, f64::INFINITY, 0.0));
        assert!(!close(f64::INFINITY, 1e308, 1e-3));
    }

    #[test]
    #[should_panic(expected = "2.0 is not 3.0")]
    fn a_bad_pair_is_reported_with_both_numbers() {
        assert_close("pair", 2.0, 3.0, 0.1);
    }

    #[test]
    #[should_panic(expected = "is not")]
    fn a_vector_with_nan_is_near_nothing() {
        assert_near("vector", &[f64::NAN, 0.0], &[0.0, 0.0], 1e9);
    }
}
