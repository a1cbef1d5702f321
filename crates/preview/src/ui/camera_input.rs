//! Cameras moved by held keys and the pointer: egui's events become numbers, which `session::camera_input` converts to
//! motions.
//!
//! A view's options determine its kind of camera; [`input_of`] returns the corresponding input. A view without a camera
//! has no keys of its own, but is shown all the same.

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
    /// Moves the camera by the keys of a frame; the arrows belong to the view if no control has the focus.
    fn keys(&self, _window: &mut Window, _ui: &Ui, _id: &ViewId, _arrows: bool) {}

    /// Moves the camera by the pointer, and handles clicks on its picture.
    fn pointer(&self, _window: &mut Window, _ui: &Ui, _id: &ViewId, _response: &Response) {}

    /// Returns the camera to its initial position.
    fn reset(&self, _window: &mut Window, _id: &ViewId) {}

    /// Returns the position of the camera in words, to follow the view's name.
    fn place(&self, _model: &Model, _id: &ViewId) -> Option<String> {
        None
    }
}

/// The input of a view whose camera cannot be moved.
struct Fixed;

impl CameraInput for Fixed {}

/// Returns the input for the camera of a view.
pub(crate) fn input_of(view: Option<&dyn View>) -> &'static dyn CameraInput {
    match CameraKind::of(view) {
        CameraKind::Space => &space::SpaceInput,
        CameraKind::Geodesic => &geodesic::GeodesicInput,
        CameraKind::Fixed => &Fixed,
    }
}

/// Returns the pixel of a picture that fills a rectangle, at a point of the screen.
pub(crate) fn pixel(request: &PictureRequest, rect: Rect, at: Pos2) -> [f64; 2] {
    camera_input::pixel(request.size, numbers(rect.size()), numbers(at - rect.min))
}

/// Converts a distance in points to numbers.
fn numbers(way: Vec2) -> [f64; 2] {
    [way.x, way.y].map(f64::from)
}

/// Returns the shorter side of a rectangle in points.
fn shorter_side(rect: Rect) -> f64 {
    f64::from(rect.width().min(rect.height()))
}

/// Returns the names under which a camera key may be reported.
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
        // On some keyboards + is Shift and =: accept either.
        CameraKey::Plus => &[Key::Plus, Key::Equals],
        CameraKey::Minus => &[Key::Minus],
    }
}

/// Returns whether a key moves cameras only if no control has the focus, because the control may use it.
pub(crate) fn may_be_of_control(key: Key) -> bool {
    let mut others = CameraKey::ALL.into_iter().filter(|it| !it.is_letter());
    others.any(|it| names(it).contains(&key))
}

/// Returns whether a key that moves cameras is pressed.
pub(crate) fn presses_camera_key(input: &InputState) -> bool {
    let mut all = CameraKey::ALL.into_iter().flat_map(names);
    all.any(|key| input.key_pressed(*key))
}

/// Returns the held keys that move cameras; `arrows` is true if no control has the focus.
pub(crate) fn held(input: &InputState, keys: &HeldKeys, arrows: bool) -> Held {
    // The first frame of a held key may follow a pause of any length.
    let elapsed = match presses_camera_key(input) {
        true => input.predicted_dt,
        false => input.unstable_dt,
    };
    let is_held = |key| names(key).iter().any(|name| keys.moves(*name));
    Held::new(is_held, arrows, modifiers(input), f64::from(elapsed))
}

/// Returns the held modifiers.
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

/// Returns the scrolling of the wheel or of two fingers; `fingers` is true if it is not a wheel.
fn scroll(input: &InputState, fingers: bool) -> Scroll {
    Scroll {
        by: numbers(input.smooth_scroll_delta()),
        pinched: f64::from(input.zoom_delta()),
        fingers,
    }
}
