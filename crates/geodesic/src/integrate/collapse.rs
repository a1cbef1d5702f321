//! Losses of rank ahead of a ray: steps towards one would shrink to nothing, so it is detected in advance.

use super::ray::Ray;
use super::stalled_at;
use crate::chart::Chart;
use crate::status::Status;
use crate::surface::Side;
use crate::vector::{cross, dot, norm};

/// R = |σu×σv| is monitored below this fraction of its typical value.
const LOW: f64 = 1e-2;
/// Within this fraction of the surface's size from a loss of rank, a ray has reached it.
const AT_HAND: f64 = 1e-6;
/// The signed R has vanished at this fraction of its former value.
const GONE: f64 = 1e-6;
/// At most this fraction of R remains there: where the normal has merely turned by a right angle, the signed R is 0 and R is
/// not.
const LEFT: f64 = 1e-3;

impl Ray<'_, '_> {
    /// Returns R = |σu×σv| at the ray's point, in (u,v).
    pub(super) fn rank(&self) -> f64 {
        norm(cross(self.local.tangents[0], self.local.tangents[1]))
    }

    /// Returns whether R vanishes straight ahead and nearby, after a step of length `h` in (u,v), before which R was
    /// `before`. It must be shown to vanish: where it is merely small, as on the rim of a flat ellipsoid, a ray
    /// continues.
    pub(super) fn collapses(&self, before: f64, h: f64) -> Option<Status> {
        let Chart::Plain = self.chart else {
            return None;
        };
        let [su, sv] = self.atlas.layout.scale.stretch;
        let rank = self.rank();
        let far = rank >= LOW * su * sv || rank >= before;
        // Extrapolate R to 0 at the rate of the last step.
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
