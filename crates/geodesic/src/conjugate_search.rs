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
        // The field's own zero may lie beside this part, as the cubic is not the field.
        let beside = LOOKS[1];
        Some(ZeroBracket {
            low: (low - beside).max(0.0) * h,
            high: (high + beside).min(1.0) * h,
            at: (low + (high - low) * from / (from - to)) * h,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_is_found_in_the_part_beside_the_one_of_the_cubic() {
        let h = 0.5;
        for (at, bulge) in [(0.25 + 1e-6, 0.01), (0.5 - 1e-6, -0.01), (0.6, 0.01)] {
            // A line and what vanishes with its derivative at both ends of the step, so that the cubic is the line.
            let field = |s: f64| {
                let x = s / h;
                let rest = 1.0 - x;
                let value = x - at + bulge * (x * rest).powi(2);
                [value, (1.0 + 2.0 * bulge * x * rest * (rest - x)) / h]
            };
            let mut all = brackets(h, field(0.0), field(h));
            let mut zero = all.next().expect("a zero");
            assert!(all.next().is_none());
            for _ in 0..ROUNDS {
                if zero.narrow(field(zero.at), h) {
                    break;
                }
            }
            let [off, _] = field(zero.at);
            assert!(off.abs() < 1e-14, "{at}: {off:e} at {}", zero.at);
        }
    }
}
