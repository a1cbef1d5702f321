//! Frames while the camera moves: ends and colours in software, on all cores.

use std::time::{Duration, Instant};

use geodesic::trace::Options;
use render::geodesic_view::Paint;
use render::texture::{Proportions, Texture};
use testing::examples;

use super::{milliseconds, pool, view};

/// How many cores a frame may use.
const CORES: usize = 2;
/// Frames of one walk.
const FRAMES: usize = 40;
/// The walk's step, in units of the zoom.
const STEP: f64 = 0.01;
/// The target, in milliseconds.
const TARGET: f64 = 16.0;

/// Prints the table.
pub(super) fn run() {
    println!(
        "A frame while moving, 512 × 512 pixels, {CORES} cores, the camera carried along, {FRAMES} frames: ms \
         (medians, and the greatest); target {TARGET}"
    );
    println!(
        "  {:14} {:>8} {:>8} {:>8} {:>8}",
        "scene", "ends", "colours", "frame", "greatest"
    );
    let texture = Texture::orientation(Proportions::Even, false);
    let pool = pool(CORES);
    let mut missed = Vec::new();
    for example in examples::all() {
        let Some(opening) = view(&example) else {
            continue;
        };
        let mut inside = opening.inside.moving();
        let ground = inside.manifold().clone();
        let surface = ground.surface();
        let paint = Paint {
            texture: &texture,
            colour: [1.0; 3],
            domain: surface.domain(),
            sides: surface.sides(),
            mark_centre: true,
            coarse: true,
        };
        let mut times: Vec<[Duration; 3]> = Vec::new();
        for _ in 0..FRAMES {
            let start = Instant::now();
            let moved = inside
                .frame
                .advance(surface, [STEP, 0.3 * STEP], &Options::default());
            if let Ok((next, _)) = moved {
                inside.frame = next;
            }
            let seen = pool.install(|| inside.ends(&|_| {}));
            let at_ends = start.elapsed();
            std::hint::black_box(pool.install(|| seen.resolve(&paint)));
            let whole = start.elapsed();
            times.push([at_ends, whole - at_ends, whole]);
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
