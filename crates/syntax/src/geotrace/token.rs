//! The kinds of token.

use super::declarations::DeclarationKeyword;
use crate::span::Span;
use crate::symbol::SymbolId;

/// The kind of a token, for the parser.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum TokenKind {
    Comment,
    /// The value as read: finite, or the token is [`TokenKind::Error`].
    Number(f64),
    Declare(DeclarationKeyword),
    Constant(SymbolId),
    Function(SymbolId),
    /// A parameter of the body that is being read, by its position.
    Variable(u32),
    /// A word that is not defined.
    Undefined,
    Plus,
    Minus,
    Star,
    Slash,
    Caret,
    Underscore,
    Prime,
    ParenOpen,
    ParenClose,
    BracketOpen,
    BracketClose,
    BraceOpen,
    BraceClose,
    Comma,
    Semicolon,
    Colon,
    Equals,
    At,
    /// Any other character, or a malformed number.
    Error,
    /// End of input.
    Eoi,
}

/// One token and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Token {
    /// Its kind.
    pub kind: TokenKind,
    /// Its place.
    pub span: Span,
}
