//! The language server. In: messages of an editor. Out: answers and diagnostics.
//!
//! ```text
//! bytes ──connection──▶ tower-lsp ──incoming──▶ session, documents (changed at once, in the order of the messages)
//!                                       │            │ snapshots
//!                                       ▼            ▼
//!                                  workers: ide ──to_lsp──▶ tower-lsp ──connection──▶ bytes
//!                                                     └─────── raw_responses ───────▲
//! ```
//!
//! A preview window is a separate process beside each document that has one (`preview`).
//!
//! Only `incoming` and `to_lsp` use the protocol's types. No client message ends the server except `exit`; it also ends
//! with its input, and with the process that started it.

mod connection;
mod documents;
mod encoding;
mod frames;
mod incoming;
mod platform;
mod preview;
mod raw_responses;
mod session;
mod settings;
mod tasks;
mod to_lsp;
mod tokens;
#[cfg(target_family = "wasm")]
mod turns;
mod workspace;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use futures::{Sink, Stream};
use ide::Languages;
use tokio::io::{AsyncRead, AsyncWrite};
use tower_lsp::LspService;

use frames::Frame;
use incoming::Backend;
pub use preview::WindowProgram;
use raw_responses::{RawResponses, RawSender};
use session::Session;
#[cfg(target_family = "wasm")]
pub use turns::ServerByTurns;

/// The end of a session.
#[derive(Debug, Default)]
pub struct End {
    asked_for: AtomicBool,
    now: tokio::sync::Notify,
}

impl End {
    /// Records that the editor has sent `shutdown`.
    pub(crate) fn was_asked_for(&self) {
        self.asked_for.store(true, Ordering::SeqCst);
    }

    /// Ends the session at once, whatever is running; its windows are closed.
    pub fn now(&self) {
        self.now.notify_one();
    }
}

/// Serves one editor on standard input and output until it leaves. Returns true if it left properly: by `shutdown`,
/// then `exit` or the end of its input. Documents are in one of the `languages`. `window` is the program that is
/// started for a preview; without one the editor gets a message. `end` ends the session before the editor leaves.
///
/// # Errors
/// If the system has no threads or timers left.
#[cfg(not(target_family = "wasm"))]
pub fn run(
    languages: Languages,
    window: Option<WindowProgram>,
    end: Arc<End>,
) -> std::io::Result<bool> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_io()
        .enable_time()
        .build()?;
    let (input, output) = (tokio::io::stdin(), tokio::io::stdout());
    let clean = runtime.block_on(serve_until(end, input, output, languages, window));
    // A read of standard input may be blocked by an editor that sends nothing more.
    runtime.shutdown_background();
    Ok(clean)
}

/// Serves one editor on any pair of streams; see `run`.
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
    serve_until(Arc::default(), input, output, languages, window).await
}

async fn serve_until<R, W>(
    end: Arc<End>,
    input: R,
    output: W,
    languages: Languages,
    window: Option<WindowProgram>,
) -> bool
where
    R: AsyncRead + Unpin + Send + 'static,
    W: AsyncWrite + Unpin + Send + 'static,
{
    let session = Arc::new(Mutex::new(Session::new(languages, window)));
    let (frames, output) = (frames::read(input), frames::write(output));
    let mut connection = tokio::spawn(start(frames, output, end.clone(), session.clone()));
    tokio::select! {
        _ = &mut connection => {}
        () = end.now.notified() => {}
    }
    // The editor has quit, properly or not: close its windows too.
    incoming::close_all(&session).await;
    connection.abort();
    end.asked_for.load(Ordering::SeqCst)
}

/// Starts a session with an editor.
fn start(
    frames: impl Stream<Item = Frame>,
    output: impl Sink<Vec<u8>>,
    end: Arc<End>,
    session: Arc<Mutex<Session>>,
) -> impl Future<Output = ()> {
    let (raw_sender, raw) = RawSender::new();
    let faults = raw_sender.clone();
    let service = LspService::build(|client| {
        Backend::new(client, end.clone(), session.clone(), raw_sender.clone())
    });
    let service = service.custom_method(incoming::CURSOR, Backend::cursor);
    let (service, socket) = incoming::with_texts(service).finish();
    let service = RawResponses::new(service, raw_sender);
    connection::run(frames, output, service, socket, faults, raw)
}
