//! The integration of rays, eight at a time. In: rays. Out: rays that have ended, or that continue in another group.
//!
//! A group shares its coordinates and step lengths; the error of a step is that of its worst lane. A lane that needs
//! much shorter steps than the others, or that reaches other coordinates, leaves the group, so that it does not slow it
//! down.

use super::active_ray::ActiveRay;
use super::group::Group;
use crate::chart::ChartLayout;

use crate::step_control::{step_after, step_to_try};
use crate::surface::{LANES, Surface};

/// The parameters for integrating the rays of a fan.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayPlan {
    /// The error allowed per arc length.
    pub(super) rate: f64,
    /// A shorter step is allowed the error of a step of this length: there are few.
    pub(super) least: f64,
    /// The factor from an error of direction to one of position.
    pub(super) length_scale: f64,
    /// The weight of a relative error of the Jacobi field.
    pub(super) jacobi_weight: f64,
    /// Steps below this length make no progress.
    pub(super) shortest: f64,
    /// The first step.
    pub(super) first: f64,
    /// The longest step.
    pub(super) longest: f64,
    /// The maximum number of evaluations for one ray.
    pub(super) limit: u64,
    /// The arc length that is divided into the ranges of radius.
    pub(super) reach: f64,
    /// The arc length for which a ray is continued beyond an edge, where the surface continues there. The points on both
    /// sides of the edge are then one smooth function, and the edge is where that leaves the domain.
    pub(super) beyond: f64,
}

/// Integrates all rays to their ends, on the threads of the current pool. Returns them in the order of their ids.
pub(super) fn drive_all(
    surface: &dyn Surface,
    layout: &ChartLayout,
    plan: &RayPlan,
    rays: Vec<ActiveRay>,
) -> Vec<ActiveRay> {
    use rayon::prelude::*;
    let mut done = Vec::with_capacity(rays.len());
    let mut pending = rays;
    while !pending.is_empty() {
        // Rays in the same coordinates with similar step lengths are grouped.
        pending
            .sort_by(|a, b| (a.chart.kind.cmp(&b.chart.kind)).then(octave(a.h).cmp(&octave(b.h))));
        let mut groups: Vec<Vec<ActiveRay>> = Vec::new();
        for ray in pending {
            match groups.last_mut() {
                Some(group) if group.len() < LANES && group[0].chart.kind == ray.chart.kind => {
                    group.push(ray);
                }
                _ => groups.push(vec![ray]),
            }
        }
        if groups.len() == 1 {
            groups
                .iter_mut()
                .for_each(|group| drive(surface, layout, plan, group));
        } else {
            groups
                .par_iter_mut()
                .for_each(|group| drive(surface, layout, plan, group));
        }
        let (ended, going): (Vec<_>, Vec<_>) =
            groups.into_iter().flatten().partition(|ray| ray.done);
        done.extend(ended);
        pending = going;
    }
    done.sort_by_key(|ray| ray.id);
    done
}

fn octave(h: f64) -> i32 {
    // A NaN or an infinity gets some octave, too.
    h.log2().floor() as i32
}

/// Integrates a group as long as it stays together.
fn drive(surface: &dyn Surface, layout: &ChartLayout, plan: &RayPlan, rays: &mut [ActiveRay]) {
    let count = rays.len().min(LANES);
    let rays = &mut rays[..count];
    let Some(mut group) = Group::of(surface, layout, plan, rays) else {
        return;
    };
    let mut h = rays.iter().fold(f64::INFINITY, |h, ray| h.min(ray.h));
    group.begin(rays);
    while group.active.contains(&true) {
        let remaining = rays
            .iter()
            .zip(group.active)
            .filter(|(_, active)| *active)
            .fold(0.0_f64, |most, (ray, _)| most.max(ray.way(plan.beyond)));
        let tried = step_to_try(h.min(plan.longest), remaining);
        let next = group.attempt(rays, tried);
        h = if next >= tried {
            step_after(h, tried, next)
        } else {
            next
        };
    }
}
