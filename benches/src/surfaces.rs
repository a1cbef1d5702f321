//! Implicit surfaces of the literature: a ray for each pixel of 640 × 480, on two threads, with the processor's time of both
//! together, which other programs do not lengthen.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use glam::{DAffine3, DVec3};
use tracer::{Ray, SetStep, World, WorldBuilder};

#[path = "../../crates/expr/tests/suite/formula/mod.rs"]
mod formula;
#[path = "../../crates/tracer/tests/suite/scenes/mod.rs"]
mod scenes;

use crate::measure::thread_clock;

const SIZE: [usize; 2] = [640, 480];
/// The side of the tiles of a picture, whose rays are cast together.
const TILE: usize = 8;

pub(crate) fn run() {
    let variables = formula::variables();
    let surfaces = scenes::surfaces::surfaces(&variables);
    let graph = variables[0].graph().clone();
    println!("Implicit surfaces, 640 × 480, two threads");
    println!(
        "  {:18} {:>6} {:>9} {:>9} {:>9} {:>12}",
        "surface", "degree", "build ms", "cast ms", "both ms", "intervals/ray"
    );
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    for (name, formula, half) in surfaces {
        let start = Instant::now();
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let Ok(shape) = builder.shape(formula.node(), [Some([-half, half]); 3]) else {
            continue;
        };
        let solid = builder.solid([SetStep::Leaf(shape, DAffine3::IDENTITY)]);
        let Ok(world) = solid.and_then(|_| builder.build()) else {
            continue;
        };
        let build = ms(start.elapsed());
        let start = Instant::now();
        let (evaluations, both) = cast(&world, half);
        let cast = ms(start.elapsed());
        let degree = world.degree(0).map_or("–".to_owned(), |d| d.to_string());
        println!(
            "  {name:18} {degree:>6} {build:>9.1} {cast:>9.1} {:>9.1} {:>12.2}",
            ms(both),
            evaluations as f64 / (SIZE[0] * SIZE[1]) as f64
        );
    }
}

/// Returns the number of evaluations on intervals, and the processor's time.
fn cast(world: &World, half: f64) -> (u64, Duration) {
    let eye = DVec3::new(2.2, -3.4, 1.8) * half;
    let forward = -eye.normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let ray = |i: usize, j: usize| {
        let x = (i as f64 + 0.5 - 0.5 * SIZE[0] as f64) / SIZE[1] as f64;
        let y = (0.5 * SIZE[1] as f64 - j as f64 - 0.5) / SIZE[1] as f64;
        Ray {
            origin: eye,
            direction: (forward + x * 0.8 * right + y * 0.8 * up).normalize(),
            leaving: None,
        }
    };
    let rows = Mutex::new((0..SIZE[1]).step_by(TILE));
    // A thread takes the next row of tiles.
    let work = || {
        let start = thread_clock();
        let mut caster = world.caster();
        let mut rays = Vec::new();
        let next = || rows.lock().ok().and_then(|mut rows| rows.next());
        while let Some(row) = next() {
            for from in (0..SIZE[0]).step_by(TILE) {
                rays.clear();
                for j in row..(row + TILE).min(SIZE[1]) {
                    rays.extend((from..from + TILE).map(|i| ray(i, j)));
                }
                caster.begin_bundle(&rays);
                for k in 0..rays.len() {
                    std::hint::black_box(caster.first_of_bundle(k));
                }
            }
        }
        (
            caster.interval_evaluations(),
            thread_clock().saturating_sub(start),
        )
    };
    std::thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        threads
            .into_iter()
            .filter_map(|thread| thread.join().ok())
            .fold((0, Duration::ZERO), |(n, t), (m, s)| (n + m, t + s))
    })
}
