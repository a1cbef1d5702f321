//! One method with one setting on one view: run times, work, and the errors against the reference.

use std::time::{Duration, Instant};

use geodesic::frame::Frame;
use geodesic::map::{Map, MapOptions, exponential_map};
use geodesic::reference::Reference;
use geodesic::surface::Surface;
use geodesic::trace::Status;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;

use super::method::Setting;
use crate::failure::Failure;

/// Methods that trace each pixel by itself are timed on every `n`th pixel along both axes, with this `n`.
pub(super) const EVERY: u32 = 8;
/// The time that the repetitions of one run may take together, after the first.
const TIME_LIMIT: Duration = Duration::from_millis(400);
/// The most runs for one time.
const RUNS: usize = 9;
/// The number of pixels that the reference traces.
const SAMPLE: usize = 4096;

/// All statuses, in the order of the shares.
pub(super) const STATUSES: [(Status, &str); 6] = [
    (Status::Complete, "complete"),
    (Status::LeftDomain, "left_domain"),
    (Status::ConePoint, "cone_point"),
    (Status::Degenerate, "degenerate"),
    (Status::Undefined, "undefined"),
    (Status::WorkLimit, "work_limit"),
];

/// A thread pool of one thread, and one of all cores.
#[derive(Debug)]
pub(super) struct Threads {
    one: ThreadPool,
    all: ThreadPool,
}

impl Threads {
    /// Starts both pools.
    ///
    /// # Errors
    /// [`Failure::Internal`] if the system starts no threads.
    pub(super) fn new() -> Result<Self, Failure> {
        let pool = |threads: usize| {
            ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .map_err(|error| Failure::Internal {
                    message: format!("cannot start threads: {error}"),
                })
        };
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Ok(Self {
            one: pool(1)?,
            all: pool(cores)?,
        })
    }

    /// The number of cores.
    pub(super) fn count(&self) -> usize {
        self.all.current_num_threads()
    }
}

/// The largest error and the 99th percentile of the errors, in pixels.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct ErrorBounds {
    pub(super) max: f64,
    pub(super) p99: f64,
}

/// The results of one run.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Measured {
    /// The time for the whole picture on one thread, in milliseconds.
    pub(super) time_one_ms: f64,
    /// The time for the whole picture on all cores, in milliseconds.
    pub(super) time_all_ms: f64,
    pub(super) evaluations_per_pixel: f64,
    pub(super) rays: u64,
    /// The errors of the pixels that have an end, as the reference has.
    pub(super) error_px: ErrorBounds,
    /// The estimate of the method itself.
    pub(super) estimate_px: Option<ErrorBounds>,
    /// The share of the pixels whose status differs from the reference.
    pub(super) unlike: f64,
    /// The shares of the pixels by status, in the order of [`STATUSES`].
    #[serde(skip)]
    pub(super) shares: [f64; STATUSES.len()],
}

/// A view to be measured.
pub(super) struct MeasuredView<'s> {
    surface: &'s dyn Surface,
    frame: Frame,
    size: [u32; 2],
    full: Reference<'s>,
    thin: Reference<'s>,
}

impl<'s> MeasuredView<'s> {
    /// Traces the references.
    pub(super) fn new(surface: &'s dyn Surface, frame: Frame, size: [u32; 2]) -> Self {
        Self {
            surface,
            frame,
            size,
            full: Reference::new(surface, &frame, size, SAMPLE),
            thin: Reference::new(surface, &frame, thinned(size), SAMPLE),
        }
    }

    /// The number of pixels of the reference, and the number of those whose true end is unknown.
    pub(super) fn sampled(&mut self) -> (usize, usize) {
        let errors = self.full.errors(&|_| ([f64::NAN; 2], Status::Complete));
        (errors.pixels, errors.unknown)
    }

    /// Measures a method with a setting.
    pub(super) fn measure(&mut self, setting: &Setting, threads: &Threads) -> Measured {
        let thin = setting.is_pixel_by_pixel();
        let mut options = setting.options();
        let (size, scale) = if thin {
            // Scaled from the pixels that were run to those of the whole picture.
            options.tolerance /= f64::from(EVERY);
            (thinned(self.size), f64::from(EVERY))
        } else {
            (self.size, 1.0)
        };
        let (surface, frame) = (self.surface, self.frame);
        let make = || make(surface, &frame, size, &options);
        let (one, map) = threads.one.install(|| timed(make));
        let (all, _) = threads.all.install(|| timed(make));
        let reference = if thin { &mut self.thin } else { &mut self.full };
        let errors = reference.errors(&|index| (map.uv(index), map.status[index]));
        let pixels = map.status.len().max(1) as f64;
        let share = |status| map.status.iter().filter(|s| **s == status).count() as f64 / pixels;
        let milliseconds = |time: Duration| 1e3 * scale * scale * time.as_secs_f64();
        Measured {
            time_one_ms: milliseconds(one),
            time_all_ms: milliseconds(all),
            evaluations_per_pixel: map.work.evaluations as f64 / pixels,
            rays: map.work.rays,
            error_px: ErrorBounds {
                max: scale * errors.max,
                p99: scale * errors.quantile(0.99),
            },
            estimate_px: map.estimate.map(|estimate| ErrorBounds {
                max: scale * estimate.max,
                p99: scale * estimate.p99,
            }),
            unlike: errors.unlike as f64 / errors.pixels.max(1) as f64,
            shares: STATUSES.map(|(status, _)| share(status)),
        }
    }
}

fn make(surface: &dyn Surface, frame: &Frame, size: [u32; 2], options: &MapOptions) -> Map {
    exponential_map(surface, frame, size, options, &|_| {})
}

/// Returns the median time of several runs, or the time of a single long run, with its result.
fn timed(make: impl Fn() -> Map) -> (Duration, Map) {
    let start = Instant::now();
    let map = make();
    let first = start.elapsed();
    // The first run warms the caches; it counts only if it is the only one.
    if first > TIME_LIMIT {
        return (first, map);
    }
    let begun = Instant::now();
    let mut times = Vec::new();
    while times.len() < RUNS && (times.is_empty() || begun.elapsed() + first < TIME_LIMIT) {
        let start = Instant::now();
        std::hint::black_box(make());
        times.push(start.elapsed());
    }
    times.sort_unstable();
    (times.get(times.len() / 2).copied().unwrap_or(first), map)
}

fn thinned(size: [u32; 2]) -> [u32; 2] {
    size.map(|pixels| pixels.div_ceil(EVERY))
}
