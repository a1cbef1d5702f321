//! Frames while the camera moves: map and colours in software, on all cores.

use std::time::{Duration, Instant};

use geodesic::map::{MapOptions, Method, exponential_map};
use geodesic::trace::Options;
use render::geodesic_view::{Paint, resolve};
use render::texture::Texture;
use testing::examples;

use super::{milliseconds, pool, view};

/// How many cores a frame may use.
const CORES: usize = 2;
/// Frames of one walk.
const FRAMES: usize = 40;
/// The walk's step, in units of the zoom.
const STEP: f64 = 0.01;
/// The error that is allowed while the picture moves, in pixels.
const TOLERANCE: f64 = 0.5;
/// The target, in milliseconds.
const TARGET: f64 = 16.0;

/// Prints the table.
pub(super) fn run() {
    println!(
        "A frame while moving, 512 × 512 pixels, {CORES} cores, tolerance {TOLERANCE} px, {FRAMES} frames: ms \
         (median, greatest); target {TARGET}"
    );
    println!(
        "  {:14} {:>8} {:>8} {:>8} {:>8}",
        "scene", "map", "colours", "frame", "greatest"
    );
    let texture = Texture::orientation();
    let mut missed = Vec::new();
    for example in examples::all() {
        let Some(opening) = view(&example) else {
            continue;
        };
        let surface = opening.surface.as_ref();
        let mut frame = opening.frame;
        let options = MapOptions {
            method: Method::Fan,
            tolerance: TOLERANCE,
            ..MapOptions::default()
        };
        let paint = Paint {
            texture: &texture,
            colour: [1.0; 3],
            domain: surface.domain(),
            sides: surface.sides(),
            mark_centre: false,
        };
        let mut times: Vec<[Duration; 3]> = Vec::new();
        let pool = pool(CORES);
        for _ in 0..FRAMES {
            let start = Instant::now();
            let moved = frame.advance(surface, [STEP, 0.3 * STEP], &Options::default());
            let (map, at_map) = pool.install(|| {
                let map = exponential_map(surface, &frame, [512; 2], &options, &|_| {});
                let at_map = start.elapsed();
                std::hint::black_box(resolve(&map, &paint));
                (map, at_map)
            });
            std::hint::black_box(map);
            let whole = start.elapsed();
            times.push([at_map, whole - at_map, whole]);
            if let Ok((next, _)) = moved {
                frame = next;
            }
        }
        let column = |k: usize| {
            let mut column: Vec<Duration> = times.iter().map(|times| times[k]).collect();
            column.sort_unstable();
            (column[column.len() / 2], column[column.len() - 1])
        };
        let whole = column(2);
        println!(
            "  {:14} {:8.2} {:8.2} {:8.2} {:8.2}",
            example.name,
            milliseconds(column(0).0),
            milliseconds(column(1).0),
            milliseconds(whole.0),
            milliseconds(whole.1)
        );
        if milliseconds(whole.0) > TARGET {
            missed.push(format!("{} ({:.1})", example.name, milliseconds(whole.0)));
        }
    }
    if !missed.is_empty() {
        println!("  over {TARGET} ms: {}", missed.join(", "));
    }
}
