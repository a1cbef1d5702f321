//! The camera of a geodesic view: it walks on its surface, turns and zooms.

use egui::{Response, Ui};
use render::ViewId;
use session::Model;
use session::camera_input::geodesic::{dragged, motions_of_keys, place};
use session::motion::Motion;

use super::{CameraInput, held, numbers, pixel, scroll, shorter_side};
use crate::ui::window::Window;

/// Keys and pointer of the camera of a geodesic view.
pub(super) struct GeodesicInput;

impl CameraInput for GeodesicInput {
    fn keys(&self, window: &mut Window, ui: &Ui, id: &ViewId, arrows: bool) {
        let speed = window.model.choices.preferences.camera_speed;
        let keys = &window.input.held;
        let motions = motions_of_keys(ui.input(|input| held(input, keys, arrows)), speed);
        for motion in motions {
            window.walk(surface(id), motion, ui);
        }
    }

    fn pointer(&self, window: &mut Window, ui: &Ui, id: &ViewId, response: &Response) {
        let side = shorter_side(response.rect);
        let by = response.drag_delta();
        if response.dragged() && by != egui::Vec2::ZERO {
            window.walk(surface(id), dragged(numbers(by), side), ui);
        }
        if response.hovered() {
            let scroll = ui.input(|input| scroll(input, window.input.fingers));
            if let Some(by) = scroll.carried() {
                window.walk(surface(id), dragged(by, side), ui);
            }
            // About the centre: the observer stays.
            if let Some(factor) = scroll.nearing() {
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
        place(model, surface(id))
    }
}

/// Returns the name of the surface of a geodesic view.
fn surface(id: &ViewId) -> &str {
    id.object.as_deref().unwrap_or_default()
}
