//! From the protocol's messages to the features, and their answers back.
//!
//! Every handler takes what it needs from the session before it waits for anything: handlers run beside each other,
//! and only so does the state change in the order of the messages. What takes time runs on workers over a snapshot.

mod window;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use ide::{completion, fix, format, hints, lens, live, navigate, outline, rename, signature};
use protocol::View;
use syntax::span::Span;
use tokio::sync::Semaphore;
use tower_lsp::jsonrpc::{Error, ErrorCode, Result};
use tower_lsp::ls_types as lsp;
use tower_lsp::{Client, LanguageServer};

use crate::documents::{Change, Open, Snapshot};
use crate::encoding::{Encoding, Place};
use crate::outgoing;
use crate::preview;
use crate::session::{Editor, Session};
use crate::tokens;
use crate::workspace;

/// The most symbols that a search in the workspace gives.
const MOST_SYMBOLS: usize = 1000;
/// How long windows may take to hear that they are to close when the editor says goodbye.
const PATIENCE_FAREWELL: Duration = Duration::from_millis(500);
/// The notification by which an editor tells where its cursor stands, which the protocol has none for: its params are
/// those of a hover.
pub(crate) const CURSOR: &str = "geotrace/cursor";
/// How many features are at work at once: more would only share the processors, and each needs its memory.
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

/// The span between two places, in the order of the text.
fn span(snapshot: &Snapshot, range: lsp::Range) -> Span {
    let [start, end] = places(range).map(|place| snapshot.offset(place));
    Span::new(start.min(end), start.max(end))
}

fn failed(code: ErrorCode, message: impl Into<String>) -> Error {
    Error {
        code,
        message: message.into().into(),
        data: None,
    }
}

/// What is wrong with a document, at a revision of it.
struct Findings {
    revision: u64,
    version: i32,
    found: Vec<lsp::Diagnostic>,
}

impl Findings {
    fn of(open: &Open, uri: &lsp::Uri) -> Self {
        Self {
            revision: open.revision,
            version: open.version,
            found: outgoing::diagnostics(open, uri),
        }
    }
}

fn not_open(uri: &lsp::Uri) -> Error {
    let message = format!("the document {} is not open", uri.as_str());
    failed(ErrorCode::InvalidParams, message)
}

/// The protocol's code for a request that failed for a reason that the user should read.
const REQUEST_FAILED: i64 = -32803;

impl Backend {
    pub(crate) fn new(client: Client, end: Arc<crate::End>, session: Arc<Mutex<Session>>) -> Self {
        Self {
            client,
            session,
            publishing: Arc::default(),
            places: Arc::new(Semaphore::new(MOST_AT_WORK)),
            end,
        }
    }

    fn session(&self) -> MutexGuard<'_, Session> {
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The document as it is now.
    fn snapshot(&self, uri: &lsp::Uri) -> Result<Arc<Snapshot>> {
        let session = self.session();
        let open = session.documents.get(uri.as_str());
        open.map(Open::snapshot).ok_or_else(|| not_open(uri))
    }

    /// Runs a feature on a worker, over a document as it is now. A panic in it is an error of this request alone.
    async fn ask<T: Send + 'static>(
        &self,
        uri: &lsp::Uri,
        feature: impl FnOnce(&Snapshot) -> T + Send + 'static,
    ) -> Result<T> {
        let snapshot = self.snapshot(uri)?;
        self.work(move || feature(&snapshot)).await
    }

    /// Runs something on a worker when there is a place. A request that is cancelled while it waits is never begun.
    async fn work<T: Send + 'static>(
        &self,
        feature: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T> {
        let place = self.places.clone().acquire_owned().await;
        let worker = Worker(tokio::task::spawn_blocking(move || {
            // Held until the work is done, whether anyone waits for it or not.
            let _place = place;
            feature()
        }));
        worker.result().await
    }

    /// Sends what was wrong with a document at a revision, unless it has changed meanwhile.
    async fn publish(&self, uri: lsp::Uri, findings: Findings) {
        let Findings {
            revision,
            version,
            found,
        } = findings;
        let _turn = self.publishing.lock().await;
        let is_current = {
            let session = self.session();
            session.documents.is_current(uri.as_str(), revision)
        };
        if is_current {
            self.client
                .publish_diagnostics(uri, found, Some(version))
                .await;
        }
    }

    /// Tells the user that a document is too large to be read.
    async fn refuse(&self, uri: &lsp::Uri, error: syntax::document::EditError) {
        let message = format!("{}: {error}", uri.as_str());
        self.client
            .show_message(lsp::MessageType::ERROR, message)
            .await;
    }

    /// The cursor has moved: [`CURSOR`].
    pub(crate) async fn cursor(&self, params: lsp::TextDocumentPositionParams) {
        self.point_at(&params);
    }

    /// Tells a document's window where the cursor stands.
    fn point_at(&self, at: &lsp::TextDocumentPositionParams) {
        let uri = at.text_document.uri.as_str();
        let mut session = self.session();
        if !session.previews.has(uri) {
            return;
        }
        let Some(snapshot) = session.documents.get(uri).map(Open::snapshot) else {
            return;
        };
        let offset = snapshot.offset(place(at.position));
        session.previews.cursor(uri, snapshot.version, offset);
    }

    /// Takes new settings, and has the editor ask again for what they change.
    fn set(&self, json: &serde_json::Value) {
        set(&self.session, &self.client, json);
    }
}

fn set(session: &Arc<Mutex<Session>>, client: &Client, json: &serde_json::Value) {
    let (before, after, editor) = {
        let mut session = session.lock().unwrap_or_else(PoisonError::into_inner);
        let before = session.settings;
        session.settings = before.with(json);
        (before, session.settings, session.editor)
    };
    let client = client.clone();
    if after.preview_on_open && !before.preview_on_open {
        let open = {
            let session = session.lock().unwrap_or_else(PoisonError::into_inner);
            session.documents.snapshots()
        };
        let uris = open.iter().filter_map(|snapshot| snapshot.uri.parse().ok());
        for uri in uris.filter(is_previewed) {
            window::open(session, &client, &uri, None);
        }
    }
    let hints = (before.splits, before.values) != (after.splits, after.values);
    let lenses = before.lenses != after.lenses;
    // Requests to the editor are never waited for within a handler.
    tokio::spawn(async move {
        if hints && editor.refreshes_hints {
            let _ = client.inlay_hint_refresh().await;
        }
        if lenses && editor.refreshes_lenses {
            let _ = client.code_lens_refresh().await;
        }
    });
}

/// Whether a document's preview opens by itself: not that of an older version which an editor shows beside it.
fn is_previewed(uri: &lsp::Uri) -> bool {
    ["file:", "untitled:"]
        .iter()
        .any(|scheme| uri.as_str().starts_with(scheme))
}

/// A task on a worker that is given up when nobody waits for it any more.
struct Worker<T>(tokio::task::JoinHandle<T>);

impl<T> Worker<T> {
    async fn result(mut self) -> Result<T> {
        (&mut self.0).await.map_err(|_| {
            failed(
                ErrorCode::InternalError,
                "this request ran into a fault of the server; others go on",
            )
        })
    }
}

impl<T> Drop for Worker<T> {
    fn drop(&mut self) {
        self.0.abort();
    }
}

/// A progress bar that the editor has offered with a request.
struct Progress<'c> {
    client: &'c Client,
    token: lsp::ProgressToken,
}

impl<'c> Progress<'c> {
    async fn begin(client: &'c Client, token: lsp::ProgressToken, title: &str) -> Self {
        let progress = Self { client, token };
        let begin = lsp::WorkDoneProgressBegin {
            title: title.to_owned(),
            cancellable: Some(true),
            ..lsp::WorkDoneProgressBegin::default()
        };
        progress.send(lsp::WorkDoneProgress::Begin(begin)).await;
        progress
    }

    async fn end(self) {
        let end = lsp::WorkDoneProgress::End(lsp::WorkDoneProgressEnd::default());
        self.send(end).await;
    }

    async fn send(&self, value: lsp::WorkDoneProgress) {
        let params = lsp::ProgressParams {
            token: self.token.clone(),
            value: lsp::ProgressParamsValue::WorkDone(value),
        };
        self.client
            .send_notification::<lsp::notification::Progress>(params)
            .await;
    }
}

/// What the editor offers.
fn editor(capabilities: &lsp::ClientCapabilities) -> Editor {
    let text = capabilities.text_document.as_ref();
    let workspace = capabilities.workspace.as_ref();
    let markdown = |formats: Option<&Vec<lsp::MarkupKind>>| {
        formats.is_some_and(|formats| formats.contains(&lsp::MarkupKind::Markdown))
    };
    let completion = text
        .and_then(|text| text.completion.as_ref())
        .and_then(|completion| completion.completion_item.as_ref());
    let hover = text.and_then(|text| text.hover.as_ref());
    let symbols = text.and_then(|text| text.document_symbol.as_ref());
    let edit = workspace.and_then(|workspace| workspace.workspace_edit.as_ref());
    let hints = workspace.and_then(|workspace| workspace.inlay_hint.as_ref());
    let lenses = workspace.and_then(|workspace| workspace.code_lens.as_ref());
    let window = capabilities.window.as_ref();
    let experimental = capabilities.experimental.as_ref();
    Editor {
        markdown: markdown(hover.and_then(|hover| hover.content_format.as_ref())),
        documentation: completion
            .and_then(|c| c.documentation_format.as_ref())
            .map(|formats| formats.contains(&lsp::MarkupKind::Markdown)),
        snippets: completion.and_then(|c| c.snippet_support).unwrap_or(false),
        versioned_edits: edit.and_then(|edit| edit.document_changes).unwrap_or(false),
        configuration: workspace.and_then(|w| w.configuration).unwrap_or(false),
        hierarchical_symbols: symbols
            .and_then(|symbols| symbols.hierarchical_document_symbol_support)
            .unwrap_or(false),
        refreshes_hints: hints.and_then(|h| h.refresh_support).unwrap_or(false),
        refreshes_lenses: lenses.and_then(|l| l.refresh_support).unwrap_or(false),
        shows_documents: window
            .and_then(|window| window.show_document.as_ref())
            .is_some_and(|show| show.support),
        applies_edits: workspace.and_then(|w| w.apply_edit).unwrap_or(false),
        hears_shown: experimental
            .and_then(|own| own.get("geotrace")?.get("shown")?.as_bool())
            .unwrap_or(false),
    }
}

/// The encoding of positions: of those that the editor offers, the one that it prefers. It names that first.
fn encoding(capabilities: &lsp::ClientCapabilities) -> Encoding {
    let offered = capabilities
        .general
        .as_ref()
        .and_then(|general| general.position_encodings.as_ref());
    let known = |kind: &lsp::PositionEncodingKind| match kind.as_str() {
        "utf-8" => Some(Encoding::Utf8),
        "utf-16" => Some(Encoding::Utf16),
        "utf-32" => Some(Encoding::Utf32),
        _ => None,
    };
    offered
        .and_then(|offered| offered.iter().find_map(known))
        .unwrap_or_default()
}

impl LanguageServer for Backend {
    async fn initialize(&self, params: lsp::InitializeParams) -> Result<lsp::InitializeResult> {
        let encoding = encoding(&params.capabilities);
        {
            let mut session = self.session();
            session.editor = editor(&params.capabilities);
            session.documents.encoding = encoding;
            if let Some(options) = &params.initialization_options {
                session.settings = session.settings.with(options);
            }
            let folders = params.workspace_folders.iter().flatten();
            session.folders = folders
                .filter_map(|folder| folder.uri.to_file_path())
                .map(|path| path.into_owned())
                .collect();
        }
        if let Some(process) = params.process_id {
            let end = self.end.clone();
            crate::parent::when_gone(process, move || end.now());
        }
        Ok(lsp::InitializeResult {
            capabilities: outgoing::capabilities(encoding),
            server_info: Some(lsp::ServerInfo {
                name: "geotrace".to_owned(),
                version: Some(env!("CARGO_PKG_VERSION").to_owned()),
            }),
            ..lsp::InitializeResult::default()
        })
    }

    async fn initialized(&self, _: lsp::InitializedParams) {
        if self.session().editor.configuration {
            let (client, session) = (self.client.clone(), self.session.clone());
            tokio::spawn(async move {
                let item = lsp::ConfigurationItem {
                    scope_uri: None,
                    section: Some("geotrace".to_owned()),
                };
                if let Ok(answers) = client.configuration(vec![item]).await
                    && let Some(settings) = answers.first()
                {
                    set(&session, &client, settings);
                }
            });
        }
    }

    async fn shutdown(&self) -> Result<()> {
        self.end.was_asked_for();
        window::close_all(&self.session, PATIENCE_FAREWELL).await;
        Ok(())
    }

    async fn did_open(&self, params: lsp::DidOpenTextDocumentParams) {
        let document = params.text_document;
        let uri = document.uri;
        let (opened, preview) = {
            let mut session = self.session();
            session.pulled.remove(uri.as_str());
            session.tokens.remove(uri.as_str());
            let documents = &mut session.documents;
            let opened = documents
                .open(uri.as_str(), document.version, &document.text)
                .map(|open| Findings::of(open, &uri));
            session.preview(uri.as_str());
            (opened, session.settings.preview_on_open)
        };
        if preview && opened.is_ok() && is_previewed(&uri) {
            window::open(&self.session, &self.client, &uri, None);
        }
        match opened {
            Ok(findings) => self.publish(uri, findings).await,
            Err(error) => self.refuse(&uri, error).await,
        }
    }

    async fn did_change(&self, params: lsp::DidChangeTextDocumentParams) {
        let uri = params.text_document.uri;
        let changes = params.content_changes.into_iter();
        let changes = changes.map(|change| Change {
            range: change.range.map(places),
            text: change.text,
        });
        let version = params.text_document.version;
        let (changed, pulled) = {
            let mut session = self.session();
            let pulled = session.pulled.contains(uri.as_str());
            let changed = session
                .documents
                .change(uri.as_str(), version, changes.collect());
            let changed = changed.map(|open| {
                // Who asks for what is wrong is not told unasked.
                open.map(|open| (!pulled).then(|| Findings::of(open, &uri)))
            });
            session.preview(uri.as_str());
            (changed, pulled)
        };
        match changed {
            Some(Ok(Some(findings))) if !pulled => self.publish(uri, findings).await,
            Some(Err(error)) => self.refuse(&uri, error).await,
            _ => {}
        }
    }

    async fn did_close(&self, params: lsp::DidCloseTextDocumentParams) {
        let uri = params.text_document.uri;
        {
            let mut session = self.session();
            session.documents.close(uri.as_str());
            session.previews.close(uri.as_str());
            session.tokens.remove(uri.as_str());
            session.pulled.remove(uri.as_str());
        }
        let _turn = self.publishing.lock().await;
        self.client.publish_diagnostics(uri, Vec::new(), None).await;
    }

    async fn did_change_configuration(&self, params: lsp::DidChangeConfigurationParams) {
        self.set(&params.settings);
    }

    async fn did_change_workspace_folders(&self, params: lsp::DidChangeWorkspaceFoldersParams) {
        let path =
            |folder: &lsp::WorkspaceFolder| folder.uri.to_file_path().map(|p| p.into_owned());
        let mut session = self.session();
        let removed: Vec<_> = params.event.removed.iter().filter_map(path).collect();
        session.folders.retain(|folder| !removed.contains(folder));
        session
            .folders
            .extend(params.event.added.iter().filter_map(path));
    }

    async fn diagnostic(
        &self,
        params: lsp::DocumentDiagnosticParams,
    ) -> Result<lsp::DocumentDiagnosticReportResult> {
        let uri = params.text_document.uri;
        let first = self.session().pulled.insert(uri.as_str().to_owned());
        if first {
            // What was sent unasked is taken back: else the editor would show everything twice.
            let (client, uri) = (self.client.clone(), uri.clone());
            let publishing = self.publishing.clone();
            tokio::spawn(async move {
                let _turn = publishing.lock().await;
                client.publish_diagnostics(uri, Vec::new(), None).await;
            });
        }
        let session = self.session();
        let Some(open) = session.documents.get(uri.as_str()) else {
            return Err(not_open(&uri));
        };
        let name = open.revision.to_string();
        let report = if params.previous_result_id.as_ref() == Some(&name) {
            lsp::DocumentDiagnosticReport::Unchanged(
                lsp::RelatedUnchangedDocumentDiagnosticReport {
                    related_documents: None,
                    unchanged_document_diagnostic_report: lsp::UnchangedDocumentDiagnosticReport {
                        result_id: name,
                    },
                },
            )
        } else {
            lsp::DocumentDiagnosticReport::Full(lsp::RelatedFullDocumentDiagnosticReport {
                related_documents: None,
                full_document_diagnostic_report: lsp::FullDocumentDiagnosticReport {
                    result_id: Some(name),
                    items: outgoing::diagnostics(open, &uri),
                },
            })
        };
        Ok(lsp::DocumentDiagnosticReportResult::Report(report))
    }

    async fn hover(&self, params: lsp::HoverParams) -> Result<Option<lsp::Hover>> {
        let at = params.text_document_position_params;
        let markdown = self.session().editor.markdown;
        self.ask(&at.text_document.uri, move |snapshot| {
            outgoing::hover(snapshot, snapshot.offset(place(at.position)), markdown)
        })
        .await
    }

    async fn completion(
        &self,
        params: lsp::CompletionParams,
    ) -> Result<Option<lsp::CompletionResponse>> {
        let at = params.text_document_position;
        let snippets = self.session().editor.snippets;
        self.ask(&at.text_document.uri, move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let (range, list) = completion::completions(snapshot.reading(), offset, snippets);
            let items = list
                .into_iter()
                .map(|completion| outgoing::completion(snapshot, range, completion));
            Some(lsp::CompletionResponse::Array(items.collect()))
        })
        .await
    }

    async fn completion_resolve(
        &self,
        mut item: lsp::CompletionItem,
    ) -> Result<lsp::CompletionItem> {
        let data = item.data.clone().unwrap_or_default();
        let uri = data.get("uri").and_then(serde_json::Value::as_str);
        let offset = data.get("offset").and_then(serde_json::Value::as_u64);
        let (Some(uri), Some(offset)) = (uri, offset) else {
            return Ok(item);
        };
        let format = self.session().editor.documentation;
        // A document that has been closed meanwhile has nothing more to tell.
        let Some(snapshot) = self.session().documents.get(uri).map(Open::snapshot) else {
            return Ok(item);
        };
        let label = item.label.clone();
        let described = self.work(move || {
            let offset = u32::try_from(offset)
                .unwrap_or(u32::MAX)
                .min(snapshot.reading().len());
            completion::describe(snapshot.reading(), offset, &label)
        });
        if let Some(description) = described.await? {
            item.documentation = Some(outgoing::documentation(&description, format));
        }
        Ok(item)
    }

    async fn signature_help(
        &self,
        params: lsp::SignatureHelpParams,
    ) -> Result<Option<lsp::SignatureHelp>> {
        let at = params.text_document_position_params;
        self.ask(&at.text_document.uri, move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let found = signature::signature(snapshot.reading(), offset)?;
            Some(outgoing::signature(&found))
        })
        .await
    }

    async fn goto_definition(
        &self,
        params: lsp::GotoDefinitionParams,
    ) -> Result<Option<lsp::GotoDefinitionResponse>> {
        let at = params.text_document_position_params;
        let uri = at.text_document.uri;
        self.ask(&uri.clone(), move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let (_, declared) = navigate::definition(snapshot.reading(), offset)?;
            let location = lsp::Location::new(uri, outgoing::range(snapshot, declared));
            Some(lsp::GotoDefinitionResponse::Scalar(location))
        })
        .await
    }

    async fn references(&self, params: lsp::ReferenceParams) -> Result<Option<Vec<lsp::Location>>> {
        let at = params.text_document_position;
        let uri = at.text_document.uri;
        let declaration = params.context.include_declaration;
        self.ask(&uri.clone(), move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let found = navigate::occurrences(snapshot.reading(), offset).into_iter();
            let wanted = found.filter(|occurrence| declaration || !occurrence.introduces);
            let locations = wanted.map(|occurrence| {
                lsp::Location::new(uri.clone(), outgoing::range(snapshot, occurrence.span))
            });
            Some(locations.collect())
        })
        .await
    }

    async fn document_highlight(
        &self,
        params: lsp::DocumentHighlightParams,
    ) -> Result<Option<Vec<lsp::DocumentHighlight>>> {
        let at = params.text_document_position_params;
        // Editors ask for this where the cursor stands.
        self.point_at(&at);
        self.ask(&at.text_document.uri, move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let found = navigate::occurrences(snapshot.reading(), offset).into_iter();
            let highlights = found.map(|occurrence| lsp::DocumentHighlight {
                range: outgoing::range(snapshot, occurrence.span),
                kind: Some(if occurrence.introduces {
                    lsp::DocumentHighlightKind::WRITE
                } else {
                    lsp::DocumentHighlightKind::READ
                }),
            });
            Some(highlights.collect())
        })
        .await
    }

    async fn prepare_rename(
        &self,
        params: lsp::TextDocumentPositionParams,
    ) -> Result<Option<lsp::PrepareRenameResponse>> {
        let uri = params.text_document.uri;
        self.ask(&uri, move |snapshot| {
            let offset = snapshot.offset(place(params.position));
            let (span, name) = rename::prepare(snapshot.reading(), offset).map_err(|error| {
                failed(ErrorCode::ServerError(REQUEST_FAILED), error.to_string())
            })?;
            Ok(Some(lsp::PrepareRenameResponse::RangeWithPlaceholder {
                range: outgoing::range(snapshot, span),
                placeholder: name,
            }))
        })
        .await?
    }

    async fn rename(&self, params: lsp::RenameParams) -> Result<Option<lsp::WorkspaceEdit>> {
        let at = params.text_document_position;
        let uri = at.text_document.uri;
        let versioned = self.session().editor.versioned_edits;
        self.ask(&uri.clone(), move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let edits =
                rename::rename(snapshot.reading(), offset, &params.new_name).map_err(|error| {
                    failed(ErrorCode::ServerError(REQUEST_FAILED), error.to_string())
                })?;
            Ok(Some(outgoing::workspace_edit(
                snapshot, &uri, &edits, versioned,
            )))
        })
        .await?
    }

    async fn document_symbol(
        &self,
        params: lsp::DocumentSymbolParams,
    ) -> Result<Option<lsp::DocumentSymbolResponse>> {
        let uri = params.text_document.uri;
        let hierarchical = self.session().editor.hierarchical_symbols;
        self.ask(&uri.clone(), move |snapshot| {
            let entries = outline::outline(snapshot.reading());
            let entries = entries.iter();
            Some(if hierarchical {
                let symbols = entries.map(|entry| outgoing::document_symbol(snapshot, entry));
                lsp::DocumentSymbolResponse::Nested(symbols.collect())
            } else {
                let symbols =
                    entries.map(|entry| outgoing::symbol_information(snapshot, &uri, entry));
                lsp::DocumentSymbolResponse::Flat(symbols.collect())
            })
        })
        .await
    }

    async fn symbol(
        &self,
        params: lsp::WorkspaceSymbolParams,
    ) -> Result<Option<lsp::WorkspaceSymbolResponse>> {
        let (open, folders, encoding) = {
            let session = self.session();
            let documents = &session.documents;
            (
                documents.snapshots(),
                session.folders.clone(),
                documents.encoding,
            )
        };
        let query = params.query;
        let progress = match params.work_done_progress_params.work_done_token {
            Some(token) => {
                Some(Progress::begin(&self.client, token, "Reading the workspace").await)
            }
            None => None,
        };
        let searched = self.work(move || {
            let mut found = Vec::new();
            let mut names: Vec<String> = Vec::new();
            for snapshot in &open {
                names.push(snapshot.uri.clone());
                matching(snapshot, &query, &mut found);
            }
            for path in workspace::programs(&folders) {
                let Some(uri) = lsp::Uri::from_file_path(&path) else {
                    continue;
                };
                if found.len() >= MOST_SYMBOLS || names.iter().any(|name| name == uri.as_str()) {
                    continue;
                }
                if let Ok(text) = std::fs::read_to_string(&path) {
                    let snapshot = Snapshot::new(uri.as_str(), 0, text, encoding);
                    matching(&snapshot, &query, &mut found);
                }
            }
            found.truncate(MOST_SYMBOLS);
            found
        });
        let found = searched.await;
        if let Some(progress) = progress {
            progress.end().await;
        }
        Ok(Some(lsp::WorkspaceSymbolResponse::Flat(found?)))
    }

    async fn folding_range(
        &self,
        params: lsp::FoldingRangeParams,
    ) -> Result<Option<Vec<lsp::FoldingRange>>> {
        self.ask(&params.text_document.uri, |snapshot| {
            let folds = outline::folds(snapshot.reading());
            Some(
                folds
                    .iter()
                    .map(|fold| outgoing::fold(snapshot, fold))
                    .collect(),
            )
        })
        .await
    }

    async fn selection_range(
        &self,
        params: lsp::SelectionRangeParams,
    ) -> Result<Option<Vec<lsp::SelectionRange>>> {
        self.ask(&params.text_document.uri, move |snapshot| {
            let ranges = params.positions.iter().map(|position| {
                let offset = snapshot.offset(place(*position));
                let chain = outline::selection(snapshot.reading(), offset);
                outgoing::selection(snapshot, &chain)
            });
            Some(ranges.collect())
        })
        .await
    }

    async fn semantic_tokens_full(
        &self,
        params: lsp::SemanticTokensParams,
    ) -> Result<Option<lsp::SemanticTokensResult>> {
        let uri = params.text_document.uri;
        let encoded = self
            .ask(&uri, |snapshot| tokens::encode(snapshot, None))
            .await?;
        let data = outgoing::tokens(&encoded);
        let mut session = self.session();
        let name = session.fresh_name();
        session
            .tokens
            .insert(uri.as_str().to_owned(), (name.clone(), encoded));
        Ok(Some(lsp::SemanticTokensResult::Tokens(
            lsp::SemanticTokens {
                result_id: Some(name),
                data,
            },
        )))
    }

    async fn semantic_tokens_full_delta(
        &self,
        params: lsp::SemanticTokensDeltaParams,
    ) -> Result<Option<lsp::SemanticTokensFullDeltaResult>> {
        let uri = params.text_document.uri;
        let encoded = self
            .ask(&uri, |snapshot| tokens::encode(snapshot, None))
            .await?;
        let mut session = self.session();
        let name = session.fresh_name();
        let key = uri.as_str().to_owned();
        let old = session.tokens.insert(key, (name.clone(), encoded.clone()));
        let Some((_, old)) = old.filter(|(known, _)| *known == params.previous_result_id) else {
            return Ok(Some(lsp::SemanticTokensFullDeltaResult::Tokens(
                lsp::SemanticTokens {
                    result_id: Some(name),
                    data: outgoing::tokens(&encoded),
                },
            )));
        };
        let edits = tokens::difference(&old, &encoded).into_iter();
        let edits = edits.map(|(start, gone, come)| lsp::SemanticTokensEdit {
            start: 5 * start as u32,
            delete_count: 5 * gone as u32,
            data: Some(outgoing::tokens(&come)),
        });
        Ok(Some(lsp::SemanticTokensFullDeltaResult::TokensDelta(
            lsp::SemanticTokensDelta {
                result_id: Some(name),
                edits: edits.collect(),
            },
        )))
    }

    async fn semantic_tokens_range(
        &self,
        params: lsp::SemanticTokensRangeParams,
    ) -> Result<Option<lsp::SemanticTokensRangeResult>> {
        let encoded = self
            .ask(&params.text_document.uri, move |snapshot| {
                tokens::encode(snapshot, Some(places(params.range)))
            })
            .await?;
        Ok(Some(lsp::SemanticTokensRangeResult::Tokens(
            lsp::SemanticTokens {
                result_id: None,
                data: outgoing::tokens(&encoded),
            },
        )))
    }

    async fn inlay_hint(
        &self,
        params: lsp::InlayHintParams,
    ) -> Result<Option<Vec<lsp::InlayHint>>> {
        let (settings, values) = {
            let session = self.session();
            let live = session.previews.live(params.text_document.uri.as_str());
            (session.settings, live.cloned())
        };
        self.ask(&params.text_document.uri, move |snapshot| {
            let range = span(snapshot, params.range);
            let mut found = hints::hints(snapshot.reading(), range);
            if let Some(values) = values {
                found.extend(live::live(snapshot.reading(), range, &values));
                found.sort_by_key(|hint| hint.offset);
            }
            // Values stand apart from the text, splits within it.
            let wanted = found.iter().filter(|hint| {
                if hint.apart {
                    settings.values
                } else {
                    settings.splits
                }
            });
            Some(wanted.map(|hint| outgoing::hint(snapshot, hint)).collect())
        })
        .await
    }

    async fn code_lens(&self, params: lsp::CodeLensParams) -> Result<Option<Vec<lsp::CodeLens>>> {
        if !self.session().settings.lenses {
            return Ok(Some(Vec::new()));
        }
        self.ask(&params.text_document.uri, |snapshot| {
            let lenses = lens::lenses(snapshot.reading());
            Some(
                lenses
                    .iter()
                    .map(|lens| outgoing::lens(snapshot, lens))
                    .collect(),
            )
        })
        .await
    }

    async fn code_action(
        &self,
        params: lsp::CodeActionParams,
    ) -> Result<Option<lsp::CodeActionResponse>> {
        let versioned = self.session().editor.versioned_edits;
        let uri = params.text_document.uri;
        let wanted = params.context.only.is_none_or(|kinds| {
            // A kind holds those below it: everything below the empty kind.
            let quickfix = lsp::CodeActionKind::QUICKFIX;
            kinds
                .iter()
                .any(|kind| kind.as_str().is_empty() || *kind == quickfix)
        });
        if !wanted {
            return Ok(Some(Vec::new()));
        }
        self.ask(&uri.clone(), move |snapshot| {
            let fixes = fix::fixes(snapshot.reading(), span(snapshot, params.range));
            let actions = fixes
                .iter()
                .map(|fix| outgoing::action(snapshot, &uri, fix, versioned));
            Some(actions.collect())
        })
        .await
    }

    async fn formatting(
        &self,
        params: lsp::DocumentFormattingParams,
    ) -> Result<Option<Vec<lsp::TextEdit>>> {
        self.ask(&params.text_document.uri, |snapshot| {
            let edits = format::format(snapshot.reading(), None);
            Some(outgoing::text_edits(snapshot, &edits))
        })
        .await
    }

    async fn range_formatting(
        &self,
        params: lsp::DocumentRangeFormattingParams,
    ) -> Result<Option<Vec<lsp::TextEdit>>> {
        self.ask(&params.text_document.uri, move |snapshot| {
            let range = span(snapshot, params.range);
            let edits = format::format(snapshot.reading(), Some(range));
            Some(outgoing::text_edits(snapshot, &edits))
        })
        .await
    }

    async fn on_type_formatting(
        &self,
        params: lsp::DocumentOnTypeFormattingParams,
    ) -> Result<Option<Vec<lsp::TextEdit>>> {
        let at = params.text_document_position;
        self.ask(&at.text_document.uri, move |snapshot| {
            // The declaration that the `;` before the cursor has ended.
            let offset = snapshot.offset(place(at.position)).saturating_sub(1);
            let reading = snapshot.reading();
            let item = reading.item_at(offset)?;
            let edits = format::format(reading, Some(item.span));
            Some(outgoing::text_edits(snapshot, &edits))
        })
        .await
    }

    async fn execute_command(
        &self,
        params: lsp::ExecuteCommandParams,
    ) -> Result<Option<lsp::LSPAny>> {
        if params.command != preview::COMMAND {
            let message = format!("there is no command {}", params.command);
            return Err(failed(ErrorCode::InvalidParams, message));
        }
        let mut arguments = params.arguments.into_iter();
        let Some(lsp::LSPAny::String(uri)) = arguments.next() else {
            let message = format!("{} needs the URI of a document", preview::COMMAND);
            return Err(failed(ErrorCode::InvalidParams, message));
        };
        let view = arguments.next().unwrap_or_default();
        let text = |key: &str| view.get(key).and_then(serde_json::Value::as_str);
        let view = match (text("view"), text("surface")) {
            (Some("geodesic"), Some(surface)) => Some(View::Geodesic {
                surface: surface.to_owned(),
            }),
            (Some("3d"), _) => Some(View::Space),
            _ => None,
        };
        let Ok(uri) = uri.parse::<lsp::Uri>() else {
            let message = format!("{uri} is not the URI of a document");
            return Err(failed(ErrorCode::InvalidParams, message));
        };
        window::open(&self.session, &self.client, &uri, view);
        Ok(None)
    }
}

/// The symbols of a document whose names hold the letters of the query in their order.
fn matching(snapshot: &Snapshot, query: &str, found: &mut Vec<lsp::SymbolInformation>) {
    let Ok(uri) = snapshot.uri.parse::<lsp::Uri>() else {
        return;
    };
    let fits = |name: &str| {
        let mut letters = name.chars();
        query
            .chars()
            .all(|wanted| letters.any(|letter| letter.eq_ignore_ascii_case(&wanted)))
    };
    let entries = outline::outline(snapshot.reading());
    let entries = entries.iter().filter(|entry| fits(&entry.name));
    found.extend(entries.map(|entry| outgoing::symbol_information(snapshot, &uri, entry)));
}
