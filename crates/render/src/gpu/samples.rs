//! Buffers of samples: filled by f64 blocks on the CPU or by a generated kernel; painters never know which.

use scene::ParamValues;
use scene::{Object, ObjectId, Sampling, Scene, Shape};
use wgsl::{GenerateError, Kernel};

use crate::bounds::Placement;
use crate::gpu::device::Gpu;
use crate::gpu::internal;
use crate::gpu::layout;
use crate::gpu::workshop::{Workshop, bind_numbered, dispatch_flat};
use crate::plan::{ObjectPlan, Source};
use crate::request::RenderError;
use crate::sample::{
    self, HORIZON, NORMAL_NUDGE, PositionSample, Samples, SurfaceSample, VectorSample,
};

/// The samples of one object on the GPU.
#[derive(Clone, Debug)]
pub(crate) struct SampleBuffer {
    pub(crate) buffer: wgpu::Buffer,
    /// Samples of one instance along each parameter; 1 where there is no such parameter.
    pub(crate) count: [u32; 2],
    /// Samples of all instances.
    pub(crate) total: u32,
    /// What a reader of the picture should be told.
    pub(crate) notes: Vec<String>,
    /// How many of them are undefined, if a kernel has computed them.
    pub(crate) undefined: usize,
}

/// Fills a buffer with an object's samples, from the source that the plan names.
///
/// # Errors
/// [`RenderError::Gpu`] if they do not fit the device; [`RenderError::Internal`].
pub(crate) fn fill(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    settings: &ParamValues,
    plan: &ObjectPlan,
    placement: &Placement,
) -> Result<SampleBuffer, RenderError> {
    let object = &scene.objects[plan.object.0 as usize];
    if plan.source == Source::Kernel {
        match kernel(scene, &object.shape) {
            Ok(kernel) => return run(workshop, scene, settings, object, &kernel, placement),
            Err(error) => {
                if let Some(fault) = internal(error) {
                    return Err(fault);
                }
                // Too large for a shader: f64 blocks take any expression.
            }
        }
    }
    upload(workshop, scene, settings, plan.object, placement)
}

/// The samples of an object as its generated kernel computes them, read back. `None` if its expressions are too
/// large for a shader.
pub(crate) fn computed(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    settings: &ParamValues,
    id: ObjectId,
    placement: &Placement,
) -> Result<Option<Samples>, RenderError> {
    let object = &scene.objects[id.0 as usize];
    let kernel = match kernel(scene, &object.shape) {
        Ok(kernel) => kernel,
        Err(error) => return internal(error).map_or(Ok(None), Err),
    };
    let filled = run(workshop, scene, settings, object, &kernel, placement)?;
    let total = u64::from(filled.total);
    let read = |size: usize| (&filled.buffer, total * size as u64);
    let gpu = workshop.gpu;
    let positions = || {
        let (buffer, size) = read(size_of::<PositionSample>());
        gpu.read(
            buffer,
            size,
            bytemuck::pod_collect_to_vec::<u8, PositionSample>,
        )
    };
    Ok(Some(match &object.shape {
        Shape::Point { .. } => Samples::Points(positions()?),
        Shape::Metric { .. } | Shape::Geodesic { .. } => return Ok(None),
        Shape::Curve { .. } => Samples::Curves {
            count: filled.count[0],
            samples: positions()?,
        },
        Shape::Vector { .. } => {
            let (buffer, size) = read(size_of::<VectorSample>());
            Samples::Vectors(gpu.read(buffer, size, bytemuck::pod_collect_to_vec)?)
        }
        Shape::Surface { .. } => {
            let (buffer, size) = read(size_of::<SurfaceSample>());
            let samples = gpu.read(buffer, size, bytemuck::pod_collect_to_vec)?;
            Samples::Surfaces {
                count: filled.count,
                samples,
            }
        }
    }))
}

fn upload(
    workshop: &Workshop<'_>,
    scene: &Scene,
    settings: &ParamValues,
    id: ObjectId,
    placement: &Placement,
) -> Result<SampleBuffer, RenderError> {
    let (samples, notes) = sample::sample_with_notes(scene, settings, id, placement);
    upload_samples(workshop.gpu, &samples, notes)
}

/// A buffer with samples that are there already.
///
/// # Errors
/// [`RenderError::Gpu`] if they do not fit the device.
pub(crate) fn upload_samples(
    gpu: &Gpu,
    samples: &Samples,
    notes: Vec<String>,
) -> Result<SampleBuffer, RenderError> {
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
        notes,
        undefined: 0,
    })
}

/// The generated kernel of an object's samples.
pub(crate) fn kernel(scene: &Scene, shape: &Shape) -> Result<Kernel, GenerateError> {
    match shape {
        // Neither is planned with a kernel: f64 blocks hold no samples of them.
        Shape::Metric { .. } | Shape::Geodesic { .. } => {
            Err(GenerateError::TooLarge { operations: None })
        }
        Shape::Point { position } => wgsl::kernel::sample_point(&scene.graph, *position),
        Shape::Vector { direction, origin } => {
            wgsl::kernel::sample_vector(&scene.graph, *direction, *origin)
        }
        Shape::Curve { position, .. } => wgsl::kernel::sample_curve(&scene.graph, *position),
        Shape::Surface { position, .. } => wgsl::kernel::sample_surface(&scene.graph, *position),
    }
}

fn run(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    settings: &ParamValues,
    object: &Object,
    kernel: &Kernel,
    placement: &Placement,
) -> Result<SampleBuffer, RenderError> {
    let pipeline = workshop.sample_kernel(kernel);
    let slots = kernel.uniforms();
    let gpu = workshop.gpu;
    by_kernel(
        gpu,
        scene,
        settings,
        object,
        (&pipeline, slots),
        placement,
        None,
    )
}

/// Fills a buffer with an object's samples (with the first few of them, if so many are asked for) by a kernel; `slots`
/// are the uniforms that it reads.
///
/// # Errors
/// [`RenderError::Gpu`] if they do not fit the device.
pub(crate) fn by_kernel(
    gpu: &Gpu,
    scene: &Scene,
    settings: &ParamValues,
    object: &Object,
    (pipeline, slots): (&wgpu::ComputePipeline, &[u32]),
    placement: &Placement,
    first: Option<u64>,
) -> Result<SampleBuffer, RenderError> {
    let ends = |sampling: &Sampling| [sampling.range.min as f32, sampling.range.max as f32];
    let (domains, count, bytes_per_sample) = match &object.shape {
        Shape::Point { .. } | Shape::Metric { .. } | Shape::Geodesic { .. } => {
            ([[0.0; 2]; 2], [1, 1], size_of::<PositionSample>())
        }
        Shape::Vector { .. } => ([[0.0; 2]; 2], [1, 1], size_of::<VectorSample>()),
        Shape::Curve { domain, .. } => (
            [ends(domain), [0.0; 2]],
            [domain.count, 1],
            size_of::<PositionSample>(),
        ),
        Shape::Surface { domain, .. } => (
            domain.each_ref().map(ends),
            domain.each_ref().map(|d| d.count),
            size_of::<SurfaceSample>(),
        ),
    };
    let per_instance = u64::from(count[0]) * u64::from(count[1]);
    let total = settings
        .instance_count(scene, object)
        .saturating_mul(per_instance);
    let total = first.map_or(total, |first| first.min(total));
    let size = total.saturating_mul(bytes_per_sample as u64);
    let buffer = gpu.output("samples", size)?;
    let mut uniforms: Vec<f32> = Vec::new();
    settings.for_each_instance(scene, object, |values| {
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
    let note = sample::note(&object.name, total as usize, undefined);
    Ok(SampleBuffer {
        buffer,
        count,
        total: total as u32,
        notes: note.into_iter().collect(),
        undefined,
    })
}
