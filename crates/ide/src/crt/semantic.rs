//! Semantic tokens of a script. Strings are left to the editor's own grammar.

use syntax::crt::objects::FUNCTIONS;
use syntax::crt::token::TokenKind;
use syntax::span::Span;

use super::CrtAnalysis;
use super::names::Origin;
use crate::semantic::{Modifiers, SemanticToken, TokenType};

/// The coloured tokens that touch a range.
pub(super) fn semantic_tokens(analysis: &CrtAnalysis, range: Span) -> Vec<SemanticToken> {
    let attributes = analysis.names().attribute_names();
    let mut tokens = Vec::new();
    for token in analysis.tokens(range) {
        let (token_type, modifiers) = match token.kind {
            TokenKind::Comment => (TokenType::Comment, Modifiers::default()),
            TokenKind::Integer | TokenKind::Float => (TokenType::Number, Modifiers::default()),
            TokenKind::Name => (TokenType::Function, Modifiers::DEFAULT_LIBRARY),
            TokenKind::Identifier if attributes.binary_search(&token.span).is_ok() => {
                (TokenType::Property, Modifiers::default())
            }
            TokenKind::Identifier => identifier(analysis, token.span),
            kind if is_word(kind) => (TokenType::Keyword, Modifiers::default()),
            kind if is_operator(kind) => (TokenType::Operator, Modifiers::default()),
            _ => continue,
        };
        tokens.push(SemanticToken {
            span: token.span,
            token_type,
            modifiers,
        });
    }
    tokens
}

fn identifier(analysis: &CrtAnalysis, span: Span) -> (TokenType, Modifiers) {
    let names = analysis.names();
    let Some((_, variable)) = names.variable_at(span.start + 1) else {
        let text = analysis.slice(span);
        let is_function = FUNCTIONS.iter().any(|(name, ..)| *name == text);
        return match is_function {
            true => (TokenType::Function, Modifiers::DEFAULT_LIBRARY),
            false => (TokenType::Variable, Modifiers::default()),
        };
    };
    let token_type = match names.variable(variable).origin {
        Origin::Parameter => TokenType::Parameter,
        Origin::Macro => TokenType::Function,
        Origin::Object(_) | Origin::Value => TokenType::Variable,
    };
    let modifiers = match names.first(variable) == Some(span) {
        true => Modifiers::DECLARATION,
        false => Modifiers::default(),
    };
    (token_type, modifiers)
}

fn is_word(kind: TokenKind) -> bool {
    let text = kind.text().unwrap_or_default();
    text.starts_with(|c: char| c.is_ascii_alphabetic())
}

fn is_operator(kind: TokenKind) -> bool {
    !matches!(
        kind,
        TokenKind::ParenOpen
            | TokenKind::ParenClose
            | TokenKind::BracketOpen
            | TokenKind::BracketClose
            | TokenKind::BraceOpen
            | TokenKind::BraceClose
            | TokenKind::Comma
            | TokenKind::Text
            | TokenKind::Error
            | TokenKind::Eoi
    )
}
