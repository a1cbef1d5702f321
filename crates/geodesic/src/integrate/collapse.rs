//! Losses of rank ahead of a ray: towards one the steps would shrink to nothing, so it is found before.

use super::ray::Ray;
use super::stalled_at;
use crate::chart::Chart;
use crate::metric::{cross, dot, norm};
use crate::status::Status;
use crate::surface::Side;

/// Below this share of its typical value R = |σu×σv| is watched.
const LOW: f64 = 1e-2;
/// Nearer than this share of the surface's size to a loss of rank, a ray is at it.
const AT_HAND: f64 = 1e-6;
/// R, with a sign, has vanished at this share of what it was.
const GONE: f64 = 1e-6;
/// At most this share of it is left there: where the normal has only turned by a right angle, R with a sign is 0, and R is not.
const LEFT: f64 = 1e-3;

impl Ray<'_, '_> {
    /// R = |σu×σv| here, in (u,v).
    pub(super) fn rank(&self) -> f64 {
        norm(cross(self.local.tangents[0], self.local.tangents[1]))
    }

    /// After a step of length `h` in (u,v), before which R was `before`: whether R vanishes straight ahead, and
    /// near by. It must be found to vanish: where it is only small, as on the rim of a flat ellipsoid, a ray goes on.
    pub(super) fn collapses(&self, before: f64, h: f64) -> Option<Status> {
        let Chart::Plain = self.chart else {
            return None;
        };
        let [su, sv] = self.atlas.layout.scale.stretch;
        let rank = self.rank();
        let far = rank >= LOW * su * sv || rank >= before;
        // As far as the rate of the last step takes R to 0.
        let ahead = rank * h / (before - rank);
        if far || ahead.is_nan() || ahead > AT_HAND * self.atlas.layout.scale.size {
            return None;
        }
        let normal = cross(self.local.tangents[0], self.local.tangents[1]);
        let point = |t: f64| [0, 1].map(|k| self.state.at[k] + t * self.state.velocity[k]);
        // With a sign, so that the secant passes through 0.
        let normal_at = |t: f64| {
            let jet = self.atlas.jet(point(t));
            cross(jet.du, jet.dv)
        };
        let signed = |t: f64| dot(normal_at(t), normal) / rank;
        let (mut a, mut b) = ((0.0, rank), (ahead, signed(ahead)));
        for _ in 0..6 {
            if b.1.abs() <= GONE * rank {
                break;
            }
            let next = b.0 - b.1 * (b.0 - a.0) / (b.1 - a.1);
            (a, b) = (b, (next, signed(next)));
        }
        let found = b.1.abs() <= GONE * rank
            && b.0 > 0.0
            && b.0 <= 4.0 * ahead
            && norm(normal_at(b.0)) <= LEFT * rank;
        let end = point(b.0);
        let inside = (0..2).all(|axis| {
            let [low, high] = self.atlas.layout.domain[axis];
            (low..=high).contains(&end[axis]) || self.atlas.layout.sides.of(axis)[0] != Side::Edge
        });
        (found && inside).then(|| stalled_at(self.atlas, end))
    }
}
