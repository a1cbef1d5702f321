//! The drawing units: the position and scale of a scene, removed in f64 before anything becomes f32.

use crate::point::{DrawingPoint, WorldPoint};

/// The map from the scene's units to drawing units, in which the scene's centre is 0 and its radius 1. The difference is
/// computed in f64: f32 samples keep their precision however far from 0 the scene is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The centre of the scene's box, in the scene's units.
    pub centre: [f64; 3],
    /// Half the diagonal of the scene's box, in the scene's units; positive.
    pub radius: f64,
}

impl Placement {
    /// Converts a point to drawing units.
    pub fn local(&self, WorldPoint(world): WorldPoint) -> DrawingPoint {
        DrawingPoint([0, 1, 2].map(|k| (world[k] - self.centre[k]) / self.radius))
    }

    /// Converts a point to the scene's units.
    pub fn world(&self, DrawingPoint(local): DrawingPoint) -> WorldPoint {
        WorldPoint([0, 1, 2].map(|k| self.centre[k] + local[k] * self.radius))
    }
}
