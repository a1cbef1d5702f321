//! Cameras by held keys and the pointer: egui's events become numbers, from which `session::camera_input` makes motions.
//!
//! A view's options say which camera it has; [`input_of`] returns what moves it. A view without a camera has no keys of
//! its own, and is shown all the same.

mod geodesic;
mod space;

use egui::{InputState, Key, Pos2, Rect, Response, Ui, Vec2};
use render::view::View;
use render::{PictureRequest, ViewId};
use session::Model;
use session::camera_input::{self, CameraKey, CameraKind, Held, Modifiers, Scroll};

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
    match CameraKind::of(view) {
        CameraKind::Space => &space::SpaceInput,
        CameraKind::Geodesic => &geodesic::GeodesicInput,
        CameraKind::Fixed => &Fixed,
    }
}

/// Returns the pixel of a picture, which fills a rectangle, at a point of the screen.
pub(crate) fn pixel(request: &PictureRequest, rect: Rect, at: Pos2) -> [f64; 2] {
    camera_input::pixel(request.size, numbers(rect.size()), numbers(at - rect.min))
}

/// Returns a way in points as numbers.
fn numbers(way: Vec2) -> [f64; 2] {
    [way.x, way.y].map(f64::from)
}

/// Returns the shorter side of a rectangle in points.
fn shorter_side(rect: Rect) -> f64 {
    f64::from(rect.width().min(rect.height()))
}

/// Returns the names under which a key that moves cameras may come.
fn names(key: CameraKey) -> &'static [Key] {
    match key {
        CameraKey::W => &[Key::W],
        CameraKey::S => &[Key::S],
        CameraKey::A => &[Key::A],
        CameraKey::D => &[Key::D],
        CameraKey::Q => &[Key::Q],
        CameraKey::E => &[Key::E],
        CameraKey::Z => &[Key::Z],
        CameraKey::X => &[Key::X],
        CameraKey::Left => &[Key::ArrowLeft],
        CameraKey::Right => &[Key::ArrowRight],
        CameraKey::Up => &[Key::ArrowUp],
        CameraKey::Down => &[Key::ArrowDown],
        // Where + is Shift and =, either will do.
        CameraKey::Plus => &[Key::Plus, Key::Equals],
        CameraKey::Minus => &[Key::Minus],
    }
}

/// Returns whether a key moves cameras only where no control has the focus, whose key it may be.
pub(crate) fn may_be_of_control(key: Key) -> bool {
    let mut others = CameraKey::ALL.into_iter().filter(|it| !it.is_letter());
    others.any(|it| names(it).contains(&key))
}

/// Returns whether a key that moves cameras goes down.
pub(crate) fn presses_camera_key(input: &InputState) -> bool {
    let mut all = CameraKey::ALL.into_iter().flat_map(names);
    all.any(|key| input.key_pressed(*key))
}

/// Returns the keys that move cameras, as the input has them; `arrows` where no control has the focus.
pub(crate) fn held(input: &InputState, keys: &HeldKeys, arrows: bool) -> Held {
    // The first frame of a held key comes after a pause of any length.
    let elapsed = match presses_camera_key(input) {
        true => input.predicted_dt,
        false => input.unstable_dt,
    };
    let is_held = |key| names(key).iter().any(|name| keys.moves(*name));
    Held::new(is_held, arrows, modifiers(input), f64::from(elapsed))
}

/// Returns the modifiers that are held.
fn modifiers(input: &InputState) -> Modifiers {
    let egui::Modifiers {
        alt,
        ctrl,
        shift,
        command,
        ..
    } = input.modifiers;
    Modifiers {
        shift,
        alt,
        command: ctrl || command,
    }
}

/// Returns the motion of the wheel or of two fingers; `fingers` is set where what scrolls is not a wheel.
fn scroll(input: &InputState, fingers: bool) -> Scroll {
    Scroll {
        by: numbers(input.smooth_scroll_delta()),
        pinched: f64::from(input.zoom_delta()),
        fingers,
    }
}
