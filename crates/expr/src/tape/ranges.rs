//! Evaluation on intervals, and shorter tapes for a box.
//!
//! Input: an interval for each input. Output: for each root an interval that its values do not leave, by the same
//! instructions that evaluate numbers; with slopes, their derivatives along a line too. An evaluation notes which operand
//! of each `min`, `max` and `abs` counts everywhere in the box; [`Tape::pruned`] leaves out what only the others need.

use crate::interval::{Interval, Slope};
use crate::ops::{Binary, Unary};
use crate::tape::{Instruction, Operand, Registers, Tape, TapeOperation};

/// The operand of an instruction that counts in a box.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Branch {
    First,
    Second,
    /// Both may, or the instruction does not choose.
    Open,
}

/// Sine and cosine of inputs, which often occur together.
pub(super) type InputWaves<R> = Vec<(u32, [R; 2])>;

/// The numbers that instructions compute with.
trait Range: Copy {
    fn constant(x: f64) -> Self;
    fn interval(self) -> Interval;
    fn unary(op: Unary, a: Self) -> Self;
    /// Sine and cosine.
    fn waves(self) -> [Self; 2];
    fn binary(op: Binary, a: Self, b: Self) -> Self;
    fn square(self) -> Self;
    fn integer_power(self, n: i32) -> Self;
}

impl Tape {
    /// Evaluates on a box: an interval for each of [`Tape::inputs`], and one for each root.
    ///
    /// # Panics
    /// If `inputs` or `out` is not of this length.
    pub fn eval_intervals(
        &self,
        registers: &mut Registers,
        inputs: &[Interval],
        out: &mut [Interval],
    ) {
        let Registers {
            intervals,
            interval_waves,
            choices,
            ..
        } = registers;
        self.eval_ranges(intervals, interval_waves, choices, inputs, out);
    }

    /// Evaluates with slopes along a line.
    ///
    /// # Panics
    /// If `inputs` or `out` is not of the length of [`Tape::inputs`] or of the roots.
    pub fn eval_slopes(&self, registers: &mut Registers, inputs: &[Slope], out: &mut [Slope]) {
        let Registers {
            slopes,
            slope_waves,
            choices,
            ..
        } = registers;
        self.eval_ranges(slopes, slope_waves, choices, inputs, out);
    }

    /// Returns the tape without what has no influence in the box that the registers were last used for, with this
    /// tape, by an evaluation of intervals or slopes; `None` if nothing can be left out.
    pub fn pruned(&self, registers: &Registers) -> Option<Tape> {
        let choices = registers.choices.get(..self.instructions.len())?;
        if choices.iter().all(|choice| *choice == Branch::Open) {
            return None;
        }
        let mut wanted = vec![false; self.register_count];
        let want = |wanted: &mut [bool], operand| {
            if let Operand::Register(register) = operand {
                wanted[register as usize] = true;
            }
        };
        for &root in &self.roots {
            want(&mut wanted, root);
        }
        let mut kept = Vec::with_capacity(self.instructions.len());
        for (instruction, choice) in self.instructions.iter().zip(choices).rev() {
            let out = &mut wanted[instruction.out as usize];
            if !std::mem::take(out) {
                continue;
            }
            let operation = instruction.operation.decided(*choice);
            let (first, second) = operation.operands();
            want(&mut wanted, first);
            if let Some(second) = second {
                want(&mut wanted, second);
            }
            let to_itself = TapeOperation::Copy(Operand::Register(instruction.out));
            if operation != to_itself {
                let out = instruction.out;
                kept.push(Instruction { out, operation });
            }
        }
        kept.reverse();
        Some(Tape {
            instructions: kept,
            inputs: self.inputs.clone(),
            roots: self.roots.clone(),
            register_count: self.register_count,
        })
    }

    fn eval_ranges<R: Range>(
        &self,
        registers: &mut Vec<R>,
        waves: &mut InputWaves<R>,
        choices: &mut Vec<Branch>,
        inputs: &[R],
        out: &mut [R],
    ) {
        assert_eq!(inputs.len(), self.inputs.len(), "one range per input");
        assert_eq!(out.len(), self.roots.len(), "one place per root");
        if registers.len() < self.register_count {
            registers.resize(self.register_count, R::constant(0.0));
        }
        choices.clear();
        waves.clear();
        let read = |registers: &[R], operand| match operand {
            Operand::Constant(value) => R::constant(value),
            Operand::Input(position) => inputs[position as usize],
            Operand::Register(register) => registers[register as usize],
        };
        for instruction in &self.instructions {
            let mut choice = Branch::Open;
            registers[instruction.out as usize] = match instruction.operation {
                TapeOperation::Unary(op @ (Unary::Sin | Unary::Cos), Operand::Input(input)) => {
                    let known = waves.iter().find(|(other, _)| *other == input);
                    let known = known.map(|(_, known)| *known);
                    let [sine, cosine] = known.unwrap_or_else(|| {
                        let found = inputs[input as usize].waves();
                        waves.push((input, found));
                        found
                    });
                    if op == Unary::Sin { sine } else { cosine }
                }
                TapeOperation::Unary(op, a) => {
                    let a = read(registers, a);
                    choice = choice_of_unary(op, a.interval());
                    R::unary(op, a)
                }
                TapeOperation::Binary(Binary::Mul, a, b) if a == b => read(registers, a).square(),
                TapeOperation::Binary(op, a, b) => {
                    let (a, b) = (read(registers, a), read(registers, b));
                    choice = choice_of_binary(op, a.interval(), b.interval());
                    R::binary(op, a, b)
                }
                TapeOperation::Power(a, n) => read(registers, a).integer_power(n),
                TapeOperation::Copy(a) => read(registers, a),
            };
            choices.push(choice);
        }
        for (out, &root) in out.iter_mut().zip(&self.roots) {
            *out = read(registers, root);
        }
    }
}

/// For `abs`, the first choice is the operand, the second its negative.
fn choice_of_unary(op: Unary, a: Interval) -> Branch {
    if op != Unary::Abs || a.is_empty() {
        Branch::Open
    } else if a.lower() > 0.0 {
        Branch::First
    } else if a.upper() < 0.0 {
        Branch::Second
    } else {
        Branch::Open
    }
}

fn choice_of_binary(op: Binary, a: Interval, b: Interval) -> Branch {
    // What is left out must be defined: else the result is not.
    if a.is_partial() || b.is_partial() {
        return Branch::Open;
    }
    let (first, second) = match op {
        Binary::Min => (a.upper() <= b.lower(), b.upper() < a.lower()),
        Binary::Max => (a.lower() >= b.upper(), b.lower() > a.upper()),
        _ => (false, false),
    };
    match (first, second) {
        (true, _) => Branch::First,
        (false, true) => Branch::Second,
        (false, false) => Branch::Open,
    }
}

impl TapeOperation {
    /// The operation with its choice made.
    fn decided(self, choice: Branch) -> Self {
        match (self, choice) {
            (_, Branch::Open) => self,
            (Self::Unary(_, a), Branch::First) => Self::Copy(a),
            (Self::Unary(_, a), Branch::Second) => Self::Unary(Unary::Neg, a),
            (Self::Binary(_, a, _), Branch::First) => Self::Copy(a),
            (Self::Binary(_, _, b), Branch::Second) => Self::Copy(b),
            (Self::Power(..) | Self::Copy(_), _) => self,
        }
    }

    pub(super) fn operands(self) -> (Operand, Option<Operand>) {
        match self {
            Self::Unary(_, a) | Self::Power(a, _) | Self::Copy(a) => (a, None),
            Self::Binary(_, a, b) => (a, Some(b)),
        }
    }
}

impl Range for Interval {
    fn constant(x: f64) -> Self {
        Self::point(x)
    }

    fn interval(self) -> Interval {
        self
    }

    fn unary(op: Unary, a: Self) -> Self {
        Self::unary(op, a)
    }

    fn waves(self) -> [Self; 2] {
        self.waves()
    }

    fn binary(op: Binary, a: Self, b: Self) -> Self {
        Self::binary(op, a, b)
    }

    fn square(self) -> Self {
        self.square()
    }

    fn integer_power(self, n: i32) -> Self {
        self.integer_power(n)
    }
}

impl Range for Slope {
    fn constant(x: f64) -> Self {
        Self::constant(x)
    }

    fn interval(self) -> Interval {
        self.value
    }

    fn unary(op: Unary, a: Self) -> Self {
        Self::unary(op, a)
    }

    fn waves(self) -> [Self; 2] {
        self.waves()
    }

    fn binary(op: Binary, a: Self, b: Self) -> Self {
        Self::binary(op, a, b)
    }

    fn square(self) -> Self {
        self.square()
    }

    fn integer_power(self, n: i32) -> Self {
        self.integer_power(n)
    }
}
