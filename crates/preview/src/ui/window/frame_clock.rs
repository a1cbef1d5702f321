//! The times on which a window's frames depend.

use std::time::Duration;

use session::Model;
use session::attention::Attention;
use session::camera_input::MOTION_PAUSE;

/// The times of the window. Points in time are in seconds, as counted by egui.
#[derive(Debug, Default)]
pub(crate) struct FrameClock {
    /// The maximum time that a frame waits for its pictures.
    pub(super) wait_budget: Duration,
    /// The time that this frame has waited.
    pub(crate) waited: Duration,
    /// The time that the previous frame took.
    pub(crate) painting: Duration,
    /// The view or a param counts as moving until this time.
    pub(super) moving_until: f64,
    /// Input before this time extends the current undo step.
    pub(super) gesture_until: f64,
    /// True if the last text has just arrived.
    has_text: bool,
    /// The times at which faults are shown and the emphasis ends.
    pub(super) attention: Attention,
}

impl FrameClock {
    /// Notes that a view or a param is moving.
    pub(super) fn note_motion(&mut self, now: f64) {
        self.moving_until = now + MOTION_PAUSE;
    }

    /// Notes that the user moves a view or a param.
    pub(super) fn note_gesture(&mut self, now: f64) {
        self.note_motion(now);
        // A notch of a wheel is spread over several frames, in which no button is held.
        self.gesture_until = self.moving_until;
    }

    /// Notes that another text has been compiled.
    pub(super) fn note_text(&mut self) {
        self.has_text = true;
    }

    /// Advances the faults and the emphasis ([`Attention::advance`]). Returns true if faults are shown now.
    pub(super) fn advance_attention(&mut self, model: &mut Model, now: f64) -> bool {
        if std::mem::take(&mut self.has_text) {
            self.attention.note_text(now);
        }
        self.attention.advance(model, now)
    }

    /// Resets the times: another context counts from its own start.
    pub(super) fn restart(&mut self) {
        self.moving_until = 0.0;
        self.gesture_until = 0.0;
        self.attention = Attention::default();
    }
}
