//! The command `geotrace.convert`: a document's text in another language, in a new file that the editor creates and
//! shows.

use tower_lsp::Client;
use tower_lsp::jsonrpc::{ErrorCode, Result};
use tower_lsp::ls_types as lsp;

use super::Backend;
use super::work::{failed, not_open};
use crate::documents::Open;
use crate::tasks;
use crate::to_lsp::{self, CONVERT_COMMAND};

/// The number of names that are tried for the new file.
const MOST_NAMES: u32 = 100;

/// Converts a document; the edit is sent to the editor after the answer.
pub(super) async fn convert(
    server: &Backend,
    params: lsp::ExecuteCommandParams,
) -> Result<Option<lsp::LSPAny>> {
    let Some(lsp::LSPAny::String(uri)) = params.arguments.into_iter().next() else {
        let message = format!("{CONVERT_COMMAND} needs the URI of a document");
        return Err(failed(ErrorCode::InvalidParams, message));
    };
    let Ok(uri) = uri.parse::<lsp::Uri>() else {
        let message = format!("{uri} is not the URI of a document");
        return Err(failed(ErrorCode::InvalidParams, message));
    };
    let (snapshot, editor) = {
        let session = server.session();
        let open = session.documents.get(uri.as_str()).map(Open::snapshot);
        (open, session.editor)
    };
    let snapshot = snapshot.ok_or_else(|| not_open(&uri))?;
    if !(editor.applies_edits && editor.creates_files) {
        return show_message(
            &server.client,
            "this editor does not create files for its language server; use `geotrace convert`"
                .to_owned(),
        );
    }
    if uri.as_str().starts_with("untitled:") {
        return show_message(
            &server.client,
            "only a saved script can be converted: save it first".to_owned(),
        );
    }
    let work = move || {
        let analysis = snapshot.analysis();
        let extension = analysis.conversion().unwrap_or_default();
        let target = (1..=MOST_NAMES)
            .filter_map(|count| sibling(&uri, count, extension).parse::<lsp::Uri>().ok())
            .find(|target| !exists(target));
        let target = target.ok_or_else(|| "too many converted files are beside it".to_owned())?;
        let path = target.path().decode().to_string_lossy().into_owned();
        let name = path.rsplit('/').next().unwrap_or_default();
        let text = analysis
            .convert(&[], name)
            .map_err(|error| error.to_string())?;
        Ok((target, text))
    };
    let made = tasks::work(work).await;
    let made: std::result::Result<_, String> =
        made.unwrap_or_else(|_| Err("a fault of the server".to_owned()));
    let client = server.client.clone();
    let (target, text) = match made {
        Ok(made) => made,
        Err(reason) => {
            return show_message(&client, format!("the script is not converted: {reason}"));
        }
    };
    // Handlers never wait for requests to the editor.
    tasks::spawn(async move {
        let edit = to_lsp::new_file(&target, text);
        let params = lsp::ApplyWorkspaceEditParams {
            label: Some("Convert to Geotrace's language".to_owned()),
            edit,
        };
        let asked = client
            .send_request::<lsp::request::ApplyWorkspaceEdit>(params)
            .await;
        let reason = match asked {
            Ok(answer) if answer.applied => None,
            Ok(answer) => Some(answer.failure_reason.unwrap_or_default()),
            Err(error) => Some(error.message.into_owned()),
        };
        if let Some(reason) = reason {
            let message = format!("the editor has not created {}: {reason}", target.as_str());
            client.show_message(lsp::MessageType::ERROR, message).await;
        } else if editor.shows_documents {
            let params = lsp::ShowDocumentParams {
                uri: target,
                external: None,
                take_focus: Some(true),
                selection: None,
            };
            let _ = client.show_document(params).await;
        }
    });
    Ok(None)
}

/// Returns `forest.gtr` beside `forest.crt`; with a larger count `forest-2.gtr`.
fn sibling(uri: &lsp::Uri, count: u32, extension: &str) -> String {
    let stem = uri.as_str();
    let name = stem.rfind('/').map_or(0, |slash| slash + 1);
    let stem = match stem[name..].rfind('.') {
        Some(dot) => &stem[..name + dot],
        None => stem,
    };
    let number = if count > 1 {
        format!("-{count}")
    } else {
        String::new()
    };
    format!("{stem}{number}.{extension}")
}

/// Returns true if the file exists on this system; files that an editor has elsewhere are not checked.
fn exists(uri: &lsp::Uri) -> bool {
    uri.as_str().starts_with("file:") && uri.to_file_path().is_some_and(|path| path.exists())
}

/// Shows a sentence to the user.
fn show_message(client: &Client, message: String) -> Result<Option<lsp::LSPAny>> {
    let client = client.clone();
    tasks::spawn(async move {
        client
            .show_message(lsp::MessageType::WARNING, message)
            .await
    });
    Ok(None)
}
