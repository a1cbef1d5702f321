//! Evaluation at as many points as a vector has lanes.
//!
//! In: a vector for each input. Out: the values of the first root. Sums, products, quotients, roots, sines and cosines are
//! computed in vectors, other operations lane by lane. Sine and cosine are those of [`crate::elementary`], so their values
//! may differ from those of [`Tape::eval`] in the last place; the other operations agree to the last bit.

use crate::ops::{Binary, Unary};
use crate::tape::{Operand, Tape, TapeOperation};
use crate::vectors::{Instructions, Vector};

/// Registers of vectors, for one tape.
#[derive(Debug)]
pub struct VectorRegisters<S: Instructions> {
    numbers: Vec<Vector<S>>,
    /// Sine and cosine of each input, which often occur together.
    waves: Vec<Option<(Vector<S>, Vector<S>)>>,
}

impl<S: Instructions> VectorRegisters<S> {
    /// Creates registers for evaluations of the tape.
    #[inline(always)]
    pub fn new(instructions: S, tape: &Tape) -> Self {
        Self {
            numbers: vec![Vector::splat(instructions, 0.0); tape.register_count],
            waves: vec![None; tape.inputs.len()],
        }
    }
}

impl Tape {
    /// Evaluates the first root at a point in each lane.
    ///
    /// If there are no roots, if there is not exactly one vector for each of [`Tape::inputs`], or if the registers are those
    /// of another tape.
    #[inline(always)]
    pub fn eval_vector<S: Instructions>(
        &self,
        s: S,
        registers: &mut VectorRegisters<S>,
        inputs: &[Vector<S>],
    ) -> Vector<S> {
        assert_eq!(inputs.len(), self.inputs.len(), "one vector per input");
        let VectorRegisters { numbers, waves } = registers;
        waves.fill(None);
        for instruction in &self.instructions {
            let value = match instruction.operation {
                TapeOperation::Unary(op @ (Unary::Sin | Unary::Cos), a) => {
                    let known = match a {
                        Operand::Input(input) => waves[input as usize],
                        _ => None,
                    };
                    let (sine, cosine) = match known {
                        Some(known) => known,
                        None => read(s, numbers, inputs, a).sin_cos(),
                    };
                    if let Operand::Input(input) = a {
                        waves[input as usize] = Some((sine, cosine));
                    }
                    if op == Unary::Sin { sine } else { cosine }
                }
                TapeOperation::Unary(op, a) => {
                    let a = read(s, numbers, inputs, a);
                    match op {
                        Unary::Neg => -a,
                        Unary::Abs => a.abs(),
                        Unary::Sqrt => a.sqrt(),
                        op => a.map(|a| op.eval(a)),
                    }
                }
                TapeOperation::Binary(op, a, b) => {
                    let a = read(s, numbers, inputs, a);
                    let b = read(s, numbers, inputs, b);
                    match op {
                        Binary::Add => a + b,
                        Binary::Sub => a - b,
                        Binary::Mul => a * b,
                        Binary::Div => a / b,
                        op => a.map_with(b, |a, b| op.eval(a, b)),
                    }
                }
                TapeOperation::Power(a, n) => integer_power(s, read(s, numbers, inputs, a), n),
            };
            numbers[instruction.out as usize] = value;
        }
        read(s, numbers, inputs, self.roots[0])
    }
}

#[inline(always)]
fn read<S: Instructions>(
    s: S,
    registers: &[Vector<S>],
    inputs: &[Vector<S>],
    operand: Operand,
) -> Vector<S> {
    match operand {
        Operand::Constant(x) => Vector::splat(s, x),
        Operand::Input(position) => inputs[position as usize],
        Operand::Register(register) => registers[register as usize],
    }
}

/// The multiplications of [`crate::ops::integer_power`].
#[inline(always)]
fn integer_power<S: Instructions>(s: S, x: Vector<S>, n: i32) -> Vector<S> {
    let one = Vector::splat(s, 1.0);
    let mut remaining = n.unsigned_abs();
    let (mut square, mut result) = (x, one);
    while remaining != 0 {
        if remaining & 1 == 1 {
            result = result * square;
        }
        square = square * square;
        remaining >>= 1;
    }
    if n < 0 { one / result } else { result }
}
