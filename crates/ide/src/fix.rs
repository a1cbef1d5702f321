//! What can be done about a mistake, as edits.

use syntax::diagnostic::Diagnostic;
use syntax::span::Span;

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
    let fixes = touching.flat_map(|diagnostic| {
        let fixes = diagnostic.fixes.iter();
        fixes.map(move |fix| Fix {
            title: fix.title.clone(),
            edits: vec![Edit::replace(fix.span, fix.replacement.as_str())],
            diagnostic: diagnostic.clone(),
            preferred: fix.preferred,
        })
    });
    fixes.collect()
}
