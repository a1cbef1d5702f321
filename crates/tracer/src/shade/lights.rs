//! The light that comes to faces from lights.
//!
//! Input: faces that paths come to. Output: what they send towards the starts of the paths of the light from lights. One light
//! after another is looked at from all faces, vector by vector; then the rays towards it are cast together, those that
//! leave one surface in one bundle.

use expr::processor::Processor;
use expr::vectors::MOST_LANES;
use glam::DVec3;

use super::crt::{self, PARALLEL_REACH};
use super::paths::{LeftSurface, LightPath, LightTracer, MetFace, left_surface};
use super::{Face, FaceObject};
use crate::light::{FaceBlock, Light, SeenBlock, SeenLight};
use crate::look::PictureLook;
use crate::sheets::SheetsRay;

/// Faces that lights shine on, and a light as they see it; kept for the next faces.
#[derive(Default)]
pub(super) struct LitFaces {
    /// In the order of the faces, as all of these.
    blocks: Vec<FaceBlock>,
    seen: Vec<SeenBlock>,
    /// The colour of what each scatters, times the share.
    scattered: Vec<DVec3>,
    /// The surface that rays from it leave.
    surfaces: Vec<LeftSurface>,
    /// The faces that are turned to the light.
    turned: Vec<usize>,
}

impl LitFaces {
    fn fill(&mut self, look: PictureLook, paths: &[LightPath], faces: &[MetFace]) {
        self.blocks.clear();
        self.scattered.clear();
        self.surfaces.clear();
        for (k, met) in faces.iter().enumerate() {
            if k % MOST_LANES == 0 {
                self.blocks.push(FaceBlock::default());
            }
            let Some(block) = self.blocks.last_mut() else {
                continue;
            };
            let path = &paths[met.path];
            let length = match look {
                PictureLook::Geotrace => 0.0,
                PictureLook::Crt => path.length + met.face.t,
            };
            block.set(
                k % MOST_LANES,
                met.face.position,
                met.normal,
                length,
                path.light_sample,
            );
            self.scattered.push(met.scattered());
            self.surfaces.push(left_surface(Some(&met.face.of)));
        }
        self.seen.resize(self.blocks.len(), SeenBlock::default());
    }

    /// Finds the faces that are turned to a light, and how they see it.
    fn turn(&mut self, light: &Light, processor: Processor, count: usize) {
        light.seen_from(processor, &self.blocks, &mut self.seen);
        self.turned.clear();
        let is_lit = |k: &usize| self.seen[k / MOST_LANES].is_lit(k % MOST_LANES);
        self.turned.extend((0..count).filter(is_lit));
    }

    fn seen(&self, face: usize) -> SeenLight {
        self.seen[face / MOST_LANES].light(face % MOST_LANES)
    }

    /// The cosine between the light and the normal of a face.
    fn height(&self, face: usize) -> f64 {
        self.seen[face / MOST_LANES].height[face % MOST_LANES]
    }
}

impl LightTracer<'_> {
    /// Adds what comes to the faces from lights.
    pub(super) fn add_lights(&mut self, paths: &[LightPath], faces: &mut [MetFace]) {
        let scenery = self.scenery;
        let mut lit = std::mem::take(&mut self.lit);
        lit.fill(scenery.picture_look, paths, faces);
        for light in scenery.lights {
            if light.ambient != 0.0 {
                for (met, scattered) in faces.iter_mut().zip(&lit.scattered) {
                    met.out += match scenery.picture_look {
                        PictureLook::Geotrace => *scattered * light.ambient * light.color,
                        PictureLook::Crt => crt::ambient(&met.look, light),
                    };
                }
            }
            lit.turn(light, self.processor, faces.len());
            let left = |face: usize| lit.surfaces[face];
            for run in lit.turned.chunk_by(|a, b| left(*a) == left(*b)) {
                self.add_light(light, &lit, run, paths, faces);
            }
        }
        self.lit = lit;
    }

    /// Adds the light to a run of the faces that are turned to it, which leave one surface.
    fn add_light(
        &mut self,
        light: &Light,
        lit: &LitFaces,
        run: &[usize],
        paths: &[LightPath],
        faces: &mut [MetFace],
    ) {
        let picture_look = self.scenery.picture_look;
        let reach = |seen: &SeenLight| match picture_look {
            PictureLook::Crt if !seen.distance.is_finite() => PARALLEL_REACH,
            _ => seen.distance,
        };
        if light.casts_shadows {
            let leaving = faces[run[0]].face.of.surface();
            let rays = self.caster.begin(leaving);
            let mut farthest = 0.0f64;
            for &face in run {
                let seen = lit.seen(face);
                rays.push(faces[face].face.position, seen.towards);
                farthest = farthest.max(reach(&seen));
            }
            self.caster.find_near(farthest);
        }
        let is_free = self.caster.bundle_is_free() && self.scenery.sheets.is_empty();
        for (k, &face) in run.iter().enumerate() {
            let met = &mut faces[face];
            let seen = lit.seen(face);
            let visible = if light.casts_shadows && !is_free {
                let ray = SheetsRay {
                    origin: met.face.position,
                    direction: seen.towards,
                    leaving: met.face.of.sheet(),
                    reach: reach(&seen),
                };
                self.visible(k, ray)
            } else {
                1.0
            };
            if visible == 0.0 {
                continue;
            }
            let direction = paths[met.path].ray.direction;
            let height = lit.height(face);
            met.out += match picture_look {
                PictureLook::Geotrace => {
                    let highlight = if met.look.specular > 0.0 {
                        met.highlight(seen.towards, direction)
                    } else {
                        0.0
                    };
                    let shared = visible * seen.share;
                    let scattered = light.color * lit.scattered[face] * height;
                    shared * (scattered + light.highlight * highlight)
                }
                PictureLook::Crt => crt::lit(
                    &met.look, light, &seen, height, visible, met.normal, direction,
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
        if let Some([solid, leaf]) = self.caster.entered_before(index, distance)
            && scenery.is_seen_from_outside(leaf)
            && scenery.opaque.get(solid) == Some(&true)
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
}
