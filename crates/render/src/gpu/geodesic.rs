//! The geodesic view: the ends of all pixels' geodesics, coloured by a fixed pass. The ends are a table of polynomials
//! that the fan's rays gave in f64, or, for comparison, a map pixel by pixel from f64 or from a generated kernel.
//!
//! Pictures are made in slabs of rows, so that memory is bounded, and each slab in bands, so that no dispatch runs
//! long. The resolve pass looks at neighbouring pixels: a slab's map has some rows more than are coloured.

mod chart;
mod map;

use std::borrow::Cow;

use geodesic::ends::{Estimate, Work};
use geodesic::patchwork::table::code_of;
use geodesic::trace::Status;
use geometry::ManifoldError;
use image::RgbaImage;
use scene::ParamValues;
use scene::Scene;

use crate::geodesic_view::{self, Cover, HATCH, LEAST_RING, RING, Seen, Tally};
use crate::gpu::Drawn;
use crate::gpu::layout::Resolve;
use crate::gpu::workshop::{Workshop, dispatch};
use crate::overlay::OverInside;
use crate::plan::{GeodesicPlan, Plan, Source};
use crate::request::{Method, RenderError, Request};
use crate::style;
use chart::Chart;
pub(crate) use map::map;
use map::{MapSource, kernel_source};

/// Pixels of one slab: 64 MB of map.
const SLAB_PIXELS: u32 = 1 << 22;
/// How many statuses there are.
pub(crate) const STATUSES: usize = 6;

/// Draws the plan's geodesic view; gives the picture and its notes.
pub(crate) fn render(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    plan: &Plan,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Drawn, RenderError> {
    let Some(view) = &plan.geodesic else {
        return Err(ManifoldError::NoSurface { name: None }.into());
    };
    let inside = geodesic_view::Inside::new(scene, settings, request)?;
    let object = &scene.objects[view.surface.0 as usize];
    let source = source(workshop, scene, view, &inside, progress)?;
    let [width, height] = request.size;
    let mut picture = RgbaImage::new(width, height);

    let pipeline = match &source.ends {
        Ends::Map(..) => workshop.resolve_pipeline(&wgsl::painter::resolve_geodesic()?),
        Ends::Table(_) => workshop.resolve_pipeline(&wgsl::painter::resolve_patchwork()?),
    };
    let cover = Cover::new(
        &request.texture(view.surface),
        inside.domain(),
        inside.sides(),
    );
    let sampler = workshop.sampler(cover.repeats);
    let image = workshop.texture(&cover.texture);
    let (origin, unit) = match &source.ends {
        Ends::Map(map, chart) => (map.origin(chart), chart.scale),
        Ends::Table(_) => (inside.frame.uv.0, [1.0; 2]),
    };
    let colour = request.colour(view.surface, &object.shape);
    let mut resolve = description(request, &cover, origin, unit, colour);
    let halo = resolve.reach as u32 + 1;
    let slab = (SLAB_PIXELS / width)
        .saturating_sub(2 * halo)
        .clamp(1, height);
    let gpu = workshop.gpu;
    let counts = gpu.output("counts", 4 * STATUSES as u64)?;
    for first in (0..height).step_by(slab as usize) {
        let rows = slab.min(height - first);
        let made;
        let ends = match &source.ends {
            Ends::Map(map, chart) => {
                let map_first = first.saturating_sub(halo);
                let map_rows = (first + rows + halo).min(height) - map_first;
                resolve.map_rows = [map_first, map_rows];
                made = map.rows(
                    workshop,
                    chart,
                    request.size,
                    [map_first, map_rows],
                    progress,
                )?;
                &made
            }
            Ends::Table(table) => table,
        };
        resolve.rows = [first, rows];
        let uniform = gpu.uniform("resolve", &resolve);
        let size = 4 * u64::from(width) * u64::from(rows);
        let colours = gpu.output("colours", size)?;
        let group = workshop.bind(
            &pipeline.get_bind_group_layout(0),
            &[
                uniform.as_entire_binding(),
                ends.as_entire_binding(),
                colours.as_entire_binding(),
                counts.as_entire_binding(),
                wgpu::BindingResource::TextureView(&image),
                wgpu::BindingResource::Sampler(&sampler),
            ],
        );
        gpu.submit(|encoder| {
            dispatch(
                encoder,
                &pipeline,
                &group,
                [width.div_ceil(8), rows.div_ceil(8)],
            )
        });
        let start = 4 * first as usize * width as usize;
        gpu.read(&colours, size, |bytes| {
            picture.as_flat_samples_mut().samples[start..start + bytes.len()]
                .copy_from_slice(bytes);
        })?;
        progress((first + rows) as f32 / height as f32);
    }
    let counts: Vec<u32> = gpu.read(&counts, 4 * STATUSES as u64, bytemuck::pod_collect_to_vec)?;
    let count = |status| {
        counts
            .get(code_of(status) as usize)
            .map_or(0, |&count| count as usize)
    };
    let pixels = width as usize * height as usize;
    let mut notes = geodesic_view::notes(pixels, count, &source.work, source.estimate);
    let tally = Tally::default();
    let over = OverInside::new(scene, settings, request, &inside, view.surface, &tally);
    let (over, overlays) = over.draw(&mut picture, || match &source.seen {
        Some(seen) => Cow::Borrowed(seen),
        // The kernel keeps no derivatives: what lies over its picture comes from the fan.
        None => Cow::Owned(inside.clone().by(Method::Fan).look(&|_| {})),
    });
    notes.extend(over);
    Ok(Drawn {
        image: picture,
        notes,
        overlays,
    })
}

/// Where the pixels' ends come from.
struct Found {
    ends: Ends,
    /// What they cost on the CPU.
    work: Work,
    estimate: Option<Estimate>,
    /// The ends on the CPU, unless they were computed on the GPU.
    seen: Option<Seen>,
}

enum Ends {
    /// Pixel by pixel.
    Map(MapSource, Box<Chart>),
    /// The table of a patchwork, as words.
    Table(wgpu::Buffer),
}

fn source(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    view: &GeodesicPlan,
    inside: &geodesic_view::Inside,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Found, RenderError> {
    if view.source == Source::Kernel
        && let Some(kernel) = kernel_source(workshop, scene, view.surface, inside)?
    {
        return Ok(Found {
            ends: Ends::Map(kernel, Box::new(Chart::of(inside))),
            work: Work::default(),
            estimate: None,
            seen: None,
        });
    }
    let seen = inside.look(&|share| progress(0.9 * share));
    let (work, estimate) = (seen.work(), seen.estimate());
    let ends = match &seen {
        Seen::Patchwork { patchwork, .. } => {
            let words = patchwork.table();
            Ends::Table(workshop.gpu.storage("table", bytemuck::cast_slice(&words)))
        }
        Seen::Map(map) => Ends::Map(
            MapSource::Blocks(Box::new(map.clone())),
            Box::new(Chart::of(inside)),
        ),
    };
    Ok(Found {
        ends,
        work,
        estimate,
        seen: Some(seen),
    })
}

/// What a fixed pass needs, but for the rows. The ends' offsets count `unit`s of (u,v) from `origin`.
pub(crate) fn description(
    request: &Request,
    cover: &Cover,
    origin: [f64; 2],
    unit: [f64; 2],
    [r, g, b]: [f32; 3],
) -> Resolve {
    let size = request.size;
    let pixel_unit = style::pixel_unit(size);
    let hatch_unit = pixel_unit.max(0.4);
    let mark = request.mark_centre && size[0].min(size[1]) >= 32;
    let mut hatching = [[1.0; 4]; 12];
    for (code, pair) in hatching.chunks_exact_mut(2).enumerate() {
        let colours = geodesic_view::hatching(status_of(code as u32));
        for (to, colour) in pair.iter_mut().zip(colours) {
            let [r, g, b] = style::linear(colour);
            *to = [r, g, b, 1.0];
        }
    }
    let place = cover.share(origin);
    Resolve {
        colour: [r, g, b, 1.0],
        // Where the image repeats, whole turns would only cost digits.
        place: [0, 1].map(|k| match cover.repeats[k] {
            true => (place[k] - place[k].floor()) as f32,
            false => place[k] as f32,
        }),
        per_width: [0, 1].map(|k| (unit[k] / cover.period[k]) as f32),
        repeats: cover.repeats.map(|repeats| f32::from(u8::from(repeats))),
        size,
        map_rows: [0, size[1]],
        rows: [0, size[1]],
        hatch: HATCH * hatch_unit,
        reach: (hatch_unit.round() as i32).max(1),
        ring: if mark {
            (RING * pixel_unit).max(LEAST_RING)
        } else {
            0.0
        },
        ring_half: (0.75 * pixel_unit).max(0.6),
        stride: [size[0], 0, 0, 0],
        hatching,
    }
}

fn status_of(code: u32) -> Status {
    match code {
        0 => Status::Complete,
        1 => Status::LeftDomain,
        2 => Status::ConePoint,
        3 => Status::Degenerate,
        4 => Status::Undefined,
        _ => Status::WorkLimit,
    }
}

#[cfg(test)]
mod tests;
