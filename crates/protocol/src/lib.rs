//! Messages between the language server and a preview window: one JSON object per line, over the window's standard
//! streams.
//!
//! ```text
//! server ──[Command] lines──▶ standard input of the window
//! server ◀──[Event] lines──── standard output of the window
//! ```
//!
//! Each side sends [`Hello`] first. A side that does not understand the other's version tells the user so in a sentence
//! and ends the conversation ([`handshake`]). Positions in a text are byte offsets into its UTF-8, in the version that
//! the message names. Lines are read and written by [`line`](mod@line); commands wait in a [`mailbox`], in which the
//! latest text wins. A line that is not a message is skipped, since a driver may print anything.
//!
//! The whole text is sent once. Edits follow, each with the version to which it applies. Waiting edits are composed
//! into one ([`changes`]); if the whole text is shorter, it is sent instead. A window that does not have the version to
//! which an edit applies requests the text by [`Event::TextWanted`] ([`follower`]).
//!
//! [`Command::Close`] closes the window: its document has been closed, or the editor has quit. If the commands end
//! without it, the server is gone: the window keeps its picture and says so.

pub mod changes;
pub mod follower;
pub mod handshake;
pub mod line;
pub mod mailbox;

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::changes::Changes;

/// The version of the messages. It is raised whenever a message changes its meaning.
pub const VERSION: u32 = 3;

/// The first message of each side.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Hello {
    /// The version of the messages: [`VERSION`].
    pub protocol: u32,
    /// The program's own version, for messages to the user.
    pub program: String,
}

/// A message from the server to a window.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "camelCase")]
#[non_exhaustive]
pub enum Command {
    /// The first message.
    Hello(Hello),
    /// The document's current text. It replaces all earlier ones that have not been read yet.
    Text {
        /// The document's identifier in the editor.
        uri: String,
        /// Its path on disk, if it has one: the window keeps its settings beside it.
        path: Option<String>,
        /// A number for this text, greater than those of all earlier texts: the editor's version, unless the editor
        /// restarts its count when it reopens the document.
        version: i32,
        /// The whole text.
        text: Arc<str>,
    },
    /// An edit of the document's text. It is composed with the edit before it if that has not been read yet.
    Edit {
        /// The version of the text after the edit; greater than those of all earlier texts.
        version: i32,
        /// The version of the text before the edit. A window that does not have it requests the text.
        base: i32,
        /// The changes, in offsets into the text before the edit.
        changes: Changes,
    },
    /// A view is to be shown: opened if it is not open, and brought to the front.
    Show {
        /// The view; the scene's first view if absent.
        view: Option<ViewName>,
    },
    /// The cursor is at an offset in this version of the text; the object declared there is highlighted.
    Cursor {
        /// The text's version.
        version: i32,
        /// The byte offset.
        offset: u32,
    },
    /// The window is to close.
    Close,
}

/// The name of a view of a scene. The window defines which views exist.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct ViewName {
    /// The name of the view: `3d`, `geodesic`.
    pub view: String,
    /// The name of the object that the view shows; `None` for a view of the whole scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<String>,
}

impl ViewName {
    /// Returns the name of a view of the whole scene.
    #[must_use]
    pub fn of_scene(view: impl Into<String>) -> Self {
        Self {
            view: view.into(),
            surface: None,
        }
    }

    /// Returns the name of a view of one object.
    #[must_use]
    pub fn of_object(view: impl Into<String>, object: impl Into<String>) -> Self {
        Self {
            view: view.into(),
            surface: Some(object.into()),
        }
    }
}

/// The view that is shown unless another is named.
impl Default for ViewName {
    fn default() -> Self {
        Self::of_scene("3d")
    }
}

/// A message from a window to the server.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "camelCase")]
#[non_exhaustive]
pub enum Event {
    /// The first message. It is sent at once, before the window looks for a display or a device: the server waits ten
    /// seconds.
    Hello(Hello),
    /// The pictures of a text are on the screen, or the text has errors and the last good pictures stay.
    Shown {
        /// The text's version.
        version: i32,
        /// True if it has no errors.
        ok: bool,
        /// From reading the text to the layout of the frame that shows it, in milliseconds.
        milliseconds: f64,
        /// The time that laying out the previous frame and submitting it to the driver took, in milliseconds. When the
        /// event is sent, this frame still has that work before it.
        painting: f64,
    },
    /// A declaration is to be shown in the editor.
    Open {
        /// The version of the text to which the range refers, which need not be the latest.
        version: i32,
        /// The start and the end of its name.
        range: [u32; 2],
    },
    /// The user wants a param's value in the text, as one undoable step.
    Write {
        /// The text's version.
        version: i32,
        /// The param's name.
        param: String,
        /// One finite value per component.
        value: Vec<f64>,
    },
    /// The user wants the view in the text as a camera, as one undoable step.
    WriteCamera {
        /// The text's version.
        version: i32,
        /// The name of the camera; if it is not declared, it is a new one.
        name: String,
        /// The direction in which it looks; finite, and not zero.
        direction: [f64; 3],
        /// Its position; finite.
        position: [f64; 3],
        /// The vertical field of view of a new camera, in radians.
        fov: f64,
    },
    /// The user wants another colour of an object in the text, as one undoable step.
    #[serde(rename = "writeColor")]
    WriteColour {
        /// The text's version.
        version: i32,
        /// The object's name.
        object: String,
        /// Red, green and blue, sRGB, in 0…1.
        #[serde(rename = "color")]
        colour: [f64; 3],
    },
    /// The params' current values, by name.
    Values {
        /// The text's version.
        version: i32,
        /// One finite value per component; a param that is absent has no value to show.
        values: BTreeMap<String, Vec<f64>>,
    },
    /// A sentence for the user.
    Message {
        /// True if it reports an error.
        error: bool,
        /// The sentence.
        text: String,
    },
    /// The window lacks the text to which an edit applies: the server sends the whole text. A window whose compiler has
    /// failed still has its text, and opens it again.
    TextWanted,
    /// The user is closing the window.
    Closed,
}
