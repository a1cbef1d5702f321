//! The desktop's own dialogs for files, each on a thread of its own; and what is known of a desktop that has none.

use std::cell::Cell;
use std::path::PathBuf;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

use log::{Level, LevelFilter, Log, Metadata, Record};

use crate::channel::EventSender;

/// The user's choice in a dialog.
#[derive(Debug)]
pub(crate) enum FileChoice {
    /// Image files.
    Images(Vec<PathBuf>),
    /// A program to be opened.
    Program(PathBuf),
    /// The place of a file that is to be written.
    Target(PathBuf),
    /// No dialog can be opened in which images could be chosen.
    NoDialogForImages,
    /// No dialog can be opened in which a program could be chosen.
    NoDialogForProgram,
}

/// The sentence for a desktop without dialogs.
pub(crate) const NO_DIALOG: &str = "No dialog for files can be opened here: write the file's name.";

/// Set when a dialog was requested and could not be opened.
static MISSING: AtomicBool = AtomicBool::new(false);

/// Returns whether dialogs can be opened, as far as is known.
pub(crate) fn has_dialogs() -> bool {
    !MISSING.load(Ordering::Relaxed)
}

/// Lets the user choose image files, which become textures.
pub(crate) fn choose_images(events: EventSender<FileChoice>, folder: Option<PathBuf>) {
    std::thread::spawn(move || {
        let mut dialog = rfd::FileDialog::new()
            .set_title("Open textures")
            .add_filter("Images", &["png", "jpg", "jpeg"]);
        if let Some(folder) = folder {
            dialog = dialog.set_directory(folder);
        }
        match opened(|| dialog.pick_files()) {
            Ok(paths) => events.send(FileChoice::Images(paths.unwrap_or_default())),
            Err(NoDialog) => events.send(FileChoice::NoDialogForImages),
        }
    });
}

/// Lets the user choose a program, whose file has one of some extensions.
pub(crate) fn choose_program(
    events: EventSender<FileChoice>,
    folder: Option<PathBuf>,
    extensions: Vec<&'static str>,
) {
    std::thread::spawn(move || {
        let mut dialog = rfd::FileDialog::new()
            .set_title("Open program")
            .add_filter("Programs", &extensions);
        if let Some(folder) = folder {
            dialog = dialog.set_directory(folder);
        }
        match opened(|| dialog.pick_file()) {
            Ok(Some(path)) => {
                events.send(FileChoice::Program(path));
            }
            Ok(None) => events.wake(),
            Err(NoDialog) => {
                events.send(FileChoice::NoDialogForProgram);
            }
        }
    });
}

/// Lets the user choose the place of a file that is written; the window's open dialog gets its name.
pub(crate) fn choose_target(events: EventSender<FileChoice>, title: String, proposed: PathBuf) {
    std::thread::spawn(move || {
        let name = proposed.file_name().unwrap_or_default().to_string_lossy();
        let mut dialog = rfd::FileDialog::new().set_title(title).set_file_name(name);
        if let Some(folder) = proposed.parent() {
            dialog = dialog.set_directory(folder);
        }
        match opened(|| dialog.save_file()) {
            Ok(Some(path)) => {
                events.send(FileChoice::Target(path));
            }
            // The window's dialog says that the desktop has none.
            Ok(None) | Err(NoDialog) => events.wake(),
        }
    });
}

/// No dialog can be opened.
struct NoDialog;

thread_local! {
    /// Set if the dialog of this thread could not be opened.
    static FAILED: Cell<bool> = const { Cell::new(false) };
}

/// Returns the result of a dialog. One that cannot be opened returns nothing, like one that is cancelled, and says
/// which only in the
/// log.
fn opened<T>(dialog: impl FnOnce() -> Option<T>) -> Result<Option<T>, NoDialog> {
    static LISTENS: Once = Once::new();
    LISTENS.call_once(|| {
        // Where a program has a log of its own, nothing is heard here, and a dialog that fails looks called off.
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

/// Hears what the dialogs say of themselves.
struct Listener;

impl Log for Listener {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.level() == Level::Error && metadata.target().starts_with("rfd")
    }

    fn log(&self, record: &Record<'_>) {
        // The program zenity is asked last, where the desktop's portal does not answer.
        if self.enabled(record.metadata()) && record.args().to_string().contains("zenity") {
            FAILED.set(true);
        }
    }

    fn flush(&self) {}
}

#[cfg(test)]
mod tests {
    use super::opened;

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
}
