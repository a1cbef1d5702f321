//! The numbers that an attribute of a language can have.

/// The numbers that an attribute's value, or each component of it, can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttributeRange {
    /// The minimum.
    pub min: f64,
    /// The maximum.
    pub max: f64,
    /// True if the minimum is excluded.
    pub is_open: bool,
}

impl AttributeRange {
    /// All finite numbers.
    pub const ANY: Self = Self::closed(f64::NEG_INFINITY, f64::INFINITY);
    /// 0…1.
    pub const SHARE: Self = Self::closed(0.0, 1.0);
    /// ≥ 0.
    pub const NOT_NEGATIVE: Self = Self::closed(0.0, f64::INFINITY);
    /// > 0.
    pub const POSITIVE: Self = Self {
        is_open: true,
        ..Self::NOT_NEGATIVE
    };
    /// An angle up to a full turn.
    pub const TURN: Self = Self {
        is_open: true,
        ..Self::closed(0.0, std::f64::consts::TAU)
    };

    /// Returns the closed range from `min` to `max`.
    pub const fn closed(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            is_open: false,
        }
    }

    /// Returns true if the range contains a number. It contains neither NaN nor infinities.
    pub fn contains(self, value: f64) -> bool {
        let above = value > self.min || (value == self.min && !self.is_open);
        value.is_finite() && above && value <= self.max
    }

    /// Returns the number of the range nearest to a finite number. In an open range, the minimum is replaced by the smallest
    /// number above it that is not denormal.
    pub fn clamp(self, value: f64) -> f64 {
        let least = if self.is_open {
            self.min + f64::MIN_POSITIVE
        } else {
            self.min
        };
        value.clamp(least, self.max)
    }

    /// Returns the range for the end of a sentence: `0…1`, `> 0`; `None` if it contains every number.
    pub fn text(self) -> Option<&'static str> {
        match self {
            Self::SHARE => Some("0…1"),
            Self::NOT_NEGATIVE => Some("≥ 0"),
            Self::POSITIVE => Some("> 0"),
            Self::TURN => Some("> 0 and ≤ 2pi"),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::AttributeRange;

    #[test]
    fn ranges_hold_finite_numbers_and_clamp_to_them() {
        for range in [
            AttributeRange::ANY,
            AttributeRange::SHARE,
            AttributeRange::NOT_NEGATIVE,
            AttributeRange::POSITIVE,
            AttributeRange::TURN,
        ] {
            for value in [-7.0, -1e-300, 0.0, 0.5, 1.0, 4.0, 1e300] {
                assert!(range.contains(range.clamp(value)), "{range:?} {value}");
                assert_eq!(range.contains(value), range.clamp(value) == value);
            }
            assert!(!range.contains(f64::NAN) && !range.contains(f64::INFINITY));
        }
        assert!(!AttributeRange::POSITIVE.contains(0.0));
        assert!(AttributeRange::SHARE.contains(0.0));
    }

    #[test]
    fn a_sentence_names_each_range() {
        let texts = [
            (AttributeRange::ANY, None),
            (AttributeRange::SHARE, Some("0…1")),
            (AttributeRange::NOT_NEGATIVE, Some("≥ 0")),
            (AttributeRange::POSITIVE, Some("> 0")),
            (AttributeRange::TURN, Some("> 0 and ≤ 2pi")),
        ];
        for (range, text) in texts {
            assert_eq!(range.text(), text);
        }
    }
}
