//! The editor's side: the server's commands flow in over standard input, events flow out over standard output.
//!
//! Reading and writing have a thread each, so that the window waits for neither. What is not told for a reader that
//! does not read is bounded: of values and of texts that were shown only the latest is kept.

use std::collections::VecDeque;
use std::io::{BufReader, Read, Write};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

use protocol::line::{self, ReadError};
use protocol::{Command, Event, Hello, handshake};

use crate::compiler::Compiler;
use crate::mail::{Letter, Mail};

/// How the conversation with a server has ended.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum Parting {
    /// It is gone; in the system's words, unless its commands just end.
    Gone(Option<String>),
    /// It does not speak the window's version of the messages; a sentence.
    Refused(String),
}

/// The conversation with a server.
#[derive(Debug)]
pub(crate) struct Link {
    outbox: Arc<(Mutex<Outbox>, Condvar)>,
}

#[derive(Debug, Default)]
struct Outbox {
    waiting: VecDeque<Event>,
    closed: bool,
}

/// Says hello. A server that does not listen any more is noticed by who reads.
pub(crate) fn greet(output: &mut impl Write) {
    let _ = line::write(output, &Event::Hello(Hello::own()));
}

impl Link {
    /// Starts the conversation, behind [`greet`]: listens, and says what it is given.
    pub(crate) fn start(
        mail: Mail,
        compiler: Compiler,
        input: impl Read + Send + 'static,
        output: impl Write + Send + 'static,
    ) -> Self {
        let link = Self {
            outbox: Arc::new((Mutex::new(Outbox::default()), Condvar::new())),
        };
        let outbox = Arc::clone(&link.outbox);
        std::thread::spawn(move || write(&outbox, output));
        let outbox = Arc::clone(&link.outbox);
        std::thread::spawn(move || read(&mail, &compiler, input, &outbox));
        link
    }

    /// Tells the server something, without waiting.
    pub(crate) fn say(&self, event: Event) {
        say(&self.outbox, event);
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        let (outbox, bell) = &*self.outbox;
        outbox.lock().unwrap_or_else(PoisonError::into_inner).closed = true;
        bell.notify_one();
    }
}

fn say(outbox: &(Mutex<Outbox>, Condvar), event: Event) {
    let (outbox, bell) = outbox;
    let mut outbox = outbox.lock().unwrap_or_else(PoisonError::into_inner);
    match event {
        Event::Values { .. } => outbox
            .waiting
            .retain(|it| !matches!(it, Event::Values { .. })),
        Event::Shown { .. } => outbox
            .waiting
            .retain(|it| !matches!(it, Event::Shown { .. })),
        _ => {}
    }
    outbox.waiting.push_back(event);
    bell.notify_one();
}

fn write(outbox: &(Mutex<Outbox>, Condvar), mut output: impl Write) {
    let (outbox, bell) = outbox;
    loop {
        let event = {
            let mut outbox = outbox.lock().unwrap_or_else(PoisonError::into_inner);
            loop {
                if let Some(event) = outbox.waiting.pop_front() {
                    break event;
                }
                if outbox.closed {
                    return;
                }
                outbox = bell.wait(outbox).unwrap_or_else(PoisonError::into_inner);
            }
        };
        // Who read it has ended; the thread that reads will see it too.
        if line::write(&mut output, &event).is_err() {
            return;
        }
    }
}

fn read(mail: &Mail, compiler: &Compiler, input: impl Read, outbox: &(Mutex<Outbox>, Condvar)) {
    let mut reader = line::Reader::<_, Command>::new(BufReader::new(input));
    let mut greeted = false;
    let mut document = None;
    let mut last = None;
    loop {
        let command = match reader.read() {
            Ok(Some(command)) => command,
            Ok(None) => {
                mail.send(Letter::Parted(Parting::Gone(None)));
                return;
            }
            Err(ReadError::Stream(error)) => {
                mail.send(Letter::Parted(Parting::Gone(Some(error.to_string()))));
                return;
            }
            // What is no message is passed by.
            Err(_) => continue,
        };
        if !greeted {
            if let Err(error) = handshake::check(&command) {
                let text = error.to_string();
                let error = true;
                say(
                    outbox,
                    Event::Message {
                        error,
                        text: text.clone(),
                    },
                );
                mail.send(Letter::Parted(Parting::Refused(text)));
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
            // Compiled without waiting for the window, which is told only of a document that is another one.
            let (version, text) = (*version, text.clone());
            let same = document.as_ref() == Some(&(uri.clone(), path.clone()));
            if !same {
                document = Some((uri.clone(), path.clone()));
                if !mail.send(Letter::Server(command)) {
                    return;
                }
            }
            compiler.compile(version, text);
            last = Some(version);
            continue;
        }
        let letter = match command {
            Command::Show { view } => Letter::Show {
                view,
                version: last,
            },
            command => Letter::Server(command),
        };
        if !mail.send(letter) {
            return;
        }
    }
}
