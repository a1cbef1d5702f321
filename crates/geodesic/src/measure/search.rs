//! All geodesics from a point to a target, as guesses. In: a fan and a target. Out: angles and lengths.
//!
//! The disc of directions and lengths is divided into rings, from the centre outwards, and these into cells: as many as the
//! divergence of the rays requires. A cell whose image under the exponential map is too far from the target is dropped; any
//! other cell is halved until it is so small that Newton's method finds the solutions in it.

use std::cell::Cell;
use std::f64::consts::TAU;

use super::gap::AimedPlace;
use super::shoot::{self, NewtonBounds, PolarVector};
use super::source::{Arrival, RaySource};
use crate::ends::{Coordinates, Ends};
use crate::fan::{Fan, FanOptions};
use crate::metric::gaussian_curvature;
use crate::point::{PicturePoint, TangentVector, Uv};
use crate::status::Status;
use crate::surface::Surface;

/// The guesses.
#[derive(Clone, Debug, Default)]
pub(super) struct Guesses {
    /// In order of their lengths.
    pub(super) found: Vec<PolarVector>,
    /// The length up to which geodesics were searched.
    pub(super) within: f64,
    /// False if the search was incomplete, so that some may be missing.
    pub(super) complete: bool,
}

/// The side in pixels of the picture for which the fan is accurate.
const PICTURE: u32 = 512;
/// The maximum number of evaluations of a fan, and of the ends that it does not know.
const MOST_EVALUATIONS: u64 = 2_000_000;
/// The maximum number of sectors and cells that are examined.
const MOST_CELLS: usize = 200_000;
/// The initial number of sectors.
const SECTORS: u32 = 32;
/// Cells are halved until they are smaller than this fraction of the reach.
const FINE: f64 = 1.0 / 128.0;
/// Cells are halved until they are narrower than this angle.
const NARROW: f64 = TAU / 96.0;
/// The factor by which the image of a cell may be larger than its estimate.
const MARGIN: f64 = 1.4;
/// A cell whose image is larger than the radius of curvature by this factor is halved, wherever it seems to be.
const BENT: f64 = 1.0;
/// A sector that is wider than this fraction of the reach is halved.
const EDGE: f64 = 0.25;
/// A sector in which some rays have ended, or have crossed a crease, is halved if it is wider than this fraction of the reach.
const TORN: f64 = 1.0 / 64.0;
/// Sectors narrower than this angle are not halved: the fan has no rays between those of neighbouring pixels.
const LEAST_WIDTH: f64 = 2e-4;
/// In sectors narrower than this, the fan may have missed some rays.
const SURE_WIDTH: f64 = 4e-4;
/// The maximum number of rings that the disc is divided into.
const MOST_RINGS: f64 = 256.0;
/// Guesses whose angles and lengths (relative to the reach) differ by less than this are the same …
const SAME: f64 = 2e-3;
/// … where the tip of a cone may be between them, only if their angles differ by less than this.
const SAME_BESIDE_TIP: f64 = 1e-6;

/// A part of the disc of directions and lengths.
#[derive(Clone, Copy)]
struct DiscCell {
    angles: [f64; 2],
    lengths: [f64; 2],
}

/// The state of a cell's rays, before it is examined.
enum CellState {
    /// They have ended, or the target is out of their reach.
    Ended,
    /// They are too far apart for a few of them to represent all.
    Wide,
    /// They continue.
    Open {
        /// The largest curvature at their ends.
        curvature: f64,
        /// True if the few rays represent all.
        is_resolved: bool,
        /// True if some have ended.
        has_over: bool,
    },
}

/// Finds the geodesics from a point to a target up to the length `reach`, or the shortest of them.
pub(super) fn guesses(
    source: &RaySource<'_>,
    target: &AimedPlace<'_>,
    reach: f64,
    shortest: bool,
) -> Guesses {
    let frame = source.frame().filter(|_| reach > 0.0 && reach.is_finite());
    let Some(frame) = frame else {
        return Guesses::default();
    };
    let surface = source.surface;
    let options = FanOptions {
        max_evaluations: MOST_EVALUATIONS,
        follows_each: true,
        ..FanOptions::default()
    };
    let fan = Fan::build(surface, &frame.zoomed(reach), [PICTURE; 2], &options);
    let all_known = Cell::new(true);
    let mut sides = (0..4).map(|k| surface.apex(k / 2, k % 2));
    let search = TargetSearch {
        surface,
        target,
        reach,
        has_tip: sides.any(|apex| apex.is_some_and(|apex| !apex.smooth)),
        follow: &|at| end_of(surface, &fan, reach, at, &all_known),
    };
    let mut guesses = Guesses {
        found: Vec::new(),
        within: reach,
        complete: true,
    };
    // The next one is the last element.
    let mut sectors: Vec<[f64; 2]> = (0..SECTORS)
        .rev()
        .map(|n| [n, n + 1].map(|n| TAU * f64::from(n) / f64::from(SECTORS)))
        .collect();
    let longest = 0.25 * surface.scale().size.clamp(reach / 16.0, reach);
    let mut lengths = [0.0, longest];
    let mut looked_at = 0;
    let mut is_spent = || {
        looked_at += 1;
        looked_at > MOST_CELLS || fan.work().evaluations > 2 * MOST_EVALUATIONS
    };
    // The shortest are searched first.
    'rings: while lengths[0] < reach && !sectors.is_empty() {
        if shortest && guesses.found.iter().any(|it| it.length < lengths[0]) {
            guesses.within = lengths[0];
            break;
        }
        let mut next = Vec::new();
        let mut curvature = 0.0_f64;
        while let Some(angles) = sectors.pop() {
            if is_spent() {
                guesses.complete = false;
                break 'rings;
            }
            let mut cell = DiscCell { angles, lengths };
            match search.state(&cell) {
                CellState::Ended => continue,
                CellState::Wide => {
                    sectors.extend(halves(angles).into_iter().rev());
                    continue;
                }
                CellState::Open {
                    curvature: here,
                    is_resolved,
                    has_over,
                } => {
                    guesses.complete &= is_resolved;
                    curvature = curvature.max(here);
                    next.push(angles);
                    if has_over {
                        // Next to an edge few rays reach the end of a ring: a target near it may be missed beyond it.
                        cell.lengths[1] = (lengths[1] + FINE * reach).min(reach);
                    }
                }
            }
            let mut cells = vec![cell];
            while let Some(cell) = cells.pop() {
                search.search_cell(&cell, &mut cells, &mut guesses.found);
                if is_spent() {
                    guesses.complete = false;
                    break 'rings;
                }
            }
        }
        next.reverse();
        sectors = next;
        let step = (BENT / curvature.sqrt()).clamp(reach / MOST_RINGS, longest);
        lengths = [lengths[1], (lengths[1] + step).min(reach)];
    }
    guesses.complete &= all_known.get() && fan.work().evaluations < MOST_EVALUATIONS;
    guesses.found.sort_by(|a, b| a.length.total_cmp(&b.length));
    guesses
}

fn halves([a, b]: [f64; 2]) -> [[f64; 2]; 2] {
    let middle = 0.5 * (a + b);
    [[a, middle], [middle, b]]
}

/// A search for the rays that meet a target.
struct TargetSearch<'s> {
    surface: &'s dyn Surface,
    target: &'s AimedPlace<'s>,
    reach: f64,
    has_tip: bool,
    follow: &'s dyn Fn(PolarVector) -> Option<Arrival>,
}

impl TargetSearch<'_> {
    /// Returns a point of the disc other than its centre, where rays have no direction.
    fn place(&self, angle: f64, length: f64) -> PolarVector {
        PolarVector {
            angle,
            length: length.max(1e-9 * self.reach),
        }
    }

    /// Examines three rays of a cell that starts where the previous cells end.
    fn state(&self, cell: &DiscCell) -> CellState {
        let [a, b] = cell.angles;
        let [near, far] = cell.lengths;
        let at = |angle: f64, length: f64| (self.follow)(self.place(angle, length));
        let middle = 0.5 * (a + b);
        let begin = [at(a, near), at(middle, near), at(b, near)];
        let end = [at(a, far), at(middle, far), at(b, far)];
        if begin.iter().all(Option::is_none) {
            return CellState::Ended;
        }
        let all = || begin.iter().chain(&end).flatten();
        let width = b - a;
        let spread = width * all().fold(0.0, |most: f64, it| it.m.abs().max(most));
        let [greatest, curvature] = self.curvature(all());
        let has_over = all().count() < begin.len() + end.len();
        let is_torn = has_over || !self.are_in_one_piece(all());
        let is_resolved = spread * spread * curvature <= BENT * BENT && spread <= EDGE * self.reach;
        if width > LEAST_WIDTH && !(is_resolved && (!is_torn || spread <= TORN * self.reach)) {
            return CellState::Wide;
        }
        let left = self.reach - near + spread;
        let away = |it: &Arrival| self.target.distance_in_space(it).is_some_and(|d| d > left);
        if begin.iter().flatten().all(away) {
            return CellState::Ended;
        }
        CellState::Open {
            curvature: greatest,
            is_resolved: is_resolved && (has_over || width > SURE_WIDTH),
            has_over,
        }
    }

    /// Returns the largest magnitude of the curvature at some ends, and the curvature relative to which a cell must be small
    /// for its ends to determine its size: the same, or 0 where the curvature is nowhere positive, since rays diverge there.
    fn curvature<'a>(&self, ends: impl Iterator<Item = &'a Arrival>) -> [f64; 2] {
        let mut most = [0.0_f64; 2];
        for end in ends {
            let curvature = gaussian_curvature(&self.surface.jet(end.at));
            most = [most[0].max(curvature.abs()), most[1].max(curvature)];
        }
        [most[0], if most[1] > 0.0 { most[0] } else { 0.0 }]
    }

    /// Returns whether no crease separates some ends: the curvature beside a crease does not tell how it bends rays apart.
    fn are_in_one_piece<'a>(&self, ends: impl Iterator<Item = &'a Arrival>) -> bool {
        let mut pieces = ends.map(|end| self.surface.smooth_piece(end.at));
        let first = pieces.next();
        pieces.all(|piece| Some(piece) == first)
    }

    /// Drops a cell, halves it, or searches for its solutions.
    fn search_cell(
        &self,
        cell: &DiscCell,
        cells: &mut Vec<DiscCell>,
        found: &mut Vec<PolarVector>,
    ) {
        let Self {
            target,
            reach,
            follow,
            ..
        } = *self;
        let [a, b] = cell.angles;
        let [near, far] = cell.lengths;
        let (width, depth) = (b - a, far - near);
        let middle = PolarVector {
            angle: 0.5 * (a + b),
            length: 0.5 * (near + far),
        };
        let corners = [(a, near), (b, near), (a, far), (b, far)]
            .map(|(angle, length)| self.place(angle, length));
        let ends = corners.map(follow);
        let centre = follow(middle);
        let fields = ends.iter().chain([&centre]).flatten();
        let m = fields.fold(0.0, |most: f64, end| end.m.abs().max(most));
        let across = m * width;
        let small = depth <= FINE * reach && across <= FINE * reach && width <= NARROW;
        match &centre {
            // Rays that have ended earlier do not come back.
            None if ends[0].is_none() && ends[1].is_none() => {
                let between = follow(self.place(middle.angle, near));
                if small || between.is_none() {
                    return;
                }
            }
            None => {}
            Some(end) => {
                let radius = 0.5 * MARGIN * depth.hypot(across);
                if (small || self.is_resolved(&ends, end, [depth, across]))
                    && target.distance_at_least(end) > radius
                {
                    return;
                }
            }
        }
        if !small {
            let by_angle = width > NARROW && across > 0.5 * depth || depth <= FINE * reach;
            if by_angle {
                cells.extend(halves(cell.angles).map(|angles| DiscCell { angles, ..*cell }));
            } else {
                cells.extend(halves(cell.lengths).map(|lengths| DiscCell { lengths, ..*cell }));
            }
            return;
        }
        // Near a fold of the exponential map a cell may contain two solutions.
        let folded = ends.iter().flatten().any(|end| {
            let other = centre.as_ref().map_or(0.0, |centre| centre.m);
            (end.m < 0.0) != (other < 0.0) || end.m.abs() < 0.1 * far
        });
        let bounds = NewtonBounds {
            aim: 1e-4 * reach,
            tolerance: 2e-3 * reach,
            damping: 1e-3 * reach,
            stride: 2.0 * depth,
            iterations: 10,
        };
        // Of a cell crossed by an edge, only a corner may be inside.
        let every = folded || centre.is_none() || self.has_tip;
        let others = corners.into_iter().filter(|_| every);
        for start in [middle].into_iter().chain(others) {
            let Some(hit) = shoot::newton(target, start, &bounds, follow) else {
                continue;
            };
            let PolarVector { angle, length } = hit.at;
            let strays = (angle - middle.angle).abs() > 3.0 * width.max(NARROW)
                || (length - middle.length).abs() > 4.0 * depth;
            let same_angle = if self.has_tip { SAME_BESIDE_TIP } else { SAME };
            let same = |other: &PolarVector| {
                let turn = (angle - other.angle) / TAU;
                (turn - turn.round()).abs() * TAU < same_angle
                    && (length - other.length).abs() < SAME * reach
            };
            if !strays && length > 0.5 * FINE * reach.min(far) && !found.iter().any(same) {
                found.push(hit.at);
            }
        }
    }

    /// Returns whether the ends of a cell determine the size of its image: curvature has little effect within it.
    fn is_resolved(
        &self,
        corners: &[Option<Arrival>; 4],
        centre: &Arrival,
        size: [f64; 2],
    ) -> bool {
        let [_, curvature] = self.curvature(corners.iter().flatten().chain([centre]));
        size.iter()
            .all(|size| size * size * curvature <= BENT * BENT)
    }
}

/// Returns the end of a ray as the fan has it, in (u,v) inside the domain; `None` where it ended earlier. Records a ray that
/// might continue.
fn end_of(
    surface: &dyn Surface,
    fan: &Fan<'_>,
    reach: f64,
    at: PolarVector,
    all_known: &Cell<bool>,
) -> Option<Arrival> {
    let (sin, cos) = at.angle.sin_cos();
    let place = [cos, sin].map(|x| x * at.length / reach);
    let end = fan.end(PicturePoint(place));
    if matches!(end.status, Status::WorkLimit | Status::Degenerate) {
        all_known.set(false);
    }
    if end.status != Status::Complete {
        return None;
    }
    let end = fan.in_coordinates(&end, Coordinates::Plain)?;
    let mut uv = end.at;
    let signs = surface.sides().bring_back(surface.domain(), &mut uv).signs;
    let back = |v: [f64; 2]| TangentVector([signs[0] * v[0], signs[1] * v[1]]);
    let arrival = Arrival {
        at: Uv(uv),
        along: back(end.along),
        left: back(end.across),
        m: end.stretch * at.length,
        length: at.length,
        status: Status::Complete,
    };
    let sound = arrival.at.is_finite() && arrival.m.is_finite();
    sound.then_some(arrival)
}
