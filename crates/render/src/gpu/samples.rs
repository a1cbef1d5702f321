//! Buffers of samples, filled by f64 blocks on the CPU or by a generated kernel; painters do not know which.

use scene::ParamValues;
use scene::{Object, ObjectId, Sampling, Scene, Shape};
use wgsl::{GenerateError, Kernel};

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::internal;
use crate::gpu::layout;
use crate::gpu::pipelines::{PipelineFactory, bind_numbered, dispatch_flat};
use crate::placement::Placement;
use crate::sample::{
    self, HORIZON, NORMAL_NUDGE, PositionSample, Samples, SurfaceSample, VectorSample,
};
use crate::style::Look;

/// The samples of one object on the GPU.
#[derive(Clone, Debug)]
pub(crate) struct SampleBuffer {
    pub(crate) buffer: wgpu::Buffer,
    /// Samples of one instance along each parameter; 1 for a missing parameter.
    pub(crate) count: [u32; 2],
    /// Samples of all instances.
    pub(crate) total: u32,
    /// The number of undefined samples, if a kernel has computed them.
    pub(crate) undefined: usize,
}

impl SampleBuffer {
    /// Returns the notes on the samples of this object, which a kernel has computed.
    pub(crate) fn note(&self, name: &str) -> Option<String> {
        sample::note(name, self.total as usize, self.undefined)
    }
}

/// Returns the samples of an object as its generated kernel computes them, read back; `None` if its expressions are too
/// large for a shader.
pub(crate) fn computed(
    factory: &mut PipelineFactory<'_>,
    scene: &Scene,
    params: &ParamValues,
    id: ObjectId,
    placement: &Placement,
) -> Result<Option<Samples>, RenderError> {
    let object = &scene.objects[id.index()];
    let kernel = match kernel(scene, &object.shape) {
        Ok(kernel) => kernel,
        Err(error) => return internal(error).map_or(Ok(None), Err),
    };
    let filled = run(factory, scene, params, object, &kernel, placement)?;
    let total = u64::from(filled.total);
    let read = |size: usize| (&filled.buffer, total * size as u64);
    let gpu = factory.gpu;
    let positions = || {
        let (buffer, size) = read(size_of::<PositionSample>());
        gpu.read(
            buffer,
            size,
            bytemuck::pod_collect_to_vec::<u8, PositionSample>,
        )
    };
    let count = filled.count;
    let is_vector = object.shape.vector().is_some();
    Ok(Some(match object.shape.domain() {
        _ if is_vector => {
            let (buffer, size) = read(size_of::<VectorSample>());
            Samples::Vectors(gpu.read(buffer, size, bytemuck::pod_collect_to_vec)?)
        }
        [] => Samples::Points(positions()?),
        [_] => Samples::Curves {
            count: count[0],
            samples: positions()?,
        },
        _ => {
            let (buffer, size) = read(size_of::<SurfaceSample>());
            let samples = gpu.read(buffer, size, bytemuck::pod_collect_to_vec)?;
            Samples::Surfaces { count, samples }
        }
    }))
}

/// Creates a buffer with existing samples.
///
/// # Errors
/// [`RenderError::Gpu`] if they exceed the limits of the device.
pub(crate) fn upload_samples(gpu: &Gpu, samples: &Samples) -> Result<SampleBuffer, RenderError> {
    let (bytes, count, total): (&[u8], _, _) = match samples {
        Samples::Points(samples) => (bytemuck::cast_slice(samples), [1, 1], samples.len()),
        Samples::Vectors(samples) => (bytemuck::cast_slice(samples), [1, 1], samples.len()),
        Samples::Curves { count, samples } => {
            (bytemuck::cast_slice(samples), [*count, 1], samples.len())
        }
        Samples::Surfaces { count, samples } => {
            (bytemuck::cast_slice(samples), *count, samples.len())
        }
    };
    gpu.check_size("samples", bytes.len() as u64)?;
    let buffer = gpu.storage("samples", bytes);
    Ok(SampleBuffer {
        buffer,
        count,
        total: total as u32,
        undefined: 0,
    })
}

/// Creates a buffer with the colours of an object's instances.
pub(crate) fn instance_colours(gpu: &Gpu, look: &Look) -> wgpu::Buffer {
    let colours = look.colours.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]);
    let colours: Vec<[f32; 4]> = colours.collect();
    gpu.storage("colours", bytemuck::cast_slice(&colours))
}

/// Generates the kernel of an object's samples.
pub(crate) fn kernel(scene: &Scene, shape: &Shape) -> Result<Kernel, GenerateError> {
    let graph = &scene.graph;
    if let Some((direction, origin)) = shape.vector() {
        return wgsl::kernel::sample_vector(graph, *direction, *origin);
    }
    match (shape.position(), shape.domain()) {
        (Some(position), []) => wgsl::kernel::sample_point(graph, *position),
        (Some(position), [_]) => wgsl::kernel::sample_curve(graph, *position),
        (Some(position), _) => wgsl::kernel::sample_surface(graph, *position),
        // Metrics and geodesics have no kernel: no expression gives their position in space.
        (None, _) => Err(GenerateError::TooLarge { operations: None }),
    }
}

fn run(
    factory: &mut PipelineFactory<'_>,
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    kernel: &Kernel,
    placement: &Placement,
) -> Result<SampleBuffer, RenderError> {
    let pipeline = factory.sample_kernel(kernel);
    let slots = kernel.uniforms();
    let gpu = factory.gpu;
    by_kernel(
        gpu,
        scene,
        params,
        object,
        (&pipeline, slots),
        placement,
        None,
    )
}

/// Fills a buffer with an object's samples, or with the first few of them, by a kernel; `slots` are the uniforms that it
/// reads.
///
/// # Errors
/// [`RenderError::Gpu`] if they exceed the limits of the device.
pub(crate) fn by_kernel(
    gpu: &Gpu,
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    (pipeline, slots): (&wgpu::ComputePipeline, &[u32]),
    placement: &Placement,
    first: Option<u64>,
) -> Result<SampleBuffer, RenderError> {
    let ends = |sampling: &Sampling| [sampling.range.min as f32, sampling.range.max as f32];
    let mut domains = [[0.0; 2]; 2];
    for (interval, sampling) in domains.iter_mut().zip(object.shape.domain()) {
        *interval = ends(sampling);
    }
    let count = object.shape.sample_counts();
    let bytes_per_sample = match object.shape.domain() {
        _ if object.shape.vector().is_some() => size_of::<VectorSample>(),
        [] | [_] => size_of::<PositionSample>(),
        _ => size_of::<SurfaceSample>(),
    };
    let per_instance = u64::from(count[0]) * u64::from(count[1]);
    let total = params
        .instance_count(scene, object)
        .saturating_mul(per_instance);
    let total = first.map_or(total, |first| first.min(total));
    let size = total.saturating_mul(bytes_per_sample as u64);
    let buffer = gpu.output("samples", size)?;
    let mut uniforms: Vec<f32> = Vec::new();
    params.for_each_instance(scene, object, |values| {
        uniforms.extend(slots.iter().map(|&k| values[k as usize] as f32));
    });
    gpu.check_size("uniforms", 4 * uniforms.len() as u64)?;
    let uniforms = gpu.storage("uniforms", bytemuck::cast_slice(&uniforms));
    let sampling = layout::Sampling {
        minimum: [domains[0][0], domains[1][0]],
        maximum: [domains[0][1], domains[1][1]],
        count,
        total: total as u32,
        slots: slots.len() as u32,
        centre: placement.centre.map(|x| x as f32),
        per_length: (1.0 / placement.radius) as f32,
        horizon: HORIZON as f32,
        nudge: (NORMAL_NUDGE as f32).max(1e-3),
        padding: [0.0; 2],
    };
    let sampling = gpu.uniform("sampling", &sampling);
    // A constant object reads no uniforms: the pipeline then has no such binding.
    let layout = pipeline.get_bind_group_layout(0);
    let mut bindings = vec![
        (0, sampling.as_entire_binding()),
        (2, buffer.as_entire_binding()),
    ];
    if !slots.is_empty() {
        bindings.push((1, uniforms.as_entire_binding()));
    }
    let group = bind_numbered(gpu, &layout, &bindings);
    gpu.submit(|encoder| dispatch_flat(encoder, pipeline, &group, total));
    let undefined = gpu.read(&buffer, size, |bytes| {
        // The fourth number of a sample marks it as defined.
        bytes
            .chunks_exact(bytes_per_sample)
            .filter(|sample| sample[12..16] == [0; 4])
            .count()
    })?;
    Ok(SampleBuffer {
        buffer,
        count,
        total: total as u32,
        undefined,
    })
}
