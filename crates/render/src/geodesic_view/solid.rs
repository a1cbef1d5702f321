//! The camera of the geodesic view on a solid, and the ends of its geodesics in space.

use std::sync::Arc;

use geodesic::ends::Ends;
use geodesic::fan::Interpolation;
use geodesic::implicit::{SpaceFan, SpaceFrame};
use geodesic::map::{MapOptions, pixel_place};
use geodesic::piecewise::PiecewiseMap;
use geodesic::pixels::Map;
use geodesic::trace::{Options, Status};
use geometry::SolidSurface;
use rayon::prelude::*;
use scene::{ObjectId, ParamValues, Scene};

use super::camera::{
    MOVING_TOLERANCE, PIECEWISE_SHARE, Positions, TOLERANCE, errors, fan_options, picture_place,
};
use super::{PictureMethod, as_written};
use crate::error::RenderError;
use crate::point::PixelPoint;
use crate::viewpoint::{GeodesicCamera, Pose};

/// The initial zoom as a fraction of the longest side of the solid's box: a ball shows as much as a sphere with parameters.
const FIRST_ZOOM: f64 = 0.55 * std::f64::consts::FRAC_PI_2;

/// A geodesic camera on a solid, with the size of its picture.
#[derive(Clone, Debug)]
pub struct PlacedSolidCamera {
    solid: Arc<SolidSurface>,
    /// The solid, as an object of the scene.
    pub object: ObjectId,
    /// A point and two tangent vectors X ⟂ Y of the length of the zoom.
    pub frame: SpaceFrame,
    method: PictureMethod,
    tolerance: f64,
    size: [u32; 2],
}

impl PlacedSolidCamera {
    /// Places a camera on its solid, for these values of the params.
    ///
    /// # Errors
    /// [`RenderError::Manifold`], [`RenderError::Camera`].
    pub fn new(
        scene: &Scene,
        params: &ParamValues,
        camera: &GeodesicCamera,
        size: [u32; 2],
    ) -> Result<Self, RenderError> {
        let solid = Arc::new(SolidSurface::new(scene, params, camera.surface)?);
        Self::on(solid, scene, camera, size)
    }

    /// Places a camera on a compiled solid of a scene.
    ///
    /// # Errors
    /// [`RenderError::Camera`].
    pub fn on(
        solid: Arc<SolidSurface>,
        scene: &Scene,
        camera: &GeodesicCamera,
        size: [u32; 2],
    ) -> Result<Self, RenderError> {
        let name = scene.get(camera.surface).map_or("", |object| &object.name);
        let usual = solid.bounds().map_or(1.0, |[lower, upper]| {
            let sides = [0, 1, 2].map(|k| upper[k] - lower[k]);
            FIRST_ZOOM * sides.into_iter().fold(0.0, f64::max)
        });
        let zoom = camera.zoom.unwrap_or(usual);
        let (at, angle) = match camera.pose {
            Pose::SpaceFrame(frame) => {
                return Ok(Self {
                    solid,
                    object: camera.surface,
                    frame,
                    method: PictureMethod::Fan,
                    tolerance: TOLERANCE,
                    size,
                });
            }
            Pose::InSpace { at, angle } => (at, angle),
            Pose::At {
                at: None, angle, ..
            } => (None, angle),
            Pose::At { at: Some(_), .. } | Pose::Frame(_) => {
                return Err(RenderError::Camera(format!(
                    "`{name}` is a solid: a camera on it has a position (x, y, z)"
                )));
            }
        };
        let Some(near) = at.or_else(|| solid.first_place()) else {
            return Err(RenderError::Camera(format!(
                "`{name}` has no surface that a ray from its middle hits, so the camera needs a position (x, y, z)"
            )));
        };
        let frame = SpaceFrame::new(solid.surface(), near, angle, zoom).map_err(|why| {
            let [x, y, z] = scene.stated(near);
            RenderError::Camera(format!(
                "the camera's position ({x}, {y}, {z}) cannot be projected onto `{name}`: {why}"
            ))
        })?;
        Ok(Self {
            solid,
            object: camera.surface,
            frame,
            method: PictureMethod::Fan,
            tolerance: TOLERANCE,
            size,
        })
    }

    /// Returns the camera with another method for its geodesics.
    #[must_use]
    pub fn with_method(self, method: PictureMethod) -> Self {
        Self { method, ..self }
    }

    /// Returns the camera with the tolerance of a view that moves.
    #[must_use]
    pub fn moving(self) -> Self {
        Self {
            tolerance: MOVING_TOLERANCE,
            ..self
        }
    }

    /// Returns the camera as point, angle and zoom.
    pub fn by_angle(&self) -> GeodesicCamera {
        let angle = self.frame.angle(self.solid.surface());
        GeodesicCamera {
            surface: self.object,
            pose: Pose::InSpace {
                at: Some(self.frame.at),
                angle: as_written(angle),
            },
            zoom: Some(self.frame.zoom()),
        }
    }

    /// Returns the camera after a step (x, y), in units of its frame, along a geodesic.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if the geodesic does not reach that far.
    pub fn walked(&self, step: [f64; 2]) -> Result<GeodesicCamera, RenderError> {
        let surface = self.solid.surface();
        let walked = self.frame.advance(surface, step, &Options::default());
        let (frame, trace) = walked.map_err(RenderError::cannot_walk)?;
        RenderError::check_walk(trace.status, trace.length)?;
        Ok(GeodesicCamera {
            surface: self.object,
            pose: Pose::SpaceFrame(frame),
            zoom: None,
        })
    }

    /// Returns the estimated errors of a picture by rays, in pixels, at every `step`-th pixel of every `step`-th row, NaN
    /// where nothing is seen; `None` if the method has no estimates, or the solid has no tangent plane.
    pub(crate) fn errors(&self, step: u32) -> Option<Vec<f32>> {
        let fan = self.fan(self.method.interpolation()?)?;
        Some(errors(&fan, self.size, step))
    }

    /// Passes the exponential map to `read`, as [`PlacedCamera::with_positions`](super::PlacedCamera::with_positions) does.
    pub(crate) fn with_positions<R>(
        &self,
        tolerance: f64,
        read: impl FnOnce(Positions<'_>) -> R,
    ) -> R {
        let options = fan_options(tolerance, Interpolation::default(), self.size);
        let surface = self.solid.surface();
        let fan = SpaceFan::build(surface, &self.frame, self.size, &options);
        read(&|place| {
            let end = fan.as_ref()?.end(place.into());
            (end.status == Status::Complete).then_some(end.at)
        })
    }

    fn fan(&self, interpolation: Interpolation) -> Option<SpaceFan<'_>> {
        let options = fan_options(self.tolerance, interpolation, self.size);
        SpaceFan::build(self.solid.surface(), &self.frame, self.size, &options)
    }

    /// Returns the size of the picture in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the solid that it is on.
    pub fn solid(&self) -> &SolidSurface {
        &self.solid
    }

    /// Returns the position (x, y) of a pixel in the plane of the frame: the picture's shorter side ranges from −1 to 1.
    pub(crate) fn picture_place(&self, at: PixelPoint) -> [f64; 2] {
        picture_place(self.size, at)
    }

    /// Computes the ends of all pixels' geodesics, on all cores. `progress` receives the completed fraction.
    ///
    /// # Errors
    /// [`RenderError::Camera`] for a method that needs parameters.
    pub fn ends(&self, progress: &(dyn Fn(f32) + Sync)) -> Result<Map<3>, RenderError> {
        let Some(interpolation) = self.method.interpolation() else {
            return match self.method {
                PictureMethod::Rk4Pixel => Err(RenderError::Camera(
                    "the method rk4-pixel takes steps in (u, v), but a solid has no parameters"
                        .into(),
                )),
                _ => Ok(self.pixel_by_pixel()),
            };
        };
        let Some(fan) = self.fan(interpolation) else {
            return Err(RenderError::Camera(
                "the solid has no tangent plane at the camera".into(),
            ));
        };
        progress(0.5);
        let piecewise = PiecewiseMap::cut(&fan, self.size, PIECEWISE_SHARE * self.tolerance);
        let mut map = piecewise.map(true);
        map.work = fan.work();
        map.estimate = Some(fan.estimate().with(piecewise.estimate));
        progress(1.0);
        Ok(map)
    }

    fn pixel_by_pixel(&self) -> Map<3> {
        let (surface, frame) = (self.solid.surface(), &self.frame);
        let zoom = frame.zoom();
        let [width, height] = self.size;
        let pixel = 2.0 * zoom / f64::from(width.min(height).max(1));
        let share = MapOptions::default().evaluations_per_pixel(self.size);
        let ends: Vec<_> = (0..width * height)
            .into_par_iter()
            .map(|index| {
                let place = pixel_place(self.size, index % width, index / width);
                let [x, y] = place.0;
                let length = zoom * x.hypot(y);
                if length == 0.0 {
                    return (frame.at, Status::Complete, 0);
                }
                let options = Options {
                    tolerance: (0.1 * self.tolerance * pixel / length).clamp(1e-13, 1e-3),
                    max_evaluations: usize::try_from(share).unwrap_or(usize::MAX),
                    ..Options::default()
                };
                match surface.trace(frame.at, frame.velocity(place), length, &options) {
                    Ok(end) => (end.position, end.status, end.evaluations as u64),
                    Err(_) => (frame.at, Status::Undefined, 0),
                }
            })
            .collect();
        let mut map = Map {
            size: self.size,
            origin: frame.at,
            ..Map::default()
        };
        for (at, status, evaluations) in ends {
            map.offset
                .push(std::array::from_fn(|k| (at[k] - frame.at[k]) as f32));
            map.status.push(status);
            map.work.followed += 1;
            map.work.evaluations += evaluations;
        }
        map
    }
}
