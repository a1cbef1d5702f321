//! Eight rays side by side: one step of all is tried, then accepted or rejected for each lane, and events are handled.
//!
//! In: rays in the same coordinates and a step's length. Out: the rays after the step, the lanes that are still in the
//! group, and the next step's length.

use std::cell::Cell;

use super::active_ray::ActiveRay;
use super::coordinates::FanChart;
use super::driver::RayPlan;
use super::event::leaves;
use super::lanes::{LaneEquation, LaneLocals, LaneStep, STAGES};
use super::ray::{CreasePassage, Knot, Segment};
use expr::processor::{Processor, Work};

use crate::chart::{Atlas, ChartLayout, PROOFS_PER_EVALUATION};
use crate::integrate::{self, Observed, RayEnd};
use crate::runge_kutta::{DOPRI5, States};
use crate::status::Status;
use crate::step_path::{PathPart, StepPath};
use crate::surface::{LANES, Lanes, Surface};

/// The maximum number of evaluations spent on finding the reason why a ray makes no progress.
const CAREFUL: u64 = 4000;
/// A crease is passed if it is nearer than this multiple of [`RayPlan::shortest`]: at most a quarter of a pixel.
const BESIDE_CREASE: f64 = 25.0;
/// A step to a crease ends at most at this fraction of the step that crossed it.
const SHORTER: f64 = 0.9;
/// A step shorter than this multiple of [`RayPlan::least`] means that a singularity is near.
const SHORT: f64 = 3.0;
/// The maximum number of steps beyond an edge.
const STEPS_BEYOND: u32 = 3;
/// A cone is unrolled again when a ray has turned about its tip by this angle, in radians.
const TURN: f64 = 2.0;
/// The whole group repeats a rejected step if no lane needs less than this fraction of it.
const SHARED_RETRY: f64 = 0.5;
/// A lane is slow if its next step is shorter than this multiple of the shortest one.
const SLOW_RATIO: f64 = 1.5;
/// Slow lanes leave the group where the steps of the others are longer than this multiple of the shortest one.
const SPLIT_RATIO: f64 = 2.5;
/// The excess of a step that ends outside its coordinates: about half of it is tried next.
const OUTSIDE_EXCESS: f64 = 20.0;
/// The excess of the longest step near the tip of a cone: below 1, so that rounding does not reject it.
const LONGEST_EXCESS: f64 = 0.999;
/// A ray has ended where less than this fraction of its length is left.
const END_SHARE: f64 = 1e-14;

/// A group of lanes.
pub(super) struct Group<'a> {
    equation: LaneEquation<'a>,
    plan: &'a RayPlan,
    state: States<LANES>,
    local: LaneLocals,
    sides: Lanes,
    /// The lanes that are still integrated in the group.
    pub(super) active: [bool; LANES],
    processor: Processor,
}

/// A step of all lanes, compiled for the processor's vector instructions.
struct StepWork<'a, 'f> {
    equation: &'a LaneEquation<'f>,
    state: &'a States<LANES>,
    local: &'a LaneLocals,
    h: f64,
}

impl Work for StepWork<'_, '_> {
    type Output = LaneStep;
    #[inline(always)]
    fn run(self) -> LaneStep {
        self.equation.step(self.state, self.local, self.h)
    }
}

/// The lanes' judgement of a trial step.
struct Verdict {
    /// The next step over this one, infinite for lanes that have no part in it.
    factors: [f64; LANES],
    failed: [bool; LANES],
    accepted: u32,
    rejected: u32,
}

impl Verdict {
    fn least(&self) -> f64 {
        self.factors.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

impl<'a> Group<'a> {
    /// Creates a group of up to eight rays in the same coordinates; `None` without any.
    pub(super) fn of(
        surface: &'a dyn Surface,
        layout: &'a ChartLayout,
        plan: &'a RayPlan,
        rays: &[ActiveRay],
    ) -> Option<Self> {
        let count = rays.len().min(LANES);
        let chart = layout.apex_chart(rays.first()?.chart.kind);
        let handedness = chart.map_or(1.0, |chart| chart.handedness());
        let lane = |of: &dyn Fn(&ActiveRay) -> f64| -> Lanes {
            std::array::from_fn(|lane| of(&rays[lane.min(count - 1)]))
        };
        let zero = [0.0; LANES];
        let one = [1.0; LANES];
        Some(Self {
            equation: LaneEquation {
                surface,
                layout,
                chart,
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

    /// Evaluates at the start, and stores the first knots.
    pub(super) fn begin(&mut self, rays: &mut [ActiveRay]) {
        self.equation.local(&self.state, &mut self.local);
        let knots = self.knots(&self.state, &self.local);
        for (lane, ray) in rays.iter_mut().enumerate() {
            ray.evaluations += 1;
            let [x, y] = self.local.acceleration;
            if !(x[lane].is_finite() && y[lane].is_finite()) {
                self.active[lane] = false;
                self.stall(ray);
                continue;
            }
            let mut knot = knots[lane];
            knot.s = ray.s;
            knot.m = ray.m;
            let chart = ray.chart;
            let goes_on = ray.segments.last().is_some_and(|last| {
                last.chart.is_same(&chart) && last.knots.last().is_some_and(|last| last.s == knot.s)
            });
            if !goes_on {
                ray.segments.push(Segment {
                    chart,
                    knots: Vec::with_capacity(32),
                });
                if let Some(segment) = ray.segments.last_mut() {
                    segment.knots.push(knot);
                }
            }
        }
    }

    /// Returns the lanes' knots, without their arc lengths and Jacobi fields.
    #[inline(always)]
    fn knots(&self, state: &States<LANES>, local: &LaneLocals) -> [Knot; LANES] {
        let velocity = [state[2], state[3]];
        let [n, n1] = local.normals(&velocity, &self.sides);
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
    /// All lanes share the step's length, so the group takes the step if most lanes accept it and no other lane would shrink
    /// it much. Lanes that reject it, or whose next step would be much shorter than that of the others, leave the group and
    /// continue in another one. So one difficult ray does not slow down seven easy ones, and evaluations are not wasted when
    /// nearly all lanes accept.
    pub(super) fn attempt(&mut self, rays: &mut [ActiveRay], h: f64) -> f64 {
        let trial = self.processor.run(StepWork {
            equation: &self.equation,
            state: &self.state,
            local: &self.local,
            h,
        });
        let verdict = self.judge(rays, &trial, h);
        if verdict.rejected > 0
            && (verdict.accepted < verdict.rejected || verdict.least() > SHARED_RETRY)
        {
            return self.retry(rays, &verdict, h);
        }
        let next = self.take(rays, &trial, &verdict, h);
        let next = self.part_with_slow(rays, next);
        self.state = trial.end;
        // The Jacobi field of the next step begins with one in each of its two values.
        for (row, start) in self.state[4..8].iter_mut().zip([0.0, 1.0, 1.0, 0.0]) {
            *row = [start; LANES];
        }
        self.local = trial.local;
        if next.is_finite() { next } else { h }
    }

    /// Returns which lanes accept a trial step. A lane beyond an edge needs no accuracy, and the group does not wait for it.
    fn judge(&mut self, rays: &mut [ActiveRay], trial: &LaneStep, h: f64) -> Verdict {
        let mut verdict = Verdict {
            factors: [f64::INFINITY; LANES],
            failed: [false; LANES],
            accepted: 0,
            rejected: 0,
        };
        for (lane, ray) in rays.iter_mut().enumerate() {
            if !self.active[lane] {
                continue;
            }
            ray.evaluations += STAGES;
            let excess = self.excess(ray, trial, lane, h);
            if ray.stop.is_some() {
                self.active[lane] = excess <= 1.0;
                continue;
            }
            // A step across a crease is wrong in any case, whatever its error.
            if excess.is_finite()
                && let Some(ahead) = self.crease_ahead(ray, trial, lane, h)
            {
                let near = BESIDE_CREASE * self.plan.shortest;
                if ahead <= near {
                    self.pass_crease(ray, ahead + 0.5 * near);
                    self.active[lane] = false;
                } else {
                    verdict.factors[lane] = ((ahead - 0.5 * near) / h).min(SHORTER);
                    verdict.failed[lane] = true;
                    verdict.rejected += 1;
                }
                continue;
            }
            // The method has order 5. Single precision is enough for a factor.
            let root = f64::from((excess as f32).powf(-0.2));
            match ray.control.judge(root, f64::INFINITY) {
                Ok(factor) => {
                    verdict.factors[lane] = factor;
                    verdict.accepted += 1;
                }
                Err(factor) => {
                    verdict.factors[lane] = factor;
                    verdict.failed[lane] = true;
                    verdict.rejected += 1;
                }
            }
        }
        verdict
    }

    /// Shortens the step for all lanes; returns its length.
    fn retry(&mut self, rays: &mut [ActiveRay], verdict: &Verdict, h: f64) -> f64 {
        let shorter = h * verdict.least();
        for (lane, ray) in rays.iter_mut().enumerate() {
            if self.active[lane] && ray.stop.is_none() {
                ray.rejected += 1;
                ray.h = shorter;
                if self.is_at_end(ray, h * verdict.factors[lane]) {
                    self.active[lane] = false;
                    self.stall(ray);
                }
            }
        }
        shorter
    }

    /// Accepts the step; the few lanes that failed continue in another group. Returns the shortest next step of the others.
    fn take(&mut self, rays: &mut [ActiveRay], trial: &LaneStep, verdict: &Verdict, h: f64) -> f64 {
        let knots = self.knots(&trial.end, &trial.local);
        let mut next = f64::INFINITY;
        for (lane, ray) in rays.iter_mut().enumerate() {
            if !self.active[lane] {
                continue;
            }
            if ray.stop.is_some() {
                self.active[lane] = self.go_beyond(ray, trial, lane, h, knots[lane]);
                continue;
            }
            ray.h = h * verdict.factors[lane];
            if verdict.failed[lane] {
                ray.rejected += 1;
                self.active[lane] = false;
                if self.is_at_end(ray, ray.h) {
                    self.stall(ray);
                }
                continue;
            }
            self.accept(ray, trial, lane, h, knots[lane]);
            if self.active[lane] && ray.stop.is_none() {
                next = next.min(ray.h);
            }
        }
        next
    }

    /// Lets the lanes leave that would slow down the others; returns the next step of those that stay.
    fn part_with_slow(&mut self, rays: &[ActiveRay], next: f64) -> f64 {
        let goes = |lane: usize| self.active[lane] && rays[lane].stop.is_none();
        let is_slow = |lane: usize| rays[lane].h < SLOW_RATIO * next;
        let (slow, others): (Vec<usize>, Vec<usize>) = (0..rays.len())
            .filter(|&lane| goes(lane))
            .partition(|&lane| is_slow(lane));
        let shortest = others
            .iter()
            .fold(f64::INFINITY, |least, &lane| least.min(rays[lane].h));
        if slow.len() > others.len() || shortest <= SPLIT_RATIO * next {
            return next;
        }
        for lane in slow {
            self.active[lane] = false;
        }
        shortest
    }

    /// True for a ray whose next step would be too short, or whose evaluations are used up.
    fn is_at_end(&self, ray: &ActiveRay, step: f64) -> bool {
        step < self.plan.shortest || ray.evaluations + STAGES > self.plan.limit
    }

    /// Returns a lane's error over the allowed error; NaN where anything is undefined.
    fn excess(&self, ray: &ActiveRay, trial: &LaneStep, lane: usize, h: f64) -> f64 {
        let [.., m, _, n, _] = trial.error.map(|errors| errors[lane]);
        let jacobi = (n * ray.m[0] + m * ray.m[1]).abs();
        let error = trial.position_error[lane]
            + self.plan.length_scale * trial.direction_error[lane]
            + self.plan.jacobi_weight * jacobi;
        let mut excess = error / (ray.tolerance_share * self.plan.rate * h.max(self.plan.least));
        let [x, y] = trial.local.acceleration;
        if !(x[lane].is_finite() && y[lane].is_finite() && trial.local.curvature[lane].is_finite())
        {
            return f64::NAN;
        }
        let end = [trial.end[0][lane], trial.end[1][lane]];
        match self.equation.chart {
            None => {
                if self.equation.layout.needs_apex_chart(end) {
                    excess = excess.max(OUTSIDE_EXCESS);
                }
            }
            Some(chart) => {
                if chart.oversteps(end) {
                    excess = excess.max(OUTSIDE_EXCESS);
                }
                if !chart.apex.smooth {
                    let longest = chart.longest(ray.state());
                    excess = excess.max((h / longest).powi(5) * LONGEST_EXCESS);
                }
            }
        }
        excess
    }

    fn accept(&mut self, ray: &mut ActiveRay, trial: &LaneStep, lane: usize, h: f64, knot: Knot) {
        let layout = self.equation.layout;
        let from = ray.state();
        let before = [
            self.local.acceleration[0][lane],
            self.local.acceleration[1][lane],
        ];
        let s = ray.s;
        let direction = trial.direction_error[lane];
        let position = trial.position_error[lane].max(h * direction);
        ray.errors.add(fields(trial, lane), position, direction);
        ray.note_error(s, s + h, self.plan.reach);
        ray.h *= ray.control.trend(h, SHORT * self.plan.least);
        ray.control.accept(h);
        ray.step(h, fields(trial, lane), knot);
        match self.equation.chart {
            None => {
                if let Some((share, edge)) = leaves(layout, &from, before, &knot, h) {
                    self.active[lane] = self.leave(ray, s + share * h, edge);
                    return;
                }
            }
            Some(chart) => {
                let principal = knot.at[1].atan2(knot.at[0]);
                let turn = principal - ray.turned;
                ray.turned += turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round();
                if !chart.apex.smooth && chart.is_hit_between(from.at, knot.at) {
                    self.active[lane] = false;
                    ray.stop(ray.s, Status::ConePoint);
                    return;
                }
            }
        }
        if ray.s >= ray.length * (1.0 - END_SHARE) {
            ray.done = true;
            self.active[lane] = false;
            return;
        }
        if ray.evaluations + STAGES > self.plan.limit {
            ray.stop(ray.s, Status::WorkLimit);
            self.active[lane] = false;
            return;
        }
        if ray.h < self.plan.shortest {
            self.active[lane] = false;
            self.stall(ray);
            return;
        }
        let chart = match self.equation.chart {
            None => layout.chart_near(knot.at).map(|chart| FanChart::of(&chart)),
            Some(chart) if chart.is_left_at(knot.at) => Some(FanChart::PLAIN),
            Some(chart) if !chart.apex.smooth && ray.turned.abs() > TURN => Some(FanChart {
                reference: ray.chart.reference + ray.turned / chart.apex.rate,
                ..ray.chart
            }),
            Some(_) => None,
        };
        if let Some(chart) = chart {
            ray.enter(layout, chart);
            self.active[lane] = false;
        }
    }

    /// Continues a ray beyond an edge; returns whether it goes on.
    fn go_beyond(
        &self,
        ray: &mut ActiveRay,
        trial: &LaneStep,
        lane: usize,
        h: f64,
        knot: Knot,
    ) -> bool {
        ray.step(h, fields(trial, lane), knot);
        ray.beyond += 1;
        self.goes_beyond(ray)
    }

    fn goes_beyond(&self, ray: &ActiveRay) -> bool {
        ray.beyond < STEPS_BEYOND
            && ray.way(self.plan.beyond) > 0.0
            && ray.evaluations + STAGES <= self.plan.limit
    }

    /// Returns the length to a point shortly behind the first crease on a step.
    fn crease_ahead(
        &self,
        ray: &mut ActiveRay,
        trial: &LaneStep,
        lane: usize,
        h: f64,
    ) -> Option<f64> {
        let LaneEquation {
            surface, layout, ..
        } = self.equation;
        if !layout.has_creases || self.equation.chart.is_some() {
            return None;
        }
        let of = |state: &States<LANES>, local: &LaneLocals| {
            let [x, y] = &local.acceleration;
            [
                [state[0][lane], state[1][lane]],
                [state[2][lane], state[3][lane]],
                [x[lane], y[lane]],
            ]
        };
        let path = StepPath::new(
            h,
            of(&self.state, &self.local),
            of(&trial.end, &trial.local),
        );
        let proofs = Cell::new(0);
        let creases = |part: &PathPart<2>| {
            proofs.set(proofs.get() + 1);
            layout.creases_along(surface, part)
        };
        let share = path.first_beyond(&creases, &|at| {
            layout.beyond_edge(at).is_none() && layout.smooth_piece(surface, at) != ray.piece
        });
        ray.evaluations += proofs.get() / PROOFS_PER_EVALUATION;
        Some(share? * h)
    }

    /// Passes a crease within this length by an integration on its own; the ray continues behind it in another group.
    fn pass_crease(&self, ray: &mut ActiveRay, way: f64) {
        let layout = self.equation.layout;
        let from = ray.state();
        let mut start = from;
        let back = layout.bring_state_back(&mut start);
        let atlas = Atlas::new(self.equation.surface);
        let pass = |field: [f64; 2]| {
            let plan = integrate::IntegrationPlan {
                tableau: &DOPRI5,
                tolerance: Some(self.plan.rate.clamp(1e-12, 1e-6)),
                step: way,
                limit: atlas.evaluations() + CAREFUL as usize,
                charts: true,
                keep_path: false,
            };
            let observed = Observed {
                first_field: Some(field),
                ..Observed::default()
            };
            integrate::integrate_observed(&atlas, start.into(), way, plan, observed)
        };
        let end = pass([0.0, 1.0]);
        let other = pass([1.0, 0.0]);
        ray.evaluations += atlas.evaluations() as u64;
        let off = [0, 1].map(|k| end.state.at[k] - start.at[k]);
        let stays = (0..2).all(|k| off[k].abs() < 0.5 * layout.width(k));
        if end.status != Status::Complete || end.flipped || !stays {
            self.end_at(ray, &end);
            return;
        }
        let fields = [[other.field, end.field], [other.field_rate, end.field_rate]];
        let [m, rate] = ray.m;
        ray.m = fields.map(|[n, k]| n * m + k * rate);
        ray.errors.add(fields, 0.0, 0.0);
        let piece = layout.smooth_piece(self.equation.surface, end.state.at);
        if piece != ray.piece || end.creases > 0 {
            ray.passages.push(CreasePassage {
                from: ray.s,
                to: ray.s + way,
                piece,
            });
        }
        ray.piece = piece;
        ray.s += way;
        ray.at = [0, 1].map(|k| from.at[k] + back.signs[k] * off[k]);
        ray.velocity = [0, 1].map(|k| back.signs[k] * end.state.velocity[k]);
        ray.control.forget();
        if ray.s >= ray.length * (1.0 - END_SHARE) {
            ray.done = true;
        } else if ray.evaluations + STAGES > self.plan.limit {
            ray.stop(ray.s, Status::WorkLimit);
        }
    }

    /// Ends a ray at an edge; returns whether it is worth continuing beyond.
    fn leave(&self, ray: &mut ActiveRay, s: f64, (axis, end): (usize, usize)) -> bool {
        let collapsed = self.equation.layout.apexes[axis][end].is_some();
        ray.stop(
            s,
            if collapsed {
                Status::ConePoint
            } else {
                Status::LeftDomain
            },
        );
        ray.aim(axis, end);
        !collapsed && self.goes_beyond(ray)
    }

    /// Ends a ray whose steps make no progress: one careful integration finds the reason and the position.
    fn stall(&self, ray: &mut ActiveRay) {
        let layout = self.equation.layout;
        let mut state = ray.plain(layout);
        layout.bring_state_back(&mut state);
        let atlas = Atlas::new(self.equation.surface);
        let way = (ray.length - ray.s).min(1e2 * self.plan.shortest);
        let left = self.plan.limit.saturating_sub(ray.evaluations).min(CAREFUL);
        let plan = integrate::IntegrationPlan {
            tableau: &DOPRI5,
            tolerance: Some(self.plan.rate.clamp(1e-9, 1e-3)),
            step: self.plan.shortest,
            limit: left as usize,
            charts: true,
            keep_path: false,
        };
        let end = integrate::integrate(&atlas, state, way, plan);
        ray.evaluations += atlas.evaluations() as u64;
        self.end_at(ray, &end);
    }

    /// Ends a ray where an integration on its own, from the ray's point, ended.
    fn end_at(&self, ray: &mut ActiveRay, end: &RayEnd) {
        let layout = self.equation.layout;
        let status = match end.status {
            // It passes what stopped the group: unknown from here on.
            Status::Complete => Status::WorkLimit,
            status => status,
        };
        let s = if status == Status::WorkLimit {
            ray.s
        } else {
            ray.s + end.length
        };
        ray.stop(s, status);
        if status == Status::LeftDomain {
            let off = |axis: usize, side: usize| {
                layout.beyond(end.state.at, (axis, side)).abs() / layout.width(axis)
            };
            let nearest = (0..4)
                .map(|n| (n / 2, n % 2))
                .min_by(|a, b| off(a.0, a.1).total_cmp(&off(b.0, b.1)));
            if let Some((axis, side)) = nearest {
                ray.aim(axis, side);
            }
        }
    }
}

/// Returns a lane's fundamental fields at the end of a step, with their derivatives: (n, m), (n', m').
fn fields(trial: &LaneStep, lane: usize) -> [[f64; 2]; 2] {
    [
        [trial.end[6][lane], trial.end[4][lane]],
        [trial.end[7][lane], trial.end[5][lane]],
    ]
}
