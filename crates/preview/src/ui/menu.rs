//! The menu bar.

use egui::{Key, MenuBar, Panel, Ui};

use crate::state::layout::Arrangement;
use crate::state::pane::{Pane, PaneKey};
use crate::state::{Marks, Step, WAVEFRONTS};
use crate::ui::dialogs::{picture, record};
use crate::ui::window::{TextSource, Window};

/// The menu bar.
pub(crate) fn bar(window: &mut Window, ui: &mut Ui) {
    let frame = egui::Frame::side_top_panel(ui.style()).fill(window.display.background(ui));
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
    if let TextSource::File { editor, .. } = &window.source {
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
        picture::ask_for_picture(window);
    }
    if entry(ui, has_picture, "Copy picture", "Ctrl+C") {
        picture::copy_picture(window, ui);
    }
    let free = window.dialogs.recording.is_none();
    if entry(ui, has_picture && free, "Record…", "Ctrl+R") {
        record::ask(window);
    }
    if entry(ui, has_picture, "Export mesh…", "Ctrl+M") {
        picture::ask_for_mesh(window);
    }
}

fn choose_textures(window: &Window) {
    crate::io::file_dialogs::choose_images(window.file_choices(), window.folder());
}

/// Handles the keys of the menu *File*, where they do not belong to a control.
pub(crate) fn file_keys(window: &mut Window, ui: &Ui) {
    let pressed = |key| {
        let shortcut = egui::KeyboardShortcut::new(egui::Modifiers::COMMAND, key);
        ui.input_mut(|input| input.consume_shortcut(&shortcut))
    };
    if pressed(Key::O) {
        choose_textures(window);
    }
    if pressed(Key::E) {
        picture::ask_for_picture(window);
    }
    if pressed(Key::R) && window.dialogs.recording.is_none() {
        record::ask(window);
    }
    if pressed(Key::M) && window.sent(&window.active).is_some() {
        picture::ask_for_mesh(window);
    }
    // A text that is marked is copied rather than the picture.
    let copies = ui.input(|input| input.events.contains(&egui::Event::Copy));
    if copies && !ui.ctx().text_edit_focused() {
        picture::copy_picture(window, ui);
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
    let mut paths = window.model.paths.values();
    let any = paths.any(|path| path.trail.points.len() > 1);
    let clear = egui::Button::new("Clear the trail");
    if ui.add_enabled(any, clear).clicked() {
        window.model.clear_trails();
    }
    if marks != before {
        let step = Step::new("Change the overlays", "");
        window
            .model
            .change(step, |view| view.preferences.marks = marks);
        window.model.history.settle();
    }
}
