//! The cutting of a picture: ends at places in, pieces out, by division into four wherever one polynomial will not do.

use super::fit::{CHECKS, COUNT, Fit, Grid, highest, truncate, value};
use super::{BLOCK, Patch, Single};
use crate::ends::{Coordinates, End, Ends};
use crate::trace::Status;

/// The error at the places of the check is a sample: the largest one may be this much larger.
const WIDENING: f64 = 2.0;
/// Each degree's terms of a series are taken to be at least this share of those of the degree below: what is finer
/// than the nodes may look smooth at all places of the check by chance.
const BEYOND: f64 = 0.12;
/// The share of the tolerance up to which a polynomial's highest terms are left out.
const NEGLIGIBLE: f64 = 0.05;
/// How an error shrinks when the sides are halved.
const HALVED: f64 = (1_u64 << COUNT) as f64;
/// An apex farther off than so many times the patch's extent lets (u,v) be as smooth as its own coordinates.
const FAR_APEX: f64 = 4.0;
/// The corners are looked at before all else, as the first places of the check.
const CORNERS: usize = 4;

/// From a node to the next one that is looked at: without a common divisor with how many there are.
const STRIDE: usize = 3 * COUNT - 1;
/// The pixels of the smallest square that are looked at first; where all of them show nothing, the others do neither.
const FIRST: [[u32; 2]; 9] = [
    [0, 0],
    [7, 0],
    [0, 7],
    [7, 7],
    [4, 0],
    [7, 4],
    [3, 7],
    [0, 3],
    [4, 4],
];

/// What covers a square.
pub(super) enum Piece {
    Patch(Box<Patch>),
    Single {
        corner: [u32; 2],
        single: Single,
    },
    Nothing {
        corner: [u32; 2],
        side: u32,
        status: Status,
    },
}

/// What one part of the picture has become.
#[derive(Default)]
pub(super) struct Pieces {
    pub(super) all: Vec<Piece>,
    pub(super) samples: u64,
}

/// What all squares share.
pub(super) struct Cutter<'e> {
    pub(super) ends: &'e dyn Ends,
    pub(super) size: [u32; 2],
    /// The camera's (u, v).
    pub(super) origin: [f64; 2],
    /// The error that a polynomial may add, in pixels.
    pub(super) tolerance: f64,
    /// A pixel's width on the surface.
    pub(super) pixel: f64,
    /// One pixel in units of the picture.
    pub(super) per_place: f64,
    pub(super) zoom: f64,
    pub(super) fit: Fit,
}

/// A square, or what of it is in the picture.
#[derive(Clone, Copy)]
struct Square {
    corner: [u32; 2],
    side: u32,
    extent: [u32; 2],
}

/// What became of an attempt to cover a square by one polynomial.
enum Attempt {
    Covered(Piece),
    /// To be divided, so many times.
    Divide(u32),
}

impl Cutter<'_> {
    /// Covers the square at a corner.
    pub(super) fn cover(&self, corner: [u32; 2], side: u32, pieces: &mut Pieces) {
        if corner[0] >= self.size[0] || corner[1] >= self.size[1] {
            return;
        }
        let square = Square {
            corner,
            side,
            extent: [0, 1].map(|k| side.min(self.size[k] - corner[k])),
        };
        if side <= BLOCK {
            let single = self.single(&square, pieces);
            pieces.all.push(single);
            return;
        }
        match self.attempt(&square, pieces) {
            Attempt::Covered(piece) => pieces.all.push(piece),
            Attempt::Divide(times) => {
                let side = (side >> times).max(BLOCK);
                let parts = square.side / side;
                for row in 0..parts {
                    for column in 0..parts {
                        let corner = [corner[0] + column * side, corner[1] + row * side];
                        self.cover(corner, side, pieces);
                    }
                }
            }
        }
    }

    /// The place in the picture of (X, Y) in a square.
    fn place(&self, square: &Square, at: [f64; 2]) -> [f64; 2] {
        let pixel = |k: usize| {
            let half = 0.5 * f64::from(square.extent[k]);
            f64::from(square.corner[k]) + half + at[k] * half - 0.5 * f64::from(self.size[k])
        };
        [pixel(0) * self.per_place, -pixel(1) * self.per_place]
    }

    fn end(&self, place: [f64; 2], pieces: &mut Pieces) -> End {
        pieces.samples += 1;
        self.ends.end(place)
    }

    fn attempt(&self, square: &Square, pieces: &mut Pieces) -> Attempt {
        // Corners that differ cost four looks, not all.
        let outermost = square.extent.map(|n| 1.0 - 1.0 / f64::from(n));
        let places = self.fit.checks;
        let check_at = |n: usize| [0, 1].map(|k| places[n][k] * outermost[k]);
        let mut checks = [None; CHECKS];
        let mut status = None;
        for (n, check) in checks.iter_mut().enumerate().take(CORNERS) {
            let end = self.end(self.place(square, check_at(n)), pieces);
            if *status.get_or_insert(end.status) != end.status {
                return Attempt::Divide(1);
            }
            *check = Some(end);
        }
        let nodes = self.fit.nodes;
        let mut samples = [(); COUNT * COUNT].map(|()| None);
        for n in 0..COUNT * COUNT {
            // Far from each other one after the other: a line between two statuses is soon met.
            let n = STRIDE * n % (COUNT * COUNT);
            let place = self.place(square, [nodes[n % COUNT], nodes[n / COUNT]]);
            let end = self.end(place, pieces);
            if status != Some(end.status) {
                return Attempt::Divide(1);
            }
            samples[n] = Some((place, end));
        }
        let mut samples: Vec<(Place, End)> = samples.into_iter().flatten().collect();
        let status = status.unwrap_or_default();
        if status != Status::Complete {
            return Attempt::Covered(Piece::Nothing {
                corner: square.corner,
                side: square.side,
                status,
            });
        }
        let Some(coordinates) = self.common(&mut samples) else {
            return Attempt::Divide(1);
        };
        let periods = self.periods(coordinates);
        self.unify(&mut samples, periods);

        // The middle sample's value is taken away first: what is left is small.
        let reference = samples[COUNT * COUNT / 2 + COUNT / 2].1;
        let lengths = [[1.0, 0.0], [0.0, 1.0]].map(|v| reference.length(v) / self.pixel);
        let mut powers = [[[0.0; COUNT]; COUNT]; 2];
        let mut worst = 0.0_f64;
        for (k, powers) in powers.iter_mut().enumerate() {
            let values: Grid = std::array::from_fn(|j| {
                std::array::from_fn(|i| samples[COUNT * j + i].1.at[k] - reference.at[k])
            });
            let mut series = self.fit.series(&values);
            let [last, before] = highest(&series);
            let beyond = (BEYOND * last).max(BEYOND * BEYOND * before);
            worst = worst.max(lengths[k] * beyond);
            truncate(&mut series, NEGLIGIBLE * self.tolerance / lengths[k]);
            *powers = self.fit.powers(&series);
        }
        if let Some(times) = self.divisions(worst) {
            return Attempt::Divide(times);
        }
        for (n, check) in checks.iter_mut().enumerate() {
            let at = check_at(n);
            let end = match check.take() {
                Some(end) => end,
                None => self.end(self.place(square, at), pieces),
            };
            let error = self.discrepancy(&end, coordinates, periods, |k| {
                reference.at[k] + value(&powers[k], at)
            });
            // A NaN is no proof either.
            if end.status != Status::Complete || error.is_nan() {
                return Attempt::Divide(1);
            }
            worst = worst.max(WIDENING * error);
            if let Some(times) = self.divisions(worst) {
                return Attempt::Divide(times);
            }
        }
        let centre = [0, 1].map(|k| reference.at[k] + powers[k][0][0]);
        Attempt::Covered(Piece::Patch(Box::new(Patch {
            corner: square.corner,
            side: square.side,
            extent: square.extent,
            coordinates,
            centre,
            coefficients: [0, 1].map(|k| {
                let mut rows = powers[k].map(|row| row.map(|c| c as f32));
                rows[0][0] = 0.0;
                rows
            }),
            error: worst as f32,
        })))
    }

    /// How often a square with this error is to be divided, if it is.
    fn divisions(&self, error: f64) -> Option<u32> {
        let twice = error > 2.0 * HALVED * self.tolerance;
        (error > self.tolerance || error.is_nan()).then_some(if twice { 2 } else { 1 })
    }

    /// Brings all samples into common coordinates, where there are such.
    fn common(&self, samples: &mut [(Place, End)]) -> Option<Coordinates> {
        let apex = samples
            .iter()
            .map(|(_, end)| end.coordinates)
            .find(|coordinates| *coordinates != Coordinates::Plain);
        let Some(apex) = apex else {
            return Some(Coordinates::Plain);
        };
        let known = match apex {
            Coordinates::Apex { axis, end } => self.ends.polar(axis, end).is_some(),
            Coordinates::Plain => true,
        };
        let about: Option<Vec<End>> = samples
            .iter()
            .map(|(_, end)| self.ends.in_coordinates(end, apex))
            .collect();
        let coordinates = match about {
            Some(about) if known && is_near(&about) => apex,
            _ => Coordinates::Plain,
        };
        for (_, end) in samples.iter_mut() {
            *end = self.ends.in_coordinates(end, coordinates)?;
        }
        Some(coordinates)
    }

    fn periods(&self, coordinates: Coordinates) -> [f64; 2] {
        match coordinates {
            Coordinates::Plain => self.ends.periods(),
            Coordinates::Apex { .. } => [0.0; 2],
        }
    }

    /// Adds periods so that each sample lies where the derivatives at it and at a neighbour expect it.
    fn unify(&self, samples: &mut [(Place, End)], periods: [f64; 2]) {
        if periods == [0.0; 2] {
            return;
        }
        for n in 1..samples.len() {
            let before = if n % COUNT == 0 { n - COUNT } else { n - 1 };
            let (from, known) = samples[before];
            let (to, end) = &mut samples[n];
            let way = [0, 1].map(|k| to[k] - from[k]);
            let [a, b] = [(from, &known), (*to, &*end)].map(|(place, end)| {
                let [x, y] = end.by_place(place, self.zoom);
                [0, 1].map(|k| x[k] * way[0] + y[k] * way[1])
            });
            for k in 0..2 {
                if periods[k] > 0.0 {
                    let expected = 0.5 * (a[k] + b[k]);
                    let expected = if expected.is_finite() { expected } else { 0.0 };
                    let off = end.at[k] - known.at[k] - expected;
                    let turns = (off / periods[k]).round();
                    if turns.is_finite() {
                        end.at[k] -= periods[k] * turns;
                    }
                }
            }
        }
    }

    /// How far a polynomial's value is off an end, in pixels.
    fn discrepancy(
        &self,
        end: &End,
        coordinates: Coordinates,
        periods: [f64; 2],
        value: impl Fn(usize) -> f64,
    ) -> f64 {
        let Some(end) = self.ends.in_coordinates(end, coordinates) else {
            return f64::NAN;
        };
        let off = [0, 1].map(|k| {
            let off = value(k) - end.at[k];
            if periods[k] > 0.0 {
                off - periods[k] * (off / periods[k]).round()
            } else {
                off
            }
        });
        if off == [0.0; 2] {
            return 0.0;
        }
        end.length(off) / self.pixel
    }

    /// The pixels of the smallest square, one by one.
    fn single(&self, square: &Square, pieces: &mut Pieces) -> Piece {
        let look = |[column, row]: [u32; 2], pieces: &mut Pieces| {
            let at = [(column, 0), (row, 1)]
                .map(|(n, k)| (2.0 * f64::from(n) + 1.0) / f64::from(square.extent[k]) - 1.0);
            let place = self.place(square, at);
            (place, self.end(place, pieces))
        };
        let pixels = (BLOCK * BLOCK) as usize;
        let mut known = vec![None; pixels];
        let mut seen = None;
        let mut nothing = true;
        for pixel in FIRST {
            let pixel = [0, 1].map(|k| pixel[k].min(square.extent[k] - 1));
            let index = (pixel[1] * BLOCK + pixel[0]) as usize;
            let (_, end) = *known[index].get_or_insert_with(|| look(pixel, pieces));
            nothing &= end.status != Status::Complete;
            nothing &= *seen.get_or_insert(end.status) == end.status;
            if !nothing {
                break;
            }
        }
        if let (true, Some(status)) = (nothing, seen) {
            return Piece::Nothing {
                corner: square.corner,
                side: square.side,
                status,
            };
        }
        let mut single = Single {
            offset: vec![[0.0; 2]; pixels],
            by_pixel: vec![[0.0; 4]; pixels],
            status: vec![Status::default(); pixels],
        };
        for row in 0..square.extent[1] {
            for column in 0..square.extent[0] {
                let index = (row * BLOCK + column) as usize;
                let (place, end) = match known[index] {
                    Some(known) => known,
                    None => look([column, row], pieces),
                };
                single.status[index] = end.status;
                if end.status == Status::Complete {
                    (single.offset[index], single.by_pixel[index]) = self.pixel(end, place);
                }
            }
        }
        Piece::Single {
            corner: square.corner,
            single,
        }
    }

    /// A complete end as an offset, with its derivatives by pixel.
    pub(super) fn pixel(&self, end: End, place: [f64; 2]) -> ([f32; 2], [f32; 4]) {
        let plain = self.ends.in_coordinates(&end, Coordinates::Plain);
        let mut end = plain.unwrap_or(end);
        if end.stretch.is_nan() {
            end.stretch = 1.0;
        }
        let offset = [0, 1].map(|k| (end.at[k] - self.origin[k]) as f32);
        let [x, y] = end
            .by_place(place, self.zoom)
            .map(|d| d.map(|c| (c * self.per_place) as f32));
        let by_pixel = [x[0], x[1], -y[0], -y[1]];
        let finite = |all: &[f32]| all.iter().all(|x| x.is_finite());
        (
            if finite(&offset) { offset } else { [0.0; 2] },
            if finite(&by_pixel) {
                by_pixel
            } else {
                [0.0; 4]
            },
        )
    }
}

type Place = [f64; 2];

/// Whether an apex is so near to ends about it that their polar coordinates would bend.
fn is_near(ends: &[End]) -> bool {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    let mut nearest = f64::INFINITY;
    for end in ends {
        nearest = nearest.min(end.at[0].hypot(end.at[1]));
        for k in 0..2 {
            low[k] = low[k].min(end.at[k]);
            high[k] = high[k].max(end.at[k]);
        }
    }
    nearest < FAR_APEX * (high[0] - low[0]).max(high[1] - low[1])
}
