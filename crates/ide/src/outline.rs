//! The shape of a text: what it declares, what folds, what grows around a cursor.

use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use crate::reading::Reading;

/// A declaration for a list of them.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct OutlineEntry {
    /// Its name.
    pub name: String,
    /// The word that declares it.
    pub word: DeclarationKeyword,
    /// Its parameters as they are written: `(u, v)`; empty for a value.
    pub detail: String,
    /// The whole declaration.
    pub span: Span,
    /// Its name.
    pub name_span: Span,
}

/// Every declaration with a name, in the order of the text.
pub fn outline(reading: &Reading) -> Vec<OutlineEntry> {
    let items = reading.items();
    items
        .filter(|item| !item.name.is_empty())
        .map(|item| OutlineEntry {
            name: item.name.to_owned(),
            word: item.word,
            detail: parameters(item.parameters().map(|(name, _)| name)),
            span: item.span,
            name_span: item.name_span,
        })
        .collect()
}

/// `(u, v)`, or nothing.
pub(crate) fn parameters<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() {
        String::new()
    } else {
        format!("({})", names.join(", "))
    }
}

/// Something that can be folded away.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Fold {
    /// From its first to its last character.
    pub span: Span,
    /// A run of comments rather than a declaration.
    pub comment: bool,
}

/// Declarations and runs of comment lines that take more than one line.
pub fn folds(reading: &Reading) -> Vec<Fold> {
    let text = reading.text();
    let lines = |span: Span| span.text(text).contains('\n');
    let mut folds: Vec<Fold> = reading
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
    for token in reading.tokens(0..reading.token_count()) {
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

/// Whether two comments stand on lines that follow each other.
fn follows(text: &str, one: Span, other: Span) -> bool {
    let between = &text[one.end as usize..other.start as usize];
    between.matches('\n').count() == 1
}

/// The ranges around a place, from the smallest to the whole text: token, operands, declaration.
pub fn selection(reading: &Reading, offset: u32) -> Vec<Span> {
    let holds = |span: &Span| span.start <= offset && offset <= span.end;
    let mut spans: Vec<Span> = Vec::new();
    let token = reading.token_at(offset).and_then(|k| reading.token(k));
    spans.extend(token.map(|token| token.span));
    if let Some(item) = reading.item_at(offset) {
        spans.extend(item.operands().filter(holds));
        spans.extend(item.intervals().filter(holds));
        spans.push(item.span);
    }
    spans.push(Span::new(0, reading.len()));
    spans.sort_by_key(|span| span.end - span.start);
    // Each holds the one before; what only overlaps it is left out.
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
