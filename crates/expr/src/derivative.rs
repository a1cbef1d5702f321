//! Exact derivatives: one arm per row of the table of operations.

use rustc_hash::FxHashMap;

use crate::graph::{Graph, Input, Node, NodeId, TooLarge};
use crate::ops::{Binary, Unary};

impl Graph {
    /// The exact derivative of each root by `input`. All roots share their work, and every shared
    /// subexpression is derived once.
    ///
    /// # Errors
    /// [`TooLarge`] where the graph is full.
    pub fn derivatives(&mut self, roots: &[NodeId], input: Input) -> Result<Vec<NodeId>, TooLarge> {
        let order = self.reachable(roots);
        // Nodes that are absent do not depend on the input.
        let mut derivatives: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for id in order {
            let node = self.node(id);
            let depends = match node {
                Node::Input(this) => this == input,
                _ => node
                    .operands()
                    .any(|operand| derivatives.contains_key(&operand)),
            };
            if !depends {
                continue;
            }
            let derivative = match node {
                Node::Constant(_) => continue,
                Node::Input(_) => self.constant(1.0),
                Node::Unary(op, a) => {
                    let da = derivatives[&a];
                    self.unary_derivative(op, id, a, da)
                }
                Node::Binary(op, a, b) => self.binary_derivative(
                    op,
                    id,
                    (a, derivatives.get(&a).copied()),
                    (b, derivatives.get(&b).copied()),
                ),
                Node::IntegerPower(a, n) => {
                    // n·a^(n−1)·a′
                    let power = self.power_integer(a, n - 1);
                    let n = self.constant(f64::from(n));
                    let outer = self.multiply(n, power);
                    self.multiply(outer, derivatives[&a])
                }
            };
            if self.overflowed() {
                return Err(TooLarge);
            }
            derivatives.insert(id, derivative);
        }
        let zero = self.constant(0.0);
        if self.overflowed() {
            return Err(TooLarge);
        }
        Ok(roots
            .iter()
            .map(|root| derivatives.get(root).copied().unwrap_or(zero))
            .collect())
    }

    /// The derivative of `node` = op(a), where a′ is `da`.
    fn unary_derivative(&mut self, op: Unary, node: NodeId, a: NodeId, da: NodeId) -> NodeId {
        let one = self.constant(1.0);
        match op {
            Unary::Negate => self.negate(da),
            Unary::Sin => {
                let cos = self.unary(Unary::Cos, a);
                self.multiply(cos, da)
            }
            Unary::Cos => {
                let sin = self.unary(Unary::Sin, a);
                let minus = self.negate(sin);
                self.multiply(minus, da)
            }
            Unary::Tan => {
                let square = self.power_integer(node, 2);
                let outer = self.add(one, square);
                self.multiply(outer, da)
            }
            Unary::Exp => self.multiply(node, da),
            Unary::Log => self.divide(da, a),
            Unary::Sqrt => {
                let two = self.constant(2.0);
                let twice = self.multiply(two, node);
                self.divide(da, twice)
            }
            Unary::Asin | Unary::Acos => {
                let square = self.power_integer(a, 2);
                let rest = self.subtract(one, square);
                let root = self.unary(Unary::Sqrt, rest);
                let quotient = self.divide(da, root);
                if op == Unary::Acos {
                    self.negate(quotient)
                } else {
                    quotient
                }
            }
            Unary::Atan => {
                let square = self.power_integer(a, 2);
                let sum = self.add(one, square);
                self.divide(da, sum)
            }
            Unary::Sinh => {
                let cosh = self.unary(Unary::Cosh, a);
                self.multiply(cosh, da)
            }
            Unary::Cosh => {
                let sinh = self.unary(Unary::Sinh, a);
                self.multiply(sinh, da)
            }
            Unary::Tanh => {
                let square = self.power_integer(node, 2);
                let outer = self.subtract(one, square);
                self.multiply(outer, da)
            }
            Unary::Abs => {
                let sign = self.unary(Unary::Sign, a);
                self.multiply(sign, da)
            }
            Unary::Sign => self.constant(0.0),
        }
    }

    /// The derivative of `node` = op(a, b); an operand without a derivative does not depend on the input.
    fn binary_derivative(
        &mut self,
        op: Binary,
        node: NodeId,
        (a, da): (NodeId, Option<NodeId>),
        (b, db): (NodeId, Option<NodeId>),
    ) -> NodeId {
        let zero = self.constant(0.0);
        let (dense_da, dense_db) = (da.unwrap_or(zero), db.unwrap_or(zero));
        match op {
            Binary::Add => self.add(dense_da, dense_db),
            Binary::Subtract => self.subtract(dense_da, dense_db),
            Binary::Multiply => {
                let left = self.multiply(dense_da, b);
                let right = self.multiply(a, dense_db);
                self.add(left, right)
            }
            Binary::AnnihilatingProduct => {
                let left = self.binary(Binary::AnnihilatingProduct, dense_da, b);
                let right = self.binary(Binary::AnnihilatingProduct, a, dense_db);
                self.add(left, right)
            }
            // (a/b)′ = (a′ − (a/b)·b′)/b, which needs no square of b.
            Binary::Divide => {
                let inner = self.multiply(node, dense_db);
                let numerator = self.subtract(dense_da, inner);
                self.divide(numerator, b)
            }
            // (a^b)′ = b·a^(b−1)·a′ + a^b·log a·b′; each product vanishes with its first factor, so that a power
            // of a param is differentiable wherever it should be.
            Binary::Power => {
                let base = match da {
                    None => zero,
                    Some(da) => {
                        let one = self.constant(1.0);
                        let exponent = self.subtract(b, one);
                        let power = self.binary(Binary::Power, a, exponent);
                        let outer = self.binary(Binary::AnnihilatingProduct, b, power);
                        self.multiply(outer, da)
                    }
                };
                let exponent = match db {
                    None => zero,
                    Some(db) => {
                        let log = self.unary(Unary::Log, a);
                        let outer = self.binary(Binary::AnnihilatingProduct, node, log);
                        self.binary(Binary::AnnihilatingProduct, db, outer)
                    }
                };
                self.add(base, exponent)
            }
        }
    }
}
