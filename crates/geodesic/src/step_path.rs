//! The way of a step in coordinates: where it first leaves a region.
//!
//! In: the states at both ends of a step. Out: positions at fractions of it, bounds of its parts, and the fraction at which it
//! leaves a region that is given by a test on parts and one on points.

use std::array::from_fn;

use expr::interval::{Interval, Slope};

use crate::interpolate::{quintic, value};

/// Parts of a step that are shorter than this fraction of it are not halved in the search for a border.
const LEAST_PART: f64 = 1.0 / (1 << 26) as f64;
/// The maximum number of parts of a step that are halved in the search for a border, besides the step itself.
const MOST_HALVED: u32 = 127;

/// The position, the velocity and the acceleration at an end of a step.
pub(crate) type StepEnd<const D: usize> = [[f64; D]; 3];

/// A part of a path.
#[derive(Clone, Copy, Debug)]
pub struct PathPart<const D: usize> {
    /// The coordinates, with their derivatives by the path's parameter.
    pub(crate) coordinates: [Slope; D],
    /// The coordinates in the middle of the part.
    pub(crate) middle: [Interval; D],
    /// Half the part's length in the parameter.
    pub(crate) half: f64,
}

impl<const D: usize> PathPart<D> {
    /// Returns the box that contains the part.
    pub(crate) fn within(&self) -> [Interval; D] {
        self.coordinates.map(|coordinate| coordinate.value)
    }

    /// Returns the part in other coordinates, each a function of one coordinate, which is given by its index.
    pub(crate) fn changed(&self, change: &dyn Fn(usize, Slope) -> Slope) -> Self {
        let at_rest = |value: Interval| Slope {
            value,
            slope: Interval::point(0.0),
        };
        Self {
            coordinates: from_fn(|k| change(k, self.coordinates[k])),
            middle: from_fn(|k| change(k, at_rest(self.middle[k])).value),
            half: self.half,
        }
    }
}

/// The knowledge of the borders of regions along a part of a path.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Borders {
    /// The part meets none.
    None,
    /// The part crosses each border at most once.
    CrossedOnce,
    /// Nothing.
    Unknown,
}

impl Borders {
    /// Returns [`Borders::None`] for true, and [`Borders::Unknown`] for false.
    pub(crate) fn none_if(is_known: bool) -> Self {
        if is_known { Self::None } else { Self::Unknown }
    }
}

/// The coordinates of a step as quintic polynomials of the fraction done, from 0 to 1.
pub(crate) struct StepPath<const D: usize>([[f64; 6]; D]);

impl<const D: usize> StepPath<D> {
    /// Returns the path of a step of length `h` between two ends.
    pub(crate) fn new(h: f64, from: StepEnd<D>, to: StepEnd<D>) -> Self {
        let of = |end: &StepEnd<D>, k: usize| end.map(|vector| vector[k]);
        Self(from_fn(|k| quintic(h, of(&from, k), of(&to, k))))
    }

    /// Returns the position at a fraction of the step.
    pub(crate) fn at(&self, x: f64) -> [f64; D] {
        self.0.each_ref().map(|path| value(path, x))
    }

    /// Returns a part of the path, from one fraction to another.
    fn part(&self, [from, to]: [f64; 2]) -> PathPart<D> {
        let middle = 0.5 * (from + to);
        let coordinates = self.0.each_ref().map(|path| Slope {
            value: range(path, [from, to]),
            slope: range(&derivative(path), [from, to]),
        });
        PathPart {
            coordinates,
            middle: self.0.each_ref().map(|path| range(path, [middle; 2])),
            half: 0.5 * (to - from),
        }
    }

    /// Returns the first fraction known to be beyond the border of a region in which the step begins, or `None`. `borders`
    /// returns what is known of a part; `is_beyond` decides for a point.
    pub(crate) fn first_beyond(
        &self,
        borders: &dyn Fn(&PathPart<D>) -> Borders,
        is_beyond: &dyn Fn([f64; D]) -> bool,
    ) -> Option<f64> {
        let whole = [0.0, 1.0];
        match borders(&self.part(whole)) {
            // Most steps stay as a whole: no list is needed.
            Borders::None => return None,
            Borders::CrossedOnce => {
                return is_beyond(self.at(1.0)).then(|| self.border(is_beyond, 0.0, 1.0));
            }
            Borders::Unknown => {}
        }
        // Parts of the step, the first at the end of the list.
        let mut parts = Vec::with_capacity(32);
        parts.extend([[0.5, 1.0], [0.0, 0.5]]);
        let mut left = MOST_HALVED;
        while let Some([from, to]) = parts.pop() {
            match borders(&self.part([from, to])) {
                Borders::None => continue,
                Borders::CrossedOnce => {
                    if is_beyond(self.at(to)) {
                        return Some(self.border(is_beyond, from, to));
                    }
                    continue;
                }
                Borders::Unknown => {}
            }
            let middle = 0.5 * (from + to);
            if to - from > LEAST_PART && left > 0 {
                left -= 1;
                parts.extend([[middle, to], [from, middle]]);
                continue;
            }
            let inside = (from > 0.0).then_some(from);
            let places = inside
                .into_iter()
                .chain([0.25, 0.5, 0.75, 1.0].map(|x| from + x * (to - from)));
            let mut low = from;
            for x in places {
                if is_beyond(self.at(x)) {
                    return Some(self.border(is_beyond, low, x));
                }
                low = x;
            }
        }
        None
    }

    /// Returns the first fraction known to be beyond a border, between one that is not and one that is.
    fn border(&self, is_beyond: &dyn Fn([f64; D]) -> bool, mut low: f64, mut high: f64) -> f64 {
        for _ in 0..48 {
            let middle = 0.5 * (low + high);
            if is_beyond(self.at(middle)) {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }
}

/// Returns a polynomial's derivative, from its coefficients by powers.
fn derivative(&[_, b, c, d, e, f]: &[f64; 6]) -> [f64; 6] {
    [b, 2.0 * c, 3.0 * d, 4.0 * e, 5.0 * f, 0.0]
}

/// Returns the range of a polynomial for arguments between two that are not negative, from its coefficients by powers.
pub(crate) fn range(coefficients: &[f64; 6], [from, to]: [f64; 2]) -> Interval {
    let (mut lower, mut upper, mut size) = (0.0, 0.0, 0.0);
    let (mut low, mut high) = (1.0, 1.0);
    for c in coefficients {
        let [a, b] = [c * low, c * high];
        lower += a.min(b);
        upper += a.max(b);
        size += a.abs().max(b.abs());
        (low, high) = (low * from, high * to);
    }
    let rounding = 16.0 * f64::EPSILON * size;
    Interval::new(lower - rounding, upper + rounding)
}
