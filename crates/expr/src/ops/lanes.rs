//! One operation in all lanes of a block.
//!
//! In: operands, each a number per lane or one for all. Out: a number per lane.

/// An operand of a block operation.
#[derive(Clone, Copy, Debug)]
pub enum Lanes<'a, const N: usize> {
    /// A number per lane.
    Each(&'a [f64; N]),
    /// One number for all lanes.
    Same(f64),
}

#[inline]
pub(super) fn each<const N: usize>(x: &[f64; N], out: &mut [f64; N], f: impl Fn(f64) -> f64) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out = f(x);
    }
}

#[inline]
pub(super) fn each_pair<const N: usize>(
    a: Lanes<'_, N>,
    b: Lanes<'_, N>,
    out: &mut [f64; N],
    f: impl Fn(f64, f64) -> f64,
) {
    match (a, b) {
        (Lanes::Each(a), Lanes::Each(b)) => {
            for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
                *out = f(a, b);
            }
        }
        (Lanes::Same(a), Lanes::Each(b)) => each(b, out, |b| f(a, b)),
        (Lanes::Each(a), Lanes::Same(b)) => each(a, out, |a| f(a, b)),
        (Lanes::Same(a), Lanes::Same(b)) => *out = [f(a, b); N],
    }
}
