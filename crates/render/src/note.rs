//! Notes for a reader of a picture.

use std::fmt;

/// A note for a reader of a picture: a sentence.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Note {
    /// About what is seen: "`p` is undefined at the current params and is not drawn".
    Remark(String),
    /// About what the picture took, or how exact it is.
    Cost(String),
}

impl Note {
    /// The sentence.
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
