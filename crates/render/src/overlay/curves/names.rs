//! The places at which the lines of a geodesic view have their names: away from the middle, where the observer is, and
//! from the edges.
//!
//! The pixels of lines flow in, band by band and in any order; for each line the best one flows out.

use std::sync::{Mutex, PoisonError};

use crate::point::PixelPoint;

/// The best distance of a name from the middle, as a share of that of the edges.
const DISTANCE: f64 = 0.55;
/// The direction in the picture in which names are rather, to the right and up, and how much that weighs.
const SIDE: [f64; 2] = [0.8, -0.6];
const SIDE_WEIGHT: f64 = 0.2;

/// A pixel for a line's name.
#[derive(Clone, Copy, Debug)]
pub(in crate::overlay) struct NamePlace {
    /// Less is better.
    cost: f64,
    /// The number of the pixel.
    pixel: usize,
}

/// The best pixels for the names of some lines.
pub(in crate::overlay) struct NamePlaces {
    size: [u32; 2],
    best: Mutex<Vec<NamePlace>>,
}

impl NamePlace {
    /// No pixel at all.
    pub(in crate::overlay) const NONE: Self = Self {
        cost: f64::INFINITY,
        pixel: usize::MAX,
    };

    /// Takes another pixel over if that is better; of equal ones the first.
    #[inline]
    pub(in crate::overlay) fn note(&mut self, other: Self) {
        if (other.cost, other.pixel) < (self.cost, self.pixel) {
            *self = other;
        }
    }
}

impl NamePlaces {
    pub(in crate::overlay) fn new(size: [u32; 2], lines: usize) -> Self {
        Self {
            size,
            best: Mutex::new(vec![NamePlace::NONE; lines]),
        }
    }

    /// Returns a pixel with its cost.
    pub(in crate::overlay) fn place(&self, pixel: usize) -> NamePlace {
        let [width, height] = self.size.map(|side| side as usize);
        let at = [pixel % width.max(1), pixel / width.max(1)];
        let [x, y] = [(0, width), (1, height)].map(|(k, side)| {
            let half = 0.5 * side as f64;
            (at[k] as f64 + 0.5 - half) / half
        });
        let distance = x.hypot(y);
        let towards = (x * SIDE[0] + y * SIDE[1]) / distance.max(f64::MIN_POSITIVE);
        NamePlace {
            cost: (distance - DISTANCE).abs() + SIDE_WEIGHT * (1.0 - towards),
            pixel,
        }
    }

    /// Takes the best places of some rows over.
    pub(in crate::overlay) fn note(&self, places: &[NamePlace]) {
        let mut best = self.best.lock().unwrap_or_else(PoisonError::into_inner);
        for (best, place) in best.iter_mut().zip(places) {
            best.note(*place);
        }
    }

    /// Returns the best pixel of each line, of those that are seen.
    pub(in crate::overlay) fn pixels(&self) -> Vec<Option<PixelPoint>> {
        let best = self.best.lock().unwrap_or_else(PoisonError::into_inner);
        let width = self.size[0].max(1) as usize;
        let middle = |place: &NamePlace| {
            let at = [place.pixel % width, place.pixel / width];
            PixelPoint(at.map(|x| x as f64 + 0.5))
        };
        let seen = |place: &NamePlace| place.cost.is_finite().then(|| middle(place));
        best.iter().map(seen).collect()
    }
}
