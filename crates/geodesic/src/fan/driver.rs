//! Rays on their way, eight at a time: runners in, runners out that have ended or that go on in another group.
//!
//! A group shares its coordinates and its steps' lengths; the error of a step is that of its worst lane. A lane that
//! asks for much shorter steps than the others, or that comes to other coordinates, leaves the group, so that it does
//! not hold it up.

use super::active_ray::ActiveRay;
use super::coordinates::Space;
use super::group::Group;

use crate::surface::{LANES, Surface};

/// The plan by which the rays of a fan are integrated.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayPlan {
    /// The error allowed per arc length.
    pub(super) rate: f64,
    /// A step shorter than this is allowed the error of one of this length: few are.
    pub(super) least: f64,
    /// What an error of direction is multiplied by to be one of position.
    pub(super) length_scale: f64,
    /// What a relative error of the Jacobi field matters.
    pub(super) field: f64,
    /// Steps below this length lead nowhere.
    pub(super) shortest: f64,
    /// The first step.
    pub(super) first: f64,
    /// The most evaluations for one ray.
    pub(super) limit: u64,
    /// What the ranges of radius are parts of.
    pub(super) reach: f64,
    /// How far a ray is followed beyond an edge, where the surface goes on there: so that the places on both sides of the
    /// edge are one smooth function, and the edge is where that leaves the domain.
    pub(super) beyond: f64,
}

/// Follows all runners to their ends, on the threads of the current pool; they come back in the order of their ids.
pub(super) fn drive_all<S: Surface + ?Sized>(
    surface: &S,
    space: &Space,
    plan: &RayPlan,
    runners: Vec<ActiveRay>,
) -> Vec<ActiveRay> {
    use rayon::prelude::*;
    let mut done = Vec::with_capacity(runners.len());
    let mut pending = runners;
    while !pending.is_empty() {
        // Rays in the same coordinates, with steps of like lengths, go together.
        pending
            .sort_by(|a, b| (a.chart.kind.cmp(&b.chart.kind)).then(octave(a.h).cmp(&octave(b.h))));
        let mut groups: Vec<Vec<ActiveRay>> = Vec::new();
        for runner in pending {
            match groups.last_mut() {
                Some(group) if group.len() < LANES && group[0].chart.kind == runner.chart.kind => {
                    group.push(runner);
                }
                _ => groups.push(vec![runner]),
            }
        }
        if groups.len() == 1 {
            groups
                .iter_mut()
                .for_each(|group| drive(surface, space, plan, group));
        } else {
            groups
                .par_iter_mut()
                .for_each(|group| drive(surface, space, plan, group));
        }
        let (ended, going): (Vec<_>, Vec<_>) =
            groups.into_iter().flatten().partition(|runner| runner.done);
        done.extend(ended);
        pending = going;
    }
    done.sort_by_key(|runner| runner.id);
    done
}

fn octave(h: f64) -> i32 {
    // A NaN or an infinity has some octave, too.
    h.log2().floor() as i32
}

/// Takes a group as far as it goes together.
fn drive<S: Surface + ?Sized>(
    surface: &S,
    space: &Space,
    plan: &RayPlan,
    runners: &mut [ActiveRay],
) {
    let count = runners.len().min(LANES);
    let runners = &mut runners[..count];
    let Some(mut group) = Group::of(surface, space, plan, runners) else {
        return;
    };
    let mut h = runners
        .iter()
        .fold(f64::INFINITY, |h, runner| h.min(runner.h));
    group.begin(runners);
    while group.active.contains(&true) {
        let remaining = runners
            .iter()
            .zip(group.active)
            .filter(|(_, active)| *active)
            .fold(0.0_f64, |most, (runner, _)| {
                most.max(runner.way(plan.beyond))
            });
        // Two steps of equal length rather than a long one and a sliver.
        let tried = if h >= remaining {
            remaining
        } else if 2.0 * h > remaining {
            0.5 * remaining
        } else {
            h
        };
        let next = group.attempt(runners, tried);
        // A step cut short by the end says little about the next.
        h = if tried < h && next >= tried {
            next.max(h.min(2.0 * next))
        } else {
            next
        };
    }
}
