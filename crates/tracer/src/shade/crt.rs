//! The light from lights in the look `crt`.
//!
//! Σ C·a·(1 − ρ) + (c·k·C·(n·l) + C·c·σ·max(0, r·d)^shininess)·V·S·I, with the colour c, the share k that is scattered,
//! the highlight σ and the mirror ρ of the face, the colour C and the ambient a of the light, l towards it, d the ray and
//! r = l − 2(l·n)n. I is (falloff/(r + path))², path the length of the way from the eye; a light behind the face adds no more
//! than its ambient.

use glam::DVec3;

use super::FaceLook;
use super::lights::LitFace;
use crate::light::Light;

/// The distance within which faces keep parallel light from others.
pub const PARALLEL_REACH: f64 = 1e4;

/// Returns the share, by colour, that a face sends of the light from everywhere.
pub(super) fn ambient(look: &FaceLook) -> DVec3 {
    DVec3::ONE - look.mirror
}

/// Returns the light that a face sends, if this share of a light comes to it.
pub(super) fn lit(face: &LitFace<'_>, light: &Light, visible: DVec3) -> DVec3 {
    let LitFace {
        met, seen, height, ..
    } = face;
    let away = seen.towards - 2.0 * height * met.normal;
    let along = away.dot(face.direction).max(0.0);
    let highlight = met.specular * along.powf(met.shininess);
    let shared = visible * seen.share;
    shared * (met.scattered * height * light.colour + highlight * light.highlight)
}
