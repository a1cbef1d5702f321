//! Expressions as the thesis' program writes them out: derivatives by the rules, nothing simplified, every
//! use of a subexpression computed again.
//!
//! Only the sizes of these trees are wanted, and they may be astronomic: nodes are shared here, and each
//! knows how many operations its tree would have.

use std::collections::HashMap;

use expr::graph::{Node, TooLarge};
use expr::ops::{Binary, Operation};
use expr::{Graph, Input, NodeId};

/// The most nodes that are made.
const LIMIT: usize = 2_000_000;

/// A node of [`Trees`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Tree(usize);

/// Expressions that no constructor simplifies.
#[derive(Debug, Default)]
pub(super) struct Trees {
    nodes: Vec<Written>,
    /// The operations of each node, written out as a tree; saturates.
    sizes: Vec<u64>,
}

/// What a node is.
#[derive(Clone, Copy, Debug)]
enum Written {
    /// A number.
    Constant,
    /// An input; its derivative is the number 1 or 0.
    Input,
    /// An operation of `expr`'s table on one or two operands.
    Operation(Operation, [Option<Tree>; 2]),
}

impl Trees {
    /// Writes out roots of a graph.
    pub(super) fn write(&mut self, graph: &Graph, roots: &[NodeId]) -> Result<Vec<Tree>, TooLarge> {
        self.write_at(graph, roots, [None; 2])
    }

    /// The derivatives of roots by any one of the inputs: which one changes no size, since nothing is
    /// simplified.
    pub(super) fn derivatives(&mut self, roots: &[Tree]) -> Result<Vec<Tree>, TooLarge> {
        let end = roots.iter().map(|root| root.0 + 1).max().unwrap_or(0);
        // Operands come before what uses them, so that one pass from the start meets them first.
        let mut derivatives: Vec<Tree> = Vec::with_capacity(end);
        for index in 0..end {
            let derivative = match self.nodes[index] {
                Written::Constant | Written::Input => self.push(Written::Constant)?,
                Written::Operation(operation, operands) => {
                    let inner = operands.map(|operand| Some(derivatives[operand?.0]));
                    self.rule(operation, operands, inner)?
                }
            };
            derivatives.push(derivative);
        }
        Ok(roots.iter().map(|root| derivatives[root.0]).collect())
    }

    /// The dot product of two vectors.
    pub(super) fn dot(&mut self, a: &[Tree], b: &[Tree]) -> Result<Tree, TooLarge> {
        let mut sum = None;
        for (&a, &b) in a.iter().zip(b) {
            let product = self.binary(Binary::Mul, a, b)?;
            sum = Some(match sum {
                None => product,
                Some(sum) => self.binary(Binary::Add, sum, product)?,
            });
        }
        sum.map_or_else(|| self.push(Written::Constant), Ok)
    }

    /// The operations of some trees together; saturates.
    pub(super) fn size(&self, roots: &[Tree]) -> u64 {
        let sizes = roots.iter().map(|root| self.sizes[root.0]);
        sizes.fold(0, u64::saturating_add)
    }

    /// The chain rule: the sum over the operands of the operation's partial derivative times the operand's
    /// derivative.
    fn rule(
        &mut self,
        operation: Operation,
        operands: [Option<Tree>; 2],
        inner: [Option<Tree>; 2],
    ) -> Result<Tree, TooLarge> {
        if let (Operation::Binary(op @ (Binary::Add | Binary::Sub)), [Some(a), Some(b)]) =
            (operation, inner)
        {
            return self.binary(op, a, b);
        }
        let mut sum = None;
        for (variable, inner) in (0..).zip(inner) {
            let Some(inner) = inner else { continue };
            let partial = self.partial(operation, variable, operands)?;
            let term = self.binary(Binary::Mul, partial, inner)?;
            sum = Some(match sum {
                None => term,
                Some(sum) => self.binary(Binary::Add, sum, term)?,
            });
        }
        sum.map_or_else(|| self.push(Written::Constant), Ok)
    }

    /// An operation's partial derivative by one of its operands, at these operands: as `expr`'s table has it.
    fn partial(
        &mut self,
        operation: Operation,
        variable: u32,
        operands: [Option<Tree>; 2],
    ) -> Result<Tree, TooLarge> {
        let mut graph = Graph::default();
        let a = graph.input(Input::Variable(0));
        let b = graph.input(Input::Variable(1));
        let value = match operation {
            Operation::Unary(op) => graph.unary(op, a),
            Operation::Binary(op) => graph.binary(op, a, b),
            Operation::Power(exponent) => graph.integer_power(a, exponent),
        };
        let partial = graph.derivatives(&[value], Input::Variable(variable))?;
        let written = self.write_at(&graph, &partial, operands)?;
        written.first().copied().ok_or(TooLarge)
    }

    /// Writes out roots, `Variable(0)` and `Variable(1)` being replaced where there is something to replace
    /// them with.
    fn write_at(
        &mut self,
        graph: &Graph,
        roots: &[NodeId],
        variables: [Option<Tree>; 2],
    ) -> Result<Vec<Tree>, TooLarge> {
        let mut written: HashMap<NodeId, Tree> = HashMap::new();
        for id in graph.order(roots) {
            let tree = match graph.node(id) {
                Node::Constant(_) => self.push(Written::Constant)?,
                Node::Input(input) => {
                    let replacement = match input {
                        Input::Variable(k) => variables.get(k as usize).copied().flatten(),
                        Input::Uniform(_) => None,
                    };
                    match replacement {
                        Some(tree) => tree,
                        None => self.push(Written::Input)?,
                    }
                }
                Node::Unary(op, a) => self.push(Written::Operation(
                    Operation::Unary(op),
                    [Some(written[&a]), None],
                ))?,
                Node::Binary(op, a, b) => self.binary(op, written[&a], written[&b])?,
                Node::Power(a, exponent) => self.push(Written::Operation(
                    Operation::Power(exponent),
                    [Some(written[&a]), None],
                ))?,
            };
            written.insert(id, tree);
        }
        Ok(roots.iter().map(|root| written[root]).collect())
    }

    fn binary(&mut self, op: Binary, a: Tree, b: Tree) -> Result<Tree, TooLarge> {
        self.push(Written::Operation(
            Operation::Binary(op),
            [Some(a), Some(b)],
        ))
    }

    fn push(&mut self, node: Written) -> Result<Tree, TooLarge> {
        if self.nodes.len() >= LIMIT {
            return Err(TooLarge);
        }
        let size = match node {
            Written::Constant | Written::Input => 0,
            Written::Operation(_, operands) => {
                let operands = operands.into_iter().flatten();
                operands.fold(1, |sum: u64, operand| {
                    sum.saturating_add(self.sizes[operand.0])
                })
            }
        };
        self.nodes.push(node);
        self.sizes.push(size);
        Ok(Tree(self.nodes.len() - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_count_every_use_again() -> Result<(), TooLarge> {
        let mut graph = Graph::default();
        let u = graph.input(Input::Variable(0));
        let sine = graph.unary(expr::ops::Unary::Sin, u);
        let square = graph.mul(sine, sine);
        let fourth = graph.mul(square, square);
        let mut trees = Trees::default();
        let roots = trees.write(&graph, &[sine, square, fourth])?;
        // sin u; sin u · sin u; and that twice and a product.
        assert_eq!(
            roots
                .iter()
                .map(|root| trees.size(&[*root]))
                .collect::<Vec<_>>(),
            [1, 3, 7]
        );
        // cos u · 1; and sin u · (cos u · 1) twice and a sum, not simplified.
        let derivatives = trees.derivatives(&roots[..2])?;
        assert_eq!(trees.size(&derivatives[..1]), 2);
        assert_eq!(trees.size(&derivatives[1..]), 9);
        Ok(())
    }

    #[test]
    fn sizes_that_explode_saturate() -> Result<(), TooLarge> {
        let mut graph = Graph::default();
        let mut power = graph.input(Input::Variable(0));
        for _ in 0..100 {
            power = graph.mul(power, power);
        }
        let mut trees = Trees::default();
        let roots = trees.write(&graph, &[power])?;
        assert_eq!(trees.size(&roots), u64::MAX);
        Ok(())
    }
}
