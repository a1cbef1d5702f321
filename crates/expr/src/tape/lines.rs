//! Evaluation with slopes along several lines at once.
//!
//! Input: for each input a number, or the starts and rates of a coordinate along the lines of a block; and the part of the
//! lines. Output: for each line values and slopes, as [`Tape::eval_slopes`] has them for one, in bounds that may be wider by a
//! few units in the last place. Sums, products, squares, sines and cosines are computed in vectors; tapes with other operations
//! are left to [`Tape::eval_slopes`], and so is what is not bounded.

use crate::elementary;
use crate::interval::{Interval, Slope};
use crate::ops::{Binary, Unary};
use crate::processor::Processor;
use crate::tape::{Operand, Tape, TapeOperation};
use crate::vectors::{Instructions, MOST_LANES, Mask, Vector, VectorWork};

/// The values of an input on the lines of a block.
#[derive(Clone, Copy, Debug)]
pub enum LineInput {
    /// The same number everywhere.
    Number(f64),
    /// On each line `origin` + t·`direction`.
    Coordinate {
        /// The starts.
        origin: [f64; MOST_LANES],
        /// The rates.
        direction: [f64; MOST_LANES],
    },
    /// On each line between bounds, the lower ones first.
    Range {
        /// Of the values.
        value: [[f64; MOST_LANES]; 2],
        /// Of the derivatives.
        slope: [[f64; MOST_LANES]; 2],
    },
}

impl Tape {
    /// True if [`Tape::eval_slopes_on_lines`] knows all operations.
    pub fn is_of_vectors(&self) -> bool {
        let is_known = |operation| match operation {
            TapeOperation::Unary(op, _) => matches!(op, Unary::Neg | Unary::Sin | Unary::Cos),
            TapeOperation::Binary(op, ..) => {
                matches!(op, Binary::Add | Binary::Sub | Binary::Mul)
            }
            TapeOperation::Power(_, n) => n == 2,
            TapeOperation::Copy(_) => true,
        };
        let mut operations = self.instructions.iter().map(|it| it.operation);
        operations.all(is_known)
    }

    /// Evaluates the first root with slopes along the lines of a block, for t in `t`; `None` if an operation is not known, or
    /// something on the way is not bounded on a line.
    ///
    /// # Panics
    /// If there is not one input for each of [`Tape::inputs`].
    pub fn eval_slopes_on_lines(
        &self,
        processor: Processor,
        inputs: &[LineInput],
        t: Interval,
    ) -> Option<[Slope; MOST_LANES]> {
        assert_eq!(inputs.len(), self.inputs.len(), "one value per input");
        let root = *self.roots.first()?;
        if t.is_empty() {
            return None;
        }
        let mut bounds = [[0.0; MOST_LANES]; 4];
        let is_bounded = processor.run_vectors(OnLines {
            tape: self,
            root,
            inputs,
            t,
            bounds: &mut bounds,
        });
        let [a, b, c, d] = &bounds;
        is_bounded.then(|| {
            std::array::from_fn(|lane| Slope {
                value: Interval::new(a[lane], b[lane]),
                slope: Interval::new(c[lane], d[lane]),
            })
        })
    }
}

/// The evaluation; it returns false if an operation is not known, or something is not bounded.
struct OnLines<'a> {
    tape: &'a Tape,
    root: Operand,
    inputs: &'a [LineInput],
    t: Interval,
    /// Of the values, then of the slopes: the lower and the upper ones.
    bounds: &'a mut [[f64; MOST_LANES]; 4],
}

/// Values and slopes on as many lines as a vector has lanes, defined everywhere.
#[derive(Clone, Copy)]
struct LineRanges<S: Instructions> {
    value: LaneBounds<S>,
    slope: LaneBounds<S>,
    /// True if the slopes are 0 on all lines.
    is_number: bool,
}

#[derive(Clone, Copy)]
struct LaneBounds<S: Instructions> {
    lower: Vector<S>,
    upper: Vector<S>,
}

impl VectorWork for OnLines<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) -> bool {
        let Self {
            tape,
            root,
            inputs: given,
            t,
            bounds,
        } = self;
        let zero = LineRanges::number(s, 0.0);
        let mut registers = vec![zero; tape.register_count];
        let mut inputs = vec![zero; given.len()];
        // Sine and cosine of each input.
        let mut waves = vec![None; given.len()];
        for part in 0..Vector::<S>::PARTS {
            for (input, given) in inputs.iter_mut().zip(given) {
                *input = match given {
                    LineInput::Number(x) => LineRanges::number(s, *x),
                    LineInput::Coordinate { origin, direction } => {
                        let (from, rate) = (
                            Vector::load(s, origin, part),
                            Vector::load(s, direction, part),
                        );
                        LineRanges::coordinate(s, from, rate, t)
                    }
                    LineInput::Range { value, slope } => LineRanges {
                        value: LaneBounds::load(s, value, part),
                        slope: LaneBounds::load(s, slope, part),
                        is_number: false,
                    },
                };
                if !input.is_bounded() {
                    return false;
                }
            }
            waves.fill(None);
            for instruction in &tape.instructions {
                let found = match instruction.operation {
                    TapeOperation::Unary(op @ (Unary::Sin | Unary::Cos), Operand::Input(input)) => {
                        let input = input as usize;
                        let known: Option<[LineRanges<S>; 2]> = waves[input];
                        let [sine, cosine] = match known {
                            Some(known) => known,
                            None => {
                                let found = inputs[input].waves(s);
                                waves[input] = Some(found);
                                found
                            }
                        };
                        if op == Unary::Sin { sine } else { cosine }
                    }
                    TapeOperation::Unary(op, a) => {
                        let a = read(s, &registers, &inputs, a);
                        match op {
                            Unary::Neg => a.negative(),
                            Unary::Sin => a.waves(s)[0],
                            Unary::Cos => a.waves(s)[1],
                            _ => return false,
                        }
                    }
                    TapeOperation::Binary(Binary::Mul, a, b) if a == b => {
                        read(s, &registers, &inputs, a).square(s)
                    }
                    TapeOperation::Binary(op, a, b) => {
                        let a = read(s, &registers, &inputs, a);
                        let b = read(s, &registers, &inputs, b);
                        match op {
                            Binary::Add => a.sum(s, b),
                            Binary::Sub => a.sum(s, b.negative()),
                            Binary::Mul => a.product(s, b),
                            _ => return false,
                        }
                    }
                    TapeOperation::Power(a, 2) => read(s, &registers, &inputs, a).square(s),
                    TapeOperation::Power(..) => return false,
                    TapeOperation::Copy(a) => read(s, &registers, &inputs, a),
                };
                if !found.is_bounded() {
                    return false;
                }
                registers[instruction.out as usize] = found;
            }
            let found = read(s, &registers, &inputs, root);
            if !found.is_bounded() {
                return false;
            }
            let [a, b, c, d] = &mut *bounds;
            found.value.lower.store(a, part);
            found.value.upper.store(b, part);
            found.slope.lower.store(c, part);
            found.slope.upper.store(d, part);
        }
        true
    }
}

#[inline(always)]
fn read<S: Instructions>(
    s: S,
    registers: &[LineRanges<S>],
    inputs: &[LineRanges<S>],
    operand: Operand,
) -> LineRanges<S> {
    match operand {
        Operand::Constant(x) => LineRanges::number(s, x),
        Operand::Input(position) => inputs[position as usize],
        Operand::Register(register) => registers[register as usize],
    }
}

impl<S: Instructions> LineRanges<S> {
    #[inline(always)]
    fn number(s: S, x: f64) -> Self {
        Self {
            value: LaneBounds::point(Vector::splat(s, x)),
            slope: LaneBounds::point(Vector::splat(s, 0.0)),
            is_number: true,
        }
    }

    /// `from` + t·`rate`.
    #[inline(always)]
    fn coordinate(s: S, from: Vector<S>, rate: Vector<S>, t: Interval) -> Self {
        let times = LaneBounds {
            lower: Vector::splat(s, t.lower()),
            upper: Vector::splat(s, t.upper()),
        };
        let rates = LaneBounds::point(rate);
        Self {
            value: LaneBounds::point(from).sum(s, times.product(s, rates)),
            slope: rates,
            is_number: false,
        }
    }

    #[inline(always)]
    fn is_bounded(&self) -> bool {
        let Self { value, slope, .. } = self;
        let all = value.lower.is_finite()
            & value.upper.is_finite()
            & slope.lower.is_finite()
            & slope.upper.is_finite();
        !(!all).any()
    }

    #[inline(always)]
    fn negative(self) -> Self {
        Self {
            value: self.value.negative(),
            slope: self.slope.negative(),
            ..self
        }
    }

    #[inline(always)]
    fn sum(self, s: S, other: Self) -> Self {
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
    fn product(self, s: S, other: Self) -> Self {
        Self {
            value: self.value.product(s, other.value),
            slope: if self.is_number && other.is_number {
                self.slope
            } else if other.is_number {
                self.slope.product(s, other.value)
            } else if self.is_number {
                self.value.product(s, other.slope)
            } else {
                let first = self.slope.product(s, other.value);
                first.sum(s, self.value.product(s, other.slope))
            },
            is_number: self.is_number && other.is_number,
        }
    }

    #[inline(always)]
    fn square(self, s: S) -> Self {
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

    /// Sine and cosine, each the other's slope.
    #[inline(always)]
    fn waves(&self, s: S) -> [Self; 2] {
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
    fn load(s: S, [lower, upper]: &[[f64; MOST_LANES]; 2], part: usize) -> Self {
        Self {
            lower: Vector::load(s, lower, part),
            upper: Vector::load(s, upper, part),
        }
    }

    #[inline(always)]
    fn point(x: Vector<S>) -> Self {
        Self { lower: x, upper: x }
    }

    #[inline(always)]
    fn negative(self) -> Self {
        Self {
            lower: -self.upper,
            upper: -self.lower,
        }
    }

    /// Wider by at least a unit in the last place, and by more than the least normal number.
    #[inline(always)]
    fn widened(self, s: S) -> Self {
        let unit = Vector::splat(s, f64::EPSILON);
        let least = Vector::splat(s, f64::MIN_POSITIVE);
        Self {
            lower: self.lower - (self.lower.abs() * unit + least),
            upper: self.upper + (self.upper.abs() * unit + least),
        }
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
        let a = self.lower * other.lower;
        let b = self.lower * other.upper;
        let c = self.upper * other.lower;
        let d = self.upper * other.upper;
        let product = Self {
            lower: a.least(b).least(c.least(d)),
            upper: a.greatest(b).greatest(c.greatest(d)),
        };
        product.widened(s)
    }

    /// The values of sine and cosine. In quarters of a turn, the sine has its crests at 1 + 4k and its troughs at 3 + 4k, the
    /// cosine at 4k and 2 + 4k.
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
        let (sines, cosines) = self.ends(s);
        let is_precise = size.lt(number(elementary::LARGEST_ANGLE));
        let far = !is_precise;
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

    /// Sine and cosine at both ends.
    #[inline(always)]
    fn ends(self, s: S) -> (Self, Self) {
        let mut ends = [[0.0; MOST_LANES]; 2];
        let [lower, upper] = &mut ends;
        self.lower.store(lower, 0);
        self.upper.store(upper, 0);
        let mut waves = [[0.0; MOST_LANES]; 4];
        let [a, b, c, d] = &mut waves;
        match Vector::<S>::PARTS {
            1 => {
                (*a, *c) = elementary::sin_cos(lower);
                (*b, *d) = elementary::sin_cos(upper);
            }
            2 => {
                let at = |ends: &[f64; MOST_LANES]| {
                    let [x, y, z, w, ..] = *ends;
                    elementary::sin_cos(&[x, y, z, w])
                };
                for (ends, sine, cosine) in [(&*lower, &mut *a, &mut *c), (&*upper, b, d)] {
                    let found = at(ends);
                    sine[..4].copy_from_slice(&found.0);
                    cosine[..4].copy_from_slice(&found.1);
                }
            }
            _ => {
                for lane in 0..MOST_LANES / Vector::<S>::PARTS {
                    (a[lane], c[lane]) = lower[lane].sin_cos();
                    (b[lane], d[lane]) = upper[lane].sin_cos();
                }
            }
        }
        let [a, b, c, d] = &waves;
        let sines = Self {
            lower: Vector::load(s, a, 0),
            upper: Vector::load(s, b, 0),
        };
        let cosines = Self {
            lower: Vector::load(s, c, 0),
            upper: Vector::load(s, d, 0),
        };
        (sines, cosines)
    }

    /// The values of a wave with these values at its ends, to four units in the last place, and these extremes between.
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

    /// False only where no place + 4k, k an integer, lies between.
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
        let zero = Vector::splat(s, 0.0);
        let (a, b) = (self.lower.abs(), self.upper.abs());
        let (least, most) = (a.least(b), a.greatest(b));
        let crosses = self.lower.le(zero) & zero.le(self.upper);
        let square = Self {
            lower: crosses.choose(zero, least * least),
            upper: most * most,
        };
        let square = square.widened(s);
        Self {
            lower: square.lower.greatest(zero),
            ..square
        }
    }
}
