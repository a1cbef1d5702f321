//! Geodesics as knots: points at given arc lengths.
//!
//! Each knot is reached from the one before it, so that a line costs its length once. Where a geodesic cannot be
//! continued from a knot (in a pole, which has no direction), it is followed again from its start.

use geodesic::frame::Frame;
use geodesic::implicit::{ImplicitSurface, SpaceTraceError};
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status, Trace, TraceError, trace};

/// A point of a geodesic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// (u, v), brought back into the domain; NaN on a solid.
    pub uv: [f64; 2],
    /// The place in space; `None` on a metric.
    pub position: Option<[f64; 3]>,
}

/// The start of a geodesic.
#[derive(Clone, Copy, Debug)]
pub enum GeodesicStart<'a> {
    /// At (u, v), in a direction a σu + b σv; its length does not matter.
    Chart([f64; 2], [f64; 2]),
    /// At a frame, towards a point of its picture.
    Frame(&'a Frame, [f64; 2]),
}

impl GeodesicStart<'_> {
    fn trace(&self, surface: &dyn Surface, length: f64) -> Result<Trace, TraceError> {
        let sign = if length < 0.0 { -1.0 } else { 1.0 };
        let options = Options::default();
        match self {
            Self::Chart(uv, direction) => {
                let direction = direction.map(|d| sign * d);
                trace(surface, *uv, direction, length.abs(), &options)
            }
            Self::Frame(frame, place) => {
                let place = place.map(|x| sign * x);
                frame.trace(surface, place, length.abs(), &options)
            }
        }
    }
}

/// Follows a geodesic to ascending arc lengths; negative ones lie behind the start. A geodesic that ends early has one
/// knot at its end and `None` from there on.
pub fn knots_at(
    surface: &dyn Surface,
    start: &GeodesicStart,
    lengths: &[f64],
) -> Vec<Option<Knot>> {
    let ahead = lengths.partition_point(|&t| t < 0.0);
    let behind: Vec<f64> = lengths[..ahead].iter().rev().copied().collect();
    let mut knots = one_way(surface, start, &behind);
    knots.reverse();
    knots.extend(one_way(surface, start, &lengths[ahead..]));
    knots
}

/// Follows a geodesic on a solid to ascending arc lengths, as [`knots_at`] does on a surface.
///
/// # Errors
/// It cannot start.
pub fn space_knots_at(
    surface: &ImplicitSurface,
    start: [f64; 3],
    direction: [f64; 3],
    lengths: &[f64],
) -> Result<Vec<Option<Knot>>, SpaceTraceError> {
    let (start, direction) = surface.start(start, direction)?;
    let one_way = |lengths: &mut dyn Iterator<Item = f64>, sign: f64, count: usize| {
        let mut knots = Vec::with_capacity(count);
        let (mut at, mut towards, mut before) = (start, direction.map(|x| sign * x), 0.0);
        for length in lengths {
            let step = (length - before).abs();
            let Ok(trace) = surface.trace(at, towards, step, &Options::default()) else {
                break;
            };
            knots.push(Some(Knot {
                uv: [f64::NAN; 2],
                position: Some(trace.position),
            }));
            // A geodesic that ends early keeps the knot at its end.
            if trace.status != Status::Complete {
                break;
            }
            (at, towards, before) = (trace.position, trace.direction, length);
        }
        knots.resize(count, None);
        knots
    };
    let ahead = lengths.partition_point(|&t| t < 0.0);
    let behind = &lengths[..ahead];
    let mut knots = one_way(&mut behind.iter().rev().copied(), -1.0, behind.len());
    knots.reverse();
    let rest = &lengths[ahead..];
    knots.extend(one_way(&mut rest.iter().copied(), 1.0, rest.len()));
    Ok(knots)
}

/// Follows a geodesic to arc lengths of one sign, each farther from the start than the one before.
fn one_way(surface: &dyn Surface, start: &GeodesicStart, lengths: &[f64]) -> Vec<Option<Knot>> {
    let mut knots = Vec::with_capacity(lengths.len());
    // The last trace, which holds the direction of the geodesic at its end, and its arc length.
    let mut last: Option<(Trace, f64)> = None;
    let complete = |trace: &Trace| trace.status == Status::Complete;
    for &length in lengths {
        let gone_on = last.as_ref().and_then(|(from, at)| {
            let step = (length - at).abs();
            let options = Options::default();
            trace(surface, from.uv, from.direction, step, &options)
                .ok()
                .filter(complete)
        });
        let reached = match gone_on {
            Some(trace) => Ok(trace),
            None => start.trace(surface, length),
        };
        match reached {
            Ok(trace) => {
                knots.push(Some(Knot {
                    uv: trace.uv.0,
                    position: trace.position,
                }));
                // A geodesic that ends early keeps the knot at its end.
                if !complete(&trace) {
                    break;
                }
                last = Some((trace, length));
            }
            Err(_) => break,
        }
    }
    knots.resize(lengths.len(), None);
    knots
}
