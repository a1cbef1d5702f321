//! The parts of a picture that rays do not determine, and the work that may be spent on their pixels.
//!
//! In: sectors. Out: the radius within which pixels may be integrated one by one, and the evaluations for each. All
//! pixels have the same limits, in whatever order they are evaluated, so that a picture is the same on any number of
//! threads.

use super::cell::{self, Found};
use super::sectors::{BINS, Sectors};
use super::start::FanStart;
use super::{FanOptions, Interpolation};
use crate::chart::{Atlas, ChartLayout};
use crate::surface::Surface;

/// The maximum number of evaluations for a pixel that is integrated on its own.
pub(super) const ONE_PIXEL: u64 = 20_000;
/// The cost of an evaluation for one pixel, in evaluations of rays, of which several are done at once.
const COST: u64 = 2;
/// The number of pixels whose evaluations are counted beforehand.
const MEASURED: usize = 16;
/// The number of times that each pixel may be evaluated.
const LOOKS: f64 = 2.0;
/// The fractions of a sector's width at which it is sampled.
const SHARES: [f64; 2] = [0.25, 0.75];

/// The parts of a picture that rays do not determine.
#[derive(Debug)]
pub(super) struct UnknownAreas {
    /// For each range of radius, the area in squared units of arc length, and the arc length at its middle.
    ranges: Vec<[f64; 2]>,
    /// The angle and the arc length of a point in each part of a sector that is unknown.
    points: Vec<[f64; 2]>,
}

impl UnknownAreas {
    /// Collects the unknown areas of sectors, which are in the order of their angles.
    pub(super) fn of(
        sectors: &Sectors,
        layout: &ChartLayout,
        interpolation: Interpolation,
        start: &FanStart,
    ) -> Self {
        let step = start.reach / BINS as f64;
        let mut ranges: Vec<[f64; 2]> = (0..BINS).map(|n| [0.0, step * (n as f64 + 0.5)]).collect();
        let mut points = Vec::new();
        for sector in &sectors.sectors {
            let angle = sector.angle + 0.5 * sector.width;
            let rays = sectors.rays(sector);
            for (n, [area, middle]) in ranges.iter_mut().enumerate() {
                let [from, to] = [n, n + 1].map(|k| (step * k as f64).min(sector.border));
                if to <= sector.free_until || from >= to {
                    continue;
                }
                let ring = |from: f64, to: f64| 0.5 * sector.width * (to * to - from * from);
                if from >= sector.unknown_from {
                    *area += ring(from, to);
                    points.push([angle, 0.5 * (from + to)]);
                    continue;
                }
                // Beyond the known part, the whole area; before it, what creases hide and the fraction that the samples show.
                let known = to.min(sector.unknown_from);
                let hidden = sector.hidden_area(from, known);
                *area += ring(known, to) + hidden;
                let s = middle.min(known);
                if hidden > 0.0 {
                    points.push([angle, s]);
                }
                if sector.hides(s) {
                    continue;
                }
                let is_unknown = |t: &&f64| {
                    let found =
                        cell::end_between(layout, interpolation, rays, sector.width, **t, s);
                    matches!(found, Found::Unknown)
                };
                let count = SHARES.iter().filter(is_unknown).count();
                *area += ring(from, known) * count as f64 / SHARES.len() as f64;
                if count > 0 {
                    points.push([angle, s]);
                }
            }
        }
        Self { ranges, points }
    }

    /// Returns the evaluations to reserve for a pixel, more than a few of them take on average, and those that these took.
    pub(super) fn evaluations_of_pixel(
        &self,
        surface: &dyn Surface,
        options: &FanOptions,
        start: &FanStart,
    ) -> [u64; 2] {
        let atlas = Atlas::new(surface);
        let step = self.points.len().div_ceil(MEASURED).max(1);
        let mut count = 0;
        for [angle, s] in self.points.iter().skip(step / 2).step_by(step) {
            let (sin, cos) = angle.sin_cos();
            let place = [cos, sin].map(|x| x * s / start.zoom).into();
            start.follow(&atlas, options, place, *s, ONE_PIXEL as usize);
            count += 1;
        }
        let taken = atlas.evaluations() as u64;
        let mean = taken / u64::max(count, 1);
        [(2 * mean + 100).min(ONE_PIXEL), taken]
    }

    /// Returns the radius within which pixels may be integrated one by one, and the evaluations for each, so that all
    /// together use at most `left`, in evaluations of rays. `each` are reserved for each pixel.
    pub(super) fn affordable(&self, each: u64, start: &FanStart, left: u64) -> (f64, usize) {
        let left = (left / COST) as f64;
        let each = each as f64;
        let looks = |area: f64| LOOKS * area / (start.pixel * start.pixel);
        let limit = |pixels: f64| (left / pixels).clamp(each, ONE_PIXEL as f64) as usize;
        let step = start.reach / BINS as f64;
        let mut pixels = 0.0;
        for (n, [area, _]) in self.ranges.iter().enumerate() {
            let more = looks(*area);
            if (pixels + more) * each > left {
                // The affordable fraction of this range, by area.
                let share = ((left / each - pixels) / more).clamp(0.0, 1.0);
                let [from, to] = [n, n + 1].map(|k| step * k as f64);
                let radius = (from * from + share * (to * to - from * from)).sqrt();
                return (radius, limit(left / each));
            }
            pixels += more;
        }
        (f64::INFINITY, limit(pixels))
    }
}
