//! The parts of a picture about which rays say nothing, and the work that may be spent on their pixels.
//!
//! Sectors in; the radius within which pixels may be followed one by one, and the evaluations for each, out. All pixels
//! have the same limits, in whatever order they are looked at, so that a picture is the same on any number of threads.

use super::Interpolation;
use super::cell::{self, Found};
use super::sectors::{BINS, Sectors};
use super::start::FanStart;
use crate::chart::ChartLayout;
use crate::ends::GeodesicWork;

/// The most evaluations for a pixel that is followed by itself.
const ONE_PIXEL: u64 = 20_000;
/// The time of an evaluation for one pixel, in evaluations of rays, of which several are done at once.
const COST: u64 = 2;
/// Each pixel may be looked at so many times.
const LOOKS: f64 = 2.0;
/// The shares of a sector's width in which it is looked at.
const SHARES: [f64; 2] = [0.25, 0.75];

/// The parts of a picture about which rays say nothing.
#[derive(Debug)]
pub(super) struct UnknownAreas {
    /// For each range of radius, the area in the units of arc length, squared, and the arc length at its middle.
    ranges: Vec<[f64; 2]>,
}

impl UnknownAreas {
    /// Looks through the sectors, which are in order.
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
                // Beyond where less is known than the rays say; before it, a share as the samples have it.
                let known = to.min(sector.unknown_from);
                *area += ring(known, to);
                let s = middle.min(known);
                let is_unknown = |t: &&f64| {
                    let found = cell::look(layout, interpolation, rays, sector.width, **t, s);
                    matches!(found, Found::Unknown)
                };
                let count = SHARES.iter().filter(is_unknown).count();
                *area += ring(from, known) * count as f64 / SHARES.len() as f64;
            }
        }
        Self { ranges }
    }

    /// The radius within which pixels may be followed by themselves, and the evaluations for each, so that all together
    /// have no more than `left`, in evaluations of rays.
    pub(super) fn affordable(
        &self,
        work: &GeodesicWork,
        start: &FanStart,
        left: u64,
    ) -> (f64, usize) {
        let left = (left / COST) as f64;
        // What the rays needed, and more.
        let each = (2 * work.evaluations / work.rays.max(1) + 100).min(ONE_PIXEL) as f64;
        let looks = |area: f64| LOOKS * area / (start.pixel * start.pixel);
        let limit = |pixels: f64| (left / pixels).clamp(each, ONE_PIXEL as f64) as usize;
        let step = start.reach / BINS as f64;
        let mut pixels = 0.0;
        for (n, [area, _]) in self.ranges.iter().enumerate() {
            let more = looks(*area);
            if (pixels + more) * each > left {
                // So much of this range, by its area.
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
