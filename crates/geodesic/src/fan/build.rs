//! Building a fan. In: a start and a tolerance. Out: rays and the sectors between them.
//!
//! The first rays determine the accuracy that steps need; `refine.rs` chooses the rays between them, `missed.rs` looks for
//! what is beside all of them, and `verify.rs` estimates the error of the whole.

use std::cell::Cell;
use std::f64::consts::TAU;

use super::FanOptions;
use super::active_ray::ActiveRay;
use super::border;
use super::driver::{self, RayPlan};
use super::ray::Ray;
use super::sectors::{Profile, Sector, Sectors, most};
use super::start::FanStart;
use super::unknown::{ONE_PIXEL, UnknownAreas};
use crate::chart::{ChartLayout, PROOFS_PER_EVALUATION};
use crate::ends::GeodesicWork;
use crate::surface::Surface;

/// The initial number of rays.
pub(crate) const BASE: usize = 16;
/// The fraction of the tolerance that interpolation between rays may use.
pub(crate) const ACROSS: f64 = 0.7;
/// The fraction of the tolerance that the rays' own errors may use.
const ALONG: f64 = 0.3;
/// The factor on the tolerance when the first rays are integrated again to measure their errors.
const EXACT: f64 = 0.04;
/// The maximum factor by which the other rays' errors may be increased where the first ones prove too accurate. A
/// larger factor would space knots so far apart that the interpolation has kinks, which cost more patches of the
/// picture than they save steps.
const LOOSEST: f64 = 4.0;
/// The minimum fraction of the usual error that a ray is allowed: where even that leads to too large errors, rays are
/// useless.
const LEAST_TOLERANCE_SHARE: f64 = 2e-2;
/// The maximum number of evaluations for one ray, and in space for a pixel that is integrated on its own.
pub(crate) const ONE_RAY: u64 = 20_000;
/// The minimum number of evaluations with which a ray is begun.
const LEAST: u64 = 50;
/// The maximum number of evaluations of the surface for all rays of a fan, whatever its options allow: each step of each ray is
/// stored, in about 300 bytes.
pub const MOST_FOR_RAYS: u64 = 20_000_000;

/// The number of pixels by which rays are continued beyond an edge, so that a square of pixels crossed by an edge can be one
/// polynomial.
const BEYOND: f64 = 48.0;

/// A ray to be integrated, as long as the picture extends within an angle of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    angle: f64,
    around: f64,
    /// The fraction of the usual error that it is allowed.
    tolerance_share: f64,
}

impl Wanted {
    pub(super) fn new(angle: f64, around: f64) -> Self {
        Self {
            angle,
            around,
            tolerance_share: 1.0,
        }
    }

    /// The ray in the middle of a sector.
    pub(super) fn middle(sector: &Sector) -> Self {
        let half = 0.5 * sector.width;
        Self::new(sector.angle + half, half)
    }

    /// Returns the ray with a fraction of the usual error allowed.
    pub(super) fn with_tolerance_share(self, tolerance_share: f64) -> Self {
        Self {
            tolerance_share,
            ..self
        }
    }
}

pub(super) struct Builder<'a> {
    pub(super) surface: &'a dyn Surface,
    pub(super) layout: &'a ChartLayout,
    pub(super) start: &'a FanStart,
    pub(super) options: &'a FanOptions,
    pub(super) plan: RayPlan,
    pub(super) rays: Vec<Ray>,
    pub(super) work: GeodesicWork,
    pub(super) exhausted: bool,
    /// The evaluations spent on the search for what rays miss.
    pub(super) examined: Cell<u64>,
    /// The number of parts between rays that were to be proven smooth.
    pub(super) proofs: Cell<u64>,
    /// A ray's error in pixels per unit of its estimated error.
    pub(super) factor: f64,
}

/// Builds a fan.
pub(super) fn build(
    surface: &dyn Surface,
    layout: &ChartLayout,
    start: &FanStart,
    options: &FanOptions,
) -> Sectors {
    let tolerance = options.tolerance.clamp(1e-6, 100.0);
    let options = FanOptions {
        tolerance,
        ..*options
    };
    let size = layout.scale.size;
    let allowed = ALONG * tolerance * start.pixel;
    let mut builder = Builder {
        surface,
        layout,
        start,
        options: &options,
        plan: RayPlan {
            rate: allowed / start.reach,
            least: 0.01 * start.reach,
            length_scale: 0.5 * size.min(start.reach),
            jacobi_weight: 0.05,
            shortest: (1e-2 * start.pixel).min(1e-4 * size),
            first: start.reach.min(size) * 0.03,
            longest: f64::INFINITY,
            limit: ONE_RAY,
            reach: start.reach,
            beyond: (BEYOND * start.pixel).min(0.25 * start.reach),
        },
        rays: Vec::new(),
        work: GeodesicWork::default(),
        exhausted: false,
        examined: Cell::new(0),
        proofs: Cell::new(0),
        factor: 0.0,
    };
    let plan = builder.plan;
    let mut sectors = builder.base();
    builder.refine(&mut sectors);
    if builder.misses_any(&sectors) {
        // Rays have leapt over it, or passed it by: once more, with steps that meet what is as large.
        builder.rays.clear();
        builder.plan = RayPlan {
            longest: builder.lattice_step(),
            ..plan
        };
        sectors = builder.base();
        builder.refine(&mut sectors);
        builder.find_missed(&mut sectors);
    }
    let estimate = builder.verify(&mut sectors);
    let mut all = Sectors {
        rays: std::mem::take(&mut builder.rays),
        sectors,
        table: Vec::new(),
        work: builder.work,
        estimate,
        follow_within: 0.0,
        pixel_limit: 0,
    };
    all.index();
    if options.follows_each {
        (all.follow_within, all.pixel_limit) = (f64::INFINITY, ONE_PIXEL as usize);
    } else if !builder.exhausted {
        let unknown = UnknownAreas::of(&all, layout, options.interpolation, start);
        let taken = all.work.evaluations + builder.besides_rays();
        let left = options.max_evaluations.saturating_sub(taken);
        // The number that the rays needed, and more.
        let of_ray = 2 * all.work.evaluations / builder.work.rays.max(1) + 100;
        let mut affordable = unknown.affordable(of_ray, start, left);
        if affordable.0.is_finite() {
            // Pixels take fewer where only the rays have difficulties.
            let [of_pixel, taken] = unknown.evaluations_of_pixel(surface, &options, start);
            all.work.evaluations += taken;
            let left = left.saturating_sub(taken);
            affordable = unknown.affordable(of_ray.min(of_pixel), start, left);
        }
        (all.follow_within, all.pixel_limit) = affordable;
    }
    all.work.rays = all.rays.len() as u64;
    all.work.evaluations += builder.besides_rays();
    all
}

impl Builder<'_> {
    /// Returns the number of evaluations that were not those of rays.
    fn besides_rays(&self) -> u64 {
        self.examined.get() + self.proofs.get() / PROOFS_PER_EVALUATION
    }

    /// Integrates rays. Returns `None` if the evaluations do not suffice for all.
    pub(super) fn integrate(&mut self, plan: &RayPlan, wanted: &[Wanted]) -> Option<Vec<Ray>> {
        let most = self.options.max_evaluations.min(MOST_FOR_RAYS);
        let left = most.saturating_sub(self.work.evaluations + self.besides_rays());
        // The number that each ray may certainly use; only a few use more than twice the average.
        let each = left / wanted.len().max(1) as u64;
        let average = self.work.evaluations / self.work.rays.max(1);
        if each < (2 * average).max(LEAST) {
            self.exhausted = true;
            return None;
        }
        let plan = &RayPlan {
            limit: plan.limit.min(each),
            ..*plan
        };
        let rays = wanted
            .iter()
            .enumerate()
            .map(|(id, wanted)| {
                let mut ray = self.start.ray(wanted.angle, wanted.around, plan.first);
                ray.id = id;
                if self.layout.has_creases {
                    let at = ray.plain(self.layout).at;
                    ray.piece = self.layout.smooth_piece(self.surface, at);
                }
                ray.tolerance_share = wanted.tolerance_share;
                ray
            })
            .collect();
        let done = driver::drive_all(self.surface, self.layout, plan, rays);
        for ray in &done {
            // The limit was lower than a ray could have used on its own.
            self.exhausted |= plan.limit < ONE_RAY && ray.evaluations + LEAST > plan.limit;
            self.work.rays += 1;
            self.work.steps += ray.steps;
            self.work.rejected += ray.rejected;
            self.work.evaluations += ray.evaluations;
        }
        let finish = |ray: ActiveRay| ray.finish(self.layout);
        Some(done.into_iter().map(finish).collect())
    }

    /// Integrates rays that become part of the fan. A ray whose own error grows more than that of the others is
    /// integrated again with a correspondingly smaller tolerance.
    pub(super) fn follow(&mut self, wanted: &[Wanted]) -> Option<Vec<Ray>> {
        let plan = self.plan;
        let mut rays = self.integrate(&plan, wanted)?;
        self.improve(&mut rays, wanted);
        Some(rays)
    }

    /// Returns the fraction of the usual error for the ray in the middle of a sector: the one that its neighbours would
    /// have needed.
    pub(super) fn tolerance_share(&self, sector: &Sector) -> f64 {
        let [a, b] = self
            .pair(sector)
            .map(|ray| ray.error() / ray.tolerance_share);
        self.tolerance_share_for(self.factor * (a * b).sqrt())
    }

    /// Returns the fraction of the usual error for a ray that would have an error of `off` pixels.
    fn tolerance_share_for(&self, off: f64) -> f64 {
        let allowed = ALONG * self.options.tolerance;
        if off > 1.5 * allowed {
            (0.5 * allowed / off).max(LEAST_TOLERANCE_SHARE)
        } else {
            1.0
        }
    }

    pub(super) fn improve(&mut self, rays: &mut [Ray], wanted: &[Wanted]) {
        let allowed = ALONG * self.options.tolerance;
        let poor: Vec<usize> = (0..rays.len())
            .filter(|&n| self.factor * rays[n].error() > 1.5 * allowed)
            .collect();
        if poor.is_empty() {
            return;
        }
        let again: Vec<Wanted> = poor
            .iter()
            .map(|&n| Wanted {
                tolerance_share: self
                    .tolerance_share_for(self.factor * rays[n].error() / wanted[n].tolerance_share),
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

    /// Integrates the first rays, accurately enough, and returns the sectors between them.
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
            // Integrate every other ray again, more accurately, to measure its error.
            let exact = RayPlan {
                rate: EXACT * plan.rate,
                ..plan
            };
            let again: Vec<Wanted> = wanted.iter().copied().skip(1).step_by(2).collect();
            let Some(again) = self.integrate(&exact, &again) else {
                break;
            };
            let mut worst = 0.0_f32;
            for (n, exact) in again.iter().enumerate() {
                let ray = &self.rays[2 * n + 1];
                let next = &self.rays[(2 * n + 2) % BASE];
                let (profile, _) = self.seen([ray, next], step, exact, 0.0, &[0.5]);
                worst = worst.max(most(&profile));
            }
            let worst = f64::from(worst);
            let estimated = self
                .rays
                .iter()
                .skip(1)
                .step_by(2)
                .fold(0.0_f64, |largest, ray| largest.max(ray.error()));
            self.factor = if estimated > 0.0 {
                (worst / estimated).min(10.0 / self.start.pixel)
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
        // The other rays need not be as accurate as the first ones proved to be.
        self.plan.rate *= loose;
        for ray in &mut self.rays {
            ray.tolerance_share /= loose;
        }
        let order = self.order();
        let stretched =
            |a: usize, b: usize| border::is_stretched([&self.rays[a], &self.rays[b % BASE]]);
        // Each ray is the middle of a sector of twice the width.
        let wide: Vec<(Profile, f64)> = (0..BASE)
            .map(|middle| {
                let beside = [middle + BASE - 1, middle + 1].map(|ray| &self.rays[ray % BASE]);
                let middle = &self.rays[middle];
                let edge = border::exit_discrepancy(beside, 2.0 * step, middle);
                (self.profile(beside, 2.0 * step, middle, 0.5), edge)
            })
            .collect();
        (0..BASE)
            .map(|n| {
                let [(first, _), (last, _)] = [&wide[n], &wide[(n + 1) % BASE]];
                let errors: Profile = std::array::from_fn(|k| first[k].max(last[k]));
                let pair = n / 2;
                let [a, b] = [2 * pair, (2 * pair + 2) % BASE];
                let edge = wide[2 * pair + 1].1;
                let mut sector = self.sector(
                    [n, (n + 1) % BASE],
                    n as f64 * step,
                    step,
                    errors.map(|x| x / order),
                    edge / f64::from(order),
                );
                // Where rays do not end at an edge, its slope is not known yet.
                let have_slopes = [a, b]
                    .iter()
                    .all(|&ray| self.rays[ray].stop.is_none_or(|stop| stop.has_own_slope));
                sector.proven = have_slopes && stretched(n, n + 1) == stretched(a, b);
                sector
            })
            .collect()
    }
}
