//! The dialogs: which is open, and its input.

pub(crate) mod help;
pub(crate) mod picture;
pub(crate) mod program;
pub(crate) mod record;

use std::path::Path;

use egui::{Grid, Ui};
use render::Views;
use render::view::Key;

use crate::engine::recording::Recording;
use crate::ui::measure::{self, Measuring};
use crate::ui::window::{Next, Window};
use crate::ui::{gallery, key_names};
use help::HelpPage;
use picture::PictureDialog;
use program::ProgramDialog;
use record::RecordDialog;

/// A dialog, which receives the keys while it is open, and its input.
#[derive(Debug)]
pub(crate) enum Dialog {
    /// For saving a picture.
    Picture(PictureDialog),
    /// For writing a mesh: its file.
    Mesh(String),
    /// For recording an animation.
    Record(RecordDialog),
    /// For opening or saving a program.
    Program(ProgramDialog),
    /// The list of examples.
    Examples,
    /// A page of help.
    Help(HelpPage),
}

/// The dialogs before the panes: at most one that takes the keys, a question before it, and windows that leave the keys to the panes.
#[derive(Debug, Default)]
pub(crate) struct Dialogs {
    /// The open dialog.
    pub(crate) open: Option<Dialog>,
    /// True if the file field of the newly opened dialog is to get the focus.
    pub(crate) wants_name: bool,
    /// The next step, before which the user is asked about unsaved text.
    pub(crate) leaving: Option<Next>,
    /// True while the keys are listed.
    pub(crate) shortcuts: bool,
    /// The running recording.
    pub(crate) recording: Option<Recording>,
    /// The window in which surfaces are measured.
    pub(crate) measuring: Measuring,
    /// The text of the field for a texture's file.
    pub(crate) texture_path: String,
    /// True if that field is to get the focus.
    pub(crate) wants_image: bool,
}

impl Dialogs {
    /// Sets the file of the open dialog.
    pub(crate) fn take_path(&mut self, path: &Path) {
        if let Some(field) = self.path() {
            *field = path.display().to_string();
        }
    }

    /// Returns the text of the open dialog's file field.
    fn path(&mut self) -> Option<&mut String> {
        match self.open.as_mut()? {
            Dialog::Picture(dialog) => Some(&mut dialog.path),
            Dialog::Mesh(path) => Some(path),
            Dialog::Record(dialog) => Some(&mut dialog.path),
            Dialog::Program(dialog) => Some(&mut dialog.path),
            Dialog::Examples | Dialog::Help(_) => None,
        }
    }

    /// Returns whether a dialog receives the keys.
    pub(crate) fn is_open(&self) -> bool {
        self.open.is_some() || self.leaving.is_some()
    }
}

/// Shows the open dialogs.
pub(crate) fn show(window: &mut Window, ui: &mut Ui) {
    if window.dialogs.shortcuts {
        shortcuts(window, ui);
    }
    measure::show(window, ui);
    name_keys(window, ui);
    record::show_recording(window, ui);
    // A dialog that stays open is put back.
    match window.dialogs.open.take() {
        Some(Dialog::Picture(dialog)) => picture::show_picture(window, dialog, ui),
        Some(Dialog::Mesh(path)) => picture::show_mesh(window, path, ui),
        Some(Dialog::Record(dialog)) => record::show(window, dialog, ui),
        Some(Dialog::Program(dialog)) => program::show(window, dialog, ui),
        Some(Dialog::Help(page)) => help::show(window, page, ui),
        Some(Dialog::Examples) => examples(window, ui),
        None => {}
    }
    if let Some(next) = window.dialogs.leaving.clone() {
        leaving(window, &next, ui);
    }
}

/// Gives the focus to the file field of a newly opened dialog. When a dialog is first shown, it is measured in a pass
/// in which no field keeps the focus.
fn name_keys(window: &mut Window, ui: &Ui) {
    let dialogs = &mut window.dialogs;
    let has_keys = ui.memory(|memory| memory.has_focus(picture::path_field()));
    dialogs.wants_name &= !has_keys && dialogs.path().is_some();
    if dialogs.wants_name
        && let Some(path) = dialogs.path()
    {
        picture::take_keys(path, ui);
        ui.ctx().request_repaint();
    }
}

fn leaving(window: &mut Window, next: &Next, ui: &Ui) {
    let [save, drop] = match next {
        Next::Close => ["Save and close", "Close without saving"],
        Next::File(_) | Next::New { .. } => ["Save", "Do not save"],
    };
    let modal = egui::Modal::new(egui::Id::unique("leaving")).show(ui.ctx(), |ui| {
        ui.heading("The program is not saved");
        let choices = |ui: &mut Ui| [save, drop, "Cancel"].map(|it| ui.button(it).clicked());
        ui.horizontal(choices).inner
    });
    let [saves, drops, cancels] = modal.inner;
    if saves {
        window.dialogs.leaving = None;
        window.save_text_and(next.clone());
    } else if drops {
        window.dialogs.leaving = None;
        window.take_next(next.clone());
    } else if cancels || modal.should_close() {
        window.dialogs.leaving = None;
    }
}

fn examples(window: &mut Window, ui: &Ui) {
    let screen = ui.ctx().content_rect();
    let modal = egui::Modal::new(egui::Id::unique("examples")).show(ui.ctx(), |ui| {
        ui.set_width((screen.width() - 80.0).min(860.0));
        ui.heading("Examples");
        let room = (screen.height() - 160.0).max(120.0);
        let chosen = gallery::show(ui, room);
        (chosen, ui.button("Cancel").clicked())
    });
    let is_closing = modal.should_close();
    let (chosen, cancels) = modal.inner;
    if !cancels && chosen.is_none() && !is_closing {
        window.dialogs.open = Some(Dialog::Examples);
    }
    if let Some(next) = chosen {
        window.go_on(next);
    }
}

/// The width of the column with the keys.
const KEYS_WIDTH: f32 = 150.0;
/// The maximum width of a column with their effects.
const ACTION_WIDTH: f32 = 300.0;

/// The keys that are the same in all views.
const KEYS: [Key; 6] = [
    Key::new("M", "measure on surfaces"),
    Key::new("Alt and click", "measure there, without snapping"),
    Key::new("F6, Shift+F6", "the next view, the one before"),
    Key::new("Ctrl+Z, Ctrl+Y", "undo, redo a change of the view"),
    Key::new("Ctrl+ + − 0", "interface scale"),
    Key::new("F11, Ctrl+B", "full screen, views alone"),
];

/// The keys of the program's pane and of files, in one sentence each: the menus show them too.
const PROGRAM_KEYS: &str = "In the program Ctrl+Space lists words, Tab inserts one, Ctrl+F finds, Ctrl+/ comments, F2 \
    renames, Ctrl+. fixes, Shift+Alt+F formats. Ctrl+N, Ctrl+O, Ctrl+S: new, open, save; Ctrl+E, Ctrl+M, Ctrl+R: save a picture, a mesh, record.";

/// The keys of the views that share them.
struct KeyColumn {
    /// The titles of the views.
    title: String,
    keys: &'static [Key],
}

/// Returns the columns of the list: views with the same keys share one, and those without keys have none.
fn columns(views: &Views) -> Vec<KeyColumn> {
    let mut columns: Vec<KeyColumn> = Vec::new();
    for view in views.iter().filter(|view| !view.keys().is_empty()) {
        match columns.iter_mut().find(|it| it.keys == view.keys()) {
            Some(column) => {
                column.title.push_str(", ");
                column.title.push_str(view.title());
            }
            None => columns.push(KeyColumn {
                title: view.title().to_owned(),
                keys: view.keys(),
            }),
        }
    }
    columns
}

/// Returns a row for each key, with its effect in each column.
fn rows(columns: &[KeyColumn]) -> Vec<(&'static str, Vec<&'static str>)> {
    let mut rows: Vec<(&str, Vec<&str>)> = Vec::new();
    for (index, column) in columns.iter().enumerate() {
        let mut next = 0;
        for Key { keys, action } in column.keys {
            let known = rows.iter().position(|(known, _)| known == keys);
            let at = known.unwrap_or_else(|| {
                // A key that the earlier columns lack follows its predecessor in this column.
                rows.insert(next, (keys, vec![""; columns.len()]));
                next
            });
            rows[at].1[index] = action;
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
    let columns = columns(&window.views);
    let screen = ui.ctx().content_rect();
    // Its title, its margins, and some of the background.
    let room = screen.size() - egui::vec2(48.0, 80.0);
    // The column of keys is narrower than those of their effects.
    let width = room.x.min(KEYS_WIDTH + columns.len() as f32 * ACTION_WIDTH);
    let column_width = (width - KEYS_WIDTH) / columns.len().max(1) as f32 - 12.0;
    egui::Window::new("Keyboard and mouse")
        .open(&mut window.dialogs.shortcuts)
        .collapsible(false)
        .resizable(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(screen.center())
        .default_size(egui::vec2(width, room.y))
        .show(ui.ctx(), |ui| {
            ui.set_width(width);
            ui.spacing_mut().interact_size.y = 0.0;
            let list = egui::ScrollArea::vertical().max_height(room.y);
            list.auto_shrink([false, true]).show(ui, |ui| {
                Grid::new("keys")
                    .num_columns(columns.len() + 1)
                    .striped(true)
                    .spacing([12.0, 1.0])
                    .max_col_width(column_width)
                    .show(ui, |ui| key_rows(&columns, ui));
                ui.label("Keys move the view that the pointer moves over, or that was chosen with a click or F6.");
                ui.label(PROGRAM_KEYS);
            });
        });
}

fn key_rows(columns: &[KeyColumn], ui: &mut Ui) {
    ui.strong("");
    for column in columns {
        ui.strong(&column.title);
    }
    ui.end_row();
    for (keys, actions) in rows(columns) {
        ui.strong(key_names::named(ui.ctx(), keys));
        for action in actions {
            ui.add(egui::Label::new(action).wrap());
        }
        ui.end_row();
    }
}

#[cfg(test)]
mod tests {
    use render::Views;

    #[test]
    fn the_keys_of_all_views_are_listed_once_in_their_order() {
        let columns = super::columns(&Views::standard());
        let titles: Vec<&str> = columns.iter().map(|it| it.title.as_str()).collect();
        assert_eq!(titles, ["3D view, Traced view", "Geodesic view"]);
        let rows = super::rows(&columns);
        let keys: Vec<&str> = rows.iter().map(|(keys, _)| *keys).collect();
        assert_eq!(keys[..5], ["W S", "A D", "Q E", "Z X", "Arrows"]);
        assert_eq!(keys.len(), 26);
        assert_eq!(rows[3].1, ["", "zoom in, out"]);
        assert_eq!(rows[4].1, ["look around", "move"]);
    }
}
