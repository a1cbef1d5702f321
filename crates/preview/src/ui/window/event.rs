//! The events of the window: one variant for each part that sends events.

use crate::engine::render_thread::RenderEvent;
use crate::engine::textures::TextureRead;
use crate::io::file_dialogs::FileChoice;
use crate::io::link::LinkEvent;
use crate::io::watch::Unreadable;
use crate::state::{Compiled, StatusMessage};

/// An event that a thread sends to the window.
#[derive(Debug)]
pub(crate) enum WindowEvent {
    /// A text has been compiled.
    Compiled(Compiled),
    /// The render thread has finished something.
    Render(Box<RenderEvent>),
    /// The file on disk holds another text now, or cannot be read.
    File(Result<String, Unreadable>),
    /// The server has sent something, or is gone.
    Link(LinkEvent),
    /// An image has been read.
    Texture(TextureRead),
    /// The user has chosen files in a dialog of the desktop.
    FileChoice(FileChoice),
    /// A sentence for the status line.
    Status(StatusMessage),
}
