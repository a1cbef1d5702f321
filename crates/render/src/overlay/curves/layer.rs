//! Lines in the chart are laid over a picture: segments and the pixels' ends flow in, inked pixels flow out.
//!
//! A pixel's distance to a line is measured in the chart and turned into pixels by the derivative of its end, so lines
//! are as wide as other lines wherever they are seen. Segments are looked up for a block of pixels at once, and measured
//! for a row of it at once, in loops that become vectors.

use std::sync::{Mutex, MutexGuard, PoisonError};

use expr::processor::{Processor, Work};
use geodesic::piecewise::BLOCK;
use geodesic::trace::Status;

use super::super::{StrokeColour, StrokeStyle};
use super::SurfaceCurve;
use super::names::{NamePlace, NamePlaces};
use super::table::{FoundSegments, Near, SegmentTable};
use crate::counters::PixelCounters;
use crate::geodesic_view::{EndsOfRows, Layer, PlacedCamera};
use crate::point::PixelPoint;

/// Pixels that are measured together.
const LANES: usize = BLOCK as usize;
/// The most cells of the table that the neighbourhood of a pixel may cover: beyond it, lines are thinner than can be seen.
const MOST_CELLS: f64 = 256.0;
/// The neighbourhood of a pixel extends half a line's width around it, and this many pixels more.
const ABOUT: f32 = 2.5;

/// Lines that are laid over a picture, the first one undermost.
pub(in crate::overlay) struct Lines<'t> {
    table: SegmentTable,
    inks: Vec<StrokeColour>,
    pen: StrokeStyle,
    /// The picture's.
    width: usize,
    /// The places for the lines' names, if they are wanted.
    names: Option<NamePlaces>,
    processor: Processor,
    /// The buffers of bands that are done, for others.
    scratches: Mutex<Vec<Scratch>>,
    counters: &'t PixelCounters,
}

impl<'t> Lines<'t> {
    /// Returns `None` if there are no lines.
    pub(in crate::overlay) fn new(
        lines: &[SurfaceCurve],
        camera: &PlacedCamera,
        scale: f32,
        named: bool,
        counters: &'t PixelCounters,
    ) -> Option<Self> {
        if lines.iter().all(|line| line.pieces.is_empty()) {
            return None;
        }
        let size = camera.size();
        Some(Self {
            table: SegmentTable::new(lines, camera),
            inks: lines
                .iter()
                .map(|line| {
                    let colour = StrokeColour::new(line.colour);
                    match line.is_outlined {
                        true => colour.outlined(),
                        false => colour,
                    }
                })
                .collect(),
            pen: StrokeStyle::for_size(size, scale),
            width: size[0] as usize,
            names: named.then(|| NamePlaces::new(size, lines.len())),
            processor: Processor::here(),
            scratches: Mutex::default(),
            counters,
        })
    }

    /// Returns true if the neighbourhood of a pixel covers few enough cells, given its extent in (u,v) for each pixel.
    #[inline(always)]
    fn few_cells(&self, [u, v]: [f64; 2]) -> bool {
        let [across, down] = self.table.cells_per_unit();
        let about = 2.0 * f64::from(self.pen.half + ABOUT);
        (1.0 + about * u * across) * (1.0 + about * v * down) <= MOST_CELLS
    }

    /// Returns the pixel of each line that is best for its name, as far as it has been laid over a picture; none unless
    /// names are wanted.
    pub(in crate::overlay) fn name_places(&self) -> Vec<Option<PixelPoint>> {
        let names = self.names.as_ref();
        names.map_or(Vec::new(), NamePlaces::pixels)
    }

    fn scratches(&self) -> MutexGuard<'_, Vec<Scratch>> {
        self.scratches
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

impl Layer for Lines<'_> {
    fn lay(&self, ends: EndsOfRows<'_>, pixels: &mut [u8]) {
        // Without derivatives, nothing is known of a line's width.
        if ends.by_pixel.is_empty() {
            return;
        }
        let scratch = self.scratches().pop();
        let mut scratch = scratch.unwrap_or_else(|| Scratch {
            squares: vec![[f32::INFINITY; LANES]; self.inks.len()],
            ..Scratch::default()
        });
        scratch.distances = 0;
        scratch.named.clear();
        scratch.named.resize(self.inks.len(), NamePlace::NONE);
        self.processor.run(Band {
            lines: self,
            ends,
            scratch: &mut scratch,
            pixels,
        });
        self.counters.count_distances(scratch.distances);
        if let Some(names) = &self.names {
            names.note(&scratch.named);
        }
        self.scratches().push(scratch);
    }
}

/// The buffers with which a band of pixels is measured.
#[derive(Debug, Default)]
struct Scratch {
    found: FoundSegments,
    /// The segments that were found, as offsets from the camera.
    near: Vec<Offset>,
    /// The squares of the lines' distances.
    squares: Vec<[f32; LANES]>,
    /// The best places for the lines' names in a band.
    named: Vec<NamePlace>,
    /// See [`crate::counters::WorkCounters::distances`].
    distances: u64,
}

/// A segment as it is measured.
#[derive(Debug)]
struct Offset {
    line: usize,
    from: [f32; 2],
    step: [f32; 2],
}

/// Some whole rows of pixels with their ends.
struct Band<'a> {
    lines: &'a Lines<'a>,
    ends: EndsOfRows<'a>,
    scratch: &'a mut Scratch,
    pixels: &'a mut [u8],
}

/// The neighbourhood of some pixels in the chart.
struct Neighbourhood {
    /// A box in the chart within which it lies: lowest and highest (u,v).
    around: [[f64; 2]; 2],
    /// True if the neighbourhood of each of them covers few enough cells.
    few_cells: bool,
}

/// Some pixels of a row: where they are in the chart, and how a step in it becomes one in pixels. Pixels that show no
/// line are so far away that none is near.
struct Strip {
    u: [f32; LANES],
    v: [f32; LANES],
    /// ∂x/∂u, ∂x/∂v, ∂y/∂u, ∂y/∂v.
    pixels: [[f32; LANES]; 4],
}

impl Work for Band<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let width = self.lines.width;
        let end = self.ends.status.len();
        for left in (0..width).step_by(LANES) {
            let count = LANES.min(width - left);
            let rows = (left..end).step_by(width);
            let Some(bounds) = self.bounds(rows.clone(), count) else {
                continue;
            };
            match self.find(&bounds, false) {
                Near::Nothing => {}
                Near::Some => {
                    for first in rows {
                        self.strip(first, count, bounds.few_cells);
                    }
                }
                Near::Unclear => {
                    for index in rows.flat_map(|first| first..first + count) {
                        let bounds = self.bounds(std::iter::once(index), 1);
                        if let Some(bounds) = bounds
                            && bounds.few_cells
                            && self.find(&bounds, true) == Near::Some
                        {
                            self.strip(index, 1, true);
                        }
                    }
                }
            }
        }
    }
}

impl Band<'_> {
    /// Returns the neighbourhood of a number of pixels from each of the first ones on; `None` if none of them shows the
    /// surface.
    #[inline(always)]
    fn bounds(&self, firsts: impl Iterator<Item = usize>, count: usize) -> Option<Neighbourhood> {
        let EndsOfRows {
            origin,
            offset,
            by_pixel,
            status,
            ..
        } = self.ends;
        let complete = |status: &Status| *status == Status::Complete;
        let mut extent = Extent::default();
        let mut any = false;
        for first in firsts {
            let status = &status[first..first + count];
            let whole = (
                offset[first..].first_chunk::<LANES>(),
                by_pixel[first..].first_chunk::<LANES>(),
            );
            if let (Some(offset), Some(by_pixel)) = whole
                && count == LANES
                && status.iter().all(complete)
            {
                any = true;
                for n in 0..LANES {
                    extent.note(n, &offset[n], &by_pixel[n]);
                }
            } else {
                for n in (0..count).filter(|n| complete(&status[*n])) {
                    any = true;
                    extent.note(n, &offset[first + n], &by_pixel[first + n]);
                }
            }
        }
        if !any {
            return None;
        }
        let (low, high, slopes) = extent.of_all();
        let by_pixel = [0, 1].map(|k| {
            let [x, y] = [slopes[k], slopes[k + 2]].map(f64::from);
            (x * x + y * y).sqrt()
        });
        let reach = by_pixel.map(|x| f64::from(self.lines.pen.reach()) * x);
        Some(Neighbourhood {
            around: [
                [0, 1].map(|k| origin[k] + f64::from(low[k]) - reach[k]),
                [0, 1].map(|k| origin[k] + f64::from(high[k]) + reach[k]),
            ],
            few_cells: self.lines.few_cells(by_pixel),
        })
    }

    /// Finds the segments that are near some pixels, or one.
    #[inline(always)]
    fn find(&mut self, bounds: &Neighbourhood, point: bool) -> Near {
        let Scratch { found, near, .. } = &mut *self.scratch;
        let what = self.lines.table.near(bounds.around, point, found);
        near.clear();
        if what == Near::Some {
            let origin = self.ends.origin;
            near.extend(found.segments.iter().map(|segment| Offset {
                line: segment.line,
                from: [0, 1].map(|k| (segment.from[k] - origin[k]) as f32),
                step: segment.step.map(|x| x as f32),
            }));
        }
        what
    }

    /// Inks some pixels of a row with the segments that are near. `few_cells` is known of all of them, or has to be found
    /// out for each.
    #[inline(always)]
    fn strip(&mut self, first: usize, count: usize, few_cells: bool) {
        let strip = self.measured(first, count, few_cells);
        let Scratch {
            near,
            squares,
            distances,
            named,
            ..
        } = &mut *self.scratch;
        *distances += near.len() as u64;
        for segment in near.iter() {
            strip.measure(segment.from, segment.step, &mut squares[segment.line]);
        }
        let pen = &self.lines.pen;
        let most = pen.reach() * pen.reach();
        let lines = squares.iter_mut().zip(&self.lines.inks).zip(named);
        for ((squares, ink), named) in lines {
            for (n, square) in squares.iter().take(count).enumerate() {
                if *square < most {
                    if let Some(names) = &self.lines.names
                        && *square < pen.half * pen.half
                    {
                        let pixel = self.ends.first * self.lines.width + first + n;
                        named.note(names.place(pixel));
                    }
                    let pixel = 4 * (first + n);
                    pen.ink(&mut self.pixels[pixel..pixel + 4], ink, square.sqrt());
                }
            }
            squares.fill(f32::INFINITY);
        }
    }

    #[inline(always)]
    fn measured(&self, first: usize, count: usize, few_cells: bool) -> Strip {
        let row = first..first + count;
        let mut offset = [[0.0; 2]; LANES];
        let mut by_pixel = [[0.0; 4]; LANES];
        let mut shown = [false; LANES];
        offset[..count].copy_from_slice(&self.ends.offset[row.clone()]);
        by_pixel[..count].copy_from_slice(&self.ends.by_pixel[row.clone()]);
        for (shown, status) in shown.iter_mut().zip(&self.ends.status[row]) {
            *shown = *status == Status::Complete;
        }
        if !few_cells {
            for (shown, by_pixel) in shown.iter_mut().zip(&by_pixel) {
                let [a, b, c, d] = by_pixel.map(f64::from);
                let wide = |x: f64, y: f64| (x * x + y * y).sqrt();
                *shown &= self.lines.few_cells([wide(a, c), wide(b, d)]);
            }
        }
        let mut strip = Strip {
            u: [0.0; LANES],
            v: [0.0; LANES],
            pixels: [[0.0; LANES]; 4],
        };
        for n in 0..LANES {
            strip.u[n] = if shown[n] { offset[n][0] } else { f32::NAN };
            strip.v[n] = if shown[n] { offset[n][1] } else { f32::NAN };
            // (u,v) = x (a,b) + y (c,d), turned round.
            let [a, b, c, d] = by_pixel[n].map(f64::from);
            let one = 1.0 / (a * d - b * c);
            strip.pixels[0][n] = (d * one) as f32;
            strip.pixels[1][n] = (-c * one) as f32;
            strip.pixels[2][n] = (-b * one) as f32;
            strip.pixels[3][n] = (a * one) as f32;
        }
        strip
    }
}

/// The least and largest numbers among pixels' ends, column by column: a row of them is one vector or two.
struct Extent {
    low: [[f32; 2]; LANES],
    high: [[f32; 2]; LANES],
    /// The sizes of the derivatives.
    slopes: [[f32; 4]; LANES],
}

impl Default for Extent {
    fn default() -> Self {
        Self {
            low: [[f32::INFINITY; 2]; LANES],
            high: [[f32::NEG_INFINITY; 2]; LANES],
            slopes: [[0.0; 4]; LANES],
        }
    }
}

#[allow(clippy::needless_range_loop)] // Several arrays are walked together, lane by lane.
impl Extent {
    #[inline(always)]
    fn note(&mut self, column: usize, offset: &[f32; 2], by_pixel: &[f32; 4]) {
        for k in 0..2 {
            self.low[column][k] = lesser(offset[k], self.low[column][k]);
            self.high[column][k] = greater(offset[k], self.high[column][k]);
        }
        for k in 0..4 {
            self.slopes[column][k] = greater(by_pixel[k].abs(), self.slopes[column][k]);
        }
    }

    /// The extent of all columns: lowest and highest offsets, largest derivatives.
    #[inline(always)]
    fn of_all(&self) -> ([f32; 2], [f32; 2], [f32; 4]) {
        let (mut low, mut high, mut slopes) = (self.low[0], self.high[0], self.slopes[0]);
        for n in 1..LANES {
            for k in 0..2 {
                low[k] = lesser(self.low[n][k], low[k]);
                high[k] = greater(self.high[n][k], high[k]);
            }
            for k in 0..4 {
                slopes[k] = greater(self.slopes[n][k], slopes[k]);
            }
        }
        (low, high, slopes)
    }
}

/// `b` where `a` is no number: one instruction, unlike [`f32::min`].
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `b` where `a` is no number.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

impl Strip {
    /// Lowers the squares of the distances to those of a segment, given by offsets from the camera, where it is nearer.
    #[inline(always)]
    fn measure(&self, from: [f32; 2], step: [f32; 2], squares: &mut [f32; LANES]) {
        let [xu, xv, yu, yv] = &self.pixels;
        for n in 0..LANES {
            let (u, v) = (from[0] - self.u[n], from[1] - self.v[n]);
            let p = [u * xu[n] + v * xv[n], u * yu[n] + v * yv[n]];
            let q = [
                step[0] * xu[n] + step[1] * xv[n],
                step[0] * yu[n] + step[1] * yv[n],
            ];
            let square = q[0] * q[0] + q[1] * q[1];
            let t = -(p[0] * q[0] + p[1] * q[1]) / square.max(f32::MIN_POSITIVE);
            let t = t.clamp(0.0, 1.0);
            let off = [p[0] + t * q[0], p[1] + t * q[1]];
            let square = off[0] * off[0] + off[1] * off[1];
            // Not where a pixel has no place: that is no number.
            squares[n] = if square < squares[n] {
                square
            } else {
                squares[n]
            };
        }
    }
}
