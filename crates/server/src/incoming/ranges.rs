//! What is asked of a range of a document, or of all of it: symbols, tokens, hints, lenses, formatting, …

use ide::{fix, format, hints, lens, live, outline};
use syntax::span::Span;
use tower_lsp::jsonrpc::Result;
use tower_lsp::ls_types as lsp;

use super::{Backend, places};
use crate::documents::Snapshot;
use crate::outgoing;
use crate::tokens;

pub(super) async fn document_symbol(
    server: &Backend,
    params: lsp::DocumentSymbolParams,
) -> Result<Option<lsp::DocumentSymbolResponse>> {
    let uri = params.text_document.uri;
    let hierarchical = server.session().editor.hierarchical_symbols;
    server
        .ask(&uri.clone(), move |snapshot| {
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

pub(super) async fn folding_range(
    server: &Backend,
    params: lsp::FoldingRangeParams,
) -> Result<Option<Vec<lsp::FoldingRange>>> {
    server
        .ask(&params.text_document.uri, |snapshot| {
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

pub(super) async fn semantic_tokens_full(
    server: &Backend,
    params: lsp::SemanticTokensParams,
) -> Result<Option<lsp::SemanticTokensResult>> {
    let uri = params.text_document.uri;
    let encoded = server
        .ask(&uri, |snapshot| tokens::encode(snapshot, None))
        .await?;
    let data = outgoing::tokens(&encoded);
    let mut session = server.session();
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

pub(super) async fn semantic_tokens_full_delta(
    server: &Backend,
    params: lsp::SemanticTokensDeltaParams,
) -> Result<Option<lsp::SemanticTokensFullDeltaResult>> {
    let uri = params.text_document.uri;
    let encoded = server
        .ask(&uri, |snapshot| tokens::encode(snapshot, None))
        .await?;
    let mut session = server.session();
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

pub(super) async fn semantic_tokens_range(
    server: &Backend,
    params: lsp::SemanticTokensRangeParams,
) -> Result<Option<lsp::SemanticTokensRangeResult>> {
    let encoded = server
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

pub(super) async fn inlay_hint(
    server: &Backend,
    params: lsp::InlayHintParams,
) -> Result<Option<Vec<lsp::InlayHint>>> {
    let (settings, values) = {
        let session = server.session();
        let live = session.previews.live(params.text_document.uri.as_str());
        (session.settings, live.cloned())
    };
    server
        .ask(&params.text_document.uri, move |snapshot| {
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

pub(super) async fn code_lens(
    server: &Backend,
    params: lsp::CodeLensParams,
) -> Result<Option<Vec<lsp::CodeLens>>> {
    if !server.session().settings.lenses {
        return Ok(Some(Vec::new()));
    }
    server
        .ask(&params.text_document.uri, |snapshot| {
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

pub(super) async fn code_action(
    server: &Backend,
    params: lsp::CodeActionParams,
) -> Result<Option<lsp::CodeActionResponse>> {
    let versioned = server.session().editor.versioned_edits;
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
    server
        .ask(&uri.clone(), move |snapshot| {
            let fixes = fix::fixes(snapshot.reading(), span(snapshot, params.range));
            let actions = fixes
                .iter()
                .map(|fix| outgoing::action(snapshot, &uri, fix, versioned));
            Some(actions.collect())
        })
        .await
}

pub(super) async fn formatting(
    server: &Backend,
    params: lsp::DocumentFormattingParams,
) -> Result<Option<Vec<lsp::TextEdit>>> {
    server
        .ask(&params.text_document.uri, |snapshot| {
            let edits = format::format(snapshot.reading(), None);
            Some(outgoing::text_edits(snapshot, &edits))
        })
        .await
}

pub(super) async fn range_formatting(
    server: &Backend,
    params: lsp::DocumentRangeFormattingParams,
) -> Result<Option<Vec<lsp::TextEdit>>> {
    server
        .ask(&params.text_document.uri, move |snapshot| {
            let range = span(snapshot, params.range);
            let edits = format::format(snapshot.reading(), Some(range));
            Some(outgoing::text_edits(snapshot, &edits))
        })
        .await
}

/// The span between two places, in the order of the text.
fn span(snapshot: &Snapshot, range: lsp::Range) -> Span {
    let [start, end] = places(range).map(|place| snapshot.offset(place));
    Span::new(start.min(end), start.max(end))
}
