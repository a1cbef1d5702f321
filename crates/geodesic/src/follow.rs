//! A ray, step by step: changes of chart, control of the error in the metric, events, the end and why it came.
//!
//! In: an atlas, a start at unit speed, a length. Out: [`End`]. Every ray ends, within its number of evaluations.

use crate::chart::{Atlas, Chart, Local, Motion, REACH, rotated};
use crate::integrate::{self, Step, Tableau};
use crate::metric::{combine, norm};
use crate::surface::{Side, Surface};
use crate::trace::Status;

/// A tip of a cone is hit by what passes it within this share of its chart's radius.
const HIT: f64 = 1e-12;
/// How far beyond an edge a ray may stray, as a share of the domain's width, and still be on it.
const EDGE_SLACK: f64 = 1e-12;
/// A step shorter than this share of the ray's own scale is not worth taking.
const SHORTEST: f64 = 1e-13;
/// What an evaluation's rounding may do to a step; the tolerance asked for has this as its floor.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// How a ray is to be integrated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    pub(crate) tableau: &'static Tableau,
    /// The error allowed, per length; `None` for steps of equal length.
    pub(crate) tolerance: Option<f64>,
    /// The first step's length; for steps of equal length, all of them.
    pub(crate) step: f64,
    pub(crate) max_evaluations: usize,
    /// Whether apexes are passed in their own charts.
    pub(crate) charts: bool,
    /// Whether the positions of the steps' ends are kept.
    pub(crate) keep_path: bool,
}

/// Where a ray ended.
#[derive(Clone, Debug)]
pub(crate) struct End {
    pub(crate) motion: Motion,
    pub(crate) length: f64,
    pub(crate) speed_drift: f64,
    pub(crate) error: f64,
    pub(crate) steps: usize,
    pub(crate) rejected: usize,
    pub(crate) evaluations: usize,
    pub(crate) status: Status,
    pub(crate) flipped: bool,
    pub(crate) path: Vec<[f64; 2]>,
    /// The length of the last step that the tolerance chose: where a neighbouring ray may begin.
    pub(crate) step: f64,
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

/// Where within a step something happens.
#[derive(Clone, Copy, Debug)]
enum Event {
    Edge { axis: usize, end: usize },
    NearestToApex,
}

/// A ray on its way.
struct Ray<'a, 's, S: Surface + ?Sized> {
    atlas: &'a Atlas<'s, S>,
    plan: Plan,
    chart: Chart,
    motion: Motion,
    local: Local,
    evaluations: usize,
    steps: usize,
    rejected: usize,
    s: f64,
    errors: ErrorSum,
    flipped: bool,
}

/// Follows the geodesic from `start` in (u,v), inside the domain, at unit speed.
pub(crate) fn follow<S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    start: Motion,
    length: f64,
    plan: Plan,
) -> End {
    let mut evaluations = 0;
    let (chart, motion) = chart_at(atlas, &plan, start);
    let Some(local) = atlas.local(&chart, motion, &mut evaluations) else {
        return End {
            motion: start,
            length: 0.0,
            speed_drift: 0.0,
            error: 0.0,
            steps: 0,
            rejected: 0,
            evaluations,
            status: stalled_at(atlas, start.at),
            flipped: false,
            path: Vec::new(),
            step: plan.step,
        };
    };
    let mut ray = Ray {
        atlas,
        plan,
        chart,
        motion,
        local,
        evaluations,
        steps: 0,
        rejected: 0,
        s: 0.0,
        errors: ErrorSum::default(),
        flipped: false,
    };
    let before = ray.speed();
    let mut path = Vec::new();
    if plan.keep_path {
        path.push(start.at);
    }
    let mut h = plan.step;
    let mut chosen = plan.step;
    let status = loop {
        let remaining = length - ray.s;
        if remaining <= 1e-15 * length {
            break Status::Complete;
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
        match ray.attempt(tried, length) {
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
        if ray.evaluations >= plan.max_evaluations {
            break if length - ray.s <= 1e-15 * length {
                Status::Complete
            } else {
                Status::WorkLimit
            };
        }
    };
    if plan.keep_path {
        path.push(ray.plain().at);
    }
    let drift = ray.speed() / before - 1.0;
    End {
        motion: ray.plain(),
        length: if status == Status::Complete {
            length
        } else {
            ray.s
        },
        speed_drift: drift,
        error: ray.errors.bound(),
        steps: ray.steps,
        rejected: ray.rejected,
        evaluations: ray.evaluations,
        status,
        flipped: ray.flipped,
        path,
        step: chosen,
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
            Chart::Apex(chart) => chart.leave(self.motion),
        };
        let signs = self.atlas.bring_back(&mut motion.at);
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

    fn step(&mut self, h: f64) -> Option<Step> {
        integrate::step(
            self.atlas,
            &self.chart,
            self.plan.tableau,
            self.motion,
            &self.local,
            h,
            &mut self.evaluations,
        )
    }

    fn attempt(&mut self, h: f64, length: f64) -> Attempt {
        let Some(step) = self.step(h) else {
            return Attempt::Again(0.25 * h);
        };
        let scale = self.atlas.scale.size.min(length);
        let rounding = self.rounding();
        let noise = match &self.chart {
            Chart::Plain => 0.0,
            Chart::Apex(chart) => chart.noise(self.motion.at, step.end.at),
        };
        let mut next = None;
        if let Some(tolerance) = self.plan.tolerance {
            // A ray of many short steps is allowed a thousandth of its scale's error in each: errors grow no more
            // than that by being made over and over.
            let floor = (rounding + scale * noise).max(1e-3 * tolerance * scale);
            let allowed = (tolerance * h).max(floor);
            let position = step.position_error / allowed;
            let direction = scale * step.direction_error / allowed;
            let excess = position + direction;
            let factor = 0.9 * excess.powf(-1.0 / self.plan.tableau.error_order);
            if excess > 1.0 || excess.is_nan() {
                return Attempt::Again(h * factor.clamp(0.1, 0.9));
            }
            next = Some(h * factor.clamp(0.2, 6.0));
        }
        if self.oversteps(&step) {
            return Attempt::Again(0.5 * h);
        }
        if let Some((event, h)) = self.event(&step, h) {
            return self.end_at(event, h, length);
        }
        self.accept(&step, h, rounding, scale);
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

    fn accept(&mut self, step: &Step, h: f64, rounding: f64, scale: f64) {
        let noise = match &self.chart {
            Chart::Plain => 0.0,
            Chart::Apex(chart) => chart.noise(self.motion.at, step.end.at),
        };
        let direction = step.direction_error + noise + ROUNDING * (1.0 + h / scale);
        self.errors
            .add(step, step.position_error + rounding, direction);
        self.steps += 1;
        self.s += h;
        self.motion = step.end;
        if let Some(local) = step.end_local {
            self.local = local;
        } else if let Some(local) = self
            .atlas
            .local(&self.chart, step.end, &mut self.evaluations)
        {
            self.local = local;
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
                let signs = self.bring_back();
                if signs[0] * signs[1] < 0.0 {
                    // A pole mirrors one parameter and moves the other: that keeps the handedness, a flip not.
                    self.flipped = !self.flipped;
                }
                if self.plan.charts
                    && let Chart::Apex(chart) = self.atlas.chart_for(self.motion.at)
                {
                    self.motion = chart.enter(self.motion);
                    self.chart = Chart::Apex(chart);
                    return self.look();
                }
                true
            }
            Chart::Apex(chart) => {
                if chart.is_left_at(self.motion.at) {
                    self.motion = chart.leave(self.motion);
                    self.chart = Chart::Plain;
                    let signs = self.bring_back();
                    if signs[0] * signs[1] < 0.0 {
                        self.flipped = !self.flipped;
                    }
                    return self.look();
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

    fn bring_back(&mut self) -> [f64; 2] {
        let signs = self.atlas.bring_back(&mut self.motion.at);
        for k in 0..2 {
            self.motion.velocity[k] *= signs[k];
            self.local.acceleration[k] *= signs[k];
            self.local.tangents[k] = self.local.tangents[k].map(|x| x * signs[k]);
        }
        signs
    }

    fn look(&mut self) -> bool {
        let local = self
            .atlas
            .local(&self.chart, self.motion, &mut self.evaluations);
        if let Some(local) = local {
            self.local = local;
        }
        local.is_some()
    }

    /// What happens within a step, and a length of the step by which it has happened.
    fn event(&self, step: &Step, h: f64) -> Option<(Event, f64)> {
        match &self.chart {
            Chart::Apex(chart) => {
                if chart.apex.smooth {
                    return None;
                }
                let outward = |motion: &Motion| {
                    motion.at[0] * motion.velocity[0] + motion.at[1] * motion.velocity[1]
                };
                let passes = outward(&self.motion) < 0.0 && outward(&step.end) >= 0.0;
                let arrives = step.end.at[0].hypot(step.end.at[1]) <= HIT * chart.radius();
                (passes || arrives).then_some((Event::NearestToApex, h))
            }
            Chart::Plain => {
                // The earliest of a few looks at the step, the last one at its end.
                [0.25, 0.5, 0.75, 1.0].into_iter().find_map(|share| {
                    let at = if share == 1.0 {
                        step.end.at
                    } else {
                        hermite(&self.motion, &step.end, h, share)
                    };
                    (0..2).find_map(|axis| {
                        let [low, high] = self.atlas.domain[axis];
                        let slack = EDGE_SLACK * (high - low);
                        [low - at[axis], at[axis] - high]
                            .into_iter()
                            .enumerate()
                            .find_map(|(end, beyond)| {
                                let ends =
                                    self.atlas.sides.of(axis)[end] == Side::Edge && beyond > slack;
                                ends.then_some((Event::Edge { axis, end }, share * h))
                            })
                    })
                })
            }
        }
    }

    /// How far an event is ahead (negative) or behind (positive) at a point, and its rate.
    fn measure(&self, event: Event, motion: &Motion) -> (f64, f64) {
        match event {
            Event::Edge { axis, end } => {
                let sign = if end == 0 { -1.0 } else { 1.0 };
                (
                    sign * (motion.at[axis] - self.atlas.domain[axis][end]),
                    sign * motion.velocity[axis],
                )
            }
            Event::NearestToApex => {
                let ([a, b], [x, y]) = (motion.at, motion.velocity);
                (a * x + b * y, x * x + y * y)
            }
        }
    }

    /// Locates an event by Newton's method on the step's length, kept within a bracket: as exact as the steps are.
    fn end_at(&mut self, event: Event, h: f64, length: f64) -> Attempt {
        let scale = self.atlas.scale.size.min(length);
        let rounding = self.rounding();
        let (mut low, mut high) = (0.0, h);
        let (value, rate) = self.measure(event, &self.motion);
        let mut at = if rate > 0.0 {
            (-value / rate).clamp(0.0, h)
        } else {
            0.5 * h
        };
        let mut best = None;
        for _ in 0..60 {
            let Some(step) = self.step(at) else {
                high = at;
                at = 0.5 * (low + high);
                continue;
            };
            let (value, rate) = self.measure(event, &step.end);
            best = Some((at, step));
            if value > 0.0 {
                high = at;
            } else {
                low = at;
            }
            let newton = at - value / rate;
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            if (next - at).abs() <= 1e-15 * h || value == 0.0 {
                break;
            }
            at = next;
            if self.evaluations >= self.plan.max_evaluations {
                break;
            }
        }
        let Some((at, step)) = best else {
            return Attempt::Ended(stalled_at(self.atlas, self.plain().at));
        };
        if let (Event::NearestToApex, Chart::Apex(chart)) = (event, &self.chart) {
            let miss = step.end.at[0].hypot(step.end.at[1]);
            let hit = miss <= HIT * chart.radius();
            if !hit {
                // A near miss: the step ends at the nearest point, from where the next one leads away.
                self.accept(&step, at, rounding, scale);
                // Past the nearest point by a hair, so that it is not met again.
                let ([a, b], [x, y]) = (self.motion.at, self.motion.velocity);
                if a * x + b * y < 0.0 {
                    let along = (a * x + b * y) / (x * x + y * y);
                    self.motion.at = [a - along * x, b - along * y];
                }
                return if self.enter_next_chart() {
                    Attempt::Accepted(Some(h))
                } else {
                    Attempt::Ended(stalled_at(self.atlas, self.plain().at))
                };
            }
        }
        self.accept(&step, at, rounding, scale);
        Attempt::Ended(match event {
            Event::NearestToApex => Status::ConePoint,
            Event::Edge { axis, end } => {
                self.motion.at[axis] = self.atlas.domain[axis][end];
                match self.atlas.apexes[axis][end] {
                    Some(_) => Status::ConePoint,
                    None => Status::LeftDomain,
                }
            }
        })
    }
}

/// The chart for a point of the domain, and the motion in it.
fn chart_at<S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    plan: &Plan,
    start: Motion,
) -> (Chart, Motion) {
    if plan.charts
        && let Chart::Apex(chart) = atlas.chart_for(start.at)
    {
        return (Chart::Apex(chart), chart.enter(start));
    }
    (Chart::Plain, start)
}

/// A point of the cubic through both ends with their velocities.
fn hermite(from: &Motion, to: &Motion, h: f64, share: f64) -> [f64; 2] {
    let t = share;
    let (h00, h10) = (
        (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t),
        t * (1.0 - t) * (1.0 - t),
    );
    let (h01, h11) = (t * t * (3.0 - 2.0 * t), t * t * (t - 1.0));
    [0, 1].map(|k| {
        h00 * from.at[k] + h10 * h * from.velocity[k] + h01 * to.at[k] + h11 * h * to.velocity[k]
    })
}

/// Why a ray cannot go on from a point where the steps have become too short, or an evaluation fails.
fn stalled_at<S: Surface + ?Sized>(atlas: &Atlas<'_, S>, at: [f64; 2]) -> Status {
    for axis in 0..2 {
        for end in 0..2 {
            let off = (at[axis] - atlas.domain[axis][end]).abs() / atlas.width(axis);
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
