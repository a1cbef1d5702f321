//! Kernels that are compiled in the background: until one is ready, f64 blocks stand in for it, and no picture waits.
//!
//! Drivers compile at the first dispatch, so a kernel counts as ready when it has filled a few samples.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

use scene::ParamValues;
use scene::{ObjectId, Scene};
use wgsl::GenerateError;

use crate::content::Structure;
use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::pipelines::PipelineFactory;
use crate::gpu::samples::{self, SampleBuffer};
use crate::placement::Placement;
use crate::plan::{self, KERNEL_PAYS};

/// Samples that a kernel fills before it is said to be ready.
const FIRST: u64 = 64;
/// Kernels that are kept.
const MOST: usize = 256;

/// Kernels by the structure of what they sample.
#[derive(Debug)]
pub(crate) struct Kernels {
    states: HashMap<Arc<[u64]>, KernelState>,
    built: Arc<AtomicU64>,
    /// The threads that build kernels.
    threads: Vec<JoinHandle<()>>,
    /// The number of operations from which on an object has one.
    pays: u64,
}

#[derive(Debug)]
struct KernelState {
    /// Operations of one sample, with its normal.
    operations: u64,
    kernel: Option<Arc<OnceLock<Made>>>,
}

/// The outcome of building a kernel.
#[derive(Debug)]
enum Made {
    Ready(Ready),
    /// Its expressions are too large for a shader.
    TooLarge,
    /// The driver, or this program's own validation, has refused it; the message.
    Refused(String),
}

#[derive(Debug)]
struct Ready {
    pipeline: wgpu::ComputePipeline,
    /// The index among the structure's uniforms of each number of a row of uniforms.
    slots: Vec<usize>,
}

/// The samples of an object, as far as kernels give them.
pub(crate) enum ObjectSamples {
    /// Its samples, by a kernel.
    Samples(SampleBuffer),
    /// Blocks are to be used; if a kernel has been refused, why.
    Blocks(Option<String>),
}

/// An object of a scene.
pub(crate) struct SampleRequest<'a> {
    pub(crate) scene: &'a Arc<Scene>,
    pub(crate) params: &'a ParamValues,
    pub(crate) object: ObjectId,
    pub(crate) structure: &'a Structure,
    pub(crate) placement: &'a Placement,
    /// True if the picture waits for its kernel.
    pub(crate) waits: bool,
}

impl Default for Kernels {
    fn default() -> Self {
        Self {
            states: HashMap::new(),
            built: Arc::default(),
            threads: Vec::new(),
            pays: KERNEL_PAYS,
        }
    }
}

impl Kernels {
    /// Sets the number of operations from which on an object has a kernel.
    pub(crate) fn pay_from(&mut self, operations: u64) {
        self.pays = operations;
    }

    /// Returns true if any is being made.
    pub(crate) fn is_making(&self) -> bool {
        let begun = self.states.values().filter_map(|it| it.kernel.as_ref());
        begun.into_iter().any(|kernel| kernel.get().is_none())
    }

    /// Samples of an object by its kernel, if it pays and is ready. If it pays and is not known, its making begins.
    ///
    /// # Errors
    /// Those of the device.
    pub(crate) fn samples(
        &mut self,
        gpu: &Arc<Gpu>,
        wanted: &SampleRequest,
    ) -> Result<ObjectSamples, RenderError> {
        let SampleRequest {
            scene, structure, ..
        } = *wanted;
        let object = &scene.objects[wanted.object.index()];
        let samples = plan::samples(scene, wanted.params, object);
        // Where kernels are refused for a test, they are requested at once.
        let pays = if gpu.refuses_samples() { 1 } else { self.pays };
        // Nothing that a shader may hold would pay.
        if samples.saturating_mul(wgsl::kernel::OPERATION_LIMIT as u64) < pays {
            return Ok(ObjectSamples::Blocks(None));
        }
        if self.states.len() >= MOST && !self.states.contains_key(structure.words()) {
            self.states.clear();
        }
        let state = self
            .states
            .entry(structure.words().clone())
            .or_insert_with(|| KernelState {
                operations: plan::operations(scene, object),
                kernel: None,
            });
        if samples.saturating_mul(state.operations) < pays
            || !plan::may_have_kernel(scene, wanted.params, object)
        {
            return Ok(ObjectSamples::Blocks(None));
        }
        let kernel = state
            .kernel
            .get_or_insert_with(|| begin(gpu, wanted, &self.built, &mut self.threads));
        if wanted.waits {
            kernel.wait();
        }
        match kernel.get() {
            None | Some(Made::TooLarge) => Ok(ObjectSamples::Blocks(None)),
            Some(Made::Refused(message)) => {
                Ok(ObjectSamples::Blocks(Some(refused(&object.name, message))))
            }
            Some(Made::Ready(ready)) => {
                let slots: Vec<u32> = ready
                    .slots
                    .iter()
                    .map(|&at| structure.uniforms()[at])
                    .collect();
                let by = (&ready.pipeline, &slots[..]);
                samples::by_kernel(
                    gpu,
                    scene,
                    wanted.params,
                    object,
                    by,
                    wanted.placement,
                    None,
                )
                .map(ObjectSamples::Samples)
            }
        }
    }

    /// Returns the note on an object whose kernel has been refused.
    pub(crate) fn refusal(&self, structure: &Structure, name: &str) -> Option<String> {
        let kernel = self.states.get(structure.words())?.kernel.as_ref()?;
        match kernel.get()? {
            Made::Refused(message) => Some(refused(name, message)),
            _ => None,
        }
    }

    /// The number of kernels that have been built so far.
    pub(crate) fn built(&self) -> u64 {
        self.built.load(Ordering::Relaxed)
    }
}

impl Drop for Kernels {
    fn drop(&mut self) {
        // The process may end next, and that unloads the driver: a thread that still uses it would crash the process.
        for thread in self.threads.drain(..) {
            // A panic of the thread has been reported where it occurred.
            let _ = thread.join();
        }
    }
}

fn refused(name: &str, message: &str) -> String {
    format!("the GPU has refused the shader of `{name}`, which is computed without it: {message}")
}

/// Begins to make the kernel of an object, on a thread of its own.
fn begin(
    gpu: &Arc<Gpu>,
    wanted: &SampleRequest,
    built: &Arc<AtomicU64>,
    threads: &mut Vec<JoinHandle<()>>,
) -> Arc<OnceLock<Made>> {
    let place = Arc::new(OnceLock::new());
    let (gpu, built, result) = (gpu.clone(), built.clone(), place.clone());
    let scene = wanted.scene.clone();
    let (params, object) = (wanted.params.clone(), wanted.object);
    let (structure, placement) = (wanted.structure.clone(), *wanted.placement);
    let work = move || {
        let made = make(&gpu, &scene, &params, object, &structure, &placement);
        built.fetch_add(u64::from(matches!(made, Made::Ready(_))), Ordering::Relaxed);
        // Nobody else sets it.
        let _ = result.set(made);
    };
    threads.retain(|thread| !thread.is_finished());
    match thread::Builder::new().name("kernel".to_owned()).spawn(work) {
        Ok(thread) => threads.push(thread),
        // Blocks go on.
        Err(error) => {
            let _ = place.set(Made::Refused(error.to_string()));
        }
    }
    place
}

fn make(
    gpu: &Gpu,
    scene: &Scene,
    params: &ParamValues,
    object: ObjectId,
    structure: &Structure,
    placement: &Placement,
) -> Made {
    let object = &scene.objects[object.index()];
    let kernel = match samples::kernel(scene, &object.shape) {
        Ok(kernel) => kernel,
        Err(GenerateError::TooLarge { .. }) => return Made::TooLarge,
        Err(GenerateError::Internal(error)) => return Made::Refused(error.message),
    };
    let made = gpu.guarded(|| {
        let pipeline = PipelineFactory::new(gpu).sample_kernel(&kernel);
        let by = (&pipeline, kernel.uniforms());
        samples::by_kernel(gpu, scene, params, object, by, placement, Some(FIRST))?;
        Ok(pipeline)
    });
    let slot = |uniform: &u32| {
        structure
            .uniforms()
            .iter()
            .position(|known| known == uniform)
    };
    let slots: Option<Vec<usize>> = kernel.uniforms().iter().map(slot).collect();
    match (made, slots) {
        (Ok(pipeline), Some(slots)) => Made::Ready(Ready { pipeline, slots }),
        (Ok(_), None) => Made::TooLarge,
        (Err(error), _) => Made::Refused(error.to_string()),
    }
}
