//! Pictures: rays through pixels, tile by tile, on all threads.
//!
//! Input: a scenery, a camera, a range of samples. Output: for each pixel the sum of its samples' light. A tile is drawn by
//! one thread and depends on nothing but its place, so the sums are the same for any number of threads.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use glam::DVec3;

use crate::camera::{CameraFrame, LensCamera, Sample, SampleAxes};
use crate::line::Ray;
use crate::shade::{EyeSample, LightTracer, Scenery};
use crate::threads::run_on;

/// The side of a tile in pixels; its rays of one sample are read together.
const TILE: u32 = 8;
/// The samples of a tile whose rays are read together: what a bundle takes once is shared by more of them, and they still
/// fit the cache.
const SAMPLES_AT_ONCE: u32 = 2;

/// The light that comes to the pixels of a picture.
#[derive(Clone, Debug)]
pub struct LightSums {
    size: [u32; 2],
    /// Row by row.
    sums: Vec<DVec3>,
    samples: u32,
    rays_cut_short: u64,
}

/// The progress of a picture.
#[derive(Clone, Copy, Debug)]
pub struct PictureProgress {
    /// The share of the tiles that are drawn.
    pub share: f32,
    /// The work on them, in operations, as [`Caster::operations`](crate::Caster::operations).
    pub operations: u64,
    /// The work that all tiles are expected to take: told once, when those that are drawn first are done, and only where
    /// they are enough to tell.
    pub expected: Option<u64>,
}

/// One tile of so many is drawn before the others: they are spread over the picture, and tell the work of all.
const DRAWN_FIRST: usize = 16;
/// Fewer tiles do not tell the work of all.
const LEAST_DRAWN_FIRST: usize = 256;

/// The tiles in the order in which they are drawn, and how many of them are spread over the picture.
fn tile_order(count: usize) -> (Vec<usize>, usize) {
    // In each run of tiles another one, so that they form no columns.
    let is_first = |tile: &usize| tile % DRAWN_FIRST == tile / DRAWN_FIRST * 5 % DRAWN_FIRST;
    let (mut order, rest): (Vec<usize>, Vec<usize>) = (0..count).partition(is_first);
    let first = order.len();
    order.extend(rest);
    (order, first)
}

/// The light of one tile, row by row, with its first pixel.
type Tile = ([u32; 2], Vec<DVec3>);

impl LightSums {
    /// A picture without samples.
    pub fn new(size: [u32; 2]) -> Self {
        Self {
            size,
            sums: vec![DVec3::ZERO; size[0] as usize * size[1] as usize],
            samples: 0,
            rays_cut_short: 0,
        }
    }

    /// The number of samples that each pixel has.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The number of rays that took more work than there may be, so that what they meet may be missing.
    pub fn rays_cut_short(&self) -> u64 {
        self.rays_cut_short
    }

    /// Adds the next samples, `count` for each pixel, whose light somebody else has summed: that of each pixel, row by row.
    ///
    /// # Panics
    /// If there is not one sum for each pixel.
    pub fn add_sums(&mut self, sums: &[DVec3], count: u32) {
        assert_eq!(sums.len(), self.sums.len(), "one sum for each pixel");
        for (sum, light) in self.sums.iter_mut().zip(sums) {
            *sum += light;
        }
        self.samples += count;
    }

    /// Adds the next samples, `count` for each pixel, on so many threads; `grid` is that of [`SampleAxes`]. `progress`
    /// is called after each tile, from any thread, and returns false to stop: then nothing is added.
    pub fn add(
        &mut self,
        scenery: &Scenery<'_>,
        camera: &LensCamera,
        grid: Option<u32>,
        count: u32,
        threads: usize,
        progress: &(dyn Fn(PictureProgress) -> bool + Sync),
    ) -> bool {
        let [columns, rows] = self.size.map(|side| side.div_ceil(TILE));
        let tiles = (columns * rows) as usize;
        let axes = SampleAxes::of(scenery, camera, grid);
        let frame = camera.frame(self.size);
        let next = AtomicUsize::new(0);
        let stopped = std::sync::atomic::AtomicBool::new(false);
        let (order, first) = tile_order(tiles);
        let [cut_short, operations, first_operations, first_once] =
            [const { AtomicU64::new(0) }; 4];
        let first_drawn = AtomicUsize::new(0);
        let drawn: Mutex<Vec<Tile>> = Mutex::new(Vec::with_capacity(tiles));
        let work = || {
            let mut tracer = LightTracer::new(scenery);
            let mut own: Vec<Tile> = Vec::new();
            let mut known = 0;
            let mut known_once = 0;
            while !stopped.load(Ordering::Relaxed) {
                let place = next.fetch_add(1, Ordering::Relaxed);
                let Some(&tile) = order.get(place) else {
                    break;
                };
                let corner = [tile as u32 % columns, tile as u32 / columns].map(|k| k * TILE);
                own.push((corner, self.tile(&mut tracer, axes, &frame, corner, count)));
                let so_far = tracer.operations();
                let new = so_far - std::mem::replace(&mut known, so_far);
                let mut expected = None;
                if place < first {
                    let so_far = tracer.operations_once();
                    let once = so_far - std::mem::replace(&mut known_once, so_far);
                    first_once.fetch_add(once, Ordering::Relaxed);
                    first_operations.fetch_add(new - once, Ordering::Relaxed);
                    // The last of them sees what the others have added.
                    let is_last = first_drawn.fetch_add(1, Ordering::AcqRel) + 1 == first;
                    let share = tiles as f64 / first as f64;
                    let sum = |of: &AtomicU64| of.load(Ordering::Relaxed);
                    expected = (is_last && first >= LEAST_DRAWN_FIRST)
                        .then(|| sum(&first_once) + (share * sum(&first_operations) as f64) as u64);
                }
                let progress = progress(PictureProgress {
                    share: (place + 1) as f32 / tiles as f32,
                    operations: operations.fetch_add(new, Ordering::Relaxed) + new,
                    expected,
                });
                if !progress {
                    stopped.store(true, Ordering::Relaxed);
                }
            }
            cut_short.fetch_add(tracer.rays_cut_short(), Ordering::Relaxed);
            drawn
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .extend(own);
        };
        run_on(threads.min(tiles), work);
        if stopped.load(Ordering::Relaxed) {
            return false;
        }
        for (corner, light) in drawn.into_inner().unwrap_or_else(PoisonError::into_inner) {
            for (pixel, light) in pixels(self.size, corner).zip(light) {
                self.sums[(pixel[1] * self.size[0] + pixel[0]) as usize] += light;
            }
        }
        self.samples += count;
        self.rays_cut_short += cut_short.into_inner();
        true
    }

    /// The means of the samples, linear, row by row.
    pub fn means(&self) -> impl ExactSizeIterator<Item = DVec3> + '_ {
        let share = 1.0 / f64::from(self.samples.max(1));
        self.sums.iter().map(move |sum| share * sum)
    }

    fn tile(
        &self,
        tracer: &mut LightTracer<'_>,
        axes: SampleAxes,
        camera: &CameraFrame,
        corner: [u32; 2],
        count: u32,
    ) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; pixels(self.size, corner).count()];
        let (mut samples, mut rays, mut eye_samples) = (Vec::new(), Vec::new(), Vec::new());
        let end = self.samples + count;
        for first in (self.samples..end).step_by(SAMPLES_AT_ONCE as usize) {
            samples.clear();
            rays.clear();
            eye_samples.clear();
            for sample in first..end.min(first.saturating_add(SAMPLES_AT_ONCE)) {
                samples.extend(
                    pixels(self.size, corner).map(|pixel| (pixel, axes.sample(pixel, sample))),
                );
            }
            camera.add_rays(tracer.processor(), &samples, &mut rays);
            let places = samples.iter().zip(&rays);
            eye_samples.extend(places.map(|((_, sample), ray)| camera.eye_sample(sample, ray)));
            tracer.begin_tile(rays.len());
            let lights = tracer.lights(&rays, &eye_samples);
            for lights in lights.chunks(sums.len().max(1)) {
                for (sum, light) in sums.iter_mut().zip(lights) {
                    *sum += *light;
                }
            }
        }
        sums
    }
}

/// The light of some samples, each of a pixel, on so many threads: what [`LightSums::add`] adds for them.
pub fn sample_light(
    scenery: &Scenery<'_>,
    camera: &LensCamera,
    grid: Option<u32>,
    size: [u32; 2],
    samples: &[([u32; 2], u32)],
    threads: usize,
) -> Vec<DVec3> {
    let axes = SampleAxes::of(scenery, camera, grid);
    let frame = camera.frame(size);
    let mut light = vec![DVec3::ZERO; samples.len()];
    let at_once = (TILE * TILE) as usize;
    let tiles = samples.chunks(at_once).zip(light.chunks_mut(at_once));
    let tiles = Mutex::new(tiles);
    run_on(threads, || {
        let mut tracer = LightTracer::new(scenery);
        let mut rays = Vec::new();
        let next = || tiles.lock().unwrap_or_else(PoisonError::into_inner).next();
        while let Some((samples, light)) = next() {
            tracer.begin_tile(samples.len());
            let samples = samples.iter();
            let samples: Vec<_> = samples
                .map(|&(pixel, sample)| (pixel, axes.sample(pixel, sample)))
                .collect();
            rays.clear();
            frame.add_rays(tracer.processor(), &samples, &mut rays);
            for (((_, sample), ray), light) in samples.iter().zip(&rays).zip(light) {
                *light = tracer.light(ray, frame.eye_sample(sample, ray));
            }
        }
    });
    light
}

impl CameraFrame {
    fn eye_sample(&self, sample: &Sample, ray: &Ray) -> EyeSample {
        EyeSample {
            light: sample.light,
            spread: sample.side * self.pixel_angle(ray.direction),
        }
    }
}

impl SampleAxes {
    /// The axes that a scenery needs through a camera.
    pub fn of(scenery: &Scenery<'_>, camera: &LensCamera, grid: Option<u32>) -> Self {
        Self {
            lens: camera.aperture > 0.0,
            lights: scenery.lights.iter().any(|light| light.size > 0.0),
            grid,
        }
    }
}

/// The pixels of a tile, row by row.
fn pixels(size: [u32; 2], [i, j]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let [right, bottom] = [(i + TILE).min(size[0]), (j + TILE).min(size[1])];
    (j..bottom).flat_map(move |j| (i..right).map(move |i| [i, j]))
}
