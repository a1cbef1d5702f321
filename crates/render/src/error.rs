//! The errors of rendering, as sentences for the user.

use std::fmt;

use geodesic::trace::Status;

use geometry::ManifoldError;

/// The longest side of a picture in pixels.
pub const MAX_SIDE: u32 = 16_384;
/// The allowed factors of the widths of lines and the sizes of words.
pub const SCALES: std::ops::RangeInclusive<f32> = 0.1..=20.0;

/// The reason why a picture cannot be drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum RenderError {
    /// No GPU can be used; `reason` completes "because …".
    NoGpu {
        /// For instance "no GPU driver was found".
        reason: String,
    },
    /// The GPU refused or lost the work, in the driver's words.
    Gpu(String),
    /// No view of this name is registered.
    NoView {
        /// The name.
        name: String,
    },
    /// The object has no geodesic view: it is not a surface, or its geodesics cannot be computed.
    Manifold(ManifoldError),
    /// The geodesic camera cannot be placed there: the surface is undefined or has no tangent plane at (u, v).
    UndefinedCamera {
        /// The surface's name.
        name: String,
        /// The point of its chart.
        at: [f64; 2],
    },
    /// The geodesic camera's (u, v) is not in the surface's domain.
    CameraOutside {
        /// The surface's name.
        name: String,
        /// The point of its chart.
        at: [f64; 2],
        /// `[[u min, u max], [v min, v max]]`.
        domain: [[f64; 2]; 2],
    },
    /// A number of the camera is not finite, a zoom is not positive, or eye and target coincide; the sentence
    /// says which.
    Camera(String),
    /// The picture's size is not between 1×1 and [`MAX_SIDE`]×[`MAX_SIDE`].
    Size([u32; 2]),
    /// The picture was given up for something newer.
    Interrupted,
    /// The picture takes more operations on solids, lights and surfaces than this limit.
    TooMuchWork(u64),
    /// The factor of widths and of words is not one of [`SCALES`].
    Scale(f32),
    /// A fault of this program: generated text did not pass validation.
    Internal {
        /// The finding, with its origin.
        message: String,
        /// The text, kept for a report.
        source: String,
    },
}

impl RenderError {
    /// Says why a camera cannot walk somewhere.
    pub fn cannot_walk(reason: impl fmt::Display) -> Self {
        Self::Camera(format!("the camera cannot walk there: {reason}"))
    }

    /// Checks that a walk, of which the status and the length are given, did not end because it took too many steps.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if it did.
    pub fn check_walk(status: Status, length: f64) -> Result<(), Self> {
        match status {
            Status::WorkLimit => Err(Self::cannot_walk(format_args!(
                "it exceeds the limit of steps at length {length:.6}"
            ))),
            _ => Ok(()),
        }
    }
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoGpu { reason } => write!(f, "no GPU can be used: {reason}"),
            Self::Gpu(message) => write!(f, "the GPU could not draw the picture: {message}"),
            Self::NoView { name } => write!(f, "there is no view `{name}`"),
            Self::Manifold(error) => write!(f, "{error}"),
            Self::UndefinedCamera { name, at: [u, v] } => {
                write!(
                    f,
                    "`{name}` has no tangent plane at (u, v) = ({u}, {v}), so the camera cannot be there"
                )
            }
            Self::CameraOutside {
                name,
                at: [u, v],
                domain: [[u0, u1], [v0, v1]],
            } => write!(
                f,
                "({u}, {v}) is outside the domain of `{name}`, which is [{u0}, {u1}] by [{v0}, {v1}]"
            ),
            Self::Camera(sentence) => write!(f, "{sentence}"),
            Self::Interrupted => write!(f, "the picture was abandoned for a newer one"),
            Self::Size([width, height]) => {
                write!(
                    f,
                    "a picture of {width}x{height} pixels is not possible: each side is from 1 to {MAX_SIDE}"
                )
            }
            Self::TooMuchWork(limit) => {
                write!(
                    f,
                    "the picture exceeds the work limit: more than {limit} operations on solids, lights and surfaces"
                )
            }
            Self::Scale(scale) => {
                let (least, most) = (SCALES.start(), SCALES.end());
                write!(
                    f,
                    "lines and text cannot be scaled by {scale}: the factor is from {least} to {most}"
                )
            }
            Self::Internal { message, .. } => {
                write!(f, "internal error in a generated shader: {message}")
            }
        }
    }
}

impl std::error::Error for RenderError {}

impl From<wgsl::InternalError> for RenderError {
    fn from(error: wgsl::InternalError) -> Self {
        Self::Internal {
            message: error.message,
            source: error.source,
        }
    }
}

impl From<ManifoldError> for RenderError {
    fn from(error: ManifoldError) -> Self {
        Self::Manifold(error)
    }
}

#[cfg(test)]
mod tests {
    use super::{RenderError, SCALES};

    #[test]
    fn a_scale_that_is_refused_is_named_with_its_limits() {
        let sentence = RenderError::Scale(30.0).to_string();
        for number in [30.0, *SCALES.start(), *SCALES.end()] {
            assert!(sentence.contains(&number.to_string()), "{sentence}");
        }
    }
}
