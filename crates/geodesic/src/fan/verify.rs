//! How exact a fan is: rays that are integrated more exactly measure its errors, where they should be the largest and
//! in places spread evenly. What they find wrong they mend.

use super::march::Plan;
use super::refine::{ACROSS, Builder, Wanted};
use super::sectors::{BINS, Sector, bin, most};
use crate::ends::Estimate;
use crate::surface::Surface;

/// How much more exactly the rays are integrated that measure the errors of the others.
const EXACT: f64 = 0.15;
/// Beside the sectors that should have the largest errors so many are measured that are spread evenly, …
const SPREAD: usize = 3;
/// … so many times, while sectors have to be bisected after it.
const ROUNDS: usize = 4;
/// Predictions that were too low by more than this factor are raised, and looked at again.
const RAISED: f64 = 1.4;
/// A few pixels between two rays, where the picture bends most, escape the rays that measure: by so much the estimate
/// is widened that the truth stays below three times it in all of the random scenes of the tests.
const WIDENED: f64 = 1.2;

impl<S: Surface + ?Sized> Builder<'_, S> {
    /// Measures errors with rays that are integrated more exactly; where they are too large, these take part.
    pub(super) fn verify(&mut self, sectors: &mut Vec<Sector>) -> Estimate {
        let exact = Plan {
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
                let (found, _) = self.seen(self.pair(&sector), sector.width, &ray, 0.5);
                let worst = f64::from(most(&found[..=self.inside(&sector)]));
                let predicted = self.worst(&sector);
                if predicted.is_finite() && predicted > 0.2 * ACROSS * self.options.tolerance {
                    let across = worst - f64::from(most(&self.along));
                    low = low.max((across / predicted).min(4.0));
                }
                if worst > self.options.tolerance && sector.unknown_from.is_infinite() {
                    let [a, b] = self.halve(sector, ray);
                    sectors[n] = a;
                    halves.push(b);
                } else {
                    sectors[n].errors = found;
                    sectors[n].measured = true;
                    let wrong = |error: &f32| f64::from(*error) > self.options.tolerance;
                    if let Some(bin) = found.iter().position(wrong) {
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
            if sectors.len() == before && low <= RAISED {
                break;
            }
        }
        for sector in sectors.iter_mut().filter(|sector| !sector.measured) {
            for (error, along) in sector.errors.iter_mut().zip(self.along) {
                *error += along;
            }
        }
        let max = sectors
            .iter()
            .map(|sector| self.worst(sector))
            .fold(0.0, f64::max);
        Estimate {
            max: WIDENED * max,
            p99: WIDENED * self.quantile(sectors).min(max),
        }
    }

    /// The error that 99 % of the picture stay below.
    fn quantile(&self, sectors: &[Sector]) -> f64 {
        let mut samples: Vec<(f32, f64)> = Vec::with_capacity(3 * BINS * sectors.len());
        for sector in sectors {
            let known = bin(sector.border.min(sector.unknown_from), self.start.reach);
            for (k, &error) in sector.errors[..=known].iter().enumerate() {
                let along = self.along[k];
                let weight = sector.width * (k as f64 + 0.5);
                // Between two rays the error is like t²(1−t)².
                for (share, part) in [(1.0, 0.3), (0.7, 0.3), (0.25, 0.4)] {
                    samples.push((along.max(error * share), weight * part));
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

    /// The sectors whose errors are to be measured: those that should have the largest, and some spread evenly.
    fn doubtful(&self, sectors: &[Sector], spread: bool) -> Vec<usize> {
        let mut known: Vec<usize> = (0..sectors.len())
            .filter(|&n| !sectors[n].measured && sectors[n].unknown_from > 0.1 * self.start.reach)
            .collect();
        known.sort_by(|&a, &b| sectors[a].angle.total_cmp(&sectors[b].angle));
        let count = if spread { SPREAD.min(known.len()) } else { 0 };
        let mut chosen: Vec<usize> = (0..count)
            .map(|n| known[n * known.len() / SPREAD])
            .collect();
        known.sort_by(|&a, &b| {
            let [a, b] = [a, b].map(|n| self.worst(&sectors[n]));
            b.total_cmp(&a)
        });
        // In whole groups of eight.
        let worst = (known.len() / 16).min(64).next_multiple_of(8);
        known.truncate(worst.max(8) - if spread { SPREAD } else { 0 });
        chosen.extend(known);
        chosen.sort_unstable();
        chosen.dedup();
        chosen
    }
}
