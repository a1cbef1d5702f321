//! One geodesic on a surface in space, integrated adaptively in f64.

use std::fmt;
use std::sync::Arc;

use super::ray::{self, SpacePlan, SpaceRayEnd, SpaceState};
use super::{FieldPiece, ImplicitSurface, PlaceError};
use crate::fan::ray::Ray;
use crate::jacobi::JacobiKnot;
use crate::runge_kutta::{DOP853, DOPRI5};
use crate::status::Status;
use crate::trace::{FINER, LOOSE, Options, TIGHTEST};
use crate::vector::{combine, norm};

/// The end of a geodesic in space.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceTrace {
    /// Its start, on the surface.
    pub start: [f64; 3],
    /// The end point.
    pub position: [f64; 3],
    /// The unit tangent there.
    pub direction: [f64; 3],
    /// The arc length reached.
    pub length: f64,
    /// The change of its speed over all steps, before each correction.
    pub speed_drift: f64,
    /// The estimated distance from the true end; see [`Trace::error_estimate`](crate::trace::Trace::error_estimate).
    pub error_estimate: f64,
    /// Accepted steps.
    pub steps: usize,
    /// Rejected steps.
    pub rejected: usize,
    /// Evaluations of the field and its derivatives.
    pub evaluations: usize,
    /// The reason why it ended.
    pub status: Status,
    /// (m, m') at the end: the Jacobi field across the geodesic with m = 0, m' = 1 at its start.
    pub jacobi: [f64; 2],
    /// The arc lengths of the conjugate points, where m = 0, in ascending order, if the options request them; else empty.
    pub conjugates: Vec<f64>,
    /// The Jacobi field after each step, beginning with the start, if requested; else empty.
    pub jacobi_knots: Vec<JacobiKnot>,
}

/// A geodesic on a surface in space at several arc lengths.
#[derive(Clone, Debug)]
pub struct SpacePoints {
    /// Its points; for a geodesic that ends early those that it reached, then its end.
    pub points: Vec<[f64; 3]>,
    /// Evaluations of the field and its derivatives.
    pub evaluations: usize,
    /// The reason why it ended.
    pub status: Status,
}

/// The reason why a geodesic in space cannot be started.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpaceTraceError {
    /// The start could not be moved onto the surface.
    Place {
        /// The start.
        at: [f64; 3],
        /// The reason.
        why: PlaceError,
    },
    /// A component of the direction is not a finite number.
    DirectionNotFinite,
    /// The direction is zero.
    ZeroDirection,
    /// The direction is the surface's normal: it has no component in the tangent plane.
    NormalDirection,
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
    /// The derivatives of the field exceed the limit for expressions.
    TooLarge,
}

/// A direction whose tangential component is below this fraction of its length counts as normal.
const NORMAL: f64 = 1e-12;
/// The first step as a fraction of the ray's scale.
const FIRST: f64 = 0.04;

impl fmt::Display for SpaceTraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Place { at: [x, y, z], why } => {
                write!(
                    f,
                    "the start ({x}, {y}, {z}) cannot be projected onto the surface: {why}"
                )
            }
            Self::DirectionNotFinite => f.write_str("the direction is not three numbers"),
            Self::ZeroDirection => f.write_str("the direction is zero"),
            Self::NormalDirection => f.write_str("the direction is normal to the surface"),
            Self::BadLength { length } => {
                write!(f, "the length {length} is not a number of at least 0")
            }
            Self::BadTolerance { tolerance } => {
                write!(f, "the tolerance {tolerance} is not a positive number")
            }
            Self::TooLarge => f.write_str("the derivatives of the solid are too large"),
        }
    }
}

impl std::error::Error for SpaceTraceError {}

impl ImplicitSurface {
    /// Returns the start of a geodesic: the point moved onto the surface, and the direction's unit vector in its tangent
    /// plane.
    ///
    /// # Errors
    /// [`SpaceTraceError`].
    pub fn start(
        &self,
        near: [f64; 3],
        direction: [f64; 3],
    ) -> Result<([f64; 3], [f64; 3]), SpaceTraceError> {
        let largest = direction.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        if direction.iter().any(|x| !x.is_finite()) {
            return Err(SpaceTraceError::DirectionNotFinite);
        }
        if largest == 0.0 {
            return Err(SpaceTraceError::ZeroDirection);
        }
        let failed = |why| SpaceTraceError::Place { at: near, why };
        let at = self.place(near).map_err(failed)?;
        let piece = self.piece_at(at).map_err(|_| SpaceTraceError::TooLarge)?;
        let shape = piece.shape(at).ok_or(failed(PlaceError::NoGradient))?;
        let direction = direction.map(|x| x / largest);
        let tangential = shape.tangential(direction);
        let length = norm(tangential);
        if length <= NORMAL * norm(direction) {
            return Err(SpaceTraceError::NormalDirection);
        }
        // Repeat the projection: a nearly normal direction has lost digits.
        let unit = shape.tangential(tangential.map(|x| x / length));
        let length = norm(unit);
        Ok((at, unit.map(|x| x / length)))
    }

    /// Follows the geodesic from a point, which is moved onto the surface, in a direction, which is projected onto the tangent
    /// plane, for the arc length `length`. The options' method and path are ignored: the steps are adaptive.
    ///
    /// # Errors
    /// [`SpaceTraceError`]: invalid numbers, or no surface near the start. Every later failure is a [`Status`].
    pub fn trace(
        &self,
        near: [f64; 3],
        direction: [f64; 3],
        length: f64,
        options: &Options,
    ) -> Result<SpaceTrace, SpaceTraceError> {
        let tolerance = options.tolerance;
        let (piece, start) = self.begin(near, direction, length, tolerance)?;
        let accurate_jacobi = options.conjugates || options.keep_jacobi;
        let plan = SpacePlan {
            tableau: if tolerance >= LOOSE { &DOPRI5 } else { &DOP853 },
            tolerance: tolerance.max(TIGHTEST),
            step: self.first_step(start.at, length),
            limit: options.max_evaluations,
            accurate_jacobi,
            conjugates: options.conjugates,
            jacobi_knots: options.keep_jacobi,
            knots: false,
            beyond: false,
        };
        let mut end = ray::integrate(self, &piece, start, length, plan);
        if options.compare
            && let Some((error, evaluations)) = self.compared(&piece, start, length, &plan, &end)
        {
            end.error = error;
            end.evaluations += evaluations;
        }
        Ok(SpaceTrace {
            start: start.at,
            position: end.state.at,
            direction: end.state.velocity,
            length: end.length,
            speed_drift: end.speed_drift,
            error_estimate: end.error,
            steps: end.steps,
            rejected: end.rejected,
            evaluations: end.evaluations,
            status: end.status,
            jacobi: end.field,
            conjugates: end.conjugates,
            jacobi_knots: end.jacobi_knots,
        })
    }

    /// Returns the start of a geodesic of a given length, and the piece of the field on which it starts.
    fn begin(
        &self,
        near: [f64; 3],
        direction: [f64; 3],
        length: f64,
        tolerance: f64,
    ) -> Result<(Arc<FieldPiece>, SpaceState), SpaceTraceError> {
        if !(length >= 0.0 && length.is_finite()) {
            return Err(SpaceTraceError::BadLength { length });
        }
        if tolerance.is_nan() || tolerance <= 0.0 {
            return Err(SpaceTraceError::BadTolerance { tolerance });
        }
        let (at, velocity) = self.start(near, direction)?;
        let piece = self.piece_at(at).map_err(|_| SpaceTraceError::TooLarge)?;
        Ok((piece, SpaceState { at, velocity }))
    }

    /// Follows the geodesic once, as [`Self::trace`] does, through ascending arc lengths of at least 0. Between two steps it is
    /// interpolated by the polynomial of degree five through their ends, velocities and accelerations. The method of order five
    /// takes such short steps that this is as accurate as they are.
    ///
    /// # Errors
    /// [`SpaceTraceError`].
    pub fn trace_points(
        &self,
        near: [f64; 3],
        direction: [f64; 3],
        lengths: &[f64],
        options: &Options,
    ) -> Result<SpacePoints, SpaceTraceError> {
        let length = lengths.last().copied().unwrap_or(0.0);
        let tolerance = options.tolerance;
        let (piece, start) = self.begin(near, direction, length, tolerance)?;
        let plan = SpacePlan {
            tableau: &DOPRI5,
            tolerance: tolerance.max(TIGHTEST),
            step: self.first_step(start.at, length),
            limit: options.max_evaluations,
            accurate_jacobi: false,
            conjugates: false,
            jacobi_knots: false,
            knots: true,
            beyond: false,
        };
        let end = ray::integrate(self, &piece, start, length, plan);
        let ray = Ray::new(0.0, &[end.segment], None);
        let is_complete = end.status == Status::Complete;
        let reached = lengths
            .iter()
            .take_while(|s| is_complete || **s < end.length);
        let mut points: Vec<[f64; 3]> = reached
            .map(|s| ray.at(*s).map_or(start.at, |sample| sample.at))
            .collect();
        if !is_complete {
            points.push(end.state.at);
        }
        Ok(SpacePoints {
            points,
            evaluations: end.evaluations,
            status: end.status,
        })
    }

    /// Returns a first step that is certainly short enough for its error to be judged.
    pub(super) fn first_step(&self, at: [f64; 3], length: f64) -> f64 {
        let shape = self.piece_at(at).ok().and_then(|piece| piece.shape(at));
        let radius = shape.map_or(f64::INFINITY, |shape| shape.radius());
        length.min(FIRST * self.size().min(radius))
    }

    /// Estimates the error of a ray's end by integrating it again with a fraction of the tolerance; also returns the
    /// evaluations used. `None` if it cannot be afforded, or ends for another reason.
    fn compared(
        &self,
        piece: &FieldPiece,
        start: SpaceState,
        length: f64,
        plan: &SpacePlan,
        end: &SpaceRayEnd,
    ) -> Option<(f64, usize)> {
        let tolerance = plan.tolerance / FINER;
        let left = plan.limit.saturating_sub(end.evaluations);
        if tolerance < TIGHTEST || left < 2 * end.evaluations || end.status == Status::WorkLimit {
            return None;
        }
        let finer = SpacePlan {
            tableau: &DOP853,
            tolerance,
            step: 0.3 * plan.step,
            limit: left,
            accurate_jacobi: false,
            conjugates: false,
            jacobi_knots: false,
            ..*plan
        };
        let finer = ray::integrate(self, piece, start, length, finer);
        if finer.status != end.status {
            return None;
        }
        let gap = norm(combine(1.0, end.state.at, -1.0, finer.state.at));
        let rounding = 32.0 * f64::EPSILON * (norm(end.state.at) + length);
        Some((gap + rounding, finer.evaluations))
    }
}
