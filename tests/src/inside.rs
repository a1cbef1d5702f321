//! Geodesic views as they open, and seeded random surfaces to look at from inside.

use std::f64::consts::PI;

use geodesic::frame::Frame;
use geodesic::map::{Map, MapMethod, MapOptions, bring_back, exponential_map};
use geodesic::reference::Reference;
use geodesic::surface::Surface;
use geodesic::trace::Status;
use render::geodesic_view::PlacedCamera;
use scene::{ObjectId, Shape};
use scene::{ParamValues, Scene};

use crate::wanted::Wanted;

/// A surface or a metric with the camera that its geodesic view opens with.
#[derive(Clone, Debug)]
pub struct Opening {
    /// The view.
    pub inside: PlacedCamera,
}

impl Opening {
    /// What the camera stands on, its params at their opening values.
    pub fn surface(&self) -> &dyn Surface {
        self.inside.manifold().surface()
    }

    /// The camera.
    pub fn frame(&self) -> Frame {
        self.inside.frame
    }
}

/// The geodesic view of a scene's first surface or metric; `None` where there is neither.
///
/// # Panics
/// When the view does not open.
pub fn opening(scene: &Scene) -> Option<Opening> {
    let is_ground = |shape: &Shape| matches!(shape, Shape::Surface { .. } | Shape::Metric { .. });
    let index = scene
        .objects
        .iter()
        .position(|object| is_ground(&object.shape))?;
    let request = Wanted::geodesic(ObjectId::new(index), [512, 512]);
    let inside = request
        .placed(scene, &ParamValues::initial(scene))
        .unwrap_or_else(|error| panic!("the view does not open: {error}"));
    Some(Opening { inside })
}

/// SplitMix64: the same numbers on every machine.
#[derive(Clone, Copy, Debug)]
pub struct Random(pub u64);

impl Random {
    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number below `limit`.
    pub fn below(&mut self, limit: u32) -> u32 {
        (self.unit() * f64::from(limit)) as u32
    }
}

/// A program with one random surface `s`, and a length typical of it: sums of waves over the plane, tubes about
/// rings, dented spheres, and wavy cylinders.
pub fn random_surface(random: &mut Random) -> (String, f64) {
    match random.below(4) {
        0 => {
            let waves = waves(random, 0.05, 0.35, ["u", "v"]);
            let text = format!("surface s(u,v) = (u, v, {waves}), u : [-4, 4], v : [-4, 4];");
            (text, 1.0)
        }
        1 => {
            let tube = random.between(0.1, 0.8);
            let dent = random.between(0.0, 0.15) * tube;
            let (turns, phase) = (1 + random.below(4), random.between(0.0, 6.2));
            let text = format!(
                "function r(u,v) = {tube:.6} + {dent:.6} sin({turns}u + {}v + {phase:.6});\n\
                 surface s(u,v) = ((1 + r(u,v) cos v) cos u, (1 + r(u,v) cos v) sin u, r(u,v) sin v), \
                 u : [0, 2pi], v : [0, 2pi];",
                random.below(3)
            );
            (text, tube)
        }
        2 => {
            let axes = [0; 3].map(|_| random.between(0.5, 1.5));
            let text = format!(
                "surface s(u,v) = ({:.6} cos u sin v, {:.6} sin u sin v, {:.6} cos v), \
                 u : [0, 2pi], v : [0, pi];",
                axes[0], axes[0], axes[2]
            );
            (text, axes[0].min(axes[2]))
        }
        _ => {
            let dent = random.between(0.0, 0.3);
            let (around, phase) = (random.below(4), random.between(0.0, 6.2));
            let along = random.between(0.5, 2.0);
            let text = format!(
                "function r(u,v) = 1 + {dent:.6} sin({around}u + {along:.6} v + {phase:.6});\n\
                 surface s(u,v) = (r(u,v) cos u, r(u,v) sin u, v), u : [0, 2pi], v : [-6, 6];"
            );
            (text, 1.0)
        }
    }
}

/// A sum of three waves with slopes between two bounds.
fn waves(random: &mut Random, low: f64, high: f64, names: [&str; 2]) -> String {
    let parts: Vec<String> = (0..3)
        .map(|_| {
            let length = random.between(0.7, 2.5);
            let angle = random.between(0.0, std::f64::consts::TAU);
            let height = random.between(low, high) / length;
            format!(
                "{height:.6} sin(({:.6}){} + ({:.6}){} + {:.6})",
                length * angle.cos(),
                names[0],
                length * angle.sin(),
                names[1],
                random.between(0.0, std::f64::consts::TAU)
            )
        })
        .collect();
    parts.join(" + ")
}

/// A seeded random view of a [`random_surface`].
#[derive(Clone, Debug)]
pub struct RandomView {
    /// The program.
    pub program: String,
    /// What it declares.
    pub opening: Opening,
    /// A camera somewhere in the middle three fifths of the domain, with a zoom from a little to several times the
    /// surface's length.
    pub frame: Frame,
    /// A tolerance from a hundredth of a pixel to a pixel.
    pub tolerance: f64,
}

/// The view with this number; `None` where no camera can stand there.
pub fn random_view(number: u64) -> Option<RandomView> {
    let mut random = Random(0xacc0 + 7919 * number);
    let (program, length) = random_surface(&mut random);
    let opening = opening(&crate::draw::scene(&program))?;
    let surface = opening.surface();
    let domain = surface.domain();
    let at = [0, 1].map(|k| {
        let [low, high] = domain[k];
        low + random.between(0.2, 0.8) * (high - low)
    });
    let angle = random.between(-PI, PI);
    let zoom = length * random.between(0.3, 4.0);
    let frame = Frame::new(surface, at, angle, zoom).ok()?;
    let tolerance = 10_f64.powf(random.between(-2.0, 0.0));
    Some(RandomView {
        program,
        opening,
        frame,
        tolerance,
    })
}

/// How far off a picture is at most, and what it says of it, in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Held {
    /// The largest error of all pixels whose truth is known.
    pub truth: f64,
    /// The estimate.
    pub estimate: f64,
}

/// Pixels of a picture whose estimate is held to the truth.
const SIDE: u32 = 96;
/// How many pixels of it are traced one by one, beside those that a more exact picture shows to be the worst.
const TRACED: usize = 225;
/// How many of these.
const WORST: usize = 16;

/// A method's estimate for a view against the truth. A far more exact picture shows at which of all the pixels it is off
/// the most; how much it is there, geodesics traced one by one say. `None` where nearly nothing is seen.
pub fn held(view: &RandomView, method: MapMethod) -> Option<Held> {
    let (surface, frame) = (view.opening.surface(), &view.frame);
    let size = [SIDE; 2];
    let map = |method: MapMethod, tolerance: f64| {
        let options = MapOptions {
            method,
            tolerance,
            ..MapOptions::default()
        };
        exponential_map(surface, frame, size, &options, &|_| {})
    };
    let picture = map(method, view.tolerance);
    let exact = map(MapMethod::Fan, (0.02 * view.tolerance).min(1e-3));
    let position = |map: &Map, index: usize| {
        let (uv, _) = bring_back(surface.domain(), surface.sides(), map.uv(index));
        surface.jet(uv).position
    };
    let mut off: Vec<(f64, u32)> = (0..picture.status.len())
        .filter(|&index| {
            let complete = [&picture, &exact].map(|map| map.status[index] == Status::Complete);
            complete == [true; 2]
        })
        .map(|index| {
            let [a, b] = [&picture, &exact].map(|map| position(map, index));
            let square = [0, 1, 2].map(|k| (a[k] - b[k]) * (a[k] - b[k]));
            (square.iter().sum(), index as u32)
        })
        .collect();
    if off.len() * 100 < picture.status.len() {
        return None;
    }
    off.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut reference = Reference::new(surface, frame, size, TRACED);
    reference.suspect(off.iter().take(WORST).map(|(_, index)| *index));
    let errors = reference.errors(&|index| (picture.uv(index), picture.status[index]));
    Some(Held {
        truth: errors.max,
        estimate: picture.estimate?.max,
    })
}
