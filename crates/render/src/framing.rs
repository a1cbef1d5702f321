//! The framing of the scene, kept still while it moves a little: samples are in drawing units, and a camera without a
//! position of its own must not jump at every step of a slider.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;
use scene::ObjectId;
use tracer::camera::{LensCamera, LensProjection};

use crate::bounds::{Bounds, ObjectCloud, stated_radii};
use crate::camera::Camera;
use crate::content::{Content, Structure};
use crate::declared_camera::declared_lens;
use crate::error::RenderError;
use crate::overlay::{AxesBox, axis_height};
use crate::point::WorldPoint;
use crate::request::PictureRequest;
use crate::viewpoint::Viewpoint;

/// The bounds are kept while the scene stays in a ball of this many of their radii.
const OUTGROWN: f64 = 1.6;
/// The bounds are kept while the scene's own radius is at least this share of theirs.
const SHRUNK: f64 = 0.3;

/// The target of a declared camera is not nearer than this, in radii of the scene, unless its direction says so.
const NEAREST_TARGET: f64 = 0.1;

/// The bounds that pictures are drawn in, and the coarse points that they come from.
#[derive(Debug, Default)]
pub(crate) struct KeptBounds {
    kept: Option<Arc<Bounds>>,
    clouds: HashMap<Content, Arc<ObjectCloud>>,
    /// The scene that was placed last.
    last: Option<Framed>,
}

/// A scene in its place.
#[derive(Clone, Debug)]
pub(crate) struct Framed {
    contents: Arc<[Content]>,
    /// True for those that the view leaves room for.
    counts: Arc<[bool]>,
    /// The radii that they state.
    radii: Arc<[f64]>,
    /// The bounds that are kept.
    pub(crate) bounds: Arc<Bounds>,
    /// The coarse places of the scene's objects, in their order.
    clouds: Arc<[Arc<ObjectCloud>]>,
    /// The scene's points now, in the drawing units of these bounds.
    cloud: Arc<Vec<[f64; 3]>>,
}

impl KeptBounds {
    /// Places a scene with the contents of its objects.
    pub(crate) fn frame(
        &mut self,
        request: &PictureRequest,
        structures: &[Structure],
        leaves_room: impl Fn(ObjectId) -> bool,
    ) -> Framed {
        let (scene, params) = (&*request.scene, &*request.params);
        let contents: Arc<[Content]> = scene
            .objects
            .iter()
            .zip(structures)
            .map(|(object, structure)| structure.instances(scene, params, object))
            .collect();
        let counts: Arc<[bool]> = scene.numbered().map(|(id, _)| leaves_room(id)).collect();
        let radii: Arc<[f64]> = stated_radii(scene, params).into();
        if let (Some(last), true) = (&self.last, self.kept.is_some())
            && last.contents == contents
            && last.counts == counts
            && last.radii == radii
        {
            return last.clone();
        }
        let known: Vec<Option<Arc<ObjectCloud>>> = contents
            .iter()
            .map(|content| self.clouds.get(content).cloned())
            .collect();
        let wanted: Vec<bool> = known.iter().map(Option::is_none).collect();
        let new = ObjectCloud::all(scene, params, &wanted);
        let clouds: Arc<[Arc<ObjectCloud>]> = known
            .into_iter()
            .zip(new)
            .filter_map(|(known, new)| known.or_else(|| new.map(Arc::new)))
            .collect();
        self.clouds = contents
            .iter()
            .cloned()
            .zip(clouds.iter().cloned())
            .filter(|(_, cloud)| !cloud.is_omitted)
            .collect();
        let shown = || {
            clouds
                .iter()
                .zip(radii.iter())
                .zip(counts.iter())
                .filter(|(_, counts)| **counts)
                .map(|((cloud, radius), _)| (&**cloud, *radius))
        };
        let all = || shown().flat_map(|(cloud, radius)| cloud.thick_points(radius));
        let now = Bounds::around_objects(shown());
        let bounds = match &self.kept {
            Some(kept) if still_fits(kept, &now) => kept.clone(),
            _ => self.kept.insert(Arc::new(now.clone())).clone(),
        };
        let cloud = if bounds.placement == now.placement {
            now.cloud
        } else {
            all()
                .map(|point| bounds.placement.local(WorldPoint(point)).0)
                .collect()
        };
        let placed = Framed {
            contents,
            counts,
            radii,
            bounds,
            clouds,
            cloud: Arc::new(cloud),
        };
        self.last = Some(placed.clone());
        placed
    }

    /// Returns the bounds that are kept.
    pub(crate) fn get(&self) -> Option<&Arc<Bounds>> {
        self.kept.as_ref()
    }

    /// Keeps other bounds from now on; none: those of the next scene.
    pub(crate) fn set(&mut self, bounds: Option<Arc<Bounds>>) {
        self.kept = bounds;
        self.last = None;
    }
}

impl Framed {
    /// The contents of the scene's objects, in their order.
    pub(crate) fn contents(&self) -> &[Content] {
        &self.contents
    }

    /// The coarse places of an object.
    pub(crate) fn object(&self, id: ObjectId) -> Option<&ObjectCloud> {
        self.clouds.get(id.index()).map(|cloud| &**cloud)
    }

    /// Returns sentences about the solids of a request that no ray has met, among those that its view shows.
    pub(crate) fn notes(
        &self,
        request: &PictureRequest,
        shows: impl Fn(ObjectId) -> bool,
    ) -> Vec<String> {
        let objects = request.scene.numbered().zip(self.clouds.iter());
        let missed = objects.filter(|((id, _), cloud)| cloud.is_missed && shows(*id));
        let note = |name: &str| {
            format!("`{name}` may contain no point: no ray that looks for it meets it")
        };
        missed.map(|((_, object), _)| note(&object.name)).collect()
    }

    /// The corners of the box around the scene's points now, in drawing units: the least and the greatest coordinates.
    pub(crate) fn corners(&self) -> Option<[[f64; 3]; 2]> {
        let first = *self.cloud.first()?;
        let corners = self.cloud.iter().fold([first; 2], |[low, high], place| {
            [
                std::array::from_fn(|k| low[k].min(place[k])),
                std::array::from_fn(|k| high[k].max(place[k])),
            ]
        });
        Some(corners)
    }

    /// Places a camera as [`first_camera`] does.
    ///
    /// # Errors
    /// As [`first_camera`].
    pub(crate) fn camera(
        &self,
        viewpoint: &Viewpoint,
        request: &PictureRequest,
    ) -> Result<Camera, RenderError> {
        let corners = self.corners();
        let mut camera = with_room_for_axes(&self.bounds, corners, viewpoint, request)?;
        camera.keep_clear_of(&self.cloud);
        Ok(camera)
    }
}

/// Places a camera in bounds as [`Camera::new`] does. Where a request has axes, a camera that has no place of its own sees
/// their box too, with its numbers.
///
/// # Errors
/// As [`Camera::new`].
pub fn first_camera(
    bounds: &Bounds,
    viewpoint: &Viewpoint,
    request: &PictureRequest,
) -> Result<Camera, RenderError> {
    let corners = [bounds.half.map(|half| -half), bounds.half];
    let corners = (!bounds.cloud.is_empty()).then_some(corners);
    with_room_for_axes(bounds, corners, viewpoint, request)
}

/// Places a camera with the corners of the axes' box, if there is one.
fn with_room_for_axes(
    bounds: &Bounds,
    corners: Option<[[f64; 3]; 2]>,
    viewpoint: &Viewpoint,
    request: &PictureRequest,
) -> Result<Camera, RenderError> {
    let lens = declared_lens(request);
    let declared = lens.and_then(|lens| declared_viewpoint(bounds, viewpoint, &lens));
    let viewpoint = declared.as_ref().unwrap_or(viewpoint);
    let mut camera = Camera::new(bounds, viewpoint, request.size)?;
    if let (Some(lens), Some(_)) = (lens, viewpoint.eye) {
        camera.turn_as(&lens);
    }
    let straight = lens.filter(|lens| lens.projection == LensProjection::Pinhole);
    camera.opening = straight.map(|lens| lens.fov);
    let corners = corners.filter(|_| request.overlays.axes);
    Ok(match corners {
        Some(corners) => camera.with_room_for(bounds, viewpoint, |camera| {
            let height = axis_height(request);
            let axes = AxesBox::new(camera, corners, request.scene.stated_axes(), height);
            axes.extent(camera, height)
        }),
        None => camera,
    })
}

/// The place of a declared camera, for a viewpoint that has none. Its target lies before it as deep as the middle of the
/// scene.
fn declared_viewpoint(
    bounds: &Bounds,
    viewpoint: &Viewpoint,
    lens: &LensCamera,
) -> Option<Viewpoint> {
    if viewpoint.eye.is_some() || viewpoint.target.is_some() {
        return None;
    }
    let ahead = lens.direction.normalize_or_zero();
    let depth = (DVec3::from(bounds.placement.centre) - lens.position).dot(ahead);
    let depth = if depth > NEAREST_TARGET * bounds.placement.radius {
        depth
    } else {
        lens.direction.length()
    };
    let target = lens.position + depth * ahead;
    Some(Viewpoint {
        projection: viewpoint.projection,
        ..Viewpoint::new(lens.position.to_array(), target.to_array())
    })
}

fn still_fits(kept: &Bounds, now: &Bounds) -> bool {
    let (old, new) = (&kept.placement, &now.placement);
    // An empty scene has a place of its own.
    if kept.cloud.is_empty() != now.cloud.is_empty() {
        return false;
    }
    let away = glam::DVec3::from(new.centre).distance(glam::DVec3::from(old.centre));
    away + new.radius <= OUTGROWN * old.radius && new.radius >= SHRUNK * old.radius
}

#[cfg(test)]
mod tests {
    use scene::ParamValues;

    use super::*;
    use crate::point::DrawingPoint;
    use crate::view::space;
    use crate::viewpoint::Projection;

    const SPHERE: &str =
        "surface s(u, v) = (sin(v) cos(u), sin(v) sin(u), cos(v)), u : [-pi, pi], v : [0, pi];";
    const TUBE: &str = "surface s(u, v) = (5 cos(u), (5 + cos(v)) sin(u), 0.2 sin(v)),
        u : [0, 2 pi], v : [0, 2 pi];";
    const LINE: &str = "curve c(t) = (t, 1234, 0), t : [-1000, 1000];";

    #[test]
    fn a_declared_camera_sees_each_place_where_its_lens_does() {
        for (direction, roll) in [
            ("(-1, 4, -2)", "0"),
            ("(-1, 4, -2)", "pi/6"),
            ("(3, 0.1, 0.5)", "-2"),
            ("(0, 0, -1)", "0.7"),
        ] {
            let text = format!(
                "solid c(x, y, z) = max(abs x, abs y, abs z) - 1;
                 camera v = {direction} @ (1, -4, 2), fov : 0.9, roll : {roll};"
            );
            let scene = scene::geotrace::compile(&text).scene.expect("no errors");
            let params = ParamValues::initial(&scene);
            let options = crate::request::part::SpaceOptions::default();
            let request = PictureRequest::new(scene, params, options, [320, 240]);
            let bounds = space::bounds(&request);
            let camera = first_camera(&bounds, &Viewpoint::default(), &request).expect("a camera");
            let lens = declared_lens(&request).expect("a lens");
            for pixel in [[160.0, 120.0], [20.0, 30.0], [310.0, 200.0]] {
                let (origin, direction) = lens.ray(request.size, pixel, [0.5; 2]);
                let place = WorldPoint((origin + 3.0 * direction).to_array());
                let at = camera.pixel_of(camera.placement.local(place));
                let at = at.expect("before the eye").0;
                let off = (at[0] - pixel[0]).hypot(at[1] - pixel[1]);
                assert!(off < 1e-6, "{text}: {at:?}, not {pixel:?}");
            }
        }
    }

    #[test]
    fn the_first_camera_sees_the_whole_of_a_thick_curve() {
        let text = "curve k(t) = (2cos t, 2sin t, 0), t : [0, 2pi, 300], radius : 0.4 + 0.2cos t;";
        let scene = scene::geotrace::compile(text).scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        let options = crate::request::part::SpaceOptions::default();
        for size in [[600, 450], [200, 500]] {
            let request = PictureRequest::new(scene.clone(), params.clone(), options.clone(), size);
            let bounds = space::bounds(&request);
            let camera = first_camera(&bounds, &Viewpoint::default(), &request).expect("a camera");
            for k in 0..3600 {
                let (t, s) = (f64::from(k % 60), f64::from(k / 60));
                let [t, s] = [t, s].map(|angle| angle * std::f64::consts::TAU / 60.0);
                let radius = 0.4 + 0.2 * t.cos();
                let out = 2.0 + radius * s.cos();
                let place = WorldPoint([out * t.cos(), out * t.sin(), radius * s.sin()]);
                let place = camera.placement.local(place);
                assert!(camera.sees(place), "{size:?}: {t} {s}");
            }
        }
    }

    #[test]
    fn the_first_camera_sees_the_box_of_the_axes_with_all_its_words() {
        for (text, size) in [SPHERE, TUBE, LINE]
            .into_iter()
            .flat_map(|text| [[320, 240], [200, 900], [1440, 500]].map(|size| (text, size)))
        {
            let scene = scene::geotrace::compile(text).scene.expect("no errors");
            let params = ParamValues::initial(&scene);
            for projection in [Projection::Perspective, Projection::Orthographic] {
                let viewpoint = Viewpoint {
                    projection,
                    ..Viewpoint::default()
                };
                let options = crate::request::part::SpaceOptions::default();
                let mut request = PictureRequest::new(scene.clone(), params.clone(), options, size);
                request.scale = 1.5;
                let bounds = space::bounds(&request);
                let without = first_camera(&bounds, &viewpoint, &request);
                assert_eq!(without, Camera::new(&bounds, &viewpoint, size), "{text}");
                request.overlays.axes = true;
                let camera = first_camera(&bounds, &viewpoint, &request).expect("a camera");
                let corners = [bounds.half.map(|half| -half), bounds.half];
                let height = axis_height(&request);
                let axes = AxesBox::new(&camera, corners, [0, 1, 2], height);
                for place in axes.extent(&camera, height) {
                    let at = camera.pixel_of(DrawingPoint(place.to_array()));
                    let at = at.expect("before the eye").0;
                    let is_inside = |k: usize| (0.0..=f64::from(size[k])).contains(&at[k]);
                    assert!(
                        is_inside(0) && is_inside(1),
                        "{text} in {size:?}, {projection:?}: {at:?}"
                    );
                }
            }
        }
    }
}
