//! The meaning of two or three numbers: a place in the picture, a place in space in one of two units.
//!
//! Signatures between modules use these types, so that a place in the scene's units is not passed for one in drawing
//! units. Inner loops unwrap them once and work on arrays.

/// A place in a picture, in pixels from its top left corner: right, down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelPoint(pub [f64; 2]);

/// A place in space, in the scene's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldPoint(pub [f64; 3]);

/// A place in space, in the drawing units of a [`Placement`](crate::placement::Placement).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawingPoint(pub [f64; 3]);

impl From<[f64; 3]> for WorldPoint {
    fn from(numbers: [f64; 3]) -> Self {
        Self(numbers)
    }
}
