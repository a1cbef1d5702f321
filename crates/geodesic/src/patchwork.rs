//! A picture's ends as a patchwork of polynomials: few evaluations of an [`Ends`] in, all pixels out.
//!
//! The picture is cut into squares of pixels, as large as one polynomial in each meets the tolerance, by evaluations
//! that took no part in it. Pixels that no square covers are evaluated one by one. The same table is read by the CPU
//! ([`Patchwork::map`]) and by a fixed pass on the GPU.

use crate::ends::{Coordinates, Ends, Estimate};
use crate::map::Map;
use crate::trace::Status;

/// The side in pixels of the smallest square.
pub const BLOCK: u32 = 8;
/// The polynomials' degree in x and in y.
pub const DEGREE: usize = 5;

/// A square of pixels on which the ends are one polynomial.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// The column and the row (from the top) of its first pixel.
    pub corner: [u32; 2],
    /// Pixels along each side: a power of two times [`BLOCK`]; it may reach beyond the picture.
    pub side: u32,
    /// What the polynomial's values mean.
    pub coordinates: Coordinates,
    /// The value at the square's middle; the polynomials are offsets from it.
    pub centre: [f64; 2],
    /// `[coordinate][j][i]` multiplies X^i Y^j, X to the right and Y **down**, in [−1, 1] over the square.
    pub coefficients: [[[f32; DEGREE + 1]; DEGREE + 1]; 2],
}

/// A block of pixels that have been evaluated one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct Single {
    /// Offsets of (u,v), plain coordinates, from [`Patchwork::origin`]; 64 pixels, row by row.
    pub offset: Vec<[f32; 2]>,
    /// ∂(u,v) by one pixel to the right, then by one pixel **down**.
    pub by_pixel: Vec<[f32; 4]>,
    /// Why they ended.
    pub status: Vec<Status>,
}

/// What covers a block of [`BLOCK`]² pixels.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Cover {
    /// Part of a [`Patch`], by its index.
    Patch(u32),
    /// A [`Single`], by its index.
    Single(u32),
    /// All pixels ended like this, and show nothing.
    Nothing(Status),
}

/// The whole picture.
#[derive(Clone, Debug, Default)]
pub struct Patchwork {
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// The camera's (u, v), from which offsets count.
    pub origin: [f64; 2],
    /// What covers each block, row by row from the top.
    pub covers: Vec<Cover>,
    /// The polynomials.
    pub patches: Vec<Patch>,
    /// The pixels evaluated one by one.
    pub singles: Vec<Single>,
    /// The polynomials' own error, beside that of the ends.
    pub estimate: Estimate,
    /// How often the ends have been evaluated.
    pub samples: u64,
}

impl Patchwork {
    /// Cuts a picture. `tolerance` is what the polynomials may add to the error, in pixels of length `pixel` on the
    /// surface.
    pub fn cut(_ends: &dyn Ends, _size: [u32; 2], _tolerance: f64) -> Self {
        todo!()
    }

    /// All pixels.
    pub fn map(&self) -> Map {
        todo!()
    }
}
