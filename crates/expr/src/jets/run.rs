//! From code to numbers: an interpreter over lanes.
//!
//! What flows in: code, fixed numbers, points. What flows out: coefficients. An instruction is decoded once for all
//! lanes; lanes are worked on in lines of eight numbers, which is what one processor's vectors hold, one line of
//! another's cache. All arithmetic is that of [`crate::ops`] and [`crate::elementary`], the same for any number of
//! lanes.

use crate::arithmetic::{power, sign, zmul};
use crate::elementary;
use crate::jets::assemble::{Code, FIRST_FIXED, Instruction, Op};
use crate::processor::{Processor, Work};

/// Registers, reused between evaluations so that none allocates. One per thread, for any tapes.
#[derive(Clone, Debug, Default)]
pub struct JetRegisters {
    numbers: Vec<f64>,
    /// Whose fixed numbers stand in the registers, and in how many lanes; 0 for nobody's.
    filled: (u64, usize),
    processor: Processor,
}

/// How many numbers a line of cache holds.
const LINE: usize = 8;

impl JetRegisters {
    /// Registers for a kind of processor that is not this one's best.
    pub fn on(processor: Processor) -> Self {
        Self {
            processor,
            ..Self::default()
        }
    }

    pub(super) fn run<const N: usize, const K: usize>(
        &mut self,
        code: &Code,
        fixed: &[f64],
        identity: u64,
        at: &[[f64; N]; 2],
        out: [&mut [[f64; N]]; K],
    ) {
        let length = code.register_count * N;
        if self.numbers.len() < length + LINE {
            self.numbers = vec![0.0; length + LINE];
            self.filled = (0, 0);
        }
        // Registers begin where a line does, so that no vector straddles two.
        let start = self.numbers.as_ptr().align_offset(size_of::<[f64; LINE]>());
        let start = if start < LINE { start } else { 0 };
        let registers = &mut self.numbers[start..start + length];
        if self.filled != (identity, N) {
            self.filled = (identity, N);
            let places = registers[FIRST_FIXED * N..].chunks_exact_mut(N);
            for (place, &number) in places.zip(fixed) {
                place.fill(number);
            }
        }
        let out = out.map(<[[f64; N]]>::as_flattened_mut);
        match N {
            1 => whole::<1, 1, N, K>(code, registers, at, out),
            8 => self.processor.run(Run::<1, N, K> {
                code,
                registers,
                at,
                out,
            }),
            64 => self.processor.run(Run::<8, N, K> {
                code,
                registers,
                at,
                out,
            }),
            _ => whole::<1, N, N, K>(code, registers, at, out),
        }
    }
}

/// An evaluation with `COUNT` lines to a register.
struct Run<'a, const COUNT: usize, const N: usize, const K: usize> {
    code: &'a Code,
    registers: &'a mut [f64],
    at: &'a [[f64; N]; 2],
    out: [&'a mut [f64]; K],
}

impl<const COUNT: usize, const N: usize, const K: usize> Work for Run<'_, COUNT, N, K> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        whole::<LINE, COUNT, N, K>(self.code, self.registers, self.at, self.out);
    }
}

/// Points in, code, coefficients out; N = W·COUNT.
#[inline(always)]
fn whole<const W: usize, const COUNT: usize, const N: usize, const K: usize>(
    code: &Code,
    registers: &mut [f64],
    at: &[[f64; N]; 2],
    out: [&mut [f64]; K],
) {
    let (registers, _) = registers.as_chunks_mut::<W>();
    let (at, _) = at.as_flattened().as_chunks::<W>();
    registers[..2 * COUNT].copy_from_slice(at);
    run_lines::<W, COUNT>(code, registers);
    let per_coefficient = code.places.chunks_exact((code.places.len() / K).max(1));
    for (places, out) in per_coefficient.zip(out) {
        let (out, _) = out.as_chunks_mut::<W>();
        for (&(register, flip), out) in places.iter().zip(out.chunks_exact_mut(COUNT)) {
            let first = register as usize * COUNT;
            for (out, line) in out.iter_mut().zip(&registers[first..first + COUNT]) {
                let mut lanes = [0.0; W];
                for lane in 0..W {
                    lanes[lane] = f64::from_bits(line[lane].to_bits() ^ flip);
                }
                *out = lanes;
            }
        }
    }
}

/// Runs code over registers of `COUNT` lines of `W` lanes.
#[inline(always)]
fn run_lines<const W: usize, const COUNT: usize>(code: &Code, registers: &mut [[f64; W]]) {
    for instruction in &code.instructions {
        step::<W, COUNT>(instruction, registers);
    }
}

/// Runs one instruction, line by line. Macros rather than closures: what is not inlined is not compiled for the
/// processor at hand.
#[inline(always)]
fn step<const W: usize, const COUNT: usize>(i: &Instruction, registers: &mut [[f64; W]]) {
    macro_rules! read {
        ($line:ident, $k:literal) => {
            registers[i.operands[$k] as usize * COUNT + $line]
        };
    }
    macro_rules! each {
        (|$($x:ident = $k:literal),+| $value:expr) => {
            for line in 0..COUNT {
                $(let $x = read!(line, $k);)+
                let mut out = [0.0; W];
                for lane in 0..W {
                    $(let $x = $x[lane];)+
                    out[lane] = $value;
                }
                registers[i.out as usize * COUNT + line] = out;
            }
        };
    }
    macro_rules! one {
        ($f:path) => {
            for line in 0..COUNT {
                let x = read!(line, 0);
                registers[i.out as usize * COUNT + line] = $f(&x);
            }
        };
    }
    macro_rules! pair {
        ($f:path) => {
            for line in 0..COUNT {
                let x = read!(line, 0);
                let (first, second) = $f(&x);
                registers[i.out as usize * COUNT + line] = first;
                registers[i.second as usize * COUNT + line] = second;
            }
        };
    }
    match i.op {
        Op::Add => each!(|a = 0, b = 1| a + b),
        Op::Sub => each!(|a = 0, b = 1| a - b),
        Op::Mul => each!(|a = 0, b = 1| a * b),
        Op::Div => each!(|a = 0, b = 1| a / b),
        Op::Pow => each!(|a = 0, b = 1| power(a, b)),
        Op::Zmul => each!(|a = 0, b = 1| zmul(a, b)),
        Op::ProductPlus => each!(|a = 0, b = 1, c = 2| a * b + c),
        Op::ProductMinus => each!(|a = 0, b = 1, c = 2| a * b - c),
        Op::MinusProduct => each!(|a = 0, b = 1, c = 2| c - a * b),
        Op::ProductsPlus => each!(|a = 0, b = 1, c = 2, d = 3| a * b + c * d),
        Op::ProductsMinus => each!(|a = 0, b = 1, c = 2, d = 3| a * b - c * d),
        Op::Neg => each!(|a = 0| -a),
        Op::Sqrt => each!(|a = 0| a.sqrt()),
        Op::Abs => each!(|a = 0| a.abs()),
        Op::Sign => each!(|a = 0| sign(a)),
        Op::Asin => each!(|a = 0| a.asin()),
        Op::Acos => each!(|a = 0| a.acos()),
        Op::Atan => each!(|a = 0| a.atan()),
        Op::Tan => one!(elementary::tan),
        Op::Exp => one!(elementary::exp),
        Op::Log => one!(elementary::log),
        Op::Tanh => one!(elementary::tanh),
        Op::SinCos => pair!(elementary::sin_cos),
        Op::SinhCosh => pair!(elementary::sinh_cosh),
    }
}
