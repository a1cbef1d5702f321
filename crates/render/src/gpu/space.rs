//! The 3D view: painters into a multisampled target, with the size of the picture or of a tile of it.

use std::ops::Range;

use image::RgbaImage;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::error::RenderError;
use crate::gpu::canvas::Canvas;
use crate::gpu::device::Gpu;
use crate::gpu::glyphs::Glyphs;
use crate::gpu::layout::ViewUniform;
use crate::gpu::pipelines::{COLOUR_FORMAT, DEPTH_FORMAT, PipelineFactory, SAMPLES};
use crate::gpu::samples::SampleBuffer;
use crate::gpu::solids::Solids;
use crate::gpu::surfaces::Surfaces;
use crate::gpu::{curves, points, vectors};
use crate::sample::Painter;
use crate::solids::SolidPainter;
use crate::style::{self, Look};
use crate::texture::SurfaceImage;

/// The longest side of a tile. A tile needs 36 bytes per pixel on the device, 150 MB at this size.
const TILE: u32 = 2048;

/// A prepared draw.
pub(crate) struct Draw {
    pub(crate) pipeline: wgpu::RenderPipeline,
    pub(crate) group: wgpu::BindGroup,
    pub(crate) vertices: Vertices,
}

/// The vertices that are drawn.
pub(crate) enum Vertices {
    /// A number of vertices.
    Plain(u32),
    /// The vertices of an index buffer, for a number of instances.
    Indexed {
        /// u32 indices.
        buffer: wgpu::Buffer,
        /// The number of vertices.
        count: u32,
        /// The instances.
        instances: Range<u32>,
    },
}

/// Draws into memory, tile by tile, so that a large picture needs no target of its own size. `view` is the uniform that the
/// draws read; `before` returns what is drawn before them into a tile with this first pixel and size. `progress` receives
/// the completed fraction.
///
/// # Errors
/// Those of the device.
pub(crate) fn draw_tiles(
    gpu: &Gpu,
    camera: &Camera,
    view: &wgpu::Buffer,
    draws: &[Draw],
    before: &mut dyn FnMut([u32; 2], [u32; 2]) -> Result<Option<Draw>, RenderError>,
    background: [f32; 4],
    progress: &dyn Fn(f32),
) -> Result<RgbaImage, RenderError> {
    let [width, height] = camera.size;
    let mut picture = RgbaImage::new(width, height);
    let target = Target::new(gpu, [width.min(TILE), height.min(TILE)]);
    let resolved = Canvas::new(gpu, target.size);
    let tiles: Vec<[u32; 2]> = (0..height.div_ceil(TILE))
        .flat_map(|y| (0..width.div_ceil(TILE)).map(move |x| [x * TILE, y * TILE]))
        .collect();
    for (number, first) in tiles.iter().enumerate() {
        // Every tile has the target's size; pixels beyond the picture are not copied.
        let uniform = ViewUniform::new(camera, *first, target.size);
        gpu.queue
            .write_buffer(view, 0, bytemuck::bytes_of(&uniform));
        let before = before(*first, target.size)?;
        let draws = before.iter().chain(draws);
        gpu.submit(|encoder| target.draw(encoder, &resolved, draws, background));
        let size = [
            target.size[0].min(width - first[0]),
            target.size[1].min(height - first[1]),
        ];
        gpu.read_rows(resolved.texture(), size, |y, row| {
            let start = 4 * ((first[1] as usize + y) * width as usize + first[0] as usize);
            picture.as_flat_samples_mut().samples[start..start + row.len()].copy_from_slice(row);
        })?;
        progress((number + 1) as f32 / tiles.len() as f32);
    }
    if background[3] < 1.0 {
        straighten(&mut picture);
    }
    Ok(picture)
}

/// Converts colours with premultiplied alpha, as in targets, to straight alpha.
pub(crate) fn straighten(picture: &mut RgbaImage) {
    picture
        .as_flat_samples_mut()
        .samples
        .par_chunks_exact_mut(4)
        .for_each(|pixel| {
            let alpha = f32::from(pixel[3]) / 255.0;
            if alpha > 0.0 && alpha < 1.0 {
                for byte in &mut pixel[..3] {
                    *byte = style::encode(style::decode(*byte) / alpha);
                }
            }
        });
}

/// The painters in use, each built when the first of its objects is drawn.
#[derive(Debug, Default)]
pub(crate) struct Painters {
    points: Option<Glyphs>,
    vectors: Option<Glyphs>,
    curves: Option<Glyphs>,
    surfaces: Option<Surfaces>,
    solids: Option<Solids>,
}

impl Painters {
    /// Returns the draws of an object with its samples and its look; for a surface also its image. Solids have no samples
    /// and are drawn together ([`Painters::draw_solids`]).
    pub(crate) fn draw(
        &mut self,
        factory: &mut PipelineFactory<'_>,
        painter: Painter,
        view: &wgpu::Buffer,
        samples: &SampleBuffer,
        look: &Look,
        image: impl FnOnce(()) -> SurfaceImage,
    ) -> Result<Vec<Draw>, RenderError> {
        let (place, kind) = match painter {
            Painter::Points => (&mut self.points, &points::KIND),
            Painter::Vectors => (&mut self.vectors, &vectors::KIND),
            Painter::Curves | Painter::Solids => (&mut self.curves, &curves::KIND),
            Painter::Surfaces => {
                return built(&mut self.surfaces, || Surfaces::new(factory))?.draw(
                    factory,
                    view,
                    samples,
                    look,
                    &image(()),
                );
            }
        };
        let glyphs = built(place, || Glyphs::new(factory, kind))?;
        Ok(vec![glyphs.draw(factory, view, samples, look)])
    }

    /// Returns the draw of all solids into a target of this size that begins at a pixel of the picture.
    pub(crate) fn draw_solids(
        &mut self,
        factory: &mut PipelineFactory<'_>,
        painter: &SolidPainter<'_>,
        first: [u32; 2],
        size: [u32; 2],
    ) -> Result<Draw, RenderError> {
        let solids = built(&mut self.solids, || Solids::new(factory))?;
        Ok(solids.draw(factory, painter, first, size))
    }

    /// Ends a picture: resources that it has not used are dropped.
    pub(crate) fn next(&mut self) {
        if let Some(surfaces) = &mut self.surfaces {
            surfaces.next();
        }
    }
}

/// Returns the value, built now if it is missing.
fn built<T>(
    place: &mut Option<T>,
    build: impl FnOnce() -> Result<T, RenderError>,
) -> Result<&mut T, RenderError> {
    let value = place.take().map_or_else(build, Ok)?;
    Ok(place.insert(value))
}

/// A multisampled target.
#[derive(Debug)]
pub(crate) struct Target {
    pub(crate) size: [u32; 2],
    colour: wgpu::TextureView,
    depth: wgpu::TextureView,
}

impl Target {
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let texture = |label, format| {
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: SAMPLES,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        Self {
            size,
            colour: texture("colour", COLOUR_FORMAT),
            depth: texture("depth", DEPTH_FORMAT),
        }
    }

    /// Draws onto a canvas of its size.
    pub(crate) fn draw<'d>(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        canvas: &Canvas,
        draws: impl Iterator<Item = &'d Draw>,
        behind: [f32; 4],
    ) {
        let [r, g, b, a] = behind.map(f64::from);
        let (r, g, b) = (r * a, g * a, b * a);
        let resolved = canvas.target();
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("objects"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.colour,
                depth_slice: None,
                resolve_target: Some(resolved),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        for draw in draws {
            pass.set_pipeline(&draw.pipeline);
            pass.set_bind_group(0, &draw.group, &[]);
            match &draw.vertices {
                Vertices::Plain(count) => pass.draw(0..*count, 0..1),
                Vertices::Indexed {
                    buffer,
                    count,
                    instances,
                } => {
                    pass.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint32);
                    pass.draw_indexed(0..*count, 0, instances.clone());
                }
            }
        }
    }
}
