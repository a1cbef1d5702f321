//! The number of rays that a fan needs: bisection in angle, by what a new ray says about the two beside it.
//!
//! A new ray in the middle of a sector shows the error that interpolation makes there. In the halves it is a sixteenth
//! of that, so that they need not be looked at, each, to be accepted.

use super::Interpolation;
use super::build::{ACROSS, Builder, Wanted};
use super::ray::Ray;
use super::sectors::{BINS, Profile, Sector, bin};
use super::{border, cell};

/// An edge is to be at its place to this part of a pixel.
const EDGE: f64 = 0.25;
/// Sectors narrower than this, in pixels at the picture's border, are bisected only while there are a few of them.
const NARROWEST: f64 = 0.5;
const FEW: usize = 64;
/// Such sectors are bisected only while more pixels than this are left out between two rays.
const LEFT_OUT: f64 = 2.0;
/// The factor by which a sector's error may exceed the one that was expected of it before less is expected of its halves.
const EXCESS: f32 = 2.0;
/// An error in pixels that stands for no agreement at all.
const WRONG: f64 = 1e9;

impl Builder<'_> {
    /// The factor to the errors when a sector is halved.
    pub(super) fn order(&self) -> f32 {
        match self.options.interpolation {
            Interpolation::Hermite => 16.0,
            Interpolation::Linear => 4.0,
        }
    }

    /// The error at a share of the way between two rays, over the one in the middle.
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
        Sector {
            rays,
            angle,
            width,
            border: self.start.border(angle + 0.5 * width, 0.5 * width),
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

    /// The errors that a ray shows of the two beside it, in pixels; infinite where it shows nothing.
    pub(super) fn profile(&self, rays: [&Ray; 2], width: f64, middle: &Ray, t: f64) -> Profile {
        let (mut out, seen) = self.seen(rays, width, middle, t, &[0.5]);
        if seen < BINS {
            // At an edge that both rays meet it goes on much the same, elsewhere anything may be.
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

    /// The errors that a ray shows at these shares of its steps, and for how many ranges it does.
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
            // Beyond an edge that only one of them has left through, it still tells what the other sees.
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
            // What is not a number is as wrong as can be.
            let error = if error.is_finite() {
                error / self.start.pixel
            } else {
                WRONG
            };
            let error = error.min(WRONG) as f32;
            let bin = bin(s, self.start.reach);
            // With the ranges that were passed over in between.
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
    }

    /// The last range of radius that matters.
    pub(super) fn inside(&self, sector: &Sector) -> usize {
        let far = border::farthest(self.pair(sector), sector.width);
        bin(sector.border.min(far), self.start.reach)
    }

    /// The largest error as far as it is known and matters.
    pub(super) fn worst(&self, sector: &Sector) -> f64 {
        f64::from(sector.most(self.last(sector)))
    }

    /// The last range of radius that matters and is known.
    pub(super) fn last(&self, sector: &Sector) -> usize {
        let inside = self.inside(sector);
        if sector.unknown_from.is_infinite() {
            return inside;
        }
        inside.min(bin(sector.unknown_from, self.start.reach).saturating_sub(1))
    }

    /// The share that the picture shows of the rays' own errors, of the worse one of both, in pixels.
    pub(super) fn along(&self, sector: &Sector) -> Profile {
        let [a, b] = self.pair(sector);
        let [_, near_a, near_b] = &sector.seen;
        let factor = self.factor as f32;
        std::array::from_fn(|n| factor * (near_a[n] * a.off[n]).max(near_b[n] * b.off[n]))
    }

    /// Marks how far a sector is known that cannot be made better.
    fn give_up(&self, sector: &mut Sector) {
        let inside = self.inside(sector);
        let wrong = (0..=inside)
            .find(|&n| f64::from(sector.seen_error(n)) > ACROSS * self.options.tolerance);
        if let Some(bin) = wrong {
            // An error that grows so fast may have been seen too early in the range before.
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

    /// The number of pixels that of a sector would have to be followed by themselves.
    fn left_out(&self, sector: &Sector) -> f64 {
        let mut sector = sector.clone();
        self.give_up(&mut sector);
        let (from, to) = (sector.unknown_from, sector.border);
        0.5 * sector.width * (to * to - from * from).max(0.0)
            / (self.start.pixel * self.start.pixel)
    }

    /// Bisects until all sectors are fine.
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
                // Chaos: narrower sectors would be no better, and as many as there are pixels.
                let (wide, narrow) = open
                    .into_iter()
                    .partition(|sector| sector.width > narrowest);
                open = wide;
                done.extend::<Vec<Sector>>(narrow);
            } else {
                // A few directions in which nearby rays part: down to where hardly a pixel is left between two.
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
            let wanted: Vec<Wanted> = open
                .iter()
                .map(|sector| {
                    Wanted::middle(sector).with_tolerance_share(self.tolerance_share(sector))
                })
                .collect();
            let Some(middles) = self.follow(&wanted) else {
                done.extend(open);
                *sectors = done;
                break;
            };
            for (sector, middle) in open.into_iter().zip(middles) {
                let halves = self.halve(sector, middle);
                done.extend(halves);
            }
            *sectors = done;
        }
        for sector in sectors.iter_mut() {
            if sector.unknown_from.is_infinite() && !self.is_fine(sector) {
                self.give_up(sector);
            }
        }
    }

    /// Finds the change of the end's place with the angle from the neighbours, where rays end at no edge.
    fn slopes(&mut self, sectors: &mut [Sector]) {
        let open = |ray: &Ray| ray.stop.is_some_and(|stop| !stop.told);
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
            if b.told || a.status != b.status || b.status != c.status {
                continue;
            }
            let (h, k) = (before.width, after.width);
            let slope = ((b.s - a.s) / h * k + (c.s - b.s) / k * h) / (h + k);
            if let Some(stop) = &mut self.rays[here].stop {
                stop.slope = slope;
            }
        }
    }

    /// Both halves of a sector, with a new ray between them.
    pub(super) fn halve(&mut self, sector: Sector, middle: Ray) -> [Sector; 2] {
        let order = self.order();
        let rays = self.pair(&sector);
        let found = self.profile(rays, sector.width, &middle, 0.5);
        // Where a sector is worse than the wider one made expect, the fourth power of the width does not hold yet.
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
