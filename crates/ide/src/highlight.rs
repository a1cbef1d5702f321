//! Colours for an editor without semantic tokens, such as the program pane of the window.

pub use syntax::highlight::HighlightKind;
use syntax::span::Span;

use crate::semantic::{SemanticToken, TokenType};

/// A coloured part of a text.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Highlight {
    /// Its range.
    pub span: Span,
    /// Its kind.
    pub kind: HighlightKind,
}

/// Returns the colours of semantic tokens.
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
            TokenType::Property => HighlightKind::Keyword,
            TokenType::EnumMember => HighlightKind::Constant,
        },
    });
    highlights.collect()
}
