//! How large an expression is, with sharing and without.

use rustc_hash::FxHashMap;

use crate::graph::{Graph, Node, NodeId};

impl Graph {
    /// How many operations the roots need when every shared subexpression is computed once. Constants and
    /// inputs are no operations.
    pub fn operation_count(&self, roots: &[NodeId]) -> usize {
        self.reachable(roots)
            .into_iter()
            .filter(|&id| self.is_operation(id))
            .count()
    }

    /// How many operations the roots need when each is written out as a tree, nothing shared; saturates.
    pub fn tree_size(&self, roots: &[NodeId]) -> u64 {
        let mut sizes: FxHashMap<NodeId, u64> = FxHashMap::default();
        for id in self.reachable(roots) {
            let operands: u64 = self
                .node(id)
                .operands()
                .fold(0, |sum: u64, operand| sum.saturating_add(sizes[&operand]));
            sizes.insert(
                id,
                operands.saturating_add(u64::from(self.is_operation(id))),
            );
        }
        roots
            .iter()
            .fold(0, |sum: u64, root| sum.saturating_add(sizes[root]))
    }

    fn is_operation(&self, id: NodeId) -> bool {
        !matches!(self.node(id), Node::Constant(_) | Node::Input(_))
    }
}
