//! The GPU objects that one picture builds: pipelines, kernels, textures and samplers, all counted.

use wgsl::{Joined, Kernel};

use crate::gpu::device::Gpu;
use crate::plan::Built;
use crate::texture::Texture;

/// The colour format of targets: linear light is blended and averaged, sRGB is stored.
pub(crate) const COLOUR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// The depth format of targets; greater is nearer.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Samples per pixel.
pub(crate) const SAMPLES: u32 = 4;
/// The maximum number of workgroups along one axis of a dispatch.
const MAX_WORKGROUPS: u32 = 65_535;

/// Builds objects for one picture, and counts them.
pub(crate) struct PipelineFactory<'a> {
    pub(crate) gpu: &'a Gpu,
    /// The counts of everything that has been built.
    pub(crate) built: Built,
}

impl<'a> PipelineFactory<'a> {
    pub(crate) fn new(gpu: &'a Gpu) -> Self {
        Self {
            gpu,
            built: Built::default(),
        }
    }

    fn module(&self, label: &str, joined: &Joined) -> wgpu::ShaderModule {
        self.gpu
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(joined.source().into()),
            })
    }

    /// Builds a generated kernel that fills samples.
    pub(crate) fn sample_kernel(&mut self, kernel: &Kernel) -> wgpu::ComputePipeline {
        self.built.sample_kernels += 1;
        // The driver refuses the name of a missing entry point.
        let refused = self.gpu.refuses_samples().then_some("refused");
        self.compute_from(kernel.entry_point(), kernel.joined(), refused)
    }

    /// Builds the fixed pass that colours a table of polynomials.
    pub(crate) fn resolve_pipeline(&mut self, joined: &Joined) -> wgpu::ComputePipeline {
        self.built.resolve_pipelines += 1;
        self.compute("resolve", joined)
    }

    /// Builds the pass that traces a picture.
    pub(crate) fn trace_pipeline(&mut self, joined: &Joined) -> wgpu::ComputePipeline {
        self.built.trace_pipelines += 1;
        self.compute("trace", joined)
    }

    /// Builds a kernel that no picture needs.
    pub(crate) fn compute(&self, label: &str, joined: &Joined) -> wgpu::ComputePipeline {
        self.compute_from(label, joined, None)
    }

    fn compute_from(
        &self,
        label: &str,
        joined: &Joined,
        entry_point: Option<&str>,
    ) -> wgpu::ComputePipeline {
        let module = self.module(label, joined);
        self.gpu
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(label),
                layout: None,
                module: &module,
                entry_point,
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
    }

    /// Builds a painter's pipeline: triangles, both sides, depth, multisampling.
    pub(crate) fn draw_pipeline(&mut self, label: &str, joined: &Joined) -> wgpu::RenderPipeline {
        self.built.draw_pipelines += 1;
        let module = self.module(label, joined);
        let options = wgpu::PipelineCompilationOptions::default();
        self.gpu
            .device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: None,
                    compilation_options: options.clone(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH_FORMAT,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState {
                    count: SAMPLES,
                    ..Default::default()
                },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: None,
                    compilation_options: options,
                    targets: &[Some(COLOUR_FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
    }

    /// Creates a sampler, linear within and between levels, for images that repeat along some axes; along the others their
    /// border continues.
    pub(crate) fn sampler(&mut self, repeats: [bool; 2]) -> wgpu::Sampler {
        self.built.samplers += 1;
        let [u, v] = repeats.map(|repeats| match repeats {
            true => wgpu::AddressMode::Repeat,
            false => wgpu::AddressMode::ClampToEdge,
        });
        self.gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("image"),
            address_mode_u: u,
            address_mode_v: v,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        })
    }

    /// Creates a texture of an image with its mip chain.
    pub(crate) fn texture(&mut self, texture: &Texture) -> wgpu::TextureView {
        self.built.textures += 1;
        // A level that is too large for the device is left out: the next one is half its size.
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        let levels = texture.levels();
        let first = levels
            .iter()
            .position(|level| level.size.iter().all(|&side| side <= most))
            .unwrap_or(0);
        let levels = &levels[first..];
        let extent = |size: [u32; 2]| wgpu::Extent3d {
            width: size[0],
            height: size[1],
            depth_or_array_layers: 1,
        };
        let image = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("image"),
            size: extent(levels[0].size),
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (number, level) in levels.iter().enumerate() {
            let to = wgpu::TexelCopyTextureInfo {
                mip_level: number as u32,
                ..image.as_image_copy()
            };
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * level.size[0]),
                rows_per_image: Some(level.size[1]),
            };
            let texels = bytemuck::cast_slice(&level.texels);
            self.gpu
                .queue
                .write_texture(to, texels, layout, extent(level.size));
        }
        image.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Binds resources to the bindings 0, 1, … of a pipeline's group 0.
    pub(crate) fn bind(
        &self,
        layout: &wgpu::BindGroupLayout,
        resources: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        let numbered: Vec<(u32, wgpu::BindingResource<'_>)> =
            (0..).zip(resources.iter().cloned()).collect();
        self.bind_numbered(layout, &numbered)
    }

    /// Binds resources to the given bindings of a pipeline's group 0.
    pub(crate) fn bind_numbered(
        &self,
        layout: &wgpu::BindGroupLayout,
        resources: &[(u32, wgpu::BindingResource<'_>)],
    ) -> wgpu::BindGroup {
        bind_numbered(self.gpu, layout, resources)
    }
}

/// Binds resources to the given bindings of a pipeline's group 0.
pub(crate) fn bind_numbered(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    resources: &[(u32, wgpu::BindingResource<'_>)],
) -> wgpu::BindGroup {
    let entries: Vec<wgpu::BindGroupEntry<'_>> = resources
        .iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry {
            binding: *binding,
            resource: resource.clone(),
        })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &entries,
    })
}

/// Dispatches a one-dimensional kernel with workgroups of 64.
pub(crate) fn dispatch_flat(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::ComputePipeline,
    group: &wgpu::BindGroup,
    invocations: u64,
) {
    let groups = invocations.div_ceil(64).max(1);
    let rows = groups.div_ceil(u64::from(MAX_WORKGROUPS));
    let per_row = groups.div_ceil(rows);
    dispatch(encoder, pipeline, group, [per_row as u32, rows as u32]);
}

/// Dispatches a kernel over workgroups.
pub(crate) fn dispatch(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::ComputePipeline,
    group: &wgpu::BindGroup,
    groups: [u32; 2],
) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.dispatch_workgroups(groups[0], groups[1], 1);
}
