//! The desktop's own file dialogs, each on a thread of its own, and whether the desktop has any.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

use log::{Level, LevelFilter, Log, Metadata, Record};
use rfd::FileDialog;

use crate::channel::{EventSender, start_thread};

/// The user's choice in a dialog.
#[derive(Clone, Debug)]
pub(crate) enum FileChoice {
    /// Image files.
    Images(Vec<PathBuf>),
    /// A program to open.
    Program(PathBuf),
    /// The path of a file to write.
    Target(PathBuf),
    /// No dialog can be opened for choosing images.
    NoDialogForImages,
    /// No dialog can be opened for choosing a program.
    NoDialogForProgram,
}

/// The sentence for a desktop without dialogs.
pub(crate) const NO_DIALOG: &str = "No file dialog can be opened here: type the file's name.";

/// True once a requested dialog could not be opened.
static MISSING: AtomicBool = AtomicBool::new(false);

/// Returns whether dialogs can be opened, as far as is known.
pub(crate) fn has_dialogs() -> bool {
    !MISSING.load(Ordering::Relaxed)
}

/// Lets the user choose image files, which become textures.
pub(crate) fn choose_images(events: EventSender<FileChoice>, folder: Option<PathBuf>) {
    let dialog = in_folder(FileDialog::new(), folder.as_deref())
        .set_title("Open textures")
        .add_filter("Images", &["png", "jpg", "jpeg"]);
    let missing = Some(FileChoice::NoDialogForImages);
    ask(
        events,
        move || dialog.pick_files(),
        FileChoice::Images,
        missing,
    );
}

/// Lets the user choose a program, whose file has one of some extensions.
pub(crate) fn choose_program(
    events: EventSender<FileChoice>,
    folder: Option<PathBuf>,
    extensions: Vec<&'static str>,
) {
    let dialog = in_folder(FileDialog::new(), folder.as_deref())
        .set_title("Open program")
        .add_filter("Programs", &extensions);
    let missing = Some(FileChoice::NoDialogForProgram);
    ask(
        events,
        move || dialog.pick_file(),
        FileChoice::Program,
        missing,
    );
}

/// Lets the user choose the path of a file to write; the window's open dialog receives it.
pub(crate) fn choose_target(events: EventSender<FileChoice>, title: String, proposed: PathBuf) {
    let name = proposed.file_name().unwrap_or_default().to_string_lossy();
    let dialog = in_folder(FileDialog::new(), proposed.parent())
        .set_title(title)
        .set_file_name(name);
    // The window's dialog reports that the desktop has none.
    ask(events, move || dialog.save_file(), FileChoice::Target, None);
}

fn in_folder(dialog: FileDialog, folder: Option<&Path>) -> FileDialog {
    match folder {
        Some(folder) => dialog.set_directory(folder),
        None => dialog,
    }
}

/// Opens a dialog on a thread of its own. Sends the choice as the event that `done` makes of it, or `missing` if no
/// dialog can be opened; wakes the window if there is nothing to send.
fn ask<T: 'static>(
    events: EventSender<FileChoice>,
    dialog: impl FnOnce() -> Option<T> + Send + 'static,
    done: fn(T) -> FileChoice,
    missing: Option<FileChoice>,
) {
    let (own, without) = (events.clone(), missing.clone());
    let thread = start_thread("file dialog", move || {
        let choice = match opened(dialog) {
            Ok(chosen) => chosen.map(done),
            Err(NoDialog) => without,
        };
        answer(&own, choice);
    });
    if thread.is_err() {
        answer(&events, missing);
    }
}

fn answer(events: &EventSender<FileChoice>, choice: Option<FileChoice>) {
    match choice {
        Some(choice) => {
            events.send(choice);
        }
        None => events.wake(),
    }
}

/// The error that no dialog can be opened.
struct NoDialog;

thread_local! {
    /// True if the dialog of this thread could not be opened.
    static FAILED: Cell<bool> = const { Cell::new(false) };
}

/// Returns the result of a dialog. A dialog that cannot be opened returns `None`, like one that is cancelled; only the
/// log tells the two apart.
fn opened<T>(dialog: impl FnOnce() -> Option<T>) -> Result<Option<T>, NoDialog> {
    static LISTENS: Once = Once::new();
    LISTENS.call_once(|| {
        // If the program has a log of its own, nothing is received here, and a failed dialog looks cancelled.
        if log::set_logger(&Listener).is_ok() {
            log::set_max_level(LevelFilter::Error);
        }
    });
    FAILED.set(false);
    let given = dialog();
    if given.is_none() && FAILED.get() {
        MISSING.store(true, Ordering::Relaxed);
        return Err(NoDialog);
    }
    Ok(given)
}

/// Receives the dialogs' log messages.
struct Listener;

impl Log for Listener {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.level() == Level::Error && metadata.target().starts_with("rfd")
    }

    fn log(&self, record: &Record<'_>) {
        // The program zenity is tried last, if the desktop's portal does not answer.
        if self.enabled(record.metadata()) && record.args().to_string().contains("zenity") {
            FAILED.set(true);
        }
    }

    fn flush(&self) {}
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::sync::mpsc::Receiver;

    use super::{FileChoice, ask, opened};
    use crate::channel::EventSender;

    #[test]
    fn a_dialog_that_says_it_cannot_be_opened_is_not_one_that_was_called_off() {
        assert!(matches!(opened(|| Some(1)), Ok(Some(1))));
        assert!(matches!(opened(|| None::<u8>), Ok(None)));
        let fails = || {
            log::error!(target: "rfd::backend", "Failed to save file with zenity: no such file");
            None::<u8>
        };
        assert!(opened(fails).is_err());
        assert!(!super::has_dialogs());
        // The portal's silence is no failure where zenity answers.
        let answers = || {
            log::error!(target: "rfd::backend", "Failed to connect to session bus");
            None::<u8>
        };
        assert!(matches!(opened(answers), Ok(None)));
    }

    #[test]
    fn a_dialog_that_was_called_off_chooses_nothing() {
        let choice = |chosen: Option<PathBuf>| -> Option<FileChoice> {
            let (sender, events): (_, Receiver<FileChoice>) =
                EventSender::new(egui::Context::default());
            let missing = Some(FileChoice::NoDialogForProgram);
            ask(sender, move || chosen, FileChoice::Program, missing);
            // The thread holds the last sender.
            events.recv().ok()
        };
        assert!(choice(None).is_none());
        let path = PathBuf::from("a.gtr");
        assert!(matches!(choice(Some(path.clone())), Some(FileChoice::Program(it)) if it == path));
    }
}
