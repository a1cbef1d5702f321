//! The camera of a geodesic view: it walks on its surface, turns and zooms.

use egui::{Key, Response, Ui};
use render::ViewId;

use super::{CameraInput, Held, TURN_SPEED, ZOOM_SPEED, carried, nearing, pixel};
use crate::state::motion::Motion;
use crate::state::{InsideCamera, Model};
use crate::ui::window::Window;

/// Lengths of X a second.
const WALK_SPEED: f64 = 0.8;

/// Keys and pointer of the camera of a geodesic view.
pub(super) struct GeodesicInput;

impl CameraInput for GeodesicInput {
    fn keys(&self, window: &mut Window, ui: &Ui, id: &ViewId, arrows: bool) {
        let speed = window.model.view.preferences.camera_speed;
        let keys = &window.input.held;
        let motions = ui.input(|input| motions_of_keys(Held::new(input, keys, arrows), speed));
        for motion in motions {
            window.walk(surface(id), motion, ui);
        }
    }

    fn pointer(&self, window: &mut Window, ui: &Ui, id: &ViewId, response: &Response) {
        let side = response.rect.width().min(response.rect.height());
        let by = response.drag_delta();
        if response.dragged() && by != egui::Vec2::ZERO {
            window.walk(surface(id), dragged(by, side), ui);
        }
        if response.hovered() {
            let fingers = window.input.fingers;
            if let Some(by) = ui.input(|input| carried(input, fingers)) {
                window.walk(surface(id), dragged(by, side), ui);
            }
            // About the middle: the observer stays.
            if let Some(factor) = ui.input(|input| nearing(input, fingers)) {
                window.walk(surface(id), Motion::Zoom(factor), ui);
            }
        }
        let command = ui.input(|input| input.modifiers.command);
        let measures = window.dialogs.measuring.is_open();
        if response.clicked() && command || response.double_clicked() && !measures {
            window.open_declaration(surface(id));
        } else if measures
            && response.clicked()
            && let Some(request) = window.pictures.sent(id).cloned()
        {
            let pointed = response.interact_pointer_pos();
            let at = pointed.unwrap_or_else(|| response.rect.center());
            let pixel = pixel(&request, response.rect, at);
            window.click(request, pixel, pointed.is_none(), ui);
        }
    }

    fn reset(&self, window: &mut Window, id: &ViewId) {
        window.model.reset(surface(id));
    }

    fn place(&self, model: &Model, id: &ViewId) -> Option<String> {
        let camera = model.view.inside.get(surface(id))?;
        let zoom = camera.zoom();
        let place = match camera {
            InsideCamera::Chart(camera) => {
                let [u, v] = camera.at;
                format!("(u, v) = ({u:.3}, {v:.3})")
            }
            InsideCamera::Solid(camera) => {
                let [x, y, z] = model.scene.as_ref()?.stated(camera.at);
                format!("(x, y, z) = ({x:.3}, {y:.3}, {z:.3})")
            }
        };
        Some(format!(" from {place}, {zoom:.3} from centre to edge"))
    }
}

/// The name of the surface that a view is seen from.
fn surface(id: &ViewId) -> &str {
    id.object.as_deref().unwrap_or_default()
}

/// Returns the motions of a geodesic camera for the held keys.
fn motions_of_keys(held: Held<'_>, speed: f64) -> Vec<Motion> {
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

/// Returns the motion of a geodesic camera for a drag in points: the surface under the pointer goes with it.
fn dragged(by: egui::Vec2, side: f32) -> Motion {
    let half = f64::from(0.5 * side.max(1.0));
    Motion::Walk([-f64::from(by.x) / half, f64::from(by.y) / half])
}
