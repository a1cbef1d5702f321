//! Solids as functions: the combination of their leaves' functions by set operations.
//!
//! In: a solid, and the values of the grids at which its parts close. Out: one node over the variables of space: the
//! minimum for a union, the maximum for an intersection, and the minimum over all instances.

use expr::ops::Binary;
use expr::{Graph, Input, NodeId, TooLarge};

use crate::range::Sampling;
use crate::solid::{AffineNodes, BoundGrid, Solid, SolidLeaf, SolidStep};

/// The maximum number of values of grids over which a solid's minimum is expanded.
const MOST_INSTANCES: u64 = 4_096;

/// Computes the field of a leaf; `None` for a leaf that is omitted.
type LeafField<'f> = dyn Fn(&mut Graph, &SolidLeaf) -> Result<Option<NodeId>, TooLarge> + 'f;

impl Solid {
    /// Returns its value as a function of x, y and z; its cuts are not part of it. `axes` returns the values of the grids
    /// over which it is a union.
    ///
    /// # Errors
    /// [`TooLarge`] if it has so many leaves or instances that the graph has no room for the expression.
    pub fn function(
        &self,
        graph: &mut Graph,
        axes: &dyn Fn(&BoundGrid) -> Vec<Sampling>,
    ) -> Result<NodeId, TooLarge> {
        self.joined_leaves(graph, axes, &|graph, leaf| {
            if leaf.is_cut_alone(graph) {
                return Ok(None);
            }
            placed(graph, leaf, leaf.field).map(Some)
        })
    }

    /// Returns the field that is 0 on its surface and negative inside: its function with its cuts.
    ///
    /// # Errors
    /// As [`Solid::function`].
    pub fn field(
        &self,
        graph: &mut Graph,
        axes: &dyn Fn(&BoundGrid) -> Vec<Sampling>,
    ) -> Result<NodeId, TooLarge> {
        self.joined_leaves(graph, axes, &|graph, leaf| {
            let mut field = (!leaf.is_cut_alone(graph)).then_some(leaf.field);
            for (axis, cut) in (0..).zip(&leaf.cuts) {
                let Some(cut) = cut else { continue };
                let at = graph.input(Input::Variable(axis));
                let (min, max) = (graph.constant(cut.range.min), graph.constant(cut.range.max));
                for side in [graph.sub(min, at), graph.sub(at, max)] {
                    field = Some(match field {
                        Some(field) => graph.binary(Binary::Max, field, side),
                        None => side,
                    });
                }
            }
            let field = field.unwrap_or(leaf.field);
            placed(graph, leaf, field).map(Some)
        })
    }

    fn joined_leaves(
        &self,
        graph: &mut Graph,
        axes: &dyn Fn(&BoundGrid) -> Vec<Sampling>,
        of_leaf: &LeafField<'_>,
    ) -> Result<NodeId, TooLarge> {
        let mut stack: Vec<Option<NodeId>> = Vec::new();
        for step in &self.steps {
            let node = match step {
                SolidStep::Leaf(leaf) => match self.leaves.get(*leaf as usize) {
                    Some(leaf) => of_leaf(graph, leaf)?,
                    None => None,
                },
                SolidStep::Instances(grids) => match stack.pop().flatten() {
                    Some(node) => Some(least(graph, node, grids, axes)?),
                    None => None,
                },
                join => {
                    let (second, first) = (stack.pop().flatten(), stack.pop().flatten());
                    match (join, first, second) {
                        (SolidStep::Union, Some(a), Some(b)) => {
                            Some(graph.binary(Binary::Min, a, b))
                        }
                        (SolidStep::Difference, Some(a), Some(b)) => {
                            let b = graph.neg(b);
                            Some(graph.binary(Binary::Max, a, b))
                        }
                        (_, Some(a), Some(b)) => Some(graph.binary(Binary::Max, a, b)),
                        // A part's cuts.
                        (_, a, b) => a.or(b),
                    }
                }
            };
            stack.push(node);
        }
        match graph.overflowed() {
            true => Err(TooLarge),
            false => stack.pop().flatten().ok_or(TooLarge),
        }
    }
}

/// Returns f(M⁻¹q) for a function f of a leaf under the map M, over the variables of q.
fn placed(graph: &mut Graph, leaf: &SolidLeaf, field: NodeId) -> Result<NodeId, TooLarge> {
    if leaf.map == AffineNodes::identity(graph) {
        return Ok(field);
    }
    let place = leaf.map.preimage(graph);
    let replace = |input| match input {
        Input::Variable(k) => place.get(k as usize).copied(),
        Input::Uniform(_) => None,
    };
    let found = graph.substitute(&[field], &replace)?;
    found.first().copied().ok_or(TooLarge)
}

/// Returns the minimum of a node over all values of grids.
fn least(
    graph: &mut Graph,
    node: NodeId,
    grids: &[BoundGrid],
    axes_of: &dyn Fn(&BoundGrid) -> Vec<Sampling>,
) -> Result<NodeId, TooLarge> {
    let axes: Vec<(u32, Sampling)> = grids
        .iter()
        .flat_map(|bound| (bound.first_uniform..).zip(axes_of(bound)))
        .collect();
    let count = axes.iter().fold(1, |product: u64, (_, axis)| {
        product.saturating_mul(u64::from(axis.count))
    });
    if count > MOST_INSTANCES {
        return Err(TooLarge);
    }
    let mut all: Option<NodeId> = None;
    for index in 0..count {
        let mut rest = index;
        let mut values: Vec<(u32, NodeId)> = Vec::with_capacity(axes.len());
        for (uniform, axis) in axes.iter().rev() {
            let value = axis.value((rest % u64::from(axis.count)) as u32);
            rest /= u64::from(axis.count);
            values.push((*uniform, graph.constant(value)));
        }
        let replace = |input| match input {
            Input::Uniform(k) => values
                .iter()
                .find(|(uniform, _)| *uniform == k)
                .map(|(_, node)| *node),
            Input::Variable(_) => None,
        };
        let found = graph.substitute(&[node], &replace)?;
        let found = found.first().copied().ok_or(TooLarge)?;
        all = Some(match all {
            Some(known) => graph.binary(Binary::Min, known, found),
            None => found,
        });
    }
    all.ok_or(TooLarge)
}
