//! The exponential map, pixel by pixel: what a geodesic picture is resolved from.

use crate::trace::Status;

/// For each pixel, row by row from the top, where its geodesic ends.
#[derive(Clone, Debug, Default)]
pub struct Map {
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// The end of each pixel's geodesic, brought back into the domain.
    pub uv: Vec<[f32; 2]>,
    /// Why each pixel's geodesic ended.
    pub status: Vec<Status>,
}
