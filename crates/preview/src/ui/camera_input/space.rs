//! The camera in space: keys, drags and the wheel move it; clicks find what is under them.

use egui::{Color32, FontId, Key, PointerButton, Pos2, Rect, Response, Ui};
use render::ViewId;
use session::Model;
use session::camera_input::space::{Grip, dragged, moved_by_keys, neared, place};

use super::{CameraInput, held, modifiers, numbers, pixel, scroll, shorter_side};
use crate::engine::render_thread::Purpose;
use crate::ui::navigation;
use crate::ui::window::Window;

/// Keys and pointer of the camera in space.
pub(super) struct SpaceInput;

impl CameraInput for SpaceInput {
    fn keys(&self, window: &mut Window, ui: &Ui, _id: &ViewId, arrows: bool) {
        if ui.input(|input| input.key_pressed(Key::F) && input.modifiers.is_none()) {
            window.frame(None);
        }
        if ui.input(|input| input.key_pressed(Key::T) && input.modifiers.is_none()) {
            window.toggle_traced();
        }
        navigation::keys(window, ui);
        let Some(camera) = window.model.view.space else {
            return;
        };
        let speed = window.model.view.preferences.camera_speed;
        let keys = &window.input.held;
        let is_parallel = window.model.view.preferences.orthographic;
        let held = ui.input(|input| held(input, keys, arrows));
        let next = moved_by_keys(camera, held, speed, is_parallel);
        if next != camera {
            window.move_space("keys", next, ui);
        }
    }

    fn pointer(&self, window: &mut Window, ui: &Ui, id: &ViewId, response: &Response) {
        let side = shorter_side(response.rect);
        let fly = window.model.view.preferences.fly;
        if let Some(mut camera) = window.model.view.space {
            if !camera.moved {
                let scene = window.model.scene.as_ref();
                let mut objects = scene.iter().flat_map(|scene| &scene.objects);
                let has_surface = objects.any(|object| object.shape.manifold().is_some());
                hint(ui, response.rect, fly, has_surface);
            }
            let by = response.drag_delta();
            if let Some(grip) = grip(ui, response, fly)
                && by != egui::Vec2::ZERO
            {
                camera = dragged(camera, grip, numbers(by), side);
                window.move_space("drag", camera, ui);
            }
            if let Some(pointer) = response.hover_pos() {
                let scroll = ui.input(|input| scroll(input, window.input.fingers));
                if let Some(by) = scroll.carried() {
                    camera = dragged(camera, Grip::Pan, by, side);
                    window.move_space("wheel", camera, ui);
                }
                if let Some(factor) = scroll.nearing() {
                    let at = numbers(pointer - response.rect.center());
                    camera = neared(camera, factor, at, side);
                    window.move_space("wheel", camera, ui);
                }
            }
        }
        if response.clicked()
            && let Some(request) = window.pictures.sent(id).cloned()
        {
            let pointed = response.interact_pointer_pos();
            // A key presses what has the focus, in its middle.
            let at = pointed.unwrap_or_else(|| response.rect.center());
            let pixel = pixel(&request, response.rect, at);
            // egui counts clicks elsewhere too: the third of them may be the second one here.
            let is_second = window.clicked_until().is_some() && response.triple_clicked();
            if response.double_clicked() || is_second {
                window.double_click(request, pixel);
            } else if ui.input(|input| input.modifiers.command) {
                window
                    .pictures
                    .render_thread
                    .pick(request, pixel, Purpose::Open);
            } else if !response.triple_clicked() {
                // The third of three clicks means nothing by itself.
                window.click(request, pixel, pointed.is_none(), ui);
            }
        }
        if response.has_focus() && window.input.by_keys {
            aim(ui, response.rect.center());
        }
        navigation::gizmo(window, ui, id, response.rect);
    }

    fn reset(&self, window: &mut Window, _id: &ViewId) {
        window.model.reset_space();
    }

    fn place(&self, model: &Model, _id: &ViewId) -> Option<String> {
        place(model)
    }
}

/// Returns what a drag does; `fly` exchanges what it does with Alt and without.
fn grip(ui: &Ui, response: &Response, fly: bool) -> Option<Grip> {
    let dragged = |button| response.dragged_by(button);
    let others = dragged(PointerButton::Secondary) || dragged(PointerButton::Middle);
    let is_dragged = others || dragged(PointerButton::Primary);
    is_dragged.then(|| Grip::of(!others, ui.input(modifiers), fly))
}

/// Says faintly what the pointer does, to those who have not moved the camera yet.
fn hint(ui: &Ui, rect: Rect, fly: bool, has_surface: bool) {
    let verb = if fly { "look around" } else { "turn" };
    let last = match has_surface {
        true => "click a surface to stand there",
        false => "F to fit",
    };
    let text = format!("drag to {verb}, wheel to zoom, {last}");
    // The legend is in the other corner.
    let (font, colour) = (FontId::proportional(12.0), Color32::from_gray(128));
    let painter = ui.painter_at(rect);
    let galley = painter.layout(text, font, colour, rect.width() - 16.0);
    let at = rect.right_bottom() - egui::vec2(8.0, 8.0) - galley.size();
    painter.galley(at, galley, colour);
}

/// A ring about the place that Enter means.
fn aim(ui: &Ui, at: Pos2) {
    for (width, colour) in [(3.0, Color32::BLACK), (1.5, Color32::WHITE)] {
        ui.painter().circle_stroke(at, 6.0, (width, colour));
    }
}
