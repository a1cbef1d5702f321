//! The exponential map: the end of each pixel's geodesic, from which a geodesic picture is resolved.
//!
//! In: a surface, a frame, a picture's size, a method. Out: [`Map`]. The methods are alternatives: the fan, which
//! shares its rays among the pixels, and those that integrate a geodesic for each pixel (`map/pixel.rs`), with which it
//! is compared.

mod pixel;
mod rk4;

use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::ends::{Ends, Estimate};
use crate::fan::{Fan, FanOptions, Interpolation};
use crate::frame::Frame;
use crate::moved::Moved;
use crate::piecewise::PiecewiseMap;
use crate::point::Uv;
use crate::reparametrised::Reparametrised;
use crate::surface::{Sides, Surface};

pub use crate::pixels::{Map, pixel_place};

/// A method of finding the ends of a picture's pixels.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum MapMethod {
    /// Rays shared by all pixels, interpolated by their Jacobi fields.
    #[default]
    Fan,
    /// Rays shared by all pixels, interpolated linearly, for comparison.
    FanLinear,
    /// A geodesic for each pixel, with steps as long as the tolerance allows; poles are passed in their own charts.
    Adaptive,
    /// A geodesic for each pixel, with equal steps of the classical Runge–Kutta method in (u,v), as in the thesis
    /// (equations 4.2), for comparison.
    Rk4 {
        /// The number of steps; at least one is taken.
        steps: u32,
    },
}

/// The accuracy of a map, and the limits on its work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapOptions {
    /// The method.
    pub method: MapMethod,
    /// The error allowed at a pixel, in pixels.
    pub tolerance: f64,
    /// The maximum number of evaluations of all pixels together; lower for a surface that is expensive to evaluate
    /// ([`affordable_evaluations`](crate::surface::affordable_evaluations)). A method that integrates pixels one by one
    /// has [`MapOptions::evaluations_per_pixel`] on average.
    pub max_evaluations: u64,
    /// True if [`Map::by_pixel`] is requested, for methods that provide it.
    pub by_pixel: bool,
}

/// The minimum number of evaluations allowed per pixel on average, however many pixels there are: several times the
/// number that benign surfaces need.
pub const LEAST_FOR_PIXEL: u64 = 400;
/// The maximum number of evaluations per pixel, however few pixels there are.
pub const MOST_FOR_PIXEL: u64 = 20_000;

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            method: MapMethod::default(),
            tolerance: 0.1,
            max_evaluations: 40_000_000,
            by_pixel: true,
        }
    }
}

impl MapOptions {
    /// Returns the maximum number of evaluations per pixel, on average, for a picture of this size and a method that
    /// integrates pixels one by one: an equal share of [`MapOptions::max_evaluations`], but at least [`LEAST_FOR_PIXEL`]
    /// and at most [`MOST_FOR_PIXEL`].
    pub fn evaluations_per_pixel(&self, size: [u32; 2]) -> u64 {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        (self.max_evaluations / pixels.max(1)).clamp(LEAST_FOR_PIXEL, MOST_FOR_PIXEL)
    }
}

/// Brings a point back through the sides that wrap. Also returns the signs by which the components of a vector change:
/// a flip reverses the other coordinate.
pub fn bring_back(domain: [[f64; 2]; 2], sides: Sides, uv: impl Into<Uv>) -> (Uv, [f64; 2]) {
    let Uv(mut at) = uv.into();
    let crossing = sides.wrap(domain, &mut at);
    (Uv(at), crossing.signs)
}

/// Computes the whole map, on all threads of the current rayon pool; the result does not depend on their number.
/// `progress` receives the fraction that is done.
pub fn exponential_map(
    surface: &dyn Surface,
    frame: &Frame,
    size: [u32; 2],
    options: &MapOptions,
    progress: &(dyn Fn(f32) + Sync),
) -> Map {
    // With a zoom of 0 no geodesic needs to be integrated, and there is nothing to share.
    let shared = shared(options.method).filter(|_| frame.zoom(surface) != 0.0);
    let mut map = if let Some(interpolation) = shared {
        let fan = fan_options(interpolation, options);
        with_fan(surface, frame, size, &fan, |fan, ends| {
            by_fan(fan, ends, size, options, progress)
        })
    } else {
        let moved = match options.method {
            // As in the thesis: in (u, v).
            MapMethod::Rk4 { .. } => None,
            _ => Moved::for_camera(surface, frame, size),
        };
        match &moved {
            Some((moved, camera)) => pixel_by_pixel(moved, camera, size, options, progress),
            None => pixel_by_pixel(surface, frame, size, options, progress),
        }
    };
    map.origin = frame.uv.0;
    map
}

/// Builds the fan of a picture in the coordinates in which its rays run: those of the camera for a deep zoom, those that are
/// smooth across a seam, or the surface's own. Passes it to `read`, with its ends: in the surface's coordinates, or for a deep
/// zoom relative to the camera.
pub fn with_fan<R>(
    surface: &dyn Surface,
    frame: &Frame,
    size: [u32; 2],
    options: &FanOptions,
    read: impl FnOnce(&Fan<'_>, &dyn Ends) -> R,
) -> R {
    if let Some((moved, camera)) = Moved::for_camera(surface, frame, size) {
        let fan = Fan::build(&moved, &camera, size, options);
        read(&fan, &fan)
    } else if let Some((even, camera)) = Reparametrised::for_camera(surface, frame) {
        let fan = Fan::build(&even, &camera, size, options);
        read(&fan, &even.restored_ends(&fan))
    } else {
        let fan = Fan::build(surface, frame, size, options);
        read(&fan, &fan)
    }
}

/// Returns the interpolation of a method whose rays the pixels share.
fn shared(method: MapMethod) -> Option<Interpolation> {
    match method {
        MapMethod::Fan => Some(Interpolation::Hermite),
        MapMethod::FanLinear => Some(Interpolation::Linear),
        MapMethod::Adaptive | MapMethod::Rk4 { .. } => None,
    }
}

fn fan_options(interpolation: Interpolation, options: &MapOptions) -> FanOptions {
    let defaults = FanOptions::default();
    FanOptions {
        tolerance: options.tolerance,
        interpolation,
        max_evaluations: defaults.max_evaluations.min(options.max_evaluations),
        ..defaults
    }
}

/// Computes the map of a fan, from its ends in the requested coordinates.
fn by_fan(
    fan: &Fan<'_>,
    ends: &dyn Ends,
    size: [u32; 2],
    options: &MapOptions,
    progress: &(dyn Fn(f32) + Sync),
) -> Map {
    progress(0.5);
    let piecewise = PiecewiseMap::cut(ends, size, PIECEWISE_SHARE * options.tolerance);
    let mut map = piecewise.map(options.by_pixel);
    map.work = fan.work();
    map.estimate = Some(fan.estimate().with(piecewise.estimate));
    progress(1.0);
    map
}

/// The fraction of the tolerance that the polynomials may add to the rays' error.
const PIECEWISE_SHARE: f64 = 0.5;

fn pixel_by_pixel(
    surface: &dyn Surface,
    frame: &Frame,
    size: [u32; 2],
    options: &MapOptions,
    progress: &(dyn Fn(f32) + Sync),
) -> Map {
    let done = AtomicU32::new(0);
    let rows: Vec<pixel::Row> = (0..size[1])
        .into_par_iter()
        .map(|row| {
            let finished = pixel::row(surface, frame, size, row, options);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(done as f32 / size[1] as f32);
            finished
        })
        .collect();
    let mut map = Map {
        size,
        origin: frame.uv.0,
        ..Map::default()
    };
    let mut errors = Vec::new();
    for row in rows {
        map.offset.extend(row.offset);
        map.by_pixel.extend(row.by_pixel);
        map.status.extend(row.status);
        map.work.steps += row.work.steps;
        map.work.rejected += row.work.rejected;
        map.work.evaluations += row.work.evaluations;
        map.work.followed += row.work.followed;
        errors.extend(row.errors);
    }
    map.estimate = Estimate::of(&mut errors);
    map
}
