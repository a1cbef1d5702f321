//! The camera of a surface in space: a point on it, and two tangent vectors.

use super::ray::SpaceState;
use super::{ImplicitSurface, PlaceError, SpaceTrace, SpaceTraceError};
use crate::point::PicturePoint;
use crate::trace::Options;
use crate::vector::{combine, cross, dot, norm};

/// A point on a surface with two orthogonal tangent vectors of equal length, which is the zoom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceFrame {
    /// The point.
    pub at: [f64; 3],
    /// To the right in the picture.
    pub x: [f64; 3],
    /// Up in the picture.
    pub y: [f64; 3],
}

/// If ẑ×n is shorter than this, it has no direction.
const UPRIGHT: f64 = 1e-9;
/// The fraction of the zoom by which a frame may be off its surface: the rounding error of a long walk.
const FITS: f64 = 1e-9;

/// Returns X = ẑ×n and Y = n×X at a point with the unit normal n; X is x̂ where ẑ×n is 0.
fn axes(n: [f64; 3]) -> [[f64; 3]; 2] {
    let x = cross([0.0, 0.0, 1.0], n);
    let length = norm(x);
    let x = match length > UPRIGHT {
        true => x.map(|x| x / length),
        false => {
            let x = combine(1.0, [1.0, 0.0, 0.0], -n[0], n);
            let length = norm(x);
            x.map(|x| x / length)
        }
    };
    [x, cross(n, x)]
}

impl SpaceFrame {
    /// Creates the frame at a point, which is moved onto the surface: X along ẑ×n, turned by `angle` radians towards Y =
    /// n×X. It sees the surface from outside.
    ///
    /// # Errors
    /// [`PlaceError`].
    pub fn new(
        surface: &ImplicitSurface,
        near: [f64; 3],
        angle: f64,
        zoom: f64,
    ) -> Result<Self, PlaceError> {
        let at = surface.place(near)?;
        let normal = surface.normal(at).ok_or(PlaceError::NoGradient)?;
        let [x, y] = axes(normal);
        let (sin, cos) = angle.sin_cos();
        Ok(Self {
            at,
            x: combine(zoom * cos, x, zoom * sin, y),
            y: combine(-zoom * sin, x, zoom * cos, y),
        })
    }

    /// Moves the frame onto a surface that has changed: to the nearby point on it, with X without its component along the
    /// normal and of the same length. A frame that already fits is returned unchanged, to the last digit.
    ///
    /// # Errors
    /// [`PlaceError`].
    pub fn brought_onto(&self, surface: &ImplicitSurface) -> Result<Self, PlaceError> {
        let at = surface.place(self.at)?;
        let normal = surface.normal(at).ok_or(PlaceError::NoGradient)?;
        let zoom = self.zoom();
        let along = combine(1.0, self.x, -dot(self.x, normal), normal);
        let length = norm(along);
        let x = match length > UPRIGHT * zoom {
            true => along.map(|x| x * zoom / length),
            false => axes(normal)[0].map(|x| zoom * x),
        };
        let brought = Self {
            at,
            x,
            y: cross(normal, x),
        };
        let misses = |a: [f64; 3], b: [f64; 3]| norm(combine(1.0, a, -1.0, b));
        let fits = [
            misses(brought.at, self.at),
            misses(brought.x, self.x),
            misses(brought.y, self.y),
        ];
        let fits = fits.iter().all(|miss| *miss <= FITS * zoom);
        Ok(if fits { *self } else { brought })
    }

    /// Returns the length of both vectors.
    pub fn zoom(&self) -> f64 {
        norm(self.x)
    }

    /// Returns the frame with vectors of length `zoom`.
    #[must_use]
    pub fn zoomed(&self, zoom: f64) -> Self {
        let factor = zoom / self.zoom();
        Self {
            x: self.x.map(|x| factor * x),
            y: self.y.map(|y| factor * y),
            ..*self
        }
    }

    /// Returns the frame turned by an angle from X towards Y.
    #[must_use]
    pub fn turned(&self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self {
            at: self.at,
            x: combine(cos, self.x, sin, self.y),
            y: combine(-sin, self.x, cos, self.y),
        }
    }

    /// Returns the angle of X from ẑ×n (x̂ if that is 0) towards n×(ẑ×n), in radians.
    pub fn angle(&self, surface: &ImplicitSurface) -> f64 {
        let [x, y] = axes(surface.normal(self.at).unwrap_or([1.0, 0.0, 0.0]));
        dot(self.x, y).atan2(dot(self.x, x))
    }

    /// Returns the vector x X + y Y of a point (x, y) of the picture.
    pub fn velocity(&self, place: impl Into<PicturePoint>) -> [f64; 3] {
        let PicturePoint([x, y]) = place.into();
        combine(x, self.x, y, self.y)
    }

    /// Returns the start, at unit speed, in the direction at an angle from X towards Y.
    pub(super) fn start(&self, angle: f64) -> SpaceState {
        let (sin, cos) = angle.sin_cos();
        let zoom = self.zoom();
        SpaceState {
            at: self.at,
            velocity: combine(cos / zoom, self.x, sin / zoom, self.y),
        }
    }

    /// Moves by `step` (x, y), in units of the frame: along the geodesic with the velocity xX + yY, along which X and Y are
    /// parallel transported. The trace reports whether the step was completed; the frame is at the trace's end.
    ///
    /// # Errors
    /// [`SpaceTraceError`].
    pub fn advance(
        &self,
        surface: &ImplicitSurface,
        step: impl Into<PicturePoint>,
        options: &Options,
    ) -> Result<(Self, SpaceTrace), SpaceTraceError> {
        let PicturePoint([x, y]) = step.into();
        let share = x.hypot(y);
        let zoom = self.zoom();
        let towards = if share > 0.0 { [x, y] } else { [1.0, 0.0] };
        let direction = self.velocity(towards);
        let trace = surface.trace(self.at, direction, share * zoom, options)?;
        let normal = surface
            .normal(trace.position)
            .unwrap_or_else(|| cross(self.x, self.y).map(|n| n / (zoom * zoom)));
        let along = trace.direction.map(|x| zoom * x);
        let left = cross(normal, along);
        let [cos, sin] = if share > 0.0 {
            [x / share, y / share]
        } else {
            [1.0, 0.0]
        };
        let frame = Self {
            at: trace.position,
            x: combine(cos, along, -sin, left),
            y: combine(sin, along, cos, left),
        };
        Ok((frame, trace))
    }
}
