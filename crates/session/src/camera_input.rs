//! Cameras moved by held keys and the pointer, in numbers.
//!
//! In: held keys, distances in points, factors and seconds. Out: moved cameras and motions. A window or a page only
//! translates its own events into these numbers, so that every motion is the same in both.

pub mod axis_views;
pub mod geodesic;
pub mod space;

use render::view::View;
use serde::Deserialize;

/// The kind of a view's camera.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum CameraKind {
    /// No movable camera.
    Fixed,
    /// A camera in space, which all views in space share: `Choices::space` of the model.
    Space,
    /// A camera on a surface or a solid: `Choices::inside` of the model.
    Geodesic,
}

impl CameraKind {
    /// Returns the kind of camera of a view; [`CameraKind::Fixed`] where there is no view.
    pub fn of(view: Option<&dyn View>) -> Self {
        match view.map(|view| view.options(None)) {
            Some(options) if options.space().is_some() => Self::Space,
            Some(options) if options.geodesic_camera().is_some() => Self::Geodesic,
            _ => Self::Fixed,
        }
    }
}

/// Returns the pixel of a picture of `size` pixels, scaled to a rectangle of `room` points, at a point `at` from the
/// upper left corner of the rectangle.
pub fn pixel(size: [u32; 2], room: [f64; 2], at: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|axis| at[axis] / room[axis] * f64::from(size[axis]))
}

/// The change of the natural logarithm of the zoom, or of the distance, per second.
const ZOOM_SPEED: f64 = 0.9;
/// Radians per second.
const TURN_SPEED: f64 = 1.2;
/// The change of the natural logarithm of the distance per point of the wheel.
const WHEEL: f64 = 0.003;
/// The maximum time for which cameras and params move between frames, in seconds, so that they do not jump after a slow
/// frame.
pub const MAX_STEP: f64 = 0.1;
/// The time for which a view counts as moving after its last motion, such as between two turns of a wheel, in seconds.
pub const MOTION_PAUSE: f64 = 0.18;

/// A key that moves cameras. The page's messages name it "w", "left", "plus".
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "camelCase")]
pub enum CameraKey {
    /// Forward.
    W,
    /// Back.
    S,
    /// To the left.
    A,
    /// To the right.
    D,
    /// Up in space; a turn to the left on a surface.
    Q,
    /// Down in space; a turn to the right on a surface.
    E,
    /// Nearer, on a surface.
    Z,
    /// Farther, on a surface.
    X,
    /// The left arrow.
    Left,
    /// The right arrow.
    Right,
    /// The up arrow.
    Up,
    /// The down arrow.
    Down,
    /// Nearer: the + key, with or without Shift.
    Plus,
    /// Farther: the − key.
    Minus,
}

impl CameraKey {
    /// All keys.
    pub const ALL: [Self; 14] = [
        Self::W,
        Self::S,
        Self::A,
        Self::D,
        Self::Q,
        Self::E,
        Self::Z,
        Self::X,
        Self::Left,
        Self::Right,
        Self::Up,
        Self::Down,
        Self::Plus,
        Self::Minus,
    ];

    /// Returns whether it is a letter. The other keys move cameras only if no control, which may use them itself, has
    /// the focus.
    pub fn is_letter(self) -> bool {
        match self {
            Self::W | Self::S | Self::A | Self::D | Self::Q | Self::E | Self::Z | Self::X => true,
            Self::Left | Self::Right | Self::Up | Self::Down | Self::Plus | Self::Minus => false,
        }
    }

    fn bit(self) -> u16 {
        1 << self as u16
    }
}

/// The held modifier keys.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Modifiers {
    /// Shift.
    pub shift: bool,
    /// Alt.
    pub alt: bool,
    /// Ctrl, or the Command key of a Mac.
    pub command: bool,
}

/// The camera keys that are held in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Held {
    keys: u16,
    modifiers: Modifiers,
    seconds: f64,
}

impl Held {
    /// Returns the keys for which `is_held` returns true. `arrows` is true if no control has the focus: otherwise only
    /// letters count. `elapsed` is the time since the last frame in seconds. If a key was pressed since then, it is the
    /// typical time of a frame, because the first frame of a motion may follow a pause of any length.
    pub fn new(
        is_held: impl Fn(CameraKey) -> bool,
        arrows: bool,
        modifiers: Modifiers,
        elapsed: f64,
    ) -> Self {
        // Shortcuts are not motions. With Alt, the arrows have another meaning, and the letters have none.
        let counts = |key: &CameraKey| {
            !modifiers.command
                && if key.is_letter() {
                    !modifiers.alt
                } else {
                    arrows
                }
        };
        let keys = CameraKey::ALL.into_iter().filter(counts);
        let held = keys.filter(|key| is_held(*key));
        Self {
            keys: held.fold(0, |all, key| all | key.bit()),
            modifiers,
            seconds: elapsed.clamp(0.0, MAX_STEP),
        }
    }

    /// Returns whether any key is held.
    pub fn any(self) -> bool {
        self.keys != 0
    }

    /// Returns the direction of two keys: 1, 0 or −1.
    fn direction(self, plus: CameraKey, minus: CameraKey) -> f64 {
        let held = |key: CameraKey| f64::from(u8::from(self.keys & key.bit() != 0));
        held(plus) - held(minus)
    }

    /// Returns the direction of the arrow keys: right, up.
    fn arrows(self) -> [f64; 2] {
        [
            self.direction(CameraKey::Right, CameraKey::Left),
            self.direction(CameraKey::Up, CameraKey::Down),
        ]
    }

    /// Returns 1 for nearer, −1 for farther.
    fn nearer(self) -> f64 {
        self.direction(CameraKey::Plus, CameraKey::Minus)
    }
}

/// The scrolling of a wheel, or of two fingers on a touchpad, in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scroll {
    /// The distance by which the picture under the pointer is to move, in points: to the right and down.
    pub by: [f64; 2],
    /// The factor by which two fingers have moved apart: 1 if they have not.
    pub pinched: f64,
    /// True if two fingers scroll, and not a wheel.
    pub fingers: bool,
}

impl Scroll {
    /// Returns the distance by which two fingers drag the picture under the pointer, in points; `None` if they rest.
    pub fn carried(&self) -> Option<[f64; 2]> {
        (self.fingers && self.by != [0.0; 2]).then_some(self.by)
    }

    /// Returns the factor of the distance, or of the zoom: below 1 when the wheel is turned away from the user, or the
    /// fingers move apart; `None` if they rest.
    pub fn nearing(&self) -> Option<f64> {
        let turned = if self.fingers { 0.0 } else { self.by[1] };
        let factor = (-turned * WHEEL).exp() / self.pinched.max(1e-3);
        (turned != 0.0 || self.pinched != 1.0).then_some(factor)
    }
}

#[cfg(test)]
mod tests {
    use super::{CameraKey, Held, Modifiers, Scroll, pixel};

    #[test]
    fn shortcuts_are_no_motions_and_arrows_may_belong_to_a_control() {
        let held = |arrows, modifiers| Held::new(|_| true, arrows, modifiers, 1.0);
        let plain = Modifiers::default();
        let command = Modifiers {
            command: true,
            ..plain
        };
        let alt = Modifiers { alt: true, ..plain };
        assert!(!held(true, command).any());
        assert!(held(false, plain).any() && !held(false, alt).any() && held(true, alt).any());
        let one = |key| Held::new(|it| it == key, true, plain, 1.0);
        assert_eq!(one(CameraKey::Up).arrows(), [0.0, 1.0]);
        assert_eq!(one(CameraKey::Minus).nearer(), -1.0);
        assert_eq!(held(true, plain).nearer(), 0.0, "both");
        assert_eq!(one(CameraKey::W).seconds, 0.1, "a slow frame is no leap");
        let letters = CameraKey::ALL.into_iter().filter(|key| key.is_letter());
        assert_eq!(letters.count(), 8);
    }

    #[test]
    fn a_wheel_comes_nearer_and_fingers_carry() {
        let wheel = Scroll {
            by: [0.0, 100.0],
            pinched: 1.0,
            fingers: false,
        };
        assert_eq!(wheel.carried(), None);
        assert!((wheel.nearing().expect("it turns") - (-0.3f64).exp()).abs() < 1e-15);
        let fingers = Scroll {
            fingers: true,
            ..wheel
        };
        assert_eq!(
            (fingers.carried(), fingers.nearing()),
            (Some([0.0, 100.0]), None)
        );
        let pinched = Scroll {
            by: [0.0; 2],
            pinched: 2.0,
            fingers: true,
        };
        assert_eq!((pinched.carried(), pinched.nearing()), (None, Some(0.5)));
    }

    #[test]
    fn a_pixel_is_as_far_from_the_corner_as_the_pointer() {
        assert_eq!(
            pixel([200, 100], [400.0, 400.0], [100.0, 200.0]),
            [50.0, 50.0]
        );
    }
}
