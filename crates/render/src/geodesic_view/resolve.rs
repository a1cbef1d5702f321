//! The conversion of a map of geodesics' ends to colours.
//!
//! A pixel shows the image's colour times the surface's, without light or gamma change. Its footprint in the image is given
//! by the map's derivative, or by the differences to the neighbouring pixels if the derivative is unknown.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use expr::processor::{Processor, Work};
use geodesic::map::Map;
use geodesic::piecewise::{BLOCK, PiecewiseMap, Rows};
use geodesic::surface::{Side, Sides};
use geodesic::trace::Status;
use image::RgbaImage;
use rayon::prelude::*;

use super::{EndsOfRows, HATCH, LEAST_RING, Layer, RING, UNSEEN, hatching};
use crate::style;
use crate::texture::{Sampler, Texture, thresholds};

/// The number of pixels that pass each stage together.
const STRIP: usize = 32;

/// The textures and colours that a map is coloured with.
#[derive(Clone, Copy, Debug)]
pub struct Paint<'a> {
    /// The surface's image.
    pub texture: &'a Arc<Texture>,
    /// The surface's colour in linear light; multiplies the image.
    pub colour: [f32; 3],
    /// `[[u min, u max], [v min, v max]]`: one width of the domain is one width of the image.
    pub domain: [[f64; 2]; 2],
    /// Beyond sides that wrap, the image continues, mirrored beyond a flip. At other sides it ends.
    pub sides: Sides,
    /// True if the centre is marked by an open ring.
    pub mark_centre: bool,
    /// True if speed matters more than quality: surfaces at a grazing angle are then blurred.
    pub coarse: bool,
}

/// Colours a map, on all cores.
pub fn resolve(map: &Map, paint: &Paint) -> RgbaImage {
    let [width, height] = map.size.map(|side| side as usize);
    let mut image = RgbaImage::new(map.size[0], map.size[1]);
    if width == 0 {
        return image;
    }
    let cover = Cover::new(paint.texture, paint.domain, paint.sides);
    let sampler = cover.sampler(map.origin, paint.coarse);
    let (cover, sampler) = (&cover, &sampler);
    let processor = Processor::here();
    image
        .par_chunks_mut(4 * BLOCK as usize * width)
        .enumerate()
        .for_each(|(number, pixels)| {
            processor.run(ImageRows {
                width,
                height,
                offset: &map.offset,
                by_pixel: bytemuck::cast_slice(&map.by_pixel),
                status: &map.status,
                tint: paint.colour,
                cover,
                sampler,
                top: number * BLOCK as usize,
                pixels,
            });
        });
    hatch(&mut image, &map.status);
    if let Some(ring) = Ring::of(paint.mark_centre, map.size) {
        ring.mark(&mut image, 0, |_| true);
    }
    image
}

/// Colours a piecewise map, on all cores. Several rows at a time are computed, coloured and overlaid while they are in the
/// cache. Also returns each pixel's status.
pub(super) fn resolve_piecewise(
    piecewise: &PiecewiseMap,
    paint: &Paint,
    layer: Option<&dyn Layer>,
) -> (RgbaImage, Vec<Status>) {
    let [width, height] = piecewise.size.map(|side| side as usize);
    let mut image = RgbaImage::new(piecewise.size[0], piecewise.size[1]);
    let mut status = vec![Status::Complete; width * height];
    if status.is_empty() {
        return (image, status);
    }
    let cover = Cover::new(paint.texture, paint.domain, paint.sides);
    let sampler = cover.sampler(piecewise.origin, paint.coarse);
    let (cover, sampler) = (&cover, &sampler);
    let ring = Ring::of(paint.mark_centre, piecewise.size);
    let processor = Processor::here();
    let band = BLOCK as usize * width;
    let buffers = || (vec![[0.0; 2]; band], vec![[0.0; 4]; band]);
    image
        .par_chunks_mut(4 * band)
        .zip(status.par_chunks_mut(band))
        .enumerate()
        .for_each_init(buffers, |(offset, by_pixel), (number, (pixels, status))| {
            let count = status.len();
            let (offset, by_pixel) = (&mut offset[..count], &mut by_pixel[..count]);
            let rows = Rows {
                offset: &mut *offset,
                by_pixel: bytemuck::cast_slice_mut(by_pixel),
                status: &mut *status,
            };
            piecewise.block_row(number as u32, rows);
            processor.run(ImageRows {
                width,
                height: count / width,
                offset,
                by_pixel,
                status,
                tint: paint.colour,
                cover,
                sampler,
                top: 0,
                pixels: &mut *pixels,
            });
            if let Some(ring) = &ring {
                ring.mark(pixels, number as u32 * BLOCK, |index| {
                    status[index] == Status::Complete
                });
            }
            if let Some(layer) = layer {
                let ends = EndsOfRows {
                    first: number * BLOCK as usize,
                    origin: piecewise.origin,
                    offset,
                    by_pixel,
                    status,
                };
                layer.lay(ends, pixels);
            }
        });
    // Hatching depends on the neighbourhood, perhaps in other rows, so it comes last. Layers do not change these pixels.
    hatch(&mut image, &status);
    if let Some(ring) = &ring {
        ring.mark(&mut image, 0, |index| status[index] != Status::Complete);
    }
    (image, status)
}

/// Hatches the pixels that show nothing.
pub(crate) fn hatch(image: &mut RgbaImage, status: &[Status]) {
    let size = [image.width(), image.height()];
    let width = size[0] as usize;
    let unit = style::pixel_unit(size).max(0.4);
    let reach = unit.round().max(1.0) as usize;
    let hatchings: OnceLock<Vec<(Status, Hatching)>> = OnceLock::new();
    let rows: Vec<&[Status]> = status.chunks_exact(width.max(1)).collect();
    image
        .par_chunks_mut(4 * width)
        .enumerate()
        .for_each(|(y, pixels)| {
            let unseen = unseen_runs(rows[y]);
            if unseen.is_empty() {
                return;
            }
            let hatchings = hatchings.get_or_init(|| {
                let of = |status| (status, Hatching::new(status, size));
                UNSEEN.map(of).into()
            });
            let hatching = |status| {
                let found = hatchings.iter().find(|(other, _)| *other == status);
                found.map(|(_, hatching)| hatching)
            };
            let (pixels, _) = pixels.as_chunks_mut::<4>();
            for (run, status) in &unseen {
                if let Some(hatching) = hatching(*status) {
                    let stripes = &hatching.stripes[run.start + y..run.end + y];
                    pixels[run.clone()].copy_from_slice(stripes);
                }
            }
            // Some of the surface is visible within the border's width.
            let around = y.saturating_sub(reach)..(y + reach + 1).min(rows.len());
            for (other, row) in around.clone().zip(&rows[around]) {
                let down = other.abs_diff(y);
                let across = (reach * reach - down * down).isqrt();
                for (run, status) in near(&unseen, &seen_runs(row), across) {
                    if let Some(hatching) = hatching(status) {
                        pixels[run].fill(hatching.border);
                    }
                }
            }
        });
}

/// Returns the runs of pixels of a row that see nothing of the surface for one reason.
fn unseen_runs(row: &[Status]) -> Vec<(Range<usize>, Status)> {
    // Most rows have none: a count needs no branches.
    let complete = row.iter().filter(|&&it| it == Status::Complete).count();
    if complete == row.len() {
        return Vec::new();
    }
    let mut end = 0;
    let runs = row.chunk_by(|a, b| a == b).map(|run| {
        end += run.len();
        (end - run.len()..end, run[0])
    });
    runs.filter(|(_, status)| *status != Status::Complete)
        .collect()
}

/// Returns the runs of pixels of a row that see the surface.
fn seen_runs(row: &[Status]) -> Vec<Range<usize>> {
    let mut end = 0;
    let complete = |status: &Status| *status == Status::Complete;
    let runs = row.chunk_by(|a, b| complete(a) == complete(b)).map(|run| {
        end += run.len();
        (end - run.len()..end, run[0])
    });
    runs.filter(|(_, status)| complete(status))
        .map(|(run, _)| run)
        .collect()
}

/// Returns the parts of unseen runs that are at most `pixels` pixels away from seen ones.
fn near(
    unseen: &[(Range<usize>, Status)],
    seen: &[Range<usize>],
    pixels: usize,
) -> Vec<(Range<usize>, Status)> {
    let mut parts = Vec::new();
    let (mut i, mut j) = (0, 0);
    while let (Some((run, status)), Some(other)) = (unseen.get(i), seen.get(j)) {
        let from = run.start.max(other.start.saturating_sub(pixels));
        let to = run.end.min(other.end + pixels);
        if from < to {
            parts.push((from..to, *status));
        }
        if run.end < other.end + pixels {
            i += 1;
        } else {
            j += 1;
        }
    }
    parts
}

/// The ratio of length to width of a footprint from which on it is blurred during motion.
const COARSE_ANISOTROPY: f32 = 2.0;

/// An image continued beyond the domain's sides.
pub(crate) struct Cover {
    pub(crate) texture: Arc<Texture>,
    /// The sides at which it repeats.
    pub(crate) repeats: [bool; 2],
    /// The domain's minima.
    low: [f64; 2],
    /// The width and height of the cover in (u,v).
    pub(crate) period: [f64; 2],
}

impl Cover {
    pub(crate) fn new(texture: &Arc<Texture>, domain: [[f64; 2]; 2], sides: Sides) -> Self {
        let flips = [0, 1].map(|k| sides.of(k)[0] == Side::WrapFlip);
        Self {
            texture: texture.cover(flips),
            repeats: [0, 1].map(|k| matches!(sides.of(k)[0], Side::Wrap | Side::WrapFlip)),
            low: domain.map(|[low, _]| low),
            period: [0, 1].map(|k| {
                let [low, high] = domain[k];
                (high - low) * if flips[k] { 2.0 } else { 1.0 }
            }),
        }
    }

    /// Returns a point in widths of the cover, from its minimum.
    pub(crate) fn share(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (at[k] - self.low[k]) / self.period[k])
    }

    /// Returns a sampler of the image about a point, in units of (u,v).
    fn sampler(&self, origin: [f64; 2], coarse: bool) -> Sampler<'_> {
        let unit = self.period.map(|period| 1.0 / period);
        let sampler = Sampler::new(&self.texture, self.share(origin), unit, self.repeats);
        if coarse {
            sampler.coarse(COARSE_ANISOTROPY)
        } else {
            sampler
        }
    }
}

/// Several rows of the picture. Pixels that show nothing are left unchanged.
struct ImageRows<'a> {
    /// The width of the rows.
    width: usize,
    height: usize,
    /// As in [`Map`].
    offset: &'a [[f32; 2]],
    by_pixel: &'a [[f32; 4]],
    status: &'a [Status],
    tint: [f32; 3],
    cover: &'a Cover,
    sampler: &'a Sampler<'a>,
    /// The index of the first row to be drawn.
    top: usize,
    pixels: &'a mut [u8],
}

impl Work for ImageRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let pixels = std::mem::take(&mut self.pixels);
        let rows = pixels.len() / (4 * self.width);
        // Strips below each other read neighbouring texels, which stay in the cache.
        for first in (0..self.width).step_by(STRIP) {
            let count = STRIP.min(self.width - first);
            for row in 0..rows {
                let from = 4 * (row * self.width + first);
                self.strip(self.top + row, first, &mut pixels[from..from + 4 * count]);
            }
        }
    }
}

#[inline(always)]
fn is_finite(x: f32) -> bool {
    x.abs() < f32::INFINITY
}

impl ImageRows<'_> {
    /// Colours pixels of a row, starting at a column.
    #[inline(always)]
    fn strip(&self, y: usize, first: usize, pixels: &mut [u8]) {
        let count = pixels.len() / 4;
        let start = y * self.width + first;
        let here = start..start + count;
        let (offset, status) = (&self.offset[here.clone()], &self.status[here.clone()]);
        let mut derivatives = [[0.0; STRIP]; 4];
        let mut at = [[0.0; STRIP]; 2];
        let mut light = [[0.0; STRIP]; 3];
        for k in 0..count {
            // Pixels without an end read the texel at the camera, and are not shown.
            let complete = status[k] == Status::Complete;
            let [u, v] = offset[k];
            at[0][k] = if complete { u } else { 0.0 };
            at[1][k] = if complete { v } else { 0.0 };
        }
        if let Some(known) = self.by_pixel.get(here) {
            for (k, &[ax, ay, bx, by]) in known.iter().enumerate() {
                derivatives[0][k] = ax;
                derivatives[1][k] = ay;
                derivatives[2][k] = bx;
                derivatives[3][k] = by;
            }
        } else {
            derivatives = [[f32::NAN; STRIP]; 4];
        }
        let [ax, ay, bx, by] = &derivatives;
        let mut unknown = 0;
        for k in 0..STRIP {
            unknown |= u32::from(!is_finite(ax[k] + ay[k] + bx[k] + by[k]));
        }
        if unknown != 0 {
            self.fill_unknown(y, first, count, &mut derivatives);
        }
        let footprints = self.sampler.footprints(&derivatives, thresholds(y));
        self.sampler.averages(&at, &footprints, &mut light);
        for (light, tint) in light.iter_mut().zip(self.tint) {
            for light in light {
                *light *= tint;
            }
        }
        style::encode_pixels(&light, pixels);
    }

    /// Sets unknown derivatives of a strip's pixels, starting at a column, to the differences to their neighbours.
    #[inline(never)]
    fn fill_unknown(
        &self,
        y: usize,
        first: usize,
        count: usize,
        derivatives: &mut [[f32; STRIP]; 4],
    ) {
        for k in 0..STRIP {
            let sum: f32 = derivatives.iter().map(|all| all[k]).sum();
            if sum.is_finite() {
                continue;
            }
            let index = y * self.width + first + k;
            let found = if k < count && self.status[index] == Status::Complete {
                self.differences(first + k, y)
            } else {
                [0.0; 4]
            };
            for (all, found) in derivatives.iter_mut().zip(found) {
                all[k] = found;
            }
        }
    }

    /// Returns the differences of a pixel's end to those of its horizontal and vertical neighbours, each the shorter of both
    /// sides' and to the nearest repetition of the image: a seam, at which the chart jumps, is not an edge of the picture.
    #[inline(never)]
    fn differences(&self, x: usize, y: usize) -> [f32; 4] {
        let (width, cover) = (self.width, self.cover);
        let here = self.offset[y * width + x];
        let toward = |x: Option<usize>, y: Option<usize>| {
            let index = y? * width + x?;
            (self.status[index] == Status::Complete).then(|| -> [f32; 2] {
                std::array::from_fn(|k| {
                    let step = f64::from(self.offset[index][k]) - f64::from(here[k]);
                    let period = cover.period[k];
                    if cover.repeats[k] {
                        (step - period * (step / period).round()) as f32
                    } else {
                        step as f32
                    }
                })
            })
        };
        let shorter = |one: Option<[f32; 2]>, other: Option<[f32; 2]>| {
            // Measured in widths of the image, so that both coordinates count.
            let square = |d: [f32; 2]| -> f64 {
                let of = |k: usize| (f64::from(d[k]) / cover.period[k]).powi(2);
                of(0) + of(1)
            };
            match (one, other) {
                (Some(one), Some(other)) if square(other) < square(one) => other,
                (Some(one), _) => one,
                (None, other) => other.unwrap_or_default(),
            }
        };
        let after = |x: usize, size: usize| (x + 1 < size).then_some(x + 1);
        let [a, b] = shorter(
            toward(x.checked_sub(1), Some(y)),
            toward(after(x, width), Some(y)),
        );
        let [c, d] = shorter(
            toward(Some(x), y.checked_sub(1)),
            toward(Some(x), after(y, self.height)),
        );
        [a, b, c, d]
    }
}

/// The colours of pixels that show nothing of the surface for one reason.
struct Hatching {
    /// The colour beside seen pixels.
    border: [u8; 4],
    /// The colours elsewhere, by the sum of column and row.
    stripes: Vec<[u8; 4]>,
}

impl Hatching {
    fn new(status: Status, size: [u32; 2]) -> Self {
        let opaque = |colour: [f32; 3]| {
            let [r, g, b] = colour.map(style::encode);
            [r, g, b, 255]
        };
        let unit = style::pixel_unit(size).max(0.4);
        let places = 0..size[0] + size[1];
        Self {
            border: opaque(style::linear(hatching(status)[1]).map(|c| 0.45 * c)),
            stripes: places
                .map(|place| opaque(stripes(status, place as f32 + 1.0, unit)))
                .collect(),
        }
    }
}

/// Returns the hatching itself: stripes at 45° with edges softened over a pixel. `place` is the sum of a pixel's column and
/// row, `unit` its [`style::pixel_unit`].
pub(crate) fn stripes(status: Status, place: f32, unit: f32) -> [f32; 3] {
    let [paper, stripe] = hatching(status).map(style::linear);
    let period = 2.0 * HATCH * unit;
    let phase = (place / std::f32::consts::SQRT_2 / period).rem_euclid(1.0);
    let to_middle = (phase - 0.5).abs() * period;
    let share = (0.5 * HATCH * unit - to_middle + 0.5).clamp(0.0, 1.0);
    std::array::from_fn(|k| paper[k] + share * (stripe[k] - paper[k]))
}

/// An open ring about the centre, white with a dark rim, so that it is visible on any background and leaves the centre free.
pub(crate) struct Ring {
    size: [u32; 2],
    radius: f32,
    /// Half the width of the ring.
    half: f32,
}

impl Ring {
    /// Returns the requested ring. A picture of less than 32 pixels has no room for it.
    pub(crate) fn of(mark_centre: bool, size: [u32; 2]) -> Option<Self> {
        let unit = style::pixel_unit(size);
        (mark_centre && size[0].min(size[1]) >= 32).then_some(Self {
            size,
            radius: (RING * unit).max(LEAST_RING),
            half: (0.75 * unit).max(0.6),
        })
    }

    /// Draws the ring over several whole rows of the picture, the first of which is `top`, but only over the pixels for
    /// which `wanted` is true, by their index in these rows.
    pub(crate) fn mark(&self, pixels: &mut [u8], top: u32, wanted: impl Fn(usize) -> bool) {
        let [width, height] = self.size;
        let reach = (self.radius + 2.2 * self.half + 1.0).ceil() as u32;
        let around = |side: u32| (side / 2).saturating_sub(reach)..(side / 2 + reach).min(side);
        let rows = around(height);
        let bottom = top + (pixels.len() / 4) as u32 / width;
        for y in rows.start.max(top)..rows.end.min(bottom) {
            for x in around(width) {
                let index = ((y - top) * width + x) as usize;
                let dx = x as f32 + 0.5 - 0.5 * width as f32;
                let dy = y as f32 + 0.5 - 0.5 * height as f32;
                let off = (dx.hypot(dy) - self.radius).abs();
                let white = (self.half - off + 0.5).clamp(0.0, 1.0);
                let dark = 0.6 * (2.2 * self.half - off + 0.5).clamp(0.0, 1.0);
                if dark > 0.0 && wanted(index) {
                    for channel in &mut pixels[4 * index..4 * index + 3] {
                        let c = style::decode(*channel) * (1.0 - dark);
                        *channel = style::encode(c + white * (1.0 - c));
                    }
                }
            }
        }
    }
}
