//! The classical Runge–Kutta method in (u,v) with steps of equal length (thesis, equations 4.2), several geodesics side
//! by side.
//!
//! In: starts in (u,v) with velocities, whose geodesics are wanted at the time 1. Out: where they end, beyond sides
//! that wrap brought back, and why. Poles are passed as (u,v) pass them, edges are looked for at the steps' ends.

use expr::processor::{Processor, Work};
use geodesic::surface::{Crossing, Jet, Side, Surface};
use geodesic::trace::Status;

use super::real::Real;
use super::{Equations, Pair};

/// A geodesic's end, and what it took.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) at: [f64; 2],
    pub(super) status: Status,
    pub(super) evaluations: u64,
}

/// What lies around the chart.
#[derive(Clone, Copy)]
pub(super) struct Domain<'a> {
    surface: &'a dyn Surface,
    domain: [[f64; 2]; 2],
}

impl<'a> Domain<'a> {
    pub(super) fn new(surface: &'a dyn Surface) -> Self {
        Self {
            surface,
            domain: surface.domain(),
        }
    }

    pub(super) fn bring_back(&self, at: &mut [f64; 2]) -> Crossing {
        self.surface.sides().bring_back(self.domain, at)
    }

    /// The status of a point beyond an edge, or at no finite place.
    fn ended(&self, before: [f64; 2], at: [f64; 2]) -> Option<Status> {
        for (axis, x) in at.into_iter().enumerate() {
            let [low, high] = self.domain[axis];
            for (end, beyond) in [low - x, x - high].into_iter().enumerate() {
                if self.surface.sides().of(axis)[end] == Side::Edge && beyond > 0.0 {
                    return Some(match self.surface.apex(axis, end) {
                        Some(_) => Status::ConePoint,
                        None => Status::LeftDomain,
                    });
                }
            }
        }
        let finite = at.iter().all(|x| x.is_finite());
        (!finite).then(|| {
            let mut last = before;
            self.bring_back(&mut last);
            self.stuck_at(last)
        })
    }

    /// Why a geodesic has no next point: where a tangent vector is a thousandth of its usual length, or both are as
    /// good as parallel, the chart is degenerate.
    fn stuck_at(&self, at: [f64; 2]) -> Status {
        const THIN: f64 = 1e-3;
        let Jet { du, dv, .. } = self.surface.jet(at.into());
        let inner = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (e, f, g) = (inner(du, du), inner(du, dv), inner(dv, dv));
        let [along_u, along_v] = self.surface.scale().stretch;
        let short = e.sqrt() < THIN * along_u || g.sqrt() < THIN * along_v;
        let parallel = e * g - f * f < THIN * THIN * e * g;
        let infinite = e.is_infinite() || g.is_infinite();
        if short || parallel || infinite {
            Status::Degenerate
        } else {
            Status::Undefined
        }
    }
}

/// Follows several geodesics, each a point with a velocity.
pub(super) fn follow<T: Real, const N: usize>(
    domain: Domain<'_>,
    equations: &Equations,
    registers: &mut [[T; N]],
    starts: [[[f64; 2]; 2]; N],
    steps: u32,
) -> [End; N] {
    let processor = Processor::here();
    processor.run(Several {
        processor,
        chart: domain,
        equations,
        registers,
        domain: domain.domain.map(|ends| ends.map(T::nearest)),
        starts,
        steps,
    })
}

struct Several<'a, T, const N: usize> {
    processor: Processor,
    chart: Domain<'a>,
    equations: &'a Equations,
    registers: &'a mut [[T; N]],
    domain: [[T; 2]; 2],
    starts: [[[f64; 2]; 2]; N],
    steps: u32,
}

impl<T: Real, const N: usize> Work for Several<'_, T, N> {
    type Output = [End; N];

    #[inline(always)]
    fn run(mut self) -> Self::Output {
        let h = 1.0 / f64::from(self.steps);
        let (whole, half) = (T::nearest(h), T::nearest(0.5 * h));
        let (mut at, mut velocity) = ([[T::default(); N]; 2], [[T::default(); N]; 2]);
        let mut status = [None; N];
        let mut evaluations = [0; N];
        for (lane, [start, direction]) in self.starts.iter().enumerate() {
            for k in 0..2 {
                at[k][lane] = T::nearest(start[k]);
                velocity[k][lane] = T::nearest(direction[k]);
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
                    None => self.chart.ended(was, is),
                };
                // It rests where it was, or goes on in the domain: there no stage needs to be brought back.
                let (mut next, mut signs) = (was, [0.0; 2]);
                if ending.is_none() {
                    next = is;
                    signs = self.chart.bring_back(&mut next).signs;
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
            self.chart.bring_back(&mut end);
            End {
                at: end,
                status: status[lane].unwrap_or_default(),
                evaluations: evaluations[lane],
            }
        })
    }
}

impl<T: Real, const N: usize> Several<'_, T, N> {
    #[inline(always)]
    fn all_inside(&self, at: &Pair<T, N>) -> bool {
        let [[a, b], [c, d]] = self.domain;
        let mut inside = true;
        for (u, v) in at[0].iter().zip(&at[1]) {
            inside &= (*u >= a) & (*u <= b) & (*v >= c) & (*v <= d);
        }
        inside
    }

    /// The accelerations at points that may lie beyond sides that wrap.
    #[inline(always)]
    fn acceleration(&mut self, at: &Pair<T, N>, velocity: &Pair<T, N>) -> Pair<T, N> {
        let mut out = [[T::default(); N]; 2];
        if self.all_inside(at) {
            self.equations
                .accelerations(self.processor, self.registers, at, velocity, &mut out);
            return out;
        }
        let (mut back, mut turned) = (*at, *velocity);
        let mut signs = [[T::ONE; N]; 2];
        for lane in 0..N {
            let mut point = [back[0][lane].into(), back[1][lane].into()];
            let turn = self.chart.bring_back(&mut point).signs;
            for k in 0..2 {
                back[k][lane] = T::nearest(point[k]);
                signs[k][lane] = T::nearest(turn[k]);
                turned[k][lane] = turned[k][lane] * signs[k][lane];
            }
        }
        self.equations
            .accelerations(self.processor, self.registers, &back, &turned, &mut out);
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
