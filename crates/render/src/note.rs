//! Notes for the reader of a picture.

use std::fmt;

/// A note for the reader of a picture: a sentence.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Note {
    /// About the content of the picture: "`p` is undefined at the current params and is not drawn".
    Remark(String),
    /// About the cost or the accuracy of the picture.
    Cost(String),
}

impl Note {
    /// Returns the sentence.
    pub fn text(&self) -> &str {
        match self {
            Self::Remark(text) | Self::Cost(text) => text,
        }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())
    }
}
