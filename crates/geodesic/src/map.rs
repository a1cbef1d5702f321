//! The exponential map, pixel by pixel: what a geodesic picture is resolved from.

use crate::chart::Atlas;
use crate::follow::{self, Plan};
use crate::frame::Frame;
use crate::integrate::{DOPRI5, RK4};
use crate::surface::Surface;
use crate::trace::{self, Method, Status};

/// For each pixel, row by row from the top, where its geodesic ends.
#[derive(Clone, Debug, Default)]
pub struct Map {
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// The end of each pixel's geodesic, brought back into the domain.
    pub uv: Vec<[f32; 2]>,
    /// Why each pixel's geodesic ended.
    pub status: Vec<Status>,
    /// Evaluations of the surface and its derivatives, for all pixels together.
    pub evaluations: u64,
}

/// One row of a [`Map`].
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// The ends, from left to right.
    pub uv: Vec<[f32; 2]>,
    /// Why they ended.
    pub status: Vec<Status>,
    /// Evaluations of the surface and its derivatives.
    pub evaluations: u64,
}

/// How a map is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapOptions {
    /// How each geodesic is integrated.
    pub method: Method,
    /// The error allowed at a pixel, in pixels.
    pub tolerance: f64,
    /// The most evaluations for one pixel.
    pub max_evaluations: usize,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            method: Method::Adaptive,
            tolerance: 0.1,
            max_evaluations: 20_000,
        }
    }
}

/// The place of a pixel's centre in the picture: [−1,1] spans the shorter side, x to the right, y up.
pub fn pixel_place(size: [u32; 2], column: u32, row: u32) -> [f64; 2] {
    let half = 0.5 * f64::from(size[0].min(size[1]).max(1));
    [
        (f64::from(column) + 0.5 - 0.5 * f64::from(size[0])) / half,
        (0.5 * f64::from(size[1]) - f64::from(row) - 0.5) / half,
    ]
}

/// The whole map, a row after the other. `progress` is told the share that is done.
pub fn exponential_map<S: Surface + ?Sized>(
    surface: &S,
    frame: &Frame,
    size: [u32; 2],
    options: &MapOptions,
    progress: &(dyn Fn(f32) + Sync),
) -> Map {
    let rows: Vec<Row> = (0..size[1])
        .map(|row| {
            let done = map_row(surface, frame, size, row, options);
            progress((row + 1) as f32 / size[1] as f32);
            done
        })
        .collect();
    Map::from_rows(size, rows)
}

impl Map {
    /// Puts rows together, given from the top; they may have been made in any order, on any thread.
    pub fn from_rows(size: [u32; 2], rows: impl IntoIterator<Item = Row>) -> Self {
        let mut map = Self {
            size,
            ..Self::default()
        };
        for row in rows {
            map.uv.extend(row.uv);
            map.status.extend(row.status);
            map.evaluations += row.evaluations;
        }
        map
    }
}

/// One row of the map, `row` counted from the top. It depends on no other row.
pub fn map_row<S: Surface + ?Sized>(
    surface: &S,
    frame: &Frame,
    size: [u32; 2],
    row: u32,
    options: &MapOptions,
) -> Row {
    let atlas = Atlas::new(surface);
    let mut out = Row::default();
    let zoom = frame.zoom(surface);
    // A pixel's width on the surface, at the centre; per length, over the longest ray of the row's pixels.
    let pixel = zoom * 2.0 / f64::from(size[0].min(size[1]).max(1));
    let mut step = None;
    for column in 0..size[0] {
        let place = pixel_place(size, column, row);
        let length = zoom * place[0].hypot(place[1]);
        let velocity = frame.velocity(place);
        if length == 0.0 || length.is_nan() {
            out.uv.push(frame.uv.map(|x| x as f32));
            out.status.push(Status::Complete);
            continue;
        }
        let limit = atlas.evaluations().saturating_add(options.max_evaluations);
        let start = match trace::unit_start(&atlas, frame.uv, velocity) {
            Ok((start, _)) => start,
            Err(_) => {
                out.uv.push(frame.uv.map(|x| x as f32));
                out.status.push(Status::Undefined);
                continue;
            }
        };
        let common = Plan {
            tableau: &DOPRI5,
            tolerance: Some((options.tolerance * pixel / length).clamp(1e-13, 1e-2)),
            step: step.unwrap_or_else(|| trace::first_step(&atlas, length)),
            limit,
            charts: true,
            keep_path: false,
        };
        let plan = match options.method {
            Method::Adaptive => common,
            Method::Rk4 { steps } => Plan {
                tableau: &RK4,
                tolerance: None,
                step: length / f64::from(steps.max(1)),
                charts: false,
                ..common
            },
        };
        let end = follow::follow(&atlas, start, length, plan);
        // The neighbour's geodesic is much the same.
        step = (end.status == Status::Complete).then_some(end.step);
        out.uv.push(end.motion.at.map(|x| x as f32));
        out.status.push(end.status);
    }
    out.evaluations = atlas.evaluations() as u64;
    out
}
