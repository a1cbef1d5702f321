//! Geodesic views as they open, and seeded random surfaces to look at from inside.

use geodesic::frame::Frame;
use geodesic::surface::Surface;
use render::Request;
use render::geodesic_view::Inside;
use scene::scene::{ObjectId, Shape};
use scene::{Scene, Settings};

/// A surface or a metric with the camera that its geodesic view opens with.
#[derive(Clone, Debug)]
pub struct Opening {
    /// The view.
    pub inside: Inside,
}

impl Opening {
    /// What the camera stands on, its params at their opening values.
    pub fn surface(&self) -> &dyn Surface {
        self.inside.ground().surface()
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
    let request = Request::geodesic(ObjectId(index as u32), [512, 512]);
    let inside = Inside::new(scene, &Settings::opening(scene), &request)
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
