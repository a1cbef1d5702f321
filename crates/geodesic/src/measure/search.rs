//! All geodesics from a place to a target, as guesses: a fan and a target in, angles and lengths out.
//!
//! The disc of directions and lengths is cut into cells. A cell whose image under the exponential map lies too far from the
//! target is dropped; another is halved, until it is so small that Newton's method finds what it holds.

use std::f64::consts::TAU;

use super::gap::AimedPlace;
use super::shoot::{self, NewtonBounds, PolarVector};
use super::source::{Arrival, RaySource};
use crate::ends::{Coordinates, Ends};
use crate::fan::{Fan, FanOptions};
use crate::point::{PicturePoint, TangentVector, Uv};
use crate::status::Status;
use crate::surface::Surface;

/// The guesses.
#[derive(Clone, Debug, Default)]
pub(super) struct Guesses {
    /// By their length.
    pub(super) found: Vec<PolarVector>,
    /// False if work was left undone, so that some may be missing.
    pub(super) complete: bool,
}

/// The picture that the fan is exact for, in pixels each way.
const PICTURE: u32 = 512;
/// The most evaluations of a fan, and of the ends that it does not know.
const MOST_EVALUATIONS: u64 = 2_000_000;
/// The most cells that are looked at.
const MOST_CELLS: usize = 60_000;
/// The number of sectors to begin with.
const SECTORS: u32 = 32;
/// Cells are halved until they are smaller than the reach by this factor, …
const FINE: f64 = 1.0 / 128.0;
/// … and than this angle.
const NARROW: f64 = TAU / 96.0;
/// By how much the image of a cell may be larger than it seems.
const MARGIN: f64 = 1.4;
/// Guesses whose angles and lengths (of the reach) differ by less are one.
const SAME: f64 = 2e-3;

struct DiscCell {
    angles: [f64; 2],
    lengths: [f64; 2],
}

/// Finds the geodesics from a place to a target that are no longer than `reach`.
pub(super) fn guesses(source: &RaySource<'_>, target: &AimedPlace<'_>, reach: f64) -> Guesses {
    let Some(frame) = source.frame() else {
        return Guesses::default();
    };
    let surface = source.surface;
    let options = FanOptions {
        max_evaluations: MOST_EVALUATIONS,
        ..FanOptions::default()
    };
    let fan = Fan::build(surface, &frame.zoomed(reach), [PICTURE; 2], &options);
    let follow = |at: PolarVector| end_of(surface, &fan, reach, at);
    let mut cells = first_cells(surface, reach);
    let mut guesses = Guesses {
        found: Vec::new(),
        complete: true,
    };
    let mut looked_at = 0;
    while let Some(cell) = cells.pop() {
        looked_at += 1;
        if looked_at > MOST_CELLS || fan.work().evaluations > 2 * MOST_EVALUATIONS {
            guesses.complete = false;
            break;
        }
        look(
            &cell,
            target,
            reach,
            &follow,
            &mut cells,
            &mut guesses.found,
        );
    }
    guesses.complete &= fan.work().evaluations < MOST_EVALUATIONS;
    guesses.found.sort_by(|a, b| a.length.total_cmp(&b.length));
    guesses
}

fn first_cells(surface: &dyn Surface, reach: f64) -> Vec<DiscCell> {
    let rings = (4.0 * reach / surface.scale().size).ceil().clamp(4.0, 64.0) as u32;
    let share = |n: u32, of: u32| f64::from(n) / f64::from(of);
    let mut cells = Vec::new();
    // The shortest are looked at first, from the end of the list.
    for ring in (0..rings).rev() {
        for sector in 0..SECTORS {
            cells.push(DiscCell {
                angles: [sector, sector + 1].map(|n| TAU * share(n, SECTORS)),
                lengths: [ring, ring + 1].map(|n| reach * share(n, rings)),
            });
        }
    }
    cells
}

/// Drops a cell, halves it, or looks for what it holds.
fn look(
    cell: &DiscCell,
    target: &AimedPlace<'_>,
    reach: f64,
    follow: &dyn Fn(PolarVector) -> Option<Arrival>,
    cells: &mut Vec<DiscCell>,
    found: &mut Vec<PolarVector>,
) {
    let [a, b] = cell.angles;
    let [near, far] = cell.lengths;
    let (width, depth) = (b - a, far - near);
    let middle = PolarVector {
        angle: 0.5 * (a + b),
        length: 0.5 * (near + far),
    };
    let corners = [(a, near), (b, near), (a, far), (b, far)].map(|(angle, length)| PolarVector {
        angle,
        length: length.max(1e-9 * reach),
    });
    let ends = corners.map(follow);
    let centre = follow(middle);
    let fields = ends.iter().chain([&centre]).flatten();
    let m = fields.fold(0.0, |most: f64, end| end.m.abs().max(most));
    let across = m * width;
    let small = depth <= FINE * reach && across <= FINE * reach && width <= NARROW;
    match &centre {
        // Rays that have ended before do not come back.
        None if ends[0].is_none() && ends[1].is_none() => return,
        None if small => return,
        None => {}
        Some(end) => {
            let radius = 0.5 * MARGIN * depth.hypot(across);
            if target.distance_at_least(end) > radius {
                return;
            }
        }
    }
    if !small {
        let by_angle = width > NARROW && across > 0.5 * depth || depth <= FINE * reach;
        for half in 0..2 {
            let halves = |[from, to]: [f64; 2], middle: f64| {
                if half == 0 {
                    [middle, to]
                } else {
                    [from, middle]
                }
            };
            cells.push(if by_angle {
                DiscCell {
                    angles: halves(cell.angles, middle.angle),
                    ..*cell
                }
            } else {
                DiscCell {
                    lengths: halves(cell.lengths, middle.length),
                    ..*cell
                }
            });
        }
        return;
    }
    // Beside a fold of the exponential map a cell may hold two.
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
    let starts = [middle]
        .into_iter()
        .chain(corners.into_iter().filter(|_| folded));
    for start in starts {
        let Some(hit) = shoot::newton(target, start, &bounds, follow) else {
            continue;
        };
        let PolarVector { angle, length } = hit.at;
        let strays = (angle - middle.angle).abs() > 3.0 * width.max(NARROW)
            || (length - middle.length).abs() > 4.0 * depth;
        let same = |other: &PolarVector| {
            let turn = (angle - other.angle) / TAU;
            (turn - turn.round()).abs() * TAU < SAME && (length - other.length).abs() < SAME * reach
        };
        if !strays && length > 0.5 * FINE * reach.min(far) && !found.iter().any(same) {
            found.push(hit.at);
        }
    }
}

/// The end of a ray as the fan has it, in (u,v) inside the domain; `None` where it ended before.
fn end_of(surface: &dyn Surface, fan: &Fan<'_>, reach: f64, at: PolarVector) -> Option<Arrival> {
    let (sin, cos) = at.angle.sin_cos();
    let place = [cos, sin].map(|x| x * at.length / reach);
    let end = fan.end(PicturePoint(place));
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
