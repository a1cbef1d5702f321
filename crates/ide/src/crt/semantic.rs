//! Semantic tokens of a script. Strings are left to the editor's own grammar.

use syntax::crt::highlight;
use syntax::crt::objects::FUNCTIONS;
use syntax::crt::token::TokenKind;
use syntax::highlight::HighlightKind;
use syntax::span::Span;

use super::CrtAnalysis;
use super::names::Origin;
use crate::semantic::{Modifiers, SemanticToken, TokenType};

/// Returns the coloured tokens that touch a range.
pub(super) fn semantic_tokens(analysis: &CrtAnalysis, range: Span) -> Vec<SemanticToken> {
    let attributes = analysis.names().attribute_names();
    let mut tokens = Vec::new();
    for token in analysis.tokens(range) {
        let (token_type, modifiers) = match token.kind {
            TokenKind::Name => (TokenType::Function, Modifiers::DEFAULT_LIBRARY),
            TokenKind::Identifier if attributes.binary_search(&token.span).is_ok() => {
                (TokenType::Property, Modifiers::default())
            }
            TokenKind::Identifier => identifier(analysis, token.span),
            kind => match highlight::kind(kind).and_then(token_type) {
                Some(token_type) => (token_type, Modifiers::default()),
                None => continue,
            },
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

/// Returns the type of a token that is determined by its kind alone.
fn token_type(kind: HighlightKind) -> Option<TokenType> {
    match kind {
        HighlightKind::Comment => Some(TokenType::Comment),
        HighlightKind::Number => Some(TokenType::Number),
        HighlightKind::Keyword | HighlightKind::Constant => Some(TokenType::Keyword),
        HighlightKind::Operator => Some(TokenType::Operator),
        _ => None,
    }
}
