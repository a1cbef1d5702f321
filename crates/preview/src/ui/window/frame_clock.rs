//! The times that a window's frames depend on.

use std::time::Duration;

/// The pause between two turns of a wheel: a view counts as moving for so long after its last motion, in seconds.
const MOTION_PAUSE: f64 = 0.18;

/// The pause in typing after which faults are shown, in seconds.
const TYPING_PAUSE: f64 = 0.5;
/// The time for which the object at the cursor is set off in the views in space, in seconds.
const EMPHASIS: f64 = 1.0;

/// The times of the window. Points in time are in seconds, as egui counts them.
#[derive(Debug, Default)]
pub(crate) struct FrameClock {
    /// The longest time that a frame waits for its pictures.
    pub(super) wait_budget: Duration,
    /// The time that this frame has waited.
    pub(crate) waited: Duration,
    /// The time that the frame before this one took.
    pub(crate) painting: Duration,
    /// The view or a param counts as moving until this time.
    pub(super) moving_until: f64,
    /// Input before this time extends the current undo step.
    pub(super) gesture_until: f64,
    /// The last text has just come.
    has_text: bool,
    /// The text counts as being typed until this time.
    pub(super) typing_until: f64,
    /// The object at the cursor is set off until this time.
    pub(super) emphasis_until: f64,
}

impl FrameClock {
    /// Notes that a view or a param is moving.
    pub(super) fn note_motion(&mut self, now: f64) {
        self.moving_until = now + MOTION_PAUSE;
    }

    /// Notes that the user moves a view or a param.
    pub(super) fn note_gesture(&mut self, now: f64) {
        self.note_motion(now);
        // A notch of a wheel is spread over frames, in which no button is held.
        self.gesture_until = self.moving_until;
    }

    /// Notes that another text has been compiled.
    pub(super) fn note_text(&mut self) {
        self.has_text = true;
    }

    /// Returns whether the last text came a while ago.
    pub(super) fn is_typing_over(&mut self, now: f64) -> bool {
        if std::mem::take(&mut self.has_text) {
            self.typing_until = now + TYPING_PAUSE;
        }
        now >= self.typing_until
    }

    /// Sets an object off from now on, for a while.
    pub(super) fn begin_emphasis(&mut self, now: f64) {
        self.emphasis_until = now + EMPHASIS;
    }

    /// Begins anew: another context counts its time from the beginning.
    pub(super) fn restart(&mut self) {
        self.moving_until = 0.0;
        self.gesture_until = 0.0;
        self.typing_until = 0.0;
        self.emphasis_until = 0.0;
    }
}
