//! Messages between the language server and a preview window: one JSON object a line, over the window's own pipes.
//!
//! ```text
//! server ──[Command] lines──▶ standard input of the window
//! server ◀──[Event] lines──── standard output of the window
//! ```
//!
//! Each side says [`Hello`] first. A side that does not understand the other's version says so in a sentence for the
//! user and ends the conversation ([`handshake`]). Places in a text are byte offsets into its UTF-8, of the version that
//! is named. Lines are read and written by [`line`](mod@line); commands wait in a [`mailbox`], where the latest text wins.
//! A line that is no message is passed by: a driver may print what it likes.
//!
//! The text comes whole once; then come edits, each with the version that it applies to. Edits that wait are composed into
//! one ([`changes`]), or the whole text is sent, where that is shorter. A window that does not have the version that an
//! edit applies to asks for the text by [`Event::TextWanted`] ([`follower`]).
//!
//! The window closes by [`Command::Close`]: its document has been closed, or the editor has gone. If the commands just end,
//! the server is gone, and the window keeps its picture and says so.

pub mod changes;
pub mod follower;
pub mod handshake;
pub mod line;
pub mod mailbox;

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::changes::Changes;

/// The version of the messages. Raised whenever a message changes its meaning.
pub const VERSION: u32 = 2;

/// The first message of each side.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Hello {
    /// The version of the messages: [`VERSION`].
    pub protocol: u32,
    /// The program's own version, for sentences.
    pub program: String,
}

/// A message from the server to a window.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "camelCase")]
#[non_exhaustive]
pub enum Command {
    /// The first message.
    Hello(Hello),
    /// The document's text now. A later one takes the place of all earlier ones that have not been read yet.
    Text {
        /// The document, as the editor names it.
        uri: String,
        /// Its place on disk, if it has one: the window keeps its memory beside it.
        path: Option<String>,
        /// A number for this text, greater than those of all texts before: the editor's, unless that counts anew when it
        /// reads the document anew.
        version: i32,
        /// All of it.
        text: Arc<str>,
    },
    /// An edit of the document's text. One that follows an edit which has not been read yet is composed with it.
    Edit {
        /// The version of the text after the edit; greater than those of all texts before.
        version: i32,
        /// The version of the text before the edit. A window that does not have it asks for the text.
        base: i32,
        /// The changes, in places of the text before the edit.
        changes: Changes,
    },
    /// A view is to be seen: opened if it is not, and brought to the front.
    Show {
        /// The view; the first view of the scene where none is named.
        view: Option<View>,
    },
    /// The cursor is at a place of the text of this version; what is declared there is highlighted.
    Cursor {
        /// The text's version.
        version: i32,
        /// The place.
        offset: u32,
    },
    /// The window is to close.
    Close,
}

/// A view of a scene. Which views there are is the window's business.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct View {
    /// The name of the view: `3d`, `geodesic`.
    pub view: String,
    /// The name of the object that the view is of, where it is of one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<String>,
}

impl View {
    /// A view of the whole scene.
    #[must_use]
    pub fn of_scene(view: impl Into<String>) -> Self {
        Self {
            view: view.into(),
            surface: None,
        }
    }

    /// A view of one object.
    #[must_use]
    pub fn of_object(view: impl Into<String>, object: impl Into<String>) -> Self {
        Self {
            view: view.into(),
            surface: Some(object.into()),
        }
    }
}

/// The view that is shown unless another is named.
impl Default for View {
    fn default() -> Self {
        Self::of_scene("3d")
    }
}

/// A message from a window to the server.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "camelCase")]
#[non_exhaustive]
pub enum Event {
    /// The first message. It is said at once, before a display or a device is looked for: the server waits ten seconds.
    Hello(Hello),
    /// The pictures of a text are on the screen, or it has errors and the last good ones stay.
    Shown {
        /// The text's version.
        version: i32,
        /// Set if it has no errors.
        ok: bool,
        /// From reading the text to the layout of the frame that shows it, in milliseconds.
        milliseconds: f64,
        /// The time that laying out the frame before this one and handing it to the driver took, in milliseconds: what
        /// this one still has before it when the event is sent.
        painting: f64,
    },
    /// A declaration is to be shown in the editor.
    Open {
        /// The text's version: that in which the range is meant, which need not be the last.
        version: i32,
        /// The beginning and the end of its name.
        range: [u32; 2],
    },
    /// The user wants a param's value in the text, as one step that can be undone.
    Write {
        /// The text's version.
        version: i32,
        /// The param's name.
        param: String,
        /// One finite value per component.
        value: Vec<f64>,
    },
    /// The user wants the view in the text as a camera, as one step that can be undone.
    WriteCamera {
        /// The text's version.
        version: i32,
        /// The name of the camera; a new one, if it is not declared.
        name: String,
        /// The direction in which it looks; finite, and not zero.
        direction: [f64; 3],
        /// Its place; finite.
        position: [f64; 3],
    },
    /// The user wants another colour of an object in the text, as one step that can be undone.
    WriteColor {
        /// The text's version.
        version: i32,
        /// The object's name.
        object: String,
        /// Red, green and blue, sRGB, 0…1.
        color: [f64; 3],
    },
    /// The params' values now, by name.
    Values {
        /// The text's version.
        version: i32,
        /// One finite value per component; a param that is left out has no value to show.
        values: BTreeMap<String, Vec<f64>>,
    },
    /// A sentence for the user.
    Message {
        /// Set if it is about an error.
        error: bool,
        /// The sentence.
        text: String,
    },
    /// The window lacks the text that an edit applies to: the server sends the whole text. A window whose compiler has
    /// failed still has its text, and opens it anew.
    TextWanted,
    /// The window is closing, by the user's hand.
    Closed,
}
