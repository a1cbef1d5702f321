//! The file that is watched: its text flows to the window whenever it holds another one.
//!
//! Its folder is what the system watches, since many editors write a new file and rename it. What comes in a burst is
//! read once, a little later.

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use export::whole_file::phrase;
use ide::language::LONGEST_PROGRAM;
use notify::{RecommendedWatcher, RecursiveMode, Watcher};

use crate::channel::EventSender;
use crate::io::files::read_limited;

/// The time for which nothing must happen before the file is read.
const QUIET: Duration = Duration::from_millis(30);

/// Watches a file for as long as it lives.
#[derive(Debug)]
pub(crate) struct Watch {
    _watcher: RecommendedWatcher,
}

/// The text of a watched file as it is now.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) struct ChangedFile {
    /// The file, by the path that it was watched by: the window may show another one by now.
    pub(crate) path: PathBuf,
    /// Its text.
    pub(crate) text: Result<String, Unreadable>,
}

/// The reason why a file has no text.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum Unreadable {
    /// The file does not exist; in the system's words.
    Missing(String),
    /// It cannot be read; in the system's words.
    Refused(String),
    /// It holds something else.
    NoText,
}

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(reason) | Self::Refused(reason) => f.write_str(reason),
            Self::NoText => f.write_str("it is not UTF-8"),
        }
    }
}

/// The text of a file.
///
/// # Errors
/// See [`Unreadable`].
pub(crate) fn read(path: &Path) -> Result<String, Unreadable> {
    let bytes = read_limited(path, LONGEST_PROGRAM).map_err(|error| match error.kind() {
        ErrorKind::NotFound => Unreadable::Missing(phrase(&error.to_string())),
        _ => Unreadable::Refused(phrase(&error.to_string())),
    })?;
    String::from_utf8(bytes).map_err(|_| Unreadable::NoText)
}

impl Watch {
    /// Starts to watch. `known` is the text that the window has.
    ///
    /// # Errors
    /// In the system's words.
    pub(crate) fn start(
        path: &Path,
        known: String,
        events: EventSender<ChangedFile>,
    ) -> Result<Self, String> {
        let watched_path = path.to_owned();
        let path = std::path::absolute(path).map_err(|error| error.to_string())?;
        let folder = path.parent().unwrap_or(Path::new("/")).to_owned();
        let name = path.file_name().unwrap_or_default().to_owned();
        let (sender, changes) = channel();
        let handler = move |event: notify::Result<notify::Event>| {
            // A watcher that has lost events says so by an error: look, to be sure.
            let concerns = event.map_or(true, |event| {
                !event.kind.is_access()
                    && event.paths.iter().any(|it: &PathBuf| {
                        // Some systems take a name in any case.
                        it.file_name()
                            .is_some_and(|it| it.eq_ignore_ascii_case(&name))
                    })
            });
            if concerns {
                let _ = sender.send(());
            }
        };
        let mut watcher =
            notify::recommended_watcher(handler).map_err(|error| error.to_string())?;
        watcher
            .watch(&folder, RecursiveMode::NonRecursive)
            .map_err(|error| error.to_string())?;
        std::thread::spawn(move || {
            let mut known: Result<String, Unreadable> = Ok(known);
            // Ends when the watcher is dropped.
            while changes.recv().is_ok() {
                loop {
                    match changes.recv_timeout(QUIET) {
                        Ok(()) => {}
                        Err(RecvTimeoutError::Timeout) => break,
                        Err(RecvTimeoutError::Disconnected) => return,
                    }
                }
                let text = read(&path);
                if text == known {
                    continue;
                }
                known.clone_from(&text);
                let changed = ChangedFile {
                    path: watched_path.clone(),
                    text,
                };
                if !events.send(changed) {
                    return;
                }
            }
        });
        Ok(Self { _watcher: watcher })
    }
}
