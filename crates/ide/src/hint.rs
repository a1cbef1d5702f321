//! Hints that an editor shows between the letters of a text.

/// A text that an editor shows but does not write.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Hint {
    /// The byte before which the hint appears.
    pub offset: u32,
    /// The shown text.
    pub label: String,
    /// An explanation in one sentence.
    pub tooltip: String,
    /// True if the label keeps a distance from the text before it.
    pub apart: bool,
}
