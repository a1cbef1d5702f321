//! The menu bar and the dialogs it opens.

use std::path::Path;

use egui::{Grid, Key, MenuBar, Panel, Ui};

use crate::model::{Marks, Step, WAVEFRONTS};
use crate::orders::PaneKey;
use crate::panes::{Arrangement, Pane};
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
    let frame = egui::Frame::side_top_panel(ui.style()).fill(window.ground(ui));
    Panel::top("menu").frame(frame).show(ui, |ui| {
        MenuBar::new().ui(ui, |ui| {
            ui.menu_button("File", |ui| file(window, ui));
            ui.menu_button("Edit", |ui| edit(window, ui));
            ui.menu_button("View", |ui| view(window, ui));
            ui.menu_button("Overlays", |ui| overlays(window, ui));
            ui.menu_button("Help", |ui| {
                if entry(ui, true, "Keys and pointer", "F1") {
                    window.dialogs.shortcuts = true;
                }
            });
        });
    });
}

/// An entry of a menu, with its keys beside it; whether it was chosen.
fn entry(ui: &mut Ui, enabled: bool, title: &str, keys: &str) -> bool {
    let button = egui::Button::new(title).shortcut_text(keys);
    let response = ui.add_enabled(enabled, button);
    response.accessible_name(title).clicked()
}

fn file(window: &mut Window, ui: &mut Ui) {
    if let Origin::File { editor, .. } = &window.origin {
        let changed = editor.is_changed();
        if entry(ui, changed, "Save program", "Ctrl+S") {
            window.save_text();
        }
    }
    if entry(ui, true, "Open textures…", "Ctrl+O") {
        choose_textures(window);
    }
    ui.separator();
    let has_picture = window.sent(&window.active).is_some();
    if entry(ui, has_picture, "Save picture…", "Ctrl+E") {
        saving::ask_for_picture(window);
    }
    if entry(ui, has_picture, "Copy picture", "Ctrl+C") {
        saving::copy_picture(window, ui);
    }
    let free = window.dialogs.recording.is_none();
    if entry(ui, has_picture && free, "Record…", "Ctrl+R") {
        recording::ask(window);
    }
    if entry(ui, has_picture, "Export mesh…", "Ctrl+M") {
        saving::ask_for_mesh(window);
    }
}

fn choose_textures(window: &Window) {
    crate::desktop::choose_images(window.mail.clone(), window.folder());
}

/// What the keys of the menu *File* ask for, where they are not another's.
pub(crate) fn file_keys(window: &mut Window, ui: &Ui) {
    let pressed = |key| {
        let shortcut = egui::KeyboardShortcut::new(egui::Modifiers::COMMAND, key);
        ui.input_mut(|input| input.consume_shortcut(&shortcut))
    };
    if pressed(Key::O) {
        choose_textures(window);
    }
    if pressed(Key::E) {
        saving::ask_for_picture(window);
    }
    if pressed(Key::R) && window.dialogs.recording.is_none() {
        recording::ask(window);
    }
    if pressed(Key::M) && window.sent(&window.active).is_some() {
        saving::ask_for_mesh(window);
    }
    // A text that is marked is copied rather than the picture.
    let copies = ui.input(|input| input.events.contains(&egui::Event::Copy));
    if copies && !ui.ctx().text_edit_focused() {
        saving::copy_picture(window, ui);
    }
}

fn edit(window: &mut Window, ui: &mut Ui) {
    let titled = |verb: &str, title: Option<&str>| {
        title.map_or(verb.to_owned(), |title| format!("{verb}: {title}"))
    };
    let last = window.model.history.last();
    if entry(ui, last.is_some(), &titled("Undo", last), "Ctrl+Z") {
        window.undo();
    }
    let next = window.model.history.next();
    if entry(ui, next.is_some(), &titled("Redo", next), "Ctrl+Y") {
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
                (_, true) => window.bring_forward(&pane),
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
    ui.menu_button("Arrange the panes", |ui| {
        for (title, arrangement) in Arrangement::ALL {
            if ui.button(title).clicked() {
                window.panes.set_out(arrangement);
            }
        }
        ui.separator();
        if entry(ui, true, "Larger view", "Ctrl+Shift+Right") {
            window.resize_active(true);
        }
        if entry(ui, true, "Smaller view", "Ctrl+Shift+Left") {
            window.resize_active(false);
        }
    });
    if entry(ui, true, "Next view", "F6") {
        window.next_view(ui, false);
    }
    ui.separator();
    if entry(ui, true, "Frame everything", "F") {
        window.frame_all();
    }
    if entry(ui, true, "Reset the camera", "R") {
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
