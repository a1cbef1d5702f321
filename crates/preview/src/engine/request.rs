//! The request for a pane's picture: all that it shows, as data that can be compared. A picture is requested again only
//! where its request has changed.

use render::PictureRequest;
use render::request::{Overlays, Spacing, ViewPart};
use render::shared::Shared;
use render::texture::Texture;
use render::trail::Trail;
use render::view::geodesic::GeodesicOptions;
use render::view::space::SpaceOptions;
use render::viewpoint::{GeodesicCamera, PerspectiveCamera};
use scene::ObjectId;

use crate::engine::textures::Library;
use crate::state::pane::PaneKey;
use crate::state::{Choice, InsideCamera, Marks, Model};

/// Returns the request for the picture of a pane with so many pixels; nothing if there is nothing to be seen. `active` is
/// the surface whose geodesic camera the 3D view shows. While the view is `moving`, a picture at once is worth more than a
/// fine one.
pub(crate) fn picture_request(
    model: &mut Model,
    library: &mut Library,
    pane: &PaneKey,
    size: [u32; 2],
    active: Option<&str>,
    moving: bool,
) -> Option<PictureRequest> {
    let (view, trails) = match pane {
        PaneKey::Space => space_view(model, active)?,
        PaneKey::Inside(name) => geodesic_view(model, name)?,
    };
    let scene = model.scene.clone()?;
    let mut request = PictureRequest::new(&scene, model.settings()?, view, size);
    request.trails = trails;
    request.moving = moving;
    request.overlays = overlays(model.view.preferences.marks);
    let hidden = request.view.get::<SpaceOptions>();
    let hidden = hidden.map_or(Vec::new(), |options| options.hidden.clone());
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

/// The part of a request that belongs to its view, and the trails that the view shows.
type ViewAndTrails = (ViewPart, Vec<Shared<Trail>>);

fn space_view(model: &mut Model, active: Option<&str>) -> Option<ViewAndTrails> {
    let marks = model.view.preferences.marks;
    let shown = active.filter(|_| marks.cameras).and_then(|name| {
        let camera = model.settle_camera(name, false)?;
        Some(camera_on(model.object(name)?.0, &camera))
    });
    let scene = model.scene.as_ref()?;
    let id_of = |name: &str| scene.object(name).map(|(id, _)| id);
    let paths = model.paths.iter().filter(|_| marks.trail);
    let paths = paths.filter(|(name, _)| id_of(name).is_some());
    let camera = model.view.space;
    let background = model.view.preferences.background;
    let [r, g, b] = background.unwrap_or(render::style::BACKGROUND);
    let options = SpaceOptions {
        camera: PerspectiveCamera {
            eye: camera.map(|it| it.eye),
            target: camera.map(|it| it.target),
        },
        show_camera: shown,
        background: Some([r, g, b, 255]),
        highlight: model.highlighted.as_deref().and_then(id_of),
        hidden: model.hidden(),
    };
    let trails = paths.map(|(_, path)| Shared::from(&path.trail)).collect();
    Some((options.into(), trails))
}

fn geodesic_view(model: &mut Model, name: &str) -> Option<ViewAndTrails> {
    let marks = model.view.preferences.marks;
    let camera = model.settle_camera(name, true);
    let (surface, _) = model.object(name)?;
    // Where the surface has no place for a camera, the renderer says why.
    let camera = camera.map_or(GeodesicCamera::new(surface), |camera| {
        camera_on(surface, &camera)
    });
    let options = GeodesicOptions {
        mark_centre: marks.centre,
        ..GeodesicOptions::from(camera)
    };
    let path = model.paths.get(name).filter(|_| marks.trail);
    let trails = path.iter().map(|path| Shared::from(&path.trail)).collect();
    Some((options.into(), trails))
}

/// Returns a geodesic camera as a request has it.
pub(crate) fn camera_on(surface: ObjectId, camera: &InsideCamera) -> GeodesicCamera {
    GeodesicCamera::new(surface).with_frame(camera.frame())
}

fn overlays(marks: Marks) -> Overlays {
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
    if let Some(options) = request.view.get_mut::<SpaceOptions>() {
        options.highlight = None;
    }
    request
}

/// Returns whether two requests differ only by the geodesic camera that the 3D view shows, and its trail.
pub(crate) fn differ_by_shown_camera(before: &PictureRequest, after: &PictureRequest) -> bool {
    let mut like = before.clone();
    if let (Some(options), Some(other)) = (
        like.view.get_mut::<SpaceOptions>(),
        after.view.get::<SpaceOptions>(),
    ) {
        options.show_camera = other.show_camera;
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
