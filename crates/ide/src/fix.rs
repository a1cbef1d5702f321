//! Corrections of mistakes, as edits.

use syntax::diagnostic::Diagnostic;
use syntax::span::Span;

use crate::edit::Edit;
use crate::text::Text;

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

/// Returns the edits of all fixes that may be applied together, and the number of those fixes. A fix that only inserts leaves
/// the text between its insertions unchanged, so such fixes may be nested; of other overlapping fixes, the first is applied.
pub fn fix_all(diagnostics: &[Diagnostic], text: &dyn Text) -> (Vec<Edit>, usize) {
    let fixes = diagnostics
        .iter()
        .filter_map(|diagnostic| diagnostic.fixes.iter().find(|fix| fix.all));
    let mut edits: Vec<Edit> = Vec::new();
    let mut count = 0;
    for fix in fixes {
        let old = text.slice(fix.span).unwrap_or_default();
        let own = insertions(&old, &fix.replacement, fix.span.start)
            .unwrap_or_else(|| vec![Edit::replace(fix.span, fix.replacement.as_str())]);
        let overlaps = |edit: &Edit| {
            let meets = |other: &Edit| {
                let (a, b) = (edit.span, other.span);
                a.start < b.end && b.start < a.end
            };
            edits.iter().any(meets)
        };
        if !own.iter().any(overlaps) {
            edits.extend(own);
            count += 1;
        }
    }
    edits.sort_by_key(|edit| edit.span);
    (edits, count)
}

/// Returns the insertions that turn `old`, whose text starts at an offset, into `new`; `None` if text has to be
/// removed.
fn insertions(old: &str, new: &str, start: u32) -> Option<Vec<Edit>> {
    let mut edits: Vec<Edit> = Vec::new();
    let mut rest = old.char_indices().peekable();
    for sign in new.chars() {
        if rest.next_if(|(_, next)| *next == sign).is_some() {
            continue;
        }
        let at = start + rest.peek().map_or(old.len(), |(at, _)| *at) as u32;
        match edits.last_mut().filter(|last| last.span.start == at) {
            Some(last) => last.text.push(sign),
            None => edits.push(Edit::insert(at, sign)),
        }
    }
    rest.next().is_none().then_some(edits)
}

#[cfg(test)]
mod tests {
    use super::{fix_all, insertions};
    use crate::edit::{Edit, apply};
    use crate::geotrace::GeotraceAnalysis;
    use crate::text::PlainText;

    #[test]
    fn a_replacement_that_only_adds_is_insertions() {
        let edits = vec![Edit::insert(3, "("), Edit::insert(9, ")")];
        assert_eq!(insertions("cos(t)^2", "(cos(t))^2", 3), Some(edits));
        assert_eq!(insertions("ln", "log", 0), None);
        assert_eq!(insertions("", ";", 7), Some(vec![Edit::insert(7, ";")]));
    }

    #[test]
    fn powers_inside_powers_are_fixed_at_once() {
        for (text, fixed) in [
            (
                "function f(t) = (cos(t)^2, sin(cos(t)^2)^3, ln(t));\nfunction g(t) = f(t)_1",
                "function f(t) = ((cos(t))^2, (sin((cos(t))^2))^3, log(t));\nfunction g(t) = (f(t))_1;",
            ),
            ("define a = sin 2pi;", "define a = sin 2pi;"),
            ("// one\ndefine a = 2π;", "# one\ndefine a = 2pi;"),
        ] {
            let analysis = GeotraceAnalysis::new(text);
            let plain = PlainText::new(text).expect("a short text");
            let (edits, count) = fix_all(analysis.diagnostics(), &plain);
            assert_eq!(apply(text, &edits), fixed);
            assert_eq!(count == 0, text == fixed);
        }
    }
}
