//! The conversion of the ends of geodesics on a solid to colours: its own at each point, or a checker if the solid has a
//! single colour.
//!
//! A pixel shows the mean of several points within it, without light or gamma change.

use geodesic::pixels::Map;
use geodesic::trace::Status;
use glam::DVec3;
use image::RgbaImage;
use rayon::prelude::*;
use scene::{AttributeValue, ObjectId, stated_word};
use tracer::shade::Face;

use crate::geodesic_view::{PlacedSolidCamera, Ring, hatch};
use crate::request::PictureRequest;
use crate::solids::SolidScene;
use crate::style::{self, DARK_SQUARE};

/// The number of squares of a checker along the longest side of the box.
const SQUARES: f64 = 8.0;
/// The positions in a pixel that are evaluated, as offsets from its centre in pixels to the right and down.
const SAMPLES: [[f32; 2]; 4] = [
    [-0.125, -0.375],
    [0.375, -0.125],
    [-0.375, 0.125],
    [0.125, 0.375],
];

/// The boxes of space whose walls cut a surface into the squares of a checker.
struct CheckerBoard {
    low: [f64; 3],
    /// The sides of a box, and the number of boxes along each axis; infinite for an unbounded solid.
    side: [f64; 3],
    count: [f64; 3],
}

impl CheckerBoard {
    /// Creates a board of about as many cubes as fit, so that the faces of the box are never between two of them.
    fn new(bounds: Option<[[f64; 3]; 2]>) -> Self {
        let Some([low, high]) = bounds else {
            return Self {
                low: [0.0; 3],
                side: [1.0; 3],
                count: [f64::INFINITY; 3],
            };
        };
        let sides = [0, 1, 2].map(|k| high[k] - low[k]);
        let longest = sides.into_iter().fold(0.0, f64::max);
        let count = sides.map(|side| (SQUARES * side / longest).round().max(1.0));
        Self {
            low,
            side: [0, 1, 2].map(|k| (sides[k] / count[k]).max(f64::MIN_POSITIVE)),
            count,
        }
    }

    fn is_dark(&self, at: [f64; 3]) -> bool {
        let index = |k: usize| {
            let index = ((at[k] - self.low[k]) / self.side[k]).floor();
            if self.count[k].is_finite() {
                index.clamp(0.0, self.count[k] - 1.0)
            } else {
                index
            }
        };
        let sum: f64 = (0..3).map(index).sum();
        sum.rem_euclid(2.0) >= 1.0
    }
}

/// Colours a map of a solid, on all cores.
pub(super) fn resolve_solid(
    request: &PictureRequest,
    scene: &SolidScene,
    camera: &PlacedSolidCamera,
    map: &Map<3>,
    mark_centre: bool,
) -> RgbaImage {
    let width = map.size[0] as usize;
    let mut image = RgbaImage::new(map.size[0], map.size[1]);
    if width == 0 {
        return image;
    }
    let object = camera.object;
    let face = face(scene, camera);
    let colour = |at: [f64; 3]| -> [f32; 3] {
        let Some(face) = &face else {
            return style::linear(style::SOLID_COLOUR);
        };
        let face = Face {
            position: DVec3::from_array(at),
            ..*face
        };
        let colour = scene.look(&face).colour.clamp(DVec3::ZERO, DVec3::ONE);
        colour.to_array().map(|c| c as f32)
    };
    let chosen = request.chosen_colour(object).map(style::linear);
    let chosen = chosen.filter(|_| !request.keeps_stated_colour(object));
    let one = (!varies(request, object)).then(|| colour(camera.frame.at));
    let one = one.map(|own| chosen.unwrap_or(own));
    let checker = CheckerBoard::new(camera.solid().bounds());
    let seen = |at: [f64; 3]| match one {
        Some(light) if checker.is_dark(at) => light.map(|c| DARK_SQUARE * c),
        Some(light) => light,
        None => colour(at),
    };
    image
        .par_chunks_mut(4 * width)
        .enumerate()
        .for_each(|(row, pixels)| {
            for (column, pixel) in pixels.chunks_exact_mut(4).enumerate() {
                let index = row * width + column;
                if map.status[index] != Status::Complete {
                    continue;
                }
                let offset = map.offset[index];
                let by_pixel = map.by_pixel.get(index).copied().unwrap_or_default();
                let mut sum = [0.0_f32; 3];
                for [right, down] in SAMPLES {
                    let at = [0, 1, 2].map(|k| {
                        let moved = offset[k] + right * by_pixel[0][k] + down * by_pixel[1][k];
                        map.origin[k] + f64::from(moved)
                    });
                    for (sum, c) in sum.iter_mut().zip(seen(at)) {
                        *sum += c;
                    }
                }
                let [r, g, b] = sum.map(|c| style::encode(c / SAMPLES.len() as f32));
                pixel.copy_from_slice(&[r, g, b, 255]);
            }
        });
    hatch(&mut image, &map.status);
    if let Some(ring) = Ring::of(mark_centre, map.size) {
        ring.mark(&mut image, 0, |_| true);
    }
    image
}

/// Returns the face under the camera.
fn face(scene: &SolidScene, camera: &PlacedSolidCamera) -> Option<Face> {
    let at = DVec3::from_array(camera.frame.at);
    let normal = camera.solid().surface().normal(camera.frame.at)?;
    let normal = DVec3::from_array(normal);
    let away = 1e-3 * camera.frame.zoom();
    let ray = tracer::Ray {
        origin: at + away * normal,
        direction: -normal,
        leaving: None,
    };
    let mut caster = scene.world().caster();
    let crossings = caster.cast(&ray);
    let distance = |crossing: &&tracer::Crossing| crossing.position.distance(at);
    let nearest = crossings
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    Some(Face::from(nearest))
}

/// Returns true if the colour of a solid varies from point to point.
fn varies(request: &PictureRequest, object: ObjectId) -> bool {
    let scene = &request.scene;
    let Some(solid) = scene.get(object).and_then(|object| object.shape.solid()) else {
        return false;
    };
    let chosen = request.chosen_texture(object).is_some();
    let mut attributes = solid.leaves.iter().flat_map(|leaf| &*leaf.attributes);
    let is_variable = |input: &expr::Input| matches!(input, expr::Input::Variable(_));
    let painted = solid.leaves.iter().any(|leaf| {
        let has_place = leaf.attributes.iter().any(|stated| stated.word == "uv");
        has_place && (chosen || stated_word(&leaf.attributes, "image").is_some())
    });
    painted
        || attributes.any(|stated| match &stated.value {
            AttributeValue::Numbers(nodes) if stated.word == "color" => {
                scene.graph.inputs(nodes).iter().any(is_variable)
            }
            _ => false,
        })
}
