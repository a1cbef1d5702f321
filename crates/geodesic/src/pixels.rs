//! A picture's pixels: their places, and where the geodesic of each ends.

use crate::ends::{Estimate, Work};
use crate::status::Status;

/// For each pixel, row by row from the top, where its geodesic ends.
#[derive(Clone, Debug, Default)]
pub struct Map {
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// The camera's (u, v), from which `offset` counts.
    pub origin: [f64; 2],
    /// Where each pixel's geodesic ends: (u, v) − origin, going on beyond sides that wrap; [`Sides::wrap`](crate::sides::Sides::wrap) takes it
    /// into the domain. Finite for every pixel, without a meaning where the status is not complete.
    pub offset: Vec<[f32; 2]>,
    /// ∂(u,v) by one pixel to the right, then by one pixel **down**; empty where a method does not know it.
    pub by_pixel: Vec<[f32; 4]>,
    /// Why each pixel's geodesic ended.
    pub status: Vec<Status>,
    /// What it cost.
    pub work: Work,
    /// How exact it is, as far as the method can tell.
    pub estimate: Option<Estimate>,
}

impl Map {
    /// A pixel's end in (u, v), perhaps beyond sides that wrap.
    pub fn uv(&self, index: usize) -> [f64; 2] {
        [0, 1].map(|k| self.origin[k] + f64::from(self.offset[index][k]))
    }
}

/// The place of a pixel's centre in the picture: [−1,1] spans the shorter side, x to the right, y up.
pub fn pixel_place(size: [u32; 2], column: u32, row: u32) -> [f64; 2] {
    let half = 0.5 * f64::from(size[0].min(size[1]).max(1));
    [
        (f64::from(column) + 0.5 - 0.5 * f64::from(size[0])) / half,
        (0.5 * f64::from(size[1]) - f64::from(row) - 0.5) / half,
    ]
}
