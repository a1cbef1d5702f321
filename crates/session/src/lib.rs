//! A session: the open program, the user's choices, the cameras, and the undo history.
//!
//! It is plain data with the functions that change it: no window, no thread, no file, no clock. A window and a page add
//! their own: they pass in texts, bytes of images, distances of the pointer and seconds, and draw the resulting
//! requests.
//!
//! ```text
//! text ──reader──▶ Compiled ──take()──▶ Model ◀──change()── the user's actions, each a named step
//! (editor, typing)                        │ (model)           ├─ history, difference: undo, redo
//!                                         │                   ├─ camera_input: keys, drags, wheel ──▶ motions
//!                                         │                   └─ clicks: hits ──▶ cameras, declarations
//!                                         ├─ choices: those that are kept by name, and between runs
//!                                         ├─ faults, attention: the faults of the text, and when they are shown
//!                                         ├─ camera, inside_camera: the cameras in space and of the geodesic views
//!                                         ├─ motion, path, camera_controller: the motions of the latter
//!                                         ├─ measuring, questions, figures: measurements on a surface
//!                                         ├─ constant: numbers typed into fields
//!                                         └─ pane, layout: the panes and their arrangement
//!                                         │
//! images ──textures──▶ request ◀──────────┘
//!                         │
//!                         ▼
//!                   PictureRequest ──▶ render::Renderer
//!                    ├─ framing: the default camera in space
//!                    ├─ refinement: coarse while it moves, fine at rest
//!                    └─ snapping: the point that is measured at a pixel
//! ```

pub mod attention;
pub mod camera;
pub mod camera_controller;
pub mod camera_input;
pub mod choices;
pub mod clicks;
pub mod constant;
mod difference;
pub mod editor;
pub mod faults;
pub mod figures;
pub mod framing;
pub mod history;
pub mod inside_camera;
pub mod layout;
pub mod measuring;
pub mod model;
pub mod motion;
pub mod pane;
pub mod path;
pub mod program;
pub mod questions;
pub mod reader;
pub mod refinement;
pub mod request;
pub mod snapping;
pub mod stated_colour;
pub mod textures;
pub mod typing;

pub use camera::SpaceCamera;
pub use choices::{
    Animation, Choices, DeclaredValue, Look, MOST_SAMPLES, Marks, Preferences, SCALES,
    TextureChoice, Theme, WAVEFRONTS,
};
pub use faults::ProgramFaults;
pub use history::{History, Step};
pub use inside_camera::{ChartCamera, InsideCamera, SolidCamera};
pub use model::Model;
pub use path::CameraPath;
pub use program::{Compiled, Finding, ReadProgram};

/// The kind of a sentence of the status line, which determines how long it is shown.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum MessageKind {
    /// Something failed: shown until the next sentence.
    Failed,
    /// Something was done: shown for a while.
    Done,
    /// The point of a click and the object there: shown until the user moves a view or a param.
    Clicked,
}

/// A sentence for the status line.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct StatusMessage {
    /// Its kind.
    pub kind: MessageKind,
    /// The sentence.
    pub text: String,
}

impl StatusMessage {
    /// Returns a sentence about a failure.
    pub fn error(text: impl Into<String>) -> Self {
        Self {
            kind: MessageKind::Failed,
            text: text.into(),
        }
    }

    /// Returns a sentence about a completed action.
    pub fn info(text: impl Into<String>) -> Self {
        Self {
            kind: MessageKind::Done,
            text: text.into(),
        }
    }

    /// Returns a sentence about the object that was clicked.
    pub fn clicked(text: impl Into<String>) -> Self {
        Self {
            kind: MessageKind::Clicked,
            text: text.into(),
        }
    }
}
