//! A ray on its way: one step tried, taken or refused.
//!
//! In: where a ray is, what it has met so far, a step's length. Out: an [`Attempt`], and the ray a step farther on, with
//! the errors of its steps carried along.

use super::{IntegrationPlan, stalled_at};
use crate::chart::{Atlas, Chart, Local, REACH, State, rotated};
use crate::field::{self, FieldKnot};
use crate::metric::{combine, norm};
use crate::runge_kutta::{self, Step, StepParameter};
use crate::status::Status;
use crate::surface::Surface;

/// Steps shorter than this share of the ray's scale have something singular near by.
const SHORT: f64 = 0.01;
/// Where the rounding of u and v turns the tangent plane by more than this, the chart has lost its rank.
const MEANINGLESS: f64 = 1e-9;
/// What an evaluation's rounding may do to a step; the tolerance asked for has this as its floor.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The tolerance is for steps no shorter than this share of the ray's scale.
const SMALL_STEP: f64 = 0.005;
/// The share of its evaluations that a ray may use before they are compared with its progress, …
const UNHURRIED: f64 = 0.25;
/// … the share that it keeps back then, …
const KEPT: f64 = 0.15;
/// … and by how much its steps may err more at most.
const MOST_RELAXED: f64 = 1e3;

/// What the end of a ray takes at most: a last change of chart, a look at why it ended, its position.
const AT_END: usize = 16;

/// A ray on its way.
pub(super) struct Ray<'a, 's, S: Surface + ?Sized> {
    pub(super) atlas: &'a Atlas<'s, S>,
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

/// What a ray has cost so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cost {
    /// The count of evaluations at the start.
    pub(super) first_evaluation: usize,
    pub(super) steps: usize,
    pub(super) rejected: usize,
}

/// What is noted on the way.
#[derive(Clone, Debug)]
pub(super) struct Observers {
    /// True if the Jacobi fields are to be as exact as the ray.
    pub(super) fields: bool,
    /// The arc lengths of the conjugate points, where they are asked for.
    pub(super) conjugates: Option<Vec<f64>>,
    /// The places of the steps' ends in (u,v), where they are asked for.
    pub(super) path: Option<Vec<[f64; 2]>>,
    /// The Jacobi field after each step, where it is asked for.
    pub(super) knots: Option<Vec<FieldKnot>>,
}

/// The choice of each step's length from the errors of the steps before it.
///
/// The next length is 0.9 h e^(−1/q) for the error e of this step over the one allowed and the order q (Hairer, Nørsett,
/// Wanner, *Solving Ordinary Differential Equations I*, 2nd edition, section II.4), or less where the errors have been
/// growing from step to step (Gustafsson, ACM TOMS 20, 1994, pages 496–517).
#[derive(Clone, Copy, Debug)]
pub(super) struct StepControl {
    /// The size of the step before; 0 before the first.
    last_step: f64,
    /// Its error over the one allowed.
    last_excess: f64,
    /// The error over the one allowed of the step that is being tried.
    this_excess: f64,
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
            last_step: 0.0,
            last_excess: 1.0,
            this_excess: 1.0,
        }
    }
}

impl StepControl {
    /// Judges a step of size `h` by its error over the one allowed: the size of the next one, or, as an error, of another
    /// attempt. `scale` is the length beside which steps are short.
    fn judge(&mut self, h: f64, excess: f64, order: f64, scale: f64) -> Result<f64, f64> {
        let factor = 0.9 * excess.powf(-1.0 / order);
        if excess > 1.0 || excess.is_nan() {
            return Err(h * factor.clamp(0.1, 0.9));
        }
        // As the error has been growing from step to step, it will go on to grow.
        let predicted = if self.last_step > 0.0 {
            factor * (h / self.last_step) * (self.last_excess / excess).powf(1.0 / order)
        } else {
            factor
        };
        let factor = factor.min(predicted.max(0.5 * factor));
        self.this_excess = excess;
        // Steps that have been shrinking, towards a singular point, will go on to shrink.
        let shrinking = h < self.last_step && h < SHORT * scale;
        let trend = if shrinking {
            (h / self.last_step).max(0.5)
        } else {
            1.0
        };
        Ok(h * factor.clamp(0.2, 6.0) * trend)
    }

    /// Takes note of a step that has been taken.
    fn accept(&mut self, h: f64) {
        self.last_step = h;
        self.last_excess = self.this_excess;
    }

    /// Forgets the step before: it says nothing about those to come.
    pub(super) fn forget(&mut self) {
        self.last_step = 0.0;
    }
}

/// The outcome of a step that has been tried.
pub(super) enum Attempt {
    /// Taken; the length that the tolerance suggests next.
    Accepted(Option<f64>),
    /// Not taken: to be tried again with this length.
    Again(f64),
    Ended(Status),
}

impl<S: Surface + ?Sized> Ray<'_, '_, S> {
    pub(super) fn speed(&self) -> f64 {
        let [x, y] = self.state.velocity;
        norm(combine(
            x,
            self.local.tangents[0],
            y,
            self.local.tangents[1],
        ))
    }

    /// The point and velocity in (u,v), in the domain.
    pub(super) fn plain(&self) -> State {
        let mut state = match &self.chart {
            Chart::Plain => self.state,
            Chart::Apex(chart) => self.atlas.leave(chart, self.state, self.local.tangents),
        };
        let signs = self.atlas.bring_back(&mut state.at).signs;
        state.velocity = [0, 1].map(|k| signs[k] * state.velocity[k]);
        state
    }

    /// Notes where the ray is and its field, if they are asked for.
    pub(super) fn note_place(&mut self) {
        if let Some(knots) = &mut self.observers.knots {
            let [m, rate] = self.field;
            knots.push(FieldKnot {
                length: self.s,
                m,
                rate,
                curvature: self.local.curvature,
            });
        }
        if self.observers.path.is_some() {
            let at = self.plain().at;
            self.observers.path.get_or_insert_default().push(at);
        }
    }

    /// The longest step that the chart allows.
    pub(super) fn longest(&self) -> f64 {
        let by_chart = match &self.chart {
            Chart::Plain => f64::INFINITY,
            Chart::Apex(chart) => {
                let [x, y] = self.state.velocity;
                chart.longest(self.state) / x.hypot(y)
            }
        };
        match self.observers.knots {
            Some(_) => by_chart.min(field::longest_step(self.local.curvature)),
            None => by_chart,
        }
    }

    pub(super) fn step(&mut self, h: f64, pace: StepParameter) -> Option<Step> {
        runge_kutta::step(
            self.atlas,
            &self.chart,
            self.plan.tableau,
            self.state,
            &self.local,
            h,
            pace,
        )
    }

    /// By how much more than asked for the steps may err, so that the ray gets where it should within its limit:
    /// the work left is compared with the work done.
    pub(super) fn relaxation(&self, length: f64) -> f64 {
        let used = (self.atlas.evaluations() - self.cost.first_evaluation) as f64;
        let limit = self.plan.limit.saturating_sub(self.cost.first_evaluation) as f64;
        if used < UNHURRIED * limit || self.s <= 0.0 || used >= limit {
            return 1.0;
        }
        let needed = used * (length - self.s) / self.s;
        // Some are kept for a dear stretch at the end.
        let left = ((1.0 - KEPT) * limit - used).max(0.3 * (limit - used));
        (needed / left)
            .powf(self.plan.tableau.error_order)
            .clamp(1.0, MOST_RELAXED)
    }

    /// Returns whether one more step, and what its end takes, are within the limit.
    pub(super) fn affords_step(&self) -> bool {
        let interpolated = matches!(&self.chart, Chart::Apex(chart) if chart.apex.smooth);
        let each = if interpolated { 6 } else { 1 };
        let step = each * (self.plan.tableau.stages.len() + 1);
        self.atlas.evaluations() + step + AT_END <= self.plan.limit
    }

    pub(super) fn attempt(&mut self, h: f64, pace: StepParameter, length: f64) -> Attempt {
        let Some(step) = self.step(h, pace) else {
            return Attempt::Again(0.25 * h);
        };
        if self.s + step.length > length && pace == StepParameter::Coordinates {
            return Attempt::Again(0.5 * h);
        }
        let scale = self.atlas.scale.size.min(length);
        let rounding = self.rounding();
        // Only what a chart about an apex loses may pass for rounding; in (u,v) it ends the ray, see below.
        let noise = match &self.chart {
            Chart::Plain => 0.0,
            Chart::Apex(chart) => chart.noise(self.state.at, step.end.at),
        };
        let mut next = None;
        let mut may_err = f64::INFINITY;
        if let Some(tolerance) = self.plan.tolerance {
            // A ray of many short steps is allowed that much of its scale's error in each: errors grow no more
            // than that by being made over and over.
            let floor = (rounding + scale * noise).max(SMALL_STEP * tolerance * scale);
            let allowed = self.relaxation(length) * (tolerance * h).max(floor);
            may_err = allowed;
            let position = step.position_error / allowed;
            let direction = scale * step.direction_error / allowed;
            let mut excess = position + direction;
            if self.observers.fields {
                excess = excess.max(scale * step.field_error / allowed);
            }
            let order = self.plan.tableau.error_order;
            next = match self.control.judge(h, excess, order, scale) {
                Ok(next) => Some(next),
                Err(shorter) => return Attempt::Again(shorter),
            };
        }
        if self.oversteps(&step) {
            return Attempt::Again(0.5 * h);
        }
        if let Some((event, h)) = self.event(&step, h) {
            return self.end_at(event, h, pace, length);
        }
        let Some(local) = self.local_after(&step) else {
            return Attempt::Again(0.25 * h);
        };
        if next.is_some()
            && let Some(met) = self.crease(&step, &local, h, pace, may_err)
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

    /// What the rounding of coordinates amounts to on the surface.
    pub(super) fn rounding(&self) -> f64 {
        let [a, b] = self.state.at;
        let [t, w] = self.local.tangents;
        ROUNDING * (a.abs() * norm(t) + b.abs() * norm(w))
    }

    pub(super) fn accept(
        &mut self,
        step: &Step,
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
        // A pair's estimate for the point is now and then small by chance, when the one for the velocity, which acts
        // on the point within the step, or the change of speed, is not.
        let velocity = step.direction_error.max((self.speed() - before).abs());
        let position = step.position_error.max(step.length * velocity);
        let direction = velocity + noise + ROUNDING * (1.0 + step.length / scale);
        self.errors.add(step, position + rounding, direction);
    }

    /// The local data at a step's end; `None` where the surface is undefined.
    pub(super) fn local_after(&mut self, step: &Step) -> Option<Local> {
        match step.end_local {
            Some(local) => Some(local),
            None => self.atlas.local(&self.chart, step.end),
        }
    }

    /// Returns whether a step runs farther than its chart is good for.
    pub(super) fn oversteps(&self, step: &Step) -> bool {
        match &self.chart {
            Chart::Plain => self.plan.charts && self.atlas.needs_apex_chart(step.end.at),
            Chart::Apex(chart) => chart.share(step.end.at) > REACH,
        }
    }

    /// Brings the point back into the domain and changes the chart where another suits better. False where the
    /// surface is undefined there.
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
        let crossing = self.atlas.bring_back(&mut self.state.at);
        self.flipped ^= crossing.flipped;
        for (k, sign) in crossing.signs.into_iter().enumerate() {
            self.state.velocity[k] *= sign;
            self.local.acceleration[k] *= sign;
            self.local.tangents[k] = self.local.tangents[k].map(|x| x * sign);
        }
    }
}

/// The covariance of the error sideways and in direction: errors of the steps, carried on by the Jacobi fields.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ErrorSum {
    position: f64,
    mixed: f64,
    direction: f64,
    terms: f64,
}

impl ErrorSum {
    fn add(&mut self, step: &Step, position: f64, direction: f64) {
        let [[n, m], [n1, m1]] = step.propagator;
        let (p, x, d) = (self.position, self.mixed, self.direction);
        self.position = n * n * p + 2.0 * n * m * x + m * m * d + position * position;
        self.mixed = n * n1 * p + (n * m1 + m * n1) * x + m * m1 * d;
        self.direction = n1 * n1 * p + 2.0 * n1 * m1 * x + m1 * m1 * d + direction * direction;
        self.terms += 1.0;
    }

    /// A bound for errors that may all have one sign (Cauchy and Schwarz).
    pub(super) fn bound(&self) -> f64 {
        (self.terms * self.position.max(0.0)).sqrt()
    }
}
