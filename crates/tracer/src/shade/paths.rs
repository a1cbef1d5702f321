//! Paths of light, a bundle at a time.
//!
//! Input: rays that start near each other and go nearly the same way. Output: the light that comes along each. All paths of a
//! bundle come to their first faces, then one light after another is looked at from all faces, then all are followed on from
//! mirrors, then from glass. So each step casts rays that go nearly the same way again, and what none of them meets is left
//! out at once. The light along a ray does not depend on the others.

use glam::DVec3;

use crate::cast::{Caster, Crossing};
use crate::light::{Light, SeenLight};
use crate::line::{Ray, SurfaceId};
use crate::look::PictureLook;
use crate::optics::{fresnel, reflected, refracted};
use crate::shade::crt::{self, PARALLEL_REACH};
use crate::shade::{Face, FaceLook, FaceObject, Glass, Scenery};
use crate::sheet::SheetScratch;
use crate::sheets::SheetsRay;

/// Follows rays through a scenery; one for each thread.
pub struct LightTracer<'a> {
    scenery: &'a Scenery<'a>,
    caster: Caster<'a>,
    sheets: SheetScratch,
    crossings: Vec<Crossing>,
}

/// Glass around a ray.
#[derive(Clone, Copy, Debug)]
struct Medium {
    solid: usize,
    glass: Glass,
    /// The colour where the ray came in.
    color: DVec3,
}

/// A ray that is followed.
struct LightPath {
    ray: Ray,
    /// The face that it starts on.
    start: Option<FaceObject>,
    weight: f64,
    /// The length of the way from the eye to the start.
    length: f64,
    bounces: u32,
    /// By declaration; the last one counts.
    media: Vec<Medium>,
    /// The place on lights that have a size, two numbers from 0 to 1.
    light_sample: [f64; 2],
}

/// A face that a path comes to.
struct MetFace {
    /// The number of the path.
    path: usize,
    face: Face,
    look: FaceLook,
    /// The bumped normal.
    normal: DVec3,
    /// The share of the light that the glass on the way keeps.
    kept: DVec3,
    /// The shares of what is seen in the face and through it.
    mirror: DVec3,
    through: DVec3,
    /// The direction behind the face, and the glass there.
    onward: Option<(DVec3, Vec<Medium>)>,
    /// The light that leaves it towards the start of the path, as far as it is known.
    out: DVec3,
}

/// A face that lights shine on.
struct LitFace {
    position: DVec3,
    normal: DVec3,
    /// The colour of what it scatters, times the share.
    scattered: DVec3,
    light_sample: [f64; 2],
    out: DVec3,
}

/// A light that a face is turned to.
struct FacedLight {
    /// The number of the face.
    face: usize,
    seen: SeenLight,
    /// The cosine between the light and the normal.
    height: f64,
}

/// The surface that a ray leaves: a piece of a leaf, or a parametric surface.
type LeftSurface = Option<(Option<SurfaceId>, usize)>;

impl<'a> LightTracer<'a> {
    /// Begins with a scenery.
    pub fn new(scenery: &'a Scenery<'a>) -> Self {
        Self {
            scenery,
            caster: scenery.world.caster(),
            sheets: SheetScratch::default(),
            crossings: Vec::new(),
        }
    }

    /// The light that comes to the start of the ray from its unit direction; `sample` is the place on lights that have a
    /// size, two numbers from 0 to 1.
    pub fn light(&mut self, ray: &Ray, sample: [f64; 2]) -> DVec3 {
        let light = self.lights(&[*ray], &[sample]);
        light.first().copied().unwrap_or_default()
    }

    /// The light that comes to the start of each ray, as [`LightTracer::light`] has it, in less time the nearer the rays are
    /// to each other.
    pub fn lights(&mut self, rays: &[Ray], samples: &[[f64; 2]]) -> Vec<DVec3> {
        let paths = rays.iter().zip(samples);
        let paths: Vec<LightPath> = paths
            .map(|(ray, &light_sample)| LightPath {
                ray: *ray,
                start: None,
                weight: 1.0,
                length: 0.0,
                bounces: self.scenery.bounces,
                media: Vec::new(),
                light_sample,
            })
            .collect();
        self.follow(paths)
    }

    /// The first face with t > 0.
    pub fn first(&mut self, ray: &Ray) -> Option<Face> {
        self.caster
            .begin_near(std::iter::once(*ray), f64::INFINITY, None);
        self.nearest(0, ray, None)
    }

    /// The light along each path. Recurses no deeper than the number of bounces.
    fn follow(&mut self, mut paths: Vec<LightPath>) -> Vec<DVec3> {
        let mut light = vec![DVec3::ZERO; paths.len()];
        let mut faces = self.met_faces(&mut paths, &mut light);
        // Paths that leave one surface follow each other.
        faces.sort_by_key(|met| left_surface(Some(&met.face.of)));
        self.add_lights(&paths, &mut faces);
        self.go_on(
            &paths,
            &mut faces,
            |met| met.mirror,
            |path, met| {
                let (direction, face) = (path.ray.direction, &met.face);
                let mut away = reflected(direction, met.normal);
                // Into the true face: reflected at it once more.
                if away.dot(face.normal) < 0.0 {
                    away = reflected(away, face.normal);
                }
                Some((away, path.media.clone()))
            },
        );
        self.go_on(
            &paths,
            &mut faces,
            |met| met.through,
            |_, met| met.onward.take(),
        );
        for met in faces {
            light[met.path] = met.kept * met.out;
        }
        light
    }

    /// The first faces of paths; for those that meet none, `light` receives the background.
    fn met_faces(&mut self, paths: &mut [LightPath], light: &mut [DVec3]) -> Vec<MetFace> {
        let mut faces = Vec::with_capacity(paths.len());
        let mut number = 0;
        for run in paths
            .chunk_by_mut(|a, b| left_surface(a.start.as_ref()) == left_surface(b.start.as_ref()))
        {
            let leaving = run[0].ray.leaving;
            let rays = run.iter().map(|path| path.ray);
            self.caster.begin_near(rays, f64::INFINITY, leaving);
            if run[0].start.is_none() && run.len() > 1 {
                self.caster.divide_fields();
            }
            for (k, path) in run.iter_mut().enumerate() {
                let face = self.nearest(k, &path.ray, path.start.as_ref());
                if path.start.is_none() {
                    path.media = self.media_at_start();
                }
                match face {
                    Some(face) => faces.push(self.met_face(path, number, face)),
                    None => light[number] = (self.scenery.background)(path.ray.direction),
                }
                number += 1;
            }
        }
        faces
    }

    /// The look of the face that a path has just come to, with the shares of light that go on from there.
    fn met_face(&mut self, path: &LightPath, number: usize, face: Face) -> MetFace {
        let kept = match path.media.last() {
            Some(medium) => {
                let exponent = face.t / medium.glass.depth;
                DVec3::from_array(medium.color.to_array().map(|c| c.powf(exponent)))
            }
            None => DVec3::ONE,
        };
        let look = (self.scenery.look)(&face).balanced();
        let direction = path.ray.direction;
        let slope = look.bump - face.normal.dot(look.bump) * face.normal;
        let normal = (face.normal - slope).normalize_or(face.normal);
        let (mut mirror, mut through) = (look.mirror, DVec3::ZERO);
        let mut onward = None;
        if look.glass > 0.0 {
            if let FaceObject::Solid { .. } = face.of {
                let media = self.beyond(path, look.color);
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
        MetFace {
            path: number,
            face,
            look,
            normal,
            kept,
            mirror,
            through,
            onward,
            out: DVec3::ZERO,
        }
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

    /// The first face of the ray with this index in the caster's bundle; `crossings` receives those of solids at its place, if it is one of a
    /// solid.
    fn nearest(&mut self, index: usize, ray: &Ray, start: Option<&FaceObject>) -> Option<Face> {
        let Self {
            scenery,
            caster,
            sheets: scratch,
            crossings,
            ..
        } = self;
        let scenery = *scenery;
        crossings.clear();
        crossings.extend_from_slice(caster.nearest(index));
        let is_seen = |found: &Crossing| scenery.is_seen(found);
        if !crossings.is_empty() && !crossings.iter().any(is_seen) {
            let all = caster.cast(ray);
            let first = all.iter().find(|found| is_seen(found));
            let t = first.map(|first| first.t);
            crossings.clear();
            crossings.extend(all.iter().filter(|found| Some(found.t) == t));
        }
        if scenery.sheets.is_empty() {
            return crossings
                .iter()
                .find(|found| is_seen(found))
                .map(Face::from);
        }
        let mut reach = crossings.first().map_or(f64::INFINITY, |first| first.t);
        let mut found = None;
        let ray = SheetsRay {
            origin: ray.origin,
            direction: ray.direction,
            leaving: start.and_then(FaceObject::sheet),
            reach,
        };
        scenery.sheets.cast(scratch, ray, &mut |sheet, hit| {
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

    /// Adds what comes to the faces from lights.
    fn add_lights(&mut self, paths: &[LightPath], faces: &mut [MetFace]) {
        let scenery = self.scenery;
        // Each light reads no more than this of a face.
        let mut lit: Vec<LitFace> = faces
            .iter()
            .map(|met| LitFace {
                position: met.face.position,
                normal: met.normal,
                scattered: met.scattered(),
                light_sample: paths[met.path].light_sample,
                out: met.out,
            })
            .collect();
        let mut faced: Vec<FacedLight> = Vec::with_capacity(faces.len());
        for light in scenery.lights {
            faced.clear();
            for (k, lit) in lit.iter_mut().enumerate() {
                let length = match scenery.picture_look {
                    PictureLook::Geotrace => {
                        lit.out += lit.scattered * light.ambient * light.color;
                        0.0
                    }
                    PictureLook::Crt => {
                        let met = &faces[k];
                        lit.out += crt::ambient(&met.look, light);
                        paths[met.path].length + met.face.t
                    }
                };
                let seen = light.from(lit.position, lit.light_sample, length);
                let height = lit.normal.dot(seen.towards);
                if height > 0.0 && seen.share > 0.0 {
                    faced.push(FacedLight {
                        face: k,
                        seen,
                        height,
                    });
                }
            }
            let surface = |faced: &FacedLight| left_surface(Some(&faces[faced.face].face.of));
            for run in faced.chunk_by(|a, b| surface(a) == surface(b)) {
                self.add_light(light, run, paths, faces, &mut lit);
            }
        }
        for (met, lit) in faces.iter_mut().zip(lit) {
            met.out = lit.out;
        }
    }

    /// Adds the light to the faces of a run, which leave one surface.
    fn add_light(
        &mut self,
        light: &Light,
        run: &[FacedLight],
        paths: &[LightPath],
        faces: &[MetFace],
        lit: &mut [LitFace],
    ) {
        let picture_look = self.scenery.picture_look;
        let reach = |seen: &SeenLight| match picture_look {
            PictureLook::Crt if !seen.distance.is_finite() => PARALLEL_REACH,
            _ => seen.distance,
        };
        if light.casts_shadows {
            let leaving = faces[run[0].face].face.of.surface();
            let rays = run.iter().map(|faced| Ray {
                origin: lit[faced.face].position,
                direction: faced.seen.towards,
                leaving,
            });
            let reaches = run.iter().map(|faced| reach(&faced.seen));
            let reach = reaches.fold(0.0, f64::max);
            self.caster.begin_near(rays, reach, leaving);
        }
        let is_free = self.caster.bundle_is_free() && self.scenery.sheets.is_empty();
        for (k, faced) in run.iter().enumerate() {
            let met = &faces[faced.face];
            let visible = if light.casts_shadows && !is_free {
                let ray = SheetsRay {
                    origin: lit[faced.face].position,
                    direction: faced.seen.towards,
                    leaving: met.face.of.sheet(),
                    reach: reach(&faced.seen),
                };
                self.visible(k, ray)
            } else {
                1.0
            };
            if visible == 0.0 {
                continue;
            }
            let direction = paths[met.path].ray.direction;
            let FacedLight { seen, height, .. } = faced;
            let lit = &mut lit[faced.face];
            lit.out += match picture_look {
                PictureLook::Geotrace => {
                    let highlight = if met.look.specular > 0.0 {
                        met.highlight(seen.towards, direction)
                    } else {
                        0.0
                    };
                    let shared = visible * seen.share;
                    let scattered = light.color * lit.scattered * *height;
                    shared * (scattered + light.highlight * highlight)
                }
                PictureLook::Crt => crt::lit(
                    &met.look, light, seen, *height, visible, met.normal, direction,
                ),
            };
        }
    }

    /// The share of a light that the faces on the way let through, unbent; the ray is that with this index in the caster's
    /// bundle.
    fn visible(&mut self, index: usize, ray: SheetsRay) -> f64 {
        let scenery = self.scenery;
        let look = scenery.look;
        let distance = ray.reach;
        let known = self.caster.known_before(index, distance);
        if let Some(passed) = known
            && scenery.is_seen(&passed)
            && look(&(&passed).into()).balanced().glass == 0.0
        {
            return 0.0;
        }
        let mut share = 1.0;
        self.caster.each_before(index, distance, &mut |passed| {
            if scenery.is_seen(passed) {
                share *= look(&passed.into()).balanced().glass;
            }
            share != 0.0
        });
        if share > 0.0 {
            scenery
                .sheets
                .cast(&mut self.sheets, ray, &mut |sheet, hit| {
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

    /// Adds `share` of what is seen from the faces along the directions that `next` gives, with the glass there.
    fn go_on(
        &mut self,
        paths: &[LightPath],
        faces: &mut [MetFace],
        share: impl Fn(&MetFace) -> DVec3,
        next: impl Fn(&LightPath, &mut MetFace) -> Option<(DVec3, Vec<Medium>)>,
    ) {
        let scenery = self.scenery;
        let (mut onward, mut numbers) = (Vec::new(), Vec::new());
        for (k, met) in faces.iter_mut().enumerate() {
            let part = share(met);
            if part == DVec3::ZERO {
                continue;
            }
            let path = &paths[met.path];
            let Some((direction, media)) = next(path, met) else {
                continue;
            };
            let weight = path.weight * part.max_element();
            if weight < scenery.picture_look.least_weight() {
                continue;
            }
            match (path.bounces, scenery.picture_look) {
                (0, PictureLook::Geotrace) => met.out += part * (scenery.background)(direction),
                (0, PictureLook::Crt) => {}
                _ => {
                    numbers.push(k);
                    onward.push(LightPath {
                        ray: Ray {
                            origin: met.face.position,
                            direction,
                            leaving: met.face.of.surface(),
                        },
                        start: Some(met.face.of),
                        weight,
                        length: path.length + met.face.t,
                        bounces: path.bounces - 1,
                        media,
                        light_sample: path.light_sample,
                    });
                }
            }
        }
        if onward.is_empty() {
            return;
        }
        let light = self.follow(onward);
        for (k, light) in numbers.into_iter().zip(light) {
            let part = share(&faces[k]);
            faces[k].out += part * light;
        }
    }

    /// The glass behind the face that a path has just come to.
    fn beyond(&self, path: &LightPath, color: DVec3) -> Vec<Medium> {
        let mut media = path.media.clone();
        for crossing in &self.crossings {
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

impl MetFace {
    /// The colour of what it scatters, times the share.
    fn scattered(&self) -> DVec3 {
        let look = &self.look;
        look.scattered() * look.color
    }

    /// The highlight of light from `towards` that leaves against `direction`.
    fn highlight(&self, towards: DVec3, direction: DVec3) -> f64 {
        let half = (towards - direction).normalize_or_zero();
        self.look.specular * self.normal.dot(half).max(0.0).powf(self.look.shininess)
    }
}

impl FaceObject {
    fn surface(&self) -> Option<SurfaceId> {
        match *self {
            Self::Solid { surface, .. } => Some(surface),
            Self::Sheet { .. } => None,
        }
    }

    fn sheet(&self) -> Option<(usize, [f64; 2])> {
        match *self {
            Self::Sheet { sheet, uv } => Some((sheet, uv)),
            Self::Solid { .. } => None,
        }
    }
}

fn left_surface(start: Option<&FaceObject>) -> LeftSurface {
    start.map(|of| match *of {
        FaceObject::Solid { leaf, surface, .. } => (Some(surface), leaf),
        FaceObject::Sheet { sheet, .. } => (None, sheet),
    })
}
