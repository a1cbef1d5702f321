//! What every evaluator is held to: sample arguments for every row of the table of operations.
//!
//! The f64 tape, its blocks and the generated WGSL are each run over [`cases`] by the tests and compared with
//! `expected`, which comes from the table's own definition; tests of this crate compare that with independent
//! values.

use crate::graph::{Graph, NodeId};
use crate::ops::{Binary, Unary, integer_power};

/// An operation of the table.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[allow(missing_docs)]
pub enum Operation {
    Unary(Unary),
    Binary(Binary),
    IntegerPower(i32),
}

impl Operation {
    /// The operation on nodes; `b` counts for two operands only.
    pub fn node(self, graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
        match self {
            Self::Unary(op) => graph.unary(op, a),
            Self::Binary(op) => graph.binary(op, a, b),
            Self::IntegerPower(n) => graph.power_integer(a, n),
        }
    }

    /// The value by the table.
    pub fn eval(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Unary(op) => op.eval(a),
            Self::Binary(op) => op.eval(a, b),
            Self::IntegerPower(n) => integer_power(a, n),
        }
    }
}

/// One case: an operation, its operands (the second counts for two operands only), its value.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)]
pub struct Case {
    pub operation: Operation,
    pub operands: [f64; 2],
    pub expected: f64,
}

/// Operands that are numbers of f32 too, so that a shader starts from the same ones.
const NUMBERS: [f64; 11] = [
    -2.5, -2.0, -1.0, -0.75, -0.125, 0.0, 0.125, 0.5, 1.0, 1.5, 3.0,
];

/// Every operation at every operand (or pair of operands) where it is defined and finite.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut push = |operation: Operation, a: f64, b: f64| {
        let expected = operation.eval(a, b);
        if expected.is_finite() {
            cases.push(Case {
                operation,
                operands: [a, b],
                expected,
            });
        }
    };
    for a in NUMBERS {
        for op in Unary::ALL {
            push(Operation::Unary(op), a, 0.0);
        }
        for n in [-5, -2, -1, 2, 3, 4, 7, 10, 13] {
            push(Operation::IntegerPower(n), a, 0.0);
        }
        for b in NUMBERS {
            for op in Binary::ALL {
                push(Operation::Binary(op), a, b);
            }
        }
    }
    // An annihilating product is 0 whatever the other factor is.
    push(
        Operation::Binary(Binary::AnnihilatingProduct),
        0.0,
        f64::INFINITY,
    );
    cases
}
