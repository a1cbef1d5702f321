//! Colours by meaning: the tokens of a text in the standard types of editors.

use syntax::geotrace::declarations::{Category, DeclarationKeyword};
use syntax::geotrace::document::PlacedChunk;
use syntax::geotrace::highlight;
use syntax::geotrace::symbols::SymbolKind;
use syntax::geotrace::token::TokenKind;
use syntax::highlight::HighlightKind;
use syntax::span::Span;

use super::analysis::{GeotraceAnalysis, lexeme};
use super::targets::{ChunkTargets, Target};
use crate::semantic::{Modifiers, SemanticToken, TokenType};

/// Returns the coloured tokens that touch a range, in the order of the text and without overlaps. Punctuation,
/// undefined words and characters that form no token have no colour.
pub fn semantic_tokens(analysis: &GeotraceAnalysis, range: Span) -> Vec<SemanticToken> {
    let document = analysis.document();
    let wanted = analysis.tokens_in(range);
    let first = u32::try_from(wanted.start).ok();
    let first = first.and_then(|token| document.placed_chunk_of_token(token));
    let placed_chunks = document.placed_chunks_from(first.map(|(placed, _)| placed));
    let mut skipped = first.map_or(0, |(_, index)| index);
    let mut left = wanted.len();
    let mut found = Vec::new();
    for placed in placed_chunks {
        if left == 0 {
            break;
        }
        let end = placed.tokens().len().min(skipped + left);
        let targets = ChunkTargets::new(placed);
        let tokens = skipped..end;
        left -= tokens.len();
        skipped = 0;
        found.extend(tokens.filter_map(|index| token(analysis, placed, &targets, index)));
    }
    found
}

fn token(
    analysis: &GeotraceAnalysis,
    placed: PlacedChunk<'_>,
    targets: &ChunkTargets<'_>,
    index: usize,
) -> Option<SemanticToken> {
    let token = lexeme(placed, placed.tokens().get(index)?);
    let span = token.span;
    let plain = |token_type| (token_type, Modifiers::default());
    let (token_type, modifiers) = match token.kind {
        TokenKind::Comment => plain(TokenType::Comment),
        TokenKind::Number(_) => plain(TokenType::Number),
        TokenKind::Declare(_) => plain(TokenType::Keyword),
        kind if highlight::kind(kind) == Some(HighlightKind::Operator) => {
            plain(TokenType::Operator)
        }
        TokenKind::Attribute(_) => plain(TokenType::Property),
        TokenKind::Word => plain(TokenType::EnumMember),
        TokenKind::Map(_) => (TokenType::Function, Modifiers::DEFAULT_LIBRARY),
        TokenKind::Constant(_)
        | TokenKind::Function(_)
        | TokenKind::Variable(_)
        | TokenKind::Undefined => {
            let (token_type, modifiers) = match targets.target(analysis, index)? {
                Target::Parameter { .. } => plain(TokenType::Parameter),
                Target::Symbol(id) => {
                    let symbol = analysis.symbol(id)?;
                    let token_type = match symbol.kind {
                        SymbolKind::Constant => TokenType::Variable,
                        SymbolKind::Function => TokenType::Function,
                    };
                    (
                        token_type,
                        category_modifier(symbol.keyword.map(DeclarationKeyword::category)),
                    )
                }
            };
            if targets.introduces(index) {
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

fn category_modifier(category: Option<Category>) -> Modifiers {
    match category {
        None => Modifiers::DEFAULT_LIBRARY,
        Some(Category::Curve) => Modifiers::CURVE,
        Some(Category::Surface | Category::Metric) => Modifiers::SURFACE,
        Some(Category::Grid) => Modifiers::GRID,
        Some(Category::Slider) => Modifiers::PARAM,
        Some(Category::Solid) => Modifiers::SOLID,
        Some(Category::Constant | Category::Function | Category::Stage) => Modifiers::default(),
    }
}
