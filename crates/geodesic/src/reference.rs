//! The true errors of a picture's ends: a sample of its pixels is traced again with much higher accuracy.
//!
//! In: a surface, a frame, a picture's size; then any method's result for a pixel. Out: [`Errors`], in pixels. The
//! sample is one pixel of each cell of a lattice, the same on every machine. From its worst pixels the errors are
//! followed uphill, from pixel to pixel, so that the maximum is one of the picture and not only of the sample.

use std::collections::HashMap;
use std::fmt;

use crate::chart::Atlas;
use crate::frame::Frame;
use crate::pixels::pixel_place;
use crate::point::{PicturePoint, Uv};
use crate::status::Status;
use crate::surface::{Jet, Side, Surface};
use crate::topology::Apex;
use crate::trace::Options;
use crate::vector::{combine, norm};

/// Within this fraction of the domain's width from a pole, points are also compared in polar coordinates.
const NEAR_POLE: f64 = 0.1;
/// The largest error of a reference ray, in pixels; where its own estimate is larger, the truth is unknown.
const KNOWN: f64 = 0.01;
/// The number of a sample's worst pixels from which the errors are followed uphill.
const CLIMBS: usize = 12;
/// The maximum number of moves uphill.
const MOVES: usize = 40;
/// The maximum number of pixels that are checked again because they ended differently, or far away.
const SECOND_LOOKS: usize = 600;
/// Errors above this, in pixels, may be caused by a cut: the region behind a cone's tip is torn apart.
const FAR: f64 = 1.0;
/// There is a cut between two points a quarter of a pixel apart whose ends are this many pixels apart.
const TORN: f64 = 8.0;

/// The true end of a pixel's geodesic.
#[derive(Clone, Copy, Debug)]
struct Truth {
    uv: Uv,
    jet: Jet,
    status: Status,
    /// The estimated error of the truth itself, in pixels.
    error: f64,
}

/// The true ends of a sample of a picture's pixels.
pub struct Reference<'s> {
    surface: &'s dyn Surface,
    frame: Frame,
    size: [u32; 2],
    zoom: f64,
    sample: Vec<u32>,
    /// Additional pixels, outside the sample, from which the errors are followed uphill.
    suspects: Vec<u32>,
    known: HashMap<u32, Truth>,
    /// True if points are compared in space.
    embedded: bool,
}

/// The distances of a picture's ends from the true ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Errors {
    /// The errors of the sample's pixels that have an end, in pixels, in ascending order.
    pub sample: Vec<f64>,
    /// The largest error in pixels: of the sample, or uphill from its worst pixels.
    pub max: f64,
    /// The number of the sample's pixels whose status differs from the true one.
    pub unlike: usize,
    /// The number of the sample's pixels within a pixel of a border, or next to a cut, that show its other side.
    pub beside: usize,
    /// The number of the sample's pixels whose truth is unknown, because of chaos or for lack of evaluations.
    pub unknown: usize,
    /// The number of the sample's pixels.
    pub pixels: usize,
}

impl Errors {
    /// Returns the error that a fraction of the sample's pixels does not exceed; 0 for an empty sample.
    pub fn quantile(&self, share: f64) -> f64 {
        let last = self.sample.len().saturating_sub(1);
        let index = (share * last as f64).ceil() as usize;
        self.sample.get(index.min(last)).copied().unwrap_or(0.0)
    }

    /// Returns the number of the sample's pixels whose error exceeds this, or whose status is wrong.
    pub fn wrong(&self, pixels: f64) -> usize {
        self.unlike + self.sample.len() - self.sample.partition_point(|e| *e <= pixels)
    }
}

impl fmt::Display for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "max {:.3} px, 99 % {:.3} px, of {} pixels {} unlike, {} beside, {} unknown",
            self.max,
            self.quantile(0.99),
            self.pixels,
            self.unlike,
            self.beside,
            self.unknown
        )
    }
}

impl<'s> Reference<'s> {
    /// Traces about `pixels` pixels of a picture.
    pub fn new(surface: &'s dyn Surface, frame: &Frame, size: [u32; 2], pixels: usize) -> Self {
        let mut reference = Self {
            surface,
            frame: *frame,
            size,
            zoom: frame.zoom(surface),
            sample: lattice(size, pixels),
            suspects: Vec::new(),
            known: HashMap::new(),
            embedded: surface.is_embedded(),
        };
        for index in reference.sample.clone() {
            reference.truth(index);
        }
        reference
    }

    /// Also follows the errors uphill from these pixels, given by index: for spots where a method may be wrong and that
    /// the sample misses. They count for [`Errors::max`] alone.
    pub fn suspect(&mut self, pixels: impl IntoIterator<Item = u32>) {
        let count = u64::from(self.size[0]) * u64::from(self.size[1]);
        let known = pixels.into_iter().filter(|index| u64::from(*index) < count);
        self.suspects.extend(known);
    }

    /// Returns a pixel's width on the surface.
    pub fn pixel(&self) -> f64 {
        2.0 * self.zoom / f64::from(self.size[0].min(self.size[1]).max(1))
    }

    /// Compares a method's results with the truth. `end` returns the end of a pixel, by its index row by row from the
    /// top, anywhere beyond sides that wrap, and its status.
    pub fn errors<P: Into<Uv>>(&mut self, end: &dyn Fn(usize) -> (P, Status)) -> Errors {
        let end = &|index: usize| {
            let (at, status) = end(index);
            (at.into(), status)
        };
        let atlas = Atlas::new(self.surface);
        let mut errors = Errors {
            pixels: self.sample.len(),
            ..Errors::default()
        };
        let mut looks = SECOND_LOOKS;
        let mut worst: Vec<(f64, u32)> = Vec::new();
        for index in self.sample.clone() {
            match self.verdict(&atlas, index, end(index as usize), &mut looks) {
                Verdict::Error(error) => {
                    errors.sample.push(error);
                    worst.push((error, index));
                }
                Verdict::Unlike => errors.unlike += 1,
                Verdict::Beside => errors.beside += 1,
                Verdict::Unknown => errors.unknown += 1,
            }
        }
        errors.sample.sort_unstable_by(f64::total_cmp);
        worst.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        errors.max = worst.first().map_or(0.0, |(error, _)| *error);
        worst.truncate(CLIMBS);
        for index in self.suspects.clone() {
            let verdict = self.verdict(&atlas, index, end(index as usize), &mut looks);
            if let Verdict::Error(error) = verdict {
                errors.max = errors.max.max(error);
                worst.push((error, index));
            }
        }
        for start in worst {
            let (error, _) = self.climb(&atlas, start, end, &mut looks);
            errors.max = errors.max.max(error);
        }
        errors
    }

    /// Moves from a pixel to its worst neighbour, as long as that is worse.
    fn climb(
        &mut self,
        atlas: &Atlas<'_>,
        start: (f64, u32),
        end: &dyn Fn(usize) -> (Uv, Status),
        looks: &mut usize,
    ) -> (f64, u32) {
        let mut best = start;
        for _ in 0..MOVES {
            let from = best;
            for index in neighbours(self.size, from.1) {
                let verdict = self.verdict(atlas, index, end(index as usize), looks);
                if let Verdict::Error(error) = verdict
                    && error > best.0
                {
                    best = (error, index);
                }
            }
            if best == from {
                break;
            }
        }
        best
    }

    fn verdict(
        &mut self,
        atlas: &Atlas<'_>,
        index: u32,
        (uv, status): (Uv, Status),
        looks: &mut usize,
    ) -> Verdict {
        let truth = self.truth(index);
        if truth.status == Status::WorkLimit || truth.error.is_nan() || truth.error > KNOWN {
            return Verdict::Unknown;
        }
        let place = pixel_place(self.size, index % self.size[0], index / self.size[0]);
        if status != truth.status {
            if *looks > 0 {
                *looks -= 1;
                if self.around(place, 1.0).any(|other| other.status == status) {
                    return Verdict::Beside;
                }
            }
            return Verdict::Unlike;
        }
        if status != Status::Complete {
            return Verdict::Error(0.0);
        }
        let error = self.distance(atlas, &truth, uv) / self.pixel();
        if error.is_nan() {
            return Verdict::Unlike;
        }
        if error > FAR && *looks > 0 {
            *looks -= 1;
            let pixel = self.pixel();
            let torn = self.around(place, 0.25).any(|other| {
                other.status == Status::Complete
                    && self.distance(atlas, &other, uv) < FAR * pixel
                    && self.distance(atlas, &truth, other.uv) > TORN * pixel
            });
            if torn {
                return Verdict::Beside;
            }
        }
        Verdict::Error(error)
    }

    /// Returns the truth at the eight points around one, `pixels` away.
    fn around(&self, place: PicturePoint, pixels: f64) -> impl Iterator<Item = Truth> {
        let off = pixels * 2.0 / f64::from(self.size[0].min(self.size[1]).max(1));
        (0..8).map(move |n| {
            let (sin, cos) = (f64::from(n) * std::f64::consts::FRAC_PI_4).sin_cos();
            self.trace(PicturePoint([place[0] + off * cos, place[1] + off * sin]))
        })
    }

    fn truth(&mut self, index: u32) -> Truth {
        if let Some(truth) = self.known.get(&index) {
            return *truth;
        }
        let truth = self.trace(pixel_place(
            self.size,
            index % self.size[0],
            index / self.size[0],
        ));
        self.known.insert(index, truth);
        truth
    }

    fn trace(&self, place: PicturePoint) -> Truth {
        let length = self.zoom * place[0].hypot(place[1]);
        let pixel = self.pixel();
        let still = |uv: Uv, status| Truth {
            uv,
            jet: self.surface.jet(uv),
            status,
            error: 0.0,
        };
        if length == 0.0 {
            return still(self.frame.uv, Status::Complete);
        }
        let options = Options {
            tolerance: (1e-5 * pixel / length).clamp(1e-13, 1e-9),
            max_evaluations: 200_000,
            ..Options::default()
        };
        match self.frame.trace(self.surface, place, length, &options) {
            Ok(end) => Truth {
                uv: end.uv,
                jet: self.surface.jet(end.uv),
                status: end.status,
                error: end.error_estimate / pixel,
            },
            Err(_) => still(self.frame.uv, Status::Undefined),
        }
    }

    /// Returns the distance on the surface from a true end to another point, exact where they are close.
    fn distance(&self, atlas: &Atlas<'_>, truth: &Truth, uv: Uv) -> f64 {
        let Uv(mut other) = uv;
        atlas.layout.bring_back(&mut other);
        if self.embedded {
            let position = self.surface.jet(Uv(other)).position;
            return norm(combine(1.0, truth.jet.position, -1.0, position));
        }
        let mut least = f64::INFINITY;
        for turns in repetitions(atlas, other) {
            let difference = [0, 1].map(|k| turns[k] - truth.uv[k]);
            let length = norm(combine(
                difference[0],
                truth.jet.du,
                difference[1],
                truth.jet.dv,
            ));
            least = least.min(length);
        }
        for axis in 0..2 {
            for end in 0..2 {
                if let Some(apex) = atlas.layout.apexes[axis][end]
                    && apex.smooth
                {
                    let base = atlas.layout.domain[axis][end];
                    let near = |uv: [f64; 2]| {
                        (uv[axis] - base).abs() < NEAR_POLE * atlas.layout.width(axis)
                    };
                    if !near(other) || !near(truth.uv.0) {
                        continue;
                    }
                    least = least.min(about_pole(&apex, axis, base, truth, other));
                }
            }
        }
        least
    }
}

/// The result of one pixel's comparison.
enum Verdict {
    Error(f64),
    Unlike,
    Beside,
    Unknown,
}

/// Returns one pixel of each cell of a lattice with about `pixels` cells.
fn lattice(size: [u32; 2], pixels: usize) -> Vec<u32> {
    let [width, height] = size;
    let area = f64::from(width) * f64::from(height);
    let side = ((area / pixels.max(1) as f64).sqrt().floor() as u32).max(1);
    let mut sample = Vec::new();
    let mut state = 0_u64;
    let mut below = |limit: u32| {
        // SplitMix64: the same numbers on every machine.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % u64::from(limit.max(1))) as u32
    };
    for top in (0..height).step_by(side as usize) {
        for left in (0..width).step_by(side as usize) {
            let column = left + below(side.min(width - left));
            let row = top + below(side.min(height - top));
            sample.push(row * width + column);
        }
    }
    sample
}

fn neighbours([width, height]: [u32; 2], index: u32) -> impl Iterator<Item = u32> {
    let (column, row) = (i64::from(index % width), i64::from(index / width));
    let around = (-1..=1).flat_map(move |dy| (-1..=1).map(move |dx| (column + dx, row + dy)));
    around
        .filter(move |&(x, y)| {
            (0..i64::from(width)).contains(&x)
                && (0..i64::from(height)).contains(&y)
                && (x, y) != (column, row)
        })
        .map(move |(x, y)| y as u32 * width + x as u32)
}

/// Returns a point of the domain and its nearest copies beyond the sides that wrap.
fn repetitions(atlas: &Atlas<'_>, uv: [f64; 2]) -> Vec<[f64; 2]> {
    let mut all = vec![uv];
    for axis in 0..2 {
        let side = atlas.layout.sides.of(axis)[0];
        if !matches!(side, Side::Wrap | Side::WrapFlip) {
            continue;
        }
        for at in all.clone() {
            for turn in [-1.0, 1.0] {
                let mut other = at;
                other[axis] += turn * atlas.layout.width(axis);
                if side == Side::WrapFlip {
                    let [low, high] = atlas.layout.domain[1 - axis];
                    other[1 - axis] = low + high - other[1 - axis];
                }
                all.push(other);
            }
        }
    }
    all
}

/// Returns the distance across a pole, by the law of cosines about it: exact near the pole.
fn about_pole(apex: &Apex, axis: usize, base: f64, truth: &Truth, uv: [f64; 2]) -> f64 {
    let [r, s] = [truth.uv.0, uv].map(|at| (at[axis] - base).abs().powf(1.0 / apex.power));
    let angle = apex.rate * (uv[1 - axis] - truth.uv[1 - axis]);
    let half = (0.5 * angle).sin();
    let chord = ((r - s) * (r - s) + 4.0 * r * s * half * half).sqrt();
    let along = norm(if axis == 0 {
        truth.jet.du
    } else {
        truth.jet.dv
    });
    // |σ_r|: the radial parameter is r^power.
    chord * along * apex.power * r.powf(apex.power - 1.0)
}
