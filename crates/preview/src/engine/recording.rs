//! A running recording: a thread that draws the pictures of an animation and writes them.

pub(crate) mod film;

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::JoinHandle;

use session::StatusMessage;

use crate::channel::{EventSender, start_thread};
use film::{Ended, Film};

/// A running recording. Dropping it cancels it, and leaves no file.
#[derive(Debug)]
pub(crate) struct Recording {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    frames: u32,
    /// The number of the picture that is being drawn, from 1; 0 before the first.
    now: AtomicU32,
    cancelled: AtomicBool,
    ended: AtomicBool,
}

impl Recording {
    /// Starts to record a film into a file.
    ///
    /// # Errors
    /// The system's error if it cannot start a thread.
    pub(crate) fn start(
        events: EventSender<StatusMessage>,
        film: Film,
        path: PathBuf,
    ) -> io::Result<Self> {
        let shared = Arc::new(Shared {
            frames: film.clip.frames,
            now: AtomicU32::new(0),
            cancelled: AtomicBool::new(false),
            ended: AtomicBool::new(false),
        });
        let own = Arc::clone(&shared);
        let work = move || {
            let result = film.shoot(&path, &|number| {
                own.now.store(number + 1, Ordering::Relaxed);
                events.wake();
                !own.cancelled.load(Ordering::Relaxed)
            });
            own.ended.store(true, Ordering::Release);
            events.send(match result {
                Ok(text) => StatusMessage::info(text),
                Err(Ended::Failed(text)) => StatusMessage::error(text),
                Err(Ended::Cancelled) => {
                    StatusMessage::info("The recording was cancelled: no file was written")
                }
            });
        };
        Ok(Self {
            shared,
            thread: Some(start_thread("record", work)?),
        })
    }

    /// Cancels the recording.
    pub(crate) fn cancel(&self) {
        self.shared.cancelled.store(true, Ordering::Relaxed);
    }

    /// Returns the number of the picture that is being drawn, from 1 (0 before the first), and the number of pictures.
    pub(crate) fn progress(&self) -> (u32, u32) {
        (self.shared.now.load(Ordering::Relaxed), self.shared.frames)
    }

    /// Returns whether it has ended.
    pub(crate) fn has_ended(&self) -> bool {
        let panicked = self.thread.as_ref().is_some_and(JoinHandle::is_finished);
        self.shared.ended.load(Ordering::Acquire) || panicked
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        self.shared.cancelled.store(true, Ordering::Relaxed);
        // The thread ends after the picture that it is drawing.
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
