//! Colours that a text states as numbers, for an editor's colour picker.

use syntax::span::Span;

/// A constant colour in a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatedColor {
    /// The range of the value.
    pub span: Span,
    /// Red, green and blue, sRGB, 0…1.
    pub rgb: [f64; 3],
}
