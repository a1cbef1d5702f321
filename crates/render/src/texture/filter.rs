//! Filtering: a place in an image and a pixel's footprint there in, a colour out.
//!
//! Texels are fetched in linear light from the level of the mip chain on which the footprint is one texel wide, by up
//! to eight trilinear probes along its longer axis (J. McCormack et al., "Feline: fast elliptical lines for anisotropic
//! texture mapping", 1999).

use super::{Level, Texture};
use crate::style::decode;

/// The ratio of length to width of a footprint from which on it is blurred across.
const MAX_ANISOTROPY: f32 = 8.0;
/// This ratio where time is short.
const COARSE_ANISOTROPY: f32 = 2.0;
/// A footprint that is so many times longer than wide still has one probe, on a coarser level.
const ROUND: f32 = 0.5;
/// Probes overlap: each is this much of its share of the footprint's length, at least.
const OVERLAP: f32 = 0.8;

/// Levels blend into one another between this share of the way and as much before its end; outside of it one is enough.
const BLEND_FROM: f32 = 0.25;

/// The thresholds over 4 × 4 pixels by which, where time is short, one of two levels is taken instead of a blend: the
/// mean over them is the blend. (The recursive order of B. E. Bayer, 1973, in 32nds.)
const THRESHOLDS: [[f32; 4]; 4] = {
    const ORDER: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
    let mut thresholds = [[0.0; 4]; 4];
    let mut k = 0;
    while k < 16 {
        thresholds[k / 4][k % 4] = (2 * ORDER[k / 4][k % 4] + 1) as f32 / 32.0;
        k += 1;
    }
    thresholds
};

/// One level in linear light, 65535 for 1. The fourth channel is 1 everywhere: it adds up the weights, and four channels
/// go through one vector register.
pub(super) type Light = Vec<[u16; 4]>;

/// An image about one place of it: coordinates are offsets from there, so that none of their digits is lost however
/// small they are.
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    levels: Vec<LevelSampler<'a>>,
    /// Texels of the first level per unit of an offset.
    texels: [f32; 2],
    last: f32,
    /// One over how many times a footprint may be longer than wide.
    narrowest: f32,
    /// True if levels are not blended but dithered.
    dithers: bool,
}

#[derive(Clone, Copy, Debug)]
struct LevelSampler<'a> {
    light: &'a [[u16; 4]],
    size: [i32; 2],
    /// The texel that the place is in (less half a texel) and how far, from 0 to 1.
    texel: [i32; 2],
    fraction: [f32; 2],
    /// Texels per unit of an offset.
    scale: [f32; 2],
    repeats: [bool; 2],
}

/// The footprint over which a pixel's colour is averaged: probes in a row.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Footprint {
    /// The level, between 0 and the last.
    level: f32,
    /// The number of probes, a whole number from 1 on.
    probes: f32,
    /// The step from one to the next, in the offset's units.
    step: [f32; 2],
}

impl<'a> Sampler<'a> {
    /// `at` counts widths and heights of the image; an offset's unit is `unit` of them. Along an axis that does not
    /// repeat, the image's border goes on.
    pub fn new(texture: &'a Texture, at: [f64; 2], unit: [f64; 2], repeats: [bool; 2]) -> Self {
        let level = |(level, light): (&Level, &'a Light)| {
            let size = level.size.map(f64::from);
            let texel = [0, 1].map(|k| {
                let at = if repeats[k] {
                    at[k] - at[k].floor()
                } else {
                    at[k]
                };
                at * size[k] - 0.5
            });
            LevelSampler {
                light,
                size: level.size.map(|side| side as i32),
                texel: texel.map(|x| x.floor() as i32),
                fraction: texel.map(|x| (x - x.floor()) as f32),
                scale: [0, 1].map(|k| (unit[k] * size[k]) as f32),
                repeats,
            }
        };
        let levels: Vec<_> = texture
            .levels()
            .iter()
            .zip(texture.light())
            .map(level)
            .collect();
        Self {
            texels: levels[0].scale,
            last: (levels.len() - 1) as f32,
            levels,
            narrowest: 1.0 / MAX_ANISOTROPY,
            dithers: false,
        }
    }

    /// Returns the colour with fewer probes where a footprint is long, a little blurred there, and each on one level.
    pub(crate) fn coarse(self) -> Self {
        Self {
            narrowest: 1.0 / COARSE_ANISOTROPY,
            dithers: true,
            ..self
        }
    }

    /// Takes one level for each of the footprints of pixels in a row, the first of them at a multiple of four columns, if
    /// levels are not blended.
    #[inline(always)]
    pub(crate) fn dither(&self, row: usize, footprints: &mut [Footprint]) {
        if !self.dithers {
            return;
        }
        let thresholds = THRESHOLDS[row % 4];
        for (column, footprint) in footprints.iter_mut().enumerate() {
            // The share of the upper level, in `trilinear`, is above the threshold.
            let up = 1.0 - BLEND_FROM - (1.0 - 2.0 * BLEND_FROM) * thresholds[column % 4];
            footprint.level = (footprint.level + up).floor().min(self.last);
        }
    }

    /// The colour in linear light at an offset, averaged over the parallelogram that `across` and `along` (in the
    /// offset's units) span around it; not finite ones give the whole image's mean.
    #[inline(always)]
    pub fn colour(&self, offset: [f32; 2], across: [f32; 2], along: [f32; 2]) -> [f32; 3] {
        let [a, b] = [across, along];
        self.averaged(offset, self.footprint([a[0], a[1], b[0], b[1]]))
    }

    /// Returns the probes for a pixel with the derivatives (across, along). It has no branches, so that a loop over
    /// many pixels is one over vectors of them.
    #[inline(always)]
    pub(crate) fn footprint(&self, [ax, ay, bx, by]: [f32; 4]) -> Footprint {
        let [su, sv] = self.texels;
        let (ax, ay, bx, by) = (ax * su, ay * sv, bx * su, by * sv);
        // The ellipse's axes are the singular vectors of (a b).
        let (xx, xy, yy) = (ax * ax + bx * bx, ax * ay + bx * by, ay * ay + by * by);
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let spread = (half * half + xy * xy).sqrt();
        let major = (mean + spread).sqrt();
        let minor = (mean - spread).max(0.0).sqrt();
        let minor = minor.max(major * self.narrowest).max(1.0);
        let probes = (major / minor + (1.0 - ROUND)).floor().max(1.0);
        let level = log2(minor.max(OVERLAP * major / probes));
        // Half the angle of (half, xy), without an arc tangent: the axis of the larger singular value.
        let turned = half < 0.0;
        let x = if turned { xy } else { spread + half };
        let y = if turned { spread - half } else { xy };
        let step = major / (probes * (x * x + y * y).sqrt()).max(f32::MIN_POSITIVE);
        let finite = major < 1e18;
        Footprint {
            level: if finite {
                level.min(self.last)
            } else {
                self.last
            },
            probes: if finite { probes } else { 1.0 },
            step: [x * step / su, y * step / sv],
        }
    }

    /// The colour in linear light at an offset, averaged over a footprint.
    #[inline(always)]
    pub(crate) fn averaged(&self, offset: [f32; 2], footprint: Footprint) -> [f32; 3] {
        let Footprint {
            level,
            probes,
            step,
        } = footprint;
        if probes == 1.0 {
            return light(self.trilinear(level, offset));
        }
        let first = -0.5 * (probes - 1.0);
        let mut sum = [0.0; 4];
        for k in 0..probes as i32 {
            let t = first + k as f32;
            let probe = self.trilinear(level, [offset[0] + t * step[0], offset[1] + t * step[1]]);
            sum = std::array::from_fn(|k| sum[k] + probe[k]);
        }
        light(sum)
    }

    #[inline(always)]
    fn trilinear(&self, level: f32, offset: [f32; 2]) -> [f32; 4] {
        let lower = level as i32;
        let share = (level - lower as f32 - BLEND_FROM) * (1.0 / (1.0 - 2.0 * BLEND_FROM));
        let lower = lower as usize;
        if share <= 0.0 {
            return self.levels[lower].bilinear(offset);
        }
        let upper = (lower + 1).min(self.levels.len() - 1);
        if share >= 1.0 {
            return self.levels[upper].bilinear(offset);
        }
        let near = self.levels[lower].bilinear(offset);
        let far = self.levels[upper].bilinear(offset);
        std::array::from_fn(|k| near[k] + share * (far[k] - near[k]))
    }
}

impl LevelSampler<'_> {
    #[inline(always)]
    fn bilinear(&self, offset: [f32; 2]) -> [f32; 4] {
        let (x0, x1, tx) = self.columns(0, offset[0]);
        let (y0, y1, ty) = self.columns(1, offset[1]);
        let width = self.size[0] as usize;
        let texel = |x: usize, y: usize| -> [f32; 4] {
            let texel = self.light[y * width + x];
            std::array::from_fn(|k| f32::from(texel[k]))
        };
        let (p, q, r, s) = (texel(x0, y0), texel(x1, y0), texel(x0, y1), texel(x1, y1));
        std::array::from_fn(|k| {
            let top = p[k] + tx * (q[k] - p[k]);
            let bottom = r[k] + tx * (s[k] - r[k]);
            top + ty * (bottom - top)
        })
    }

    /// The two columns (or rows) on both sides of a place, and how far it is between them.
    #[inline(always)]
    fn columns(&self, axis: usize, offset: f32) -> (usize, usize, f32) {
        let x = self.fraction[axis] + offset * self.scale[axis];
        // Towards zero, then down; what is not a number counts as 0.
        let whole = x as i32;
        let whole = whole - i32::from(x < whole as f32);
        let t = x - whole as f32;
        let first = whole.wrapping_add(self.texel[axis]);
        let last = self.size[axis] - 1;
        if (first as u32) < last as u32 {
            return (first as usize, first as usize + 1, t);
        }
        let (first, second) = beyond(first, self.size[axis], self.repeats[axis]);
        // So far out that f32 has no fractions, the difference to a saturated number would be no weight.
        (first, second, t.clamp(0.0, 1.0))
    }
}

#[cold]
#[inline(never)]
fn beyond(first: i32, size: i32, repeats: bool) -> (usize, usize) {
    if repeats {
        let first = first.rem_euclid(size);
        let second = if first + 1 == size { 0 } else { first + 1 };
        (first as usize, second as usize)
    } else {
        let kept = |x: i32| x.clamp(0, size - 1) as usize;
        (kept(first), kept(first.saturating_add(1)))
    }
}

#[inline(always)]
fn light([r, g, b, weight]: [f32; 4]) -> [f32; 3] {
    let scale = 1.0 / weight;
    [r * scale, g * scale, b * scale]
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
pub(super) fn light_of(levels: &[Level]) -> Vec<Light> {
    let table: Vec<u16> = (0..=255)
        .map(|byte| (decode(byte) * 65535.0).round() as u16)
        .collect();
    let texel = |[r, g, b, _]: &[u8; 4]| {
        let [r, g, b] = [r, g, b].map(|&byte| table[usize::from(byte)]);
        [r, g, b, u16::MAX]
    };
    levels
        .iter()
        .map(|level| level.texels.iter().map(texel).collect())
        .collect()
}
