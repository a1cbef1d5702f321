//! The connection to the editor. In: the server's commands, over standard input. Out: events, over standard output.
//!
//! Reading and writing each have a thread, so that the window waits for neither. Of the values and of the shown texts that
//! wait for a reader, only the latest is kept; what the user requests is kept, one event for each request.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use protocol::changes::Changes;
use protocol::follower::{Follower, Gap};
use protocol::line::{self, ReadError};
use protocol::{Command, Event, Hello, handshake};

use crate::channel::{EventSender, start_thread};
use crate::queue::LatestQueue;

/// An event of the conversation.
#[derive(Debug)]
pub(crate) enum LinkEvent {
    /// The server has sent a command.
    Command(Command),
    /// A view of the text of a version is to be shown.
    Show {
        /// The view; the first view of the scene if none is named.
        view: Option<protocol::ViewName>,
        /// The version of the last text before it, if there was one.
        version: Option<i32>,
    },
    /// The server sends nothing more.
    Disconnected(DisconnectReason),
}

/// The reason why the conversation with a server has ended.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum DisconnectReason {
    /// The server is gone; the system's message, unless its commands simply ended.
    Gone(Option<String>),
    /// The server does not speak the window's version of the messages; a sentence.
    Refused(String),
}

/// The conversation with a server.
#[derive(Debug)]
pub(crate) struct Link {
    outbox: Outbox,
}

/// The events that the server has not read yet.
#[derive(Clone, Debug, Default)]
struct Outbox {
    queue: LatestQueue<EventKind, Event>,
    sent: Arc<std::sync::atomic::AtomicU64>,
}

/// The kind of an event: for some kinds only the latest is kept.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum EventKind {
    Values,
    Shown,
    Each(u64),
}

/// Sends the greeting. The thread that reads notices if the server has ended.
pub(crate) fn greet(output: &mut impl Write) {
    let _ = line::write(output, &Event::Hello(Hello::own()));
}

impl Link {
    /// Starts the conversation, after [`greet`]. Texts are passed to `compile`, with the path or the URI of their
    /// document and the changes of the text before it, without waiting for the window.
    ///
    /// # Errors
    /// The system's error if it cannot start a thread.
    pub(crate) fn start(
        events: EventSender<LinkEvent>,
        compile: impl Fn(&Path, i32, Arc<str>, Option<Changes>) + Send + 'static,
        input: impl Read + Send + 'static,
        output: impl Write + Send + 'static,
    ) -> io::Result<Self> {
        let outbox = Outbox::default();
        let own = outbox.clone();
        start_thread("link output", move || write(&own.queue, output))?;
        let own = outbox.clone();
        start_thread("link input", move || read(&events, compile, input, &own))?;
        Ok(Self { outbox })
    }

    /// Sends an event to the server, without waiting.
    pub(crate) fn send(&self, event: Event) {
        self.outbox.send(event);
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.outbox.queue.close();
    }
}

impl Outbox {
    fn send(&self, event: Event) {
        let kind = match &event {
            Event::Values { .. } => EventKind::Values,
            Event::Shown { .. } => EventKind::Shown,
            _ => EventKind::Each(self.sent.fetch_add(1, std::sync::atomic::Ordering::Relaxed)),
        };
        // The later event is about later texts and pictures: it follows the events that were sent meanwhile.
        self.queue.remove(&kind);
        self.queue.push(0, kind, event);
    }
}

fn write(queue: &LatestQueue<EventKind, Event>, mut output: impl Write) {
    while let Some((_, event)) = queue.take() {
        // The thread that reads also notices if the reader has ended.
        if line::write(&mut output, &event).is_err() {
            return;
        }
    }
}

/// The text of the server's document, as the window follows it.
#[derive(Default)]
struct FollowedText {
    /// The URI of the document, and its path if it has one.
    document: Option<(String, Option<String>)>,
    /// The path, or the URI of a text without a file, which ends with its extension.
    place: PathBuf,
    follower: Follower,
    /// The version of the text.
    version: Option<i32>,
    text: Arc<str>,
}

impl FollowedText {
    /// Takes a whole text. Returns true if it is of another document than the one before.
    fn replace(
        &mut self,
        document: (String, Option<String>),
        version: i32,
        text: Arc<str>,
    ) -> bool {
        self.follower.text(version);
        self.text = text;
        self.version = Some(version);
        let is_other = self.document.as_ref() != Some(&document);
        if is_other {
            self.place = PathBuf::from(document.1.as_ref().unwrap_or(&document.0));
            self.document = Some(document);
        }
        is_other
    }

    /// Applies an edit, unless the text that it applies to is missing. Returns true if it has been applied.
    fn edit(&mut self, version: i32, base: i32, changes: &Changes, outbox: &Outbox) -> bool {
        let edited = match self.follower.edit(version, base) {
            Ok(()) => changes.apply(&self.text),
            Err(Gap { ask: false }) => return false,
            Err(Gap { ask: true }) => None,
        };
        let Some(edited) = edited else {
            self.follower.wait();
            outbox.send(Event::TextWanted);
            return false;
        };
        self.text = edited.into();
        self.version = Some(version);
        true
    }
}

/// Reads the next command. A line that is not a message is skipped.
fn next_command(
    reader: &mut line::Reader<impl BufRead, Command>,
) -> Result<Command, DisconnectReason> {
    loop {
        match reader.read() {
            Ok(Some(command)) => return Ok(command),
            Ok(None) => return Err(DisconnectReason::Gone(None)),
            Err(ReadError::Stream(error)) => {
                return Err(DisconnectReason::Gone(Some(error.to_string())));
            }
            Err(_) => {}
        }
    }
}

/// Reads the greeting, and reports one that does not fit.
fn read_greeting(
    reader: &mut line::Reader<impl BufRead, Command>,
    outbox: &Outbox,
) -> Result<(), DisconnectReason> {
    handshake::check(&next_command(reader)?).map_err(|error| {
        let text = error.to_string();
        outbox.send(Event::Message {
            error: true,
            text: text.clone(),
        });
        DisconnectReason::Refused(text)
    })
}

/// Passes commands on until the server sends nothing more. Texts are compiled without waiting for the window, which
/// only receives the command of another document.
fn read(
    events: &EventSender<LinkEvent>,
    compile: impl Fn(&Path, i32, Arc<str>, Option<Changes>),
    input: impl Read,
    outbox: &Outbox,
) {
    let mut reader = line::Reader::<_, Command>::new(BufReader::new(input));
    let mut followed = FollowedText::default();
    let mut next = read_greeting(&mut reader, outbox).and_then(|()| next_command(&mut reader));
    while let Ok(command) = next {
        let is_received = match &command {
            Command::Text {
                uri,
                path,
                version,
                text,
            } => {
                let (version, text) = (*version, Arc::clone(text));
                let document = (uri.clone(), path.clone());
                let is_other = followed.replace(document, version, Arc::clone(&text));
                let is_received = !is_other || events.send(LinkEvent::Command(command));
                if is_received {
                    compile(&followed.place, version, text, None);
                }
                is_received
            }
            Command::Edit {
                version,
                base,
                changes,
            } => {
                if followed.edit(*version, *base, changes, outbox) {
                    let text = Arc::clone(&followed.text);
                    compile(&followed.place, *version, text, Some(changes.clone()));
                }
                true
            }
            Command::Show { view } => events.send(LinkEvent::Show {
                view: view.clone(),
                version: followed.version,
            }),
            _ => events.send(LinkEvent::Command(command)),
        };
        if !is_received {
            return;
        }
        next = next_command(&mut reader);
    }
    if let Err(reason) = next {
        events.send(LinkEvent::Disconnected(reason));
    }
}
