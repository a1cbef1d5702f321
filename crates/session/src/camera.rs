//! The camera of the views in space: its position, and its motions.

use glam::{DVec2, DVec3};
use render::camera::{is_vertical, upright};
use serde::{Deserialize, Serialize};

/// The camera of the 3D view, in the scene's units; up is z.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SpaceCamera {
    /// Its position.
    pub eye: [f64; 3],
    /// The point at which it looks, and about which it turns.
    pub target: [f64; 3],
    /// The scene's radius: one unit of the camera's speed.
    pub radius: f64,
    /// True if the user has moved it; otherwise it is placed anew when a scene changes.
    #[serde(default)]
    pub moved: bool,
    /// The tangent of half the field of view along the picture's shorter side.
    #[serde(default = "usual_tangent")]
    pub tangent: f64,
    /// The angle by which the picture's right is turned towards its up, in radians.
    #[serde(default)]
    pub roll: f64,
}

/// Returns the tangent of half the field of view where no camera is declared.
fn usual_tangent() -> f64 {
    (0.5 * render::style::FIELD_OF_VIEW).tan()
}

/// The minimum angle between the camera's direction and straight up or down, in radians.
const POLE: f64 = 0.01;

impl SpaceCamera {
    /// Returns whether a picture can be drawn from it.
    pub fn is_sane(&self) -> bool {
        let all = [self.eye, self.target].concat();
        all.iter().all(|x| x.is_finite() && x.abs() < 1e100)
            && self.distance() > 0.0
            && self.radius > 0.0
            && self.radius.is_finite()
            && self.tangent.is_finite()
            && self.tangent > 0.0
            && self.roll.is_finite()
    }

    fn distance(&self) -> f64 {
        DVec3::from(self.target).distance(DVec3::from(self.eye))
    }

    /// Returns the length of the picture's shorter side in the plane of the target.
    pub fn side_seen(&self) -> f64 {
        2.0 * self.distance() * self.tangent
    }

    /// Returns the vertical field of view in a picture of some size, in radians.
    pub fn vertical_fov(&self, [width, height]: [u32; 2]) -> f64 {
        let shorter = width.min(height).max(1);
        2.0 * (self.tangent * f64::from(height) / f64::from(shorter)).atan()
    }

    /// Returns the unit vector along which it looks.
    fn forward(&self) -> DVec3 {
        (DVec3::from(self.target) - DVec3::from(self.eye)).normalize_or(DVec3::NEG_Y)
    }

    /// Returns the horizontal unit vector to the right, without the roll.
    fn right(&self) -> DVec3 {
        upright(-self.forward())[0]
    }

    /// Returns the unit vectors to the right and up in the picture, and from the target to the eye.
    pub fn axes(&self) -> [DVec3; 3] {
        let (level, back) = (self.right(), -self.forward());
        let (sin, cos) = self.roll.sin_cos();
        let right = cos * level + sin * back.cross(level);
        [right, back.cross(right), back]
    }

    /// Returns the camera with its picture turned so that this unit vector is to the right.
    #[must_use]
    pub(crate) fn rolled(self, right: DVec3) -> Self {
        let [level, up, _] = Self { roll: 0.0, ..self }.axes();
        let roll = right.dot(up).atan2(right.dot(level));
        Self { roll, ..self }
    }

    /// Returns the camera turned about its target, with its eye in a direction: a vector from the target to the eye.
    #[must_use]
    pub fn seen_from(self, direction: DVec3) -> Self {
        let target = DVec3::from(self.target);
        let back = direction.normalize_or(DVec3::NEG_Y);
        self.with(target + back * self.distance(), target)
    }

    /// Returns the azimuth and elevation of its direction, in radians.
    fn angles(&self) -> [f64; 2] {
        let forward = self.forward();
        if is_vertical(forward) {
            // Seen from straight above, y is up in the picture: it is ahead. Seen from below, it is behind.
            return [
                -forward.z.signum() * std::f64::consts::FRAC_PI_2,
                forward.z.signum() * (std::f64::consts::FRAC_PI_2 - POLE),
            ];
        }
        [
            forward.y.atan2(forward.x),
            forward.z.clamp(-1.0, 1.0).asin(),
        ]
    }

    fn direction([azimuth, elevation]: [f64; 2]) -> DVec3 {
        let most = std::f64::consts::FRAC_PI_2 - POLE;
        let elevation = elevation.clamp(-most, most);
        let (sin, cos) = azimuth.sin_cos();
        DVec3::new(
            cos * elevation.cos(),
            sin * elevation.cos(),
            elevation.sin(),
        )
    }

    fn with(self, eye: DVec3, target: DVec3) -> Self {
        let next = Self {
            eye: eye.into(),
            target: target.into(),
            moved: true,
            ..self
        };
        if next.is_sane() { next } else { self }
    }

    /// Returns the step in the picture's plane, to the right and up, in fractions of the distance to its target.
    fn in_plane(&self, by: DVec2) -> DVec3 {
        let [right, up, _] = self.axes();
        (right * by.x + up * by.y) * self.distance()
    }

    /// Returns the camera moved by a number of radii: right, forward, and up in the world.
    #[must_use]
    pub fn moved(self, by: [f64; 3]) -> Self {
        let [right, forward, up] = by.map(|x| x * self.radius);
        let step = self.right() * right + self.forward() * forward + DVec3::Z * up;
        self.with(
            DVec3::from(self.eye) + step,
            DVec3::from(self.target) + step,
        )
    }

    /// Returns the camera turned in place, by radians to the right and up.
    #[must_use]
    pub fn turned(self, right: f64, up: f64) -> Self {
        let [azimuth, elevation] = self.angles();
        let ahead = Self::direction([azimuth - right, elevation + up]) * self.distance();
        self.with(self.eye.into(), DVec3::from(self.eye) + ahead)
    }

    /// Returns the camera carried around its target, by radians: the objects in front turn to the right and down with
    /// the pointer.
    #[must_use]
    pub fn orbited(self, right: f64, up: f64) -> Self {
        let [azimuth, elevation] = self.angles();
        let ahead = Self::direction([azimuth - right, elevation + up]) * self.distance();
        self.with(DVec3::from(self.target) - ahead, self.target.into())
    }

    /// Returns the camera moved in the picture's plane, in fractions of the distance to its target: the picture follows
    /// `by`.
    #[must_use]
    pub(crate) fn panned(self, by: DVec2) -> Self {
        let step = self.in_plane(-by);
        self.with(
            DVec3::from(self.eye) + step,
            DVec3::from(self.target) + step,
        )
    }

    /// Returns the camera at the distance of `home`, from which everything is seen, with its own direction.
    #[must_use]
    pub fn framed(self, home: &Self) -> Self {
        let target = DVec3::from(home.target);
        let camera = Self {
            radius: home.radius,
            ..self
        };
        // A ball of radius 1 that touches the sides of the picture is at a distance of 1 over this.
        let sine = |tangent: f64| tangent.atan().sin();
        let distance = home.distance() * sine(home.tangent) / sine(self.tangent);
        camera.with(target - self.forward() * distance, target)
    }

    /// Returns the camera nearer by a factor below 1, or farther by one above, to the point `towards` in the plane of
    /// the target: to the right and up, in fractions of the distance. The picture does not move at that point.
    #[must_use]
    pub fn neared(self, factor: f64, towards: DVec2) -> Self {
        let (eye, target) = (DVec3::from(self.eye), DVec3::from(self.target));
        let distance = self.distance();
        let next = (distance * factor).clamp(1e-6 * self.radius, 1e6 * self.radius);
        let place = target + self.in_plane(towards);
        let near = |from: DVec3| place + (from - place) * (next / distance);
        // At the picture's centre the target stays exactly as it is.
        let ahead = if towards == DVec2::ZERO {
            target
        } else {
            near(target)
        };
        self.with(near(eye), ahead)
    }
}
