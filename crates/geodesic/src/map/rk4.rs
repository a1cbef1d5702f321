//! The method of the thesis: the classical Runge–Kutta method in (u,v) (equations 4.2), with equal steps and without
//! extensions.
//!
//! In: a start in (u,v) with a velocity, whose geodesic is wanted at time 1. Out: its end, brought back through sides that
//! wrap, and the reason. Poles are passed in (u,v); edges are checked at the steps' ends.

use crate::chart::{Atlas, State};
use crate::metric;
use crate::point::Uv;
use crate::status::Status;
use crate::surface::{Side, Surface};

/// The end of a geodesic, and its cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelEnd {
    pub(super) at: [f64; 2],
    pub(super) status: Status,
    pub(super) evaluations: u64,
}

/// Returns the status of a ray at a point beyond an edge; `None` inside.
fn ended(atlas: &Atlas<'_>, before: [f64; 2], at: [f64; 2]) -> Option<Status> {
    for (axis, x) in at.into_iter().enumerate() {
        let [low, high] = atlas.layout.domain[axis];
        for (end, beyond) in [low - x, x - high].into_iter().enumerate() {
            if atlas.layout.sides.of(axis)[end] == Side::Edge && beyond > 0.0 {
                return Some(match atlas.layout.apexes[axis][end] {
                    Some(_) => Status::ConePoint,
                    None => Status::LeftDomain,
                });
            }
        }
    }
    let finite = at.iter().all(|x| x.is_finite());
    (!finite).then(|| {
        let mut last = before;
        atlas.layout.bring_back(&mut last);
        atlas.rank_at(last)
    })
}

/// Follows one geodesic.
pub(super) fn follow(
    atlas: &Atlas<'_>,
    surface: &dyn Surface,
    start: State,
    steps: u32,
) -> PixelEnd {
    let h = 1.0 / f64::from(steps);
    let State {
        mut at,
        mut velocity,
    } = start;
    let along = |x: [f64; 2], s: f64, y: [f64; 2]| [x[0] + s * y[0], x[1] + s * y[1]];
    let acceleration = |mut at: [f64; 2], velocity: [f64; 2]| {
        let signs = atlas.layout.bring_back(&mut at).signs;
        let turned = [0, 1].map(|k| signs[k] * velocity[k]);
        let acceleration = metric::acceleration(&surface.jet(Uv(at)), turned);
        [0, 1].map(|k| signs[k] * acceleration[k])
    };
    let mut evaluations = 0;
    for _ in 0..steps {
        evaluations += 4;
        let a1 = acceleration(at, velocity);
        let v2 = along(velocity, 0.5 * h, a1);
        let a2 = acceleration(along(at, 0.5 * h, velocity), v2);
        let v3 = along(velocity, 0.5 * h, a2);
        let a3 = acceleration(along(at, 0.5 * h, v2), v3);
        let v4 = along(velocity, h, a3);
        let a4 = acceleration(along(at, h, v3), v4);
        let mean = |a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]| {
            [0, 1].map(|k| (a[k] + 2.0 * (b[k] + c[k]) + d[k]) / 6.0)
        };
        let before = at;
        at = along(at, h, mean(velocity, v2, v3, v4));
        velocity = along(velocity, h, mean(a1, a2, a3, a4));
        if let Some(status) = ended(atlas, before, at) {
            return PixelEnd {
                at: before,
                status,
                evaluations,
            };
        }
    }
    atlas.layout.bring_back(&mut at);
    PixelEnd {
        at,
        status: Status::Complete,
        evaluations,
    }
}
