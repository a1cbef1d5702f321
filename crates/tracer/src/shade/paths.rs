//! Paths of light, a bundle at a time.
//!
//! Input: rays that start near each other and go nearly the same way. Output: the light that comes along each. All paths of a
//! bundle come to their first faces, then one light after another is looked at from all faces, then all are followed on from
//! mirrors, then from glass. So each step casts rays that go nearly the same way again, and what none of them meets is left
//! out at once. The light along a ray does not depend on the others.

use expr::processor::Processor;
use glam::DVec3;

use crate::cast::Caster;
use crate::line::{Ray, SurfaceId};
use crate::look::PictureLook;
use crate::optics::{fresnel, reflected, refracted};
use crate::shade::lights::LitFaces;
use crate::shade::{Face, FaceLook, FaceObject, Glass, Scenery};
use crate::sheet::SheetScratch;
use crate::sheets::SheetsRay;

/// Follows rays through a scenery; one for each thread.
pub struct LightTracer<'a> {
    pub(super) scenery: &'a Scenery<'a>,
    pub(super) processor: Processor,
    pub(super) caster: Caster<'a>,
    pub(super) sheets: SheetScratch,
    pub(super) lit: LitFaces,
    /// The work on lights so far, in operations.
    pub(super) operations: u64,
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
pub(super) struct LightPath {
    pub(super) ray: Ray,
    /// The face that it starts on.
    start: Option<FaceObject>,
    weight: f64,
    /// The length of the way from the eye to the start.
    pub(super) length: f64,
    bounces: u32,
    /// By declaration; the last one counts.
    media: Vec<Medium>,
    /// The place on lights that have a size, two numbers from 0 to 1.
    pub(super) light_sample: [f64; 2],
}

/// A face that a path comes to.
pub(super) struct MetFace {
    /// The number of the path.
    pub(super) path: usize,
    pub(super) face: Face,
    pub(super) look: FaceLook,
    /// The bumped normal.
    pub(super) normal: DVec3,
    /// The share of the light that the glass on the way keeps.
    kept: DVec3,
    /// The shares of what is seen in the face and through it.
    mirror: DVec3,
    through: DVec3,
    /// The direction behind the face, and the glass there.
    onward: Option<(DVec3, Vec<Medium>)>,
    /// The light that leaves it towards the start of the path, as far as it is known.
    pub(super) out: DVec3,
}

/// The number of a surface: of a parametric surface, or of a piece of a leaf.
pub(super) type SurfaceNumber = u64;

impl LightPath {
    /// The surface that the ray leaves, if it starts on one.
    fn left_surface(&self) -> Option<SurfaceNumber> {
        self.start.as_ref().map(FaceObject::surface_number)
    }
}

impl<'a> LightTracer<'a> {
    /// Begins with a scenery.
    pub fn new(scenery: &'a Scenery<'a>) -> Self {
        Self {
            scenery,
            processor: Processor::here(),
            caster: scenery.world.caster(),
            lit: LitFaces::default(),
            sheets: SheetScratch::default(),
            operations: 0,
        }
    }

    /// The processor that this runs on.
    pub(crate) fn processor(&self) -> Processor {
        self.processor
    }

    /// Begins a tile of a picture, as [`Caster::begin_tile`] does.
    pub fn begin_tile(&mut self, rays: usize) {
        self.caster.begin_tile(rays);
    }

    /// The work so far, in operations, as [`Caster::operations`].
    pub fn operations(&self) -> u64 {
        self.operations + self.caster.operations() + self.sheets.operations
    }

    /// The number of rays so far that took more work than there may be.
    pub fn rays_cut_short(&self) -> u64 {
        self.caster.rays_cut_short()
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
        self.caster.begin(None).push(ray.origin, ray.direction);
        self.caster.find_near(f64::INFINITY);
        self.nearest(0, ray, None)
    }

    /// The light along each path. Recurses no deeper than the number of bounces.
    fn follow(&mut self, mut paths: Vec<LightPath>) -> Vec<DVec3> {
        let mut light = vec![DVec3::ZERO; paths.len()];
        let mut faces = self.met_faces(&mut paths, &mut light);
        // Paths that leave one surface follow each other. The faces stay where they are: each is large.
        let surfaces = faces.iter().map(|met| met.face.of.surface_number());
        let mut by_surface: Vec<_> = surfaces.zip(0..).collect();
        by_surface.sort_unstable();
        self.add_lights(&paths, &mut faces, &by_surface);
        self.go_on(
            &paths,
            &mut faces,
            &by_surface,
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
            &by_surface,
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
        for run in paths.chunk_by_mut(|a, b| a.left_surface() == b.left_surface()) {
            let leaving = run[0].ray.leaving;
            let rays = self.caster.begin(leaving);
            for path in run.iter() {
                rays.push(path.ray.origin, path.ray.direction);
            }
            self.caster.find_near(f64::INFINITY);
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
        let normal = if look.bump == DVec3::ZERO {
            face.normal
        } else {
            let slope = look.bump - face.normal.dot(look.bump) * face.normal;
            (face.normal - slope).normalize_or(face.normal)
        };
        let (mut mirror, mut through) = (look.mirror, DVec3::ZERO);
        let mut onward = None;
        if look.glass > 0.0 {
            if let FaceObject::Solid { .. } = face.of {
                let media = self.beyond(path, face.t, look.color);
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

    /// The first face of the ray with this index in the caster's bundle; if it is one of a solid, the caster has the crossings
    /// at its place.
    fn nearest(&mut self, index: usize, ray: &Ray, start: Option<&FaceObject>) -> Option<Face> {
        let Self {
            scenery,
            caster,
            sheets: scratch,
            ..
        } = self;
        let scenery = *scenery;
        let mut crossings = caster.nearest(index);
        let mut seen = crossings.iter().find(|found| scenery.is_seen(found));
        if seen.is_none() && !crossings.is_empty() {
            crossings = caster.cast(ray);
            seen = crossings.iter().find(|found| scenery.is_seen(found));
        }
        if scenery.sheets.is_empty() {
            return seen.map(Face::from);
        }
        let mut reach = seen.map_or(f64::INFINITY, |seen| seen.t);
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
        match found {
            Some((sheet, hit)) => Some(Face {
                t: hit.t,
                position: hit.position,
                normal: hit.normal,
                of: FaceObject::Sheet { sheet, uv: hit.uv },
            }),
            None => seen.map(Face::from),
        }
    }

    /// Adds `share` of what is seen from the faces along the directions that `next` gives, with the glass there.
    fn go_on(
        &mut self,
        paths: &[LightPath],
        faces: &mut [MetFace],
        by_surface: &[(SurfaceNumber, usize)],
        share: impl Fn(&MetFace) -> DVec3,
        next: impl Fn(&LightPath, &mut MetFace) -> Option<(DVec3, Vec<Medium>)>,
    ) {
        let scenery = self.scenery;
        let (mut onward, mut numbers) = (Vec::new(), Vec::new());
        for &(_, k) in by_surface {
            let met = &mut faces[k];
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

    /// The glass behind the face at `t` that a path has just come to.
    fn beyond(&self, path: &LightPath, t: f64, color: DVec3) -> Vec<Medium> {
        let mut media = path.media.clone();
        let crossings = self.caster.crossings().iter();
        for crossing in crossings.filter(|crossing| crossing.t == t) {
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
    pub(super) fn scattered(&self) -> DVec3 {
        let look = &self.look;
        look.scattered() * look.color
    }

    /// The highlight of light from `towards` that leaves against `direction`.
    pub(super) fn highlight(&self, towards: DVec3, direction: DVec3) -> f64 {
        let half = (towards - direction).normalize_or_zero();
        self.look.specular * self.normal.dot(half).max(0.0).powf(self.look.shininess)
    }
}

impl FaceObject {
    fn surface_number(&self) -> SurfaceNumber {
        const SOLIDS: SurfaceNumber = 1 << 63;
        match *self {
            Self::Sheet { sheet, .. } => sheet as SurfaceNumber,
            // There are less than 2³¹ leaves.
            Self::Solid { surface, .. } => {
                SOLIDS | u64::from(surface.leaf) << 32 | u64::from(surface.piece)
            }
        }
    }

    pub(super) fn surface(&self) -> Option<SurfaceId> {
        match *self {
            Self::Solid { surface, .. } => Some(surface),
            Self::Sheet { .. } => None,
        }
    }

    pub(super) fn sheet(&self) -> Option<(usize, [f64; 2])> {
        match *self {
            Self::Sheet { sheet, uv } => Some((sheet, uv)),
            Self::Solid { .. } => None,
        }
    }
}
