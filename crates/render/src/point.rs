//! Types for two or three numbers: a position in the picture, or a point in space in one of two units.
//!
//! Signatures between modules use these types, so that a point in the scene's units is not mistaken for one in drawing
//! units. Inner loops unwrap them once and work on arrays.

/// A position in a picture, in pixels from its top left corner: right, down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelPoint(pub [f64; 2]);

/// A point in space, in the scene's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldPoint(pub [f64; 3]);

/// A point in space, in the drawing units of a [`Placement`](crate::placement::Placement).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawingPoint(pub [f64; 3]);

impl From<[f64; 3]> for WorldPoint {
    fn from(numbers: [f64; 3]) -> Self {
        Self(numbers)
    }
}
