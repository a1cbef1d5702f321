//! Counters of a renderer's work, with which tests check that nothing is computed twice.

use std::sync::atomic::{AtomicU64, Ordering};

/// Counters of a renderer's work; no count ever decreases.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct WorkCounters {
    /// Pictures that have been drawn.
    pub pictures: u64,
    /// Pipelines of painters and passes, and kernels: everything that a driver compiles.
    pub pipelines: u64,
    /// Objects whose samples were computed.
    pub sampled: u64,
    /// Geodesic views whose geodesics were followed.
    pub followed: u64,
    /// Pixels of geodesic views whose ends were computed on the CPU, for colours or for overlays.
    pub ends: u64,
    /// Rows of up to eight pixels for which the distances to a straight piece of an overlay line were computed.
    pub distances: u64,
    /// Worlds of solids that were prepared for rays.
    pub worlds: u64,
    /// Rays of the 3D view that were cast at solids.
    pub rays: u64,
    /// Samples of pixels of traced pictures.
    pub traced: u64,
    /// Samples of traced pictures that a GPU has left to f64.
    pub retraced: u64,
}

/// The counts that increase on several threads at once.
#[derive(Debug, Default)]
pub(crate) struct PixelCounters {
    ends: AtomicU64,
    distances: AtomicU64,
    rays: AtomicU64,
    traced: AtomicU64,
    retraced: AtomicU64,
}

impl PixelCounters {
    /// Adds pixels whose ends were computed from a table.
    pub(crate) fn count_ends(&self, count: usize) {
        self.ends.fetch_add(count as u64, Ordering::Relaxed);
    }

    /// Adds rows of up to eight pixels for which the distances to a straight piece of a line were computed.
    pub(crate) fn count_distances(&self, count: u64) {
        self.distances.fetch_add(count, Ordering::Relaxed);
    }

    /// Adds rays that were cast at solids.
    pub(crate) fn count_rays(&self, count: u64) {
        self.rays.fetch_add(count, Ordering::Relaxed);
    }

    /// Adds samples of pixels that were traced.
    pub(crate) fn count_traced(&self, count: u64) {
        self.traced.fetch_add(count, Ordering::Relaxed);
    }

    /// Adds samples that a GPU has left to f64.
    pub(crate) fn count_retraced(&self, count: u64) {
        self.retraced.fetch_add(count, Ordering::Relaxed);
    }

    /// Writes them into counters.
    pub(crate) fn write(&self, counters: &mut WorkCounters) {
        counters.ends = self.ends.load(Ordering::Relaxed);
        counters.distances = self.distances.load(Ordering::Relaxed);
        counters.rays = self.rays.load(Ordering::Relaxed);
        counters.traced = self.traced.load(Ordering::Relaxed);
        counters.retraced = self.retraced.load(Ordering::Relaxed);
    }
}
