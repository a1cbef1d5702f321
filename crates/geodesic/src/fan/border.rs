//! The ends of two rays and of the points between them: edges, their slopes, and the arc lengths up to which they are
//! known.
//!
//! In: a pair of rays, the angle between them, a fraction of the way from one to the other. Out: arc lengths and
//! statuses.

use super::ray::{Ray, Stop};
use crate::interpolate::cubic;
use crate::status::Status;

/// Interpolation at equal fractions of the way to an oblique edge, instead of equal arc lengths: where only one of two
/// rays continues, the other gives no information.
pub(super) struct Stretch {
    pub(super) ends: [f64; 2],
    pub(super) slopes: [f64; 2],
    /// The arc length of the edge here, and its derivative by the angle.
    pub(super) s: f64,
    pub(super) slope: f64,
}

impl Stretch {
    #[inline(always)]
    pub(super) fn of(rays: [&Ray; 2], width: f64, t: f64) -> Option<Self> {
        let (a, b) = (rays[0].stop.as_ref()?, rays[1].stop.as_ref()?);
        if !aslant(rays, [a, b]) || !(a.slope + b.slope).is_finite() {
            return None;
        }
        let rest = 1.0 - t;
        let (s, _) = edge(rays, width, t)?;
        let slope = 6.0 * t * rest / width * (b.s - a.s)
            + (1.0 - t * (4.0 - 3.0 * t)) * a.slope
            + t * (3.0 * t - 2.0) * b.slope;
        Some(Self {
            ends: [a.s, b.s],
            slopes: [a.slope, b.slope],
            s,
            slope,
        })
    }
}

/// Returns whether points must and can be interpolated at equal fractions of the way to the edge.
#[inline(always)]
fn aslant(rays: [&Ray; 2], stops: [&Stop; 2]) -> bool {
    let [a, b] = stops;
    let far = a.s.max(b.s);
    let known = rays.into_iter().all(|ray| far <= ray.end + ray.slack);
    let like = a.status == b.status && a.edge == b.edge && a.status != Status::WorkLimit;
    let smooth = rays.into_iter().all(|ray| ray.passages.is_empty());
    like && smooth && !known && a.s.min(b.s) > 0.5 * far
}

/// Returns the arc length up to which both rays continue: 0 where they end at an edge that may be oblique.
pub(super) fn free_until(rays: [&Ray; 2]) -> f64 {
    if is_stretched(rays) {
        return 0.0;
    }
    rays[0].limit().min(rays[1].limit())
}

/// Returns whether points between two rays are given by their fractions of the way to the edge, once its slope is
/// known.
#[inline(always)]
pub(super) fn is_stretched(rays: [&Ray; 2]) -> bool {
    match (&rays[0].stop, &rays[1].stop) {
        (Some(a), Some(b)) => aslant(rays, [a, b]),
        _ => false,
    }
}

/// Returns the arc length of the edge at the fraction `t` between two rays that leave through it.
#[inline(always)]
pub(super) fn edge(rays: [&Ray; 2], width: f64, t: f64) -> Option<(f64, Status)> {
    let [a, b] = [rays[0].stop?, rays[1].stop?];
    let rest = 1.0 - t;
    let status = if t < 0.5 { a.status } else { b.status };
    let smooth = a.edge == b.edge && a.slope.is_finite() && b.slope.is_finite();
    let s = if smooth {
        cubic(t, width, [a.s, a.slope], [b.s, b.slope])
    } else {
        rest * a.s + t * b.s
    };
    Some((s, status))
}

/// Returns the arc length up to which any point between two rays is on the surface: an edge may bulge outwards between
/// the points where they leave.
pub(super) fn farthest(rays: [&Ray; 2], width: f64) -> f64 {
    let far = rays[0].limit().max(rays[1].limit());
    let (Some(a), Some(b)) = (rays[0].stop, rays[1].stop) else {
        return far;
    };
    let left = |stop: &Stop| stop.status == Status::LeftDomain;
    if !left(&a) || !left(&b) {
        return far;
    }
    if a.edge != b.edge {
        return far.max(rays[0].end.min(rays[1].end));
    }
    let between = [0.25, 0.5, 0.75].map(|t| edge(rays, width, t).map_or(far, |(s, _)| s));
    between.into_iter().fold(far, f64::max)
}

/// Returns the reason why both rays have ended before an arc length, if they have.
#[inline(always)]
pub(super) fn both_ended(rays: [&Ray; 2], t: f64, s: f64) -> Option<Status> {
    let [a, b] = [rays[0].stop?, rays[1].stop?];
    let known = a.status != Status::WorkLimit && b.status != Status::WorkLimit;
    (known && s > a.s && s > b.s).then_some(if t < 0.5 { a.status } else { b.status })
}

/// Returns the error of the exit point of a third ray as predicted by two rays, as a length; infinite where they do not
/// agree.
pub(super) fn exit_discrepancy(rays: [&Ray; 2], width: f64, middle: &Ray) -> f64 {
    match (rays[0].stop, rays[1].stop, middle.stop) {
        (None, None, None) => 0.0,
        (Some(_), Some(_), Some(stop)) => {
            edge(rays, width, 0.5).map_or(f64::INFINITY, |(s, _)| (s - stop.s).abs())
        }
        _ => f64::INFINITY,
    }
}

/// Returns whether two rays end alike, so that everything between them follows from both.
pub(super) fn end_alike(rays: [&Ray; 2], reach: f64, pixel: f64) -> bool {
    let known = |ray: &Ray, s: f64| s <= ray.end + ray.slack;
    match (rays[0].stop, rays[1].stop) {
        (None, None) => true,
        (Some(a), Some(b)) => {
            let like = a.status == b.status && a.edge == b.edge && a.status != Status::WorkLimit;
            let far = a.s.max(b.s);
            let near = (a.s - b.s).abs() <= pixel
                || (a.edge.is_some() && known(rays[0], far) && known(rays[1], far))
                || (aslant(rays, [&a, &b]) && (a.slope + b.slope).is_finite());
            // Beyond the picture, nothing matters.
            (like && near) || a.s.min(b.s) >= reach
        }
        (Some(stop), None) | (None, Some(stop)) => {
            let ended = if rays[0].stop.is_some() {
                rays[0]
            } else {
                rays[1]
            };
            stop.s >= reach || (stop.status == Status::LeftDomain && known(ended, reach))
        }
    }
}
