//! The vector instructions of this processor, detected at run time.
//!
//! In: work over arrays of numbers, written as plain loops. Out: its result, from a copy of the work that was compiled
//! for the widest available vectors (on x86-64: 128 bits everywhere, 256 with AVX2, 512 with AVX-512). Nothing is
//! contracted or reordered, so that every copy gives the same bits.

use crate::vectors::VectorWork;

/// A computation. Mark [`Work::run`] and everything that its inner loops call `#[inline(always)]`: only inlined code is
/// compiled separately for each kind of processor.
pub trait Work {
    /// The result.
    type Output;
    /// Computes it.
    fn run(self) -> Self::Output;
}

/// A kind of processor. Cheap to copy and to store.
#[derive(Clone, Copy, Debug)]
pub struct Processor(pulp::Arch);

impl Processor {
    /// Returns the processor that this code is running on.
    pub fn here() -> Self {
        Self(pulp::Arch::new())
    }

    /// Returns the instructions that every processor of the architecture has.
    pub fn least() -> Self {
        Self(pulp::Arch::Scalar)
    }

    /// Runs the work with this processor's instructions.
    #[inline]
    pub fn run<W: Work>(self, work: W) -> W::Output {
        self.0.dispatch(Inlined(work))
    }

    /// Runs work on vectors with this processor's instructions.
    #[inline]
    pub fn run_vectors<W: VectorWork>(self, work: W) -> W::Output {
        self.0.dispatch(OnVectors(work))
    }
}

impl Default for Processor {
    fn default() -> Self {
        Self::here()
    }
}

struct Inlined<W>(W);

struct OnVectors<W>(W);

impl<W: VectorWork> pulp::WithSimd for OnVectors<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, instructions: S) -> W::Output {
        self.0.run(instructions)
    }
}

impl<W: Work> pulp::WithSimd for Inlined<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> W::Output {
        self.0.run()
    }
}
