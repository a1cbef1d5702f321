//! The structure of a text: its declarations, its foldable ranges, and the selections around a cursor.

use syntax::geotrace::declarations::{COORDINATES, Category, DeclarationKeyword};
use syntax::geotrace::symbols::Symbol;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use crate::outline::{Fold, OutlineEntry, OutlineKind};

/// Returns every declaration with a name, in the order of the text.
pub fn outline(analysis: &GeotraceAnalysis) -> Vec<OutlineEntry> {
    let items = analysis.items();
    items
        .filter(|item| !item.name.is_empty())
        .map(|item| OutlineEntry {
            name: item.name.to_owned(),
            kind: kind(item.keyword.category()),
            keyword: item.keyword.text(),
            detail: parameters(item.parameters().map(|(name, _)| name)),
            span: item.span,
            name_span: item.name_span,
        })
        .collect()
}

fn kind(category: Category) -> OutlineKind {
    match category {
        Category::Slider | Category::Grid => OutlineKind::Variable,
        Category::Constant => OutlineKind::Constant,
        Category::Function => OutlineKind::Function,
        Category::Curve
        | Category::Surface
        | Category::Metric
        | Category::Solid
        | Category::Stage => OutlineKind::Object,
    }
}

/// Returns the parameters of a symbol; for a solid that lists none, the coordinates.
pub(crate) fn parameters_of(symbol: &Symbol) -> impl Iterator<Item = &str> {
    let implied: &[&str] = match symbol.keyword {
        Some(DeclarationKeyword::Solid) if symbol.parameters.is_empty() => &COORDINATES,
        _ => &[],
    };
    let stated = symbol.parameters.iter().map(|own| own.name.as_str());
    stated.chain(implied.iter().copied())
}

/// Returns `(u, v)`, or an empty text.
pub(crate) fn parameters<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() {
        String::new()
    } else {
        format!("({})", names.join(", "))
    }
}

/// Returns the declarations and runs of comment lines that span more than one line.
pub fn folds(analysis: &GeotraceAnalysis) -> Vec<Fold> {
    let text = analysis.text();
    let lines = |span: Span| span.text(text).contains('\n');
    let mut folds: Vec<Fold> = analysis
        .items()
        .map(|item| item.span)
        .filter(|&span| lines(span))
        .map(|span| Fold {
            span,
            comment: false,
        })
        .collect();
    let mut run: Option<Span> = None;
    let mut close = |run: &mut Option<Span>| {
        folds.extend(run.take().filter(|&span| lines(span)).map(|span| Fold {
            span,
            comment: true,
        }));
    };
    for token in analysis.tokens(0..analysis.token_count()) {
        if token.kind != TokenKind::Comment || !opens_line(text, token.span.start) {
            close(&mut run);
            continue;
        }
        run = match run {
            Some(span) if follows(text, span, token.span) => Some(span.to(token.span)),
            _ => {
                close(&mut run);
                Some(token.span)
            }
        };
    }
    close(&mut run);
    folds.sort_by_key(|fold| fold.span);
    folds
}

fn opens_line(text: &str, offset: u32) -> bool {
    let before = &text[..offset as usize];
    let line = before.rfind('\n').map_or(before, |at| &before[at + 1..]);
    line.trim().is_empty()
}

/// Returns true if two comments are on consecutive lines.
fn follows(text: &str, one: Span, other: Span) -> bool {
    let between = &text[one.end as usize..other.start as usize];
    between.matches('\n').count() == 1
}

/// Returns the ranges around an offset, from the smallest to the whole text: token, operands, declaration.
pub fn selection(analysis: &GeotraceAnalysis, offset: u32) -> Vec<Span> {
    let holds = |span: &Span| span.start <= offset && offset <= span.end;
    let mut spans: Vec<Span> = Vec::new();
    let token = analysis.token_at(offset).and_then(|k| analysis.token(k));
    spans.extend(token.map(|token| token.span));
    if let Some(item) = analysis.item_at(offset) {
        spans.extend(item.operands().filter(holds));
        spans.extend(item.intervals().filter(holds));
        spans.push(item.span);
    }
    spans.push(Span::new(0, analysis.len()));
    spans.sort_by_key(|span| span.end - span.start);
    // Each contains the previous one; ranges that only overlap it are omitted.
    let mut chain: Vec<Span> = Vec::new();
    for span in spans {
        let fits = chain
            .last()
            .is_none_or(|last| span != *last && span.start <= last.start && last.end <= span.end);
        if fits {
            chain.push(span);
        }
    }
    chain
}
