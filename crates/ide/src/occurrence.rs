//! Occurrences of a name.

use syntax::span::Span;

/// An occurrence of a name.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Occurrence {
    /// The range of the name.
    pub span: Span,
    /// True if this occurrence introduces the name.
    pub introduces: bool,
}
