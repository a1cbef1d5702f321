//! Translates the protocol's messages into calls of features, and their results into answers.
//!
//! ```text
//! lifecycle   initialize, shutdown, and the capabilities of both sides
//! documents   opened, changed, closed; their diagnostics
//! places      requests at a position              ─┐
//! ranges      requests for a range, or for all     ├─▶ work: on a worker, over a snapshot
//! workspace   settings, folders, all programs     ─┘
//! conversion  a document in another language, in a new file
//! window      a document's preview window, from its start to its end
//! ```
//!
//! Every handler takes what it needs from the session before it first awaits. Handlers run concurrently, and only in
//! this way does the state change in the order of the messages. Long work runs on workers over a snapshot.

mod conversion;
mod documents;
mod lifecycle;
mod places;
mod ranges;
mod window;
mod work;
mod workspace;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Semaphore;
use tower_lsp::jsonrpc::Result;
use tower_lsp::ls_types as lsp;
use tower_lsp::{Client, LanguageServer, LspServiceBuilder};

use crate::encoding::Place;
use crate::raw_responses::{self, RawSender};
use crate::session::Session;
pub(crate) use window::close_all;

/// The notification by which an editor reports the position of its cursor, which the protocol lacks. Its params are
/// those of a hover.
pub(crate) const CURSOR: &str = "geotrace/cursor";
/// The maximum number of features that run at once: more would only share the processors, and each needs its memory.
const MOST_AT_WORK: usize = 2;
/// The maximum number of features that run a program at once: however long that takes, the others go on.
const MOST_RUNS: usize = MOST_AT_WORK - 1;

/// The server as the protocol sees it; cheap to clone.
#[derive(Clone)]
pub(crate) struct Backend {
    client: Client,
    session: Arc<Mutex<Session>>,
    /// Diagnostics are sent one after the other, so that an older list never follows a newer one.
    publishing: Arc<tokio::sync::Mutex<()>>,
    /// The permits of features that run at once.
    places: Arc<Semaphore>,
    /// The permits of those features that run a program.
    runs: Arc<Semaphore>,
    end: Arc<crate::End>,
    /// The writer of messages that bypass the protocol.
    raw_sender: RawSender,
}

/// Adds the methods that answer with text to the protocol's methods.
pub(crate) fn with_texts(builder: LspServiceBuilder<Backend>) -> LspServiceBuilder<Backend> {
    builder
        .custom_method(raw_responses::CODE_ACTION, ranges::code_action)
        .custom_method(raw_responses::CODE_LENS, ranges::code_lens)
        .custom_method(raw_responses::COMPLETION, places::completion)
        .custom_method(raw_responses::DIAGNOSTIC, documents::diagnostic)
        .custom_method(
            raw_responses::DOCUMENT_HIGHLIGHT,
            places::document_highlight,
        )
        .custom_method(raw_responses::DOCUMENT_SYMBOL, ranges::document_symbol)
        .custom_method(raw_responses::FOLDING_RANGE, ranges::folding_range)
        .custom_method(raw_responses::FORMATTING, ranges::formatting)
        .custom_method(raw_responses::INLAY_HINT, ranges::inlay_hint)
        .custom_method(raw_responses::REFERENCES, places::references)
        .custom_method(raw_responses::RENAME, places::rename)
        .custom_method(raw_responses::SYMBOL, workspace::symbol)
        .custom_method(raw_responses::TOKENS, ranges::semantic_tokens_full)
        .custom_method(
            raw_responses::TOKENS_DELTA,
            ranges::semantic_tokens_full_delta,
        )
        .custom_method(raw_responses::TOKENS_RANGE, ranges::semantic_tokens_range)
}

impl Backend {
    pub(crate) fn new(
        client: Client,
        end: Arc<crate::End>,
        session: Arc<Mutex<Session>>,
        raw_sender: RawSender,
    ) -> Self {
        Self {
            client,
            raw_sender,
            session,
            publishing: Arc::default(),
            places: Arc::new(Semaphore::new(MOST_AT_WORK)),
            runs: Arc::new(Semaphore::new(MOST_RUNS)),
            end,
        }
    }

    fn session(&self) -> MutexGuard<'_, Session> {
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Handles a move of the cursor: [`CURSOR`].
    pub(crate) async fn cursor(&self, params: lsp::TextDocumentPositionParams) {
        self.point_at(&params);
    }

    /// Stores the position of the cursor in a document, and sends it to the document's window, if it has one.
    fn point_at(&self, at: &lsp::TextDocumentPositionParams) {
        let uri = at.text_document.uri.as_str();
        let mut session = self.session();
        let session = &mut *session;
        let Some(open) = session.documents.get(uri) else {
            return;
        };
        let place = place(at.position);
        session.cursors.insert(uri.to_owned(), place);
        if session.previews.has(uri) {
            let snapshot = open.snapshot();
            let offset = snapshot.offset(place);
            session.previews.cursor(uri, snapshot.version, offset);
        }
    }
}

/// The requests and notifications that a module handles: a method of the protocol's trait for each row.
macro_rules! handlers {
    ($($module:ident::$name:ident($params:ty) $(-> $result:ty)?;)*) => {
        $(async fn $name(&self, params: $params) $(-> $result)? {
            $module::$name(self, params).await
        })*
    };
}

impl LanguageServer for Backend {
    async fn shutdown(&self) -> Result<()> {
        lifecycle::shutdown(self).await
    }

    handlers! {
        lifecycle::initialize(lsp::InitializeParams) -> Result<lsp::InitializeResult>;
        lifecycle::initialized(lsp::InitializedParams);
        documents::did_open(lsp::DidOpenTextDocumentParams);
        documents::did_change(lsp::DidChangeTextDocumentParams);
        documents::did_close(lsp::DidCloseTextDocumentParams);
        workspace::did_change_configuration(lsp::DidChangeConfigurationParams);
        workspace::did_change_workspace_folders(lsp::DidChangeWorkspaceFoldersParams);
        places::hover(lsp::HoverParams) -> Result<Option<lsp::Hover>>;
        places::completion_resolve(lsp::CompletionItem) -> Result<lsp::CompletionItem>;
        places::signature_help(lsp::SignatureHelpParams) -> Result<Option<lsp::SignatureHelp>>;
        places::goto_definition(lsp::GotoDefinitionParams) -> Result<Option<lsp::GotoDefinitionResponse>>;
        places::prepare_rename(lsp::TextDocumentPositionParams) -> Result<Option<lsp::PrepareRenameResponse>>;
        places::selection_range(lsp::SelectionRangeParams) -> Result<Option<Vec<lsp::SelectionRange>>>;
        ranges::document_link(lsp::DocumentLinkParams) -> Result<Option<Vec<lsp::DocumentLink>>>;
        ranges::document_color(lsp::DocumentColorParams) -> Result<Vec<lsp::ColorInformation>>;
        ranges::color_presentation(lsp::ColorPresentationParams) -> Result<Vec<lsp::ColorPresentation>>;
        ranges::range_formatting(lsp::DocumentRangeFormattingParams) -> Result<Option<Vec<lsp::TextEdit>>>;
        places::on_type_formatting(lsp::DocumentOnTypeFormattingParams) -> Result<Option<Vec<lsp::TextEdit>>>;
        workspace::execute_command(lsp::ExecuteCommandParams) -> Result<Option<lsp::LSPAny>>;
    }
}

fn place(position: lsp::Position) -> Place {
    Place {
        line: position.line,
        column: position.character,
    }
}

fn places(range: lsp::Range) -> [Place; 2] {
    [place(range.start), place(range.end)]
}
