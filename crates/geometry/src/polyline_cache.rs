//! Geodesics on one manifold as points of its chart, cached between pictures: they do not change while a camera moves.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use geodesic::surface::Surface;
use rayon::prelude::*;

use crate::polyline::{GeodesicStart, knots_at};

/// The maximum number of points in the cache.
const MOST_KEPT: usize = 1 << 18;

/// A geodesic to be followed to points at equal arc lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeodesicSegment {
    /// (u, v).
    pub start: [f64; 2],
    /// a σu + b σv; its length is irrelevant.
    pub direction: [f64; 2],
    /// The arc lengths of the first and of the last point.
    pub lengths: [f64; 2],
    /// The number of intervals: one less than the number of points.
    pub pieces: u32,
    /// The maximum number of evaluations of the surface.
    pub max_evaluations: u64,
}

/// A geodesic as points of the chart; cheap to clone.
#[derive(Clone, Debug)]
pub struct ChartPolyline {
    /// Points (u, v) in the domain; `None` where the geodesic ends earlier.
    pub points: Arc<[Option<[f64; 2]>]>,
    /// True if it ends because its evaluations are used up.
    pub is_cut: bool,
}

/// The geodesics that were followed on one surface.
#[derive(Debug, Default)]
pub(crate) struct PolylineCache {
    known: Mutex<HashMap<[u64; 8], ChartPolyline>>,
}

impl PolylineCache {
    /// Follows those segments that are not yet known. `surface` must be the same in every call.
    pub(crate) fn follow(
        &self,
        surface: &dyn Surface,
        segments: &[GeodesicSegment],
    ) -> Vec<ChartPolyline> {
        let mut found: Vec<Option<ChartPolyline>> = {
            let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
            segments
                .iter()
                .map(|segment| known.get(&segment.key()).cloned())
                .collect()
        };
        if found.iter().any(Option::is_none) {
            found
                .par_iter_mut()
                .zip(segments)
                .filter(|(found, _)| found.is_none())
                .for_each(|(found, segment)| *found = Some(segment.points(surface)));
            self.keep(segments, &found);
        }
        found.into_iter().flatten().collect()
    }

    fn keep(&self, segments: &[GeodesicSegment], found: &[Option<ChartPolyline>]) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let points = |all: &mut dyn Iterator<Item = &ChartPolyline>| -> usize {
            all.map(|l| l.points.len()).sum()
        };
        // The lines of this picture will be needed again sooner than those of earlier ones.
        if points(&mut known.values()) + points(&mut found.iter().flatten()) > MOST_KEPT {
            known.clear();
        }
        let mut room = MOST_KEPT;
        for (segment, line) in segments.iter().zip(found.iter().flatten()) {
            let Some(left) = room.checked_sub(line.points.len()) else {
                break;
            };
            room = left;
            known.insert(segment.key(), line.clone());
        }
    }
}

impl GeodesicSegment {
    fn key(&self) -> [u64; 8] {
        let [u, v] = self.start;
        let [a, b] = self.direction;
        let [low, high] = self.lengths;
        let [u, v, a, b, low, high] = [u, v, a, b, low, high].map(f64::to_bits);
        let pieces = u64::from(self.pieces);
        [u, v, a, b, low, high, pieces, self.max_evaluations]
    }

    fn points(&self, surface: &dyn Surface) -> ChartPolyline {
        let [low, high] = self.lengths;
        let count = f64::from(self.pieces.max(1));
        let lengths: Vec<f64> = (0..=self.pieces)
            .map(|k| low + (high - low) * f64::from(k) / count)
            .collect();
        let start = GeodesicStart::Chart(self.start, self.direction);
        let line = knots_at(surface, &start, &lengths, self.max_evaluations);
        ChartPolyline {
            points: line.knots.iter().map(|knot| knot.map(|k| k.uv)).collect(),
            is_cut: line.is_cut,
        }
    }
}
