//! The program pane: in a standalone window the editable text; in any window, the diagnostics at its foot.

mod code;
pub(crate) mod commands;
pub(crate) mod completion;
pub(crate) mod find;
mod findings;
mod keys;
pub(crate) mod rename;

use egui::Ui;

use crate::ui::key_names;
use crate::ui::window::{TextSource, Window};

/// Draws the pane.
pub(super) fn show(window: &mut Window, ui: &mut Ui) {
    let margin = egui::Frame::new().inner_margin(6.0);
    margin.show(ui, |ui| {
        let is_own = matches!(window.text.source, TextSource::File { .. });
        let replaced = is_own && bar(window, ui);
        findings::show(window, ui);
        let edited = is_own && code::show(window, ui);
        if edited || replaced {
            window.has_edited();
        }
    });
}

/// Shows the file and its buttons. Returns whether the text was replaced.
fn bar(window: &mut Window, ui: &mut Ui) -> bool {
    let mut changed = false;
    let TextSource::File { editor, .. } = &mut window.text.source else {
        return false;
    };
    if editor.conflict.is_some() {
        ui.horizontal_wrapped(|ui| {
            let colour = ui.visuals().warn_fg_color;
            ui.colored_label(colour, "Both the file on disk and this text have changed.");
            if ui.button("Reload from disk").clicked() {
                changed = editor.settle(true);
            }
            if ui.button("Keep my text").clicked() {
                changed = editor.settle(false);
            }
        });
    }
    let mut save = false;
    ui.horizontal(|ui| {
        save = ui
            .add_enabled(
                editor.is_changed() || editor.is_new,
                egui::Button::new("Save"),
            )
            // Dialogs also have a button of this name.
            .accessible_name("Save program")
            .on_hover_text(key_names::named(ui.ctx(), "Ctrl+S"))
            .clicked();
        if editor.is_changed() {
            ui.weak("not saved");
        }
        // Only the name: a long folder would determine the width of the text.
        let name = editor.path.file_name().unwrap_or_default();
        let name = egui::Label::new(name.to_string_lossy()).truncate();
        ui.add(name)
            .on_hover_text(editor.path.display().to_string());
    });
    if save {
        window.save_text();
    }
    changed
}
