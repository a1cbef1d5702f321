//! The structure of a script: its blocks, macros and objects, and its foldable ranges.

use syntax::crt::tree::{BlockKind, ExpressionKind, StatementKind};
use syntax::span::Span;

use super::CrtAnalysis;
use crate::outline::{Fold, OutlineEntry, OutlineKind};
use syntax::crt::objects::ObjectName;

/// Returns `Settings`, `Scene`, and the variables to which macros and objects are assigned at top level.
pub(super) fn outline(analysis: &CrtAnalysis) -> Vec<OutlineEntry> {
    let script = analysis.script();
    let entries = script.blocks().filter_map(|(start, block)| {
        let word = |word: &'static str, kind| {
            let place = block.span.start;
            let name_span = Span::new(place, place + word.len() as u32);
            (word.to_owned(), kind, word, String::new(), name_span)
        };
        let (name, kind, keyword, detail, name_span) = match &block.kind {
            BlockKind::Settings(..) => word("Settings", OutlineKind::Constant),
            BlockKind::Scene(_) => word("Scene", OutlineKind::Object),
            BlockKind::Statement(statement) => {
                let StatementKind::Expression(expression) = &statement.kind else {
                    return None;
                };
                let ExpressionKind::Assignment(parts) = &expression.kind else {
                    return None;
                };
                let [target, value] = &**parts;
                let ExpressionKind::Identifier(name) = &target.kind else {
                    return None;
                };
                let (kind, keyword, detail) = match &value.kind {
                    ExpressionKind::Macro(it) => {
                        let parameters: Vec<&str> =
                            it.parameters.iter().map(|word| &*word.text).collect();
                        let detail = format!("({})", parameters.join(", "));
                        (OutlineKind::Function, "Macro", detail)
                    }
                    ExpressionKind::Object(object) => {
                        let known = ObjectName::from_text(&object.name.text)?;
                        (OutlineKind::Object, known.text(), String::new())
                    }
                    _ => return None,
                };
                (name.to_string(), kind, keyword, detail, target.span)
            }
        };
        Some(OutlineEntry {
            name,
            kind,
            keyword,
            detail,
            span: block.span.moved(start),
            name_span: name_span.moved(start),
        })
    });
    entries.collect()
}

/// Returns the braces, in the order of the text.
fn braces(analysis: &CrtAnalysis) -> Vec<Span> {
    let names = analysis.names();
    let objects = names.objects.iter().map(|object| object.braces);
    let mut spans: Vec<Span> = objects.chain(names.bodies.iter().copied()).collect();
    spans.sort_unstable();
    spans
}

/// Returns the braces that span several lines, in the order of the text.
pub(super) fn folds(analysis: &CrtAnalysis) -> Vec<Fold> {
    let text = analysis.snapshot_text();
    let spans = braces(analysis).into_iter();
    let spans = spans.filter(|span| text.line(span.start) < text.line(span.end));
    let folds = spans.map(|span| Fold {
        span,
        comment: false,
    });
    folds.collect()
}

/// Returns the ranges around an offset: the token, the text between braces, the braces, the block, the whole text.
pub(super) fn selection(analysis: &CrtAnalysis, offset: u32) -> Vec<Span> {
    let script = analysis.script();
    let around = Span::new(offset, offset);
    let token = analysis.tokens(around).map(|token| token.span);
    let blocks = script
        .blocks()
        .map(|(start, block)| block.span.moved(start));
    let objects = analysis.names().objects.iter();
    let objects = objects.map(|object| object.name.to(object.braces));
    let attributes = analysis.names().objects.iter();
    let attributes = attributes.flat_map(|object| object.attributes.iter().map(|it| it.0));
    let all = token.chain(braces(analysis)).chain(blocks);
    let all = all.chain(objects).chain(attributes);
    let all = all.chain([Span::new(0, analysis.snapshot_text().len())]);
    let holds = |span: &Span| span.start <= offset && offset <= span.end;
    let mut spans: Vec<Span> = all.filter(holds).collect();
    spans.sort_by_key(|span| (span.end - span.start, span.start));
    let mut nested: Vec<Span> = Vec::new();
    for span in spans {
        let grows = nested.last().is_none_or(|last: &Span| {
            *last != span && span.start <= last.start && last.end <= span.end
        });
        if grows {
            nested.push(span);
        }
    }
    nested
}
