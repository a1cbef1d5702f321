//! The choice of a fan's rays: bisection in angle, by the errors that a new ray shows of its neighbours.
//!
//! A new ray in the middle of a sector shows the interpolation error there. In the halves the error is a sixteenth of
//! that, so that they need not each be checked to be accepted.

use super::Interpolation;
use super::build::{ACROSS, Builder, Wanted};
use super::creases::AreaBetween;
use super::ray::Ray;
use super::sectors::{BINS, Profile, Sector, bin};
use super::{border, cell};

/// The error allowed to an edge's position, as a fraction of a pixel.
const EDGE: f64 = 0.25;
/// Sectors narrower than this, in pixels at the picture's border, are bisected only while there are a few of them.
const NARROWEST: f64 = 0.5;
const FEW: usize = 64;
/// Such sectors are bisected only while more pixels than this between two rays are not determined by them.
const LEFT_OUT: f64 = 2.0;
/// The factor by which a sector's error may exceed its prediction before a lower order is assumed for its halves.
const EXCESS: f32 = 2.0;
/// Sectors of which creases hide more pixels than this are bisected: a ray costs about as much as some of them.
const MOST_HIDDEN: f64 = 16.0;
/// An error in pixels that means no agreement at all.
const WRONG: f64 = 1e9;

impl Builder<'_> {
    /// Returns the factor on the errors when a sector is halved.
    pub(super) fn order(&self) -> f32 {
        match self.options.interpolation {
            Interpolation::Hermite => 16.0,
            Interpolation::Linear => 4.0,
        }
    }

    /// Returns the error at a fraction of the way between two rays, relative to the one in the middle.
    fn bulge(&self) -> fn(f64) -> f64 {
        match self.options.interpolation {
            Interpolation::Hermite => |t| 16.0 * (t * (1.0 - t)).powi(2),
            Interpolation::Linear => |t| 4.0 * t * (1.0 - t),
        }
    }

    pub(super) fn sector(
        &self,
        rays: [usize; 2],
        angle: f64,
        width: f64,
        errors: Profile,
        edge: f64,
    ) -> Sector {
        let border = self.start.border(angle + 0.5 * width, 0.5 * width);
        let between = AreaBetween {
            surface: self.surface,
            layout: self.layout,
            rays: rays.map(|ray| &self.rays[ray]),
            width,
            border,
            pixel: self.start.pixel,
        };
        Sector {
            rays,
            angle,
            width,
            border,
            hidden: between.hidden(&self.proofs),
            unknown_from: f64::INFINITY,
            free_until: 0.0,
            errors,
            seen: self.start.seen(angle, width, self.bulge()),
            edge: edge / self.start.pixel,
            proven: true,
            measured: false,
            doubted: false,
        }
    }

    /// Returns the errors that a ray shows of its two neighbours, in pixels; infinite where it shows nothing.
    pub(super) fn profile(&self, rays: [&Ray; 2], width: f64, middle: &Ray, t: f64) -> Profile {
        let (mut out, seen) = self.seen(rays, width, middle, t, &[0.5]);
        if seen < BINS {
            // Beyond an edge that both rays meet the error continues similarly; elsewhere it may be anything.
            let both = rays.iter().all(|ray| ray.limit().is_finite());
            let last = if both || seen > bin(self.border_of(middle, width), self.start.reach) {
                seen.checked_sub(1).map_or(0.0, |last| out[last])
            } else {
                f32::INFINITY
            };
            out[seen..].fill(last);
        }
        out
    }

    fn border_of(&self, middle: &Ray, width: f64) -> f64 {
        self.start.border(middle.angle, 0.5 * width)
    }

    /// Computes the errors that a ray shows at these fractions of its steps; returns the number of ranges covered.
    pub(super) fn seen(
        &self,
        rays: [&Ray; 2],
        width: f64,
        middle: &Ray,
        t: f64,
        shares: &[f64],
    ) -> (Profile, usize) {
        let mut out = [0.0_f32; BINS];
        let mut seen = 0;
        let border = self.border_of(middle, width);
        let limits = rays.map(Ray::limit);
        let last = if limits[0].is_finite() && limits[1].is_finite() {
            middle.limit().min(border)
        } else {
            // Beyond an edge through which only one of them has left, it still determines what the other sees.
            let [a, b] = rays.map(Ray::reach);
            a.min(b).min(middle.limit()).min(border)
        };
        let last = last.min(middle.end);
        let probes = middle.probes(shares).filter(|s| *s < last);
        for s in probes.chain([last]) {
            let interpolation = self.options.interpolation;
            let Some(error) =
                cell::discrepancy(self.layout, interpolation, rays, width, middle, t, s)
            else {
                continue;
            };
            // A NaN counts as the worst error.
            let error = if error.is_finite() {
                error / self.start.pixel
            } else {
                WRONG
            };
            let error = error.min(WRONG) as f32;
            let bin = bin(s, self.start.reach);
            // Including the ranges skipped in between.
            for range in &mut out[seen.min(bin)..=bin] {
                *range = range.max(error);
            }
            seen = seen.max(bin + 1);
        }
        (out, seen)
    }

    pub(super) fn pair(&self, sector: &Sector) -> [&Ray; 2] {
        sector.rays.map(|ray| &self.rays[ray])
    }

    fn is_fine(&self, sector: &Sector) -> bool {
        let border = sector.border;
        let inside = self.inside(sector);
        let worst = sector.most(inside);
        f64::from(worst) <= ACROSS * self.options.tolerance
            && sector.proven
            && (sector.edge <= EDGE
                || self.pair(sector)[0]
                    .limit()
                    .min(self.pair(sector)[1].limit())
                    >= border)
            && border::end_alike(self.pair(sector), border, self.start.pixel)
            && sector.hidden_area(0.0, border) <= MOST_HIDDEN * self.start.pixel * self.start.pixel
    }

    /// Returns the last range of radius that matters.
    pub(super) fn inside(&self, sector: &Sector) -> usize {
        let far = border::farthest(self.pair(sector), sector.width);
        let far = far.min(sector.hidden_from());
        bin(sector.border.min(far), self.start.reach)
    }

    /// Returns the largest error among the ranges that are known and matter.
    pub(super) fn worst(&self, sector: &Sector) -> f64 {
        f64::from(sector.most(self.last(sector)))
    }

    /// Returns the last range of radius that matters and is known.
    pub(super) fn last(&self, sector: &Sector) -> usize {
        let inside = self.inside(sector);
        if sector.unknown_from.is_infinite() {
            return inside;
        }
        inside.min(bin(sector.unknown_from, self.start.reach).saturating_sub(1))
    }

    /// Returns the visible part of the rays' own errors, of the worse ray, in pixels.
    pub(super) fn along(&self, sector: &Sector) -> Profile {
        let [a, b] = self.pair(sector);
        let [_, near_a, near_b] = &sector.seen;
        let factor = self.factor as f32;
        std::array::from_fn(|n| factor * (near_a[n] * a.off[n]).max(near_b[n] * b.off[n]))
    }

    /// Marks the range up to which a sector is known, when it cannot be improved.
    fn give_up(&self, sector: &mut Sector) {
        let inside = self.inside(sector);
        let wrong = (0..=inside)
            .find(|&n| f64::from(sector.seen_error(n)) > ACROSS * self.options.tolerance);
        if let Some(bin) = wrong {
            // An error that grows this fast may have appeared too early, in the previous range.
            let bin = bin.saturating_sub(1);
            sector.unknown_from = self.start.reach * bin as f64 / BINS as f64;
            sector.errors[bin..].fill(0.0);
        }
        let rays = self.pair(sector);
        let alike = border::end_alike(rays, sector.border, self.start.pixel);
        if !alike || sector.edge > EDGE {
            let limit = rays[0].limit().min(rays[1].limit());
            sector.unknown_from = sector.unknown_from.min(limit);
        }
    }

    /// Returns the number of pixels of a sector that would have to be integrated one by one.
    fn left_out(&self, sector: &Sector) -> f64 {
        let mut sector = sector.clone();
        self.give_up(&mut sector);
        let (from, to) = (sector.unknown_from, sector.border);
        0.5 * sector.width * (to * to - from * from).max(0.0)
            / (self.start.pixel * self.start.pixel)
    }

    /// Bisects until the errors of all sectors are small enough.
    pub(super) fn refine(&mut self, sectors: &mut Vec<Sector>) {
        loop {
            self.slopes(sectors);
            let (mut open, mut done): (Vec<Sector>, Vec<Sector>) = std::mem::take(sectors)
                .into_iter()
                .partition(|sector| sector.unknown_from.is_infinite() && !self.is_fine(sector));
            let narrowest = NARROWEST * self.start.pixel / self.start.reach;
            if open
                .iter()
                .filter(|sector| sector.width <= narrowest)
                .count()
                > FEW
            {
                // Chaos: narrower sectors would be no better, and as numerous as the pixels.
                let (wide, narrow) = open
                    .into_iter()
                    .partition(|sector| sector.width > narrowest);
                open = wide;
                done.extend::<Vec<Sector>>(narrow);
            } else {
                // A few directions in which nearby rays separate: bisect until hardly a pixel is left between two.
                let worth =
                    |sector: &Sector| sector.width > narrowest || self.left_out(sector) > LEFT_OUT;
                let (wide, narrow) = open.into_iter().partition(worth);
                open = wide;
                done.extend::<Vec<Sector>>(narrow);
            }
            if open.is_empty() {
                *sectors = done;
                break;
            }
            let bisected = self.bisect(open);
            let is_exhausted = bisected.is_err();
            done.extend(bisected.unwrap_or_else(|open| open));
            *sectors = done;
            if is_exhausted {
                break;
            }
        }
        for sector in sectors.iter_mut() {
            if sector.unknown_from.is_infinite() && !self.is_fine(sector) {
                self.give_up(sector);
            }
        }
    }

    /// Determines the derivative of the end's position by the angle from the neighbours, where rays do not end at an
    /// edge.
    fn slopes(&mut self, sectors: &mut [Sector]) {
        let open = |ray: &Ray| ray.stop.is_some_and(|stop| !stop.has_own_slope);
        if !self.rays.iter().any(open) {
            return;
        }
        sectors.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        for n in 0..sectors.len() {
            let (before, after) = (&sectors[n], &sectors[(n + 1) % sectors.len()]);
            let [first, here, last] = [before.rays[0], before.rays[1], after.rays[1]];
            let (Some(a), Some(b), Some(c)) = (
                self.rays[first].stop,
                self.rays[here].stop,
                self.rays[last].stop,
            ) else {
                continue;
            };
            if b.has_own_slope || a.status != b.status || b.status != c.status {
                continue;
            }
            let (h, k) = (before.width, after.width);
            let slope = ((b.s - a.s) / h * k + (c.s - b.s) / k * h) / (h + k);
            if let Some(stop) = &mut self.rays[here].stop {
                stop.slope = slope;
            }
        }
    }

    /// Returns the halves of all sectors, in order, with new rays between them.
    ///
    /// # Errors
    /// The sectors, if the evaluations do not suffice for all rays.
    pub(super) fn bisect(&mut self, sectors: Vec<Sector>) -> Result<Vec<Sector>, Vec<Sector>> {
        let wanted: Vec<Wanted> = sectors
            .iter()
            .map(|sector| Wanted::middle(sector).with_tolerance_share(self.tolerance_share(sector)))
            .collect();
        let Some(middles) = self.follow(&wanted) else {
            return Err(sectors);
        };
        let pairs = sectors.into_iter().zip(middles);
        Ok(pairs
            .flat_map(|(sector, middle)| self.halve(sector, middle))
            .collect())
    }

    /// Returns both halves of a sector, with a new ray between them.
    pub(super) fn halve(&mut self, sector: Sector, middle: Ray) -> [Sector; 2] {
        let order = self.order();
        let rays = self.pair(&sector);
        let found = self.profile(rays, sector.width, &middle, 0.5);
        // Where a sector is worse than the wider one predicted, the fourth-order estimate does not hold yet.
        let errors: Profile = std::array::from_fn(|n| {
            let excess = found[n] / sector.errors[n];
            let order = match excess > EXCESS && sector.errors[n] > 0.0 {
                true => (order / excess).max(1.0),
                false => order,
            };
            found[n] / order
        });
        let edge = border::exit_discrepancy(rays, sector.width, &middle) / f64::from(order);
        let half = 0.5 * sector.width;
        let new = self.rays.len();
        self.rays.push(middle);
        let [a, b] = sector.rays;
        let before = border::is_stretched(self.pair(&sector));
        let mut halves = [
            self.sector([a, new], sector.angle, half, errors, edge),
            self.sector([new, b], sector.angle + half, half, errors, edge),
        ];
        for half in &mut halves {
            half.proven = border::is_stretched(self.pair(half)) == before;
        }
        halves
    }
}
