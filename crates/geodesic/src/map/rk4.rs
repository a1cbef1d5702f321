//! The thesis' method at its best: the classical Runge–Kutta method in (u,v), with steps of equal length and nothing
//! else, a pixel at a time or several.
//!
//! In: starts in (u,v) with velocities, whose geodesics are wanted at the time 1. Out: where they end, beyond sides
//! that wrap brought back, and why. Poles are passed as (u,v) pass them, edges are looked for at the steps' ends.

use expr::processor::{Processor, Work};
use expr::real::Real;

use crate::accelerations::Pair;
use crate::chart::{Atlas, Motion};
use crate::surface::{LANES, SINGLES, Side, Surface};
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
    surface: &S,
    start: Motion,
    steps: u32,
    single: bool,
) -> End {
    if single {
        follow::<true, S>(atlas, surface, start, steps)
    } else {
        follow::<false, S>(atlas, surface, start, steps)
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
    surface: &S,
    start: Motion,
    steps: u32,
) -> End {
    let h = 1.0 / f64::from(steps);
    let mut at = rounded::<SINGLE>(start.at);
    let mut velocity = rounded::<SINGLE>(start.velocity);
    let along =
        |x: [f64; 2], s: f64, y: [f64; 2]| rounded::<SINGLE>([x[0] + s * y[0], x[1] + s * y[1]]);
    let acceleration = |mut at: [f64; 2], velocity: [f64; 2]| {
        let signs = atlas.bring_back(&mut at).signs;
        let turned = [0, 1].map(|k| signs[k] * velocity[k]);
        let acceleration = surface.acceleration(at, turned);
        rounded::<SINGLE>([0, 1].map(|k| signs[k] * acceleration[k]))
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

/// A precision, in vectors of `N` lanes.
pub(super) trait Precision<const N: usize>: Real {
    /// [`Surface::accelerations`] in it.
    fn accelerations<S: Surface + ?Sized>(
        surface: &S,
        at: &Pair<Self, N>,
        velocity: &Pair<Self, N>,
        out: &mut Pair<Self, N>,
    );
}

impl Precision<LANES> for f64 {
    #[inline(always)]
    fn accelerations<S: Surface + ?Sized>(
        surface: &S,
        at: &Pair<Self, LANES>,
        velocity: &Pair<Self, LANES>,
        out: &mut Pair<Self, LANES>,
    ) {
        surface.accelerations(at, velocity, out);
    }
}

impl Precision<SINGLES> for f32 {
    #[inline(always)]
    fn accelerations<S: Surface + ?Sized>(
        surface: &S,
        at: &Pair<Self, SINGLES>,
        velocity: &Pair<Self, SINGLES>,
        out: &mut Pair<Self, SINGLES>,
    ) {
        surface.accelerations_single(at, velocity, out);
    }
}

/// Several geodesics side by side.
pub(super) fn several<T: Precision<N>, const N: usize, S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    surface: &S,
    starts: [Motion; N],
    steps: u32,
) -> [End; N] {
    let work = Several::<T, N, S> {
        atlas,
        surface,
        domain: atlas.domain.map(|ends| ends.map(T::nearest)),
        starts,
        steps,
    };
    Processor::here().run(work)
}

struct Several<'a, 's, T, const N: usize, S: Surface + ?Sized> {
    atlas: &'a Atlas<'s, S>,
    surface: &'a S,
    domain: [[T; 2]; 2],
    starts: [Motion; N],
    steps: u32,
}

impl<T: Precision<N>, const N: usize, S: Surface + ?Sized> Work for Several<'_, '_, T, N, S> {
    type Output = [End; N];

    #[inline(always)]
    fn run(self) -> Self::Output {
        let h = 1.0 / f64::from(self.steps);
        let (whole, half) = (T::nearest(h), T::nearest(0.5 * h));
        let (mut at, mut velocity) = ([[T::default(); N]; 2], [[T::default(); N]; 2]);
        let mut status = [None; N];
        let mut evaluations = [0; N];
        for (lane, start) in self.starts.iter().enumerate() {
            for k in 0..2 {
                at[k][lane] = T::nearest(start.at[k]);
                velocity[k][lane] = T::nearest(start.velocity[k]);
            }
        }
        for _ in 0..self.steps {
            for lane in 0..N {
                evaluations[lane] += if status[lane].is_none() { 4 } else { 0 };
            }
            let before = at;
            let a1 = self.acceleration(&at, &velocity);
            let v2 = along(&velocity, half, &a1);
            let a2 = self.acceleration(&along(&at, half, &velocity), &v2);
            let v3 = along(&velocity, half, &a2);
            let a3 = self.acceleration(&along(&at, half, &v2), &v3);
            let v4 = along(&velocity, whole, &a3);
            let a4 = self.acceleration(&along(&at, whole, &v3), &v4);
            at = along(&at, whole, &mean(&velocity, &v2, &v3, &v4));
            velocity = along(&velocity, whole, &mean(&a1, &a2, &a3, &a4));
            if self.all_inside(&at) {
                continue;
            }
            let mut running = false;
            for lane in 0..N {
                let [was, is]: [[f64; 2]; 2] =
                    [before, at].map(|at| [at[0][lane].into(), at[1][lane].into()]);
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
                    at[k][lane] = T::nearest(next[k]);
                    velocity[k][lane] = velocity[k][lane] * T::nearest(signs[k]);
                }
                status[lane] = ending;
                running |= ending.is_none();
            }
            if !running {
                break;
            }
        }
        std::array::from_fn(|lane| {
            let mut end = [at[0][lane].into(), at[1][lane].into()];
            self.atlas.bring_back(&mut end);
            End {
                at: end,
                status: status[lane].unwrap_or_default(),
                evaluations: evaluations[lane],
            }
        })
    }
}

impl<T: Precision<N>, const N: usize, S: Surface + ?Sized> Several<'_, '_, T, N, S> {
    #[inline(always)]
    fn all_inside(&self, at: &Pair<T, N>) -> bool {
        let [[a, b], [c, d]] = self.domain;
        let mut inside = true;
        for (u, v) in at[0].iter().zip(&at[1]) {
            inside &= (*u >= a) & (*u <= b) & (*v >= c) & (*v <= d);
        }
        inside
    }

    /// See [`Surface::accelerations`].
    #[inline(always)]
    fn acceleration(&self, at: &Pair<T, N>, velocity: &Pair<T, N>) -> Pair<T, N> {
        let mut out = [[T::default(); N]; 2];
        if self.all_inside(at) {
            T::accelerations(self.surface, at, velocity, &mut out);
            return out;
        }
        let (mut back, mut turned) = (*at, *velocity);
        let mut signs = [[T::ONE; N]; 2];
        for lane in 0..N {
            let mut point = [back[0][lane].into(), back[1][lane].into()];
            let turn = self.atlas.bring_back(&mut point).signs;
            for k in 0..2 {
                back[k][lane] = T::nearest(point[k]);
                signs[k][lane] = T::nearest(turn[k]);
                turned[k][lane] = turned[k][lane] * signs[k][lane];
            }
        }
        T::accelerations(self.surface, &back, &turned, &mut out);
        for k in 0..2 {
            for lane in 0..N {
                out[k][lane] = out[k][lane] * signs[k][lane];
            }
        }
        out
    }
}

#[inline(always)]
fn along<T: Real, const N: usize>(x: &Pair<T, N>, s: T, y: &Pair<T, N>) -> Pair<T, N> {
    let mut out = *x;
    for k in 0..2 {
        for lane in 0..N {
            out[k][lane] = x[k][lane] + s * y[k][lane];
        }
    }
    out
}

#[inline(always)]
fn mean<T: Real, const N: usize>(
    a: &Pair<T, N>,
    b: &Pair<T, N>,
    c: &Pair<T, N>,
    d: &Pair<T, N>,
) -> Pair<T, N> {
    let sixth = T::nearest(1.0 / 6.0);
    let mut out = *a;
    for k in 0..2 {
        for lane in 0..N {
            let middle = b[k][lane] + c[k][lane];
            out[k][lane] = sixth * (a[k][lane] + (middle + middle) + d[k][lane]);
        }
    }
    out
}
