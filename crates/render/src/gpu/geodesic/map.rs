//! Maps of geodesics' ends pixel by pixel, for comparison: a generated kernel, or a map in f64, in; buffers with some rows
//! of it out, and the whole map read back.

use geodesic::ends::Coordinates;
use geodesic::map::Map;
use geodesic::patchwork::table::code_of;
use geometry::ManifoldError;
use scene::ParamValues;
use scene::{ObjectId, Scene, Shape};
use wgsl::Kernel;

use super::chart::Chart;
use super::status_of;
use crate::geodesic_view;
use crate::gpu::internal;
use crate::gpu::workshop::{Workshop, dispatch};
use crate::request::{RenderError, Request, View};

/// Pixels of one dispatch.
const BAND_PIXELS: u32 = 1 << 16;
/// Bytes of a pixel of the map.
const PIXEL_BYTES: u64 = 16;

/// The map of a geodesic view as a generated kernel computes it, in one piece: for comparing it with f64. `None` if
/// the surface's derivatives are too large for a shader, or the camera stands at a pole.
pub(crate) fn map(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
) -> Result<Option<Map>, RenderError> {
    let View::Geodesic { surface, .. } = request.view else {
        return Err(ManifoldError::NoSurface { name: None }.into());
    };
    let inside = geodesic_view::Inside::new(scene, settings, request)?;
    let chart = Chart::of(&inside);
    let Some(source) = kernel_source(workshop, scene, surface, &inside)? else {
        return Ok(None);
    };
    source.whole(workshop, &chart, request.size).map(Some)
}

/// Where maps come from.
pub(super) enum MapSource {
    Kernel {
        pipeline: wgpu::ComputePipeline,
        uniforms: Option<wgpu::Buffer>,
    },
    /// A map in f64.
    Blocks(Box<Map>),
}

/// The generated kernel; `None` if it would be too large for a shader, or if the camera stands so near a pole that it has
/// coordinates of its own there, which single precision's (u,v) cannot tell apart: f64 takes any of them.
pub(super) fn kernel_source(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    surface: ObjectId,
    inside: &geodesic_view::Inside,
) -> Result<Option<MapSource>, RenderError> {
    let Shape::Surface { position, .. } = &scene.objects[surface.0 as usize].shape else {
        return Err(ManifoldError::NoSurface { name: None }.into());
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
    pub(super) fn kernel(workshop: &mut Workshop<'_>, kernel: &Kernel, values: &[f64]) -> Self {
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
    pub(super) fn origin(&self, chart: &Chart) -> [f64; 2] {
        match self {
            Self::Kernel { .. } => chart.at,
            Self::Blocks(map) => map.origin,
        }
    }

    /// The whole map, read back.
    pub(super) fn whole(
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
    pub(super) fn rows(
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
