//! Comparison to a stated bound.

/// Panics with both numbers and the bound.
#[track_caller]
pub(crate) fn near(what: &str, found: f64, expected: f64, bound: f64) {
    assert!(
        (found - expected).abs() <= bound,
        "{what}: {found:?} is not {expected:?}: off by {:e}, allowed {bound:e}",
        (found - expected).abs()
    );
}
