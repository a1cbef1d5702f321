//! The geodesic view's map against the thesis' method, on every example, at equal maximal error.

mod baseline;
mod moving;
mod spheres;

use std::time::Duration;

use geodesic::map::{Map, MapMethod, MapOptions, exponential_map};
use geodesic::reference::{Errors, Reference};
use rayon::{ThreadPool, ThreadPoolBuilder};
use testing::draw::scene;
use testing::examples::{self, Example};
use testing::inside::{Opening, opening};

use self::baseline::{Baseline, KINDS};
use crate::measure::{Times, processor_time};
use crate::thesis::Equations;

/// The error at which both are compared, in pixels.
const EQUAL: f64 = 0.25;
/// How many pixels a reference takes.
const SAMPLE: usize = 4096;
/// The sizes of the pictures.
const SIZES: [u32; 2] = [512, 1024];
/// What is to be reached: over the scalar baseline at each size, and over the SIMD one.
const TARGETS: [f64; 2] = [500.0, 1200.0];
const TARGET_SIMD: f64 = 60.0;
/// No smooth scene may be under this.
const LEAST: f64 = 200.0;
/// A scene is benign where the thesis' method needs no more steps than this.
const FEW: u32 = 64;
/// Tolerances that the fan is tried with, the loosest first: the first one that holds [`EQUAL`] is taken.
const TOLERANCES: [f64; 7] = [0.75, 0.5, 0.35, 0.25, 0.15, 0.1, 0.05];

/// Ours and the thesis' method on one scene at one size.
struct Row {
    name: String,
    tolerance: f64,
    one: Duration,
    all: Duration,
    map: Map,
    errors: Errors,
    baselines: Vec<Baseline>,
}

/// A pool of so many threads.
fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads can be started")
}

/// All cores.
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The view that an example opens with; `None` where it has no surface.
fn view(example: &Example) -> Option<Opening> {
    opening(&scene(&example.source))
}

/// Prints everything.
pub(crate) fn run() {
    println!(
        "The map of the geodesic view (u and v for each pixel, no colours) against the thesis' method"
    );
    println!(
        "Each at its loosest setting with at most {EQUAL} px of error at every pixel that it gets right; one thread \
         against one thread, in processor time. The thesis' method is timed on every few pixels and scaled: its pixels cost the same."
    );
    for (size, target) in SIZES.into_iter().zip(TARGETS) {
        println!();
        compare(size, target);
    }
    println!();
    moving::run();
    println!();
    spheres::run();
}

fn compare(size: u32, target: f64) {
    println!("{size} × {size} pixels");
    println!(
        "  {:14} {:>8} {:>8} {:>8} {:>7} {:>7} {:>6} {:>6} | {}",
        "scene",
        "1 thr ms",
        "all ms",
        "eval/px",
        "max px",
        "99 % px",
        "tol px",
        "rays",
        KINDS
            .iter()
            .map(|kind| format!("{:>26}", format!("{}: steps, ms, ratio", kind.name)))
            .collect::<Vec<_>>()
            .join(" ")
    );
    let rows: Vec<Row> = examples::all()
        .iter()
        .filter_map(|example| {
            let row = measure(example, size)?;
            print_row(&row);
            Some(row)
        })
        .collect();
    summary(&rows, target);
}

fn measure(example: &Example, size: u32) -> Option<Row> {
    let scene = scene(&example.source);
    let (view, equations) = (opening(&scene)?, Equations::of(&scene)?);
    let (surface, frame) = (view.surface(), view.frame());
    let mut reference = Reference::new(surface, &frame, [size; 2], SAMPLE);
    let make = |tolerance: f64| {
        let options = MapOptions {
            method: MapMethod::Fan,
            tolerance,
            by_pixel: false,
            ..MapOptions::default()
        };
        exponential_map(surface, &frame, [size; 2], &options, &|_| {})
    };
    let mut chosen = None;
    for tolerance in TOLERANCES {
        let map = make(tolerance);
        let errors = reference.errors(&|index| (map.uv(index), map.status[index]));
        let enough = errors.max <= EQUAL;
        chosen = Some((tolerance, map, errors));
        if enough {
            break;
        }
    }
    let (tolerance, map, errors) = chosen?;
    let one = pool(1).install(|| processor_time(|| make(tolerance)));
    let all = pool(cores()).install(|| Times::of(9, || make(tolerance)).median());
    let baselines = pool(1).install(|| baseline::measure(surface, &equations, &frame, size));
    Some(Row {
        name: example.name.clone(),
        tolerance,
        one,
        all,
        map,
        errors,
        baselines,
    })
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}

fn print_row(row: &Row) {
    let pixels = row.map.status.len() as f64;
    let columns: Vec<String> = row
        .baselines
        .iter()
        .map(|baseline| {
            let text = match baseline.steps {
                None => "never".to_owned(),
                Some(steps) => format!(
                    "{steps}{} {:9.0} {:7.0}",
                    if baseline.never > 0.0 { "*" } else { " " },
                    milliseconds(baseline.time),
                    baseline.time.as_secs_f64() / row.one.as_secs_f64()
                ),
            };
            format!("{text:>26}")
        })
        .collect();
    let mut notes = Vec::new();
    let worst = row.baselines.first().map_or(0.0, |baseline| baseline.never);
    if worst > 0.0 {
        notes.push(format!("* never right: {:.2} %", 100.0 * worst));
    }
    if row.map.work.followed > 0 {
        notes.push(format!("{} followed", row.map.work.followed));
    }
    let errors = &row.errors;
    for (count, what) in [
        (errors.unlike, "unlike"),
        (errors.beside, "beside a border"),
        (errors.unknown, "unknown"),
    ] {
        if count > 0 {
            notes.push(format!("{count} of {} {what}", errors.pixels));
        }
    }
    println!(
        "  {:14} {:8.2} {:8.2} {:8.4} {:7.3} {:7.3} {:6} {:6} | {} {}",
        row.name,
        milliseconds(row.one),
        milliseconds(row.all),
        row.map.work.evaluations as f64 / pixels,
        row.errors.max,
        row.errors.quantile(0.99),
        row.tolerance,
        row.map.work.rays,
        columns.join(" "),
        notes.join(", ")
    );
}

/// Geometric means of the ratios, and what is missed.
fn summary(rows: &[Row], target: f64) {
    let ratio = |row: &Row, simd: bool| -> Option<f64> {
        let best = row
            .baselines
            .iter()
            .zip(KINDS)
            .filter(|(baseline, kind)| kind.is_simd() == simd && baseline.steps.is_some())
            .map(|(baseline, _)| baseline.time.as_secs_f64())
            .min_by(f64::total_cmp)?;
        Some(best / row.one.as_secs_f64())
    };
    // Poles, tips and rims make steps of equal length short everywhere; without them it does best.
    let smooth = |row: &&Row| {
        let steps = |baseline: &Baseline| baseline.steps.is_some_and(|steps| steps <= FEW);
        row.baselines.iter().all(steps)
    };
    for (simd, name, target) in [(false, "scalar", target), (true, "SIMD", TARGET_SIMD)] {
        let of = |rows: &[&Row]| {
            let ratios: Vec<f64> = rows.iter().filter_map(|row| ratio(row, simd)).collect();
            (geometric_mean(&ratios), ratios.len())
        };
        let (all, count) = of(&rows.iter().collect::<Vec<_>>());
        let (benign, benign_count) = of(&rows.iter().filter(smooth).collect::<Vec<_>>());
        println!(
            "  geometric mean over the best {name} baseline: {all:.0} ({count} scenes; {benign:.0} for the \
             {benign_count} where {FEW} steps are enough for it); target {target}"
        );
    }
    let all_threads: Vec<f64> = rows
        .iter()
        .map(|row| row.one.as_secs_f64() / row.all.as_secs_f64())
        .collect();
    println!(
        "  {} threads are {:.2} times as fast as one (geometric mean)",
        cores(),
        geometric_mean(&all_threads)
    );
    let pixels: Vec<f64> = rows
        .iter()
        .map(|row| row.map.work.evaluations as f64 / row.map.status.len() as f64)
        .collect();
    println!(
        "  evaluations per pixel: geometric mean {:.4}",
        geometric_mean(&pixels)
    );
    let slow: Vec<String> = rows
        .iter()
        .filter_map(|row| Some((row, ratio(row, false)?)))
        .filter(|(_, ratio)| *ratio < LEAST)
        .map(|(row, ratio)| format!("{} ({ratio:.0})", row.name))
        .collect();
    if !slow.is_empty() {
        println!("  under {LEAST}: {}", slow.join(", "));
    }
    let missed: Vec<String> = rows
        .iter()
        .filter(|row| row.errors.max > EQUAL || row.errors.unlike > 0)
        .map(|row| format!("{} ({})", row.name, row.errors))
        .collect();
    if !missed.is_empty() {
        println!(
            "  ours is not within {EQUAL} px everywhere: {}",
            missed.join("; ")
        );
    }
}

/// The geometric mean; NaN of nothing.
fn geometric_mean(values: &[f64]) -> f64 {
    let sum: f64 = values.iter().map(|value| value.ln()).sum();
    (sum / values.len() as f64).exp()
}
