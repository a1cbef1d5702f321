//! The server without threads: in a Worker of a browser, which passes each message to it and gives it turns.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::{Arc, Mutex};

use futures::channel::mpsc;
use futures::{future, sink};
use ide::Languages;

use crate::frames::{self, Frame};
use crate::session::Session;
use crate::tasks;

/// A server for one editor, whose messages are JSON texts without a header.
#[derive(Debug)]
pub struct ServerByTurns {
    incoming: mpsc::UnboundedSender<Frame>,
    outgoing: Rc<RefCell<Vec<String>>>,
}

impl ServerByTurns {
    /// Returns a server for documents in these languages. It has no windows.
    pub fn new(languages: Languages) -> Self {
        let (incoming, frames) = mpsc::unbounded();
        let outgoing = Rc::<RefCell<Vec<String>>>::default();
        let output = sink::unfold(outgoing.clone(), |outgoing, body: Vec<u8>| {
            let text = String::from_utf8_lossy(&body).into_owned();
            outgoing.borrow_mut().push(text);
            future::ready(Ok::<_, std::convert::Infallible>(outgoing))
        });
        let session = Arc::new(Mutex::new(Session::new(languages, None)));
        tasks::spawn(crate::start(frames, output, Arc::default(), session));
        Self { incoming, outgoing }
    }

    /// Takes a message of the editor.
    pub fn receive(&self, message: &str) {
        let frame = frames::message(message.as_bytes()).unwrap_or(Frame::Invalid);
        let _ = self.incoming.unbounded_send(frame);
        tasks::run();
    }

    /// Does the work that has waited longest. Returns false if none waits.
    pub fn turn(&self) -> bool {
        tasks::turn()
    }

    /// The messages to the editor since the last time.
    pub fn take_outgoing(&self) -> Vec<String> {
        std::mem::take(&mut self.outgoing.borrow_mut())
    }
}
