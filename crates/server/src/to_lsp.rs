//! Converts plain data into the protocol's types.

use ide::colour::WrittenColour;
use ide::completion::{Completion, CompletionKind, Completions};
use ide::edit::Edit;
use ide::fix::Fix;
use ide::hint::Hint;
use ide::lens::Lens;
use ide::outline::{Fold, OutlineEntry, OutlineKind};
use ide::semantic::{Modifiers, TokenType};
use ide::signature::Signature;
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::span::Span;
use tower_lsp::ls_types as lsp;

use crate::documents::{Places, Snapshot};
use crate::encoding::{Encoding, Place};
use crate::preview;
use crate::session::Editor;
use crate::tokens::Encoded;

pub(crate) fn position(place: Place) -> lsp::Position {
    lsp::Position::new(place.line, place.column)
}

pub(crate) fn range(places: &impl Places, span: Span) -> lsp::Range {
    let [start, end] = places.range(span).map(position);
    lsp::Range::new(start, end)
}

/// Returns the server's capabilities.
pub(crate) fn capabilities(encoding: Encoding, editor: Editor) -> lsp::ServerCapabilities {
    let encoding = match encoding {
        Encoding::Utf8 => lsp::PositionEncodingKind::UTF8,
        Encoding::Utf16 => lsp::PositionEncodingKind::UTF16,
        Encoding::Utf32 => lsp::PositionEncodingKind::UTF32,
    };
    let words = |words: &[&str]| Some(words.iter().map(|word| (*word).to_owned()).collect());
    let no_progress = lsp::WorkDoneProgressOptions::default;
    lsp::ServerCapabilities {
        position_encoding: Some(encoding),
        text_document_sync: Some(lsp::TextDocumentSyncCapability::Options(
            lsp::TextDocumentSyncOptions {
                open_close: Some(true),
                change: Some(lsp::TextDocumentSyncKind::INCREMENTAL),
                ..lsp::TextDocumentSyncOptions::default()
            },
        )),
        hover_provider: Some(lsp::HoverProviderCapability::Simple(true)),
        completion_provider: Some(lsp::CompletionOptions {
            resolve_provider: Some(true),
            trigger_characters: words(&["_"]),
            ..lsp::CompletionOptions::default()
        }),
        signature_help_provider: Some(lsp::SignatureHelpOptions {
            trigger_characters: words(&["(", "[", "{", ","]),
            retrigger_characters: words(&[")", "]", "}"]),
            work_done_progress_options: no_progress(),
        }),
        definition_provider: Some(lsp::OneOf::Left(true)),
        references_provider: Some(lsp::OneOf::Left(true)),
        document_highlight_provider: Some(lsp::OneOf::Left(true)),
        document_symbol_provider: Some(lsp::OneOf::Left(true)),
        workspace_symbol_provider: Some(lsp::OneOf::Right(lsp::WorkspaceSymbolOptions {
            work_done_progress_options: lsp::WorkDoneProgressOptions {
                work_done_progress: Some(true),
            },
            resolve_provider: None,
        })),
        code_action_provider: Some(lsp::CodeActionProviderCapability::Options(
            lsp::CodeActionOptions {
                code_action_kinds: Some(vec![
                    lsp::CodeActionKind::QUICKFIX,
                    lsp::CodeActionKind::SOURCE_FIX_ALL,
                    CONVERT,
                ]),
                ..lsp::CodeActionOptions::default()
            },
        )),
        code_lens_provider: Some(lsp::CodeLensOptions {
            resolve_provider: Some(false),
        }),
        document_formatting_provider: Some(lsp::OneOf::Left(true)),
        document_range_formatting_provider: Some(lsp::OneOf::Left(true)),
        document_on_type_formatting_provider: Some(lsp::DocumentOnTypeFormattingOptions {
            first_trigger_character: ";".to_owned(),
            more_trigger_character: None,
        }),
        rename_provider: Some(match editor.prepares_rename {
            true => lsp::OneOf::Right(lsp::RenameOptions {
                prepare_provider: Some(true),
                work_done_progress_options: no_progress(),
            }),
            false => lsp::OneOf::Left(true),
        }),
        color_provider: Some(lsp::ColorProviderCapability::Simple(true)),
        folding_range_provider: Some(lsp::FoldingRangeProviderCapability::Simple(true)),
        selection_range_provider: Some(lsp::SelectionRangeProviderCapability::Simple(true)),
        execute_command_provider: Some(lsp::ExecuteCommandOptions {
            commands: [preview::COMMAND, CONVERT_COMMAND]
                .map(str::to_owned)
                .to_vec(),
            work_done_progress_options: no_progress(),
        }),
        semantic_tokens_provider: Some(
            lsp::SemanticTokensServerCapabilities::SemanticTokensOptions(
                lsp::SemanticTokensOptions {
                    work_done_progress_options: no_progress(),
                    legend: lsp::SemanticTokensLegend {
                        token_types: TokenType::ALL
                            .map(|kind| lsp::SemanticTokenType::new(kind.name()))
                            .to_vec(),
                        token_modifiers: Modifiers::NAMES
                            .map(lsp::SemanticTokenModifier::new)
                            .to_vec(),
                    },
                    range: Some(true),
                    full: Some(lsp::SemanticTokensFullOptions::Delta { delta: Some(true) }),
                },
            ),
        ),
        inlay_hint_provider: Some(lsp::OneOf::Left(true)),
        document_link_provider: Some(lsp::DocumentLinkOptions {
            resolve_provider: Some(false),
            work_done_progress_options: no_progress(),
        }),
        diagnostic_provider: Some(lsp::DiagnosticServerCapabilities::Options(
            lsp::DiagnosticOptions {
                identifier: Some("geotrace".to_owned()),
                inter_file_dependencies: false,
                workspace_diagnostics: false,
                work_done_progress_options: no_progress(),
            },
        )),
        workspace: Some(lsp::WorkspaceServerCapabilities {
            workspace_folders: Some(lsp::WorkspaceFoldersServerCapabilities {
                supported: Some(true),
                change_notifications: Some(lsp::OneOf::Left(true)),
            }),
            file_operations: None,
        }),
        ..lsp::ServerCapabilities::default()
    }
}

pub(crate) fn diagnostics(
    places: &impl Places,
    uri: &lsp::Uri,
    found: &[Diagnostic],
    related: bool,
) -> Vec<lsp::Diagnostic> {
    let found = found.iter();
    found.map(|d| diagnostic(places, uri, d, related)).collect()
}

/// `related` says whether the editor accepts related locations.
fn diagnostic(
    places: &impl Places,
    uri: &lsp::Uri,
    diagnostic: &Diagnostic,
    related: bool,
) -> lsp::Diagnostic {
    let severity = match diagnostic.severity {
        Severity::Error => lsp::DiagnosticSeverity::ERROR,
        Severity::Warning => lsp::DiagnosticSeverity::WARNING,
        Severity::Hint => lsp::DiagnosticSeverity::HINT,
    };
    let message = match &diagnostic.hint {
        Some(hint) => format!("{}\n{hint}", diagnostic.message),
        None => diagnostic.message.clone(),
    };
    let related: Vec<_> = diagnostic
        .related
        .iter()
        .filter(|_| related)
        .map(|related| lsp::DiagnosticRelatedInformation {
            location: lsp::Location::new(uri.clone(), range(places, related.span)),
            message: related.message.clone(),
        })
        .collect();
    lsp::Diagnostic {
        range: range(places, diagnostic.span),
        severity: Some(severity),
        code: Some(lsp::NumberOrString::String(diagnostic.code.0.to_owned())),
        source: Some("geotrace".to_owned()),
        message,
        related_information: (!related.is_empty()).then_some(related),
        ..lsp::Diagnostic::default()
    }
}

fn markup(markdown: bool, description: &ide::description::Description) -> lsp::MarkupContent {
    if markdown {
        lsp::MarkupContent {
            kind: lsp::MarkupKind::Markdown,
            value: description.markdown(),
        }
    } else {
        lsp::MarkupContent {
            kind: lsp::MarkupKind::PlainText,
            value: description.plain(),
        }
    }
}

pub(crate) fn hover(snapshot: &Snapshot, offset: u32, markdown: bool) -> Option<lsp::Hover> {
    let (span, description) = snapshot.analysis().hover(offset)?;
    Some(lsp::Hover {
        contents: lsp::HoverContents::Markup(markup(markdown, &description)),
        range: Some(range(snapshot, span)),
    })
}

/// Returns the data of a completion item by which its remaining parts are resolved later.
pub(crate) fn later(uri: &str, offset: u32) -> serde_json::Value {
    serde_json::json!({ "uri": uri, "offset": offset })
}

/// The editor requests an incomplete list again when the user has typed more.
pub(crate) fn completions(snapshot: &Snapshot, found: Completions) -> lsp::CompletionResponse {
    let list = found.list.into_iter();
    let items = list.map(|it| completion(snapshot, found.range, it));
    let items = items.collect();
    match found.is_complete {
        true => lsp::CompletionResponse::Array(items),
        false => lsp::CompletionResponse::List(lsp::CompletionList {
            is_incomplete: true,
            items,
        }),
    }
}

fn completion(snapshot: &Snapshot, replaced: Span, completion: Completion) -> lsp::CompletionItem {
    let kind = match completion.kind {
        CompletionKind::Keyword => lsp::CompletionItemKind::KEYWORD,
        CompletionKind::Function => lsp::CompletionItemKind::FUNCTION,
        CompletionKind::Surface | CompletionKind::Curve | CompletionKind::Solid => {
            lsp::CompletionItemKind::CLASS
        }
        CompletionKind::Attribute => lsp::CompletionItemKind::PROPERTY,
        CompletionKind::Word => lsp::CompletionItemKind::ENUM_MEMBER,
        CompletionKind::Constant => lsp::CompletionItemKind::CONSTANT,
        CompletionKind::Parameter => lsp::CompletionItemKind::VARIABLE,
    };
    let format = if completion.snippet {
        lsp::InsertTextFormat::SNIPPET
    } else {
        lsp::InsertTextFormat::PLAIN_TEXT
    };
    lsp::CompletionItem {
        // Editors that accept the server's ranges of edits filter by this.
        filter_text: Some(completion.label.clone()),
        label: completion.label,
        kind: Some(kind),
        detail: Some(completion.detail),
        insert_text_format: Some(format),
        text_edit: Some(lsp::CompletionTextEdit::Edit(lsp::TextEdit {
            range: range(snapshot, replaced),
            new_text: completion.insert,
        })),
        data: Some(later(&snapshot.uri, replaced.end)),
        ..lsp::CompletionItem::default()
    }
}

/// `markdown` is `None` if the editor accepts only strings.
pub(crate) fn documentation(
    description: &ide::description::Description,
    markdown: Option<bool>,
) -> lsp::Documentation {
    match markdown {
        Some(markdown) => lsp::Documentation::MarkupContent(markup(markdown, description)),
        None => lsp::Documentation::String(description.plain()),
    }
}

/// `offsets` says whether the editor accepts a parameter as a range of the label; otherwise it gets the parameter's
/// text.
pub(crate) fn signature(signature: &Signature, offsets: bool) -> lsp::SignatureHelp {
    let units = |at: u32| signature.label[..at as usize].encode_utf16().count() as u32;
    let parameters = signature.parameters.iter();
    let parameters = parameters.map(|&(start, end)| lsp::ParameterInformation {
        label: match offsets {
            true => lsp::ParameterLabel::LabelOffsets([start, end].map(units)),
            false => {
                let text = &signature.label[start as usize..end as usize];
                lsp::ParameterLabel::Simple(text.to_owned())
            }
        },
        documentation: None,
    });
    lsp::SignatureHelp {
        signatures: vec![lsp::SignatureInformation {
            label: signature.label.clone(),
            documentation: Some(lsp::Documentation::String(signature.what.clone())),
            parameters: Some(parameters.collect()),
            active_parameter: Some(signature.active),
        }],
        active_signature: Some(0),
        active_parameter: Some(signature.active),
    }
}

pub(crate) fn text_edits(snapshot: &Snapshot, edits: &[Edit]) -> Vec<lsp::TextEdit> {
    let edits = edits.iter().map(|edit| lsp::TextEdit {
        range: range(snapshot, edit.span),
        new_text: edit.text.clone(),
    });
    edits.collect()
}

/// Returns edits of a document, which must have the snapshot's version.
pub(crate) fn workspace_edit(
    snapshot: &Snapshot,
    uri: &lsp::Uri,
    edits: &[Edit],
    versioned: bool,
) -> lsp::WorkspaceEdit {
    let edits = text_edits(snapshot, edits);
    if versioned {
        return lsp::WorkspaceEdit {
            document_changes: Some(lsp::DocumentChanges::Edits(vec![lsp::TextDocumentEdit {
                text_document: lsp::OptionalVersionedTextDocumentIdentifier {
                    uri: uri.clone(),
                    version: Some(snapshot.version),
                },
                edits: edits.into_iter().map(lsp::OneOf::Left).collect(),
            }])),
            ..lsp::WorkspaceEdit::default()
        };
    }
    lsp::WorkspaceEdit {
        changes: Some([(uri.clone(), edits)].into()),
        ..lsp::WorkspaceEdit::default()
    }
}

pub(crate) fn action(
    snapshot: &Snapshot,
    uri: &lsp::Uri,
    fix: &Fix,
    editor: Editor,
) -> lsp::CodeActionOrCommand {
    let edit = workspace_edit(snapshot, uri, &fix.edits, editor.versioned_edits);
    let found = diagnostic(snapshot, uri, &fix.diagnostic, editor.related_places);
    lsp::CodeActionOrCommand::CodeAction(lsp::CodeAction {
        title: fix.title.clone(),
        kind: Some(lsp::CodeActionKind::QUICKFIX),
        diagnostics: Some(vec![found]),
        edit: Some(edit),
        is_preferred: (fix.preferred && editor.preferred_actions).then_some(true),
        ..lsp::CodeAction::default()
    })
}

pub(crate) fn fix_all(
    snapshot: &Snapshot,
    uri: &lsp::Uri,
    edits: &[Edit],
    count: usize,
    versioned: bool,
) -> lsp::CodeActionOrCommand {
    lsp::CodeActionOrCommand::CodeAction(lsp::CodeAction {
        title: match count {
            1 => "Fix all (1 place)".to_owned(),
            count => format!("Fix all ({count} places)"),
        },
        kind: Some(lsp::CodeActionKind::SOURCE_FIX_ALL),
        edit: Some(workspace_edit(snapshot, uri, edits, versioned)),
        ..lsp::CodeAction::default()
    })
}

/// The command that writes a document in another language into a new file: its argument is the document's URI.
pub(crate) const CONVERT_COMMAND: &str = "geotrace.convert";
/// The kind of that action.
pub(crate) const CONVERT: lsp::CodeActionKind = lsp::CodeActionKind::new("source.convert");

/// Returns the action that writes a document in Geotrace's language, into a new file.
pub(crate) fn conversion(uri: &lsp::Uri) -> lsp::CodeActionOrCommand {
    let title = "Convert to Geotrace's language".to_owned();
    lsp::CodeActionOrCommand::CodeAction(lsp::CodeAction {
        title: title.clone(),
        kind: Some(CONVERT),
        command: Some(lsp::Command {
            title,
            command: CONVERT_COMMAND.to_owned(),
            arguments: Some(vec![lsp::LSPAny::String(uri.to_string())]),
        }),
        ..lsp::CodeAction::default()
    })
}

/// Returns the edit that creates a file with a text.
pub(crate) fn new_file(uri: &lsp::Uri, text: String) -> lsp::WorkspaceEdit {
    let create = lsp::ResourceOp::Create(lsp::CreateFile {
        uri: uri.clone(),
        options: None,
        annotation_id: None,
    });
    let edit = lsp::TextDocumentEdit {
        text_document: lsp::OptionalVersionedTextDocumentIdentifier {
            uri: uri.clone(),
            version: None,
        },
        edits: vec![lsp::OneOf::Left(lsp::TextEdit {
            range: lsp::Range::default(),
            new_text: text,
        })],
    };
    lsp::WorkspaceEdit {
        document_changes: Some(lsp::DocumentChanges::Operations(vec![
            lsp::DocumentChangeOperation::Op(create),
            lsp::DocumentChangeOperation::Edit(edit),
        ])),
        ..lsp::WorkspaceEdit::default()
    }
}

fn symbol_kind(kind: OutlineKind) -> lsp::SymbolKind {
    match kind {
        OutlineKind::Variable => lsp::SymbolKind::VARIABLE,
        OutlineKind::Constant => lsp::SymbolKind::CONSTANT,
        OutlineKind::Function => lsp::SymbolKind::FUNCTION,
        OutlineKind::Object => lsp::SymbolKind::CLASS,
    }
}

pub(crate) fn document_symbol(snapshot: &Snapshot, entry: &OutlineEntry) -> lsp::DocumentSymbol {
    #[allow(deprecated)] // The field has to be named to be left out.
    lsp::DocumentSymbol {
        name: entry.name.clone(),
        detail: Some(
            format!("{} {}", entry.keyword, entry.detail)
                .trim_end()
                .to_owned(),
        ),
        kind: symbol_kind(entry.kind),
        tags: None,
        deprecated: None,
        range: range(snapshot, entry.span),
        selection_range: range(snapshot, entry.name_span),
        children: None,
    }
}

pub(crate) fn symbol_information(
    snapshot: &Snapshot,
    uri: &lsp::Uri,
    entry: &OutlineEntry,
) -> lsp::SymbolInformation {
    #[allow(deprecated)] // As above.
    lsp::SymbolInformation {
        name: entry.name.clone(),
        kind: symbol_kind(entry.kind),
        tags: None,
        deprecated: None,
        location: lsp::Location::new(uri.clone(), range(snapshot, entry.name_span)),
        container_name: Some(entry.keyword.to_owned()),
    }
}

pub(crate) fn fold(snapshot: &Snapshot, fold: &Fold) -> lsp::FoldingRange {
    let [start, end] = snapshot.range(fold.span);
    lsp::FoldingRange {
        start_line: start.line,
        end_line: end.line,
        kind: fold.comment.then_some(lsp::FoldingRangeKind::Comment),
        ..lsp::FoldingRange::default()
    }
}

pub(crate) fn colour(snapshot: &Snapshot, stated: &WrittenColour) -> lsp::ColorInformation {
    let [red, green, blue] = stated.rgb.map(|channel| channel as f32);
    lsp::ColorInformation {
        range: range(snapshot, stated.span),
        color: lsp::Color {
            red,
            green,
            blue,
            alpha: 1.0,
        },
    }
}

pub(crate) fn colour_presentation(
    snapshot: &Snapshot,
    replaced: Span,
    text: String,
) -> lsp::ColorPresentation {
    lsp::ColorPresentation {
        text_edit: Some(lsp::TextEdit {
            range: range(snapshot, replaced),
            new_text: text.clone(),
        }),
        label: text,
        additional_text_edits: None,
    }
}

/// Returns the chain of ranges, from the smallest to the largest. Each contains the next one, in memory and in the
/// message, and deep nesting overflows stacks: of a long chain, only the smallest and a sample of the larger ones are
/// returned.
pub(crate) fn selection(snapshot: &Snapshot, chain: &[Span]) -> lsp::SelectionRange {
    const SMALL: usize = 64;
    const LARGE: usize = 32;
    let (small, large) = chain.split_at(chain.len().min(SMALL));
    let step = large.len().div_ceil(LARGE).max(1);
    let mut parent = None;
    for span in large.iter().rev().step_by(step).chain(small.iter().rev()) {
        parent = Some(Box::new(lsp::SelectionRange {
            range: range(snapshot, *span),
            parent,
        }));
    }
    match parent {
        Some(selection) => *selection,
        None => lsp::SelectionRange {
            range: lsp::Range::default(),
            parent: None,
        },
    }
}

pub(crate) fn hint(snapshot: &Snapshot, hint: &Hint) -> lsp::InlayHint {
    let place = snapshot.range(Span::new(hint.offset, hint.offset))[0];
    lsp::InlayHint {
        position: position(place),
        label: lsp::InlayHintLabel::String(hint.label.clone()),
        kind: None,
        text_edits: None,
        tooltip: Some(lsp::InlayHintTooltip::String(hint.tooltip.clone())),
        padding_left: hint.apart.then_some(true),
        padding_right: None,
        data: None,
    }
}

pub(crate) fn lens(snapshot: &Snapshot, lens: &Lens) -> lsp::CodeLens {
    let view = protocol::ViewName {
        view: lens.view.to_owned(),
        surface: lens.object.clone(),
    };
    lsp::CodeLens {
        range: range(snapshot, lens.span),
        command: Some(lsp::Command {
            title: lens.title.to_owned(),
            command: preview::COMMAND.to_owned(),
            arguments: Some(vec![snapshot.uri.clone().into(), serde_json::json!(view)]),
        }),
        data: None,
    }
}

pub(crate) fn tokens(encoded: &[Encoded]) -> Vec<lsp::SemanticToken> {
    let tokens = encoded.iter().map(
        |&[line, start, length, kind, modifiers]| lsp::SemanticToken {
            delta_line: line,
            delta_start: start,
            length,
            token_type: kind,
            token_modifiers_bitset: modifiers,
        },
    );
    tokens.collect()
}
