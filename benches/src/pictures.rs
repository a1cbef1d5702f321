//! Pictures, each drawn in a process of its own.

use std::process::{Command, ExitCode};
use std::sync::Arc;
use std::time::{Duration, Instant};

use render::Backend;
use scene::ParamValues;
use testing::draw::surfaces;
use testing::examples;

use crate::measure::{Times, megabytes, peak_memory};
use testing::wanted::Wanted;

/// Programs that are no examples.
const LARGE: &[(&str, &str)] = &[
    (
        "surface of 1000 × 1000 samples",
        "surface s(u,v) = ((1 + 0.4cos v) cos u, (1 + 0.4cos v) sin u, 0.4sin v), \
         u : [0, 2pi, 1000], v : [0, 2pi, 1000];",
    ),
    (
        "grid of 100,000 vectors",
        "grid k : [-1, 1, 50], [-1, 1, 50], [-1, 1, 40];\n\
         vector w = (-k_2, k_1, 0)/20 @ k;",
    ),
];

/// Draws a picture, and prints its time in seconds and the peak memory in bytes: `child NAME VIEW BACKEND`.
pub(crate) fn child(arguments: &[String]) -> ExitCode {
    let [name, view, backend] = arguments else {
        eprintln!("child NAME VIEW BACKEND");
        return ExitCode::from(2);
    };
    let large = LARGE.iter().find(|(title, _)| title == name);
    let source = large.map_or_else(
        || examples::one(name).source,
        |(_, source)| (*source).to_owned(),
    );
    let start = Instant::now();
    let Some(scene) = scene::geotrace::compile(&source).scene.map(Arc::new) else {
        eprintln!("{name} has errors");
        return ExitCode::from(1);
    };
    let request = match surfaces(&scene).first() {
        Some(surface) if view == "geodesic" => Wanted::geodesic(*surface, [512, 512]),
        _ => Wanted::space([512, 512]),
    };
    let backend = if backend == "gpu" {
        Backend::Gpu
    } else {
        Backend::Software
    };
    let request = Wanted { backend, ..request };
    match request.draw(&scene, &ParamValues::initial(&scene)) {
        Ok(picture) => {
            println!(
                "{} {} {}",
                start.elapsed().as_secs_f64(),
                peak_memory(),
                picture.backend
            );
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{name}: {error}");
            ExitCode::from(1)
        }
    }
}

/// What several runs of a child gave.
struct Drawn {
    times: Times,
    peak: u64,
    backend: String,
}

fn draw(name: &str, view: &str, backend: &str, runs: usize) -> Result<Drawn, String> {
    let own = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut times = Vec::new();
    let (mut peak, mut by) = (0, String::new());
    for _ in 0..runs {
        let output = Command::new(&own)
            .args(["child", name, view, backend])
            .output()
            .map_err(|error| error.to_string())?;
        let text = String::from_utf8_lossy(&output.stdout);
        let mut words = text.trim().splitn(3, ' ');
        let (Some(seconds), Some(bytes)) = (
            words.next().and_then(|word| word.parse::<f64>().ok()),
            words.next().and_then(|word| word.parse::<u64>().ok()),
        ) else {
            return Err(String::from_utf8_lossy(&output.stderr).trim().to_owned());
        };
        times.push(Duration::from_secs_f64(seconds));
        peak = peak.max(bytes);
        words.next().unwrap_or("").clone_into(&mut by);
    }
    Ok(Drawn {
        times: Times::new(times),
        peak,
        backend: by,
    })
}

fn row(name: &str, view: &str, backend: &str, runs: usize) {
    match draw(name, view, backend, runs) {
        Ok(drawn) => println!(
            "  {name:32} {view:9} {backend:9} {:44} {:7.1} MB  ({})",
            drawn.times.to_string(),
            megabytes(drawn.peak),
            drawn.backend
        ),
        Err(error) => println!("  {name:32} {view:9} {backend:9} failed: {error}"),
    }
}

/// Prints the table of all examples.
pub(crate) fn examples() {
    println!(
        "Pictures of 512 × 512 pixels, each in a process of its own: from the text to the picture"
    );
    for example in examples::all() {
        let inside = scene::geotrace::compile(&example.source)
            .scene
            .is_some_and(|scene| !surfaces(&scene).is_empty());
        for view in ["3d", "geodesic"] {
            if view == "geodesic" && !inside {
                continue;
            }
            for backend in ["software", "gpu"] {
                row(&example.name, view, backend, 3);
            }
        }
    }
}

/// Prints the table of large scenes.
pub(crate) fn large() {
    println!("Large scenes, 512 × 512 pixels");
    for (name, _) in LARGE {
        for backend in ["software", "gpu"] {
            row(name, "3d", backend, 5);
        }
    }
}
