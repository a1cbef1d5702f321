//! The GPU part of a renderer: pipelines, buffers, targets and canvases that persist between pictures. Params are numbers in
//! buffers; changing them compiles nothing.

use std::sync::Arc;

use scene::ObjectId;

use crate::cache::Cache;
use crate::camera::Camera;
use crate::content::{Content, Structure};
use crate::error::RenderError;
use crate::gpu::canvas::{Canvases, Pixels};
use crate::gpu::device::Gpu;
use crate::gpu::geodesic::{ResolvePass, ResolveTask, Resolved};
use crate::gpu::kernels::{Kernels, ObjectSamples, SampleRequest};
use crate::gpu::layout::ViewUniform;
use crate::gpu::pipelines::PipelineFactory;
use crate::gpu::samples::{self, SampleBuffer};
use crate::gpu::space::{Draw, Painters, Target, draw_tiles};
use crate::gpu::trace::{TracePass, TraceTask, TracedSamples};
use crate::overlay::OverlayObject;
use crate::plan::Built;
use crate::request::PictureRequest;
use crate::sample::{self, Painter};
use crate::sample_store::SampleStore;
use crate::solids::SolidPainter;
use crate::style::Look;
use crate::texture::{Proportions, SurfaceImage, Texture};

/// The bytes of sample buffers that are kept although the last picture has not used them.
const ALLOWANCE: usize = 16 << 20;
/// The number of targets that are kept, enough for this number of panes.
const TARGETS: usize = 3;

/// Draws repeatedly on a device.
#[derive(Debug)]
pub(crate) struct GpuRenderer {
    pub(crate) gpu: Arc<Gpu>,
    built: Built,
    painters: Painters,
    buffers: Cache<Content, Buffered>,
    overlay: Option<(Arc<[OverlayObject]>, Vec<SampleBuffer>)>,
    /// The most recently used target is last.
    targets: Vec<Target>,
    canvases: Canvases,
    kernels: Kernels,
    resolve: ResolvePass,
    trace: TracePass,
    /// The number of objects whose samples a kernel has computed.
    sampled: u64,
}

/// Samples on the device.
#[derive(Clone, Debug)]
struct Buffered {
    buffer: SampleBuffer,
    /// True if a kernel has computed them.
    by_kernel: bool,
}

/// A scene to be drawn in space.
pub(crate) struct SpaceScene<'a> {
    pub(crate) request: &'a PictureRequest,
    pub(crate) structures: &'a [Structure],
    pub(crate) contents: &'a [Content],
    pub(crate) camera: &'a Camera,
    /// The look and the image of an object; `None` for one that is hidden.
    pub(crate) shown: &'a dyn Fn(ObjectId) -> Option<&'a Look>,
    pub(crate) image: &'a dyn Fn(ObjectId) -> SurfaceImage,
    /// The objects that are drawn beside those of the scene.
    pub(crate) overlay: &'a Arc<[OverlayObject]>,
    /// The solids, if there are any.
    pub(crate) solids: Option<&'a SolidPainter<'a>>,
    /// Linear light and alpha.
    pub(crate) background: [f32; 4],
}

impl GpuRenderer {
    pub(crate) fn new(gpu: Arc<Gpu>) -> Self {
        Self {
            gpu,
            built: Built::default(),
            painters: Painters::default(),
            buffers: Cache::new(ALLOWANCE),
            overlay: None,
            targets: Vec::new(),
            canvases: Canvases::default(),
            kernels: Kernels::default(),
            resolve: ResolvePass::default(),
            trace: TracePass::default(),
            sampled: 0,
        }
    }

    /// Draws objects; returns the picture and the notes for its reader. A single picture is drawn into memory tile by tile,
    /// and waits for its kernels.
    ///
    /// # Errors
    /// Those of the device.
    pub(crate) fn draw_space(
        &mut self,
        store: &mut SampleStore,
        scene: &SpaceScene,
        is_single: bool,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<(Pixels, Vec<String>), RenderError> {
        let gpu = self.gpu.clone();
        gpu.guarded(|| {
            let size = scene.request.size;
            if !is_single {
                check_side(&gpu, size)?;
            }
            let view = gpu.uniform("view", &ViewUniform::new(scene.camera, [0, 0], size));
            let prepared = |share: f32| progress(0.5 * share);
            let (draws, notes) = self.draws(store, scene, &view, is_single, &prepared)?;
            let pixels = if is_single {
                let drawn = |share: f32| progress(0.5 + 0.5 * share);
                let (camera, background) = (scene.camera, scene.background);
                let mut before = |first, size| self.solids(scene, first, size);
                Pixels::Image(draw_tiles(
                    &gpu,
                    camera,
                    &view,
                    &draws,
                    &mut before,
                    background,
                    &drawn,
                )?)
            } else {
                let solids = self.solids(scene, [0; 2], size)?;
                let draws = solids.iter().chain(&draws);
                let canvas = self.canvases.take(&gpu, size);
                let target = self.target(size);
                gpu.submit(|encoder| target.draw(encoder, &canvas, draws, scene.background));
                Pixels::Texture(canvas)
            };
            self.painters.next();
            self.buffers.next();
            Ok((pixels, notes))
        })
    }

    /// Colours the pixels of a geodesic view.
    ///
    /// # Errors
    /// Those of the device.
    pub(crate) fn resolve(
        &mut self,
        task: &ResolveTask,
        progress: &dyn Fn(f32),
    ) -> Result<Resolved, RenderError> {
        let gpu = self.gpu.clone();
        let mut factory = PipelineFactory {
            gpu: &gpu,
            built: self.built,
        };
        let (pass, canvases) = (&mut self.resolve, &mut self.canvases);
        let resolved = gpu.guarded(|| pass.resolve(&mut factory, canvases, task, progress));
        self.built = factory.built;
        resolved
    }

    /// Returns true if the pass of traced pictures with these functions is ready; with `waits`, waits for it.
    ///
    /// # Errors
    /// A clause, if the driver has refused it.
    pub(crate) fn can_trace(&mut self, functions: &str, waits: bool) -> Result<bool, String> {
        self.trace
            .is_ready(&self.gpu, functions, &mut self.built, waits)
    }

    /// Traces samples of a picture. `progress` receives the completed fraction, and returns false to stop; then the result
    /// is `None`.
    ///
    /// # Errors
    /// Those of the device.
    pub(crate) fn trace(
        &mut self,
        task: &TraceTask<'_>,
        progress: &dyn Fn(f32) -> bool,
    ) -> Result<Option<TracedSamples>, RenderError> {
        let gpu = self.gpu.clone();
        let factory = PipelineFactory::new(&gpu);
        gpu.guarded(|| self.trace.trace(&factory, task, progress))
    }

    /// Sets the number of operations from which on a kernel computes an object's samples.
    pub(crate) fn kernels_pay_from(&mut self, operations: u64) {
        self.kernels.pay_from(operations);
    }

    /// Returns true if kernels or the pass of traced pictures are being built.
    pub(crate) fn is_building(&self) -> bool {
        self.kernels.is_building() || self.trace.is_building()
    }

    /// Returns the number of pipelines and kernels that have been built so far.
    pub(crate) fn pipelines(&self) -> u64 {
        let built = &self.built;
        let fixed = built.draw_pipelines + built.resolve_pipelines + built.trace_pipelines;
        u64::from(fixed) + self.kernels.built()
    }

    /// Returns the counts of everything that has been built so far.
    pub(crate) fn built(&self) -> Built {
        Built {
            sample_kernels: self.kernels.built() as u32,
            ..self.built
        }
    }

    /// Returns the number of objects whose samples kernels have computed so far.
    pub(crate) fn sampled(&self) -> u64 {
        self.sampled
    }

    /// Returns the prepared draws, and the notes for the reader of the picture.
    fn draws(
        &mut self,
        store: &mut SampleStore,
        scene: &SpaceScene,
        view: &wgpu::Buffer,
        is_single: bool,
        progress: &dyn Fn(f32),
    ) -> Result<(Vec<Draw>, Vec<String>), RenderError> {
        let request = scene.request;
        let mut notes = Vec::new();
        let mut draws: Vec<Draw> = Vec::new();
        let steps = request.scene.objects.len() as f32;
        for (id, object) in request.scene.numbered() {
            let Some(look) = (scene.shown)(id) else {
                continue;
            };
            let painter = Painter::for_object(&request.scene, object);
            let Some(painter) = painter.filter(|painter| *painter != Painter::Solids) else {
                notes.extend(sample::left_out(object));
                continue;
            };
            let buffer = self.buffer(store, scene, id, is_single, &mut notes)?;
            let image = |()| (scene.image)(id);
            draws.extend(self.with_factory(|painters, factory| {
                painters.draw(factory, painter, view, &buffer, look, image)
            })?);
            progress((id.index() + 1) as f32 / steps);
        }
        self.upload_overlay(scene.overlay)?;
        let buffers = self.overlay.as_ref().map(|(_, buffers)| buffers.clone());
        for (object, buffer) in scene.overlay.iter().zip(buffers.iter().flatten()) {
            let look = object.look(request.scale);
            let texture = |()| Texture::orientation(Proportions::Even, false);
            let image = |()| SurfaceImage::open(texture(()));
            draws.extend(self.with_factory(|painters, factory| {
                painters.draw(factory, object.painter, view, buffer, &look, image)
            })?);
        }
        Ok((draws, notes))
    }

    /// Returns the draw of the solids into a target of this size that begins at a pixel of the picture.
    fn solids(
        &mut self,
        scene: &SpaceScene,
        first: [u32; 2],
        size: [u32; 2],
    ) -> Result<Option<Draw>, RenderError> {
        let draw = scene.solids.map(|painter| {
            self.with_factory(|painters, factory| {
                painters.draw_solids(factory, painter, first, size)
            })
        });
        draw.transpose()
    }

    /// Returns the samples of an object on the device, and adds notes about them to `notes`.
    fn buffer(
        &mut self,
        store: &mut SampleStore,
        scene: &SpaceScene,
        id: ObjectId,
        is_single: bool,
        notes: &mut Vec<String>,
    ) -> Result<SampleBuffer, RenderError> {
        let request = scene.request;
        let object = &request.scene.objects[id.index()];
        let content = &scene.contents[id.index()];
        let structure = &scene.structures[id.index()];
        let placement = &scene.camera.placement;
        let key = content.placed(placement);
        let known = self.buffers.get(&key);
        if let Some(known) = known.as_ref().filter(|known| known.by_kernel) {
            notes.extend(known.buffer.note(&object.name));
            return Ok(known.buffer.clone());
        }
        if known.is_none() {
            let wanted = SampleRequest {
                scene: request.scene.arc(),
                params: &request.params,
                object: id,
                structure,
                placement,
                waits: is_single,
            };
            match self.kernels.samples(&self.gpu, &wanted)? {
                ObjectSamples::Samples(buffer) => {
                    self.sampled += 1;
                    notes.extend(buffer.note(&object.name));
                    self.put(key, &buffer, true);
                    return Ok(buffer);
                }
                ObjectSamples::Blocks(note) => notes.extend(note),
            }
        }
        let sampled = store.get(&request.scene, &request.params, id, content, placement);
        notes.extend(sampled.notes(object));
        if let Some(known) = known {
            notes.extend(self.kernels.refusal(structure, &object.name));
            return Ok(known.buffer);
        }
        let buffer = samples::upload_samples(&self.gpu, &sampled.samples)?;
        if is_single {
            // They are on the device now, and the CPU copy is not needed any more.
            store.forget(content, placement);
        }
        self.put(key, &buffer, false);
        Ok(buffer)
    }

    fn put(&mut self, key: Content, buffer: &SampleBuffer, by_kernel: bool) {
        let bytes = buffer.buffer.size() as usize;
        let buffer = buffer.clone();
        self.buffers.put(key, Buffered { buffer, by_kernel }, bytes);
    }

    fn upload_overlay(&mut self, objects: &Arc<[OverlayObject]>) -> Result<(), RenderError> {
        if let Some((known, _)) = &self.overlay
            && Arc::ptr_eq(known, objects)
        {
            return Ok(());
        }
        let buffers: Result<Vec<_>, _> = objects
            .iter()
            .map(|object| samples::upload_samples(&self.gpu, &object.samples))
            .collect();
        self.overlay = Some((objects.clone(), buffers?));
        Ok(())
    }

    fn with_factory<T>(
        &mut self,
        work: impl FnOnce(&mut Painters, &mut PipelineFactory<'_>) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let mut factory = PipelineFactory {
            gpu: &self.gpu,
            built: self.built,
        };
        let result = work(&mut self.painters, &mut factory);
        self.built = factory.built;
        result
    }

    fn target(&mut self, size: [u32; 2]) -> &Target {
        let known = self.targets.iter().position(|target| target.size == size);
        let target = match known {
            Some(at) => self.targets.remove(at),
            None => {
                if self.targets.len() >= TARGETS {
                    self.targets.remove(0);
                }
                Target::new(&self.gpu, size)
            }
        };
        self.targets.push(target);
        &self.targets[self.targets.len() - 1]
    }
}

/// Refuses pictures that exceed the maximum size of a texture.
///
/// # Errors
/// [`RenderError::Gpu`].
pub(crate) fn check_side(gpu: &Gpu, size: [u32; 2]) -> Result<(), RenderError> {
    let most = gpu.device.limits().max_texture_dimension_2d;
    if size.iter().any(|&side| side > most) {
        let [width, height] = size;
        return Err(RenderError::Gpu(format!(
            "a picture of {width}x{height} pixels is larger than its textures, which have at most {most} on a side"
        )));
    }
    Ok(())
}
