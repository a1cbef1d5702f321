//! The default camera in space, for requests without one: it sees everything.
//!
//! In: a request. Out: the camera. It is kept for as long as everything that it depends on stays the same.

use std::sync::Arc;

use glam::DVec3;
use render::shared::Shared;
use render::view::space;
use render::viewpoint::{Projection, Viewpoint};
use render::{PictureRequest, RenderError};
use scene::{ObjectId, ParamValues, Scene};

use crate::camera::SpaceCamera;

/// Finds the camera from which everything is seen, and keeps the last one.
#[derive(Debug, Default)]
pub struct Framing {
    known: Option<(FramedScene, SpaceCamera)>,
}

/// All that determines the camera that sees everything.
#[derive(Clone, Debug, PartialEq)]
struct FramedScene {
    scene: Shared<Scene>,
    params: Arc<ParamValues>,
    size: [u32; 2],
    hidden: Vec<ObjectId>,
    /// The surfaces that leave room even if they are hidden: of the shown camera and of trails.
    occupied: Vec<ObjectId>,
    projection: Projection,
    /// The factors of the size of the lettering of axes, if there are any.
    axes: Option<[f32; 2]>,
    /// The name of the camera that the program declares, or `None` for its first one; the outer one if it does not count.
    declared: Option<Option<String>>,
}

/// The minimum distance of a camera's target, in radii of the scene.
const NEAREST_TARGET: f64 = 0.1;

impl Framing {
    /// Sets the camera that sees everything in a request of a view in space without a camera, and returns it.
    ///
    /// # Errors
    /// [`RenderError`] if there is no camera that sees the whole scene.
    pub fn fill_in(
        &mut self,
        request: &mut PictureRequest,
    ) -> Result<Option<SpaceCamera>, RenderError> {
        let space = request.view.space();
        if space.is_none_or(|space| space.camera.eye.is_some()) {
            return Ok(None);
        }
        let camera = self.camera(request, true)?;
        put_camera(request, &camera);
        Ok(Some(camera))
    }

    /// Returns the camera that sees everything that a request of a view in space shows, whatever camera the request has
    /// or the program declares; `None` for another view, or if there is none.
    pub fn of_everything(&mut self, request: &PictureRequest) -> Option<SpaceCamera> {
        // A declared camera need not see everything.
        request.view.space()?;
        self.camera(request, false).ok()
    }

    /// Returns the camera that sees everything that a request of a view in space shows, or with `with_declared` the one that
    /// the program declares, if there is one.
    fn camera(
        &mut self,
        request: &PictureRequest,
        with_declared: bool,
    ) -> Result<SpaceCamera, RenderError> {
        let key = FramedScene::new(request, with_declared);
        if let Some((known, camera)) = &self.known
            && *known == key
        {
            return Ok(*camera);
        }
        let viewpoint = Viewpoint {
            projection: key.projection,
            ..Viewpoint::default()
        };
        let mut request = request.clone();
        if !with_declared && !request.scene.stage.is_empty() {
            let mut scene = Scene::clone(&request.scene);
            scene.stage.clear();
            request.scene = scene.into();
        }
        let bounds = space::bounds(&request);
        let camera = space::first_camera(&bounds, &viewpoint, &request)?;
        let (centre, radius) = (
            DVec3::from(bounds.placement.centre),
            bounds.placement.radius,
        );
        let world = |place: DVec3| (centre + radius * place).to_array();
        let ahead = camera.eye.dot(camera.axes[2]);
        // A declared camera may look away from the centre of the scene.
        let ahead = if ahead > NEAREST_TARGET { ahead } else { 1.0 };
        let [across, upward] = camera.half_tangents();
        let right = camera.axes[0];
        let camera = SpaceCamera {
            eye: world(camera.eye),
            target: world(camera.eye - camera.axes[2] * ahead),
            radius,
            moved: false,
            tangent: across.min(upward),
            roll: 0.0,
        };
        let camera = camera.rolled(right);
        self.known = Some((key, camera));
        Ok(camera)
    }
}

/// Sets the camera in a request of a view in space.
pub fn put_camera(request: &mut PictureRequest, camera: &SpaceCamera) {
    if let Some(space) = request.view.space_mut() {
        space.camera = Viewpoint {
            projection: space.camera.projection,
            ..Viewpoint::new(camera.eye, camera.target)
        };
    }
}

impl FramedScene {
    fn new(request: &PictureRequest, with_declared: bool) -> Self {
        let space = request.view.space();
        let camera = space.and_then(|space| space.show_camera);
        let trails = request.trails.iter().map(|trail| trail.surface);
        Self {
            scene: request.scene.clone(),
            params: Arc::clone(&request.params),
            size: request.size,
            hidden: space.map_or(Vec::new(), |space| space.hidden.clone()),
            occupied: camera.iter().map(|it| it.surface).chain(trails).collect(),
            projection: space.map_or(Projection::default(), |space| space.camera.projection),
            axes: request
                .overlays
                .axes
                .then_some([request.scale, request.magnification]),
            declared: with_declared.then(|| space.and_then(|space| space.declared.clone())),
        }
    }
}

#[cfg(test)]
mod tests {
    use render::request::part::SpaceOptions;
    use render::viewpoint::GeodesicCamera;

    use super::*;
    use crate::reader::{Reader, SourceText};

    #[test]
    fn the_camera_is_found_again_for_all_that_it_depends_on() {
        let languages = ide::Languages::standard();
        let text = "surface far(u, v) = (u + 50, v, 0), u : [0, 1], v : [0, 1];
            solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;
            camera eye = (0, 1, 0) @ (0, -3, 0);";
        let text = SourceText {
            language: languages.default_language().as_ref(),
            text,
            changes: None,
        };
        let scene = Reader::default()
            .read(&text)
            .program
            .scene
            .expect("a scene");
        let far = scene
            .numbered()
            .find(|(_, it)| it.name == "far")
            .expect("it")
            .0;
        let params = Arc::new(ParamValues::initial(&scene));
        let hidden = SpaceOptions {
            hidden: vec![far],
            ..SpaceOptions::default()
        };
        let of = |options: &SpaceOptions| {
            PictureRequest::new(&scene, params.clone(), options.clone(), [900, 600])
        };
        let shown = SpaceOptions {
            show_camera: Some(GeodesicCamera::new(far)),
            ..hidden.clone()
        };
        let mut larger = of(&hidden);
        larger.overlays.axes = true;
        let mut largest = larger.clone();
        largest.scale = 3.0;
        let mut framing = Framing::default();
        let mut seen = Vec::new();
        for request in [of(&hidden), of(&shown), larger, largest] {
            let camera = framing.of_everything(&request).expect("a camera");
            assert_eq!(Framing::default().of_everything(&request), Some(camera));
            let declared = framing.fill_in(&mut request.clone()).expect("a camera");
            assert_eq!(declared.map(|it| it.eye), Some([0.0, -3.0, 0.0]));
            seen.push(camera.eye);
        }
        seen.dedup();
        assert_eq!(seen.len(), 4, "{seen:?}");
    }
}
