//! Cameras by held keys and the pointer.
//!
//! A view's options say which camera it has; [`input_of`] returns what moves it. A view without a camera has no keys of
//! its own, and is shown all the same.

mod geodesic;
mod space;

use egui::{InputState, Key, Modifiers, Pos2, Rect, Response, Ui, Vec2};
use render::view::View;
use render::{PictureRequest, ViewId};

use crate::state::Model;
use crate::ui::held_keys::HeldKeys;
use crate::ui::window::Window;

/// Moves the camera of a view.
pub(crate) trait CameraInput {
    /// Moves the camera by the keys of a frame; the arrows are the view's where no control has the focus.
    fn keys(&self, _window: &mut Window, _ui: &Ui, _id: &ViewId, _arrows: bool) {}

    /// Moves the camera by the pointer, and takes clicks on its picture.
    fn pointer(&self, _window: &mut Window, _ui: &Ui, _id: &ViewId, _response: &Response) {}

    /// Puts the camera at its first place.
    fn reset(&self, _window: &mut Window, _id: &ViewId) {}

    /// Returns the place of the camera in words, behind the view's name.
    fn place(&self, _model: &Model, _id: &ViewId) -> Option<String> {
        None
    }
}

/// A view whose camera cannot be moved.
struct Fixed;

impl CameraInput for Fixed {}

/// Returns what moves the camera of a view.
pub(crate) fn input_of(view: Option<&dyn View>) -> &'static dyn CameraInput {
    let options = view.map(|view| view.options(None));
    match options {
        Some(options) if options.space().is_some() => &space::SpaceInput,
        Some(options) if options.geodesic_camera().is_some() => &geodesic::GeodesicInput,
        _ => &Fixed,
    }
}

/// Returns the pixel of a picture, which fills a rectangle, at a point of the screen.
pub(crate) fn pixel(request: &PictureRequest, rect: Rect, at: Pos2) -> [f64; 2] {
    let share = (at - rect.min) / rect.size();
    let [width, height] = request.size.map(f64::from);
    [f64::from(share.x) * width, f64::from(share.y) * height]
}

/// The natural logarithm of the zoom, or of the distance, a second.
const ZOOM_SPEED: f64 = 0.9;
/// Radians a second.
const TURN_SPEED: f64 = 1.2;
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
pub(crate) const ARROWS: [Key; 7] = [
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
    keys: &'a HeldKeys,
    /// The view has the arrows too.
    arrows: bool,
}

impl<'a> Held<'a> {
    /// As the input has them; `arrows` where no control has the focus.
    pub(crate) fn new(input: &'a InputState, keys: &'a HeldKeys, arrows: bool) -> Self {
        Self {
            input,
            keys,
            arrows,
        }
    }

    /// Returns whether any is held.
    pub(crate) fn any(self) -> bool {
        let Modifiers {
            alt, ctrl, command, ..
        } = self.input.modifiers;
        // Shortcuts are not motions; with Alt the arrows have a meaning of their own.
        let held = |keys: &[Key]| keys.iter().any(|key| self.keys.moves(*key));
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
        let held = |keys: &[Key]| keys.iter().any(|key| self.keys.moves(*key));
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

/// Returns the way by which two fingers on a touchpad carry what is under the pointer, in points, where they move.
/// `fingers` is set where what scrolls is not a wheel.
fn carried(input: &InputState, fingers: bool) -> Option<Vec2> {
    let by = input.smooth_scroll_delta();
    (fingers && by != Vec2::ZERO).then_some(by)
}

/// Returns the factor of the distance, or of the zoom, for the wheel or two fingers: below 1 when the wheel is turned
/// away from the user, or the fingers part; nothing where they rest.
fn nearing(input: &InputState, fingers: bool) -> Option<f64> {
    let scrolled = input.smooth_scroll_delta().y;
    let (turned, pinched) = (if fingers { 0.0 } else { scrolled }, input.zoom_delta());
    let factor = (-f64::from(turned) * WHEEL).exp() / f64::from(pinched.max(1e-3));
    (turned != 0.0 || pinched != 1.0).then_some(factor)
}
