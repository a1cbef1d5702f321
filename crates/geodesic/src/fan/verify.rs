//! The errors of a fan: rays integrated with higher accuracy measure them, both where they should be largest and in
//! evenly spread places. Errors that are too large are reduced.
//!
//! A ray in the middle of a sector measures the interpolation and both rays of the sector there; one in the direction of
//! a ray of the fan measures that ray alone.

use std::cmp::Reverse;
use std::f64::consts::TAU;

use super::border;
use super::build::{ACROSS, BASE, Builder, Wanted};
use super::driver::RayPlan;
use super::error_indicator;
use super::ray::Ray;
use super::sectors::{BINS, Profile, Sector, bin, most};
use crate::ends::Estimate;

/// The factor on the tolerance of the rays that measure the errors of the others.
const EXACT: f64 = 0.15;
/// The number of evenly spread sectors that are measured besides those that should have the largest errors.
const SPREAD: usize = 3;
/// The maximum number of rounds of measuring and bisecting.
const ROUNDS: usize = 4;
/// More sectors are measured while any unmeasured one is expected to have more than this fraction of the largest error
/// found, and not many have been measured.
const DOUBTFUL: f64 = 0.7;
/// Predictions that were too low by more than this factor are raised, and checked again.
const RAISED: f64 = 1.4;
/// The minimum factor on predictions that were too high.
const LOWERED: f64 = 0.5;
/// The factor on the prediction for a sector that was never bisected: wider ones may underestimate it by far.
const UNTRIED: f64 = 6.0;
/// Rays are measured if their own errors, times this factor, may be the largest of the picture.
const RAY_DOUBTFUL: f64 = 3.0;
/// The maximum number of such rays, besides as many as fill the last group of eight.
const RAYS: usize = 4;
/// The fractions of their steps at which they are compared: steps are so long that between one and those of other rays there
/// is more than one bulge.
const SHARES: [f64; 2] = [0.25, 0.75];
/// The ratio of the largest error at the picture's pixels to the largest that is expected anywhere in its sectors. On
/// random scenes most estimates are within a factor of two of the truth with this value (`benches estimates`).
const AT_PIXELS: f64 = 0.8;

impl Builder<'_> {
    /// Measures errors with rays integrated more accurately; where the errors are too large, these rays join the fan.
    pub(super) fn verify(&mut self, sectors: &mut Vec<Sector>) -> Estimate {
        let exact = RayPlan {
            rate: EXACT * self.plan.rate,
            ..self.plan
        };
        // The factor by which predictions have been too low.
        let mut low = 1.0_f64;
        let mut compared = Vec::new();
        for round in 0..ROUNDS {
            sectors.sort_by(|a, b| a.angle.total_cmp(&b.angle));
            let chosen = self.doubtful(sectors, round == 0);
            let doubtful_rays = self.doubtful_rays(sectors, &compared, chosen.len());
            let wanted: Vec<Wanted> = (chosen.iter())
                .map(|&n| Wanted::middle(&sectors[n]))
                .chain(doubtful_rays.iter().map(|&n| first_ray(sectors, n)))
                .collect();
            if wanted.is_empty() {
                break;
            }
            let Some(mut rays) = self.integrate(&exact, &wanted) else {
                break;
            };
            for ray in &mut rays {
                ray.tolerance_share *= EXACT;
            }
            let again = rays.split_off(chosen.len());
            compared.extend(doubtful_rays.iter().map(|&n| sectors[n].rays[0]));
            let raised = self.compare_rays(sectors, &doubtful_rays, again);
            low = low.max(self.measure(sectors, &chosen, rays));
            if low > RAISED {
                for sector in sectors
                    .iter_mut()
                    .filter(|sector| !sector.measured && !sector.doubted)
                {
                    sector.errors = sector.errors.map(|error| error * low as f32);
                    sector.doubted = true;
                }
            }
            let before = sectors.len();
            self.refine(sectors);
            let is_settled = sectors.len() == before && low <= RAISED && raised <= RAISED;
            if is_settled && !self.is_doubtful(sectors) {
                break;
            }
        }
        self.estimate(sectors)
    }

    /// Measures sectors with the rays in their middles; returns the factor by which predictions were too low.
    fn measure(&mut self, sectors: &mut Vec<Sector>, chosen: &[usize], rays: Vec<Ray>) -> f64 {
        let mut low = 1.0_f64;
        for (&n, ray) in chosen.iter().zip(rays) {
            let sector = sectors[n].clone();
            let (found, _) = self.seen(self.pair(&sector), sector.width, &ray, 0.5, &SHARES);
            let predicted = self.worst(&sector);
            let measured = Sector {
                errors: found,
                ..sector.clone()
            };
            let worst = f64::from(measured.most(self.inside(&sector)));
            if predicted.is_finite() && predicted > 0.2 * ACROSS * self.options.tolerance {
                let across = worst - f64::from(most(&self.along(&sector)));
                low = low.max((across / predicted).min(4.0));
            }
            if worst > self.options.tolerance && sector.unknown_from.is_infinite() {
                let [a, b] = self.halve(sector, ray);
                sectors[n] = a;
                sectors.push(b);
            } else {
                sectors[n].errors = found;
                sectors[n].measured = true;
                let wrong =
                    |&bin: &usize| f64::from(measured.seen_error(bin)) > self.options.tolerance;
                if let Some(bin) = (0..BINS).find(wrong) {
                    // Less is known of the sector than assumed.
                    let from = self.start.reach * bin as f64 / BINS as f64;
                    sectors[n].unknown_from = sectors[n].unknown_from.min(from);
                }
            }
        }
        low
    }

    /// Replaces the first rays of sectors by more accurate ones and compares the two; returns the factor by which the
    /// errors exceeded their estimates.
    fn compare_rays(&mut self, sectors: &mut [Sector], chosen: &[usize], again: Vec<Ray>) -> f64 {
        let (mut found, mut estimated) = (0.0_f64, 0.0_f64);
        for (&n, exact) in chosen.iter().zip(&again) {
            let sector = &sectors[n];
            let rays = self.pair(sector);
            let (errors, _) = self.seen(rays, sector.width, exact, 0.0, &SHARES);
            let seen = |errors: &Profile| {
                let shown = errors
                    .iter()
                    .zip(&sector.seen[1])
                    .map(|(error, seen)| error * seen);
                f64::from(shown.fold(0.0_f32, f32::max))
            };
            found = found.max(seen(&errors));
            estimated = estimated.max(self.factor * seen(&rays[0].off));
        }
        let raised = if estimated > 0.0 {
            (found / estimated).max(LOWERED)
        } else {
            1.0
        };
        self.factor = (raised * self.factor).min(10.0 / self.start.pixel);
        let stretched: Vec<bool> = (sectors.iter())
            .map(|sector| border::is_stretched(self.pair(sector)))
            .collect();
        for (&n, exact) in chosen.iter().zip(again) {
            self.rays[sectors[n].rays[0]] = exact;
        }
        if raised > RAISED {
            let mut wanted: Vec<(usize, Wanted)> = (0..sectors.len())
                .map(|n| (sectors[n].rays[0], first_ray(sectors, n)))
                .collect();
            wanted.sort_by_key(|(ray, _)| *ray);
            let wanted: Vec<Wanted> = wanted
                .into_iter()
                .map(|(ray, wanted)| wanted.with_tolerance_share(self.rays[ray].tolerance_share))
                .collect();
            let mut rays = std::mem::take(&mut self.rays);
            self.improve(&mut rays, &wanted);
            self.rays = rays;
        }
        for (sector, before) in sectors.iter_mut().zip(stretched) {
            // Its errors were those of another interpolation.
            if border::is_stretched(self.pair(sector)) != before {
                sector.proven = false;
                sector.measured = false;
            }
        }
        raised
    }

    /// Returns the estimated errors of the whole picture, from those known of each sector.
    fn estimate(&self, sectors: &mut [Sector]) -> Estimate {
        let mut max = 0.0_f64;
        for sector in sectors.iter_mut() {
            let along = self.along(sector);
            let last = self.last(sector);
            for (n, along) in along.into_iter().enumerate() {
                let both = |across: f32| {
                    if sector.measured {
                        across.max(along)
                    } else {
                        across.hypot(along)
                    }
                };
                if n <= last {
                    max = max.max(f64::from(both(sector.seen_error(n))));
                }
                sector.errors[n] = both(sector.errors[n]);
            }
        }
        let max = AT_PIXELS * max;
        Estimate {
            max,
            p99: self.quantile(sectors).min(max),
        }
    }

    /// Returns the error that 99 % of the picture does not exceed.
    fn quantile(&self, sectors: &[Sector]) -> f64 {
        let mut samples: Vec<(f32, f64)> = Vec::with_capacity(3 * BINS * sectors.len());
        for sector in sectors {
            let known = bin(sector.border.min(sector.unknown_from), self.start.reach);
            let along = self.along(sector);
            for (k, &error) in sector.errors[..=known].iter().enumerate().step_by(2) {
                let weight = sector.width * (k as f64 + 0.5);
                // Between two rays the error is proportional to t²(1−t)².
                for (share, part) in [(1.0, 0.3), (0.7, 0.3), (0.25, 0.4)] {
                    samples.push((along[k].max(error * share), weight * part));
                }
            }
        }
        samples.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        let total: f64 = samples.iter().map(|sample| sample.1).sum();
        let mut sum = 0.0;
        let found = samples.iter().find(|sample| {
            sum += sample.1;
            sum >= 0.01 * total
        });
        found.map_or(0.0, |sample| f64::from(sample.0))
    }

    /// Returns whether unmeasured sectors may be worse than the measured ones.
    fn is_doubtful(&self, sectors: &[Sector]) -> bool {
        let count = sectors.iter().filter(|sector| sector.measured).count();
        if 3 * count >= 2 * sectors.len() {
            return false;
        }
        let (mut known, mut doubtful) = (0.0_f64, 0.0_f64);
        for (sector, expected) in sectors.iter().zip(self.expected(sectors)) {
            if sector.measured {
                known = known.max(self.worst(sector));
            } else {
                doubtful = doubtful.max(expected);
            }
        }
        doubtful > DOUBTFUL * known
    }

    /// Returns the expected errors of the sectors, from their construction and from indicators of their rays.
    fn expected(&self, sectors: &[Sector]) -> Vec<f64> {
        let mut errors: Vec<f64> = sectors.iter().map(|sector| self.worst(sector)).collect();
        let mut order: Vec<usize> = (0..sectors.len()).collect();
        order.sort_by(|&a, &b| sectors[a].angle.total_cmp(&sectors[b].angle));
        let sorted: Vec<&Sector> = order.iter().map(|&n| &sectors[n]).collect();
        let (reach, pixel) = (self.start.reach, self.start.pixel);
        let between = error_indicator::between(self.layout, &self.rays, &sorted, reach, pixel);
        for (n, error) in order.into_iter().zip(between) {
            errors[n] = errors[n].max(error);
            let is_untried = sectors[n].width > 0.9 * TAU / BASE as f64 && !sectors[n].measured;
            if is_untried {
                errors[n] *= UNTRIED;
            }
        }
        errors
    }

    /// Returns the sectors to be measured: those that should have the largest errors, and some spread evenly.
    fn doubtful(&self, sectors: &[Sector], first: bool) -> Vec<usize> {
        let mut known: Vec<usize> = (0..sectors.len())
            .filter(|&n| !sectors[n].measured && sectors[n].unknown_from > 0.1 * self.start.reach)
            .collect();
        known.sort_by(|&a, &b| sectors[a].angle.total_cmp(&sectors[b].angle));
        let count = if first { SPREAD.min(known.len()) } else { 0 };
        let mut chosen: Vec<usize> = (0..count)
            .map(|n| known[n * known.len() / SPREAD])
            .collect();
        let estimated = self.expected(sectors);
        known.sort_by_key(|&n| Reverse(magnitude(estimated[n])));
        // In whole groups of eight.
        let worst = (known.len() / 16).min(64).next_multiple_of(8);
        known.truncate(worst.max(8) - if first { SPREAD } else { 0 });
        chosen.extend(known);
        chosen.sort_unstable();
        chosen.dedup();
        chosen
    }

    /// Returns the sectors, given in the order of their angles, whose first rays are to be measured: those whose own
    /// errors should be the largest, if these may be the largest of the picture. `beside` sectors are measured with
    /// them.
    fn doubtful_rays(&self, sectors: &[Sector], compared: &[usize], beside: usize) -> Vec<usize> {
        let known = sectors
            .iter()
            .fold(0.0_f64, |most, sector| most.max(self.worst(sector)));
        let along: Vec<f64> = (sectors.iter())
            .map(|sector| f64::from(most(&self.along(sector))))
            .collect();
        let count = sectors.len();
        let estimated = |n: usize| along[n].max(along[(n + count - 1) % count]);
        let mut chosen: Vec<usize> = (0..count)
            .filter(|&n| {
                RAY_DOUBTFUL * estimated(n) > known && !compared.contains(&sectors[n].rays[0])
            })
            .collect();
        chosen.sort_by_key(|&n| Reverse(magnitude(estimated(n))));
        chosen.truncate((beside + RAYS).next_multiple_of(8) - beside);
        chosen
    }
}

/// Returns the request for a sector's first ray, as long as the two adjacent sectors need it. The sectors are in the
/// order of their angles.
fn first_ray(sectors: &[Sector], n: usize) -> Wanted {
    let before = &sectors[(n + sectors.len() - 1) % sectors.len()];
    Wanted::new(sectors[n].angle, sectors[n].width.max(before.width))
}

/// Quantises an error to a hundredth of itself, for sorting. Rays that a surface's symmetry maps to each other have the
/// same errors up to rounding; the first of them must be chosen on every machine, however its sine rounds.
fn magnitude(error: f64) -> u32 {
    (error as f32).to_bits() >> 16
}
