//! The dialogs: which are open, and what has been entered.

pub(crate) mod picture;
pub(crate) mod record;

use std::path::Path;

use egui::{Grid, Key, Ui};

use crate::engine::recording::Recording;
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
    /// The window was asked to close with a text that is not saved.
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
                window.closing = !window.has_unsaved();
                window.dialogs.leaving = false;
            }
            if ui.button("Close without saving").clicked() {
                window.closing = true;
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

/// Keys and the pointer, and what they do in the 3D view and in a geodesic view.
const KEYS: [(&str, &str, &str); 21] = [
    ("W S", "forward, back", "along Y, against it"),
    ("A D", "left, right", "against X, along it"),
    (
        "Q E",
        "up, down in the world",
        "turn anticlockwise, clockwise",
    ),
    ("Z X", "", "zoom in, out"),
    ("Arrows", "turn", "move"),
    ("Alt and arrows", "around the target", ""),
    ("Shift and arrows", "sideways", ""),
    ("+ −", "nearer, farther", "zoom in, out"),
    ("F", "frame everything", ""),
    ("R, Home", "reset", "reset"),
    (
        "Enter",
        "put the geodesic camera to the middle of the picture",
        "",
    ),
    (
        "Ctrl+Enter",
        "show the declaration in the middle of the picture",
        "show the declaration",
    ),
    ("Drag", "turn", "move"),
    ("Alt or right drag", "around the target", ""),
    ("Shift or middle drag", "sideways", ""),
    ("Wheel", "nearer, farther", "zoom"),
    (
        "Click",
        "put the geodesic camera there; of what has none, show the declaration",
        "",
    ),
    (
        "Double or Ctrl click",
        "show the declaration",
        "show the declaration",
    ),
    ("F6, Shift+F6", "the next view, the one before", ""),
    ("Ctrl+Z, Ctrl+Y", "undo, redo a change of the view", ""),
    ("Ctrl+ + − 0", "size of the controls", ""),
];

fn shortcuts(window: &mut Window, ui: &Ui) {
    let escape =
        |input: &mut egui::InputState| input.consume_key(egui::Modifiers::NONE, Key::Escape);
    if !window.dialogs.is_open() && ui.input_mut(escape) {
        window.dialogs.shortcuts = false;
        return;
    }
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
                .num_columns(3)
                .striped(true)
                .spacing([16.0, 4.0])
                .show(ui, |ui| {
                    ui.strong("");
                    ui.strong("3D view");
                    ui.strong("Geodesic view");
                    ui.end_row();
                    for (key, space, inside) in KEYS {
                        ui.strong(key);
                        ui.label(space);
                        ui.label(inside);
                        ui.end_row();
                    }
                });
            ui.label("A view that was clicked on, or reached with Tab, has the keys.");
        });
}
