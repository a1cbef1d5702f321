//! A piecewise map as an array of 32-bit words, as a fixed pass on the GPU reads it. Numbers are the bits of an `f32`.
//!
//! | words | meaning |
//! | --- | --- |
//! | 0, 1 | the picture's width and height in pixels |
//! | 2, 3 | its width and height in blocks of [`BLOCK`]² pixels |
//! | 4 | the word at which the covers begin |
//! | 5 | the word at which the patches begin |
//! | 6 | the word at which the singles begin |
//! | 7 | the number of words |
//! | 8 … 39 | the apexes: [`APEX_WORDS`] for each side, u min, u max, v min, v max |
//! | 40 … 43 | the offsets of the edges from the camera, u min, u max, v min, v max: ±3·10³⁸ where there is no edge |
//! | then | a cover for each block, row by row from the top; then the patches; then the singles |
//!
//! **A cover** has its kind in the two highest bits (0 patch, 1 single, 2 nothing), and in the lower bits the index of
//! the patch or single, or the status ([`code_of`]).
//!
//! **A patch** has [`PATCH_WORDS`] words: 0, 1 the first pixel's column and row; 2, 3 its extent in columns and rows; 4
//! its coordinates (0 plain, 1 + 2·axis + end about an apex, 5 plain and crossed by an edge: values beyond the edges'
//! offsets have left the domain); 5 its estimated error in pixels; 6, 7 its centre: in plain coordinates relative to
//! the camera's (u,v), about an apex (a,b) itself; then the coefficients, first all of the first coordinate, `[j][i]`
//! for X^i Y^j, then those of the second. X = (2n + 1)/extent − 1 for the n-th column, Y likewise downwards. The value
//! is the centre plus the polynomial; a derivative by pixel is 2/extent times the derivative by X or Y.
//!
//! **An apex** converts (a, b) to offsets from the camera's (u,v): along the axis base + sign·r^power, across it low +
//! angle(a, b)·per_angle. Its words: 0 base, 1 sign, 2 low, 3 per_angle, 4 power, 5 whether there is one (1 or 0).
//!
//! **A single** has [`SINGLE_WORDS`] words, eight for each of its 64 pixels, row by row: 0, 1 the offset of (u,v) from
//! the camera; 2 … 5 ∂(u,v) by one pixel to the right and by one pixel down; 6 the status; 7 unused.

use super::{BLOCK, Cover, DEGREE, PiecewiseMap};
use crate::ends::Coordinates;
use crate::status::Status;

/// The number of words before the covers.
pub(crate) const HEADER_WORDS: usize = 44;
/// The number of words of an apex.
pub const APEX_WORDS: usize = 8;
/// The number of words of a patch: a head of eight, and the coefficients.
pub const PATCH_WORDS: usize = 8 + 2 * (DEGREE + 1) * (DEGREE + 1);
/// The number of words of a single.
pub const SINGLE_WORDS: usize = 8 * (BLOCK * BLOCK) as usize;

/// Returns a status as a number.
pub fn code_of(status: Status) -> u32 {
    match status {
        Status::Complete => 0,
        Status::LeftDomain => 1,
        Status::ConePoint => 2,
        Status::Degenerate => 3,
        Status::Undefined => 4,
        Status::WorkLimit => 5,
    }
}

impl PiecewiseMap {
    /// Returns the words of the table.
    pub fn table(&self) -> Vec<u32> {
        let covers = HEADER_WORDS;
        let patches = covers + self.covers.len();
        let singles = patches + PATCH_WORDS * self.patches.len();
        let total = singles + SINGLE_WORDS * self.singles.len();
        let blocks = self.size.map(|n| n.div_ceil(BLOCK));
        let mut words = Vec::with_capacity(total);
        words.extend([self.size[0], self.size[1], blocks[0], blocks[1]]);
        words.extend([covers, patches, singles, total].map(|n| n as u32));
        for (side, polar) in self.polars.as_flattened().iter().enumerate() {
            let axis = side / 2;
            let numbers = match polar {
                Some(polar) => [
                    polar.base - self.base[axis],
                    polar.sign,
                    polar.low - self.base[1 - axis],
                    1.0 / polar.rate,
                    polar.power,
                ],
                None => [0.0; 5],
            };
            words.extend(numbers.map(|x| (x as f32).to_bits()));
            words.extend([u32::from(polar.is_some()), 0, 0]);
        }
        let bounds = self.bounds.as_flattened();
        words.extend(bounds.iter().map(|x| x.clamp(-3e38, 3e38).to_bits()));
        words.extend(self.covers.iter().map(|cover| match *cover {
            Cover::Patch(index) => index,
            Cover::Single(index) => 1 << 30 | index,
            Cover::Nothing(status) => 2 << 30 | code_of(status),
        }));
        for patch in &self.patches {
            words.extend(patch.corner);
            words.extend(patch.extent);
            let (coordinates, centre) = match patch.coordinates {
                Coordinates::Plain => (
                    if patch.edge { 5 } else { 0 },
                    [0, 1].map(|k| patch.centre[k] - self.base[k]),
                ),
                Coordinates::Apex { axis, end } => {
                    (1 + 2 * u32::from(axis) + u32::from(end), patch.centre)
                }
            };
            words.extend([coordinates, patch.error.to_bits()]);
            words.extend(centre.map(|x| (x as f32).to_bits()));
            let coefficients = patch.coefficients.as_flattened().as_flattened();
            words.extend(coefficients.iter().map(|c| c.to_bits()));
        }
        for single in &self.singles {
            let pixels = single.offset.iter().zip(&single.by_pixel);
            for ((offset, by_pixel), status) in pixels.zip(&single.status) {
                let numbers = offset.iter().chain(by_pixel.as_flattened());
                words.extend(numbers.map(|x| x.to_bits()));
                words.extend([code_of(*status), 0]);
            }
        }
        words
    }
}
