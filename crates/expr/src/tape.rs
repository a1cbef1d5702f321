//! Evaluation in f64: a graph's roots as straight-line code over registers.

use crate::graph::{Graph, Input, NodeId};

/// How many points [`Tape::eval_block`] evaluates at once.
pub const LANES: usize = 64;
/// One number for each lane.
pub type Block = [f64; LANES];

/// Straight-line code for some roots.
#[derive(Clone, Debug)]
pub struct Tape {}

/// Registers; reused between evaluations so that none allocates. One per thread.
#[derive(Clone, Debug, Default)]
pub struct Registers {}

impl Tape {
    /// Compiles the roots.
    pub fn new(graph: &Graph, roots: &[NodeId]) -> Self {
        let _ = (graph, roots);
        todo!()
    }
    /// The inputs in the order in which evaluation takes them: sorted.
    pub fn inputs(&self) -> &[Input] {
        todo!()
    }
    /// Evaluates at one point. `inputs` follows [`Tape::inputs`]; `out` has one place per root.
    pub fn eval(&self, registers: &mut Registers, inputs: &[f64], out: &mut [f64]) {
        let _ = (registers, inputs, out);
        todo!()
    }
    /// Evaluates at [`LANES`] points: the same operations in the same order as [`Tape::eval`], so the same
    /// results to the last bit.
    pub fn eval_block(&self, registers: &mut Registers, inputs: &[Block], out: &mut [Block]) {
        let _ = (registers, inputs, out);
        todo!()
    }
    /// How many operations one evaluation runs.
    pub fn operation_count(&self) -> usize {
        todo!()
    }
}
