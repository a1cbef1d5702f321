//! What one geodesic acceleration costs: our form beside the thesis' scheme.
//!
//! Both give (u'', v'') from (u, v) and (u', v'). Ours is the ambient form: with
//! A = σuu u'² + 2 σuv u'v' + σvv v'², solve `[E F; F G]`·(u'', v'') = −(σu·A, σv·A); every shared
//! subexpression is computed once. The thesis' (system 2.2) evaluates E, F, G and their six derivatives, each
//! written out as a tree by the rules of derivation, and solves
//! 2·`[E F; F G]`·(u'', v'') = (v'²(Gu − 2Fv) − u'²Eu − 2u'v'Ev, u'²(Ev − 2Fu) − v'²Gv − 2u'v'Gu).

use expr::graph::TooLarge;
use expr::{Graph, Input, NodeId};
use serde::Serialize;

use super::unshared::Trees;

/// Operations for one acceleration (u'', v'').
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Acceleration {
    /// In the ambient form, shared subexpressions computed once.
    pub(super) acceleration_operations: u64,
    /// In the thesis' scheme, each of the nine functions written out as a tree.
    pub(super) thesis_tree_operations: u64,
}

impl Acceleration {
    /// How many times as many operations the thesis' scheme takes.
    pub(super) fn ratio(&self) -> f64 {
        let ours = self.acceleration_operations.max(1);
        self.thesis_tree_operations as f64 / ours as f64
    }
}

/// Counts for the surface with this position over `Variable(0)`, `Variable(1)`. `None` if its derivatives are
/// too large to be written out.
pub(super) fn count(graph: &Graph, position: &[NodeId; 3]) -> Option<Acceleration> {
    let (mut graph, position) = graph.extract(position);
    let ours = ambient(&mut graph, &position).ok()?;
    let thesis = expanded(&graph, &position).ok()?;
    (!graph.overflowed()).then_some(Acceleration {
        acceleration_operations: ours,
        thesis_tree_operations: thesis,
    })
}

/// Counts for the metric with this form \[E, F, G\] over `Variable(0)`, `Variable(1)`: system 2.2 in both columns,
/// with and without sharing. `None` if its derivatives are too large to be written out.
pub(super) fn count_metric(graph: &Graph, form: &[NodeId; 3]) -> Option<Acceleration> {
    let (mut graph, form) = graph.extract(form);
    let thesis = expanded_form(&graph, &form).ok()?;
    let by_u = graph.derivatives(&form, U).ok()?;
    let by_v = graph.derivatives(&form, V).ok()?;
    let triple = |nodes: &[NodeId]| <[NodeId; 3]>::try_from(nodes).ok();
    let solution = system(&mut graph, triple(&form)?, triple(&by_u)?, triple(&by_v)?);
    let ours = graph.operation_count(&solution) as u64;
    (!graph.overflowed()).then_some(Acceleration {
        acceleration_operations: ours,
        thesis_tree_operations: thesis,
    })
}

const U: Input = Input::Variable(0);
const V: Input = Input::Variable(1);

fn ambient(graph: &mut Graph, position: &[NodeId]) -> Result<u64, TooLarge> {
    let du = graph.derivatives(position, U)?;
    let dv = graph.derivatives(position, V)?;
    let duu = graph.derivatives(&du, U)?;
    let duv = graph.derivatives(&du, V)?;
    let dvv = graph.derivatives(&dv, V)?;
    let (p, q) = velocity(graph);
    let two = graph.constant(2.0);
    let pp = graph.mul(p, p);
    let pq = graph.mul(p, q);
    let pq = graph.mul(two, pq);
    let qq = graph.mul(q, q);
    let mut along = Vec::with_capacity(position.len());
    for ((&uu, &uv), &vv) in duu.iter().zip(&duv).zip(&dvv) {
        let sum = [(uu, pp), (uv, pq), (vv, qq)].map(|(a, b)| graph.mul(a, b));
        let first = graph.add(sum[0], sum[1]);
        along.push(graph.add(first, sum[2]));
    }
    let right = [&du, &dv].map(|tangent| {
        let product = dot(graph, tangent, &along);
        graph.neg(product)
    });
    let metric = [
        dot(graph, &du, &du),
        dot(graph, &du, &dv),
        dot(graph, &dv, &dv),
    ];
    let solution = solve(graph, metric, right);
    Ok(graph.operation_count(&solution) as u64)
}

fn expanded(graph: &Graph, position: &[NodeId]) -> Result<u64, TooLarge> {
    let mut trees = Trees::default();
    let position = trees.write(graph, position)?;
    // One pass stands for both parameters: what is not simplified has the same size by either.
    let tangent = trees.derivatives(&position)?;
    let entry = trees.dot(&tangent, &tangent)?;
    let derivative = trees.derivatives(&[entry])?;
    let entries = trees.size(&[entry; 3]);
    let derivatives = trees.size(&[derivative[0]; 6]);
    let functions = entries.saturating_add(derivatives);
    Ok(functions.saturating_add(system_operations()))
}

/// E, F and G as trees, and the derivatives of each by both parameters.
fn expanded_form(graph: &Graph, form: &[NodeId]) -> Result<u64, TooLarge> {
    let mut trees = Trees::default();
    let form = trees.write(graph, form)?;
    let derivatives = trees.derivatives(&form)?;
    let derivatives = trees.size(&derivatives).saturating_mul(2);
    let functions = trees.size(&form).saturating_add(derivatives);
    Ok(functions.saturating_add(system_operations()))
}

/// System 2.2 over the nine values, once they are there.
fn system_operations() -> u64 {
    let mut graph = Graph::default();
    let mut triple = |first: u32| [0, 1, 2].map(|k| graph.input(Input::Variable(4 + first + k)));
    let [form, by_u, by_v] = [triple(0), triple(3), triple(6)];
    let solution = system(&mut graph, form, by_u, by_v);
    graph.operation_count(&solution) as u64
}

/// The solution of system 2.2.
fn system(
    graph: &mut Graph,
    form: [NodeId; 3],
    [eu, fu, gu]: [NodeId; 3],
    [ev, fv, gv]: [NodeId; 3],
) -> [NodeId; 2] {
    let (p, q) = velocity(graph);
    let first = right_side(graph, [p, q], [eu, ev, gu, fv]);
    let second = right_side(graph, [q, p], [gv, gu, ev, fu]);
    let two = graph.constant(2.0);
    let doubled = form.map(|entry| graph.mul(two, entry));
    solve(graph, doubled, [first, second])
}

/// q²(c − 2d) − p²a − 2pq·b: a line of system 2.2, and the other one with the parameters exchanged.
fn right_side(graph: &mut Graph, [p, q]: [NodeId; 2], [a, b, c, d]: [NodeId; 4]) -> NodeId {
    let two = graph.constant(2.0);
    let twice = graph.mul(two, d);
    let difference = graph.sub(c, twice);
    let qq = graph.mul(q, q);
    let first = graph.mul(qq, difference);
    let pp = graph.mul(p, p);
    let second = graph.mul(pp, a);
    let pq = graph.mul(p, q);
    let pq = graph.mul(two, pq);
    let third = graph.mul(pq, b);
    let sum = graph.sub(first, second);
    graph.sub(sum, third)
}

/// u' and v'.
fn velocity(graph: &mut Graph) -> (NodeId, NodeId) {
    (
        graph.input(Input::Variable(2)),
        graph.input(Input::Variable(3)),
    )
}

fn dot(graph: &mut Graph, a: &[NodeId], b: &[NodeId]) -> NodeId {
    let mut sum = graph.constant(0.0);
    for (&x, &y) in a.iter().zip(b) {
        let product = graph.mul(x, y);
        sum = graph.add(sum, product);
    }
    sum
}

/// The solution of `[e f; f g]`·x = right by Cramer's rule.
fn solve(graph: &mut Graph, [e, f, g]: [NodeId; 3], [first, second]: [NodeId; 2]) -> [NodeId; 2] {
    let eg = graph.mul(e, g);
    let ff = graph.mul(f, f);
    let determinant = graph.sub(eg, ff);
    [(g, first, f, second), (e, second, f, first)].map(|(a, x, b, y)| {
        let ax = graph.mul(a, x);
        let by = graph.mul(b, y);
        let numerator = graph.sub(ax, by);
        graph.div(numerator, determinant)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// σ(u, v) = (u, v, u v).
    fn saddle() -> (Graph, [NodeId; 3]) {
        let mut graph = Graph::default();
        let (u, v) = (graph.input(U), graph.input(V));
        let product = graph.mul(u, v);
        (graph, [u, v, product])
    }

    #[test]
    fn counts_are_those_made_by_hand() {
        let (graph, position) = saddle();
        let count = count(&graph, &position).expect("a small surface");
        // Ours: u'v' doubled (2); E = 1 + v², F = uv, G = 1 + u² (5); −σu·A, −σv·A (4); the solution (11).
        // The simplifier may move a sign out of them.
        let ours = count.acceleration_operations;
        assert!((18..=22).contains(&ours), "{ours}");
        // The thesis': σu and σv have an entry of 3 operations, so E, F, G have 11 each; the derivative of that
        // entry has 7, so the six derivatives have 31 each; the right sides (18), the doubled matrix (3), the
        // solution (11).
        assert_eq!(count.thesis_tree_operations, 3 * 11 + 6 * 31 + 18 + 3 + 11);
    }

    #[test]
    fn a_metric_is_counted_by_its_own_form() {
        // du² + (1 + u²) dv².
        let mut graph = Graph::default();
        let u = graph.input(U);
        let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
        let square = graph.mul(u, u);
        let last = graph.add(one, square);
        let count = count_metric(&graph, &[one, zero, last]).expect("a small metric");
        // G has 2 operations, its derivative as a tree 4 by either parameter, and the system 32.
        let system = 18 + 3 + 11;
        let trees = count.thesis_tree_operations;
        assert!(
            (2 + system..=2 + 2 * 5 + system).contains(&trees),
            "{trees}"
        );
        assert!(count.acceleration_operations < trees);
    }

    #[test]
    fn a_deeper_surface_gains_more() {
        let (mut graph, mut position) = saddle();
        let small = count(&graph, &position).expect("a small surface");
        for _ in 0..4 {
            let squared = graph.mul(position[2], position[2]);
            position[2] = graph.add(squared, position[0]);
        }
        let large = count(&graph, &position).expect("a surface");
        assert!(large.ratio() > 4.0 * small.ratio(), "{small:?} {large:?}");
    }
}
