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
    known: Option<FramedScene>,
}

/// A camera that sees everything, and all that determines it.
#[derive(Debug)]
struct FramedScene {
    scene: Shared<Scene>,
    settings: Arc<ParamValues>,
    size: [u32; 2],
    hidden: Vec<ObjectId>,
    projection: Projection,
    has_axes: bool,
    declared: Option<String>,
    camera: SpaceCamera,
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
        let camera = self.camera(request)?;
        if let Some(space) = request.view.space_mut() {
            space.camera = Viewpoint {
                projection: space.camera.projection,
                ..Viewpoint::new(camera.eye, camera.target)
            };
        }
        Ok(Some(camera))
    }

    /// Returns the camera that sees everything that a request of a view in space shows, whatever camera the request has
    /// or the program declares; `None` for another view, or if there is none.
    pub fn of_everything(&mut self, request: &PictureRequest) -> Option<SpaceCamera> {
        let mut request = request.clone();
        if !request.scene.stage.is_empty() {
            // A declared camera need not see everything.
            let mut scene = Scene::clone(&request.scene);
            scene.stage.clear();
            request.scene = scene.into();
        }
        let space = request.view.space_mut()?;
        space.declared = None;
        (space.camera.eye, space.camera.target) = (None, None);
        self.camera(&request).ok()
    }

    /// Returns the camera that sees everything that a request of a view in space shows.
    fn camera(&mut self, request: &PictureRequest) -> Result<SpaceCamera, RenderError> {
        let space = request.view.space();
        let hidden = space.map_or(Vec::new(), |space| space.hidden.clone());
        let declared = space.and_then(|space| space.declared.clone());
        let projection = space.map_or(Projection::default(), |space| space.camera.projection);
        if let Some(known) = &self.known
            && known.scene == request.scene
            && known.settings == request.params
            && known.size == request.size
            && known.hidden == hidden
            && known.projection == projection
            && known.has_axes == request.overlays.axes
            && known.declared == declared
        {
            return Ok(known.camera);
        }
        let bounds = space::bounds(request);
        let viewpoint = Viewpoint {
            projection,
            ..Viewpoint::default()
        };
        let camera = space::first_camera(&bounds, &viewpoint, request)?;
        let (centre, radius) = (
            DVec3::from(bounds.placement.centre),
            bounds.placement.radius,
        );
        let world = |place: DVec3| (centre + radius * place).to_array();
        let ahead = camera.eye.dot(camera.axes[2]);
        // A declared camera may look away from the centre of the scene.
        let ahead = if ahead > NEAREST_TARGET { ahead } else { 1.0 };
        let [across, upward] = camera.half_tangents();
        let camera = SpaceCamera {
            eye: world(camera.eye),
            target: world(camera.eye - camera.axes[2] * ahead),
            radius,
            moved: false,
            tangent: across.min(upward),
        };
        self.known = Some(FramedScene {
            scene: request.scene.clone(),
            settings: Arc::clone(&request.params),
            size: request.size,
            hidden,
            projection,
            has_axes: request.overlays.axes,
            declared,
            camera,
        });
        Ok(camera)
    }
}
