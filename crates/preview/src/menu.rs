//! The menu bar and the dialogs it opens.

use std::path::Path;

use egui::{Grid, MenuBar, Panel, Ui};

use crate::model::{Marks, Step, WAVEFRONTS};
use crate::orders::PaneKey;
use crate::panes::Pane;
use crate::recording::{self, RecordDialog, Recording};
use crate::saving::{self, PictureDialog};
use crate::window::{Origin, Window};

/// The dialogs, and what has been entered.
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
    /// What stands in the field for a texture's file.
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

    /// Whether keys belong to a dialog.
    pub(crate) fn is_open(&self) -> bool {
        self.picture.is_some() || self.mesh.is_some() || self.record.is_some() || self.leaving
    }
}

/// The menu bar.
pub(crate) fn bar(window: &mut Window, ui: &mut Ui) {
    Panel::top("menu").show(ui, |ui| {
        MenuBar::new().ui(ui, |ui| {
            ui.menu_button("File", |ui| file(window, ui));
            ui.menu_button("Edit", |ui| edit(window, ui));
            ui.menu_button("View", |ui| view(window, ui));
            ui.menu_button("Overlays", |ui| overlays(window, ui));
            ui.menu_button("Help", |ui| {
                if ui.button("Keys and pointer (F1)").clicked() {
                    window.dialogs.shortcuts = true;
                }
            });
        });
    });
}

fn file(window: &mut Window, ui: &mut Ui) {
    if let Origin::File { editor, .. } = &window.origin {
        let changed = editor.is_changed();
        if ui
            .add_enabled(changed, egui::Button::new("Save program (Ctrl+S)"))
            .clicked()
        {
            window.save_text();
        }
    }
    if ui.button("Open textures…").clicked() {
        crate::desktop::choose_images(window.mail.clone(), window.folder());
    }
    ui.separator();
    let has_picture = window.sent(&window.active).is_some();
    if ui
        .add_enabled(has_picture, egui::Button::new("Save picture…"))
        .clicked()
    {
        saving::ask_for_picture(window);
    }
    if ui
        .add_enabled(has_picture, egui::Button::new("Copy picture"))
        .clicked()
    {
        saving::copy_picture(window, ui);
    }
    let free = window.dialogs.recording.is_none();
    if ui
        .add_enabled(has_picture && free, egui::Button::new("Record…"))
        .clicked()
    {
        recording::ask(window);
    }
    if ui
        .add_enabled(has_picture, egui::Button::new("Export mesh…"))
        .clicked()
    {
        saving::ask_for_mesh(window);
    }
}

fn edit(window: &mut Window, ui: &mut Ui) {
    let entry = |verb: &str, key: &str, title: Option<&str>| match title {
        Some(title) => format!("{verb}: {title} ({key})"),
        None => format!("{verb} ({key})"),
    };
    let last = window.model.history.last();
    let undo = egui::Button::new(entry("Undo", "Ctrl+Z", last));
    if ui.add_enabled(last.is_some(), undo).clicked() {
        window.undo();
    }
    let next = window.model.history.next();
    let redo = egui::Button::new(entry("Redo", "Ctrl+Y", next));
    if ui.add_enabled(next.is_some(), redo).clicked() {
        window.redo();
    }
}

fn view(window: &mut Window, ui: &mut Ui) {
    let mut panes = vec![(Pane::Space, "3D view".to_owned())];
    for name in window.model.surfaces() {
        let title = format!("Geodesic view of {name}");
        panes.push((Pane::Inside(name), title));
    }
    panes.push((Pane::Settings, "Settings".to_owned()));
    panes.push((Pane::Program, "Program".to_owned()));
    for (pane, title) in panes {
        let mut open = window.panes.is_open(&pane);
        if ui.checkbox(&mut open, title).changed() {
            window.panes.arranged = true;
            match (&pane, open) {
                (Pane::Inside(name), true) => window.open_inside(name),
                (_, true) => window.panes.bring_forward(&pane),
                (_, false) => {
                    window.panes.close(&pane);
                    if let Pane::Inside(name) = pane {
                        window.model.adjust(|view| {
                            view.closed.insert(name);
                        });
                    }
                }
            }
        }
    }
    ui.separator();
    if ui.button("Frame everything (F)").clicked() {
        window.frame_all();
    }
    if ui.button("Reset the camera (R)").clicked() {
        match window.active.clone() {
            PaneKey::Space => window.reset_space(),
            PaneKey::Inside(name) => window.reset_inside(&name),
        }
    }
}

fn overlays(window: &mut Window, ui: &mut Ui) {
    let mut marks = window.model.view.preferences.marks;
    let before = marks;
    let entries: [(&mut bool, &str); 8] = {
        let Marks {
            legend,
            wavefronts,
            conjugate,
            cut_locus,
            error,
            centre,
            cameras,
            trail,
        } = &mut marks;
        [
            (wavefronts, WAVEFRONTS),
            (conjugate, "Conjugate points"),
            (cut_locus, "Cut locus"),
            (error, "Estimated error"),
            (legend, "Legend"),
            (centre, "Ring at the centre"),
            (cameras, "Geodesic camera in the 3D view"),
            (trail, "Trail of the walk"),
        ]
    };
    for (on, title) in entries {
        ui.checkbox(on, title);
    }
    let walked = &window.model.walked;
    let any = walked.values().any(|way| way.trail.points.len() > 1);
    let clear = egui::Button::new("Clear the trail");
    if ui.add_enabled(any, clear).clicked() {
        window.model.trails_begun += 1;
    }
    if marks != before {
        let step = Step::new("Change the overlays", "");
        window
            .model
            .change(step, |view| view.preferences.marks = marks);
        window.model.history.settle();
    }
}

/// The dialogs that are open.
pub(crate) fn dialogs(window: &mut Window, ui: &mut Ui) {
    if window.dialogs.shortcuts {
        shortcuts(window, ui);
    }
    saving::show(window, ui);
    recording::show(window, ui);
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

/// Keys and what they do: one table for the dialog and its test.
const KEYS: [(&str, &str, &str); 13] = [
    ("W S", "forward, back", "along Y, against it"),
    ("A D", "left, right", "against X, along it"),
    (
        "Q E",
        "up, down in the world",
        "turn anticlockwise, clockwise",
    ),
    ("Z X", "", "zoom in, out"),
    ("Drag", "turn", "move"),
    ("Alt or right drag", "around the target", ""),
    ("Shift or middle drag", "sideways", ""),
    ("Wheel", "nearer, farther", "zoom"),
    ("F", "frame everything", ""),
    ("R, Home", "reset", "reset"),
    ("Click", "put the geodesic camera there", ""),
    (
        "Double or Ctrl click",
        "show the declaration",
        "show the declaration",
    ),
    ("Ctrl+Z, Ctrl+Y", "undo, redo a change of the view", ""),
];

fn shortcuts(window: &mut Window, ui: &Ui) {
    egui::Window::new("Keys and pointer")
        .open(&mut window.dialogs.shortcuts)
        .collapsible(false)
        .resizable(false)
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
