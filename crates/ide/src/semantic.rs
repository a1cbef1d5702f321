//! Colours by meaning: the text's tokens in the standard types of editors.

use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::document::Piece;
use syntax::geotrace::symbols::SymbolKind;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use crate::reading::{Reading, Target, introduces_in, lexeme};

/// What a token is, in editors' standard terms.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
#[allow(missing_docs)]
pub enum TokenType {
    Keyword,
    Function,
    Variable,
    Parameter,
    Number,
    Operator,
    Comment,
}

impl TokenType {
    /// All, in the order of the legend.
    pub const ALL: [Self; 7] = [
        Self::Keyword,
        Self::Function,
        Self::Variable,
        Self::Parameter,
        Self::Number,
        Self::Operator,
        Self::Comment,
    ];

    /// Its name in the legend.
    pub fn name(self) -> &'static str {
        match self {
            Self::Keyword => "keyword",
            Self::Function => "function",
            Self::Variable => "variable",
            Self::Parameter => "parameter",
            Self::Number => "number",
            Self::Operator => "operator",
            Self::Comment => "comment",
        }
    }
}

/// The modifiers of a token, as a set of bits in the order of [`Modifiers::NAMES`].
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub struct Modifiers(pub u32);

impl Modifiers {
    /// The names, in the order of the legend: two standard ones, then the language's own.
    pub const NAMES: [&'static str; 6] = [
        "declaration",
        "defaultLibrary",
        "curve",
        "surface",
        "grid",
        "param",
    ];
    /// The name is introduced here.
    pub const DECLARATION: Self = Self(1);
    /// It is builtin.
    pub const DEFAULT_LIBRARY: Self = Self(1 << 1);
    /// A curve or a geodesic.
    pub const CURVE: Self = Self(1 << 2);
    /// A surface or a metric.
    pub const SURFACE: Self = Self(1 << 3);
    /// A grid.
    pub const GRID: Self = Self(1 << 4);
    /// A param.
    pub const PARAM: Self = Self(1 << 5);

    fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// A coloured piece of the text.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct SemanticToken {
    /// Where it is; never more than one line.
    pub span: Span,
    /// What it is.
    pub token_type: TokenType,
    /// What more there is to say.
    pub modifiers: Modifiers,
}

/// The coloured tokens that touch a range, in the order of the text and without overlap. Punctuation, words without a
/// meaning and characters that are no token have no colour.
pub fn semantic_tokens(reading: &Reading, range: Span) -> Vec<SemanticToken> {
    let document = reading.document();
    let wanted = reading.tokens_in(range);
    let first = u32::try_from(wanted.start).ok();
    let first = first.and_then(|token| document.piece_of_token(token));
    let pieces = document.pieces_from(first.map(|(piece, _)| piece));
    let all = pieces.flat_map(|piece| {
        let tokens = 0..piece.tokens().len();
        tokens.map(move |index| (piece, index))
    });
    let skipped = first.map_or(0, |(_, index)| index);
    let all = all.skip(skipped).take(wanted.len());
    all.filter_map(|(piece, index)| token(reading, piece, index))
        .collect()
}

fn token(reading: &Reading, piece: Piece<'_>, index: usize) -> Option<SemanticToken> {
    let token = lexeme(piece, piece.tokens().get(index)?);
    let span = token.span;
    let plain = |token_type| (token_type, Modifiers::default());
    let (token_type, modifiers) = match token.kind {
        TokenKind::Comment => plain(TokenType::Comment),
        TokenKind::Number(_) => plain(TokenType::Number),
        TokenKind::Declare(_) => plain(TokenType::Keyword),
        TokenKind::Plus
        | TokenKind::Minus
        | TokenKind::Star
        | TokenKind::Slash
        | TokenKind::Caret
        | TokenKind::Underscore
        | TokenKind::Prime => plain(TokenType::Operator),
        TokenKind::Constant(_)
        | TokenKind::Function(_)
        | TokenKind::Variable(_)
        | TokenKind::Undefined => {
            let (token_type, modifiers) = match reading.target_in(piece, index)? {
                Target::Parameter { .. } => plain(TokenType::Parameter),
                Target::Symbol(id) => {
                    let symbol = reading.symbol(id)?;
                    let token_type = match symbol.kind {
                        SymbolKind::Constant => TokenType::Variable,
                        SymbolKind::Function => TokenType::Function,
                    };
                    (token_type, word_modifier(symbol.word))
                }
            };
            if introduces_in(piece, index) {
                (token_type, modifiers.with(Modifiers::DECLARATION))
            } else {
                (token_type, modifiers)
            }
        }
        _ => return None,
    };
    Some(SemanticToken {
        span,
        token_type,
        modifiers,
    })
}

fn word_modifier(word: Option<DeclarationKeyword>) -> Modifiers {
    match word {
        None => Modifiers::DEFAULT_LIBRARY,
        Some(DeclarationKeyword::Curve | DeclarationKeyword::Geodesic) => Modifiers::CURVE,
        Some(DeclarationKeyword::Surface | DeclarationKeyword::Metric) => Modifiers::SURFACE,
        Some(DeclarationKeyword::Grid) => Modifiers::GRID,
        Some(DeclarationKeyword::Param) => Modifiers::PARAM,
        Some(
            DeclarationKeyword::Define
            | DeclarationKeyword::Function
            | DeclarationKeyword::Point
            | DeclarationKeyword::Vector,
        ) => Modifiers::default(),
    }
}
