//! Views written into the text as cameras: their numbers, and the reasons why they are not written.

use std::fmt;

/// The reason why a camera is not written.
#[derive(Clone, Debug, PartialEq)]
pub enum EditCameraError {
    /// The language declares no cameras.
    NoCameras,
    /// The camera of this name is declared with an error.
    Faulty {
        /// The camera.
        name: String,
    },
    /// The name denotes something else, or is not a name.
    NotACamera {
        /// The name.
        name: String,
    },
    /// The direction is zero, or a number is not finite.
    NotAPlace,
    /// The camera is not stated with a position and a target, directly or by one variable.
    NotStated,
    /// A comment is inside the range to be replaced, and would be lost.
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
                "the declaration of `{name}` has an error: fix it before you write the camera"
            ),
            Self::NotACamera { name } => {
                write!(
                    f,
                    "`{name}` is not available as the name of a camera: choose another"
                )
            }
            Self::NotAPlace => write!(
                f,
                "a camera needs a direction that is not zero, and finite numbers"
            ),
            Self::NotStated => write!(
                f,
                "the script computes its camera: state it in Settings, or by one variable, as Camera {{ position -> … pointing -> … }}"
            ),
            Self::Comment { name } => write!(
                f,
                "the place of `{name}` has a comment in it, which would be lost: write the camera by hand"
            ),
        }
    }
}

impl std::error::Error for EditCameraError {}

/// The number of digits written beyond the magnitude of the direction: less than a pixel at any size of a picture.
const DIGITS: i32 = 4;

/// Returns the numbers of a vector, rounded to a fraction of a length.
pub(crate) fn short_numbers(vector: [f64; 3], length: f64) -> [String; 3] {
    let digits = (DIGITS - length.log10().floor() as i32).clamp(0, 20) as usize;
    vector.map(|x| {
        if x.abs() >= 1e12 || length < 1e-12 {
            return format!("{x:e}");
        }
        let text = format!("{x:.digits$}");
        let text = match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.'),
            false => &text,
        };
        match text {
            "-0" => "0".to_owned(),
            text => text.to_owned(),
        }
    })
}
