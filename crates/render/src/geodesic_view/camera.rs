//! The camera of the geodesic view, placed on its surface, and the geodesics that start from it, in f64.

use std::sync::Arc;

use expr::Input;
use geodesic::ends::{Coordinates, Ends};
use geodesic::fan::{Fan, FanOptions, Interpolation};
use geodesic::frame::Frame;
use geodesic::map::{self, Map, MapMethod, MapOptions, exponential_map};
use geodesic::piecewise::PiecewiseMap;
use geodesic::surface::{Sides, Surface};
use geodesic::topology::Apex;
use geodesic::trace::{Status, TraceError};
use glam::DVec3;
use rayon::prelude::*;
use scene::ParamValues;
use scene::{ObjectId, Scene};

use super::{PictureMethod, RayEnds, as_written};
use crate::error::RenderError;
use crate::point::PixelPoint;
use crate::sample::DEGENERATE;
use crate::viewpoint::{GeodesicCamera, Pose};
use geometry::{Manifold, ManifoldError};

/// The points at which the camera is tried first, as fractions of the domain: its centre, then points off every symmetry.
const PLACES: [[f64; 2]; 7] = [
    [0.5, 0.5],
    [0.47, 0.53],
    [0.39, 0.36],
    [0.61, 0.32],
    [0.27, 0.71],
    [0.83, 0.64],
    [0.13, 0.17],
];
/// The initial zoom, as a fraction of the shorter of the two coordinate lines through the camera.
const FIRST_ZOOM: f64 = 0.55;
/// The number of steps of [`PictureMethod::Rk4Pixel`] for each pixel.
const RK4_STEPS: u32 = 128;

/// The maximum error at a pixel, in pixels.
pub const TOLERANCE: f64 = 0.1;
/// The maximum error at a pixel, in pixels, of a view that moves.
pub const MOVING_TOLERANCE: f64 = 0.5;
/// The fraction of the tolerance that polynomials between the rays may add.
pub(super) const PIECEWISE_SHARE: f64 = 0.25;

/// A geodesic camera on its surface or metric, with the size of its picture.
#[derive(Clone, Debug)]
pub struct PlacedCamera {
    manifold: Arc<Manifold>,
    /// The surface or metric, as an object of the scene.
    pub surface: ObjectId,
    /// A point and two tangent vectors X ⟂ Y of the length [`PlacedCamera::zoom`].
    pub frame: Frame,
    /// The distance on the surface from the picture's centre to the middle of its shorter side's edge.
    pub zoom: f64,
    /// The method by which geodesics are integrated.
    pub method: PictureMethod,
    /// The maximum error at a pixel, in pixels.
    tolerance: f64,
    size: [u32; 2],
}

/// An exponential map: from a place (x, y) of a picture to the place in space at which its geodesic ends.
pub(crate) type Positions<'a> = &'a (dyn Fn([f64; 2]) -> Option<[f64; 3]> + Sync);

/// Returns the position (x, y) in the plane of a frame of a pixel of a picture of this size: the shorter side ranges from −1
/// to 1.
pub(super) fn picture_place(size: [u32; 2], PixelPoint(at): PixelPoint) -> [f64; 2] {
    let [width, height] = size.map(f64::from);
    let per_pixel = 2.0 / width.min(height);
    let [x, y] = [at[0] - 0.5 * width, 0.5 * height - at[1]];
    [x * per_pixel, y * per_pixel]
}

/// Returns the options of a picture's fan.
pub(super) fn fan_options(
    tolerance: f64,
    interpolation: Interpolation,
    size: [u32; 2],
) -> FanOptions {
    let defaults = FanOptions::default();
    FanOptions {
        tolerance,
        interpolation,
        max_evaluations: defaults.max_evaluations.min(most_evaluations(size)),
        ..defaults
    }
}

/// Returns the maximum number of evaluations for a picture: with any method, its pixels take at most as many as separately.
fn most_evaluations(size: [u32; 2]) -> u64 {
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    MapOptions::default()
        .max_evaluations
        .min(pixels.saturating_mul(map::MOST_FOR_PIXEL))
}

/// Returns the estimated errors of ends, in pixels, at every `step`-th pixel of every `step`-th row of a picture; NaN where
/// nothing is seen.
pub(super) fn errors<const N: usize>(ends: &dyn Ends<N>, size: [u32; 2], step: u32) -> Vec<f32> {
    let [columns, rows] = size.map(|side| side.div_ceil(step));
    let error = |index: u32| {
        let [x, y] = [index % columns, index / columns].map(|n| n * step + step / 2);
        let end = ends.end(map::pixel_place(size, x, y));
        if end.status == Status::Complete {
            end.error as f32
        } else {
            f32::NAN
        }
    };
    (0..columns * rows).into_par_iter().map(error).collect()
}

impl PlacedCamera {
    /// Places a camera on its surface; for a surface that depends on grids, on the first instance. A point beyond a side
    /// that wraps is moved back into the domain.
    ///
    /// # Errors
    /// [`RenderError::Manifold`], [`RenderError::CameraOutside`], [`RenderError::UndefinedCamera`].
    pub fn new(
        scene: &Scene,
        params: &ParamValues,
        camera: &GeodesicCamera,
        size: [u32; 2],
    ) -> Result<Self, RenderError> {
        Self::on(scene, params, camera, size, |surface, uniforms| {
            Ok(Arc::new(Manifold::new(scene, surface, uniforms)?))
        })
    }

    /// Places a camera as [`PlacedCamera::new`] does, on an existing manifold: that of the surface with the given uniforms.
    ///
    /// # Errors
    /// As [`PlacedCamera::new`].
    pub fn on(
        scene: &Scene,
        params: &ParamValues,
        camera: &GeodesicCamera,
        size: [u32; 2],
        manifold: impl FnOnce(ObjectId, &[f64]) -> Result<Arc<Manifold>, RenderError>,
    ) -> Result<Self, RenderError> {
        let object = scene
            .get(camera.surface)
            .ok_or(ManifoldError::NoSurface { name: None })?;
        let uniforms = params.first_instance(scene, object);
        let manifold = manifold(camera.surface, &uniforms)?;
        let (frame, zoom) = place(manifold.surface(), &object.name, camera)?;
        Ok(Self {
            manifold,
            surface: camera.surface,
            frame,
            zoom,
            method: PictureMethod::Fan,
            tolerance: TOLERANCE,
            size,
        })
    }

    /// Returns the camera as point, angle and zoom.
    pub fn by_angle(&self) -> GeodesicCamera {
        let surface = self.manifold.surface();
        GeodesicCamera {
            surface: self.surface,
            pose: Pose::At {
                at: Some(self.frame.uv.0),
                angle: as_written(self.frame.angle(surface)),
                mirrored: self.frame.is_mirrored(surface),
            },
            zoom: Some(self.zoom),
        }
    }

    /// Returns the position (x, y) of a pixel in the plane of the frame: the picture's shorter side ranges from −1 to 1.
    pub(crate) fn picture_place(&self, at: PixelPoint) -> [f64; 2] {
        picture_place(self.size, at)
    }

    /// Returns the domain, `[[u min, u max], [v min, v max]]`.
    pub fn domain(&self) -> [[f64; 2]; 2] {
        self.manifold.surface().domain()
    }

    /// Returns the kind of each side of the domain.
    pub fn sides(&self) -> Sides {
        self.manifold.surface().sides()
    }

    /// Returns the sides that are single points: `[axis][end]`.
    pub fn apexes(&self) -> [[Option<Apex>; 2]; 2] {
        self.manifold.apexes()
    }

    /// Follows the geodesics of all pixels, in f64 on all cores. `progress` receives the completed fraction.
    pub fn ends(&self, progress: &(dyn Fn(f32) + Sync)) -> RayEnds {
        let Some(interpolation) = self.method.interpolation() else {
            return RayEnds::Map(self.map(progress));
        };
        let tolerance = PIECEWISE_SHARE * self.tolerance;
        self.with_fan(interpolation, |fan, ends| {
            progress(0.5);
            let mut piecewise = PiecewiseMap::cut(ends, self.size, tolerance);
            piecewise.origin = self.frame.uv.0;
            progress(1.0);
            RayEnds::Piecewise {
                work: fan.work(),
                estimate: fan.estimate().with(piecewise.estimate),
                piecewise: Box::new(piecewise),
            }
        })
    }

    /// Computes the ends of all pixels' geodesics one by one, in f64 on all cores. `progress` receives the completed
    /// fraction.
    pub fn map(&self, progress: &(dyn Fn(f32) + Sync)) -> Map {
        let options = MapOptions {
            method: match self.method {
                PictureMethod::Fan => MapMethod::Fan,
                PictureMethod::FanLinear => MapMethod::FanLinear,
                PictureMethod::Adaptive => MapMethod::Adaptive,
                PictureMethod::Rk4Pixel => MapMethod::Rk4 { steps: RK4_STEPS },
            },
            tolerance: self.tolerance,
            max_evaluations: most_evaluations(self.size),
            ..MapOptions::default()
        };
        let surface = self.manifold.surface();
        exponential_map(surface, &self.frame, self.size, &options, progress)
    }

    /// Returns the estimated errors, in pixels, at every `step`-th pixel of every `step`-th row; NaN where nothing is seen.
    /// `None` if the method has no estimate for each pixel.
    pub(crate) fn errors(&self, step: u32) -> Option<Vec<f32>> {
        let interpolation = self.method.interpolation()?;
        Some(self.with_fan(interpolation, |_, ends| errors(ends, self.size, step)))
    }

    /// Passes the exponential map to `read`, as a function from a place (x, y) of the picture to the place in space at which its
    /// geodesic ends, `None` if it ends earlier. The map is a fan with a tolerance in pixels.
    pub(crate) fn with_positions<R>(
        &self,
        tolerance: f64,
        read: impl FnOnce(Positions<'_>) -> R,
    ) -> R {
        let options = FanOptions {
            follows_each: true,
            ..fan_options(tolerance, Interpolation::default(), self.size)
        };
        let surface = self.manifold.surface();
        map::with_fan(surface, &self.frame, self.size, &options, |fan, _| {
            read(&|place| fan.position(place.into()))
        })
    }

    fn with_fan<R>(
        &self,
        interpolation: Interpolation,
        read: impl FnOnce(&Fan<'_>, &dyn Ends) -> R,
    ) -> R {
        let surface = self.manifold.surface();
        let options = fan_options(self.tolerance, interpolation, self.size);
        map::with_fan(surface, &self.frame, self.size, &options, read)
    }

    /// Returns the uniforms that an object's shape reads, by their numbers.
    pub(crate) fn uniforms_used(&self, scene: &Scene, object: ObjectId) -> Vec<usize> {
        let roots = scene
            .get(object)
            .map_or_else(Vec::new, |object| object.shape.roots());
        let inputs = scene.graph.inputs(&roots).into_iter();
        inputs
            .filter_map(|input| match input {
                Input::Uniform(k) => Some(k as usize),
                Input::Variable(_) => None,
            })
            .collect()
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

    /// Returns the surface or metric that it is on.
    pub fn manifold(&self) -> &Manifold {
        &self.manifold
    }

    /// Returns the size of the picture in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }
}

/// Returns the frame and the zoom of a camera on a surface.
///
/// # Errors
/// [`RenderError::CameraOutside`], [`RenderError::UndefinedCamera`].
fn place(
    surface: &dyn Surface,
    name: &str,
    camera: &GeodesicCamera,
) -> Result<(Frame, f64), RenderError> {
    let outside = |at, domain| RenderError::CameraOutside {
        name: name.to_owned(),
        at,
        domain,
    };
    let undefined = |at| RenderError::UndefinedCamera {
        name: name.to_owned(),
        at,
    };
    let (at, angle, mirrored) = match camera.pose {
        Pose::Frame(frame) => {
            let zoom = frame.zoom(surface);
            let domain = surface.domain();
            let in_domain = |k: usize| (domain[k][0]..=domain[k][1]).contains(&frame.uv[k]);
            if !in_domain(0) || !in_domain(1) {
                return Err(outside(frame.uv.0, domain));
            }
            if !(zoom.is_finite() && zoom > 0.0) {
                return Err(undefined(frame.uv.0));
            }
            return Ok((frame, zoom));
        }
        Pose::InSpace { .. } | Pose::SpaceFrame(_) => {
            return Err(RenderError::Camera(format!(
                "`{name}` has two parameters: a camera on it has a position (u, v)"
            )));
        }
        Pose::At {
            at,
            angle,
            mirrored,
        } => (at.unwrap_or_else(|| first_place(surface)), angle, mirrored),
    };
    // The length does not matter yet: the initial zoom is measured from the actual position of the frame.
    let mut unit = Frame::new(surface, at, angle, 1.0).map_err(|error| match error {
        TraceError::OutsideDomain { at, domain } => outside(at, domain),
        _ => undefined(at),
    })?;
    if unit.coordinates == Coordinates::Plain && !has_tangent_plane(surface, unit.uv.0) {
        return Err(undefined(at));
    }
    if mirrored {
        unit.y = unit.y.map(|y| -y);
    }
    let zoom = camera
        .zoom
        .unwrap_or_else(|| first_zoom(surface, unit.uv.0));
    Ok((unit.zoomed(zoom), zoom))
}

/// Returns a point with a tangent plane: the centre of the domain if it has one.
fn first_place(surface: &dyn Surface) -> [f64; 2] {
    let domain = surface.domain();
    let places = PLACES.map(|share| {
        std::array::from_fn(|k| domain[k][0] + share[k] * (domain[k][1] - domain[k][0]))
    });
    let found = places
        .into_iter()
        .find(|&at| has_tangent_plane(surface, at));
    found.unwrap_or(places[0])
}

/// Returns true if σ is defined and σu, σv, each scaled by its domain's width, span a plane.
fn has_tangent_plane(surface: &dyn Surface, at: [f64; 2]) -> bool {
    let jet = surface.jet(at.into());
    let widths = surface.domain().map(|[low, high]| high - low);
    let (a, b) = (
        DVec3::from(jet.du) * widths[0],
        DVec3::from(jet.dv) * widths[1],
    );
    let longest = a.abs().max_element().max(b.abs().max_element());
    if !(longest > 0.0 && longest.is_finite() && DVec3::from(jet.position).is_finite()) {
        return false;
    }
    (a / longest).cross(b / longest).length() > DEGENERATE
}

/// Returns a zoom that shows a large part of the surface.
fn first_zoom(surface: &dyn Surface, at: [f64; 2]) -> f64 {
    const STEPS: u32 = 64;
    let domain = surface.domain();
    let length = |k: usize| -> f64 {
        let [low, high] = domain[k];
        let step = (high - low) / f64::from(STEPS);
        let pieces = (0..STEPS).map(|n| {
            let mut place = at;
            place[k] = low + (f64::from(n) + 0.5) * step;
            let jet = surface.jet(place.into());
            DVec3::from(if k == 0 { jet.du } else { jet.dv }).length() * step
        });
        pieces.filter(|piece| piece.is_finite()).sum()
    };
    let shorter = [length(0), length(1)]
        .into_iter()
        .filter(|&l| l > 0.0)
        .fold(f64::INFINITY, f64::min);
    if shorter.is_finite() {
        FIRST_ZOOM * shorter
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(source: &str, at: [f64; 2], zoom: f64) -> PlacedCamera {
        let scene = scene::geotrace::compile(source).scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        let camera = GeodesicCamera {
            pose: Pose::At {
                at: Some(at),
                angle: 0.3,
                mirrored: false,
            },
            zoom: Some(zoom),
            ..GeodesicCamera::new(ObjectId::new(0))
        };
        PlacedCamera::new(&scene, &params, &camera, [64; 2]).expect("a camera")
    }

    #[test]
    fn positions_are_where_geodesics_end() {
        // Past a pole, through a side that is turned over, past the tip of a cone, up to an edge; a deep zoom.
        for (source, at, zoom) in [
            (
                "surface s(u,v) = (cos u cos v, sin u cos v, sin v), u : [0, 2pi], v : [-pi/2, pi/2];",
                [1.0, 0.2],
                1.7,
            ),
            (
                "surface s(u,v) = ((1 + v cos(u/2)) cos u, (1 + v cos(u/2)) sin u, v sin(u/2)), \
                 u : [0, 2pi], v : [-1/2, 1/2];",
                [6.1, 0.1],
                0.5,
            ),
            (
                "surface s(u,v) = (v cos u, v sin u, v), u : [0, 2pi], v : [0, 2];",
                [1.0, 0.4],
                1.0,
            ),
            (
                "surface s(u,v) = (u, v, 0.4 sin(3u) cos v), u : [0, 4], v : [0, 2];",
                [1.5, 0.75],
                1e-13,
            ),
        ] {
            const TOLERANCE: f64 = 0.02;
            let camera = placed(source, at, zoom);
            let surface = camera.manifold().surface();
            let (mut ended, mut most) = (0, 0.0_f64);
            camera.with_positions(TOLERANCE, |position| {
                for k in 0..50 {
                    let angle = f64::from(k) * std::f64::consts::TAU / 50.0;
                    let reach = 0.3 + 0.02 * f64::from(k);
                    let place = [reach * angle.cos(), reach * angle.sin()];
                    let options = geodesic::trace::Options::default();
                    let trace = camera.frame.trace(surface, place, zoom * reach, &options);
                    let trace = trace.expect("a geodesic");
                    let expected = trace.position.filter(|_| trace.status == Status::Complete);
                    match (position(place), expected) {
                        (Some(found), Some(expected)) => {
                            let off = DVec3::from(found).distance(DVec3::from(expected));
                            most = most.max(off / (2.0 * zoom / 64.0));
                        }
                        (None, None) => ended += 1,
                        both => panic!("{both:?} at {place:?} of {source}"),
                    }
                }
            });
            // In space a deep zoom has the digits of numbers about 1.
            let rounding = 4.0 * f64::EPSILON / (2.0 * zoom / 64.0);
            assert!(
                most <= 2.0 * TOLERANCE + rounding,
                "{most} pixels, {source}"
            );
            assert!(ended < 40, "{ended} of 50 end, {source}");
        }
    }

    #[test]
    fn errors_of_a_deep_zoom_are_those_of_the_fan_that_is_drawn() {
        // The same surface, relative to the camera.
        let surface = "surface s(u,v) = (u, v, 0.4 sin(3u) cos v), u : [0, 4], v : [0, 2];";
        let relative = "surface s(u,v) = (u + 1.5, v + 0.75, 0.4 sin(3(u + 1.5)) cos(v + 0.75)), \
            u : [-1.5, 2.5], v : [-0.75, 1.25];";
        for zoom in [1e-3, 1e-13, 1e-15] {
            let [found, expected] =
                [(surface, [1.5, 0.75]), (relative, [0.0; 2])].map(|(source, at)| {
                    placed(source, at, zoom)
                        .errors(8)
                        .expect("a fan has an estimate")
                });
            for (found, expected) in found.into_iter().zip(expected) {
                let off = (found - expected).abs();
                assert!(off <= 1e-3 * expected, "{found}, not {expected}, at {zoom}");
            }
        }
    }
}
