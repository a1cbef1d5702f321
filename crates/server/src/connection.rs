//! The connection to the editor: each message calls the protocol's service directly.
//!
//! ```text
//! frames ──▶ requests ──▶ service ──▶ responses ─┐
//!        └─▶ responses ─▶ socket ──▶ requests ───┼──▶ bodies
//!                         raw responses ─────────┘
//! ```
//!
//! The futures of the requests run concurrently in one task, which also reads and writes: each is first polled in the
//! order of the messages. `tower_lsp::Server` does the same on streams of its own, which would frame and parse every
//! message a second time, without the error recovery of `frames::FrameReader`.

use futures::channel::{mpsc, oneshot};
use futures::{FutureExt, Sink, SinkExt, Stream, StreamExt, TryFutureExt, future, join, stream};
use serde::Serialize;
use tokio::sync::mpsc::UnboundedReceiver;
use tower_lsp::ClientSocket;
use tower_lsp::jsonrpc::{Error, Request, Response};
use tower_lsp::ls_types as lsp;
use tower_lsp::ls_types::notification::Notification as _;
use tower_service::Service;

use crate::frames::Frame;
use crate::raw_responses::{Message, RawSender};

/// The maximum number of messages that are processed at once; a cancellation waits for a free slot.
const CONCURRENCY: usize = 64;
/// The maximum number of requests that wait for a slot.
const WAITING: usize = 100;

/// JSON-RPC 2.0, section 5.1: the message is not JSON, …
const PARSE_ERROR: i64 = -32700;
/// … or not a request.
const INVALID_REQUEST: i64 = -32600;

/// Serves the connection to an editor, whose messages come from `frames`; the bodies of messages to it are written to
/// `output`. `raw` receives the messages of `raw_sender`. Ends after the last frame or `exit`, when all messages are
/// written or the editor has stopped reading.
pub(crate) async fn run<S>(
    frames: impl Stream<Item = Frame>,
    output: impl Sink<Vec<u8>>,
    service: S,
    socket: ClientSocket,
    raw_sender: RawSender,
    raw: UnboundedReceiver<Message>,
) where
    S: Service<Request, Response = Option<Response>>,
{
    let (requests, mut answers) = socket.split();
    let (requests_end, ended) = oneshot::channel::<()>();
    let requests = until(requests, ended);
    // A response waits until the previous one is written.
    let (responses, to_write) = mpsc::channel(0);
    let messages = stream::select(to_write.map(json::<Response>), requests.map(json));
    let writing = write_all(Box::pin(output), raw, Box::pin(messages));
    let serving = async {
        let (mut tasks, to_do) = mpsc::channel(WAITING);
        let work = to_do
            .buffer_unordered(CONCURRENCY)
            .filter_map(future::ready)
            .map(Ok)
            .forward(responses)
            .map(|_| ());
        let read = async move {
            let mut service = service;
            let mut frames = Box::pin(frames);
            while let Some(frame) = frames.next().await {
                match frame {
                    Frame::Request(request)
                        if request.method().starts_with("$/") && request.id().is_some() =>
                    {
                        // The service treats them all as notifications.
                        let id = request.id().cloned().unwrap_or_default();
                        let unknown = Response::from_error(id, Error::method_not_found());
                        raw_sender.send(json(unknown));
                    }
                    Frame::Request(request) => {
                        let is_last = request.method() == "exit";
                        if future::poll_fn(|cx| service.poll_ready(cx)).await.is_err() {
                            break;
                        }
                        let task = service.call(request).unwrap_or_else(|_| None);
                        let _ = tasks.send(task).await;
                        if is_last {
                            break;
                        }
                    }
                    Frame::Response(response) => {
                        if answers.send(response).await.is_err() {
                            break;
                        }
                    }
                    Frame::Bad(reason) => {
                        let message = format!("this is not a message: {reason}");
                        raw_sender
                            .send_when_room(error(PARSE_ERROR, &message))
                            .await;
                    }
                    Frame::Invalid => {
                        let message = "this is JSON, but neither a request nor an answer";
                        raw_sender
                            .send_when_room(error(INVALID_REQUEST, message))
                            .await;
                    }
                    Frame::Failed(reason) => {
                        let message = format!("the editor's messages cannot be read: {reason}");
                        raw_sender.send(log(&message));
                    }
                }
            }
            // The responses of running requests are still written, but no more requests are sent to the editor.
            drop(requests_end);
        };
        join!(work, read);
    };
    // One task, in this order: a handler's messages are written in the same turn, without waking another thread.
    join!(serving, writing);
}

/// Returns the items of a stream until the sender of `ended` is dropped. Then it drops the stream: otherwise a handler
/// could wait forever for room in the channel behind it, and the connection for the handler.
fn until<S: Stream + Unpin>(
    stream: S,
    ended: oneshot::Receiver<()>,
) -> impl Stream<Item = S::Item> {
    stream::unfold((stream, ended), |(mut stream, mut ended)| async {
        tokio::select! {
            biased;
            _ = &mut ended => None,
            item = stream.next() => item.map(|item| (item, (stream, ended))),
        }
    })
}

/// Writes messages as they arrive. Raw messages are written first, so that their order relative to the protocol's
/// responses is preserved.
async fn write_all(
    mut output: impl Sink<Vec<u8>> + Unpin,
    mut raw: UnboundedReceiver<Message>,
    mut messages: impl stream::Stream<Item = Vec<u8>> + Unpin,
) {
    loop {
        let written = tokio::select! {
            biased;
            Some(message) = raw.recv() => output.send(message.body).await,
            message = messages.next() => match message {
                Some(body) => output.send(body).await,
                None => break,
            },
        };
        if written.is_err() {
            return;
        }
    }
    // Raw messages that have already been sent are still written.
    while let Ok(message) = raw.try_recv() {
        if output.send(message.body).await.is_err() {
            return;
        }
    }
}

/// Returns the body of a message. All types of the protocol can be serialised.
fn json<T: Serialize>(message: T) -> Vec<u8> {
    serde_json::to_vec(&message).unwrap_or_default()
}

/// Returns the response to a message without a readable identifier.
fn error(code: i64, message: &str) -> Vec<u8> {
    let error = serde_json::json!({
        "jsonrpc": "2.0",
        "id": null,
        "error": { "code": code, "message": message },
    });
    error.to_string().into_bytes()
}

/// Returns the notification of an error for the editor's log.
fn log(message: &str) -> Vec<u8> {
    let notification = serde_json::json!({
        "jsonrpc": "2.0",
        "method": lsp::notification::LogMessage::METHOD,
        "params": lsp::LogMessageParams {
            typ: lsp::MessageType::ERROR,
            message: message.to_owned(),
        },
    });
    notification.to_string().into_bytes()
}

#[cfg(test)]
mod tests {
    use std::pin::{Pin, pin};
    use std::task::{Context, Poll};
    use std::time::Duration;

    use futures::FutureExt as _;
    use ide::Languages;
    use tokio::io::{AsyncRead, AsyncReadExt, AsyncWriteExt, ReadBuf};

    use crate::frames::framed;

    /// A stream that cannot be read.
    struct Broken;

    impl AsyncRead for Broken {
        fn poll_read(
            self: Pin<&mut Self>,
            _: &mut Context<'_>,
            _: &mut ReadBuf<'_>,
        ) -> Poll<std::io::Result<()>> {
            Poll::Ready(Err(std::io::Error::other("a broken pipe")))
        }
    }

    /// The handlers of the edits wait for room to publish their diagnostics when `exit` is read.
    #[tokio::test]
    async fn an_editor_that_leaves_before_it_has_read_everything_is_left() {
        let (mut to_server, input) = tokio::io::duplex(1 << 16);
        let (output, mut from_server) = tokio::io::duplex(64);
        let server = tokio::spawn(crate::serve(input, output, Languages::standard(), None));
        let message = |method: &str, params: serde_json::Value| {
            let message =
                serde_json::json!({ "jsonrpc": "2.0", "method": method, "params": params });
            framed(message.to_string().as_bytes())
        };
        let params = serde_json::json!({ "processId": null, "rootUri": null, "capabilities": {} });
        let initialize = serde_json::json!(
            { "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": params }
        );
        let mut bytes = framed(initialize.to_string().as_bytes());
        to_server.write_all(&bytes).await.expect("it is read");
        let mut answer = [0; 64];
        from_server
            .read_exact(&mut answer)
            .await
            .expect("an answer");

        let uri = "file:///a.gtr";
        let document =
            serde_json::json!({ "uri": uri, "languageId": "geotrace", "version": 1, "text": "a" });
        bytes = message("initialized", serde_json::json!({}));
        let open = serde_json::json!({ "textDocument": document });
        bytes.extend(message("textDocument/didOpen", open));
        for version in 2..50 {
            let edit = serde_json::json!({
                "textDocument": { "uri": uri, "version": version },
                "contentChanges": [{ "text": "b".repeat(version) }],
            });
            bytes.extend(message("textDocument/didChange", edit));
        }
        let exit = message("exit", serde_json::Value::Null);
        for bytes in [bytes, exit] {
            to_server.write_all(&bytes).await.expect("it is read");
            // The server's tasks, which share this thread, go on until nothing can be written any more.
            for _ in 0..1000 {
                tokio::task::yield_now().await;
            }
        }
        let mut rest = Vec::new();
        let all_read = from_server.read_to_end(&mut rest);
        let read = tokio::time::timeout(Duration::from_secs(60), all_read).await;
        assert!(read.is_ok(), "its output ends");
        assert!(!server.await.expect("no panic"), "it has not said goodbye");
    }

    #[tokio::test]
    async fn an_editor_that_does_not_read_the_replies_to_faults_is_not_read() {
        let (mut to_server, input) = tokio::io::duplex(1 << 10);
        let (output, mut from_server) = tokio::io::duplex(64);
        let server = tokio::spawn(crate::serve(input, output, Languages::standard(), None));
        let faults = b"Content-Length: x\r\n\r\n".repeat(5000);
        {
            let mut writing = pin!(to_server.write_all(&faults));
            for _ in 0..2000 {
                let written = writing.as_mut().now_or_never();
                assert!(written.is_none(), "all of it is read");
                tokio::task::yield_now().await;
            }
            let reading = async {
                let mut reply = [0; 64];
                loop {
                    from_server.read_exact(&mut reply).await.expect("a reply");
                }
            };
            let written = tokio::select! {
                written = writing => written,
                () = reading => Ok(()),
            };
            written.expect("it is read");
        }
        server.abort();
    }

    #[tokio::test]
    async fn an_input_that_cannot_be_read_is_written_to_the_log() {
        let input = Broken;
        let (output, mut from_server) = tokio::io::duplex(1 << 12);
        assert!(!crate::serve(input, output, Languages::standard(), None).await);
        let mut written = String::new();
        let read = from_server.read_to_string(&mut written);
        let read = tokio::time::timeout(Duration::from_secs(60), read).await;
        assert!(read.is_ok_and(|read| read.is_ok()), "its output ends");
        assert!(written.contains("window/logMessage") && written.contains("a broken pipe"));
    }
}
