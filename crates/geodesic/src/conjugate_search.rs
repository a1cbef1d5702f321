//! The search for conjugate points within a step: the zeros of the Jacobi field of a ray's start.
//!
//! In: the field and its rate at both ends of a step. Out: brackets of its zeros, each narrowed by Newton's method on the
//! step's length. The zeros are as accurate as the caller's steps.

use crate::interpolate::cubic;

/// A conjugate point is located to this fraction of its step.
const SHARP: f64 = 1e-14;
/// The maximum number of Newton steps, or halvings.
pub(crate) const ROUNDS: usize = 40;
/// The fractions of a step between which zeros are sought.
const LOOKS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// A part of a step that contains a zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ZeroBracket {
    low: f64,
    high: f64,
    /// The length of the step to the estimated zero.
    pub(crate) at: f64,
    /// True if the field is positive before the zero.
    falls: bool,
}

/// Returns the brackets of the zeros within a step of length `h`, where the cubic through both ends changes sign.
/// `before` and `after` are the field and its rate at the ends.
pub(crate) fn brackets(
    h: f64,
    before: [f64; 2],
    after: [f64; 2],
) -> impl Iterator<Item = ZeroBracket> {
    let m = move |share: f64| cubic(share, h, before, after);
    (1..LOOKS.len()).filter_map(move |k| {
        let (low, high) = (LOOKS[k - 1], LOOKS[k]);
        let (from, to) = (m(low), m(high));
        // The start itself, where m = 0, is not a conjugate point.
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
    /// Narrows the bracket by the field and its rate at the end of a step of length `at`. Returns true once the zero is as
    /// precise as a step of length `h` allows.
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
