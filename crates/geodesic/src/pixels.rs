//! A picture's pixels: their positions, and the end of each pixel's geodesic.

use crate::ends::{Estimate, GeodesicWork};
use crate::point::{PicturePoint, Uv};
use crate::status::Status;

/// The end of each pixel's geodesic, row by row from the top.
#[derive(Clone, Debug)]
pub struct Map<const N: usize = 2> {
    /// The size in pixels: width, height.
    pub size: [u32; 2],
    /// The camera's position, which `offset` is relative to: its (u, v) in a chart.
    pub origin: [f64; N],
    /// The end of each pixel's geodesic, less `origin`. In a chart (u, v) continues beyond sides that wrap;
    /// [`Sides::wrap`](crate::sides::Sides::wrap) brings it into the domain. Finite for every pixel, but meaningless
    /// where the status is not complete.
    pub offset: Vec<[f32; N]>,
    /// The derivatives of the end by one pixel to the right, then by one pixel **down**; empty where the method does
    /// not provide them.
    pub by_pixel: Vec<[[f32; N]; 2]>,
    /// The reason why each pixel's geodesic ended.
    pub status: Vec<Status>,
    /// The work spent.
    pub work: GeodesicWork,
    /// The estimated errors, where the method has an estimate.
    pub estimate: Option<Estimate>,
}

impl<const N: usize> Default for Map<N> {
    fn default() -> Self {
        Self {
            size: [0; 2],
            origin: [0.0; N],
            offset: Vec::new(),
            by_pixel: Vec::new(),
            status: Vec::new(),
            work: GeodesicWork::default(),
            estimate: None,
        }
    }
}

impl Map {
    /// Returns a pixel's end in (u, v), possibly beyond sides that wrap.
    pub fn uv(&self, index: usize) -> Uv {
        Uv([0, 1].map(|k| self.origin[k] + f64::from(self.offset[index][k])))
    }
}

/// Returns the point of the picture at a pixel's centre: [−1,1] spans the shorter side, x to the right, y up.
pub fn pixel_place(size: [u32; 2], column: u32, row: u32) -> PicturePoint {
    let half = 0.5 * f64::from(size[0].min(size[1]).max(1));
    PicturePoint([
        (f64::from(column) + 0.5 - 0.5 * f64::from(size[0])) / half,
        (0.5 * f64::from(size[1]) - f64::from(row) - 0.5) / half,
    ])
}
