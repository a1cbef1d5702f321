//! Conversions: the text of one language flows in, a text of another one that shows the same flows out.

use std::fmt;

/// The reason for which a text was not converted.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum ConvertError {
    /// Texts of the language are not converted.
    NotOffered,
    /// The text has errors.
    HasErrors,
    /// The scene has more leaves of solids than the other language takes in one program.
    TooManyLeaves {
        /// The most that it takes.
        most: u64,
    },
}

impl fmt::Display for ConvertError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotOffered => write!(f, "only CRT scripts are converted, to Geotrace's language"),
            Self::HasErrors => write!(
                f,
                "a script with errors is not converted; fix the errors first"
            ),
            Self::TooManyLeaves { most } => write!(
                f,
                "the script draws more than {most} shapes, the limit of conversions; a `grid` draws many instances of \
                 one solid"
            ),
        }
    }
}

impl std::error::Error for ConvertError {}
