//! The painter of surfaces: lit, textured triangles.

use std::sync::Arc;

use crate::error::RenderError;
use crate::gpu::layout::Patch;
use crate::gpu::pipelines::PipelineFactory;
use crate::gpu::samples::{SampleBuffer, instance_colours};
use crate::gpu::space::{Draw, Vertices};
use crate::style::Look;
use crate::texture::{SurfaceImage, Texture};

/// The painter, with the images in use.
#[derive(Debug)]
pub(crate) struct Surfaces {
    pipeline: wgpu::RenderPipeline,
    /// Samplers, by whether they repeat along u and along v.
    samplers: Vec<([bool; 2], wgpu::Sampler)>,
    images: Vec<(Arc<Texture>, wgpu::TextureView, bool)>,
    /// Index buffers by the size of their grid. As with images, the last value is true if the current picture uses them.
    indices: Vec<([u32; 2], wgpu::Buffer, bool)>,
}

impl Surfaces {
    pub(crate) fn new(factory: &mut PipelineFactory<'_>) -> Result<Self, RenderError> {
        let joined = wgsl::painter::surfaces()?;
        let pipeline = factory.draw_pipeline("surfaces", &joined);
        Ok(Self {
            pipeline,
            samplers: Vec::new(),
            images: Vec::new(),
            indices: Vec::new(),
        })
    }

    /// Returns the draws of all instances of one object: one for each image.
    pub(crate) fn draw(
        &mut self,
        factory: &mut PipelineFactory<'_>,
        view: &wgpu::Buffer,
        samples: &SampleBuffer,
        look: &Look,
        image: &SurfaceImage,
    ) -> Result<Vec<Draw>, RenderError> {
        let patch = Patch {
            count: samples.count,
            first: 0,
            emphasis: look.emphasis,
        };
        let patch = factory.gpu.uniform("patch", &patch);
        let colours = instance_colours(factory.gpu, look);
        let sampler = self.sampler(factory, image.repeats);
        let [u, v] = samples.count;
        let count = 6 * u64::from(u - 1) * u64::from(v - 1);
        let limit = factory.gpu.device.limits().max_buffer_size;
        if 4 * count > limit || count > u64::from(u32::MAX) {
            return Err(RenderError::Gpu(format!(
                "a surface of {u} by {v} samples has too many triangles for it"
            )));
        }
        let buffer = self.grid(factory, samples.count);
        let instances = samples.total / (u * v);
        let last = image.texture.instances().count() as u32 - 1;
        let textures = (0..instances).zip(image.texture.instances());
        let draw = |(instance, texture): (u32, &Arc<Texture>)| {
            let image = self.image(factory, texture);
            let group = factory.bind(
                &self.pipeline.get_bind_group_layout(0),
                &[
                    view.as_entire_binding(),
                    patch.as_entire_binding(),
                    samples.buffer.as_entire_binding(),
                    wgpu::BindingResource::TextureView(&image),
                    wgpu::BindingResource::Sampler(&sampler),
                    colours.as_entire_binding(),
                ],
            );
            let end = if instance < last {
                instance + 1
            } else {
                instances
            };
            Draw {
                pipeline: self.pipeline.clone(),
                group,
                vertices: Vertices::Indexed {
                    buffer: buffer.clone(),
                    count: count as u32,
                    instances: instance..end,
                },
            }
        };
        Ok(textures.map(draw).collect())
    }

    /// Returns the sampler of images that repeat along these parameters.
    fn sampler(&mut self, factory: &mut PipelineFactory<'_>, repeats: [bool; 2]) -> wgpu::Sampler {
        if let Some((_, sampler)) = self.samplers.iter().find(|(known, _)| *known == repeats) {
            return sampler.clone();
        }
        let sampler = factory.sampler(repeats);
        self.samplers.push((repeats, sampler.clone()));
        sampler
    }

    /// Ends a picture: images and indices that it has not used are dropped.
    pub(crate) fn next(&mut self) {
        self.images.retain_mut(|(.., used)| std::mem::take(used));
        self.indices.retain_mut(|(.., used)| std::mem::take(used));
    }

    /// Returns the image's view; each image is uploaded once.
    fn image(
        &mut self,
        factory: &mut PipelineFactory<'_>,
        texture: &Arc<Texture>,
    ) -> wgpu::TextureView {
        if let Some((_, view, used)) = self
            .images
            .iter_mut()
            .find(|(known, ..)| Arc::ptr_eq(known, texture))
        {
            *used = true;
            return view.clone();
        }
        let view = factory.texture(texture);
        self.images.push((texture.clone(), view.clone(), true));
        view
    }

    /// Returns the indices of a grid's triangles.
    fn grid(&mut self, factory: &PipelineFactory<'_>, size: [u32; 2]) -> wgpu::Buffer {
        if let Some((_, buffer, used)) = self.indices.iter_mut().find(|(known, ..)| *known == size)
        {
            *used = true;
            return buffer.clone();
        }
        let [u, v] = size;
        let cells = (0..v - 1).flat_map(|j| (0..u - 1).map(move |i| j * u + i));
        let indices: Vec<u32> = cells
            .flat_map(|at| [at, at + 1, at + u + 1, at, at + u + 1, at + u])
            .collect();
        let buffer = factory.gpu.buffer(
            "triangles of a grid",
            wgpu::BufferUsages::INDEX,
            bytemuck::cast_slice(&indices),
        );
        self.indices.push((size, buffer.clone(), true));
        buffer
    }
}
