//! Links from a text to files.

use syntax::span::Span;

/// A file that a text names.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct FileLink {
    /// The span of the name, without quotes.
    pub span: Span,
    /// The path, relative to the folder of the text.
    pub path: String,
}
