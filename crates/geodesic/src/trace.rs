//! One geodesic, integrated adaptively in f64: [`trace`].

use std::fmt;

use crate::chart::{Atlas, Chart, State};
use crate::integrate::{self, IntegrationPlan, Observed, RayEnd, Start};
use crate::jacobi::JacobiKnot;
use crate::metric::speed;
use crate::point::{TangentVector, Uv};
use crate::runge_kutta::{DOP853, DOPRI5, RK4};
use crate::surface::{Side, Surface};
use crate::vector::{cross, norm};

pub use crate::status::Status;

/// A method of integration.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum TraceMethod {
    /// Steps as long as the tolerance allows: DOP853, or Dormand–Prince 5(4) where the tolerance is loose. Poles and
    /// tips of cones are passed in their own charts.
    #[default]
    Adaptive,
    /// This many equal steps (at least one) of the classical Runge–Kutta method in (u,v), as in the thesis (equations
    /// 4.2), for comparison. Its error is estimated from a second run with half the number of steps, or with two for
    /// one; both are within the limit on evaluations.
    Rk4 {
        /// The number of steps.
        steps: u32,
    },
}

/// The accuracy requested, and the limits on work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The error allowed per step, relative to the step's length, measured on the surface; at least 50 ε.
    pub tolerance: f64,
    /// The method of integration.
    pub method: TraceMethod,
    /// The maximum number of evaluations of the surface and its derivatives, whatever the method.
    pub max_evaluations: usize,
    /// True if the error is estimated by integrating the geodesic again with higher accuracy, where the remaining
    /// evaluations allow it, at three to four times the cost. Otherwise the estimate is a bound from the steps' own
    /// estimates.
    pub compare: bool,
    /// True if [`Trace::path`] is recorded.
    pub keep_path: bool,
    /// True if conjugate points are located: [`Trace::conjugates`]. Steps are then short enough for [`Trace::jacobi`]
    /// to be as accurate as the end.
    pub conjugates: bool,
    /// True if [`Trace::jacobi_knots`] is recorded. Steps are then short enough for it, and for [`Trace::jacobi`].
    pub keep_jacobi: bool,
}

/// The maximum number of evaluations for a geodesic that is traced on its own: a few seconds. For one of many, as in a picture,
/// see [`Options::default`].
pub const MOST_OF_ONE: usize = 10_000_000;

impl Default for Options {
    fn default() -> Self {
        Self {
            tolerance: 1.5e-10,
            method: TraceMethod::Adaptive,
            max_evaluations: 20_000,
            compare: false,
            keep_path: false,
            conjugates: false,
            keep_jacobi: false,
        }
    }
}

/// The end of a geodesic.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// The end point, brought back into the domain where the surface wraps.
    pub uv: Uv,
    /// (u', v') there, at unit speed.
    pub direction: TangentVector,
    /// σ there; `None` on a metric without an embedding.
    pub position: Option<[f64; 3]>,
    /// The arc length reached.
    pub length: f64,
    /// The change of its speed, which is 1 at the start: it is not corrected, so it measures the integration's
    /// accuracy.
    pub speed_drift: f64,
    /// The estimated distance from the true end: by comparison with a more accurate run ([`Options::compare`]), or a bound
    /// from the steps' estimated errors, propagated by the Jacobi fields, which often exceeds the truth tenfold or more.
    pub error_estimate: f64,
    /// Accepted steps.
    pub steps: usize,
    /// Rejected steps.
    pub rejected: usize,
    /// Evaluations of the surface and its derivatives.
    pub evaluations: usize,
    /// The reason why it ended.
    pub status: Status,
    /// True if it has passed an odd number of flips: left and right are then exchanged.
    pub flipped: bool,
    /// The number of creases that it has crossed, where σ is continuous and its derivatives are not. There the components of
    /// the velocity along and across the crease keep their lengths.
    pub creases: usize,
    /// (m, m') at the end: the Jacobi field across the geodesic with m = 0, m' = 1 at its start. A small change dθ of
    /// the direction moves the end by m dθ. It is as accurate as the end if conjugate points are located; otherwise its
    /// error is not controlled.
    pub jacobi: [f64; 2],
    /// The arc lengths of the conjugate points, where m = 0, in ascending order, if the options request them; else empty.
    pub conjugates: Vec<f64>,
    /// (u, v) after each step, beginning with the start, if the options request it; else empty.
    pub path: Vec<Uv>,
    /// The Jacobi field after each step, beginning with the start, if the options request it; else empty.
    pub jacobi_knots: Vec<JacobiKnot>,
}

/// The reason why a geodesic cannot be started.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TraceError {
    /// A coordinate of the start is not a finite number.
    StartNotFinite,
    /// A component of the direction is not a finite number.
    DirectionNotFinite,
    /// The direction is zero.
    ZeroDirection,
    /// The length is negative, or not a finite number.
    BadLength {
        /// The length.
        length: f64,
    },
    /// The tolerance is not a positive number.
    BadTolerance {
        /// The tolerance.
        tolerance: f64,
    },
    /// The start is outside the domain, beyond a side that does not wrap.
    OutsideDomain {
        /// The start.
        at: [f64; 2],
        /// The domain.
        domain: [[f64; 2]; 2],
    },
    /// The surface is undefined at the start.
    UndefinedStart {
        /// The start.
        at: [f64; 2],
    },
    /// σu and σv do not span a tangent plane at the start.
    DegenerateStart {
        /// The start.
        at: [f64; 2],
    },
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::StartNotFinite => f.write_str("the start is not a pair of numbers"),
            Self::DirectionNotFinite => f.write_str("the direction is not a pair of numbers"),
            Self::ZeroDirection => f.write_str("the direction is zero"),
            Self::BadLength { length } => {
                write!(f, "the length {length} is not a number of at least 0")
            }
            Self::BadTolerance { tolerance } => {
                write!(f, "the tolerance {tolerance} is not a positive number")
            }
            Self::OutsideDomain {
                at: [u, v],
                domain: [[u0, u1], [v0, v1]],
            } => write!(
                f,
                "the start ({u}, {v}) lies outside the domain [{u0}, {u1}] × [{v0}, {v1}]"
            ),
            Self::UndefinedStart { at: [u, v] } => {
                write!(f, "the surface is undefined at the start ({u}, {v})")
            }
            Self::DegenerateStart { at: [u, v] } => write!(
                f,
                "the surface has no tangent plane at the start ({u}, {v}): σu and σv are parallel or undefined, or the metric is \
                 not positive definite"
            ),
        }
    }
}

impl std::error::Error for TraceError {}

/// Looser tolerances than this use the cheaper pair.
pub(crate) const LOOSE: f64 = 1e-6;
/// The tightest tolerance: below it, rounding prevents the error control from accepting steps.
pub(crate) const TIGHTEST: f64 = 50.0 * f64::EPSILON;
/// The factor by which a run that serves for comparison is more accurate.
pub(crate) const FINER: f64 = 1000.0;
/// The factor on the estimate of a single run where a comparison was requested but is impossible: such estimates may be too
/// low by almost this factor (`an_estimate_that_cannot_be_checked_is_a_bound`).
const UNCHECKED: f64 = 4.0;
/// A change of the speed beyond this is no error of single steps.
const DRIFTED: f64 = 1e-6;
/// A ray of fewer steps is compared with one in two halves.
const FEW: usize = 15;
/// Two runs of the classical method whose ends are farther apart, in units of the size, have not converged.
const CONVERGED: f64 = 1e-3;
/// σu and σv are parallel if the sine of their angle is below this.
const PARALLEL: f64 = 1e-12;

/// Follows the geodesic from `start` in the direction of `velocity` (of any non-zero length), both in (u,v), for the
/// arc length `length`. At a pole only the direction's component along the meridian counts.
///
/// # Errors
/// [`TraceError`]: invalid numbers, or no tangent plane at the start. Every later failure is a [`Status`].
pub fn trace(
    surface: &dyn Surface,
    start: impl Into<Uv>,
    velocity: impl Into<TangentVector>,
    length: f64,
    options: &Options,
) -> Result<Trace, TraceError> {
    let (Uv(start), TangentVector(velocity)) = (start.into(), velocity.into());
    let atlas = Atlas::new(surface);
    check(length, options)?;
    let (start, moved) = unit_start(&atlas, start, velocity)?;
    let (mut trace, _) = trace_from(&atlas, start.into(), length, options);
    trace.error_estimate += moved;
    Ok(trace)
}

/// Checks that length and tolerance are valid for a trace.
pub(crate) fn check(length: f64, options: &Options) -> Result<(), TraceError> {
    if !(length >= 0.0 && length.is_finite()) {
        return Err(TraceError::BadLength { length });
    }
    let tolerance = options.tolerance;
    if tolerance.is_nan() || tolerance <= 0.0 {
        return Err(TraceError::BadTolerance { tolerance });
    }
    Ok(())
}

/// Follows the geodesic from a start whose numbers have been checked. Besides the trace, returns the chart in which it
/// ended, and the point and velocity there.
pub(crate) fn trace_from(
    atlas: &Atlas<'_>,
    start: Start,
    length: f64,
    options: &Options,
) -> (Trace, (Chart, State)) {
    // Numbers have no digits left for shorter lengths.
    let length = if length < f64::MIN_POSITIVE {
        0.0
    } else {
        length
    };
    let tolerance = options.tolerance;
    let noting = Observed {
        accurate_jacobi: options.conjugates || options.keep_jacobi,
        conjugates: options.conjugates,
        jacobi_knots: options.keep_jacobi,
        ..Observed::default()
    };
    let common = IntegrationPlan {
        tableau: &DOP853,
        tolerance: None,
        step: length,
        limit: options.max_evaluations,
        charts: false,
        keep_path: options.keep_path,
    };
    let end = match options.method {
        TraceMethod::Adaptive => {
            let loose = tolerance >= LOOSE;
            let plan = IntegrationPlan {
                tableau: if loose { &DOPRI5 } else { &DOP853 },
                tolerance: Some(tolerance.max(TIGHTEST)),
                step: first_step(atlas, length),
                charts: true,
                ..common
            };
            let first_evaluation = atlas.evaluations();
            let mut end = integrate::integrate_observed(atlas, start, length, plan, noting);
            let used = atlas.evaluations() - first_evaluation;
            if options.compare
                && let Some(error) = compared(atlas, start, length, &plan, &end, used)
            {
                end.error = error;
            }
            end
        }
        TraceMethod::Rk4 { steps } => {
            let step = length / f64::from(steps.max(1));
            let plan = IntegrationPlan {
                tableau: &RK4,
                step,
                // The run with half the steps costs half as much.
                limit: options.max_evaluations / 3 * 2,
                ..common
            };
            let mut fine = integrate::integrate_observed(atlas, start, length, plan, noting);
            // A single step is compared with two halves of it.
            let is_single = fine.steps < 2;
            let other = IntegrationPlan {
                step: if is_single {
                    0.5 * fine.length
                } else {
                    2.0 * step
                },
                limit: options.max_evaluations,
                keep_path: false,
                ..plan
            };
            // Where the first run ended early, the second one is compared with it there.
            let other = integrate::integrate(atlas, start, fine.length, other);
            let gap = atlas.gap(fine.state.at, other.state.at);
            // Of fourth order: the coarse run's error is sixteen times the fine one's (Richardson extrapolation), once steps
            // are short enough for the order to show.
            let size = atlas.layout.scale.size.min(length);
            fine.error = if is_single || gap > CONVERGED * size {
                gap
            } else {
                gap / 15.0
            };
            fine
        }
    };
    let inside = end.inside;
    (finish(atlas, end), inside)
}

/// Estimates the error of a ray's end by integrating it again with a fraction of the tolerance; a bound where that
/// cannot be afforded; `None` where it ends for another reason.
fn compared(
    atlas: &Atlas<'_>,
    start: Start,
    length: f64,
    plan: &IntegrationPlan,
    end: &RayEnd,
    used: usize,
) -> Option<f64> {
    let tolerance = plan.tolerance? / FINER;
    if tolerance < TIGHTEST {
        return None;
    }
    let left = plan.limit.saturating_sub(atlas.evaluations());
    // What the steps' estimates leave out: an error of the speed grows over the whole length.
    let unchecked = UNCHECKED * end.error + end.speed_drift.abs() * end.length;
    if end.status == Status::WorkLimit || left < 2 * used {
        return Some(unchecked);
    }
    let whole = IntegrationPlan {
        tableau: &DOP853,
        tolerance: Some(tolerance),
        keep_path: false,
        ..*plan
    };
    let mut finer = integrate::integrate(atlas, start, length, whole);
    if finer.status == Status::Complete && (end.steps < FEW || 3 * finer.steps < 5 * end.steps) {
        // Few steps, or steps that are hardly shorter than before, reveal little new.
        let half = IntegrationPlan {
            step: whole.step.min(0.25 * length),
            ..whole
        };
        let first = integrate::integrate(atlas, start, 0.5 * length, half);
        if first.status == Status::Complete {
            let start = match first.inside {
                (Chart::Plain, state) => Start::Plain(state),
                (Chart::Apex(chart), state) => Start::About(chart, state),
            };
            finer = integrate::integrate(atlas, start, 0.5 * length, half);
        }
    }
    if finer.status == Status::WorkLimit {
        return Some(unchecked);
    }
    if finer.status != end.status {
        return None;
    }
    let mut gap = atlas.gap(end.state.at, finer.state.at);
    if end.status != Status::Complete {
        // At an edge or a tip both end at the same point: an error along the ray is a difference of their lengths.
        gap += (end.length - finer.length).abs();
    }
    // Rounding, which affects both runs independently.
    let rounding = 32.0 * f64::EPSILON * (atlas.layout.scale.size + length);
    // A geodesic's speed is constant. Where it is not, both runs have the same error.
    let drift = end.speed_drift.abs();
    let shared = if drift > DRIFTED {
        drift * end.length
    } else {
        0.0
    };
    Some((gap + rounding).max(shared))
}

/// Returns a first step that is certainly short enough for its error to be judged.
pub(crate) fn first_step(atlas: &Atlas<'_>, length: f64) -> f64 {
    length.min(0.04 * atlas.layout.scale.size)
}

/// Returns the start brought back into the domain, at unit speed, and the distance by which it was moved off a pole
/// or a crease.
pub(crate) fn unit_start(
    atlas: &Atlas<'_>,
    start: [f64; 2],
    velocity: [f64; 2],
) -> Result<(State, f64), TraceError> {
    if !start.iter().all(|x| x.is_finite()) {
        return Err(TraceError::StartNotFinite);
    }
    let velocity = as_direction(velocity)?;
    let mut at = place(atlas, start)?;
    let signs = atlas.layout.bring_back(&mut at).signs;
    let given = at;
    at = atlas.off_crease(atlas.layout.off_pole(at), velocity);
    let jet = atlas.jet(at);
    if !jet.position.iter().all(|x| x.is_finite()) {
        return Err(TraceError::UndefinedStart { at: start });
    }
    let velocity = [0, 1].map(|k| signs[k] * velocity[k]);
    let speed = speed(&jet, velocity);
    let sine = norm(cross(jet.du, jet.dv)) / (norm(jet.du) * norm(jet.dv));
    let at_apex = (0..2).any(|axis| {
        (0..2).any(|end| {
            at[axis] == atlas.layout.domain[axis][end]
                && atlas.layout.apexes[axis][end].is_some_and(|apex| apex.regular)
        })
    });
    let usable = at_apex || sine > PARALLEL;
    let is_speed = speed > 0.0 && speed.is_finite();
    if !is_speed || !usable {
        return Err(TraceError::DegenerateStart { at: start });
    }
    let moved = if at == given {
        0.0
    } else {
        crate::metric::speed(&jet, [0, 1].map(|k| at[k] - given[k]))
    };
    let velocity = velocity.map(|x| x / speed);
    Ok((State { at, velocity }, moved))
}

/// Returns a velocity of any magnitude divided by its largest component.
pub(crate) fn as_direction(velocity: [f64; 2]) -> Result<[f64; 2], TraceError> {
    if !velocity.iter().all(|x| x.is_finite()) {
        return Err(TraceError::DirectionNotFinite);
    }
    let largest = velocity[0].abs().max(velocity[1].abs());
    if largest == 0.0 {
        return Err(TraceError::ZeroDirection);
    }
    Ok(velocity.map(|x| x / largest))
}

/// Returns the start, which may be beyond sides that wrap, but not beyond others (up to rounding).
fn place(atlas: &Atlas<'_>, start: [f64; 2]) -> Result<[f64; 2], TraceError> {
    let mut at = start;
    for (axis, x) in at.iter_mut().enumerate() {
        let [low, high] = atlas.layout.domain[axis];
        let slack = 1e-12 * (high - low);
        let wraps = matches!(atlas.layout.sides.of(axis)[0], Side::Wrap | Side::WrapFlip);
        if !wraps {
            if *x < low - slack || *x > high + slack {
                return Err(TraceError::OutsideDomain {
                    at: start,
                    domain: atlas.layout.domain,
                });
            }
            *x = x.clamp(low, high);
        }
    }
    Ok(at)
}

fn finish(atlas: &Atlas<'_>, end: RayEnd) -> Trace {
    let State { at, velocity } = end.state;
    let position = atlas.embedded.then(|| atlas.jet(at).position);
    Trace {
        uv: Uv(at),
        direction: TangentVector(velocity),
        position,
        length: end.length,
        speed_drift: end.speed_drift,
        error_estimate: end.error,
        steps: end.steps,
        rejected: end.rejected,
        evaluations: atlas.evaluations(),
        status: end.status,
        flipped: end.flipped,
        creases: end.creases,
        jacobi: [end.field, end.field_rate],
        conjugates: end.conjugates,
        path: end.path.into_iter().map(Uv).collect(),
        jacobi_knots: end.jacobi_knots,
    }
}
