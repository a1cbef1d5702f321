//! A ray during integration: one step tried, then accepted or rejected.
//!
//! In: a ray's state, the events so far, a step's length. Out: an [`Attempt`], and the ray after the step, with the
//! errors of its steps propagated.

use super::step::RayStep;
use super::{IntegrationPlan, stalled_at};
use crate::chart::{Atlas, Chart, Local, State, rotated};
use crate::jacobi::{self, JacobiKnot};
use crate::runge_kutta::StepParameter;
use crate::status::Status;
use crate::step_control::{ErrorSum, ROUNDING, SHORT, SMALL_STEP, StepControl, UNDEFINED};
use crate::vector::{combine, norm};

/// If the rounding of u and v turns the tangent plane by more than this, the chart has lost its rank.
const MEANINGLESS: f64 = 1e-9;
/// The fraction of its evaluations that a ray may use before they are compared with its progress.
const UNHURRIED: f64 = 0.25;
/// The fraction of its evaluations that a ray reserves from then on.
const KEPT: f64 = 0.15;
/// The maximum factor by which the error of a ray short of evaluations may be increased.
const MOST_RELAXED: f64 = 1e3;

/// The maximum number of evaluations at the end of a ray: a last change of chart, the reason for its end, its position.
const AT_END: usize = 16;

/// A ray during integration.
pub(super) struct Ray<'a, 's> {
    pub(super) atlas: &'a Atlas<'s>,
    pub(super) plan: IntegrationPlan,
    pub(super) chart: Chart,
    pub(super) state: State,
    pub(super) local: Local,
    /// The arc length so far.
    pub(super) s: f64,
    pub(super) errors: ErrorSum,
    /// m and m'.
    pub(super) field: [f64; 2],
    pub(super) flipped: bool,
    pub(super) creases: usize,
    pub(super) cost: Cost,
    pub(super) control: StepControl,
    pub(super) observers: Observers,
}

/// The work of a ray so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cost {
    /// The count of evaluations at the start.
    pub(super) first_evaluation: usize,
    pub(super) steps: usize,
    pub(super) rejected: usize,
}

/// The quantities observed along the way.
#[derive(Clone, Debug)]
pub(super) struct Observers {
    /// True if the Jacobi fields are to be as accurate as the ray.
    pub(super) accurate_jacobi: bool,
    /// The arc lengths of the conjugate points, if requested.
    pub(super) conjugates: Option<Vec<f64>>,
    /// The ends of the steps in (u,v), if requested.
    pub(super) path: Option<Vec<[f64; 2]>>,
    /// The Jacobi field after each step, if requested.
    pub(super) jacobi_knots: Option<Vec<JacobiKnot>>,
}

/// The outcome of a step that has been tried.
pub(super) enum Attempt {
    /// Accepted, with the length that the tolerance suggests next.
    Accepted(Option<f64>),
    /// Rejected; to be tried again with this length.
    Again(f64),
    Ended(Status),
}

impl Ray<'_, '_> {
    pub(super) fn speed(&self) -> f64 {
        let [x, y] = self.state.velocity;
        norm(combine(
            x,
            self.local.tangents[0],
            y,
            self.local.tangents[1],
        ))
    }

    /// Returns the point and velocity in (u,v), in the domain.
    pub(super) fn plain(&self) -> State {
        let mut state = match &self.chart {
            Chart::Plain => self.state,
            Chart::Apex(chart) => self.atlas.leave(chart, self.state, self.local.tangents),
        };
        self.atlas.layout.bring_state_back(&mut state);
        state
    }

    /// Records the ray's field, if requested.
    pub(super) fn note_field(&mut self) {
        if let Some(knots) = &mut self.observers.jacobi_knots {
            let [m, rate] = self.field;
            knots.push(JacobiKnot {
                length: self.s,
                m,
                rate,
                curvature: self.local.curvature,
            });
        }
    }

    /// Records the ray's position and its field, if requested.
    pub(super) fn note_place(&mut self) {
        self.note_field();
        if self.observers.path.is_some() {
            let at = self.plain().at;
            self.observers.path.get_or_insert_default().push(at);
        }
    }

    /// Returns the longest step that the chart allows.
    pub(super) fn longest(&self) -> f64 {
        let by_chart = match &self.chart {
            Chart::Plain => f64::INFINITY,
            Chart::Apex(chart) => chart.longest(self.state),
        };
        match self.observers.jacobi_knots {
            Some(_) => by_chart.min(jacobi::longest_step(self.local.curvature)),
            None => by_chart,
        }
    }

    /// Returns the factor on the tolerance that lets the ray reach its length within its limit: the remaining work is
    /// compared with the work done.
    pub(super) fn relaxation(&self, length: f64) -> f64 {
        let used = (self.atlas.evaluations() - self.cost.first_evaluation) as f64;
        let limit = self.plan.limit.saturating_sub(self.cost.first_evaluation) as f64;
        if used < UNHURRIED * limit || self.s <= 0.0 || used >= limit {
            return 1.0;
        }
        let needed = used * (length - self.s) / self.s;
        // Some are reserved for an expensive stretch at the end.
        let left = ((1.0 - KEPT) * limit - used).max(0.3 * (limit - used));
        (needed / left)
            .powf(self.plan.tableau.error_order)
            .clamp(1.0, MOST_RELAXED)
    }

    /// Returns whether one more step, and the work at its end, are within the limit.
    pub(super) fn affords_step(&self) -> bool {
        let interpolated = matches!(&self.chart, Chart::Apex(chart) if chart.apex.smooth);
        let each = if interpolated { 6 } else { 1 };
        let step = each * (self.plan.tableau.stages.len() + 1);
        self.atlas.evaluations() + step + AT_END <= self.plan.limit
    }

    pub(super) fn attempt(&mut self, h: f64, pace: StepParameter, length: f64) -> Attempt {
        if self.plan.tolerance.is_some()
            && let Some(met) = self.nears_other_piece(h)
        {
            return met;
        }
        let Some(step) = self.step(h, pace) else {
            return Attempt::Again(UNDEFINED * h);
        };
        if self.s + step.length > length && pace == StepParameter::Coordinates {
            return Attempt::Again(0.5 * h);
        }
        // No tolerance is needed to notice another piece, and steps across creases are not smooth.
        if self.plan.tolerance.is_some()
            && let Some(met) = self.enters_other_piece(&step, h)
        {
            return met;
        }
        let scale = self.atlas.layout.scale.size.min(length);
        let rounding = self.rounding();
        // Only the digits lost in a chart about an apex count as rounding; in (u,v) the loss ends the ray, see below.
        let noise = match &self.chart {
            Chart::Plain => 0.0,
            Chart::Apex(chart) => chart.noise(self.state.at, step.end.at),
        };
        let mut next = None;
        let mut may_err = f64::INFINITY;
        if let Some(tolerance) = self.plan.tolerance {
            // A ray of many short steps is allowed this fraction of its scale's error in each step: errors accumulate
            // no more than that.
            let floor = (rounding + scale * noise).max(SMALL_STEP * tolerance * scale);
            let allowed = self.relaxation(length) * (tolerance * h).max(floor);
            may_err = allowed;
            let position = step.position_error / allowed;
            let direction = scale * step.direction_error / allowed;
            let mut excess = position + direction;
            if self.observers.accurate_jacobi {
                excess = excess.max(scale * step.field_error / allowed);
            }
            let order = self.plan.tableau.error_order;
            let root = excess.powf(-1.0 / order);
            let most = self.control.foreseen(h, root);
            next = match self.control.judge(root, most) {
                Ok(factor) => Some(h * factor * self.control.trend(h, SHORT * scale)),
                Err(factor) => return Attempt::Again(h * factor),
            };
        }
        if self.oversteps(&step) {
            return Attempt::Again(0.5 * h);
        }
        let mut looked = 0.0;
        while let Some((event, share)) = self.event(&step, h, pace, looked) {
            if let Some(met) = self.end_at(event, share * h, pace, length) {
                return met;
            }
            looked = share;
        }
        let Some(local) = self.local_after(&step) else {
            return Attempt::Again(UNDEFINED * h);
        };
        if next.is_some()
            && let Some(met) = self.speed_jumps(&step, &local, h, may_err)
        {
            return met;
        }
        let rank = self.rank();
        self.accept(&step, local, h, pace, rounding, scale);
        if let Some(status) = self.collapses(rank, h) {
            return Attempt::Ended(status);
        }
        if matches!(self.chart, Chart::Plain) && self.local.noise > MEANINGLESS {
            return Attempt::Ended(Status::Degenerate);
        }
        if self.enter_next_chart() {
            Attempt::Accepted(next)
        } else {
            Attempt::Ended(stalled_at(self.atlas, self.plain().at))
        }
    }

    /// Returns the length on the surface of the coordinates' rounding.
    pub(super) fn rounding(&self) -> f64 {
        let [a, b] = self.state.at;
        let [t, w] = self.local.tangents;
        ROUNDING * (a.abs() * norm(t) + b.abs() * norm(w))
    }

    pub(super) fn accept(
        &mut self,
        step: &RayStep,
        local: Local,
        h: f64,
        pace: StepParameter,
        rounding: f64,
        scale: f64,
    ) {
        let noise = match &self.chart {
            Chart::Plain => self.local.noise,
            Chart::Apex(chart) => chart.noise(self.state.at, step.end.at),
        };
        if self.observers.conjugates.is_some() {
            self.note_conjugates(step, h, pace);
        }
        let before = self.speed();
        self.cost.steps += 1;
        self.control.accept(h);
        self.s += step.length;
        self.state = step.end;
        self.local = local;
        let [m, m1] = self.field;
        self.field = step.propagator.map(|[n, k]| n * m + k * m1);
        // A pair's estimate for the point is occasionally small by chance, when the one for the velocity, which affects
        // the point within the step, or the change of speed, is not.
        let velocity = step.direction_error.max((self.speed() - before).abs());
        let position = step.position_error.max(step.length * velocity);
        let direction = velocity + noise + ROUNDING * (1.0 + step.length / scale);
        self.errors
            .add(step.propagator, position + rounding, direction);
    }

    /// Returns the local data at a step's end; `None` where the surface is undefined.
    pub(super) fn local_after(&mut self, step: &RayStep) -> Option<Local> {
        match step.end_local {
            Some(local) => Some(local),
            None => self.atlas.local(&self.chart, step.end),
        }
    }

    /// Returns whether a step leaves the region in which its chart is valid.
    pub(super) fn oversteps(&self, step: &RayStep) -> bool {
        match &self.chart {
            Chart::Plain => self.plan.charts && self.atlas.layout.needs_apex_chart(step.end.at),
            Chart::Apex(chart) => chart.oversteps(step.end.at),
        }
    }

    /// Brings the point back into the domain and changes to a more suitable chart. Returns false where the surface is
    /// undefined there.
    pub(super) fn enter_next_chart(&mut self) -> bool {
        match &mut self.chart {
            Chart::Plain => {
                self.bring_back();
                if self.plan.charts
                    && let Chart::Apex(chart) = self.atlas.chart_for(self.state.at)
                {
                    let Some((state, local)) = self.atlas.enter(&chart, self.state) else {
                        return false;
                    };
                    (self.state, self.local) = (state, local);
                    self.chart = Chart::Apex(chart);
                }
                true
            }
            Chart::Apex(chart) => {
                if chart.is_left_at(self.state.at) {
                    self.state = chart.leave(self.state);
                    self.chart = Chart::Plain;
                    self.bring_back();
                    let local = self.atlas.local(&self.chart, self.state);
                    self.local = local.unwrap_or(self.local);
                    return local.is_some();
                }
                let rotation = chart.turn_to(&mut self.state);
                self.local.acceleration = rotated(rotation, self.local.acceleration);
                let [t, w] = self.local.tangents;
                let [cos, sin] = rotation;
                self.local.tangents = [combine(cos, t, sin, w), combine(-sin, t, cos, w)];
                true
            }
        }
    }

    pub(super) fn bring_back(&mut self) {
        let crossing = self.atlas.layout.bring_state_back(&mut self.state);
        self.flipped ^= crossing.flipped;
        for (k, sign) in crossing.signs.into_iter().enumerate() {
            self.local.acceleration[k] *= sign;
            self.local.tangents[k] = self.local.tangents[k].map(|x| x * sign);
        }
    }
}
