//! Large answers: serialised where they are computed, and sent past the protocol's own path, which would first build a
//! tree of all their values.
//!
//! In: requests, and for some of them an answer that is already JSON. Out: whole messages for the writer, in order,
//! beside those that the protocol writes. State, cancellation and errors remain the protocol's: a request only gets the
//! name of a method that answers with text.

use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use serde::Serialize;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tower_lsp::jsonrpc::{Error, Id, Request, Response, Result};
use tower_lsp::ls_types::LSPAny;
use tower_service::Service;

/// The methods that answer with text, by the protocol's names and by this server's.
macro_rules! methods {
    ($($name:ident = $method:literal;)*) => {
        $(pub(crate) const $name: &str = concat!("text:", $method);)*

        /// Returns this server's name for a method of the protocol that answers with text.
        fn named(method: &str) -> Option<&'static str> {
            match method {
                $($method => Some($name),)*
                _ => None,
            }
        }
    };
}

methods! {
    CODE_LENS = "textDocument/codeLens";
    CODE_ACTION = "textDocument/codeAction";
    COMPLETION = "textDocument/completion";
    DIAGNOSTIC = "textDocument/diagnostic";
    DOCUMENT_HIGHLIGHT = "textDocument/documentHighlight";
    DOCUMENT_SYMBOL = "textDocument/documentSymbol";
    FOLDING_RANGE = "textDocument/foldingRange";
    FORMATTING = "textDocument/formatting";
    INLAY_HINT = "textDocument/inlayHint";
    REFERENCES = "textDocument/references";
    RENAME = "textDocument/rename";
    SYMBOL = "workspace/symbol";
    TOKENS = "textDocument/semanticTokens/full";
    TOKENS_DELTA = "textDocument/semanticTokens/full/delta";
    TOKENS_RANGE = "textDocument/semanticTokens/range";
}

/// The maximum number of large answers and of error responses that wait for the editor to read them. Until then their
/// requests are not complete, and no message after an invalid one is read.
const MOST_WAITING: usize = 8;

/// An answer as JSON.
#[derive(Debug)]
pub(crate) struct Answer(String);

/// It passes through the protocol as a single string.
impl Serialize for Answer {
    fn serialize<S: serde::Serializer>(&self, to: S) -> std::result::Result<S::Ok, S::Error> {
        to.serialize_str(&self.0)
    }
}

/// Serialises an answer.
///
/// # Errors
/// An internal error; all types of the protocol can be serialised.
pub(crate) fn answer(value: &impl Serialize) -> Result<Answer> {
    serde_json::to_string(value)
        .map(Answer)
        .map_err(|_| Error::internal_error())
}

/// Returns the body of a notification.
pub(crate) fn notification(method: &str, params: &impl Serialize) -> Vec<u8> {
    #[derive(Serialize)]
    struct Notification<'a, P> {
        jsonrpc: &'static str,
        method: &'a str,
        params: &'a P,
    }
    let notification = Notification {
        jsonrpc: "2.0",
        method,
        params,
    };
    // All types of the protocol can be serialised.
    serde_json::to_vec(&notification).unwrap_or_default()
}

/// A whole message, without its header.
#[derive(Debug)]
pub(crate) struct Message {
    pub(crate) body: Vec<u8>,
    /// Released when the message has been written.
    _room: Option<OwnedSemaphorePermit>,
}

impl From<Vec<u8>> for Message {
    fn from(body: Vec<u8>) -> Self {
        Self { body, _room: None }
    }
}

/// Sends messages to the editor, in order.
#[derive(Clone, Debug)]
pub(crate) struct RawSender {
    messages: UnboundedSender<Message>,
    room: Arc<Semaphore>,
}

impl RawSender {
    /// Returns a sender and the receiver of its messages.
    pub(crate) fn new() -> (Self, UnboundedReceiver<Message>) {
        let (messages, out) = unbounded_channel();
        let room = Arc::new(Semaphore::new(MOST_WAITING));
        (Self { messages, room }, out)
    }

    /// Sends a small message at once. Only messages whose number the server limits may be sent in this way.
    pub(crate) fn send(&self, body: Vec<u8>) {
        let _ = self.messages.send(body.into());
    }

    /// Sends a message once there is room for it.
    pub(crate) async fn send_when_room(&self, body: Vec<u8>) {
        let room = self.room().await;
        let _ = self.messages.send(Message { body, _room: room });
    }

    /// Sends an answer once there is room for it.
    async fn answer(&self, id: &Id, text: &str) {
        let room = self.room().await;
        let id = serde_json::to_string(id).unwrap_or_else(|_| "null".to_owned());
        let parts = [r#"{"jsonrpc":"2.0","id":"#, &id, r#","result":"#, text, "}"];
        let _ = self.messages.send(Message {
            body: parts.concat().into_bytes(),
            _room: room,
        });
    }

    /// Waits for room for a message. The semaphore is never closed.
    async fn room(&self) -> Option<OwnedSemaphorePermit> {
        self.room.clone().acquire_owned().await.ok()
    }
}

/// The protocol's service, which some answers bypass.
#[derive(Debug)]
pub(crate) struct RawResponses<S> {
    inner: S,
    raw_sender: RawSender,
}

impl<S> RawResponses<S> {
    pub(crate) fn new(inner: S, raw_sender: RawSender) -> Self {
        Self { inner, raw_sender }
    }
}

impl<S> Service<Request> for RawResponses<S>
where
    S: Service<Request, Response = Option<Response>>,
    S::Future: Send + 'static,
    S::Error: Send,
{
    type Response = Option<Response>;
    type Error = S::Error;
    type Future =
        Pin<Box<dyn Future<Output = std::result::Result<Option<Response>, S::Error>> + Send>>;

    fn poll_ready(&mut self, cx: &mut Context<'_>) -> Poll<std::result::Result<(), S::Error>> {
        self.inner.poll_ready(cx)
    }

    fn call(&mut self, request: Request) -> Self::Future {
        let Some(name) = named(request.method()) else {
            return Box::pin(self.inner.call(request));
        };
        let (_, id, params) = request.into_parts();
        let mut request = Request::build(name);
        if let Some(id) = id {
            request = request.id(id);
        }
        if let Some(params) = params {
            request = request.params(params);
        }
        let answered = self.inner.call(request.finish());
        let raw_sender = self.raw_sender.clone();
        Box::pin(async move {
            let Some(response) = answered.await? else {
                return Ok(None);
            };
            match response.into_parts() {
                (id, Ok(LSPAny::String(text))) => {
                    raw_sender.answer(&id, &text).await;
                    Ok(None)
                }
                (id, other) => Ok(Some(Response::from_parts(id, other))),
            }
        })
    }
}
