//! The request for a view's picture: everything that it shows, as data that can be compared. A picture is requested
//! again only if its request has changed.

use render::geodesic_view::{PlacedCamera, PlacedSolidCamera};
use render::request::{Overlays, Spacing, ViewPart};
use render::shared::Shared;
use render::style::{self, Theme};
use render::trail::Trail;
use render::viewpoint::{GeodesicCamera, Pose, Projection, Viewpoint};
use render::{PictureRequest, ViewId, Views};
use scene::{Object, ObjectId, Scene};

use crate::model::Emphasis;
use crate::textures::{ImageSource, Library};
use crate::{Marks, Model, TextureChoice};

/// A pane for which a picture is requested.
#[derive(Clone, Copy, Debug)]
pub struct PaneRequest<'a> {
    /// The view that it shows.
    pub id: &'a ViewId,
    /// The picture's width and height in pixels.
    pub size: [u32; 2],
    /// The surface whose geodesic camera the views in space show.
    pub active: Option<&'a str>,
}

/// Returns the request for the picture of a pane at rest; nothing if there is nothing to see.
pub fn picture_request(
    model: &mut Model,
    library: &mut Library<impl ImageSource>,
    views: &Views,
    pane: PaneRequest<'_>,
) -> Option<PictureRequest> {
    let id = pane.id;
    let scene = model.scene.clone()?;
    let other = views.instead_of(&id.kind);
    let other = other.filter(|_| id.object.is_none() && model.choices.preferences.traced);
    let mut view = match other {
        Some(other) => other.options(None),
        None => views.options(id, &scene)?,
    };
    let marks = model.choices.preferences.marks.clone();
    for setting in views.get(&id.kind)?.settings() {
        view.set(setting.name, marks.is_on(setting));
    }
    // The surface of the view's own camera, or else the one whose camera it shows.
    let own = id.object.as_deref();
    let own = own.filter(|_| view.geodesic_camera().is_some());
    let shown = pane.active;
    let shown = shown.filter(|_| marks.cameras && view.space().is_some());
    // If no camera can be on the surface, the renderer says why.
    if let Some(name) = own.or(shown)
        && let Some(camera) = model.settle_camera(name, own.is_some())
        && let Some((surface, _)) = scene.object(name)
    {
        view.show_camera(camera.on(surface));
    }
    let hidden = show_space(model, &scene, &mut view);
    let is_in_space = view.space().is_some();
    let mut request = PictureRequest::new(&scene, model.param_values()?, view, pane.size);
    request.trails = trails(model, &scene, &marks, own, is_in_space);
    request.images = library.named(&scene);
    request.overlays = overlays(&marks);
    // A dense display has more pixels, in which lines and words are larger; the scale that the user has chosen is beyond that.
    request.scale = model.choices.preferences.scale;
    request.colours = colours(model, own.is_none());
    request.colours.retain(|(id, _)| !hidden.contains(id));
    add_textures(&mut request, model, library, &hidden);
    Some(request)
}

/// Sets the camera, the background, the highlighted and the hidden objects of a view in space. Returns the hidden ones.
fn show_space(model: &Model, scene: &Scene, view: &mut ViewPart) -> Vec<ObjectId> {
    let Some(space) = view.space_mut() else {
        return Vec::new();
    };
    let camera = model.choices.space;
    let camera = camera.filter(|_| !model.follows_declared_camera());
    space.declared = model.declared_camera().map(|camera| camera.name.clone());
    let [r, g, b] = model.background();
    space.camera = Viewpoint {
        eye: camera.map(|it| it.eye.into()),
        target: camera.map(|it| it.target.into()),
        projection: match model.choices.preferences.orthographic {
            true => Projection::Orthographic,
            false => Projection::Perspective,
        },
    };
    space.background = Some([r, g, b, 255]);
    let highlighted = model.highlighted.as_deref();
    let highlighted = highlighted.filter(|_| model.emphasis != Emphasis::Off);
    let highlighted = highlighted.and_then(|name| scene.object(name));
    space.highlight = highlighted.map(|(id, _)| id);
    space.hidden = model.hidden();
    space.hidden.clone()
}

/// Returns the paths and figures that a view shows: those on its own surface, or in space those on all surfaces.
fn trails(
    model: &Model,
    scene: &Scene,
    marks: &Marks,
    own: Option<&str>,
    is_in_space: bool,
) -> Vec<Shared<Trail>> {
    let has_trail = |name: &str| match own {
        Some(own) => own == name,
        None => is_in_space && scene.object(name).is_some(),
    };
    let paths = model.paths.iter();
    let paths = paths.filter(|(name, _)| marks.trail && has_trail(name));
    let walked = paths.map(|(_, path)| &path.trail);
    let measured = model.measured.iter().filter(|(name, _)| has_trail(name));
    let measured = measured.flat_map(|(_, lines)| lines);
    walked.chain(measured).map(Shared::from).collect()
}

/// Adds the textures that are chosen for the surfaces that are not hidden.
fn add_textures(
    request: &mut PictureRequest,
    model: &Model,
    library: &mut Library<impl ImageSource>,
    hidden: &[ObjectId],
) {
    let scene = request.scene.clone();
    for (id, object) in scene.numbered().filter(|(id, _)| !hidden.contains(id)) {
        if object.shape.manifold().is_some() {
            if model.choices.look(&object.name).flipped {
                request.flipped.push(id);
            }
            let choice = model.choices.texture(&object.name);
            if *choice == TextureChoice::Curvature {
                request.curved.push(id);
            }
            if *choice != TextureChoice::Default
                && let Some(texture) = library.texture(choice)
            {
                request.textures.push((id, texture.into()));
            }
        }
    }
}

/// Returns the colours of objects for which one is chosen. With `dims`, objects that are out of date are dimmed.
fn colours(model: &Model, dims: bool) -> Vec<(ObjectId, [u8; 3])> {
    let Some(scene) = &model.scene else {
        return Vec::new();
    };
    let stale = model.faults.stale();
    let defaults = style::colours(scene, Theme::Screen, model.shows_curvature());
    let colour = |(id, object): (ObjectId, &Object)| {
        let look = model.choices.looks.get(&object.name);
        // The colours of curvature are dimmed only.
        let is_curved = *model.choices.texture(&object.name) == TextureChoice::Curvature;
        let chosen = look.and_then(|look| look.colour.filter(|_| !is_curved));
        if dims && stale.contains(&object.name) {
            let colour = chosen.unwrap_or(defaults[id.index()]);
            return Some((id, style::dimmed(colour)));
        }
        chosen.map(|colour| (id, colour))
    };
    scene.numbered().filter_map(colour).collect()
}

fn overlays(marks: &Marks) -> Overlays {
    Overlays {
        legend: marks.legend,
        wavefronts: marks.wavefronts.then_some(Spacing::Auto),
        conjugate_points: marks.conjugate,
        cut_locus: marks.cut_locus,
        error: marks.error,
        labels: marks.labels,
        axes: marks.axes,
        hidden_lines: false,
    }
}

/// Returns the request for a picture that is saved: of a view at rest, with no object highlighted or dimmed, without
/// overlays that the view does not draw, and with a geodesic camera that is specified by an angle.
pub fn at_rest(mut request: PictureRequest, model: &Model, size: [u32; 2]) -> PictureRequest {
    request.size = size;
    (request.moving, request.magnification) = (false, 1.0);
    if request.view.samples().is_some() {
        request.view.set_samples(model.choices.preferences.samples);
    }
    request.colours = colours(model, false);
    if let Some(space) = request.view.space_mut() {
        space.highlight = None;
    }
    let shown = request.view.shown_camera().copied();
    request.overlays = request.view.drawn(request.overlays);
    let placed = |camera: GeodesicCamera| {
        let (scene, params) = (&request.scene, &request.params);
        if let Pose::SpaceFrame(_) = camera.pose {
            let placed = PlacedSolidCamera::new(scene, params, &camera, size);
            return Some(placed.ok()?.by_angle());
        }
        let placed = PlacedCamera::new(scene, params, &camera, size)
            .ok()?
            .by_angle();
        PlacedCamera::new(scene, params, &placed, size)
            .is_ok()
            .then_some(placed)
    };
    if let Some(camera) = shown.and_then(placed) {
        request.view.show_camera(camera);
    }
    request
}

/// Returns whether two requests of a view in space differ only by the geodesic camera that it shows, and its trail.
pub fn differ_by_shown_camera(before: &PictureRequest, after: &PictureRequest) -> bool {
    let mut like = before.clone();
    if let (Some(space), Some(other)) = (like.view.space_mut(), after.view.space()) {
        space.show_camera = other.show_camera;
        like.trails.clone_from(&after.trails);
    }
    before != after && like == *after
}

/// Returns whether two requests are for the same picture, at any size and number of samples.
pub fn differ_by_refinement(a: &PictureRequest, b: &PictureRequest) -> bool {
    let mut like = a.clone();
    like.size = b.size;
    like.moving = b.moving;
    like.magnification = b.magnification;
    if let Some(samples) = b.view.samples() {
        like.view.set_samples(samples);
    }
    like == *b
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use render::ViewId;

    use super::{PaneRequest, colours, picture_request, style};
    use crate::Model;
    use crate::reader::{Reader, SourceText};
    use crate::textures::{ImageSource, ImageState, Library};

    struct NoImages;

    impl ImageSource for NoImages {
        fn file_of(&self, _word: &str) -> Option<PathBuf> {
            None
        }

        fn has(&self, _word: &str) -> bool {
            false
        }

        fn read(&mut self, path: &Path) -> ImageState {
            unreachable!("{path:?} is not chosen")
        }
    }

    #[test]
    fn words_in_pictures_follow_the_interface_scale() {
        let text = "point p = (0, 0, 0);";
        let languages = ide::Languages::standard();
        let source = SourceText {
            language: &**languages.default_language(),
            text,
            changes: None,
        };
        let mut model = Model::default();
        let read = Reader::default().read(&source);
        model.take(read.compiled(1, text.into()));
        let views = render::Views::standard();
        let id = ViewId::of_scene(views.first().name());
        let pane = PaneRequest {
            id: &id,
            size: [64; 2],
            active: None,
        };
        let mut library = Library::new(NoImages);
        for scale in [1.0, 2.0] {
            model.adjust(|choices| choices.preferences.scale = scale);
            let request = picture_request(&mut model, &mut library, &views, pane);
            assert_eq!(request.expect("a picture").scale, scale);
        }
    }

    /// The names of the objects that have a colour in a request, with that colour.
    fn coloured(model: &Model, dims: bool) -> Vec<(String, [u8; 3])> {
        let scene = model.scene.as_ref().expect("a scene");
        let name = |(id, colour): (scene::ObjectId, _)| {
            let object = &scene.objects[id.index()];
            (object.name.clone(), colour)
        };
        colours(model, dims).into_iter().map(name).collect()
    }

    #[test]
    fn only_what_depends_on_a_fault_is_dim() {
        let good = "param r : [1, 2];
point p = (r, 0, 0);
point q = (0, 0, 0);
point o = (0, r, 0);
define unused = 1;
";
        let languages = ide::Languages::standard();
        let mut model = Model::default();
        model.adjust(|choices| {
            choices.looks.entry("o".into()).or_default().colour = Some([200, 100, 50])
        });
        let mut reader = Reader::default();
        let mut take = |model: &mut Model, version, text: String| {
            let source = SourceText {
                language: &**languages.default_language(),
                text: &text,
                changes: None,
            };
            let read = reader.read(&source);
            model.take(read.compiled(version, text.as_str().into()));
            model.faults.show_latest();
        };
        take(&mut model, 1, good.to_owned());
        let chosen = vec![("o".to_owned(), [200, 100, 50])];
        assert_eq!(coloured(&model, true), chosen);
        take(&mut model, 2, good.replace("unused = 1", "unused = 1 +"));
        assert_eq!(coloured(&model, true), chosen, "nothing depends on it");
        take(&mut model, 3, good.replace("(r, 0, 0)", "(r, 0, 0"));
        let names = |model: &Model| -> Vec<String> {
            coloured(model, true).into_iter().map(|it| it.0).collect()
        };
        assert_eq!(names(&model), ["p", "o"]);
        take(&mut model, 4, good.replace("[1, 2]", "[1, 2"));
        let all = coloured(&model, true);
        let dim = style::dimmed([200, 100, 50]);
        assert_eq!(names(&model), ["p", "o"]);
        assert_eq!(all[1].1, dim);
        assert_eq!(coloured(&model, false), chosen, "a picture that is kept");
    }
}
