//! The edge that a step crosses.

use super::ray::Knot;
use crate::chart::{ChartLayout, State};
use crate::interpolate::{quintic, turning_points, value};

/// Returns the edge through which a step in the plain coordinates leaves, as its axis and end, and the fraction of the
/// step after which it does. `before` is the acceleration at the start.
pub(super) fn leaves(
    layout: &ChartLayout,
    from: &State,
    before: [f64; 2],
    to: &Knot,
    h: f64,
) -> Option<(f64, (usize, usize))> {
    let path = [0, 1].map(|k| {
        let start = [from.at[k], from.velocity[k], before[k]];
        quintic(h, start, [to.at[k], to.velocity[k], to.acceleration[k]])
    });
    let point = |x: f64| [0, 1].map(|k| value(&path[k], x));
    // A step that comes back inside is farthest beyond the edge where it turns.
    let turns = [0, 1].into_iter().flat_map(|k| {
        let [from, to] = [(from.at[k], from.velocity[k]), (to.at[k], to.velocity[k])];
        turning_points(h, from.into(), to.into())
    });
    let (first, edge) = layout.edge_on_way(to.at, 0.0, turns, point)?;
    let crossing = |edge: (usize, usize), beyond: f64| {
        let (mut low, mut high) = ((first - 0.25).max(0.0), beyond);
        for _ in 0..48 {
            let middle = 0.5 * (low + high);
            if layout.beyond(point(middle), edge) > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    };
    let share = crossing(edge, first);
    Some(match layout.beyond_edge(point(share)) {
        // Near a corner both edges are crossed between two samples.
        Some(earlier) if earlier != edge => (crossing(earlier, share), earlier),
        _ => (share, edge),
    })
}
