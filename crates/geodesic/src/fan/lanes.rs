//! One step of Dormand and Prince's pair for eight rays at once: states in, states and errors out.
//!
//! The same step for one ray is in `runge_kutta.rs`: that one takes any pair, changes charts in between and carries data for
//! the error estimate; this one is written so that the compiler makes vectors of it.
//!
//! All loops run over lanes innermost, so that the compiler turns them into vector instructions. Beside the geodesic
//! each lane carries the fundamental solution of y'' = −K y over the step: the Jacobi field comes from it, and what
//! an error at the step's start becomes at its end.

#![allow(clippy::needless_range_loop)] // Several arrays are walked together, lane by lane.

use super::coordinates::{CoordinateKind, NEAREST, Space};
use crate::runge_kutta::DOPRI5;
use crate::surface::{JetBlock, LANES, Lanes, Surface};

/// Point, velocity, and the fields (m, m'), (n, n') of y'' = −K y with m' = 1 and n = 1 at the step's start.
pub(super) type LaneStates = [Lanes; 8];

/// The geodesic equation of a group of rays in common coordinates.
pub(super) struct Field<'a, S: Surface + ?Sized> {
    pub(super) surface: &'a S,
    pub(super) space: &'a Space,
    pub(super) kind: CoordinateKind,
    /// See [`FanChart`](super::coordinates::FanChart).
    pub(super) reference: Lanes,
}

/// The local data at the lanes' points.
#[derive(Clone, Debug)]
pub(super) struct LaneLocals {
    /// In the group's coordinates.
    pub(super) jets: JetBlock,
    pub(super) acceleration: [Lanes; 2],
    pub(super) curvature: Lanes,
}

impl Default for LaneLocals {
    fn default() -> Self {
        Self {
            jets: JetBlock::default(),
            acceleration: [[f64::NAN; LANES]; 2],
            curvature: [f64::NAN; LANES],
        }
    }
}

/// A step that has been tried.
pub(super) struct Trial {
    pub(super) end: LaneStates,
    pub(super) local: LaneLocals,
    /// The estimated errors of the point (in the metric), of the unit velocity and of the two fields.
    pub(super) position: Lanes,
    pub(super) direction: Lanes,
    pub(super) fields: [Lanes; 2],
}

/// Evaluations of a lane in a step: the first stage is the last one of the step before.
pub(super) const STAGES: u64 = 6;

/// The weights of the stages before each stage; the last row gives the step's end.
const ROWS: [&[f64]; 6] = [
    DOPRI5.stages[0],
    DOPRI5.stages[1],
    DOPRI5.stages[2],
    DOPRI5.stages[3],
    DOPRI5.stages[4],
    DOPRI5.weights,
];

impl<S: Surface + ?Sized> Field<'_, S> {
    /// One step of the length `h` from `start`, where `local` holds.
    #[inline(always)]
    pub(super) fn step(&self, start: &LaneStates, local: &LaneLocals, h: f64) -> Trial {
        let mut slopes = [[[0.0; LANES]; 8]; 7];
        slopes[0] = slope(start, local);
        let mut state = *start;
        let mut end = LaneLocals::default();
        for (stage, row) in ROWS.iter().enumerate() {
            state = *start;
            for (weight, slope) in row.iter().zip(&slopes) {
                if *weight != 0.0 {
                    add(&mut state, h * weight, slope);
                }
            }
            self.local(&state, &mut end);
            slopes[stage + 1] = slope(&state, &end);
        }
        let mut error = [[0.0; LANES]; 8];
        for (weight, slope) in DOPRI5.error.iter().zip(&slopes) {
            if *weight != 0.0 {
                add(&mut error, h * weight, slope);
            }
        }
        let [x, y, a, b, m, _, n, _] = error;
        // Geodesics keep their speed, the method does not: what it has lost shows errors that the pair's difference
        // misses where a step is too long for it.
        let before = length(&local.jets, &[start[2], start[3]]);
        let after = length(&end.jets, &[state[2], state[3]]);
        let mut direction = length(&local.jets, &[a, b]);
        for lane in 0..LANES {
            let lost = (after[lane] - before[lane]).abs();
            direction[lane] = if lost > direction[lane] {
                lost
            } else {
                direction[lane]
            };
        }
        Trial {
            end: state,
            position: length(&local.jets, &[x, y]),
            direction,
            fields: [n, m],
            local: end,
        }
    }

    /// Evaluates the local data at the states' points.
    #[inline(always)]
    pub(super) fn local(&self, state: &LaneStates, out: &mut LaneLocals) {
        match self.space.tip(self.kind) {
            None => self.plain(&[state[0], state[1]], &mut out.jets),
            Some(_) => self.about_apex(&[state[0], state[1]], &mut out.jets),
        }
        accelerate(
            &out.jets,
            &[state[2], state[3]],
            &mut out.acceleration,
            &mut out.curvature,
        );
    }

    /// Jets in the plain coordinates, that go on beyond sides that wrap.
    #[inline(always)]
    fn plain(&self, at: &[Lanes; 2], jets: &mut JetBlock) {
        let mut inside = true;
        for lane in 0..LANES {
            inside &= self.space.contains(at[0][lane], at[1][lane]);
        }
        if inside {
            self.surface.jets(at, jets);
            return;
        }
        let mut back = *at;
        let mut signs = [[1.0; LANES]; 2];
        self.space.bring_all_back(&mut back, &mut signs);
        self.surface.jets(&back, jets);
        for lane in 0..LANES {
            let [s, t] = [signs[0][lane], signs[1][lane]];
            for k in 0..3 {
                jets.du[k][lane] *= s;
                jets.dv[k][lane] *= t;
                jets.duv[k][lane] *= s * t;
            }
        }
    }

    /// Jets in an apex's coordinates, by the chain rule.
    #[inline(always)]
    fn about_apex(&self, at: &[Lanes; 2], jets: &mut JetBlock) {
        let Some(tip) = self.space.tip(self.kind) else {
            return;
        };
        let least = NEAREST * tip.radius;
        let mut plain = *at;
        let (mut radius, mut cos, mut sin) = ([0.0; LANES], [1.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let (a, b) = (at[0][lane], at[1][lane]);
            let r = (a * a + b * b).sqrt();
            if r > 0.0 {
                cos[lane] = a / r;
                sin[lane] = b / r;
            }
            radius[lane] = r.max(least);
        }
        for lane in 0..LANES {
            let along = tip.base + tip.sign * tip.power(radius[lane]);
            let across = self.reference[lane] + sin[lane].atan2(cos[lane]) / tip.apex.rate;
            let point = tip.pair(along, across);
            plain[0][lane] = point[0];
            plain[1][lane] = point[1];
        }
        let mut polar = JetBlock::default();
        self.plain(&plain, &mut polar);
        let (dw, dww, dt, dtt) = if tip.axis == 0 {
            (&polar.du, &polar.duu, &polar.dv, &polar.dvv)
        } else {
            (&polar.dv, &polar.dvv, &polar.du, &polar.duu)
        };
        let power = tip.apex.power;
        let rate = 1.0 / tip.apex.rate;
        for lane in 0..LANES {
            let (r, c, s) = (radius[lane], cos[lane], sin[lane]);
            let inverse = 1.0 / r;
            let first = if power == 1.0 {
                tip.sign
            } else {
                tip.sign * power * r.powf(power - 1.0)
            };
            let second = first * (power - 1.0) * inverse;
            let (cc, cs, ss) = (c * c, c * s, s * s);
            for k in 0..3 {
                let by_r = first * dw[k][lane];
                let by_rr = first * first * dww[k][lane] + second * dw[k][lane];
                // Derivatives by the angle over r, so that all are of one size.
                let turn = rate * inverse * dt[k][lane];
                let turn_r = rate * inverse * first * polar.duv[k][lane] - inverse * turn;
                let turn_turn = rate * rate * inverse * inverse * dtt[k][lane] + inverse * by_r;
                jets.du[k][lane] = c * by_r - s * turn;
                jets.dv[k][lane] = s * by_r + c * turn;
                jets.duu[k][lane] = cc * by_rr - 2.0 * cs * turn_r + ss * turn_turn;
                jets.dvv[k][lane] = ss * by_rr + 2.0 * cs * turn_r + cc * turn_turn;
                jets.duv[k][lane] = cs * (by_rr - turn_turn) + (cc - ss) * turn_r;
                jets.position[k][lane] = polar.position[k][lane];
            }
        }
    }
}

#[inline(always)]
fn slope(state: &LaneStates, local: &LaneLocals) -> LaneStates {
    let mut out = [[0.0; LANES]; 8];
    out[0] = state[2];
    out[1] = state[3];
    out[2] = local.acceleration[0];
    out[3] = local.acceleration[1];
    out[4] = state[5];
    out[6] = state[7];
    for lane in 0..LANES {
        out[5][lane] = -local.curvature[lane] * state[4][lane];
        out[7][lane] = -local.curvature[lane] * state[6][lane];
    }
    out
}

#[inline(always)]
fn add(to: &mut LaneStates, weight: f64, what: &LaneStates) {
    for (to, what) in to.iter_mut().zip(what) {
        for lane in 0..LANES {
            to[lane] += weight * what[lane];
        }
    }
}

/// The acceleration of geodesics by orthogonalisation, which keeps the digits that the normal equations of a sheared
/// chart lose, and the Gaussian curvature.
#[inline(always)]
fn accelerate(
    j: &JetBlock,
    velocity: &[Lanes; 2],
    acceleration: &mut [Lanes; 2],
    curvature: &mut Lanes,
) {
    for l in 0..LANES {
        let (a, b) = (velocity[0][l], velocity[1][l]);
        let du = [j.du[0][l], j.du[1][l], j.du[2][l]];
        let dv = [j.dv[0][l], j.dv[1][l], j.dv[2][l]];
        let duu = [j.duu[0][l], j.duu[1][l], j.duu[2][l]];
        let duv = [j.duv[0][l], j.duv[1][l], j.duv[2][l]];
        let dvv = [j.dvv[0][l], j.dvv[1][l], j.dvv[2][l]];
        let (aa, ab, bb) = (a * a, 2.0 * a * b, b * b);
        let w = [
            aa * duu[0] + ab * duv[0] + bb * dvv[0],
            aa * duu[1] + ab * duv[1] + bb * dvv[1],
            aa * duu[2] + ab * duv[2] + bb * dvv[2],
        ];
        let [x, y] = minus_components(du, dv, w);
        acceleration[0][l] = x;
        acceleration[1][l] = y;
        let normal = [
            du[1] * dv[2] - du[2] * dv[1],
            du[2] * dv[0] - du[0] * dv[2],
            du[0] * dv[1] - du[1] * dv[0],
        ];
        let square = 1.0 / dot(normal, normal);
        let (p, q, r) = (dot(duu, normal), dot(duv, normal), dot(dvv, normal));
        curvature[l] = (p * square) * (r * square) - (q * square) * (q * square);
    }
}

/// The unit normals that lie to the left of the velocities where `side` is 1, to the right where it is −1, and their
/// derivatives along the geodesics: they are parallel.
#[inline(always)]
pub(super) fn normals(j: &JetBlock, velocity: &[Lanes; 2], side: &Lanes) -> [[Lanes; 2]; 2] {
    let mut out = [[[0.0; LANES]; 2]; 2];
    for l in 0..LANES {
        let (a, b) = (velocity[0][l], velocity[1][l]);
        let du = [j.du[0][l], j.du[1][l], j.du[2][l]];
        let dv = [j.dv[0][l], j.dv[1][l], j.dv[2][l]];
        let normal = [
            du[1] * dv[2] - du[2] * dv[1],
            du[2] * dv[0] - du[0] * dv[2],
            du[0] * dv[1] - du[1] * dv[0],
        ];
        let area = side[l] / dot(normal, normal).sqrt();
        let along = [
            a * du[0] + b * dv[0],
            a * du[1] + b * dv[1],
            a * du[2] + b * dv[2],
        ];
        let n = [-dot(along, dv) * area, dot(along, du) * area];
        let (aa, ab, bb) = (a * n[0], a * n[1] + b * n[0], b * n[1]);
        let w = [
            aa * j.duu[0][l] + ab * j.duv[0][l] + bb * j.dvv[0][l],
            aa * j.duu[1][l] + ab * j.duv[1][l] + bb * j.dvv[1][l],
            aa * j.duu[2][l] + ab * j.duv[2][l] + bb * j.dvv[2][l],
        ];
        let turned = minus_components(du, dv, w);
        for k in 0..2 {
            out[0][k][l] = n[k];
            out[1][k][l] = turned[k];
        }
    }
    out
}

/// The lengths of tangent vectors.
#[inline(always)]
fn length(j: &JetBlock, v: &[Lanes; 2]) -> Lanes {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        let mut sum = 0.0;
        for k in 0..3 {
            let x = v[0][l] * j.du[k][l] + v[1][l] * j.dv[k][l];
            sum += x * x;
        }
        out[l] = sum.sqrt();
    }
    out
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn minus_components(du: [f64; 3], dv: [f64; 3], w: [f64; 3]) -> [f64; 2] {
    let e = 1.0 / dot(du, du);
    let shear = dot(du, dv) * e;
    let across = [
        dv[0] - shear * du[0],
        dv[1] - shear * du[1],
        dv[2] - shear * du[2],
    ];
    let second = -dot(across, w) / dot(across, across);
    [-dot(du, w) * e - shear * second, second]
}
