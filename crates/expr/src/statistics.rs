//! Sizes of expressions, which show how much sharing saves.

use rustc_hash::FxHashMap;

use crate::graph::{Graph, NodeId};

/// Returns the number of operations that the roots need when every shared subexpression is computed once. Constants and
/// inputs are not counted.
pub fn operation_count(graph: &Graph, roots: &[NodeId]) -> usize {
    graph
        .order(roots)
        .into_iter()
        .filter(|&id| graph.node(id).is_operation())
        .count()
}

/// Returns the number of operations that the roots need when each is written out as a tree without sharing, as an
/// evaluator of trees would run. Saturates at `u64::MAX`.
pub fn tree_size(graph: &Graph, roots: &[NodeId]) -> u64 {
    let mut sizes: FxHashMap<NodeId, u64> = FxHashMap::default();
    for id in graph.order(roots) {
        let node = graph.node(id);
        let size = node
            .operands()
            .fold(u64::from(node.is_operation()), |size, operand| {
                size.saturating_add(sizes[&operand])
            });
        sizes.insert(id, size);
    }
    roots
        .iter()
        .fold(0, |size: u64, root| size.saturating_add(sizes[root]))
}

impl Graph {
    /// [`operation_count`] of this graph.
    pub fn operation_count(&self, roots: &[NodeId]) -> usize {
        operation_count(self, roots)
    }

    /// [`tree_size`] of this graph.
    pub fn tree_size(&self, roots: &[NodeId]) -> u64 {
        tree_size(self, roots)
    }
}
