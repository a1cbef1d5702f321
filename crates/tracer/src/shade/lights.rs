//! The light that comes to faces from lights.
//!
//! Input: faces that paths come to. Output: what they send towards the starts of the paths of the light from lights. The faces
//! stand in blocks, those of one surface together. One light after another is evaluated at all of them, vector by vector;
//! then the rays from one surface towards it are cast together. Faces without a highlight that nothing hides from the
//! light are lit block by block, the others one by one.

use expr::processor::Processor;
use expr::vectors::{Instructions, Lanes, MOST_LANES, Mask, Vector, VectorWork};
use glam::DVec3;

use super::Face;
use super::crt::{self, PARALLEL_REACH};
use super::paths::{LightPath, LightTracer, Medium, MetFace, SurfaceNumber, flush_with, kept};
use crate::light::{FaceBlock, Light, SeenBlock, SeenLight};
use crate::look::PictureLook;
use crate::sheets::SheetsRay;

/// Faces that lights shine on, and a light as they see it; kept for the next faces.
#[derive(Default)]
pub(super) struct LitFaces {
    blocks: Vec<LitBlock>,
    places: Vec<FaceBlock>,
    seen: Vec<SeenBlock>,
}

/// Faces of one surface.
#[derive(Clone, Debug)]
struct LitBlock {
    /// Their numbers, lane by lane.
    faces: [usize; MOST_LANES],
    /// True for the first block of a surface.
    begins: bool,
    /// The lanes that have a face.
    used: Lanes,
    /// Those of faces that send more than what they scatter.
    shiny: Lanes,
    /// Those of faces that coloured glass is before.
    tinted: Lanes,
    /// Those of faces that are turned to the light.
    turned: Lanes,
    /// Those of them that nothing hides from the light, and that send nothing but what they scatter.
    plain: Lanes,
    /// The colour of what they scatter, times the share.
    scattered: [[f64; MOST_LANES]; 3],
    /// The light that they send.
    out: [[f64; MOST_LANES]; 3],
}

impl LitFaces {
    fn fill(
        &mut self,
        look: PictureLook,
        paths: &[LightPath],
        faces: &[MetFace],
        by_surface: &[(SurfaceNumber, usize)],
    ) {
        self.blocks.clear();
        self.places.clear();
        for of_surface in by_surface.chunk_by(|(a, _), (b, _)| a == b) {
            for (k, numbers) in of_surface.chunks(MOST_LANES).enumerate() {
                let mut block = LitBlock {
                    faces: [0; MOST_LANES],
                    begins: k == 0,
                    used: Lanes::default(),
                    shiny: Lanes::default(),
                    tinted: Lanes::default(),
                    turned: Lanes::default(),
                    plain: Lanes::default(),
                    scattered: [[0.0; MOST_LANES]; 3],
                    out: [[0.0; MOST_LANES]; 3],
                };
                let mut places = FaceBlock::default();
                for (lane, &(_, number)) in numbers.iter().enumerate() {
                    let met = &faces[number];
                    block.faces[lane] = number;
                    let path = &paths[met.path];
                    let (length, is_shiny) = match look {
                        PictureLook::Geotrace => (0.0, met.specular != DVec3::ZERO),
                        PictureLook::Crt => (path.length + met.t, true),
                    };
                    places.set(lane, met.position, met.normal, length, path.light_sample);
                    block.used.add(lane, true);
                    block.shiny.add(lane, is_shiny);
                    let medium = path.media.last();
                    let is_tinted = medium.is_some_and(|medium| medium.colour != DVec3::ONE);
                    block.tinted.add(lane, is_tinted);
                    let [r, g, b] = &mut block.scattered;
                    (r[lane], g[lane], b[lane]) = met.scattered.into();
                    block.add(lane, met.out);
                }
                self.blocks.push(block);
                self.places.push(places);
            }
        }
        self.seen.resize(self.places.len(), SeenBlock::default());
    }

    /// Finds the faces that are turned to a light, and how they see it.
    fn turn(&mut self, light: &Light, processor: Processor) {
        light.seen_from(processor, &self.places, &mut self.seen);
        for (block, seen) in self.blocks.iter_mut().zip(&self.seen) {
            block.turned = block.used & seen.lit();
        }
    }
}

impl LitBlock {
    fn add(&mut self, lane: usize, light: DVec3) {
        let [r, g, b] = &mut self.out;
        r[lane] += light.x;
        g[lane] += light.y;
        b[lane] += light.z;
    }
}

/// Adds what plain faces scatter of a light.
struct ScatteredLight<'a> {
    colour: [f64; 3],
    blocks: &'a mut [LitBlock],
    seen: &'a [SeenBlock],
}

impl VectorWork for ScatteredLight<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) {
        let zero = Vector::splat(s, 0.0);
        for (block, seen) in self.blocks.iter_mut().zip(self.seen) {
            if !block.plain.any() {
                continue;
            }
            for part in 0..Vector::<S>::PARTS {
                let is_plain = Mask::of(s, block.plain, part);
                let share = Vector::load(s, &seen.share, part);
                let height = Vector::load(s, &seen.height, part);
                for (k, colour) in self.colour.into_iter().enumerate() {
                    let scattered = Vector::load(s, &block.scattered[k], part);
                    let light = share * (Vector::splat(s, colour) * scattered * height);
                    let out = Vector::load(s, &block.out[k], part);
                    (out + is_plain.choose(light, zero)).store(&mut block.out[k], part);
                }
            }
        }
    }
}

/// The faces of one surface, and a light as they see it.
struct SurfaceFaces<'a> {
    blocks: &'a mut [LitBlock],
    places: &'a [FaceBlock],
    seen: &'a [SeenBlock],
}

/// A face, and a light as it sees it.
pub(super) struct LitFace<'a> {
    pub(super) met: &'a MetFace,
    /// The direction of the ray that comes to the face.
    pub(super) direction: DVec3,
    pub(super) seen: SeenLight,
    /// The cosine of the angle between the direction towards the light and the normal.
    pub(super) height: f64,
}

impl LitFace<'_> {
    /// Returns the light that it sends against the ray, if this share of the light comes to it.
    fn sent(&self, look: PictureLook, light: &Light, visible: DVec3) -> DVec3 {
        match look {
            PictureLook::Geotrace => {
                let shared = visible * self.seen.share;
                let scattered = light.colour * self.met.scattered * self.height;
                shared * (scattered + light.highlight * self.highlight())
            }
            PictureLook::Crt => crt::lit(self, light, visible),
        }
    }

    /// Returns the highlight, as a share of the light by colour.
    fn highlight(&self) -> DVec3 {
        let met = self.met;
        if met.specular == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let half = (self.seen.towards - self.direction).normalize_or_zero();
        met.specular * met.normal.dot(half).max(0.0).powf(met.shininess)
    }
}

/// Returns the distance within which a face can be in the shadow of others, from a light at this distance.
fn shadow_distance(look: PictureLook, distance: f64) -> f64 {
    match look {
        PictureLook::Crt if !distance.is_finite() => PARALLEL_REACH,
        _ => distance,
    }
}

/// The work of a light for a block of faces, in operations.
const LIGHT_OPERATIONS: u64 = 16;

impl LightTracer<'_> {
    /// Adds what comes to the faces from lights; `by_surface` has the numbers of the faces, surface by surface.
    pub(super) fn add_lights(
        &mut self,
        paths: &[LightPath],
        faces: &mut [MetFace],
        by_surface: &[(SurfaceNumber, usize)],
    ) {
        let scenery = self.scenery;
        let mut lit = std::mem::take(&mut self.lit);
        lit.fill(scenery.picture_look, paths, faces, by_surface);
        for light in scenery.lights {
            lit.turn(light, self.processor);
            self.operations += lit.blocks.len() as u64 * LIGHT_OPERATIONS;
            let mut begin = 0;
            for blocks in lit.blocks.chunk_by_mut(|_, next| !next.begins) {
                let range = begin..begin + blocks.len();
                begin = range.end;
                if blocks.iter().any(|block| block.turned.any()) {
                    let surface = SurfaceFaces {
                        blocks,
                        places: &lit.places[range.clone()],
                        seen: &lit.seen[range],
                    };
                    self.add_light(light, surface, paths, faces);
                }
            }
        }
        for block in &lit.blocks {
            for lane in block.used.each() {
                let [r, g, b] = &block.out;
                faces[block.faces[lane]].out = DVec3::new(r[lane], g[lane], b[lane]);
            }
        }
        self.lit = lit;
    }

    /// Adds a light to the faces of a surface.
    fn add_light(
        &mut self,
        light: &Light,
        surface: SurfaceFaces<'_>,
        paths: &[LightPath],
        faces: &[MetFace],
    ) {
        let picture_look = self.scenery.picture_look;
        if light.casts_shadows {
            self.begin_shadow_rays(&surface, faces);
        }
        let SurfaceFaces { blocks, seen, .. } = surface;
        let mut rays = 0;
        for (block, seen) in blocks.iter_mut().zip(seen) {
            block.plain = Lanes::default();
            if !block.turned.any() {
                continue;
            }
            let free = match light.casts_shadows {
                true => self.free_lanes(block, seen, rays),
                false => block.turned,
            };
            block.plain = free.without(block.shiny);
            for lane in block.turned.without(block.plain).each() {
                let met = &faces[block.faces[lane]];
                let path = &paths[met.path];
                let lit = LitFace {
                    met,
                    direction: path.ray.direction,
                    seen: seen.light(lane),
                    height: seen.height[lane],
                };
                let visible = if free.has(lane) {
                    DVec3::ONE
                } else {
                    let ray = SheetsRay {
                        origin: met.position,
                        direction: lit.seen.towards,
                        leaving: met.start.sheet,
                        reach: shadow_distance(picture_look, lit.seen.distance),
                    };
                    self.visible(rays + lane, ray, &path.media)
                };
                if visible != DVec3::ZERO {
                    block.add(lane, lit.sent(picture_look, light, visible));
                }
            }
            rays += MOST_LANES;
        }
        self.processor.run_vectors(ScatteredLight {
            colour: light.colour.to_array(),
            blocks,
            seen,
        });
    }

    /// Begins the bundle of the rays from the faces of a surface towards a light.
    fn begin_shadow_rays(&mut self, surface: &SurfaceFaces<'_>, faces: &[MetFace]) {
        let picture_look = self.scenery.picture_look;
        let SurfaceFaces {
            blocks,
            places,
            seen,
        } = surface;
        let rays = self.caster.begin(faces[blocks[0].faces[0]].start.surface);
        let mut farthest = 0.0f64;
        for ((block, places), seen) in blocks.iter().zip(*places).zip(*seen) {
            if block.turned.any() {
                rays.push_block(&places.position, &seen.towards, block.turned);
                let lanes = block.turned.each();
                let distances =
                    lanes.map(|lane| shadow_distance(picture_look, seen.distance[lane]));
                farthest = distances.fold(farthest, f64::max);
            }
        }
        self.caster.find_near(farthest);
    }

    /// Returns the lanes of a block whose faces are turned to the light and are known to see it unchanged; `first` is the
    /// number of the block's first ray in the caster's bundle.
    fn free_lanes(&self, block: &LitBlock, seen: &SeenBlock, first: usize) -> Lanes {
        if !self.scenery.sheets.is_empty() {
            return Lanes::default();
        }
        let mut free = block.turned.without(block.tinted);
        if !self.caster.bundle_is_free() {
            let picture_look = self.scenery.picture_look;
            let distances = seen.distance.map(|it| shadow_distance(picture_look, it));
            free = free & self.caster.free_rays(first, &distances);
        }
        free
    }

    /// The share of a light that the faces on the way let through, unbent, and the glass between them: first these media. The
    /// ray is that with this index in the caster's bundle.
    fn visible(&mut self, index: usize, ray: SheetsRay, media: &[Medium]) -> DVec3 {
        let scenery = self.scenery;
        let look = scenery.look;
        let distance = ray.reach;
        if let Some((solid, leaf, entering)) = self.caster.passed_before(index, distance)
            && scenery.is_seen_through(leaf, entering)
            && scenery.opaque.get(solid) == Some(&true)
        {
            return DVec3::ZERO;
        }
        let mut share = DVec3::ONE;
        let mut media = media.to_vec();
        let mut way = 0.0;
        // The places of the faces so far: those at one place are one face, as for a ray from the eye.
        let mut places: Vec<f64> = Vec::new();
        self.caster.each_before(index, distance, &mut |passed| {
            let look = look(&passed.into()).balanced();
            if scenery.is_seen(passed) {
                if look.glass == 0.0 {
                    share = DVec3::ZERO;
                } else if places.last() != Some(&passed.t) {
                    share *= look.glass;
                    places.push(passed.t);
                }
            }
            if share == DVec3::ZERO {
                return false;
            }
            share *= kept(&media, passed.t - way);
            way = passed.t;
            scenery.pass(&mut media, passed, &look);
            true
        });
        share *= kept(&media, distance - way);
        if share != DVec3::ZERO {
            scenery
                .sheets
                .cast(&mut self.sheets, ray, &mut |sheet, hit| {
                    if scenery.sees(hit) {
                        let glass = look(&Face::on_sheet(sheet, hit)).balanced().glass;
                        let [least, most] = flush_with(hit.t, ray.origin);
                        if glass == 0.0 {
                            share = DVec3::ZERO;
                        } else if !places.iter().any(|&t| least <= t && t <= most) {
                            share *= glass;
                            places.push(hit.t);
                        }
                    }
                    // Behind what is opaque nothing changes.
                    if share == DVec3::ZERO { 0.0 } else { distance }
                });
        }
        share
    }
}
