//! The errors of writing a camera into the text.

use std::fmt;

/// The reason for which a camera is not written.
#[derive(Clone, Debug, PartialEq)]
pub enum EditCameraError {
    /// The language declares no cameras.
    NoCameras,
    /// The camera of this name is declared with an error.
    Faulty {
        /// The camera.
        name: String,
    },
    /// The name stands for something else, or is none.
    NotACamera {
        /// The name.
        name: String,
    },
    /// The direction is zero, or a number is not finite.
    NotAPlace,
    /// A comment stands within the place that is written now, and would be lost.
    Comment {
        /// The camera.
        name: String,
    },
}

impl fmt::Display for EditCameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoCameras => write!(f, "this language declares no cameras"),
            Self::Faulty { name } => write!(
                f,
                "the declaration of `{name}` has an error: mend it, and write the camera then"
            ),
            Self::NotACamera { name } => {
                write!(
                    f,
                    "`{name}` is not free as the name of a camera: choose another"
                )
            }
            Self::NotAPlace => write!(
                f,
                "a camera needs a direction that is not zero, and finite numbers"
            ),
            Self::Comment { name } => write!(
                f,
                "the place of `{name}` has a comment in it, which would be lost: write the camera by hand"
            ),
        }
    }
}

impl std::error::Error for EditCameraError {}
