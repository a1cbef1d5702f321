//! The pipelines of the pass of traced pictures, one for each set of functions.
//!
//! In: the text of functions. Out: a pipeline, once it is built. Compiling takes seconds on a separate thread; meanwhile f64
//! draws.

use std::sync::Arc;

use bytemuck::Zeroable;

use crate::error::RenderError;
use crate::gpu::background::BackgroundBuild;
use crate::gpu::device::Gpu;
use crate::gpu::layout::Trace;
use crate::gpu::pipelines::{PipelineFactory, dispatch};
use crate::plan::Built;

/// The number of cached pipelines.
const KEPT: usize = 4;

/// The pipelines of the last pictures; the most recently used one is last.
#[derive(Debug, Default)]
pub(super) struct TracePipelines(Vec<TracePipeline>);

#[derive(Debug)]
struct TracePipeline {
    functions: String,
    pipeline: BackgroundBuild<wgpu::ComputePipeline>,
}

impl TracePipelines {
    /// As [`TracePass::is_ready`](super::TracePass::is_ready).
    pub(super) fn is_ready(
        &mut self,
        gpu: &Arc<Gpu>,
        functions: &str,
        built: &mut Built,
        waits: bool,
    ) -> Result<bool, String> {
        let is_building = self.is_building();
        let pipelines = &mut self.0;
        match pipelines.iter().position(|it| it.functions == functions) {
            Some(known) => pipelines[known..].rotate_left(1),
            // During editing, the functions may change faster than they are compiled.
            None if !waits && is_building => return Ok(false),
            None => {
                // Removing a pipeline that is still being built would wait for it.
                if pipelines.len() >= KEPT
                    && let Some(done) = pipelines.iter().position(|it| !it.pipeline.is_building())
                {
                    pipelines.remove(done);
                }
                built.trace_pipelines += 1;
                pipelines.push(TracePipeline::start(gpu, functions));
            }
        }
        let Some(TracePipeline { pipeline, .. }) = self.0.last() else {
            return Ok(false);
        };
        if waits {
            pipeline.wait();
        }
        match pipeline.get() {
            None => Ok(false),
            Some(Ok(_)) => Ok(true),
            Some(Err(message)) => Err(format!("the GPU rejected its shader: {message}")),
        }
    }

    /// Returns true while a pipeline is being built.
    pub(super) fn is_building(&self) -> bool {
        self.0.iter().any(|it| it.pipeline.is_building())
    }

    /// Returns the pipeline with these functions.
    pub(super) fn get(&self, functions: &str) -> Option<&wgpu::ComputePipeline> {
        let known = self.0.iter().find(|it| it.functions == functions)?;
        known.pipeline.get()?.as_ref().ok()
    }
}

impl TracePipeline {
    fn start(gpu: &Arc<Gpu>, functions: &str) -> Self {
        let (gpu, text) = (gpu.clone(), functions.to_owned());
        let pipeline = BackgroundBuild::start("trace", move || {
            let built = gpu.guarded(|| build(&gpu, &text));
            built.map_err(|error| error.to_string())
        });
        Self {
            functions: functions.to_owned(),
            pipeline,
        }
    }
}

/// Builds the pipeline and dispatches it for zero pixels: drivers compile at the first dispatch.
fn build(gpu: &Gpu, functions: &str) -> Result<wgpu::ComputePipeline, RenderError> {
    let mut factory = PipelineFactory::new(gpu);
    let pipeline = factory.trace_pipeline(&wgsl::traced::trace_scene(functions)?);
    let uniform = gpu.uniform("trace", &Trace::zeroed());
    let buffers: Result<Vec<_>, _> = (0..8).map(|_| gpu.output("nothing", 256)).collect();
    let buffers = buffers?;
    let resources: Vec<_> = std::iter::once(&uniform)
        .chain(&buffers)
        .map(wgpu::Buffer::as_entire_binding)
        .collect();
    let group = factory.bind(&pipeline.get_bind_group_layout(0), &resources);
    gpu.submit(|encoder| dispatch(encoder, &pipeline, &group, [1, 1]));
    gpu.wait()?;
    Ok(pipeline)
}
