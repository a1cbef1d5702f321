//! The geodesic view: its camera ([`Inside`]), and how a map of geodesics' ends becomes colours ([`resolve`]).
//!
//! Maps come from `geodesic::map` (f64) or from a generated kernel; nothing here knows which.

mod inside;

pub use inside::Inside;

use geodesic::map::{Map, bring_back};
use geodesic::surface::Sides;
use geodesic::trace::Status;
use image::{Rgba, RgbaImage};
use rayon::prelude::*;

use crate::style;
use crate::texture::Texture;

/// Half the period of the hatching of what is not seen, in [`style::pixel_unit`]s.
pub const HATCH: f32 = 5.0;
/// The radius of the ring around the centre, in [`style::pixel_unit`]s; at least [`LEAST_RING`] pixels.
pub const RING: f32 = 7.0;
/// The least radius of the ring in pixels.
pub const LEAST_RING: f32 = 3.5;

/// What a map is coloured with.
#[derive(Clone, Copy, Debug)]
pub struct Paint<'a> {
    /// The surface's image.
    pub texture: &'a Texture,
    /// The surface's colour in linear light; multiplies the image.
    pub colour: [f32; 3],
    /// `[[u min, u max], [v min, v max]]`: one width of the domain is one width of the image.
    pub domain: [[f64; 2]; 2],
    /// Beyond sides that wrap, the image goes on; beyond a flip it is mirrored.
    pub sides: Sides,
    /// Whether the centre is marked by an open ring.
    pub mark_centre: bool,
}

/// Paper and stripe of the hatching of pixels without a colour, sRGB: light, never black, one pair per reason.
pub fn hatching(status: Status) -> [[u8; 3]; 2] {
    match status {
        Status::Complete | Status::LeftDomain => [[232, 234, 238], [205, 209, 217]],
        Status::ConePoint => [[245, 235, 214], [226, 208, 172]],
        Status::Degenerate => [[240, 226, 240], [216, 192, 219]],
        Status::Undefined => [[244, 226, 224], [224, 192, 189]],
        Status::WorkLimit => [[222, 236, 238], [187, 211, 215]],
    }
}

/// What a reader of the picture should be told of pixels that show nothing of the surface: `count` gives how many of
/// the `pixels` have a status.
pub fn notes(pixels: usize, count: impl Fn(Status) -> usize) -> Vec<String> {
    let kinds = [
        (Status::LeftDomain, "lie beyond the surface's edge"),
        (Status::ConePoint, "end at the tip of a cone"),
        (
            Status::Degenerate,
            "end where the surface has no tangent plane",
        ),
        (Status::Undefined, "end where the surface is undefined"),
        (
            Status::WorkLimit,
            "could not be followed within the limit of work",
        ),
    ];
    let note = |(status, what): (Status, &str)| {
        let count = count(status);
        let share = 100.0 * count as f64 / pixels as f64;
        (count > 0).then(|| format!("{share:.2} % of the pixels {what}; they are hatched"))
    };
    kinds.into_iter().filter_map(note).collect()
}

/// Colours a map. No light and no gamma change: a pixel shows the image's own colour times the surface's.
///
/// A pixel's footprint in the image is the difference to its neighbours, the shorter of both sides' and to the
/// image's period: a seam, where the chart jumps, is no edge of the picture.
pub fn resolve(map: &Map, paint: &Paint) -> RgbaImage {
    let [width, height] = map.size;
    let mut image = RgbaImage::new(width, height);
    let row_bytes = 4 * width as usize;
    if row_bytes == 0 {
        return image;
    }
    image
        .par_chunks_mut(row_bytes)
        .enumerate()
        .for_each(|(y, row)| {
            for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
                let colour = pixel_colour(map, paint, x as u32, y as u32);
                let Rgba(bytes) = mark(colour, paint, map.size, x as u32, y as u32);
                pixel.copy_from_slice(&bytes);
            }
        });
    image
}

/// The colour of one pixel in linear light.
fn pixel_colour(map: &Map, paint: &Paint, x: u32, y: u32) -> [f32; 3] {
    let [width, height] = map.size;
    let at = |x: u32, y: u32| y as usize * width as usize + x as usize;
    let index = at(x, y);
    let status = map.status[index];
    let normal = |index: usize| -> [f32; 2] {
        let (at, _) = bring_back(paint.domain, paint.sides, map.uv(index));
        std::array::from_fn(|k| {
            let [low, high] = paint.domain[k];
            ((at[k] - low) / (high - low)) as f32
        })
    };
    if status != Status::Complete {
        return hatched(map, x, y, status);
    }
    let uv = normal(index);
    let toward = |neighbour: Option<usize>| {
        let neighbour = neighbour.filter(|&n| map.status[n] == Status::Complete)?;
        let other = normal(neighbour);
        // To the nearest repetition of the image.
        let step: [f32; 2] = std::array::from_fn(|k| {
            let d = other[k] - uv[k];
            d - d.round()
        });
        Some(step)
    };
    let shorter = |one: Option<[f32; 2]>, other: Option<[f32; 2]>| {
        let square = |d: [f32; 2]| d[0] * d[0] + d[1] * d[1];
        match (one, other) {
            (Some(one), Some(other)) => {
                if square(one) <= square(other) {
                    one
                } else {
                    other
                }
            }
            (Some(one), None) => one,
            (None, other) => other.unwrap_or_default(),
        }
    };
    let across = shorter(
        toward((x > 0).then(|| at(x.wrapping_sub(1), y))),
        toward((x + 1 < width).then(|| at(x + 1, y))),
    );
    let along = shorter(
        toward((y > 0).then(|| at(x, y.wrapping_sub(1)))),
        toward((y + 1 < height).then(|| at(x, y + 1))),
    );
    let texel = paint.texture.sample(uv, across, along);
    std::array::from_fn(|k| texel[k] * paint.colour[k])
}

/// The hatching of a pixel that shows nothing of the surface; darker along its border to what is seen.
fn hatched(map: &Map, x: u32, y: u32, status: Status) -> [f32; 3] {
    let [width, height] = map.size;
    let unit = style::pixel_unit(map.size).max(0.4);
    let seen = |dx: i64, dy: i64| {
        let (x, y) = (i64::from(x) + dx, i64::from(y) + dy);
        let inside = (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
        inside && map.status[y as usize * width as usize + x as usize] == Status::Complete
    };
    let [paper, stripe] = hatching(status).map(style::linear);
    let reach = (unit.round() as i64).max(1);
    let border = (-reach..=reach)
        .any(|dy| (-reach..=reach).any(|dx| dx * dx + dy * dy <= reach * reach && seen(dx, dy)));
    if border {
        return stripe.map(|c| 0.45 * c);
    }
    // Stripes at 45°, their edges softened over a pixel.
    let period = 2.0 * HATCH * unit;
    let place = (x as f32 + y as f32 + 1.0) / std::f32::consts::SQRT_2;
    let phase = (place / period).rem_euclid(1.0);
    let to_middle = (phase - 0.5).abs() * period;
    let share = (0.5 * HATCH * unit - to_middle + 0.5).clamp(0.0, 1.0);
    std::array::from_fn(|k| paper[k] + share * (stripe[k] - paper[k]))
}

/// Lays the open ring over a colour: white with a dark rim, so that it is seen on anything; what lies in the centre
/// stays free.
fn mark(colour: [f32; 3], paint: &Paint, size: [u32; 2], x: u32, y: u32) -> Rgba<u8> {
    let [r, g, b] = if paint.mark_centre && size[0].min(size[1]) >= 32 {
        let unit = style::pixel_unit(size);
        let radius = (RING * unit).max(LEAST_RING);
        let half = (0.75 * unit).max(0.6);
        let dx = x as f32 + 0.5 - 0.5 * size[0] as f32;
        let dy = y as f32 + 0.5 - 0.5 * size[1] as f32;
        let off = (dx.hypot(dy) - radius).abs();
        let white = (half - off + 0.5).clamp(0.0, 1.0);
        let dark = 0.6 * (2.2 * half - off + 0.5).clamp(0.0, 1.0);
        colour.map(|c| {
            let c = c * (1.0 - dark);
            c + white * (1.0 - c)
        })
    } else {
        colour
    };
    Rgba([style::encode(r), style::encode(g), style::encode(b), 255])
}
