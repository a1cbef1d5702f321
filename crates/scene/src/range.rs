//! Intervals of numbers, and equally spaced values in them.

/// A closed interval with finite ends, `min < max`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Range {
    pub min: f64,
    pub max: f64,
}

/// The number of positions of a slider, more than a screen has pixels.
const POSITIONS: f64 = 10_000.0;

/// Equally spaced values over a closed interval, including both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// The interval.
    pub range: Range,
    /// The number of values, at least 2.
    pub count: u32,
}

impl Range {
    /// Returns true if a value is in the interval, whose ends are included. NaN is in no interval.
    pub fn contains(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }

    /// Returns a value on a slider over the interval, rounded to the decimals that distinguish the slider's positions.
    /// The ends are exact.
    pub fn rounded(&self, value: f64) -> f64 {
        let step = ((self.max - self.min) / POSITIONS).log10().floor();
        if !step.is_finite() || value <= self.min || value >= self.max {
            return value;
        }
        let rounded = if step > 0.0 {
            let step = 10_f64.powf(step);
            (value / step).round() * step
        } else {
            // The text of a decimal number is read as the nearest f64; a product may be another one.
            format!("{value:.*}", -step as usize)
                .parse()
                .unwrap_or(value)
        };
        // The sum makes a positive zero of a negative one.
        rounded.clamp(self.min, self.max) + 0.0
    }

    /// Returns the index of the first value that is outside its interval.
    pub fn first_outside(ranges: &[Self], values: &[f64]) -> Option<usize> {
        let mut pairs = ranges.iter().zip(values);
        pairs.position(|(range, value)| !range.contains(*value))
    }
}

impl Sampling {
    /// Returns the `index`-th value, counted from 0 and below `count`; the first is exactly `min` and the last is
    /// exactly `max`.
    pub fn value(&self, index: u32) -> f64 {
        let last = self.count - 1;
        if index == last {
            return self.range.max;
        }
        let Range { min, max } = self.range;
        let (index, last) = (f64::from(index), f64::from(last));
        // Multiply before dividing: then the integers of [0, 100, 101] are exact.
        let offset = (max - min) * index / last;
        if offset.is_finite() {
            return (min + offset).min(max);
        }
        // The interval is wider than the largest number.
        min * (1.0 - index / last) + max * (index / last)
    }
}

#[cfg(test)]
mod tests {
    use super::Range;

    #[test]
    fn the_value_of_a_slider_has_the_digits_that_distinguish_its_positions() {
        use std::f64::consts::TAU;
        for (min, max, value, rounded) in [
            (0.0, 1.0, 0.3, 0.3),
            (0.0, 1.0, 0.300_02, 0.3),
            (0.0, 1.0, 0.123_456, 0.1235),
            (-1.0, 1.0, -0.000_01, 0.0),
            (0.0, TAU, 1.234_567, 1.2346),
            (0.0, TAU, TAU, TAU),
            (0.0, TAU, TAU - 1e-6, TAU),
            (0.0, 1e9, 123_456_789.0, 1.235e8),
            (0.0, 1e-9, 2.5e-10, 2.5e-10),
            (1.0, 1.0 + 1e-15, 1.0 + 4.44e-16, 1.0 + 4.44e-16),
            (-f64::MAX, f64::MAX, 1e300, 1e300),
        ] {
            let value = Range { min, max }.rounded(value);
            assert_eq!(
                value.to_bits(),
                f64::to_bits(rounded),
                "{value} for {rounded}"
            );
        }
    }
}
