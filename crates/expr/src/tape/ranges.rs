//! Evaluation on intervals.
//!
//! In: an interval for each input. Out: for each root an interval that contains its values, by the same instructions
//! that evaluate numbers; with slopes, also their derivatives along a line; or the linear functions of two coordinates
//! that the values are near.

use crate::interval::{Affine, Interval, Slope};
use crate::ops::{Binary, Unary};
use crate::tape::{Operand, Registers, Tape, TapeOperation};

/// Sine and cosine of inputs, which often occur together.
pub(super) type InputWaves<R> = Vec<(u32, [R; 2])>;

/// The numbers that instructions compute with.
trait Range: Copy {
    fn constant(x: f64) -> Self;
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
    /// If `inputs` or `out` has a different length.
    pub fn eval_intervals(
        &self,
        registers: &mut Registers,
        inputs: &[Interval],
        out: &mut [Interval],
    ) {
        let Registers {
            intervals,
            interval_waves,
            ..
        } = registers;
        self.eval_ranges(intervals, interval_waves, inputs, out);
    }

    /// Evaluates with slopes along a line.
    ///
    /// # Panics
    /// If the length of `inputs` differs from that of [`Tape::inputs`], or that of `out` from the number of roots.
    pub fn eval_slopes(&self, registers: &mut Registers, inputs: &[Slope], out: &mut [Slope]) {
        let Registers {
            slopes,
            slope_waves,
            ..
        } = registers;
        self.eval_ranges(slopes, slope_waves, inputs, out);
    }

    /// Evaluates near linear functions on a rectangle.
    ///
    /// # Panics
    /// If `inputs` or `out` is not of the length of [`Tape::inputs`] or of the roots.
    pub fn eval_affine(&self, registers: &mut Registers, inputs: &[Affine], out: &mut [Affine]) {
        let Registers {
            affines,
            affine_waves,
            ..
        } = registers;
        self.eval_ranges(affines, affine_waves, inputs, out);
    }

    fn eval_ranges<R: Range>(
        &self,
        registers: &mut Vec<R>,
        waves: &mut InputWaves<R>,
        inputs: &[R],
        out: &mut [R],
    ) {
        assert_eq!(inputs.len(), self.inputs.len(), "one range per input");
        assert_eq!(out.len(), self.roots.len(), "one place per root");
        if registers.len() < self.register_count {
            registers.resize(self.register_count, R::constant(0.0));
        }
        waves.clear();
        let read = |registers: &[R], operand| match operand {
            Operand::Constant(value) => R::constant(value),
            Operand::Input(position) => inputs[position as usize],
            Operand::Register(register) => registers[register as usize],
        };
        for instruction in &self.instructions {
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
                TapeOperation::Unary(op, a) => R::unary(op, read(registers, a)),
                TapeOperation::Binary(Binary::Mul, a, b) if a == b => read(registers, a).square(),
                TapeOperation::Binary(op, a, b) => {
                    R::binary(op, read(registers, a), read(registers, b))
                }
                TapeOperation::Power(a, n) => read(registers, a).integer_power(n),
            };
        }
        for (out, &root) in out.iter_mut().zip(&self.roots) {
            *out = read(registers, root);
        }
    }
}

/// Implements [`Range`] by the type's own methods, of which only the constructor of a constant has several names.
macro_rules! ranges {
    ($($range:ty, $constant:ident;)+) => {$(
        impl Range for $range {
            fn constant(x: f64) -> Self {
                Self::$constant(x)
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
    )+};
}

ranges! {
    Interval, point;
    Slope, constant;
    Affine, constant;
}
