//! The 3D view: what the pointer does there.

use egui::{Color32, PointerButton, Pos2, Ui};

use super::picture;
use crate::engine::render_thread::Purpose;
use crate::state::pane::PaneKey;
use crate::ui::camera_input::{Grip, nearing, space_drag};
use crate::ui::window::Window;

/// Draws the pane.
pub(super) fn show(window: &mut Window, ui: &mut Ui) {
    let pane = PaneKey::Space;
    let response = picture::show(window, ui, &pane);
    let side = response.rect.width().min(response.rect.height());
    if let Some(camera) = window.model.view.space {
        let (shift, alt) = ui.input(|input| (input.modifiers.shift, input.modifiers.alt));
        let grip = if response.dragged_by(PointerButton::Middle)
            || response.dragged_by(PointerButton::Primary) && shift
        {
            Some(Grip::Pan)
        } else if response.dragged_by(PointerButton::Secondary)
            || response.dragged_by(PointerButton::Primary) && alt
        {
            Some(Grip::Orbit)
        } else if response.dragged_by(PointerButton::Primary) {
            Some(Grip::Turn)
        } else {
            None
        };
        let by = response.drag_delta();
        if let Some(grip) = grip
            && by != egui::Vec2::ZERO
        {
            window.move_space("drag", space_drag(camera, grip, by, side), ui);
        }
        if response.hovered()
            && let Some(factor) = ui.input(nearing)
        {
            window.move_space("wheel", camera.neared(factor), ui);
        }
    }
    if response.clicked()
        && let Some(request) = window.sent(&pane).cloned()
    {
        let pointed = response.interact_pointer_pos();
        // A key presses what has the focus, in its middle.
        let at = pointed.unwrap_or_else(|| response.rect.center());
        let share = (at - response.rect.min) / response.rect.size();
        let [width, height] = request.size.map(f64::from);
        let pixel = [f64::from(share.x) * width, f64::from(share.y) * height];
        if response.double_clicked() {
            window.double_click(request, pixel);
        } else if ui.input(|input| input.modifiers.command) {
            window.render_thread.pick(request, pixel, Purpose::Open);
        } else if !response.triple_clicked() {
            // The third of three clicks means nothing by itself.
            window.click(request, pixel, pointed.is_none(), ui);
        }
    }
    if response.has_focus() && window.input.by_keys {
        aim(ui, response.rect.center());
    }
}

/// A ring about the place that Enter means.
fn aim(ui: &Ui, at: Pos2) {
    for (width, colour) in [(3.0, Color32::BLACK), (1.5, Color32::WHITE)] {
        ui.painter().circle_stroke(at, 6.0, (width, colour));
    }
}
