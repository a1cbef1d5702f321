//! The parts of a picture that rays do not determine, and the work that may be spent on their pixels.
//!
//! In: sectors. Out: the radius within which pixels may be integrated one by one, and the evaluations for each. All
//! pixels have the same limits, in whatever order they are evaluated, so that a picture is the same on any number of
//! threads.

use super::Interpolation;
use super::cell::{self, Found};
use super::sectors::{BINS, Sectors};
use super::start::FanStart;
use crate::chart::ChartLayout;
use crate::ends::GeodesicWork;

/// The maximum number of evaluations for a pixel that is integrated on its own.
pub(super) const ONE_PIXEL: u64 = 20_000;
/// The cost of an evaluation for one pixel, in evaluations of rays, of which several are done at once.
const COST: u64 = 2;
/// The number of times that each pixel may be evaluated.
const LOOKS: f64 = 2.0;
/// The fractions of a sector's width at which it is sampled.
const SHARES: [f64; 2] = [0.25, 0.75];

/// The parts of a picture that rays do not determine.
#[derive(Debug)]
pub(super) struct UnknownAreas {
    /// For each range of radius, the area in squared units of arc length, and the arc length at its middle.
    ranges: Vec<[f64; 2]>,
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
        for sector in &sectors.sectors {
            let rays = sectors.rays(sector);
            for (n, [area, middle]) in ranges.iter_mut().enumerate() {
                let [from, to] = [n, n + 1].map(|k| (step * k as f64).min(sector.border));
                if to <= sector.free_until || from >= to {
                    continue;
                }
                let ring = |from: f64, to: f64| 0.5 * sector.width * (to * to - from * from);
                if from >= sector.unknown_from {
                    *area += ring(from, to);
                    continue;
                }
                // Beyond the known part, the whole area; before it, the fraction that the samples show.
                let known = to.min(sector.unknown_from);
                *area += ring(known, to);
                let s = middle.min(known);
                let is_unknown = |t: &&f64| {
                    let found =
                        cell::end_between(layout, interpolation, rays, sector.width, **t, s);
                    matches!(found, Found::Unknown)
                };
                let count = SHARES.iter().filter(is_unknown).count();
                *area += ring(from, known) * count as f64 / SHARES.len() as f64;
            }
        }
        Self { ranges }
    }

    /// Returns the radius within which pixels may be integrated one by one, and the evaluations for each, so that all
    /// together use at most `left`, in evaluations of rays.
    pub(super) fn affordable(
        &self,
        work: &GeodesicWork,
        start: &FanStart,
        left: u64,
    ) -> (f64, usize) {
        let left = (left / COST) as f64;
        // The number that the rays needed, and more.
        let each = (2 * work.evaluations / work.rays.max(1) + 100).min(ONE_PIXEL) as f64;
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
