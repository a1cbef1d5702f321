//! From code to numbers: an interpreter over lanes.
//!
//! In: code, fixed numbers, points. Out: coefficients. An instruction is decoded once for all lanes; lanes are
//! processed in lines of eight numbers, which fit one vector of some processors and one cache line of others. All
//! arithmetic is that of [`crate::ops`] and [`crate::elementary`], the same for any number of lanes.

use crate::arithmetic::{at_most, greatest, least, power, sign, zmul};
use crate::elementary;
use crate::jets::assemble::{
    FEW, FIRST_FIXED, Instruction, Instructions, Op, Steps, StraightLineCode,
};
use crate::processor::{Processor, Work};

/// Registers, reused between evaluations to avoid allocations. One set per thread, for any tapes.
#[derive(Clone, Debug, Default)]
pub struct JetRegisters {
    numbers: Vec<f64>,
    /// The owner of the fixed numbers in the registers (0 for none), and the number of lanes.
    filled: (u64, usize),
    processor: Processor,
}

/// The number of numbers in a line.
const LINE: usize = 8;
/// The number of bytes in a cache line.
const CACHE_LINE: usize = 64;

impl JetRegisters {
    /// Creates registers for another kind of processor than the best for this one.
    pub fn on(processor: Processor) -> Self {
        Self {
            processor,
            ..Self::default()
        }
    }

    pub(super) fn run<const N: usize>(
        &mut self,
        code: &StraightLineCode,
        fixed: &[f64],
        identity: u64,
        at: &[[f64; N]; 2],
        out: &mut [[f64; N]],
    ) {
        let length = N * match code.program {
            Instructions::Few(_) => FEW,
            Instructions::Many(_) => code.register_count,
        };
        let slack = CACHE_LINE / size_of::<f64>();
        if self.numbers.len() < length + slack {
            self.numbers = vec![0.0; length + slack];
            self.filled = (0, 0);
        }
        // Align registers to cache lines, so that no vector straddles two.
        let start = self.numbers.as_ptr().align_offset(CACHE_LINE);
        let start = if start < slack { start } else { 0 };
        let registers = &mut self.numbers[start..start + length];
        let (fixed, factors) = fixed.split_at(code.fixed.len());
        if self.filled != (identity, N) {
            self.filled = (identity, N);
            let places = registers[FIRST_FIXED * N..].chunks_exact_mut(N);
            for (place, &number) in places.zip(fixed) {
                place.fill(number);
            }
        }
        let run = Run {
            code,
            factors,
            registers,
            at,
            out,
        };
        match N {
            // One point does not need vectors.
            1 => run.lines::<1, 1, { FEW }>(),
            8 => self.processor.run(Eight(run)),
            64 => self.processor.run(SixtyFour(run)),
            _ => run.lines::<1, N, 0>(),
        }
    }
}

/// An evaluation.
struct Run<'a, const N: usize> {
    code: &'a StraightLineCode,
    /// The factors of the results.
    factors: &'a [f64],
    registers: &'a mut [f64],
    at: &'a [[f64; N]; 2],
    out: &'a mut [[f64; N]],
}

/// One line per register.
struct Eight<'a, const N: usize>(Run<'a, N>);

/// Eight lines per register.
struct SixtyFour<'a, const N: usize>(Run<'a, N>);

impl<const N: usize> Work for Eight<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.0.lines::<LINE, 1, { FEW }>();
    }
}

impl<const N: usize> Work for SixtyFour<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.0.lines::<LINE, 8, { 8 * FEW }>();
    }
}

/// The name of a register.
trait Name: Copy {
    fn index(self) -> usize;
}

impl Name for u8 {
    #[inline(always)]
    fn index(self) -> usize {
        usize::from(self)
    }
}

impl Name for u32 {
    #[inline(always)]
    fn index(self) -> usize {
        self as usize
    }
}

/// The lines that hold registers.
trait Lines<const W: usize> {
    fn get(&self, line: usize) -> [f64; W];
    fn set(&mut self, line: usize, value: [f64; W]);
}

impl<const W: usize> Lines<W> for [[f64; W]] {
    #[inline(always)]
    fn get(&self, line: usize) -> [f64; W] {
        self[line]
    }

    #[inline(always)]
    fn set(&mut self, line: usize, value: [f64; W]) {
        self[line] = value;
    }
}

/// A byte cannot exceed this number of lines, so the compiler omits the bounds checks.
impl<const W: usize, const ALL: usize> Lines<W> for [[f64; W]; ALL] {
    #[inline(always)]
    fn get(&self, line: usize) -> [f64; W] {
        self[line]
    }

    #[inline(always)]
    fn set(&mut self, line: usize, value: [f64; W]) {
        self[line] = value;
    }
}

impl<const N: usize> Run<'_, N> {
    /// Evaluates with `COUNT` lines of `W` lanes per register, N = W·COUNT; `ALL` is the number of lines of [`FEW`]
    /// registers.
    #[inline(always)]
    fn lines<const W: usize, const COUNT: usize, const ALL: usize>(self) {
        let (registers, _) = self.registers.as_chunks_mut::<W>();
        let (at, _) = self.at.as_flattened().as_chunks::<W>();
        registers[..2 * COUNT].copy_from_slice(at);
        match &self.code.program {
            Instructions::Few(steps) => match registers.first_chunk_mut::<ALL>() {
                Some(all) if ALL > 0 => {
                    evaluate::<W, COUNT, N, u8, _>(steps, self.factors, all, self.out)
                }
                _ => evaluate::<W, COUNT, N, u8, _>(steps, self.factors, registers, self.out),
            },
            Instructions::Many(steps) => {
                evaluate::<W, COUNT, N, u32, _>(steps, self.factors, registers, self.out);
            }
        }
    }
}

/// Runs the instructions, and copies coefficients, multiplied by their factors, to the caller's output.
#[inline(always)]
fn evaluate<const W: usize, const COUNT: usize, const N: usize, R, L>(
    steps: &Steps<R>,
    factors: &[f64],
    registers: &mut L,
    out: &mut [[f64; N]],
) where
    R: Name,
    L: Lines<W> + ?Sized,
{
    for instruction in &steps.instructions {
        step::<W, COUNT, R, L>(instruction, registers);
    }
    for ((out, register), &factor) in out.iter_mut().zip(&steps.places).zip(factors) {
        let (out, _) = out.as_chunks_mut::<W>();
        for (line, out) in out.iter_mut().enumerate() {
            let value = registers.get(register.index() * COUNT + line);
            for lane in 0..W {
                out[lane] = factor * value[lane];
            }
        }
    }
}

/// Runs one instruction, line by line. Uses macros rather than closures: functions that are not inlined are not
/// compiled for the processor at hand.
#[inline(always)]
fn step<const W: usize, const COUNT: usize, R, L>(i: &Instruction<R>, registers: &mut L)
where
    R: Name,
    L: Lines<W> + ?Sized,
{
    macro_rules! read {
        ($line:ident, $k:literal) => {
            registers.get(i.operands[$k].index() * COUNT + $line)
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
                registers.set(i.out.index() * COUNT + line, out);
            }
        };
    }
    macro_rules! one {
        ($f:path) => {
            for line in 0..COUNT {
                let x = read!(line, 0);
                registers.set(i.out.index() * COUNT + line, $f(&x));
            }
        };
    }
    macro_rules! pair {
        ($f:path) => {
            for line in 0..COUNT {
                let x = read!(line, 0);
                let (first, second) = $f(&x);
                registers.set(i.out.index() * COUNT + line, first);
                registers.set(i.second.index() * COUNT + line, second);
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
        Op::Min => each!(|a = 0, b = 1| least(a, b)),
        Op::Max => each!(|a = 0, b = 1| greatest(a, b)),
        Op::AtMost => each!(|a = 0, b = 1| at_most(a, b)),
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
        Op::Sech => one!(elementary::sech),
        Op::SinCos => pair!(elementary::sin_cos),
        Op::SinhCosh => pair!(elementary::sinh_cosh),
    }
}
