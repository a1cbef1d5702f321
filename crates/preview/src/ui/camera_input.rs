//! Held keys and the pointer as motions of cameras.
//!
//! In: egui's state of keys, pointer and time. Out: for the 3D camera its next place, for a geodesic camera
//! [`Motion`]s, which its controller makes.

use egui::{InputState, Key, Modifiers};
use glam::DVec2;

use crate::state::SpaceCamera;
use crate::state::motion::Motion;

/// Radii of the scene a second, at the camera speed 1.
const SPACE_SPEED: f64 = 1.0;
/// Lengths of X a second.
const WALK_SPEED: f64 = 0.8;
/// Radians a second.
const TURN_SPEED: f64 = 1.2;
/// The natural logarithm of the zoom, or of the distance, a second.
const ZOOM_SPEED: f64 = 0.9;
/// Distances to the target a second.
const PAN_SPEED: f64 = 0.8;
/// Radians for a drag across a picture's shorter side.
const TURN_DRAG: f64 = 1.2;
/// Radians around the target for a drag across a picture's shorter side.
const ORBIT_DRAG: f64 = 3.2;
/// The natural logarithm of the distance for a point of the wheel.
const WHEEL: f64 = 0.003;
/// The longest time between frames that a camera moves for, in seconds: a slow frame is no leap.
const MAX_STEP: f64 = 0.1;

/// The letters that move cameras.
const LETTERS: [Key; 8] = [
    Key::W,
    Key::S,
    Key::A,
    Key::D,
    Key::Q,
    Key::E,
    Key::Z,
    Key::X,
];
/// The other keys that move cameras, unless a control has the focus, whose keys they may be.
const ARROWS: [Key; 7] = [
    Key::ArrowLeft,
    Key::ArrowRight,
    Key::ArrowUp,
    Key::ArrowDown,
    Key::Plus,
    Key::Equals,
    Key::Minus,
];

/// The keys that move cameras, as they are held in a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held<'a> {
    input: &'a InputState,
    /// The view has the arrows too.
    arrows: bool,
}

impl<'a> Held<'a> {
    /// As the input has them; `arrows` where no control has the focus.
    pub(crate) fn new(input: &'a InputState, arrows: bool) -> Self {
        Self { input, arrows }
    }

    /// Returns whether any is held.
    pub(crate) fn any(self) -> bool {
        let Modifiers {
            alt, ctrl, command, ..
        } = self.input.modifiers;
        // Shortcuts are not motions; with Alt the arrows have a meaning of their own.
        let held = |keys: &[Key]| keys.iter().any(|key| self.input.key_down(*key));
        let letters = !alt && held(&LETTERS);
        !(ctrl || command) && (letters || self.arrows && held(&ARROWS))
    }

    /// Seconds since the last frame, as far as a held key counts them.
    fn seconds(self) -> f64 {
        // The first frame of a held key comes after a pause of any length.
        let pressed = |keys: &[Key]| keys.iter().any(|key| self.input.key_pressed(*key));
        let elapsed = if pressed(&LETTERS) || pressed(&ARROWS) {
            self.input.predicted_dt
        } else {
            self.input.unstable_dt
        };
        f64::from(elapsed).clamp(0.0, MAX_STEP)
    }

    fn axis(self, plus: &[Key], minus: &[Key]) -> f64 {
        let held = |keys: &[Key]| keys.iter().any(|key| self.input.key_down(*key));
        f64::from(u8::from(held(plus))) - f64::from(u8::from(held(minus)))
    }

    /// Returns the direction of two letters: 1, 0 or -1. With Alt they mean nothing here.
    fn letters(self, plus: Key, minus: Key) -> f64 {
        if self.input.modifiers.alt {
            return 0.0;
        }
        self.axis(&[plus], &[minus])
    }

    /// Returns the direction of the arrows: right, up.
    fn arrows(self) -> [f64; 2] {
        if !self.arrows {
            return [0.0; 2];
        }
        [
            self.axis(&[Key::ArrowRight], &[Key::ArrowLeft]),
            self.axis(&[Key::ArrowUp], &[Key::ArrowDown]),
        ]
    }

    /// 1 for nearer, -1 for farther.
    fn nearer(self) -> f64 {
        if !self.arrows {
            return 0.0;
        }
        // Where + is Shift and =, either will do.
        self.axis(&[Key::Plus, Key::Equals], &[Key::Minus])
    }
}

/// Moves the 3D camera by the held keys: it goes, or looks, in the direction of the letters and arrows.
pub(crate) fn space_keys(held: Held<'_>, mut camera: SpaceCamera, speed: f64) -> SpaceCamera {
    if !held.any() {
        return camera;
    }
    let step = held.seconds() * speed;
    let Modifiers { alt, shift, .. } = held.input.modifiers;
    let way = [
        held.letters(Key::D, Key::A),
        held.letters(Key::W, Key::S),
        held.letters(Key::Q, Key::E),
    ];
    if way != [0.0; 3] {
        camera = camera.moved(way.map(|x| x * step * SPACE_SPEED));
    }
    let [x, y] = held.arrows().map(|x| x * step);
    if [x, y] != [0.0; 2] {
        camera = if alt {
            camera.orbited(-x * TURN_SPEED, -y * TURN_SPEED)
        } else if shift {
            camera.panned(DVec2::new(-x, -y) * PAN_SPEED)
        } else {
            camera.turned(x * TURN_SPEED, y * TURN_SPEED)
        };
    }
    let nearer = held.nearer();
    if nearer != 0.0 {
        camera = camera.neared((-nearer * step * ZOOM_SPEED).exp());
    }
    camera
}

/// Returns the motions of a geodesic camera for the held keys.
pub(crate) fn inside_keys(held: Held<'_>, speed: f64) -> Vec<Motion> {
    let mut motions = Vec::new();
    if !held.any() {
        return motions;
    }
    let step = held.seconds() * speed;
    let [right, up] = held.arrows();
    let x = (held.letters(Key::D, Key::A) + right).clamp(-1.0, 1.0);
    let y = (held.letters(Key::W, Key::S) + up).clamp(-1.0, 1.0);
    if x != 0.0 || y != 0.0 {
        let length = x.hypot(y);
        motions.push(Motion::Walk([x, y].map(|k| k / length * step * WALK_SPEED)));
    }
    let turn = held.letters(Key::Q, Key::E);
    if turn != 0.0 {
        motions.push(Motion::Turn(turn * step * TURN_SPEED));
    }
    let out = (held.letters(Key::X, Key::Z) - held.nearer()).clamp(-1.0, 1.0);
    if out != 0.0 {
        motions.push(Motion::Zoom((out * step * ZOOM_SPEED).exp()));
    }
    motions
}

/// A use of the pointer on the 3D view.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Grip {
    /// The camera turns where it stands.
    Turn,
    /// The camera is carried around its target.
    Orbit,
    /// The camera is moved in the picture's plane.
    Pan,
}

/// Moves the 3D camera by a drag in points; `side` is the picture's shorter side in points.
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

/// Returns the factor of the distance, or of the zoom, for the wheel or two fingers: below 1 when the wheel is turned
/// away
/// from the user, or the fingers part; nothing where they rest.
pub(crate) fn nearing(input: &InputState) -> Option<f64> {
    let (turned, pinched) = (input.smooth_scroll_delta().y, input.zoom_delta());
    let factor = (-f64::from(turned) * WHEEL).exp() / f64::from(pinched.max(1e-3));
    (turned != 0.0 || pinched != 1.0).then_some(factor)
}

/// Returns the motion of a geodesic camera for a drag in points: the surface under the pointer goes with it.
pub(crate) fn inside_drag(by: egui::Vec2, side: f32) -> Motion {
    let half = f64::from(0.5 * side.max(1.0));
    Motion::Walk([-f64::from(by.x) / half, f64::from(by.y) / half])
}
