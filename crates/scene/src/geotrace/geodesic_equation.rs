//! The geodesic equation as expressions.

use expr::{Graph, Input, NodeId, TooLarge};

use crate::geodesic_value::ManifoldNodes;

/// Returns the right-hand side of the geodesic equation, (u'', v'') = −Γ(g′, g′), over `Variable(0..4)`, which
/// represent (u, v) and (u', v'). The Christoffel symbols are those of E, F, G: do Carmo, Differential Geometry of
/// Curves and Surfaces, 4-3.
pub(crate) fn geodesic_equation(
    graph: &mut Graph,
    manifold: &ManifoldNodes,
) -> Result<[NodeId; 2], TooLarge> {
    let [u, v] = [Input::Variable(0), Input::Variable(1)];
    let form = if manifold.is_metric {
        manifold.components.to_vec()
    } else {
        let du = graph.derivatives(&manifold.components, u)?;
        let dv = graph.derivatives(&manifold.components, v)?;
        let dot = |graph: &mut Graph, a: &[NodeId], b: &[NodeId]| {
            let zero = graph.constant(0.0);
            a.iter().zip(b).fold(zero, |sum, (x, y)| {
                let product = graph.mul(*x, *y);
                graph.add(sum, product)
            })
        };
        vec![
            dot(graph, &du, &du),
            dot(graph, &du, &dv),
            dot(graph, &dv, &dv),
        ]
    };
    let by_u = graph.derivatives(&form, u)?;
    let by_v = graph.derivatives(&form, v)?;
    let ([e, f, g], [eu, fu, gu], [ev, fv, gv]) = match (&form[..], &by_u[..], &by_v[..]) {
        (&[e, f, g], &[eu, fu, gu], &[ev, fv, gv]) => ([e, f, g], [eu, fu, gu], [ev, fv, gv]),
        _ => return Err(TooLarge),
    };
    let [p, q] = [2, 3].map(|k| graph.input(Input::Variable(k)));
    let half = graph.constant(0.5);
    // The covariant components: half of E_u p² + 2 E_v p q + (2 F_v − G_u) q², and its mirror image.
    let mut lowered = |one: NodeId, two: NodeId, three: [NodeId; 2], x: NodeId, y: NodeId| {
        let (xx, yy, xy) = (graph.mul(x, x), graph.mul(y, y), graph.mul(x, y));
        let first = graph.mul(one, xx);
        let second = graph.mul(two, xy);
        let second = graph.add(second, second);
        let twice = graph.add(three[0], three[0]);
        let third = graph.sub(twice, three[1]);
        let third = graph.mul(third, yy);
        let sum = graph.add(first, second);
        let sum = graph.add(sum, third);
        graph.mul(half, sum)
    };
    let first = lowered(eu, ev, [fv, gu], p, q);
    let second = lowered(gv, gu, [fu, ev], q, p);
    // Raised by the inverse of the form.
    let (eg, ff) = (graph.mul(e, g), graph.mul(f, f));
    let determinant = graph.sub(eg, ff);
    let mut raised = |a: NodeId, b: NodeId, c: NodeId, d: NodeId| {
        let (ab, cd) = (graph.mul(a, b), graph.mul(c, d));
        let difference = graph.sub(cd, ab);
        graph.div(difference, determinant)
    };
    let found = [raised(g, first, f, second), raised(e, second, f, first)];
    match graph.overflowed() {
        true => Err(TooLarge),
        false => Ok(found),
    }
}

/// Returns the right-hand side of the geodesic equation on the surface where a field over `Variable(0..3)` is 0: x″ =
/// −(x′ᵀHx′/|∇f|²)∇f, over `Variable(0..6)`, which represent (x, y, z) and (x', y', z').
pub(crate) fn space_geodesic_equation(
    graph: &mut Graph,
    field: NodeId,
) -> Result<[NodeId; 3], TooLarge> {
    let by = |graph: &mut Graph, node: NodeId, k: u32| {
        let found = graph.derivatives(&[node], Input::Variable(k))?;
        found.first().copied().ok_or(TooLarge)
    };
    let mut gradient = [field; 3];
    for (k, slot) in (0..).zip(&mut gradient) {
        *slot = by(graph, field, k)?;
    }
    let velocity = [3, 4, 5].map(|k| graph.input(Input::Variable(k)));
    let zero = graph.constant(0.0);
    let (mut bend, mut square) = (zero, zero);
    for (i, slope) in gradient.into_iter().enumerate() {
        let own = graph.mul(slope, slope);
        square = graph.add(square, own);
        for (j, towards) in (0..).zip(velocity) {
            let second = by(graph, slope, j)?;
            let product = graph.mul(velocity[i], towards);
            let product = graph.mul(second, product);
            bend = graph.add(bend, product);
        }
    }
    let share = graph.div(bend, square);
    let share = graph.neg(share);
    let found = gradient.map(|slope| graph.mul(share, slope));
    match graph.overflowed() {
        true => Err(TooLarge),
        false => Ok(found),
    }
}
