//! From the protocol's messages to the features, and their answers back.
//!
//! ```text
//! lifecycle   initialize, shutdown, and what both sides can do
//! documents   opened, changed, closed; what is wrong with them
//! places      requests at a place                 ─┐
//! ranges      requests for a range, or for all     ├─▶ work: on a worker, over a snapshot
//! workspace   settings, folders, all programs       ─┘
//! window      a document's preview window, from its start to its end
//! ```
//!
//! Every handler takes what it needs from the session before it waits for anything: handlers run beside each other,
//! and only so does the state change in the order of the messages. What takes time runs on workers over a snapshot.

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

/// The notification by which an editor reports the place of its cursor, which the protocol lacks: its params are those
/// of a hover.
pub(crate) const CURSOR: &str = "geotrace/cursor";
/// The number of features that run at once: more would only share the processors, and each needs its memory.
const MOST_AT_WORK: usize = 2;

/// The server as the protocol sees it.
pub(crate) struct Backend {
    client: Client,
    session: Arc<Mutex<Session>>,
    /// Diagnostics are sent one after the other, so that an older list never comes behind a newer one.
    publishing: Arc<tokio::sync::Mutex<()>>,
    /// The places for features that are at work at once.
    places: Arc<Semaphore>,
    end: Arc<crate::End>,
    /// The writer of messages that bypass the protocol.
    raw_sender: RawSender,
}

/// Adds the methods that answer with text to those of the protocol.
pub(crate) fn with_texts(builder: LspServiceBuilder<Backend>) -> LspServiceBuilder<Backend> {
    builder
        .custom_method(raw_responses::CODE_LENS, ranges::code_lens)
        .custom_method(raw_responses::COMPLETION, places::completion)
        .custom_method(raw_responses::DIAGNOSTIC, documents::diagnostic)
        .custom_method(raw_responses::DOCUMENT_SYMBOL, ranges::document_symbol)
        .custom_method(raw_responses::FOLDING_RANGE, ranges::folding_range)
        .custom_method(raw_responses::FORMATTING, ranges::formatting)
        .custom_method(raw_responses::INLAY_HINT, ranges::inlay_hint)
        .custom_method(raw_responses::REFERENCES, places::references)
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
            end,
        }
    }

    fn session(&self) -> MutexGuard<'_, Session> {
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The cursor has moved: [`CURSOR`].
    pub(crate) async fn cursor(&self, params: lsp::TextDocumentPositionParams) {
        self.point_at(&params);
    }

    /// Stores the place of the cursor in a document, and sends it to the document's window, if it has one.
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

impl LanguageServer for Backend {
    async fn initialize(&self, params: lsp::InitializeParams) -> Result<lsp::InitializeResult> {
        lifecycle::initialize(self, params).await
    }

    async fn initialized(&self, params: lsp::InitializedParams) {
        lifecycle::initialized(self, params).await
    }

    async fn shutdown(&self) -> Result<()> {
        lifecycle::shutdown(self).await
    }

    async fn did_open(&self, params: lsp::DidOpenTextDocumentParams) {
        documents::did_open(self, params).await
    }

    async fn did_change(&self, params: lsp::DidChangeTextDocumentParams) {
        documents::did_change(self, params).await
    }

    async fn did_close(&self, params: lsp::DidCloseTextDocumentParams) {
        documents::did_close(self, params).await
    }

    async fn did_change_configuration(&self, params: lsp::DidChangeConfigurationParams) {
        workspace::did_change_configuration(self, params).await
    }

    async fn did_change_workspace_folders(&self, params: lsp::DidChangeWorkspaceFoldersParams) {
        workspace::did_change_workspace_folders(self, params).await
    }

    async fn hover(&self, params: lsp::HoverParams) -> Result<Option<lsp::Hover>> {
        places::hover(self, params).await
    }

    async fn completion_resolve(&self, item: lsp::CompletionItem) -> Result<lsp::CompletionItem> {
        places::completion_resolve(self, item).await
    }

    async fn signature_help(
        &self,
        params: lsp::SignatureHelpParams,
    ) -> Result<Option<lsp::SignatureHelp>> {
        places::signature_help(self, params).await
    }

    async fn goto_definition(
        &self,
        params: lsp::GotoDefinitionParams,
    ) -> Result<Option<lsp::GotoDefinitionResponse>> {
        places::goto_definition(self, params).await
    }

    async fn document_highlight(
        &self,
        params: lsp::DocumentHighlightParams,
    ) -> Result<Option<Vec<lsp::DocumentHighlight>>> {
        places::document_highlight(self, params).await
    }

    async fn prepare_rename(
        &self,
        params: lsp::TextDocumentPositionParams,
    ) -> Result<Option<lsp::PrepareRenameResponse>> {
        places::prepare_rename(self, params).await
    }

    async fn rename(&self, params: lsp::RenameParams) -> Result<Option<lsp::WorkspaceEdit>> {
        places::rename(self, params).await
    }

    async fn selection_range(
        &self,
        params: lsp::SelectionRangeParams,
    ) -> Result<Option<Vec<lsp::SelectionRange>>> {
        places::selection_range(self, params).await
    }

    async fn code_action(
        &self,
        params: lsp::CodeActionParams,
    ) -> Result<Option<lsp::CodeActionResponse>> {
        ranges::code_action(self, params).await
    }

    async fn range_formatting(
        &self,
        params: lsp::DocumentRangeFormattingParams,
    ) -> Result<Option<Vec<lsp::TextEdit>>> {
        ranges::range_formatting(self, params).await
    }

    async fn on_type_formatting(
        &self,
        params: lsp::DocumentOnTypeFormattingParams,
    ) -> Result<Option<Vec<lsp::TextEdit>>> {
        places::on_type_formatting(self, params).await
    }

    async fn execute_command(
        &self,
        params: lsp::ExecuteCommandParams,
    ) -> Result<Option<lsp::LSPAny>> {
        workspace::execute_command(self, params).await
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
