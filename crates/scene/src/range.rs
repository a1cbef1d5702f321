//! Intervals of numbers, and equally spaced values in them.

/// A closed interval with finite ends, `min < max`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Range {
    pub min: f64,
    pub max: f64,
}

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
