//! The end of a window that another thread asks for: a signal that would end the process.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Asks a window to end; cheap to clone. A text that was not saved is written beside its file, as where a system ends all
/// programs.
#[derive(Clone, Debug, Default)]
pub struct Ending(Arc<EndingState>);

#[derive(Debug, Default)]
struct EndingState {
    is_asked: AtomicBool,
    /// Wakes the window that is open.
    window: Mutex<Option<egui::Context>>,
}

impl Ending {
    /// Asks the window to end. Returns false if none is open.
    pub fn ask(&self) -> bool {
        let window = self.0.window.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(context) = &*window else {
            return false;
        };
        self.0.is_asked.store(true, Ordering::Relaxed);
        context.request_repaint();
        true
    }

    /// From now on this window is asked.
    pub(crate) fn opened(&self, context: &egui::Context) {
        let mut window = self.0.window.lock().unwrap_or_else(PoisonError::into_inner);
        *window = Some(context.clone());
    }

    /// Returns true once the window has been asked to end.
    pub(crate) fn is_asked(&self) -> bool {
        self.0.is_asked.load(Ordering::Relaxed)
    }
}
