//! The live preview window: views of a program while it is written.
//!
//! ```text
//! io/: watch (a file), link (an editor) ──text──▶ engine/compiler ──scene, findings──▶ session::Model
//!                                                                                       │
//!   ui/: keys, pointer, sliders, menus ──window, panes──▶ session: plain data ◀─────────┘
//!                                                            │ session::request: what is to be seen
//!                                                            ▼
//!                                    engine/render_thread: the renderer ──pictures──▶ ui/panes
//! ```
//!
//! The parts below `ui` know nothing of it: each sends events of its own type over a `channel`, and the window makes
//! one enum of them. The folders use each other only downward: `ui`, then `engine`, then `io`, then `channel`,
//! `ending`, `queue`, `examples` and `platform`. What is neither window nor thread nor file is in the crate `session`.
//!
//! Nothing is drawn unless something has changed: the threads wake the window when they have something to show, and
//! only an animation or a held key lets it draw by itself. The window's own thread waits for others only where that costs
//! nothing that is seen: for pictures that are expected within the frame, and for files when it closes.

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
    /// Asked to end it from elsewhere.
    pub ending: Ending,
    /// The languages of programs; the extension of a file chooses one of them.
    pub languages: Languages,
    /// The views that it offers.
    pub views: Views,
    /// The backend that draws the pictures.
    pub backend: Backend,
    /// A file for counters, one JSON object a line for each frame of the window: for tests of the real
    /// window. See [`Counters`].
    pub report: Option<PathBuf>,
}

/// Faults of a window's GPU, for tests of the real window.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    /// It is given up, as though it were lost, when there is a file of this name.
    pub loses_gpu: Option<PathBuf>,
    /// The number of times that it is given up.
    pub losses: u32,
    /// It is given up when a frame is laid out and not yet painted, rather than before a frame.
    pub loses_in_frame: bool,
    /// It refuses shaders of samples.
    pub refuses_samples: bool,
}

/// The source of a window's text.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Source {
    /// A file, which is watched, and which the window's own pane edits.
    File(PathBuf),
    /// No program yet: the window offers new ones, those that were opened last, and the examples.
    Welcome,
    /// An editor's language server, over standard input and output.
    Attached,
}

/// The reason why there is no window.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// There is no display, or it refuses a window.
    NoDisplay {
        /// In the system's words.
        reason: String,
    },
    /// Nothing can draw the window: no graphics driver was found.
    NoGraphics {
        /// In the system's words.
        reason: String,
    },
    /// The system starts no thread for the window's work.
    NoThread {
        /// In the system's words.
        reason: String,
    },
    /// The file cannot be read.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// In the system's words.
        reason: String,
    },
}

impl Failure {
    /// With what else the user must know, behind the reason.
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

/// Of a thread that the system refuses.
impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::NoThread {
            reason: error.to_string(),
        }
    }
}
