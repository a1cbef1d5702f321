//! A ray, step by step: changes of chart, control of the error in the metric, events, the end and why it came.
//!
//! In: an atlas, a start at unit speed, a length. Out: [`End`]. Every ray ends, within its number of evaluations.

mod collapse;
mod conjugate;
mod crease;
mod event;

use crate::chart::{ApexChart, Atlas, Chart, Local, Motion, REACH, rotated};
use crate::integrate::{self, Pace, Step, Tableau};
use crate::metric::{combine, norm};
use crate::surface::{Side, Surface};
use crate::trace::Status;

/// A step shorter than this share of the ray's own scale is not worth taking.
const SHORTEST: f64 = 1e-13;
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
const MOST_LENIENT: f64 = 1e3;

/// What the end of a ray takes at most: a last change of chart, a look at why it ended, its position.
const AT_END: usize = 16;

/// How a ray is to be integrated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    pub(crate) tableau: &'static Tableau,
    /// The error allowed, per length; `None` for steps of equal length.
    pub(crate) tolerance: Option<f64>,
    /// The first step's length; for steps of equal length, all of them.
    pub(crate) step: f64,
    /// How far the atlas's count of evaluations may go.
    pub(crate) limit: usize,
    /// Whether apexes are passed in their own charts.
    pub(crate) charts: bool,
    /// Whether the positions of the steps' ends are kept.
    pub(crate) keep_path: bool,
}

/// Where a ray begins.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Start {
    /// In (u,v), inside the domain, at unit speed.
    Plain(Motion),
    /// In the chart about an apex, at unit speed.
    About(ApexChart, Motion),
}

impl From<Motion> for Start {
    fn from(motion: Motion) -> Self {
        Self::Plain(motion)
    }
}

/// Where a ray ended.
#[derive(Clone, Debug)]
pub(crate) struct End {
    /// In (u,v), inside the domain.
    pub(crate) motion: Motion,
    /// The chart that it ended in, and the point and velocity there.
    pub(crate) inside: (Chart, Motion),
    pub(crate) length: f64,
    pub(crate) speed_drift: f64,
    pub(crate) error: f64,
    pub(crate) steps: usize,
    pub(crate) rejected: usize,
    pub(crate) status: Status,
    pub(crate) flipped: bool,
    /// The creases that it has crossed.
    pub(crate) creases: usize,
    pub(crate) path: Vec<[f64; 2]>,
    /// The length of the last step that the tolerance chose: where a neighbouring ray may begin.
    pub(crate) step: f64,
    /// m at the end: the Jacobi field with m = 0, m' = 1 at the start, across the ray.
    pub(crate) field: f64,
    /// m' there.
    pub(crate) field_rate: f64,
    /// The arc lengths at which m = 0, if they were asked for.
    pub(crate) conjugates: Vec<f64>,
}

/// The covariance of the error sideways and in direction: errors of the steps, carried on by the Jacobi fields.
#[derive(Clone, Copy, Debug, Default)]
struct ErrorSum {
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
    fn bound(&self) -> f64 {
        (self.terms * self.position.max(0.0)).sqrt()
    }
}

/// A ray on its way.
struct Ray<'a, 's, S: Surface + ?Sized> {
    atlas: &'a Atlas<'s, S>,
    plan: Plan,
    chart: Chart,
    motion: Motion,
    local: Local,
    steps: usize,
    rejected: usize,
    s: f64,
    errors: ErrorSum,
    /// m and m'.
    field: [f64; 2],
    flipped: bool,
    creases: usize,
    /// The arc lengths of the conjugate points, where they are asked for.
    conjugates: Option<Vec<f64>>,
    /// Whether the Jacobi fields are to be as exact as the ray.
    fields: bool,
    /// The count of evaluations at the start.
    first_evaluation: usize,
    /// The size of the step before; 0 before the first.
    last_step: f64,
    /// Its error over the one allowed.
    last_excess: f64,
    /// The same of the step that is being tried.
    this_excess: f64,
}

/// Follows the geodesic from `start`.
pub(crate) fn follow<S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    start: impl Into<Start>,
    length: f64,
    plan: Plan,
) -> End {
    follow_noting(atlas, start.into(), length, plan, Noting::default())
}

/// What is to be noted on the way beside the ray itself.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Noting {
    /// Whether the Jacobi fields are to be as exact as the ray.
    pub(crate) fields: bool,
    /// Whether conjugate points are looked for.
    pub(crate) conjugates: bool,
}

/// The same, noting more on the way.
pub(crate) fn follow_noting<S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    start: Start,
    length: f64,
    plan: Plan,
    noting: Noting,
) -> End {
    let first_evaluation = atlas.evaluations();
    let Some((chart, motion, local)) = begin(atlas, &plan, start) else {
        let start = match start {
            Start::Plain(motion) => motion,
            Start::About(chart, motion) => chart.leave(motion),
        };
        return End {
            motion: start,
            inside: (Chart::Plain, start),
            length: 0.0,
            speed_drift: 0.0,
            error: 0.0,
            steps: 0,
            rejected: 0,
            status: stalled_at(atlas, start.at),
            flipped: false,
            creases: 0,
            path: Vec::new(),
            step: plan.step,
            field: 0.0,
            field_rate: 1.0,
            conjugates: Vec::new(),
        };
    };
    let mut ray = Ray {
        atlas,
        plan,
        chart,
        motion,
        local,
        steps: 0,
        rejected: 0,
        s: 0.0,
        errors: ErrorSum::default(),
        field: [0.0, 1.0],
        conjugates: noting.conjugates.then(Vec::new),
        flipped: false,
        creases: 0,
        fields: noting.fields,
        first_evaluation,
        last_step: 0.0,
        last_excess: 1.0,
        this_excess: 1.0,
    };
    let before = ray.speed();
    let mut path = Vec::new();
    if plan.keep_path {
        path.push(ray.plain().at);
    }
    let mut h = plan.step;
    let mut chosen = plan.step;
    let status = loop {
        let remaining = length - ray.s;
        if remaining <= 1e-15 * length {
            break Status::Complete;
        }
        if !ray.affords_step() {
            break Status::WorkLimit;
        }
        h = h.min(ray.longest());
        // Two steps of equal length rather than a long one and a sliver.
        let tried = if h >= remaining {
            remaining
        } else if plan.tolerance.is_some() && 2.0 * h > remaining {
            0.5 * remaining
        } else if remaining - h < 1e-9 * h {
            remaining
        } else {
            h
        };
        // The last step, and steps of equal length, are to be of that length.
        let pace = if tried == remaining || plan.tolerance.is_none() {
            Pace::Length
        } else {
            Pace::Coordinates
        };
        match ray.attempt(tried, pace, length) {
            Attempt::Accepted(next) => {
                if let Some(next) = next {
                    // A step cut short by the end says little about the next.
                    h = if tried < h {
                        next.max(h.min(2.0 * next))
                    } else {
                        next
                    };
                    chosen = h;
                }
                if plan.keep_path {
                    path.push(ray.plain().at);
                }
            }
            Attempt::Ended(status) => break status,
            Attempt::Again(shorter) => {
                ray.rejected += 1;
                h = shorter;
                if plan.tolerance.is_none() {
                    break stalled_at(atlas, ray.plain().at);
                }
            }
        }
        // Steps that shrink to nothing run into something that they will not pass.
        let shortest = SHORTEST * length.min(atlas.scale.size).max(ray.s);
        if plan.tolerance.is_some() && h < shortest && length - ray.s > shortest {
            break stalled_at(atlas, ray.plain().at);
        }
    };
    if plan.keep_path {
        path.push(ray.plain().at);
    }
    let drift = ray.speed() / before - 1.0;
    End {
        motion: ray.plain(),
        inside: (ray.chart, ray.motion),
        length: if status == Status::Complete {
            length
        } else {
            ray.s
        },
        speed_drift: drift,
        error: ray.errors.bound(),
        steps: ray.steps,
        rejected: ray.rejected,
        status,
        flipped: ray.flipped,
        creases: ray.creases,
        path,
        step: chosen,
        field: ray.field[0],
        field_rate: ray.field[1],
        conjugates: ray.conjugates.unwrap_or_default(),
    }
}

enum Attempt {
    /// Taken; the length that the tolerance suggests next.
    Accepted(Option<f64>),
    /// Not taken: to be tried again with this length.
    Again(f64),
    Ended(Status),
}

impl<S: Surface + ?Sized> Ray<'_, '_, S> {
    fn speed(&self) -> f64 {
        let [x, y] = self.motion.velocity;
        norm(combine(
            x,
            self.local.tangents[0],
            y,
            self.local.tangents[1],
        ))
    }

    /// The point and velocity in (u,v), in the domain.
    fn plain(&self) -> Motion {
        let mut motion = match &self.chart {
            Chart::Plain => self.motion,
            Chart::Apex(chart) => self.atlas.leave(chart, self.motion, self.local.tangents),
        };
        let signs = self.atlas.bring_back(&mut motion.at).signs;
        motion.velocity = [0, 1].map(|k| signs[k] * motion.velocity[k]);
        motion
    }

    /// The longest step that the chart allows.
    fn longest(&self) -> f64 {
        match &self.chart {
            Chart::Plain => f64::INFINITY,
            Chart::Apex(chart) => {
                let [x, y] = self.motion.velocity;
                chart.longest(self.motion) / x.hypot(y)
            }
        }
    }

    fn step(&mut self, h: f64, pace: Pace) -> Option<Step> {
        integrate::step(
            self.atlas,
            &self.chart,
            self.plan.tableau,
            self.motion,
            &self.local,
            h,
            pace,
        )
    }

    /// By how much more than asked for the steps may err, so that the ray gets where it should within its limit:
    /// the work left is compared with the work done.
    fn leniency(&self, length: f64) -> f64 {
        let used = (self.atlas.evaluations() - self.first_evaluation) as f64;
        let limit = self.plan.limit.saturating_sub(self.first_evaluation) as f64;
        if used < UNHURRIED * limit || self.s <= 0.0 || used >= limit {
            return 1.0;
        }
        let needed = used * (length - self.s) / self.s;
        // Some are kept for a dear stretch at the end.
        let left = ((1.0 - KEPT) * limit - used).max(0.3 * (limit - used));
        (needed / left)
            .powf(self.plan.tableau.error_order)
            .clamp(1.0, MOST_LENIENT)
    }

    /// Whether one more step, and what its end takes, are within the limit.
    fn affords_step(&self) -> bool {
        let interpolated = matches!(&self.chart, Chart::Apex(chart) if chart.apex.smooth);
        let each = if interpolated { 6 } else { 1 };
        let step = each * (self.plan.tableau.stages.len() + 1);
        self.atlas.evaluations() + step + AT_END <= self.plan.limit
    }

    fn attempt(&mut self, h: f64, pace: Pace, length: f64) -> Attempt {
        let Some(step) = self.step(h, pace) else {
            return Attempt::Again(0.25 * h);
        };
        if self.s + step.length > length && pace == Pace::Coordinates {
            return Attempt::Again(0.5 * h);
        }
        let scale = self.atlas.scale.size.min(length);
        let rounding = self.rounding();
        // Only what a chart about an apex loses may pass for rounding; in (u,v) it ends the ray, see below.
        let noise = match &self.chart {
            Chart::Plain => 0.0,
            Chart::Apex(chart) => chart.noise(self.motion.at, step.end.at),
        };
        let mut next = None;
        let mut may_err = f64::INFINITY;
        if let Some(tolerance) = self.plan.tolerance {
            // A ray of many short steps is allowed that much of its scale's error in each: errors grow no more
            // than that by being made over and over.
            let floor = (rounding + scale * noise).max(SMALL_STEP * tolerance * scale);
            let allowed = self.leniency(length) * (tolerance * h).max(floor);
            may_err = allowed;
            let position = step.position_error / allowed;
            let direction = scale * step.direction_error / allowed;
            let mut excess = position + direction;
            if self.fields {
                excess = excess.max(scale * step.field_error / allowed);
            }
            let order = self.plan.tableau.error_order;
            let factor = 0.9 * excess.powf(-1.0 / order);
            if excess > 1.0 || excess.is_nan() {
                return Attempt::Again(h * factor.clamp(0.1, 0.9));
            }
            // As the error has been growing from step to step, it will go on to grow (Gustafsson's predictor).
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
            next = Some(h * factor.clamp(0.2, 6.0) * trend);
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
    fn rounding(&self) -> f64 {
        let [a, b] = self.motion.at;
        let [t, w] = self.local.tangents;
        ROUNDING * (a.abs() * norm(t) + b.abs() * norm(w))
    }

    fn accept(&mut self, step: &Step, local: Local, h: f64, pace: Pace, rounding: f64, scale: f64) {
        let noise = match &self.chart {
            Chart::Plain => self.local.noise,
            Chart::Apex(chart) => chart.noise(self.motion.at, step.end.at),
        };
        if self.conjugates.is_some() {
            self.note_conjugates(step, h, pace);
        }
        let before = self.speed();
        self.steps += 1;
        self.last_step = h;
        self.last_excess = self.this_excess;
        self.s += step.length;
        self.motion = step.end;
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
    fn local_after(&mut self, step: &Step) -> Option<Local> {
        match step.end_local {
            Some(local) => Some(local),
            None => self.atlas.local(&self.chart, step.end),
        }
    }

    /// Whether a step runs farther than its chart is good for.
    fn oversteps(&self, step: &Step) -> bool {
        match &self.chart {
            Chart::Plain => self.plan.charts && self.atlas.needs_apex_chart(step.end.at),
            Chart::Apex(chart) => chart.share(step.end.at) > REACH,
        }
    }

    /// Brings the point back into the domain and changes the chart where another suits better. False where the
    /// surface is undefined there.
    fn enter_next_chart(&mut self) -> bool {
        match &mut self.chart {
            Chart::Plain => {
                self.bring_back();
                if self.plan.charts
                    && let Chart::Apex(chart) = self.atlas.chart_for(self.motion.at)
                {
                    let Some((motion, local)) = self.atlas.enter(&chart, self.motion) else {
                        return false;
                    };
                    (self.motion, self.local) = (motion, local);
                    self.chart = Chart::Apex(chart);
                }
                true
            }
            Chart::Apex(chart) => {
                if chart.is_left_at(self.motion.at) {
                    self.motion = chart.leave(self.motion);
                    self.chart = Chart::Plain;
                    self.bring_back();
                    let local = self.atlas.local(&self.chart, self.motion);
                    self.local = local.unwrap_or(self.local);
                    return local.is_some();
                }
                let rotation = chart.turn_to(&mut self.motion);
                self.local.acceleration = rotated(rotation, self.local.acceleration);
                let [t, w] = self.local.tangents;
                let [cos, sin] = rotation;
                self.local.tangents = [combine(cos, t, sin, w), combine(-sin, t, cos, w)];
                true
            }
        }
    }

    fn bring_back(&mut self) {
        let crossing = self.atlas.bring_back(&mut self.motion.at);
        self.flipped ^= crossing.flipped;
        for (k, sign) in crossing.signs.into_iter().enumerate() {
            self.motion.velocity[k] *= sign;
            self.local.acceleration[k] *= sign;
            self.local.tangents[k] = self.local.tangents[k].map(|x| x * sign);
        }
    }
}

/// The chart for a start, the motion in it, and its local data.
fn begin<S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    plan: &Plan,
    start: Start,
) -> Option<(Chart, Motion, Local)> {
    let start = match start {
        Start::Plain(motion) => motion,
        Start::About(chart, motion) => {
            let local = atlas.local(&Chart::Apex(chart), motion)?;
            if plan.charts {
                return Some((Chart::Apex(chart), motion, local));
            }
            let mut left = atlas.leave(&chart, motion, local.tangents);
            let signs = atlas.bring_back(&mut left.at).signs;
            left.velocity = [0, 1].map(|k| signs[k] * left.velocity[k]);
            left
        }
    };
    if plan.charts
        && let Chart::Apex(chart) = atlas.chart_for(start.at)
    {
        let (motion, local) = atlas.enter(&chart, start)?;
        return Some((Chart::Apex(chart), motion, local));
    }
    let local = atlas.local(&Chart::Plain, start)?;
    Some((Chart::Plain, start, local))
}

/// Why a ray cannot go on from a point where the steps have become too short, or an evaluation fails.
fn stalled_at<S: Surface + ?Sized>(atlas: &Atlas<'_, S>, at: [f64; 2]) -> Status {
    for (axis, x) in at.into_iter().enumerate() {
        for end in 0..2 {
            let off = (x - atlas.domain[axis][end]).abs() / atlas.width(axis);
            if off < 1e-6 && atlas.apexes[axis][end].is_some() {
                return Status::ConePoint;
            }
            if off < 1e-9 && atlas.sides.of(axis)[end] == Side::Edge {
                return Status::LeftDomain;
            }
        }
    }
    atlas.rank_at(at)
}
