//! Fixes of mistakes, as edits.

use syntax::diagnostic::Diagnostic;
use syntax::span::Span;

use crate::edit::Edit;

/// A change that fixes a diagnostic.
#[derive(Clone, Debug, PartialEq)]
pub struct Fix {
    /// An imperative sentence: "Write `sin(2x)`".
    pub title: String,
    /// The edits.
    pub edits: Vec<Edit>,
    /// The diagnostic that the edits fix.
    pub diagnostic: Diagnostic,
    /// True for the fix that an editor may apply without asking.
    pub preferred: bool,
}

/// Returns the fixes of the diagnostics that touch a range.
pub fn fixes(diagnostics: &[Diagnostic], range: Span) -> Vec<Fix> {
    let touching = diagnostics
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
