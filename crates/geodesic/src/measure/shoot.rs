//! Newton's method on the exponential map. In: a guess of angle and length. Out: the geodesic that meets the target.
//!
//! The derivative is the Jacobi field: the end moves by 1 along the ray per unit of length, and by m across it per
//! radian. Where m nearly vanishes, Levenberg–Marquardt damping limits the change of the angle.

use super::gap::AimedPlace;
use super::source::{Arrival, RaySource};
use crate::status::Status;

/// The angle and length of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct PolarVector {
    pub(super) angle: f64,
    pub(super) length: f64,
}

/// The targets and limits of Newton's method.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewtonBounds {
    /// The distance from the target at which the iteration stops.
    pub(super) aim: f64,
    /// The distance that is accepted when the iteration makes no more progress.
    pub(super) tolerance: f64,
    /// The size of m at which damping sets in.
    pub(super) damping: f64,
    /// The maximum step in length.
    pub(super) stride: f64,
    pub(super) iterations: u32,
}

/// A ray that meets its target.
#[derive(Clone, Debug)]
pub(super) struct Hit {
    pub(super) at: PolarVector,
    pub(super) end: Arrival,
    /// The distance from the target.
    pub(super) off: f64,
}

/// The maximum change of the angle in one step.
const TURN: f64 = 0.3;

/// Improves a guess until its ray meets the target.
pub(super) fn newton(
    target: &AimedPlace<'_>,
    guess: PolarVector,
    bounds: &NewtonBounds,
    follow: &dyn Fn(PolarVector) -> Option<Arrival>,
) -> Option<Hit> {
    let mut at = guess;
    let mut best: Option<Hit> = None;
    let mut share = 1.0;
    for _ in 0..bounds.iterations {
        if !(at.length > 0.0 && at.length.is_finite()) {
            break;
        }
        let look = follow(at).and_then(|end| Some((target.way_from(&end)?, end)));
        let better = match (&look, &best) {
            (None, _) => false,
            (Some(_), None) => true,
            (Some(([x, y], _)), Some(best)) => x.hypot(*y) < best.off,
        };
        if better && let Some(([x, y], end)) = look {
            // A ray that ends early has the length it reached.
            at.length = end.length;
            let off = x.hypot(y);
            best = Some(Hit { at, end, off });
            share = 1.0;
            if off <= bounds.aim {
                return best;
            }
        } else {
            share *= 0.25;
            if share < 1e-3
                || best
                    .as_ref()
                    .is_some_and(|best| best.off <= bounds.tolerance)
            {
                break;
            }
        }
        let hit = best.as_ref()?;
        let [along, across] = target.way_from(&hit.end)?;
        let m = hit.end.m;
        let turn = across * m / (m * m + bounds.damping * bounds.damping);
        at = PolarVector {
            angle: hit.at.angle + share * turn.clamp(-TURN, TURN),
            length: hit.at.length + share * along.clamp(-bounds.stride, bounds.stride),
        };
    }
    best.filter(|best| best.off <= bounds.tolerance)
}

/// The distance from its target within which a ray must end, relative to its length.
const EXACT: f64 = 1e-10;
/// m counts as zero below this fraction of the length.
const NO_FIELD: f64 = 1e-8;

/// Improves a guess with rays that are integrated on their own.
pub(super) fn hit(
    source: &RaySource<'_>,
    target: &AimedPlace<'_>,
    guess: PolarVector,
) -> Option<Hit> {
    let size = guess.length.max(target.near_distance(source));
    let rounding = 8.0 * f64::EPSILON * source.surface.scale().size;
    let bounds = NewtonBounds {
        aim: 1e-3 * EXACT * size,
        tolerance: (EXACT * size).max(rounding),
        damping: 0.1 * NO_FIELD * size,
        stride: 0.2 * size,
        iterations: 24,
    };
    let follow = |at: PolarVector| {
        let (end, _) = source.follow(at.angle, at.length, false).ok()?;
        let met = matches!(
            end.status,
            Status::Complete | Status::LeftDomain | Status::ConePoint
        );
        met.then_some(end)
    };
    newton(target, guess, &bounds, &follow)
}

/// Returns true if the end is conjugate to the start: m = 0 to within its accuracy.
pub(super) fn is_conjugate(hit: &Hit) -> bool {
    hit.end.m.abs() <= 10.0 * NO_FIELD * hit.at.length
}
