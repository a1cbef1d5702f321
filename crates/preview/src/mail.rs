//! How the threads reach the window: letters wake it, but for those behind which another is about to come.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use render::texture::Texture;

use crate::artist::Answer;
use crate::compiler::Compiled;
use crate::link::Parting;
use crate::watch::Unreadable;

/// What a thread tells the window.
#[derive(Debug)]
pub(crate) enum Letter {
    /// A text has been compiled.
    Compiled(Compiled),
    /// The artist has finished something.
    Artist(Box<Answer>),
    /// The file on disk holds another text now.
    Changed {
        /// The text, or why it cannot be read.
        text: Result<String, Unreadable>,
    },
    /// The server has sent something.
    Server(protocol::Command),
    /// A view is to be seen of the text of this version, if the server has sent one already.
    Show {
        /// Which; the 3D view where none is named.
        view: Option<protocol::View>,
        /// The last text before.
        version: Option<i32>,
    },
    /// Nothing more comes from the server.
    Parted(Parting),
    /// An image has been read.
    Texture {
        /// Its file.
        path: PathBuf,
        /// The texture, or a sentence.
        texture: Result<Arc<Texture>, String>,
    },
    /// The user has chosen image files in a dialog.
    Images(Vec<PathBuf>),
    /// The user has chosen in a dialog where a file is to be written.
    Chosen(PathBuf),
    /// No dialog can be opened in which images could be chosen.
    NoDialogForImages,
    /// A sentence for the status line.
    Say {
        /// Whether it is an error.
        error: bool,
        /// The sentence.
        text: String,
    },
}

/// Sends letters; cheap to clone.
#[derive(Clone, Debug)]
pub(crate) struct Mail {
    sender: Sender<Letter>,
    context: Arc<Mutex<egui::Context>>,
    /// The window waits for letters, and need not be woken.
    listens: Arc<AtomicBool>,
}

impl Mail {
    /// A letter box for a window.
    pub(crate) fn new(context: egui::Context) -> (Self, Receiver<Letter>) {
        let (sender, receiver) = channel();
        let context = Arc::new(Mutex::new(context));
        let mail = Self {
            sender,
            context,
            listens: Arc::default(),
        };
        (mail, receiver)
    }

    /// Sends a letter and wakes the window; false where it is no more.
    pub(crate) fn send(&self, letter: Letter) -> bool {
        let sent = self.sender.send(letter).is_ok();
        if !self.listens.load(Ordering::SeqCst) {
            self.wake();
        }
        sent
    }

    /// Whether the window waits for letters from now on. Where it does no longer, it looks once more: what was sent
    /// before that has not woken it.
    pub(crate) fn listen(&self, listens: bool) {
        self.listens.store(listens, Ordering::SeqCst);
    }

    /// Wakes the window, which has something to look at.
    pub(crate) fn wake(&self) {
        let context = self.context.lock().unwrap_or_else(PoisonError::into_inner);
        // At once, but once: without any delay it would be drawn twice.
        context.request_repaint_after(Duration::from_nanos(1));
    }

    /// Sends a letter that may wait for the next one to wake the window; false where it is no more.
    pub(crate) fn leave(&self, letter: Letter) -> bool {
        self.sender.send(letter).is_ok()
    }

    /// Does what takes its time on a thread of its own, and has the sentence told that becomes of it.
    pub(crate) fn tell_when_done(
        &self,
        work: impl FnOnce() -> Result<String, String> + Send + 'static,
    ) {
        let mail = self.clone();
        std::thread::spawn(move || {
            // A fault of ours is told too.
            let done = catch_unwind(AssertUnwindSafe(work));
            let done = done.unwrap_or_else(|_| Err("internal error: it was not done".to_owned()));
            let (error, text) = match done {
                Ok(text) => (false, text),
                Err(text) => (true, text),
            };
            mail.send(Letter::Say { error, text });
        });
    }

    /// From now on letters wake another window.
    pub(crate) fn readdress(&self, context: egui::Context) {
        *self.context.lock().unwrap_or_else(PoisonError::into_inner) = context;
    }
}

#[cfg(test)]
mod tests {
    use super::{Letter, Mail};

    #[test]
    fn what_becomes_of_a_work_is_told_also_where_it_fails() {
        let (mail, letters) = Mail::new(egui::Context::default());
        let told = || match letters.recv().expect("a letter") {
            Letter::Say { error, text } => (error, text),
            other => panic!("{other:?}"),
        };
        mail.tell_when_done(|| Ok("done".to_owned()));
        assert_eq!(told(), (false, "done".to_owned()));
        mail.tell_when_done(|| Err("no room".to_owned()));
        assert_eq!(told(), (true, "no room".to_owned()));
        mail.tell_when_done(|| panic!("a fault"));
        let (error, text) = told();
        assert!(error && text.starts_with("internal error"), "{text}");
    }
}
