//! Geodesic pictures again and again: the table of a look is uploaded once, the fixed pass is built once, and what has
//! been coloured stays on the device unless something is drawn over it in memory.

use std::sync::Arc;

use ::geodesic::patchwork::table::code_of;
use image::RgbaImage;
use scene::ParamValues;
use scene::Scene;

use crate::geodesic_view::{self, Cover, Seen};
use crate::gpu::canvas::Canvases;
use crate::gpu::geodesic::{STATUSES, description};
use crate::gpu::studio::check_side;
use crate::gpu::workshop::{Workshop, dispatch};
use crate::live::Pixels;
use crate::live::inside::Look;
use crate::overlay::{self, OverInside};
use crate::request::{RenderError, Request, View};
use crate::texture::Texture;

/// Tables and images that are kept: those of so many panes.
const KEPT: usize = 6;

/// What geodesic pictures have in common.
#[derive(Debug, Default)]
pub(crate) struct Insides {
    pipeline: Option<wgpu::ComputePipeline>,
    samplers: Vec<([bool; 2], wgpu::Sampler)>,
    images: Vec<(Arc<Texture>, wgpu::TextureView)>,
    tables: Vec<Table>,
}

/// A look on the device.
#[derive(Debug)]
struct Table {
    look: Arc<Look>,
    words: wgpu::Buffer,
    /// How many pixels have each status, once they have been counted.
    counts: Option<Vec<u32>>,
}

/// A picture with what belongs to it.
pub(crate) struct Coloured {
    pub(crate) pixels: Pixels,
    pub(crate) notes: Vec<String>,
    pub(crate) overlays: Vec<&'static str>,
}

impl Insides {
    /// Colours a look; `None` if it is not a table of polynomials, which alone the device takes.
    ///
    /// # Errors
    /// Those of the device.
    pub(crate) fn colour(
        &mut self,
        workshop: &mut Workshop<'_>,
        canvases: &mut Canvases,
        scene: &Scene,
        settings: &ParamValues,
        request: &Request,
        look: &Arc<Look>,
    ) -> Result<Option<Coloured>, RenderError> {
        let (View::Geodesic { surface, .. }, Seen::Patchwork { patchwork, .. }) =
            (&request.view, &look.seen)
        else {
            return Ok(None);
        };
        let gpu = workshop.gpu;
        check_side(gpu, request.size)?;
        let pipeline = match &self.pipeline {
            Some(pipeline) => pipeline.clone(),
            None => {
                let built = workshop.resolve_pipeline(&wgsl::painter::resolve_patchwork()?);
                self.pipeline.insert(built).clone()
            }
        };
        let inside = &look.inside;
        let cover = Cover::new(&request.texture(*surface), inside.domain(), inside.sides());
        let sampler = self.sampler(workshop, cover.repeats);
        let image = self.image(workshop, &cover.texture);
        let table = recent(
            &mut self.tables,
            |table| Arc::ptr_eq(&table.look, look),
            || Table {
                look: look.clone(),
                words: gpu.storage("table", bytemuck::cast_slice(&patchwork.table())),
                counts: None,
            },
        );

        let [width, height] = request.size;
        let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let shape = &scene.objects[surface.0 as usize].shape;
        let colour = request.colour(*surface, shape);
        let mut resolve = description(request, &cover, inside.frame.uv.0, colour);
        resolve.stride[0] = row / 4;
        let uniform = gpu.uniform("resolve", &resolve);
        let size = u64::from(row) * u64::from(height);
        let colours = gpu.output("colours", size)?;
        let counts = gpu.output("counts", 4 * STATUSES as u64)?;
        let group = workshop.bind(
            &pipeline.get_bind_group_layout(0),
            &[
                uniform.as_entire_binding(),
                table.words.as_entire_binding(),
                colours.as_entire_binding(),
                counts.as_entire_binding(),
                wgpu::BindingResource::TextureView(&image),
                wgpu::BindingResource::Sampler(&sampler),
            ],
        );
        let groups = [width.div_ceil(8), height.div_ceil(8)];
        let plain = !overlay::any_inside(scene, request, *surface);
        let canvas = plain.then(|| canvases.take(gpu, request.size));
        gpu.submit(|encoder| {
            dispatch(encoder, &pipeline, &group, groups);
            if let Some(canvas) = &canvas {
                canvas.fill(encoder, &colours, row);
            }
        });
        if table.counts.is_none() {
            let read = bytemuck::pod_collect_to_vec;
            table.counts = Some(gpu.read(&counts, 4 * STATUSES as u64, read)?);
        }
        let count = |status| {
            let counts = table.counts.as_ref();
            counts
                .and_then(|counts| counts.get(code_of(status) as usize))
                .map_or(0, |&count| count as usize)
        };
        let pixels = width as usize * height as usize;
        let seen = &look.seen;
        let mut notes = geodesic_view::notes(pixels, count, &seen.work(), seen.estimate());
        let Some(canvas) = canvas else {
            let mut picture = RgbaImage::new(width, height);
            gpu.read(&colours, size, |bytes| {
                let rows = bytes.chunks_exact(row as usize);
                for (to, from) in picture.chunks_exact_mut(4 * width as usize).zip(rows) {
                    to.copy_from_slice(&from[..to.len()]);
                }
            })?;
            let over = OverInside::new(scene, settings, request, inside, *surface, &look.tally);
            let (over, overlays) = over.draw(&mut picture, seen);
            notes.extend(over);
            return Ok(Some(Coloured {
                pixels: Pixels::Image(picture),
                notes,
                overlays,
            }));
        };
        Ok(Some(Coloured {
            pixels: Pixels::Texture(canvas),
            notes,
            overlays: Vec::new(),
        }))
    }

    fn sampler(&mut self, workshop: &mut Workshop<'_>, repeats: [bool; 2]) -> wgpu::Sampler {
        let known = |(key, _): &([bool; 2], wgpu::Sampler)| *key == repeats;
        let make = || (repeats, workshop.sampler(repeats));
        recent(&mut self.samplers, known, make).1.clone()
    }

    fn image(&mut self, workshop: &mut Workshop<'_>, texture: &Arc<Texture>) -> wgpu::TextureView {
        let known = |(key, _): &(Arc<Texture>, wgpu::TextureView)| Arc::ptr_eq(key, texture);
        let make = || (texture.clone(), workshop.texture(texture));
        recent(&mut self.images, known, make).1.clone()
    }
}

/// The entry that is looked for, made if there is none; it stands last from now on, and the first gives way.
fn recent<T>(all: &mut Vec<T>, is: impl Fn(&T) -> bool, make: impl FnOnce() -> T) -> &mut T {
    let entry = match all.iter().position(is) {
        Some(at) => all.remove(at),
        None => make(),
    };
    if all.len() >= KEPT {
        all.remove(0);
    }
    all.push(entry);
    let last = all.len() - 1;
    &mut all[last]
}
