//! The GPU's half of a [`crate::live::Stage`]: pipelines, buffers, targets and canvases that stay from one picture to the
//! next. Params are numbers in buffers; nothing is compiled for them.

use std::sync::Arc;

use scene::ParamValues;
use scene::{ObjectId, Scene, Shape};

use crate::camera::Camera;
use crate::gpu::canvas::{Canvas, Canvases};
use crate::gpu::device::Gpu;
use crate::gpu::inside::Insides;
use crate::gpu::kernels::{Found, Kernels, Wanted};
use crate::gpu::layout::View;
use crate::gpu::samples::{self, SampleBuffer};
use crate::gpu::space::{Draw, Painters, Target};
use crate::gpu::workshop::Workshop;
use crate::live::content::{Content, Structure};
use crate::live::kept::Kept;
use crate::live::samples::SampleStore;
use crate::overlay::Extra;
use crate::plan::{Built, Painter};
use crate::request::{RenderError, Request};
use crate::sample;
use crate::texture::Texture;

/// What sample buffers may take that the last picture has not used.
const ALLOWANCE: usize = 16 << 20;
/// Targets that are kept: the sizes of so many panes.
const TARGETS: usize = 3;

/// Draws on a device, again and again.
#[derive(Debug)]
pub(crate) struct Studio {
    pub(crate) gpu: Arc<Gpu>,
    built: Built,
    painters: Painters,
    buffers: Kept<Content, Buffered>,
    extras: Option<(Arc<[Extra]>, Vec<SampleBuffer>)>,
    /// The one that was used last stands last.
    targets: Vec<Target>,
    canvases: Canvases,
    kernels: Kernels,
    insides: Insides,
    /// Objects whose samples a kernel has computed.
    sampled: u64,
}

/// Samples on the device.
#[derive(Clone, Debug)]
struct Buffered {
    buffer: SampleBuffer,
    /// Whether a kernel has computed them.
    by_kernel: bool,
}

/// A scene to be drawn in space.
pub(crate) struct Space<'a> {
    pub(crate) scene: &'a Arc<Scene>,
    pub(crate) settings: &'a ParamValues,
    pub(crate) request: &'a Request,
    pub(crate) structures: &'a [Structure],
    pub(crate) contents: &'a [Content],
    pub(crate) camera: &'a Camera,
    pub(crate) extras: &'a Arc<[Extra]>,
}

impl Studio {
    pub(crate) fn new(gpu: Arc<Gpu>) -> Self {
        Self {
            gpu,
            built: Built::default(),
            painters: Painters::default(),
            buffers: Kept::new(ALLOWANCE),
            extras: None,
            targets: Vec::new(),
            canvases: Canvases::default(),
            kernels: Kernels::default(),
            insides: Insides::default(),
            sampled: 0,
        }
    }

    /// Draws objects; gives the picture and what a reader should be told.
    ///
    /// # Errors
    /// Those of the device.
    pub(crate) fn space(
        &mut self,
        store: &mut SampleStore,
        space: &Space,
    ) -> Result<(Canvas, Vec<String>), RenderError> {
        let gpu = self.gpu.clone();
        gpu.guarded(|| self.draw_space(store, space))
    }

    /// Geodesic pictures, with what they need from this device.
    pub(crate) fn insides(&mut self) -> (&mut Insides, Workshop<'_>, &mut Canvases) {
        let workshop = Workshop {
            gpu: &self.gpu,
            built: self.built,
        };
        (&mut self.insides, workshop, &mut self.canvases)
    }

    /// Takes over what a workshop has built.
    pub(crate) fn keep_count(&mut self, built: Built) {
        self.built = built;
    }

    /// From so many operations on, an object's samples are computed by a kernel.
    pub(crate) fn kernels_pay_from(&mut self, operations: u64) {
        self.kernels.pay_from(operations);
    }

    /// Whether kernels are being made.
    pub(crate) fn is_building(&self) -> bool {
        self.kernels.is_making()
    }

    /// The number of pipelines and kernels that have been built so far.
    pub(crate) fn pipelines(&self) -> u64 {
        let built = &self.built;
        let fixed = built.draw_pipelines + built.resolve_pipelines;
        u64::from(fixed) + self.kernels.built()
    }

    /// Objects whose samples kernels have computed so far.
    pub(crate) fn sampled(&self) -> u64 {
        self.sampled
    }

    fn draw_space(
        &mut self,
        store: &mut SampleStore,
        space: &Space,
    ) -> Result<(Canvas, Vec<String>), RenderError> {
        let gpu = self.gpu.clone();
        let size = space.request.size;
        check_side(&gpu, size)?;
        let view = gpu.uniform("view", &View::new(space.camera, [0, 0], size));
        let mut notes = Vec::new();
        let mut draws: Vec<Draw> = Vec::new();
        for (index, object) in space.scene.objects.iter().enumerate() {
            let id = ObjectId(index as u32);
            if !space.request.shows(id) {
                continue;
            }
            let Some(painter) = painter(space.scene, id) else {
                notes.extend(sample::left_out(object));
                continue;
            };
            let buffer = self.buffer(store, space, id, &mut notes)?;
            let colour = (
                space.request.colour(id, &object.shape),
                space.request.emphasis(id),
            );
            let texture = |()| space.request.texture(id);
            draws.push(self.with_workshop(|painters, workshop| {
                painters.draw(workshop, painter, &view, &buffer, colour, texture)
            })?);
        }
        self.upload_extras(space.extras)?;
        let buffers = self.extras.as_ref().map(|(_, buffers)| buffers.clone());
        for (extra, buffer) in space.extras.iter().zip(buffers.iter().flatten()) {
            let colour = (extra.colour, 0.0);
            let texture = |()| Texture::orientation();
            draws.push(self.with_workshop(|painters, workshop| {
                painters.draw(workshop, extra.painter, &view, buffer, colour, texture)
            })?);
        }
        let canvas = self.canvases.take(&gpu, size);
        let behind = space.request.background_light();
        let target = self.target(size);
        gpu.submit(|encoder| target.draw(encoder, &canvas, &draws, behind));
        self.painters.next();
        self.buffers.next();
        Ok((canvas, notes))
    }

    /// The samples of an object on the device. What a reader should be told of them is added to `notes`.
    fn buffer(
        &mut self,
        store: &mut SampleStore,
        space: &Space,
        id: ObjectId,
        notes: &mut Vec<String>,
    ) -> Result<SampleBuffer, RenderError> {
        let object = &space.scene.objects[id.0 as usize];
        let content = &space.contents[id.0 as usize];
        let placement = &space.camera.placement;
        let key = content.placed(placement);
        let known = self.buffers.get(&key);
        if let Some(known) = known.as_ref().filter(|known| known.by_kernel) {
            let SampleBuffer {
                total, undefined, ..
            } = known.buffer;
            notes.extend(sample::note(&object.name, total as usize, undefined));
            return Ok(known.buffer.clone());
        }
        if known.is_none() {
            let wanted = Wanted {
                scene: space.scene,
                settings: space.settings,
                object: id,
                structure: &space.structures[id.0 as usize],
                placement,
            };
            match self.kernels.samples(&self.gpu, &wanted)? {
                Found::Samples(buffer) => {
                    self.sampled += 1;
                    notes.extend(sample::note(
                        &object.name,
                        buffer.total as usize,
                        buffer.undefined,
                    ));
                    self.put(key, &buffer, true);
                    return Ok(buffer);
                }
                Found::Blocks(note) => notes.extend(note),
            }
        }
        let sampled = store.get(space.scene, space.settings, id, content, placement);
        notes.extend(sampled.notes(object));
        if let Some(known) = known {
            let structure = &space.structures[id.0 as usize];
            notes.extend(self.kernels.refusal(structure, &object.name));
            return Ok(known.buffer);
        }
        let buffer = samples::upload_samples(&self.gpu, &sampled.samples, Vec::new())?;
        self.put(key, &buffer, false);
        Ok(buffer)
    }

    fn put(&mut self, key: Content, buffer: &SampleBuffer, by_kernel: bool) {
        let bytes = buffer.buffer.size() as usize;
        let buffer = buffer.clone();
        self.buffers.put(key, Buffered { buffer, by_kernel }, bytes);
    }

    fn upload_extras(&mut self, extras: &Arc<[Extra]>) -> Result<(), RenderError> {
        if let Some((known, _)) = &self.extras
            && Arc::ptr_eq(known, extras)
        {
            return Ok(());
        }
        let buffers: Result<Vec<_>, _> = extras
            .iter()
            .map(|extra| samples::upload_samples(&self.gpu, &extra.samples, Vec::new()))
            .collect();
        self.extras = Some((extras.clone(), buffers?));
        Ok(())
    }

    fn with_workshop<T>(
        &mut self,
        work: impl FnOnce(&mut Painters, &mut Workshop<'_>) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let mut workshop = Workshop {
            gpu: &self.gpu,
            built: self.built,
        };
        let result = work(&mut self.painters, &mut workshop);
        self.built = workshop.built;
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

/// Refuses pictures that are larger than a texture may be.
///
/// # Errors
/// [`RenderError::Gpu`].
pub(crate) fn check_side(gpu: &Gpu, size: [u32; 2]) -> Result<(), RenderError> {
    let most = gpu.device.limits().max_texture_dimension_2d;
    if size.iter().any(|&side| side > most) {
        let [width, height] = size;
        return Err(RenderError::Gpu(format!(
            "a picture of {width}x{height} pixels is larger than its textures, which have {most} a side"
        )));
    }
    Ok(())
}

/// What draws an object in space; nothing for what has no place there.
fn painter(scene: &Scene, id: ObjectId) -> Option<Painter> {
    match &scene.objects[id.0 as usize].shape {
        Shape::Point { .. } => Some(Painter::Points),
        Shape::Vector { .. } => Some(Painter::Vectors),
        Shape::Curve { .. } => Some(Painter::Curves),
        Shape::Surface { .. } => Some(Painter::Surfaces),
        Shape::Geodesic { .. } => geometry::lies_in_space(scene, id).then_some(Painter::Curves),
        Shape::Metric { .. } => None,
    }
}
