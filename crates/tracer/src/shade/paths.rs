//! Paths of light, a bundle at a time.
//!
//! Input: rays that start near each other and go nearly the same way. Output: the light that comes along each. All paths of a
//! bundle come to their first faces, then one light after another is evaluated at all faces, then all are followed on from
//! mirrors, then from glass. So each step casts rays that go nearly the same way again, and what none of them meets is left
//! out at once. The light along a ray does not depend on the others.

use expr::processor::Processor;
use glam::DVec3;

use crate::cast::{Caster, Crossing};
use crate::line::{Ray, SurfaceId};
use crate::look::PictureLook;
use crate::optics::{fresnel, reflected, refracted};
use crate::shade::crt;
use crate::shade::lights::LitFaces;
use crate::shade::{Face, FaceLook, FaceObject, Glass, Scenery};
use crate::sheet::SheetScratch;
use crate::sheets::SheetsRay;

/// A parametric surface lies on the face of a solid where a ray meets both within this share of the distances: roots are
/// exact to that.
const FLUSH: f64 = 1e-10;

/// Follows rays through a scenery; one for each thread.
pub struct LightTracer<'a> {
    pub(super) scenery: &'a Scenery<'a>,
    pub(super) processor: Processor,
    pub(super) caster: Caster<'a>,
    pub(super) sheets: SheetScratch,
    pub(super) lit: LitFaces,
    /// The light that comes from everywhere.
    ambient: DVec3,
    /// The work on lights so far, in operations.
    pub(super) operations: u64,
}

/// Glass around a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Medium {
    solid: usize,
    glass: Glass,
    /// The colour where the ray came in.
    pub(super) colour: DVec3,
}

/// A parametric surface, with the parameters of a place on it.
type SheetPlace = (usize, [f64; 2]);

/// The surfaces that rays leave at a face: its own, and those that are flush with it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Start {
    /// The surface of a solid.
    pub(super) surface: Option<SurfaceId>,
    /// The parametric surface.
    pub(super) sheet: Option<SheetPlace>,
}

/// The place on lights, and the cone, of a ray from the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeSample {
    /// The place on lights that have a size, two numbers from 0 to 1.
    pub light: [f64; 2],
    /// The angle of the cone of rays for which it stands, in radians: images are averaged over what that cone meets. With 0 the
    /// ray stands for itself.
    pub spread: f64,
}

impl Default for EyeSample {
    /// The middles of lights, and the ray itself.
    fn default() -> Self {
        Self {
            light: [0.5; 2],
            spread: 0.0,
        }
    }
}

/// A ray that is followed.
pub(super) struct LightPath {
    pub(super) ray: Ray,
    /// The angle of the cone for which it stands; 0 after a face.
    spread: f64,
    start: Start,
    weight: f64,
    /// The length of the way from the eye to the start.
    pub(super) length: f64,
    bounces: u32,
    /// By declaration; the last one counts.
    pub(super) media: Vec<Medium>,
    /// The place on lights that have a size, two numbers from 0 to 1.
    pub(super) light_sample: [f64; 2],
}

/// A face that a path comes to.
pub(super) struct MetFace {
    /// The number of the path.
    pub(super) path: usize,
    /// The distance from the start of the path.
    pub(super) t: f64,
    pub(super) position: DVec3,
    /// The unit normal on the side of the path's start, and the bumped one.
    true_normal: DVec3,
    pub(super) normal: DVec3,
    pub(super) start: Start,
    /// The share of light that it scatters, by colour.
    pub(super) scattered: DVec3,
    /// The strength of the highlight by colour, and its sharpness.
    pub(super) specular: DVec3,
    pub(super) shininess: f64,
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

/// The numbers of what rays leave: of a piece of a leaf, and of a parametric surface; 0 for none.
pub(super) type SurfaceNumber = [u64; 2];

impl Start {
    pub(super) fn number(&self) -> SurfaceNumber {
        // There are less than 2³¹ leaves.
        let surface = |it: SurfaceId| 1 + (u64::from(it.leaf) << 32 | u64::from(it.piece));
        let sheet = |(sheet, _)| 1 + sheet as u64;
        [self.surface.map_or(0, surface), self.sheet.map_or(0, sheet)]
    }

    /// True for the eye.
    fn is_nowhere(&self) -> bool {
        self.surface.is_none() && self.sheet.is_none()
    }
}

/// The share of light that is left after a way of this length within the last of some media.
pub(super) fn kept(media: &[Medium], length: f64) -> DVec3 {
    match media.last() {
        Some(medium) if medium.colour != DVec3::ONE => {
            let exponent = length / medium.glass.depth;
            let share = |c: f64| c.powf(exponent).min(f64::MAX);
            DVec3::from_array(medium.colour.to_array().map(share))
        }
        _ => DVec3::ONE,
    }
}

/// The parameters between which a parametric surface is flush with a face at `t` on a ray from `origin`.
pub(super) fn flush_with(t: f64, origin: DVec3) -> [f64; 2] {
    let error = FLUSH * (t + origin.abs().max_element());
    [t - error, t + error]
}

impl<'a> LightTracer<'a> {
    /// Begins with a scenery.
    pub fn new(scenery: &'a Scenery<'a>) -> Self {
        let lights = scenery.lights.iter();
        let ambient = lights.map(|light| light.ambient * light.colour);
        Self {
            scenery,
            processor: Processor::here(),
            caster: scenery.world.caster(),
            lit: LitFaces::default(),
            ambient: ambient.sum(),
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

    /// Those of the operations whose outcome is kept: other rays do not take them again.
    pub(crate) fn operations_once(&self) -> u64 {
        self.sheets.once
    }

    /// The number of rays so far that took more work than there may be.
    pub fn rays_cut_short(&self) -> u64 {
        self.caster.rays_cut_short()
    }

    /// The light that comes to the start of the ray from its unit direction.
    pub fn light(&mut self, ray: &Ray, sample: EyeSample) -> DVec3 {
        let light = self.lights(&[*ray], &[sample]);
        light.first().copied().unwrap_or_default()
    }

    /// The light that comes to the start of each ray, as [`LightTracer::light`] has it, in less time the nearer the rays are
    /// to each other.
    pub fn lights(&mut self, rays: &[Ray], samples: &[EyeSample]) -> Vec<DVec3> {
        let paths = rays.iter().zip(samples);
        let paths: Vec<LightPath> = paths
            .map(|(ray, sample)| LightPath {
                ray: *ray,
                spread: sample.spread,
                start: Start::default(),
                weight: 1.0,
                length: 0.0,
                bounces: self.scenery.bounces,
                media: Vec::new(),
                light_sample: sample.light,
            })
            .collect();
        self.follow(paths)
    }

    /// The first face with t > 0.
    pub fn first(&mut self, ray: &Ray) -> Option<Face> {
        self.caster.begin(None).push(ray.origin, ray.direction);
        self.caster.find_near(f64::INFINITY);
        let (face, _) = self.nearest(0, ray, Start::default())?;
        Some(face)
    }

    /// The light along each path. Recurses no deeper than the number of bounces.
    fn follow(&mut self, mut paths: Vec<LightPath>) -> Vec<DVec3> {
        let mut light = vec![DVec3::ZERO; paths.len()];
        let mut faces = self.met_faces(&mut paths, &mut light);
        // Paths that leave one surface follow each other. The faces stay where they are: each is large.
        let surfaces = faces.iter().map(|met| met.start.number());
        let mut by_surface: Vec<_> = surfaces.zip(0..).collect();
        by_surface.sort_unstable();
        self.add_lights(&paths, &mut faces, &by_surface);
        self.go_on(
            &paths,
            &mut faces,
            &by_surface,
            |met| met.mirror,
            |path, met| {
                let mut away = reflected(path.ray.direction, met.normal);
                // Into the true face: reflected at it once more.
                if away.dot(met.true_normal) < 0.0 {
                    away = reflected(away, met.true_normal);
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
        for run in paths.chunk_by_mut(|a, b| a.start.number() == b.start.number()) {
            let leaving = run[0].ray.leaving;
            let rays = self.caster.begin(leaving);
            for path in run.iter() {
                rays.push(path.ray.origin, path.ray.direction);
            }
            self.caster.find_near(f64::INFINITY);
            if run[0].start.is_nowhere() && run.len() > 1 {
                self.caster.divide_fields();
            }
            for (k, path) in run.iter_mut().enumerate() {
                let face = self.nearest(k, &path.ray, path.start);
                if path.start.is_nowhere() {
                    path.media = self.media_at_start(&path.ray);
                }
                match face {
                    Some((face, start)) => faces.push(self.met_face(path, number, face, start)),
                    None => {
                        let background = (self.scenery.background)(path.ray.direction);
                        light[number] = kept(&path.media, f64::INFINITY) * background;
                    }
                }
                number += 1;
            }
        }
        faces
    }

    /// The look of the face that a path has just come to, with the shares of light that go on from there.
    fn met_face(
        &mut self,
        path: &LightPath,
        number: usize,
        mut face: Face,
        start: Start,
    ) -> MetFace {
        let kept = kept(&path.media, face.t);
        let direction = path.ray.direction;
        face.beam = path.spread * face.t * direction;
        let look = (self.scenery.look)(&face).balanced();
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
                let media = self.beyond(path, face.t);
                let index = |media: &[Medium]| media.last().map_or(1.0, |medium| medium.glass.ior);
                let (n1, n2) = (index(&path.media), index(&media));
                let cosine = (-normal.dot(direction)).clamp(0.0, 1.0);
                let share = fresnel(cosine, n1, n2);
                mirror += DVec3::splat(look.glass * share);
                // A bump may bend the light so that it stays on its side of the true face.
                onward = refracted(direction, normal, n1, n2).map(|bent| {
                    let passes = bent.dot(face.normal) < 0.0;
                    (bent, if passes { media } else { path.media.clone() })
                });
                through = DVec3::splat(look.glass * (1.0 - share));
            } else {
                onward = Some((direction, path.media.clone()));
                through = look.glass * look.colour;
            }
        }
        let scattered = look.scattered() * look.colour;
        let (specular, ambient) = match self.scenery.picture_look {
            PictureLook::Geotrace => (DVec3::splat(look.specular), scattered),
            PictureLook::Crt => (look.specular * look.colour, crt::ambient(&look)),
        };
        MetFace {
            path: number,
            t: face.t,
            position: face.position,
            true_normal: face.normal,
            normal,
            start,
            scattered,
            specular,
            shininess: look.shininess,
            kept,
            mirror,
            through,
            onward,
            out: ambient * self.ambient,
        }
    }

    /// The glass around the start of the ray that has just been cast, with the colour that its leaf has there.
    fn media_at_start(&self, ray: &Ray) -> Vec<Medium> {
        let scenery = self.scenery;
        let solids = self.caster.solids_at_start().iter();
        let media = solids.filter_map(|&solid| {
            let glass = scenery.glass(solid)?;
            let face = Face {
                t: 0.0,
                position: ray.origin,
                normal: -ray.direction,
                beam: DVec3::ZERO,
                of: FaceObject::Solid {
                    solid,
                    leaf: glass.leaf,
                    surface: SurfaceId::of_leaf(glass.leaf),
                    entering: true,
                },
            };
            Some(Medium {
                solid,
                glass,
                colour: (scenery.look)(&face).colour,
            })
        });
        media.collect()
    }

    /// The first face of the ray with this index in the caster's bundle, and what rays from there leave; if it is one of a
    /// solid, the caster has the crossings at its place.
    ///
    /// An opaque parametric surface is seen before the face of a solid that it lies on, one of glass is not.
    // A face that is returned through memory is read back before the processor has stored it.
    #[inline(always)]
    fn nearest(&mut self, index: usize, ray: &Ray, start: Start) -> Option<(Face, Start)> {
        let scenery = self.scenery;
        let mut crossings = self.caster.nearest(index);
        let mut seen = scenery.first_seen(crossings);
        if seen.is_none() && !crossings.is_empty() {
            crossings = self.caster.cast(ray);
            seen = scenery.first_seen(crossings);
        }
        let mut flush = None;
        if !scenery.sheets.is_empty() {
            let found;
            (found, flush) = scenery.nearest_sheet(&mut self.sheets, ray, start, seen);
            if found.is_some() {
                return found;
            }
        }
        let seen = seen?;
        let start = Start {
            surface: Some(seen.surface),
            sheet: flush,
        };
        Some((Face::from(seen), start))
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
                            origin: met.position,
                            direction,
                            leaving: met.start.surface,
                        },
                        spread: 0.0,
                        start: met.start,
                        weight,
                        length: path.length + met.t,
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
    fn beyond(&self, path: &LightPath, t: f64) -> Vec<Medium> {
        let scenery = self.scenery;
        let mut media = path.media.clone();
        let crossings = self.caster.crossings().iter();
        for crossing in crossings.filter(|crossing| crossing.t == t) {
            let look = (scenery.look)(&Face::from(crossing));
            scenery.pass(&mut media, crossing, &look);
        }
        media
    }
}

impl Scenery<'_> {
    fn glass(&self, solid: usize) -> Option<Glass> {
        self.glass.get(solid).copied().flatten()
    }

    /// The first face of a parametric surface before, or flush with, the face of a solid that a ray sees, with what rays from
    /// there leave; and a surface of glass that is flush with that face.
    fn nearest_sheet(
        &self,
        scratch: &mut SheetScratch,
        ray: &Ray,
        start: Start,
        seen: Option<&Crossing>,
    ) -> (Option<(Face, Start)>, Option<SheetPlace>) {
        let [before, mut reach] =
            seen.map_or([f64::INFINITY; 2], |seen| flush_with(seen.t, ray.origin));
        let (mut found, mut flush) = (None, None);
        let ray = SheetsRay {
            origin: ray.origin,
            direction: ray.direction,
            leaving: start.sheet,
            reach,
        };
        self.sheets.cast(scratch, ray, &mut |sheet, hit| {
            if hit.t < reach && self.sees(hit) {
                let face = Face::on_sheet(sheet, hit);
                let is_flush = hit.t >= before;
                if is_flush && (self.look)(&face).balanced().glass > 0.0 {
                    flush = Some((sheet, hit.uv));
                } else {
                    reach = hit.t;
                    let surface = seen.map(|seen| seen.surface);
                    let start = Start {
                        surface: surface.filter(|_| is_flush),
                        sheet: Some((sheet, hit.uv)),
                    };
                    found = Some((face, start));
                }
            }
            reach
        });
        (found, flush)
    }

    /// The face that a ray sees first, of crossings by t: of those at one place the first that is opaque, else the first.
    fn first_seen<'c>(&self, crossings: &'c [Crossing]) -> Option<&'c Crossing> {
        let mut seen = crossings.iter().filter(|found| self.is_seen(found));
        let first = seen.next()?;
        let mut others = seen.take_while(|found| found.t == first.t).peekable();
        // The look is not asked for in vain.
        if others.peek().is_none() {
            return Some(first);
        }
        let is_opaque = |found: &&Crossing| (self.look)(&Face::from(*found)).glass == 0.0;
        let mut all = std::iter::once(first).chain(others);
        all.find(is_opaque).or(Some(first))
    }

    /// Changes the glass around a ray to that behind a crossing, whose face has this look.
    pub(super) fn pass(&self, media: &mut Vec<Medium>, crossing: &Crossing, look: &FaceLook) {
        let solid = crossing.solid;
        media.retain(|medium| medium.solid != solid);
        if crossing.entering
            && let Some(glass) = self.glass(solid)
        {
            media.push(Medium {
                solid,
                glass,
                colour: look.colour,
            });
            media.sort_by_key(|medium| medium.solid);
        }
    }
}
