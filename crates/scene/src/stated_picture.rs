//! The picture that a text describes by itself.

/// The settings of a picture, of a text in left-handed coordinates (x right, y up, z into the screen).
#[derive(Clone, Debug, PartialEq)]
pub struct StatedPicture {
    /// The exponent 1/gamma makes bytes of light; positive.
    pub gamma: f64,
    /// The samples of a pixel lie on a grid of so many columns and rows; at least 1.
    pub supersampling: u32,
    /// The samples on the lens of each of them; at least 1.
    pub lens_samples: u32,
    /// The reflections and refractions that are followed.
    pub bounces: u32,
}
