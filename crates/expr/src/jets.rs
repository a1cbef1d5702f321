//! Evaluation with derivatives: values and partial derivatives by two variables up to order two, in lanes of points.
//!
//! ```text
//! roots ──expand.rs──▶ one coefficient for each node and derivative ──assemble.rs──▶ code ──run.rs──▶ numbers
//! ```
//!
//! In: roots and two variables, then points. Out: the coefficients of each root. Derivatives are computed along with
//! the values (truncated Taylor arithmetic in two variables); nothing is differentiated symbolically, and each
//! operation costs a bounded number of instructions. The arithmetic is unrolled before any point is given: a
//! coefficient that is zero everywhere, because its node does not depend on a variable or is linear in it, costs
//! nothing; equal coefficients (the derivative of a sine, and the cosine) are computed once; coefficients that depend
//! only on uniforms are computed once per set of their values ([`JetTape::fix`]).
//!
//! ```
//! use expr::jets::{JetRegisters, JetTape, Order};
//! use expr::{Graph, Input};
//!
//! let mut graph = Graph::default();
//! let [u, v] = [0, 1].map(|k| graph.input(Input::Variable(k)));
//! let square = graph.mul(u, u);
//! let root = graph.mul(square, v);
//! let tape = JetTape::new(&graph, &[root], [Input::Variable(0), Input::Variable(1)], Order::Second).unwrap();
//! let mut out = [[f64::NAN]; 6];
//! tape.eval(&mut JetRegisters::default(), &tape.fix(&[]), &[[3.0], [5.0]], &mut out);
//! assert_eq!(out, [45.0, 30.0, 9.0, 10.0, 6.0, 0.0].map(|x| [x]));
//! ```

use std::sync::atomic::{AtomicU64, Ordering};

use crate::graph::{Graph, Input, NodeId, TooLarge};
use crate::jets::assemble::{StraightLineCode, assemble};
use crate::jets::expand::{Expansion, expand};

mod assemble;
mod expand;
mod run;
mod terms;
pub use run::JetRegisters;

/// The number of points that are evaluated at once in bulk: a vector of eight, or two of four.
pub const LANES: usize = 8;

/// The order up to which derivatives are computed.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Order {
    /// The value alone.
    Value,
    /// The value and both first derivatives.
    First,
    /// The value, both first and all three second derivatives.
    Second,
}

impl Order {
    /// Returns the number of coefficients of a root: 1, 3 or 6.
    pub fn coefficients(self) -> usize {
        match self {
            Self::Value => 1,
            Self::First => 3,
            Self::Second => 6,
        }
    }
}

/// Straight-line code for the coefficients of some roots.
#[derive(Clone, Debug)]
pub struct JetTape {
    expansion: Expansion,
    code: StraightLineCode,
    order: Order,
    identity: u64,
}

/// The numbers of a [`JetTape`] that are the same at every point: constants, and values that depend only on uniforms.
#[derive(Clone, Debug)]
pub struct Fixed {
    /// The contents of the registers, then the factors of the results.
    numbers: Vec<f64>,
    tape: u64,
    identity: u64,
}

/// Returns an identity for tapes and their fixed numbers, so that registers record whose numbers they contain.
fn next_identity() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

impl JetTape {
    /// Compiles the roots, to be differentiated by `variables`; every other input is a uniform.
    ///
    /// # Errors
    /// [`TooLarge`] where there are more coefficients than the graph may hold nodes.
    pub fn new(
        graph: &Graph,
        roots: &[NodeId],
        variables: [Input; 2],
        order: Order,
    ) -> Result<Self, TooLarge> {
        let expansion = expand(graph, roots, variables, order)?;
        let code = assemble(&expansion, order.coefficients());
        Ok(Self {
            expansion,
            code,
            order,
            identity: next_identity(),
        })
    }

    /// Returns the inputs other than the two variables, in the order that [`JetTape::fix`] expects.
    pub fn uniforms(&self) -> &[Input] {
        &self.expansion.uniforms
    }

    /// Returns the order up to which it differentiates.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Returns the number of roots.
    pub fn root_count(&self) -> usize {
        self.code.program.place_count() / self.order.coefficients()
    }

    /// Returns the number of instructions of one evaluation.
    pub fn instruction_count(&self) -> usize {
        self.code.program.instruction_count()
    }

    /// Computes the numbers that are the same at every point. `uniforms` are in the order of [`JetTape::uniforms`].
    ///
    /// # Panics
    /// If `uniforms` has a different length.
    pub fn fix(&self, uniforms: &[f64]) -> Fixed {
        assert_eq!(
            uniforms.len(),
            self.uniforms().len(),
            "one number per uniform"
        );
        let wanted = self.code.fixed.iter().copied();
        let wanted: Vec<u32> = wanted
            .chain(self.code.factors.iter().map(|(id, _)| *id))
            .collect();
        let mut numbers = self.expansion.fixed_numbers(uniforms, &wanted);
        let factors = &mut numbers[self.code.fixed.len()..];
        for (factor, (_, negative)) in factors.iter_mut().zip(&self.code.factors) {
            if *negative {
                *factor = -*factor;
            }
        }
        Fixed {
            numbers,
            tape: self.identity,
            identity: next_identity(),
        }
    }

    /// Evaluates at `N` points: `at` contains the two variables. `out` receives the values of all roots, then their ∂u,
    /// ∂v, ∂uu, ∂uv and ∂vv, up to the order: coefficient k of a root is at k·[`JetTape::root_count`] + root. The bits
    /// depend neither on `N` nor on the processor.
    ///
    /// # Panics
    /// If `fixed` is from another tape, or `out` does not have one element per root and coefficient.
    pub fn eval<const N: usize>(
        &self,
        registers: &mut JetRegisters,
        fixed: &Fixed,
        at: &[[f64; N]; 2],
        out: &mut [[f64; N]],
    ) {
        assert_eq!(fixed.tape, self.identity, "fixed numbers of this tape");
        let places = self.code.program.place_count();
        assert_eq!(out.len(), places, "a place per root and coefficient");
        registers.run(&self.code, &fixed.numbers, fixed.identity, at, out);
    }
}
