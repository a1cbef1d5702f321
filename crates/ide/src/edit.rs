//! Changes of a text, as data.

use syntax::span::Span;

use crate::text::Text;

/// A piece of the text and its replacement.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Edit {
    /// The range that is replaced; empty to insert.
    pub span: Span,
    /// The new text.
    pub text: String,
}

impl Edit {
    /// Creates an edit that inserts a text at an offset.
    pub fn insert(offset: u32, text: impl Into<String>) -> Self {
        Self {
            span: Span::new(offset, offset),
            text: text.into(),
        }
    }

    /// Creates an edit that appends lines after the last one.
    pub(crate) fn append(text: &dyn Text, lines: &str) -> Self {
        let end = text.len();
        let last = text.slice(Span::new(end.saturating_sub(1), end));
        let gap = match last.as_deref() {
            Some("" | "\n") => "",
            // The last byte cannot be read alone if it is part of a longer character.
            _ => "\n",
        };
        Self::insert(end, format!("{gap}{lines}"))
    }

    /// Creates an edit that replaces a range.
    pub fn replace(span: Span, text: impl Into<String>) -> Self {
        Self {
            span,
            text: text.into(),
        }
    }

    /// Returns the part of an edit of white space that concerns the line that begins at `start`, and those below it; `None` if
    /// it changes nothing there.
    pub(crate) fn clipped(self, start: u32, text: &dyn Text) -> Option<Self> {
        if start <= self.span.start {
            return Some(self);
        }
        let above = text.slice(Span::new(self.span.start, start))?;
        let breaks = above.matches('\n').count();
        let rest = self.text.splitn(breaks + 1, '\n').last()?;
        let span = Span::new(start, self.span.end);
        let old = text.slice(span)?;
        (old != rest).then(|| Self::replace(span, rest))
    }
}

/// Returns the text after edits that do not overlap, in any order; edits at the same position are applied in the given
/// order.
pub fn apply(text: &str, edits: &[Edit]) -> String {
    let mut order: Vec<&Edit> = edits.iter().collect();
    order.sort_by_key(|edit| edit.span);
    let mut result = String::with_capacity(text.len());
    let mut at = 0;
    for edit in order {
        let (start, end) = (edit.span.start as usize, edit.span.end as usize);
        debug_assert!(at <= start, "edits overlap");
        result.push_str(&text[at..start]);
        result.push_str(&edit.text);
        at = end;
    }
    result.push_str(&text[at..]);
    result
}

#[cfg(test)]
mod tests {
    use super::{Edit, apply};
    use syntax::span::Span;

    #[test]
    fn edits_are_applied_whatever_their_order() {
        let edits = [
            Edit::replace(Span::new(4, 5), "y"),
            Edit::insert(0, "# "),
            Edit::insert(5, "!"),
        ];
        assert_eq!(apply("a = x;", &edits), "# a = y!;");
    }
}
