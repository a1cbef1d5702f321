//! Copies of pictures onto a foreign target, such as a window. In: a canvas. Out: its pixels, unchanged.
//!
//! A window's own way to paint an image blends it, with a shader for everything that a window paints. If the processor
//! emulates the GPU, that is most of the cost of a frame.

use wgsl::library;

use crate::error::RenderError;
use crate::gpu::canvas::Canvas;
use crate::gpu::device::Gpu;

/// Copies canvases onto targets of one format.
#[derive(Debug)]
pub struct Blitter {
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
    /// True if the target receives linear light and stores sRGB.
    is_linear: bool,
}

/// A canvas prepared for copying.
#[derive(Debug)]
pub struct Blit {
    canvas: Canvas,
    bindings: wgpu::BindGroup,
}

impl Blit {
    /// Returns the canvas.
    pub fn canvas(&self) -> &Canvas {
        &self.canvas
    }
}

impl Blitter {
    /// Creates a pass for targets of a format, with one sample per pixel and no depth.
    ///
    /// # Errors
    /// [`RenderError::Gpu`], [`RenderError::Internal`].
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<Self, RenderError> {
        let joined = wgsl::join::join(&[library::PASS_BLIT])?;
        gpu.guarded(|| {
            let module = gpu
                .device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some("blit"),
                    source: wgpu::ShaderSource::Wgsl(joined.source().into()),
                });
            let options = wgpu::PipelineCompilationOptions::default();
            let pipeline = gpu
                .device
                .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some("blit"),
                    layout: None,
                    vertex: wgpu::VertexState {
                        module: &module,
                        entry_point: None,
                        compilation_options: options.clone(),
                        buffers: &[],
                    },
                    primitive: wgpu::PrimitiveState::default(),
                    depth_stencil: None,
                    multisample: wgpu::MultisampleState::default(),
                    fragment: Some(wgpu::FragmentState {
                        module: &module,
                        entry_point: None,
                        compilation_options: options,
                        targets: &[Some(format.into())],
                    }),
                    multiview_mask: None,
                    cache: None,
                });
            let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("blit"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..wgpu::SamplerDescriptor::default()
            });
            Ok(Self {
                pipeline,
                sampler,
                is_linear: format.is_srgb(),
            })
        })
    }

    /// Prepares a canvas for copying.
    pub fn ready(&self, gpu: &Gpu, canvas: Canvas) -> Blit {
        // The bytes must not change: if the target converts light to sRGB, the canvas view converts it back first.
        let view = if self.is_linear {
            canvas.target()
        } else {
            canvas.view()
        };
        let bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("blit"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(view),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Sampler(&self.sampler),
                },
            ],
        });
        Blit { canvas, bindings }
    }

    /// Copies a picture onto the rectangle left, top, width, height, in pixels. It is stretched, unless the sizes differ by
    /// at most a pixel: then each of its pixels is copied to one pixel of the target.
    pub fn copy(&self, pass: &mut wgpu::RenderPass<'_>, blit: &Blit, rectangle: [f32; 4]) {
        let [left, top, width, height] = rectangle;
        let own = blit.canvas.size().map(|side| side as f32);
        let is_as_large = (own[0] - width).abs() <= 1.0 && (own[1] - height).abs() <= 1.0;
        let [width, height] = if is_as_large { own } else { [width, height] };
        pass.set_viewport(left, top, width, height, 0.0, 1.0);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &blit.bindings, &[]);
        pass.draw(0..3, 0..1);
    }
}

#[cfg(test)]
mod tests {
    use super::{Blitter, Canvas, Gpu};

    /// Returns the pixels of a target of that format after a canvas has been copied onto a rectangle of it.
    fn copied(gpu: &Gpu, format: wgpu::TextureFormat, canvas: &Canvas, at: [f32; 4]) -> Vec<u8> {
        let target = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width: 8,
                height: 6,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let blitter = Blitter::new(gpu, format).expect("a pipeline");
        let blit = blitter.ready(gpu, canvas.clone());
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let view = target.create_view(&Default::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations::default(),
                })],
                ..Default::default()
            });
            blitter.copy(&mut pass, &blit, at);
        }
        gpu.queue.submit([encoder.finish()]);
        let mut bytes = Vec::new();
        gpu.read_rows(&target, [8, 6], |_, row| bytes.extend_from_slice(row))
            .expect("read");
        bytes
    }

    /// Four by three pixels, all different.
    fn picture() -> Vec<u8> {
        (0..12)
            .flat_map(|k: u8| [20 * k, 255 - 20 * k, 7 * k + 3, 255])
            .collect()
    }

    #[test]
    fn a_picture_is_copied_byte_by_byte_onto_targets_of_both_kinds() {
        let gpu = Gpu::shared().expect("a driver");
        let canvas = Canvas::with_pixels(&gpu, [4, 3], &picture()).expect("a canvas");
        for format in [
            wgpu::TextureFormat::Rgba8Unorm,
            wgpu::TextureFormat::Rgba8UnormSrgb,
        ] {
            // A rectangle that is a pixel larger and smaller.
            for at in [[2.0, 1.0, 4.0, 3.0], [2.0, 1.0, 5.0, 2.0]] {
                let bytes = copied(&gpu, format, &canvas, at);
                for (y, row) in bytes.chunks(4 * 8).enumerate() {
                    for (x, pixel) in row.chunks(4).enumerate() {
                        let inside = (2..6).contains(&x) && (1..4).contains(&y);
                        let expected = if inside {
                            let at = 4 * (4 * (y - 1) + x - 2);
                            picture()[at..at + 4].to_vec()
                        } else {
                            vec![0; 4]
                        };
                        assert_eq!(pixel, expected, "{format:?} {at:?}: ({x}, {y})");
                    }
                }
            }
        }
    }

    #[test]
    fn a_picture_of_another_size_is_stretched_over_the_rectangle() {
        let gpu = Gpu::shared().expect("a driver");
        let canvas = Canvas::with_pixels(&gpu, [2, 1], &[0, 0, 0, 255, 200, 200, 200, 255]);
        let canvas = canvas.expect("a canvas");
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let bytes = copied(&gpu, format, &canvas, [0.0, 0.0, 8.0, 6.0]);
        // Pixel x's centre is at (x + 1/2)/4 of a source pixel: linear between the sources' centres, constant beyond.
        let expected = [0.0, 0.0, 25.0, 75.0, 125.0, 175.0, 200.0, 200.0];
        for row in bytes.chunks(4 * 8) {
            for (pixel, expected) in row.chunks(4).zip(expected) {
                assert!((f64::from(pixel[0]) - expected).abs() <= 1.0, "{pixel:?}");
            }
        }
    }
}
