//! The camera of the geodesic view: a place with two tangent vectors, moved by parallel transport.

use crate::metric::Metric;
use crate::surface::Surface;
use crate::trace::{self, Options, Trace, TraceError};

/// A point of the chart with two tangent vectors X ⟂ Y of equal length, in (u,v) components. Pixel
/// (x, y) ∈ [−1,1]² looks along xX + yY.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Frame {
    pub uv: [f64; 2],
    pub x: [f64; 2],
    pub y: [f64; 2],
}

impl Frame {
    /// X along σu turned by `angle` radians towards σv, Y = X turned by +90°, both of the length `zoom`.
    ///
    /// # Errors
    /// [`TraceError`] where the surface has no tangent plane, or a number is not finite.
    pub fn new<S: Surface + ?Sized>(
        surface: &S,
        uv: [f64; 2],
        angle: f64,
        zoom: f64,
    ) -> Result<Self, TraceError> {
        if !(angle.is_finite() && zoom.is_finite()) {
            return Err(TraceError::DirectionNotFinite);
        }
        let atlas = crate::chart::Atlas::new(surface);
        let (start, _) = trace::unit_start(&atlas, uv, [1.0, 0.0])?;
        let jet = surface.jet(start.at);
        let metric = Metric::of(&jet);
        if metric.r.is_nan() || metric.r <= 0.0 {
            return Err(TraceError::DegenerateStart { at: uv });
        }
        let unit = [1.0 / metric.e.sqrt(), 0.0];
        let x = metric.turn(unit, angle).map(|a| a * zoom);
        Ok(Self {
            uv: start.at,
            x,
            y: metric.turn_left(x),
        })
    }

    /// The velocity of the geodesic that a pixel shows: xX + yY.
    pub fn velocity(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| x * self.x[k] + y * self.y[k])
    }

    /// The length of X: the distance on the surface from the picture's centre to its edge.
    pub fn zoom<S: Surface + ?Sized>(&self, surface: &S) -> f64 {
        crate::metric::speed(&surface.jet(self.uv), self.x)
    }

    /// The frame with X and Y turned by `angle` radians.
    pub fn turned(&self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self {
            uv: self.uv,
            x: [0, 1].map(|k| cos * self.x[k] + sin * self.y[k]),
            y: [0, 1].map(|k| cos * self.y[k] - sin * self.x[k]),
        }
    }

    /// The frame with X and Y longer by `factor`.
    pub fn zoomed(&self, factor: f64) -> Self {
        Self {
            uv: self.uv,
            x: self.x.map(|a| a * factor),
            y: self.y.map(|a| a * factor),
        }
    }

    /// Moves by `step` (x, y), in units of the frame: along the geodesic with the velocity xX + yY, which X and Y
    /// follow by parallel transport. The trace says whether it got there; the frame stands where that ended.
    /// Through a flip, X and Y change their handedness.
    ///
    /// # Errors
    /// [`TraceError`] where the geodesic cannot be begun, or the surface has no tangent plane at its end.
    pub fn advance<S: Surface + ?Sized>(
        &self,
        surface: &S,
        step: [f64; 2],
        options: &Options,
    ) -> Result<(Self, Trace), TraceError> {
        let zoom = self.zoom(surface);
        let share = step[0].hypot(step[1]);
        if share == 0.0 {
            let trace = trace::trace(surface, self.uv, self.x, 0.0, options)?;
            return Ok((*self, trace));
        }
        let velocity = self.velocity(step);
        let trace = trace::trace(surface, self.uv, velocity, share * zoom, options)?;
        let metric = Metric::of(&surface.jet(trace.uv));
        let along = trace.direction.map(|a| a * zoom);
        let mut left = metric.turn_left(along);
        if !left.iter().all(|a| a.is_finite()) {
            return Err(TraceError::DegenerateStart { at: trace.uv });
        }
        // A mirrored camera has Y to the right of X, before and after.
        let mirrored = Metric::of(&surface.jet(self.uv))
            .inner(Metric::of(&surface.jet(self.uv)).turn_left(self.x), self.y)
            < 0.0;
        if trace.flipped != mirrored {
            left = left.map(|a| -a);
        }
        // In the plane of the frame, the geodesic's direction is (cos, sin).
        let [cos, sin] = step.map(|a| a / share);
        let frame = Self {
            uv: trace.uv,
            x: [0, 1].map(|k| cos * along[k] - sin * left[k]),
            y: [0, 1].map(|k| sin * along[k] + cos * left[k]),
        };
        Ok((frame, trace))
    }
}
