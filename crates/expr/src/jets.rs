//! Evaluation with derivatives: values and all partial derivatives up to order two, in lanes of points.
//!
//! What flows in: roots and the two variables to derive by, then points. What flows out: a [`Jet`] for each root.
//! The derivatives are carried along with the values (truncated Taylor arithmetic in two variables), so that nothing
//! is derived symbolically; what a node does not depend on is known beforehand and costs nothing.

use crate::graph::{Graph, Input, NodeId};

/// How many points are evaluated at once where many are: two vectors of four on a processor with AVX2.
pub const LANES: usize = 8;

/// A value with its partial derivatives by two variables, in `N` lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Jet<const N: usize> {
    pub value: [f64; N],
    pub du: [f64; N],
    pub dv: [f64; N],
    pub duu: [f64; N],
    pub duv: [f64; N],
    pub dvv: [f64; N],
}

/// Straight-line code for the jets of some roots.
#[derive(Clone, Debug)]
pub struct JetTape {}

/// Registers, reused between evaluations so that none allocates. One per thread, for any tapes.
#[derive(Clone, Debug, Default)]
pub struct JetRegisters<const N: usize> {}

impl JetTape {
    /// Compiles the roots, to be derived by `variables`.
    pub fn new(_graph: &Graph, _roots: &[NodeId], _variables: [Input; 2]) -> Self {
        todo!()
    }

    /// The inputs other than the two variables, in the order in which evaluation takes them.
    pub fn uniforms(&self) -> &[Input] {
        todo!()
    }

    /// Values and derivatives up to order two at `N` points; `at` holds the two variables, `uniforms` follows
    /// [`JetTape::uniforms`], `out` has one place per root.
    ///
    /// # Panics
    /// If `uniforms` or `out` is not of this length.
    pub fn eval<const N: usize>(
        &self,
        _registers: &mut JetRegisters<N>,
        _at: &[[f64; N]; 2],
        _uniforms: &[f64],
        _out: &mut [Jet<N>],
    ) {
        todo!()
    }
}
