//! The kinds of token.

use super::attributes::AttributeWord;
use super::declarations::DeclarationKeyword;
use crate::span::Span;
use crate::symbol::SymbolId;

/// Passes the table of symbols to a macro: the name of each token and its byte, the most frequent symbols first.
macro_rules! with_symbols {
    ($macro:ident) => {
        $macro! {
            Comma b',' ParenOpen b'(' ParenClose b')' Plus b'+' Minus b'-' Slash b'/' Semicolon b';' Equals b'='
            BracketOpen b'[' BracketClose b']' Colon b':' Caret b'^' Underscore b'_' Prime b'\'' Star b'*' At b'@'
            BraceOpen b'{' BraceClose b'}' Bar b'|' Ampersand b'&' Backslash b'\\'
        }
    };
}
pub(crate) use with_symbols;

macro_rules! token_kinds {
    ($($symbol:ident $byte:literal)*) => {
        /// The kind of a token, for the parser.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[allow(missing_docs)]
        pub enum TokenKind {
            Comment,
            /// The value as read, which is finite: otherwise the token is [`TokenKind::Error`].
            Number(f64),
            Declare(DeclarationKeyword),
            Constant(SymbolId),
            Function(SymbolId),
            /// A parameter of the body that is being read, by its index.
            Variable(u32),
            /// An undefined word.
            Undefined,
            /// The word of an attribute, after a `,` of a declaration.
            Attribute(AttributeWord),
            /// The word that is the value of an attribute.
            Word,
            /// The word of a map, right after the `@` of a set.
            Map(MapWord),
            $($symbol,)*
            /// Any other character, or a malformed number.
            Error,
            /// End of input.
            Eoi,
        }

        impl TokenKind {
            /// The kinds without a value.
            pub(crate) const PLAIN: &[Self] =
                &[$(Self::$symbol,)* Self::Comment, Self::Undefined, Self::Word, Self::Error, Self::Eoi];

            /// Returns true for a name that stands for a value.
            pub(crate) fn is_value(self) -> bool {
                matches!(self, Self::Variable(_) | Self::Constant(_))
            }

            /// Returns the symbol with this byte.
            pub(crate) fn from_byte(byte: u8) -> Option<Self> {
                Some(match byte {
                    $($byte => Self::$symbol,)*
                    _ => return None,
                })
            }
        }
    };
}

with_symbols!(token_kinds);

/// A map of space with a keyword.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum MapWord {
    /// `scale`, by a number or by one number along each axis.
    Scale,
    /// `rotate`, about a vector by its length in radians.
    Rotate,
}

impl MapWord {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Scale, Self::Rotate];

    /// Returns the word as written.
    pub fn text(self) -> &'static str {
        match self {
            Self::Scale => "scale",
            Self::Rotate => "rotate",
        }
    }

    /// Returns the map with this word.
    pub fn from_text(text: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|map| map.text() == text)
    }
}

/// A token and its span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Token {
    /// Its kind.
    pub kind: TokenKind,
    /// Its span.
    pub span: Span,
}
