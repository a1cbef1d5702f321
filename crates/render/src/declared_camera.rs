//! The cameras that a program declares. In: a scene for rays, or a request. Out: a camera with its lens.

use geometry::solids::{RayScene, RaySceneOptions};
use glam::DVec3;
use tracer::camera::LensCamera;

use crate::request::PictureRequest;

/// Returns the declared camera of a name, or the first one.
pub(crate) fn declared_camera(rays: &RayScene, name: Option<&str>) -> Option<LensCamera> {
    let mut cameras = rays.cameras().iter();
    let found = match name {
        Some(name) => cameras.find(|camera| camera.name == name),
        None => cameras.next(),
    };
    found.map(|camera| camera.lens)
}

/// Returns the camera that the scene of a request declares, as the request names it.
pub(crate) fn declared_lens(request: &PictureRequest) -> Option<LensCamera> {
    if request.scene.stage.is_empty() {
        return None;
    }
    let options = RaySceneOptions {
        shown: &|_| false,
        colour: &|_| DVec3::ONE,
        thickness: None,
        stage: true,
        picture_look: Default::default(),
    };
    let rays = RayScene::new(&request.scene, &request.params, &options);
    declared_camera(&rays, request.view.space()?.declared.as_deref())
}
