//! Hover: a description of the word under the cursor, and the value of its application.

use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use super::application;
use super::describe;
use crate::description::Description;

/// Returns the description of the word at an offset, and the word's range.
pub fn hover(analysis: &GeotraceAnalysis, offset: u32) -> Option<(Span, Description)> {
    let k = analysis.token_at(offset)?;
    let token = analysis.token(k)?;
    let word = match token.kind {
        TokenKind::Declare(keyword) => Some(describe::keyword(keyword)),
        TokenKind::Map(map) => Some(describe::map(map)),
        TokenKind::Attribute(_) | TokenKind::Word => Some(describe::stated_attribute(analysis, k)?),
        _ => None,
    };
    if let Some(description) = word {
        return Some((token.span, description));
    }
    let mut description = describe::describe(analysis, analysis.target(k)?)?;
    let mut text = application::describe(analysis, k);
    text.append(&mut description.text);
    description.text = text;
    Some((token.span, description))
}
