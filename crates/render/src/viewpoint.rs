//! Cameras as data in a request. A view places them in a scene; a window moves them.

use geodesic::frame::Frame;
use geodesic::implicit::SpaceFrame;
use geometry::ManifoldError;
use scene::{ObjectId, Scene};

use crate::error::RenderError;
use crate::point::WorldPoint;

/// The camera of a view in space, in the scene's units. Coordinates that are not given are chosen so that the scene fills
/// the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Viewpoint {
    /// The position of the eye.
    pub eye: Option<WorldPoint>,
    /// The point that it looks at.
    pub target: Option<WorldPoint>,
    /// The projection.
    pub projection: Projection,
}

/// The projection of space onto a picture.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Projection {
    /// Lines of sight meet in the eye: distant objects are smaller.
    #[default]
    Perspective,
    /// Lines of sight are parallel: equal lengths across them are equal in the picture, with the size that they have in
    /// perspective in the plane of the target. Nothing is behind the eye.
    Orthographic,
}

/// A camera on a surface, a metric or a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeodesicCamera {
    /// The surface, metric or solid.
    pub surface: ObjectId,
    /// Its position and direction.
    pub pose: Pose,
    /// The distance on the surface that corresponds to half the picture's shorter side; positive. Chosen from the surface's
    /// size if not given. A [`Pose::Frame`] has its own.
    pub zoom: Option<f64>,
}

/// The position and direction of a geodesic camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pose {
    /// At a point of the chart.
    At {
        /// (u, v); the centre of the domain if not given.
        at: Option<[f64; 2]>,
        /// The angle from σu to the picture's x axis, towards σv, in radians.
        angle: f64,
        /// True if the picture's up is to the right of that axis, in the orientation of (u,v): the surface is seen from its
        /// other side.
        mirrored: bool,
    },
    /// Near a point in space, on a solid.
    InSpace {
        /// (x, y, z), which is projected onto the solid's surface; if not given, the point where the ray from the centre of
        /// its box along x leaves it.
        at: Option<[f64; 3]>,
        /// The angle from X = ẑ×n (x̂ if that is 0) to the picture's x axis, towards n×X, in radians.
        angle: f64,
    },
    /// A frame on a solid that has been moved. The length of its vectors is the zoom.
    SpaceFrame(SpaceFrame),
    /// A frame that has been moved: created by [`PlacedCamera::frame`](crate::geodesic_view::PlacedCamera) and moved by
    /// [`Frame`]'s methods. The length of its vectors is the zoom.
    Frame(Frame),
}

/// The zooms that single precision can represent, and whose reciprocals it can represent.
const ZOOMS: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

impl Viewpoint {
    /// Creates a camera at a position, with a target.
    pub fn new(eye: impl Into<WorldPoint>, target: impl Into<WorldPoint>) -> Self {
        Self {
            eye: Some(eye.into()),
            target: Some(target.into()),
            projection: Projection::Perspective,
        }
    }

    /// Refuses a camera that has no direction.
    ///
    /// # Errors
    /// [`RenderError::Camera`].
    pub fn check(&self) -> Result<(), RenderError> {
        let finite =
            |place: &Option<WorldPoint>| place.is_none_or(|p| p.0.iter().all(|x| x.is_finite()));
        if !finite(&self.eye) || !finite(&self.target) {
            return Err(RenderError::Camera(
                "the camera's position and target must be finite".into(),
            ));
        }
        if self.eye.is_some() && self.eye == self.target {
            return Err(RenderError::Camera(
                "the camera is at its target and has no direction".into(),
            ));
        }
        Ok(())
    }
}

impl GeodesicCamera {
    /// Returns the initial camera of a surface or metric: at the centre of its domain, or beside it.
    pub fn new(surface: ObjectId) -> Self {
        Self {
            surface,
            pose: Pose::At {
                at: None,
                angle: 0.0,
                mirrored: false,
            },
            zoom: None,
        }
    }

    /// Returns the camera at another point (u, v) of the chart, with angle 0.
    #[must_use]
    pub fn at(self, at: [f64; 2]) -> Self {
        let pose = Pose::At {
            at: Some(at),
            angle: 0.0,
            mirrored: false,
        };
        Self { pose, ..self }
    }

    /// Returns the camera with another zoom.
    #[must_use]
    pub fn zoomed(self, zoom: f64) -> Self {
        Self {
            zoom: Some(zoom),
            ..self
        }
    }

    /// Returns the camera with the pose of a frame.
    #[must_use]
    pub fn with_frame(self, frame: Frame) -> Self {
        Self {
            pose: Pose::Frame(frame),
            ..self
        }
    }

    /// Refuses a camera that is not on a surface, and numbers that are not finite.
    ///
    /// # Errors
    /// [`RenderError::Manifold`], [`RenderError::Camera`].
    pub fn check(&self, scene: &Scene) -> Result<(), RenderError> {
        let object = scene.get(self.surface);
        if object.is_none_or(|object| !object.shape.has_inside()) {
            let name = object.map(|object| object.name.clone());
            return Err(ManifoldError::NoSurface { name }.into());
        }
        if let Pose::InSpace { at, angle } = self.pose
            && (!angle.is_finite() || at.is_some_and(|at| at.iter().any(|x| !x.is_finite())))
        {
            return Err(RenderError::Camera(
                "the camera's position and angle must be finite".into(),
            ));
        }
        if let Pose::At { at, angle, .. } = self.pose
            && (!angle.is_finite() || at.is_some_and(|at| at.iter().any(|x| !x.is_finite())))
        {
            return Err(RenderError::Camera(
                "the camera's position and angle must be finite".into(),
            ));
        }
        if self
            .zoom
            .is_some_and(|zoom| !zoom.is_finite() || zoom <= 0.0)
        {
            return Err(RenderError::Camera(
                "the zoom is a distance and must be positive".into(),
            ));
        }
        if self.zoom.is_some_and(|zoom| !ZOOMS.contains(&zoom)) {
            return Err(RenderError::Camera(format!(
                "the zoom must be between {:e} and {:e}",
                ZOOMS.start(),
                ZOOMS.end()
            )));
        }
        Ok(())
    }
}
