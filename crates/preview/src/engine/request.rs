//! The request for a view's picture: all that it shows, as data that can be compared. A picture is requested again only
//! where its request has changed.

use render::request::{Overlays, Spacing};
use render::shared::Shared;
use render::texture::Texture;
use render::viewpoint::{GeodesicCamera, PerspectiveCamera};
use render::{PictureRequest, ViewId, Views};
use scene::ObjectId;

use crate::engine::textures::Library;
use crate::state::{Choice, InsideCamera, Marks, Model};

/// Returns the request for the picture of a view with so many pixels; nothing if there is nothing to be seen. `active` is
/// the surface whose geodesic camera the views in space show. While the view is `moving`, a picture at once is worth more
/// than a fine one.
pub(crate) fn picture_request(
    model: &mut Model,
    library: &mut Library,
    views: &Views,
    id: &ViewId,
    size: [u32; 2],
    active: Option<&str>,
    moving: bool,
) -> Option<PictureRequest> {
    let scene = model.scene.clone()?;
    let mut view = views.options(id, &scene)?;
    let marks = model.view.preferences.marks.clone();
    for setting in views.get(&id.kind)?.settings() {
        view.set(setting.name, marks.is_on(setting));
    }
    // The surface that the view is seen from, else the one whose camera it shows.
    let own = id.object.as_deref();
    let own = own.filter(|_| view.geodesic_camera().is_some());
    let shown = active.filter(|_| marks.cameras && view.space().is_some());
    // Where a surface has no place for a camera, the renderer says why.
    if let Some(name) = own.or(shown)
        && let Some(camera) = model.settle_camera(name, own.is_some())
        && let Some((surface, _)) = scene.object(name)
    {
        view.show_camera(camera_on(surface, &camera));
    }
    let mut hidden = Vec::new();
    if let Some(space) = view.space_mut() {
        let camera = model.view.space;
        let background = model.view.preferences.background;
        let [r, g, b] = background.unwrap_or(render::style::BACKGROUND);
        space.camera = PerspectiveCamera {
            eye: camera.map(|it| it.eye.into()),
            target: camera.map(|it| it.target.into()),
        };
        space.background = Some([r, g, b, 255]);
        let highlighted = model.highlighted.as_deref();
        let highlighted = highlighted.and_then(|name| scene.object(name));
        space.highlight = highlighted.map(|(id, _)| id);
        hidden = model.hidden();
        space.hidden.clone_from(&hidden);
    }
    let has_trail = |name: &str| match own {
        Some(own) => own == name,
        None => view.space().is_some() && scene.object(name).is_some(),
    };
    let paths = model.paths.iter();
    let paths = paths.filter(|(name, _)| marks.trail && has_trail(name));
    let walked = paths.map(|(_, path)| &path.trail);
    let measured = model.measured.iter().filter(|(name, _)| has_trail(name));
    let measured = measured.flat_map(|(_, lines)| lines);
    let trails = walked.chain(measured).map(Shared::from).collect();
    let mut request = PictureRequest::new(&scene, model.settings()?, view, size);
    request.trails = trails;
    request.moving = moving;
    request.overlays = overlays(&marks);
    for (id, object) in scene.numbered().filter(|(id, _)| !hidden.contains(id)) {
        let look = model.view.looks.get(&object.name);
        if let Some(colour) = look.and_then(|look| look.colour) {
            request.colours.push((id, colour));
        }
        if object.shape.manifold().is_some() {
            let choice = model.view.texture(&object.name);
            if *choice == Choice::Curvature {
                request.curved.push(id);
            }
            if *choice != Choice::Default
                && let Some(texture) = library.texture(choice)
            {
                request.textures.push((id, texture.into()));
            }
        }
    }
    Some(request)
}

/// Returns a geodesic camera as a request has it.
pub(crate) fn camera_on(surface: ObjectId, camera: &InsideCamera) -> GeodesicCamera {
    GeodesicCamera::new(surface).with_frame(camera.frame())
}

fn overlays(marks: &Marks) -> Overlays {
    Overlays {
        legend: marks.legend,
        wavefronts: marks.wavefronts.then_some(Spacing::Auto),
        conjugate_points: marks.conjugate,
        cut_locus: marks.cut_locus,
        error: marks.error,
    }
}

/// Returns the request for a picture that is kept: of a view at rest, with no object highlighted.
pub(crate) fn at_rest(mut request: PictureRequest, size: [u32; 2]) -> PictureRequest {
    request.size = size;
    request.moving = false;
    if let Some(space) = request.view.space_mut() {
        space.highlight = None;
    }
    request
}

/// Returns whether two requests of a view in space differ only by the geodesic camera that it shows, and its trail.
pub(crate) fn differ_by_shown_camera(before: &PictureRequest, after: &PictureRequest) -> bool {
    let mut like = before.clone();
    if let (Some(space), Some(other)) = (like.view.space_mut(), after.view.space()) {
        space.show_camera = other.show_camera;
        like.trails.clone_from(&after.trails);
    }
    before != after && like == *after
}

/// Returns a request whose surfaces have the textures of curvature as images, for a mesh.
pub(crate) fn with_curvatures(mut request: PictureRequest) -> PictureRequest {
    for id in std::mem::take(&mut request.curved) {
        // A surface whose derivatives are too large shows what it would show otherwise.
        if let Ok(texture) = Texture::curvature(&request.scene, &request.params, id) {
            request.textures.push((id, texture.into()));
        }
    }
    request
}
