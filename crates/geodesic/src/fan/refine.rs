//! How many rays a fan needs: bisection in angle, by what a new ray says about the two beside it.
//!
//! A new ray in the middle of a sector shows the error that interpolation makes there. In the halves it is a sixteenth
//! of that, so that they need not be looked at, each, to be accepted.

use std::f64::consts::TAU;

use super::cell;
use super::coordinates::Space;
use super::march::{self, Plan};
use super::ray::Ray;
use super::runner::Runner;
use super::sectors::{self, BINS, Profile, Sector, Sectors, bin, most};
use super::start::Start;
use super::{Across, FanOptions};
use crate::ends::Work;
use crate::surface::Surface;

/// Rays to begin with.
const BASE: usize = 16;
/// The share of the tolerance that interpolation between rays may use, …
pub(super) const ACROSS: f64 = 0.7;
/// … and the one that the rays' own errors may.
const ALONG: f64 = 0.3;
/// An edge is to be at its place to this part of a pixel.
const EDGE: f64 = 0.25;
/// Sectors narrower than this, in pixels at the picture's border, are bisected only while there are a few of them, …
const NARROWEST: f64 = 0.5;
const FEW: usize = 64;
/// … and while more pixels than this are left out between two rays.
const LEFT_OUT: f64 = 2.0;
/// How much more exactly the first rays are integrated once more, to see how exact they are.
const EXACT: f64 = 0.04;
/// By how much more the others may err where the first ones are found too exact. More would leave knots so far apart
/// that what lies between them has kinks that cost more squares of a picture than it saves steps.
const LOOSEST: f64 = 4.0;
/// The least share of the usual error that a ray is allowed: where even that grows too large, rays are of no use.
const MOST_CARE: f64 = 2e-2;
/// The most evaluations for one ray, and the least that one is begun with.
const ONE_RAY: u64 = 20_000;
const LEAST: u64 = 50;

/// An error in pixels that stands for no agreement at all.
const WRONG: f64 = 1e9;

/// A ray to be integrated: as long as the picture is within a distance in angle of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    angle: f64,
    around: f64,
    /// The share of the usual error that it is allowed.
    care: f64,
}

impl Wanted {
    fn new(angle: f64, around: f64) -> Self {
        Self {
            angle,
            around,
            care: 1.0,
        }
    }

    /// The ray in the middle of a sector.
    pub(super) fn middle(sector: &Sector) -> Self {
        let half = 0.5 * sector.width;
        Self::new(sector.angle + half, half)
    }
}

pub(super) struct Builder<'a, S: Surface + ?Sized> {
    pub(super) surface: &'a S,
    pub(super) space: &'a Space,
    pub(super) start: &'a Start,
    pub(super) options: &'a FanOptions,
    pub(super) plan: Plan,
    pub(super) rays: Vec<Ray>,
    pub(super) work: Work,
    pub(super) exhausted: bool,
    /// The rays' own errors.
    pub(super) along: Profile,
    /// Pixels by which a ray is off for each unit of its estimated error.
    pub(super) factor: f64,
}

/// Makes a fan.
pub(super) fn build<S: Surface + ?Sized>(
    surface: &S,
    space: &Space,
    start: &Start,
    options: &FanOptions,
) -> Sectors {
    let tolerance = options.tolerance.clamp(1e-6, 100.0);
    let options = FanOptions {
        tolerance,
        ..*options
    };
    let size = space.scale.size;
    let allowed = ALONG * tolerance * start.pixel;
    let mut builder = Builder {
        surface,
        space,
        start,
        options: &options,
        plan: Plan {
            rate: allowed / start.reach,
            least: 0.01 * start.reach,
            lever: 0.5 * size.min(start.reach),
            field: 0.05,
            shortest: (1e-2 * start.pixel).min(1e-4 * size),
            first: start.reach.min(size) * 0.03,
            limit: ONE_RAY,
        },
        rays: Vec::new(),
        work: Work::default(),
        exhausted: false,
        along: [0.0; BINS],
        factor: 0.0,
    };
    let mut sectors = builder.base();
    builder.refine(&mut sectors);
    let estimate = builder.verify(&mut sectors);
    let mut all = Sectors {
        rays: builder.rays,
        sectors,
        table: Vec::new(),
        work: builder.work,
        estimate,
        follow_within: 0.0,
    };
    if !builder.exhausted {
        let left = options.max_evaluations.saturating_sub(all.work.evaluations);
        all.follow_within = sectors::affordable(&all, start, left);
    }
    all.work.rays = all.rays.len() as u64;
    all.index();
    all
}

impl<S: Surface + ?Sized> Builder<'_, S> {
    /// How much smaller the errors of a halved sector are.
    fn order(&self) -> f32 {
        match self.options.across {
            Across::Hermite => 16.0,
            Across::Linear => 4.0,
        }
    }

    /// Integrates rays. `None` where
    /// the evaluations do not suffice for all.
    pub(super) fn integrate(&mut self, plan: &Plan, wanted: &[Wanted]) -> Option<Vec<Ray>> {
        let left = self
            .options
            .max_evaluations
            .saturating_sub(self.work.evaluations);
        // What each may take for sure; no more than a few do more than twice the average.
        let each = left / wanted.len().max(1) as u64;
        let average = self.work.evaluations / self.work.rays.max(1);
        if each < (2 * average).max(LEAST) {
            self.exhausted = true;
            return None;
        }
        let plan = &Plan {
            limit: plan.limit.min(each),
            ..*plan
        };
        let runners = wanted
            .iter()
            .enumerate()
            .map(|(id, wanted)| {
                let mut runner = self.start.runner(wanted.angle, wanted.around, plan.first);
                runner.id = id;
                runner.care = wanted.care;
                runner
            })
            .collect();
        let done = march::march_all(self.surface, self.space, plan, runners);
        for runner in &done {
            // Less than what a ray may take had there been no other.
            self.exhausted |= plan.limit < ONE_RAY && runner.evaluations + LEAST > plan.limit;
            self.work.rays += 1;
            self.work.steps += runner.steps;
            self.work.rejected += runner.rejected;
            self.work.evaluations += runner.evaluations;
        }
        Some(done.into_iter().map(Runner::finish).collect())
    }

    /// Rays that take part. Where one's own error grows on the way more than that of the others, it is integrated once
    /// more, so much more exactly.
    fn follow(&mut self, wanted: &[Wanted]) -> Option<Vec<Ray>> {
        let plan = self.plan;
        let mut rays = self.integrate(&plan, wanted)?;
        self.improve(&mut rays, wanted);
        Some(rays)
    }

    /// The share of the usual error for the ray in the middle of a sector: what those beside it would have needed.
    fn care(&self, sector: &Sector) -> f64 {
        let [a, b] = self.pair(sector).map(|ray| ray.error / ray.care);
        self.care_for(self.factor * (a * b).sqrt())
    }

    /// The share of the usual error for a ray that would be off by so many pixels.
    fn care_for(&self, off: f64) -> f64 {
        let allowed = ALONG * self.options.tolerance;
        if off > 1.5 * allowed {
            (0.5 * allowed / off).max(MOST_CARE)
        } else {
            1.0
        }
    }

    fn improve(&mut self, rays: &mut [Ray], wanted: &[Wanted]) {
        let allowed = ALONG * self.options.tolerance;
        let poor: Vec<usize> = (0..rays.len())
            .filter(|&n| self.factor * rays[n].error > 1.5 * allowed)
            .collect();
        if poor.is_empty() {
            return;
        }
        let again: Vec<Wanted> = poor
            .iter()
            .map(|&n| Wanted {
                care: self.care_for(self.factor * rays[n].error / wanted[n].care),
                ..wanted[n]
            })
            .collect();
        let plan = self.plan;
        let Some(again) = self.integrate(&plan, &again) else {
            return;
        };
        for (n, ray) in poor.into_iter().zip(again) {
            rays[n] = ray;
        }
    }

    /// The first rays, exact enough, and the sectors between them.
    fn base(&mut self) -> Vec<Sector> {
        let step = TAU / BASE as f64;
        let wanted: Vec<Wanted> = (0..BASE)
            .map(|n| Wanted::new(n as f64 * step, 2.0 * step))
            .collect();
        let mut loose = 1.0;
        for _ in 0..4 {
            let plan = self.plan;
            let Some(rays) = self.integrate(&plan, &wanted) else {
                return Vec::new();
            };
            self.rays = rays;
            // Every other one again, more exactly: how far off are they?
            let exact = Plan {
                rate: EXACT * plan.rate,
                ..plan
            };
            let again: Vec<Wanted> = wanted.iter().copied().skip(1).step_by(2).collect();
            let Some(again) = self.integrate(&exact, &again) else {
                break;
            };
            self.along = [0.0; BINS];
            for (n, exact) in again.iter().enumerate() {
                let ray = &self.rays[2 * n + 1];
                let next = &self.rays[(2 * n + 2) % BASE];
                let (profile, _) = self.seen([ray, next], step, exact, 0.0);
                for (all, one) in self.along.iter_mut().zip(profile) {
                    *all = all.max(one);
                }
            }
            let worst = f64::from(self.along.iter().fold(0.0_f32, |worst, x| worst.max(*x)));
            let told = self
                .rays
                .iter()
                .skip(1)
                .step_by(2)
                .fold(0.0_f64, |told, ray| told.max(ray.error));
            self.factor = if told > 0.0 {
                (worst / told).min(10.0 / self.start.pixel)
            } else {
                0.0
            };
            let share = worst / (ALONG * self.options.tolerance);
            if share <= 1.0 {
                loose = (0.5 / share).clamp(1.0, LOOSEST);
                break;
            }
            self.plan.rate *= (0.5 / share).max(1e-3);
        }
        let mut rays = std::mem::take(&mut self.rays);
        self.improve(&mut rays, &wanted);
        self.rays = rays;
        // What the first rays were too exact, the others need not be.
        self.plan.rate *= loose;
        self.along = self.along.map(|error| error * loose as f32);
        for ray in &mut self.rays {
            ray.care /= loose;
        }
        let order = self.order();
        let stretched =
            |a: usize, b: usize| cell::is_stretched([&self.rays[a], &self.rays[b % BASE]]);
        (0..BASE)
            .map(|n| {
                // The odd rays are the middles of sectors twice as wide.
                let pair = n / 2;
                let [a, middle, b] = [2 * pair, 2 * pair + 1, (2 * pair + 2) % BASE];
                let rays = [&self.rays[a], &self.rays[b]];
                let errors = self.profile(rays, 2.0 * step, &self.rays[middle], 0.5);
                let edge = cell::exit_discrepancy(rays, 2.0 * step, &self.rays[middle]);
                let mut sector = self.sector(
                    [n, (n + 1) % BASE],
                    n as f64 * step,
                    step,
                    errors.map(|x| x / order),
                    edge / f64::from(order),
                );
                // (Where rays end at no edge, its slope is not known yet.)
                let told = [a, b]
                    .iter()
                    .all(|&ray| self.rays[ray].stop.is_none_or(|stop| stop.told));
                sector.proven = told && stretched(n, n + 1) == stretched(a, b);
                sector
            })
            .collect()
    }

    fn sector(
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
            edge: edge / self.start.pixel,
            proven: true,
            measured: false,
            doubted: false,
        }
    }

    /// The errors that a ray shows of the two beside it, in pixels; infinite where it shows nothing.
    fn profile(&self, rays: [&Ray; 2], width: f64, middle: &Ray, t: f64) -> Profile {
        let (mut out, seen) = self.seen(rays, width, middle, t);
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

    /// The errors that a ray shows, and for how many ranges it does.
    pub(super) fn seen(
        &self,
        rays: [&Ray; 2],
        width: f64,
        middle: &Ray,
        t: f64,
    ) -> (Profile, usize) {
        let mut out = [0.0_f32; BINS];
        let mut seen = 0;
        let border = self.border_of(middle, width);
        let limits = rays.map(Ray::limit);
        let last = if limits[0].is_finite() && limits[1].is_finite() {
            middle.limit().min(border)
        } else {
            limits[0].min(limits[1]).min(border)
        };
        let last = last.min(middle.end);
        let probes = middle.probes.iter().copied().filter(|s| *s < last);
        for s in probes.chain([last]) {
            let across = self.options.across;
            let Some(error) = cell::discrepancy(self.space, across, rays, width, middle, t, s)
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
        let worst = most(&sector.errors[..=inside]);
        f64::from(worst) <= ACROSS * self.options.tolerance
            && sector.proven
            && (sector.edge <= EDGE
                || self.pair(sector)[0]
                    .limit()
                    .min(self.pair(sector)[1].limit())
                    >= border)
            && cell::end_alike(self.pair(sector), border, self.start.pixel)
    }

    /// The last range of radius that matters.
    pub(super) fn inside(&self, sector: &Sector) -> usize {
        let [a, b] = self.pair(sector).map(Ray::limit);
        bin(sector.border.min(a.max(b)), self.start.reach)
    }

    /// The largest error as far as it is known and matters.
    pub(super) fn worst(&self, sector: &Sector) -> f64 {
        let mut last = self.inside(sector);
        if sector.unknown_from.is_finite() {
            last = last.min(bin(sector.unknown_from, self.start.reach).saturating_sub(1));
        }
        f64::from(most(&sector.errors[..=last]))
    }

    /// What is known of a sector that cannot be made better.
    fn give_up(&self, sector: &mut Sector) {
        let inside = self.inside(sector);
        let wrong = sector.errors[..=inside]
            .iter()
            .position(|x| f64::from(*x) > ACROSS * self.options.tolerance);
        if let Some(bin) = wrong {
            sector.unknown_from = self.start.reach * bin as f64 / BINS as f64;
            sector.errors[bin..].fill(0.0);
        }
        let rays = self.pair(sector);
        let alike = cell::end_alike(rays, sector.border, self.start.pixel);
        if !alike || sector.edge > EDGE {
            let limit = rays[0].limit().min(rays[1].limit());
            sector.unknown_from = sector.unknown_from.min(limit);
        }
    }

    /// How many pixels of a sector would have to be followed by themselves.
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
                .map(|sector| Wanted {
                    care: self.care(sector),
                    ..Wanted::middle(sector)
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

    /// Where rays end at no edge, how the place changes with the angle is told from their neighbours.
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
        let errors = self
            .profile(rays, sector.width, &middle, 0.5)
            .map(|x| x / order);
        let edge = cell::exit_discrepancy(rays, sector.width, &middle) / f64::from(order);
        let half = 0.5 * sector.width;
        let new = self.rays.len();
        self.rays.push(middle);
        let [a, b] = sector.rays;
        let before = cell::is_stretched(self.pair(&sector));
        let mut halves = [
            self.sector([a, new], sector.angle, half, errors, edge),
            self.sector([new, b], sector.angle + half, half, errors, edge),
        ];
        for half in &mut halves {
            half.proven = cell::is_stretched(self.pair(half)) == before;
        }
        halves
    }
}
