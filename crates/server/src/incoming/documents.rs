//! Documents are opened, changed and closed; their diagnostics are pushed or pulled.

use std::sync::Arc;

use serde::Serialize;
use tower_lsp::jsonrpc::{ErrorCode, Result};
use tower_lsp::ls_types as lsp;
use tower_lsp::ls_types::notification::Notification as _;

use super::work::{failed, not_open};
use super::{Backend, places, window};
use crate::documents::{ContentChange, Open, Snapshot};
use crate::raw_responses::{Answer, RawSender, answer, notification};
use crate::tasks;
use crate::to_lsp;

pub(super) async fn did_open(server: &Backend, params: lsp::DidOpenTextDocumentParams) {
    let document = params.text_document;
    let uri = document.uri;
    let (opened, opens) = {
        let mut session = server.session();
        session.pulled.remove(uri.as_str());
        session.tokens.remove(uri.as_str());
        session.keep_text(uri.as_str());
        let related = session.editor.related_places;
        let documents = &mut session.documents;
        let opened = documents
            .open(
                uri.as_str(),
                &document.language_id,
                document.version,
                &document.text,
            )
            .map(|open| Findings::of(open, &uri, related));
        session.preview_text(uri.as_str());
        // A document that an editor reloads already has its window, which stays where it is.
        let opens = session.settings.preview_on_open && !session.previews.has(uri.as_str());
        (opened, opens)
    };
    if opens && opened.is_ok() && is_previewed(&uri) {
        window::open(&server.session, &server.client, &uri, None);
    }
    match opened {
        Ok(findings) => server.publish(uri, findings).await,
        Err(error) => server.refuse(&uri, error).await,
    }
}

pub(super) async fn did_change(server: &Backend, params: lsp::DidChangeTextDocumentParams) {
    let uri = params.text_document.uri;
    let changes = params.content_changes.into_iter();
    let changes = changes.map(|change| ContentChange {
        range: change.range.map(places),
        text: change.text,
    });
    let version = params.text_document.version;
    let changed = {
        let mut session = server.session();
        let pulled = session.pulled.contains(uri.as_str());
        let previewed = session.previews.has(uri.as_str());
        let related = session.editor.related_places;
        let changed = session
            .documents
            .change(uri.as_str(), version, changes.collect(), previewed);
        let changed = changed.map(|open| {
            // Nothing is pushed to an editor that pulls diagnostics.
            open.map(|open| (!pulled).then(|| Findings::of(open, &uri, related)))
        });
        session.preview_edit(uri.as_str());
        changed
    };
    match changed {
        Some(Ok(Some(findings))) => server.publish(uri, findings).await,
        Some(Err(error)) => server.refuse(&uri, error).await,
        _ => {}
    }
}

pub(super) async fn did_close(server: &Backend, params: lsp::DidCloseTextDocumentParams) {
    let uri = params.text_document.uri;
    let left = {
        let mut session = server.session();
        session.keep_text(uri.as_str());
        session.documents.close(uri.as_str());
        session.cursors.remove(uri.as_str());
        session.tokens.remove(uri.as_str());
        session.pulled.remove(uri.as_str());
        session.previews.leave(uri.as_str())
    };
    if let Some(left) = left {
        window::close_later(&server.session, &uri, left);
    }
    let _turn = server.publishing.lock().await;
    push(&server.raw_sender, &uri, &[], None).await;
}

pub(super) async fn diagnostic(
    server: &Backend,
    params: lsp::DocumentDiagnosticParams,
) -> Result<Answer> {
    let uri = params.text_document.uri;
    let first = {
        let mut session = server.session();
        if session.documents.get(uri.as_str()).is_none() {
            return Err(not_open(&uri));
        }
        session.pulled.insert(uri.as_str().to_owned())
    };
    if first {
        // Diagnostics that were pushed are withdrawn: otherwise the editor would show them twice.
        let (raw_sender, uri) = (server.raw_sender.clone(), uri.clone());
        let publishing = server.publishing.clone();
        tasks::spawn(async move {
            let _turn = publishing.lock().await;
            push(&raw_sender, &uri, &[], None).await;
        });
    }
    let (revision, snapshot, known, related) = {
        let session = server.session();
        let Some(open) = session.documents.get(uri.as_str()) else {
            return Err(not_open(&uri));
        };
        let (found, may_grow) = open.findings();
        let known = (!may_grow).then_some(found);
        let related = session.editor.related_places;
        (open.revision, open.snapshot(), known, related)
    };
    let name = revision.to_string();
    if params.previous_result_id.as_ref() == Some(&name) {
        let unchanged = lsp::UnchangedDocumentDiagnosticReport { result_id: name };
        return answer(&lsp::DocumentDiagnosticReport::Unchanged(
            lsp::RelatedUnchangedDocumentDiagnosticReport {
                related_documents: None,
                unchanged_document_diagnostic_report: unchanged,
            },
        ));
    }
    let found = match known {
        Some(found) => found,
        None => {
            let run = server.run(snapshot.clone(), |it| it.analysis().diagnostics());
            let found = run.await?;
            // An edit has ended the run.
            let session = server.session();
            if !session.documents.is_current(uri.as_str(), revision) {
                let message = "the document has changed";
                return Err(failed(ErrorCode::ContentModified, message));
            }
            found
        }
    };
    answer(&lsp::DocumentDiagnosticReport::Full(
        lsp::RelatedFullDocumentDiagnosticReport {
            related_documents: None,
            full_document_diagnostic_report: lsp::FullDocumentDiagnosticReport {
                result_id: Some(name),
                items: to_lsp::diagnostics(&*snapshot, &uri, &found, related),
            },
        },
    ))
}

/// Returns true if a document's preview opens by itself; that of an older version which an editor shows for comparison
/// does not.
pub(super) fn is_previewed(uri: &lsp::Uri) -> bool {
    ["file:", "untitled:"]
        .iter()
        .any(|scheme| uri.as_str().starts_with(scheme))
}

/// The diagnostics of a document at a revision.
struct Findings {
    revision: u64,
    version: i32,
    found: Vec<lsp::Diagnostic>,
    /// The document, if a run of it may find more.
    runs: Option<Arc<Snapshot>>,
}

impl Findings {
    fn of(open: &Open, uri: &lsp::Uri, related: bool) -> Self {
        let (found, may_grow) = open.findings();
        Self {
            revision: open.revision,
            version: open.version,
            found: to_lsp::diagnostics(open, uri, &found, related),
            runs: may_grow.then(|| open.snapshot()),
        }
    }
}

impl Backend {
    /// Sends the diagnostics of a document at a revision, unless it has changed meanwhile; then those that a run of it
    /// finds.
    async fn publish(&self, uri: lsp::Uri, findings: Findings) {
        self.publish_found(&uri, &findings).await;
        let Some(snapshot) = findings.runs.clone() else {
            return;
        };
        // End the handler, since only a few may run at once.
        let server = self.clone();
        let related = self.session().editor.related_places;
        tasks::spawn(async move {
            let place = uri.clone();
            let run = server.run(snapshot, move |snapshot| {
                let found = snapshot.analysis().diagnostics();
                to_lsp::diagnostics(snapshot, &place, &found, related)
            });
            let Ok(found) = run.await else {
                return;
            };
            if found != findings.found {
                let findings = Findings { found, ..findings };
                server.publish_found(&uri, &findings).await;
            }
        });
    }

    async fn publish_found(&self, uri: &lsp::Uri, findings: &Findings) {
        let _turn = self.publishing.lock().await;
        let is_wanted = {
            let session = self.session();
            let is_current = session
                .documents
                .is_current(uri.as_str(), findings.revision);
            is_current && !session.pulled.contains(uri.as_str())
        };
        if is_wanted {
            let version = Some(findings.version);
            push(&self.raw_sender, uri, &findings.found, version).await;
        }
    }

    /// Shows the user that a document is too large to be read.
    async fn refuse(&self, uri: &lsp::Uri, error: ide::language::EditError) {
        let message = format!("{}: {error}", uri.as_str());
        self.client
            .show_message(lsp::MessageType::ERROR, message)
            .await;
    }
}

/// Sends the diagnostics of a document to the editor. They are large, so they bypass the protocol's tree of JSON values.
async fn push(
    raw_sender: &RawSender,
    uri: &lsp::Uri,
    diagnostics: &[lsp::Diagnostic],
    version: Option<i32>,
) {
    /// [`lsp::PublishDiagnosticsParams`] without its own copies.
    #[derive(Serialize)]
    struct Params<'a> {
        uri: &'a lsp::Uri,
        diagnostics: &'a [lsp::Diagnostic],
        #[serde(skip_serializing_if = "Option::is_none")]
        version: Option<i32>,
    }
    let params = Params {
        uri,
        diagnostics,
        version,
    };
    let body = notification(lsp::notification::PublishDiagnostics::METHOD, &params);
    raw_sender.send_when_room(body).await;
}
