//! The pixels of a piecewise map, several rows at a time. In: polynomials. Out: offsets, in loops that the compiler
//! vectorises.

use std::array::from_fn;

use expr::processor::Work;

use super::angle::{angle, larger_and_ratio};
use super::fit::COUNT;
use super::{BLOCK, Cover, Patch, PiecewiseMap};
use crate::ends::{Coordinates, Polar};
use crate::status::Status;

/// Several rows of pixels, over the picture's whole width; a part that is not requested may be empty.
pub struct Rows<'a, const N: usize = 2> {
    /// As in [`Map`](crate::pixels::Map).
    pub offset: &'a mut [[f32; N]],
    /// As in [`Map`](crate::pixels::Map).
    pub by_pixel: &'a mut [[[f32; N]; 2]],
    /// As in [`Map`](crate::pixels::Map).
    pub status: &'a mut [Status],
}

/// The blocks of one row of blocks, to be evaluated into rows that begin with it.
pub(super) struct Band<'a, 'r, const N: usize> {
    pub(super) piecewise: &'a PiecewiseMap<N>,
    /// The index of the row of blocks, from the top.
    pub(super) block_row: u32,
    pub(super) rows: Rows<'r, N>,
}

impl<const N: usize> Work for Band<'_, '_, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self {
            piecewise,
            block_row,
            mut rows,
        } = self;
        let [width, height] = piecewise.size;
        let across = width.div_ceil(BLOCK);
        let top = block_row * BLOCK;
        let covers = &piecewise.covers[(block_row * across) as usize..][..across as usize];
        let mut block = 0;
        while block < across {
            let left = block * BLOCK;
            let cover = covers[block as usize];
            let right = match cover {
                Cover::Patch(index) => {
                    let patch = &piecewise.patches[index as usize];
                    patch.corner[0] + patch.extent[0]
                }
                _ => (left + BLOCK).min(width),
            };
            let count = BLOCK.min(height - top);
            let strip = match cover {
                Cover::Patch(index) => {
                    let patch = &piecewise.patches[index as usize];
                    Some(Strip::of(piecewise, patch, top, left))
                }
                _ => None,
            };
            for row in 0..count as usize {
                let from = row * width as usize + left as usize;
                let pixels = from..from + (right - left) as usize;
                match (cover, &strip) {
                    (Cover::Single(index), _) => {
                        let single = &piecewise.singles[index as usize];
                        let first = row * BLOCK as usize;
                        copy(&single.offset[first..], part(rows.offset, &pixels));
                        copy(&single.by_pixel[first..], part(rows.by_pixel, &pixels));
                        copy(&single.status[first..], part(rows.status, &pixels));
                    }
                    (Cover::Nothing(status), _) => {
                        part(rows.offset, &pixels).fill([0.0; N]);
                        part(rows.by_pixel, &pixels).fill([[0.0; N]; 2]);
                        part(rows.status, &pixels).fill(status);
                    }
                    (Cover::Patch(_), Some(strip)) => strip.evaluate(row, &mut rows, pixels),
                    (Cover::Patch(_), None) => {}
                }
            }
            block = right.div_ceil(BLOCK);
        }
    }
}

/// Returns the pixels of a requested part, else nothing.
#[inline(always)]
fn part<'a, T>(all: &'a mut [T], pixels: &std::ops::Range<usize>) -> &'a mut [T] {
    all.get_mut(pixels.clone()).unwrap_or_default()
}

#[inline(always)]
fn copy<T: Copy>(from: &[T], to: &mut [T]) {
    let count = from.len().min(to.len());
    to[..count].copy_from_slice(&from[..count]);
}

/// A coefficient for each row of a strip.
type Column = [f32; BLOCK as usize];

/// Several rows of a patch: polynomials in X alone; a row's coefficients are at its index in each column.
struct Strip<const N: usize> {
    /// The values, without the centre.
    value: [[Column; COUNT]; N],
    /// The derivative by one pixel to the right.
    right: [[Column; COUNT]; N],
    /// The derivative by one pixel down.
    down: [[Column; COUNT]; N],
    /// The point that the values are offsets from, less the camera's.
    centre: [f32; N],
    /// X of the first pixel, and the step from a pixel to the next.
    start: f32,
    step: f32,
    apex: Option<(usize, About)>,
    /// [`PiecewiseMap::bounds`], if an edge crosses it.
    bounds: Option<[[f32; 2]; N]>,
}

/// [`Polar`] in single precision, relative to the camera.
struct About {
    base: f32,
    sign: f32,
    low: f32,
    per_angle: f32,
    power: f32,
}

impl About {
    #[inline(always)]
    fn of<const N: usize>(axis: usize, polar: &Polar, origin: [f64; N]) -> Self {
        Self {
            base: (polar.base - origin[axis]) as f32,
            sign: polar.sign as f32,
            low: (polar.low - origin[1 - axis]) as f32,
            per_angle: (1.0 / polar.rate) as f32,
            power: polar.power as f32,
        }
    }

    /// Converts (a, b) to (w, t): w along the axis, t across.
    #[inline(always)]
    fn point(&self, [a, b]: [f32; 2]) -> [f32; 2] {
        let (larger, ratio) = larger_and_ratio(a, b);
        let r = larger * (1.0 + ratio * ratio).sqrt();
        let (powered, _) = self.power_and_slope(r);
        [
            self.base + self.sign * powered,
            self.low + self.per_angle * angle(a, b, ratio),
        ]
    }

    /// Converts a vector at (a, b) to one at (w, t).
    #[inline(always)]
    fn vector(&self, [a, b]: [f32; 2], [x, y]: [f32; 2]) -> [f32; 2] {
        let (larger, ratio) = larger_and_ratio(a, b);
        let r = larger * (1.0 + ratio * ratio).sqrt();
        let (_, slope) = self.power_and_slope(r);
        // At the apex itself, any direction will do.
        let over = 1.0 / if r > LEAST { r } else { LEAST };
        let (cos, sin) = (a * over, b * over);
        let around = (cos * y - sin * x) * over;
        [
            self.sign * slope * (cos * x + sin * y),
            bounded(self.per_angle * around),
        ]
    }

    /// Returns r^power and its derivative.
    #[inline(always)]
    fn power_and_slope(&self, r: f32) -> (f32, f32) {
        if self.power == 1.0 {
            (r, 1.0)
        } else if self.power == 2.0 {
            (r * r, 2.0 * r)
        } else {
            let root = if r > LEAST { r } else { LEAST }.sqrt();
            (root, 0.5 / root)
        }
    }
}

/// The minimum distance from an apex.
const LEAST: f32 = 1e-36;

/// Bounds a number: near an apex the angle's derivative is unbounded.
#[inline(always)]
fn bounded(x: f32) -> f32 {
    let x = if x > 1e30 { 1e30 } else { x };
    if x < -1e30 { -1e30 } else { x }
}

impl<const N: usize> Strip<N> {
    /// Prepares the rows from `row`, the pixels from `column`.
    #[inline(always)]
    fn of(piecewise: &PiecewiseMap<N>, patch: &Patch<N>, row: u32, column: u32) -> Self {
        let step = [2.0 / patch.extent[0] as f32, 2.0 / patch.extent[1] as f32];
        let mut y: Column = [0.0; BLOCK as usize];
        for (n, y) in y.iter_mut().enumerate() {
            *y = ((row - patch.corner[1]) as f32 + n as f32 + 0.5) * step[1] - 1.0;
        }
        let nothing = [[[0.0; BLOCK as usize]; COUNT]; N];
        let (mut value, mut right, mut down) = (nothing, nothing, nothing);
        for k in 0..N {
            for i in 0..COUNT {
                let mut sum = [patch.coefficients[k][COUNT - 1][i]; BLOCK as usize];
                let mut slope = [0.0; BLOCK as usize];
                let mut j = COUNT - 1;
                while j > 0 {
                    j -= 1;
                    let coefficient = patch.coefficients[k][j][i];
                    for n in 0..BLOCK as usize {
                        slope[n] = slope[n] * y[n] + sum[n];
                        sum[n] = sum[n] * y[n] + coefficient;
                    }
                }
                value[k][i] = sum;
                for n in 0..BLOCK as usize {
                    down[k][i][n] = slope[n] * step[1];
                }
                if i > 0 {
                    for n in 0..BLOCK as usize {
                        right[k][i - 1][n] = sum[n] * (i as f32 * step[0]);
                    }
                }
            }
        }
        let origin = piecewise.base;
        let (apex, centre) = match patch.coordinates {
            Coordinates::Plain => {
                let centre = from_fn(|k| (patch.centre[k] - origin[k]) as f32);
                (None, centre)
            }
            Coordinates::Apex { axis, end } => {
                let axis = usize::from(axis.min(1));
                let polar = piecewise.polars[axis][usize::from(end.min(1))].unwrap_or_default();
                let about = About::of(axis, &polar, origin);
                (Some((axis, about)), patch.centre.map(|x| x as f32))
            }
        };
        Self {
            value,
            right,
            down,
            centre,
            start: ((column - patch.corner[0]) as f32 + 0.5) * step[0] - 1.0,
            step: step[0],
            apex,
            bounds: patch.edge.then_some(piecewise.bounds),
        }
    }

    /// Evaluates one row. The iterations are independent, so that the compiler vectorises the loops.
    #[inline(always)]
    fn evaluate(&self, row: usize, rows: &mut Rows<'_, N>, pixels: std::ops::Range<usize>) {
        let status = part(rows.status, &pixels);
        status.fill(Status::Complete);
        let offset = part(rows.offset, &pixels);
        let by_pixel = part(rows.by_pixel, &pixels);
        match &self.apex {
            None => self.plain(row, offset, by_pixel),
            Some((0, about)) => self.about::<0>(about, row, offset, by_pixel),
            Some((_, about)) => self.about::<1>(about, row, offset, by_pixel),
        }
        if let Some(bounds) = self.bounds {
            for (status, offset) in status.iter_mut().zip(offset) {
                let mut left = false;
                for k in 0..N {
                    left |= (offset[k] < bounds[k][0]) | (offset[k] > bounds[k][1]);
                }
                if left {
                    *status = Status::LeftDomain;
                }
            }
        }
    }

    #[inline(always)]
    fn plain(&self, row: usize, offset: &mut [[f32; N]], by_pixel: &mut [[[f32; N]; 2]]) {
        let (value, centre) = (at_row(&self.value, row), self.centre);
        let (start, step) = (self.start, self.step);
        for (n, offset) in (0_i32..).zip(offset.iter_mut()) {
            let x = n as f32 * step + start;
            for k in 0..N {
                offset[k] = horner(&value[k], x) + centre[k];
            }
        }
        let (right, down) = (at_row(&self.right, row), at_row(&self.down, row));
        for (n, by_pixel) in (0_i32..).zip(by_pixel.iter_mut()) {
            let x = n as f32 * step + start;
            for k in 0..N {
                by_pixel[0][k] = horner(&right[k], x);
                by_pixel[1][k] = horner(&down[k], x);
            }
        }
    }

    /// Evaluates about an apex at an end of the axis `AXIS`; only charts, with their two coordinates, have apexes.
    #[inline(always)]
    fn about<const AXIS: usize>(
        &self,
        about: &About,
        row: usize,
        offset: &mut [[f32; N]],
        by_pixel: &mut [[[f32; N]; 2]],
    ) {
        let value = at_row(&self.value, row);
        let (right, down) = (at_row(&self.right, row), at_row(&self.down, row));
        let centre = [self.centre[0], self.centre[1]];
        let (start, step) = (self.start, self.step);
        for (n, offset) in (0_i32..).zip(offset.iter_mut()) {
            let x = n as f32 * step + start;
            let at = [
                horner(&value[0], x) + centre[0],
                horner(&value[1], x) + centre[1],
            ];
            let at = about.point(at);
            (offset[AXIS], offset[1 - AXIS]) = (at[0], at[1]);
        }
        for (n, by_pixel) in (0_i32..).zip(by_pixel.iter_mut()) {
            let x = n as f32 * step + start;
            let at = [
                horner(&value[0], x) + centre[0],
                horner(&value[1], x) + centre[1],
            ];
            let right = about.vector(at, [horner(&right[0], x), horner(&right[1], x)]);
            let down = about.vector(at, [horner(&down[0], x), horner(&down[1], x)]);
            (by_pixel[0][AXIS], by_pixel[0][1 - AXIS]) = (right[0], right[1]);
            (by_pixel[1][AXIS], by_pixel[1][1 - AXIS]) = (down[0], down[1]);
        }
    }
}

/// Returns a row's coefficients, for each coordinate.
#[inline(always)]
fn at_row<const N: usize>(columns: &[[Column; COUNT]; N], row: usize) -> [[f32; COUNT]; N] {
    let mut coefficients = [[0.0; COUNT]; N];
    for (coefficients, columns) in coefficients.iter_mut().zip(columns) {
        for (coefficient, column) in coefficients.iter_mut().zip(columns) {
            *coefficient = column[row];
        }
    }
    coefficients
}

#[inline(always)]
fn horner(coefficients: &[f32; COUNT], x: f32) -> f32 {
    let mut sum = coefficients[COUNT - 1];
    let mut n = COUNT - 1;
    while n > 0 {
        n -= 1;
        sum = sum * x + coefficients[n];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_radial_parameter_is_a_power_of_the_distance() {
        for (power, expected) in [(1.0, (0.25, 1.0)), (2.0, (0.0625, 0.5)), (0.5, (0.5, 1.0))] {
            let about = About {
                base: 0.0,
                sign: 1.0,
                low: 0.0,
                per_angle: 1.0,
                power,
            };
            assert_eq!(about.power_and_slope(0.25), expected);
        }
    }
}
