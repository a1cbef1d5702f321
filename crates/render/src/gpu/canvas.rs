//! A pool of textures on which pictures are drawn; a texture is reused when no handle refers to it.

use std::sync::Arc;

use image::RgbaImage;

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::pipelines::COLOUR_FORMAT;
use crate::gpu::space::straighten;

/// The number of unused canvases in the pool: panes are drawn again at the same size.
const IDLE: usize = 4;

/// The pixels of a picture, in memory or on a GPU.
#[derive(Clone, Debug)]
pub enum Pixels {
    /// sRGB, top row first, in memory: drawn by the software path, or for a file.
    Image(RgbaImage),
    /// The texture on the renderer's device.
    Texture(Canvas),
}

/// A picture on a GPU. Clones are the same canvas; it may be reused once all of them are dropped.
#[derive(Clone, Debug)]
pub struct Canvas(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    size: [u32; 2],
    texture: wgpu::Texture,
    target: wgpu::TextureView,
    bytes: wgpu::TextureView,
}

impl Canvas {
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("canvas"),
            size: wgpu::Extent3d {
                width: size[0],
                height: size[1],
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: COLOUR_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[COLOUR_FORMAT.remove_srgb_suffix()],
        });
        let target = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let bytes = texture.create_view(&wgpu::TextureViewDescriptor {
            format: Some(COLOUR_FORMAT.remove_srgb_suffix()),
            usage: Some(wgpu::TextureUsages::TEXTURE_BINDING),
            ..wgpu::TextureViewDescriptor::default()
        });
        Self(Arc::new(Inner {
            size,
            texture,
            target,
            bytes,
        }))
    }

    /// Creates a canvas from pixels in memory: RGBA in rows from the top, sRGB with premultiplied alpha.
    ///
    /// # Errors
    /// [`RenderError::Gpu`].
    pub fn with_pixels(gpu: &Gpu, size: [u32; 2], pixels: &[u8]) -> Result<Self, RenderError> {
        let canvas = gpu.guarded(|| Ok(Self::new(gpu, size)))?;
        canvas.write(gpu, pixels)?;
        Ok(canvas)
    }

    /// Replaces the pixels, in the format of [`Canvas::with_pixels`]. Submitted work still shows the previous pixels.
    ///
    /// # Errors
    /// [`RenderError::Gpu`].
    pub fn write(&self, gpu: &Gpu, pixels: &[u8]) -> Result<(), RenderError> {
        gpu.guarded(|| {
            let [width, height] = self.size();
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * width),
                rows_per_image: Some(height),
            };
            let extent = wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            };
            let texture = self.texture().as_image_copy();
            gpu.queue.write_texture(texture, pixels, layout, extent);
            Ok(())
        })
    }

    /// Returns width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.0.size
    }

    /// Returns a view of the picture's bytes, sRGB with premultiplied alpha, in the format `Rgba8Unorm`.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.0.bytes
    }

    /// Returns true if two handles are the same canvas.
    pub fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Copies the picture into memory, with straight alpha. Waits for the GPU.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device is lost.
    pub fn read(&self, gpu: &Gpu) -> Result<RgbaImage, RenderError> {
        gpu.guarded(|| {
            let [width, height] = self.size();
            let mut picture = RgbaImage::new(width, height);
            gpu.read_rows(self.texture(), self.size(), |y, row| {
                let start = 4 * y * width as usize;
                picture.as_flat_samples_mut().samples[start..start + row.len()]
                    .copy_from_slice(row);
            })?;
            if picture.pixels().any(|pixel| pixel.0[3] < 255) {
                straighten(&mut picture);
            }
            Ok(picture)
        })
    }

    pub(crate) fn texture(&self) -> &wgpu::Texture {
        &self.0.texture
    }

    /// Returns the attachment for drawing, in linear light.
    pub(crate) fn target(&self) -> &wgpu::TextureView {
        &self.0.target
    }

    /// Fills it from a buffer of rows that are `row` bytes apart.
    pub(crate) fn fill(&self, encoder: &mut wgpu::CommandEncoder, from: &wgpu::Buffer, row: u32) {
        let [width, height] = self.size();
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row),
            rows_per_image: Some(height),
        };
        let from = wgpu::TexelCopyBufferInfo {
            buffer: from,
            layout,
        };
        let extent = wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        };
        encoder.copy_buffer_to_texture(from, self.texture().as_image_copy(), extent);
    }

    fn is_idle(&self) -> bool {
        Arc::strong_count(&self.0) == 1
    }
}

/// The canvases in use, and idle ones.
#[derive(Debug, Default)]
pub(crate) struct Canvases(Vec<Canvas>);

impl Canvases {
    /// Returns an unused canvas.
    pub(crate) fn take(&mut self, gpu: &Gpu, size: [u32; 2]) -> Canvas {
        let idle = |canvas: &Canvas| canvas.is_idle() && canvas.size() == size;
        if let Some(at) = self.0.iter().position(idle) {
            return self.0[at].clone();
        }
        // Keep the newest idle canvases: they have the current sizes of panes.
        let mut kept = 0;
        for at in (0..self.0.len()).rev() {
            if self.0[at].is_idle() {
                kept += 1;
                if kept > IDLE {
                    self.0.remove(at);
                }
            }
        }
        let canvas = Canvas::new(gpu, size);
        self.0.push(canvas.clone());
        canvas
    }
}
