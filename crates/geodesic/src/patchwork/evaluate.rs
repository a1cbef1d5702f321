//! The pixels of a patchwork, some rows at a time: polynomials in, offsets out, in loops that become vectors.

use expr::processor::Work;

use super::angle::{angle, larger_and_ratio};
use super::fit::COUNT;
use super::{BLOCK, Cover, Patch, Patchwork};
use crate::ends::{Coordinates, Polar};
use crate::trace::Status;

/// How many pixels are computed side by side.
const LANES: usize = 8;

type Lanes = [f32; LANES];

/// Some rows of pixels, of the picture's whole width; each part may be empty where it is not wanted.
pub struct Rows<'a> {
    /// As in [`Map`](crate::map::Map).
    pub offset: &'a mut [[f32; 2]],
    /// As in [`Map`](crate::map::Map).
    pub by_pixel: &'a mut [[f32; 4]],
    /// As in [`Map`](crate::map::Map).
    pub status: &'a mut [Status],
}

/// The blocks of one row of blocks, to be evaluated into rows that begin with it.
pub(super) struct Band<'a, 'r> {
    pub(super) patchwork: &'a Patchwork,
    /// Which row of blocks.
    pub(super) block_row: u32,
    pub(super) rows: Rows<'r>,
}

impl Work for Band<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self {
            patchwork,
            block_row,
            mut rows,
        } = self;
        let [width, height] = patchwork.size;
        let across = width.div_ceil(BLOCK);
        let top = block_row * BLOCK;
        let covers = &patchwork.covers[(block_row * across) as usize..][..across as usize];
        let mut block = 0;
        while block < across {
            let left = block * BLOCK;
            let cover = covers[block as usize];
            let right = match cover {
                Cover::Patch(index) => {
                    let patch = &patchwork.patches[index as usize];
                    patch.corner[0] + patch.extent[0]
                }
                _ => (left + BLOCK).min(width),
            };
            for row in 0..BLOCK.min(height - top) {
                let from = (row * width + left) as usize;
                let pixels = from..from + (right - left) as usize;
                match cover {
                    Cover::Patch(index) => {
                        let patch = &patchwork.patches[index as usize];
                        let line = Line::of(patchwork, patch, top + row, left);
                        line.evaluate(&mut rows, pixels);
                    }
                    Cover::Single(index) => {
                        let single = &patchwork.singles[index as usize];
                        let first = (row * BLOCK) as usize;
                        copy(&single.offset[first..], part(rows.offset, &pixels));
                        copy(&single.by_pixel[first..], part(rows.by_pixel, &pixels));
                        copy(&single.status[first..], part(rows.status, &pixels));
                    }
                    Cover::Nothing(status) => {
                        part(rows.offset, &pixels).fill([0.0; 2]);
                        part(rows.by_pixel, &pixels).fill([0.0; 4]);
                        part(rows.status, &pixels).fill(status);
                    }
                }
            }
            block = right.div_ceil(BLOCK);
        }
    }
}

/// The pixels of a part that is wanted, else nothing.
#[inline(always)]
fn part<'a, T>(all: &'a mut [T], pixels: &std::ops::Range<usize>) -> &'a mut [T] {
    all.get_mut(pixels.clone()).unwrap_or_default()
}

#[inline(always)]
fn copy<T: Copy>(from: &[T], to: &mut [T]) {
    let count = from.len().min(to.len());
    to[..count].copy_from_slice(&from[..count]);
}

/// A row of a patch: polynomials in X alone.
struct Line {
    /// The values, without the centre.
    value: [[f32; COUNT]; 2],
    /// By one pixel to the right.
    right: [[f32; COUNT]; 2],
    /// By one pixel down.
    down: [[f32; COUNT]; 2],
    /// What is added to the values.
    centre: [f32; 2],
    /// X of the first pixel, and from a pixel to the next.
    start: f32,
    step: f32,
    apex: Option<(usize, About)>,
}

/// [`Polar`] in single precision, from the camera.
struct About {
    base: f32,
    sign: f32,
    low: f32,
    per_angle: f32,
    power: f32,
}

impl About {
    #[inline(always)]
    fn of(axis: usize, polar: &Polar, origin: [f64; 2]) -> Self {
        Self {
            base: (polar.base - origin[axis]) as f32,
            sign: polar.sign as f32,
            low: (polar.low - origin[1 - axis]) as f32,
            per_angle: (1.0 / polar.rate) as f32,
            power: polar.power as f32,
        }
    }

    /// From (a, b) with its derivatives by two directions to (w, t) with its own: w along the axis, t across.
    #[inline(always)]
    fn undo(&self, [a, b]: [f32; 2], by: [[f32; 2]; 2]) -> ([f32; 2], [[f32; 2]; 2]) {
        let (larger, ratio) = larger_and_ratio(a, b);
        let turn = angle(a, b, ratio);
        let r = larger * (1.0 + ratio * ratio).sqrt();
        // At the apex itself any direction is as good as another.
        let least = if r > 1e-36 { r } else { 1e-36 };
        let (cos, sin) = (a / least, b / least);
        let (powered, slope) = if self.power == 1.0 {
            (r, 1.0)
        } else if self.power == 2.0 {
            (r * r, 2.0 * r)
        } else {
            let root = least.sqrt();
            (root, 0.5 / root)
        };
        let derivatives = by.map(|[da, db]| {
            let outward = cos * da + sin * db;
            let around = (cos * db - sin * da) / least;
            [
                self.sign * slope * outward,
                bounded(self.per_angle * around),
            ]
        });
        (
            [
                self.base + self.sign * powered,
                self.low + self.per_angle * turn,
            ],
            derivatives,
        )
    }
}

/// Near an apex the angle turns without bound; a number stays a number.
#[inline(always)]
fn bounded(x: f32) -> f32 {
    let x = if x > 1e30 { 1e30 } else { x };
    if x < -1e30 { -1e30 } else { x }
}

impl Line {
    #[inline(always)]
    fn of(patchwork: &Patchwork, patch: &Patch, row: u32, column: u32) -> Self {
        let half = patch.extent.map(|n| 0.5 * n as f32);
        let step = half.map(|half| 1.0 / half);
        let y = ((row - patch.corner[1]) as f32 + 0.5) * step[1] - 1.0;
        let mut value = [[0.0; COUNT]; 2];
        let mut down = [[0.0; COUNT]; 2];
        let mut right = [[0.0; COUNT]; 2];
        for k in 0..2 {
            let rows = &patch.coefficients[k];
            value[k] = rows[COUNT - 1];
            for row in rows[..COUNT - 1].iter().rev() {
                for i in 0..COUNT {
                    down[k][i] = down[k][i] * y + value[k][i];
                    value[k][i] = value[k][i] * y + row[i];
                }
            }
            for i in 1..COUNT {
                right[k][i - 1] = i as f32 * value[k][i] * step[0];
            }
            for slope in &mut down[k] {
                *slope *= step[1];
            }
        }
        let origin = patchwork.origin;
        let (apex, centre) = match patch.coordinates {
            Coordinates::Plain => (None, [0, 1].map(|k| (patch.centre[k] - origin[k]) as f32)),
            Coordinates::Apex { axis, end } => {
                let axis = usize::from(axis.min(1));
                let polar = patchwork.polars[axis][usize::from(end.min(1))].unwrap_or_default();
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
        }
    }

    #[inline(always)]
    fn evaluate(&self, rows: &mut Rows<'_>, pixels: std::ops::Range<usize>) {
        part(rows.status, &pixels).fill(Status::Complete);
        let offset = part(rows.offset, &pixels);
        let by_pixel = part(rows.by_pixel, &pixels);
        match &self.apex {
            None if by_pixel.is_empty() => {
                for (chunk, offset) in offset.chunks_mut(LANES).enumerate() {
                    let value = self.values(&self.places(chunk));
                    store(offset, |lane| [value[0][lane], value[1][lane]]);
                }
            }
            None => {
                for (chunk, (offset, by_pixel)) in chunks(offset, by_pixel) {
                    let x = self.places(chunk);
                    let value = self.values(&x);
                    let [right, down] = self.slopes(&x);
                    store(offset, |lane| [value[0][lane], value[1][lane]]);
                    store(by_pixel, |lane| {
                        [right[0][lane], right[1][lane], down[0][lane], down[1][lane]]
                    });
                }
            }
            Some((axis, about)) => {
                for (chunk, (offset, by_pixel)) in chunks(offset, by_pixel) {
                    let x = self.places(chunk);
                    let mut value = self.values(&x);
                    let mut slopes = self.slopes(&x);
                    for lane in 0..LANES {
                        let [right, down] = &slopes;
                        let by = [
                            [right[0][lane], right[1][lane]],
                            [down[0][lane], down[1][lane]],
                        ];
                        let at = [value[0][lane], value[1][lane]];
                        let (at, by) = about.undo(at, by);
                        for k in 0..2 {
                            value[k][lane] = at[k];
                            slopes[0][k][lane] = by[0][k];
                            slopes[1][k][lane] = by[1][k];
                        }
                    }
                    let (u, v) = (*axis, 1 - *axis);
                    let [right, down] = slopes;
                    store(offset, |lane| [value[u][lane], value[v][lane]]);
                    store(by_pixel, |lane| {
                        [right[u][lane], right[v][lane], down[u][lane], down[v][lane]]
                    });
                }
            }
        }
    }

    /// X of the pixels of a chunk.
    #[inline(always)]
    fn places(&self, chunk: usize) -> Lanes {
        let first = (chunk * LANES) as f32;
        std::array::from_fn(|lane| (first + lane as f32) * self.step + self.start)
    }

    #[inline(always)]
    fn values(&self, x: &Lanes) -> [Lanes; 2] {
        [0, 1].map(|k| horner(&self.value[k], x).map(|value| value + self.centre[k]))
    }

    /// By one pixel to the right, and down.
    #[inline(always)]
    fn slopes(&self, x: &Lanes) -> [[Lanes; 2]; 2] {
        [&self.right, &self.down].map(|by| [0, 1].map(|k| horner(&by[k], x)))
    }
}

#[inline(always)]
fn horner(coefficients: &[f32; COUNT], x: &Lanes) -> Lanes {
    let mut sum = [coefficients[COUNT - 1]; LANES];
    for &coefficient in coefficients[..COUNT - 1].iter().rev() {
        for lane in 0..LANES {
            sum[lane] = sum[lane] * x[lane] + coefficient;
        }
    }
    sum
}

/// Both parts, a chunk at a time; one of them may be empty.
#[inline(always)]
fn chunks<'a>(
    offset: &'a mut [[f32; 2]],
    by_pixel: &'a mut [[f32; 4]],
) -> impl Iterator<Item = (usize, (&'a mut [[f32; 2]], &'a mut [[f32; 4]]))> {
    let count = offset.len().max(by_pixel.len()).div_ceil(LANES);
    let mut offset = offset.chunks_mut(LANES);
    let mut by_pixel = by_pixel.chunks_mut(LANES);
    (0..count).map(move |n| {
        let parts = (
            offset.next().unwrap_or_default(),
            by_pixel.next().unwrap_or_default(),
        );
        (n, parts)
    })
}

/// Puts lanes side by side. A whole chunk has a length that the compiler knows.
#[inline(always)]
fn store<const K: usize>(to: &mut [[f32; K]], pixel: impl Fn(usize) -> [f32; K]) {
    if let Ok(whole) = <&mut [[f32; K]; LANES]>::try_from(&mut *to) {
        for (lane, to) in whole.iter_mut().enumerate() {
            *to = pixel(lane);
        }
    } else {
        for (lane, to) in to.iter_mut().enumerate() {
            *to = pixel(lane.min(LANES - 1));
        }
    }
}
