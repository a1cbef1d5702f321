//! The connection to the editor. In: the server's commands, over standard input. Out: events, over standard output.
//!
//! Reading and writing each have a thread, so that the window waits for neither. Of the values and of the shown texts that
//! wait for a reader, only the latest is kept; what the user requests is kept, one event for each request.

use std::io::{self, BufReader, Read, Write};
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
        view: Option<protocol::View>,
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
    pub(crate) fn say(&self, event: Event) {
        self.outbox.say(event);
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.outbox.queue.close();
    }
}

impl Outbox {
    fn say(&self, event: Event) {
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

fn read(
    events: &EventSender<LinkEvent>,
    compile: impl Fn(&Path, i32, Arc<str>, Option<Changes>),
    input: impl Read,
    outbox: &Outbox,
) {
    let mut reader = line::Reader::<_, Command>::new(BufReader::new(input));
    let mut greeted = false;
    let mut document = None;
    let mut place = PathBuf::new();
    let mut follower = Follower::default();
    let mut last: Option<i32> = None;
    let mut text_now: Arc<str> = Arc::default();
    loop {
        let command = match reader.read() {
            Ok(Some(command)) => command,
            Ok(None) => {
                events.send(LinkEvent::Disconnected(DisconnectReason::Gone(None)));
                return;
            }
            Err(ReadError::Stream(error)) => {
                events.send(LinkEvent::Disconnected(DisconnectReason::Gone(Some(
                    error.to_string(),
                ))));
                return;
            }
            // A line that is not a message is skipped.
            Err(_) => continue,
        };
        if !greeted {
            if let Err(error) = handshake::check(&command) {
                let text = error.to_string();
                let error = true;
                outbox.say(Event::Message {
                    error,
                    text: text.clone(),
                });
                events.send(LinkEvent::Disconnected(DisconnectReason::Refused(text)));
                return;
            }
            greeted = true;
            continue;
        }
        if let Command::Text {
            uri,
            path,
            version,
            text,
        } = &command
        {
            // Compiled without waiting for the window, which is only told of a change of document.
            let (version, text) = (*version, text.clone());
            // The name of a text without a file ends with its extension.
            place = PathBuf::from(path.as_ref().unwrap_or(uri));
            let same = document.as_ref() == Some(&(uri.clone(), path.clone()));
            if !same {
                document = Some((uri.clone(), path.clone()));
                if !events.send(LinkEvent::Command(command)) {
                    return;
                }
            }
            follower.text(version);
            text_now = Arc::clone(&text);
            compile(&place, version, text, None);
            last = Some(version);
            continue;
        }
        if let Command::Edit {
            version,
            base,
            changes,
        } = &command
        {
            let edited = match follower.edit(*version, *base) {
                Ok(()) => changes.apply(&text_now),
                Err(Gap { ask: false }) => continue,
                Err(Gap { ask: true }) => None,
            };
            match edited {
                Some(edited) => {
                    text_now = edited.into();
                    let text = Arc::clone(&text_now);
                    compile(&place, *version, text, Some(changes.clone()));
                    last = Some(*version);
                }
                None => {
                    follower.wait();
                    outbox.say(Event::TextWanted);
                }
            }
            continue;
        }
        let event = match command {
            Command::Show { view } => LinkEvent::Show {
                view,
                version: last,
            },
            command => LinkEvent::Command(command),
        };
        if !events.send(event) {
            return;
        }
    }
}
