//! Requests that do not concern a single document: settings, folders, symbols of all programs, commands.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use protocol::ViewName;
use tower_lsp::Client;
use tower_lsp::jsonrpc::{ErrorCode, Result};
use tower_lsp::ls_types as lsp;
use tower_lsp::ls_types::notification::Notification as _;

use super::documents::is_previewed;
use super::lifecycle::request_settings;
use super::work::failed;
use super::{Backend, conversion, window};
use crate::documents::Snapshot;
use crate::preview;
use crate::raw_responses::{Answer, RawSender, answer, notification};
use crate::session::Session;
use crate::tasks;
use crate::to_lsp;
use crate::workspace;

/// The maximum number of symbols that a search in the workspace returns.
const MOST_SYMBOLS: usize = 1000;

pub(super) async fn did_change_configuration(
    server: &Backend,
    params: lsp::DidChangeConfigurationParams,
) {
    let settings = params.settings.as_object();
    if settings.is_none_or(|settings| settings.is_empty()) {
        // The notification only says that the settings have changed.
        request_settings(server);
        return;
    }
    set(&server.session, &server.client, &params.settings);
}

pub(super) async fn did_change_workspace_folders(
    server: &Backend,
    params: lsp::DidChangeWorkspaceFoldersParams,
) {
    let path = |folder: &lsp::WorkspaceFolder| folder.uri.to_file_path().map(|p| p.into_owned());
    let mut session = server.session();
    let removed: Vec<_> = params.event.removed.iter().filter_map(path).collect();
    session.folders.retain(|folder| !removed.contains(folder));
    session
        .folders
        .extend(params.event.added.iter().filter_map(path));
}

pub(super) async fn symbol(server: &Backend, params: lsp::WorkspaceSymbolParams) -> Result<Answer> {
    let (open, folders, encoding, languages) = {
        let session = server.session();
        let documents = &session.documents;
        (
            documents.snapshots(),
            session.folders.clone(),
            documents.encoding,
            documents.languages.clone(),
        )
    };
    let query = params.query;
    let token = params.work_done_progress_params.work_done_token;
    let progress =
        token.map(|token| Progress::begin(&server.raw_sender, token, "Reading the workspace"));
    let searched = server.work(move || {
        let mut found = Vec::new();
        // Compared by path: a file has several URIs, such as with C: and with c%3A.
        let mut paths: Vec<PathBuf> = Vec::new();
        for snapshot in &open {
            let uri = snapshot.uri.parse::<lsp::Uri>().ok();
            paths.extend(uri.and_then(|uri| Some(uri.to_file_path()?.into_owned())));
            matching(snapshot, &query, &mut found);
        }
        for path in workspace::programs(&folders, &languages) {
            let Some(uri) = lsp::Uri::from_file_path(&path) else {
                continue;
            };
            if found.len() >= MOST_SYMBOLS || paths.contains(&path) {
                continue;
            }
            if let Some(text) = workspace::read(&path) {
                let snapshot =
                    Snapshot::new(uri.as_str(), &**languages.for_path(&path), &text, encoding);
                matching(&snapshot, &query, &mut found);
            }
        }
        found.truncate(MOST_SYMBOLS);
        answer(&found)
    });
    let found = searched.await;
    // The answer follows the end of the progress.
    drop(progress);
    found?
}

pub(super) async fn execute_command(
    server: &Backend,
    params: lsp::ExecuteCommandParams,
) -> Result<Option<lsp::LSPAny>> {
    if params.command == to_lsp::CONVERT_COMMAND {
        return conversion::convert(server, params).await;
    }
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
    // The window defines which views exist.
    let view = serde_json::from_value::<ViewName>(view).ok();
    let Ok(uri) = uri.parse::<lsp::Uri>() else {
        let message = format!("{uri} is not the URI of a document");
        return Err(failed(ErrorCode::InvalidParams, message));
    };
    window::open(&server.session, &server.client, &uri, view);
    Ok(None)
}

/// Applies new settings, and has the editor refresh everything that depends on them.
pub(super) fn set(session: &Arc<Mutex<Session>>, client: &Client, json: &serde_json::Value) {
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
    // Handlers never wait for requests to the editor.
    tasks::spawn(async move {
        if hints && editor.refreshes_hints {
            let _ = client.inlay_hint_refresh().await;
        }
        if lenses && editor.refreshes_lenses {
            let _ = client.code_lens_refresh().await;
        }
    });
}

/// Adds the symbols of a document whose names contain the letters of the query in order.
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
    let entries = snapshot.analysis().outline();
    let entries = entries.iter().filter(|entry| fits(&entry.name));
    found.extend(entries.map(|entry| to_lsp::symbol_information(snapshot, &uri, entry)));
}

/// A progress bar that the editor offered with a request, from its first to its last report. Its reports are sent on
/// the same path as the answers, so that it ends before they arrive.
struct Progress<'o> {
    raw_sender: &'o RawSender,
    token: lsp::ProgressToken,
}

impl<'o> Progress<'o> {
    fn begin(raw_sender: &'o RawSender, token: lsp::ProgressToken, title: &str) -> Self {
        let progress = Self { raw_sender, token };
        let begin = lsp::WorkDoneProgressBegin {
            title: title.to_owned(),
            cancellable: Some(true),
            ..lsp::WorkDoneProgressBegin::default()
        };
        progress.send(lsp::WorkDoneProgress::Begin(begin));
        progress
    }

    fn send(&self, value: lsp::WorkDoneProgress) {
        let params = lsp::ProgressParams {
            token: self.token.clone(),
            value: lsp::ProgressParamsValue::WorkDone(value),
        };
        let body = notification(lsp::notification::Progress::METHOD, &params);
        self.raw_sender.send(body);
    }
}

/// Ends the progress, even if the request is cancelled.
impl Drop for Progress<'_> {
    fn drop(&mut self) {
        let end = lsp::WorkDoneProgressEnd::default();
        self.send(lsp::WorkDoneProgress::End(end));
    }
}
