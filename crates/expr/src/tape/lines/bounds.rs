//! Bounds of values and slopes on several lines.
//!
//! In: bounds of operands on as many lines as a vector has lanes. Out: bounds of the operation's values and slopes, wider than
//! exact ones by a few ulps, and the state of the lines after each operation.

use crate::elementary;
use crate::ops::Unary;
use crate::vectors::{Instructions, MOST_LANES, Mask, Vector};

/// Values and slopes on as many lines as a vector has lanes.
#[derive(Clone, Copy)]
pub(super) struct LineRanges<S: Instructions> {
    /// Lower > upper where the value is undefined throughout.
    pub(super) value: LaneBounds<S>,
    pub(super) slope: LaneBounds<S>,
    /// True if the slopes are 0 on all lines.
    is_number: bool,
}

#[derive(Clone, Copy)]
pub(super) struct LaneBounds<S: Instructions> {
    pub(super) lower: Vector<S>,
    pub(super) upper: Vector<S>,
}

/// The state of the lines after all operations so far: the root depends on each of them, and none is defined where an
/// operand is not.
#[derive(Clone, Copy)]
pub(super) struct KnownLines<S: Instructions> {
    /// All values are bounded.
    pub(super) bounded: Mask<S>,
    /// All slopes are bounded.
    pub(super) sloped: Mask<S>,
    /// A value is undefined somewhere.
    pub(super) partial: Mask<S>,
    /// A value is undefined everywhere.
    pub(super) undefined: Mask<S>,
}

impl<S: Instructions> KnownLines<S> {
    #[inline(always)]
    pub(super) fn new(s: S) -> Self {
        let [yes, no] = [true, false].map(|value| Mask::splat(s, value));
        Self {
            bounded: yes,
            sloped: yes,
            partial: no,
            undefined: no,
        }
    }

    /// Records a result.
    #[inline(always)]
    pub(super) fn note(&mut self, found: &LineRanges<S>) {
        let LineRanges { value, slope, .. } = found;
        let bounded = value.lower.is_finite() & value.upper.is_finite();
        let new = self.bounded & !bounded;
        if new.any() {
            self.undefined = self.undefined | (new & value.upper.lt(value.lower));
            self.bounded = self.bounded & bounded;
        }
        self.sloped = self.sloped & slope.lower.is_finite() & slope.upper.is_finite();
    }

    /// Restricts values to a domain, which may begin at −∞; values outside are undefined.
    #[inline(always)]
    fn restrict(&mut self, s: S, value: LaneBounds<S>, [least, most]: [f64; 2]) -> LaneBounds<S> {
        let (least, most) = (Vector::splat(s, least), Vector::splat(s, most));
        let outside = value.lower.lt(least) | most.lt(value.upper);
        self.partial = self.partial | outside;
        let undefined = value.upper.lt(least) | most.lt(value.lower);
        let endless = Vector::splat(s, f64::INFINITY);
        LaneBounds {
            lower: undefined.choose(endless, value.lower.greatest(least)),
            upper: undefined.choose(-endless, value.upper.least(most)),
        }
    }
}

impl<S: Instructions> LineRanges<S> {
    #[inline(always)]
    pub(super) fn number(s: S, x: f64) -> Self {
        Self {
            value: LaneBounds::point(Vector::splat(s, x)),
            slope: LaneBounds::point(Vector::splat(s, 0.0)),
            is_number: true,
        }
    }

    /// Returns `from` + t·`rate` for t in `times`.
    #[inline(always)]
    pub(super) fn coordinate(
        s: S,
        from: LaneBounds<S>,
        rate: LaneBounds<S>,
        times: LaneBounds<S>,
    ) -> Self {
        Self {
            value: from.sum(s, times.product(s, rate)),
            slope: rate,
            is_number: false,
        }
    }

    #[inline(always)]
    pub(super) fn negative(self) -> Self {
        Self {
            value: self.value.negative(),
            slope: self.slope.negative(),
            ..self
        }
    }

    #[inline(always)]
    pub(super) fn sum(self, s: S, other: Self) -> Self {
        Self {
            value: self.value.sum(s, other.value),
            slope: if other.is_number {
                self.slope
            } else if self.is_number {
                other.slope
            } else {
                self.slope.sum(s, other.slope)
            },
            is_number: self.is_number && other.is_number,
        }
    }

    #[inline(always)]
    pub(super) fn product(self, s: S, other: Self) -> Self {
        Self {
            value: self.value.product(s, other.value),
            slope: if self.is_number && other.is_number {
                self.slope
            } else if other.is_number {
                self.slope.product(s, other.value)
            } else if self.is_number {
                self.value.product(s, other.slope)
            } else {
                let first = self.slope.nearest_product(other.value);
                let second = self.value.nearest_product(other.slope);
                first.sum_of_products(s, second)
            },
            is_number: self.is_number && other.is_number,
        }
    }

    #[inline(always)]
    pub(super) fn quotient(self, s: S, other: Self) -> Self {
        let reciprocal = other.value.reciprocal(s);
        let value = self.value.product(s, reciprocal);
        let slope = if other.is_number {
            self.slope
        } else {
            let share = value.product(s, other.slope).negative();
            self.slope.sum(s, share)
        };
        let is_number = self.is_number && other.is_number;
        Self {
            value,
            slope: if is_number {
                self.slope
            } else {
                slope.product(s, reciprocal)
            },
            is_number,
        }
    }

    #[inline(always)]
    pub(super) fn cube(self, s: S) -> Self {
        let LaneBounds { lower, upper } = self.value;
        let cube = LaneBounds {
            lower: lower * lower * lower,
            upper: upper * upper * upper,
        };
        let square = self.value.square(s);
        let three = LaneBounds::point(Vector::splat(s, 3.0));
        Self {
            value: cube.widened_by(s, 2.0),
            slope: if self.is_number {
                self.slope
            } else {
                three.product(s, square).product(s, self.slope)
            },
            ..self
        }
    }

    #[inline(always)]
    pub(super) fn square(self, s: S) -> Self {
        let twice = LaneBounds {
            lower: self.value.lower + self.value.lower,
            upper: self.value.upper + self.value.upper,
        };
        Self {
            value: self.value.square(s),
            slope: if self.is_number {
                self.slope
            } else {
                twice.product(s, self.slope)
            },
            ..self
        }
    }

    /// Returns the absolute value.
    #[inline(always)]
    pub(super) fn size(self, s: S) -> Self {
        let zero = Vector::splat(s, 0.0);
        let falls = self.value.upper.le(zero);
        let rises = zero.le(self.value.lower);
        let (down, up) = (self.slope.negative(), self.slope);
        Self {
            value: self.value.size(s),
            slope: LaneBounds {
                lower: rises.choose(
                    up.lower,
                    falls.choose(down.lower, up.lower.least(down.lower)),
                ),
                upper: rises.choose(
                    up.upper,
                    falls.choose(down.upper, up.upper.greatest(down.upper)),
                ),
            },
            ..self
        }
    }

    /// Applies a function that is monotone where it is defined: an exponential, a logarithm, a root, or an inverse
    /// trigonometric function. NaN for any other.
    #[inline(always)]
    pub(super) fn elementary(self, s: S, op: Unary, known: &mut KnownLines<S>) -> Self {
        let number = |x: f64| Vector::splat(s, x);
        let (zero, one) = (number(0.0), number(1.0));
        let domain = match op {
            Unary::Exp | Unary::Atan => None,
            Unary::Sqrt | Unary::Log => Some([0.0, f64::INFINITY]),
            Unary::Asin | Unary::Acos => Some([-1.0, 1.0]),
            _ => return Self::number(s, f64::NAN),
        };
        let x = match domain {
            Some(domain) => known.restrict(s, self.value, domain),
            None => self.value,
        };
        let is_undefined = x.upper.lt(x.lower);
        let ends = match op {
            Unary::Sqrt => [x.lower.sqrt(), x.upper.sqrt()],
            Unary::Acos => [x.upper, x.lower].map(|x| x.map(f64::acos)),
            op => [x.lower, x.upper].map(|x| x.map(|x| op.eval(x))),
        };
        let value = LaneBounds {
            lower: ends[0],
            upper: ends[1],
        };
        let value = value.widened_by(s, 4.0);
        let value = match op {
            Unary::Exp | Unary::Sqrt | Unary::Acos => LaneBounds {
                lower: zero.greatest(value.lower),
                ..value
            },
            _ => value,
        };
        let value = LaneBounds {
            lower: is_undefined.choose(x.lower, value.lower),
            upper: is_undefined.choose(x.upper, value.upper),
        };
        if self.is_number {
            return Self { value, ..self };
        }
        let ones = LaneBounds::point(one);
        let rate = match op {
            Unary::Exp => value,
            Unary::Log => x.reciprocal(s),
            Unary::Sqrt => value.sum(s, value).reciprocal(s),
            Unary::Atan => x.square(s).sum(s, ones).reciprocal(s),
            _ => {
                let rest = ones.sum(s, x.square(s).negative());
                let root = LaneBounds {
                    lower: zero.greatest(rest.lower).sqrt(),
                    upper: rest.upper.sqrt(),
                };
                let root = root.widened(s);
                root.reciprocal(s)
            }
        };
        let rate = if op == Unary::Acos {
            rate.negative()
        } else {
            rate
        };
        Self {
            value,
            slope: rate.product(s, self.slope),
            ..self
        }
    }

    /// Returns the larger one.
    #[inline(always)]
    pub(super) fn greatest(self, other: Self) -> Self {
        let first = other.value.upper.le(self.value.lower);
        let second = self.value.upper.lt(other.value.lower);
        let (a, b) = (self.slope, other.slope);
        Self {
            value: LaneBounds {
                lower: self.value.lower.greatest(other.value.lower),
                upper: self.value.upper.greatest(other.value.upper),
            },
            slope: LaneBounds {
                lower: first.choose(a.lower, second.choose(b.lower, a.lower.least(b.lower))),
                upper: first.choose(a.upper, second.choose(b.upper, a.upper.greatest(b.upper))),
            },
            is_number: self.is_number && other.is_number,
        }
    }

    /// Returns sine and cosine, each of which determines the other's slope.
    #[inline(always)]
    pub(super) fn waves(&self, s: S) -> [Self; 2] {
        let (sine, cosine) = self.value.waves(s);
        let (by_sine, by_cosine) = if self.is_number {
            (self.slope, self.slope)
        } else {
            (
                cosine.product(s, self.slope),
                sine.negative().product(s, self.slope),
            )
        };
        [
            Self {
                value: sine,
                slope: by_sine,
                ..*self
            },
            Self {
                value: cosine,
                slope: by_cosine,
                ..*self
            },
        ]
    }
}

impl<S: Instructions> LaneBounds<S> {
    #[inline(always)]
    pub(super) fn load(s: S, [lower, upper]: &[[f64; MOST_LANES]; 2], part: usize) -> Self {
        Self {
            lower: Vector::load(s, lower, part),
            upper: Vector::load(s, upper, part),
        }
    }

    #[inline(always)]
    pub(super) fn point(x: Vector<S>) -> Self {
        Self { lower: x, upper: x }
    }

    #[inline(always)]
    fn negative(self) -> Self {
        Self {
            lower: -self.upper,
            upper: -self.lower,
        }
    }

    /// Widens by at least one ulp, and by more than the smallest normal number.
    #[inline(always)]
    fn widened(self, s: S) -> Self {
        self.widened_by(s, 1.0)
    }

    /// Widens by `units` ulps, and by more than the smallest normal number.
    #[inline(always)]
    fn widened_by(self, s: S, units: f64) -> Self {
        let unit = Vector::splat(s, units * f64::EPSILON);
        let least = Vector::splat(s, f64::MIN_POSITIVE);
        Self {
            lower: self.lower - (self.lower.abs() * unit + least),
            upper: self.upper + (self.upper.abs() * unit + least),
        }
    }

    /// Returns the reciprocals; NaN where 0 is among the values.
    #[inline(always)]
    fn reciprocal(self, s: S) -> Self {
        let (zero, one) = (Vector::splat(s, 0.0), Vector::splat(s, 1.0));
        let crosses = self.lower.le(zero) & zero.le(self.upper);
        let nothing = Vector::splat(s, f64::NAN);
        let reciprocal = Self {
            lower: crosses.choose(nothing, one / self.upper),
            upper: crosses.choose(nothing, one / self.lower),
        };
        reciprocal.widened(s)
    }

    #[inline(always)]
    fn sum(self, s: S, other: Self) -> Self {
        let sum = Self {
            lower: self.lower + other.lower,
            upper: self.upper + other.upper,
        };
        sum.widened(s)
    }

    #[inline(always)]
    fn product(self, s: S, other: Self) -> Self {
        self.nearest_product(other).widened(s)
    }

    /// Returns the product, rounded to nearest instead of outward.
    #[inline(always)]
    fn nearest_product(self, other: Self) -> Self {
        let a = self.lower * other.lower;
        let b = self.lower * other.upper;
        let c = self.upper * other.lower;
        let d = self.upper * other.upper;
        Self {
            lower: a.least(b).least(c.least(d)),
            upper: a.greatest(b).greatest(c.greatest(d)),
        }
    }

    /// Returns the sum of two products that are rounded to nearest.
    #[inline(always)]
    fn sum_of_products(self, s: S, other: Self) -> Self {
        let units = Vector::splat(s, 2.0 * f64::EPSILON);
        let least = Vector::splat(s, 2.0 * f64::MIN_POSITIVE);
        let below = (self.lower.abs() + other.lower.abs()) * units + least;
        let above = (self.upper.abs() + other.upper.abs()) * units + least;
        Self {
            lower: (self.lower + other.lower) - below,
            upper: (self.upper + other.upper) + above,
        }
    }

    /// Returns the absolute values.
    #[inline(always)]
    fn size(self, s: S) -> Self {
        let zero = Vector::splat(s, 0.0);
        let (a, b) = (self.lower.abs(), self.upper.abs());
        let crosses = self.lower.le(zero) & zero.le(self.upper);
        Self {
            lower: crosses.choose(zero, a.least(b)),
            upper: a.greatest(b),
        }
    }

    /// Returns the values of sine and cosine. In quarter turns, the sine has its maxima at 1 + 4k and its minima at 3 + 4k,
    /// the cosine at 4k and 2 + 4k.
    #[inline(always)]
    fn waves(self, s: S) -> (Self, Self) {
        let number = |x: f64| Vector::splat(s, x);
        let quarter = number(std::f64::consts::FRAC_2_PI);
        let (from, to) = (self.lower * quarter, self.upper * quarter);
        let size = from.abs().greatest(to.abs());
        let slack = number(8.0 * f64::EPSILON) * (number(1.0) + size);
        let quarters = Self {
            lower: from - slack,
            upper: to + slack,
        };
        // Where the reduction is not accurate, assume all values: large angles, which are slow, are not evaluated.
        let far = !size.lt(number(elementary::LARGEST_ANGLE));
        let near = Self {
            lower: far.choose(number(0.0), self.lower),
            upper: far.choose(number(0.0), self.upper),
        };
        let (lower, upper) = (near.lower.sin_cos(), near.upper.sin_cos());
        let sines = Self {
            lower: lower.0,
            upper: upper.0,
        };
        let cosines = Self {
            lower: lower.1,
            upper: upper.1,
        };
        let sine = Self::wave(
            s,
            sines,
            far | quarters.meets(s, 1.0),
            far | quarters.meets(s, 3.0),
        );
        let cosine = Self::wave(
            s,
            cosines,
            far | quarters.meets(s, 0.0),
            far | quarters.meets(s, 2.0),
        );
        (sine, cosine)
    }

    /// Returns the values of a wave with these values at its ends, to four ulps, and these extrema between.
    #[inline(always)]
    fn wave(s: S, ends: Self, crest: Mask<S>, trough: Mask<S>) -> Self {
        let one = Vector::splat(s, 1.0);
        let units = Vector::splat(s, 4.0 * f64::EPSILON);
        let least = ends.lower.least(ends.upper);
        let most = ends.lower.greatest(ends.upper);
        let lower = (least - least.abs() * units).greatest(-one);
        let upper = (most + most.abs() * units).least(one);
        Self {
            lower: trough.choose(-one, lower),
            upper: crest.choose(one, upper),
        }
    }

    /// Returns false only where no `place` + 4k, k an integer, is between the bounds.
    #[inline(always)]
    fn meets(self, s: S, place: f64) -> Mask<S> {
        let round = Vector::splat(s, elementary::ROUND);
        let (place, four) = (Vector::splat(s, place), Vector::splat(s, 4.0));
        let turns = (self.lower - place) * Vector::splat(s, 0.25);
        let nearest = (turns + round) - round;
        let next = nearest
            + nearest
                .lt(turns)
                .choose(Vector::splat(s, 1.0), Vector::splat(s, 0.0));
        (next * four + place).le(self.upper)
    }

    #[inline(always)]
    fn square(self, s: S) -> Self {
        let Self { lower, upper } = self.size(s);
        let square = Self {
            lower: lower * lower,
            upper: upper * upper,
        };
        let square = square.widened(s);
        Self {
            lower: square.lower.greatest(Vector::splat(s, 0.0)),
            ..square
        }
    }
}
