//! The texture of a surface's Gaussian curvature. In: exact second derivatives. Out: colours over the domain.
//!
//! The curvature is evaluated in f64 at the centre of each texel, by (LN − M²)/(EG − F²) for a surface in space and by
//! Gauss's equation for a metric (M. do Carmo, *Differential Geometry of Curves and Surfaces*, 1976, sections 3-3 and 4-3).
//! The colours are on straight lines in a perceptual space, equally bright on both sides of zero.

use std::sync::Arc;

use geodesic::metric::{Metric, gaussian_curvature};
use geodesic::surface::{JetBlock, LANES, Lanes, Surface};
use rayon::prelude::*;
use scene::ParamValues;
use scene::{ObjectId, Scene};

use super::{Level, MOST_INSTANCES, Texture, side};
use crate::error::RenderError;
use crate::style::encode;
use geometry::{Manifold, ManifoldError};

/// The number of texels along u and along v, at most; a multiple of [`LANES`].
const SIDE: u32 = 512;
/// The fraction of the surface's area whose curvature the scale always distinguishes. The scale includes the whole surface,
/// unless the rest would use up the colours of this part.
const COVERED: f64 = 0.98;
/// The maximum ratio of the scale to the curvature that covers this fraction of the area.
const MOST_BEYOND: f64 = 2.0;
/// The number of times a step, initially a texel, is halved in the search for the largest curvature, and the maximum number
/// of steps of one size.
const HALVINGS: u32 = 20;
const STEPS: u32 = 8;
/// The distance of the search from the sides of the domain, as a fraction of its length: at a pole the values are only
/// rounding errors.
const SIDES: f64 = 1e-6;
/// Curvature counts as a rounding error if a surface of this size would turn by less than about the root of this.
const FLAT: f64 = 1e-9;
/// The colour of undefined curvature, sRGB: distinct from white, which is flat, and from all others.
const UNDEFINED: [u8; 3] = [128, 128, 128];

/// The scale of the colours of a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvatureScale {
    /// The curvature of the last colour on either side of zero, in 1/length²; positive.
    pub most: f64,
    /// True if the curvature exceeds this somewhere; the last colour is shown there.
    pub is_clipped: bool,
    /// True if the curvature is 0 everywhere, except for rounding: no place has another colour than that of 0.
    pub is_flat: bool,
}

impl Texture {
    /// Creates a texture of a surface or metric coloured by its Gaussian curvature: blue where it is negative, white at
    /// zero, red where it is positive, grey where it is undefined. For a surface that depends on grids, each instance has a
    /// texture of its own. The scale is symmetric about zero and includes all instances, or almost all of their area if the
    /// rest is curved far more: [`Texture::curvature_scale`].
    ///
    /// It is valid for these param values only.
    ///
    /// # Errors
    /// [`RenderError::Manifold`].
    pub fn curvature(
        scene: &Scene,
        params: &ParamValues,
        surface: ObjectId,
    ) -> Result<Arc<Self>, RenderError> {
        let object = scene.get(surface);
        let object = object.ok_or(ManifoldError::NoSurface { name: None })?;
        let count = params.instance_count(scene, object);
        let instances = (0..count.clamp(1, MOST_INSTANCES)).map(|instance| {
            let uniforms = match count {
                0 => params.first_instance(scene, object),
                _ => params.instance(scene, object, instance),
            };
            Manifold::new(scene, surface, &uniforms)
        });
        let grounds: Vec<Manifold> = instances.collect::<Result<_, _>>()?;
        Ok(Arc::new(of_surfaces(&grounds)))
    }

    /// Returns the scale of the colours, if this is a [`Texture::curvature`].
    pub fn curvature_scale(&self) -> Option<CurvatureScale> {
        self.scale
    }
}

impl CurvatureScale {
    /// Returns the colour of a curvature, sRGB.
    pub fn colour(&self, curvature: f64) -> [u8; 3] {
        if !curvature.is_finite() {
            return UNDEFINED;
        }
        diverging((curvature / self.most).clamp(-1.0, 1.0) as f32)
    }
}

/// Returns the texture of the instances of a surface, of which there is at least one.
fn of_surfaces(grounds: &[Manifold]) -> Texture {
    let side = side(grounds.len() as u64, SIDE);
    let instances = grounds.iter().map(|ground| {
        let surface = ground.surface();
        (surface, samples(surface, side))
    });
    let instances: Vec<(&dyn Surface, Vec<CurvatureSample>)> = instances.collect();
    let scale = scale(&instances, side);
    let textures = instances.iter().map(|(_, samples)| {
        let colour = |&(curvature, _): &CurvatureSample| {
            let [r, g, b] = scale.colour(curvature);
            [r, g, b, 255]
        };
        let level = Level {
            size: [side; 2],
            texels: samples.par_iter().map(colour).collect(),
        };
        Texture {
            scale: Some(scale),
            ..Texture::chain(level)
        }
    });
    Texture::of_instances(textures)
}

/// The curvature and the area of a texel.
type CurvatureSample = (f64, f64);

/// Returns the curvature and the area of each texel, row by row.
fn samples(surface: &dyn Surface, side: u32) -> Vec<CurvatureSample> {
    let domain = surface.domain();
    let at = |k: usize, texel: usize| {
        let [low, high] = domain[k];
        low + (high - low) * (texel as f64 + 0.5) / f64::from(side)
    };
    let side = side as usize;
    let mut samples = vec![(f64::NAN, 0.0); side * side];
    let rows = samples.par_chunks_mut(side).enumerate();
    rows.for_each_init(JetBlock::default, |block, (row, samples)| {
        for (number, samples) in samples.chunks_mut(LANES).enumerate() {
            let us: Lanes = std::array::from_fn(|lane| at(0, number * LANES + lane));
            surface.jets(&[us, [at(1, row); LANES]], block);
            for (lane, sample) in samples.iter_mut().enumerate() {
                let jet = block.lane(lane);
                *sample = (gaussian_curvature(&jet), Metric::of(&jet).r);
            }
        }
    });
    samples
}

/// Returns the scale of surfaces with these samples.
fn scale(instances: &[(&dyn Surface, Vec<CurvatureSample>)], side: u32) -> CurvatureScale {
    let mut known: Vec<CurvatureSample> = instances
        .iter()
        .flat_map(|(_, samples)| samples)
        .filter(|(curvature, area)| curvature.is_finite() && area.is_finite())
        .map(|&(curvature, area)| (curvature.abs(), area))
        .collect();
    known.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = known.iter().map(|(_, area)| area).sum();
    let mut below = 0.0;
    let found = known.iter().find(|(_, area)| {
        below += area;
        below >= COVERED * all
    });
    // The least visible curvature of the smallest instance.
    let least = instances.iter().map(|(surface, _)| {
        let (domain, stretch) = (surface.domain(), surface.scale().stretch);
        let lengths = [0, 1].map(|k| stretch[k] * (domain[k][1] - domain[k][0]));
        FLAT / (lengths[0] * lengths[1])
    });
    let least = least.filter(|it| it.is_finite()).fold(0.0, f64::max);
    let most = found.map_or(0.0, |(curvature, _)| *curvature);
    if most > least {
        let largest = instances.par_iter();
        let largest = largest.map(|(surface, samples)| largest_curvature(*surface, samples, side));
        let all = largest.reduce(|| most, f64::max);
        let is_clipped = all > MOST_BEYOND * most;
        return CurvatureScale {
            most: if is_clipped { most } else { all },
            is_clipped,
            is_flat: false,
        };
    }
    // Flat: rounding errors are white beside a curvature that would be visible.
    CurvatureScale {
        most: if least > 0.0 { least / FLAT } else { 1.0 },
        is_clipped: false,
        is_flat: true,
    }
}

/// Returns the largest absolute curvature of a surface: a search from the texel with the largest value, with steps that are
/// halved when none leads to a larger one.
fn largest_curvature(surface: &dyn Surface, samples: &[CurvatureSample], side: u32) -> f64 {
    let known = samples.iter().enumerate();
    let known = known.filter(|(_, (curvature, area))| curvature.is_finite() && area.is_finite());
    let Some((index, _)) = known.max_by(|a, b| a.1.0.abs().total_cmp(&b.1.0.abs())) else {
        return 0.0;
    };
    let domain = surface.domain();
    let inner = domain.map(|[low, high]| {
        let away = SIDES * (high - low);
        [low + away, high - away]
    });
    let mut steps = domain.map(|[low, high]| (high - low) / f64::from(side));
    let texel = [index % side as usize, index / side as usize];
    let mut at: [f64; 2] =
        std::array::from_fn(|k| domain[k][0] + (texel[k] as f64 + 0.5) * steps[k]);
    let mut most = samples[index].0.abs();
    for _ in 0..HALVINGS {
        for _ in 0..STEPS {
            let beside = AROUND.map(|by| {
                let place = |k: usize| (at[k] + by[k] * steps[k]).clamp(inner[k][0], inner[k][1]);
                let place = [place(0), place(1)];
                (gaussian_curvature(&surface.jet(place.into())).abs(), place)
            });
            let finite = beside.iter().filter(|(curvature, _)| curvature.is_finite());
            let best = finite.max_by(|a, b| a.0.total_cmp(&b.0));
            match best {
                Some(&(curvature, place)) if curvature > most => (most, at) = (curvature, place),
                _ => break,
            }
        }
        steps = steps.map(|step| 0.5 * step);
    }
    most
}

/// The directions of the search.
const AROUND: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [1.0, 1.0],
    [0.0, 1.0],
    [-1.0, 1.0],
    [-1.0, 0.0],
    [-1.0, -1.0],
    [0.0, -1.0],
    [1.0, -1.0],
];

/// Returns colours from blue (−1) over white (0) to red (1), sRGB: straight lines in Oklab (Björn Ottosson, "A perceptual
/// color space for image processing", 2020), so that equal steps look equally large.
fn diverging(t: f32) -> [u8; 3] {
    const WHITE: f32 = 0.97;
    const DARKEST: f32 = 0.47;
    const CHROMA: f32 = 0.17;
    // The hues of the ends in radians.
    let hue: f32 = if t < 0.0 { 4.55 } else { 0.50 };
    let share = t.abs();
    let lightness = WHITE + share * (DARKEST - WHITE);
    let (a, b) = (share * CHROMA * hue.cos(), share * CHROMA * hue.sin());
    let cone = [
        lightness + 0.396_337_78 * a + 0.215_803_76 * b,
        lightness - 0.105_561_35 * a - 0.063_854_17 * b,
        lightness - 0.089_484_18 * a - 1.291_485_5 * b,
    ];
    let [l, m, s] = cone.map(|x| x * x * x);
    [
        encode(4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s),
        encode(-1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s),
        encode(-0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::decode;

    /// Relative luminance.
    fn luminance(colour: [u8; 3]) -> f32 {
        let [r, g, b] = colour.map(decode);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn colours_darken_alike_on_both_sides_and_stay_within_what_a_screen_shows() {
        let scale = CurvatureScale {
            most: 2.0,
            is_clipped: false,
            is_flat: false,
        };
        assert_eq!(scale.colour(f64::NAN), UNDEFINED);
        assert_eq!(scale.colour(9.0), scale.colour(2.0));
        let [r, g, b] = scale.colour(0.0);
        assert!(r == g && g == b && r > 240, "{:?}", [r, g, b]);
        let mut last = luminance([r, g, b]);
        for step in 1..=20 {
            let value = f64::from(step) / 10.0;
            let (cold, warm) = (scale.colour(-value), scale.colour(value));
            assert!(cold[2] > cold[0] && warm[0] > warm[2]);
            let both = [cold, warm].map(luminance);
            assert!(both.iter().all(|&y| y < last), "at {value}");
            assert!((both[0] - both[1]).abs() < 0.05, "{both:?} at {value}");
            last = both[0].max(both[1]);
            // A clipped channel would bend the hue.
            assert!(
                cold.iter().chain(&warm).all(|&x| x > 0 && x < 255),
                "{cold:?} {warm:?}"
            );
        }
    }
}
