//! A picture's ends as a piecewise polynomial map. In: a few evaluations of an [`Ends`]. Out: all pixels.
//!
//! The picture is divided into squares of pixels, each as large as one polynomial meets the tolerance, which is checked
//! at points that are not used for the fit. Pixels that no square covers are evaluated one by one. The same table is
//! read by the CPU ([`PiecewiseMap::map`]) and by a fixed pass on the GPU ([`table`]).
//!
//! A square is one polynomial only if all the ends sampled in it (at the corners, at the nodes, on the sides) are complete; or
//! if all others have left through an edge beyond which their continuations are known: then the polynomial itself determines
//! the edge. A square shows nothing only if all sampled ends with known continuations are beyond one edge. So a line of a
//! different kind (another edge, the region behind a tip, a strip of the surface) cannot cross a square undetected. Undetected
//! are only areas wholly between the samples, which are at most a quarter of the square's side apart (60 pixels in the largest
//! square, less in those that their neighbourhood has made small), and the outermost pixels of a curve that bends into the
//! square and out again between two samples.

mod angle;
mod cut;
mod evaluate;
mod fit;
mod square;
pub mod table;

pub use evaluate::Rows;

use std::array::from_fn;

use expr::processor::Processor;
use rayon::prelude::*;

use crate::ends::{Coordinates, Ends, Estimate, Polar};
use crate::pixels::Map;
use crate::point::PicturePoint;
use crate::status::Status;
use cut::{Piece, Pieces, Subdivider};
use evaluate::Band;
use fit::Fit;

/// The side in pixels of the smallest square.
pub const BLOCK: u32 = 8;
/// The polynomials' degree in x and in y.
pub const DEGREE: usize = 6;
/// The side of the largest square. A picture begins with squares of at most a quarter of its shorter side, which gives
/// several cores work.
const LARGEST: u32 = 256;

/// A square of pixels on which the ends are one polynomial.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch<const N: usize = 2> {
    /// The column and the row (from the top) of its first pixel.
    pub corner: [u32; 2],
    /// The number of pixels along each side: a power of two times [`BLOCK`]; it may extend beyond the picture.
    pub side: u32,
    /// The numbers of its columns and rows that are in the picture.
    pub extent: [u32; 2],
    /// The coordinates of the polynomial's values.
    pub coordinates: Coordinates,
    /// The value at the middle of its extent; the polynomials are offsets from it.
    pub centre: [f64; N],
    /// `[coordinate][j][i]` multiplies X^i Y^j, X to the right and Y **down**, in [−1, 1] over the extent: a pixel's
    /// centre is at (2n+1)/extent − 1.
    pub coefficients: [[[f32; DEGREE + 1]; DEGREE + 1]; N],
    /// The estimated error of the polynomials, in pixels.
    pub error: f32,
    /// True if an edge crosses it: a pixel whose value is beyond [`PiecewiseMap::bounds`] has left the domain. Only in plain
    /// coordinates.
    pub edge: bool,
}

/// A block of pixels that were evaluated one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct Single<const N: usize = 2> {
    /// Offsets of the ends, in plain coordinates, from [`PiecewiseMap::origin`]; 64 pixels, row by row.
    pub offset: Vec<[f32; N]>,
    /// Their derivatives by one pixel to the right, then by one pixel **down**.
    pub by_pixel: Vec<[[f32; N]; 2]>,
    /// The reasons why they ended.
    pub status: Vec<Status>,
}

/// The cover of a block of [`BLOCK`]² pixels.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Cover {
    /// Part of a [`Patch`], by its index.
    Patch(u32),
    /// A [`Single`], by its index.
    Single(u32),
    /// All pixels ended with this status, and show nothing.
    Nothing(Status),
}

/// The whole picture: the exponential map as polynomials on squares of pixels.
#[derive(Clone, Debug)]
pub struct PiecewiseMap<const N: usize = 2> {
    /// The size in pixels: width, height.
    pub size: [u32; 2],
    /// The camera's position, which offsets are relative to: its (u, v) in a chart. The caller must replace it if the
    /// ends are those of a surface in recentred coordinates.
    pub origin: [f64; N],
    /// The camera's position in the coordinates of the ends, which patches use.
    base: [f64; N],
    /// The cover of each block, row by row from the top.
    pub covers: Vec<Cover>,
    /// The polynomials.
    pub patches: Vec<Patch<N>>,
    /// The pixels evaluated one by one.
    pub singles: Vec<Single<N>>,
    /// `[axis][end]`: the coordinates about the apexes that patches may use.
    pub polars: [[Option<Polar>; 2]; 2],
    /// Offsets from the camera beyond which an end has left the domain, `[axis][end]`: infinite where there is no edge.
    pub bounds: [[f32; 2]; N],
    /// The derivatives by pixel at the camera's own position, which a picture with odd width and height shows exactly.
    pub centre_by_pixel: [[f32; N]; 2],
    /// The polynomials' own error, in addition to that of the ends.
    pub estimate: Estimate,
    /// The number of evaluations of the ends.
    pub samples: u64,
}

impl<const N: usize> Default for PiecewiseMap<N> {
    fn default() -> Self {
        Self {
            size: [0; 2],
            origin: [0.0; N],
            base: [0.0; N],
            covers: Vec::new(),
            patches: Vec::new(),
            singles: Vec::new(),
            polars: [[None; 2]; 2],
            bounds: [[0.0; 2]; N],
            centre_by_pixel: [[0.0; N]; 2],
            estimate: Estimate::default(),
            samples: 0,
        }
    }
}

impl<const N: usize> PiecewiseMap<N> {
    /// Divides a picture, on all threads of the current rayon pool; the result does not depend on their number.
    /// `tolerance` is the error that the polynomials may add, in pixels measured on the surface.
    pub fn cut(ends: &dyn Ends<N>, size: [u32; 2], tolerance: f64) -> Self {
        let zoom = ends.zoom();
        let per_place = 2.0 / f64::from(size[0].min(size[1]).max(1));
        let origin = ends.origin().map(|x| if x.is_finite() { x } else { 0.0 });
        let subdivider = Subdivider {
            ends,
            size,
            origin,
            tolerance,
            pixel: zoom * per_place,
            per_place,
            zoom,
            bounds: ends.bounds(),
            fit: Fit::new(),
        };
        let shorter = size[0].min(size[1]);
        let mut side = LARGEST;
        while side > 2 * BLOCK && 4 * side > shorter {
            side /= 2;
        }
        let [columns, rows] = size.map(|n| n.div_ceil(side));
        let squares: Vec<[u32; 2]> = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| [column * side, row * side]))
            .collect();
        let parts: Vec<Pieces<N>> = squares
            .into_par_iter()
            .with_min_len(1)
            .map(|corner| {
                let mut pieces = Pieces::default();
                subdivider.cover(corner, side, &mut pieces);
                pieces
            })
            .collect();
        let [across, down] = size.map(|n| n.div_ceil(BLOCK) as usize);
        let mut piecewise = Self {
            size,
            origin,
            base: origin,
            covers: vec![Cover::Nothing(Status::Undefined); across * down],
            bounds: from_fn(|axis| subdivider.bounds[axis].map(|x| (x - origin[axis]) as f32)),
            polars: [0, 1].map(|axis| [0, 1].map(|end| ends.polar(axis, end))),
            ..Self::default()
        };
        if size[0] > 0 && size[1] > 0 {
            let end = ends.end(PicturePoint::default());
            piecewise.samples += 1;
            if end.status == Status::Complete {
                piecewise.centre_by_pixel = subdivider.pixel(end, PicturePoint::default()).1;
            }
        }
        for part in parts {
            piecewise.samples += part.samples;
            for piece in part.all {
                piecewise.put(piece);
            }
        }
        piecewise.estimate = piecewise.estimated();
        piecewise
    }

    fn put(&mut self, piece: Piece<N>) {
        let (corner, side, cover) = match piece {
            Piece::Patch(patch) => {
                let place = (patch.corner, patch.side);
                self.patches.push(*patch);
                (place.0, place.1, Cover::Patch(index(self.patches.len())))
            }
            Piece::Single { corner, single } => {
                self.singles.push(single);
                (corner, BLOCK, Cover::Single(index(self.singles.len())))
            }
            Piece::Nothing {
                corner,
                side,
                status,
            } => (corner, side, Cover::Nothing(status)),
        };
        let [across, down] = self.size.map(|n| n.div_ceil(BLOCK));
        let [left, top] = corner.map(|n| n / BLOCK);
        let count = side / BLOCK;
        for row in top..(top + count).min(down) {
            let from = (row * across + left) as usize;
            let to = (row * across + (left + count).min(across)) as usize;
            self.covers[from..to].fill(cover);
        }
    }

    /// Returns the polynomials' errors, each weighted by the number of pixels that it covers.
    fn estimated(&self) -> Estimate {
        let area = |patch: &Patch<N>| u64::from(patch.extent[0]) * u64::from(patch.extent[1]);
        let mut errors: Vec<(f32, u64)> = self
            .patches
            .iter()
            .map(|patch| (patch.error, area(patch)))
            .collect();
        errors.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        let mut left = u64::from(self.size[0]) * u64::from(self.size[1]) / 100;
        let max = errors.first().map_or(0.0, |(error, _)| *error);
        let mut p99 = 0.0;
        for (error, area) in errors {
            if area > left {
                p99 = error;
                break;
            }
            left -= area;
        }
        Estimate {
            max: f64::from(max),
            p99: f64::from(p99),
        }
    }

    /// Evaluates all pixels, on all threads of the current rayon pool; the result is bitwise independent of their
    /// number. `by_pixel` requests the derivatives, two thirds of the numbers.
    pub fn map(&self, by_pixel: bool) -> Map<N> {
        let [width, height] = self.size.map(|n| n as usize);
        let pixels = width * height;
        let mut map = Map {
            size: self.size,
            origin: self.origin,
            offset: vec![[0.0; N]; pixels],
            by_pixel: vec![[[0.0; N]; 2]; if by_pixel { pixels } else { 0 }],
            status: vec![Status::default(); pixels],
            estimate: Some(self.estimate),
            ..Map::default()
        };
        if pixels == 0 {
            return map;
        }
        let band = BLOCK as usize * width;
        let offsets = map.offset.par_chunks_mut(band);
        let statuses = map.status.par_chunks_mut(band);
        if by_pixel {
            let by_pixel = map.by_pixel.par_chunks_mut(band);
            let all = offsets.zip(statuses).zip(by_pixel).enumerate();
            all.for_each(|(row, ((offset, status), by_pixel))| {
                let rows = Rows {
                    offset,
                    by_pixel,
                    status,
                };
                self.block_row(row as u32, rows);
            });
        } else {
            offsets
                .zip(statuses)
                .enumerate()
                .for_each(|(row, (offset, status))| {
                    let rows = Rows {
                        offset,
                        by_pixel: &mut [],
                        status,
                    };
                    self.block_row(row as u32, rows);
                });
        }
        map
    }

    /// Evaluates the pixels of one row of blocks, `row` counted from the top: [`BLOCK`] rows of the picture (fewer at
    /// the bottom), over its whole width, into buffers of exactly this many pixels. Small enough to be coloured while
    /// it is in the cache.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn block_row(&self, row: u32, rows: Rows<'_, N>) {
        let [width, height] = self.size;
        let Rows {
            offset,
            by_pixel,
            status,
        } = rows;
        Processor::here().run(Band {
            piecewise: self,
            block_row: row,
            rows: Rows {
                offset: &mut *offset,
                by_pixel: &mut *by_pixel,
                status,
            },
        });
        // The middle pixel of a picture with odd width and height is the camera's own position, to the last bit.
        let odd = width % 2 == 1 && height % 2 == 1;
        if odd && height / 2 / BLOCK == row && self.is_in_patch(width / 2, height / 2) {
            let index = ((height / 2 - row * BLOCK) * width + width / 2) as usize;
            if let Some(offset) = offset.get_mut(index) {
                *offset = [0.0; N];
            }
            if let Some(by_pixel) = by_pixel.get_mut(index) {
                *by_pixel = self.centre_by_pixel;
            }
        }
    }

    fn is_in_patch(&self, column: u32, row: u32) -> bool {
        let across = self.size[0].div_ceil(BLOCK);
        let index = (row / BLOCK * across + column / BLOCK) as usize;
        matches!(self.covers.get(index), Some(Cover::Patch(_)))
    }
}

/// Returns the index of the last of `count` elements.
fn index(count: usize) -> u32 {
    u32::try_from(count.saturating_sub(1)).unwrap_or(u32::MAX)
}
