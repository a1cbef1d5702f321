//! The camera of the geodesic view: a point with two tangent vectors, moved by parallel transport.
//!
//! In: a point, an angle, a zoom; then steps in the picture's own directions. Out: frames, and the geodesics that start
//! there. At a smooth pole (u,v) has no directions: there a frame holds its vectors in the coordinates about the pole.
//! Frames move through poles as anywhere else.

use crate::chart::{ApexChart, Atlas, Chart, State};
use crate::ends::Coordinates;
use crate::integrate::Start;
use crate::metric::Metric;
use crate::point::{PicturePoint, TangentVector, Uv};
use crate::surface::{Jet, Surface};
use crate::trace::{self, Options, Trace, TraceError};
use crate::vector::{combine, norm};

/// A point of the chart with two tangent vectors X ⟂ Y of equal length. Pixel (x, y) ∈ [−1,1]² looks along xX + yY.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The point, in (u,v).
    pub uv: Uv,
    /// The coordinates of the components of X and Y: (u,v), or, at a smooth pole and so near to it that (u,v) does not
    /// distinguish directions, the coordinates (a,b) about it.
    pub coordinates: Coordinates,
    /// X in these coordinates.
    pub x: TangentVector,
    /// Y in these coordinates.
    pub y: TangentVector,
}

impl Frame {
    /// Creates the frame with X along σu turned by `angle` radians towards σv, Y = X turned by +90°, both of length
    /// `zoom`.
    ///
    /// At a smooth pole, where σu or σv is zero, X points along the a-axis of [`Coordinates::Apex`], whatever the value
    /// of the other parameter: away from the pole along the meridian at that parameter's minimum. It is turned in the
    /// sense in which σu turns towards σv all around the pole.
    ///
    /// # Errors
    /// [`TraceError`] where the surface has no tangent plane, or a number is not finite.
    pub fn new(
        surface: &dyn Surface,
        uv: impl Into<Uv>,
        angle: f64,
        zoom: f64,
    ) -> Result<Self, TraceError> {
        if !(angle.is_finite() && zoom.is_finite()) {
            return Err(TraceError::DirectionNotFinite);
        }
        Self::at(
            &Atlas::new(surface),
            uv.into(),
            angle,
            zoom,
            Meridian::First,
        )
    }

    fn at(
        atlas: &Atlas<'_>,
        Uv(uv): Uv,
        angle: f64,
        zoom: f64,
        meridian: Meridian,
    ) -> Result<Self, TraceError> {
        let (start, _) = trace::unit_start(atlas, uv, [1.0, 0.0])?;
        let mut frame = Self {
            uv: Uv(start.at),
            coordinates: Coordinates::Plain,
            x: TangentVector([1.0, 0.0]),
            y: TangentVector([0.0, 1.0]),
        };
        if let Some(chart) = atlas.layout.pole_near(start.at) {
            frame.coordinates = chart.coordinates();
            frame.x = TangentVector(along_u(chart, start.at));
            if chart.is_at(start.at) {
                frame.uv[chart.axis] = chart.base;
                if meridian == Meridian::First {
                    frame.x = TangentVector([1.0, 0.0]);
                }
            }
        }
        let metric = frame.metric_in(atlas);
        if metric.r.is_nan() || metric.r <= 0.0 {
            return Err(TraceError::DegenerateStart { at: uv });
        }
        let hand = frame.handedness(atlas);
        let length = metric.inner(frame.x, frame.x).sqrt();
        let unit = frame.x.map(|a| a / length);
        frame.x = metric.turn(unit, hand * angle).map(|a| a * zoom);
        frame.y = metric.turn_left(frame.x).map(|a| hand * a);
        Ok(frame)
    }

    /// Returns the velocity of a pixel's geodesic: xX + yY, in the frame's coordinates.
    pub fn velocity(&self, place: impl Into<PicturePoint>) -> TangentVector {
        let PicturePoint([x, y]) = place.into();
        x * self.x + y * self.y
    }

    /// Returns the length of X: the distance on the surface from the picture's centre to its edge.
    pub fn zoom(&self, surface: &dyn Surface) -> f64 {
        let [t, w] = self.tangents(&Atlas::new(surface));
        norm(combine(self.x[0], t, self.x[1], w))
    }

    /// Returns the angle for which [`Frame::new`] at this point yields this X, in radians, from −π to π; NaN where the
    /// surface has no tangent plane.
    pub fn angle(&self, surface: &dyn Surface) -> f64 {
        let Ok(first) = Self::new(surface, self.uv, 0.0, 1.0) else {
            return f64::NAN;
        };
        let [first, own] = match first.coordinates == self.coordinates {
            true => [first, *self],
            false => [first.plain(surface), self.plain(surface)],
        };
        let metric = first.metric(surface);
        metric
            .inner(own.x, first.y)
            .atan2(metric.inner(own.x, first.x))
    }

    /// Returns the first fundamental form at the frame's point, in its coordinates.
    pub fn metric(&self, surface: &dyn Surface) -> Metric {
        self.metric_in(&Atlas::new(surface))
    }

    /// Returns whether Y is to the right of X in (u,v): after an odd number of flips.
    pub fn is_mirrored(&self, surface: &dyn Surface) -> bool {
        self.orientation(&Atlas::new(surface)) < 0.0
    }

    /// Returns the frame with X and Y turned by `angle` radians.
    pub fn turned(&self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self {
            x: cos * self.x + sin * self.y,
            y: cos * self.y - sin * self.x,
            ..*self
        }
    }

    /// Returns the frame with X and Y scaled by `factor`.
    pub fn zoomed(&self, factor: f64) -> Self {
        Self {
            x: self.x.map(|a| a * factor),
            y: self.y.map(|a| a * factor),
            ..*self
        }
    }

    /// Returns the frame at the nearest point of the surface's domain: rounding, or a change of surface, may have left
    /// it outside.
    pub fn within_domain(&self, surface: &dyn Surface) -> Self {
        let mut frame = *self;
        for (at, [low, high]) in frame.uv.0.iter_mut().zip(surface.domain()) {
            *at = at.clamp(low, high);
        }
        frame
    }

    /// Returns the frame in (u,v), for callers without other coordinates. At a pole it is moved off along X by the
    /// smallest distance that distinguishes the meridians; its vectors are very long there.
    pub fn plain(&self, surface: &dyn Surface) -> Self {
        let atlas = Atlas::new(surface);
        let Some(chart) = self.chart(&atlas) else {
            return *self;
        };
        let mut at = chart.point(self.uv.0);
        if at[0].hypot(at[1]) < chart.nearest() {
            let length = self.x[0].hypot(self.x[1]);
            at = self.x.0.map(|x| x / length * chart.nearest());
        }
        // Match the directions in space: the parameter's rounding at the pole distorts (u,v) there.
        let tangents = self.tangents(&atlas);
        let [mut x, mut y] = [self.x, self.y].map(|TangentVector(velocity)| {
            let state = State { at, velocity };
            atlas.leave(&chart, state, tangents).velocity
        });
        let mut uv = chart.plain_point(at);
        let signs = atlas.layout.bring_back(&mut uv).signs;
        for k in 0..2 {
            x[k] *= signs[k];
            y[k] *= signs[k];
        }
        Self {
            uv: Uv(uv),
            coordinates: Coordinates::Plain,
            x: TangentVector(x),
            y: TangentVector(y),
        }
    }

    /// Follows the geodesic that starts here along xX + yY, `direction` = (x, y), for the arc length `length`.
    ///
    /// # Errors
    /// As [`trace::trace`].
    pub fn trace(
        &self,
        surface: &dyn Surface,
        direction: impl Into<PicturePoint>,
        length: f64,
        options: &Options,
    ) -> Result<Trace, TraceError> {
        trace::check(length, options)?;
        let atlas = Atlas::new(surface);
        let start = self.start(&atlas, direction.into())?;
        Ok(trace::trace_from(&atlas, start, length, options).0)
    }

    /// Moves by `step` (x, y), in units of the frame: along the geodesic with the velocity xX + yY, along which X and Y
    /// are parallel transported. The trace reports whether the step was completed; the frame is at the trace's end.
    /// Through a flip, X and Y change their handedness.
    ///
    /// # Errors
    /// [`TraceError`] where the geodesic cannot be started, or the surface has no tangent plane at its end.
    pub fn advance(
        &self,
        surface: &dyn Surface,
        step: impl Into<PicturePoint>,
        options: &Options,
    ) -> Result<(Self, Trace), TraceError> {
        let step = step.into();
        let atlas = Atlas::new(surface);
        let zoom = self.zoom(surface);
        let share = step[0].hypot(step[1]);
        let length = share * zoom;
        trace::check(length, options)?;
        if share == 0.0 {
            let start = self.start(&atlas, PicturePoint([1.0, 0.0]))?;
            return Ok((*self, trace::trace_from(&atlas, start, 0.0, options).0));
        }
        let start = self.start(&atlas, step)?;
        let (trace, inside) = trace::trace_from(&atlas, start, length, options);
        let mut frame = Self {
            uv: trace.uv,
            coordinates: Coordinates::Plain,
            x: trace.direction,
            y: trace.direction,
        };
        if let (Chart::Apex(chart), State { at, velocity }) = inside
            && chart.is_inner(at)
        {
            frame.coordinates = chart.coordinates();
            if let Some(pole) = frame.chart(&atlas) {
                frame.x = TangentVector(pole.vector_of(&chart, velocity));
                if at[0].hypot(at[1]) <= chart.nearest() {
                    frame.uv[chart.axis] = chart.base;
                }
            }
        }
        // A mirrored camera has Y to the right of X, before and after.
        let mirrored = self.orientation(&atlas) < 0.0;
        let metric = frame.metric_in(&atlas);
        let hand = frame.handedness(&atlas) * if trace.flipped != mirrored { -1.0 } else { 1.0 };
        let along = frame.x.map(|a| a * zoom);
        let left = metric.turn_left(along).map(|a| hand * a);
        if !left.is_finite() {
            return Err(TraceError::DegenerateStart { at: trace.uv.0 });
        }
        // In the plane of the frame, the geodesic's direction is (cos, sin).
        let PicturePoint([cos, sin]) = step.map(|a| a / share);
        frame.x = cos * along - sin * left;
        frame.y = sin * along + cos * left;
        Ok((frame, trace))
    }

    /// Returns the start, at unit speed, of the geodesic of a point (x, y) of the picture.
    pub(crate) fn start(
        &self,
        atlas: &Atlas<'_>,
        place: PicturePoint,
    ) -> Result<Start, TraceError> {
        let TangentVector(velocity) = self.velocity(place);
        let Some(chart) = self.chart(atlas) else {
            return Ok(trace::unit_start(atlas, self.uv.0, velocity)?.0.into());
        };
        let velocity = trace::as_direction(velocity)?;
        let [t, w] = self.tangents(atlas);
        let speed = norm(combine(velocity[0], t, velocity[1], w));
        if !(speed > 0.0 && speed.is_finite()) {
            return Err(TraceError::UndefinedStart { at: self.uv.0 });
        }
        let state = State {
            at: chart.point(self.uv.0),
            velocity: velocity.map(|x| x / speed),
        };
        Ok(Start::About(chart, state))
    }

    /// Returns the chart about the pole at or near which the frame is.
    fn chart(&self, atlas: &Atlas<'_>) -> Option<ApexChart> {
        atlas.layout.pole_chart(self.coordinates).copied()
    }

    /// Returns the tangent vectors of the frame's coordinates at its point; NaN where the surface is undefined.
    fn tangents(&self, atlas: &Atlas<'_>) -> [[f64; 3]; 2] {
        let Some(chart) = self.chart(atlas) else {
            let jet = atlas.jet(self.uv.0);
            return [jet.du, jet.dv];
        };
        let state = State {
            at: chart.point(self.uv.0),
            velocity: [0.0; 2],
        };
        let local = atlas.local(&Chart::Apex(chart), state);
        local.map_or([[f64::NAN; 3]; 2], |local| local.tangents)
    }

    fn metric_in(&self, atlas: &Atlas<'_>) -> Metric {
        let [du, dv] = self.tangents(atlas);
        Metric::of(&Jet {
            du,
            dv,
            ..Jet::default()
        })
    }

    /// +1 where the frame's coordinates have the handedness of (u,v), else −1.
    fn handedness(&self, atlas: &Atlas<'_>) -> f64 {
        self.chart(atlas).map_or(1.0, |chart| chart.handedness())
    }

    /// Positive where Y is to the left of X in (u,v).
    fn orientation(&self, atlas: &Atlas<'_>) -> f64 {
        let (x, y) = (self.x, self.y);
        self.handedness(atlas) * (x[0] * y[1] - x[1] * y[0])
    }
}

/// Follows the geodesic from a point along σu turned by `angle` radians towards σv, for the arc length `length`. At a
/// smooth pole σu is the limit along the meridian of the given parameter.
///
/// # Errors
/// As [`trace::trace`].
pub fn trace_heading(
    surface: &dyn Surface,
    uv: impl Into<Uv>,
    angle: f64,
    length: f64,
    options: &Options,
) -> Result<Trace, TraceError> {
    if !angle.is_finite() {
        return Err(TraceError::DirectionNotFinite);
    }
    let frame = Frame::at(&Atlas::new(surface), uv.into(), angle, 1.0, Meridian::Given)?;
    frame.trace(surface, [1.0, 0.0], length, options)
}

/// The direction of X with angle 0 at a pole.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Meridian {
    /// The a-axis.
    First,
    /// The direction of σu near the pole on the given meridian.
    Given,
}

/// Returns the direction of σu near a pole, in the chart about it.
fn along_u(chart: &ApexChart, at: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = chart.angle(at).sin_cos();
    if chart.axis == 0 {
        [cos, sin].map(|x| chart.sign * x)
    } else {
        [-sin, cos].map(|x| chart.apex.rate.signum() * x)
    }
}
