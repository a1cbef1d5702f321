//! The sphere of `examples/sphere.gtr` from inside, against great circles in closed form.

use std::f64::consts::{PI, TAU};

use geodesic::ends::Coordinates;
use geodesic::frame::Frame;
use geodesic::map::{Map, pixel_place};
use geodesic::surface::Surface;
use geodesic::trace::Status;

use crate::draw::scene;
use crate::examples;
use crate::inside::{Opening, Random, opening};

/// The sphere's radius.
const RADIUS: f64 = 0.99;

/// The sphere.
pub struct Sphere {
    opening: Opening,
}

/// How far a picture is off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Pixels off by more than one pixel, or without an end.
    pub wrong: usize,
    /// The largest error in pixels.
    pub worst: f64,
}

impl Default for Sphere {
    fn default() -> Self {
        Self::new()
    }
}

impl Sphere {
    /// The example's.
    ///
    /// # Panics
    /// When the example has errors.
    pub fn new() -> Self {
        let opening = opening(&scene(&examples::one("sphere").source));
        Self {
            opening: opening.expect("the example has a surface"),
        }
    }

    /// The surface: (u, v) ∈ `[0,1]²`, v from the north pole.
    pub fn surface(&self) -> &dyn Surface {
        self.opening.surface()
    }

    /// A camera by its number: 0 and 1 stand on the poles, the others anywhere, every tenth within 10⁻⁶ to 10⁻¹ of a
    /// pole, looking in any direction 0.05 to 2π radians far.
    ///
    /// # Panics
    /// When there is no camera there, which would be a mistake.
    pub fn camera(&self, number: u64) -> Frame {
        let mut random = Random(0x5eed ^ number.wrapping_mul(0x1000_0001));
        let v = match number {
            0 => 0.0,
            1 => 1.0,
            n if n % 10 == 0 => {
                let off = 10_f64.powf(random.between(-6.0, -1.0));
                if random.unit() < 0.5 { off } else { 1.0 - off }
            }
            // Evenly on the sphere.
            _ => random.between(-1.0, 1.0).acos() / PI,
        };
        let u = random.unit();
        let angle = random.between(-PI, PI);
        let zoom = RADIUS * 10_f64.powf(random.between(0.05_f64.log10(), TAU.log10()));
        Frame::new(self.surface(), [u, v], angle, zoom)
            .unwrap_or_else(|error| panic!("camera {number} at ({u}, {v}): {error}"))
    }
}

/// Compares every pixel with the great circle that it lies on.
pub fn wrong_pixels(sphere: &Sphere, frame: &Frame, map: &Map) -> Tally {
    let surface = sphere.surface();
    let zoom = frame.zoom(surface);
    let pixel = 2.0 * zoom / f64::from(map.size[0].min(map.size[1]));
    let axes = axes(frame);
    let mut tally = Tally::default();
    for (index, status) in map.status.iter().enumerate() {
        let [width, _] = map.size;
        let (column, row) = (index as u32 % width, index as u32 / width);
        let [x, y] = pixel_place(map.size, column, row).0;
        let share = x.hypot(y);
        let angle = zoom * share / RADIUS;
        let [position, right, up] = axes;
        let direction = [0, 1, 2].map(|k| {
            if share > 0.0 {
                (x * right[k] + y * up[k]) / share
            } else {
                0.0
            }
        });
        let [u, v] = map.uv(index).0;
        let end = point(u, v);
        let gap = (0..3)
            .map(|k| {
                let expected = position[k] * angle.cos() + direction[k] * angle.sin();
                (RADIUS * (expected - end[k])).powi(2)
            })
            .sum::<f64>()
            .sqrt();
        let error = gap / pixel;
        if *status != Status::Complete || error.is_nan() || error > 1.0 {
            tally.wrong += 1;
        }
        tally.worst = tally
            .worst
            .max(if error.is_nan() { f64::INFINITY } else { error });
    }
    tally
}

/// A point of the unit sphere.
fn point(u: f64, v: f64) -> [f64; 3] {
    let ((su, cu), (sv, cv)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
    [sv * cu, sv * su, cv]
}

/// The camera's place and the unit vectors X, Y in space.
fn axes(frame: &Frame) -> [[f64; 3]; 3] {
    let [u, v] = frame.uv.0;
    let ((su, cu), (sv, cv)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
    let position = [sv * cu, sv * su, cv];
    let (east, south) = ([-su, cu, 0.0], [cv * cu, cv * su, -sv]);
    let unit = |w: [f64; 2]| {
        let vector = match frame.coordinates {
            Coordinates::Plain => {
                [0, 1, 2].map(|k| TAU * sv * w[0] * east[k] + PI * w[1] * south[k])
            }
            // About both poles, a runs along the meridian u = 0 and b along u = 1/4.
            Coordinates::Apex { .. } => [w[0], w[1], 0.0],
        };
        let length = vector.iter().map(|a| a * a).sum::<f64>().sqrt();
        vector.map(|a| a / length)
    };
    [position, unit(frame.x.0), unit(frame.y.0)]
}
