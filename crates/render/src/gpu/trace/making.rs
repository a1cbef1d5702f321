//! The pipelines of the pass of traced pictures, each with the functions of a scene.
//!
//! Input: the text of functions. Output: a pipeline, once it is made; it takes seconds to compile, on a thread of its own, and
//! meanwhile f64 draws.

use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

use bytemuck::Zeroable;

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::layout::Trace;
use crate::gpu::pipelines::{PipelineFactory, dispatch};
use crate::plan::Built;

/// The pipelines that are kept.
const KEPT: usize = 4;

/// The pipelines of the last pictures, the one that was asked for last at the end.
#[derive(Debug, Default)]
pub(super) struct TracePipelines(Vec<Making>);

/// A pipeline that is being made, or is there.
#[derive(Debug)]
struct Making {
    functions: String,
    /// The pipeline, or the message with which it was refused.
    made: Arc<OnceLock<Result<wgpu::ComputePipeline, String>>>,
    thread: Option<JoinHandle<()>>,
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
        let is_making = self.is_making();
        let pipelines = &mut self.0;
        match pipelines.iter().position(|it| it.functions == functions) {
            Some(known) => pipelines[known..].rotate_left(1),
            // While a program is edited, its functions may change sooner than they are compiled.
            None if !waits && is_making => return Ok(false),
            None => {
                // One that is still being made would have to be waited for.
                if pipelines.len() >= KEPT
                    && let Some(done) = pipelines.iter().position(|it| it.made.get().is_some())
                {
                    pipelines.remove(done);
                }
                built.trace_pipelines += 1;
                pipelines.push(Making::begin(gpu, functions));
            }
        }
        let Some(making) = self.0.last() else {
            return Ok(false);
        };
        if waits {
            making.made.wait();
        }
        match making.made.get() {
            None => Ok(false),
            Some(Ok(_)) => Ok(true),
            Some(Err(message)) => Err(format!("the GPU has refused its shader: {message}")),
        }
    }

    /// True while a pipeline is made.
    pub(super) fn is_making(&self) -> bool {
        self.0.iter().any(|making| making.made.get().is_none())
    }

    /// The pipeline with these functions.
    pub(super) fn get(&self, functions: &str) -> Option<&wgpu::ComputePipeline> {
        let making = self.0.iter().find(|it| it.functions == functions)?;
        making.made.get()?.as_ref().ok()
    }
}

impl Making {
    fn begin(gpu: &Arc<Gpu>, functions: &str) -> Self {
        let made = Arc::new(OnceLock::new());
        let (gpu, result) = (gpu.clone(), made.clone());
        let text = functions.to_owned();
        let work = move || {
            let made = gpu.guarded(|| make(&gpu, &text));
            // Nobody else sets it.
            let _ = result.set(made.map_err(|error| error.to_string()));
        };
        let thread = std::thread::Builder::new().name("trace".to_owned());
        let thread = thread.spawn(work);
        if let Err(error) = &thread {
            // Nobody else sets it.
            let _ = made.set(Err(error.to_string()));
        }
        Self {
            functions: functions.to_owned(),
            made,
            thread: thread.ok(),
        }
    }
}

impl Drop for Making {
    fn drop(&mut self) {
        // The process may end next, and that unloads the driver: a thread that still uses it would crash the process.
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has been reported where it occurred.
            let _ = thread.join();
        }
    }
}

/// Builds the pipeline and dispatches it for no pixel: drivers compile at the first dispatch.
fn make(gpu: &Gpu, functions: &str) -> Result<wgpu::ComputePipeline, RenderError> {
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
