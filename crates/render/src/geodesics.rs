//! Geodesics as polylines: points at given arc lengths, of declared geodesics and of the camera's own.
//!
//! Each point is reached from the one before it; where that cannot be gone on from (in a pole), from the start.

mod polylines;

pub(crate) use polylines::{Line, Polyline, Polylines};

use geodesic::frame::Frame;
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status, Trace, TraceError, trace};
use rayon::prelude::*;
use scene::InitialConditionsEvaluator;
use scene::ParamValues;
use scene::{Object, ObjectId, Sampling, Scene, Shape};

use crate::ground::Ground;

/// The most points of all instances of a declared geodesic; further instances are not drawn.
pub const MAX_POINTS: u64 = 2_000_000;

/// A point of a geodesic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// In the chart, brought back into the domain.
    pub uv: [f64; 2],
    /// In space; none on a metric.
    pub position: Option<[f64; 3]>,
}

/// A declared geodesic, followed.
#[derive(Clone, Debug, Default)]
pub struct Followed {
    /// Points of one instance.
    pub count: u32,
    /// For each instance its points in the order of t; `None` where the geodesic does not get to.
    pub lines: Vec<Vec<Option<Knot>>>,
    /// What a reader of the picture should know.
    pub notes: Vec<String>,
}

/// Follows all instances of a declared geodesic on all cores; nothing for other objects.
pub fn declared(scene: &Scene, settings: &ParamValues, id: ObjectId) -> Followed {
    let Some((object, surface, domain)) = parts(scene, id) else {
        return Followed::default();
    };
    let Some(launcher) = InitialConditionsEvaluator::new(scene, id) else {
        return Followed::default();
    };
    let name = &object.name;
    let instances = settings.instance_count(scene, object);
    let drawn = instances.min((MAX_POINTS / u64::from(domain.count.max(1))).max(1));
    let mut notes = Vec::new();
    if drawn < instances {
        notes.push(format!(
            "of the {instances} instances of `{name}` the first {drawn} are drawn: that is the limit"
        ));
    }
    let lengths: Vec<f64> = (0..domain.count).map(|i| domain.value(i)).collect();
    // Only a surface that depends on grids is another one for each instance.
    let on = scene.objects.get(surface.0 as usize);
    let shared = on
        .filter(|on| on.grids.is_empty())
        .map(|on| Ground::new(scene, surface, &settings.first_instance(scene, on)));
    let line = |index: u64| -> (Vec<Option<Knot>>, Option<String>) {
        let nowhere = || vec![None; lengths.len()];
        let uniforms = settings.instance(scene, object, index);
        let own;
        let ground = match &shared {
            Some(shared) => shared,
            None => {
                own = Ground::new(scene, surface, &uniforms);
                &own
            }
        };
        let ground = match ground {
            Ok(ground) => ground,
            Err(error) => return (nowhere(), Some(error.to_string())),
        };
        match launcher.clone().evaluate(&uniforms) {
            Ok(launch) => {
                let surface = ground.surface();
                let from = Start::Chart(launch.start, launch.direction);
                (along(surface, &from, &lengths), None)
            }
            Err(fault) => (nowhere(), Some(fault.to_string())),
        }
    };
    let (lines, faults): (Vec<_>, Vec<_>) = (0..drawn).into_par_iter().map(line).unzip();
    let faults: Vec<String> = faults.into_iter().flatten().collect();
    if let Some(first) = faults.first() {
        notes.push(match (faults.len(), drawn) {
            (_, 1) => format!("`{name}` is not drawn: {first}"),
            (few, all) => {
                format!("{few} of the {all} instances of `{name}` are not drawn: {first}")
            }
        });
    }
    Followed {
        count: domain.count,
        lines,
        notes,
    }
}

/// The surface of a declared geodesic, if it lies in space: then the geodesic is drawn there.
pub fn in_space(scene: &Scene, id: ObjectId) -> bool {
    parts(scene, id).is_some_and(|(_, surface, _)| {
        let on = scene.objects.get(surface.0 as usize);
        on.is_some_and(|on| matches!(on.shape, Shape::Surface { .. }))
    })
}

fn parts(scene: &Scene, id: ObjectId) -> Option<(&Object, ObjectId, &Sampling)> {
    let object = scene.objects.get(id.0 as usize)?;
    match &object.shape {
        Shape::Geodesic {
            surface, domain, ..
        } => Some((object, *surface, domain)),
        _ => None,
    }
}

/// How a geodesic begins.
pub(crate) enum Start<'a> {
    /// At (u,v), in a direction a σu + b σv.
    Chart([f64; 2], [f64; 2]),
    /// At a frame, towards a place of its picture.
    Frame(&'a Frame, [f64; 2]),
}

impl Start<'_> {
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

/// The points at ascending arc lengths, of which some may be negative: they lie behind the start.
pub(crate) fn along(surface: &dyn Surface, start: &Start, lengths: &[f64]) -> Vec<Option<Knot>> {
    let ahead = lengths.partition_point(|&t| t < 0.0);
    let behind: Vec<f64> = lengths[..ahead].iter().rev().copied().collect();
    let mut knots = one_way(surface, start, &behind);
    knots.reverse();
    knots.extend(one_way(surface, start, &lengths[ahead..]));
    knots
}

/// The points at arc lengths of one sign, each further away than the one before.
fn one_way(surface: &dyn Surface, start: &Start, lengths: &[f64]) -> Vec<Option<Knot>> {
    let mut knots = Vec::with_capacity(lengths.len());
    // The last point, with the direction that the geodesic has there.
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
                    uv: trace.uv,
                    position: trace.position,
                }));
                // What ends early is drawn up to its end.
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
