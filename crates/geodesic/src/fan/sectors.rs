//! The sectors between neighbouring rays of a fan, with their known errors, looked up by angle.

use std::f64::consts::TAU;

use super::border;
use super::creases;
use super::ray::Ray;
use crate::ends::{Estimate, GeodesicWork};

/// The number of ranges of radius for which errors are known separately.
pub(super) const BINS: usize = 32;

/// Errors in pixels by ranges of radius.
pub(super) type Profile = [f32; BINS];

/// The sector between two neighbouring rays.
#[derive(Clone, Debug)]
pub(super) struct Sector {
    pub(super) rays: [usize; 2],
    pub(super) angle: f64,
    pub(super) width: f64,
    /// The largest distance to the picture's border in it.
    pub(super) border: f64,
    /// The arc length from which its rays do not determine where geodesics end.
    pub(super) unknown_from: f64,
    /// The ranges of arc length in which its rays do not determine them because of creases; the last one may be endless.
    pub(super) hidden: Vec<[f64; 2]>,
    /// The arc length up to which both rays continue and nothing else needs checking (see
    /// [`free_end_between`](super::cell::free_end_between)). Set when the fan is complete.
    pub(super) free_until: f64,
    pub(super) errors: Profile,
    /// The visible fractions of the errors in the sector's middle, of its first and of its second ray, for each range of
    /// radius: towards a corner of the picture only the part near one of the rays is visible.
    pub(super) seen: [Profile; 3],
    /// The error of the edge's position.
    pub(super) edge: f64,
    /// True if the errors are derived from a wider sector that interpolates in the same way.
    pub(super) proven: bool,
    /// True if a more accurate ray has measured the errors.
    pub(super) measured: bool,
    /// True if the errors have been raised because measured ones were larger.
    pub(super) doubted: bool,
}

impl Sector {
    /// Returns the visible error of a range of radius.
    pub(super) fn seen_error(&self, range: usize) -> f32 {
        self.errors[range] * self.seen[0][range]
    }

    /// Returns the largest visible error up to a range of radius.
    pub(super) fn most(&self, last: usize) -> f32 {
        (0..=last).fold(0.0, |most, n| self.seen_error(n).max(most))
    }

    /// Returns true if its rays do not determine where geodesics of this length end, because of a crease.
    #[inline(always)]
    pub(super) fn hides(&self, s: f64) -> bool {
        self.hidden.iter().any(|[from, to]| *from < s && s < *to)
    }

    /// Returns the arc length from which creases hide everything.
    pub(super) fn hidden_from(&self) -> f64 {
        let last = self.hidden.last().filter(|[_, to]| to.is_infinite());
        last.map_or(f64::INFINITY, |[from, _]| *from)
    }

    /// Returns the area between two arc lengths that creases hide.
    pub(super) fn hidden_area(&self, from: f64, to: f64) -> f64 {
        let ring = |range: &[f64; 2]| {
            let [from, to] = [range[0].max(from), range[1].min(to)];
            0.5 * self.width * (to * to - from * from).max(0.0) * f64::from(from < to)
        };
        self.hidden.iter().map(ring).sum()
    }

    /// The estimated error in pixels.
    #[inline(always)]
    pub(super) fn error_at(&self, s: f64, reach: f64) -> f64 {
        f64::from(self.errors[bin(s, reach)])
    }
}

/// A whole fan.
#[derive(Debug, Default)]
pub(super) struct Sectors {
    pub(super) rays: Vec<Ray>,
    /// In the order of their angles.
    pub(super) sectors: Vec<Sector>,
    /// The sector at the beginning of each of equal parts of the full turn.
    pub(super) table: Vec<u32>,
    pub(super) work: GeodesicWork,
    pub(super) estimate: Estimate,
    /// Pixels nearer to the centre than this may be integrated one by one where the rays do not determine their ends.
    pub(super) follow_within: f64,
    /// The maximum number of evaluations for such a pixel; the same again if its error proves too large.
    pub(super) pixel_limit: usize,
}

impl Sectors {
    /// Returns the sector that contains an angle in [0, 2π], and the fraction of the way from its first ray to its
    /// second.
    #[inline(always)]
    pub(super) fn find(&self, angle: f64) -> Option<(&Sector, f64)> {
        let part = angle * (self.table.len() as f64 / TAU);
        let last = self.table.len().checked_sub(1)?;
        let mut n = self.table[(part as usize).min(last)] as usize;
        while self
            .sectors
            .get(n + 1)
            .is_some_and(|next| next.angle <= angle)
        {
            n += 1;
        }
        let sector = self.sectors.get(n)?;
        Some((
            sector,
            ((angle - sector.angle) / sector.width).clamp(0.0, 1.0),
        ))
    }

    #[inline(always)]
    pub(super) fn rays(&self, sector: &Sector) -> [&Ray; 2] {
        let [a, b] = sector.rays;
        [&self.rays[a], &self.rays[b]]
    }

    pub(super) fn index(&mut self) {
        self.sectors.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        for sector in &mut self.sectors {
            let rays = sector.rays.map(|ray| &self.rays[ray]);
            let hidden = sector
                .hidden
                .first()
                .map_or(f64::INFINITY, |range| range[0]);
            sector.free_until = border::free_until(rays)
                .min(sector.unknown_from)
                .min(creases::first_of(rays))
                .min(hidden);
        }
        let parts = (4 * self.sectors.len()).next_power_of_two();
        let mut n = 0;
        self.table = (0..parts)
            .map(|part| {
                let angle = TAU * part as f64 / parts as f64;
                while self
                    .sectors
                    .get(n + 1)
                    .is_some_and(|next| next.angle <= angle)
                {
                    n += 1;
                }
                n as u32
            })
            .collect();
    }
}

/// Returns the range of an arc length, of those that `reach` is divided into.
pub(super) fn bin(s: f64, reach: f64) -> usize {
    ((s / reach * BINS as f64) as usize).min(BINS - 1)
}

/// Returns the largest error.
pub(super) fn most(errors: &[f32]) -> f32 {
    errors.iter().fold(0.0_f32, |most, x| most.max(*x))
}
