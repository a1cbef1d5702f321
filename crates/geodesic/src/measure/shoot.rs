//! Newton's method on the exponential map: a guess of angle and length in, the geodesic that meets the target out.
//!
//! The derivative is the Jacobi field: the end moves by 1 along the ray for each unit of length, and by m across it for
//! each radian. Where m is all but zero, Levenberg and Marquardt's damping keeps the angle from leaping.

use super::gap::AimedPlace;
use super::source::{Arrival, RaySource};
use crate::status::Status;

/// The angle and length of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct PolarVector {
    pub(super) angle: f64,
    pub(super) length: f64,
}

/// The goals of Newton's method.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewtonBounds {
    /// The distance from the target that it aims at.
    pub(super) aim: f64,
    /// The distance that is near enough where it comes no nearer.
    pub(super) tolerance: f64,
    /// Beside which m is small.
    pub(super) damping: f64,
    /// The longest step of the length.
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

/// The most that the angle changes in one step.
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
            // A ray that ends early has come as far as it did.
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

/// The distance to its target within which a ray has to come, relative to its length.
const EXACT: f64 = 1e-10;
/// Beside this share of the length m is nothing.
const NO_FIELD: f64 = 1e-8;

/// Improves a guess by rays that are followed by themselves.
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

/// True if the end is conjugate to the start: m = 0 as far as can be known.
pub(super) fn is_conjugate(hit: &Hit) -> bool {
    hit.end.m.abs() <= 10.0 * NO_FIELD * hit.at.length
}
