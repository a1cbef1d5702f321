//! Messages on a stream of bytes: `Content-Length: N`, a blank line, N bytes of JSON.
//!
//! The reader always recovers. A header without a length, a wrong length, or a body that is not JSON becomes a
//! [`Frame::Bad`] with a reason, and reading continues at the next header that can be found. Messages are parsed here
//! and nowhere else.

use futures::{Sink, Stream, sink, stream};
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tower_lsp::jsonrpc::{Request, Response};

/// The maximum length of a message that is read, in bytes; an editor sends whole files, but none of this size.
const LONGEST: usize = 256 << 20;
/// The maximum length of a header, in bytes.
const LONGEST_HEADER: usize = 64 << 10;
const LENGTH: &[u8] = b"Content-Length:";

/// A message that was read.
#[derive(Debug, PartialEq)]
pub(crate) enum Frame {
    /// A request or a notification of the editor.
    Request(Request),
    /// The response to a request of the server.
    Response(Response),
    /// Anything else, with the reason: completes "this is no message: …".
    Bad(String),
    /// Valid JSON that is neither a request, a notification nor a response.
    Invalid,
    /// The stream can no longer be read; the system's reason. No frame follows.
    Failed(String),
}

/// Reads frames from a stream.
pub(crate) struct FrameReader<R> {
    stream: R,
    buffer: Vec<u8>,
    /// The number of bytes at the start of the buffer that have been used.
    used: usize,
    /// True if the bytes from `used` on may be the rest of a faulty message: everything before the next header is skipped.
    skips: bool,
    ended: bool,
    /// The reason of an end by a failure, until it has been returned.
    failure: Option<String>,
}

impl<R: AsyncRead + Unpin> FrameReader<R> {
    pub(crate) fn new(stream: R) -> Self {
        Self {
            stream,
            buffer: Vec::new(),
            used: 0,
            skips: false,
            ended: false,
            failure: None,
        }
    }

    /// Returns the next frame; `None` at the end of the stream.
    pub(crate) async fn next(&mut self) -> Option<Frame> {
        let Some(header) = self.header().await else {
            return self.failure.take().map(Frame::Failed);
        };
        let (body, length) = match header {
            Ok(header) => header,
            Err(reason) => return Some(Frame::Bad(reason)),
        };
        if length > LONGEST {
            self.skip_from(body);
            return Some(Frame::Bad(format!(
                "its length of {length} bytes is too large"
            )));
        }
        while self.buffer.len() < body + length && self.fill().await {}
        let end = (body + length).min(self.buffer.len());
        let content = &self.buffer[body..end];
        if end == body + length {
            let whole = || message(&without_lone_surrogates(content)?);
            if let Some(frame) = message(content).or_else(whole) {
                self.used = end;
                return Some(frame);
            }
            if serde_json::from_slice::<serde::de::IgnoredAny>(content).is_ok() {
                self.used = end;
                return Some(Frame::Invalid);
            }
        }
        // The length may be wrong: search for the next header from the start of the body.
        self.skip_from(body);
        Some(Frame::Bad(
            "its body is not valid JSON of the length in its header".to_owned(),
        ))
    }

    /// Returns the start of the next body, and its length.
    async fn header(&mut self) -> Option<Result<(usize, usize), String>> {
        self.buffer.drain(..self.used);
        self.used = 0;
        loop {
            self.skip_to_header();
            let blank = find(&self.buffer, b"\r\n\r\n");
            if let Some(end) = blank {
                let header = &self.buffer[..end];
                let length = length_of(header);
                match length {
                    Some(length) => return Some(Ok((end + 4, length))),
                    None => {
                        self.skip_from(end + 4);
                        return Some(Err("its header has no valid Content-Length".to_owned()));
                    }
                }
            }
            if self.buffer.len() > LONGEST_HEADER {
                self.skip_from(1);
                return Some(Err("its header does not end".to_owned()));
            }
            if !self.fill().await {
                if self.buffer.is_empty() {
                    return None;
                }
                self.buffer.clear();
                return Some(Err("the input ends within a header".to_owned()));
            }
        }
    }

    /// Skips the bytes up to `from`, and from there on everything up to the next header, which may not have been read yet.
    fn skip_from(&mut self, from: usize) {
        self.used = from.min(self.buffer.len());
        self.skips = true;
    }

    /// Removes what is skipped from the buffer. At its end, the beginning of a header is kept.
    fn skip_to_header(&mut self) {
        if !self.skips {
            return;
        }
        let begins_header = |at: &usize| {
            let mut name = self.buffer[*at..].iter().zip(LENGTH);
            name.all(|(byte, expected)| byte.eq_ignore_ascii_case(expected))
        };
        let start = (0..self.buffer.len()).find(begins_header);
        self.buffer.drain(..start.unwrap_or(self.buffer.len()));
        self.skips = self.buffer.len() < LENGTH.len();
    }

    /// Reads more bytes. Returns false at the end of the stream.
    async fn fill(&mut self) -> bool {
        if self.ended {
            return false;
        }
        match self.stream.read_buf(&mut self.buffer).await {
            Ok(count) => self.ended = count == 0,
            Err(error) => {
                self.ended = true;
                self.failure = Some(error.to_string());
            }
        }
        !self.ended
    }
}

/// Returns the frames of a stream, up to its end.
pub(crate) fn read(stream: impl AsyncRead + Unpin) -> impl Stream<Item = Frame> {
    stream::unfold(FrameReader::new(stream), async |mut reader| {
        let frame = reader.next().await?;
        Some((frame, reader))
    })
}

/// Writes each body with its header at once.
pub(crate) fn write(stream: impl AsyncWrite + Unpin) -> impl Sink<Vec<u8>, Error = std::io::Error> {
    sink::unfold(stream, async |mut stream, body: Vec<u8>| {
        stream.write_all(&framed(&body)).await?;
        stream.flush().await?;
        Ok(stream)
    })
}

/// Returns the bytes of a message with its header.
pub(crate) fn framed(body: &[u8]) -> Vec<u8> {
    let mut bytes = format!("Content-Length: {}\r\n\r\n", body.len()).into_bytes();
    bytes.extend_from_slice(body);
    bytes
}

fn length_of(header: &[u8]) -> Option<usize> {
    let header = std::str::from_utf8(header).ok()?;
    header.split("\r\n").find_map(|line| {
        let (name, value) = line.split_once(':')?;
        let is_length = name.trim().eq_ignore_ascii_case("Content-Length");
        is_length.then(|| value.trim().parse().ok()).flatten()
    })
}

/// Parses a body as a message. The method is optional in the protocol's type of requests, so a response is a request
/// without a method.
pub(crate) fn message(body: &[u8]) -> Option<Frame> {
    let request: Option<Request> = serde_json::from_slice(body).ok();
    match request {
        Some(request) if !request.method().is_empty() => Some(Frame::Request(request)),
        request => {
            let response = serde_json::from_slice(body).ok().map(Frame::Response);
            response.or(request.map(Frame::Request))
        }
    }
}

/// Replaces escapes of lone UTF-16 surrogates in a body by that of U+FFFD; `None` if there are none. An editor whose text is
/// UTF-16 sends them, but they denote no character. All lengths in UTF-16 units remain the same.
fn without_lone_surrogates(body: &[u8]) -> Option<Vec<u8>> {
    let unit = |at: usize| {
        let digits = body.get(at..at + 6)?.strip_prefix(b"\\u")?;
        u16::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
    };
    let mut replaced = None;
    let mut at = 0;
    let next_escape = |from: usize| {
        let rest = body.get(from..)?;
        Some(from + rest.iter().position(|byte| *byte == b'\\')?)
    };
    while let Some(escape) = next_escape(at) {
        at = escape;
        at += match (unit(at), unit(at + 6)) {
            (Some(0xD800..0xDC00), Some(0xDC00..0xE000)) => 12,
            (Some(0xD800..0xE000), _) => {
                let bytes = replaced.get_or_insert_with(|| body.to_vec());
                bytes[at..at + 6].copy_from_slice(b"\\ufffd");
                6
            }
            // The escaped character, perhaps another backslash, begins no escape.
            _ => 2,
        };
    }
    replaced
}

fn find(bytes: &[u8], wanted: &[u8]) -> Option<usize> {
    bytes
        .windows(wanted.len())
        .position(|window| window == wanted)
}

#[cfg(test)]
mod tests {
    use super::{Frame, FrameReader, framed};

    async fn read(bytes: &[u8]) -> Vec<Frame> {
        let mut reader = FrameReader::new(bytes);
        let mut frames = Vec::new();
        while let Some(frame) = reader.next().await {
            frames.push(frame);
            assert!(frames.len() < 100);
        }
        frames
    }

    fn good(frames: &[Frame]) -> Vec<String> {
        let texts = frames.iter().filter_map(|frame| match frame {
            Frame::Request(request) => Some(request.to_string()),
            Frame::Response(response) => serde_json::to_string(response).ok(),
            _ => None,
        });
        texts.collect()
    }

    #[tokio::test]
    async fn messages_behind_any_fault_are_read() {
        let next = framed(br#"{"jsonrpc":"2.0","method":"b"}"#);
        for fault in [
            &b"Content-Length: 5\r\n\r\n{\"a\":1}"[..],
            b"Content-Length: 99\r\n\r\n{\"a\":1}",
            b"Content-Length: x\r\n\r\n{\"a\":1}",
            b"Content-Length: -1\r\n\r\n",
            b"Content-Length: 4\r\n\r\n{\"a\"",
            b"Content-Length: 2\r\n\r\n\xFF\xFE",
            b"Content-Type: x\r\n\r\n{}",
            b"garbage\r\n\r\n",
            b"Content-Length: 99999999999\r\n\r\n",
        ] {
            let frames = read(&[fault, &next].concat()).await;
            assert_eq!(
                good(&frames).last().map(String::as_str),
                Some(r#"{"jsonrpc":"2.0","method":"b"}"#),
                "{fault:?}: {frames:?}"
            );
            assert!(
                frames.iter().any(|f| matches!(f, Frame::Bad(_))),
                "{fault:?}"
            );
        }
    }

    #[tokio::test]
    async fn a_fault_is_reported_once_however_the_stream_is_cut() {
        use tokio::io::AsyncWriteExt;
        let message = r#"{"jsonrpc":"2.0","method":"b"}"#;
        for fault in [
            &b"Content-Lenth: 5\r\n\r\n{\"a\"}"[..],
            b"Content-Length: x\r\n\r\n{}",
            b"Content-Length: 3\r\n\r\n{\"jsonrpc\":\"2.0\"}",
            b"Content-Length: 2\r\n\r\n\xFF\xFE",
        ] {
            for name in ["Content-Length", "content-length"] {
                let header = format!("{name}: {}\r\n\r\n", message.len());
                let bytes = [fault, header.as_bytes(), message.as_bytes()].concat();
                for cut in 0..=bytes.len() {
                    let (mut writer, reader) = tokio::io::duplex(1024);
                    let mut reader = FrameReader::new(reader);
                    let (first, rest) = bytes.split_at(cut);
                    let frames = async {
                        let mut frames = Vec::new();
                        while let Some(frame) = reader.next().await {
                            frames.push(frame);
                        }
                        frames
                    };
                    let write = async {
                        writer.write_all(first).await.expect("room");
                        // The reader takes what it has.
                        tokio::task::yield_now().await;
                        writer.write_all(rest).await.expect("room");
                        drop(writer);
                    };
                    let ((), frames) = tokio::join!(write, frames);
                    assert!(
                        matches!(frames[..], [Frame::Bad(_), Frame::Request(_)]),
                        "{fault:?} {name} {cut}: {frames:?}"
                    );
                }
            }
        }
    }

    #[tokio::test]
    async fn a_lone_surrogate_is_a_replacement_character() {
        for (text, expected) in [
            (r"\ud83d", "\u{FFFD}"),
            (r"a\uDE00b\ud83d", "a\u{FFFD}b\u{FFFD}"),
            (r"\ud83d\ud83d\ude00", "\u{FFFD}\u{1F600}"),
            (r"\\\ud83d\\", "\\\u{FFFD}\\"),
            (r"\\ud83d\ud83d", "\\ud83d\u{FFFD}"),
        ] {
            let body = format!(r#"{{"jsonrpc":"2.0","method":"b","params":{{"text":"{text}"}}}}"#);
            let frames = read(&framed(body.as_bytes())).await;
            let [Frame::Request(request)] = &frames[..] else {
                panic!("{text}: {frames:?}");
            };
            let params = serde_json::to_value(request.params()).expect("JSON");
            assert_eq!(params["text"], expected, "{text}");
        }
    }

    #[tokio::test]
    async fn answers_of_the_editor_are_responses() {
        for answer in [
            r#"{"jsonrpc":"2.0","result":null,"id":1}"#,
            r#"{"jsonrpc":"2.0","error":{"code":-32603,"message":"no"},"id":"a"}"#,
        ] {
            let frames = read(&framed(answer.as_bytes())).await;
            assert!(matches!(frames[..], [Frame::Response(_)]), "{frames:?}");
            assert_eq!(good(&frames), [answer]);
        }
    }

    #[tokio::test]
    async fn messages_come_whole_however_the_stream_is_cut() {
        let messages = [
            r#"{"jsonrpc":"2.0","method":"a"}"#,
            r#"{"jsonrpc":"2.0","method":"b","params":{"text":"a\r\n\r\nb"}}"#,
        ];
        let bytes = messages.map(|message| framed(message.as_bytes())).concat();
        assert_eq!(good(&read(&bytes).await), messages);
        let (mut writer, reader) = tokio::io::duplex(3);
        let task = tokio::spawn(async move {
            use tokio::io::AsyncWriteExt;
            writer.write_all(&bytes).await
        });
        let mut reader = FrameReader::new(reader);
        for message in messages {
            let next = reader.next().await.expect("a message");
            assert_eq!(good(&[next]), [message]);
        }
        assert_eq!(reader.next().await, None);
        assert!(task.await.is_ok());
    }
}
