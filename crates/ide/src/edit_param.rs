//! The errors of writing a param's value into the text.

use std::fmt;

use scene::SetError;

/// The reason why a value is not written.
#[derive(Clone, Debug, PartialEq)]
pub enum EditParamError {
    /// No param of this name is declared without errors.
    NoParam {
        /// The name.
        name: String,
    },
    /// The values do not fit the param.
    Set(SetError),
    /// A comment is inside the value to be replaced, and would be lost.
    Comment {
        /// The param.
        name: String,
    },
}

impl fmt::Display for EditParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoParam { name } => write!(
                f,
                "no param `{name}` is declared without errors, so its value cannot be written"
            ),
            Self::Set(error) => error.fmt(f),
            Self::Comment { name } => write!(
                f,
                "the value of `{name}` has a comment in it, which would be lost: write the value by hand"
            ),
        }
    }
}

impl std::error::Error for EditParamError {}

impl From<SetError> for EditParamError {
    fn from(error: SetError) -> Self {
        Self::Set(error)
    }
}
