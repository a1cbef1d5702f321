//! Conversions of a text into another language, in which it shows the same scene.

use std::fmt;

/// The reason why a text is not converted.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum ConvertError {
    /// Texts of the language are not converted.
    NotOffered,
    /// The text has errors.
    HasErrors,
    /// The scene has more leaves of solids than the other language allows in a program.
    TooManyLeaves {
        /// The maximum.
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
