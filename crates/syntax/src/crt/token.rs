//! The kinds of token.

use crate::span::Span;

macro_rules! token_kinds {
    ($($word:ident $text:literal)*; $($symbol:ident $sign:literal)*) => {
        /// The kind of a token, by which the productions refer to tokens.
        #[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
        #[allow(missing_docs)]
        pub enum TokenKind {
            /// A comment, from `--` to the end of the line.
            Comment,
            /// A whole number.
            Integer,
            /// A number with a decimal point.
            Float,
            /// A text between `"`.
            Text,
            /// A word that begins with a small letter.
            Identifier,
            /// A word that begins with a capital letter: the name of an object.
            Name,
            $($word,)*
            $($symbol,)*
            /// A `<` whose next token is `scale`, `translate` or `rotate`.
            Modify,
            /// A character that begins no token, or a malformed number or string.
            Error,
            /// End of input.
            Eoi,
        }

        /// The reserved words with their kinds.
        pub const RESERVED: &[(&str, TokenKind)] = &[$(($text, TokenKind::$word)),*];

        impl TokenKind {
            /// Returns the kind of a reserved word.
            pub fn from_word(word: &str) -> Option<Self> {
                Some(match word {
                    $($text => Self::$word,)*
                    _ => return None,
                })
            }

            /// Returns the longest sign at the start of a text, and its length in bytes.
            pub(crate) fn from_sign(bytes: &[u8]) -> Option<(Self, usize)> {
                // Signs of two characters come first in the table.
                $(if bytes.starts_with($sign.as_bytes()) {
                    return Some((Self::$symbol, $sign.len()));
                })*
                None
            }

            /// Returns the text of the token, if all tokens of the kind have the same text.
            pub fn text(self) -> Option<&'static str> {
                Some(match self {
                    $(Self::$word => $text,)*
                    $(Self::$symbol => $sign,)*
                    Self::Modify => "<",
                    _ => return None,
                })
            }
        }
    };
}

token_kinds! {
    Settings "Settings" Scene "Scene" Macro "Macro" Scale "scale" Translate "translate" Rotate "rotate"
    True "true" False "false" While "while" If "if" Else "else";

    Arrow "->" LessEqual "<=" GreaterEqual ">=" Equal "==" NotEqual "!=" And "&&" Or "||"
    ParenOpen "(" ParenClose ")" BracketOpen "[" BracketClose "]" BraceOpen "{" BraceClose "}"
    Comma "," Assign "=" Question "?" Colon ":" Less "<" Greater ">" Plus "+" Minus "-" Caret "^"
    Star "*" Slash "/" Percent "%" Not "!"
}

impl TokenKind {
    /// Returns true for a word that names a modifier.
    pub fn is_modifier(self) -> bool {
        matches!(self, Self::Scale | Self::Translate | Self::Rotate)
    }

    /// Returns true for a token that continues the statement above if a line begins with it, though it may be meant to begin
    /// another one.
    pub fn may_continue_line(self) -> bool {
        matches!(
            self,
            Self::Plus | Self::Minus | Self::Caret | Self::BracketOpen | Self::ParenOpen
        )
    }

    /// Returns true for a token that begins a primary expression in any context.
    pub(crate) fn begins_primary(self) -> bool {
        matches!(
            self,
            Self::Integer
                | Self::Float
                | Self::Text
                | Self::Identifier
                | Self::Name
                | Self::True
                | Self::False
                | Self::Macro
                | Self::ParenOpen
                | Self::BracketOpen
        )
    }

    /// Returns true for a token that begins an expression.
    pub(crate) fn begins_expression(self) -> bool {
        self.begins_primary() || matches!(self, Self::Plus | Self::Minus | Self::Not)
    }

    /// Returns true for a token that begins a statement.
    pub(crate) fn begins_statement(self) -> bool {
        self.begins_expression() || matches!(self, Self::While | Self::If)
    }
}

/// A token and its span.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Token {
    /// Its kind.
    pub kind: TokenKind,
    /// Its span.
    pub span: Span,
}
