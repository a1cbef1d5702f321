//! The function or macro whose arguments are being written.

use syntax::crt::objects::FUNCTIONS;
use syntax::crt::token::{Token, TokenKind};
use syntax::span::Span;

use super::CrtAnalysis;
use crate::signature::Signature;

/// Returns the innermost call with a bracket around an offset.
pub(super) fn signature(analysis: &CrtAnalysis, offset: u32) -> Option<Signature> {
    let tokens: Vec<Token> = analysis.tokens(Span::new(0, offset)).collect();
    if let Some(last) = tokens.iter().rfind(|it| it.span.start < offset)
        && matches!(last.kind, TokenKind::Comment | TokenKind::Text)
        && (last.span.end > offset || last.kind == TokenKind::Comment)
    {
        return None;
    }
    let before = tokens.iter().filter(|it| it.span.end <= offset);
    let mut before = before.filter(|it| it.kind != TokenKind::Comment).rev();
    let modifier_ends = &analysis.names().modifier_ends;
    let (mut depth, mut commas) = (0, 0);
    while let Some(token) = before.next() {
        match token.kind {
            // The arguments of a call contain no statements, except within a macro or an object.
            TokenKind::BraceOpen if depth == 0 => return None,
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => depth += 1,
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen if depth > 0 => {
                depth -= 1;
            }
            TokenKind::ParenOpen => {
                let called = before
                    .clone()
                    .next()
                    .filter(|it| it.kind == TokenKind::Identifier);
                if let Some(found) = called.and_then(|it| of_name(analysis, it.span, commas)) {
                    return Some(found);
                }
                commas = 0;
            }
            TokenKind::Greater if modifier_ends.binary_search(&token.span.start).is_ok() => {
                depth += 1;
            }
            TokenKind::Modify if depth > 0 => depth -= 1,
            // A list, or modifiers: continue with the bracket around it.
            TokenKind::BracketOpen | TokenKind::Modify => commas = 0,
            TokenKind::Comma if depth == 0 => commas += 1,
            _ => {}
        }
    }
    None
}

fn of_name(analysis: &CrtAnalysis, name: Span, active: u32) -> Option<Signature> {
    let text = analysis.slice(name);
    let names = analysis.names();
    let variable = names.variable_at(name.start + 1);
    // A macro with this name takes precedence over the function.
    let own = variable.and_then(|(_, it)| names.parameters(it));
    let builtin = FUNCTIONS.iter().find(|(function, ..)| *function == text);
    let (words, what): (Vec<&str>, _) = match (own, builtin) {
        (Some(own), _) => (own.iter().map(|it| &**it).collect(), "macro"),
        (None, Some((_, words, _))) => (words.to_vec(), "builtin function"),
        (None, None) => return None,
    };
    let mut start = text.len() as u32 + 1;
    let places = words.iter().map(|word| {
        let place = (start, start + word.len() as u32);
        start = place.1 + 2;
        place
    });
    Some(Signature {
        parameters: places.collect(),
        label: format!("{text}({})", words.join(", ")),
        active,
        what: what.to_owned(),
    })
}
