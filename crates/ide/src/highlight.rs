//! Colours for an editor that shows a text by itself, as the program pane of the window does.

use syntax::span::Span;

use crate::semantic::{SemanticToken, TokenType};

/// The kind of a part of the text, to the eye.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum HighlightKind {
    /// A comment.
    Comment,
    /// A number.
    Number,
    /// A word of the language.
    Keyword,
    /// A name that stands for a value.
    Constant,
    /// A name that is applied.
    Function,
    /// A parameter.
    Variable,
    /// An operator.
    Operator,
    /// Brackets and separators.
    Punctuation,
    /// A word without a meaning.
    Undefined,
    /// Characters that are not a token.
    Error,
}

/// A coloured part of a text.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Highlight {
    /// Its range.
    pub span: Span,
    /// Its kind.
    pub kind: HighlightKind,
}

/// The colours of semantic tokens.
pub(crate) fn from_tokens(tokens: &[SemanticToken]) -> Vec<Highlight> {
    let highlights = tokens.iter().map(|token| Highlight {
        span: token.span,
        kind: match token.token_type {
            TokenType::Keyword => HighlightKind::Keyword,
            TokenType::Function => HighlightKind::Function,
            TokenType::Variable => HighlightKind::Constant,
            TokenType::Parameter => HighlightKind::Variable,
            TokenType::Number => HighlightKind::Number,
            TokenType::Operator => HighlightKind::Operator,
            TokenType::Comment => HighlightKind::Comment,
        },
    });
    highlights.collect()
}
