//! The thesis' method at its best: the classical Runge–Kutta method in (u,v), with steps of equal length and nothing
//! else, a pixel at a time or eight.
//!
//! In: starts in (u,v) with velocities, whose geodesics are wanted at the time 1. Out: where they end, beyond sides
//! that wrap brought back, and why. Poles are passed as (u,v) pass them, edges are looked for at the steps' ends.

use expr::processor::{Processor, Work};

use crate::chart::{Atlas, Motion};
use crate::metric;
use crate::surface::{JetBlock, LANES, Lanes, Side, Surface};
use crate::trace::Status;

/// A geodesic's end, and what it took.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) at: [f64; 2],
    pub(super) status: Status,
    pub(super) evaluations: u64,
}

/// Where a point is beyond an edge, or nowhere.
fn ended<S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    before: [f64; 2],
    at: [f64; 2],
) -> Option<Status> {
    for (axis, x) in at.into_iter().enumerate() {
        let [low, high] = atlas.domain[axis];
        for (end, beyond) in [low - x, x - high].into_iter().enumerate() {
            if atlas.sides.of(axis)[end] == Side::Edge && beyond > 0.0 {
                return Some(match atlas.apexes[axis][end] {
                    Some(_) => Status::ConePoint,
                    None => Status::LeftDomain,
                });
            }
        }
    }
    let finite = at.iter().all(|x| x.is_finite());
    (!finite).then(|| {
        let mut last = before;
        atlas.bring_back(&mut last);
        atlas.rank_at(last)
    })
}

/// One geodesic, in f64 or with everything but the surface's own expressions rounded to f32.
pub(super) fn one<S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    start: Motion,
    steps: u32,
    single: bool,
) -> End {
    if single {
        follow::<true, S>(atlas, start, steps)
    } else {
        follow::<false, S>(atlas, start, steps)
    }
}

fn rounded<const SINGLE: bool>(x: [f64; 2]) -> [f64; 2] {
    if SINGLE {
        x.map(|x| f64::from(x as f32))
    } else {
        x
    }
}

fn follow<const SINGLE: bool, S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    start: Motion,
    steps: u32,
) -> End {
    let h = 1.0 / f64::from(steps);
    let mut at = rounded::<SINGLE>(start.at);
    let mut velocity = rounded::<SINGLE>(start.velocity);
    let along =
        |x: [f64; 2], s: f64, y: [f64; 2]| rounded::<SINGLE>([x[0] + s * y[0], x[1] + s * y[1]]);
    let acceleration = |at: [f64; 2], velocity: [f64; 2]| {
        rounded::<SINGLE>(metric::acceleration(&atlas.jet(at), velocity))
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
            return End {
                at: before,
                status,
                evaluations,
            };
        }
    }
    atlas.bring_back(&mut at);
    End {
        at,
        status: Status::Complete,
        evaluations,
    }
}

/// Eight geodesics side by side.
pub(super) fn eight<S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    surface: &S,
    starts: [Motion; LANES],
    steps: u32,
) -> [End; LANES] {
    Processor::here().run(Eight {
        atlas,
        surface,
        starts,
        steps,
    })
}

struct Eight<'a, 's, S: Surface + ?Sized> {
    atlas: &'a Atlas<'s, S>,
    surface: &'a S,
    starts: [Motion; LANES],
    steps: u32,
}

type Pair = [Lanes; 2];

impl<S: Surface + ?Sized> Work for Eight<'_, '_, S> {
    type Output = [End; LANES];

    #[inline(always)]
    fn run(self) -> Self::Output {
        let h = 1.0 / f64::from(self.steps);
        let (mut at, mut velocity) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2]);
        let mut status = [None; LANES];
        let mut evaluations = [0; LANES];
        for (lane, start) in self.starts.iter().enumerate() {
            for k in 0..2 {
                at[k][lane] = start.at[k];
                velocity[k][lane] = start.velocity[k];
            }
        }
        let mut jets = JetBlock::default();
        for _ in 0..self.steps {
            for lane in 0..LANES {
                evaluations[lane] += if status[lane].is_none() { 4 } else { 0 };
            }
            let before = at;
            let a1 = self.acceleration(&at, &velocity, &mut jets);
            let v2 = along(&velocity, 0.5 * h, &a1);
            let a2 = self.acceleration(&along(&at, 0.5 * h, &velocity), &v2, &mut jets);
            let v3 = along(&velocity, 0.5 * h, &a2);
            let a3 = self.acceleration(&along(&at, 0.5 * h, &v2), &v3, &mut jets);
            let v4 = along(&velocity, h, &a3);
            let a4 = self.acceleration(&along(&at, h, &v3), &v4, &mut jets);
            at = along(&at, h, &mean(&velocity, &v2, &v3, &v4));
            velocity = along(&velocity, h, &mean(&a1, &a2, &a3, &a4));
            if self.all_inside(&at) {
                continue;
            }
            let mut running = false;
            for lane in 0..LANES {
                let [was, is] = [before, at].map(|at| [at[0][lane], at[1][lane]]);
                let ending = match status[lane] {
                    Some(status) => Some(status),
                    None => ended(self.atlas, was, is),
                };
                // It rests where it was, or goes on in the domain: there no stage needs to be brought back.
                let (mut next, mut signs) = (was, [0.0; 2]);
                if ending.is_none() {
                    next = is;
                    signs = self.atlas.bring_back(&mut next).signs;
                }
                for k in 0..2 {
                    at[k][lane] = next[k];
                    velocity[k][lane] *= signs[k];
                }
                status[lane] = ending;
                running |= ending.is_none();
            }
            if !running {
                break;
            }
        }
        std::array::from_fn(|lane| {
            let mut end = [at[0][lane], at[1][lane]];
            self.atlas.bring_back(&mut end);
            End {
                at: end,
                status: status[lane].unwrap_or_default(),
                evaluations: evaluations[lane],
            }
        })
    }
}

impl<S: Surface + ?Sized> Eight<'_, '_, S> {
    #[inline(always)]
    fn all_inside(&self, at: &Pair) -> bool {
        let [[a, b], [c, d]] = self.atlas.domain;
        let mut inside = true;
        for (u, v) in at[0].iter().zip(&at[1]) {
            inside &= (*u >= a) & (*u <= b) & (*v >= c) & (*v <= d);
        }
        inside
    }

    /// See [`metric::acceleration`].
    #[inline(always)]
    fn acceleration(&self, at: &Pair, velocity: &Pair, jets: &mut JetBlock) -> Pair {
        let mut signs = [[1.0; LANES]; 2];
        if self.all_inside(at) {
            self.surface.jets(at, jets);
        } else {
            let mut back = *at;
            for lane in 0..LANES {
                let mut point = [back[0][lane], back[1][lane]];
                let turned = self.atlas.bring_back(&mut point).signs;
                for k in 0..2 {
                    back[k][lane] = point[k];
                    signs[k][lane] = turned[k];
                }
            }
            self.surface.jets(&back, jets);
        }
        let mut out = [[0.0; LANES]; 2];
        for lane in 0..LANES {
            let [s, t] = [signs[0][lane], signs[1][lane]];
            let [x, y] = [s * velocity[0][lane], t * velocity[1][lane]];
            let (xx, xy, yy) = (x * x, 2.0 * x * y, y * y);
            let (mut e, mut f, mut g) = (0.0, 0.0, 0.0);
            let (mut along_u, mut along_v) = (0.0, 0.0);
            for k in 0..3 {
                let (du, dv) = (jets.du[k][lane], jets.dv[k][lane]);
                let bent = xx * jets.duu[k][lane] + xy * jets.duv[k][lane] + yy * jets.dvv[k][lane];
                e += du * du;
                f += du * dv;
                g += dv * dv;
                along_u += du * bent;
                along_v += dv * bent;
            }
            let r = 1.0 / (e * g - f * f);
            out[0][lane] = s * r * (f * along_v - g * along_u);
            out[1][lane] = t * r * (f * along_u - e * along_v);
        }
        out
    }
}

#[inline(always)]
fn along(x: &Pair, s: f64, y: &Pair) -> Pair {
    let mut out = *x;
    for k in 0..2 {
        for lane in 0..LANES {
            out[k][lane] += s * y[k][lane];
        }
    }
    out
}

#[inline(always)]
fn mean(a: &Pair, b: &Pair, c: &Pair, d: &Pair) -> Pair {
    let mut out = *a;
    for k in 0..2 {
        for lane in 0..LANES {
            let middle = 2.0 * (b[k][lane] + c[k][lane]);
            out[k][lane] = (a[k][lane] + middle + d[k][lane]) / 6.0;
        }
    }
    out
}
