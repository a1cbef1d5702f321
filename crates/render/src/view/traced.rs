//! The traced view: a scene with its lights, shadows, mirrors and glass, followed ray by ray.
//!
//! ```text
//! request ──geometry──▶ scenery, lens camera ──tracer: sums of light, kept──▶ means ──▶ picture
//! ```
//!
//! A request says how many samples each pixel has. The sums of the last picture are kept: a request for more samples of the
//! same picture adds those that are missing, so that a window refines a picture at rest.

use std::num::NonZero;
use std::sync::Arc;

use glam::DVec3;
use image::RgbaImage;
use scene::{Object, ObjectId, Scene, Shape};
use tracer::camera::{Bokeh, LensCamera, LensProjection, SharpPlaces};
use tracer::picture::LightSums;
use tracer::shade::{Face, FaceObject, LightTracer};
use tracer::{PictureLook, Ray, gamma_encoded};

use super::space::{self, SpaceView};
use super::{Hit, Key, SharedState, View, ViewRenderer};
use crate::camera::Camera;
use crate::error::RenderError;
use crate::gpu::Pixels;
use crate::overlay;
use crate::plan::Plan;
use crate::point::{DrawingPoint, PixelPoint, WorldPoint};
use crate::rendered::{RenderedImage, SOFTWARE};
use crate::request::part::SpaceOptions;
use crate::request::{PictureRequest, ViewOptions, ViewPart};
use crate::solids::TracedScene;
use crate::style;

/// The view's name.
pub const NAME: &str = "traced";

/// The samples of a pixel, unless a request says otherwise.
pub const SAMPLES: u32 = 16;
/// Likewise through a lens.
pub const LENS_SAMPLES: u32 = 64;
/// The samples of a pixel that a picture may have.
pub const MAX_SAMPLES: u32 = 1 << 16;
/// The reflections and refractions that are followed, unless a request says otherwise.
pub const BOUNCES: u32 = 8;
/// The reflections and refractions that may be followed.
pub const MAX_BOUNCES: u32 = 64;

/// The traced view.
#[derive(Clone, Copy, Debug)]
pub struct TracedView;

/// The options of a traced picture beyond those of all pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TracedOptions {
    /// The options that all views in space have. The picture has the lens of the declared camera; without one, it has a lens as the 3D
    /// view.
    pub space: SpaceOptions,
    /// The samples of a pixel, 1 to [`MAX_SAMPLES`]; if not given, [`SAMPLES`], or [`LENS_SAMPLES`] through a lens.
    pub samples: Option<u32>,
    /// The reflections and refractions that are followed, 0 to [`MAX_BOUNCES`]; if not given, those that the scene states,
    /// or [`BOUNCES`].
    pub bounces: Option<u32>,
    /// The formulas by which light becomes bytes; if not given, those of the CRT scene language where the scene states its
    /// picture.
    pub look: Option<PictureLook>,
    /// The gamma of the look `crt`, positive; if not given, the one that the scene states, or 1.
    pub gamma: Option<f64>,
}

/// The settings of a picture, those of the scene included.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TracedSettings {
    look: PictureLook,
    gamma: f64,
    bounces: u32,
}

impl TracedOptions {
    fn settings(&self, scene: &Scene) -> TracedSettings {
        let stated = scene.picture.as_ref();
        let usual = match stated {
            Some(_) => PictureLook::Crt,
            None => PictureLook::Geotrace,
        };
        let bounces = self.bounces.or(stated.map(|stated| stated.bounces));
        TracedSettings {
            look: self.look.unwrap_or(usual),
            gamma: self.gamma.or(stated.map(|it| it.gamma)).unwrap_or(1.0),
            bounces: bounces.unwrap_or(BOUNCES).min(MAX_BOUNCES),
        }
    }

    /// The samples of a pixel, and the grid on which they lie. In the look `crt` a single sample is in the pixel's middle,
    /// and those of a picture without a lens lie on a grid if their number is a square.
    fn sampling(&self, scene: &Scene, look: PictureLook, has_lens: bool) -> (u32, Option<u32>) {
        let usual = if has_lens { LENS_SAMPLES } else { SAMPLES };
        let limited = |samples: u32| samples.clamp(1, MAX_SAMPLES);
        if look == PictureLook::Geotrace {
            return (limited(self.samples.unwrap_or(usual)), None);
        }
        let stated = scene.picture.as_ref();
        let own = stated.map_or(usual, |it| {
            let places = it.supersampling.saturating_mul(it.supersampling);
            places.saturating_mul(if has_lens { it.lens_samples } else { 1 })
        });
        let samples = limited(self.samples.unwrap_or(own));
        let grid = match (has_lens, stated) {
            (true, Some(stated)) => stated.supersampling,
            (true, None) => 1,
            (false, _) => samples.isqrt(),
        };
        let places = grid.saturating_mul(grid).max(1);
        (samples, (samples % places == 0).then_some(grid))
    }
}

impl ViewOptions for TracedOptions {
    fn view(&self) -> &'static str {
        NAME
    }

    fn space(&self) -> Option<&SpaceOptions> {
        Some(&self.space)
    }

    fn space_mut(&mut self) -> Option<&mut SpaceOptions> {
        Some(&mut self.space)
    }

    fn samples(&self) -> Option<u32> {
        Some(self.samples.unwrap_or(SAMPLES))
    }

    fn set_samples(&mut self, samples: u32) {
        self.samples = Some(samples);
    }

    fn check(&self, scene: &Scene) -> Result<(), RenderError> {
        self.space.camera.check()?;
        if let Some(name) = &self.space.declared
            && !declares_camera(scene, name)
        {
            let sentence = format!("the program declares no camera `{name}`");
            return Err(RenderError::Camera(sentence));
        }
        Ok(())
    }
}

impl View for TracedView {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "Traced view"
    }

    fn purpose(&self) -> &'static str {
        "all objects in space with lights, shadows, mirrors and glass"
    }

    fn shows(&self, scene: &Scene, object: &Object) -> bool {
        SpaceView.shows(scene, object)
    }

    fn nothing(&self) -> &'static str {
        SpaceView.nothing()
    }

    fn options(&self, _object: Option<ObjectId>) -> ViewPart {
        TracedOptions::default().into()
    }

    fn name_behind(&self) -> Option<&'static str> {
        Some("CAMERA")
    }

    /// The name behind the view's is that of a declared camera.
    fn options_of(&self, scene: &Scene, name: &str) -> Option<ViewPart> {
        let mut options = TracedOptions::default();
        options.space.declared = Some(name.to_owned());
        declares_camera(scene, name).then(|| options.into())
    }

    fn instead_of(&self) -> Option<&'static str> {
        Some(space::NAME)
    }

    fn keys(&self) -> &'static [Key] {
        space::KEYS
    }

    fn plan(&self, _request: &PictureRequest, plan: &mut Plan) {
        let sentence = "no pipeline: rays are followed in f64";
        plan.left_out.push(sentence.to_owned());
    }

    fn renderer(&self) -> Box<dyn ViewRenderer> {
        Box::new(TracedRenderer::default())
    }
}

/// Returns true if a scene declares a camera of this name.
fn declares_camera(scene: &Scene, name: &str) -> bool {
    let is_it = |it: &Object| it.name == name && matches!(it.shape, Shape::Camera(_));
    scene.stage.iter().any(is_it)
}

/// The state that is kept for the traced view.
#[derive(Debug, Default)]
struct TracedRenderer {
    sums: Option<(TracedContent, LightSums)>,
}

/// All that the light of a traced picture depends on.
#[derive(Debug)]
struct TracedContent {
    scene: Arc<TracedScene>,
    camera: LensCamera,
    size: [u32; 2],
    bounces: u32,
    grid: Option<u32>,
}

impl TracedContent {
    /// Returns true if another picture has the same light.
    fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && (self.camera, self.size) == (other.camera, other.size)
            && (self.bounces, self.grid) == (other.bounces, other.grid)
    }
}

impl ViewRenderer for TracedRenderer {
    fn draw(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<RenderedImage, RenderError> {
        let options = options(request)?;
        let settings = options.settings(&request.scene);
        let framed = space::framed(shared, request, &options.space);
        let space_camera = framed.camera(&options.space.camera, request)?;
        let placement = &space_camera.placement;
        let scene = shared
            .solids
            .traced(request, &options.space.hidden, placement, settings.look);
        let mut camera = lens(&scene, options, &space_camera);
        let has_lens = camera.aperture > 0.0;
        let (wanted, grid) = options.sampling(&request.scene, settings.look, has_lens);
        if settings.look == PictureLook::Crt && wanted == 1 {
            camera.aperture = 0.0;
        }
        let content = TracedContent {
            scene: scene.clone(),
            camera,
            size: request.size,
            bounces: settings.bounces,
            grid,
        };
        let kept = self.sums.take();
        let kept = kept.filter(|(known, sums)| known.is(&content) && sums.samples() <= wanted);
        let (content, mut sums) = kept.unwrap_or_else(|| (content, LightSums::new(request.size)));
        let missing = wanted - sums.samples();
        let interrupt = &shared.interrupt;
        // The light of a pixel is added sample by sample: in one pass or in many, its sum has the same bits.
        let step = match shared.keeps_partial {
            true => 1,
            false => missing,
        };
        let is_done = missing == 0
            || scene.with_scenery(&camera, content.bounces, |scenery| {
                let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
                (0..missing).step_by(step as usize).all(|first| {
                    sums.add(scenery, &camera, grid, step, threads, &|share| {
                        progress((first as f32 + step as f32 * share) / missing as f32);
                        // While something moves, each picture has something newer behind it.
                        request.moving || !interrupt.is_wanted()
                    })
                })
            });
        let done = sums.samples();
        let added = done - (wanted - missing);
        let pixels = u64::from(request.size[0]) * u64::from(request.size[1]);
        shared.pixels.count_traced(u64::from(added) * pixels);
        let mut image = picture(request.size, &sums, &settings);
        self.sums = Some((content, sums));
        if !is_done && !(shared.keeps_partial && done > 0) {
            return Err(RenderError::Interrupted);
        }
        let partial = (!is_done)
            .then(|| format!("interrupted: each pixel has {done} of its {wanted} samples"));
        let mut overlays = Vec::new();
        // Through a lens that bends or turns the picture, names would be elsewhere.
        let is_straight = camera.projection == LensProjection::Pinhole && camera.roll == 0.0;
        if request.overlays.labels && is_straight && space_camera.parallel.is_none() {
            let labels =
                space::labels(shared, request, &options.space, &framed, &space_camera, &[]);
            overlays = overlay::over_space(&mut image, request, None, &labels)?;
            shared.samples.next();
        }
        Ok(RenderedImage {
            backend: SOFTWARE.to_owned(),
            overlays,
            samples: Some([done, added]),
            notes: scene
                .rays()
                .notes()
                .iter()
                .map(ToString::to_string)
                .chain(partial)
                .collect(),
            ..RenderedImage::new(Pixels::Image(image))
        })
    }

    fn pick(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        at: PixelPoint,
    ) -> Result<Option<Hit>, RenderError> {
        let options = options(request)?;
        let settings = options.settings(&request.scene);
        let framed = space::framed(shared, request, &options.space);
        let space_camera = framed.camera(&options.space.camera, request)?;
        let placement = &space_camera.placement;
        let scene = shared
            .solids
            .traced(request, &options.space.hidden, placement, settings.look);
        let camera = LensCamera {
            aperture: 0.0,
            ..lens(&scene, options, &space_camera)
        };
        let (origin, direction) = camera.ray(request.size, at.0, [0.5; 2]);
        let ray = Ray {
            origin,
            direction,
            leaving: None,
        };
        let face = scene.with_scenery(&camera, 0, |scenery| LightTracer::new(scenery).first(&ray));
        Ok(face.and_then(|face| hit(&scene, request, &face)))
    }

    fn camera(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
    ) -> Result<Option<Camera>, RenderError> {
        let options = options(request)?;
        let framed = space::framed(shared, request, &options.space);
        framed.camera(&options.space.camera, request).map(Some)
    }
}

/// The view's options in a request.
///
/// # Errors
/// [`RenderError::NoView`] if they are another view's, which claims this view's name.
fn options(request: &PictureRequest) -> Result<&TracedOptions, RenderError> {
    let name = request.view.name();
    request.view.get().ok_or_else(|| RenderError::NoView {
        name: name.to_owned(),
    })
}

/// The camera of a picture: where the 3D view's stands, with the lens of the declared one.
fn lens(scene: &TracedScene, options: &TracedOptions, space: &Camera) -> LensCamera {
    let declared = space::declared_camera(scene.rays(), options.space.declared.as_deref());
    let viewpoint = &options.space.camera;
    if let (Some(lens), None) = (declared, viewpoint.eye) {
        return lens;
    }
    let [_, up, back] = space.axes;
    let WorldPoint(position) = space.placement.world(DrawingPoint(space.eye.to_array()));
    let position = DVec3::from(position);
    let ahead = viewpoint
        .target
        .map(|target| DVec3::from(target.0) - position);
    let distance = ahead.map_or(space.placement.radius, DVec3::length);
    let lens = declared.unwrap_or(LensCamera {
        position,
        direction: -back,
        up,
        fov: 2.0 * space.half_tangents()[1].atan(),
        roll: 0.0,
        focus: distance,
        aperture: 0.0,
        bokeh: Bokeh::default(),
        projection: LensProjection::default(),
        sharp: SharpPlaces::default(),
    });
    LensCamera {
        position,
        direction: -back,
        up,
        ..lens
    }
}

/// The object to which a face belongs.
fn hit(scene: &TracedScene, request: &PictureRequest, face: &Face) -> Option<Hit> {
    let owner = scene.rays().owner(&face.of);
    let parameters = match face.of {
        FaceObject::Sheet { uv, .. } => uv,
        FaceObject::Solid { .. } => [0.0; 2],
    };
    Some(Hit {
        object: owner.object.id?,
        position: Some(WorldPoint(face.position.to_array())),
        parameters,
        instance: owner.instance,
        leaf: scene.leaf(&request.scene, face),
        polar: None,
    })
}

/// The mean light of all pixels as bytes.
fn picture(size: [u32; 2], sums: &LightSums, settings: &TracedSettings) -> RgbaImage {
    let encoder = style::Encoder::get();
    let mut image = RgbaImage::new(size[0], size[1]);
    for (pixel, light) in image.pixels_mut().zip(sums.means()) {
        let [r, g, b] = match settings.look {
            PictureLook::Geotrace => light.to_array().map(|light| encoder.encode(light as f32)),
            PictureLook::Crt => gamma_encoded(light, settings.gamma),
        };
        pixel.0 = [r, g, b, u8::MAX];
    }
    image
}
