//! Measures casting.
//!
//! `surfaces [NAME [FOLDER]]` casts a ray for each pixel of 640 × 480 at each implicit surface of the tests whose name
//! contains `NAME`, on two threads, and prints the time that it takes and the processor's time of both threads together,
//! which other programs do not lengthen; with a folder it writes pictures there. `csg [RAYS]` casts rays at random trees and
//! compares every crossing with the membership of points. `pictures [NAME]` draws pictures on one thread.

use std::sync::Mutex;
use std::time::Instant;

use glam::{DAffine3, DVec3};
use tracer::{Ray, SetStep, World, WorldBuilder};

#[path = "../../../expr/tests/formula/mod.rs"]
mod formula;
mod pictures;
#[path = "../../tests/scenes/mod.rs"]
mod scenes;
use formula::variables;
use scenes::surfaces::surfaces;
use scenes::{Random, shapes};

const SIZE: [usize; 2] = [640, 480];
/// The side of the tiles of a picture, whose rays are read together.
const TILE: usize = 8;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("csg") => csg(arguments
            .get(1)
            .and_then(|n| n.parse().ok())
            .unwrap_or(10_000)),
        Some("surfaces") => {
            let wanted = arguments.get(1).map_or("", String::as_str);
            all_surfaces(wanted, arguments.get(2));
        }
        Some("pictures") => pictures::pictures(arguments.get(1).map_or("", String::as_str)),
        _ => eprintln!("measure surfaces [NAME [FOLDER]] | csg [RAYS] | pictures [NAME]"),
    }
}

fn all_surfaces(wanted: &str, folder: Option<&String>) {
    let variables = variables();
    let surfaces = surfaces(&variables);
    let graph = variables[0].graph().clone();
    println!(
        "{:18} {:>6} {:>9} {:>9} {:>9} {:>12}",
        "surface", "degree", "build ms", "cast ms", "both ms", "intervals/ray"
    );
    for (name, formula, half) in surfaces {
        if !name.contains(wanted) {
            continue;
        }
        let start = Instant::now();
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let Ok(shape) = builder.shape(formula.node(), [Some([-half, half]); 3]) else {
            continue;
        };
        let solid = builder.solid([SetStep::Leaf(shape, DAffine3::IDENTITY)]);
        let Ok(world) = solid.and_then(|_| builder.build()) else {
            continue;
        };
        let build = start.elapsed();
        let start = Instant::now();
        let (pixels, evaluations, both) = picture(&world, half);
        let cast = start.elapsed();
        let degree = world.degree(0).map_or("–".to_owned(), |d| d.to_string());
        println!(
            "{name:18} {degree:>6} {:>9.1} {:>9.1} {both:>9.1} {:>12.2}",
            build.as_secs_f64() * 1e3,
            cast.as_secs_f64() * 1e3,
            evaluations as f64 / (SIZE[0] * SIZE[1]) as f64
        );
        if let Some(folder) = folder {
            let mut file = format!("P5 {} {} 255\n", SIZE[0], SIZE[1]).into_bytes();
            file.extend(pixels);
            let path = std::path::Path::new(folder).join(format!("{}.pgm", name.replace(' ', "-")));
            if let Err(error) = std::fs::write(&path, file) {
                eprintln!("{}: {error}", path.display());
            }
        }
    }
}

/// The brightness of each pixel, the number of evaluations on intervals, and the processor's time in milliseconds.
fn picture(world: &World, half: f64) -> (Vec<u8>, u64, f64) {
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
    let mut pixels = vec![0; SIZE[0] * SIZE[1]];
    let rows = Mutex::new(pixels.chunks_mut(TILE * SIZE[0]).enumerate());
    // A thread takes the next row of tiles.
    let draw = || {
        let mut caster = world.caster();
        let mut rays = Vec::new();
        loop {
            let next = rows.lock().ok().and_then(|mut rows| rows.next());
            let Some((row, pixels)) = next else { break };
            for from in (0..SIZE[0]).step_by(TILE) {
                let places: Vec<[usize; 2]> = (0..pixels.len() / SIZE[0])
                    .flat_map(|j| (from..from + TILE).map(move |i| [i, j]))
                    .collect();
                rays.clear();
                rays.extend(places.iter().map(|&[i, j]| ray(i, row * TILE + j)));
                caster.begin_bundle(&rays);
                for (k, [i, j]) in places.into_iter().enumerate() {
                    if let Some(hit) = caster.first_of_bundle(k) {
                        let light = hit.normal.dot(DVec3::new(0.3, -0.5, 0.8)).max(0.0);
                        pixels[j * SIZE[0] + i] = (50.0 + 200.0 * light) as u8;
                    }
                }
            }
        }
        (caster.interval_evaluations(), processor_time())
    };
    let (evaluations, both) = std::thread::scope(|scope| {
        let threads = [scope.spawn(draw), scope.spawn(draw)];
        threads
            .into_iter()
            .filter_map(|thread| thread.join().ok())
            .fold((0, 0.0), |(n, t), (m, s)| (n + m, t + s))
    });
    (pixels, evaluations, both)
}

/// The time in milliseconds that this thread has run; 0 where the system does not say.
fn processor_time() -> f64 {
    let read = std::fs::read_to_string("/proc/thread-self/schedstat");
    let first = read
        .ok()
        .and_then(|text| text.split(' ').next()?.parse().ok());
    first.map_or(0.0, |nanoseconds: f64| nanoseconds * 1e-6)
}

fn csg(rays: usize) {
    let mut random = Random(2026);
    let variables = variables();
    let formulas = shapes(&variables);
    let graph = formulas[0].graph().clone();
    let (mut crossings, mut checks, mut wrong, mut seconds) = (0, 0, 0, 0.0);
    let trees = rays.div_ceil(1000).max(1);
    for _ in 0..trees {
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let ids: Vec<_> = formulas
            .iter()
            .filter_map(|f| builder.shape(f.node(), [None; 3]).ok())
            .collect();
        let steps = random.tree(&ids, 12, 1.2);
        let Ok(world) = builder.solid(&steps).and_then(|_| builder.build()) else {
            continue;
        };
        let mut caster = world.caster();
        for _ in 0..1000.min(rays) {
            let direction = random.direction();
            let ray = Ray {
                origin: random.vector(1.2) - 6.0 * direction,
                direction,
                leaving: None,
            };
            let start = Instant::now();
            let found = caster.cast(&ray);
            seconds += start.elapsed().as_secs_f64();
            crossings += found.len();
            // Between two crossings, and on both sides of each.
            let mut ts = vec![0.0];
            ts.extend(found.iter().map(|crossing| crossing.t));
            ts.push(14.0);
            for (k, pair) in ts.windows(2).enumerate() {
                let said = if k == 0 {
                    found.first().is_some_and(|first| !first.entering)
                } else {
                    found[k - 1].entering
                };
                let step = 1e-5f64.min(0.25 * (pair[1] - pair[0]));
                for t in [pair[0] + step, 0.5 * (pair[0] + pair[1]), pair[1] - step] {
                    let point = ray.origin + t * direction;
                    checks += 1;
                    if world.contains(0, point) != said && decided(&world, point) {
                        wrong += 1;
                        println!("{ray:?} at {t}");
                    }
                }
            }
        }
    }
    println!(
        "{} rays on {trees} trees: {crossings} crossings, {checks} memberships, {wrong} disagreements, {:.2} µs a ray",
        trees * 1000.min(rays),
        seconds * 1e6 / (trees * 1000.min(rays)) as f64
    );
}

/// True if the points around are all inside or all outside.
fn decided(world: &World, point: DVec3) -> bool {
    let here = world.contains(0, point);
    (0..27).all(|k| {
        let offset = DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9)) - 1.0;
        world.contains(0, point + 1e-5 * offset) == here
    })
}
