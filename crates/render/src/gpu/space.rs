//! The 3D view: painters into a multisampled target, tile by tile, read back into the picture.

use image::RgbaImage;
use rayon::prelude::*;
use scene::{scene::Scene, values::Settings};

use crate::bounds::Bounds;
use crate::camera::Camera;
use crate::gpu::device::Gpu;
use crate::gpu::glyphs::Glyphs;
use crate::gpu::layout::View;
use crate::gpu::surfaces::Surfaces;
use crate::gpu::workshop::{COLOUR_FORMAT, DEPTH_FORMAT, SAMPLES, Workshop};
use crate::gpu::{Drawn, samples};
use crate::gpu::{curves, points, vectors};
use crate::plan::{Painter, Plan};
use crate::request::{RenderError, Request};
use crate::style;
use crate::{overlay, sample};

/// The longest side of a tile. A tile takes 36 bytes a pixel on the device, 150 MB at this side.
const TILE: u32 = 2048;

/// Something to draw, ready.
pub(crate) struct Draw {
    pub(crate) pipeline: wgpu::RenderPipeline,
    pub(crate) group: wgpu::BindGroup,
    pub(crate) vertices: Vertices,
}

/// Which vertices are drawn.
pub(crate) enum Vertices {
    /// So many.
    Plain(u32),
    /// By indices, so many instances.
    Indexed {
        /// u32 indices.
        buffer: wgpu::Buffer,
        /// How many.
        count: u32,
        /// How many instances.
        instances: u32,
    },
}

/// Draws the plan's objects; gives the picture and its notes.
pub(crate) fn render(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    settings: &Settings,
    request: &Request,
    plan: &Plan,
    [eye, target]: [Option<[f64; 3]>; 2],
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Drawn, RenderError> {
    let gpu = workshop.gpu;
    let bounds = Bounds::of(scene, settings);
    let camera = Camera::new(&bounds, eye, target, request.size)?;
    let view = gpu.uniform("view", &View::new(&camera, [0, 0], request.size));

    let extras = overlay::extras(scene, settings, request, &camera.placement)?;
    let mut notes = Vec::new();
    let mut draws: Vec<Draw> = Vec::new();
    let mut painters = Painters::default();
    let steps = plan.objects.len().max(1) as f32;
    for (index, object) in plan.objects.iter().enumerate() {
        let samples = samples::fill(workshop, scene, settings, object, &camera.placement)?;
        notes.extend(samples.notes.clone());
        let shape = &scene.objects[object.object.0 as usize].shape;
        let colour = (
            request.colour(object.object, shape),
            request.emphasis(object.object),
        );
        let glyph = match object.painter {
            Painter::Points => Some((&mut painters.points, &points::KIND)),
            Painter::Vectors => Some((&mut painters.vectors, &vectors::KIND)),
            Painter::Curves => Some((&mut painters.curves, &curves::KIND)),
            Painter::Surfaces => None,
        };
        let draw = match glyph {
            Some((place, kind)) => built(place, || Glyphs::new(workshop, kind))?
                .draw(workshop, &view, &samples, colour),
            None => {
                let texture = request.texture(object.object);
                built(&mut painters.surfaces, || Surfaces::new(workshop))?
                    .draw(workshop, &view, &samples, colour, &texture)?
            }
        };
        draws.push(draw);
        progress(0.5 * (index + 1) as f32 / steps);
    }

    notes.extend(scene.objects.iter().filter_map(sample::left_out));
    for extra in &extras {
        let samples = samples::upload_samples(workshop, &extra.samples, Vec::new())?;
        let (place, kind) = match extra.painter {
            Painter::Vectors => (&mut painters.vectors, &vectors::KIND),
            _ => (&mut painters.curves, &curves::KIND),
        };
        let draw = built(place, || Glyphs::new(workshop, kind))?.draw(
            workshop,
            &view,
            &samples,
            (extra.colour, 0.0),
        );
        draws.push(draw);
    }

    let behind = request.background_light();
    let [width, height] = request.size;
    let mut picture = RgbaImage::new(width, height);
    let target = Target::new(gpu, [width.min(TILE), height.min(TILE)]);
    let tiles: Vec<[u32; 2]> = (0..height.div_ceil(TILE))
        .flat_map(|y| (0..width.div_ceil(TILE)).map(move |x| [x * TILE, y * TILE]))
        .collect();
    for (number, first) in tiles.iter().enumerate() {
        // Every tile has the target's size; what lies beyond the picture is not copied.
        let uniform = View::new(&camera, *first, target.size);
        gpu.queue
            .write_buffer(&view, 0, bytemuck::bytes_of(&uniform));
        gpu.submit(|encoder| target.draw(encoder, &draws, behind));
        let size = [
            target.size[0].min(width - first[0]),
            target.size[1].min(height - first[1]),
        ];
        gpu.read_rows(&target.resolved, size, |y, row| {
            let start = 4 * ((first[1] as usize + y) * width as usize + first[0] as usize);
            picture.as_flat_samples_mut().samples[start..start + row.len()].copy_from_slice(row);
        })?;
        progress(0.5 + 0.5 * (number + 1) as f32 / tiles.len() as f32);
    }
    if behind[3] < 1.0 {
        straighten(&mut picture);
    }
    Ok(Drawn {
        image: picture,
        notes,
        overlays: overlay::names(&extras),
    })
}

/// From colours that their alpha is multiplied into, as targets hold them, to colours beside their alpha.
fn straighten(picture: &mut RgbaImage) {
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

/// The painters in use, each built when the first of its objects comes.
#[derive(Default)]
struct Painters {
    points: Option<Glyphs>,
    vectors: Option<Glyphs>,
    curves: Option<Glyphs>,
    surfaces: Option<Surfaces>,
}

/// What stands in the place, built now if nothing does.
fn built<T>(
    place: &mut Option<T>,
    build: impl FnOnce() -> Result<T, RenderError>,
) -> Result<&mut T, RenderError> {
    let value = place.take().map_or_else(build, Ok)?;
    Ok(place.insert(value))
}

/// A multisampled target and what it resolves to.
struct Target {
    size: [u32; 2],
    colour: wgpu::TextureView,
    depth: wgpu::TextureView,
    resolved: wgpu::Texture,
}

impl Target {
    fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let texture = |label, format, sample_count, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let all = wgpu::TextureViewDescriptor::default();
        Self {
            size,
            colour: texture("colour", COLOUR_FORMAT, SAMPLES, attachment).create_view(&all),
            depth: texture("depth", DEPTH_FORMAT, SAMPLES, attachment).create_view(&all),
            resolved: texture(
                "picture",
                COLOUR_FORMAT,
                1,
                attachment | wgpu::TextureUsages::COPY_SRC,
            ),
        }
    }

    fn draw(&self, encoder: &mut wgpu::CommandEncoder, draws: &[Draw], behind: [f32; 4]) {
        let [r, g, b, a] = behind.map(f64::from);
        let (r, g, b) = (r * a, g * a, b * a);
        let resolved = self
            .resolved
            .create_view(&wgpu::TextureViewDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("objects"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.colour,
                depth_slice: None,
                resolve_target: Some(&resolved),
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
                    pass.draw_indexed(0..*count, 0, 0..*instances);
                }
            }
        }
    }
}
