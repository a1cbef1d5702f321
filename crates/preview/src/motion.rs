//! Held keys and the pointer as motions of cameras.
//!
//! In: what egui knows of keys, pointer and time. Out: for the 3D camera its next place, for a geodesic camera
//! [`Motion`]s, which its pilot carries out.

use egui::{InputState, Key};
use glam::DVec2;

use crate::model::SpaceCamera;

/// A motion of a geodesic camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Motion {
    /// Along the geodesic with the velocity xX + yY, for the time 1.
    Walk([f64; 2]),
    /// Turned by radians, anticlockwise.
    Turn(f64),
    /// X and Y longer by a factor: what is seen lies farther away.
    Zoom(f64),
}

/// Radii of the scene a second, at the camera speed 1.
const SPACE_SPEED: f64 = 1.0;
/// Lengths of X a second.
const WALK_SPEED: f64 = 0.8;
/// Radians a second.
const TURN_SPEED: f64 = 1.2;
/// The natural logarithm of the zoom a second.
const ZOOM_SPEED: f64 = 0.9;
/// Radians for a drag across a picture's shorter side.
const TURN_DRAG: f64 = 1.2;
/// Radians around the target for a drag across a picture's shorter side.
const ORBIT_DRAG: f64 = 3.2;
/// The natural logarithm of the distance for a point of the wheel.
const WHEEL: f64 = 0.003;
/// The longest time between frames that a camera moves for, in seconds: a slow frame is no leap.
const MAX_STEP: f64 = 0.1;

/// The keys that move cameras.
const KEYS: [Key; 8] = [
    Key::W,
    Key::S,
    Key::A,
    Key::D,
    Key::Q,
    Key::E,
    Key::Z,
    Key::X,
];

/// Whether a key that moves a camera is held.
pub(crate) fn any_held(input: &InputState) -> bool {
    free(input) && KEYS.iter().any(|key| input.key_down(*key))
}

/// Shortcuts with Ctrl are not motions.
fn free(input: &InputState) -> bool {
    let modifiers = input.modifiers;
    !(modifiers.ctrl || modifiers.command || modifiers.alt)
}

/// Seconds since the last frame, as far as a held key counts them.
fn seconds(input: &InputState) -> f64 {
    // The first frame of a held key comes after a pause of any length.
    let pressed = KEYS.iter().any(|key| input.key_pressed(*key));
    let elapsed = if pressed {
        input.predicted_dt
    } else {
        input.unstable_dt
    };
    f64::from(elapsed).clamp(0.0, MAX_STEP)
}

fn axis(input: &InputState, plus: Key, minus: Key) -> f64 {
    f64::from(u8::from(input.key_down(plus))) - f64::from(u8::from(input.key_down(minus)))
}

/// Where held keys bring the 3D camera.
pub(crate) fn space_keys(input: &InputState, camera: SpaceCamera, speed: f64) -> SpaceCamera {
    if !any_held(input) {
        return camera;
    }
    let step = seconds(input) * speed * SPACE_SPEED;
    let right = axis(input, Key::D, Key::A);
    let forward = axis(input, Key::W, Key::S);
    let up = axis(input, Key::Q, Key::E);
    if [right, forward, up] == [0.0; 3] {
        return camera;
    }
    camera.moved([right * step, forward * step, up * step])
}

/// What held keys ask of a geodesic camera.
pub(crate) fn inside_keys(input: &InputState, speed: f64) -> Vec<Motion> {
    let mut motions = Vec::new();
    if !any_held(input) {
        return motions;
    }
    let step = seconds(input) * speed;
    let [x, y] = [axis(input, Key::D, Key::A), axis(input, Key::W, Key::S)];
    if x != 0.0 || y != 0.0 {
        let length = x.hypot(y);
        motions.push(Motion::Walk([x, y].map(|k| k / length * step * WALK_SPEED)));
    }
    let turn = axis(input, Key::Q, Key::E);
    if turn != 0.0 {
        motions.push(Motion::Turn(turn * step * TURN_SPEED));
    }
    let out = axis(input, Key::X, Key::Z);
    if out != 0.0 {
        motions.push(Motion::Zoom((out * step * ZOOM_SPEED).exp()));
    }
    motions
}

/// How the pointer is used on the 3D view.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Grip {
    /// The camera turns where it stands.
    Turn,
    /// The camera is carried around its target.
    Orbit,
    /// The camera is moved in the picture's plane.
    Pan,
}

/// Where a drag by points brings the 3D camera; `side` is the picture's shorter side in points.
pub(crate) fn space_drag(
    camera: SpaceCamera,
    grip: Grip,
    by: egui::Vec2,
    side: f32,
) -> SpaceCamera {
    let side = f64::from(side.max(1.0));
    let [x, y] = [f64::from(by.x) / side, f64::from(by.y) / side];
    match grip {
        // As the thesis has it: the camera looks where the pointer goes.
        Grip::Turn => camera.turned(x * TURN_DRAG, -y * TURN_DRAG),
        Grip::Orbit => camera.orbited(x * ORBIT_DRAG, -y * ORBIT_DRAG),
        Grip::Pan => {
            let tangent = 2.0 * (0.5 * render::style::FIELD_OF_VIEW).tan();
            camera.panned(DVec2::new(x, -y) * tangent)
        }
    }
}

/// The factor of the distance, or of the zoom, that the wheel asks for: below 1 when it is turned away from the user.
pub(crate) fn wheel(points: f32) -> f64 {
    (-f64::from(points) * WHEEL).exp()
}

/// What a drag by points asks of a geodesic camera: what is under the pointer goes with it.
pub(crate) fn inside_drag(by: egui::Vec2, side: f32) -> Motion {
    let half = f64::from(0.5 * side.max(1.0));
    Motion::Walk([-f64::from(by.x) / half, f64::from(by.y) / half])
}

/// Adds a motion to those that wait, joined with the last where that comes to the same.
pub(crate) fn push(motions: &mut Vec<Motion>, next: Motion) {
    match (motions.last_mut(), next) {
        (Some(Motion::Turn(last)), Motion::Turn(by)) => *last += by,
        (Some(Motion::Zoom(last)), Motion::Zoom(by)) => *last *= by,
        (Some(Motion::Walk(last)), Motion::Walk(by))
            if (last[0] * by[1] - last[1] * by[0]).abs() <= 1e-12 =>
        {
            *last = [last[0] + by[0], last[1] + by[1]];
        }
        _ => motions.push(next),
    }
}

#[cfg(test)]
mod tests {
    use super::{Motion, push};

    #[test]
    fn motions_that_wait_are_joined_where_that_comes_to_the_same() {
        let mut motions = Vec::new();
        for motion in [
            Motion::Walk([0.0, 0.1]),
            Motion::Walk([0.0, 0.2]),
            Motion::Walk([0.1, 0.0]),
            Motion::Turn(0.5),
            Motion::Turn(0.25),
            Motion::Zoom(2.0),
            Motion::Zoom(4.0),
        ] {
            push(&mut motions, motion);
        }
        let expected = [
            Motion::Walk([0.0, 0.1 + 0.2]),
            Motion::Walk([0.1, 0.0]),
            Motion::Turn(0.75),
            Motion::Zoom(8.0),
        ];
        assert_eq!(motions, expected);
    }
}
