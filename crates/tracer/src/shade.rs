//! The light that comes along a ray.
//!
//! Input: a world, the looks of its faces, lights, a background. Output: linear light. At a face with the colour c:
//! k·c·ΣaC + Σ V·S·C·(falloff/r)²·(k·c·(n·l) + specular·(n·h)^shininess) + (m + gF)·R + g(1 − F)·T, where R and T are what
//! the reflected and the refracted ray see, F is Fresnel's share, and V the share that no face keeps from the light. That is
//! the look `geotrace`; `shade/crt.rs` has the light that the look `crt` takes from lights.

mod crt;

use glam::DVec3;

use crate::cast::{Caster, Crossing};
use crate::light::Light;
use crate::line::{Ray, SurfaceId};
use crate::look::PictureLook;
use crate::optics::{fresnel, reflected, refracted};
use crate::sheet::{SheetHit, SheetScratch};
use crate::sheets::{Sheets, SheetsRay};
use crate::world::World;

/// The look of a face at a place; colours are linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceLook {
    /// Its colour, c.
    pub color: DVec3,
    /// The share that is scattered, k; without one, what mirror and glass leave.
    pub diffuse: Option<f64>,
    /// The strength of the highlight.
    pub specular: f64,
    /// The sharpness of the highlight.
    pub shininess: f64,
    /// The share that is reflected, m, by colour.
    pub mirror: DVec3,
    /// The share that is reflected or refracted, g.
    pub glass: f64,
    /// The gradient of the height along the normal.
    pub bump: DVec3,
}

/// The glass that a solid is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// The refractive index.
    pub ior: f64,
    /// The length of glass that has the colour.
    pub depth: f64,
}

/// A place on a face that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// The distance along the ray, in units of its direction.
    pub t: f64,
    /// The place.
    pub position: DVec3,
    /// The unit normal on the side of the ray's start.
    pub normal: DVec3,
    /// The object that the face belongs to.
    pub of: FaceObject,
}

/// The object that a face belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaceObject {
    /// A solid.
    Solid {
        /// Its number in the world.
        solid: usize,
        /// The leaf whose surface it is, over all solids.
        leaf: usize,
        /// The surface.
        surface: SurfaceId,
        /// True where the ray enters.
        entering: bool,
    },
    /// A parametric surface.
    Sheet {
        /// Its number.
        sheet: usize,
        /// The parameters.
        uv: [f64; 2],
    },
}

/// All that is seen.
pub struct Scenery<'a> {
    /// The solids.
    pub world: &'a World,
    /// The parametric surfaces.
    pub sheets: &'a Sheets,
    /// The glass that each solid is of; `None`, also for those that are not listed, for none.
    pub glass: &'a [Option<Glass>],
    /// The look of a face.
    pub look: &'a (dyn Fn(&Face) -> FaceLook + Sync),
    /// The lights.
    pub lights: &'a [Light],
    /// The light that comes from a unit direction where nothing else is.
    pub background: &'a (dyn Fn(DVec3) -> DVec3 + Sync),
    /// The number of reflections and refractions that are followed. After them a ray sees the background, in the look `crt`
    /// nothing.
    pub bounces: u32,
    /// The formula by which faces are lit.
    pub picture_look: PictureLook,
    /// The sides from which the faces of each leaf are seen; leaves that are not listed are seen from both.
    pub sides: &'a [FaceSides],
}

/// The sides from which a face is seen, and casts shadows.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum FaceSides {
    /// From both.
    #[default]
    Both,
    /// From outside of its solid.
    Outer,
    /// From none.
    None,
}

/// Follows rays through a scenery; one for each thread.
pub struct LightTracer<'a> {
    scenery: &'a Scenery<'a>,
    caster: Caster<'a>,
    sheets: SheetScratch,
    /// The place on lights that have a size.
    light_sample: [f64; 2],
}

/// Glass around a ray.
#[derive(Clone, Copy, Debug)]
struct Medium {
    solid: usize,
    glass: Glass,
    /// The colour where the ray came in.
    color: DVec3,
}

/// The face that a ray starts on.
#[derive(Clone, Copy, Debug)]
enum PathStart {
    Free,
    /// On none, and of the bundle.
    Bundled,
    On(FaceObject),
}

/// A ray that is followed.
#[derive(Clone)]
struct LightPath {
    origin: DVec3,
    direction: DVec3,
    start: PathStart,
    weight: f64,
    /// The length of the way from the eye to the start.
    length: f64,
    bounces: u32,
    /// By declaration; the last one counts.
    media: Vec<Medium>,
}

impl Default for FaceLook {
    fn default() -> Self {
        Self {
            color: DVec3::ONE,
            diffuse: None,
            specular: 0.07,
            shininess: 40.0,
            mirror: DVec3::ZERO,
            glass: 0.0,
            bump: DVec3::ZERO,
        }
    }
}

impl Default for Glass {
    fn default() -> Self {
        Self {
            ior: 1.5,
            depth: 1.0,
        }
    }
}

impl<'a> LightTracer<'a> {
    /// Begins with a scenery.
    pub fn new(scenery: &'a Scenery<'a>) -> Self {
        Self {
            scenery,
            caster: scenery.world.caster(),
            sheets: SheetScratch::default(),
            light_sample: [0.5; 2],
        }
    }

    /// Reads these rays together, see [`Caster::begin_bundle`].
    pub fn begin_bundle(&mut self, rays: &[Ray]) {
        self.caster.begin_bundle(rays);
    }

    /// The light that comes to the start of the ray from its unit direction; `bundled` for a ray of the bundle, `sample` for
    /// the place on lights that have a size, two numbers from 0 to 1.
    pub fn light(&mut self, ray: &Ray, bundled: bool, sample: [f64; 2]) -> DVec3 {
        self.light_sample = sample;
        self.follow(LightPath {
            origin: ray.origin,
            direction: ray.direction,
            start: if bundled {
                PathStart::Bundled
            } else {
                PathStart::Free
            },
            weight: 1.0,
            length: 0.0,
            bounces: self.scenery.bounces,
            media: Vec::new(),
        })
    }

    /// The first face with t > 0.
    pub fn first(&mut self, ray: &Ray) -> Option<Face> {
        let mut crossings = Vec::new();
        self.nearest(ray.origin, ray.direction, PathStart::Free, &mut crossings)
    }

    /// Recurses no deeper than the number of bounces.
    fn follow(&mut self, mut path: LightPath) -> DVec3 {
        let mut crossings = Vec::new();
        let face = self.nearest(path.origin, path.direction, path.start, &mut crossings);
        if !matches!(path.start, PathStart::On(_)) {
            path.media = self.media_at_start();
        }
        let Some(face) = face else {
            return (self.scenery.background)(path.direction);
        };
        let kept = match path.media.last() {
            Some(medium) => {
                let exponent = face.t / medium.glass.depth;
                DVec3::from_array(medium.color.to_array().map(|c| c.powf(exponent)))
            }
            None => DVec3::ONE,
        };
        kept * self.seen(&path, &face, &crossings)
    }

    /// The glass around the start of the ray that has just been cast. Its colour is not known there.
    fn media_at_start(&self) -> Vec<Medium> {
        let solids = self.caster.solids_at_start().iter();
        let media = solids.filter_map(|&solid| {
            let glass = self.glass(solid)?;
            Some(Medium {
                solid,
                glass,
                color: DVec3::ONE,
            })
        });
        media.collect()
    }

    fn glass(&self, solid: usize) -> Option<Glass> {
        self.scenery.glass.get(solid).copied().flatten()
    }

    /// The first face of a ray; `crossings` receives those of solids at its place, if it is one of a solid.
    fn nearest(
        &mut self,
        origin: DVec3,
        direction: DVec3,
        start: PathStart,
        crossings: &mut Vec<Crossing>,
    ) -> Option<Face> {
        let ray = Ray {
            origin,
            direction,
            leaving: start.surface(),
        };
        let bundled = matches!(start, PathStart::Bundled);
        crossings.extend_from_slice(self.caster.nearest(&ray, bundled));
        let scenery = self.scenery;
        let is_seen = |found: &Crossing| scenery.is_seen(found);
        if !crossings.is_empty() && !crossings.iter().any(is_seen) {
            let all = self.caster.cast(&ray);
            let first = all.iter().find(|found| is_seen(found));
            let t = first.map(|first| first.t);
            crossings.clear();
            crossings.extend(all.iter().filter(|found| Some(found.t) == t));
        }
        let sheets = scenery.sheets;
        let mut reach = crossings.first().map_or(f64::INFINITY, |first| first.t);
        let mut found = None;
        let ray = SheetsRay {
            origin,
            direction,
            leaving: start.sheet(),
            reach,
        };
        sheets.cast(&mut self.sheets, ray, &mut |sheet, hit| {
            if hit.t < reach && scenery.sees(hit) {
                reach = hit.t;
                found = Some((sheet, *hit));
            }
            reach
        });
        if let Some((sheet, hit)) = found {
            crossings.clear();
            return Some(Face {
                t: hit.t,
                position: hit.position,
                normal: hit.normal,
                of: FaceObject::Sheet { sheet, uv: hit.uv },
            });
        }
        let seen = crossings.iter().find(|found| is_seen(found));
        seen.map(Face::from)
    }

    /// The light that leaves a face towards the start of the ray.
    fn seen(&mut self, path: &LightPath, face: &Face, crossings: &[Crossing]) -> DVec3 {
        let look = (self.scenery.look)(face).balanced();
        let direction = path.direction;
        let slope = look.bump - face.normal.dot(look.bump) * face.normal;
        let normal = (face.normal - slope).normalize_or(face.normal);
        let mut out = match self.scenery.picture_look {
            PictureLook::Geotrace => self.lit(&look, face, normal, direction),
            PictureLook::Crt => self.lit_crt(&look, face, normal, path),
        };
        let (mut mirror, mut through) = (look.mirror, DVec3::ZERO);
        let mut onward = None;
        if look.glass > 0.0 {
            if let FaceObject::Solid { .. } = face.of {
                let media = self.beyond(path, crossings, look.color);
                let index = |media: &[Medium]| media.last().map_or(1.0, |medium| medium.glass.ior);
                let (n1, n2) = (index(&path.media), index(&media));
                let cosine = (-normal.dot(direction)).clamp(0.0, 1.0);
                let share = fresnel(cosine, n1, n2);
                mirror += DVec3::splat(look.glass * share);
                onward = refracted(direction, normal, n1, n2).map(|direction| (direction, media));
                through = DVec3::splat(look.glass * (1.0 - share));
            } else {
                onward = Some((direction, path.media.clone()));
                through = look.glass * look.color;
            }
        }
        let go = |direction: DVec3, weight: f64, media: Vec<Medium>| LightPath {
            origin: face.position,
            direction,
            start: PathStart::On(face.of),
            weight: path.weight * weight,
            length: path.length + face.t,
            bounces: path.bounces.saturating_sub(1),
            media,
        };
        if mirror != DVec3::ZERO {
            let mut away = reflected(direction, normal);
            // Into the true face: reflected at it once more.
            if away.dot(face.normal) < 0.0 {
                away = reflected(away, face.normal);
            }
            let next = go(away, mirror.max_element(), path.media.clone());
            out += mirror * self.go_on(next, path.bounces);
        }
        if let Some((direction, media)) = onward
            && through != DVec3::ZERO
        {
            let next = go(direction, through.max_element(), media);
            out += through * self.go_on(next, path.bounces);
        }
        out
    }

    fn go_on(&mut self, next: LightPath, left: u32) -> DVec3 {
        let look = self.scenery.picture_look;
        if next.weight < look.least_weight() {
            return DVec3::ZERO;
        }
        match (left, look) {
            (0, PictureLook::Geotrace) => (self.scenery.background)(next.direction),
            (0, PictureLook::Crt) => DVec3::ZERO,
            _ => self.follow(next),
        }
    }

    /// Light from the lights.
    fn lit(&mut self, look: &FaceLook, face: &Face, normal: DVec3, direction: DVec3) -> DVec3 {
        let mut out = DVec3::ZERO;
        let left = (1.0 - look.mirror.max_element() - look.glass).max(0.0);
        let scattered = look.diffuse.unwrap_or(left) * look.color;
        for light in self.scenery.lights {
            out += scattered * light.ambient * light.color;
            let seen = light.from(face.position, self.light_sample, 0.0);
            let height = normal.dot(seen.towards);
            if height <= 0.0 || seen.share <= 0.0 {
                continue;
            }
            let visible = if light.casts_shadows {
                self.visible(face, seen.towards, seen.distance)
            } else {
                1.0
            };
            if visible == 0.0 {
                continue;
            }
            let highlight = if look.specular > 0.0 {
                let half = (seen.towards - direction).normalize_or_zero();
                look.specular * normal.dot(half).max(0.0).powf(look.shininess)
            } else {
                0.0
            };
            let shared = visible * seen.share;
            out += shared * (light.color * scattered * height + light.highlight * highlight);
        }
        out
    }

    /// The share of a light that the faces on the way let through, unbent.
    fn visible(&mut self, face: &Face, towards: DVec3, distance: f64) -> f64 {
        let start = PathStart::On(face.of);
        let ray = Ray {
            origin: face.position,
            direction: towards,
            leaving: start.surface(),
        };
        let look = self.scenery.look;
        let mut share = 1.0;
        let scenery = self.scenery;
        self.caster.each_before(&ray, distance, &mut |passed| {
            if scenery.is_seen(passed) {
                share *= look(&passed.into()).balanced().glass;
            }
            share != 0.0
        });
        let sheets = self.scenery.sheets;
        if share > 0.0 {
            let ray = SheetsRay {
                origin: face.position,
                direction: towards,
                leaving: start.sheet(),
                reach: distance,
            };
            sheets.cast(&mut self.sheets, ray, &mut |sheet, hit| {
                if scenery.sees(hit) {
                    let face = Face {
                        t: hit.t,
                        position: hit.position,
                        normal: hit.normal,
                        of: FaceObject::Sheet { sheet, uv: hit.uv },
                    };
                    share *= look(&face).balanced().glass;
                }
                // Behind what is opaque nothing changes.
                if share > 0.0 { distance } else { 0.0 }
            });
        }
        share
    }

    /// The glass behind the face.
    fn beyond(&self, path: &LightPath, crossings: &[Crossing], color: DVec3) -> Vec<Medium> {
        let mut media = path.media.clone();
        for crossing in crossings {
            let solid = crossing.solid;
            media.retain(|medium| medium.solid != solid);
            if crossing.entering
                && let Some(glass) = self.glass(solid)
            {
                media.push(Medium {
                    solid,
                    glass,
                    color,
                });
            }
        }
        media.sort_by_key(|medium| medium.solid);
        media
    }
}

impl Scenery<'_> {
    /// True if a ray that comes to a crossing sees the face there.
    fn is_seen(&self, crossing: &Crossing) -> bool {
        match self.sides.get(crossing.leaf) {
            None | Some(FaceSides::Both) => true,
            Some(FaceSides::Outer) => crossing.entering,
            Some(FaceSides::None) => false,
        }
    }

    /// True if a ray sees a parametric surface where it meets it: in the look `crt`, from the side to which σu×σv points.
    fn sees(&self, hit: &SheetHit) -> bool {
        self.picture_look == PictureLook::Geotrace || hit.is_front
    }
}

impl PathStart {
    fn surface(self) -> Option<SurfaceId> {
        match self {
            Self::On(FaceObject::Solid { surface, .. }) => Some(surface),
            _ => None,
        }
    }

    fn sheet(self) -> Option<(usize, [f64; 2])> {
        match self {
            Self::On(FaceObject::Sheet { sheet, uv }) => Some((sheet, uv)),
            _ => None,
        }
    }
}

impl From<&Crossing> for Face {
    fn from(crossing: &Crossing) -> Self {
        Self {
            t: crossing.t,
            position: crossing.position,
            normal: if crossing.entering {
                crossing.normal
            } else {
                -crossing.normal
            },
            of: FaceObject::Solid {
                solid: crossing.solid,
                leaf: crossing.leaf,
                surface: crossing.surface,
                entering: crossing.entering,
            },
        }
    }
}

impl Face {
    /// The unit normal that leads out of the solid; of a parametric surface, the one on the side of the ray's start.
    pub fn outward(&self) -> DVec3 {
        match self.of {
            FaceObject::Solid {
                entering: false, ..
            } => -self.normal,
            _ => self.normal,
        }
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
