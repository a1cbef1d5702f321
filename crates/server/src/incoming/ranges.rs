//! Requests for a range of a document, or for all of it: symbols, tokens, hints, lenses, formatting, …

use std::sync::Arc;

use syntax::span::Span;
use tower_lsp::jsonrpc::Result;
use tower_lsp::ls_types as lsp;

use super::{Backend, places};
use crate::documents::Snapshot;
use crate::raw_responses::{Answer, answer};
use crate::to_lsp;
use crate::tokens::{self, Encoded};

pub(super) async fn document_symbol(
    server: &Backend,
    params: lsp::DocumentSymbolParams,
) -> Result<Answer> {
    let uri = params.text_document.uri;
    let hierarchical = server.session().editor.hierarchical_symbols;
    server
        .answer(&uri.clone(), move |snapshot| {
            let entries = snapshot.analysis().outline();
            let entries = entries.iter();
            if hierarchical {
                let symbols = entries.map(|entry| to_lsp::document_symbol(snapshot, entry));
                lsp::DocumentSymbolResponse::Nested(symbols.collect())
            } else {
                let symbols =
                    entries.map(|entry| to_lsp::symbol_information(snapshot, &uri, entry));
                lsp::DocumentSymbolResponse::Flat(symbols.collect())
            }
        })
        .await
}

pub(super) async fn folding_range(
    server: &Backend,
    params: lsp::FoldingRangeParams,
) -> Result<Answer> {
    server
        .answer(&params.text_document.uri, |snapshot| {
            let folds = snapshot.analysis().folds();
            let folds = folds.iter().map(|fold| to_lsp::fold(snapshot, fold));
            folds.collect::<Vec<_>>()
        })
        .await
}

pub(super) async fn document_link(
    server: &Backend,
    params: lsp::DocumentLinkParams,
) -> Result<Option<Vec<lsp::DocumentLink>>> {
    let uri = params.text_document.uri;
    server
        .ask(&uri.clone(), move |snapshot| {
            // Paths are relative to the document's folder; an untitled document has none.
            let file = uri.to_file_path()?;
            let folder = file.parent()?;
            let links = snapshot.analysis().links().into_iter();
            let links = links.filter_map(|link| {
                Some(lsp::DocumentLink {
                    range: to_lsp::range(snapshot, link.span),
                    target: Some(lsp::Uri::from_file_path(folder.join(&link.path))?),
                    tooltip: None,
                    data: None,
                })
            });
            Some(links.collect())
        })
        .await
}

pub(super) async fn document_color(
    server: &Backend,
    params: lsp::DocumentColorParams,
) -> Result<Vec<lsp::ColorInformation>> {
    server
        .ask(&params.text_document.uri, |snapshot| {
            let stated = snapshot.analysis().colours();
            let stated = stated.iter().map(|colour| to_lsp::colour(snapshot, colour));
            stated.collect()
        })
        .await
}

pub(super) async fn color_presentation(
    server: &Backend,
    params: lsp::ColorPresentationParams,
) -> Result<Vec<lsp::ColorPresentation>> {
    server
        .ask(&params.text_document.uri, move |snapshot| {
            let range = span(snapshot, params.range);
            let lsp::Color {
                red, green, blue, ..
            } = params.color;
            let texts = snapshot
                .analysis()
                .colour_texts(range, [red, green, blue].map(f64::from));
            let texts = texts.into_iter();
            let texts = texts.map(|text| to_lsp::colour_presentation(snapshot, range, text));
            texts.collect()
        })
        .await
}

pub(super) async fn semantic_tokens_full(
    server: &Backend,
    params: lsp::SemanticTokensParams,
) -> Result<Answer> {
    tokens_since(server, params.text_document.uri, None).await
}

pub(super) async fn semantic_tokens_full_delta(
    server: &Backend,
    params: lsp::SemanticTokensDeltaParams,
) -> Result<Answer> {
    let known = params.previous_result_id;
    tokens_since(server, params.text_document.uri, Some(known)).await
}

/// Returns all tokens, or their difference from the last tokens sent if the editor still has those under the name
/// `known`.
async fn tokens_since(server: &Backend, uri: lsp::Uri, known: Option<String>) -> Result<Answer> {
    let (name, old) = {
        let mut session = server.session();
        let sent = session.tokens.get(uri.as_str());
        let sent = sent.filter(|(name, _)| known.as_ref() == Some(name));
        let old = sent.map(|(_, encoded)| encoded.clone());
        (session.fresh_name(), old)
    };
    let own_name = name.clone();
    let answered = server.ask(&uri, move |snapshot| {
        let encoded: Arc<[Encoded]> = tokens::encode(snapshot, None).into();
        let result_id = Some(own_name);
        let answer = match old {
            None => answer(&lsp::SemanticTokens {
                result_id,
                data: to_lsp::tokens(&encoded),
            }),
            Some(old) => {
                let edits = tokens::difference(&old, &encoded).into_iter();
                let edits = edits.map(|(start, gone, come)| lsp::SemanticTokensEdit {
                    start: 5 * start as u32,
                    delete_count: 5 * gone as u32,
                    data: Some(to_lsp::tokens(&come)),
                });
                answer(&lsp::SemanticTokensDelta {
                    result_id,
                    edits: edits.collect(),
                })
            }
        };
        (answer, encoded)
    });
    let (answer, encoded) = answered.await?;
    let mut session = server.session();
    let sent = (name, encoded);
    session.tokens.insert(uri.as_str().to_owned(), sent);
    answer
}

pub(super) async fn semantic_tokens_range(
    server: &Backend,
    params: lsp::SemanticTokensRangeParams,
) -> Result<Answer> {
    server
        .answer(&params.text_document.uri, move |snapshot| {
            let encoded = tokens::encode(snapshot, Some(places(params.range)));
            lsp::SemanticTokens {
                result_id: None,
                data: to_lsp::tokens(&encoded),
            }
        })
        .await
}

pub(super) async fn inlay_hint(server: &Backend, params: lsp::InlayHintParams) -> Result<Answer> {
    let (settings, values) = {
        let session = server.session();
        let live = session.previews.live(params.text_document.uri.as_str());
        (session.settings, live.cloned())
    };
    server
        .answer(&params.text_document.uri, move |snapshot| {
            let range = span(snapshot, params.range);
            let mut found = snapshot.analysis().hints(range);
            if let Some(values) = values {
                found.extend(snapshot.analysis().preview_values(range, &values));
                found.sort_by_key(|hint| hint.offset);
            }
            // Values are set apart from the text; splits are within it.
            let wanted = found.iter().filter(|hint| {
                if hint.apart {
                    settings.values
                } else {
                    settings.splits
                }
            });
            let wanted = wanted.map(|hint| to_lsp::hint(snapshot, hint));
            wanted.collect::<Vec<_>>()
        })
        .await
}

pub(super) async fn code_lens(server: &Backend, params: lsp::CodeLensParams) -> Result<Answer> {
    if !server.session().settings.lenses {
        return answer(&[(); 0]);
    }
    server
        .answer(&params.text_document.uri, |snapshot| {
            let lenses = snapshot.analysis().lenses();
            let lenses = lenses.iter().map(|lens| to_lsp::lens(snapshot, lens));
            lenses.collect::<Vec<_>>()
        })
        .await
}

pub(super) async fn code_action(server: &Backend, params: lsp::CodeActionParams) -> Result<Answer> {
    let editor = server.session().editor;
    let versioned = editor.versioned_edits;
    let uri = params.text_document.uri;
    // A kind includes its sub-kinds; the empty kind includes all.
    let only = params.context.only;
    let admits = |kind: lsp::CodeActionKind| {
        only.as_ref().is_none_or(|kinds| {
            let holds = |outer: &lsp::CodeActionKind| {
                let below = kind.as_str().strip_prefix(outer.as_str());
                below.is_some_and(|rest| {
                    outer.as_str().is_empty() || rest.is_empty() || rest.starts_with('.')
                })
            };
            kinds.iter().any(holds)
        })
    };
    let (one, all) = (
        admits(lsp::CodeActionKind::QUICKFIX),
        admits(lsp::CodeActionKind::SOURCE_FIX_ALL),
    );
    let converts = admits(to_lsp::CONVERT) && editor.applies_edits && editor.creates_files;
    let unrestricted = only.is_none();
    if !one && !all && !converts {
        return answer(&[(); 0]);
    }
    server
        .ask_run(&uri.clone(), move |snapshot| {
            let analysis = snapshot.analysis();
            let mut actions = Vec::new();
            if one {
                let fixes = analysis.fixes(span(snapshot, params.range));
                let fixes = fixes.iter();
                actions.extend(fixes.map(|fix| to_lsp::action(snapshot, &uri, fix, editor)));
            }
            if all {
                let (edits, count) = analysis.fix_all();
                // If all kinds are requested, it follows the fixes at this position, and only if there are several
                // mistakes.
                let is_listed = match unrestricted {
                    true => !actions.is_empty() && count > 1,
                    false => count > 0,
                };
                if is_listed {
                    actions.push(to_lsp::fix_all(snapshot, &uri, &edits, count, versioned));
                }
            }
            if converts && analysis.conversion().is_some() {
                actions.push(to_lsp::conversion(&uri));
            }
            answer(&actions)
        })
        .await?
}

pub(super) async fn formatting(
    server: &Backend,
    params: lsp::DocumentFormattingParams,
) -> Result<Answer> {
    server
        .answer(&params.text_document.uri, |snapshot| {
            let edits = snapshot.analysis().format(None);
            to_lsp::text_edits(snapshot, &edits)
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
            let edits = snapshot.analysis().format(Some(range));
            Some(to_lsp::text_edits(snapshot, &edits))
        })
        .await
}

/// Returns the span between two positions, in the order of the text.
fn span(snapshot: &Snapshot, range: lsp::Range) -> Span {
    let [start, end] = places(range).map(|place| snapshot.offset(place));
    Span::new(start.min(end), start.max(end))
}
