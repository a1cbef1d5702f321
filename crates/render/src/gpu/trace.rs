//! Traced pictures on the GPU: one pass, to which scenes are data, follows the rays.
//!
//! ```text
//! SceneTables ──tables.rs: buffers, kept──▶ pass/trace_scene.wgsl ──▶ sums of light, row by row
//! camera, lights ──lens.rs: numbers────────────┘       ▲           └─▶ samples that f32 cannot decide
//! SceneTables::functions ──pipelines.rs: kept──────────┘
//! ```
//!
//! The pass is fixed except for the functions of a scene's expressions. An edit that leaves their text unchanged writes
//! buffers and compiles nothing.

mod codes;
mod lens;
mod pipelines;
mod tables;

use std::sync::Arc;

use bytemuck::Zeroable;
use glam::DVec3;
use tracer::PictureLook;
use tracer::camera::{LensCamera, SampleAxes};
use tracer::light::Light;

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::layout::{ShaderLight, Trace};
use crate::gpu::pipelines::{PipelineFactory, dispatch};
use crate::gpu::trace::lens::{lens_of, light_of};
use crate::gpu::trace::pipelines::TracePipelines;
use crate::gpu::trace::tables::TableBuffers;
use crate::plan::Built;
use crate::solids::{SceneTables, TracedScene};

/// The pixels of one dispatch: few enough that no driver assumes a hang; a picture can be cancelled between two dispatches.
const DISPATCHED: u32 = 1 << 17;
/// The number of pixels whose sums are in memory at once.
const SLAB_PIXELS: u32 = 1 << 22;
/// The number of samples of a pixel whose sums are read at once: their marks are the bits of an integer that f32 represents
/// exactly.
const MOST_SAMPLES: u32 = 24;

/// The state of the pass between pictures.
#[derive(Debug, Default)]
pub(crate) struct TracePass {
    pipelines: TracePipelines,
    tables: Option<(Arc<TracedScene>, TableBuffers)>,
}

/// Samples to be traced.
pub(crate) struct TraceTask<'a> {
    pub(crate) scene: &'a Arc<TracedScene>,
    pub(crate) tables: &'a SceneTables,
    pub(crate) lights: &'a [Light],
    pub(crate) camera: &'a LensCamera,
    pub(crate) axes: SampleAxes,
    pub(crate) size: [u32; 2],
    pub(crate) bounces: u32,
    pub(crate) look: PictureLook,
    /// The first sample of each pixel, and their number.
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// Samples that have been traced.
pub(crate) struct TracedSamples {
    /// The sums of each pixel's light, row by row, without the marked samples.
    pub(crate) sums: Vec<DVec3>,
    /// The samples that f32 cannot decide, each with its pixel.
    pub(crate) marked: Vec<([u32; 2], u32)>,
}

impl TracePass {
    /// Returns true if the pipeline with these functions is ready. The first call starts to build it, which `built` counts,
    /// unless another one is being built; with `waits`, waits for it.
    ///
    /// # Errors
    /// A clause, if the driver has refused it.
    pub(crate) fn is_ready(
        &mut self,
        gpu: &Arc<Gpu>,
        functions: &str,
        built: &mut Built,
        waits: bool,
    ) -> Result<bool, String> {
        self.pipelines.is_ready(gpu, functions, built, waits)
    }

    /// Returns true while a pipeline is being built.
    pub(crate) fn is_building(&self) -> bool {
        self.pipelines.is_building()
    }

    /// Traces samples. `progress` receives the completed fraction; if it returns false, the result is `None`.
    ///
    /// # Errors
    /// [`RenderError::Gpu`], also if the pipeline is not ready.
    pub(crate) fn trace(
        &mut self,
        factory: &PipelineFactory<'_>,
        task: &TraceTask<'_>,
        progress: &dyn Fn(f32) -> bool,
    ) -> Result<Option<TracedSamples>, RenderError> {
        let gpu = factory.gpu;
        let Some(pipeline) = self.pipelines.get(&task.tables.functions) else {
            return Err(RenderError::Gpu(
                "the traced view has no pipeline".to_owned(),
            ));
        };
        let known = self.tables.take();
        let known = known.filter(|(scene, _)| Arc::ptr_eq(scene, task.scene));
        let (_, tables) = match known {
            Some(known) => self.tables.insert(known),
            None => {
                let tables = TableBuffers::new(gpu, task.tables)?;
                self.tables.insert((task.scene.clone(), tables))
            }
        };
        let origin = task.tables.world.origin;
        let mut lights: Vec<ShaderLight> = task
            .lights
            .iter()
            .map(|light| light_of(light, origin))
            .collect();
        // An empty binding is refused.
        lights.push(ShaderLight::zeroed());
        let lights = gpu.storage("lights", bytemuck::cast_slice(&lights));
        let [width, height] = task.size;
        let slab = (SLAB_PIXELS / width).clamp(1, height);
        let bytes = 16 * u64::from(width) * u64::from(slab);
        let sums = gpu.output("sums of light", bytes)?;
        let bound = Bound {
            pipeline,
            tables,
            lights: &lights,
            sums: &sums,
        };
        let mut traced = TracedSamples {
            sums: vec![DVec3::ZERO; width as usize * height as usize],
            marked: Vec::new(),
        };
        let all = f64::from(height) * f64::from(task.count);
        let mut done = 0.0;
        for slab_row in (0..height).step_by(slab as usize) {
            let end = (slab_row + slab).min(height);
            for first in (0..task.count).step_by(MOST_SAMPLES as usize) {
                let samples = MOST_SAMPLES.min(task.count - first);
                let most = (DISPATCHED / width).clamp(1, slab);
                for k in 0..samples {
                    for row in (slab_row..end).step_by(most as usize) {
                        let rows = most.min(end - row);
                        bound.submit(factory, task, slab_row, [row, rows], [first, k]);
                        gpu.wait()?;
                        done += f64::from(rows);
                        if !progress((done / all) as f32) {
                            return Ok(None);
                        }
                    }
                }
                let bytes = 16 * u64::from(width) * u64::from(end - slab_row);
                gpu.read(&sums, bytes, |bytes| {
                    let sums: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(bytes);
                    traced.add(&sums, slab_row, width, task.first + first);
                })?;
            }
        }
        Ok(Some(traced))
    }
}

impl TracedSamples {
    /// Adds the sums of rows from `row` on, with the marks of samples from `first` on.
    fn add(&mut self, sums: &[[f32; 4]], row: u32, width: u32, first: u32) {
        let start = row as usize * width as usize;
        for (k, (&[r, g, b, marks], sum)) in sums.iter().zip(&mut self.sums[start..]).enumerate() {
            *sum += DVec3::new(r.into(), g.into(), b.into());
            let marks = marks as u32;
            for sample in (0..MOST_SAMPLES).filter(|sample| marks >> sample & 1 == 1) {
                let pixel = [k as u32 % width, row + k as u32 / width];
                self.marked.push((pixel, first + sample));
            }
        }
    }
}

/// The resources of a picture's dispatches.
struct Bound<'a> {
    pipeline: &'a wgpu::ComputePipeline,
    tables: &'a TableBuffers,
    lights: &'a wgpu::Buffer,
    sums: &'a wgpu::Buffer,
}

impl Bound<'_> {
    /// Submits the dispatch of a sample of some rows: the first row and their number, the first of the samples whose sums
    /// are read at once, and the number of those before this one.
    fn submit(
        &self,
        factory: &PipelineFactory<'_>,
        task: &TraceTask<'_>,
        slab_row: u32,
        [first_row, rows]: [u32; 2],
        [first, before]: [u32; 2],
    ) {
        let gpu: &Gpu = factory.gpu;
        let places = &self.tables.places;
        let trace = Trace {
            lens: lens_of(task.camera, task.axes, task.size, task.tables.world.origin),
            first_row,
            rows,
            sample: task.first + first + before,
            bit: 1 << before,
            light_count: task.lights.len() as u32,
            endless: task.tables.world.endless as u32,
            boxes: task.tables.world.boxes.len() as u32,
            bounces: task.bounces,
            look: codes::LOOK_CRT * u32::from(task.look == PictureLook::Crt),
            least_weight: task.look.least_weight() as f32,
            order_at: places.order,
            terms_at: places.terms,
            sky_at: places.sky,
            sky_cells: task.tables.sky.len() as u32 - 1,
            slab_row,
            one: 1,
        };
        let uniform = gpu.uniform("trace", &trace);
        let tables = &self.tables;
        let resources = [
            &uniform,
            &tables.boxes,
            &tables.components,
            &tables.leaves,
            &tables.pieces,
            &tables.words,
            &tables.materials,
            self.lights,
            self.sums,
        ]
        .map(wgpu::Buffer::as_entire_binding);
        let group = factory.bind(&self.pipeline.get_bind_group_layout(0), &resources);
        let groups = [task.size[0].div_ceil(8), rows.div_ceil(8)];
        gpu.submit(|encoder| dispatch(encoder, self.pipeline, &group, groups));
    }
}
