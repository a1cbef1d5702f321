//! Gives fuzz targets any number of inputs: `cargo run --release -p geotrace-fuzz -- [TARGET…] [--count N] [--seed S]`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use fuzz::{TARGETS, Target, run};

/// Fuzz targets: each is given mutated inputs, and an input at which it panics is written to a file.
#[derive(Debug, Parser)]
struct Arguments {
    /// The targets; all of them if none is named
    targets: Vec<String>,
    /// The number of inputs of each target; ten times that of the tests if it is not given
    #[arg(long, value_name = "N")]
    count: Option<u64>,
    /// The beginning of the sequence of inputs
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Run one input from a file instead
    #[arg(long, value_name = "FILE")]
    input: Option<PathBuf>,
    /// The folder for inputs that fail
    #[arg(long, value_name = "FOLDER", default_value = "target/fuzz")]
    findings: PathBuf,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let mut targets: Vec<&Target> = Vec::new();
    for name in &arguments.targets {
        let Some(target) = fuzz::target(name) else {
            let names: Vec<&str> = TARGETS.iter().map(|it| it.name).collect();
            eprintln!(
                "error: there is no target `{name}`; there are {}",
                names.join(", ")
            );
            return ExitCode::from(2);
        };
        targets.push(target);
    }
    if targets.is_empty() {
        targets = TARGETS.iter().collect();
    }
    if let Some(path) = &arguments.input {
        return run_file(&targets, path);
    }
    println!(
        "{:<12} {:>9} {:>9} {:>10} {:>12}",
        "target", "inputs", "failures", "seconds", "slowest, ms"
    );
    let mut failures = 0;
    for target in targets {
        let start = Instant::now();
        let count = arguments.count.unwrap_or(10 * target.tested);
        let report = run::run(target, arguments.seed, count);
        println!(
            "{:<12} {:>9} {:>9} {:>10.1} {:>12.1}",
            target.name,
            report.inputs,
            report.failures.len(),
            start.elapsed().as_secs_f64(),
            1e3 * report.slowest.as_secs_f64()
        );
        failures += report.failures.len();
        for (k, input) in report.failures.iter().enumerate() {
            keep(
                &arguments.findings,
                target,
                &format!("{}-{k}", arguments.seed),
                input,
            );
        }
        keep(
            &arguments.findings,
            target,
            "slowest",
            &report.slowest_input,
        );
    }
    ExitCode::from(u8::from(failures > 0))
}

fn run_file(targets: &[&Target], path: &Path) -> ExitCode {
    let input = match std::fs::read(path) {
        Ok(input) => input,
        Err(error) => {
            eprintln!("error: cannot read `{}`: {error}", path.display());
            return ExitCode::from(2);
        }
    };
    for target in targets {
        (target.run)(&input);
        println!("{}: passed", target.name);
    }
    ExitCode::SUCCESS
}

/// Writes an input to the folder of findings.
fn keep(folder: &Path, target: &Target, name: &str, input: &[u8]) {
    let path = folder.join(format!("{}-{name}", target.name));
    let written = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&path, input));
    match written {
        Ok(()) if name == "slowest" => {}
        Ok(()) => println!(
            "  again: geotrace-fuzz {} --input {}",
            target.name,
            path.display()
        ),
        Err(error) => eprintln!("error: cannot write `{}`: {error}", path.display()),
    }
}
