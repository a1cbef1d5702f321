//! The colours of the geodesic view: the ends of all pixels' geodesics are a table of polynomials computed in f64 from the
//! fan's rays, and a fixed pass evaluates and colours them. Maps by pixel, which exist for comparison, are coloured on the
//! CPU.
//!
//! The table of a map is uploaded once, and the pass is built once. A picture stays on the device, or is read back in slabs
//! of rows, so that a large one needs no buffer of its own size.

use std::sync::Arc;

use geodesic::piecewise::PiecewiseMap;
use geodesic::trace::Status;
use image::RgbaImage;

use crate::error::RenderError;
use crate::geodesic_view::{self, Cover, HATCH, LEAST_RING, RING, RayEnds};
use crate::gpu::canvas::{Canvases, Pixels};
use crate::gpu::device::Gpu;
use crate::gpu::layout::Resolve;
use crate::gpu::pipelines::{PipelineFactory, dispatch};
use crate::gpu::renderer::check_side;
use crate::style;
use crate::texture::Texture;

/// The number of tables and images in the cache, enough for this number of panes.
const KEPT: usize = 6;
/// The pixels of one slab: 16 MB of colours.
const SLAB_PIXELS: u32 = 1 << 22;
/// The number of statuses.
const STATUSES: usize = 6;

/// The state of the pass between pictures.
#[derive(Debug, Default)]
pub(crate) struct ResolvePass {
    pipeline: Option<wgpu::ComputePipeline>,
    samplers: Vec<([bool; 2], wgpu::Sampler)>,
    images: Vec<(Arc<Texture>, wgpu::TextureView)>,
    tables: Vec<DeviceEnds>,
}

/// The ends of a map on the device.
#[derive(Debug)]
struct DeviceEnds {
    ends: Arc<RayEnds>,
    words: wgpu::Buffer,
    /// The number of pixels of each status, once counted.
    counts: Option<Vec<u32>>,
}

/// A picture to be coloured.
pub(crate) struct ResolveTask<'a> {
    /// The ends, which are a table of polynomials.
    pub(crate) ends: &'a Arc<RayEnds>,
    /// The surface's image.
    pub(crate) cover: &'a Cover,
    /// The (u, v) to which the ends' offsets are relative.
    pub(crate) origin: [f64; 2],
    /// The surface's colour in linear light.
    pub(crate) colour: [f32; 3],
    pub(crate) mark_centre: bool,
    pub(crate) size: [u32; 2],
    /// True if the picture is needed in memory.
    pub(crate) in_memory: bool,
}

/// A picture that has been coloured.
pub(crate) struct Resolved {
    pub(crate) pixels: Pixels,
    /// The number of pixels of each status, by its code.
    pub(crate) counts: Vec<u32>,
}

/// The resources of a picture's dispatches; only the rows and their colours differ.
struct Bound<'a> {
    pipeline: &'a wgpu::ComputePipeline,
    table: &'a wgpu::Buffer,
    counts: &'a wgpu::Buffer,
    image: &'a wgpu::TextureView,
    sampler: &'a wgpu::Sampler,
}

impl ResolvePass {
    /// Colours a picture. `progress` receives the completed fraction.
    ///
    /// # Errors
    /// [`RenderError::Gpu`], also if the ends are not a table of polynomials; [`RenderError::Internal`].
    pub(crate) fn resolve(
        &mut self,
        factory: &mut PipelineFactory<'_>,
        canvases: &mut Canvases,
        task: &ResolveTask,
        progress: &dyn Fn(f32),
    ) -> Result<Resolved, RenderError> {
        let RayEnds::Piecewise { piecewise, .. } = &**task.ends else {
            return Err(RenderError::Gpu("a map has no table".to_owned()));
        };
        let gpu = factory.gpu;
        if !task.in_memory {
            check_side(gpu, task.size)?;
        }
        let pipeline = match &self.pipeline {
            Some(pipeline) => pipeline.clone(),
            None => {
                let built = factory.resolve_pipeline(&wgsl::painter::resolve_piecewise()?);
                self.pipeline.insert(built).clone()
            }
        };
        let sampler = self.sampler(factory, task.cover.repeats);
        let image = self.image(factory, &task.cover.texture);
        let table = self.table(gpu, task.ends, piecewise);
        let counts = gpu.output("counts", 4 * STATUSES as u64)?;
        let bound = Bound {
            pipeline: &pipeline,
            table: &table.words,
            counts: &counts,
            image: &image,
            sampler: &sampler,
        };
        let pixels = if task.in_memory {
            Pixels::Image(slabs(factory, &bound, task, progress)?)
        } else {
            let row = row_bytes(task.size[0]);
            let colours = gpu.output("colours", u64::from(row) * u64::from(task.size[1]))?;
            let canvas = canvases.take(gpu, task.size);
            let whole = [0, task.size[1]];
            submit(factory, &bound, task, whole, row / 4, &colours, |encoder| {
                canvas.fill(encoder, &colours, row);
            });
            Pixels::Texture(canvas)
        };
        // Reading them waits for the device, so it is done once for each map.
        let counts = match &table.counts {
            Some(counts) => counts.clone(),
            None => {
                let read = bytemuck::pod_collect_to_vec;
                let counted = gpu.read(&counts, 4 * STATUSES as u64, read)?;
                table.counts.insert(counted).clone()
            }
        };
        Ok(Resolved { pixels, counts })
    }

    fn table(
        &mut self,
        gpu: &Gpu,
        ends: &Arc<RayEnds>,
        piecewise: &PiecewiseMap,
    ) -> &mut DeviceEnds {
        recent(
            &mut self.tables,
            |table| Arc::ptr_eq(&table.ends, ends),
            || DeviceEnds {
                ends: ends.clone(),
                words: gpu.storage("table", bytemuck::cast_slice(&piecewise.table())),
                counts: None,
            },
        )
    }

    fn sampler(&mut self, factory: &mut PipelineFactory<'_>, repeats: [bool; 2]) -> wgpu::Sampler {
        let known = |(key, _): &([bool; 2], wgpu::Sampler)| *key == repeats;
        let make = || (repeats, factory.sampler(repeats));
        recent(&mut self.samplers, known, make).1.clone()
    }

    fn image(
        &mut self,
        factory: &mut PipelineFactory<'_>,
        texture: &Arc<Texture>,
    ) -> wgpu::TextureView {
        let known = |(key, _): &(Arc<Texture>, wgpu::TextureView)| Arc::ptr_eq(key, texture);
        let make = || (texture.clone(), factory.texture(texture));
        recent(&mut self.images, known, make).1.clone()
    }
}

/// Colours the picture slab by slab into memory.
fn slabs(
    factory: &PipelineFactory<'_>,
    bound: &Bound,
    task: &ResolveTask,
    progress: &dyn Fn(f32),
) -> Result<RgbaImage, RenderError> {
    let gpu = factory.gpu;
    let [width, height] = task.size;
    let mut picture = RgbaImage::new(width, height);
    let slab = (SLAB_PIXELS / width).clamp(1, height);
    for first in (0..height).step_by(slab as usize) {
        let rows = slab.min(height - first);
        let size = 4 * u64::from(width) * u64::from(rows);
        let colours = gpu.output("colours", size)?;
        submit(factory, bound, task, [first, rows], width, &colours, |_| {});
        let start = 4 * first as usize * width as usize;
        gpu.read(&colours, size, |bytes| {
            picture.as_flat_samples_mut().samples[start..start + bytes.len()]
                .copy_from_slice(bytes);
        })?;
        progress((first + rows) as f32 / height as f32);
    }
    Ok(picture)
}

/// Submits the dispatch of some rows (the first one and their number), `stride` pixels apart, and the commands that process
/// their colours.
fn submit(
    factory: &PipelineFactory<'_>,
    bound: &Bound,
    task: &ResolveTask,
    rows: [u32; 2],
    stride: u32,
    colours: &wgpu::Buffer,
    then: impl FnOnce(&mut wgpu::CommandEncoder),
) {
    let gpu = factory.gpu;
    let uniform = gpu.uniform("resolve", &description(task, rows, stride));
    let group = factory.bind(
        &bound.pipeline.get_bind_group_layout(0),
        &[
            uniform.as_entire_binding(),
            bound.table.as_entire_binding(),
            colours.as_entire_binding(),
            bound.counts.as_entire_binding(),
            wgpu::BindingResource::TextureView(bound.image),
            wgpu::BindingResource::Sampler(bound.sampler),
        ],
    );
    // A workgroup colours a block of the table.
    let groups = [task.size[0].div_ceil(8), rows[1].div_ceil(8)];
    gpu.submit(|encoder| {
        dispatch(encoder, bound.pipeline, &group, groups);
        then(encoder);
    });
}

/// Returns the bytes of a row from which a texture can be filled.
fn row_bytes(width: u32) -> u32 {
    (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// Returns the inputs of the pass for one picture.
fn description(task: &ResolveTask, rows: [u32; 2], stride: u32) -> Resolve {
    let size = task.size;
    let cover = task.cover;
    let pixel_unit = style::pixel_unit(size);
    let hatch_unit = pixel_unit.max(0.4);
    let mark = task.mark_centre && size[0].min(size[1]) >= 32;
    let mut hatching = [[1.0; 4]; 12];
    for (code, pair) in hatching.chunks_exact_mut(2).enumerate() {
        let colours = geodesic_view::hatching(status_of(code as u32));
        for (to, colour) in pair.iter_mut().zip(colours) {
            let [r, g, b] = style::linear(colour);
            *to = [r, g, b, 1.0];
        }
    }
    let [r, g, b] = task.colour;
    let place = cover.share(task.origin);
    Resolve {
        colour: [r, g, b, 1.0],
        // If the image repeats, whole periods would only cost digits.
        place: [0, 1].map(|k| match cover.repeats[k] {
            true => (place[k] - place[k].floor()) as f32,
            false => place[k] as f32,
        }),
        per_width: cover.period.map(|period| (1.0 / period) as f32),
        repeats: cover.repeats.map(|repeats| f32::from(u8::from(repeats))),
        size,
        rows,
        padding: [0; 2],
        hatch: HATCH * hatch_unit,
        reach: (hatch_unit.round() as i32).max(1),
        ring: if mark {
            (RING * pixel_unit).max(LEAST_RING)
        } else {
            0.0
        },
        ring_half: (0.75 * pixel_unit).max(0.6),
        stride: [stride, 0, 0, 0],
        hatching,
    }
}

fn status_of(code: u32) -> Status {
    match code {
        0 => Status::Complete,
        1 => Status::LeftDomain,
        2 => Status::ConePoint,
        3 => Status::Degenerate,
        4 => Status::Undefined,
        _ => Status::WorkLimit,
    }
}

/// Returns the entry, created if it does not exist; it moves to the end of the list, and the first entry is evicted.
fn recent<T>(all: &mut Vec<T>, is: impl Fn(&T) -> bool, make: impl FnOnce() -> T) -> &mut T {
    let entry = match all.iter().position(is) {
        Some(at) => all.remove(at),
        None => make(),
    };
    if all.len() >= KEPT {
        all.remove(0);
    }
    all.push(entry);
    let last = all.len() - 1;
    &mut all[last]
}
