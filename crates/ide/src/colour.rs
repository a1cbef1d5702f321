//! Colours that a text states as numbers, for the colour pickers of editors and of the window.

use std::fmt;

use syntax::span::Span;

/// A constant colour in a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenColour {
    /// The range of the value.
    pub span: Span,
    /// Red, green and blue, sRGB, 0…1.
    pub rgb: [f64; 3],
}

/// The reason why a colour is not written into a text.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum EditColourError {
    /// No object of this name states its colour as numbers.
    NotStated {
        /// The object's name.
        name: String,
    },
}

impl fmt::Display for EditColourError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::NotStated { name } = self;
        write!(f, "the declaration of `{name}` states no colour as numbers")
    }
}

impl std::error::Error for EditColourError {}
