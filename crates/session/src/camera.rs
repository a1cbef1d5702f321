//! The camera of the views in space: where it stands, and how it is moved.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// The camera of the 3D view, in the scene's units; up is z.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SpaceCamera {
    /// Its place.
    pub eye: [f64; 3],
    /// The place that it looks at, and turns around.
    pub target: [f64; 3],
    /// The scene's radius: one unit of the camera's speed.
    pub radius: f64,
    /// The user has moved it; otherwise it is put anew where a scene changes.
    #[serde(default)]
    pub moved: bool,
    /// The tangent of half the field of view along the picture's shorter side.
    #[serde(default = "usual_tangent")]
    pub tangent: f64,
}

/// The tangent of half the field of view where no camera is declared.
fn usual_tangent() -> f64 {
    (0.5 * render::style::FIELD_OF_VIEW).tan()
}

/// The level part of a unit vector up to which it points straight up or down, as in `render::camera`.
const LEVEL: f64 = 1e-6;
/// The angle by which the camera keeps from straight up and down, in radians.
const POLE: f64 = 0.01;

impl SpaceCamera {
    /// Returns whether it can be drawn with.
    pub fn is_sane(&self) -> bool {
        let all = [self.eye, self.target].concat();
        all.iter().all(|x| x.is_finite() && x.abs() < 1e100)
            && self.distance() > 0.0
            && self.radius > 0.0
            && self.radius.is_finite()
            && self.tangent.is_finite()
            && self.tangent > 0.0
    }

    fn distance(&self) -> f64 {
        DVec3::from(self.target).distance(DVec3::from(self.eye))
    }

    /// The shorter side of what is seen in the plane of its target.
    pub fn side_seen(&self) -> f64 {
        2.0 * self.distance() * self.tangent
    }

    /// The unit vector that it looks along.
    fn forward(&self) -> DVec3 {
        (DVec3::from(self.target) - DVec3::from(self.eye)).normalize_or(DVec3::NEG_Y)
    }

    /// The unit vector to the right, level; from straight above it is x, and from below −x: y is up in the picture.
    fn right(&self) -> DVec3 {
        let forward = self.forward();
        let upright = DVec3::X * -forward.z.signum();
        if forward.x.hypot(forward.y) < LEVEL {
            return upright;
        }
        forward.cross(DVec3::Z).normalize_or(upright)
    }

    /// Returns the unit vectors to the right, up, and from the target to the eye.
    pub fn axes(&self) -> [DVec3; 3] {
        let (right, back) = (self.right(), -self.forward());
        [right, back.cross(right), back]
    }

    /// Returns it turned about its target, seen from a direction: a vector from the target to the eye.
    #[must_use]
    pub fn seen_from(self, direction: DVec3) -> Self {
        let target = DVec3::from(self.target);
        let back = direction.normalize_or(DVec3::NEG_Y);
        self.with(target + back * self.distance(), target)
    }

    /// Azimuth and elevation of where it looks, in radians.
    fn angles(&self) -> [f64; 2] {
        let forward = self.forward();
        if forward.x.hypot(forward.y) < LEVEL {
            // Seen from straight above, y is up in the picture: it is what lies ahead. From below it lies behind.
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

    /// The step in the picture's plane, to the right and up, in shares of the distance to its target.
    fn in_plane(&self, by: DVec2) -> DVec3 {
        let right = self.right();
        let up = right.cross(self.forward());
        (right * by.x + up * by.y) * self.distance()
    }

    /// Moved by so many radii: right, forward, and up in the world.
    #[must_use]
    pub fn moved(self, by: [f64; 3]) -> Self {
        let [right, forward, up] = by.map(|x| x * self.radius);
        let step = self.right() * right + self.forward() * forward + DVec3::Z * up;
        self.with(
            DVec3::from(self.eye) + step,
            DVec3::from(self.target) + step,
        )
    }

    /// Returns it turned on its place, by radians to the right and up.
    #[must_use]
    pub fn turned(self, right: f64, up: f64) -> Self {
        let [azimuth, elevation] = self.angles();
        let ahead = Self::direction([azimuth - right, elevation + up]) * self.distance();
        self.with(self.eye.into(), DVec3::from(self.eye) + ahead)
    }

    /// Carried around its target, by radians: what lies before it turns to the right and down as the pointer does.
    #[must_use]
    pub fn orbited(self, right: f64, up: f64) -> Self {
        let [azimuth, elevation] = self.angles();
        let ahead = Self::direction([azimuth - right, elevation + up]) * self.distance();
        self.with(DVec3::from(self.target) - ahead, self.target.into())
    }

    /// Moved in the picture's plane, in shares of the distance to its target: what is there is carried along.
    #[must_use]
    pub fn panned(self, by: DVec2) -> Self {
        let step = self.in_plane(-by);
        self.with(
            DVec3::from(self.eye) + step,
            DVec3::from(self.target) + step,
        )
    }

    /// Returns it at the distance of `home`, from which everything is seen, in its own direction.
    #[must_use]
    pub fn framed(self, home: &Self) -> Self {
        let target = DVec3::from(home.target);
        let camera = Self {
            radius: home.radius,
            ..self
        };
        camera.with(target - self.forward() * home.distance(), target)
    }

    /// Nearer by a factor below 1, farther by one above, to the place at `towards` in the plane of the target: to the
    /// right and up, in shares of the distance. Whatever is seen there stays there in the picture.
    #[must_use]
    pub fn neared(self, factor: f64, towards: DVec2) -> Self {
        let (eye, target) = (DVec3::from(self.eye), DVec3::from(self.target));
        let distance = self.distance();
        let next = (distance * factor).clamp(1e-6 * self.radius, 1e6 * self.radius);
        let place = target + self.in_plane(towards);
        let near = |from: DVec3| place + (from - place) * (next / distance);
        // In the middle of the picture the target stays as it is, to the last digit.
        let ahead = if towards == DVec2::ZERO {
            target
        } else {
            near(target)
        };
        self.with(near(eye), ahead)
    }
}
