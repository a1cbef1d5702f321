//! The cameras that a program declares. In: a scene for rays, or a request. Out: a camera with its lens.

use geometry::solids::{RayScene, RaySceneOptions};
use glam::DVec3;
use scene::Shape;
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
    declared_camera(&staged(request)?, request.view.space()?.declared.as_deref())
}

/// Returns sentences about declared cameras that differ from their declarations.
pub(crate) fn camera_notes(request: &PictureRequest) -> Vec<String> {
    let stage = request.scene.stage.iter();
    let cameras = stage.filter(|object| matches!(object.shape, Shape::Camera(_)));
    let names: Vec<&str> = cameras.map(|camera| &*camera.name).collect();
    if names.is_empty() {
        return Vec::new();
    }
    let notes = staged(request).map_or_else(Vec::new, |rays| rays.notes());
    let notes = notes.into_iter();
    let of_cameras = notes.filter(|note| names.contains(&&*note.object));
    of_cameras.map(|note| note.to_string()).collect()
}

/// Returns the lights and cameras of a request's scene.
fn staged(request: &PictureRequest) -> Option<RayScene> {
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
    Some(RayScene::new(&request.scene, &request.params, &options))
}
