//! The menu bar and the dialogs it opens.

use std::path::PathBuf;

use egui::{DragValue, Grid, MenuBar, Panel, Ui};

use crate::files;
use crate::model::{Marks, Step, WAVEFRONTS};
use crate::orders::PaneKey;
use crate::panes::Pane;
use crate::window::{Origin, Window};

/// The dialogs, and what has been entered.
#[derive(Debug, Default)]
pub(crate) struct Dialogs {
    /// The keys are listed.
    pub(crate) shortcuts: bool,
    /// A picture is to be saved.
    pub(crate) picture: Option<PictureDialog>,
    /// The window was asked to close with a text that is not saved.
    pub(crate) leaving: bool,
    /// What stands in the field for a texture's file.
    pub(crate) texture_path: String,
}

/// What is asked about a picture.
#[derive(Clone, Debug)]
pub(crate) struct PictureDialog {
    pane: PaneKey,
    size: [u32; 2],
    transparent: bool,
    path: String,
}

impl Dialogs {
    /// Whether keys belong to a dialog.
    pub(crate) fn is_open(&self) -> bool {
        self.picture.is_some() || self.leaving
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
        files::choose_images(window.mail.clone(), window.folder());
    }
    ui.separator();
    let has_picture = window.sent(&window.active).is_some();
    if ui
        .add_enabled(has_picture, egui::Button::new("Save picture…"))
        .clicked()
    {
        ask_for_picture(window);
    }
    if ui
        .add_enabled(has_picture, egui::Button::new("Copy picture"))
        .clicked()
    {
        copy(window, ui);
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
    let entries: [(&mut bool, &str); 7] = {
        let Marks {
            legend,
            wavefronts,
            conjugate,
            cut_locus,
            error,
            centre,
            cameras,
        } = &mut marks;
        [
            (wavefronts, WAVEFRONTS),
            (conjugate, "Conjugate points"),
            (cut_locus, "Cut locus"),
            (error, "Estimated error"),
            (legend, "Legend"),
            (centre, "Ring at the centre"),
            (cameras, "Geodesic camera in the 3D view"),
        ]
    };
    for (on, title) in entries {
        ui.checkbox(on, title);
    }
    if marks != before {
        let step = Step::new("Change the overlays", "");
        window
            .model
            .change(step, |view| view.preferences.marks = marks);
        window.model.history.settle();
    }
}

fn ask_for_picture(window: &mut Window) {
    let Some(order) = window.sent(&window.active) else {
        return;
    };
    let name = match &window.active {
        PaneKey::Space => "3d.png".to_owned(),
        PaneKey::Inside(name) => format!("{name}.png"),
    };
    let folder = window.folder().unwrap_or_default();
    window.dialogs.picture = Some(PictureDialog {
        pane: window.active.clone(),
        size: order.size,
        transparent: false,
        path: folder.join(name).display().to_string(),
    });
}

fn copy(window: &mut Window, ui: &Ui) {
    let request = window.sent(&window.active).cloned();
    let Some(order) = request else {
        return;
    };
    let camera = match &window.active {
        PaneKey::Inside(name) => window.model.view.inside.get(name).copied(),
        PaneKey::Space => None,
    };
    let context = ui.ctx().clone();
    let mail = window.mail.clone();
    files::write_to(mail, PathBuf::new(), move |_| {
        let request = order.request(camera);
        let picture = render::render(&order.scene, &order.settings, &request, &|_| {});
        let image = picture.map_err(|error| error.to_string())?.image;
        let size = [image.width() as usize, image.height() as usize];
        context.copy_image(egui::ColorImage::from_rgba_unmultiplied(
            size,
            image.as_raw(),
        ));
        Ok(format!(
            "A picture of {}×{} pixels was copied",
            size[0], size[1]
        ))
    });
}

/// The dialogs that are open.
pub(crate) fn dialogs(window: &mut Window, ui: &mut Ui) {
    if window.dialogs.shortcuts {
        shortcuts(window, ui);
    }
    if let Some(dialog) = window.dialogs.picture.take() {
        picture(window, ui, dialog);
    }
    if window.dialogs.leaving {
        leaving(window, ui);
    }
}

fn picture(window: &mut Window, ui: &Ui, mut dialog: PictureDialog) {
    let mut save = false;
    let mut cancel = false;
    let mut browse = false;
    let modal = egui::Modal::new(egui::Id::unique("save picture")).show(ui.ctx(), |ui| {
        ui.heading("Save picture");
        Grid::new("picture").num_columns(2).show(ui, |ui| {
            let label = ui.label("Width");
            let side = 1..=render::request::MAX_SIDE;
            ui.add(
                DragValue::new(&mut dialog.size[0])
                    .range(side.clone())
                    .suffix(" px"),
            )
            .labelled_by(label.id);
            ui.end_row();
            let label = ui.label("Height");
            ui.add(
                DragValue::new(&mut dialog.size[1])
                    .range(side)
                    .suffix(" px"),
            )
            .labelled_by(label.id);
            ui.end_row();
            let label = ui.label("File");
            ui.horizontal(|ui| {
                let edit = egui::TextEdit::singleline(&mut dialog.path).desired_width(320.0);
                ui.add(edit).labelled_by(label.id);
                browse = ui.button("Choose…").clicked();
            });
            ui.end_row();
        });
        if dialog.pane == PaneKey::Space {
            ui.checkbox(&mut dialog.transparent, "Transparent background");
        }
        ui.horizontal(|ui| {
            save = ui.button("Save").clicked();
            cancel = ui.button("Cancel").clicked();
        });
    });
    if modal.should_close() || cancel {
        return;
    }
    if !save && !browse {
        window.dialogs.picture = Some(dialog);
        return;
    }
    let Some(order) = window.sent(&dialog.pane).cloned() else {
        return;
    };
    let camera = match &dialog.pane {
        PaneKey::Inside(name) => window.model.view.inside.get(name).copied(),
        PaneKey::Space => None,
    };
    let mut request = order.request(camera);
    request.size = dialog.size;
    if dialog.transparent {
        request.background = Some([0; 4]);
    }
    let mail = window.mail.clone();
    let path = PathBuf::from(&dialog.path);
    let write = move |path: &std::path::Path| {
        files::save_picture(path, &order.scene, &order.settings, &request)
    };
    if save {
        files::write_to(mail, path, write);
    } else {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let folder = path.parent().map(PathBuf::from);
        files::choose_target(mail, "Save picture", name, folder, write);
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
