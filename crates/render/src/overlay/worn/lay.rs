//! Lines in the chart are laid over a picture: pieces and the pixels' ends flow in, inked pixels flow out.
//!
//! A pixel's distance to a line is measured in the chart and turned into pixels by the derivative of its end, so lines
//! are as wide as other lines wherever they are seen. Pieces are looked up for a block of pixels at once, and measured
//! for a row of it at once, in loops that become vectors.

use expr::processor::{Processor, Work};
use geodesic::patchwork::BLOCK;
use geodesic::trace::Status;

use super::super::Pen;
use super::Worn;
use super::table::{Near, Piece, Table};
use crate::geodesic_view::{EndsOfRows, Inside, Layer, Tally};
use crate::style;

/// Pixels that are measured together.
const LANES: usize = BLOCK as usize;
/// Where what is near a pixel covers more cells of the table, lines are thinner than can be seen.
const MOST_CELLS: f64 = 256.0;
/// How much farther than half its width a line is looked for: its rim.
const RIM: f32 = 2.5;

/// Lines that are laid over a picture, the first one undermost.
pub(in crate::overlay) struct Lines<'t> {
    table: Table,
    /// Of each line, in linear light.
    colours: Vec<[f32; 3]>,
    pen: Pen,
    /// Lines that are farther away, in pixels, are not looked for.
    most: f32,
    /// The picture's.
    width: usize,
    processor: Processor,
    tally: &'t Tally,
}

impl<'t> Lines<'t> {
    /// None where there is nothing to be laid.
    pub(in crate::overlay) fn new(
        lines: &[Worn],
        inside: &Inside,
        tally: &'t Tally,
    ) -> Option<Self> {
        if lines.iter().all(|line| line.pieces.is_empty()) {
            return None;
        }
        let size = inside.size();
        let pen = Pen::of(size);
        let colour = |line: &Worn| style::linear(line.colour);
        Some(Self {
            table: Table::new(lines, inside),
            colours: lines.iter().map(colour).collect(),
            pen,
            most: pen.half + RIM,
            width: size[0] as usize,
            processor: Processor::here(),
            tally,
        })
    }

    /// Whether what is so wide in (u,v) covers few enough cells.
    #[inline(always)]
    fn few_cells(&self, [u, v]: [f64; 2]) -> bool {
        let [across, down] = self.table.cells_per_unit();
        (1.0 + u * across) * (1.0 + v * down) <= MOST_CELLS
    }

    fn scratch(&self) -> Scratch {
        Scratch {
            near: Vec::new(),
            squares: vec![[f32::INFINITY; LANES]; self.colours.len()],
            distances: 0,
        }
    }
}

impl Layer for Lines<'_> {
    fn lay(&self, ends: EndsOfRows<'_>, pixels: &mut [u8]) {
        // Without derivatives, nothing is known of a line's width.
        if ends.by_pixel.is_empty() {
            return;
        }
        let mut scratch = self.scratch();
        self.processor.run(Band {
            lines: self,
            ends,
            scratch: &mut scratch,
            pixels,
        });
        self.tally.distances(scratch.distances);
    }
}

/// What a band of pixels is measured with.
struct Scratch {
    near: Vec<Piece>,
    /// The squares of the lines' distances.
    squares: Vec<[f32; LANES]>,
    /// See [`Tally::distances`].
    distances: u64,
}

/// Some whole rows of pixels with their ends.
struct Band<'a> {
    lines: &'a Lines<'a>,
    ends: EndsOfRows<'a>,
    scratch: &'a mut Scratch,
    pixels: &'a mut [u8],
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
        for left in (0..width).step_by(LANES) {
            let count = LANES.min(width - left);
            let rows = || (left..self.ends.offset.len()).step_by(width);
            let bounds = self.bounds(rows().map(|first| first..first + count));
            match self.lines.table.near(bounds, false, &mut self.scratch.near) {
                Near::Nothing => {}
                Near::Some => {
                    for first in (left..self.ends.offset.len()).step_by(width) {
                        self.strip(first, count);
                    }
                }
                Near::Unclear => {
                    for first in (left..self.ends.offset.len()).step_by(width) {
                        for index in first..first + count {
                            let bounds = self.bounds(std::iter::once(index..index + 1));
                            let near = &mut self.scratch.near;
                            if self
                                .lines
                                .few_cells([0, 1].map(|k| bounds[1][k] - bounds[0][k]))
                                && self.lines.table.near(bounds, true, near) == Near::Some
                            {
                                self.strip(index, 1);
                            }
                        }
                    }
                }
            }
        }
    }
}

impl Band<'_> {
    /// A box in the chart within which all lies that is near some pixels.
    #[inline(always)]
    fn bounds(&self, rows: impl Iterator<Item = std::ops::Range<usize>>) -> [[f64; 2]; 2] {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        let mut largest = [0.0_f32; 4];
        for row in rows {
            for offset in &self.ends.offset[row.clone()] {
                for k in 0..2 {
                    low[k] = low[k].min(offset[k]);
                    high[k] = high[k].max(offset[k]);
                }
            }
            for derivative in &self.ends.by_pixel[row] {
                for k in 0..4 {
                    largest[k] = largest[k].max(derivative[k].abs());
                }
            }
        }
        let reach = [0, 1].map(|k| {
            let [x, y] = [largest[k], largest[k + 2]].map(f64::from);
            f64::from(self.lines.most) * (x * x + y * y).sqrt()
        });
        let at = |k: usize, offset: f32| self.ends.origin[k] + f64::from(offset);
        [
            [0, 1].map(|k| at(k, low[k]) - reach[k]),
            [0, 1].map(|k| at(k, high[k]) + reach[k]),
        ]
    }

    /// Inks some pixels of a row with the pieces that are near.
    #[inline(always)]
    fn strip(&mut self, first: usize, count: usize) {
        let strip = self.measured(first, count);
        let Scratch {
            near,
            squares,
            distances,
        } = &mut *self.scratch;
        *distances += near.len() as u64;
        for piece in near.iter() {
            let from = [0, 1].map(|k| (piece.from[k] - self.ends.origin[k]) as f32);
            strip.measure(from, piece.step.map(|x| x as f32), &mut squares[piece.line]);
        }
        let most = self.lines.most * self.lines.most;
        for (squares, colour) in squares.iter_mut().zip(&self.lines.colours) {
            for (n, square) in squares.iter().take(count).enumerate() {
                if *square < most {
                    let pixel = 4 * (first + n);
                    let pixel = &mut self.pixels[pixel..pixel + 4];
                    self.lines.pen.ink(pixel, *colour, square.sqrt());
                }
            }
            squares.fill(f32::INFINITY);
        }
    }

    #[inline(always)]
    fn measured(&self, first: usize, count: usize) -> Strip {
        let mut strip = Strip {
            u: [f32::NAN; LANES],
            v: [f32::NAN; LANES],
            pixels: [[0.0; LANES]; 4],
        };
        let across = 2.0 * f64::from(self.lines.most);
        for n in 0..count {
            let index = first + n;
            // (u,v) = x (a,b) + y (c,d), turned round.
            let [a, b, c, d] = self.ends.by_pixel[index].map(f64::from);
            let one = 1.0 / (a * d - b * c);
            let wide = |x: f64, y: f64| across * (x * x + y * y).sqrt();
            let few = self.lines.few_cells([wide(a, c), wide(b, d)]);
            if few && self.ends.status[index] == Status::Complete {
                [strip.u[n], strip.v[n]] = self.ends.offset[index];
            }
            let pixels = [d * one, -c * one, -b * one, a * one];
            for (lanes, x) in strip.pixels.iter_mut().zip(pixels) {
                lanes[n] = x as f32;
            }
        }
        strip
    }
}

impl Strip {
    /// Lowers the squares of the distances to those of a piece, given by offsets from the camera, where it is nearer.
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
