//! A view found interactively, written into the text as a camera.
//!
//! In: a direction and a position, as in the 3D view. Out: the edit after which they are stated as `camera eye = … @
//! …;`. Attributes remain unchanged.

use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use super::item::Item;
use super::rename::is_free;
use crate::edit::Edit;
use crate::edit_camera::{EditCameraError, short_numbers};

/// Returns the edit after which the camera `name` looks along `direction` from `position`. An undeclared camera is added at the
/// end, with a vertical field of view `fov` in radians.
///
/// # Errors
/// If the name denotes something else, the numbers are not a valid view, or a comment would be lost.
pub fn edit_camera(
    analysis: &GeotraceAnalysis,
    name: &str,
    direction: [f64; 3],
    position: [f64; 3],
    fov: f64,
) -> Result<Edit, EditCameraError> {
    let length = direction[0].hypot(direction[1]).hypot(direction[2]);
    let is_place = length > 0.0 && length.is_finite() && position.iter().all(|x| x.is_finite());
    if !is_place || !fov.is_finite() {
        return Err(EditCameraError::NotAPlace);
    }
    let [direction, position] = [direction, position]
        .map(|vector| format!("({})", short_numbers(vector, length).join(", ")));
    let view = format!("{direction} @ {position}");
    match analysis.declared(name) {
        Some(item) if item.keyword == DeclarationKeyword::Camera => replace(analysis, &item, view),
        None if is_free(analysis, name) => {
            let [fov, ..] = short_numbers([fov; 3], fov);
            let line = format!("camera {name} = {view}, fov : {fov};\n");
            Ok(Edit::append(analysis.document(), &line))
        }
        _ => Err(EditCameraError::NotACamera {
            name: name.to_owned(),
        }),
    }
}

/// Returns the edit of a declared camera.
fn replace(
    analysis: &GeotraceAnalysis,
    item: &Item<'_>,
    view: String,
) -> Result<Edit, EditCameraError> {
    let name = item.name.to_owned();
    let behind = Span::new(item.name_span.end, item.span.end);
    let mut tokens = analysis.tokens(analysis.tokens_in(behind));
    let opening = tokens.find(|token| token.kind != TokenKind::Comment);
    let mut depth = 0;
    let value = tokens.take_while(|token| {
        match token.kind {
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => depth += 1,
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => depth -= 1,
            _ => {}
        }
        depth > 0 || !matches!(token.kind, TokenKind::Comma | TokenKind::Semicolon)
    });
    let value: Vec<_> = value.collect();
    if opening.is_none_or(|token| token.kind != TokenKind::Equals) || item.faulty {
        return Err(EditCameraError::Faulty { name });
    }
    if value.iter().any(|token| token.kind == TokenKind::Comment) {
        return Err(EditCameraError::Comment { name });
    }
    let span = value.iter().map(|token| token.span).reduce(Span::to);
    span.map(|span| Edit::replace(span, view))
        .ok_or(EditCameraError::Faulty { name })
}
