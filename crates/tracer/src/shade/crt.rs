//! The light from lights in the look `crt`.
//!
//! Σ C·a·(1 − ρ) + (c·k·C·(n·l) + C·c·σ·max(0, r·d)^shininess)·V·S·I, with the colour c, the share k that is scattered,
//! the highlight σ and the mirror ρ of the face, the colour C and the ambient a of the light, l towards it, d the ray and
//! r = l − 2(l·n)n. I is (falloff/(r + path))², path the length of the way from the eye; a light behind the face adds no more
//! than its ambient.

use glam::DVec3;

use super::{Face, FaceLook, LightPath, LightTracer};

/// The distance within which faces keep parallel light from others.
const PARALLEL_REACH: f64 = 1e4;

impl LightTracer<'_> {
    /// Light from the lights, at a face that a ray comes to.
    pub(super) fn lit_crt(
        &mut self,
        look: &FaceLook,
        face: &Face,
        normal: DVec3,
        path: &LightPath,
    ) -> DVec3 {
        let mut out = DVec3::ZERO;
        let left = (1.0 - look.mirror.max_element() - look.glass).max(0.0);
        let scattered = look.diffuse.unwrap_or(left);
        for light in self.scenery.lights {
            out += light.ambient * light.color * (DVec3::ONE - look.mirror);
            let length = path.length + face.t;
            let seen = light.from(face.position, self.light_sample, length);
            let height = normal.dot(seen.towards);
            if height <= 0.0 || seen.share <= 0.0 {
                continue;
            }
            let visible = if light.casts_shadows {
                let is_near = seen.distance.is_finite();
                let reach = if is_near {
                    seen.distance
                } else {
                    PARALLEL_REACH
                };
                self.visible(face, seen.towards, reach)
            } else {
                1.0
            };
            if visible == 0.0 {
                continue;
            }
            let away = seen.towards - 2.0 * height * normal;
            let along = away.dot(path.direction).max(0.0);
            let highlight = look.specular * along.powf(look.shininess);
            let shared = visible * seen.share;
            out += shared
                * look.color
                * (scattered * height * light.color + highlight * light.highlight);
        }
        out
    }
}
