//! Derivatives and substitution: new expressions from old ones, visiting each shared subexpression once.
//!
//! In: roots. Out: the same number of roots, in the same graph. Nodes are visited in the order of their ids, operands
//! first, without recursion. If the graph is full, it is left unchanged.

use rustc_hash::FxHashMap;

use crate::graph::{Graph, Input, InputSet, Node, NodeId, TooLarge};

impl Graph {
    /// Returns the exact derivative of each root by `input`. All roots share their work, also with earlier calls. A
    /// node that does not depend on `input` has the derivative 0, at no cost.
    ///
    /// The rules are in [`crate::ops`]. At a kink of `abs` the derivative is 0.
    ///
    /// # Errors
    /// [`TooLarge`] if the graph is full; it is then unchanged.
    pub fn derivatives(&mut self, roots: &[NodeId], input: Input) -> Result<Vec<NodeId>, TooLarge> {
        self.whole(|graph| {
            let mut known = graph.derivatives.remove(&input).unwrap_or_default();
            let by = InputSet::of(input);
            let order = graph.reachable(roots, |id| {
                graph.dependencies(id).may_meet(by) && !known.contains_key(&id)
            });
            graph.charge(order.len() + roots.len())?;
            for id in order {
                let derivative = graph.derivative(id, input, &known);
                graph.charge(0)?;
                known.insert(id, derivative);
            }
            let zero = graph.constant(0.0);
            graph.charge(0)?;
            let derivatives = roots
                .iter()
                .map(|root| known.get(root).copied().unwrap_or(zero))
                .collect();
            graph.derivatives.insert(input, known);
            Ok(derivatives)
        })
    }

    /// Replaces inputs simultaneously: substitution does not apply to the results of `replace`. An input for which it
    /// returns `None` stays.
    ///
    /// # Errors
    /// [`TooLarge`] if the graph is full; it is then unchanged.
    pub fn substitute(
        &mut self,
        roots: &[NodeId],
        replace: &dyn Fn(Input) -> Option<NodeId>,
    ) -> Result<Vec<NodeId>, TooLarge> {
        self.whole(|graph| {
            let order = graph.reachable(roots, |id| !graph.dependencies(id).is_empty());
            graph.charge(order.len() + roots.len())?;
            // The copy of `order[k]` is at k. Bodies are short: a search in the sorted order is faster than a separate
            // table.
            let mut copies: Vec<NodeId> = Vec::with_capacity(order.len());
            let copy_in = |copies: &[NodeId], operand: NodeId| match order.binary_search(&operand) {
                Ok(place) => copies[place],
                Err(_) => operand,
            };
            for &id in &order {
                let copy = |operand| copy_in(&copies, operand);
                let rewritten = match graph.node(id) {
                    Node::Constant(_) => id,
                    Node::Input(input) => replace(input).unwrap_or(id),
                    Node::Unary(_, a) | Node::Power(a, _) if copy(a) == a => id,
                    Node::Binary(_, a, b) if copy(a) == a && copy(b) == b => id,
                    Node::Unary(op, a) => graph.unary(op, copy(a)),
                    Node::Power(a, n) => graph.integer_power(copy(a), n),
                    Node::Binary(op, a, b) => graph.binary(op, copy(a), copy(b)),
                };
                graph.charge(0)?;
                copies.push(rewritten);
            }
            Ok(roots.iter().map(|&root| copy_in(&copies, root)).collect())
        })
    }

    /// Performs a rewriting completely, or not at all.
    fn whole<T>(
        &mut self,
        rewrite: impl FnOnce(&mut Self) -> Result<T, TooLarge>,
    ) -> Result<T, TooLarge> {
        if self.overflowed() {
            return Err(TooLarge);
        }
        let mark = self.mark();
        let result = rewrite(self);
        if result.is_err() {
            self.roll_back(mark);
        }
        result
    }

    /// Returns the derivative of one node, given those of its operands.
    fn derivative(
        &mut self,
        id: NodeId,
        input: Input,
        known: &FxHashMap<NodeId, NodeId>,
    ) -> NodeId {
        let zero = self.constant(0.0);
        let one = self.constant(1.0);
        let of = |operand| known.get(&operand).copied().unwrap_or(zero);
        match self.node(id) {
            Node::Constant(_) => zero,
            Node::Input(other) => {
                if other == input {
                    one
                } else {
                    zero
                }
            }
            Node::Unary(op, a) => match of(a) {
                // f(a) is constant, even where f' is infinite.
                da if da == zero => zero,
                da => op.derivative(self, a, id, da),
            },
            Node::Power(a, n) => crate::ops::integer_power_derivative(self, a, n, of(a)),
            Node::Binary(op, a, b) => match (of(a), of(b)) {
                (da, db) if da == zero && db == zero => zero,
                (da, db) => op.derivative(self, [a, b], id, [da, db]),
            },
        }
    }
}
