//! Cameras, and the places of samples.
//!
//! Input: a camera, a pixel, the number of a sample. Output: a ray. Samples lie on additive sequences whose steps are the
//! powers of 1/φ with φᵈ⁺¹ = φ + 1 (M. Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018), as
//! integers over 2³²: the same on every machine and for any number of threads.

use glam::DVec3;

/// A camera with a thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensCamera {
    /// The lens' centre.
    pub position: DVec3,
    /// The direction of the picture's centre.
    pub direction: DVec3,
    /// The vertical opening in radians.
    pub fov: f64,
    /// The turn of the picture's up towards its right, in radians.
    pub roll: f64,
    /// The distance of the plane that is sharp.
    pub focus: f64,
    /// The lens' radius.
    pub aperture: f64,
}

/// The steps in two dimensions.
const STEPS_2: [u32; 2] = [3_242_174_889, 2_447_445_413];
/// The steps in four dimensions.
const STEPS_4: [u32; 4] = [3_679_390_609, 3_152_041_523, 2_700_274_806, 2_313_257_605];

/// The places of a sample in its pixel and, with a lens, on it: numbers from 0 to 1.
pub fn sample(pixel: [u32; 2], sample: u32, lens: bool) -> [f64; 4] {
    let mut places = [0.5; 4];
    let steps: &[u32] = if lens { &STEPS_4 } else { &STEPS_2 };
    for (axis, (place, step)) in places.iter_mut().zip(steps).enumerate() {
        let start = if axis < 2 {
            1 << 31
        } else {
            hash(pixel, axis as u32)
        };
        *place = f64::from(step.wrapping_mul(sample).wrapping_add(start)) / 2f64.powi(32);
    }
    places
}

impl LensCamera {
    /// The start and unit direction of the ray through a place of the picture, `x` to the right and `y` down in pixels,
    /// and a place on the lens, two numbers from 0 to 1.
    pub fn ray(&self, size: [u32; 2], [x, y]: [f64; 2], [u, v]: [f64; 2]) -> (DVec3, DVec3) {
        let [right, up, forward] = self.axes();
        let scale = 2.0 * (0.5 * self.fov).tan() / f64::from(size[1]);
        let across = (x - 0.5 * f64::from(size[0])) * scale;
        let upward = (0.5 * f64::from(size[1]) - y) * scale;
        let direction = forward + across * right + upward * up;
        if self.aperture <= 0.0 {
            return (self.position, direction.normalize());
        }
        let (radius, turn) = (self.aperture * u.sqrt(), std::f64::consts::TAU * v);
        let offset = radius * (turn.cos() * right + turn.sin() * up);
        let sharp = self.focus * direction;
        (self.position + offset, (sharp - offset).normalize())
    }

    /// The picture's right and up, and the direction of its centre.
    fn axes(&self) -> [DVec3; 3] {
        let forward = self.direction.normalize_or(DVec3::Y);
        // Straight up or down, the picture's up is y.
        let vertical = forward.x == 0.0 && forward.y == 0.0;
        let upward = if vertical { DVec3::Y } else { DVec3::Z };
        let right = forward.cross(upward).normalize();
        let up = right.cross(forward);
        let (sin, cos) = self.roll.sin_cos();
        [cos * right - sin * up, cos * up + sin * right, forward]
    }
}

/// Mixes the coordinates of a pixel and an axis.
fn hash(pixel: [u32; 2], axis: u32) -> u32 {
    let mut mixed = 0x9e37_79b9u32;
    for part in [pixel[0], pixel[1], axis] {
        mixed ^= part;
        mixed = (mixed ^ (mixed >> 16)).wrapping_mul(0x7feb_352d);
        mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x846c_a68b);
        mixed ^= mixed >> 16;
    }
    mixed
}
