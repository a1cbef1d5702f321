//! Painters' shaders: hand-written passes joined with the library, without generated code.

use crate::contract::fulfils;
use crate::join::{InternalError, Joined, join};
use crate::library::{self, Piece};

/// Discs of points.
///
/// # Errors
/// [`InternalError`] if naga rejects the joined text.
pub fn points() -> Result<Joined, InternalError> {
    glyphs(library::PASS_DRAW_POINTS)
}

/// Shafts and heads of vectors.
///
/// # Errors
/// [`InternalError`] if naga rejects the joined text.
pub fn vectors() -> Result<Joined, InternalError> {
    glyphs(library::PASS_DRAW_VECTORS)
}

/// Strips and joins of curves.
///
/// # Errors
/// [`InternalError`] if naga rejects the joined text.
pub fn curves() -> Result<Joined, InternalError> {
    glyphs(library::PASS_DRAW_CURVES)
}

/// Triangles of surfaces.
///
/// # Errors
/// [`InternalError`] if naga rejects the joined text.
pub fn surfaces() -> Result<Joined, InternalError> {
    join(&[
        library::NUMBER,
        library::VIEW,
        library::IMAGE,
        library::PASS_DRAW_SURFACES,
    ])
}

/// Light and depth of solids.
///
/// # Errors
/// [`InternalError`] if naga rejects the joined text.
pub fn solids() -> Result<Joined, InternalError> {
    join(&[library::PASS_DRAW_SOLIDS])
}

/// The pass from a table of polynomials to colours.
///
/// # Errors
/// [`InternalError`] if the pass does not fulfil its contract, or naga rejects the joined text.
pub fn resolve_piecewise() -> Result<Joined, InternalError> {
    let pass = library::PASS_RESOLVE_PIECEWISE;
    fulfils(&pass, &library::CONTRACT_SEEN)?;
    join(&[
        library::NUMBER,
        library::IMAGE,
        library::PICTURE,
        library::HATCHING,
        pass,
    ])
}

fn glyphs(pass: Piece<'_>) -> Result<Joined, InternalError> {
    join(&[library::VIEW, library::GLYPH, pass])
}
