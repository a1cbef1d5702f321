//! Rays from one point by their angle. In: a surface and a point. Out: ends with their Jacobi fields.

use std::f64::consts::TAU;

use super::MeasureError;
use crate::chart::{Atlas, Chart, State};
use crate::ends::Coordinates;
use crate::frame::Frame;
use crate::metric::Metric;
use crate::point::{PicturePoint, TangentVector, Uv};
use crate::status::Status;
use crate::surface::Surface;
use crate::trace::{self, Options, Trace};
use crate::vector::norm;

/// A point from which rays start.
#[derive(Clone, Copy)]
pub(super) struct RaySource<'s> {
    pub(super) surface: &'s dyn Surface,
    origin: Origin,
}

#[derive(Clone, Copy)]
enum Origin {
    /// A point with a tangent plane. The angle is measured from X towards Y of a frame whose X is along σu.
    Frame(Frame),
    /// The tip of a cone. The angle is that of the unrolled cone, measured from the meridian at the parameter's
    /// minimum.
    Tip { axis: usize, end: usize, rate: f64 },
}

/// The end of one ray.
#[derive(Clone, Debug)]
pub(super) struct Arrival {
    pub(super) at: Uv,
    /// The unit tangent.
    pub(super) along: TangentVector,
    /// The unit normal, towards which the end moves as the angle grows where m > 0.
    pub(super) left: TangentVector,
    /// The Jacobi field.
    pub(super) m: f64,
    /// The arc length reached.
    pub(super) length: f64,
    pub(super) status: Status,
}

/// The tolerances of a ray that is integrated on its own: where rounding prevents the first, the second suffices.
const TOLERANCES: [f64; 2] = [1e-12, 1e-9];

impl<'s> RaySource<'s> {
    /// Creates a source at a point with a tangent plane.
    pub(super) fn at(surface: &'s dyn Surface, uv: Uv) -> Result<Self, MeasureError> {
        let frame = Frame::new(surface, uv, 0.0, 1.0)?;
        Ok(Self {
            surface,
            origin: Origin::Frame(frame),
        })
    }

    /// Creates a source at the tip of a cone; `None` unless there is one whose angle grows evenly with the other
    /// parameter.
    pub(super) fn tip(surface: &'s dyn Surface, axis: usize, end: usize) -> Option<Self> {
        let apex = surface.apex(axis, end)?;
        (apex.regular && !apex.smooth).then_some(Self {
            surface,
            origin: Origin::Tip {
                axis,
                end,
                rate: apex.rate,
            },
        })
    }

    /// Returns the frame from whose X the angles are measured; `None` at the tip of a cone.
    pub(super) fn frame(&self) -> Option<&Frame> {
        match &self.origin {
            Origin::Frame(frame) => Some(frame),
            Origin::Tip { .. } => None,
        }
    }

    /// Returns the direction of a ray in (u,v), at unit speed.
    pub(super) fn direction(&self, angle: f64) -> TangentVector {
        let (sin, cos) = angle.sin_cos();
        match &self.origin {
            Origin::Frame(frame) => {
                let frame = frame.turned(angle).plain(self.surface);
                frame.x
            }
            Origin::Tip { .. } => TangentVector([cos, sin]),
        }
    }

    /// Returns the angle of a tangent vector at the source, given in (u,v) at a point that equals the source up to
    /// rounding; `None` at the tip of a cone.
    pub(super) fn angle_of(&self, at: Uv, vector: TangentVector) -> Option<f64> {
        let frame = self.frame()?;
        let vector = match frame.coordinates {
            Coordinates::Plain => vector,
            coordinates @ Coordinates::Apex { .. } => {
                let atlas = Atlas::new(self.surface);
                let pole = atlas.layout.pole_chart(coordinates)?;
                let Chart::Apex(own) = atlas.chart_for(at.0) else {
                    return None;
                };
                let state = State {
                    at: at.0,
                    velocity: vector.0,
                };
                let (state, _) = atlas.enter(&own, state)?;
                TangentVector(pole.vector_of(&own, state.velocity))
            }
        };
        let metric = frame.metric(self.surface);
        let [x, y] = [frame.x, frame.y].map(|axis| metric.inner(vector, axis));
        Some(y.atan2(x))
    }

    /// Returns the angle of a full turn: less than 2π about the tip of most cones.
    pub(super) fn turn(&self) -> f64 {
        match &self.origin {
            Origin::Frame(_) => TAU,
            Origin::Tip { axis, rate, .. } => {
                let [low, high] = self.surface.domain()[1 - axis];
                (rate * (high - low)).abs()
            }
        }
    }

    /// Returns the angle of the ray from the tip of a cone towards a nearby point.
    pub(super) fn angle_towards(&self, at: Uv) -> Option<f64> {
        match &self.origin {
            Origin::Frame(_) => None,
            Origin::Tip { axis, rate, .. } => {
                let low = self.surface.domain()[1 - axis][0];
                Some(rate * (at[1 - axis] - low))
            }
        }
    }

    /// Returns the point from which a ray starts: at a pole a point on the meridian along which it runs.
    pub(super) fn start(&self, angle: f64) -> Uv {
        match &self.origin {
            Origin::Frame(frame) => frame.turned(angle).plain(self.surface).uv,
            Origin::Tip { axis, end, rate } => self.on_tip(*axis, *end, *rate, angle),
        }
    }

    /// Returns the start and the direction of a ray without rounding noise: negligible components are zero, and a point
    /// next to a pole is on it.
    pub(super) fn tidy_start(&self, angle: f64) -> [[f64; 2]; 2] {
        const NOISE: f64 = 1e-14;
        let (Uv(mut from), TangentVector(mut direction)) =
            (self.start(angle), self.direction(angle));
        let jet = self.surface.jet(Uv(from));
        for (component, tangent) in direction.iter_mut().zip([jet.du, jet.dv]) {
            if component.abs() * norm(tangent) <= NOISE {
                *component = 0.0;
            }
        }
        if let Some(frame) = self.frame()
            && let Coordinates::Apex { axis, end } = frame.coordinates
        {
            let [axis, end] = [axis, end].map(usize::from);
            let atlas = Atlas::new(self.surface);
            let pole = self.surface.domain()[axis][end];
            let given = atlas.layout.pole_chart(frame.coordinates);
            let is_at = given.is_some_and(|pole| {
                let [a, b] = pole.point(frame.uv.0);
                a.hypot(b) < pole.nearest()
            });
            if is_at {
                from[axis] = pole;
                // It leaves along the meridian.
                direction[1 - axis] = 0.0;
            }
        }
        [from, direction]
    }

    fn on_tip(&self, axis: usize, end: usize, rate: f64, angle: f64) -> Uv {
        let domain = self.surface.domain();
        let mut at = [0.0; 2];
        at[axis] = domain[axis][end];
        at[1 - axis] = domain[1 - axis][0] + angle / rate;
        self.surface.sides().bring_back(domain, &mut at);
        Uv(at)
    }

    /// Follows the ray at an angle for an arc length.
    pub(super) fn follow(
        &self,
        angle: f64,
        length: f64,
        keep_jacobi: bool,
    ) -> Result<(Arrival, Trace), MeasureError> {
        let [exact, loose] = TOLERANCES;
        let found = self.follow_with(angle, length, keep_jacobi, exact)?;
        // A ray that starts at a tip and does not leave it is a rounding artefact.
        let is_stuck = matches!(self.origin, Origin::Tip { .. }) && found.1.length == 0.0;
        match found.0.status {
            Status::ConePoint if is_stuck => self.follow_with(angle, length, keep_jacobi, loose),
            Status::Complete | Status::LeftDomain | Status::ConePoint => Ok(found),
            Status::Degenerate | Status::Undefined | Status::WorkLimit => {
                self.follow_with(angle, length, keep_jacobi, loose)
            }
        }
    }

    fn follow_with(
        &self,
        angle: f64,
        length: f64,
        keep_jacobi: bool,
        tolerance: f64,
    ) -> Result<(Arrival, Trace), MeasureError> {
        let options = Options {
            tolerance,
            keep_jacobi,
            conjugates: true,
            ..Options::default()
        };
        let (trace, hand) = match &self.origin {
            Origin::Frame(frame) => {
                let (sin, cos) = angle.sin_cos();
                let place = PicturePoint([cos, sin]);
                (frame.trace(self.surface, place, length, &options)?, 1.0)
            }
            Origin::Tip { axis, end, rate } => {
                let from = self.on_tip(*axis, *end, *rate, angle);
                let mut velocity = [0.0; 2];
                velocity[*axis] = if *end == 0 { 1.0 } else { -1.0 };
                // (Distance and angle have the handedness of (a, b); the distance is u or v.)
                let order = if *axis == 0 { 1.0 } else { -1.0 };
                let hand = velocity[*axis] * order * rate.signum();
                let trace = trace::trace(self.surface, from, velocity, length, &options)?;
                (trace, hand)
            }
        };
        let side = if trace.flipped { -hand } else { hand };
        let metric = Metric::of(&self.surface.jet(trace.uv));
        let left = metric.turn_left(trace.direction).map(|x| side * x);
        let arrival = Arrival {
            at: trace.uv,
            along: trace.direction,
            left,
            m: trace.jacobi[0],
            length: trace.length,
            status: trace.status,
        };
        Ok((arrival, trace))
    }
}
