//! A ray, step by step: changes of chart, control of the error in the metric, events, the end and why it came.
//!
//! In: an atlas, a start at unit speed, a length. Out: [`End`]. Every ray ends, within its number of evaluations.

mod collapse;
mod conjugate;
mod crease;
mod event;
mod ray;

use crate::chart::{ApexChart, Atlas, Chart, Local, Motion};
use crate::integrate::{Pace, Tableau};
use crate::status::Status;
use crate::surface::{Side, Surface};
use ray::{Attempt, ErrorSum, Ray};

/// A step shorter than this share of the ray's own scale is not worth taking.
const SHORTEST: f64 = 1e-13;

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
