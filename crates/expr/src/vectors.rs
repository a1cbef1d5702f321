//! Vectors of numbers, for work whose loops the compiler does not vectorise.
//!
//! In: work written with [`Vector`] and [`Mask`]. Out: its result, from a copy of the work for the widest available
//! vectors. Loops that choose between variables by comparisons stay scalar if LLVM cannot tell that a branch is equivalent
//! to a selection; with these types every operation is a vector operation. Each lane is computed like a single number:
//! every kind of processor gives the same bits.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use pulp::Simd;

use crate::elementary;

/// The instructions of a kind of processor.
pub trait Instructions: Simd {}

impl<S: Simd> Instructions for S {}

/// The maximum number of lanes of a vector, a multiple of the lanes of any vector.
pub const MOST_LANES: usize = 8;

/// A computation with vectors. Mark [`VectorWork::run`] and everything that it calls `#[inline(always)]`: only inlined code is
/// compiled separately for each kind of processor.
pub trait VectorWork {
    /// The result.
    type Output;
    /// Computes it.
    fn run<S: Instructions>(self, instructions: S) -> Self::Output;
}

/// A set of lanes of a block.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Lanes(u8);

impl Lanes {
    /// Returns the lanes for which `is_one` is true.
    #[inline]
    pub fn of(is_one: impl Fn(usize) -> bool) -> Self {
        let mut lanes = Self::default();
        for lane in 0..MOST_LANES {
            lanes.add(lane, is_one(lane));
        }
        lanes
    }

    /// Adds a lane if `is_one` is true.
    #[inline]
    pub fn add(&mut self, lane: usize, is_one: bool) {
        self.0 |= u8::from(is_one) << lane;
    }

    /// Returns true if the set contains the lane.
    #[inline]
    pub fn has(self, lane: usize) -> bool {
        self.0 >> lane & 1 == 1
    }

    /// Returns true if the set is not empty.
    #[inline]
    pub fn any(self) -> bool {
        self.0 != 0
    }

    /// Returns the lanes that are not in the other set.
    #[inline]
    #[must_use]
    pub fn without(self, others: Self) -> Self {
        Self(self.0 & !others.0)
    }

    /// Returns the lanes in ascending order.
    #[inline]
    pub fn each(self) -> impl Iterator<Item = usize> {
        let mut left = self.0;
        std::iter::from_fn(move || {
            let lane = left.trailing_zeros() as usize;
            left &= left.wrapping_sub(1);
            (lane < MOST_LANES).then_some(lane)
        })
    }
}

impl BitAnd for Lanes {
    type Output = Self;
    #[inline]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

/// A number in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Vector<S: Instructions> {
    instructions: S,
    lanes: S::f64s,
}

/// Returns sine and cosine of the first `W` numbers.
#[inline(always)]
fn first_sin_cos<const W: usize>(x: &[f64; MOST_LANES]) -> ([f64; MOST_LANES], [f64; MOST_LANES]) {
    let mut first = [0.0; W];
    first.copy_from_slice(&x[..W]);
    let found = elementary::sin_cos(&first);
    let (mut sine, mut cosine) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
    sine[..W].copy_from_slice(&found.0);
    cosine[..W].copy_from_slice(&found.1);
    (sine, cosine)
}

/// True or false in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Mask<S: Instructions> {
    instructions: S,
    lanes: S::m64s,
}

impl<S: Instructions> Vector<S> {
    /// The number of parts of a block, each the size of a vector.
    pub const PARTS: usize = MOST_LANES / S::F64_LANES;

    /// Returns a vector with the number in all lanes.
    #[inline(always)]
    pub fn splat(instructions: S, number: f64) -> Self {
        Self {
            instructions,
            lanes: instructions.splat_f64s(number),
        }
    }

    /// Reads the part with this index of a block.
    ///
    /// # Panics
    /// If there are not that many parts.
    #[inline(always)]
    pub fn load(instructions: S, block: &[f64; MOST_LANES], part: usize) -> Self {
        Self {
            instructions,
            lanes: S::as_simd_f64s(block).0[part],
        }
    }

    /// Writes the part with this index of a block.
    ///
    /// # Panics
    /// If there are not that many parts.
    #[inline(always)]
    pub fn store(self, block: &mut [f64; MOST_LANES], part: usize) {
        S::as_mut_simd_f64s(block).0[part] = self.lanes;
    }

    /// Returns the square roots, NaN below 0.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        self.with(self.instructions.sqrt_f64s(self.lanes))
    }

    /// Returns the absolute values.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        self.with(self.instructions.abs_f64s(self.lanes))
    }

    /// Returns the absolute values with the signs of `signs`.
    #[inline(always)]
    #[must_use]
    pub fn copysign(self, signs: Self) -> Self {
        let s = self.instructions;
        let sign = s.and_f64s(s.splat_f64s(-0.0), signs.lanes);
        self.with(s.or_f64s(self.abs().lanes, sign))
    }

    /// Returns sines and cosines, see [`elementary::sin_cos`].
    #[inline(always)]
    pub fn sin_cos(self) -> (Self, Self) {
        let mut x = [0.0; MOST_LANES];
        self.store(&mut x, 0);
        let (sine, cosine) = match S::F64_LANES {
            8 => elementary::sin_cos(&x),
            4 => first_sin_cos::<4>(&x),
            2 => first_sin_cos::<2>(&x),
            _ => first_sin_cos::<1>(&x),
        };
        let s = self.instructions;
        (Self::load(s, &sine, 0), Self::load(s, &cosine, 0))
    }

    /// Applies another function to each lane.
    #[inline(always)]
    #[must_use]
    pub fn map(self, function: impl Fn(f64) -> f64) -> Self {
        let mut x = [0.0; MOST_LANES];
        self.store(&mut x, 0);
        for x in &mut x[..S::F64_LANES] {
            *x = function(*x);
        }
        Self::load(self.instructions, &x, 0)
    }

    /// Applies a function to each pair of corresponding lanes.
    #[inline(always)]
    #[must_use]
    pub fn map_with(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        let (mut x, mut y) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
        self.store(&mut x, 0);
        other.store(&mut y, 0);
        for (x, y) in x[..S::F64_LANES].iter_mut().zip(&y) {
            *x = function(*x, *y);
        }
        Self::load(self.instructions, &x, 0)
    }

    /// Returns the smaller of two numbers; the second one where they are unordered.
    #[inline(always)]
    #[must_use]
    pub fn least(self, other: Self) -> Self {
        self.lt(other).choose(self, other)
    }

    /// Returns the larger of two numbers; the second one where they are unordered.
    #[inline(always)]
    #[must_use]
    pub fn greatest(self, other: Self) -> Self {
        other.lt(self).choose(self, other)
    }

    /// Returns the smallest of its lanes, none of which is NaN.
    #[inline(always)]
    pub fn least_lane(self) -> f64 {
        self.instructions.reduce_min_f64s(self.lanes)
    }

    /// Returns the largest of its lanes, none of which is NaN.
    #[inline(always)]
    pub fn greatest_lane(self) -> f64 {
        self.instructions.reduce_max_f64s(self.lanes)
    }

    /// Returns true where it is less than the other.
    #[inline(always)]
    pub fn lt(self, other: Self) -> Mask<S> {
        self.mask(self.instructions.less_than_f64s(self.lanes, other.lanes))
    }

    /// Returns true where it is less than or equal to the other.
    #[inline(always)]
    pub fn le(self, other: Self) -> Mask<S> {
        let lanes = self
            .instructions
            .less_than_or_equal_f64s(self.lanes, other.lanes);
        self.mask(lanes)
    }

    /// Returns true where both are equal.
    #[inline(always)]
    pub fn equals(self, other: Self) -> Mask<S> {
        self.mask(self.instructions.equal_f64s(self.lanes, other.lanes))
    }

    /// Returns true where it is neither infinite nor NaN.
    #[inline(always)]
    pub fn is_finite(self) -> Mask<S> {
        self.abs().lt(Self::splat(self.instructions, f64::INFINITY))
    }

    #[inline(always)]
    fn with(self, lanes: S::f64s) -> Self {
        Self { lanes, ..self }
    }

    #[inline(always)]
    fn mask(self, lanes: S::m64s) -> Mask<S> {
        Mask {
            instructions: self.instructions,
            lanes,
        }
    }
}

impl<S: Instructions> Mask<S> {
    /// Returns a mask with the same value in all lanes.
    #[inline(always)]
    pub fn splat(instructions: S, value: bool) -> Self {
        let number = Vector::splat(instructions, f64::from(u8::from(value)));
        Vector::splat(instructions, 0.0).lt(number)
    }

    /// Returns the first where the mask is true, else the second.
    #[inline(always)]
    pub fn choose(self, yes: Vector<S>, no: Vector<S>) -> Vector<S> {
        let s = self.instructions;
        yes.with(s.select_f64s(self.lanes, yes.lanes, no.lanes))
    }

    /// Returns true where exactly one of both is true.
    #[inline(always)]
    #[must_use]
    pub fn differs(self, other: Self) -> Self {
        self.with(self.instructions.xor_m64s(self.lanes, other.lanes))
    }

    /// Returns the mask of the given lanes for the part with this index of a block.
    #[inline(always)]
    pub fn of(instructions: S, lanes: Lanes, part: usize) -> Self {
        let mut block = [0.0; MOST_LANES];
        for (lane, number) in block.iter_mut().enumerate().take(S::F64_LANES) {
            *number = f64::from(u8::from(lanes.has(part * S::F64_LANES + lane)));
        }
        let zero = Vector::splat(instructions, 0.0);
        zero.lt(Vector::load(instructions, &block, 0))
    }

    /// Returns true if any lane is true.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.instructions.first_true_m64s(self.lanes) < S::F64_LANES
    }

    #[inline(always)]
    fn with(self, lanes: S::m64s) -> Self {
        Self { lanes, ..self }
    }
}

/// Operations on all lanes.
macro_rules! operator {
    ($operator:ident, $method:ident, $type:ident, $function:ident) => {
        impl<S: Instructions> $operator for $type<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(self.instructions.$function(self.lanes, other.lanes))
            }
        }
    };
}

operator!(Add, add, Vector, add_f64s);
operator!(Sub, sub, Vector, sub_f64s);
operator!(Mul, mul, Vector, mul_f64s);
operator!(Div, div, Vector, div_f64s);
operator!(BitAnd, bitand, Mask, and_m64s);
operator!(BitOr, bitor, Mask, or_m64s);

impl<S: Instructions> Neg for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.instructions.neg_f64s(self.lanes))
    }
}

impl<S: Instructions> Not for Mask<S> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        self.with(self.instructions.not_m64s(self.lanes))
    }
}
