//! The thesis' method at its best: the fewest steps that are exact enough, in every precision.

use std::time::Duration;

use geodesic::frame::Frame;
use geodesic::map::{MapMethod, MapOptions, exponential_map};
use geodesic::reference::{Errors, Reference};
use geodesic::surface::Surface;

use super::{EQUAL, SAMPLE};
use crate::measure::processor_time;
use crate::thesis::{self, Equations, Picture, Precision};

/// A way to compute.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    /// The precision of several pixels at once; `None` for one pixel at a time in f64.
    vectors: Option<Precision>,
}

impl Kind {
    /// Whether several pixels go at once.
    pub(super) fn is_simd(self) -> bool {
        self.vectors.is_some()
    }
}

/// All of them. One pixel at a time a processor is as fast in double precision as in single.
pub(super) const KINDS: [Kind; 3] = [
    Kind {
        name: "f64",
        vectors: None,
    },
    Kind {
        name: "f64 SIMD",
        vectors: Some(Precision::Double),
    },
    Kind {
        name: "f32 SIMD",
        vectors: Some(Precision::Single),
    },
];

/// What one of them takes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Baseline {
    /// The fewest steps; `None` where no number of steps is enough.
    pub(super) steps: Option<u32>,
    /// For the whole picture, with these steps.
    pub(super) time: Duration,
    /// The share of the pixels that no number of steps gets right.
    pub(super) never: f64,
}

/// The picture that is run: one pixel of several.
const THIN: u32 = 64;
/// The most steps that are tried.
const MOST: u32 = 1024;
/// Where the method has pixels that it never gets right, it may leave so many more of the others wrong: else it would
/// be held to the few that only its greatest number of steps gets right.
const SPARED: f64 = 0.01;

/// Searches and measures all kinds, on one thread.
pub(super) fn measure(
    surface: &dyn Surface,
    equations: &Equations,
    frame: &Frame,
    size: u32,
) -> Vec<Baseline> {
    let scale = f64::from(size) / f64::from(THIN);
    let mut reference = Reference::new(surface, frame, [THIN; 2], SAMPLE);
    KINDS
        .iter()
        .map(|kind| {
            let make = |steps: u32| match kind.vectors {
                Some(precision) => {
                    thesis::picture(surface, equations, frame, [THIN; 2], steps, precision)
                }
                None => one_by_one(surface, frame, steps),
            };
            let mut errors = |picture: &Picture| {
                reference.errors(&|index| (picture.ends[index], picture.status[index]))
            };
            let best = errors(&make(MOST));
            let wrong = |errors: &Errors| errors.wrong(EQUAL / scale);
            let floor = wrong(&best);
            let pixels = best.pixels.max(1);
            let never = floor as f64 / pixels as f64;
            let enough = |errors: &Errors| {
                if floor == 0 {
                    wrong(errors) == 0 && errors.max <= EQUAL / scale
                } else {
                    wrong(errors) <= floor + (SPARED * pixels as f64) as usize
                }
            };
            if !enough(&best) || 2 * floor > pixels {
                return Baseline {
                    steps: None,
                    time: Duration::ZERO,
                    never,
                };
            }
            // Enough at `high`, not at `low`.
            let (mut low, mut high) = (1, MOST);
            while high - low > (high / 20).max(1) {
                // In the middle by ratio: errors fall with the fourth power.
                let middle = (f64::from(low * high).sqrt() as u32).clamp(low + 1, high - 1);
                if enough(&errors(&make(middle))) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            let time = processor_time(|| make(high));
            Baseline {
                steps: Some(high),
                time: time.mul_f64(scale * scale),
                never,
            }
        })
        .collect()
}

/// The library's own, one pixel at a time.
fn one_by_one(surface: &dyn Surface, frame: &Frame, steps: u32) -> Picture {
    let options = MapOptions {
        method: MapMethod::Rk4 { steps },
        max_evaluations: u64::MAX,
        by_pixel: false,
        ..MapOptions::default()
    };
    let map = exponential_map(surface, frame, [THIN; 2], &options, &|_| {});
    Picture {
        ends: (0..map.status.len()).map(|index| map.uv(index).0).collect(),
        evaluations: map.work.evaluations,
        status: map.status,
    }
}
