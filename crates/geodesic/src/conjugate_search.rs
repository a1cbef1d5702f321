//! The search for conjugate points within a step: the zeros of the Jacobi field of a ray's start.
//!
//! In: the field and its rate at both ends of a step. Out: brackets of its zeros, each narrowed by Newton's method on the
//! step's length, as exact as the steps are that the caller takes.

use crate::interpolate::cubic;

/// A conjugate point is located to this share of its step.
const SHARP: f64 = 1e-14;
/// The most steps of Newton's method, or halvings.
pub(crate) const ROUNDS: usize = 40;
/// The shares of a step between which zeros are looked for.
const LOOKS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// A part of a step that contains a zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ZeroBracket {
    low: f64,
    high: f64,
    /// The length of the step to where the zero is taken to be.
    pub(crate) at: f64,
    /// True if the field is positive before the zero.
    falls: bool,
}

/// Returns the brackets of the zeros within a step of length `h`, where the cubic through both ends changes its sign.
/// `before` and `after` are the field and its rate there.
pub(crate) fn brackets(
    h: f64,
    before: [f64; 2],
    after: [f64; 2],
) -> impl Iterator<Item = ZeroBracket> {
    let m = move |share: f64| cubic(share, h, before, after);
    (1..LOOKS.len()).filter_map(move |k| {
        let (low, high) = (LOOKS[k - 1], LOOKS[k]);
        let (from, to) = (m(low), m(high));
        // The start itself, where m = 0, is none.
        if from == 0.0 || (from > 0.0) == (to > 0.0) {
            return None;
        }
        let (low, high) = (low * h, high * h);
        Some(ZeroBracket {
            low,
            high,
            at: low + (high - low) * from / (from - to),
            falls: from > 0.0,
        })
    })
}

impl ZeroBracket {
    /// Narrows the bracket by the field and its rate at the end of a step of the length `at`; returns true once the zero is
    /// as sharp as it can be in a step of length `h`.
    pub(crate) fn narrow(&mut self, [value, rate]: [f64; 2], h: f64) -> bool {
        if (value > 0.0) == self.falls {
            self.low = self.at;
        } else {
            self.high = self.at;
        }
        let newton = self.at - value / rate;
        let next = if newton >= self.low && newton <= self.high {
            newton
        } else {
            0.5 * (self.low + self.high)
        };
        let moved = (next - self.at).abs();
        self.at = next;
        moved <= SHARP * h || value == 0.0
    }
}
