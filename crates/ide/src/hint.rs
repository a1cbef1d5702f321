//! Hints that an editor shows within a text.

/// A text that an editor shows but that is not part of the file.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Hint {
    /// The byte before which the hint appears.
    pub offset: u32,
    /// The shown text.
    pub label: String,
    /// An explanation in one sentence.
    pub tooltip: String,
    /// True if the label is separated from the text before it.
    pub apart: bool,
}
