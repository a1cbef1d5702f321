//! The file that is watched: its text flows to the window whenever it holds another one.
//!
//! Its folder is what the system watches, since many editors write a new file and rename it. What comes in a burst is
//! read once, a little later.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use notify::{RecommendedWatcher, RecursiveMode, Watcher};

use crate::mail::{Letter, Mail};

/// For how long nothing must happen before the file is read.
const QUIET: Duration = Duration::from_millis(30);

/// Watches a file for as long as it lives.
#[derive(Debug)]
pub(crate) struct Watch {
    _watcher: RecommendedWatcher,
}

/// The text of a file.
///
/// # Errors
/// A sentence.
pub(crate) fn read(path: &Path) -> Result<String, String> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    String::from_utf8(bytes).map_err(|_| "it is not UTF-8".to_owned())
}

impl Watch {
    /// Starts to watch. `known` is the text that the window has.
    ///
    /// # Errors
    /// In the system's words.
    pub(crate) fn start(path: &Path, known: String, mail: Mail) -> Result<Self, String> {
        let path = std::path::absolute(path).map_err(|error| error.to_string())?;
        let folder = path.parent().unwrap_or(Path::new("/")).to_owned();
        let name = path.file_name().unwrap_or_default().to_owned();
        let (sender, events) = channel();
        let handler = move |event: notify::Result<notify::Event>| {
            // A watcher that has lost events says so by an error: look, to be sure.
            let concerns = event.map_or(true, |event| {
                !event.kind.is_access()
                    && event
                        .paths
                        .iter()
                        .any(|it: &PathBuf| it.file_name() == Some(&name))
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
            let mut known: Result<String, String> = Ok(known);
            // Ends when the watcher is dropped.
            while events.recv().is_ok() {
                loop {
                    match events.recv_timeout(QUIET) {
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
                if !mail.send(Letter::Changed { text }) {
                    return;
                }
            }
        });
        Ok(Self { _watcher: watcher })
    }
}
