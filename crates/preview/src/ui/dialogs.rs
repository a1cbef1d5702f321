//! The dialogs: which are open, and what has been entered.

pub(crate) mod picture;
pub(crate) mod record;

use std::path::Path;

use egui::{Grid, Ui};
use render::view::{Key, View};

use crate::engine::recording::Recording;
use crate::ui::measure::{self, Measuring};
use crate::ui::window::Window;
use picture::PictureDialog;
use record::RecordDialog;

/// The dialogs, and what has been entered in them.
#[derive(Debug, Default)]
pub(crate) struct Dialogs {
    /// The keys are listed.
    pub(crate) shortcuts: bool,
    /// A picture is to be saved.
    pub(crate) picture: Option<PictureDialog>,
    /// A mesh is to be written: its file.
    pub(crate) mesh: Option<String>,
    /// An animation is to be recorded.
    pub(crate) record: Option<RecordDialog>,
    /// An animation is being recorded.
    pub(crate) recording: Option<Recording>,
    /// Surfaces are measured.
    pub(crate) measuring: Measuring,
    /// The window is to close with a text that is not saved.
    pub(crate) leaving: bool,
    /// The text of the field for a texture's file.
    pub(crate) texture_path: String,
    /// That field is to have the keys.
    pub(crate) wants_image: bool,
}

impl Dialogs {
    /// The dialog that is open has a file now.
    pub(crate) fn take_path(&mut self, path: &Path) {
        let path = path.display().to_string();
        if let Some(dialog) = &mut self.picture {
            dialog.path = path;
        } else if let Some(mesh) = &mut self.mesh {
            *mesh = path;
        } else if let Some(dialog) = &mut self.record {
            dialog.path = path;
        }
    }

    /// Returns whether keys belong to a dialog.
    pub(crate) fn is_open(&self) -> bool {
        self.picture.is_some() || self.mesh.is_some() || self.record.is_some() || self.leaving
    }
}

/// The dialogs that are open.
pub(crate) fn show(window: &mut Window, ui: &mut Ui) {
    if window.dialogs.shortcuts {
        shortcuts(window, ui);
    }
    measure::show(window, ui);
    picture::show(window, ui);
    record::show(window, ui);
    if window.dialogs.leaving {
        leaving(window, ui);
    }
}

fn leaving(window: &mut Window, ui: &Ui) {
    let modal = egui::Modal::new(egui::Id::unique("leaving")).show(ui.ctx(), |ui| {
        ui.heading("The program is not saved");
        ui.horizontal(|ui| {
            if ui.button("Save and close").clicked() {
                window.save_text();
                window.display.closing = !window.text.has_unsaved();
                window.dialogs.leaving = false;
            }
            if ui.button("Close without saving").clicked() {
                window.display.closing = true;
                window.dialogs.leaving = false;
            }
            if ui.button("Stay").clicked() {
                window.dialogs.leaving = false;
            }
        });
    });
    if modal.should_close() {
        window.dialogs.leaving = false;
    }
}

/// The keys that are the same in all views.
const KEYS: [Key; 4] = [
    Key::new("M", "measure on surfaces"),
    Key::new("F6, Shift+F6", "the next view, the one before"),
    Key::new("Ctrl+Z, Ctrl+Y", "undo, redo a change of the view"),
    Key::new("Ctrl+ + − 0", "size of the controls"),
];

/// Returns a row for each key of some views, with its effect in each view.
fn rows(views: &[&dyn View]) -> Vec<(&'static str, Vec<&'static str>)> {
    let mut rows: Vec<(&str, Vec<&str>)> = Vec::new();
    for (column, view) in views.iter().enumerate() {
        let mut next = 0;
        for Key { keys, action } in view.keys() {
            let known = rows.iter().position(|(known, _)| known == keys);
            let at = known.unwrap_or_else(|| {
                // A key that the views before do not have follows the one that it follows here.
                rows.insert(next, (keys, vec![""; views.len()]));
                next
            });
            rows[at].1[column] = action;
            next = at + 1;
        }
    }
    let own = KEYS.iter().map(|key| (key.keys, vec![key.action]));
    rows.into_iter().chain(own).collect()
}

fn shortcuts(window: &mut Window, ui: &Ui) {
    let escape =
        |input: &mut egui::InputState| input.consume_key(egui::Modifiers::NONE, egui::Key::Escape);
    if !window.dialogs.is_open() && ui.input_mut(escape) {
        window.dialogs.shortcuts = false;
        return;
    }
    let views: Vec<&dyn View> = window.views.iter().collect();
    let views: Vec<_> = views
        .into_iter()
        .filter(|view| !view.keys().is_empty())
        .collect();
    let screen = ui.ctx().content_rect();
    // Its title, its margins, and something of what is behind it.
    let room = screen.size() - egui::vec2(48.0, 96.0);
    egui::Window::new("Keys and pointer")
        .open(&mut window.dialogs.shortcuts)
        .collapsible(false)
        .resizable(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(screen.center())
        .scroll(true)
        .max_size(room)
        .show(ui.ctx(), |ui| {
            Grid::new("keys")
                .num_columns(views.len() + 1)
                .striped(true)
                .spacing([16.0, 4.0])
                .show(ui, |ui| {
                    ui.strong("");
                    for view in &views {
                        ui.strong(view.title());
                    }
                    ui.end_row();
                    for (keys, actions) in rows(&views) {
                        ui.strong(keys);
                        for action in actions {
                            ui.label(action);
                        }
                        ui.end_row();
                    }
                });
            ui.label("A view that was clicked on, or reached with Tab, has the keys.");
        });
}

#[cfg(test)]
mod tests {
    use render::Views;
    use render::view::View;

    #[test]
    fn the_keys_of_all_views_are_listed_once_in_their_order() {
        let views = Views::standard();
        let views: Vec<&dyn View> = views.iter().collect();
        let rows = super::rows(&views);
        let keys: Vec<&str> = rows.iter().map(|(keys, _)| *keys).collect();
        assert_eq!(keys[..5], ["W S", "A D", "Q E", "Z X", "Arrows"]);
        assert_eq!(keys.len(), 23);
        assert_eq!(rows[3].1, ["", "zoom in, out"]);
        assert_eq!(rows[4].1, ["look around", "move"]);
    }
}
