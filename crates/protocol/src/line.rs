//! Messages on a stream: one JSON object per line, in UTF-8, ended by a line feed.
//!
//! Any bytes may be read: a line that is not a message, one that is too long, or one that the end of the stream has cut
//! off. Each is an error of its own, and reading continues at the next line.

use std::fmt;
use std::io::{self, BufRead, Write};
use std::marker::PhantomData;

use serde::Serialize;
use serde::de::DeserializeOwned;

/// The maximum length of a line that is written or read, in bytes, without its line feed. A text of this length is far
/// beyond what can be drawn.
pub const LONGEST: usize = 64 << 20;

/// The maximum number of characters of an invalid line that an error quotes.
const EXCERPT: usize = 80;

/// Reads messages of one kind from a stream.
#[derive(Debug)]
pub struct Reader<R, T> {
    stream: R,
    line: Vec<u8>,
    kind: PhantomData<fn() -> T>,
}

/// The reason why a line is not a message.
#[derive(Debug)]
pub enum ReadError {
    /// The stream cannot be read.
    Stream(io::Error),
    /// The line has more than [`LONGEST`] bytes; it has been skipped without being stored.
    TooLong,
    /// The stream ended within the line.
    Cut {
        /// The beginning of the line.
        excerpt: String,
    },
    /// The line is not a message of this kind.
    Invalid {
        /// The beginning of the line.
        excerpt: String,
        /// The fault, as the JSON reader reports it.
        reason: String,
    },
}

/// The reason why a message is not written.
#[derive(Debug)]
pub enum WriteError {
    /// The stream cannot be written: its reader has ended.
    Stream(io::Error),
    /// The message's line would have more than [`LONGEST`] bytes; nothing has been written.
    TooLong {
        /// The number of bytes.
        length: usize,
    },
}

impl<R: BufRead, T: DeserializeOwned> Reader<R, T> {
    /// Returns a reader of a stream.
    pub fn new(stream: R) -> Self {
        Self {
            stream,
            line: Vec::new(),
            kind: PhantomData,
        }
    }

    /// Waits for the next message. Returns `None` at the end of the stream. Empty lines are skipped.
    ///
    /// # Errors
    /// See [`ReadError`]. After any error except [`ReadError::Stream`] the next call continues after the line.
    pub fn read(&mut self) -> Result<Option<T>, ReadError> {
        loop {
            let whole = self.next_line()?;
            let line = self.line.trim_ascii();
            if line.is_empty() {
                if whole {
                    continue;
                }
                return Ok(None);
            }
            if !whole {
                return Err(ReadError::Cut {
                    excerpt: excerpt(line),
                });
            }
            return match serde_json::from_slice(line) {
                Ok(message) => Ok(Some(message)),
                Err(error) => Err(ReadError::Invalid {
                    excerpt: excerpt(line),
                    reason: error.to_string(),
                }),
            };
        }
    }

    /// Reads a line into `self.line`; false if the stream ended before the line did.
    fn next_line(&mut self) -> Result<bool, ReadError> {
        // A long text is followed by many short messages: release its memory.
        self.line.clear();
        self.line.shrink_to(1 << 16);
        let mut too_long = false;
        loop {
            let bytes = match self.stream.fill_buf() {
                Ok(bytes) => bytes,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(ReadError::Stream(error)),
            };
            let end = bytes.iter().position(|byte| *byte == b'\n');
            let part = &bytes[..end.unwrap_or(bytes.len())];
            let used = part.len() + usize::from(end.is_some());
            let ended = bytes.is_empty();
            if self.line.len() + part.len() > LONGEST {
                too_long = true;
                self.line = Vec::new();
            }
            if !too_long {
                self.line.extend_from_slice(part);
            }
            self.stream.consume(used);
            if end.is_some() || ended {
                return match too_long {
                    true => Err(ReadError::TooLong),
                    false => Ok(end.is_some()),
                };
            }
        }
    }
}

/// Writes a message and flushes the stream.
///
/// # Errors
/// See [`WriteError`].
pub fn write<T: Serialize>(stream: &mut impl Write, message: &T) -> Result<(), WriteError> {
    // JSON of these types has string keys and no cycles: serialisation into memory cannot fail.
    let mut line = serde_json::to_vec(message).map_err(|e| WriteError::Stream(e.into()))?;
    if line.len() > LONGEST {
        return Err(WriteError::TooLong { length: line.len() });
    }
    line.push(b'\n');
    stream.write_all(&line).map_err(WriteError::Stream)?;
    stream.flush().map_err(WriteError::Stream)
}

fn excerpt(line: &[u8]) -> String {
    // A character has at most four bytes.
    let start = &line[..line.len().min(4 * EXCERPT)];
    let text = String::from_utf8_lossy(start);
    let mut short: String = text.chars().take(EXCERPT).collect();
    if short.len() < line.len() {
        short.push('…');
    }
    short
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stream(error) => write!(f, "cannot read from the other side: {error}"),
            Self::TooLong => write!(f, "a line of more than {LONGEST} bytes was skipped"),
            Self::Cut { excerpt } => write!(f, "the other side stopped within a line: {excerpt}"),
            Self::Invalid { excerpt, reason } => {
                write!(f, "a line is not a message ({reason}): {excerpt}")
            }
        }
    }
}

impl std::error::Error for ReadError {}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stream(error) => write!(f, "cannot write to the other side: {error}"),
            Self::TooLong { length } => {
                write!(
                    f,
                    "a message of {length} bytes is too long: the limit is {LONGEST}"
                )
            }
        }
    }
}

impl std::error::Error for WriteError {}

#[cfg(test)]
mod tests {
    use std::io::{BufReader, Read};

    use super::{LONGEST, ReadError, Reader, WriteError, write};
    use crate::changes::Changes;
    use crate::{Command, Event, Hello, ViewName};

    fn read(bytes: &[u8]) -> Vec<Result<Option<Event>, ReadError>> {
        // A small buffer, so that lines come in pieces.
        let mut reader = Reader::new(BufReader::with_capacity(7, bytes));
        let mut all = Vec::new();
        loop {
            let next = reader.read();
            let ended = matches!(next, Ok(None));
            all.push(next);
            if ended {
                return all;
            }
            assert!(all.len() < 100);
        }
    }

    #[test]
    fn every_message_is_read_as_it_was_written() {
        let commands = [
            Command::Hello(Hello::own()),
            Command::Text {
                uri: "file:///a.gtr".to_owned(),
                path: None,
                version: -3,
                text: "# é 𝛼\r\ndefine a = \"\\\";\n\u{2028}".into(),
            },
            Command::Edit {
                version: -2,
                base: -3,
                changes: Changes::one([2, 4], "\u{2028}"),
            },
            Command::Show { view: None },
            Command::Show {
                view: Some(ViewName::default()),
            },
            Command::Show {
                view: Some(ViewName::of_object("geodesic", "s")),
            },
            Command::Cursor {
                version: 1,
                offset: u32::MAX,
            },
            Command::Close,
        ];
        let mut bytes = Vec::new();
        for command in &commands {
            write(&mut bytes, command).expect("memory takes it");
        }
        assert_eq!(bytes.iter().filter(|b| **b == b'\n').count(), 8);
        let mut reader = Reader::new(BufReader::with_capacity(5, &bytes[..]));
        for command in commands {
            assert_eq!(reader.read().expect("a message"), Some(command));
        }
        assert!(matches!(reader.read(), Ok(None)));

        let events = [
            Event::Shown {
                version: 2,
                ok: false,
                milliseconds: 1.25,
                painting: 0.5,
            },
            Event::Open {
                version: 2,
                range: [3, 4],
            },
            Event::Write {
                version: 2,
                param: "U".to_owned(),
                value: vec![0.1, -1e-300],
            },
            Event::WriteCamera {
                version: 2,
                name: "eye".to_owned(),
                direction: [0.0, 4.0, -1.0],
                position: [0.1, -4.0, 1e-300],
                fov: 0.6,
            },
            Event::WriteColour {
                version: 2,
                object: "ball".to_owned(),
                colour: [0.0, 0.2, 1.0],
            },
            Event::Values {
                version: 2,
                values: [("U".to_owned(), vec![0.1 + 0.2])].into(),
            },
            Event::Message {
                error: true,
                text: "no".to_owned(),
            },
            Event::TextWanted,
            Event::Closed,
        ];
        let mut bytes = Vec::new();
        for event in &events {
            write(&mut bytes, event).expect("memory takes it");
        }
        let all = read(&bytes);
        for (event, received) in events.iter().zip(&all) {
            assert!(
                matches!(received, Ok(Some(received)) if received == event),
                "{received:?}"
            );
        }
        assert_eq!(all.len(), events.len() + 1);
    }

    #[test]
    fn behind_any_line_that_is_no_message_the_next_is_read() {
        for garbage in [
            &b"Vulkan: warning"[..],
            b"{\"type\":\"closed\"",
            b"{\"type\":\"opened\"}",
            b"{\"type\":\"shown\",\"version\":1.5}",
            b"[]",
            b"\xFF\xFE{}",
            b"\0",
        ] {
            let all = read(&[garbage, b"\n\r\n\n", b"{\"type\":\"closed\"}\n"].concat());
            let [
                Err(ReadError::Invalid { .. }),
                Ok(Some(Event::Closed)),
                Ok(None),
            ] = &all[..]
            else {
                panic!("{garbage:?}: {all:?}")
            };
        }
    }

    #[test]
    fn half_a_line_at_the_end_is_no_message_though_it_may_look_like_one() {
        let all = read(b"{\"type\":\"closed\"}\n{\"type\":\"closed\"}");
        let [
            Ok(Some(Event::Closed)),
            Err(ReadError::Cut { excerpt }),
            Ok(None),
        ] = &all[..]
        else {
            panic!("{all:?}")
        };
        assert_eq!(excerpt, "{\"type\":\"closed\"}");
    }

    #[test]
    fn a_line_of_a_hundred_megabytes_is_refused_and_not_kept() {
        let long = std::io::repeat(b'x').take(100_000_000);
        let stream = long.chain(&b"\n{\"type\":\"closed\"}\n"[..]);
        let mut reader: Reader<_, Event> = Reader::new(BufReader::with_capacity(1 << 16, stream));
        assert!(matches!(reader.read(), Err(ReadError::TooLong)));
        assert!(reader.line.capacity() <= 1 << 16);
        assert!(matches!(reader.read(), Ok(Some(Event::Closed))));
        assert!(matches!(reader.read(), Ok(None)));
        // One that never ends as well.
        let long = std::io::repeat(b'x').take(100_000_000);
        let mut reader: Reader<_, Event> = Reader::new(BufReader::with_capacity(1 << 16, long));
        assert!(matches!(reader.read(), Err(ReadError::TooLong)));
        assert!(matches!(reader.read(), Ok(None)));
    }

    #[test]
    fn a_text_that_is_too_long_is_not_written_in_part() {
        let text = "\n".repeat(LONGEST / 2 + 1);
        let message = Event::Message { error: false, text };
        let mut bytes = Vec::new();
        let error = write(&mut bytes, &message).expect_err("each line feed takes two bytes");
        assert!(matches!(error, WriteError::TooLong { length } if length > LONGEST));
        assert!(bytes.is_empty());
    }

    #[test]
    fn errors_repeat_the_start_of_a_line_and_no_more() {
        let all = read(&["é".repeat(1000).as_bytes(), b"\n"].concat());
        let Err(error @ ReadError::Invalid { excerpt, .. }) = &all[0] else {
            panic!("{all:?}")
        };
        assert_eq!(*excerpt, format!("{}…", "é".repeat(80)));
        assert!(error.to_string().contains("not a message"));
    }

    #[test]
    fn a_colour_has_the_names_of_the_wire() {
        let event = Event::WriteColour {
            version: 3,
            object: "s".into(),
            colour: [0.0, 0.5, 1.0],
        };
        let text = r#"{"type":"writeColor","version":3,"object":"s","color":[0.0,0.5,1.0]}"#;
        assert_eq!(serde_json::to_string(&event).expect("JSON"), text);
    }
}
