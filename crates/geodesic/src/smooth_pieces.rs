//! The pieces of a chart on which the formulas of a surface are smooth. In: expressions. Out: a number for each piece.
//!
//! Where an absolute value, a minimum or a maximum changes from one of its formulas to the other, σ may have a crease. The
//! signs of what they compare tell on which side of each crease a point is.

use std::cell::RefCell;

use expr::graph::TooLarge;
use expr::jets::{Fixed, JetRegisters, JetTape, Order};
use expr::{Graph, Input, NodeId};

use crate::point::Uv;

/// The signs of a surface's corners ([`Graph::corners`]), with the uniforms' values fixed.
#[derive(Clone, Debug)]
pub(crate) struct SmoothPieces {
    corners: JetTape,
    fixed: Fixed,
}

thread_local! {
    /// Registers and results, one set per thread, to avoid allocations.
    static SCRATCH: RefCell<(JetRegisters, Vec<[f64; 1]>)> = RefCell::default();
}

impl SmoothPieces {
    /// Compiles the corners of the roots; `None` where there are none. `uniform` gives the values of the uniforms.
    ///
    /// # Errors
    /// [`TooLarge`] where they do not fit into the graph's limit.
    pub(crate) fn of(
        graph: &Graph,
        roots: &[NodeId],
        uniform: impl Fn(&Input) -> f64,
    ) -> Result<Option<Self>, TooLarge> {
        let (mut graph, roots) = graph.extract(roots);
        let corners = graph.corners(&roots);
        if corners.is_empty() {
            return Ok(None);
        }
        let variables = [Input::Variable(0), Input::Variable(1)];
        let corners = JetTape::new(&graph, &corners, variables, Order::Value)?;
        let values: Vec<f64> = corners.uniforms().iter().map(uniform).collect();
        let fixed = corners.fix(&values);
        Ok(Some(Self { corners, fixed }))
    }

    /// Returns the number of the piece to which a point belongs.
    pub(crate) fn at(&self, uv: Uv) -> u64 {
        SCRATCH.with_borrow_mut(|(registers, values)| {
            values.clear();
            values.resize(self.corners.root_count(), [0.0]);
            let at = uv.0.map(|x| [x]);
            self.corners.eval(registers, &self.fixed, &at, values);
            let positive = values.iter().map(|[value]| u64::from(*value > 0.0));
            positive.fold(0, |piece: u64, sign| piece.rotate_left(1) ^ sign)
        })
    }
}
