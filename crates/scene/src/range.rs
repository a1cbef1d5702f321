//! Intervals of numbers, and equally spaced values in them.

/// A closed interval with finite ends, `min < max`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Range {
    pub min: f64,
    pub max: f64,
}

/// Equally spaced values over a closed interval, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// The interval.
    pub range: Range,
    /// The number of values, at least 2.
    pub count: u32,
}

impl Range {
    /// Returns true if a value lies in the interval, its ends included. NaN lies in none.
    pub fn contains(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }

    /// Returns the first of some values that does not lie in the interval of its number.
    pub fn first_outside(ranges: &[Self], values: &[f64]) -> Option<usize> {
        let mut pairs = ranges.iter().zip(values);
        pairs.position(|(range, value)| !range.contains(*value))
    }
}

impl Sampling {
    /// Returns the `index`-th value, counted from 0 and below `count`; the first is `min` and the last is `max`,
    /// exactly.
    pub fn value(&self, index: u32) -> f64 {
        let last = self.count - 1;
        if index == last {
            return self.range.max;
        }
        let Range { min, max } = self.range;
        let (index, last) = (f64::from(index), f64::from(last));
        // Multiplied before divided: the integers of [0, 100, 101] come out as integers.
        let offset = (max - min) * index / last;
        if offset.is_finite() {
            return (min + offset).min(max);
        }
        // The interval is wider than the largest number.
        min * (1.0 - index / last) + max * (index / last)
    }
}
