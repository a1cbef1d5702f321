//! The geodesic view: the ends of all pixels' geodesics, coloured by a fixed pass. The ends are a table of polynomials
//! that the fan's rays gave in f64, or, for comparison, a map pixel by pixel from f64 or from a generated kernel.
//!
//! Pictures are made in slabs of rows, so that memory is bounded, and each slab in bands, so that no dispatch runs
//! long. The resolve pass looks at neighbouring pixels: a slab's map has some rows more than are coloured.

use std::borrow::Cow;

use geodesic::ends::{Coordinates, Estimate, Work};
use geodesic::frame::Frame;
use geodesic::map::Map;
use geodesic::patchwork::table::code_of;
use geodesic::surface::{Side, Sides};
use geodesic::trace::Status;
use image::RgbaImage;
use scene::scene::{ObjectId, Scene, Shape};
use scene::values::Settings;
use wgsl::Kernel;

use crate::geodesic_view::{self, Cover, HATCH, LEAST_RING, RING, Seen};
use crate::gpu::layout::{ChartCamera, Resolve};
use crate::gpu::workshop::{Workshop, dispatch};
use crate::gpu::{Drawn, internal};
use crate::overlay;
use crate::plan::{GeodesicPlan, Plan, Source};
use crate::request::{Method, RenderError, Request, View};
use crate::style;

/// Pixels of one slab: 64 MB of map.
const SLAB_PIXELS: u32 = 1 << 22;
/// Pixels of one dispatch.
const BAND_PIXELS: u32 = 1 << 16;
/// The most steps of one pixel's geodesic.
const STEP_LIMIT: u32 = 2_000;
/// How many statuses there are.
pub(crate) const STATUSES: usize = 6;
/// Bytes of a pixel of the map.
const PIXEL_BYTES: u64 = 16;

/// Draws the plan's geodesic view; gives the picture and its notes.
pub(crate) fn render(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    settings: &Settings,
    request: &Request,
    plan: &Plan,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Drawn, RenderError> {
    let Some(view) = &plan.geodesic else {
        return Err(RenderError::NoSurface { name: None });
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
        Ends::Table(_) => (inside.frame.uv, [1.0; 2]),
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
    let (over, overlays) = overlay::over_inside(
        &mut picture,
        scene,
        settings,
        request,
        &inside,
        view.surface,
        || match &source.seen {
            Some(seen) => Cow::Borrowed(seen),
            // The kernel keeps no derivatives: what lies over its picture comes from the fan.
            None => Cow::Owned(inside.clone().by(Method::Fan).look(&|_| {})),
        },
    );
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

/// The map of a geodesic view as a generated kernel computes it, in one piece: for comparing it with f64. `None` if
/// the surface's derivatives are too large for a shader, or the camera stands at a pole.
pub(crate) fn map(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    settings: &Settings,
    request: &Request,
) -> Result<Option<Map>, RenderError> {
    let View::Geodesic { surface, .. } = request.view else {
        return Err(RenderError::NoSurface { name: None });
    };
    let inside = geodesic_view::Inside::new(scene, settings, request)?;
    let chart = Chart::of(&inside);
    let Some(source) = kernel_source(workshop, scene, surface, &inside)? else {
        return Ok(None);
    };
    source.whole(workshop, &chart, request.size).map(Some)
}

/// Where maps come from.
enum MapSource {
    Kernel {
        pipeline: wgpu::ComputePipeline,
        uniforms: Option<wgpu::Buffer>,
    },
    /// A map in f64.
    Blocks(Box<Map>),
}

/// The generated kernel; `None` if it would be too large for a shader, or if the camera stands so near a pole that it has
/// coordinates of its own there, which single precision's (u,v) cannot tell apart: f64 takes any of them.
fn kernel_source(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    surface: ObjectId,
    inside: &geodesic_view::Inside,
) -> Result<Option<MapSource>, RenderError> {
    let Shape::Surface { position, .. } = &scene.objects[surface.0 as usize].shape else {
        return Err(RenderError::NoSurface { name: None });
    };
    if inside.frame.coordinates != Coordinates::Plain {
        return Ok(None);
    }
    match wgsl::kernel::geodesic(&scene.graph, *position) {
        Ok(kernel) => Ok(Some(MapSource::kernel(workshop, &kernel, &inside.uniforms))),
        Err(error) => internal(error).map_or(Ok(None), Err),
    }
}

impl MapSource {
    fn kernel(workshop: &mut Workshop<'_>, kernel: &Kernel, values: &[f64]) -> Self {
        let pipeline = workshop.geodesic_kernel(kernel);
        let row: Vec<f32> = kernel
            .uniforms()
            .iter()
            .map(|&k| values[k as usize] as f32)
            .collect();
        let uniforms =
            (!row.is_empty()).then(|| workshop.gpu.storage("uniforms", bytemuck::cast_slice(&row)));
        Self::Kernel { pipeline, uniforms }
    }

    /// Where its offsets count from.
    fn origin(&self, chart: &Chart) -> [f64; 2] {
        match self {
            Self::Kernel { .. } => chart.at,
            Self::Blocks(map) => map.origin,
        }
    }

    /// The whole map, read back.
    fn whole(
        &self,
        workshop: &Workshop<'_>,
        chart: &Chart,
        size: [u32; 2],
    ) -> Result<Map, RenderError> {
        let buffer = self.rows(workshop, chart, size, [0, size[1]], &|_| {})?;
        let bytes = PIXEL_BYTES * u64::from(size[0]) * u64::from(size[1]);
        workshop.gpu.read(&buffer, bytes, |bytes| {
            let pixels: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(bytes);
            let offset = pixels.iter().map(|&[a, b, ..]| {
                let scaled = [a, b].map(f32::from_bits);
                [0, 1].map(|k| (chart.scale[k] * f64::from(scaled[k])) as f32)
            });
            let status = pixels.iter().map(|&[_, _, status, _]| status_of(status));
            Map {
                offset: offset.collect(),
                origin: chart.at,
                status: status.collect(),
                size,
                ..Map::default()
            }
        })
    }

    /// A buffer with some rows of the map: first, and how many.
    fn rows(
        &self,
        workshop: &Workshop<'_>,
        chart: &Chart,
        size: [u32; 2],
        [first, count]: [u32; 2],
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<wgpu::Buffer, RenderError> {
        let gpu = workshop.gpu;
        let width = size[0];
        let (pipeline, uniforms) = match self {
            Self::Blocks(map) => {
                let pixels =
                    (first as usize * width as usize)..((first + count) as usize * width as usize);
                let packed: Vec<[u32; 4]> = pixels
                    .map(|at| {
                        let scaled = |k: usize| f64::from(map.offset[at][k]) / chart.scale[k];
                        let [a, b] = [0, 1].map(|k| (scaled(k) as f32).to_bits());
                        [a, b, code_of(map.status[at]), 0]
                    })
                    .collect();
                return Ok(gpu.storage("map", bytemuck::cast_slice(&packed)));
            }
            Self::Kernel { pipeline, uniforms } => (pipeline, uniforms),
        };
        let map = gpu.output("map", PIXEL_BYTES * u64::from(width) * u64::from(count))?;
        let layout = pipeline.get_bind_group_layout(0);
        let band = (BAND_PIXELS / width).max(1);
        for row in (0..count).step_by(band as usize) {
            let rows = band.min(count - row);
            let camera = gpu.uniform("camera", &chart.camera(size, [first + row, rows], first));
            let mut bindings = vec![
                (0, camera.as_entire_binding()),
                (2, map.as_entire_binding()),
            ];
            if let Some(uniforms) = uniforms {
                bindings.push((1, uniforms.as_entire_binding()));
            }
            let group = workshop.bind_numbered(&layout, &bindings);
            gpu.submit(|encoder| {
                dispatch(
                    encoder,
                    pipeline,
                    &group,
                    [width.div_ceil(8), rows.div_ceil(8)],
                )
            });
            gpu.wait()?;
            progress((first + row + rows) as f32 / size[1] as f32);
        }
        Ok(map)
    }
}

/// The chart in scaled coordinates: offsets from the camera, in units in which the camera's tangent vectors are
/// about 1.
struct Chart {
    at: [f64; 2],
    scale: [f64; 2],
    x: [f64; 2],
    y: [f64; 2],
    domain: [[f64; 2]; 2],
    sides: [u32; 4],
    tip_powers: [f32; 4],
    zoom: f64,
}

impl Chart {
    fn new(frame: &Frame, domain: [[f64; 2]; 2], sides: Sides, zoom: f64) -> Self {
        // Where a component is 0 for both vectors the chart would have no tangent plane; the frame excludes that.
        let scale = [0, 1].map(|k| frame.x[k].hypot(frame.y[k]));
        Self {
            at: frame.uv,
            scale,
            x: [0, 1].map(|k| frame.x[k] / scale[k]),
            y: [0, 1].map(|k| frame.y[k] / scale[k]),
            domain,
            sides: [sides.u[0], sides.u[1], sides.v[0], sides.v[1]].map(side_code),
            tip_powers: [1.0; 4],
            zoom,
        }
    }

    /// The chart of a camera that has been set up.
    fn of(inside: &geodesic_view::Inside) -> Self {
        let mut chart = Self::new(&inside.frame, inside.domain(), inside.sides(), inside.zoom);
        for (side, apex) in inside.apexes().as_flattened().iter().enumerate() {
            if let Some(apex) = apex.filter(|apex| apex.regular) {
                chart.tip_powers[side] = apex.power as f32;
                if !apex.smooth {
                    chart.sides[side] = CONE;
                }
            }
        }
        chart
    }

    fn camera(&self, size: [u32; 2], rows: [u32; 2], map_row: u32) -> ChartCamera {
        let end = |side: usize| {
            [0, 1].map(|k| ((self.domain[k][side] - self.at[k]) / self.scale[k]) as f32)
        };
        ChartCamera {
            origin: self.at.map(|x| x as f32),
            scale: self.scale.map(|x| x as f32),
            x: self.x.map(|x| x as f32),
            y: self.y.map(|x| x as f32),
            minimum: end(0),
            maximum: end(1),
            sides: self.sides,
            tip_powers: self.tip_powers,
            size,
            rows,
            per_length: (1.0 / self.zoom) as f32,
            step_limit: STEP_LIMIT,
            instance: 0,
            map_row,
        }
    }
}

/// The number of a side that is the tip of a cone in lib/chart.wgsl.
const CONE: u32 = 4;

/// The number of a side in lib/chart.wgsl.
fn side_code(side: Side) -> u32 {
    match side {
        Side::Edge => 0,
        Side::Wrap => 1,
        Side::WrapFlip => 2,
        Side::Pole => 3,
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
