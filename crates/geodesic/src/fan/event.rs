//! What may happen within a step: a ray leaves through an edge, or goes through the tip of a cone.

use super::coordinates::Space;
use super::ray::Knot;
use crate::chart::State;

/// A lane within this share of its radius of a cone's tip has hit it.
pub(super) const HIT: f64 = 1e-9;

/// Returns whether a step in the plain coordinates leaves through an edge: the share of it, and which.
pub(super) fn leaves(
    space: &Space,
    from: &State,
    before: [f64; 2],
    to: &Knot,
    h: f64,
) -> Option<(f64, (usize, usize))> {
    if !space.has_edges() {
        return None;
    }
    let point = |x: f64| {
        [0, 1].map(|k| {
            let (c1, c2) = (h * from.velocity[k], 0.5 * h * h * before[k]);
            let a = to.at[k] - from.at[k] - c1 - c2;
            let b = h * to.velocity[k] - c1 - 2.0 * c2;
            let c = h * h * to.acceleration[k] - 2.0 * c2;
            let high = [
                10.0 * a - 4.0 * b + 0.5 * c,
                -15.0 * a + 7.0 * b - c,
                6.0 * a - 3.0 * b + 0.5 * c,
            ];
            from.at[k] + x * (c1 + x * (c2 + x * (high[0] + x * (high[1] + x * high[2]))))
        })
    };
    let shares = [0.25, 0.5, 0.75, 1.0];
    let first = shares.into_iter().find(|&x| {
        let at = if x == 1.0 { to.at } else { point(x) };
        space.beyond_edge(at).is_some()
    })?;
    let edge = space.beyond_edge(if first == 1.0 { to.at } else { point(first) })?;
    let (axis, end) = edge;
    let sign = if end == 0 { -1.0 } else { 1.0 };
    let beyond = |x: f64| sign * (point(x)[axis] - space.domain[axis][end]);
    let (mut low, mut high) = (first - 0.25, first);
    for _ in 0..48 {
        let middle = 0.5 * (low + high);
        if beyond(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some((high, edge))
}

/// Returns whether a step goes through the tip of a cone.
pub(super) fn hits(from: &State, to: &Knot, radius: f64) -> bool {
    let way = [0, 1].map(|k| to.at[k] - from.at[k]);
    let square = way[0] * way[0] + way[1] * way[1];
    let share = if square > 0.0 {
        (-(from.at[0] * way[0] + from.at[1] * way[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let nearest = [0, 1].map(|k| from.at[k] + share * way[k]);
    nearest[0].hypot(nearest[1]) <= HIT * radius
}
