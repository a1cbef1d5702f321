//! Lines that follow from a pixel's place and its derivative: wavefronts, conjugate points; and the painted error.

use geodesic::map::{bring_back, pixel_place};
use geodesic::metric::Metric;
use geodesic::pixels::Map;
use geodesic::surface::Surface;
use geodesic::trace::Status;
use glam::DVec3;
use image::RgbaImage;
use rayon::prelude::*;

use super::measured::steps;
use super::{blend, stroke};
use crate::style;

/// The column and the row of a pixel.
pub(super) fn place_of(size: [u32; 2], index: usize) -> [u32; 2] {
    let width = size[0].max(1) as usize;
    [(index % width) as u32, (index / width) as u32]
}

/// Returns the distance of a pixel from the centre on the surface, as a multiple of the zoom.
pub(super) fn reach(size: [u32; 2], index: usize) -> f64 {
    let [column, row] = place_of(size, index);
    let [x, y] = pixel_place(size, column, row).0;
    x.hypot(y)
}

/// The least distance between wavefronts in pixels: closer ones would fill the picture.
const CLOSEST_WAVES: f64 = 3.0;

/// Circles of equal distance, where something is seen; false if they would be too close.
pub(super) fn wavefronts(
    image: &mut RgbaImage,
    status: &[Status],
    zoom: f64,
    spacing: f64,
    ink: ([u8; 3], f32),
) -> bool {
    let size = [image.width(), image.height()];
    let pixel = zoom * 2.0 / f64::from(size[0].min(size[1]).max(1));
    if !(spacing > CLOSEST_WAVES * pixel && spacing.is_finite()) {
        return false;
    }
    stroke(image, ink, |index| {
        if status[index] != Status::Complete {
            return None;
        }
        let s = zoom * reach(size, index);
        let nearest = (s / spacing).round().max(1.0) * spacing;
        Some(((s - nearest).abs() / pixel) as f32)
    });
    true
}

/// A smooth function of each pixel that is 0 at conjugate points, where the derivative of the exponential map loses its
/// rank: the area that a square pixel becomes over the sum of the squares of its sides, between −½ and ½, with the sign of the
/// Jacobi field. NaN where nothing is seen.
pub(super) fn degeneracy_in_chart(map: &Map, surface: &dyn Surface) -> Vec<f32> {
    let (domain, sides) = (surface.domain(), surface.sides());
    let degeneracy = |(index, d): (usize, &[[f32; 2]; 2])| {
        if map.status[index] != Status::Complete {
            return f32::NAN;
        }
        let [right, down] = d.map(|d| d.map(f64::from));
        let (uv, signs) = bring_back(domain, sides, map.uv(index));
        // Measured on the surface: in the chart the area is infinite at a pole, where nothing is conjugate.
        let mut metric = Metric::of(&surface.jet(uv));
        metric.f *= signs[0] * signs[1];
        let area = metric.r * (right[0] * down[1] - right[1] * down[0]);
        (area / (metric.inner(right, right) + metric.inner(down, down))) as f32
    };
    map.by_pixel
        .par_iter()
        .enumerate()
        .map(degeneracy)
        .collect()
}

/// The function of [`degeneracy_in_chart`] on a solid's surface, of which `normals` has the unit normal at each pixel's end.
pub(super) fn degeneracy_in_space(map: &Map<3>, normals: &[Option<DVec3>]) -> Vec<f32> {
    map.by_pixel
        .par_iter()
        .zip(normals)
        .map(|(d, normal)| {
            let [right, down] = steps(*d);
            normal.map_or(f32::NAN, |normal| {
                let squares = right.length_squared() + down.length_squared();
                (right.cross(down).dot(normal) / squares) as f32
            })
        })
        .collect()
}

/// Draws the conjugate points, where the function of [`degeneracy_in_chart`] changes its sign; it is empty where it is not
/// known. Returns true if there are any.
pub(super) fn conjugate_points(image: &mut RgbaImage, signed: &[f32], ink: ([u8; 3], f32)) -> bool {
    if signed.is_empty() {
        return false;
    }
    let [width, height] = [image.width(), image.height()].map(|side| side as usize);
    stroke(image, ink, |index| {
        let [x, y] = [index % width, index / width];
        let here = signed[index];
        let beside = |step: isize, wanted: bool| -> Option<f32> {
            let value = wanted.then(|| signed[index.wrapping_add_signed(step)])?;
            value.is_finite().then_some(value)
        };
        let w = width as isize;
        let left = beside(-1, x > 0);
        let right = beside(1, x + 1 < width);
        let up = beside(-w, y > 0);
        let down = beside(w, y + 1 < height);
        let slope = |low: Option<f32>, high: Option<f32>| match (low, high) {
            (Some(low), Some(high)) => 0.5 * (high - low),
            (Some(low), None) => here - low,
            (None, Some(high)) => high - here,
            (None, None) => 0.0,
        };
        let gradient = slope(left, right).hypot(slope(up, down));
        let distance = here.abs() / gradient;
        (distance < 8.0).then_some(distance)
    })
}

/// Tints the picture by its estimated errors, in pixels, of every [`STEP`]-th pixel of every [`STEP`]-th row.
pub(super) fn error(image: &mut RgbaImage, errors: &[f32]) {
    let size = [image.width(), image.height()];
    let columns = size[0].div_ceil(STEP) as usize;
    image
        .par_chunks_mut(4)
        .enumerate()
        .for_each(|(index, pixel)| {
            let [x, y] = place_of(size, index).map(|n| (n / STEP) as usize);
            let (colour, share) = tint(errors[y * columns + x]);
            blend(pixel, colour, share);
        });
}

/// Pixels that share one look at the error, along each side.
pub(super) const STEP: u32 = 4;

/// Errors of the scale's marks, in pixels, and their colours.
pub(super) const SCALE: [(f32, [u8; 3]); 4] = [
    (0.001, [40, 90, 220]),
    (0.01, [40, 190, 120]),
    (0.1, [245, 210, 40]),
    (1.0, [230, 40, 30]),
];

/// The colour of an error, in linear light, and how much of it is laid over.
fn tint(error: f32) -> ([f32; 3], f32) {
    if error.is_nan() {
        return ([0.5; 3], 0.0);
    }
    let place = (error.max(1e-9).log10() + 3.0).clamp(0.0, 3.0);
    let first = (place as usize).min(2);
    let share = place - first as f32;
    let [low, high] = [SCALE[first].1, SCALE[first + 1].1].map(style::linear);
    let colour = std::array::from_fn(|k| low[k] + share * (high[k] - low[k]));
    (colour, 0.7)
}
