//! The geodesic equation of eight rays at once. In: points and velocities. Out: the local data there.
//!
//! The innermost loops run over lanes, so that the compiler vectorises them.

#![allow(clippy::needless_range_loop)] // Several arrays are traversed together, lane by lane.

use std::convert::Infallible;

use crate::chart::{ApexChart, ChartLayout, rotated, turned as turned_by};
use crate::metric::{acceleration, curvature_in_range, turned};
use crate::runge_kutta::{
    self, DOPRI5, GeodesicEquation, RatesOfChange, States, Step, StepParameter,
};
use crate::surface::{Jet, JetBlock, LANES, Lanes, Surface};
use crate::vector::{combine, cross, dot};

/// Within this fraction of its radius from an apex, the local data at this distance is used: the chain rule loses
/// digits like 1/r, and nothing changes over so short a distance.
const NEAREST: f64 = 1e-6;

/// The geodesic equation of a group of rays in common coordinates.
pub(super) struct LaneEquation<'a> {
    pub(super) surface: &'a dyn Surface,
    pub(super) layout: &'a ChartLayout,
    /// `None` in the plain coordinates.
    pub(super) chart: Option<&'a ApexChart>,
    /// See [`FanChart`](super::coordinates::FanChart).
    pub(super) reference: Lanes,
}

/// The local data at the lanes' points.
#[derive(Clone, Debug)]
pub(super) struct LaneLocals {
    /// In the group's coordinates, about an apex turned by these angles (their cosines and sines), so that the first
    /// one is the radius.
    jets: JetBlock,
    turn: [Lanes; 2],
    pub(super) acceleration: [Lanes; 2],
    pub(super) curvature: Lanes,
}

impl Default for LaneLocals {
    fn default() -> Self {
        Self {
            jets: JetBlock::default(),
            turn: [[1.0; LANES], [0.0; LANES]],
            acceleration: [[f64::NAN; LANES]; 2],
            curvature: [f64::NAN; LANES],
        }
    }
}

/// A step of a group.
pub(super) type LaneStep = Step<LANES, LaneLocals>;

/// Evaluations of a lane in a step: the first stage is the last one of the previous step.
pub(super) const STAGES: u64 = 6;

impl GeodesicEquation<LANES> for LaneEquation<'_> {
    type Local = LaneLocals;
    type Undefined = Infallible;

    #[inline(always)]
    fn evaluate(&self, states: &States<LANES>, local: &mut LaneLocals) -> Result<(), Infallible> {
        self.local(states, local);
        Ok(())
    }
}

impl RatesOfChange<LANES> for LaneLocals {
    #[inline(always)]
    fn slope(&self, states: &States<LANES>) -> States<LANES> {
        runge_kutta::chart_slope(states, self.acceleration, self.curvature)
    }

    #[inline(always)]
    fn way(&self, states: &States<LANES>) -> Lanes {
        self.length(&[states[0], states[1]])
    }

    #[inline(always)]
    fn speed(&self, states: &States<LANES>) -> Lanes {
        self.length(&[states[2], states[3]])
    }
}

impl LaneEquation<'_> {
    /// Takes one step of length `h` from `start`, where `local` holds.
    #[inline(always)]
    pub(super) fn step(&self, start: &States<LANES>, local: &LaneLocals, h: f64) -> LaneStep {
        let Ok(mut step) = runge_kutta::step::<LANES, 8, { STAGES as usize + 1 }, _>(
            self,
            &DOPRI5,
            start,
            local,
            h,
            StepParameter::Length,
        );
        // Geodesics preserve their speed, and their Jacobi fields the Wronskian n m' − n' m = 1; the method does not. The
        // loss of either reveals errors that the embedded pair's difference misses where a step is too long for it.
        let before = local.speed(start);
        let after = step.local.speed(&step.end);
        let [.., m, m1, n, n1] = &step.end;
        for lane in 0..LANES {
            let lost = (after[lane] - before[lane]).abs();
            let wronskian = (n[lane] * m1[lane] - n1[lane] * m[lane] - 1.0).abs();
            let lost = if wronskian > lost { wronskian } else { lost };
            let error = &mut step.direction_error[lane];
            *error = if lost > *error { lost } else { *error };
        }
        step
    }

    /// Evaluates the local data at the states' points.
    #[inline(always)]
    pub(super) fn local(&self, states: &States<LANES>, out: &mut LaneLocals) {
        let [a, b, x, y, ..] = states;
        match self.chart {
            None => {
                self.plain(&[*a, *b], &mut out.jets);
                let (mut along, mut curvature) = ([[0.0; LANES]; 2], [0.0; LANES]);
                for lane in 0..LANES {
                    let jet = out.jets.lane(lane);
                    [along[0][lane], along[1][lane]] = acceleration(&jet, [x[lane], y[lane]]).0;
                    curvature[lane] = curvature_in_range(&jet);
                }
                (out.acceleration, out.curvature) = (along, curvature);
            }
            Some(chart) => self.about_apex(chart, states, out),
        }
    }

    /// Evaluates jets in the plain coordinates, which continue beyond sides that wrap.
    #[inline(always)]
    fn plain(&self, at: &[Lanes; 2], jets: &mut JetBlock) {
        let mut inside = true;
        for lane in 0..LANES {
            inside &= self.layout.contains([at[0][lane], at[1][lane]]);
        }
        if inside {
            self.surface.jets(at, jets);
            return;
        }
        let mut back = *at;
        let sides = self.layout.sides;
        let signs = sides.bring_all_back(self.layout.domain, &mut back).signs;
        self.surface.jets(&back, jets);
        jets.reflect(&signs);
    }

    /// Evaluates jets about an apex, by the chain rule.
    #[inline(always)]
    fn about_apex(&self, chart: &ApexChart, states: &States<LANES>, out: &mut LaneLocals) {
        let [a, b, x, y, ..] = states;
        let (mut radius, mut turn) = ([0.0; LANES], [[0.0; LANES]; 2]);
        for lane in 0..LANES {
            let (r, [cos, sin]) = chart.polar([a[lane], b[lane]], NEAREST * chart.radius);
            radius[lane] = r;
            turn[0][lane] = cos;
            turn[1][lane] = sin;
        }
        let mut plain = [[0.0; LANES]; 2];
        for lane in 0..LANES {
            let chart = chart.with_reference(self.reference[lane]);
            let angle = turn[1][lane].atan2(turn[0][lane]);
            let point = chart.plain_polar(radius[lane], angle);
            plain[0][lane] = point[0];
            plain[1][lane] = point[1];
        }
        let mut jets = JetBlock::default();
        self.plain(&plain, &mut jets);
        let (mut along, mut curvature) = ([[0.0; LANES]; 2], [0.0; LANES]);
        for lane in 0..LANES {
            let plain = jets.lane(lane);
            let jet = chart.radial_jet(radius[lane], &plain);
            let direction = [turn[0][lane], turn[1][lane]];
            let rates = acceleration(&jet, rotated(direction, [x[lane], y[lane]]));
            [along[0][lane], along[1][lane]] = turned_by(direction, rates.0);
            curvature[lane] = curvature_in_range(&plain);
            out.jets.set(lane, &jet);
        }
        (out.turn, out.acceleration, out.curvature) = (turn, along, curvature);
    }
}

impl LaneLocals {
    /// Returns the lengths of the lanes' tangent vectors.
    #[inline(always)]
    fn length(&self, vectors: &[Lanes; 2]) -> Lanes {
        let mut out = [0.0; LANES];
        for lane in 0..LANES {
            let [x, y] = self.turned(lane, vectors);
            let vector = combine(x, self.jets.lane(lane).du, y, self.jets.lane(lane).dv);
            out[lane] = dot(vector, vector).sqrt();
        }
        out
    }

    /// Returns a lane's vector in the coordinates of its jet.
    #[inline(always)]
    fn turned(&self, lane: usize, [x, y]: &[Lanes; 2]) -> [f64; 2] {
        rotated([self.turn[0][lane], self.turn[1][lane]], [x[lane], y[lane]])
    }

    /// Returns the unit normals, to the left of the velocities where `side` is 1, to the right where it is −1, and their
    /// derivatives along the geodesics, along which they are parallel.
    #[inline(always)]
    pub(super) fn normals(&self, velocity: &[Lanes; 2], side: &Lanes) -> [[Lanes; 2]; 2] {
        let mut out = [[[0.0; LANES]; 2]; 2];
        for lane in 0..LANES {
            let jet = self.jets.lane(lane);
            let velocity = self.turned(lane, velocity);
            let normal = unit_normal(&jet, velocity, side[lane]);
            let direction = [self.turn[0][lane], self.turn[1][lane]];
            let rates = turned_by(direction, turned(&jet, velocity, normal));
            let normal = turned_by(direction, normal);
            for k in 0..2 {
                out[0][k][lane] = normal[k];
                out[1][k][lane] = rates[k];
            }
        }
        out
    }
}

/// Returns the unit normal to a velocity, on its left where `side` is 1.
#[inline(always)]
fn unit_normal(jet: &Jet, [a, b]: [f64; 2], side: f64) -> [f64; 2] {
    let normal = cross(jet.du, jet.dv);
    let share = side / dot(normal, normal).sqrt();
    let along = combine(a, jet.du, b, jet.dv);
    [-dot(along, jet.dv) * share, dot(along, jet.du) * share]
}
