//! The function whose arguments are being written.

use expr::ops::Binary;
use syntax::geotrace::token::TokenKind;
use syntax::symbol::SymbolId;

use super::analysis::GeotraceAnalysis;
use super::outline::{parameters, parameters_of};
use crate::signature::Signature;

/// Returns the innermost function with a bracket around an offset.
pub fn signature(analysis: &GeotraceAnalysis, offset: u32) -> Option<Signature> {
    let mut at = analysis.document().tokens_ended(offset) as usize;
    let behind = analysis.token(at);
    if behind.is_some_and(|it| it.kind == TokenKind::Comment && it.span.start < offset) {
        return None;
    }
    let mut depth = 0;
    let mut commas = 0;
    while let Some(k) = at.checked_sub(1) {
        at = k;
        let token = analysis.token(k)?;
        match token.kind {
            TokenKind::Comment if token.span.end == offset => return None,
            TokenKind::Semicolon | TokenKind::Declare(_) => return None,
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => depth += 1,
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen if depth > 0 => {
                depth -= 1;
            }
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => {
                if let Some(signature) = of_function_before(analysis, k, commas) {
                    return Some(signature);
                }
                // A plain bracket: continue with the bracket around it.
                commas = 0;
            }
            TokenKind::Comma if depth == 0 => commas += 1,
            _ => {}
        }
    }
    None
}

/// Returns the signature of the function right before a bracket: `f(`, `f'(`, `f_u(`, `f^2(`.
fn of_function_before(
    analysis: &GeotraceAnalysis,
    bracket: usize,
    active: u32,
) -> Option<Signature> {
    let symbol = analysis.symbol(function_before(analysis, before_power(analysis, bracket))?)?;
    let names: Vec<&str> = match symbol.keyword {
        Some(_) => parameters_of(symbol).collect(),
        None if is_extreme(&symbol.name) => vec!["a", "b", "…"],
        None => vec!["x"],
    };
    let label = format!("{}{}", symbol.name, parameters(names.iter().copied()));
    let mut start = symbol.name.len() as u32 + 1;
    let places = names.iter().map(|name| {
        let place = (start, start + name.len() as u32);
        start = place.1 + 2;
        place
    });
    let places = places.collect();
    let what = match symbol.keyword {
        Some(word) => word.text().to_owned(),
        None => "builtin function".to_owned(),
    };
    let last = names.len().saturating_sub(1) as u32;
    Some(Signature {
        label,
        parameters: places,
        // The last parameter of `max(a, b, …)` represents all that follow.
        active: match symbol.keyword {
            Some(_) => active,
            None => active.min(last),
        },
        what,
    })
}

/// Returns the number of the `^` of a power such as `^2` or `^-1` that ends right before a token, or else of the token.
fn before_power(analysis: &GeotraceAnalysis, token: usize) -> usize {
    let mut before = analysis.tokens_before(token).map(|it| it.kind);
    let is_exponent = |kind| {
        matches!(
            kind,
            TokenKind::Number(_) | TokenKind::Constant(_) | TokenKind::Variable(_)
        )
    };
    if !before.next().is_some_and(is_exponent) {
        return token;
    }
    match (before.next(), before.next()) {
        (Some(TokenKind::Caret), _) => token - 2,
        (Some(TokenKind::Minus), Some(TokenKind::Caret)) => token - 3,
        _ => token,
    }
}

/// Returns the function right before a token, possibly with derivatives: `f`, `f'`, `f_u`.
pub(super) fn function_before(analysis: &GeotraceAnalysis, token: usize) -> Option<SymbolId> {
    let mut before = analysis.tokens_before(token).map(|it| it.kind);
    loop {
        match before.next()? {
            TokenKind::Function(id) => return Some(id),
            TokenKind::Prime => {}
            TokenKind::Variable(_) if before.next()? == TokenKind::Underscore => {}
            _ => return None,
        }
    }
}

/// Returns true for `min` and `max`, which take any number of components.
fn is_extreme(name: &str) -> bool {
    [Binary::Min, Binary::Max]
        .iter()
        .any(|op| op.name() == name)
}
