//! Requests at a position of a document: hover, completion, definition, rename, …

use tower_lsp::jsonrpc::{ErrorCode, Result};
use tower_lsp::ls_types as lsp;

use super::work::failed;
use super::{Backend, place};
use crate::documents::Open;
use crate::raw_responses::{Answer, answer};
use crate::to_lsp;

/// The protocol's code for a request that failed for a reason that the user should see.
const REQUEST_FAILED: i64 = -32803;

pub(super) async fn hover(
    server: &Backend,
    params: lsp::HoverParams,
) -> Result<Option<lsp::Hover>> {
    let at = params.text_document_position_params;
    let markdown = server.session().editor.markdown;
    server
        .ask_run(&at.text_document.uri, move |snapshot| {
            to_lsp::hover(snapshot, snapshot.offset(place(at.position)), markdown)
        })
        .await
}

pub(super) async fn completion(server: &Backend, params: lsp::CompletionParams) -> Result<Answer> {
    let at = params.text_document_position;
    let snippets = server.session().editor.snippets;
    server
        .answer(&at.text_document.uri, move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let found = snapshot.analysis().completions(offset, snippets);
            to_lsp::completions(snapshot, found)
        })
        .await
}

pub(super) async fn completion_resolve(
    server: &Backend,
    mut item: lsp::CompletionItem,
) -> Result<lsp::CompletionItem> {
    let data = item.data.clone().unwrap_or_default();
    let uri = data.get("uri").and_then(serde_json::Value::as_str);
    let offset = data.get("offset").and_then(serde_json::Value::as_u64);
    let (Some(uri), Some(offset)) = (uri, offset) else {
        return Ok(item);
    };
    let format = server.session().editor.documentation;
    // A document that has been closed meanwhile has no details.
    let Some(snapshot) = server.session().documents.get(uri).map(Open::snapshot) else {
        return Ok(item);
    };
    let label = item.label.clone();
    let described = server.work(move || {
        let offset = u32::try_from(offset)
            .unwrap_or(u32::MAX)
            .min(snapshot.text().len());
        snapshot.analysis().describe_completion(offset, &label)
    });
    if let Some(description) = described.await? {
        item.documentation = Some(to_lsp::documentation(&description, format));
    }
    Ok(item)
}

pub(super) async fn signature_help(
    server: &Backend,
    params: lsp::SignatureHelpParams,
) -> Result<Option<lsp::SignatureHelp>> {
    let at = params.text_document_position_params;
    let offsets = server.session().editor.label_offsets;
    server
        .ask(&at.text_document.uri, move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let found = snapshot.analysis().signature(offset)?;
            Some(to_lsp::signature(&found, offsets))
        })
        .await
}

pub(super) async fn goto_definition(
    server: &Backend,
    params: lsp::GotoDefinitionParams,
) -> Result<Option<lsp::GotoDefinitionResponse>> {
    let at = params.text_document_position_params;
    let uri = at.text_document.uri;
    server
        .ask(&uri.clone(), move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let (_, declared) = snapshot.analysis().definition(offset)?;
            let location = lsp::Location::new(uri, to_lsp::range(snapshot, declared));
            Some(lsp::GotoDefinitionResponse::Scalar(location))
        })
        .await
}

pub(super) async fn references(server: &Backend, params: lsp::ReferenceParams) -> Result<Answer> {
    let at = params.text_document_position;
    let uri = at.text_document.uri;
    let declaration = params.context.include_declaration;
    server
        .answer(&uri.clone(), move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let found = snapshot.analysis().occurrences(offset).into_iter();
            let wanted = found.filter(|occurrence| declaration || !occurrence.introduces);
            let locations = wanted.map(|occurrence| {
                lsp::Location::new(uri.clone(), to_lsp::range(snapshot, occurrence.span))
            });
            locations.collect::<Vec<_>>()
        })
        .await
}

pub(super) async fn document_highlight(
    server: &Backend,
    params: lsp::DocumentHighlightParams,
) -> Result<Answer> {
    let at = params.text_document_position_params;
    // Editors request this at the cursor.
    server.point_at(&at);
    server
        .answer(&at.text_document.uri, move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let found = snapshot.analysis().occurrences(offset).into_iter();
            let highlights = found.map(|occurrence| lsp::DocumentHighlight {
                range: to_lsp::range(snapshot, occurrence.span),
                kind: Some(if occurrence.introduces {
                    lsp::DocumentHighlightKind::WRITE
                } else {
                    lsp::DocumentHighlightKind::READ
                }),
            });
            highlights.collect::<Vec<_>>()
        })
        .await
}

pub(super) async fn prepare_rename(
    server: &Backend,
    params: lsp::TextDocumentPositionParams,
) -> Result<Option<lsp::PrepareRenameResponse>> {
    let uri = params.text_document.uri;
    server
        .ask(&uri, move |snapshot| {
            let offset = snapshot.offset(place(params.position));
            let (span, name) = snapshot
                .analysis()
                .prepare_rename(offset)
                .map_err(|error| {
                    failed(ErrorCode::ServerError(REQUEST_FAILED), error.to_string())
                })?;
            Ok(Some(lsp::PrepareRenameResponse::RangeWithPlaceholder {
                range: to_lsp::range(snapshot, span),
                placeholder: name,
            }))
        })
        .await?
}

pub(super) async fn rename(server: &Backend, params: lsp::RenameParams) -> Result<Answer> {
    let at = params.text_document_position;
    let uri = at.text_document.uri;
    let versioned = server.session().editor.versioned_edits;
    server
        .ask(&uri.clone(), move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let edits = snapshot
                .analysis()
                .rename(offset, &params.new_name)
                .map_err(|error| {
                    failed(ErrorCode::ServerError(REQUEST_FAILED), error.to_string())
                })?;
            answer(&to_lsp::workspace_edit(snapshot, &uri, &edits, versioned))
        })
        .await?
}

pub(super) async fn selection_range(
    server: &Backend,
    params: lsp::SelectionRangeParams,
) -> Result<Option<Vec<lsp::SelectionRange>>> {
    server
        .ask(&params.text_document.uri, move |snapshot| {
            let ranges = params.positions.iter().map(|position| {
                let offset = snapshot.offset(place(*position));
                let chain = snapshot.analysis().selection(offset);
                to_lsp::selection(snapshot, &chain)
            });
            Some(ranges.collect())
        })
        .await
}

pub(super) async fn on_type_formatting(
    server: &Backend,
    params: lsp::DocumentOnTypeFormattingParams,
) -> Result<Option<Vec<lsp::TextEdit>>> {
    let at = params.text_document_position;
    server
        .ask(&at.text_document.uri, move |snapshot| {
            let offset = snapshot.offset(place(at.position));
            let edits = snapshot.analysis().format_on_type(offset)?;
            Some(to_lsp::text_edits(snapshot, &edits))
        })
        .await
}
