//! The language server: messages of an editor in, answers and diagnostics out.
//!
//! ```text
//! bytes ──frames──▶ tower-lsp ──incoming──▶ session, documents (changed at once, in the order of the messages)
//!                                   │            │ snapshots
//!                                   ▼            ▼
//!                              workers: ide, scene ──outgoing──▶ tower-lsp ──frames──▶ bytes
//!                                                        └──────── direct ────────▲
//! ```
//!
//! A preview window is a process of its own beside each document that has one (`preview`).
//!
//! The protocol's types live in `incoming` and `outgoing`. Nothing a client sends ends the server but `exit`, the end of
//! its input, and the death of the process that started it.

mod direct;
mod documents;
mod encoding;
mod frames;
mod incoming;
mod outgoing;
mod platform;
mod preview;
mod session;
mod settings;
mod tokens;
mod workspace;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use ide::Languages;
use tokio::io::{AsyncRead, AsyncWrite, AsyncWriteExt};
use tower_lsp::{LspService, Server};

use direct::{Direct, Message, Outlet};
use frames::{Frame, FrameReader};
use incoming::Backend;
pub use preview::WindowProgram;
use session::Session;

/// How many messages are worked on at once; a cancellation waits for a free place.
const CONCURRENCY: usize = 64;
/// Bytes on the way between the framing and the protocol.
const BUFFER: usize = 1 << 16;

/// How a session came to its end.
#[derive(Debug, Default)]
pub(crate) struct End {
    asked_for: AtomicBool,
    now: tokio::sync::Notify,
}

impl End {
    /// The editor has said `shutdown`.
    pub(crate) fn was_asked_for(&self) {
        self.asked_for.store(true, Ordering::SeqCst);
    }

    /// The session ends, whatever is under way.
    pub(crate) fn now(&self) {
        self.now.notify_one();
    }
}

/// Serves one editor on standard input and output until it leaves. True if it left as it should: by `shutdown`, then
/// `exit` or the end of its input. Documents are in one of the `languages`. `window` is what is started for a preview;
/// without one the editor is told so.
///
/// # Errors
/// Where no threads or timers can be had from the system.
pub fn run(languages: Languages, window: Option<WindowProgram>) -> std::io::Result<bool> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_io()
        .enable_time()
        .build()?;
    let clean = runtime.block_on(serve(
        tokio::io::stdin(),
        tokio::io::stdout(),
        languages,
        window,
    ));
    // A read of standard input may be waiting for an editor that says nothing more.
    runtime.shutdown_background();
    Ok(clean)
}

/// Serves one editor on any pair of streams; see [`run`].
pub async fn serve<R, W>(
    input: R,
    output: W,
    languages: Languages,
    window: Option<WindowProgram>,
) -> bool
where
    R: AsyncRead + Unpin + Send + 'static,
    W: AsyncWrite + Unpin + Send + 'static,
{
    let end = Arc::new(End::default());
    let session = Arc::new(Mutex::new(Session::new(languages, window)));
    let (outlet, mut direct) = Outlet::new();
    let faults = outlet.clone();
    let service = LspService::build(|client| {
        Backend::new(client, end.clone(), session.clone(), outlet.clone())
    });
    let service = service.custom_method(incoming::CURSOR, Backend::cursor);
    let (service, socket) = incoming::with_texts(service).finish();
    let service = Direct::new(service, outlet);
    let (mut to_protocol, from_editor) = tokio::io::duplex(BUFFER);
    let (to_editor, from_protocol) = tokio::io::duplex(BUFFER);

    let reading = tokio::spawn(async move {
        let mut frames = FrameReader::new(input);
        while let Some(frame) = frames.next().await {
            match frame {
                Frame::Message(body) => {
                    if to_protocol.write_all(&frames::framed(&body)).await.is_err() {
                        return;
                    }
                }
                // Answered below; the editor is not left without a word.
                Frame::Bad(reason) => {
                    faults.send(error(PARSE_ERROR, &format!("this is no message: {reason}")));
                }
                Frame::Invalid => {
                    let message = "this is JSON, but neither a request nor an answer";
                    faults.send(error(INVALID_REQUEST, message));
                }
            }
        }
    });
    let mut writing = tokio::spawn(async move {
        let mut output = output;
        let mut frames = FrameReader::of_own(from_protocol);
        let mut goes_on = true;
        while goes_on {
            let message = tokio::select! {
                // What was sent past the protocol first, so that its order with answers that go there is kept.
                biased;
                Some(message) = direct.recv() => Some(message),
                frame = frames.next() => match frame {
                    Some(Frame::Message(body)) => Some(Message::from(body)),
                    Some(Frame::Bad(_) | Frame::Invalid) => None,
                    None => {
                        goes_on = false;
                        None
                    }
                },
            };
            if let Some(message) = message
                && write(&mut output, &message.body).await.is_err()
            {
                return;
            }
        }
        // What has been said is still written.
        while let Ok(message) = direct.try_recv() {
            if write(&mut output, &message.body).await.is_err() {
                return;
            }
        }
    });
    let server = Server::new(from_editor, to_editor, socket).concurrency_level(CONCURRENCY);
    // Beside the tasks that read and write, so that a message goes from one to the next without waking a thread.
    let mut serving = tokio::spawn(server.serve(service));
    tokio::select! {
        _ = &mut serving => {
            // What has been said is still written.
            let _ = (&mut writing).await;
        }
        () = end.now.notified() => {}
    }
    // The editor has gone, with a word or without one: its windows go too.
    incoming::close_all(&session).await;
    serving.abort();
    reading.abort();
    writing.abort();
    end.asked_for.load(Ordering::SeqCst)
}

/// Writes a message with its header.
async fn write(output: &mut (impl AsyncWrite + Unpin), body: &[u8]) -> std::io::Result<()> {
    output.write_all(&frames::framed(body)).await?;
    output.flush().await
}

/// JSON-RPC 2.0, section 5.1: what was read is no JSON, …
const PARSE_ERROR: i64 = -32700;
/// … or no request.
const INVALID_REQUEST: i64 = -32600;

/// The answer to what cannot be told apart by its identifier.
fn error(code: i64, message: &str) -> Vec<u8> {
    let error = serde_json::json!({
        "jsonrpc": "2.0",
        "id": null,
        "error": { "code": code, "message": message },
    });
    error.to_string().into_bytes()
}
