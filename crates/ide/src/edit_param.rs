//! The errors of writing a param's value into the text.

use std::fmt;

/// The reason why a value is not written.
#[derive(Clone, Debug, PartialEq)]
pub enum EditParamError {
    /// No param of this name is declared without errors.
    NoParam {
        /// The name.
        name: String,
    },
    /// The number of values differs from the number of the param's components.
    Components {
        /// The param.
        name: String,
        /// The number of its components.
        expected: usize,
        /// The number of given values.
        given: usize,
    },
    /// A value is outside its interval, or is not a number.
    OutOfRange {
        /// The param.
        name: String,
        /// The value.
        value: f64,
        /// The minimum.
        min: f64,
        /// The maximum.
        max: f64,
    },
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
            Self::Components {
                name,
                expected,
                given,
            } => {
                let wanted = match expected {
                    1 => "one number".to_owned(),
                    count => format!("{count} numbers"),
                };
                write!(f, "`{name}` takes {wanted}, but {given} were given")
            }
            Self::OutOfRange {
                name,
                value,
                min,
                max,
            } => write!(
                f,
                "{value} lies outside the interval [{min}, {max}] of `{name}`"
            ),
            Self::Comment { name } => write!(
                f,
                "the value of `{name}` has a comment in it, which would be lost: write the value by hand"
            ),
        }
    }
}

impl std::error::Error for EditParamError {}
