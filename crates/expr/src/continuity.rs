//! The points at which the value of an expression or its derivatives may jump, or is unbounded.

use crate::graph::{Graph, Input, Node, NodeId};
use crate::ops::{Binary, Unary};

impl Graph {
    /// Returns expressions at whose zeros alone the roots, as functions of the variables, may jump or grow without
    /// bound: divisors, cosines for tangents, arguments of logarithms. Where none of them is zero, the roots are
    /// continuous wherever they are defined.
    pub fn guards(&mut self, roots: &[NodeId]) -> Vec<NodeId> {
        let mut guards = Vec::new();
        for node in self.order(roots) {
            let guard = match self.node(node) {
                Node::Binary(Binary::Div, _, divisor) => divisor,
                Node::Binary(Binary::Pow | Binary::Zmul, a, _) => a,
                Node::Binary(Binary::AtMost, a, b) => self.sub(a, b),
                Node::Power(a, n) if n < 0 => a,
                Node::Unary(Unary::Tan, a) => self.unary(Unary::Cos, a),
                Node::Unary(Unary::Log | Unary::Sign, a) => a,
                Node::Constant(_)
                | Node::Input(_)
                | Node::Power(..)
                | Node::Binary(
                    Binary::Add | Binary::Sub | Binary::Mul | Binary::Min | Binary::Max,
                    ..,
                )
                | Node::Unary(
                    Unary::Neg
                    | Unary::Sin
                    | Unary::Cos
                    | Unary::Exp
                    | Unary::Sqrt
                    | Unary::Asin
                    | Unary::Acos
                    | Unary::Atan
                    | Unary::Sinh
                    | Unary::Cosh
                    | Unary::Tanh
                    | Unary::Sech
                    | Unary::Abs,
                    _,
                ) => continue,
            };
            let inputs = self.inputs(&[guard]);
            if inputs
                .iter()
                .any(|input| matches!(input, Input::Variable(_)))
            {
                guards.push(guard);
            }
        }
        guards.sort_unstable();
        guards.dedup();
        guards
    }

    /// Returns expressions at whose zeros alone the derivatives of the roots, as functions of the variables, may jump:
    /// arguments of absolute values and signs, differences of what minima, maxima and comparisons compare.
    pub fn corners(&mut self, roots: &[NodeId]) -> Vec<NodeId> {
        let mut corners = Vec::new();
        for node in self.order(roots) {
            let corner = match self.node(node) {
                Node::Unary(Unary::Abs | Unary::Sign, a) => a,
                Node::Binary(Binary::Min | Binary::Max | Binary::AtMost, a, b) => self.sub(a, b),
                _ => continue,
            };
            let inputs = self.inputs(&[corner]);
            if inputs
                .iter()
                .any(|input| matches!(input, Input::Variable(_)))
            {
                corners.push(corner);
            }
        }
        corners.sort_unstable();
        corners.dedup();
        corners
    }
}
