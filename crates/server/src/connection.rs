//! The connection to the editor: each message is framed and parsed once, and calls the protocol's service directly.
//!
//! ```text
//! bytes ──FrameReader──▶ requests ──▶ service ──▶ responses ─┐
//!                    └─▶ responses ─▶ socket ──▶ requests ───┼──▶ writer ──▶ bytes
//!                                     raw responses ─────────┘
//! ```
//!
//! The futures of the requests run beside each other in one task, which also reads: each is polled first in the order of
//! the messages. `tower_lsp::Server` does the same behind streams of its own, which would frame and parse every message a
//! second time, without the recovery of [`FrameReader`].

use futures::channel::mpsc;
use futures::{FutureExt, SinkExt, StreamExt, TryFutureExt, future, join, stream};
use serde::Serialize;
use tokio::io::{AsyncRead, AsyncWrite, AsyncWriteExt};
use tokio::sync::mpsc::UnboundedReceiver;
use tower_lsp::ClientSocket;
use tower_lsp::jsonrpc::{Request, Response};
use tower_service::Service;

use crate::frames::{self, Frame, FrameReader};
use crate::raw_responses::{Message, RawSender};

/// The number of messages that are processed at once; a cancellation waits for a free place.
const CONCURRENCY: usize = 64;
/// The number of requests that may wait for a place.
const WAITING: usize = 100;

/// JSON-RPC 2.0, section 5.1: what was read is no JSON, …
const PARSE_ERROR: i64 = -32700;
/// … or no request.
const INVALID_REQUEST: i64 = -32600;

/// The two tasks of a connection.
pub(crate) struct Connection {
    /// Reads and works; ends with the input, or behind `exit`.
    pub(crate) serving: tokio::task::JoinHandle<()>,
    /// Writes; ends when there is nothing more to write, or the editor does not read any more.
    pub(crate) writing: tokio::task::JoinHandle<()>,
}

impl Connection {
    /// Starts to serve an editor. `raw` are the messages that `raw_sender` takes.
    pub(crate) fn start<R, W, S>(
        input: R,
        output: W,
        service: S,
        socket: ClientSocket,
        raw_sender: RawSender,
        raw: UnboundedReceiver<Message>,
    ) -> Self
    where
        R: AsyncRead + Unpin + Send + 'static,
        W: AsyncWrite + Unpin + Send + 'static,
        S: Service<Request, Response = Option<Response>> + Send + 'static,
        S::Error: Send,
        S::Future: Send,
    {
        let (requests, mut answers) = socket.split();
        let (requests, requests_end) = stream::abortable(requests);
        // A response waits until the one before is written.
        let (responses, to_write) = mpsc::channel(0);
        let messages = stream::select(to_write.map(json::<Response>), requests.map(json));
        let writing = tokio::spawn(write_all(output, raw, messages));
        let serving = tokio::spawn(async move {
            let (mut tasks, to_do) = mpsc::channel(WAITING);
            let work = to_do
                .buffer_unordered(CONCURRENCY)
                .filter_map(future::ready)
                .map(Ok)
                .forward(responses)
                .map(|_| ());
            let read = async move {
                let mut service = service;
                let mut frames = FrameReader::new(input);
                while let Some(frame) = frames.next().await {
                    match frame {
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
                            let message = format!("this is no message: {reason}");
                            raw_sender.send(error(PARSE_ERROR, &message));
                        }
                        Frame::Invalid => {
                            let message = "this is JSON, but neither a request nor an answer";
                            raw_sender.send(error(INVALID_REQUEST, message));
                        }
                    }
                }
                // The responses of what is under way are still written, but no more requests are sent to the editor.
                requests_end.abort();
            };
            join!(work, read);
        });
        Self { serving, writing }
    }
}

/// Writes messages as they come, those that are sent raw first, so that their order with responses that go the protocol's
/// way is kept.
async fn write_all(
    mut output: impl AsyncWrite + Unpin,
    mut raw: UnboundedReceiver<Message>,
    mut messages: impl stream::Stream<Item = Vec<u8>> + Unpin,
) {
    loop {
        let written = tokio::select! {
            biased;
            Some(message) = raw.recv() => write(&mut output, &message.body).await,
            message = messages.next() => match message {
                Some(body) => write(&mut output, &body).await,
                None => break,
            },
        };
        if written.is_err() {
            return;
        }
    }
    // Raw messages that have been sent are still written.
    while let Ok(message) = raw.try_recv() {
        if write(&mut output, &message.body).await.is_err() {
            return;
        }
    }
}

/// Writes a message with its header.
async fn write(output: &mut (impl AsyncWrite + Unpin), body: &[u8]) -> std::io::Result<()> {
    output.write_all(&frames::framed(body)).await?;
    output.flush().await
}

/// The body of a message. The protocol's types can all be written.
fn json<T: Serialize>(message: T) -> Vec<u8> {
    serde_json::to_vec(&message).unwrap_or_default()
}

/// The response to a message that has no identifier that could be read.
fn error(code: i64, message: &str) -> Vec<u8> {
    let error = serde_json::json!({
        "jsonrpc": "2.0",
        "id": null,
        "error": { "code": code, "message": message },
    });
    error.to_string().into_bytes()
}
