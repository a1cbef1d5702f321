//! The kinds of token.

use crate::span::Span;

/// Names a symbol: the builtins first, in the order in which they were handed in, then every declared
/// name in the order of the text.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct SymbolId(pub u32);

/// The words that open a declaration.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
#[allow(missing_docs)]
pub enum DeclareWord {
    Param,
    Grid,
    Define,
    Function,
    Curve,
    Surface,
    Point,
    Vector,
    Metric,
    Geodesic,
}

/// What a token is, to the parser.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum TokenKind {
    Comment,
    /// The value as read: finite, or the token is [`TokenKind::Error`].
    Number(f64),
    Declare(DeclareWord),
    Constant(SymbolId),
    Function(SymbolId),
    /// A parameter of the body that is being read, by its position.
    Variable(u32),
    /// A word with no meaning yet.
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
    /// What it is.
    pub kind: TokenKind,
    /// Where it stands.
    pub span: Span,
}

impl DeclareWord {
    /// Every declaring word.
    pub const ALL: [Self; 10] = [
        Self::Param,
        Self::Grid,
        Self::Define,
        Self::Function,
        Self::Curve,
        Self::Surface,
        Self::Point,
        Self::Vector,
        Self::Metric,
        Self::Geodesic,
    ];

    /// As it is written.
    pub fn text(self) -> &'static str {
        match self {
            Self::Param => "param",
            Self::Grid => "grid",
            Self::Define => "define",
            Self::Function => "function",
            Self::Curve => "curve",
            Self::Surface => "surface",
            Self::Point => "point",
            Self::Vector => "vector",
            Self::Metric => "metric",
            Self::Geodesic => "geodesic",
        }
    }

    /// Whether what it declares is applied (it has parameters) rather than a value.
    pub fn declares_function(self) -> bool {
        matches!(
            self,
            Self::Function | Self::Curve | Self::Surface | Self::Metric | Self::Geodesic
        )
    }

    /// The declaring word that is written so.
    pub fn from_text(text: &str) -> Option<Self> {
        Some(match text {
            "param" => Self::Param,
            "grid" => Self::Grid,
            "define" => Self::Define,
            "function" => Self::Function,
            "curve" => Self::Curve,
            "surface" => Self::Surface,
            "point" => Self::Point,
            "vector" => Self::Vector,
            "metric" => Self::Metric,
            "geodesic" => Self::Geodesic,
            _ => return None,
        })
    }
}
