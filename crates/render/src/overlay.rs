//! What is drawn over a picture when asked for: nothing of it is computed otherwise.
//!
//! ```text
//! geodesic view: rows of ends ──worn.rs: declared geodesics, trails─────────────┐
//! (inside.rs)    map of ends ──lines.rs: wavefronts, conjugate points, error────┼──▶ picture ──legend.rs──▶ picture
//!                            ──cut.rs: the cut locus────────────────────────────┘
//! 3D view:       a geodesic camera, trails ──space.rs──▶ arrows and curves, drawn as such; legend.rs over them
//! ```
//!
//! Declared geodesics are objects of the scene: they are drawn whenever their surface is looked at.

mod cut;
mod inside;
mod legend;
mod lettering;
mod lines;
mod space;
mod trail;
mod worn;

pub(crate) use inside::OverInside;
pub(crate) use space::{Extra, camera_extras, extras, trail_extras};
pub use trail::Trail;

use std::sync::Arc;

use image::RgbaImage;
use rayon::prelude::*;
use scene::ParamValues;
use scene::{Object, ObjectId, Scene, Shape};

use crate::plan::Painter;
use crate::request::{RenderError, Request};
use crate::style::{self, Decoder, Encoder};
use crate::texture::Texture;

/// What is asked for beyond the picture itself; by default nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overlays {
    /// A key to the hatchings and lines that the picture has.
    pub legend: bool,
    /// Geodesic circles at equal distances around the camera.
    pub wavefronts: Option<Spacing>,
    /// Where geodesics from the camera meet those that start beside them: the Jacobi field is zero there.
    pub conjugate_points: bool,
    /// Beyond this line, what is seen is nearer by another way.
    pub cut_locus: bool,
    /// The estimated error, painted over the picture.
    pub error: bool,
}

/// The painters that a request's overlays need in space, beside those of the scene's objects.
pub(crate) fn painters(scene: &Scene, request: &Request) -> &'static [Painter] {
    let trail = |trail: &Arc<Trail>| space::is_shown(scene, trail.surface);
    match request.show_camera {
        Some(camera) if space::is_shown(scene, camera.surface) => &space::PAINTERS,
        _ if request.trails.iter().any(trail) => &[Painter::Curves],
        _ => &[],
    }
}

/// The names of what is drawn in space beside the scene's objects.
pub(crate) fn names<'a>(extras: impl IntoIterator<Item = &'a Extra>) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = extras.into_iter().map(|extra| extra.name).collect();
    names.dedup();
    names
}

/// The distance between wavefronts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    /// About five of them, at a round distance.
    Auto,
    /// So far, in the surface's units; positive.
    Every(f64),
}

/// A geodesic camera to be shown in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standpoint {
    /// The surface it stands on.
    pub surface: ObjectId,
    /// Its (u, v); the middle of the domain if not given.
    pub at: Option<[f64; 2]>,
    /// The angle from σu to its X, towards σv, in radians.
    pub angle: f64,
    /// The length of X and Y; chosen from the surface's size if not given.
    pub zoom: Option<f64>,
    /// A camera that has walked: it takes the place of the others.
    pub frame: Option<geodesic::frame::Frame>,
}

impl Overlays {
    /// Whether anything is asked for.
    pub fn any(&self) -> bool {
        *self != Self::default()
    }
}

impl Spacing {
    /// The distance in numbers, for a view that reaches as far as `zoom`.
    pub fn distance(self, zoom: f64) -> f64 {
        match self {
            Self::Every(distance) => distance,
            Self::Auto => {
                let rough = zoom / 4.0;
                let unit = 10.0_f64.powf(rough.log10().floor());
                let steps = [1.0, 2.0, 5.0, 10.0].map(|n| n * unit);
                steps
                    .into_iter()
                    .find(|step| *step >= rough)
                    .unwrap_or(rough)
            }
        }
    }
}

/// sRGB colours of lines.
mod ink {
    /// Wavefronts.
    pub(super) const WAVE: [u8; 3] = [250, 250, 255];
    /// Conjugate points.
    pub(super) const CONJUGATE: [u8; 3] = [255, 70, 200];
    /// The cut locus.
    pub(super) const CUT: [u8; 3] = [255, 150, 0];
    /// Trails.
    pub(super) const TRAIL: [u8; 3] = [150, 130, 255];
}

/// Whether anything lies over a geodesic picture of a surface.
pub(crate) fn any_inside(scene: &Scene, request: &Request, surface: ObjectId) -> bool {
    let worn = |object: &Object| matches!(object.shape, Shape::Geodesic { surface: on, .. } if on == surface);
    request.overlays.any()
        || trails_on(request, surface).next().is_some()
        || scene.objects.iter().any(worn)
}

/// Whether anything lies over a 3D picture.
pub(crate) fn any_space(request: &Request) -> bool {
    let curvature = |(_, texture): &(ObjectId, Arc<Texture>)| texture.curvature_scale().is_some();
    let keyed = request.show_camera.is_some() || request.textures.iter().any(curvature);
    request.overlays.legend && keyed || !request.trails.is_empty()
}

/// Draws what lies over a 3D picture: the key to its overlays and to the colours of curvature if the legend is asked
/// for, and the trails' lengths. Gives the names of what was drawn.
///
/// # Errors
/// Those of the camera that is shown.
pub(crate) fn over_space(
    image: &mut RgbaImage,
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
) -> Result<Vec<&'static str>, RenderError> {
    let mut key = legend::Key::default();
    if request.overlays.legend {
        space::key(&mut key, scene, settings, request)?;
        for (id, object) in (0..).map(ObjectId).zip(&scene.objects) {
            if matches!(object.shape, Shape::Surface { .. })
                && let Some(scale) = request.texture(id).curvature_scale()
            {
                key.curvature(&object.name, scale);
            }
        }
    }
    let legend = !key.is_empty();
    for trail in &request.trails {
        if space::is_shown(scene, trail.surface) {
            key.line(ink::TRAIL, &trail_words(trail));
        }
    }
    key.draw(image);
    Ok(if legend { vec!["legend"] } else { Vec::new() })
}

/// The trails on a surface.
fn trails_on(request: &Request, surface: ObjectId) -> impl Iterator<Item = &Trail> {
    let trails = request.trails.iter().map(Arc::as_ref);
    trails.filter(move |trail| trail.surface == surface && trail.points.len() > 1)
}

fn trail_words(trail: &Trail) -> String {
    format!("trail, length {}", legend::digits(trail.length))
}

fn wave_words(distance: f64) -> String {
    format!("wavefronts, every {}", legend::digits(distance))
}

/// How lines over pictures of a size are inked: each has a dark rim, so that it is seen on anything.
#[derive(Clone, Copy, Debug)]
struct Pen {
    /// Half a line's width in pixels, …
    half: f32,
    /// … and that of its rim.
    rim: f32,
    decoder: Decoder,
    encoder: Encoder,
}

/// The colour of a line.
#[derive(Clone, Copy, Debug)]
struct Ink {
    srgb: [u8; 3],
    /// In linear light.
    light: [f32; 3],
}

impl Ink {
    fn of(srgb: [u8; 3]) -> Self {
        let light = style::linear(srgb);
        Self { srgb, light }
    }
}

impl Pen {
    fn of(size: [u32; 2]) -> Self {
        let unit = style::pixel_unit(size);
        let half = (1.1 * unit).max(0.7);
        Self {
            half,
            rim: half + 0.8 * unit.max(0.8),
            decoder: Decoder::get(),
            encoder: Encoder::get(),
        }
    }

    /// Pixels as far as that from a line show nothing of it.
    #[inline(always)]
    fn reach(&self) -> f32 {
        self.rim + 0.5
    }

    /// Lays a line over a pixel's bytes, so many pixels from its middle.
    #[inline]
    fn ink(&self, pixel: &mut [u8], ink: &Ink, distance: f32) {
        let dark = 0.55 * (self.rim - distance + 0.5).clamp(0.0, 1.0);
        let line = (self.half - distance + 0.5).clamp(0.0, 1.0);
        if line >= 1.0 {
            pixel[..3].copy_from_slice(&ink.srgb);
        } else if dark > 0.0 {
            let (decoder, encoder) = (self.decoder, self.encoder);
            blend_by(decoder, encoder, pixel, [0.0; 3], dark);
            if line > 0.0 {
                blend_by(decoder, encoder, pixel, ink.light, line);
            }
        }
    }
}

/// Lays lines over a picture: `distance` gives how far a pixel (by its index) is from the nearest line, in pixels.
fn stroke(image: &mut RgbaImage, colour: [u8; 3], distance: impl Fn(usize) -> Option<f32> + Sync) {
    let pen = Pen::of([image.width(), image.height()]);
    let ink = Ink::of(colour);
    image
        .par_chunks_mut(4)
        .enumerate()
        .for_each(|(index, pixel)| {
            if let Some(distance) = distance(index) {
                pen.ink(pixel, &ink, distance);
            }
        });
}

/// Lays a colour (linear light) over a pixel's bytes.
fn blend(pixel: &mut [u8], colour: [f32; 3], share: f32) {
    blend_by(Decoder::get(), Encoder::get(), pixel, colour, share);
}

/// The same by tables that are at hand.
#[inline]
fn blend_by(decoder: Decoder, encoder: Encoder, pixel: &mut [u8], colour: [f32; 3], share: f32) {
    for (byte, colour) in pixel.iter_mut().zip(colour) {
        let under = decoder.decode(*byte);
        *byte = encoder.encode(under + share * (colour - under));
    }
}

/// Lays a colour (linear light) over a pixel that may be transparent. Its alpha is not multiplied into its colours.
fn cover(pixel: &mut [u8; 4], colour: [f32; 3], share: f32) {
    let under = f32::from(pixel[3]) / 255.0;
    let alpha = under + share * (1.0 - under);
    if alpha <= 0.0 {
        return;
    }
    // What is seen of the colour beneath is a share of what is seen.
    blend(&mut pixel[..3], colour, share / alpha);
    pixel[3] = (255.0 * alpha).round() as u8;
}

#[cfg(test)]
mod tests {
    use super::{Ink, Pen, blend, cover};

    #[test]
    fn a_line_is_its_colour_in_its_middle_and_nothing_beyond_its_rim() {
        let pen = Pen::of([800, 600]);
        for under in 0..=255 {
            for colour in 0..=255 {
                let ink = Ink::of([colour; 3]);
                let mut blended = [under; 3];
                blend(&mut blended, ink.light, 1.0);
                assert_eq!(blended, ink.srgb, "over {under}");
            }
            let mut blended = [under; 3];
            blend(&mut blended, [0.3; 3], 0.0);
            assert_eq!(blended, [under; 3]);
            let ink = Ink::of([77; 3]);
            let inked = |distance: f32| {
                let mut pixel = [under; 4];
                pen.ink(&mut pixel, &ink, distance);
                pixel
            };
            assert_eq!(inked(pen.half - 0.5), [77, 77, 77, under]);
            assert_eq!(inked(pen.reach()), [under; 4]);
            // Between both there is no step.
            let mut before = inked(0.0);
            let mut distance = 0.0;
            while distance < pen.reach() {
                distance += 0.01;
                let next = inked(distance);
                assert!(
                    (0..3).all(|k| before[k].abs_diff(next[k]) <= 12),
                    "{before:?} and {next:?} {distance} from the middle"
                );
                before = next;
            }
        }
    }

    #[test]
    fn covering_a_transparent_pixel_gives_the_colour_with_its_share() {
        let mut clear = [9, 9, 9, 0];
        cover(&mut clear, [1.0; 3], 0.4);
        assert_eq!(clear, [255, 255, 255, 102]);
        let mut opaque = [255, 255, 255, 255];
        cover(&mut opaque, [0.0; 3], 1.0);
        assert_eq!(opaque, [0, 0, 0, 255]);
        cover(&mut opaque, [1.0; 3], 0.0);
        assert_eq!(opaque, [0, 0, 0, 255]);
    }
}
