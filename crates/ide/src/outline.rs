//! The structure of a text: its declarations and its foldable ranges.

use syntax::span::Span;

/// A named declaration.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct OutlineEntry {
    /// The declared name.
    pub name: String,
    /// The kind of symbol that editors show.
    pub kind: OutlineKind,
    /// The keyword of the declaration.
    pub keyword: &'static str,
    /// The parameters as written: `(u, v)`; empty for a value.
    pub detail: String,
    /// The range of the whole declaration.
    pub span: Span,
    /// The range of the name.
    pub name_span: Span,
}

/// The spans of a named declaration.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct DeclarationRange {
    /// The range of the whole declaration.
    pub span: Span,
    /// The range of the name.
    pub name_span: Span,
}

/// The kind of a declaration in an outline.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum OutlineKind {
    /// A value that the user can change: a param.
    Variable,
    /// A fixed value.
    Constant,
    /// A function.
    Function,
    /// An object with a shape: a curve, a surface.
    Object,
}

/// A foldable range.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Fold {
    /// The range from the first to the last character.
    pub span: Span,
    /// True for a run of comments, false for a declaration.
    pub comment: bool,
}
