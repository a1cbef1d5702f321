//! The camera in space: it moves, turns, and is carried around its target.

use glam::DVec2;

use super::{CameraKey, Held, Modifiers, TURN_SPEED, ZOOM_SPEED};
use crate::camera::SpaceCamera;
use crate::model::Model;

/// Radii of the scene per second, at the camera speed 1.
const SPEED: f64 = 1.0;
/// Distances to the target per second.
const PAN_SPEED: f64 = 0.8;
/// Radians for a drag across a picture's shorter side.
const TURN_DRAG: f64 = 1.2;
/// Radians around the target for a drag across a picture's shorter side: half a turn.
const ORBIT_DRAG: f64 = std::f64::consts::PI;

/// A use of the pointer on a view in space.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Grip {
    /// The camera turns in place.
    Turn,
    /// The camera is carried around its target.
    Orbit,
    /// The camera is moved in the picture's plane.
    Pan,
}

impl Grip {
    /// Returns the effect of a drag: with the primary button, or with another one. `fly` swaps the effects with and
    /// without Alt.
    pub fn of(is_primary: bool, modifiers: Modifiers, fly: bool) -> Self {
        if !is_primary || modifiers.shift {
            Self::Pan
        } else if modifiers.alt == fly {
            Self::Orbit
        } else {
            Self::Turn
        }
    }
}

/// Moves the camera by a drag in points, to the right and down; `side` is the picture's shorter side in points.
#[must_use]
pub fn dragged(camera: SpaceCamera, grip: Grip, by: [f64; 2], side: f64) -> SpaceCamera {
    let [x, y] = by.map(|x| x / side.max(1.0));
    match grip {
        // As in the thesis: the camera looks where the pointer moves.
        Grip::Turn => camera.turned(x * TURN_DRAG, -y * TURN_DRAG),
        Grip::Orbit => camera.orbited(x * ORBIT_DRAG, -y * ORBIT_DRAG),
        Grip::Pan => camera.panned(in_plane(by, side, &camera)),
    }
}

/// Returns the camera nearer by a factor below 1, or farther by one above, towards a point of the picture: its position
/// from the centre in points, to the right and down. `side` is the picture's shorter side in points.
#[must_use]
pub fn neared(camera: SpaceCamera, factor: f64, at: [f64; 2], side: f64) -> SpaceCamera {
    camera.neared(factor, in_plane(at, side, &camera))
}

/// Converts a distance in points into one in the plane of the target, to the right and up, in fractions of the distance
/// to it.
fn in_plane(by: [f64; 2], side: f64, camera: &SpaceCamera) -> DVec2 {
    DVec2::new(by[0], -by[1]) * (2.0 * camera.tangent) / side.max(1.0)
}

/// Moves or turns the camera by the held keys, in the direction of the letters and arrows. `speed` is that of the
/// preferences. If lines of sight are parallel, moving forward would change nothing: the camera comes nearer instead.
#[must_use]
pub fn moved_by_keys(
    mut camera: SpaceCamera,
    held: Held,
    speed: f64,
    is_parallel: bool,
) -> SpaceCamera {
    if !held.any() {
        return camera;
    }
    let step = held.seconds * speed;
    let mut way = [
        held.direction(CameraKey::D, CameraKey::A),
        held.direction(CameraKey::W, CameraKey::S),
        held.direction(CameraKey::Q, CameraKey::E),
    ];
    if is_parallel && way[1] != 0.0 {
        let factor = (-way[1] * step * ZOOM_SPEED).exp();
        camera = camera.neared(factor, DVec2::ZERO);
        way[1] = 0.0;
    }
    if way != [0.0; 3] {
        camera = camera.moved(way.map(|x| x * step * SPEED));
    }
    let [x, y] = held.arrows().map(|x| x * step);
    if [x, y] != [0.0; 2] {
        camera = if held.modifiers.alt {
            camera.orbited(-x * TURN_SPEED, -y * TURN_SPEED)
        } else if held.modifiers.shift {
            camera.panned(DVec2::new(-x, -y) * PAN_SPEED)
        } else {
            camera.turned(x * TURN_SPEED, y * TURN_SPEED)
        };
    }
    let nearer = held.nearer();
    if nearer != 0.0 {
        camera = camera.neared((-nearer * step * ZOOM_SPEED).exp(), DVec2::ZERO);
    }
    camera
}

/// Returns the position of the camera in words, to follow a view's name; `None` if there is no camera, or no scene,
/// yet.
pub fn place(model: &Model) -> Option<String> {
    let eye = model.choices.space?.eye;
    let [x, y, z] = model.scene.as_ref()?.stated(eye);
    Some(format!(", seen from ({x:.2}, {y:.2}, {z:.2})"))
}

#[cfg(test)]
mod tests {
    use super::{Grip, dragged, moved_by_keys, neared};
    use crate::camera::SpaceCamera;
    use crate::camera_input::{CameraKey, Held, Modifiers};

    /// A camera that looks along y from a distance of 4.
    const CAMERA: SpaceCamera = SpaceCamera {
        eye: [0.0, -4.0, 0.0],
        target: [0.0; 3],
        radius: 2.0,
        moved: false,
        tangent: 0.5,
        roll: 0.0,
    };

    fn close(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
    }

    #[test]
    fn what_a_drag_does_depends_on_the_button_and_the_modifiers() {
        let plain = Modifiers::default();
        let alt = Modifiers { alt: true, ..plain };
        let shift = Modifiers {
            shift: true,
            ..plain
        };
        for (is_primary, modifiers, fly, expected) in [
            (true, plain, false, Grip::Orbit),
            (true, alt, false, Grip::Turn),
            (true, plain, true, Grip::Turn),
            (true, alt, true, Grip::Orbit),
            (true, shift, false, Grip::Pan),
            (false, plain, true, Grip::Pan),
        ] {
            assert_eq!(Grip::of(is_primary, modifiers, fly), expected);
        }
    }

    #[test]
    fn what_is_under_the_pointer_goes_with_it() {
        // The shorter side, 100 points, shows 4 in the plane of the target.
        let panned = dragged(CAMERA, Grip::Pan, [50.0, 0.0], 100.0);
        assert!(close(panned.eye, [-2.0, -4.0, 0.0]), "{panned:?}");
        // Half around after a drag across the side.
        let around = dragged(CAMERA, Grip::Orbit, [100.0, 0.0], 100.0);
        assert!(close(around.eye, [0.0, 4.0, 0.0]), "{around:?}");
        let turned = dragged(CAMERA, Grip::Turn, [10.0, 0.0], 100.0);
        assert!(close(turned.eye, CAMERA.eye) && turned.target[0] > 0.0);
        // Twice as near towards a point a quarter of the side to the right and up: (1, 0, 1).
        let near = neared(CAMERA, 0.5, [25.0, -25.0], 100.0);
        assert!(close(near.eye, [0.5, -2.0, 0.5]), "{near:?}");
    }

    #[test]
    fn held_keys_go_with_the_time_and_the_speed() {
        let held = |key| Held::new(|it| it == key, true, Modifiers::default(), 0.05);
        let forward = moved_by_keys(CAMERA, held(CameraKey::W), 2.0, false);
        assert!(close(forward.eye, [0.0, -3.8, 0.0]), "{forward:?}");
        let parallel = moved_by_keys(CAMERA, held(CameraKey::W), 2.0, true);
        assert!(close(parallel.eye, [0.0, -4.0 * (-0.09f64).exp(), 0.0]));
        assert_eq!(parallel.target, CAMERA.target);
        let up = moved_by_keys(CAMERA, held(CameraKey::Q), 2.0, false);
        assert!(close(up.eye, [0.0, -4.0, 0.2]), "{up:?}");
        assert_eq!(moved_by_keys(CAMERA, Held::default(), 2.0, false), CAMERA);
    }
}
