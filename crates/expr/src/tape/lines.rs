//! Evaluation with slopes along several lines at once.
//!
//! In: for each input a number, or the starts and rates of a coordinate along the lines of a block; and an interval of each
//! line. Out: values and slopes for each line, as [`Tape::eval_slopes`] returns them for one, in bounds that may be wider by
//! a few ulps. Tapes with powers by numbers, or with other rare operations, must use [`Tape::eval_slopes`], and so must lines
//! with an unbounded intermediate result.

use crate::interval::{Interval, Slope};
use crate::ops::{Binary, Unary};
use crate::processor::Processor;
use crate::tape::{Operand, Tape, TapeOperation};
use crate::vectors::{Instructions, MOST_LANES, Vector, VectorWork};
use bounds::{KnownLines, LaneBounds, LineRanges};

mod bounds;

/// The values of an input on the lines of a block.
#[derive(Clone, Copy, Debug)]
pub enum LineInput<'a> {
    /// The same number everywhere.
    Number(f64),
    /// On each line `origin` + t·`direction`.
    Coordinate {
        /// The starts.
        origin: &'a [f64; MOST_LANES],
        /// The rates.
        direction: &'a [f64; MOST_LANES],
    },
    /// On each line any of `origin` + t·`direction`, where both are between two bounds, the lower one first.
    Bundle {
        /// The starts.
        origin: [f64; 2],
        /// The rates.
        direction: [f64; 2],
    },
}

impl Tape {
    /// Returns true if [`Tape::eval_slopes_on_lines`] supports all operations, and no constant is NaN.
    pub fn is_of_vectors(&self) -> bool {
        let is_number = |operand: Operand| match operand {
            Operand::Constant(x) => !x.is_nan(),
            _ => true,
        };
        let is_known = |operation: TapeOperation| match operation {
            TapeOperation::Unary(op, _) => matches!(
                op,
                Unary::Neg
                    | Unary::Sin
                    | Unary::Cos
                    | Unary::Exp
                    | Unary::Log
                    | Unary::Sqrt
                    | Unary::Asin
                    | Unary::Acos
                    | Unary::Atan
                    | Unary::Abs
            ),
            TapeOperation::Binary(op, ..) => matches!(
                op,
                Binary::Add | Binary::Sub | Binary::Mul | Binary::Div | Binary::Min | Binary::Max
            ),
            TapeOperation::Power(_, n) => matches!(n, 3 | 4),
        };
        let mut operations = self.instructions.iter().map(|it| it.operation);
        operations.all(|operation| {
            let (first, second) = operation.operands();
            is_known(operation) && is_number(first) && second.is_none_or(is_number)
        })
    }

    /// Evaluates the first root with slopes along the lines of a block, for t on each line from a first bound to a second one
    /// that is not less; `None` for a line with an unbounded intermediate result. [`Tape::is_of_vectors`] must be true for
    /// the tape.
    ///
    /// # Panics
    /// If there are no roots, or not exactly one input for each of [`Tape::inputs`].
    pub fn eval_slopes_on_lines(
        &self,
        processor: Processor,
        inputs: &[LineInput<'_>],
        t: &[[f64; MOST_LANES]; 2],
    ) -> [Option<Slope>; MOST_LANES] {
        assert_eq!(inputs.len(), self.inputs.len(), "one value per input");
        let mut found = FoundOnLines {
            bounds: [[f64::NAN; MOST_LANES]; 4],
            partial: [0.0; MOST_LANES],
        };
        processor.run_vectors(OnLines {
            tape: self,
            inputs,
            t,
            found: &mut found,
        });
        std::array::from_fn(|lane| found.slope(lane))
    }
}

/// The results on the lines of a block.
struct FoundOnLines {
    /// The lower and the upper values, then the lower and the upper slopes. For values: NaN means unknown; lower > upper means
    /// that every value is undefined. For slopes: NaN means unbounded.
    bounds: [[f64; MOST_LANES]; 4],
    /// Non-zero where a value may be undefined.
    partial: [f64; MOST_LANES],
}

impl FoundOnLines {
    /// Stores the result in a part of the lanes.
    #[inline(always)]
    fn set_part<S: Instructions>(
        &mut self,
        s: S,
        part: usize,
        found: LineRanges<S>,
        known: KnownLines<S>,
    ) {
        let number = |x: f64| Vector::splat(s, x);
        let [nothing, endless] = [f64::NAN, f64::INFINITY].map(number);
        let KnownLines {
            bounded,
            sloped,
            partial,
            undefined,
        } = known;
        let lower = undefined.choose(endless, nothing);
        let upper = undefined.choose(-endless, nothing);
        let [a, b, c, d] = &mut self.bounds;
        bounded.choose(found.value.lower, lower).store(a, part);
        bounded.choose(found.value.upper, upper).store(b, part);
        sloped.choose(found.slope.lower, nothing).store(c, part);
        sloped.choose(found.slope.upper, nothing).store(d, part);
        partial
            .choose(number(1.0), number(0.0))
            .store(&mut self.partial, part);
    }

    fn slope(&self, lane: usize) -> Option<Slope> {
        let [a, b, c, d] = self.bounds.map(|bounds| bounds[lane]);
        if a.is_nan() {
            return None;
        }
        let value = Interval::new(a, b);
        Some(Slope {
            value: match self.partial[lane] == 0.0 {
                true => value,
                false => value.union(Interval::UNDEFINED),
            },
            slope: match c.is_nan() || value.is_empty() {
                true => Interval::WHOLE,
                false => Interval::new(c, d),
            },
        })
    }
}

/// The evaluation.
struct OnLines<'a> {
    tape: &'a Tape,
    inputs: &'a [LineInput<'a>],
    t: &'a [[f64; MOST_LANES]; 2],
    found: &'a mut FoundOnLines,
}

impl VectorWork for OnLines<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) {
        let Self {
            tape,
            inputs: given,
            t,
            found: out,
        } = self;
        let zero = LineRanges::number(s, 0.0);
        let mut registers = vec![zero; tape.register_count];
        let mut inputs = vec![zero; given.len()];
        // Sine and cosine of each input.
        let mut waves = vec![None; given.len()];
        for part in 0..Vector::<S>::PARTS {
            let mut known = KnownLines::new(s);
            let times = LaneBounds::load(s, t, part);
            for (input, given) in inputs.iter_mut().zip(given) {
                *input = input_ranges(s, given, part, times);
                known.note(input);
            }
            waves.fill(None);
            for instruction in &tape.instructions {
                if !known.bounded.any() {
                    break;
                }
                let values = OperandRanges {
                    registers: &registers,
                    inputs: &inputs,
                };
                let found = values.result(s, instruction.operation, &mut waves, &mut known);
                known.note(&found);
                registers[instruction.out as usize] = found;
            }
            let values = OperandRanges {
                registers: &registers,
                inputs: &inputs,
            };
            let found = values.read(s, tape.roots[0]);
            known.note(&found);
            out.set_part(s, part, found, known);
        }
    }
}

/// Returns the values and slopes of an input in a part of the lanes, at these times.
#[inline(always)]
fn input_ranges<S: Instructions>(
    s: S,
    given: &LineInput<'_>,
    part: usize,
    times: LaneBounds<S>,
) -> LineRanges<S> {
    match *given {
        LineInput::Number(x) => LineRanges::number(s, x),
        LineInput::Coordinate { origin, direction } => {
            let from = LaneBounds::point(Vector::load(s, origin, part));
            let rate = LaneBounds::point(Vector::load(s, direction, part));
            LineRanges::coordinate(s, from, rate, times)
        }
        LineInput::Bundle { origin, direction } => {
            let [from, rate] = [origin, direction].map(|[lower, upper]| LaneBounds {
                lower: Vector::splat(s, lower),
                upper: Vector::splat(s, upper),
            });
            LineRanges::coordinate(s, from, rate, times)
        }
    }
}

/// The values and slopes that instructions read.
struct OperandRanges<'a, S: Instructions> {
    registers: &'a [LineRanges<S>],
    inputs: &'a [LineRanges<S>],
}

impl<S: Instructions> OperandRanges<'_, S> {
    /// Returns the result of an operation; `waves` keeps the sines and cosines of inputs.
    #[inline(always)]
    fn result(
        &self,
        s: S,
        operation: TapeOperation,
        waves: &mut [Option<[LineRanges<S>; 2]>],
        known: &mut KnownLines<S>,
    ) -> LineRanges<S> {
        match operation {
            TapeOperation::Unary(op @ (Unary::Sin | Unary::Cos), a) => {
                let seen: Option<[LineRanges<S>; 2]> = match a {
                    Operand::Input(input) => waves[input as usize],
                    _ => None,
                };
                let found = match seen {
                    Some(found) => found,
                    None => self.read(s, a).waves(s),
                };
                if let Operand::Input(input) = a {
                    waves[input as usize] = Some(found);
                }
                let [sine, cosine] = found;
                if op == Unary::Sin { sine } else { cosine }
            }
            TapeOperation::Unary(op, a) => {
                let a = self.read(s, a);
                match op {
                    Unary::Neg => a.negative(),
                    Unary::Abs => a.size(s),
                    _ => a.elementary(s, op, known),
                }
            }
            TapeOperation::Binary(Binary::Mul, a, b) if a == b => self.read(s, a).square(s),
            TapeOperation::Binary(op, a, b) => {
                let a = self.read(s, a);
                let b = self.read(s, b);
                match op {
                    Binary::Add => a.sum(s, b),
                    Binary::Sub => a.sum(s, b.negative()),
                    Binary::Mul => a.product(s, b),
                    Binary::Div => a.quotient(s, b),
                    Binary::Max => a.greatest(b),
                    Binary::Min => a.negative().greatest(b.negative()).negative(),
                    // [`Tape::is_of_vectors`] is false for the others.
                    _ => LineRanges::number(s, f64::NAN),
                }
            }
            TapeOperation::Power(a, n) => {
                let a = self.read(s, a);
                match n {
                    3 => a.cube(s),
                    4 => a.square(s).square(s),
                    // [`Tape::is_of_vectors`] is false for the others.
                    _ => LineRanges::number(s, f64::NAN),
                }
            }
        }
    }

    #[inline(always)]
    fn read(&self, s: S, operand: Operand) -> LineRanges<S> {
        match operand {
            Operand::Constant(x) => LineRanges::number(s, x),
            Operand::Input(position) => self.inputs[position as usize],
            Operand::Register(register) => self.registers[register as usize],
        }
    }
}
