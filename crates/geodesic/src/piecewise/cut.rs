//! The subdivision of a picture. In: ends at points. Out: pieces, by division into four wherever one polynomial does
//! not suffice.

use std::array::from_fn;

use super::fit::{CHECKS, COUNT, Fit, Grid, highest, truncate};
use super::square::{
    Agreement, CORNERS, Place, Polynomials, SquareSamples, goes_on, is_near, unit,
};
use super::{BLOCK, Patch, Single};
use crate::ends::{Coordinates, End, Ends};
use crate::point::PicturePoint;
use crate::status::Status;

/// The error at the check points is a sample: the maximum may be larger by this factor.
const WIDENING: f64 = 2.0;
/// Each degree's terms of a series are assumed to be at least this fraction of those of the degree below: features
/// finer than the nodes may look smooth at all check points by chance.
const BEYOND: f64 = 0.12;
/// The fraction of the tolerance up to which a polynomial's highest terms are dropped.
const NEGLIGIBLE: f64 = 0.05;
/// The factor by which the error shrinks when the sides are halved.
const HALVED: f64 = (1_u64 << COUNT) as f64;
/// An end within this many pixels of an edge may be taken for one on the other side of it.
const BESIDE: f64 = 0.2;

/// The step from a node to the next one sampled: coprime to their number.
const STRIDE: usize = 3 * COUNT - 1;
/// The pixels of the smallest square that are evaluated first. If all of them show nothing, and are not on two sides of
/// the surface, neither do the others.
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

/// The cover of one square.
pub(super) enum Piece<const N: usize> {
    Patch(Box<Patch<N>>),
    Single {
        corner: [u32; 2],
        single: Single<N>,
    },
    Nothing {
        corner: [u32; 2],
        side: u32,
        status: Status,
    },
}

/// The squares into which one part of the picture has been divided.
#[derive(Default)]
pub(super) struct Pieces<const N: usize> {
    pub(super) all: Vec<Piece<N>>,
    pub(super) samples: u64,
    /// The ends sampled last.
    seen: Vec<End<N>>,
}

/// Divides the picture until each square is covered; shared by all squares.
pub(super) struct Subdivider<'e, const N: usize> {
    pub(super) ends: &'e dyn Ends<N>,
    pub(super) size: [u32; 2],
    /// The camera's position.
    pub(super) origin: [f64; N],
    /// The error that a polynomial may add, in pixels.
    pub(super) tolerance: f64,
    /// A pixel's width on the surface.
    pub(super) pixel: f64,
    /// One pixel in units of the picture.
    pub(super) per_place: f64,
    pub(super) zoom: f64,
    /// [`Ends::bounds`].
    pub(super) bounds: [[f64; 2]; N],
    pub(super) fit: Fit,
}

/// A square, or the part of it in the picture.
#[derive(Clone, Copy)]
struct Square {
    corner: [u32; 2],
    side: u32,
    extent: [u32; 2],
}

/// The outcome of an attempt to cover a square by one polynomial.
enum Attempt<const N: usize> {
    Covered(Piece<N>),
    /// To be divided this many times.
    Divide(u32),
}

impl<const N: usize> Subdivider<'_, N> {
    /// Covers the square at a corner.
    pub(super) fn cover(&self, corner: [u32; 2], side: u32, pieces: &mut Pieces<N>) {
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

    /// Returns the point of the picture at (X, Y) in a square.
    fn place(&self, square: &Square, at: [f64; 2]) -> Place {
        let pixel = |k: usize| {
            let half = 0.5 * f64::from(square.extent[k]);
            f64::from(square.corner[k]) + half + at[k] * half - 0.5 * f64::from(self.size[k])
        };
        PicturePoint([pixel(0) * self.per_place, -pixel(1) * self.per_place])
    }

    /// Evaluates the ends of several points into `pieces.seen`.
    fn evaluate(&self, places: &[Place], pieces: &mut Pieces<N>) {
        pieces.samples += places.len() as u64;
        pieces.seen.clear();
        self.ends.ends(places, &mut pieces.seen);
    }

    /// Tries one polynomial for the whole square. Ends are evaluated in groups, the cheapest rejections first: corners
    /// that differ cost four evaluations, not all.
    fn attempt(&self, square: &Square, pieces: &mut Pieces<N>) -> Attempt<N> {
        let Some(mut samples) = self.sample(square, pieces) else {
            return Attempt::Divide(1);
        };
        match samples.agreement {
            Agreement::Alike(Status::Complete) => {}
            Agreement::Alike(status) => {
                let nodes = samples.nodes.iter().map(|(_, end)| end);
                if self.may_straddle(samples.corners.iter().chain(nodes)) {
                    return Attempt::Divide(1);
                }
                return Attempt::Covered(Piece::Nothing {
                    corner: square.corner,
                    side: square.side,
                    status,
                });
            }
            // The polynomial itself will determine the edge: so every end must be on its side of it.
            Agreement::Edge => {
                let lies_right = |(_, end): &(Place, End<N>)| {
                    end.coordinates == Coordinates::Plain
                        && goes_on(end)
                        && self.is_on_its_side(end)
                };
                if !samples.nodes.iter().all(lies_right) {
                    return Attempt::Divide(1);
                }
            }
        }
        let Some(coordinates) = self.common(&mut samples.nodes) else {
            return Attempt::Divide(1);
        };
        let periods = self.periods(coordinates);
        self.unify(&mut samples.nodes, periods);
        let mut polynomials = self.polynomials(&samples, coordinates, periods);
        if let Some(times) = self.divisions(polynomials.worst) {
            return Attempt::Divide(times);
        }
        if let Err(times) = self.check(square, &samples, &mut polynomials, pieces) {
            return Attempt::Divide(times);
        }
        let Polynomials {
            reference, powers, ..
        } = polynomials;
        Attempt::Covered(Piece::Patch(Box::new(Patch {
            corner: square.corner,
            side: square.side,
            extent: square.extent,
            coordinates,
            centre: from_fn(|k| reference.at[k] + powers[k][0][0]),
            coefficients: powers.map(|powers| {
                let mut rows = powers.map(|row| row.map(|c| c as f32));
                rows[0][0] = 0.0;
                rows
            }),
            error: polynomials.worst as f32,
            edge: samples.agreement == Agreement::Edge,
        })))
    }

    /// Returns (X, Y) of the n-th check point: among the square's outermost pixels, or between them.
    fn check_at(&self, square: &Square, n: usize) -> [f64; 2] {
        let outermost = square.extent.map(|n| 1.0 - 1.0 / f64::from(n));
        [0, 1].map(|k| self.fit.checks[n][k] * outermost[k])
    }

    /// Samples the corners, then the nodes; `None` as soon as the ends have too little in common.
    fn sample(&self, square: &Square, pieces: &mut Pieces<N>) -> Option<SquareSamples<N>> {
        let places: [Place; CORNERS] = from_fn(|n| self.place(square, self.check_at(square, n)));
        self.evaluate(&places, pieces);
        let corners = <[End<N>; CORNERS]>::try_from(pieces.seen.as_slice()).ok()?;
        let first = corners[0];
        let mut agreement = Agreement::Alike(first.status).with(&first, &corners)?;
        let nodes = self.fit.nodes;
        let node = |n: usize| self.place(square, [nodes[n % COUNT], nodes[n / COUNT]]);
        // In an order of distant nodes: a boundary between two statuses is soon found.
        let order = |n: usize| STRIDE * n % (COUNT * COUNT);
        let mut samples = vec![(PicturePoint::default(), first); COUNT * COUNT];
        for group in 0..COUNT {
            let indices: [usize; COUNT] = from_fn(|n| order(COUNT * group + n));
            let places = indices.map(node);
            self.evaluate(&places, pieces);
            agreement = agreement.with(&first, &pieces.seen)?;
            for ((index, place), end) in indices.into_iter().zip(places).zip(&pieces.seen) {
                samples[index] = (place, *end);
            }
        }
        Some(SquareSamples {
            agreement,
            corners,
            nodes: samples,
        })
    }

    /// Returns the polynomials through the nodes, with the expected error of the omitted degrees.
    fn polynomials(
        &self,
        samples: &SquareSamples<N>,
        coordinates: Coordinates,
        periods: [f64; N],
    ) -> Polynomials<N> {
        // Subtract the middle sample's value first, so that the remainder is small.
        let reference = samples.nodes[COUNT * COUNT / 2 + COUNT / 2].1;
        let mut powers = [[[0.0; COUNT]; COUNT]; N];
        let mut worst = 0.0_f64;
        for (k, powers) in powers.iter_mut().enumerate() {
            let length = reference.length(unit(k)) / self.pixel;
            let values: Grid =
                from_fn(|j| from_fn(|i| samples.nodes[COUNT * j + i].1.at[k] - reference.at[k]));
            let mut series = self.fit.series(&values);
            let [last, before] = highest(&series);
            let beyond = (BEYOND * last).max(BEYOND * BEYOND * before);
            worst = worst.max(length * beyond);
            truncate(&mut series, NEGLIGIBLE * self.tolerance / length);
            *powers = self.fit.powers(&series);
        }
        Polynomials {
            coordinates,
            periods,
            reference,
            powers,
            worst,
        }
    }

    /// Compares the polynomials with ends that were not used for them, the corners first, and raises their error.
    /// Returns the number of divisions as an error.
    fn check(
        &self,
        square: &Square,
        samples: &SquareSamples<N>,
        polynomials: &mut Polynomials<N>,
        pieces: &mut Pieces<N>,
    ) -> Result<(), u32> {
        for part in [0..CORNERS, CORNERS..CHECKS] {
            if part.start == 0 {
                pieces.seen.clear();
                pieces.seen.extend(samples.corners);
            } else {
                let places: Vec<Place> = part
                    .clone()
                    .map(|n| self.place(square, self.check_at(square, n)))
                    .collect();
                self.evaluate(&places, pieces);
            }
            for (n, end) in part.zip(&pieces.seen) {
                let error = self.discrepancy(end, polynomials, self.check_at(square, n));
                let like = match samples.agreement {
                    Agreement::Edge => goes_on(end) && self.is_on_its_side(end),
                    Agreement::Alike(_) => end.status == Status::Complete,
                };
                // NaN is not evidence either.
                if !like || error.is_nan() {
                    return Err(1);
                }
                polynomials.worst = polynomials.worst.max(WIDENING * error);
                if let Some(times) = self.divisions(polynomials.worst) {
                    return Err(times);
                }
            }
        }
        Ok(())
    }

    /// Returns whether an end is beyond the edges if it has left through one, and within them if not; within a small distance
    /// of an edge it may be on either side.
    fn is_on_its_side(&self, end: &End<N>) -> bool {
        let mut inside = f64::INFINITY;
        for axis in 0..N {
            let length = end.length(unit(axis)) / self.pixel;
            let [low, high] = self.bounds[axis];
            let room = (end.at[axis] - low).min(high - end.at[axis]);
            inside = inside.min(room * length);
        }
        if end.status == Status::Complete {
            inside > -BESIDE
        } else {
            inside < BESIDE
        }
    }

    /// Returns whether the surface may be between ends that have all left it: the known continuations are not all beyond one
    /// edge.
    fn may_straddle<'a>(&self, ends: impl Iterator<Item = &'a End<N>> + Clone) -> bool {
        let known = || ends.clone().filter(|end| goes_on(end));
        let is_beyond = |axis: usize| {
            let [low, high] = self.bounds[axis];
            known().all(|end| end.at[axis] < low) || known().all(|end| end.at[axis] > high)
        };
        let has_edges = self.bounds.iter().flatten().any(|it| it.is_finite());
        has_edges && !(0..N).any(is_beyond)
    }

    /// Returns the number of divisions of a square with this error, if it must be divided.
    fn divisions(&self, error: f64) -> Option<u32> {
        let twice = error > 2.0 * HALVED * self.tolerance;
        (error > self.tolerance || error.is_nan()).then_some(if twice { 2 } else { 1 })
    }

    /// Converts all samples to common coordinates, if there are such.
    fn common(&self, samples: &mut [(Place, End<N>)]) -> Option<Coordinates> {
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
        let about: Option<Vec<End<N>>> = samples
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

    fn periods(&self, coordinates: Coordinates) -> [f64; N] {
        match coordinates {
            Coordinates::Plain => self.ends.periods(),
            Coordinates::Apex { .. } => [0.0; N],
        }
    }

    /// Adds periods so that each sample is where the derivatives at it and at a neighbour predict it.
    fn unify(&self, samples: &mut [(Place, End<N>)], periods: [f64; N]) {
        if periods == [0.0; N] {
            return;
        }
        for n in 1..samples.len() {
            let before = if n % COUNT == 0 { n - COUNT } else { n - 1 };
            let (from, known) = samples[before];
            let (to, end) = &mut samples[n];
            let way = [0, 1].map(|k| to[k] - from[k]);
            let [a, b] = [(from, &known), (*to, &*end)].map(|(place, end)| {
                let [x, y] = end.by_place(place, self.zoom);
                from_fn::<f64, N, _>(|k| x[k] * way[0] + y[k] * way[1])
            });
            for k in 0..N {
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

    /// Returns the distance in pixels of the polynomials' value at (X, Y) from an end; NaN where they have no coordinates in
    /// common.
    fn discrepancy(&self, end: &End<N>, polynomials: &Polynomials<N>, at: [f64; 2]) -> f64 {
        let Some(end) = self.ends.in_coordinates(end, polynomials.coordinates) else {
            return f64::NAN;
        };
        let off: [f64; N] = from_fn(|k| {
            let (off, period) = (polynomials.value(k, at) - end.at[k], polynomials.periods[k]);
            if period > 0.0 {
                off - period * (off / period).round()
            } else {
                off
            }
        });
        if off == [0.0; N] {
            return 0.0;
        }
        end.length(off) / self.pixel
    }

    /// Evaluates the pixels of the smallest square one by one.
    fn single(&self, square: &Square, pieces: &mut Pieces<N>) -> Piece<N> {
        let place = |[column, row]: [u32; 2]| {
            let at = [(column, 0), (row, 1)]
                .map(|(n, k)| (2.0 * f64::from(n) + 1.0) / f64::from(square.extent[k]) - 1.0);
            self.place(square, at)
        };
        let pixels = (BLOCK * BLOCK) as usize;
        let index = |[column, row]: [u32; 2]| (row * BLOCK + column) as usize;
        let first = FIRST.map(|pixel| [0, 1].map(|k| pixel[k].min(square.extent[k] - 1)));
        self.evaluate(&first.map(place), pieces);
        if let Some(end) = pieces.seen.first() {
            let status = end.status;
            let is_alike = pieces.seen.iter().all(|end| end.status == status);
            if status != Status::Complete && is_alike && !self.may_straddle(pieces.seen.iter()) {
                return Piece::Nothing {
                    corner: square.corner,
                    side: square.side,
                    status,
                };
            }
        }
        let mut known = [false; (BLOCK * BLOCK) as usize];
        let mut single = Single {
            offset: vec![[0.0; N]; pixels],
            by_pixel: vec![[[0.0; N]; 2]; pixels],
            status: vec![Status::default(); pixels],
        };
        let mut put = |pixels: &[[u32; 2]], places: &[Place], ends: &[End<N>]| {
            for ((pixel, place), end) in pixels.iter().zip(places).zip(ends) {
                let index = index(*pixel);
                single.status[index] = end.status;
                if end.status == Status::Complete {
                    (single.offset[index], single.by_pixel[index]) = self.pixel(*end, *place);
                }
            }
        };
        put(&first, &first.map(place), &pieces.seen);
        for pixel in first {
            known[index(pixel)] = true;
        }
        let [columns, rows] = square.extent;
        let rest: Vec<[u32; 2]> = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| [column, row]))
            .filter(|pixel| !known[index(*pixel)])
            .collect();
        let places: Vec<Place> = rest.iter().copied().map(place).collect();
        self.evaluate(&places, pieces);
        put(&rest, &places, &pieces.seen);
        Piece::Single {
            corner: square.corner,
            single,
        }
    }

    /// Returns a complete end as an offset, with its derivatives by pixel.
    pub(super) fn pixel(&self, end: End<N>, place: Place) -> ([f32; N], [[f32; N]; 2]) {
        let plain = self.ends.in_coordinates(&end, Coordinates::Plain);
        let mut end = plain.unwrap_or(end);
        if end.stretch.is_nan() {
            end.stretch = 1.0;
        }
        let offset = from_fn(|k| (end.at[k] - self.origin[k]) as f32);
        let [x, y] = end
            .by_place(place, self.zoom)
            .map(|d| d.map(|c| (c * self.per_place) as f32));
        let by_pixel = [x, y.map(|c| -c)];
        let finite = |all: &[f32]| all.iter().all(|x| x.is_finite());
        (
            if finite(&offset) { offset } else { [0.0; N] },
            if finite(by_pixel.as_flattened()) {
                by_pixel
            } else {
                [[0.0; N]; 2]
            },
        )
    }
}
