//! Holes and bumps that no ray has met.
//!
//! In: sectors that their rays call exact. Out: more rays, and the parts that stay unknown. Neither two rays nor a third one in
//! their middle know of a hole or a bump beside them. At the points of a coarse lattice the interpolated geodesics are compared
//! with the surface itself: it must be defined there, and their velocity must have unit length.

use super::build::Builder;
use super::cell::{self, Found};
use super::sectors::Sector;
use crate::metric::speed;
use crate::surface::{JetBlock, LANES};

/// The number of points of the lattice across the picture's diagonal: what is smaller than one of their distances may still be
/// missed.
const ACROSS: f64 = 48.0;
/// The maximum difference of a velocity's length from 1: beside an edge, and between rays in different charts, an interpolated
/// one is off by up to a tenth although positions are exact.
const MOST_OFF: f64 = 0.15;
/// The maximum number of times that a sector is bisected in search of what is in it.
const ROUNDS: usize = 6;

/// A point of the lattice with the interpolated geodesic there.
#[derive(Clone, Copy)]
struct Probe {
    sector: usize,
    s: f64,
    at: [f64; 2],
    along: [f64; 2],
}

impl Builder<'_> {
    /// Returns the distance between points of the lattice.
    pub(super) fn lattice_step(&self) -> f64 {
        2.0 * self.start.reach / ACROSS
    }

    /// Returns true if the surface contradicts any sector's rays.
    pub(super) fn misses_any(&self, sectors: &[Sector]) -> bool {
        self.contradicted(sectors).iter().any(|s| s.is_finite())
    }

    /// Bisects sectors in which the surface contradicts the rays, until it does not. Parts in which it still does become
    /// unknown.
    pub(super) fn find_missed(&mut self, sectors: &mut Vec<Sector>) {
        let mut done = Vec::with_capacity(sectors.len());
        let mut open = std::mem::take(sectors);
        let mut found = false;
        for round in 0..=ROUNDS {
            let contradicted = self.contradicted(&open);
            let mut bad = Vec::new();
            for (mut sector, s) in open.drain(..).zip(contradicted) {
                if s.is_infinite() {
                    done.push(sector);
                } else if round == ROUNDS {
                    sector.unknown_from = sector.unknown_from.min(s);
                    done.push(sector);
                } else {
                    bad.push(sector);
                }
            }
            if bad.is_empty() {
                break;
            }
            found = true;
            match self.bisect(bad) {
                Ok(halves) => open = halves,
                Err(bad) => {
                    done.extend(bad);
                    break;
                }
            }
        }
        *sectors = done;
        if found {
            self.refine(sectors);
        }
    }

    /// Returns for each sector the arc length from which the surface contradicts its rays; infinite where it does not.
    fn contradicted(&self, sectors: &[Sector]) -> Vec<f64> {
        let mut from = vec![f64::INFINITY; sectors.len()];
        let step = self.lattice_step();
        let probes: Vec<Probe> = (0..sectors.len())
            .flat_map(|n| self.probes(&sectors[n], n, step))
            .collect();
        self.examined.set(self.examined.get() + probes.len() as u64);
        let mut jets = JetBlock::default();
        for block in probes.chunks(LANES) {
            let mut at = [[0.0; LANES]; 2];
            for (lane, k) in (0..LANES).flat_map(|lane| [(lane, 0), (lane, 1)]) {
                at[k][lane] = block[lane.min(block.len() - 1)].at[k];
            }
            let sides = self.layout.sides;
            let signs = sides.bring_all_back(self.layout.domain, &mut at).signs;
            self.surface.jets(&at, &mut jets);
            jets.reflect(&signs);
            for (lane, probe) in block.iter().enumerate() {
                let off = (speed(&jets.lane(lane), probe.along) - 1.0).abs();
                if off.is_nan() || off > MOST_OFF {
                    let before = (probe.s - step).max(0.0);
                    from[probe.sector] = from[probe.sector].min(before);
                }
            }
        }
        from
    }

    /// Returns the points of the lattice in a sector that its rays determine.
    fn probes(&self, sector: &Sector, number: usize, step: f64) -> Vec<Probe> {
        let rays = self.pair(sector);
        let end = sector.border.min(sector.unknown_from);
        let mut probes = Vec::new();
        let mut s = 0.5 * step;
        while s < end {
            let count = (s * sector.width / step).round().max(1.0);
            for k in 0..count as u32 {
                let t = (f64::from(k) + 0.5) / count;
                let interpolation = self.options.interpolation;
                let found = cell::end_between(self.layout, interpolation, rays, sector.width, t, s);
                if let Found::Point(point) = found
                    && point.chart.is_plain()
                    && !sector.hides(s)
                {
                    probes.push(Probe {
                        sector: number,
                        s,
                        at: point.at,
                        along: point.along,
                    });
                }
            }
            s += step;
        }
        probes
    }
}
