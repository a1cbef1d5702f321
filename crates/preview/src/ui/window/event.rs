//! The events of the window: one variant for each part that sends events, and their channel.

use std::sync::mpsc::Receiver;

use session::StatusMessage;
use session::questions::MeasureAnswer;
use session::textures::TextureRead;

use crate::channel::EventSender;
use crate::engine::compiler::CompilerEvent;
use crate::engine::render_thread::RenderEvent;
use crate::io::file_dialogs::FileChoice;
use crate::io::link::LinkEvent;
use crate::io::watch::ChangedFile;

/// An event that a thread sends to the window.
#[derive(Debug)]
pub(crate) enum WindowEvent {
    /// A text has been compiled, or a scene made anew.
    Compiler(CompilerEvent),
    /// The render thread has finished something.
    Render(Box<RenderEvent>),
    /// A question has been answered.
    Measured(Box<MeasureAnswer>),
    /// The file on disk has changed, or cannot be read.
    File(ChangedFile),
    /// The server has sent something, or is gone.
    Link(LinkEvent),
    /// An image has been read.
    Texture(TextureRead),
    /// The user has chosen files in a dialog of the desktop.
    FileChoice(FileChoice),
    /// A sentence for the status line.
    Status(StatusMessage),
}

/// The channel of a window's events.
pub(crate) struct WindowEvents {
    pub(super) sender: EventSender<WindowEvent>,
    pub(super) receiver: Receiver<WindowEvent>,
}

impl WindowEvents {
    /// Returns the channel of a window.
    pub(super) fn new(context: egui::Context) -> Self {
        let (sender, receiver) = EventSender::new(context);
        Self { sender, receiver }
    }

    /// Returns a sender of sentences for the status line.
    pub(crate) fn status(&self) -> EventSender<StatusMessage> {
        self.sender.for_part(WindowEvent::Status)
    }

    /// Returns a sender of answers.
    pub(crate) fn measured(&self) -> EventSender<MeasureAnswer> {
        self.sender
            .for_part(|answer| WindowEvent::Measured(Box::new(answer)))
    }

    /// Returns a sender of the user's choices in the desktop's dialogs.
    pub(crate) fn file_choices(&self) -> EventSender<FileChoice> {
        self.sender.for_part(WindowEvent::FileChoice)
    }
}
