//! Renaming of variables.

use syntax::crt::objects::FUNCTIONS;
use syntax::crt::token::TokenKind;
use syntax::span::Span;

use super::CrtAnalysis;
use crate::edit::Edit;
use crate::rename::RenameError;

/// Returns the range and the text of the name at an offset.
pub(super) fn prepare(analysis: &CrtAnalysis, offset: u32) -> Result<(Span, String), RenameError> {
    let names = analysis.names();
    if let Some((span, variable)) = names.variable_at(offset) {
        let name = analysis.slice(span);
        return match names.may_be_builtin(variable) {
            true => Err(RenameError::Builtin(name)),
            false => Ok((span, name)),
        };
    }
    match analysis.word_at(offset) {
        Some(token) if matches!(token.kind, TokenKind::Identifier | TokenKind::Name) => {
            Err(RenameError::Builtin(analysis.slice(token.span)))
        }
        _ => Err(RenameError::NoName),
    }
}

/// Returns the edits that rename the variable at an offset. A name that occurs anywhere in the script is not available.
pub(super) fn rename(
    analysis: &CrtAnalysis,
    offset: u32,
    name: &str,
) -> Result<Vec<Edit>, RenameError> {
    let (_, old) = prepare(analysis, offset)?;
    let names = analysis.names();
    let (_, variable) = names.variable_at(offset).ok_or(RenameError::NoName)?;
    let is_name = name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.bytes().all(|byte| byte.is_ascii_alphanumeric());
    if !is_name {
        return Err(RenameError::NotAName {
            name: name.to_owned(),
            rule: "a variable starts with a letter a-z and has only letters a-z, A-Z and digits",
        });
    }
    if TokenKind::from_word(name).is_some() {
        return Err(RenameError::Keyword(name.to_owned()));
    }
    if old == name {
        return Ok(Vec::new());
    }
    let place = names.place_of(name);
    let is_builtin = name == "t" || FUNCTIONS.iter().any(|(function, ..)| *function == name);
    if place.is_some() || is_builtin {
        return Err(RenameError::Taken {
            name: name.to_owned(),
            line: place
                .filter(|_| !is_builtin)
                .map(|span| analysis.snapshot_text().line(span.start)),
        });
    }
    let places = names.occurrences(variable).into_iter();
    Ok(places.map(|it| Edit::replace(it.span, name)).collect())
}
