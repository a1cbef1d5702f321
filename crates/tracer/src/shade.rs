//! The light that comes along a ray.
//!
//! Input: a world, the looks of its solids, lights, a background. Output: linear light. At a face with the colour c:
//! k·c·ΣaC + Σ V·S·C·(falloff/r)²·(k·c·(n·l) + specular·(n·h)^shininess) + (m + gF)·R + g(1 − F)·T, where R and T are what
//! the reflected and the refracted ray see, F is Fresnel's share, and V the share that no face keeps from the light.

use glam::DVec3;

use crate::cast::{Caster, Crossing};
use crate::light::Light;
use crate::line::Ray;
use crate::optics::{fresnel, reflected, refracted};
use crate::world::World;

/// The look of a face at a place; colours are linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceLook {
    /// Its colour, c.
    pub color: DVec3,
    /// The share that is scattered, k.
    pub diffuse: f64,
    /// The strength of the highlight.
    pub specular: f64,
    /// The sharpness of the highlight.
    pub shininess: f64,
    /// The share that is reflected, m, by colour.
    pub mirror: DVec3,
    /// The share that is reflected or refracted, g.
    pub glass: f64,
    /// The refractive index inside.
    pub ior: f64,
    /// The length of glass that has the colour.
    pub depth: f64,
    /// The gradient of the height along the normal.
    pub bump: DVec3,
}

/// All that is seen.
pub struct Scenery<'a> {
    /// The solids.
    pub world: &'a World,
    /// The look of a solid where a ray crosses its surface.
    pub look: &'a (dyn Fn(&Crossing) -> FaceLook + Sync),
    /// The lights.
    pub lights: &'a [Light],
    /// The light that comes from a unit direction where nothing else is.
    pub background: &'a (dyn Fn(DVec3) -> DVec3 + Sync),
    /// The number of reflections and refractions after which a ray sees the background.
    pub bounces: u32,
}

/// Follows rays through a scenery; one for each thread.
pub struct LightTracer<'a> {
    scenery: &'a Scenery<'a>,
    caster: Caster<'a>,
}

/// Glass around a ray.
#[derive(Clone, Copy, Debug)]
struct Medium {
    solid: usize,
    ior: f64,
    /// The share of light that is left after a length of 1, as exponents by colour.
    color: DVec3,
    depth: f64,
}

/// A ray that is followed.
#[derive(Clone)]
struct LightPath {
    ray: Ray,
    weight: f64,
    bounces: u32,
    /// By declaration; the last one counts.
    media: Vec<Medium>,
}

/// Rays of less weight add nothing.
const LEAST_WEIGHT: f64 = 1.0 / 1024.0;

impl Default for FaceLook {
    fn default() -> Self {
        Self {
            color: DVec3::ONE,
            diffuse: 1.0,
            specular: 0.07,
            shininess: 40.0,
            mirror: DVec3::ZERO,
            glass: 0.0,
            ior: 1.5,
            depth: 1.0,
            bump: DVec3::ZERO,
        }
    }
}

impl<'a> LightTracer<'a> {
    /// Begins with a scenery.
    pub fn new(scenery: &'a Scenery<'a>) -> Self {
        Self {
            scenery,
            caster: scenery.world.caster(),
        }
    }

    /// The light that comes to `origin` from the unit direction `direction`.
    pub fn light(&mut self, origin: DVec3, direction: DVec3) -> DVec3 {
        let ray = Ray {
            origin,
            direction,
            leaving: None,
        };
        self.follow(LightPath {
            ray,
            weight: 1.0,
            bounces: self.scenery.bounces,
            media: Vec::new(),
        })
    }

    /// Recurses no deeper than the number of bounces.
    fn follow(&mut self, path: LightPath) -> DVec3 {
        let direction = path.ray.direction;
        let crossings = self.caster.nearest(&path.ray).to_vec();
        let Some(crossing) = crossings.first() else {
            return (self.scenery.background)(direction);
        };
        let kept = match path.media.last() {
            Some(medium) => {
                let exponent = crossing.t / medium.depth;
                DVec3::from_array(medium.color.to_array().map(|c| c.powf(exponent)))
            }
            None => DVec3::ONE,
        };
        kept * self.face(&path, crossing, &crossings)
    }

    /// The light that leaves a face towards the start of the ray.
    fn face(&mut self, path: &LightPath, crossing: &Crossing, crossings: &[Crossing]) -> DVec3 {
        let look = (self.scenery.look)(crossing).balanced();
        let direction = path.ray.direction;
        let face = if crossing.entering {
            crossing.normal
        } else {
            -crossing.normal
        };
        let slope = look.bump - face.dot(look.bump) * face;
        let normal = (face - slope).normalize_or(face);
        let mut out = self.lit(&look, crossing, normal, direction);
        let (mut mirror, mut through) = (look.mirror, 0.0);
        let mut onward = None;
        if look.glass > 0.0 {
            let media = self.beyond(path, crossings);
            let index = |media: &[Medium]| media.last().map_or(1.0, |medium| medium.ior);
            let (n1, n2) = (index(&path.media), index(&media));
            let cosine = (-normal.dot(direction)).clamp(0.0, 1.0);
            let share = fresnel(cosine, n1, n2);
            mirror += DVec3::splat(look.glass * share);
            onward = refracted(direction, normal, n1, n2).map(|direction| (direction, media));
            through = look.glass * (1.0 - share);
        }
        let go = |ray: DVec3, weight: f64, media: Vec<Medium>| LightPath {
            ray: Ray {
                origin: crossing.position,
                direction: ray,
                leaving: Some(crossing.surface),
            },
            weight: path.weight * weight,
            bounces: path.bounces.saturating_sub(1),
            media,
        };
        if mirror != DVec3::ZERO {
            let mut away = reflected(direction, normal);
            // Into the true face: reflected at it once more.
            if away.dot(face) < 0.0 {
                away = reflected(away, face);
            }
            let next = go(away, mirror.max_element(), path.media.clone());
            out += mirror * self.go_on(next, path.bounces);
        }
        if let Some((direction, media)) = onward
            && through > 0.0
        {
            out += through * self.go_on(go(direction, through, media), path.bounces);
        }
        out
    }

    fn go_on(&mut self, next: LightPath, left: u32) -> DVec3 {
        if next.weight < LEAST_WEIGHT {
            return DVec3::ZERO;
        }
        if left == 0 {
            return (self.scenery.background)(next.ray.direction);
        }
        self.follow(next)
    }

    /// Light from the lights.
    fn lit(
        &mut self,
        look: &FaceLook,
        crossing: &Crossing,
        normal: DVec3,
        direction: DVec3,
    ) -> DVec3 {
        let mut out = DVec3::ZERO;
        let scattered = look.diffuse * look.color;
        for light in self.scenery.lights {
            out += scattered * light.ambient * light.color;
            let seen = light.from(crossing.position);
            let height = normal.dot(seen.towards);
            if height <= 0.0 || seen.share <= 0.0 {
                continue;
            }
            let visible = self.visible(crossing, seen.towards, seen.distance);
            if visible == 0.0 {
                continue;
            }
            let half = (seen.towards - direction).normalize_or_zero();
            let highlight = look.specular * normal.dot(half).max(0.0).powf(look.shininess);
            out += visible * seen.share * light.color * (scattered * height + highlight);
        }
        out
    }

    /// The share of a light that the faces on the way let through, unbent.
    fn visible(&mut self, crossing: &Crossing, towards: DVec3, distance: f64) -> f64 {
        let ray = Ray {
            origin: crossing.position,
            direction: towards,
            leaving: Some(crossing.surface),
        };
        let mut share = 1.0;
        for passed in self.caster.cast(&ray) {
            if passed.t >= distance || share == 0.0 {
                break;
            }
            share *= (self.scenery.look)(passed).balanced().glass;
        }
        share
    }

    /// The glass behind the face.
    fn beyond(&self, path: &LightPath, crossings: &[Crossing]) -> Vec<Medium> {
        let mut media = path.media.clone();
        for crossing in crossings {
            media.retain(|medium| medium.solid != crossing.solid);
            let look = (self.scenery.look)(crossing).balanced();
            if crossing.entering && look.glass > 0.0 {
                media.push(Medium {
                    solid: crossing.solid,
                    ior: look.ior,
                    color: look.color,
                    depth: look.depth,
                });
            }
        }
        media.sort_by_key(|medium| medium.solid);
        media
    }
}

impl FaceLook {
    /// Mirror and glass together are at most 1.
    fn balanced(mut self) -> Self {
        let sum = self.mirror.max_element() + self.glass;
        if sum > 1.0 {
            self.mirror /= sum;
            self.glass /= sum;
        }
        self
    }
}

/// An sRGB colour of linear light, as bytes.
pub fn encoded(light: DVec3) -> [u8; 3] {
    light.to_array().map(|x| {
        let x = if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) };
        let encoded = if x <= 0.003_130_8 {
            12.92 * x
        } else {
            1.055 * x.powf(1.0 / 2.4) - 0.055
        };
        (255.0 * encoded).round() as u8
    })
}
