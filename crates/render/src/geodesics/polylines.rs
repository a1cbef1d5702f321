//! Geodesics that a picture wears, kept from one picture to the next: while a camera walks they stay as they are.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use geodesic::surface::Surface;
use rayon::prelude::*;

use super::{Start, along};

/// The most points that are kept though no picture may need them any more.
const MOST_KEPT: usize = 1 << 18;

/// A geodesic that is wanted as points at equal distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    /// (u,v).
    pub(crate) start: [f64; 2],
    /// a σu + b σv; its length does not matter.
    pub(crate) direction: [f64; 2],
    /// The arc lengths of the first and of the last point.
    pub(crate) lengths: [f64; 2],
    /// One less than there are points.
    pub(crate) pieces: u32,
}

/// Points (u,v) in the domain; `None` where the geodesic does not get to.
pub(crate) type Polyline = Arc<[Option<[f64; 2]>]>;

/// What has been followed on one surface.
#[derive(Debug, Default)]
pub(crate) struct Polylines {
    known: Mutex<HashMap<[u64; 7], Polyline>>,
}

impl Polylines {
    /// The points of some geodesics on a surface, always the same one.
    pub(crate) fn of(&self, surface: &dyn Surface, lines: &[Line]) -> Vec<Polyline> {
        let mut found: Vec<Option<Polyline>> = {
            let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
            lines
                .iter()
                .map(|line| known.get(&line.key()).cloned())
                .collect()
        };
        if found.iter().any(Option::is_none) {
            found
                .par_iter_mut()
                .zip(lines)
                .filter(|(found, _)| found.is_none())
                .for_each(|(found, line)| *found = Some(line.follow(surface)));
            self.keep(lines, &found);
        }
        found.into_iter().flatten().collect()
    }

    fn keep(&self, lines: &[Line], found: &[Option<Polyline>]) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let points =
            |all: &mut dyn Iterator<Item = &Polyline>| -> usize { all.map(|l| l.len()).sum() };
        // What this picture wears is worth more than what others have worn.
        if points(&mut known.values()) + points(&mut found.iter().flatten()) > MOST_KEPT {
            known.clear();
        }
        let mut room = MOST_KEPT;
        for (line, points) in lines.iter().zip(found.iter().flatten()) {
            let Some(left) = room.checked_sub(points.len()) else {
                break;
            };
            room = left;
            known.insert(line.key(), points.clone());
        }
    }
}

impl Line {
    fn key(&self) -> [u64; 7] {
        let [u, v] = self.start;
        let [a, b] = self.direction;
        let [low, high] = self.lengths;
        let [u, v, a, b, low, high] = [u, v, a, b, low, high].map(f64::to_bits);
        [u, v, a, b, low, high, u64::from(self.pieces)]
    }

    fn follow(&self, surface: &dyn Surface) -> Polyline {
        let [low, high] = self.lengths;
        let count = f64::from(self.pieces.max(1));
        let lengths: Vec<f64> = (0..=self.pieces)
            .map(|k| low + (high - low) * f64::from(k) / count)
            .collect();
        let start = Start::Chart(self.start, self.direction);
        let knots = along(surface, &start, &lengths);
        knots.iter().map(|knot| knot.map(|k| k.uv)).collect()
    }
}
