//! A geodesic view: what the pointer does there.

use egui::Ui;

use super::picture;
use crate::state::motion::Motion;
use crate::state::pane::PaneKey;
use crate::ui::camera_input::{inside_drag, nearing};
use crate::ui::window::Window;

/// Draws the pane.
pub(super) fn show(window: &mut Window, ui: &mut Ui, name: &str) {
    let response = picture::show(window, ui, &PaneKey::Inside(name.to_owned()));
    let side = response.rect.width().min(response.rect.height());
    let by = response.drag_delta();
    if response.dragged() && by != egui::Vec2::ZERO {
        window.walk(name, inside_drag(by, side), ui);
    }
    if response.hovered()
        && let Some(factor) = ui.input(nearing)
    {
        window.walk(name, Motion::Zoom(factor), ui);
    }
    let command = ui.input(|input| input.modifiers.command);
    if response.double_clicked() || response.clicked() && command {
        window.open_declaration(name);
    }
}
