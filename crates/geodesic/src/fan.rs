//! The fan: all pixels on one line through the centre lie on one geodesic, and neighbouring lines share the rest.
//!
//! In: a surface, a frame, a picture's size, a tolerance. Out: [`Ends`] for every place in the picture, interpolated
//! between a few rays.

use crate::ends::{Coordinates, End, Ends, Estimate, Work};
use crate::frame::Frame;
use crate::surface::Surface;

/// How ends between two rays are interpolated.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum Across {
    /// By both rays' ends and their Jacobi fields.
    #[default]
    Hermite,
    /// By both rays' ends alone, for comparison.
    Linear,
}

/// How a fan is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FanOptions {
    /// The error allowed at a pixel, in pixels.
    pub tolerance: f64,
    /// Between rays.
    pub across: Across,
    /// The most evaluations of all rays together.
    pub max_evaluations: u64,
}

impl Default for FanOptions {
    fn default() -> Self {
        Self {
            tolerance: 0.1,
            across: Across::Hermite,
            max_evaluations: 40_000_000,
        }
    }
}

/// Rays with what lies between them.
pub struct Fan<'s, S: Surface + ?Sized> {
    surface: &'s S,
}

impl<'s, S: Surface + ?Sized> Fan<'s, S> {
    /// Follows as many rays as the tolerance asks for, on all cores of the current rayon pool.
    pub fn build(surface: &'s S, _frame: &Frame, _size: [u32; 2], _options: &FanOptions) -> Self {
        let _ = Self { surface };
        todo!()
    }

    /// What it cost.
    pub fn work(&self) -> Work {
        let _ = self.surface;
        todo!()
    }

    /// How exact it is, by rays that took no part in it.
    pub fn estimate(&self) -> Estimate {
        todo!()
    }
}

impl<S: Surface + ?Sized> Ends for Fan<'_, S> {
    fn end(&self, _place: [f64; 2]) -> End {
        todo!()
    }

    fn zoom(&self) -> f64 {
        todo!()
    }

    fn origin(&self) -> [f64; 2] {
        todo!()
    }

    fn in_coordinates(&self, _end: &End, _coordinates: Coordinates) -> Option<End> {
        todo!()
    }

    fn periods(&self) -> [f64; 2] {
        todo!()
    }
}
