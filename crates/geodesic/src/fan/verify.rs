//! The errors of a fan: rays that are integrated more exactly measure its errors, where they should be the largest and
//! in places spread evenly. What they find wrong they mend.

use super::build::{ACROSS, Builder, Wanted};
use super::driver::RayPlan;
use super::error_indicator;
use super::sectors::{BINS, Sector, bin, most};
use crate::ends::Estimate;

/// The factor to the tolerance of the rays that measure the errors of the others.
const EXACT: f64 = 0.15;
/// Beside the sectors that should have the largest errors so many are measured that are spread evenly, …
const SPREAD: usize = 3;
/// … so many times, while sectors have to be bisected after it.
const ROUNDS: usize = 4;
/// While any other is expected to have more than this share of the largest error that was found, and not many have been
/// measured, more are.
const DOUBTFUL: f64 = 0.7;
/// Predictions that were too low by more than this factor are raised, and looked at again.
const RAISED: f64 = 1.4;
/// The shares of their steps at which they are compared: a step is so long that between it and those of other rays lies more than one bulge.
const SHARES: [f64; 2] = [0.25, 0.75];

impl Builder<'_> {
    /// Measures errors with rays that are integrated more exactly; where they are too large, these take part.
    pub(super) fn verify(&mut self, sectors: &mut Vec<Sector>) -> Estimate {
        let exact = RayPlan {
            rate: EXACT * self.plan.rate,
            ..self.plan
        };
        // By how much predictions have been too low.
        let mut low = 1.0_f64;
        for round in 0..ROUNDS {
            let chosen = self.doubtful(sectors, round == 0);
            let wanted: Vec<Wanted> = chosen
                .iter()
                .map(|&n| Wanted::middle(&sectors[n]))
                .collect();
            if chosen.is_empty() {
                break;
            }
            let Some(rays) = self.integrate(&exact, &wanted) else {
                break;
            };
            let mut halves = Vec::new();
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
                    halves.push(b);
                } else {
                    sectors[n].errors = found;
                    sectors[n].measured = true;
                    let wrong =
                        |&bin: &usize| f64::from(measured.seen_error(bin)) > self.options.tolerance;
                    if let Some(bin) = (0..BINS).find(wrong) {
                        // Less is known of it than was thought.
                        let from = self.start.reach * bin as f64 / BINS as f64;
                        sectors[n].unknown_from = sectors[n].unknown_from.min(from);
                    }
                }
            }
            let before = sectors.len() + halves.len();
            sectors.extend(halves);
            if low > RAISED {
                for sector in sectors
                    .iter_mut()
                    .filter(|sector| !sector.measured && !sector.doubted)
                {
                    sector.errors = sector.errors.map(|error| error * low as f32);
                    sector.doubted = true;
                }
            }
            self.refine(sectors);
            if sectors.len() == before && low <= RAISED && !self.is_doubtful(sectors) {
                break;
            }
        }
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
        Estimate {
            max,
            p99: self.quantile(sectors).min(max),
        }
    }

    /// The error that 99 % of the picture stay below.
    fn quantile(&self, sectors: &[Sector]) -> f64 {
        let mut samples: Vec<(f32, f64)> = Vec::with_capacity(3 * BINS * sectors.len());
        for sector in sectors {
            let known = bin(sector.border.min(sector.unknown_from), self.start.reach);
            let along = self.along(sector);
            for (k, &error) in sector.errors[..=known].iter().enumerate().step_by(2) {
                let weight = sector.width * (k as f64 + 0.5);
                // Between two rays the error is like t²(1−t)².
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

    /// Returns whether sectors that have not been measured may be worse than those that have.
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

    /// The errors to be expected of the sectors, by what their making has shown and by what their rays say.
    fn expected(&self, sectors: &[Sector]) -> Vec<f64> {
        let mut errors: Vec<f64> = sectors.iter().map(|sector| self.worst(sector)).collect();
        let mut order: Vec<usize> = (0..sectors.len()).collect();
        order.sort_by(|&a, &b| sectors[a].angle.total_cmp(&sectors[b].angle));
        let sorted: Vec<&Sector> = order.iter().map(|&n| &sectors[n]).collect();
        let (reach, pixel) = (self.start.reach, self.start.pixel);
        let between = error_indicator::between(self.layout, &self.rays, &sorted, reach, pixel);
        for (n, error) in order.into_iter().zip(between) {
            errors[n] = errors[n].max(error);
        }
        errors
    }

    /// The sectors whose errors are to be measured: those that should have the largest, and some spread evenly.
    fn doubtful(&self, sectors: &[Sector], first: bool) -> Vec<usize> {
        let mut known: Vec<usize> = (0..sectors.len())
            .filter(|&n| !sectors[n].measured && sectors[n].unknown_from > 0.1 * self.start.reach)
            .collect();
        known.sort_by(|&a, &b| sectors[a].angle.total_cmp(&sectors[b].angle));
        let count = if first { SPREAD.min(known.len()) } else { 0 };
        let mut chosen: Vec<usize> = (0..count)
            .map(|n| known[n * known.len() / SPREAD])
            .collect();
        let told = self.expected(sectors);
        known.sort_by(|&a, &b| told[b].total_cmp(&told[a]));
        // In whole groups of eight.
        let worst = (known.len() / 16).min(64).next_multiple_of(8);
        known.truncate(worst.max(8) - if first { SPREAD } else { 0 });
        chosen.extend(known);
        chosen.sort_unstable();
        chosen.dedup();
        chosen
    }
}
