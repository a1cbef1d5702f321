//! The preview windows of a session: one process for each document, fed with its texts.
//!
//! ```text
//! handlers ──[Previews]──▶ mailbox ──process.rs──▶ window      never waits; the latest text wins
//! the window's task ◀──── what it writes ◀──process.rs──┘
//! ```
//!
//! A window closes shortly after its document, since an editor that reloads a file closes it and opens it again; and
//! with the editor, whether it shuts down properly or not. If the server is killed, the window notices that and keeps
//! its picture.

mod process;
mod sent;

use std::collections::{BTreeMap, HashMap};
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use protocol::changes::Changes;
use protocol::{Command, Hello, ViewName};
use tokio::sync::mpsc::Receiver;

use crate::documents::{Open, Snapshot};
pub(crate) use process::{Gone, Process, WindowOutput};
pub(crate) use sent::SentVersions;

/// The command that opens a preview. Its arguments are a document's URI and, optionally, `{"view": "3d"}` or `{"view":
/// "geodesic", "surface": NAME}`.
pub(crate) const COMMAND: &str = "geotrace.preview";

/// The command that starts a preview window: a program that exchanges the messages of `protocol` on its standard
/// streams.
#[derive(Clone, Debug)]
pub struct WindowProgram {
    /// The program.
    pub program: PathBuf,
    /// Its arguments.
    pub arguments: Vec<OsString>,
    /// The maximum time until it sends its version.
    pub version_timeout: Duration,
    /// The time for which it outlives its document: an editor that reloads a file closes it and opens it again.
    pub close_delay: Duration,
}

impl WindowProgram {
    /// The default maximum time until a window sends its version, which it does before it opens a display.
    pub const VERSION_TIMEOUT: Duration = Duration::from_secs(10);
    /// The default time for which a window outlives its document.
    pub const CLOSE_DELAY: Duration = Duration::from_millis(500);

    /// Returns the command that starts this program itself, with these arguments.
    ///
    /// # Errors
    /// If the system cannot name the running program.
    pub fn own(arguments: impl IntoIterator<Item = impl Into<OsString>>) -> std::io::Result<Self> {
        Ok(Self {
            program: std::env::current_exe()?,
            arguments: arguments.into_iter().map(Into::into).collect(),
            version_timeout: Self::VERSION_TIMEOUT,
            close_delay: Self::CLOSE_DELAY,
        })
    }
}

/// All windows, by the document's URI.
#[derive(Debug, Default)]
pub(crate) struct Previews {
    open: HashMap<String, Preview>,
    /// Windows that have been forgotten, but may not have received the command to close.
    leaving: Vec<Arc<Process>>,
    counter: u64,
}

/// A window, as the session knows it.
#[derive(Debug)]
pub(crate) struct Preview {
    /// A number that distinguishes it from an earlier window of the same document.
    id: u64,
    path: Option<String>,
    process: Arc<Process>,
    /// The versions of the text to which the window may refer.
    pub(crate) sent: SentVersions,
    /// The text when the document was closed, until it is opened again.
    closed_text: Option<String>,
    /// The params' values in the window, by name.
    pub(crate) live: BTreeMap<String, Vec<f64>>,
    /// The number of a text, and the offset of the cursor in it.
    cursor: Option<(i32, u32)>,
    /// Set if its document has been closed.
    left: Option<Left>,
}

/// Identifies one closing of a document: after it has been opened and closed again, the value differs.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct Left(u64);

/// A window that has just started.
#[derive(Debug)]
pub(crate) struct Started {
    pub(crate) id: u64,
    pub(crate) process: Arc<Process>,
    pub(crate) outputs: Receiver<WindowOutput>,
}

impl Previews {
    /// Returns true if a document has a window.
    pub(crate) fn has(&self, uri: &str) -> bool {
        self.open.contains_key(uri)
    }

    /// Brings a document's window to the front. Returns false if it has none. A window that has ended, but whose end
    /// has not been reported yet, is forgotten.
    pub(crate) fn show(&mut self, uri: &str, view: Option<&ViewName>) -> bool {
        let Some(preview) = self.open.get(uri) else {
            return false;
        };
        if preview.process.has_ended() {
            self.open.remove(uri);
            return false;
        }
        preview.process.send(Command::Show {
            view: view.cloned(),
        });
        true
    }

    /// Starts a document's window; `cursor` is the position of the cursor in the text, if known.
    ///
    /// # Errors
    /// If the program cannot be started.
    pub(crate) fn start(
        &mut self,
        program: &WindowProgram,
        snapshot: &Snapshot,
        path: Option<String>,
        view: Option<ViewName>,
        cursor: Option<u32>,
    ) -> std::io::Result<Started> {
        let (process, outputs) = Process::start(program)?;
        self.counter += 1;
        let preview = Preview {
            id: self.counter,
            path,
            process: process.clone(),
            sent: SentVersions::default(),
            closed_text: None,
            live: BTreeMap::new(),
            cursor: None,
            left: None,
        };
        process.send(Command::Hello(Hello::own()));
        self.open.insert(snapshot.uri.clone(), preview);
        self.text(&snapshot.uri, snapshot.version, snapshot.text().string());
        // Unless a view is named, the window opens as the user left it.
        if view.is_some() {
            process.send(Command::Show { view });
        }
        if let Some(offset) = cursor {
            self.cursor(&snapshot.uri, snapshot.version, offset);
        }
        Ok(Started {
            id: self.counter,
            process,
            outputs,
        })
    }

    /// Sends the whole text to a document's window, if it has one.
    pub(crate) fn text(&mut self, uri: &str, version: i32, text: String) {
        let Some(preview) = self.open.get_mut(uri) else {
            return;
        };
        preview.left = None;
        let changes = preview.closed_text.take();
        let changes = changes.map(|old| Changes::between(&old, &text));
        let number = preview.sent.put(version, changes.as_ref());
        preview.send_text(uri, number, text);
    }

    /// Sends an edit to a document's window, if it has one; or the whole text, if that is shorter than the edits that
    /// the window has not read yet.
    pub(crate) fn edit(&mut self, uri: &str, open: &Open, changes: &Changes) {
        let Some(preview) = self.open.get_mut(uri) else {
            return;
        };
        let base = preview.sent.last();
        let number = preview.sent.put(open.version, Some(changes));
        let length = changes.weight() + preview.process.waiting_edits();
        match base {
            Some(base) if length < open.text().len() as usize => {
                let overtaken = preview.process.send(Command::Edit {
                    version: number,
                    base,
                    changes: changes.clone(),
                });
                preview.never_read(&overtaken);
            }
            _ => preview.send_text(uri, number, open.text().string()),
        }
    }

    /// Keeps the text of a document that is closed or reloaded, so that ranges in it can be located later.
    pub(crate) fn keep_text(&mut self, uri: &str, open: &Open) {
        if let Some(preview) = self.open.get_mut(uri) {
            preview.closed_text = Some(open.text().string());
        }
    }

    /// Sends the whole text again to a window that lacks it.
    pub(crate) fn resend(&mut self, uri: &str, id: u64, open: &Open) {
        if let Some(preview) = self.of(uri, id)
            && let Some(number) = preview.sent.last()
        {
            preview.send_text(uri, number, open.text().string());
        }
    }

    /// Sends the position of the cursor in the text of the editor's version to a document's window, if it has one.
    pub(crate) fn cursor(&mut self, uri: &str, version: i32, offset: u32) {
        let Some(preview) = self.open.get_mut(uri) else {
            return;
        };
        let version = preview.sent.number(version);
        if preview.cursor.replace((version, offset)) != Some((version, offset)) {
            preview.process.send(Command::Cursor { version, offset });
        }
    }

    /// Records that a window shows the text with a number. Returns its version, if the editor still knows it. The
    /// position of the cursor is sent again, since the window may not have read that text when the position was first
    /// sent.
    pub(crate) fn shown(&mut self, uri: &str, id: u64, number: i32, ok: bool) -> Option<i32> {
        let preview = self.of(uri, id)?;
        preview.sent.shown(number, ok);
        if let Some((version, offset)) = preview.cursor
            && version == number
        {
            preview.process.send(Command::Cursor { version, offset });
        }
        preview.sent.version(number)
    }

    /// Notes that a document has been closed: its window, if it has one, is to be closed by [`Self::close`], unless the
    /// document has been opened again by then.
    pub(crate) fn leave(&mut self, uri: &str) -> Option<Left> {
        let preview = self.open.get_mut(uri)?;
        self.counter += 1;
        preview.left = Some(Left(self.counter));
        preview.left
    }

    /// Closes and removes the window of a document that was closed and has not been opened since.
    pub(crate) fn close(&mut self, uri: &str, left: Left) {
        let is_left = |preview: &Preview| preview.left == Some(left);
        if self.open.get(uri).is_some_and(is_left)
            && let Some(preview) = self.open.remove(uri)
        {
            self.dismiss(preview.process);
        }
    }

    /// Sends the command to close to all windows. Returns those that may not have received it yet.
    pub(crate) fn close_all(&mut self) -> Vec<Arc<Process>> {
        let all: Vec<_> = self.open.drain().map(|(_, it)| it.process).collect();
        for process in all {
            self.dismiss(process);
        }
        self.leaving.clone()
    }

    fn dismiss(&mut self, process: Arc<Process>) {
        process.close();
        self.leaving.retain(|process| !process.is_all_written());
        self.leaving.push(process);
    }

    /// Forgets a window that has ended or is about to. Returns it, unless it was already forgotten.
    pub(crate) fn forget(&mut self, uri: &str, id: u64) -> Option<Preview> {
        self.of(uri, id)?;
        self.open.remove(uri)
    }

    /// Returns a window, unless it has been forgotten.
    pub(crate) fn of(&mut self, uri: &str, id: u64) -> Option<&mut Preview> {
        self.open.get_mut(uri).filter(|preview| preview.id == id)
    }

    /// Returns the params' values in a document's window, by name.
    pub(crate) fn live(&self, uri: &str) -> Option<&BTreeMap<String, Vec<f64>>> {
        let preview = self.open.get(uri)?;
        (!preview.live.is_empty()).then_some(&preview.live)
    }
}

impl Preview {
    fn send_text(&mut self, uri: &str, number: i32, text: String) {
        let overtaken = self.process.send(Command::Text {
            uri: uri.to_owned(),
            path: self.path.clone(),
            version: number,
            text: text.into(),
        });
        self.never_read(&overtaken);
    }

    /// Notes that versions will not be read because a later one has replaced them in the mailbox.
    fn never_read(&mut self, numbers: &[i32]) {
        for number in numbers {
            self.sent.never_read(*number);
        }
    }
}
