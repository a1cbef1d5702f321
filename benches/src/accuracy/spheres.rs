//! The thesis' sphere from many places: pixels that are off by more than a pixel, against great circles.

use geodesic::map::{MapMethod, MapOptions, exponential_map};
use rayon::prelude::*;
use testing::great_circles::{Sphere, wrong_pixels};

/// Cameras beside the poles.
const CAMERAS: u64 = 10_000;
/// Pixels along a side.
const SIZE: u32 = 64;

/// Prints how many pixels are wrong.
pub(super) fn run() {
    let sphere = Sphere::new();
    let options = MapOptions {
        method: MapMethod::Fan,
        by_pixel: false,
        ..MapOptions::default()
    };
    let looks = |camera: u64| {
        let frame = sphere.camera(camera);
        let map = exponential_map(sphere.surface(), &frame, [SIZE; 2], &options, &|_| {});
        wrong_pixels(&sphere, &frame, &map)
    };
    // The first two cameras stand on the poles.
    let tallies: Vec<_> = (0..CAMERAS + 2).into_par_iter().map(looks).collect();
    let wrong: usize = tallies.iter().map(|tally| tally.wrong).sum();
    let worst = tallies.iter().map(|tally| tally.worst).fold(0.0, f64::max);
    println!(
        "The sphere of examples/sphere.gtr from {CAMERAS} seeded cameras and from both poles, {SIZE} × {SIZE} pixels: \
         {wrong} of {} pixels off by more than 1 px; the largest error is {worst:.3} px",
        (CAMERAS + 2) * u64::from(SIZE * SIZE)
    );
}
