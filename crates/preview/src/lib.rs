//! The live preview window: shows views of a program while it is being written.
//!
//! ```text
//! io/: watch (a file), link (an editor) ──text──▶ engine/compiler ──scene, findings──▶ session::Model
//!                                                                                       │
//!   ui/: keys, pointer, sliders, menus ──window, panes──▶ session: plain data ◀─────────┘
//!                                                            │ session::request: what to show
//!                                                            ▼
//!                                    engine/render_thread: the renderer ──pictures──▶ ui/panes
//! ```
//!
//! The parts below `ui` know nothing of it: each sends events of its own type over a `channel`, and the window combines
//! them in one enum. The folders use each other only downward: `ui`, then `engine`, then `io`, then `channel`,
//! `ending`, `queue`, `examples` and `platform`. Code that involves no window, thread or file is in the crate
//! `session`.
//!
//! Nothing is drawn unless something has changed: the threads wake the window when they have something to show, and
//! only an animation or a held key makes it draw continuously. The window's own thread waits for others only where the
//! user does not notice: for pictures that are expected within the frame, and for files when it closes.

mod channel;
mod ending;
mod engine;
mod examples;
mod io;
mod platform;
mod queue;
mod ui;

use std::fmt;
use std::path::PathBuf;

use ide::Languages;
use render::Views;

pub use ending::Ending;
pub use engine::remembered::remembered;
pub use io::report::Counters;
pub use render::Backend;
pub use ui::app::{run, run_with_faults};
pub use ui::window::Window;

/// The options of a window.
#[derive(Debug)]
pub struct Options {
    /// The source of its text.
    pub source: Source,
    /// Requests from elsewhere that the window end.
    pub ending: Ending,
    /// The languages of programs; a file's extension selects one of them.
    pub languages: Languages,
    /// The views that it offers.
    pub views: Views,
    /// The backend that draws the pictures.
    pub backend: Backend,
    /// A file for counters, one JSON object per line for each frame, for tests of the real window. See [`Counters`].
    pub report: Option<PathBuf>,
}

/// Faults of a window's GPU, for tests of the real window.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    /// The GPU is given up, as though it were lost, when a file of this name exists.
    pub loses_gpu: Option<PathBuf>,
    /// The number of times that the GPU is given up.
    pub losses: u32,
    /// True if it is given up after a frame's layout and before its painting, rather than before a frame.
    pub loses_in_frame: bool,
    /// True if it refuses the shaders that compute samples.
    pub refuses_samples: bool,
}

/// The source of a window's text.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Source {
    /// A file, which is watched, and which the window's own pane edits.
    File(PathBuf),
    /// No program yet: the window offers new ones, recent ones, and the examples.
    Welcome,
    /// An editor's language server, over standard input and output.
    Attached,
}

/// The reason why no window can be opened.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// There is no display, or it refuses a window.
    NoDisplay {
        /// The system's message.
        reason: String,
    },
    /// The window cannot be drawn: no graphics driver was found.
    NoGraphics {
        /// The system's message.
        reason: String,
    },
    /// The system cannot start a thread for the window's work.
    NoThread {
        /// The system's message.
        reason: String,
    },
    /// The file cannot be read.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's message.
        reason: String,
    },
}

impl Failure {
    /// Appends a further sentence for the user to the reason.
    fn and(mut self, sentence: Option<String>) -> Self {
        let (Self::NoDisplay { reason }
        | Self::NoGraphics { reason }
        | Self::NoThread { reason }
        | Self::Unreadable { reason, .. }) = &mut self;
        if let Some(sentence) = sentence {
            *reason = format!("{reason}; {sentence}");
        }
        self
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDisplay { reason } => write!(
                f,
                "the window cannot be opened: there is no display ({reason})"
            ),
            Self::NoGraphics { reason } => write!(
                f,
                "the window cannot be opened: no graphics driver can draw it ({reason})"
            ),
            Self::NoThread { reason } => write!(
                f,
                "the window cannot be opened: the system cannot start a thread ({reason})"
            ),
            Self::Unreadable { path, reason } => {
                write!(f, "cannot read `{}`: {reason}", path.display())
            }
        }
    }
}

impl std::error::Error for Failure {}

/// The failure to start a thread.
impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::NoThread {
            reason: error.to_string(),
        }
    }
}
