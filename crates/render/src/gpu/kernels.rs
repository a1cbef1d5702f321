//! Kernels that are compiled in the background: until a kernel is ready, f64 blocks replace it, and no picture waits.
//!
//! Drivers compile at the first dispatch, so a kernel counts as ready when it has filled a few samples.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use scene::ParamValues;
use scene::{ObjectId, Scene};
use wgsl::GenerateError;

use crate::content::Structure;
use crate::error::RenderError;
use crate::gpu::background::BackgroundBuild;
use crate::gpu::device::Gpu;
use crate::gpu::pipelines::PipelineFactory;
use crate::gpu::samples::{self, SampleBuffer};
use crate::placement::Placement;
use crate::plan::{self, KERNEL_PAYS};

/// The number of samples that a kernel fills before it counts as ready.
const FIRST: u64 = 64;
/// The maximum number of cached kernels.
const MOST: usize = 256;

/// Kernels by the structure of the sampled object.
#[derive(Debug)]
pub(crate) struct Kernels {
    states: HashMap<Arc<[u64]>, KernelState>,
    built: Arc<AtomicU64>,
    /// The number of operations from which on an object has a kernel.
    pays: u64,
}

#[derive(Debug)]
struct KernelState {
    /// The number of operations of one sample, with its normal.
    operations: u64,
    /// Fails if the driver, or this program's own validation, refuses it.
    kernel: Option<BackgroundBuild<Kernel>>,
}

#[derive(Debug)]
enum Kernel {
    Ready(Ready),
    /// Its expressions are too large for a shader.
    TooLarge,
}

#[derive(Debug)]
struct Ready {
    pipeline: wgpu::ComputePipeline,
    /// For each number of a row of uniforms, its index among the structure's uniforms.
    slots: Vec<usize>,
}

/// The samples of an object, if a kernel provides them.
pub(crate) enum ObjectSamples {
    /// Its samples, computed by a kernel.
    Samples(SampleBuffer),
    /// Blocks are to be used; if a kernel has been refused, with the reason.
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
            pays: KERNEL_PAYS,
        }
    }
}

impl Kernels {
    /// Sets the number of operations from which on an object has a kernel.
    pub(crate) fn pay_from(&mut self, operations: u64) {
        self.pays = operations;
    }

    /// Returns true if any is being built.
    pub(crate) fn is_building(&self) -> bool {
        self.states.values().any(KernelState::is_building)
    }

    /// Returns samples of an object from its kernel, if the kernel pays off and is ready. If it pays off and is new, starts
    /// to build it.
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
        // If a test refuses kernels, they are requested at once.
        let pays = if gpu.refuses_samples() { 1 } else { self.pays };
        // Even the largest shader would not pay off.
        if samples.saturating_mul(wgsl::kernel::OPERATION_LIMIT as u64) < pays {
            return Ok(ObjectSamples::Blocks(None));
        }
        if self.states.len() >= MOST && !self.states.contains_key(structure.words()) {
            // Removing a kernel that is still being built would wait for it.
            self.states.retain(|_, state| state.is_building());
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
            .get_or_insert_with(|| start(gpu, wanted, &self.built));
        if wanted.waits {
            kernel.wait();
        }
        match kernel.get() {
            None | Some(Ok(Kernel::TooLarge)) => Ok(ObjectSamples::Blocks(None)),
            Some(Err(message)) => Ok(ObjectSamples::Blocks(Some(refused(&object.name, message)))),
            Some(Ok(Kernel::Ready(ready))) => {
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
        let message = kernel.get()?.as_ref().err()?;
        Some(refused(name, message))
    }

    /// Returns the number of kernels that have been built so far.
    pub(crate) fn built(&self) -> u64 {
        self.built.load(Ordering::Relaxed)
    }
}

impl KernelState {
    fn is_building(&self) -> bool {
        self.kernel
            .as_ref()
            .is_some_and(BackgroundBuild::is_building)
    }
}

fn refused(name: &str, message: &str) -> String {
    format!(
        "the GPU rejected the shader of `{name}`, which is computed on the processor: {message}"
    )
}

/// Starts to build the kernel of an object.
fn start(
    gpu: &Arc<Gpu>,
    wanted: &SampleRequest,
    built: &Arc<AtomicU64>,
) -> BackgroundBuild<Kernel> {
    let (gpu, count) = (gpu.clone(), built.clone());
    let scene = wanted.scene.clone();
    let (params, object) = (wanted.params.clone(), wanted.object);
    let (structure, placement) = (wanted.structure.clone(), *wanted.placement);
    BackgroundBuild::start("kernel", move || {
        let kernel = build(&gpu, &scene, &params, object, &structure, &placement)?;
        count.fetch_add(
            u64::from(matches!(kernel, Kernel::Ready(_))),
            Ordering::Relaxed,
        );
        Ok(kernel)
    })
}

fn build(
    gpu: &Gpu,
    scene: &Scene,
    params: &ParamValues,
    object: ObjectId,
    structure: &Structure,
    placement: &Placement,
) -> Result<Kernel, String> {
    let object = &scene.objects[object.index()];
    let kernel = match samples::kernel(scene, &object.shape) {
        Ok(kernel) => kernel,
        Err(GenerateError::TooLarge { .. }) => return Ok(Kernel::TooLarge),
        Err(GenerateError::Internal(error)) => return Err(error.message),
    };
    let built = gpu.guarded(|| {
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
    let pipeline = built.map_err(|error| error.to_string())?;
    Ok(match slots {
        Some(slots) => Kernel::Ready(Ready { pipeline, slots }),
        None => Kernel::TooLarge,
    })
}
