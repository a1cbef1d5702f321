//! Eight rays side by side: one step of all tried, each lane's taken or refused, and what it meets.
//!
//! What flows in: runners in the same coordinates, a step's length. What flows out: the runners a step farther on, which
//! of them are still in the group, the next step's length.

use super::active_ray::ActiveRay;
use super::coordinates::{FanChart, Space};
use super::driver::RayPlan;
use super::event::{HIT, hits, leaves};
use super::lanes::{Field, LaneLocals, LaneStates, STAGES, Trial, normals};
use super::ray::{Knot, Segment};
use expr::processor::{Processor, Work};

use crate::chart::{Atlas, State};
use crate::integrate;
use crate::runge_kutta::DOPRI5;
use crate::status::Status;
use crate::surface::{LANES, Lanes, Surface};

/// The most evaluations to find out why steps lead nowhere.
const CAREFUL: u64 = 4000;
/// The most steps beyond an edge.
const STEPS_BEYOND: u32 = 3;
/// A cone is unrolled anew when a ray has turned about its tip by this angle.
const TURN: f64 = 2.0;

/// A group of lanes.
pub(super) struct Group<'a, S: Surface + ?Sized> {
    field: Field<'a, S>,
    plan: &'a RayPlan,
    state: LaneStates,
    local: LaneLocals,
    sides: Lanes,
    /// Those that are still on their way in it.
    pub(super) active: [bool; LANES],
    processor: Processor,
}

/// A step of all lanes, compiled for the processor's vectors.
struct LaneStep<'a, 'f, S: Surface + ?Sized> {
    field: &'a Field<'f, S>,
    state: &'a LaneStates,
    local: &'a LaneLocals,
    h: f64,
}

impl<S: Surface + ?Sized> Work for LaneStep<'_, '_, S> {
    type Output = Trial;
    #[inline(always)]
    fn run(self) -> Trial {
        self.field.step(self.state, self.local, self.h)
    }
}

impl<'a, S: Surface + ?Sized> Group<'a, S> {
    /// Up to eight runners in the same coordinates; `None` where there are none.
    pub(super) fn of(
        surface: &'a S,
        space: &'a Space,
        plan: &'a RayPlan,
        runners: &[ActiveRay],
    ) -> Option<Self> {
        let count = runners.len().min(LANES);
        let kind = runners.first().map(|runner| runner.chart.kind)?;
        let handedness = space.tip(kind).map_or(1.0, |tip| tip.handedness());
        let lane = |of: &dyn Fn(&ActiveRay) -> f64| -> Lanes {
            std::array::from_fn(|lane| of(&runners[lane.min(count - 1)]))
        };
        let zero = [0.0; LANES];
        let one = [1.0; LANES];
        Some(Self {
            field: Field {
                surface,
                space,
                kind,
                reference: lane(&|r| r.chart.reference),
            },
            plan,
            state: [
                lane(&|r| r.at[0]),
                lane(&|r| r.at[1]),
                lane(&|r| r.velocity[0]),
                lane(&|r| r.velocity[1]),
                zero,
                one,
                one,
                zero,
            ],
            local: LaneLocals::default(),
            sides: lane(&|r| r.side * handedness),
            active: std::array::from_fn(|lane| lane < count),
            processor: Processor::here(),
        })
    }

    /// Evaluates at the start, and puts the first knots.
    pub(super) fn begin(&mut self, runners: &mut [ActiveRay]) {
        self.field.local(&self.state, &mut self.local);
        let knots = self.knots(&self.state, &self.local);
        for (lane, runner) in runners.iter_mut().enumerate() {
            runner.evaluations += 1;
            let [x, y] = self.local.acceleration;
            if !(x[lane].is_finite() && y[lane].is_finite()) {
                self.active[lane] = false;
                self.stall(runner);
                continue;
            }
            let mut knot = knots[lane];
            knot.s = runner.s;
            knot.m = runner.m;
            let chart = runner.chart;
            let goes_on = runner.segments.last().is_some_and(|last| {
                super::ray::same(&last.chart, &chart)
                    && last.knots.last().is_some_and(|last| last.s == knot.s)
            });
            if !goes_on {
                runner.segments.push(Segment {
                    chart,
                    knots: Vec::with_capacity(32),
                });
                if let Some(segment) = runner.segments.last_mut() {
                    segment.knots.push(knot);
                }
            }
        }
    }

    /// The lanes' knots, their arc lengths and Jacobi fields apart.
    #[inline(always)]
    fn knots(&self, state: &LaneStates, local: &LaneLocals) -> [Knot; LANES] {
        let velocity = [state[2], state[3]];
        let [n, n1] = normals(&local.jets, &velocity, &self.sides);
        std::array::from_fn(|l| Knot {
            s: 0.0,
            at: [state[0][l], state[1][l]],
            velocity: [state[2][l], state[3][l]],
            acceleration: [local.acceleration[0][l], local.acceleration[1][l]],
            m: [0.0; 2],
            normal: [[n[0][l], n[1][l]], [n1[0][l], n1[1][l]]],
        })
    }

    /// Tries a step; returns the length of the next one.
    ///
    /// All lanes share the step's length, so the group takes the step if most lanes accept it and no other would shrink much:
    /// lanes that refuse it, or whose next step would be much shorter than that of the others, leave the group and go on in
    /// another one. So neither does one hard ray make seven easy ones slow, nor are evaluations thrown away when nearly all
    /// lanes were content.
    pub(super) fn attempt(&mut self, runners: &mut [ActiveRay], h: f64) -> f64 {
        let trial = self.processor.run(LaneStep {
            field: &self.field,
            state: &self.state,
            local: &self.local,
            h,
        });
        let mut factors = [f64::INFINITY; LANES];
        let mut failed = [false; LANES];
        let (mut good, mut bad) = (0, 0);
        for (lane, runner) in runners.iter_mut().enumerate() {
            if !self.active[lane] {
                continue;
            }
            runner.evaluations += STAGES;
            let excess = self.excess(runner, &trial, lane, h);
            if runner.stop.is_some() {
                // Beyond an edge nothing needs to be found, and nobody waits.
                self.active[lane] = excess <= 1.0;
                continue;
            }
            // Single precision is enough for a factor.
            let factor = 0.9 * f64::from((excess as f32).powf(-0.2));
            // NaN is a failure, too.
            failed[lane] = excess.is_nan() || excess > 1.0;
            factors[lane] = if failed[lane] {
                factor.clamp(0.1, 0.9)
            } else {
                factor.clamp(0.2, 5.0)
            };
            if failed[lane] {
                bad += 1;
            } else {
                good += 1;
            }
        }
        let least = factors.iter().fold(f64::INFINITY, |least, x| least.min(*x));
        if bad > 0 && (good < bad || least > 0.5) {
            for (lane, runner) in runners.iter_mut().enumerate() {
                if self.active[lane] && runner.stop.is_none() {
                    runner.rejected += 1;
                    runner.h = h * least;
                    if h * factors[lane] < self.plan.shortest
                        || runner.evaluations + STAGES > self.plan.limit
                    {
                        self.active[lane] = false;
                        self.stall(runner);
                    }
                }
            }
            return h * least;
        }
        // The step is taken; the few that failed go on in another group.
        let knots = self.knots(&trial.end, &trial.local);
        let mut next = f64::INFINITY;
        for (lane, runner) in runners.iter_mut().enumerate() {
            if !self.active[lane] {
                continue;
            }
            if runner.stop.is_some() {
                self.active[lane] = self.go_beyond(runner, &trial, lane, h, knots[lane]);
                continue;
            }
            runner.h = h * factors[lane];
            if failed[lane] {
                runner.rejected += 1;
                self.active[lane] = false;
                if runner.h < self.plan.shortest || runner.evaluations + STAGES > self.plan.limit {
                    self.stall(runner);
                }
                continue;
            }
            self.accept(runner, &trial, lane, h, knots[lane]);
            if self.active[lane] && runner.stop.is_none() {
                next = next.min(runner.h);
            }
        }
        // So do those that would hold up the others.
        let goes = |lane: usize| self.active[lane] && runners[lane].stop.is_none();
        let going = (0..runners.len()).filter(|&lane| goes(lane)).count();
        let slow = |runner: &ActiveRay| runner.h < 1.5 * next;
        let slower = (0..runners.len())
            .filter(|&lane| goes(lane) && slow(&runners[lane]))
            .count();
        let others = runners
            .iter()
            .enumerate()
            .filter(|(lane, runner)| goes(*lane) && !slow(runner))
            .map(|(_, runner)| runner)
            .fold(f64::INFINITY, |least, runner| least.min(runner.h));
        if slower * 2 <= going && others > 2.5 * next {
            for (lane, runner) in runners.iter().enumerate() {
                if self.active[lane] && runner.stop.is_none() && slow(runner) {
                    self.active[lane] = false;
                }
            }
            next = others;
        }
        self.state = trial.end;
        self.state[4] = [0.0; LANES];
        self.state[5] = [1.0; LANES];
        self.state[6] = [1.0; LANES];
        self.state[7] = [0.0; LANES];
        self.local = trial.local;
        if next.is_finite() { next } else { h }
    }

    /// A lane's error over what is allowed; NaN where anything is undefined.
    fn excess(&self, runner: &ActiveRay, trial: &Trial, lane: usize, h: f64) -> f64 {
        let [n, m] = [trial.fields[0][lane], trial.fields[1][lane]];
        let field = (n * runner.m[0] + m * runner.m[1]).abs();
        let error = trial.position[lane]
            + self.plan.length_scale * trial.direction[lane]
            + self.plan.field * field;
        let mut excess = error / (runner.tolerance_share * self.plan.rate * h.max(self.plan.least));
        let [x, y] = trial.local.acceleration;
        if !(x[lane].is_finite() && y[lane].is_finite() && trial.local.curvature[lane].is_finite())
        {
            return f64::NAN;
        }
        let end = [trial.end[0][lane], trial.end[1][lane]];
        let space = self.field.space;
        match space.tip(self.field.kind) {
            None => {
                if space.needs_apex(end) {
                    excess = excess.max(20.0);
                }
            }
            Some(tip) => {
                if tip.oversteps(end) {
                    excess = excess.max(20.0);
                }
                if !tip.apex.smooth {
                    // Towards the tip of a cone so that it stays ahead, away from it twice the distance.
                    let ([a, b], [x, y]) = (runner.at, runner.velocity);
                    let r = a.hypot(b).max(HIT * tip.radius);
                    let longest = if a * x + b * y < 0.0 {
                        0.75 * r
                    } else {
                        2.0 * r
                    } / x.hypot(y);
                    excess = excess.max((h / longest).powi(5) * 0.999);
                }
            }
        }
        excess
    }

    fn accept(&mut self, runner: &mut ActiveRay, trial: &Trial, lane: usize, h: f64, knot: Knot) {
        let space = self.field.space;
        let from = State {
            at: runner.at,
            velocity: runner.velocity,
        };
        let before = [
            self.local.acceleration[0][lane],
            self.local.acceleration[1][lane],
        ];
        let s = runner.s;
        let [[n, m], [n1, m1]] = fields(trial, lane);
        let [p, x, d] = runner.errors;
        let direction = trial.direction[lane];
        let position = trial.position[lane].max(h * direction);
        runner.errors = [
            n * n * p + 2.0 * n * m * x + m * m * d + position * position,
            n * n1 * p + (n * m1 + m * n1) * x + m * m1 * d,
            n1 * n1 * p + 2.0 * n1 * m1 * x + m1 * m1 * d + direction * direction,
        ];
        runner.note_error(s, s + h, self.plan.reach);
        // Steps that have been shrinking, towards something singular, will go on to shrink.
        if h < runner.last && h < 3.0 * self.plan.least {
            runner.h *= (h / runner.last).max(0.5);
        }
        runner.last = h;
        runner.step(h, fields(trial, lane), knot);
        match space.tip(self.field.kind) {
            None => {
                if let Some((share, edge)) = leaves(space, &from, before, &knot, h) {
                    self.active[lane] = self.leave(runner, s + share * h, edge);
                    return;
                }
            }
            Some(tip) => {
                let principal = knot.at[1].atan2(knot.at[0]);
                let turn = principal - runner.turned;
                runner.turned +=
                    turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round();
                if !tip.apex.smooth && hits(&from, &knot, tip.radius) {
                    self.active[lane] = false;
                    runner.stop(runner.s, Status::ConePoint);
                    return;
                }
            }
        }
        if runner.s >= runner.length * (1.0 - 1e-14) {
            runner.done = true;
            self.active[lane] = false;
            return;
        }
        if runner.evaluations + STAGES > self.plan.limit {
            runner.stop(runner.s, Status::WorkLimit);
            self.active[lane] = false;
            return;
        }
        if runner.h < self.plan.shortest {
            self.active[lane] = false;
            self.stall(runner);
            return;
        }
        let chart = match space.tip(self.field.kind) {
            None => space.chart_near(knot.at),
            Some(tip) if tip.is_left_at(knot.at) => Some(FanChart::PLAIN),
            Some(tip) if !tip.apex.smooth && runner.turned.abs() > TURN => Some(FanChart {
                kind: self.field.kind,
                reference: runner.chart.reference + runner.turned / tip.apex.rate,
            }),
            Some(_) => None,
        };
        if let Some(chart) = chart {
            runner.enter(space, chart);
            self.active[lane] = false;
        }
    }

    /// Follows a ray beyond an edge; says whether it goes on.
    fn go_beyond(
        &self,
        runner: &mut ActiveRay,
        trial: &Trial,
        lane: usize,
        h: f64,
        knot: Knot,
    ) -> bool {
        runner.step(h, fields(trial, lane), knot);
        runner.beyond += 1;
        self.goes_beyond(runner)
    }

    fn goes_beyond(&self, runner: &ActiveRay) -> bool {
        runner.beyond < STEPS_BEYOND
            && runner.way(self.plan.beyond) > 0.0
            && runner.evaluations + STAGES <= self.plan.limit
    }

    /// Ends a ray at an edge; says whether it is worth following beyond.
    fn leave(&self, runner: &mut ActiveRay, s: f64, (axis, end): (usize, usize)) -> bool {
        let collapsed = self.field.space.is_collapsed(axis, end);
        runner.stop(
            s,
            if collapsed {
                Status::ConePoint
            } else {
                Status::LeftDomain
            },
        );
        runner.aim(axis, end);
        !collapsed && self.goes_beyond(runner)
    }

    /// Where steps lead nowhere, one careful integration says why, and where it ends.
    fn stall(&self, runner: &mut ActiveRay) {
        let space = self.field.space;
        let (at, velocity) = runner.plain(space);
        let (at, signs) = space.bring_back(at);
        let velocity = [0, 1].map(|k| velocity[k] * signs[k]);
        let atlas = Atlas::new(self.field.surface);
        let way = (runner.length - runner.s).min(1e2 * self.plan.shortest);
        let left = self
            .plan
            .limit
            .saturating_sub(runner.evaluations)
            .min(CAREFUL);
        let plan = integrate::IntegrationPlan {
            tableau: &DOPRI5,
            tolerance: Some(self.plan.rate.clamp(1e-9, 1e-3)),
            step: self.plan.shortest,
            limit: left as usize,
            charts: true,
            keep_path: false,
        };
        let end = integrate::integrate(&atlas, State { at, velocity }, way, plan);
        runner.evaluations += atlas.evaluations() as u64;
        let status = match end.status {
            // It passes what stopped the group: not known from here on.
            Status::Complete => Status::WorkLimit,
            status => status,
        };
        let s = if status == Status::WorkLimit {
            runner.s
        } else {
            runner.s + end.length
        };
        runner.stop(s, status);
        if status == Status::LeftDomain {
            let off = |axis: usize, side: usize| {
                (end.state.at[axis] - space.domain[axis][side]).abs() / space.width(axis)
            };
            let nearest = (0..4)
                .map(|n| (n / 2, n % 2))
                .min_by(|a, b| off(a.0, a.1).total_cmp(&off(b.0, b.1)));
            if let Some((axis, side)) = nearest {
                runner.aim(axis, side);
            }
        }
    }
}

/// What a lane's fundamental fields have become in a step, with their derivatives: (n, m), (n', m').
fn fields(trial: &Trial, lane: usize) -> [[f64; 2]; 2] {
    [
        [trial.end[6][lane], trial.end[4][lane]],
        [trial.end[7][lane], trial.end[5][lane]],
    ]
}
