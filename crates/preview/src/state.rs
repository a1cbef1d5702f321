//! The state of the window as plain data: no window, no thread, no picture.
//!
//! ```text
//! compiled program ──take()──▶ Model ◀──change()── what the user does, each step under its name
//! (program.rs)                   │ (model.rs)           └─ history.rs, difference.rs: undo, redo
//!                                ├─ view.rs: what is remembered by name, and between runs
//!                                ├─ faults.rs: what is wrong with the text, and when that is shown
//!                                ├─ camera.rs, inside_camera.rs: the cameras in space and of the geodesic views
//!                                ├─ motion.rs, path.rs: the motions and the paths of the geodesic ones
//!                                ├─ measuring.rs: what is measured on a surface
//!                                └─ pane.rs, layout.rs: the panes and their places
//! ```

pub(crate) mod camera;
pub(crate) mod camera_controller;
pub(crate) mod difference;
pub(crate) mod faults;
pub(crate) mod history;
pub(crate) mod inside_camera;
pub(crate) mod layout;
pub(crate) mod measuring;
pub(crate) mod model;
pub(crate) mod motion;
pub(crate) mod pane;
pub(crate) mod path;
pub(crate) mod program;
pub(crate) mod view;

pub use camera::SpaceCamera;
pub use faults::ProgramFaults;
pub use history::{History, Step};
pub use inside_camera::{ChartCamera, InsideCamera, SolidCamera};
pub use model::Model;
pub use path::CameraPath;
pub(crate) use program::Compiled;
pub use program::Finding;
pub use view::{
    Animation, Choice, Look, MOST_SAMPLES, Marks, Opening, Preferences, SCALES, Theme, View,
    WAVEFRONTS,
};

/// A sentence for the status line.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) struct StatusMessage {
    pub(crate) is_error: bool,
    pub(crate) text: String,
}

impl StatusMessage {
    /// A sentence about something that failed.
    pub(crate) fn error(text: impl Into<String>) -> Self {
        Self {
            is_error: true,
            text: text.into(),
        }
    }

    /// A sentence about something that was done.
    pub(crate) fn info(text: impl Into<String>) -> Self {
        Self {
            is_error: false,
            text: text.into(),
        }
    }
}
