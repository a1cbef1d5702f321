//! Progress bars, by `indicatif`: on standard error, only on a terminal, and only for long work.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// The delay before a bar appears: most pictures are ready before a bar could be read.
const DELAY: Duration = Duration::from_millis(400);
/// The number of steps of the bar.
const STEPS: u64 = 1000;

/// A bar that appears once the work has taken long enough. Without a terminal it has no effect.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    start: Instant,
}

impl Progress {
    /// Starts the clock of a piece of work; `label` is a short phrase such as `drawing`.
    pub(crate) fn start(label: &'static str) -> Self {
        // indicatif draws nothing if standard error is not a terminal.
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
        if let Ok(style) =
            ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %, {eta} left")
        {
            bar.set_style(style);
        }
        bar.set_message(label);
        Self {
            bar,
            start: Instant::now(),
        }
    }

    /// Shows the elapsed time of work of unknown length.
    pub(crate) fn of_unknown_length(label: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
            bar.set_style(style);
        }
        bar.set_message(label);
        bar.enable_steady_tick(DELAY);
        Self {
            bar,
            start: Instant::now(),
        }
    }

    /// Reports the completed fraction of the work, from 0 to 1. May be called from any thread, and often.
    pub(crate) fn reach(&self, fraction: f32) {
        if self.start.elapsed() > DELAY {
            let step = f64::from(fraction.clamp(0.0, 1.0)) * STEPS as f64;
            self.bar.set_position(step as u64);
        }
    }

    /// Removes the bar.
    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.clear();
    }
}
