//! Geodesics as knots: points at given arc lengths.
//!
//! Each knot is reached from the previous one, so that a line costs only its length. Where a geodesic cannot be
//! continued from a knot (at a pole, which has no direction), it is followed again from its start.

use geodesic::frame::Frame;
use geodesic::implicit::{ImplicitSurface, SpaceTraceError};
use geodesic::surface::{Surface, affordable_evaluations};
use geodesic::trace::{Options, Status, Trace, TraceError, trace};

/// The maximum number of surface evaluations for the knots of one geodesic: about a second, a few seconds through
/// poles.
pub const MAX_LINE_EVALUATIONS: u64 = 2_000_000;

/// A geodesic as knots.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KnotLine {
    /// One for each length; `None` beyond the end of a geodesic.
    pub knots: Vec<Option<Knot>>,
    /// True if it ends because its evaluations are used up.
    pub is_cut: bool,
    /// True if the last knot that is not `None` is where it ends, before the length of that knot.
    pub ends_early: bool,
}

impl KnotLine {
    /// Returns a geodesic that does not start, at `count` lengths.
    pub(crate) fn nowhere(count: usize) -> Self {
        Self {
            knots: vec![None; count],
            is_cut: false,
            ends_early: false,
        }
    }
}

/// A point of a geodesic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// (u, v), brought back into the domain; NaN on a solid.
    pub uv: [f64; 2],
    /// The position in space; `None` on a metric.
    pub position: Option<[f64; 3]>,
}

/// The start of a geodesic.
#[derive(Clone, Copy, Debug)]
pub enum GeodesicStart<'a> {
    /// At (u, v), in the direction a σu + b σv, whose length is irrelevant.
    Chart([f64; 2], [f64; 2]),
    /// At a frame, towards a point of its picture.
    Frame(&'a Frame, [f64; 2]),
}

impl GeodesicStart<'_> {
    fn trace(
        &self,
        surface: &dyn Surface,
        length: f64,
        options: &Options,
    ) -> Result<Trace, TraceError> {
        let sign = if length < 0.0 { -1.0 } else { 1.0 };
        match self {
            Self::Chart(uv, direction) => {
                let direction = direction.map(|d| sign * d);
                trace(surface, *uv, direction, length.abs(), options)
            }
            Self::Frame(frame, place) => {
                let place = place.map(|x| sign * x);
                frame.trace(surface, place, length.abs(), options)
            }
        }
    }
}

/// Follows a geodesic to ascending arc lengths; negative ones are behind the start. A geodesic that ends early has one
/// knot at its end and `None` from there on. It uses at most about `max_evaluations` of the surface, fewer if it is
/// expensive to evaluate ([`affordable_evaluations`]).
pub fn knots_at(
    surface: &dyn Surface,
    start: &GeodesicStart,
    lengths: &[f64],
    max_evaluations: u64,
) -> KnotLine {
    let ahead = lengths.partition_point(|&t| t < 0.0);
    let behind: Vec<f64> = lengths[..ahead].iter().rev().copied().collect();
    let mut left = affordable_evaluations(surface, max_evaluations) as usize;
    let mut line = one_way(surface, start, &behind, &mut left);
    line.knots.reverse();
    let rest = one_way(surface, start, &lengths[ahead..], &mut left);
    line.knots.extend(rest.knots);
    line.is_cut |= rest.is_cut;
    line.ends_early = rest.ends_early;
    line
}

/// Follows a geodesic on a solid to ascending arc lengths, as [`knots_at`] does on a surface.
///
/// # Errors
/// It cannot start.
pub(crate) fn space_knots_at(
    surface: &ImplicitSurface,
    start: [f64; 3],
    direction: [f64; 3],
    lengths: &[f64],
    max_evaluations: u64,
) -> Result<KnotLine, SpaceTraceError> {
    let mut left = max_evaluations as usize;
    let (mut is_cut, mut ends_early) = (false, false);
    let mut one_way = |lengths: &[f64], sign: f64| {
        let options = Options {
            max_evaluations: left,
            ..Options::default()
        };
        let found = surface.trace_points(start, direction.map(|x| sign * x), lengths, &options)?;
        left = left.saturating_sub(found.evaluations);
        is_cut |= found.status == Status::WorkLimit;
        ends_early = found.status != Status::Complete;
        let mut knots: Vec<Option<Knot>> = found.points.into_iter().map(knot_in_space).collect();
        // A geodesic that ends early retains the knot at its end.
        knots.resize(lengths.len(), None);
        Ok(knots)
    };
    let ahead = lengths.partition_point(|&t| t < 0.0);
    let behind: Vec<f64> = lengths[..ahead].iter().rev().map(|t| -t).collect();
    let mut knots = one_way(&behind, -1.0)?;
    knots.reverse();
    knots.extend(one_way(&lengths[ahead..], 1.0)?);
    Ok(KnotLine {
        knots,
        is_cut,
        ends_early,
    })
}

fn knot_in_space(at: [f64; 3]) -> Option<Knot> {
    Some(Knot {
        uv: [f64::NAN; 2],
        position: Some(at),
    })
}

/// Follows a geodesic to arc lengths of one sign, in order of increasing distance from the start. The evaluations used are
/// subtracted from `left`.
fn one_way(
    surface: &dyn Surface,
    start: &GeodesicStart,
    lengths: &[f64],
    left: &mut usize,
) -> KnotLine {
    let mut knots = Vec::with_capacity(lengths.len());
    let (mut is_cut, mut ends_early) = (false, false);
    // The last trace, which contains the direction of the geodesic at its end, and its arc length.
    let mut last: Option<(Trace, f64)> = None;
    let complete = |trace: &Trace| trace.status == Status::Complete;
    for &length in lengths {
        let gone_on = last.as_ref().and_then(|(from, at)| {
            let step = (length - at).abs();
            let trace = trace(surface, from.uv, from.direction, step, &options(*left)).ok()?;
            *left = left.saturating_sub(trace.evaluations);
            Some(trace).filter(complete)
        });
        let reached = match gone_on {
            Some(trace) => Ok(trace),
            None => start
                .trace(surface, length, &options(*left))
                .inspect(|trace| *left = left.saturating_sub(trace.evaluations)),
        };
        match reached {
            Ok(trace) => {
                knots.push(Some(Knot {
                    uv: trace.uv.0,
                    position: trace.position,
                }));
                // A geodesic that ends early retains the knot at its end.
                if !complete(&trace) {
                    ends_early = true;
                    is_cut = trace.status == Status::WorkLimit;
                    break;
                }
                last = Some((trace, length));
            }
            Err(_) => break,
        }
    }
    knots.resize(lengths.len(), None);
    KnotLine {
        knots,
        is_cut,
        ends_early,
    }
}

/// Returns the options of a geodesic from one knot to the next, for a line with `left` evaluations.
fn options(left: usize) -> Options {
    Options {
        max_evaluations: left,
        ..Options::default()
    }
}
