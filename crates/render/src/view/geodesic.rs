//! The geodesic view of a surface, a metric or a solid: the exponential map, as seen by an observer inside it.
//!
//! ```text
//! GeodesicCamera ──cache.rs──▶ PlacedCamera, RayEnds ──resolve (CPU, or a pass on the GPU)──▶ picture ──overlay──▶ picture
//! ```

mod cache;
mod solid_colours;

use ::geodesic::piecewise::table::code_of;
use ::geodesic::trace::{Options, Status};
use geometry::ManifoldError;
use scene::{Object, ObjectId, Scene};

use super::{Hit, Key, Setting, SharedState, View, ViewRenderer};
use crate::error::RenderError;
use crate::geodesic_view::{self, Cover, Paint, PictureMethod, RayEnds, count, notes};
use crate::gpu::Pixels;
use crate::gpu::geodesic::ResolveTask;
use crate::note::Note;
use crate::overlay::{self, GeodesicOverlay};
use crate::plan::{GeodesicPlan, Plan, derivative_operations};
use crate::point::{PixelPoint, WorldPoint};
use crate::rendered::{BackendUsed, RenderedImage};
use crate::request::{PictureRequest, ViewOptions, ViewPart};
use crate::style;
use crate::texture::SurfaceImage;
use crate::viewpoint::GeodesicCamera;
use cache::{CachedMap, MapCache, SolidMapCache};
use solid_colours::resolve_solid;

/// The view's name.
pub const NAME: &str = "geodesic";

/// The assumed fraction of a picture's work for following geodesics.
const FOLLOWING_SHARE: f32 = 0.9;

/// The geodesic view.
#[derive(Clone, Copy, Debug)]
pub struct GeodesicView;

/// The options of a geodesic picture beyond those of all pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct GeodesicOptions {
    /// The camera.
    pub camera: GeodesicCamera,
    /// The method by which the geodesics are integrated.
    pub method: PictureMethod,
    /// True if the centre is marked with an open ring.
    pub mark_centre: bool,
}

impl GeodesicOptions {
    /// Creates the options of an initial picture of a surface or metric.
    pub fn new(surface: ObjectId) -> Self {
        GeodesicCamera::new(surface).into()
    }
}

impl From<GeodesicCamera> for GeodesicOptions {
    fn from(camera: GeodesicCamera) -> Self {
        Self {
            camera,
            method: PictureMethod::Fan,
            mark_centre: true,
        }
    }
}

impl ViewOptions for GeodesicOptions {
    fn view(&self) -> &'static str {
        NAME
    }

    fn geodesic_camera(&self) -> Option<&GeodesicCamera> {
        Some(&self.camera)
    }

    fn geodesic_camera_mut(&mut self) -> Option<&mut GeodesicCamera> {
        Some(&mut self.camera)
    }

    fn method(&self) -> Option<PictureMethod> {
        Some(self.method)
    }

    fn set(&mut self, setting: &str, on: bool) -> bool {
        let known = setting == MARK_CENTRE.name;
        if known {
            self.mark_centre = on;
        }
        known
    }

    fn is_on(&self, setting: &str) -> Option<bool> {
        (setting == MARK_CENTRE.name).then_some(self.mark_centre)
    }

    fn check(&self, scene: &Scene) -> Result<(), RenderError> {
        self.camera.check(scene)
    }
}

/// The mark of the centre, as a setting.
const MARK_CENTRE: Setting = Setting {
    name: "centre",
    title: "Ring at the centre",
    default: true,
};

impl View for GeodesicView {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "Geodesic view"
    }

    fn purpose(&self) -> &'static str {
        "a surface from inside: each pixel looks along a geodesic from the camera in the centre"
    }

    fn object_kind(&self) -> Option<&'static str> {
        Some("surface, metric or solid")
    }

    fn shows(&self, _scene: &Scene, object: &Object) -> bool {
        object.shape.has_inside()
    }

    /// A scene may have many solids, and most are viewed from outside.
    fn opens_by_itself(&self, object: &Object) -> bool {
        object.shape.manifold().is_some()
    }

    fn options(&self, object: Option<ObjectId>) -> ViewPart {
        GeodesicOptions::new(object.unwrap_or(ObjectId::new(u32::MAX as usize))).into()
    }

    fn keys(&self) -> &'static [Key] {
        KEYS
    }

    fn settings(&self) -> &'static [Setting] {
        &[MARK_CENTRE]
    }

    fn plan(&self, request: &PictureRequest, plan: &mut Plan) {
        let Some(options) = request.view.get::<GeodesicOptions>() else {
            return;
        };
        let surface = options.camera.surface;
        plan.geodesic = Some(GeodesicPlan {
            surface,
            is_table: options.method.is_fan(),
            derivative_operations: derivative_operations(&request.scene, surface),
        });
        let texture = request.texture_inside(surface);
        plan.count_images(&[SurfaceImage::open(texture)]);
    }

    fn renderer(&self) -> Box<dyn ViewRenderer> {
        Box::new(GeodesicRenderer::default())
    }
}

/// The keys that move the camera.
const KEYS: &[Key] = &[
    Key::new("W S", "along Y, against it"),
    Key::new("A D", "against X, along it"),
    Key::new("Q E", "turn anticlockwise, clockwise"),
    Key::new("Z X", "zoom in, out"),
    Key::new("Arrows", "move"),
    Key::new("+ −", "zoom in, out"),
    Key::new("R, Home", "reset"),
    Key::new("Ctrl+Enter", "show the declaration"),
    Key::new("Drag", "move"),
    Key::new("Wheel, pinch", "zoom about the middle"),
    Key::new("Two fingers", "move"),
    Key::new("Double or Ctrl click", "show the declaration"),
];

/// The state of geodesic views between pictures.
#[derive(Debug, Default)]
struct GeodesicRenderer {
    maps: MapCache,
    solids: SolidMapCache,
}

impl ViewRenderer for GeodesicRenderer {
    fn draw(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<RenderedImage, RenderError> {
        let request = &*shared.stated_colours.textured(request);
        let Some(options) = request.view.get::<GeodesicOptions>() else {
            return Err(ManifoldError::NoSurface { name: None }.into());
        };
        let followed = |share: f32| progress(FOLLOWING_SHARE * share);
        if request.scene.is_solid(options.camera.surface) {
            return self.draw_solid(shared, request, options, &followed);
        }
        let map = self.maps.get(shared, request, options, &followed)?;
        self.maps.next();
        let image = match &*map.ends {
            RayEnds::Piecewise { .. } if shared.gpu.is_some() => {
                by_gpu(shared, request, options, &map, progress)?
            }
            _ => by_software(shared, request, options, &map),
        };
        progress(1.0);
        let surface = options.camera.surface;
        let on_it = |id| request.scene.geodesics_on(surface).any(|(it, _)| it == id);
        let is_shown = |id| id == surface || on_it(id);
        let colours = shared.stated_colours.notes(request, &is_shown).into_iter();
        let mut notes = image.notes;
        notes.extend(colours.map(Note::Remark));
        Ok(RenderedImage {
            notes,
            geodesics: Some((map.ends.work(), map.ends.estimate())),
            ..image
        })
    }

    /// Returns the end of the pixel's geodesic; `None` if the geodesic does not reach the pixel's distance.
    fn pick(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        at: PixelPoint,
    ) -> Result<Option<Hit>, RenderError> {
        let Some(options) = request.view.get::<GeodesicOptions>() else {
            return Err(ManifoldError::NoSurface { name: None }.into());
        };
        if request.scene.is_solid(options.camera.surface) {
            return self.pick_solid(shared, request, options, at);
        }
        let structures = shared.structures.get(request.scene.arc());
        let camera = self.maps.place(request, options, &structures)?;
        let [x, y] = camera.picture_place(at);
        let distance = camera.zoom * x.hypot(y);
        let towards = if distance > 0.0 { [x, y] } else { [1.0, 0.0] };
        let surface = camera.manifold().surface();
        let trace = camera
            .frame
            .trace(surface, towards, distance, &Options::default());
        let reached = trace.ok().filter(|it| it.status == Status::Complete);
        Ok(reached.map(|trace| Hit {
            object: camera.surface,
            position: trace.position.map(WorldPoint),
            parameters: trace.uv.0,
            instance: 0,
            leaf: None,
            polar: Some([distance, y.atan2(x)]),
        }))
    }
}

impl GeodesicRenderer {
    /// Draws the view of a solid, on the CPU: there are few rays, and colours are expressions in space.
    fn draw_solid(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        options: &GeodesicOptions,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<RenderedImage, RenderError> {
        let (camera, map) = &*self.solids.get(shared, request, options, progress)?;
        let structures = shared.structures.get(request.scene.arc());
        let (scene, id) = (&request.scene, camera.object);
        let content =
            structures[id.index()].instances(scene, &request.params, &scene.objects[id.index()]);
        let solid = shared.solids.inside(request, id, content);
        let mut image = resolve_solid(request, &solid, camera, map, options.mark_centre);
        shared.pixels.count_ends(map.status.len());
        let count = count(&map.status);
        let mut notes = geodesic_view::notes(map.status.len(), count, &map.work, map.estimate);
        let mut follow =
            |id, sampling: &_| self.solids.followed(request, &structures, id, sampling);
        let (remarks, overlays) =
            overlay::over_solid(&mut image, request, camera, map, &mut follow);
        let on_it = |id| scene.geodesics_on(camera.object).any(|(it, _)| it == id);
        let colours = shared.stated_colours.notes(request, &on_it).into_iter();
        let remarks = solid.attribute_notes().chain(colours).chain(remarks);
        notes.extend(remarks.into_iter().map(Note::Remark));
        self.solids.next();
        Ok(RenderedImage {
            notes,
            overlays,
            backend: followed_by_software(
                shared,
                "the view of a solid is coloured by the processor",
            ),
            geodesics: Some((map.work, map.estimate)),
            ..RenderedImage::new(Pixels::Image(image))
        })
    }

    /// Returns the end of the geodesic of a pixel of a solid's view.
    fn pick_solid(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        options: &GeodesicOptions,
        at: PixelPoint,
    ) -> Result<Option<Hit>, RenderError> {
        let camera = self.solids.place(shared, request, options)?;
        let [x, y] = camera.picture_place(at);
        let distance = camera.frame.zoom() * x.hypot(y);
        let surface = camera.solid().surface();
        let walked = camera.frame.advance(surface, [x, y], &Options::default());
        let reached = walked.ok().filter(|(_, it)| it.status == Status::Complete);
        Ok(reached.map(|(_, trace)| Hit {
            object: camera.object,
            position: Some(WorldPoint(trace.position)),
            parameters: [0.0; 2],
            instance: 0,
            leaf: None,
            polar: Some([distance, y.atan2(x)]),
        }))
    }
}

/// Colours a map on the CPU.
fn by_software(
    shared: &SharedState,
    request: &PictureRequest,
    options: &GeodesicOptions,
    map: &CachedMap,
) -> RenderedImage {
    let CachedMap { camera, ends } = map;
    let texture = request.texture_inside(camera.surface);
    let paint = Paint {
        texture: &texture,
        colour: colour(request, camera.surface),
        domain: camera.domain(),
        sides: camera.sides(),
        mark_centre: options.mark_centre,
        coarse: request.moving,
    };
    let counters = &*shared.pixels;
    let over = GeodesicOverlay::new(request, camera, counters);
    let (mut image, status) = ends.resolve_under(&paint, over.layer(), counters);
    let (remarks, overlays) = over.finish(&mut image, ends, Some(&status));
    let mut notes = notes(status.len(), count(&status), &ends.work(), ends.estimate());
    notes.extend(remarks.into_iter().map(Note::Remark));
    RenderedImage {
        notes,
        overlays,
        backend: followed_by_software(shared, "geodesics are followed pixel by pixel"),
        ..RenderedImage::new(Pixels::Image(image))
    }
}

/// Colours a table of polynomials by a pass on the GPU. The picture stays there unless it has overlays, or is for a file.
///
/// # Errors
/// Those of the device.
fn by_gpu(
    shared: &mut SharedState,
    request: &PictureRequest,
    options: &GeodesicOptions,
    map: &CachedMap,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<RenderedImage, RenderError> {
    let CachedMap { camera, ends } = map;
    let Some(gpu) = &mut shared.gpu else {
        return Ok(by_software(shared, request, options, map));
    };
    let surface = camera.surface;
    let cover = Cover::new(
        &request.texture_inside(surface),
        camera.domain(),
        camera.sides(),
    );
    let task = ResolveTask {
        ends,
        cover: &cover,
        origin: camera.frame.uv.0,
        colour: colour(request, surface),
        mark_centre: options.mark_centre,
        size: request.size,
        in_memory: shared.is_single || overlay::any_geodesic(request, surface),
    };
    let resolved = gpu.resolve(&task, &|share| {
        progress(FOLLOWING_SHARE + (1.0 - FOLLOWING_SHARE) * share);
    })?;
    let count = |status| {
        let count = resolved.counts.get(code_of(status) as usize);
        count.map_or(0, |&count| count as usize)
    };
    let pixels = request.size[0] as usize * request.size[1] as usize;
    let mut notes = geodesic_view::notes(pixels, count, &ends.work(), ends.estimate());
    let mut overlays = Vec::new();
    let mut image = resolved.pixels;
    if let Pixels::Image(image) = &mut image {
        let over = GeodesicOverlay::new(request, camera, &shared.pixels);
        let remarks;
        (remarks, overlays) = over.draw(image, ends);
        notes.extend(remarks.into_iter().map(Note::Remark));
    }
    Ok(RenderedImage {
        notes,
        overlays,
        backend: shared.backend(),
        ..RenderedImage::new(image)
    })
}

/// Returns the software path as the backend, with the reason if there is a GPU.
fn followed_by_software(shared: &SharedState, clause: &str) -> BackendUsed {
    let reason = shared.gpu().map(|_| format!("because {clause}"));
    BackendUsed::Software { reason }
}

/// Returns the colour of a surface, in linear light.
fn colour(request: &PictureRequest, surface: ObjectId) -> [f32; 3] {
    style::linear(request.srgb(surface))
}
