//! Completions: the text that the user can write at a position.

use syntax::span::Span;

use crate::text::Text;

/// One entry of a list of completions.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Completion {
    /// The name, as written and listed.
    pub label: String,
    /// The kind of its symbol.
    pub kind: CompletionKind,
    /// A short note beside the label.
    pub detail: String,
    /// The text that replaces [`Completions::range`].
    pub insert: String,
    /// True if `insert` contains placeholders: `${1:name}`.
    pub snippet: bool,
}

/// The kind of a completion, which editors show as a symbol.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
#[allow(missing_docs)]
pub enum CompletionKind {
    Keyword,
    Function,
    Surface,
    Curve,
    Constant,
    Parameter,
    Solid,
    /// The word of an attribute.
    Attribute,
    /// A word that is the value of an attribute.
    Word,
}

/// The completions at a position.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Completions {
    /// The range that a completion replaces: the part of the word that is already written.
    pub range: Span,
    /// The entries.
    pub list: Vec<Completion>,
    /// False if the list was truncated, so that the editor requests it again when more of the word is written.
    pub is_complete: bool,
}

impl Completions {
    /// Returns an empty, complete list at an offset.
    pub fn empty(offset: u32) -> Self {
        Self {
            range: Span::new(offset, offset),
            list: Vec::new(),
            is_complete: true,
        }
    }
}

/// Returns the text after the word at an offset on its line, from the first character that is not blank.
pub(crate) fn behind_word(text: &dyn Text, offset: u32) -> String {
    let next = text.line_start(text.line(offset) + 1);
    let end = next.unwrap_or(text.len());
    let rest = text.slice(Span::new(offset, end)).unwrap_or_default();
    let rest = rest.trim_start_matches(|c: char| c.is_ascii_alphanumeric());
    rest.trim().to_owned()
}
