//! The times that a window's frames depend on.

use std::time::Duration;

/// The pause between two turns of a wheel: a view counts as moving for so long after its last motion, in seconds.
const MOTION_PAUSE: f64 = 0.18;

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

    /// Begins anew: another context counts its time from the beginning.
    pub(super) fn restart(&mut self) {
        self.moving_until = 0.0;
        self.gesture_until = 0.0;
    }
}
