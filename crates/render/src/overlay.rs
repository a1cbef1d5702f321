//! What is drawn over a picture when asked for: nothing of it is computed otherwise.
//!
//! ```text
//! geodesic view: map of ends ──lines.rs: wavefronts, conjugate points, error── ─┐
//!                            ──cut.rs: the cut locus───────────────────────────┼──▶ picture ──legend.rs──▶ picture
//!                            ──worn.rs: declared geodesics─────────────────────┘
//! 3D view:       a geodesic camera ──space.rs──▶ arrows and curves, drawn as such
//! ```
//!
//! Declared geodesics are objects of the scene: they are drawn whenever their surface is looked at.

mod cut;
mod legend;
mod lettering;
mod lines;
mod space;
mod worn;

pub(crate) use space::{Extra, extras};

use std::borrow::Cow;

use geodesic::map::Map;
use geodesic::trace::Status;
use image::RgbaImage;
use rayon::prelude::*;
use scene::scene::{Object, ObjectId, Scene, Shape};
use scene::values::Settings;

use crate::geodesic_view::Inside;
use crate::plan::Painter;
use crate::request::Request;
use crate::style;

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
    match request.show_camera {
        Some(camera) if space::is_shown(scene, camera.surface) => &space::PAINTERS,
        _ => &[],
    }
}

/// The names of what is drawn in space beside the scene's objects.
pub(crate) fn names(extras: &[Extra]) -> Vec<&'static str> {
    if extras.is_empty() {
        Vec::new()
    } else {
        vec!["camera"]
    }
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
}

/// Draws what lies over a geodesic picture. `map` gives the pixels' ends and is called only if something needs them.
/// Gives what a reader should know, and the names of what was drawn.
pub(crate) fn over_inside<'m>(
    image: &mut RgbaImage,
    scene: &Scene,
    settings: &Settings,
    request: &Request,
    inside: &Inside,
    surface: ObjectId,
    map: impl FnOnce() -> Cow<'m, Map>,
) -> (Vec<String>, Vec<&'static str>) {
    let overlays = &request.overlays;
    let (mut notes, mut drawn) = (Vec::new(), Vec::new());
    let worn = worn::lines(scene, settings, request, inside, surface);
    if !overlays.any() && worn.is_empty() {
        return (notes, drawn);
    }
    let map = map();
    let mut key = legend::Key::default();
    if !worn.is_empty() {
        drawn.push("geodesics");
        for line in &worn {
            notes.extend(line.notes.iter().cloned());
            line.draw(image, &map, inside);
            key.line(line.colour, &format!("geodesic {}", line.name));
        }
    }
    if overlays.error {
        drawn.push("error");
        match lines::error(image, inside) {
            true => key.error(),
            false => notes.push("the error is painted only for the fan's pictures".to_owned()),
        }
    }
    if let Some(spacing) = overlays.wavefronts {
        drawn.push("wavefronts");
        let distance = spacing.distance(inside.zoom);
        lines::wavefronts(image, &map, inside.zoom, distance);
        let distance = format!("{:.6}", distance)
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned();
        key.line(ink::WAVE, &format!("wavefronts, every {distance}"));
    }
    if overlays.cut_locus {
        drawn.push("cut locus");
        let share = cut::draw(image, &map, inside);
        notes.push(format!(
            "{:.2} % of the pixels lie beyond the cut locus",
            100.0 * share
        ));
        key.line(ink::CUT, "cut locus");
    }
    if overlays.conjugate_points {
        drawn.push("conjugate points");
        lines::conjugate_points(image, &map, inside);
        key.line(ink::CONJUGATE, "conjugate points");
    }
    if overlays.legend {
        drawn.push("legend");
        for status in [
            Status::LeftDomain,
            Status::ConePoint,
            Status::Degenerate,
            Status::Undefined,
            Status::WorkLimit,
        ] {
            if map.status.contains(&status) {
                key.hatching(status);
            }
        }
        key.draw(image);
    }
    (notes, drawn)
}

/// Whether anything lies over a geodesic picture of a surface.
pub(crate) fn any_inside(scene: &Scene, request: &Request, surface: ObjectId) -> bool {
    let worn = |object: &Object| matches!(object.shape, Shape::Geodesic { surface: on, .. } if on == surface);
    request.overlays.any() || scene.objects.iter().any(worn)
}

/// Half the width of a line over a picture, in pixels.
fn half_width(size: [u32; 2]) -> f32 {
    (1.1 * style::pixel_unit(size)).max(0.7)
}

/// Lays lines over a picture: `distance` gives how far a pixel (by its index) is from the nearest line, in pixels. Each
/// has a dark rim, so that it is seen on anything.
fn stroke(image: &mut RgbaImage, colour: [u8; 3], distance: impl Fn(usize) -> Option<f32> + Sync) {
    let size = [image.width(), image.height()];
    let half = half_width(size);
    let rim = half + 0.8 * style::pixel_unit(size).max(0.8);
    let colour = style::linear(colour);
    image
        .par_chunks_mut(4)
        .enumerate()
        .for_each(|(index, pixel)| {
            let Some(distance) = distance(index) else {
                return;
            };
            let dark = 0.55 * (rim - distance + 0.5).clamp(0.0, 1.0);
            let line = (half - distance + 0.5).clamp(0.0, 1.0);
            if dark > 0.0 {
                blend(pixel, [0.0; 3], dark);
                blend(pixel, colour, line);
            }
        });
}

/// Lays a colour (linear light) over a pixel's bytes.
fn blend(pixel: &mut [u8], colour: [f32; 3], share: f32) {
    for (byte, colour) in pixel.iter_mut().zip(colour) {
        let under = style::decode(*byte);
        *byte = style::encode(under + share * (colour - under));
    }
}
