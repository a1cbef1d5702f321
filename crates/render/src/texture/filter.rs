//! Filtering: places in an image and the footprints of pixels there in, colours out.
//!
//! Texels are fetched in linear light from the level of the mip chain on which the footprint is one texel wide, by up
//! to eight trilinear probes along its longer axis (J. McCormack et al., "Feline: fast elliptical lines for anisotropic
//! texture mapping", 1999).
//!
//! Pixels go through it in arrays, one array for each quantity, in loops without branches: each becomes one over
//! vectors. What differs by level is written to arrays first, by a pass for each level that some pixel needs: neighbours
//! need one or two.
//!
//! Texels are fetched in pairs of neighbours: two loads of 16 bytes for a place, where gathers of single texels took four
//! elements of a slow instruction.

#![allow(clippy::needless_range_loop)] // Several arrays are walked together, lane by lane.

use super::{Level, Texture};
use crate::style::decode;

/// The ratio of length to width of a footprint from which on it is blurred across.
const MAX_ANISOTROPY: f32 = 8.0;
/// A footprint that is so many times longer than wide still has one probe, on a coarser level.
const ROUND: f32 = 0.5;
/// Probes overlap: each is this much of its share of the footprint's length, at least.
const OVERLAP: f32 = 0.8;

/// 2²², below which f32 has all halves of whole numbers.
const EXACT: f32 = 4_194_304.0;

/// Levels blend into one another between this share of the way and as much before its end; outside of it one is enough.
const BLEND_FROM: f32 = 0.25;

/// The thresholds of four rows. They go on for as many pixels as are filtered together at most.
const THRESHOLDS: [[f32; 64]; 4] = {
    let mut thresholds = [[0.0; 64]; 4];
    let mut k = 0;
    while k < 256 {
        thresholds[k / 64][k % 64] = threshold(k as i32 % 64, k as i32 / 64);
        k += 1;
    }
    thresholds
};

/// Returns the threshold of a pixel, by which one of two levels is taken instead of a blend where time is short. The mean over
/// 4 × 4 pixels is the blend. (The recursive order of B. E. Bayer, 1973.)
#[inline(always)]
pub(crate) const fn threshold(x: i32, y: i32) -> f32 {
    let diagonal = x ^ y;
    let order = (diagonal & 1) << 3 | (y & 1) << 2 | (diagonal & 2) | (y & 2) >> 1;
    (2 * order + 1) as f32 / 32.0
}

/// Returns the [`threshold`] of each pixel of a row, beginning with a column that is a multiple of four.
#[inline(always)]
pub(crate) fn thresholds(row: usize) -> &'static [f32; 64] {
    &THRESHOLDS[row % 4]
}

/// A texel in linear light, 65535 for 1: red in the lowest 16 bits, then green, then blue.
type LinearTexel = u64;

/// All levels in linear light, one after another, each row by row from the top. Each row ends with its first texel again,
/// and each level with its first row, so that the right and the lower neighbour of every texel follow it.
#[derive(Clone, Debug)]
pub(super) struct LinearTexels {
    texels: Vec<LinearTexel>,
    /// The positions of the levels' first texels.
    firsts: Vec<usize>,
}

/// An image about one place of it: coordinates are offsets from there, so that none of their digits is lost however
/// small they are.
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    light: &'a [LinearTexel],
    levels: Vec<LevelSampler>,
    /// Texels of the first level per unit of an offset.
    texels: [f32; 2],
    repeats: [bool; 2],
    /// One over how many times a footprint may be longer than wide.
    narrowest: f32,
    /// True if levels are not blended but dithered.
    dithers: bool,
}

#[derive(Clone, Copy, Debug)]
struct LevelSampler {
    /// The position of its first texel.
    first: i32,
    axes: [AxisSampler; 2],
}

/// One axis of a level.
#[derive(Clone, Copy, Debug)]
struct AxisSampler {
    /// Texels per unit of an offset.
    scale: f32,
    /// The texel that the place is in (less half a texel) and how far, from 0 to 1.
    texel: i32,
    fraction: f32,
    /// Texels.
    size: i32,
}

/// The footprints over which the colours of L pixels are averaged: probes in a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprints<const L: usize> {
    /// The levels, between 0 and the last.
    level: [f32; L],
    /// The numbers of probes, whole numbers from 1 on.
    probes: [f32; L],
    /// The steps from one to the next, in the offset's units.
    step: [[f32; L]; 2],
}

/// The levels of L pixels, each quantity of [`LevelSampler`] in an array.
struct PixelLevels<const L: usize> {
    first: [i32; L],
    axes: [PixelAxis<L>; 2],
}

/// One axis of the levels of L pixels, as [`AxisSampler`].
#[derive(Clone, Copy)]
struct PixelAxis<const L: usize> {
    scale: [f32; L],
    texel: [i32; L],
    fraction: [f32; L],
    size: [i32; L],
}

/// The column (or row) before each of L places, and the share of the way from it to the next one: 0 where the image's border
/// goes on.
struct Neighbours<const L: usize> {
    first: [i32; L],
    share: [f32; L],
}

impl<'a> Sampler<'a> {
    /// `at` counts widths and heights of the image; an offset's unit is `unit` of them. Along an axis that does not
    /// repeat, the image's border goes on.
    pub fn new(texture: &'a Texture, at: [f64; 2], unit: [f64; 2], repeats: [bool; 2]) -> Self {
        let light = texture.light();
        let level = |(level, &first): (&Level, &usize)| {
            let axis = |k: usize| {
                let at = if repeats[k] {
                    at[k] - at[k].floor()
                } else {
                    at[k]
                };
                let size = f64::from(level.size[k]);
                let texel = at * size - 0.5;
                AxisSampler {
                    scale: (unit[k] * size) as f32,
                    texel: texel.floor() as i32,
                    fraction: (texel - texel.floor()) as f32,
                    size: level.size[k] as i32,
                }
            };
            LevelSampler {
                first: first as i32,
                axes: [axis(0), axis(1)],
            }
        };
        let levels: Vec<_> = texture
            .levels()
            .iter()
            .zip(&light.firsts)
            .map(level)
            .collect();
        Self {
            light: &light.texels,
            texels: levels[0].axes.map(|axis| axis.scale),
            levels,
            repeats,
            narrowest: 1.0 / MAX_ANISOTROPY,
            dithers: false,
        }
    }

    /// Takes each colour from one level, instead of a blend of two, and is blurred where a footprint is more than
    /// `anisotropy` times longer than wide: fewer probes, for pictures during motion.
    pub(crate) fn coarse(self, anisotropy: f32) -> Self {
        Self {
            narrowest: 1.0 / anisotropy,
            dithers: true,
            ..self
        }
    }

    /// Returns true if [`Self::footprints`] needs thresholds.
    #[inline(always)]
    pub(crate) fn dithers(&self) -> bool {
        self.dithers
    }

    /// The colour in linear light at an offset, averaged over the parallelogram that `across` and `along` (in the
    /// offset's units) span around it; not finite ones give the whole image's mean.
    pub fn colour(&self, offset: [f32; 2], across: [f32; 2], along: [f32; 2]) -> [f32; 3] {
        let [a, b] = [across, along];
        let derivatives = [a[0], a[1], b[0], b[1]].map(|x| [x]);
        let footprints = self.footprints(&derivatives, thresholds(0));
        let mut colour = [[0.0]; 3];
        self.averages(&offset.map(|x| [x]), &footprints, &mut colour);
        colour.map(|[channel]| channel)
    }

    /// The footprints of L pixels with the derivatives (across, along) and these thresholds ([`thresholds`]), where levels are
    /// dithered.
    #[inline(always)]
    pub(crate) fn footprints<const L: usize>(
        &self,
        derivatives: &[[f32; L]; 4],
        thresholds: &[f32],
    ) -> Footprints<L> {
        let [su, sv] = self.texels;
        let last = (self.levels.len() - 1) as f32;
        let mut all = Footprints {
            level: [0.0; L],
            probes: [0.0; L],
            step: [[0.0; L]; 2],
        };
        for k in 0..L {
            let [ax, ay] = [derivatives[0][k] * su, derivatives[1][k] * sv];
            let [bx, by] = [derivatives[2][k] * su, derivatives[3][k] * sv];
            // The ellipse's axes are the singular vectors of (a b).
            let (xx, xy, yy) = (ax * ax + bx * bx, ax * ay + bx * by, ay * ay + by * by);
            let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
            let spread = (half * half + xy * xy).sqrt();
            let major = (mean + spread).sqrt();
            let minor = larger(mean - spread, 0.0).sqrt();
            let minor = larger(larger(minor, major * self.narrowest), 1.0);
            let probes = larger(floor(major / minor + (1.0 - ROUND)), 1.0);
            let level = log2(larger(minor, OVERLAP * major / probes));
            // Half the angle of (half, xy), without an arc tangent: the axis of the larger singular value.
            let turned = half < 0.0;
            let x = if turned { xy } else { spread + half };
            let y = if turned { spread - half } else { xy };
            let length = (x * x + y * y).sqrt();
            // A round footprint is as long in all directions.
            let is_round = length == 0.0;
            let x = if is_round { 1.0 } else { x };
            let step = major / (probes * if is_round { 1.0 } else { length });
            let finite = major < 1e18;
            all.level[k] = if finite { smaller(level, last) } else { last };
            all.probes[k] = if finite { probes } else { 1.0 };
            all.step[0][k] = if finite { x * step / su } else { 0.0 };
            all.step[1][k] = if finite { y * step / sv } else { 0.0 };
        }
        if self.dithers {
            for (level, threshold) in all.level.iter_mut().zip(thresholds) {
                // The share of the upper level, in `averages`, is above the threshold.
                let up = 1.0 - BLEND_FROM - (1.0 - 2.0 * BLEND_FROM) * threshold;
                *level = smaller(floor(*level + up), last);
            }
        }
        all
    }

    /// The colours in linear light at offsets, averaged over footprints.
    #[inline(always)]
    pub(crate) fn averages<const L: usize>(
        &self,
        offsets: &[[f32; L]; 2],
        footprints: &Footprints<L>,
        colours: &mut [[f32; L]; 3],
    ) {
        // The two levels of each pixel, and the share of the upper one.
        let mut lower = [0; L];
        let mut upper = [0; L];
        let mut share = [0.0; L];
        let last = (self.levels.len() - 1) as i32;
        let mut blended = 0;
        let mut most = 1;
        for k in 0..L {
            let level = footprints.level[k];
            let floor = floor(level);
            let below = to_i32(floor);
            let above = (below + 1).min(last);
            let blend = (level - floor - BLEND_FROM) * (1.0 / (1.0 - 2.0 * BLEND_FROM));
            lower[k] = if blend >= 1.0 { above } else { below };
            upper[k] = if blend > 0.0 { above } else { below };
            share[k] = if lower[k] == upper[k] { 0.0 } else { blend };
            blended |= lower[k] ^ upper[k];
            most = most.max(to_i32(footprints.probes[k]));
        }
        let lower = PixelLevels::of(self, &lower);
        if blended == 0 {
            let levels = [&lower, &lower];
            self.probe::<L, false>(offsets, footprints, most, levels, &share, colours);
        } else {
            let levels = [&lower, &PixelLevels::of(self, &upper)];
            self.probe::<L, true>(offsets, footprints, most, levels, &share, colours);
        }
    }

    /// The means of up to `most` probes: on the lower levels, if `BLENDED` mixed with so much of the upper ones.
    #[inline(always)]
    fn probe<const L: usize, const BLENDED: bool>(
        &self,
        offsets: &[[f32; L]; 2],
        Footprints { probes, step, .. }: &Footprints<L>,
        most: i32,
        [lower, upper]: [&PixelLevels<L>; 2],
        share: &[f32; L],
        colours: &mut [[f32; L]; 3],
    ) {
        let mut sums = [[0.0; L]; 3];
        for probe in 0..most {
            let probe = probe as f32;
            let mut at = [[0.0; L]; 2];
            for k in 0..L {
                let along = probe - 0.5 * (probes[k] - 1.0);
                at[0][k] = offsets[0][k] + along * step[0][k];
                at[1][k] = offsets[1][k] + along * step[1][k];
            }
            let mut light = self.bilinear(lower, &at);
            if BLENDED {
                let above = self.bilinear(upper, &at);
                for (light, above) in light.iter_mut().zip(&above) {
                    for k in 0..L {
                        light[k] += share[k] * (above[k] - light[k]);
                    }
                }
            }
            for (sum, light) in sums.iter_mut().zip(&light) {
                for k in 0..L {
                    sum[k] += if probe < probes[k] { light[k] } else { 0.0 };
                }
            }
        }
        for (colour, sum) in colours.iter_mut().zip(&sums) {
            for k in 0..L {
                colour[k] = sum[k] * (1.0 / (probes[k] * 65535.0));
            }
        }
    }

    /// The light at places of levels, interpolated between four texels; 65535 for 1.
    #[inline(always)]
    fn bilinear<const L: usize>(
        &self,
        pixels: &PixelLevels<L>,
        at: &[[f32; L]; 2],
    ) -> [[f32; L]; 3] {
        let columns = pixels.axes[0].beside(&at[0], self.repeats[0]);
        let rows = pixels.axes[1].beside(&at[1], self.repeats[1]);
        let mut top = [0; L];
        let mut bottom = [0; L];
        for k in 0..L {
            let stride = pixels.axes[0].size[k] + 1;
            top[k] = pixels.first[k] + rows.first[k] * stride + columns.first[k];
            bottom[k] = top[k] + stride;
        }
        let top = fetch(self.light, &top);
        let bottom = fetch(self.light, &bottom);
        let mut light = [[0.0; L]; 3];
        for (channel, light) in light.iter_mut().enumerate() {
            for k in 0..L {
                let (across, down) = (columns.share[k], rows.share[k]);
                let [p, q] = top[k].map(|texel| of(texel, channel));
                let [r, s] = bottom[k].map(|texel| of(texel, channel));
                let upper = p + across * (q - p);
                let lower = r + across * (s - r);
                light[k] = upper + down * (lower - upper);
            }
        }
        light
    }
}

impl<const L: usize> PixelLevels<L> {
    /// Reads the level of each of L pixels.
    #[inline(always)]
    fn of(sampler: &Sampler, levels: &[i32; L]) -> Self {
        let mut present = 0_u32;
        for &level in levels {
            present |= 1 << (level & 31);
        }
        // Most pixels have the level of their neighbours.
        let lowest = present.trailing_zeros() as usize;
        let first = &sampler.levels[lowest];
        let axis = |axis: &AxisSampler| PixelAxis {
            scale: [axis.scale; L],
            texel: [axis.texel; L],
            fraction: [axis.fraction; L],
            size: [axis.size; L],
        };
        let mut pixels = Self {
            first: [first.first; L],
            axes: [axis(&first.axes[0]), axis(&first.axes[1])],
        };
        for (number, level) in (0..).zip(&sampler.levels).skip(lowest + 1) {
            if present >> number & 1 == 0 {
                continue;
            }
            for k in 0..L {
                let first = level.first;
                pixels.first[k] = if levels[k] == number {
                    first
                } else {
                    pixels.first[k]
                };
            }
            for (all, axis) in pixels.axes.iter_mut().zip(&level.axes) {
                for k in 0..L {
                    let here = levels[k] == number;
                    all.scale[k] = if here { axis.scale } else { all.scale[k] };
                    all.texel[k] = if here { axis.texel } else { all.texel[k] };
                    all.fraction[k] = if here { axis.fraction } else { all.fraction[k] };
                    all.size[k] = if here { axis.size } else { all.size[k] };
                }
            }
        }
        pixels
    }
}

impl<const L: usize> PixelAxis<L> {
    /// The texels before offsets, and how far these are towards the next ones.
    #[inline(always)]
    fn beside(&self, offsets: &[f32; L], repeats: bool) -> Neighbours<L> {
        let mut beside = Neighbours {
            first: [0; L],
            share: [0.0; L],
        };
        let (mut outside, mut far) = (0, 0);
        for k in 0..L {
            let x = self.fraction[k] + offsets[k] * self.scale[k];
            let down = floor(x);
            let first = to_i32(down).wrapping_add(self.texel[k]);
            beside.first[k] = first;
            beside.share[k] = x - down;
            outside |= u32::from(first as u32 >= (self.size[k] - 1) as u32);
            let near = x.abs() < EXACT && (first as f32).abs() < EXACT;
            far |= u32::from(!near);
        }
        if far != 0 {
            self.beside_far(offsets, repeats, &mut beside);
        } else if outside != 0 && repeats {
            for k in 0..L {
                let (first, size) = (beside.first[k], self.size[k]);
                let times = to_i32(round(first as f32 / size as f32));
                let rest = first.wrapping_sub(times.wrapping_mul(size));
                beside.first[k] = if rest < 0 {
                    rest.wrapping_add(size)
                } else {
                    rest
                };
            }
        } else if outside != 0 {
            for k in 0..L {
                let (first, last) = (beside.first[k], self.size[k] - 1);
                let between = (first as u32) < last as u32;
                beside.first[k] = first.clamp(0, last);
                beside.share[k] = if between { beside.share[k] } else { 0.0 };
            }
        }
        beside
    }

    /// The same where f32 does not have all whole numbers any more, or an offset is no number.
    #[cold]
    #[inline(never)]
    fn beside_far(&self, offsets: &[f32; L], repeats: bool, beside: &mut Neighbours<L>) {
        for k in 0..L {
            let (size, x) = (self.size[k], self.fraction[k] + offsets[k] * self.scale[k]);
            let down = x.floor();
            let first = (down as i32).wrapping_add(self.texel[k]);
            // The difference to a saturated number would be no weight.
            let share = larger(smaller(x - down, 1.0), 0.0);
            (beside.first[k], beside.share[k]) = if repeats {
                (first.rem_euclid(size), share)
            } else {
                let between = (0..size - 1).contains(&first);
                (first.clamp(0, size - 1), if between { share } else { 0.0 })
            };
        }
    }
}

/// Texels at positions, each with the next one; beyond the last pair it is the last, which nobody asks for: so the loop has no
/// branches.
#[inline(always)]
fn fetch<const L: usize>(light: &[LinearTexel], positions: &[i32; L]) -> [[LinearTexel; 2]; L] {
    let mut pairs = [[0; 2]; L];
    let Some(last) = light.len().checked_sub(2) else {
        return pairs;
    };
    for k in 0..L {
        let position = (positions[k] as u32 as usize).min(last);
        if let Some(pair) = light[position..].first_chunk() {
            pairs[k] = *pair;
        }
    }
    pairs
}

/// A channel of a texel.
#[inline(always)]
fn of(texel: LinearTexel, channel: usize) -> f32 {
    ((texel >> (16 * channel)) as u32 & 0xffff) as i32 as f32
}

/// The larger of two numbers, the second if one is none: one instruction, which [`f32::max`] is not.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, the second if one is none.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// 1.5 · 2²³. Added to a number below 2²², it leaves no bits for a fraction: the sum's last bits are the nearest whole
/// number. These are additions, which become vectors; a conversion that saturates, as `as i32` does, does not.
const WHOLE: f32 = 12_582_912.0;

/// The nearest whole number of one below [`EXACT`]; of two, the even one.
#[inline(always)]
fn round(x: f32) -> f32 {
    (x + WHOLE) - WHOLE
}

/// The largest whole number that is not above one below [`EXACT`].
#[inline(always)]
fn floor(x: f32) -> f32 {
    let nearest = round(x);
    if nearest > x { nearest - 1.0 } else { nearest }
}

/// A whole number below [`EXACT`].
#[inline(always)]
fn to_i32(whole: f32) -> i32 {
    ((whole + WHOLE).to_bits() as i32).wrapping_sub(WHOLE.to_bits() as i32)
}

/// The binary logarithm of a positive normal number to 0.01, continuous: the exponent and a parabola.
#[inline(always)]
fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    let exponent = (bits >> 23) as i32 - 127;
    let m = f32::from_bits((bits & 0x007f_ffff) | 0x3f80_0000);
    exponent as f32 + (m - 1.0) * (1.34375 - 0.34375 * (m - 1.0))
}

/// All levels in linear light.
pub(super) fn light_of(levels: &[Level]) -> LinearTexels {
    let table: Vec<u64> = (0..=255)
        .map(|byte| (decode(byte) * 65535.0).round() as u64)
        .collect();
    let texel = |[r, g, b, _]: &[u8; 4]| {
        let [r, g, b] = [r, g, b].map(|&byte| table[usize::from(byte)]);
        r | g << 16 | b << 32
    };
    let padded = |[width, height]: [u32; 2]| (width as usize + 1) * (height as usize + 1);
    let mut light = LinearTexels {
        texels: Vec::with_capacity(levels.iter().map(|level| padded(level.size)).sum()),
        firsts: Vec::with_capacity(levels.len()),
    };
    for level in levels {
        light.firsts.push(light.texels.len());
        let rows = level.texels.chunks(level.size[0].max(1) as usize);
        for row in rows.clone().chain(rows.take(1)) {
            light
                .texels
                .extend(row.iter().chain(row.first()).map(texel));
        }
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::encode;

    const L: usize = 32;

    /// An image of odd sides, every texel another colour.
    fn texture() -> Texture {
        let [width, height] = [37, 23];
        let texel = |n: u32| {
            [
                (7 * n) as u8,
                (n / 3) as u8,
                (255 - 11 * n % 256) as u8,
                255,
            ]
        };
        Texture::of_texels([width, height], (0..width * height).map(texel).collect())
    }

    /// The definition: bilinear between the texels of a level, in f64.
    fn bilinear(level: &Level, at: [f64; 2], repeats: [bool; 2]) -> [f64; 3] {
        let texel = |x: f64, y: f64| -> [f64; 3] {
            let [x, y] = [0, 1].map(|k: usize| {
                let (at, side) = ([x, y][k], f64::from(level.size[k]));
                if repeats[k] {
                    at.rem_euclid(side) as usize
                } else {
                    at.clamp(0.0, side - 1.0) as usize
                }
            });
            let texel = level.texels[y * level.size[0] as usize + x];
            [0, 1, 2].map(|k: usize| f64::from(decode(texel[k])))
        };
        let [x, y] = [0, 1].map(|k: usize| at[k] * f64::from(level.size[k]) - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (p, q) = (texel(left, top), texel(left + 1.0, top));
        let (r, s) = (texel(left, top + 1.0), texel(left + 1.0, top + 1.0));
        [0, 1, 2].map(|k: usize| {
            let above = p[k] + (x - left) * (q[k] - p[k]);
            let below = r[k] + (x - left) * (s[k] - r[k]);
            above + (y - top) * (below - above)
        })
    }

    #[test]
    fn a_round_footprint_has_the_mean_around_its_place() {
        // A ramp along u: red is the place.
        let texel = |k: u32| [(k % 256) as u8, 0, 0, 255];
        let texture = Texture::of_texels([256; 2], (0..256 * 256).map(texel).collect());
        let sampler = Sampler::new(&texture, [0.5; 2], [1.0; 2], [false; 2]);
        for texels in [0.0, 0.5, 3.0, 5.0, 8.0, 20.0] {
            let step = texels / 256.0;
            for turn in [[step, 0.0, 0.0, step], [0.0, step, -step, 0.0]] {
                for u in [-0.2, 0.0, 0.125, 0.25] {
                    let [a, b, c, d] = turn;
                    let found = sampler.colour([u, 0.0], [a, b], [c, d])[0];
                    let place = encode(found);
                    let expected = 256.0 * (0.5 + u) - 0.5;
                    let off = (f32::from(place) - expected).abs();
                    assert!(
                        off < 1.5 + 0.1 * texels,
                        "{texels} at {u}: {place}, {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn arrays_of_pixels_have_the_colours_of_the_definition() {
        let texture = texture();
        for repeats in [[true; 2], [true, false], [false, true], [false; 2]] {
            let place = [0.3, 0.7];
            let sampler = Sampler::new(&texture, place, [1.0; 2], repeats);
            for round in 0..200 {
                // Offsets in the image, some widths away, and so far away that the cold path takes over.
                let reach = [0.4, 3.0, 40.0, 3e5][round % 4];
                let mut offsets = [[0.0; L]; 2];
                let mut derivatives = [[0.0; L]; 4];
                for k in 0..L {
                    let n = (round * L + k) as f64;
                    offsets[0][k] = (reach * (1.7 * n).sin()) as f32;
                    offsets[1][k] = (reach * (2.3 * n).cos()) as f32;
                    for (j, all) in derivatives.iter_mut().enumerate() {
                        all[k] = (0.2 * (n / 700.0) * (n * (j + 1) as f64).sin()) as f32;
                    }
                }
                let footprints = sampler.footprints(&derivatives, thresholds(0));
                let mut colours = [[0.0; L]; 3];
                sampler.averages(&offsets, &footprints, &mut colours);
                for k in 0..L {
                    let (probes, level) = (footprints.probes[k], footprints.level[k]);
                    let share =
                        ((level.fract() - BLEND_FROM) / (1.0 - 2.0 * BLEND_FROM)).clamp(0.0, 1.0);
                    let levels = texture.levels();
                    let lower = &levels[level as usize];
                    let upper = &levels[(level as usize + 1).min(levels.len() - 1)];
                    let mut wanted = [0.0; 3];
                    for probe in 0..probes as i32 {
                        let along = f64::from(probe) - 0.5 * f64::from(probes - 1.0);
                        let at = [0, 1].map(|j: usize| {
                            let step = along * f64::from(footprints.step[j][k]);
                            place[j] + f64::from(offsets[j][k]) + step
                        });
                        let near = bilinear(lower, at, repeats);
                        let far = bilinear(upper, at, repeats);
                        for channel in 0..3 {
                            let light =
                                near[channel] + f64::from(share) * (far[channel] - near[channel]);
                            wanted[channel] += light / f64::from(probes);
                        }
                    }
                    // Far away, an offset in f32 is coarser than a texel.
                    let allowed = if reach > 1e3 {
                        1.0
                    } else {
                        1e-4 * reach.max(1.0)
                    };
                    for channel in 0..3 {
                        let found = f64::from(colours[channel][k]);
                        assert!(
                            (found - wanted[channel]).abs() < allowed,
                            "{repeats:?} {round} {k}: {found} for {wanted:?}"
                        );
                        assert!((0.0..=1.0001).contains(&found), "{found}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_no_number_or_beyond_all_texels_has_some_colour() {
        let texture = texture();
        let far = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -3e9, 5e6];
        for repeats in [true, false] {
            let sampler = Sampler::new(&texture, [0.3, 0.7], [1.0; 2], [repeats; 2]);
            for (u, v) in far.iter().flat_map(|&u| far.iter().map(move |&v| (u, v))) {
                sampler.colour([u, v], [0.01, 0.0], [0.0, 0.01]);
                sampler.colour([0.0; 2], [u, v], [v, u]);
            }
            let mean = sampler.colour([0.2, 0.1], [f32::INFINITY; 2], [0.0; 2]);
            let last = texture.levels().last().map(|level| level.texels[0]);
            let [r, g, b, _] = last.unwrap_or_default();
            for (mean, byte) in mean.into_iter().zip([r, g, b]) {
                assert!((mean - decode(byte)).abs() < 1e-4, "{mean} {byte}");
            }
        }
    }
}
