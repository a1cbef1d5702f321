//! A ray, step by step: changes of chart, error control in the metric, events, and the end with its reason.
//!
//! In: an atlas, a start at unit speed, a length. Out: [`RayEnd`]. Every ray ends within its limit on evaluations.

mod collapse;
mod conjugate;
mod crease;
mod event;
mod ray;
mod step;

use crate::chart::{ApexChart, Atlas, Chart, Local, State};
use crate::jacobi::JacobiKnot;
use crate::runge_kutta::{StepParameter, Tableau};
use crate::status::Status;
use crate::step_control::{ErrorSum, SHORTEST, StepControl, step_after, step_to_try};
use crate::surface::Side;
use ray::{Attempt, Cost, Observers, Ray};

/// The parameters of an integration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IntegrationPlan {
    pub(crate) tableau: &'static Tableau,
    /// The error allowed, per length; `None` for steps of equal length.
    pub(crate) tolerance: Option<f64>,
    /// The length of the first step; with equal steps, of all of them.
    pub(crate) step: f64,
    /// The maximum that the atlas' count of evaluations may reach.
    pub(crate) limit: usize,
    /// True if rays pass apexes in the apexes' own charts.
    pub(crate) charts: bool,
    /// True if the positions of the steps' ends are stored.
    pub(crate) keep_path: bool,
}

/// The start of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Start {
    /// In (u,v), inside the domain, at unit speed.
    Plain(State),
    /// In the chart about an apex, at unit speed.
    About(ApexChart, State),
}

impl From<State> for Start {
    fn from(state: State) -> Self {
        Self::Plain(state)
    }
}

/// The end of a ray, with the events along the way.
#[derive(Clone, Debug)]
pub(crate) struct RayEnd {
    /// In (u,v), inside the domain.
    pub(crate) state: State,
    /// The chart in which it ended, and the point and velocity there.
    pub(crate) inside: (Chart, State),
    pub(crate) length: f64,
    pub(crate) speed_drift: f64,
    pub(crate) error: f64,
    pub(crate) steps: usize,
    pub(crate) rejected: usize,
    pub(crate) status: Status,
    pub(crate) flipped: bool,
    /// The number of creases that it has crossed.
    pub(crate) creases: usize,
    pub(crate) path: Vec<[f64; 2]>,
    /// The length of the last step that the tolerance chose: a first step for a neighbouring ray.
    pub(crate) step: f64,
    /// m at the end: the Jacobi field with m = 0, m' = 1 at the start, across the ray.
    pub(crate) field: f64,
    /// m' there.
    pub(crate) field_rate: f64,
    /// The arc lengths at which m = 0, if they were requested.
    pub(crate) conjugates: Vec<f64>,
    /// The Jacobi field after each step, if requested.
    pub(crate) jacobi_knots: Vec<JacobiKnot>,
}

impl RayEnd {
    /// Returns the end of a ray that cannot be started: its start, and the reason.
    fn at_start(atlas: &Atlas<'_>, start: Start, step: f64) -> Self {
        let state = match start {
            Start::Plain(state) => state,
            Start::About(chart, state) => chart.leave(state),
        };
        Self {
            state,
            inside: (Chart::Plain, state),
            length: 0.0,
            speed_drift: 0.0,
            error: 0.0,
            steps: 0,
            rejected: 0,
            status: stalled_at(atlas, state.at),
            flipped: false,
            creases: 0,
            path: Vec::new(),
            step,
            field: 0.0,
            field_rate: 1.0,
            conjugates: Vec::new(),
            jacobi_knots: Vec::new(),
        }
    }
}

/// Integrates the geodesic from `start`.
pub(crate) fn integrate(
    atlas: &Atlas<'_>,
    start: impl Into<Start>,
    length: f64,
    plan: IntegrationPlan,
) -> RayEnd {
    integrate_observed(atlas, start.into(), length, plan, Observed::default())
}

/// The quantities to be observed along the way, besides the ray itself.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Observed {
    /// The Jacobi field at the start, m and m', if not 0 and 1.
    pub(crate) first_field: Option<[f64; 2]>,
    /// True if the Jacobi fields are to be as accurate as the ray.
    pub(crate) accurate_jacobi: bool,
    /// True if conjugate points are located.
    pub(crate) conjugates: bool,
    /// True if the Jacobi field is stored after each step, and steps are short compared with 1/√|K|.
    pub(crate) jacobi_knots: bool,
}

/// Integrates the geodesic from `start` and observes more quantities along the way.
pub(crate) fn integrate_observed(
    atlas: &Atlas<'_>,
    start: Start,
    length: f64,
    plan: IntegrationPlan,
    observed: Observed,
) -> RayEnd {
    let first_evaluation = atlas.evaluations();
    let Some((chart, state, local)) = begin(atlas, &plan, start) else {
        return RayEnd::at_start(atlas, start, plan.step);
    };
    let ray = Ray {
        atlas,
        plan,
        chart,
        state,
        local,
        s: 0.0,
        errors: ErrorSum::default(),
        field: observed.first_field.unwrap_or([0.0, 1.0]),
        flipped: false,
        creases: 0,
        cost: Cost {
            first_evaluation,
            steps: 0,
            rejected: 0,
        },
        control: StepControl::default(),
        observers: Observers {
            accurate_jacobi: observed.accurate_jacobi,
            conjugates: observed.conjugates.then(Vec::new),
            path: plan.keep_path.then(Vec::new),
            jacobi_knots: observed.jacobi_knots.then(Vec::new),
        },
    };
    run(ray, length)
}

/// Takes steps until the ray has its full length, or ends earlier.
///
/// Each iteration either advances, shortens the step, or ends. The evaluations are limited, and steps that shrink to
/// nothing end the ray, so the loop terminates.
fn run(mut ray: Ray<'_, '_>, length: f64) -> RayEnd {
    let atlas = ray.atlas;
    let adaptive = ray.plan.tolerance.is_some();
    let before = ray.speed();
    ray.note_place();
    let mut h = ray.plan.step;
    let mut chosen = h;
    let status = loop {
        let remaining = length - ray.s;
        if remaining <= 1e-15 * length {
            break Status::Complete;
        }
        if !ray.affords_step() {
            break Status::WorkLimit;
        }
        h = h.min(ray.longest());
        let tried = if adaptive {
            step_to_try(h, remaining)
        } else if remaining - h < 1e-9 * h {
            remaining
        } else {
            h
        };
        // The last step, and equal steps, have a prescribed arc length.
        let pace = if tried == remaining || !adaptive {
            StepParameter::Length
        } else {
            StepParameter::Coordinates
        };
        match ray.attempt(tried, pace, length) {
            Attempt::Accepted(next) => {
                if let Some(next) = next {
                    h = step_after(h, tried, next);
                    chosen = h;
                }
                ray.note_place();
            }
            Attempt::Ended(status) => break status,
            Attempt::Again(shorter) => {
                ray.cost.rejected += 1;
                h = shorter;
                if !adaptive {
                    break stalled_at(atlas, ray.plain().at);
                }
            }
        }
        // Steps that shrink to nothing approach something that they cannot pass.
        let shortest = SHORTEST * length.min(atlas.layout.scale.size).max(ray.s);
        if adaptive && h < shortest && length - ray.s > shortest {
            if !ray.leaps_over_kink(10.0 * shortest) {
                break stalled_at(atlas, ray.plain().at);
            }
            h = 10.0 * shortest;
            ray.note_place();
        }
    };
    ray.note_place();
    let drift = ray.speed() / before - 1.0;
    RayEnd {
        state: ray.plain(),
        inside: (ray.chart, ray.state),
        length: if status == Status::Complete {
            length
        } else {
            ray.s
        },
        speed_drift: drift,
        error: ray.errors.bound(),
        steps: ray.cost.steps,
        rejected: ray.cost.rejected,
        status,
        flipped: ray.flipped,
        creases: ray.creases,
        path: ray.observers.path.unwrap_or_default(),
        step: chosen,
        field: ray.field[0],
        field_rate: ray.field[1],
        conjugates: ray.observers.conjugates.unwrap_or_default(),
        jacobi_knots: ray.observers.jacobi_knots.unwrap_or_default(),
    }
}

/// Returns the chart for a start, the state in it, and its local data.
fn begin(atlas: &Atlas<'_>, plan: &IntegrationPlan, start: Start) -> Option<(Chart, State, Local)> {
    let start = match start {
        Start::Plain(state) => state,
        Start::About(chart, state) => {
            let local = atlas.local(&Chart::Apex(chart), state)?;
            if plan.charts {
                return Some((Chart::Apex(chart), state, local));
            }
            let mut left = atlas.leave(&chart, state, local.tangents);
            atlas.layout.bring_state_back(&mut left);
            left
        }
    };
    if plan.charts
        && let Chart::Apex(chart) = atlas.chart_for(start.at)
    {
        let (state, local) = atlas.enter(&chart, start)?;
        return Some((Chart::Apex(chart), state, local));
    }
    let local = atlas.local(&Chart::Plain, start)?;
    Some((Chart::Plain, start, local))
}

/// Returns the reason why a ray cannot continue from a point where the steps have become too short, or an evaluation
/// fails.
fn stalled_at(atlas: &Atlas<'_>, at: [f64; 2]) -> Status {
    for (axis, x) in at.into_iter().enumerate() {
        for end in 0..2 {
            let off = (x - atlas.layout.domain[axis][end]).abs() / atlas.layout.width(axis);
            if off < 1e-6 && atlas.layout.apexes[axis][end].is_some() {
                return Status::ConePoint;
            }
            if off < 1e-9 && atlas.layout.sides.of(axis)[end] == Side::Edge {
                return Status::LeftDomain;
            }
        }
    }
    atlas.rank_at(at)
}
