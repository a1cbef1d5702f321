//! The dialogs for a program's file: for opening one, and for saving one.

use std::path::{Path, PathBuf};

use egui::{Grid, Ui};
use session::StatusMessage;

use super::Dialog;
use super::picture::{self, Decision};
use crate::ui::window::{Next, TextSource, Window};

/// The dialog for a program's file.
#[derive(Clone, Debug)]
pub(crate) struct ProgramDialog {
    pub(crate) path: String,
    purpose: FileAction,
}

/// The purpose of the dialog.
#[derive(Clone, Debug, Eq, PartialEq)]
enum FileAction {
    /// The file is opened.
    Open,
    /// The program is written to the file; then another step may follow.
    Save(Option<Next>),
}

/// Opens the desktop's dialog for opening a program.
pub(crate) fn choose_file(window: &Window) {
    let languages = window.text.languages();
    let extensions = languages.all().flat_map(|it| it.extensions()).copied();
    crate::io::file_dialogs::choose_program(
        window.events.file_choices(),
        window.text.folder(),
        extensions.collect(),
    );
}

/// Opens the dialog for the name of a program to open.
pub(crate) fn ask_for_file(window: &mut Window) {
    window.dialogs.open = Some(Dialog::Program(ProgramDialog {
        path: picture::in_folder(window, ""),
        purpose: FileAction::Open,
    }));
    window.dialogs.wants_name = true;
}

/// Opens the dialog for the file to which the program is to be written.
pub(crate) fn ask_for_target(window: &mut Window, next: Option<Next>) {
    if let TextSource::File { editor, .. } = &window.text.source {
        let path = std::path::absolute(&editor.path);
        let path = path.unwrap_or_else(|_| editor.path.clone());
        window.dialogs.open = Some(Dialog::Program(ProgramDialog {
            path: path.display().to_string(),
            purpose: FileAction::Save(next),
        }));
        window.dialogs.wants_name = true;
    }
}

/// Shows the dialog.
pub(super) fn show(window: &mut Window, mut dialog: ProgramDialog, ui: &Ui) {
    let (title, verb) = match dialog.purpose {
        FileAction::Open => ("Open program", "Open"),
        FileAction::Save(_) => ("Save program", picture::verb(Path::new(&dialog.path))),
    };
    let saves = dialog.purpose != FileAction::Open;
    let decision = picture::modal(ui, title, verb, |ui| {
        let mut choose = false;
        Grid::new("program").num_columns(2).show(ui, |ui| {
            choose = picture::file(ui, &mut dialog.path);
        });
        if saves {
            picture::replaced(ui, Path::new(&dialog.path));
        }
        choose
    });
    match decision {
        Decision::Cancel => {
            let message = &mut window.status_message;
            message.take_if(|it| it.text == crate::io::file_dialogs::NO_DIALOG);
            return;
        }
        Decision::Save => return take_file(window, dialog),
        Decision::Choose if !saves => return choose_file(window),
        Decision::Choose => picture::choose(window, title, &dialog.path),
        Decision::Stay => {}
    }
    window.dialogs.open = Some(Dialog::Program(dialog));
}

fn take_file(window: &mut Window, dialog: ProgramDialog) {
    let path = PathBuf::from(dialog.path.trim());
    match dialog.purpose {
        FileAction::Open => window.go_on(Next::File(path)),
        FileAction::Save(next) => match window.save_text_as(path) {
            Ok(()) => {
                if let Some(next) = next {
                    window.take_next(next);
                }
            }
            Err(sentence) => window.status_message = Some(StatusMessage::error(sentence)),
        },
    }
}
