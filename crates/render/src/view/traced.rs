//! The traced view: a scene with its lights, shadows, mirrors and glass, followed ray by ray.
//!
//! ```text
//! request ──geometry──▶ scenery, lens camera ──tracer, or gpu::trace: sums of light, kept──▶ means ──▶ picture
//! ```
//!
//! A renderer with a GPU uses it for scenes that fit its pass (`TracedScene::tables`), and leaves the samples that f32
//! cannot decide to f64.
//!
//! A request specifies the number of samples of each pixel. The sums of the last picture are kept: a request for more
//! samples of the same picture adds only the missing ones, so that a window refines a picture at rest.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use image::RgbaImage;
use scene::{Object, ObjectId, Scene, Shape};
use tracer::camera::{LensCamera, LensProjection, SampleAxes};
use tracer::picture::{LightSums, PictureProgress, sample_light};
use tracer::shade::{Face, FaceObject, LightTracer};
use tracer::{PictureLook, Ray, gamma_encoded};

use super::space::{self, SpaceView};
use super::{Hit, Key, SharedState, View, ViewRenderer};
use crate::camera::Camera;
use crate::counters::PixelCounters;
use crate::declared_camera::declared_camera;
use crate::error::RenderError;
use crate::framing::Framed;
use crate::gpu::Pixels;
use crate::gpu::renderer::GpuRenderer;
use crate::gpu::trace::TraceTask;
use crate::note::Note;
use crate::overlay;
use crate::plan::Plan;
use crate::point::{DrawingPoint, PixelPoint, WorldPoint};
use crate::rendered::{BackendUsed, RenderedImage};
use crate::request::part::SpaceOptions;
use crate::request::{PictureRequest, ViewOptions, ViewPart};
use crate::shared::Shared;
use crate::solids::{self, SceneTables, TracedScene, cut_short_note};
use crate::style;

/// The view's name.
pub const NAME: &str = "traced";

/// The default number of samples of a pixel.
pub const SAMPLES: u32 = 16;
/// The same through a lens.
pub const LENS_SAMPLES: u32 = 64;
/// The maximum number of samples of a pixel.
pub const MAX_SAMPLES: u32 = 1 << 16;
/// The default maximum number of reflections and refractions along a ray.
pub const BOUNCES: u32 = 8;
/// The upper limit of that maximum.
pub const MAX_BOUNCES: u32 = 64;

/// The traced view.
#[derive(Clone, Copy, Debug)]
pub struct TracedView;

/// The options of a traced picture beyond those of all pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TracedOptions {
    /// The options that all views in space have. The picture uses the lens of the declared camera; without one, the
    /// perspective of the 3D view.
    pub space: SpaceOptions,
    /// The number of samples of a pixel, 1 to [`MAX_SAMPLES`]; if not given, [`SAMPLES`], or [`LENS_SAMPLES`] through a
    /// lens.
    pub samples: Option<u32>,
    /// The maximum number of reflections and refractions, 0 to [`MAX_BOUNCES`]; if not given, that of the scene, or
    /// [`BOUNCES`].
    pub bounces: Option<u32>,
    /// The formulas that convert light to bytes; if not given, those of the CRT scene language if the scene specifies its
    /// picture.
    pub look: Option<PictureLook>,
    /// The gamma of the look `crt`, positive; if not given, that of the scene, or 1.
    pub gamma: Option<f64>,
    /// The maximum operations for the first sample of all pixels if rays are followed in f64; if not given, there is no
    /// limit, and a long picture must be interrupted. See [`tracer::Caster::operations`].
    pub max_operations: Option<u64>,
}

/// The settings of a picture, including those of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TracedSettings {
    look: PictureLook,
    gamma: f64,
    bounces: u32,
}

impl TracedOptions {
    /// Returns the formulas that convert light to bytes.
    pub fn picture_look(&self, scene: &Scene) -> PictureLook {
        self.settings(scene).look
    }

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

    /// Returns the number of samples of a pixel, and the grid that they form, if any. In the look `crt` a single sample is
    /// at the pixel's centre, and those of a picture without a lens form a grid if their number is a square.
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

    fn draws_lines(&self) -> bool {
        false
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

    /// The name after the view's is that of a declared camera.
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

    fn plan(&self, request: &PictureRequest, plan: &mut Plan) {
        let clause = if plan.gpu {
            misfit(request).unwrap_or_else(|error| Some(error.to_string()))
        } else {
            Some("there is no GPU".to_owned())
        };
        plan.traced = clause.is_none();
        if let Some(clause) = clause {
            let sentence = format!(
                "no pipeline of the traced view: rays are followed in f64, because {clause}"
            );
            plan.left_out.push(sentence);
        }
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

/// The state of the traced view between pictures.
#[derive(Debug, Default)]
struct TracedRenderer {
    sums: Option<(TracedContent, LightSums)>,
}

/// Everything on which the light of a traced picture depends.
#[derive(Debug, PartialEq)]
struct TracedContent {
    scene: Shared<TracedScene>,
    camera: LensCamera,
    size: [u32; 2],
    bounces: u32,
    grid: Option<u32>,
}

impl TracedContent {
    /// Adds the missing samples in f64. Returns false if the picture has been abandoned.
    ///
    /// # Errors
    /// [`RenderError::TooMuchWork`] if the first sample exceeds the limit.
    fn add_in_f64(
        &self,
        sums: &mut LightSums,
        missing: &MissingSamples<'_>,
    ) -> Result<bool, RenderError> {
        let exceeded = AtomicBool::new(false);
        let is_done = self
            .scene
            .with_scenery(&self.camera, self.bounces, |scenery| {
                missing.steps().all(|step| {
                    let most = missing.max_operations.filter(|_| step.start == 0);
                    let goes_on = |it: PictureProgress| {
                        let is_too_much = most.is_some_and(|most| {
                            let certain =
                                it.expected.map_or(0, |work| work - work / EXPECTED_ABOVE);
                            it.operations.max(certain) > most
                        });
                        exceeded.fetch_or(is_too_much, Ordering::Relaxed);
                        missing.goes_on(&step, it.share) && !is_too_much
                    };
                    let count = step.len() as u32;
                    sums.add(scenery, &self.camera, self.grid, count, threads(), &goes_on)
                })
            });
        match missing.max_operations {
            Some(most) if exceeded.into_inner() => Err(RenderError::TooMuchWork(most)),
            _ => Ok(is_done),
        }
    }

    /// Adds the missing samples on the GPU. Counts those that f32 could not decide. Returns false if the picture has been
    /// abandoned.
    fn add_on_gpu(
        &self,
        gpu: &mut GpuRenderer,
        tables: &SceneTables,
        sums: &mut LightSums,
        missing: &MissingSamples<'_>,
        counters: &PixelCounters,
    ) -> Result<bool, RenderError> {
        for step in missing.steps() {
            let goes_on = |share| missing.goes_on(&step, share);
            let count = step.len() as u32;
            let Some(retraced) = self.add_step_on_gpu(gpu, tables, sums, count, &goes_on)? else {
                return Ok(false);
            };
            counters.count_retraced(retraced);
        }
        Ok(true)
    }

    /// Adds the next samples on the GPU, and in f64 those that f32 cannot decide. Returns the number of the latter; `None`
    /// if the picture has been abandoned.
    fn add_step_on_gpu(
        &self,
        gpu: &mut GpuRenderer,
        tables: &SceneTables,
        sums: &mut LightSums,
        count: u32,
        progress: &dyn Fn(f32) -> bool,
    ) -> Result<Option<u64>, RenderError> {
        let Self {
            scene,
            camera,
            size,
            bounces,
            grid,
        } = self;
        scene.with_scenery(camera, *bounces, |scenery| {
            let task = TraceTask {
                scene: scene.arc(),
                tables,
                lights: scenery.lights,
                camera,
                axes: SampleAxes::of(scenery, camera, *grid),
                size: *size,
                bounces: *bounces,
                look: scenery.picture_look,
                first: sums.samples(),
                count,
            };
            let Some(mut traced) = gpu.trace(&task, progress)? else {
                return Ok(None);
            };
            let marked = &traced.marked;
            let light = sample_light(scenery, camera, *grid, *size, marked, threads());
            for (([x, y], _), light) in marked.iter().zip(light) {
                traced.sums[*y as usize * size[0] as usize + *x as usize] += light;
            }
            sums.add_sums(&traced.sums, count);
            Ok(Some(marked.len() as u64))
        })
    }
}

/// The work expected from a part of the picture may be too high by one part in this number.
const EXPECTED_ABOVE: u64 = 5;

/// The samples that a picture lacks.
struct MissingSamples<'a> {
    /// Their number for each pixel.
    count: u32,
    /// True if partial results may be needed: then they are added one at a time.
    is_partial: bool,
    /// The limit of operations of the first sample; it is then added alone.
    max_operations: Option<u64>,
    /// Receives the completed fraction; returns false to stop.
    progress: &'a (dyn Fn(f32) -> bool + Sync),
}

impl MissingSamples<'_> {
    /// Returns the samples that are added at once, step by step. The light of a pixel is added sample by sample: in one
    /// step or in many, its sum has the same bits.
    fn steps(&self) -> impl Iterator<Item = Range<u32>> {
        let mut start = 0;
        std::iter::from_fn(move || {
            let is_measured = self.max_operations.is_some() && start == 0;
            let end = match self.is_partial || is_measured {
                true => self.count.min(start + 1),
                false => self.count,
            };
            let step = start..end;
            start = end;
            (!step.is_empty()).then_some(step)
        })
    }

    /// Reports the completed fraction of a step. Returns false to stop.
    fn goes_on(&self, step: &Range<u32>, share: f32) -> bool {
        let done = step.start as f32 + step.len() as f32 * share;
        (self.progress)(done / self.count as f32)
    }
}

/// Returns the tables of a scene if the GPU can trace it now.
///
/// # Errors
/// A clause that says why it cannot.
fn tables_for<'a>(
    gpu: &mut GpuRenderer,
    scene: &'a TracedScene,
    is_single: bool,
) -> Result<&'a SceneTables, String> {
    let tables = scene.tables().map_err(str::to_owned)?;
    match gpu.can_trace(&tables.functions, is_single)? {
        true => Ok(tables),
        false => Err("its shader is being built".to_owned()),
    }
}

/// Returns the number of threads that follow rays.
fn threads() -> usize {
    rayon::current_num_threads()
}

impl ViewRenderer for TracedRenderer {
    fn draw(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<RenderedImage, RenderError> {
        let options: &TracedOptions = request.options()?;
        let settings = options.settings(&request.scene);
        let framed = space::framed(shared, request, &options.space);
        let (space_camera, scene) = prepared(shared, request, &framed)?;
        let mut camera = lens(&scene, options, &space_camera);
        let has_lens = camera.aperture > 0.0;
        let (wanted, grid) = options.sampling(&request.scene, settings.look, has_lens);
        if settings.look == PictureLook::Crt && wanted == 1 {
            camera.aperture = 0.0;
        }
        let content = TracedContent {
            scene: Shared::from(&scene),
            camera,
            size: request.size,
            bounces: settings.bounces,
            grid,
        };
        let kept = self.sums.take();
        let kept = kept.filter(|(known, sums)| *known == content && sums.samples() <= wanted);
        let (content, mut sums) = kept.unwrap_or_else(|| (content, LightSums::new(request.size)));
        let before = sums.samples();
        let interrupt = &shared.interrupt;
        let missing = MissingSamples {
            count: wanted - before,
            is_partial: shared.keeps_partial,
            max_operations: options.max_operations.filter(|_| before == 0),
            progress: &|share| {
                progress(share);
                // During motion, a newer picture follows anyway.
                request.moving || !interrupt.is_wanted()
            },
        };
        let mut backend = shared.backend();
        let is_single = shared.is_single;
        let by_gpu = shared.gpu.as_deref_mut().and_then(|gpu| {
            let tables = tables_for(gpu, &scene, is_single).map_err(|clause| {
                let reason = Some(format!("because {clause}"));
                backend = BackendUsed::Software { reason };
            });
            Some((tables.ok()?, gpu))
        });
        let is_done = match by_gpu {
            _ if missing.count == 0 => true,
            Some((tables, gpu)) => {
                content.add_on_gpu(gpu, tables, &mut sums, &missing, &shared.pixels)?
            }
            None => content.add_in_f64(&mut sums, &missing)?,
        };
        let done = sums.samples();
        let added = done - before;
        let pixels = u64::from(request.size[0]) * u64::from(request.size[1]);
        shared.pixels.count_traced(u64::from(added) * pixels);
        let mut image = picture(request.size, &sums, &settings);
        let cut_short = cut_short_note(sums.rays_cut_short());
        self.sums = Some((content, sums));
        let is_kept = shared.keeps_partial && done > 0;
        if !is_done && !is_kept {
            return Err(RenderError::Interrupted);
        }
        let partial = (!is_done)
            .then(|| format!("interrupted: each pixel has {done} of its {wanted} samples"));
        let (mut overlays, mut legend) = (Vec::new(), None);
        // Through a lens that bends the picture, names would be elsewhere.
        let is_straight = camera.projection == LensProjection::Pinhole;
        if request.overlays.labels && is_straight && space_camera.parallel.is_none() {
            let labels =
                space::labels(shared, request, &options.space, &framed, &space_camera, &[]);
            legend = overlay::space_key_place(request, None, &image, &labels)?;
            overlays = overlay::over_space(&mut image, request, None, &labels, legend)?;
            shared.samples.next();
        }
        Ok(RenderedImage {
            backend,
            overlays,
            legend,
            samples: Some([done, added]),
            notes: solids::notes(scene.rays(), request)
                .chain(framed.notes(request, |id| options.space.shows(id)))
                .chain(cut_short)
                .chain(partial)
                .map(Note::Remark)
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
        let options: &TracedOptions = request.options()?;
        let framed = space::framed(shared, request, &options.space);
        let (space_camera, scene) = prepared(shared, request, &framed)?;
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
        Ok(face.and_then(|face| hit(&scene, &face)))
    }

    fn camera(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
    ) -> Result<Option<Camera>, RenderError> {
        let options: &TracedOptions = request.options()?;
        let framed = space::framed(shared, request, &options.space);
        framed.camera(&options.space.camera, request).map(Some)
    }
}

/// Returns the 3D view's camera for a picture, and the scene that rays meet in it.
fn prepared(
    shared: &mut SharedState,
    request: &PictureRequest,
    framed: &Framed,
) -> Result<(Camera, Arc<TracedScene>), RenderError> {
    let options: &TracedOptions = request.options()?;
    let look = options.settings(&request.scene).look;
    let camera = framed.camera(&options.space.camera, request)?;
    let (hidden, solids) = (&options.space.hidden, &mut shared.solids);
    let scene = solids.traced(request, hidden, &camera.placement, look);
    Ok((camera, scene))
}

/// Returns a clause about the part of a picture that the GPU cannot trace; `None` if it can trace all of it.
fn misfit(request: &PictureRequest) -> Result<Option<String>, RenderError> {
    let mut shared = SharedState::default();
    let framed = space::framed(
        &mut shared,
        request,
        &request.options::<TracedOptions>()?.space,
    );
    let (_, scene) = prepared(&mut shared, request, &framed)?;
    Ok(scene.tables().err().map(str::to_owned))
}

/// Returns the camera of a picture: at the position of the 3D view's, with the lens of the declared one.
fn lens(scene: &TracedScene, options: &TracedOptions, space: &Camera) -> LensCamera {
    let declared = declared_camera(scene.rays(), options.space.declared.as_deref());
    let viewpoint = &options.space.camera;
    if let (Some(lens), None, None) = (declared, viewpoint.eye, viewpoint.target) {
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
        focus: distance,
        ..LensCamera::default()
    });
    LensCamera {
        position,
        direction: -back,
        up,
        // `up` is turned already.
        roll: 0.0,
        ..lens
    }
}

/// Returns the object to which a face belongs.
fn hit(scene: &TracedScene, face: &Face) -> Option<Hit> {
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
        leaf: owner.leaf.map(|leaf| leaf.index),
        polar: None,
    })
}

/// Returns the mean light of all pixels as bytes.
fn picture(size: [u32; 2], sums: &LightSums, settings: &TracedSettings) -> RgbaImage {
    let mut image = RgbaImage::new(size[0], size[1]);
    for (pixel, light) in image.pixels_mut().zip(sums.means()) {
        let [r, g, b] = match settings.look {
            PictureLook::Geotrace => light.to_array().map(|light| style::encode(light as f32)),
            PictureLook::Crt => gamma_encoded(light, settings.gamma),
        };
        pixel.0 = [r, g, b, u8::MAX];
    }
    image
}
