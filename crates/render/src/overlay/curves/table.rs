//! The segments of all lines, found by where they are in the chart.
//!
//! Segments flow in, and then boxes of the chart; the segments that may go through a box flow out. Whether there are
//! any, as there are not for most of a picture, is known from one sum.

use geodesic::ends::Coordinates;
use geodesic::frame::Frame;
use geodesic::surface::{Side, Sides};

use super::SurfaceCurve;
use crate::geodesic_view::PlacedCamera;

/// The fewest and the most cells of the table along an axis.
const CELLS: [f64; 2] = [8.0, 256.0];
/// The least side of a cell in pixels about the camera. Smaller cells would be found in greater numbers only.
const CELL: f64 = 4.0;
/// A box that is wider than this share of a period may meet a segment in several repetitions.
const ROUND: f64 = 0.25;

/// A straight segment in the chart, of one of the lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) line: usize,
    pub(super) from: [f64; 2],
    pub(super) step: [f64; 2],
}

/// The segments by the cells of the chart that they may go through.
pub(super) struct SegmentTable {
    domain: [[f64; 2]; 2],
    sides: Sides,
    wraps: [bool; 2],
    period: [f64; 2],
    /// The number of cells along each axis.
    cells: [usize; 2],
    segments: Vec<Segment>,
    /// The index in `numbers` of each cell's first segment, row by row; one more entry than there are cells.
    begins: Vec<u32>,
    /// Numbers of segments.
    numbers: Vec<u32>,
    /// The number of entries in the cells below and to the left of each corner of a cell.
    sums: Vec<u32>,
}

/// Segments that were found, each once.
#[derive(Debug, Default)]
pub(super) struct FoundSegments {
    pub(super) segments: Vec<Segment>,
    /// The number of the last search that came upon each segment of the table.
    searches: Vec<u32>,
    search: u32,
}

impl FoundSegments {
    fn begin(&mut self, segments: usize) {
        if self.searches.len() != segments || self.search == u32::MAX {
            self.searches = vec![0; segments];
            self.search = 0;
        }
        self.search += 1;
    }

    /// Returns true if this search comes upon a segment for the first time.
    #[inline(always)]
    fn is_new(&mut self, number: u32) -> bool {
        let last = &mut self.searches[number as usize];
        let new = *last != self.search;
        *last = self.search;
        new
    }
}

/// The segments that may go through a box.
#[derive(Debug, PartialEq)]
pub(super) enum Near {
    Nothing,
    /// They are in the list, in the box's own coordinates.
    Some,
    /// The box lies on both sides of a seam that turns the chart over, or reaches far round the chart: no one list will
    /// do for all of it.
    Unclear,
}

impl SegmentTable {
    pub(super) fn new(lines: &[SurfaceCurve], camera: &PlacedCamera) -> Self {
        let (domain, sides) = (camera.domain(), camera.sides());
        let segments = |(line, curve): (usize, &SurfaceCurve)| {
            let segment = move |&[from, to]: &[[f64; 2]; 2]| Segment {
                line,
                from,
                step: [to[0] - from[0], to[1] - from[1]],
            };
            curve.pieces.iter().map(segment).collect::<Vec<_>>()
        };
        let mut table = Self {
            domain,
            sides,
            wraps: [0, 1].map(|k| sides.of(k)[0] == Side::Wrap),
            period: domain.map(|[low, high]| high - low),
            cells: cell_counts(camera),
            segments: lines.iter().enumerate().flat_map(segments).collect(),
            begins: Vec::new(),
            numbers: Vec::new(),
            sums: Vec::new(),
        };
        table.enter();
        table
    }

    /// Cells per unit of each coordinate.
    pub(super) fn cells_per_unit(&self) -> [f64; 2] {
        [0, 1].map(|k| self.cells[k] as f64 / self.period[k])
    }

    /// The segments that may go through a box (lowest and highest (u,v), which may lie beyond sides that wrap), in its own
    /// coordinates. A box about one point is never unclear: it is taken to be where its middle is.
    #[inline(always)]
    pub(super) fn near(
        &self,
        bounds: [[f64; 2]; 2],
        point: bool,
        found: &mut FoundSegments,
    ) -> Near {
        found.segments.clear();
        let Some(Turned {
            bounds,
            signs,
            shift,
        }) = self.turned(bounds, point)
        else {
            return Near::Unclear;
        };
        let [low, high] = bounds;
        let ranges = [0, 1].map(|axis| self.ranges(axis, low[axis], high[axis]));
        let [Some(columns), Some(rows)] = ranges else {
            return Near::Nothing;
        };
        if !self.any(&columns, &rows) {
            return Near::Nothing;
        }
        let far = |k: usize| self.wraps[k] && high[k] - low[k] > ROUND * self.period[k];
        if !point && (far(0) || far(1)) {
            return Near::Unclear;
        }
        found.begin(self.segments.len());
        let middle = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
        for row in rows.iter().flat_map(|&[from, to]| from..to) {
            for number in columns.iter().flat_map(|columns| self.in_row(row, columns)) {
                if !found.is_new(*number) {
                    continue;
                }
                let Segment {
                    line,
                    mut from,
                    step,
                } = self.segments[*number as usize];
                for (k, from) in from.iter_mut().enumerate() {
                    if self.wraps[k] {
                        let period = self.period[k];
                        *from += period * ((middle[k] - *from) / period).round();
                    }
                }
                let meets = |k: usize| {
                    let to = from[k] + step[k];
                    from[k].min(to) <= high[k] && from[k].max(to) >= low[k]
                };
                if meets(0) && meets(1) {
                    found.segments.push(Segment {
                        line,
                        from: [0, 1].map(|k| signs[k] * (from[k] - shift[k])),
                        step: [0, 1].map(|k| signs[k] * step[k]),
                    });
                }
            }
        }
        match found.segments.is_empty() {
            true => Near::Nothing,
            false => Near::Some,
        }
    }

    /// A box turned over through the sides that flip, so that it lies in the domain; `None` where it lies on both sides of
    /// one of them.
    #[inline(always)]
    fn turned(&self, bounds: [[f64; 2]; 2], point: bool) -> Option<Turned> {
        let mut turned = Turned {
            bounds,
            signs: [1.0; 2],
            shift: [0.0; 2],
        };
        let Turned {
            bounds: [low, high],
            signs,
            shift,
        } = &mut turned;
        for axis in 0..2 {
            if self.sides.of(axis)[0] != Side::WrapFlip {
                continue;
            }
            let period = self.period[axis];
            let turns = |x: f64| ((x - self.domain[axis][0]) / period).floor();
            let here = turns(0.5 * (low[axis] + high[axis]));
            if !point && (turns(low[axis]) != here || turns(high[axis]) != here) {
                return None;
            }
            low[axis] -= here * period;
            high[axis] -= here * period;
            shift[axis] -= here * period;
            if here.rem_euclid(2.0) == 1.0 {
                let other = 1 - axis;
                let both = self.domain[other][0] + self.domain[other][1];
                (low[other], high[other]) = (both - high[other], both - low[other]);
                signs[other] = -signs[other];
                shift[other] = both - shift[other];
            }
        }
        Some(turned)
    }

    /// Returns true if any segment is entered in some columns and rows of cells.
    #[inline(always)]
    fn any(&self, columns: &[[usize; 2]; 2], rows: &[[usize; 2]; 2]) -> bool {
        let sum = |i: usize, j: usize| self.sums[j * (self.cells[0] + 1) + i];
        columns.iter().any(|&[i0, i1]| {
            rows.iter()
                .any(|&[j0, j1]| sum(i1, j1) + sum(i0, j0) != sum(i0, j1) + sum(i1, j0))
        })
    }

    /// The cells between two numbers, and one more on both sides for what rounding does: one or two ranges without their
    /// ends.
    #[inline(always)]
    fn ranges(&self, axis: usize, low: f64, high: f64) -> Option<[[usize; 2]; 2]> {
        let n = self.cells[axis] as i64;
        let [low, high] = [low, high].map(|x| self.cell(axis, x));
        if !(low.is_finite() && high.is_finite()) {
            return None;
        }
        let from = (low.floor() as i64).saturating_sub(1);
        let to = (high.floor() as i64).saturating_add(2);
        if !self.wraps[axis] {
            let kept = |cell: i64| cell.clamp(0, n) as usize;
            return Some([[kept(from), kept(to)], [0, 0]]);
        }
        if to.saturating_sub(from) >= n {
            return Some([[0, self.cells[axis]], [0, 0]]);
        }
        let first = from.rem_euclid(n);
        let end = first + (to - from);
        Some([
            [first as usize, end.min(n) as usize],
            [0, (end - n).max(0) as usize],
        ])
    }

    #[inline(always)]
    fn cell(&self, axis: usize, x: f64) -> f64 {
        (x - self.domain[axis][0]) / self.period[axis] * self.cells[axis] as f64
    }

    /// Returns the entries of some columns of a row, which are contiguous.
    #[inline(always)]
    fn in_row(&self, row: usize, &[from, to]: &[usize; 2]) -> &[u32] {
        let begin = |column: usize| self.begins[row * self.cells[0] + column] as usize;
        &self.numbers[begin(from)..begin(to)]
    }

    /// Enters the segments: first how many each cell has, then which.
    fn enter(&mut self) {
        let [columns, rows] = self.cells;
        let bounded = |axis: usize, cell: i64| -> Option<usize> {
            let n = self.cells[axis] as i64;
            if (0..n).contains(&cell) {
                Some(cell as usize)
            } else {
                self.wraps[axis].then(|| cell.rem_euclid(n) as usize)
            }
        };
        let mut entries: Vec<[u32; 2]> = Vec::new();
        for (number, segment) in self.segments.iter().enumerate() {
            let range = |k: usize| {
                let ends = [segment.from[k], segment.from[k] + segment.step[k]];
                let [from, to] = ends.map(|x| self.cell(k, x));
                from.min(to).floor() as i64..=from.max(to).floor() as i64
            };
            for row in range(1) {
                for column in range(0) {
                    if let (Some(column), Some(row)) = (bounded(0, column), bounded(1, row)) {
                        entries.push([(row * columns + column) as u32, number as u32]);
                    }
                }
            }
        }
        let mut begins = vec![0_u32; columns * rows + 1];
        for [cell, _] in &entries {
            begins[*cell as usize + 1] += 1;
        }
        let corners = columns + 1;
        let mut sums = vec![0_u32; corners * (rows + 1)];
        for row in 0..rows {
            let mut left = 0;
            for column in 0..columns {
                left += begins[row * columns + column + 1];
                sums[(row + 1) * corners + column + 1] = sums[row * corners + column + 1] + left;
            }
        }
        for cell in 0..columns * rows {
            begins[cell + 1] += begins[cell];
        }
        let mut next = begins.clone();
        let mut numbers = vec![0; entries.len()];
        for [cell, number] in entries {
            let next = &mut next[cell as usize];
            numbers[*next as usize] = number;
            *next += 1;
        }
        (self.begins, self.numbers, self.sums) = (begins, numbers, sums);
    }
}

/// The number of cells along each axis: so many that a pixel near the camera covers few, and a wide one some. At a pole the
/// picture does not say how large a pixel is in the chart.
fn cell_counts(camera: &PlacedCamera) -> [usize; 2] {
    let [fewest, most] = CELLS;
    let [width, height] = camera.size().map(f64::from);
    let Frame {
        coordinates, x, y, ..
    } = camera.frame;
    let domain = camera.domain();
    [0, 1].map(|k| {
        let [low, high] = domain[k];
        let pixel = x[k].hypot(y[k]) * 2.0 / width.min(height).max(1.0);
        let count = (high - low) / (CELL * pixel);
        match coordinates {
            Coordinates::Plain => count.max(fewest).min(most) as usize,
            _ => most as usize,
        }
    })
}

/// A box in the domain: its coordinates are those that it had times `signs`, and then `shift` more.
struct Turned {
    bounds: [[f64; 2]; 2],
    signs: [f64; 2],
    shift: [f64; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from 0 to 1 without a pattern.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 7_u64;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// All repetitions, within two turns, of a segment of a chart whose u wraps: by turns of it, turned over by each one
    /// where it flips.
    fn repeated(table: &SegmentTable, segment: &Segment, flips: bool) -> Vec<Segment> {
        let turn = |turn: i32| {
            let over = flips && turn % 2 != 0;
            let sign = if over { -1.0 } else { 1.0 };
            let both = table.domain[1][0] + table.domain[1][1];
            let v = if over {
                both - segment.from[1]
            } else {
                segment.from[1]
            };
            Segment {
                line: segment.line,
                from: [segment.from[0] + f64::from(turn) * table.period[0], v],
                step: [segment.step[0], sign * segment.step[1]],
            }
        };
        (-2..=2).map(turn).collect()
    }

    fn agrees(side: Side) -> [usize; 3] {
        let sides = Sides {
            u: [side; 2],
            v: [Side::Edge; 2],
        };
        let domain = [[-1.0, 2.0], [0.5, 1.5]];
        let mut number = numbers();
        let segments = (0..300).map(|line| Segment {
            line,
            from: [-1.0 + 2.95 * number(), 0.5 + 0.95 * number()],
            step: [0.04 * number(), 0.04 * number()],
        });
        let mut table = SegmentTable {
            domain,
            sides,
            wraps: [side == Side::Wrap, false],
            period: domain.map(|[low, high]| high - low),
            cells: [256, 128],
            segments: segments.collect(),
            begins: Vec::new(),
            numbers: Vec::new(),
            sums: Vec::new(),
        };
        table.enter();
        let mut counts = [0; 3];
        let mut found = FoundSegments::default();
        for _ in 0..2000 {
            let low = [-6.0 + 12.0 * number(), 0.5 + 0.9 * number()];
            let size = [0.3 * number() * number(), 0.1 * number()];
            let high = [low[0] + size[0], low[1] + size[1]];
            let near = table.near([low, high], false, &mut found);
            if near == Near::Unclear {
                counts[2] += 1;
                continue;
            }
            let meets = |segment: &Segment| {
                (0..2).all(|k| {
                    segment.from[k].max(segment.from[k] + segment.step[k]) >= low[k]
                        && segment.from[k].min(segment.from[k] + segment.step[k]) <= high[k]
                })
            };
            let mut wanted: Vec<usize> = table
                .segments
                .iter()
                .flat_map(|segment| repeated(&table, segment, side == Side::WrapFlip))
                .filter(meets)
                .map(|segment| segment.line)
                .collect();
            wanted.sort_unstable();
            wanted.dedup();
            let mut lines: Vec<usize> = found.segments.iter().map(|segment| segment.line).collect();
            lines.sort_unstable();
            assert_eq!(lines, wanted, "{low:?} {high:?}");
            assert!(
                found.segments.iter().all(meets),
                "{found:?} {low:?} {high:?}"
            );
            counts[usize::from(near == Near::Some)] += 1;
        }
        counts
    }

    #[test]
    fn a_box_finds_the_pieces_that_go_through_it_on_every_turn_of_the_chart() {
        for side in [Side::Wrap, Side::WrapFlip] {
            let [nothing, some, unclear] = agrees(side);
            assert!(
                nothing > 100 && some > 100 && unclear < 200,
                "{nothing} {some} {unclear}"
            );
        }
    }
}
