//! The 3D view: all objects in space, in perspective or orthographic.
//!
//! ```text
//! request ──framing──▶ drawing units ──samples──▶ gpu/ or software/ ──▶ picture ──overlay──▶ picture
//! ```

mod layers;

use std::sync::Arc;

use scene::{Object, ObjectId, Range, Sampling, Scene, Shape};

use super::{Hit, Key, SharedState, View, ViewRenderer};
use crate::bounds::Bounds;
use crate::camera::Camera;
use crate::content::{self, Content, Structure};
use crate::counters::PixelCounters;
use crate::declared_camera::camera_notes;
use crate::error::RenderError;
use crate::framing::Framed;
use crate::gpu::Pixels;
use crate::gpu::renderer::SpaceScene;
use crate::layers::Layers;
use crate::note::Note;
use crate::occlusion::Occlusion;
use crate::overlay::{self, AxesBox, KeyedCamera, LineMap, OverlayObject, TextLabel, axis_height};
use crate::placement::Placement;
use crate::plan::{self, Plan, object_plan};
use crate::point::{DrawingPoint, PixelPoint, WorldPoint};
use crate::rendered::RenderedImage;
use crate::request::part::SpaceOptions;
use crate::request::{Overlays, PictureRequest, ViewOptions, ViewPart};
use crate::sample::{Painter, Samples};
use crate::software::{self, Drawable};
use crate::solids::{SolidPainter, SolidScene, Tint};
use crate::stated_colours::StatedColours;
use crate::style::{self, Look, Theme};
use crate::texture::SurfaceImage;
use crate::viewpoint::GeodesicCamera;
use tracer::shade::Face;

pub use crate::framing::first_camera;

/// The view's name.
pub const NAME: &str = "3d";

/// Lines are drawn slightly in front of the surfaces they are on, and picked from a distance: a solid is picked instead of
/// an object that is behind it by more than this factor of its depth.
const NEARER: f32 = 1.02;

/// The assumed fraction of a software picture's work for its samples.
const SAMPLING_SHARE: f32 = 0.4;

/// The 3D view.
#[derive(Clone, Copy, Debug)]
pub struct SpaceView;

impl ViewOptions for SpaceOptions {
    fn view(&self) -> &'static str {
        NAME
    }

    fn space(&self) -> Option<&SpaceOptions> {
        Some(self)
    }

    fn space_mut(&mut self) -> Option<&mut SpaceOptions> {
        Some(self)
    }

    fn check(&self, _scene: &Scene) -> Result<(), RenderError> {
        self.camera.check()
    }
}

/// Returns the bounds of the objects that the framing of a view in space includes; for another request, those of the whole
/// scene.
pub fn bounds(request: &PictureRequest) -> Bounds {
    let request = &*request.with_scene_of_params();
    let options = request.view.space();
    Bounds::of_some(&request.scene, &request.params, |id| {
        options.is_none_or(|options| options.leaves_room(request, id))
    })
}

impl View for SpaceView {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "3D view"
    }

    fn purpose(&self) -> &'static str {
        "all objects in space, in perspective or orthographic"
    }

    fn shows(&self, scene: &Scene, object: &Object) -> bool {
        scene.is_in_space(object)
    }

    fn nothing(&self) -> &'static str {
        "A metric has no embedding: see its geodesic view"
    }

    fn options(&self, _object: Option<ObjectId>) -> ViewPart {
        SpaceOptions::default().into()
    }

    fn keys(&self) -> &'static [Key] {
        KEYS
    }

    fn plan(&self, request: &PictureRequest, plan: &mut Plan) {
        let (request, _) = &request.with_stated_colours();
        let Some(options) = request.view.get::<SpaceOptions>() else {
            return;
        };
        plan.overlays = overlay::painters(request, options.show_camera.as_ref());
        let mut images = Vec::new();
        for (id, object) in request.scene.numbered() {
            if !options.shows(id) {
                continue;
            }
            if object.shape.is_surface() {
                images.push(request.image_in_space(id));
            }
            let planned = object_plan(&request.scene, &request.params, id, object, plan.gpu);
            plan.objects.extend(planned);
        }
        plan.count_images(&images);
        plan.left_out
            .push("no resolve pass: the picture is the 3D view".to_owned());
    }

    fn renderer(&self) -> Box<dyn ViewRenderer> {
        Box::new(SpaceRenderer::default())
    }
}

/// The keys that move the camera.
pub(super) const KEYS: &[Key] = &[
    Key::new("W S", "forward, back"),
    Key::new("A D", "left, right"),
    Key::new("Q E", "up, down in the world"),
    Key::new("Arrows", "look around"),
    Key::new("Alt and arrows", "turn about the target"),
    Key::new("Shift and arrows", "sideways"),
    Key::new("+ −", "nearer, farther"),
    Key::new("F", "frame everything"),
    Key::new("R, Home", "reset"),
    Key::new(
        "Enter",
        "put the geodesic camera at the middle of the picture",
    ),
    Key::new("1 3 7 5 T", "front, right, top; orthographic; traced"),
    Key::new(
        "Ctrl+Enter",
        "show the declaration in the middle of the picture",
    ),
    Key::new(
        "Drag",
        "turn about the target; with View › Fly, look around",
    ),
    Key::new(
        "Alt and drag",
        "look around; with View › Fly, turn about the target",
    ),
    Key::new("Right, middle or Shift drag", "sideways"),
    Key::new("Wheel, pinch", "nearer to the pointer, farther"),
    Key::new("Two fingers", "sideways"),
    Key::new(
        "Click",
        "put the geodesic camera there; on other objects, show the declaration",
    ),
    Key::new("Double or Ctrl click", "show the declaration"),
];

/// The state of the 3D view between pictures.
#[derive(Debug, Default)]
struct SpaceRenderer {
    /// The objects that display a geodesic camera.
    camera: Option<(ShownCamera, Arc<[OverlayObject]>)>,
}

/// The inputs of the display of a geodesic camera in space.
#[derive(Clone, Debug, PartialEq)]
struct ShownCamera {
    manifold: Option<Content>,
    camera: GeodesicCamera,
    overlays: Overlays,
    theme: Theme,
    size: [u32; 2],
    placement: Placement,
}

impl ViewRenderer for SpaceRenderer {
    fn draw(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<RenderedImage, RenderError> {
        let request = &*shared.stated_colours.textured(request);
        let options: &SpaceOptions = request.options()?;
        let prepared = self.prepare(shared, request, options)?;
        let PreparedPicture {
            structures,
            framed,
            camera,
            overlay,
            ..
        } = &prepared;
        let background = options.background_light();
        let counters = shared.pixels.clone();
        let painter = prepared.painter(!request.moving, &counters);
        let (mut pixels, mut notes) = if let Some(gpu) = &mut shared.gpu {
            let looks = looks(request, options);
            let shown = |id: ObjectId| options.shows(id).then(|| &looks[id.index()]);
            let image = |id| image(request, framed, id);
            let scene = SpaceScene {
                request,
                structures,
                contents: framed.contents(),
                camera,
                shown: &shown,
                image: &image,
                overlay,
                solids: painter.as_ref(),
                background,
            };
            gpu.draw_space(&mut shared.samples, &scene, shared.is_single, progress)?
        } else {
            let sampled = |share: f32| progress(SAMPLING_SHARE * share);
            let moving = request.moving.then_some(camera);
            let (mut drawables, notes) =
                drawables(shared, request, options, framed, moving, &sampled);
            drawables.extend(prepared.extras(request));
            let drawn = |share| progress(SAMPLING_SHARE + (1.0 - SAMPLING_SHARE) * share);
            let solids = painter.as_ref();
            let image = software::draw_beside(camera, &drawables, solids, background, &drawn);
            (Pixels::Image(image), notes)
        };
        notes.extend(prepared.notes(request, options, painter.as_ref(), &shared.stated_colours)?);
        let words = prepared.words(shared, request, options);
        shared.samples.next();
        let mut overlays = overlay::names(overlay.iter());
        let mut legend = None;
        let shown = options.show_camera.as_ref();
        if overlay::any_space(request, shown) {
            let keyed = prepared.keyed_camera(options);
            let shown = keyed.as_ref();
            // Words are written over pictures in memory.
            let mut image = shared.read(pixels)?;
            legend = overlay::space_key_place(request, shown, &image, &words)?;
            let names = overlay::over_space(&mut image, request, shown, &words, legend)?;
            overlays.extend(names);
            pixels = Pixels::Image(image);
        }
        Ok(RenderedImage {
            notes: notes.into_iter().map(Note::Remark).collect(),
            overlays,
            legend,
            backend: shared.backend(),
            ..RenderedImage::new(pixels)
        })
    }

    fn layers(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Layers, RenderError> {
        self.draw_layers(shared, request, progress)
    }

    /// A point, vector or curve within [`software::NEAR`] pixels takes precedence over the surface there. Metrics are not
    /// visible in space, nor are hidden objects.
    fn pick(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        at: PixelPoint,
    ) -> Result<Option<Hit>, RenderError> {
        let options: &SpaceOptions = request.options()?;
        let structures = shared.structures.get(request.scene.arc());
        let framed = frame(shared, request, options, &structures);
        let camera = framed.camera(&options.camera, request)?;
        let (drawables, _) = drawables(shared, request, options, &framed, None, &|_| {});
        let picked = software::pick(&camera, &drawables, at);
        let solids = shared
            .solids
            .get(request, &options.hidden, framed.contents());
        if let Some(solids) = solids
            && let Some(hit) = picked_solid(shared, &camera, &solids, picked.as_ref(), at)
        {
            return Ok(Some(hit));
        }
        Ok(picked.map(|picked| Hit {
            leaf: None,
            object: ObjectId::new(picked.object),
            position: Some(camera.placement.world(picked.position)),
            parameters: parameters(&request.scene.objects[picked.object].shape, picked.shares),
            instance: picked.instance,
            polar: None,
        }))
    }

    fn camera(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
    ) -> Result<Option<Camera>, RenderError> {
        let options: &SpaceOptions = request.options()?;
        let structures = shared.structures.get(request.scene.arc());
        let framed = frame(shared, request, options, &structures);
        framed.camera(&options.camera, request).map(Some)
    }
}

/// The inputs from which a picture is drawn.
struct PreparedPicture {
    structures: Arc<[Structure]>,
    framed: Framed,
    camera: Camera,
    axes: Option<AxesBox>,
    /// The objects that are drawn in addition to those of the scene.
    overlay: Arc<[OverlayObject]>,
    /// The solids, with the tint of each.
    solids: Option<(Arc<SolidScene>, Vec<Tint>)>,
}

impl PreparedPicture {
    /// Returns the painter of the solids; `None` if there are none.
    fn painter<'a>(
        &'a self,
        is_fine: bool,
        counters: &'a PixelCounters,
    ) -> Option<SolidPainter<'a>> {
        let (solids, tints) = self.solids.as_ref()?;
        let camera = &self.camera;
        Some(SolidPainter::new(camera, solids, tints, is_fine, counters))
    }

    /// Returns the objects that are drawn in addition to those of the scene.
    fn extras(&self, request: &PictureRequest) -> impl Iterator<Item = Drawable> {
        self.overlay.iter().map(|object| {
            let look = object.look(request.scale);
            Drawable::new(object.samples.clone(), &look, None)
        })
    }

    /// Returns the displayed geodesic camera, for the key.
    fn keyed_camera<'a>(&'a self, options: &'a SpaceOptions) -> Option<KeyedCamera<'a>> {
        let camera = options.show_camera.as_ref()?;
        Some(KeyedCamera {
            camera,
            view: &self.camera,
            objects: &self.overlay,
        })
    }

    /// Returns the words at axes, figures and objects.
    fn words(
        &self,
        shared: &mut SharedState,
        request: &PictureRequest,
        options: &SpaceOptions,
    ) -> Vec<TextLabel> {
        let axes = self.axes.as_ref();
        let mut words = axes.map_or_else(Vec::new, |axes| {
            axes.labels(&self.camera, axis_height(request))
        });
        if is_labelled(request, &self.overlay) {
            let (framed, camera, extras) = (&self.framed, &self.camera, &self.overlay);
            words.extend(labels(shared, request, options, framed, camera, extras));
        }
        words
    }

    /// Returns the notes for the reader of the picture, other than those about samples. The picture has been drawn.
    fn notes(
        &self,
        request: &PictureRequest,
        options: &SpaceOptions,
        painter: Option<&SolidPainter<'_>>,
        colours: &StatedColours,
    ) -> Result<Vec<String>, RenderError> {
        let mut notes = colours.notes(request, &|id| options.shows(id));
        notes.extend(camera_notes(request));
        notes.extend(self.framed.notes(request, |id| options.shows(id)));
        if let Some(painter) = painter {
            notes.extend(painter.notes(request)?);
        }
        Ok(notes)
    }
}

impl SpaceRenderer {
    fn prepare(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        options: &SpaceOptions,
    ) -> Result<PreparedPicture, RenderError> {
        let structures = shared.structures.get(request.scene.arc());
        let framed = frame(shared, request, options, &structures);
        let camera = framed.camera(&options.camera, request)?;
        let axes = request.overlays.axes.then(|| framed.corners()).flatten();
        let axes = axes.map(|corners| {
            let height = axis_height(request);
            AxesBox::new(&camera, corners, request.scene.stated_axes(), height)
        });
        let overlay = self.overlay(request, options, &structures, &camera.placement)?;
        let overlay = match &axes {
            Some(axes) => {
                let ground = style::linear(request.axes_colour());
                overlay
                    .iter()
                    .cloned()
                    .chain([axes.object(ground)])
                    .collect()
            }
            None => overlay,
        };
        let solids = shared
            .solids
            .get(request, &options.hidden, framed.contents());
        let solids = solids.map(|solids| {
            let tints = tints(request, options, &solids);
            (solids, tints)
        });
        Ok(PreparedPicture {
            structures,
            framed,
            camera,
            axes,
            overlay,
            solids,
        })
    }

    /// Returns the objects that are drawn in addition to those of the scene: a displayed geodesic camera, and trails.
    fn overlay(
        &mut self,
        request: &PictureRequest,
        options: &SpaceOptions,
        structures: &[Structure],
        placement: &Placement,
    ) -> Result<Arc<[OverlayObject]>, RenderError> {
        let camera = match &options.show_camera {
            Some(camera) => self.shown_camera(request, camera, structures, placement)?,
            None => Arc::from([]),
        };
        let trails = overlay::trail_objects(request, placement);
        if trails.is_empty() {
            return Ok(camera);
        }
        Ok(camera.iter().cloned().chain(trails).collect())
    }

    fn shown_camera(
        &mut self,
        request: &PictureRequest,
        camera: &GeodesicCamera,
        structures: &[Structure],
        placement: &Placement,
    ) -> Result<Arc<[OverlayObject]>, RenderError> {
        let (scene, params) = (&request.scene, &request.params);
        let key = ShownCamera {
            manifold: content::first_instance(scene, params, structures, camera.surface),
            camera: *camera,
            overlays: request.overlays,
            theme: request.theme,
            size: request.size,
            placement: *placement,
        };
        if let Some((known, objects)) = &self.camera
            && *known == key
        {
            return Ok(objects.clone());
        }
        let objects: Arc<[OverlayObject]> =
            overlay::camera_objects(request, camera, placement)?.into();
        self.camera = Some((key, objects.clone()));
        Ok(objects)
    }
}

/// Frames the scene of a request of a view in space in the current bounds.
pub(super) fn framed(
    shared: &mut SharedState,
    request: &PictureRequest,
    options: &SpaceOptions,
) -> Framed {
    let structures = shared.structures.get(request.scene.arc());
    frame(shared, request, options, &structures)
}

/// Returns the colours of solids for a request. A solid with a specified colour keeps it, and is darkened at most.
fn tints(request: &PictureRequest, options: &SpaceOptions, solids: &SolidScene) -> Vec<Tint> {
    let colours = request.object_colours();
    let usual = style::linear(style::SOLID_COLOUR);
    let tint = |id: &ObjectId| {
        let object = request.scene.get(*id);
        let leaves = object.and_then(|object| object.shape.solid());
        let leaves = leaves.into_iter().flat_map(|solid| &solid.leaves);
        let mut attributes = leaves.flat_map(|leaf| &*leaf.attributes);
        let own = style::linear(colours[id.index()]);
        let factor = [0, 1, 2].map(|k| own[k] / usual[k]);
        let brightest = factor.into_iter().fold(0.0, f32::max).min(1.0);
        Tint {
            colour: match attributes.any(|it| it.word == "color") {
                true => [brightest; 3],
                false => factor,
            },
            emphasis: options.emphasis(*id),
        }
    };
    solids.objects().iter().map(tint).collect()
}

/// Returns the solid at a position in the picture, unless the picked object is in front of it.
fn picked_solid(
    shared: &SharedState,
    camera: &Camera,
    solids: &SolidScene,
    picked: Option<&software::Picked>,
    PixelPoint(at): PixelPoint,
) -> Option<Hit> {
    let painter = SolidPainter::new(camera, solids, &[], false, &shared.pixels);
    let hit = painter.hit(at)?;
    if let Some(picked) = picked
        && camera.depth_of(picked.position) * NEARER >= hit.depth
    {
        return None;
    }
    let face = Face::from(&hit.crossing);
    let owner = solids.owner(&face);
    Some(Hit {
        object: *solids.objects().get(hit.crossing.solid)?,
        position: Some(WorldPoint(face.position.to_array())),
        parameters: [0.0; 2],
        instance: owner.instance,
        leaf: owner.leaf.map(|leaf| leaf.index),
        polar: None,
    })
}

/// Frames the scene of a request in the current bounds.
fn frame(
    shared: &mut SharedState,
    request: &PictureRequest,
    options: &SpaceOptions,
    structures: &[Structure],
) -> Framed {
    let leaves_room = |id| options.leaves_room(request, id);
    shared.kept_bounds.frame(request, structures, leaves_room)
}

/// Returns the scene's objects with their samples, and notes for the reader of the picture. During motion, `moving` is the
/// camera, surfaces have fewer triangles where the difference is not visible, and their images are sampled coarsely.
fn drawables(
    shared: &mut SharedState,
    request: &PictureRequest,
    options: &SpaceOptions,
    framed: &Framed,
    moving: Option<&Camera>,
    progress: &dyn Fn(f32),
) -> (Vec<Drawable>, Vec<String>) {
    let (mut drawables, mut notes) = (Vec::new(), Vec::new());
    let placement = framed.bounds.placement;
    let scene = &request.scene;
    let looks = looks(request, options);
    for ((id, object), content) in scene.numbered().zip(framed.contents()) {
        if !options.shows(id) {
            // The object keeps its number.
            drawables.push(Drawable::nothing());
            continue;
        }
        let samples = &mut shared.samples;
        let sampled = samples.get(scene, &request.params, id, content, &placement);
        notes.extend(sampled.notes(object));
        let is_surface = object.shape.is_surface();
        let image = is_surface.then(|| image(request, framed, id));
        let look = &looks[id.index()];
        let stride = moving.map_or(1, |camera| {
            software::moving_stride(camera, &sampled.samples)
        });
        drawables.push(Drawable {
            is_coarse: moving.is_some(),
            stride,
            ..Drawable::new(sampled.samples, look, image)
        });
        progress(drawables.len() as f32 / scene.objects.len() as f32);
    }
    (drawables, notes)
}

/// Returns the looks of the scene's objects, in their order.
fn looks(request: &PictureRequest, options: &SpaceOptions) -> Vec<Look> {
    let colours = request.instance_colours().into_iter();
    let lines = style::line_styles(&request.scene, request.scale);
    let numbered = (0..).map(ObjectId::new).zip(colours.zip(lines));
    numbered
        .map(|(id, (colours, line))| Look {
            colours: colours.into_iter().map(style::linear).collect(),
            emphasis: options.emphasis(id),
            line,
        })
        .collect()
}

/// Returns the image of a surface, as [`PictureRequest::image_in_space`] does.
fn image(request: &PictureRequest, framed: &Framed, id: ObjectId) -> SurfaceImage {
    request.image_of_cloud(id, framed.object(id))
}

/// Returns true if a picture has labels, other than those of its axes.
pub(super) fn is_labelled(request: &PictureRequest, extras: &[OverlayObject]) -> bool {
    request.overlays.labels || extras.iter().any(|extra| extra.letter.is_some())
}

/// Returns the letters of figures; with labels, also the names of the visible objects, and that of the observer. They are
/// dim if a surface is in front of them, and beside the lines of the picture where there is room.
pub(super) fn labels(
    shared: &mut SharedState,
    request: &PictureRequest,
    options: &SpaceOptions,
    framed: &Framed,
    camera: &Camera,
    extras: &[OverlayObject],
) -> Vec<TextLabel> {
    let scene = &request.scene;
    let shown = scene.numbered().filter(|(id, _)| options.shows(*id));
    let clouds = shown.filter_map(|(id, _)| Some((id, framed.object(id)?)));
    let solids = shared
        .solids
        .get(request, &options.hidden, framed.contents());
    let occlusion = Occlusion::new(camera, clouds).with_solids(solids);
    let objects = scene.numbered().zip(framed.contents());
    let drawn = objects.filter(|((id, object), _)| options.shows(*id) && scene.is_in_space(object));
    let label = |((id, object), content): ((ObjectId, &Object), &Content)| {
        let samples = object.shape.is_geodesic().then(|| {
            let (store, params) = (&mut shared.samples, &request.params);
            store
                .get(scene, params, id, content, &camera.placement)
                .samples
        });
        let cloud = framed.object(id)?;
        let places = overlay::anchors(camera, &object.shape, cloud, samples.as_deref());
        // The name of a surface is at its edge, where the surface itself does not hide it.
        let is_face = object.shape.is_surface() || object.shape.solid().is_some();
        let except = is_face.then_some(id);
        let is_seen = |place: &&DrawingPoint| !occlusion.hides(**place, except);
        let seen = places.iter().find(is_seen);
        let place = *seen.or(places.first())?;
        let label = TextLabel::beside(camera.pixel_of(place)?, object.name.as_str());
        Some(label.hidden(seen.is_none()))
    };
    let mut all = overlay::letters(extras, camera, &occlusion);
    if request.overlays.labels {
        all.extend(drawn.filter_map(label));
        all.extend(overlay::here(extras, camera, &occlusion));
        let lines = Arc::new(lines(shared, request, options, framed, camera, extras));
        all = all.into_iter().map(|it| it.clear_of(&lines)).collect();
    }
    all
}

/// Returns where the picture has lines: curves, geodesics, vectors, and those that are drawn in addition.
fn lines(
    shared: &mut SharedState,
    request: &PictureRequest,
    options: &SpaceOptions,
    framed: &Framed,
    camera: &Camera,
    extras: &[OverlayObject],
) -> LineMap {
    /// An object with more samples is left out: it may cover its part of the picture, and on a GPU its samples are not here.
    const MOST_SAMPLES: u64 = 50_000;
    let (scene, params) = (&request.scene, &request.params);
    let mut lines = LineMap::new(request.size);
    for ((id, object), content) in scene.numbered().zip(framed.contents()) {
        let painter = Painter::for_object(scene, object);
        let is_line = matches!(painter, Some(Painter::Curves | Painter::Vectors));
        if is_line && options.shows(id) && plan::samples(scene, params, object) <= MOST_SAMPLES {
            let store = &mut shared.samples;
            let sampled = store.get(scene, params, id, content, &camera.placement);
            add_lines(&mut lines, camera, &sampled.samples);
        }
    }
    for extra in extras {
        add_lines(&mut lines, camera, &extra.samples);
    }
    lines
}

/// Adds the lines of an object's samples, which are in drawing units.
fn add_lines(lines: &mut LineMap, camera: &Camera, samples: &Samples) {
    let mut add = |ends: [[f64; 3]; 2]| {
        if let [Some(a), Some(b)] = ends.map(|place| camera.pixel_of(DrawingPoint(place))) {
            lines.add(a, b);
        }
    };
    match samples {
        Samples::Curves { count, samples } => {
            let lines = samples.chunks(*count as usize);
            for pair in lines.flat_map(|line| line.windows(2)) {
                let is_interrupted = pair[0].is_last() || pair.iter().any(|it| it.defined == 0.0);
                if !is_interrupted {
                    add([pair[0], pair[1]].map(|it| it.position.map(f64::from)));
                }
            }
        }
        Samples::Vectors(vectors) => {
            for vector in vectors {
                let [from, way] = [vector.origin, vector.direction].map(|it| it.map(f64::from));
                add([from, [0, 1, 2].map(|k| from[k] + way[k])]);
            }
        }
        Samples::Points(_) | Samples::Surfaces { .. } => {}
    }
}

/// Returns the parameters at fractions of the domain.
pub(super) fn parameters(shape: &Shape, shares: [f64; 2]) -> [f64; 2] {
    let value = |sampling: &Sampling, share: f64| {
        let Range { min, max } = sampling.range;
        // As in [`Sampling::value`], for intervals that may be wider than the largest number.
        (min * (1.0 - share) + max * share).clamp(min, max)
    };
    let mut parameters = [0.0; 2];
    for ((parameter, sampling), share) in parameters.iter_mut().zip(shape.domain()).zip(shares) {
        *parameter = value(sampling, share);
    }
    parameters
}
