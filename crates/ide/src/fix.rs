//! What can be done about a mistake, as edits.

use syntax::codes;
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;
use syntax::token::TokenKind;

use crate::edit::Edit;
use crate::reading::Reading;

/// A change that mends something.
#[derive(Clone, Debug, PartialEq)]
pub struct Fix {
    /// What it does, as an order: "Write `sin(2x)`".
    pub title: String,
    /// The edits.
    pub edits: Vec<Edit>,
    /// The finding that it mends.
    pub diagnostic: Diagnostic,
    /// Whether it is the one to take without a thought.
    pub preferred: bool,
}

/// What can be done about the findings that touch a range.
pub fn fixes(reading: &Reading, range: Span) -> Vec<Fix> {
    let touching = reading
        .diagnostics()
        .iter()
        .filter(|d| d.span.start <= range.end && range.start <= d.span.end);
    touching.flat_map(|d| of(reading, d)).collect()
}

fn of(reading: &Reading, diagnostic: &Diagnostic) -> Vec<Fix> {
    let fix = |title: String, edits: Vec<Edit>, preferred: bool| Fix {
        title,
        edits,
        diagnostic: diagnostic.clone(),
        preferred,
    };
    let hint = diagnostic.hint.as_deref().unwrap_or_default();
    if diagnostic.code == codes::MISSING_SEMICOLON {
        // The finding stands at the token that was not accepted: the `;` is missing behind the one before.
        let ended = reading.document().tokens_ended(diagnostic.span.start) as usize;
        let before = reading
            .tokens_before(ended)
            .find(|token| token.kind != TokenKind::Comment);
        let offset = before.map_or(diagnostic.span.start, |token| token.span.end);
        return vec![fix(
            "Insert `;`".to_owned(),
            vec![Edit::insert(offset, ";")],
            true,
        )];
    }
    if hint.starts_with("did you mean") {
        let meant = quoted(hint);
        let alone = meant.len() == 1;
        return meant
            .into_iter()
            .map(|word| {
                let span = meant_span(reading, diagnostic.span, word);
                fix(
                    format!("Change to `{word}`"),
                    vec![Edit::replace(span, word)],
                    alone,
                )
            })
            .collect();
    }
    if diagnostic.code == codes::SURPRISING_READING {
        // A name that hides a split above: the place above is written apart.
        if let Some(related) = diagnostic.related.first() {
            let at = reading.document().tokens_begun(related.span.start) as usize;
            let token = reading.token(at);
            let seam = token
                .filter(|token| token.span.start == related.span.start)
                .map(|token| token.span.end);
            return seam
                .map(|offset| {
                    fix(
                        "Insert a space above".to_owned(),
                        vec![Edit::insert(offset, " ")],
                        true,
                    )
                })
                .into_iter()
                .collect();
        }
        if hint.starts_with("write") {
            // What is offered only says the operand by `x` where the finding does not cover it.
            return quoted(hint)
                .into_iter()
                .filter(|text| !text.contains('…') && !text.ends_with(" x"))
                .map(|text| {
                    let title = format!("Write `{text}`");
                    fix(title, vec![Edit::replace(diagnostic.span, text)], false)
                })
                .collect();
        }
    }
    Vec::new()
}

/// What a suggestion takes the place of: the undefined rest of a word, or the whole word, whichever it is nearer to.
fn meant_span(reading: &Reading, span: Span, word: &str) -> Span {
    let text = reading.text();
    let bytes = text.as_bytes();
    let mut start = span.start;
    while start > 0 && bytes[start as usize - 1].is_ascii_alphanumeric() {
        start -= 1;
    }
    // Digits before the first letter are a number.
    while start < span.start && bytes[start as usize].is_ascii_digit() {
        start += 1;
    }
    let whole = Span::new(start, span.end);
    if distance(whole.text(text), word) <= distance(span.text(text), word) {
        whole
    } else {
        span
    }
}

/// The least number of insertions, deletions and substitutions that turn one word into the other.
fn distance(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.bytes().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.bytes().enumerate() {
            let changed = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// The pieces of a sentence that stand between back-quotes.
fn quoted(sentence: &str) -> Vec<&str> {
    sentence.split('`').skip(1).step_by(2).collect()
}
