//! A request from another thread that the window end, such as for a signal that would end the process.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Requests that a window end; cheap to clone. A text that was not saved is written beside its file, as when a system
/// ends all programs.
#[derive(Clone, Debug, Default)]
pub struct Ending(Arc<EndingState>);

#[derive(Debug, Default)]
struct EndingState {
    is_asked: AtomicBool,
    /// The context of the open window, to wake it.
    window: Mutex<Option<egui::Context>>,
}

impl Ending {
    /// Requests that the window end. Returns false if none is open.
    pub fn ask(&self) -> bool {
        let window = self.0.window.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(context) = &*window else {
            return false;
        };
        self.0.is_asked.store(true, Ordering::Relaxed);
        context.request_repaint();
        true
    }

    /// Directs future requests to this window.
    pub(crate) fn opened(&self, context: &egui::Context) {
        let mut window = self.0.window.lock().unwrap_or_else(PoisonError::into_inner);
        *window = Some(context.clone());
    }

    /// Returns true once the window has been requested to end.
    pub(crate) fn is_asked(&self) -> bool {
        self.0.is_asked.load(Ordering::Relaxed)
    }
}
