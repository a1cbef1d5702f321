//! Gives fuzz targets and attacks any number of inputs: `cargo run --release -p geotrace-fuzz -- [NAME…] [--count N] [--full]`.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use clap::Parser;
use fuzz::run::{self, Report};
use fuzz::{ATTACKS, Attack, TARGETS, Target, memory};

/// Fuzz targets and attacks: each is given inputs, and one at which something is wrong is written to a file.
#[derive(Debug, Parser)]
struct Arguments {
    /// The targets and attacks, before all options; all of them if none is named
    names: Vec<String>,
    /// The number of inputs of each; ten times that of the tests if it is not given
    #[arg(long, value_name = "N")]
    count: Option<u64>,
    /// The numbers of inputs of a whole attack, which takes about half an hour
    #[arg(long, conflicts_with = "count")]
    full: bool,
    /// Go on, with one sequence of inputs after the other, for so many minutes for each
    #[arg(long, value_name = "M", conflicts_with_all = ["count", "full"])]
    minutes: Option<f64>,
    /// The beginning of the sequence of inputs
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Run one input of targets from a file instead
    #[arg(long, value_name = "FILE")]
    input: Option<PathBuf>,
    /// Print rows without a head
    #[arg(long, hide = true)]
    headless: bool,
    /// The folder for inputs that fail
    #[arg(long, value_name = "FOLDER", default_value = "target/fuzz")]
    findings: PathBuf,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
enum Row {
    Target(&'static Target),
    Attack(&'static Attack),
}

impl Row {
    fn all() -> impl Iterator<Item = Self> {
        let targets = TARGETS.iter().map(Self::Target);
        targets.chain(ATTACKS.iter().map(Self::Attack))
    }

    fn name(self) -> &'static str {
        match self {
            Self::Target(it) => it.name,
            Self::Attack(it) => it.name,
        }
    }

    fn about(self) -> &'static str {
        match self {
            Self::Target(it) => it.about,
            Self::Attack(it) => it.about,
        }
    }

    fn count(self, arguments: &Arguments) -> u64 {
        let (tested, full) = match self {
            Self::Target(it) => (it.tested, it.full),
            Self::Attack(it) => (it.tested, it.full),
        };
        let usual = if arguments.full { full } else { 10 * tested };
        arguments.count.unwrap_or(usual)
    }

    fn run(self, seed: u64, count: u64) -> Report {
        match self {
            Self::Target(it) => run::run(it, seed, count),
            Self::Attack(it) => (it.run)(seed, count),
        }
    }
}

/// The name by which this program is the one that is attacked.
const ATTACKED: &str = "geotrace";

fn main() -> ExitCode {
    let own = std::env::args_os().next().unwrap_or_default();
    if Path::new(&own).file_stem() == Some(OsStr::new(ATTACKED)) {
        return cli::run(&cli::Registry::standard());
    }
    let arguments = Arguments::parse();
    let mut rows: Vec<Row> = Vec::new();
    for name in &arguments.names {
        let Some(row) = Row::all().find(|row| row.name() == name) else {
            let names: Vec<&str> = Row::all().map(Row::name).collect();
            eprintln!(
                "error: there is no `{name}`; there are {}",
                names.join(", ")
            );
            return ExitCode::from(2);
        };
        rows.push(row);
    }
    if rows.is_empty() {
        rows = Row::all().collect();
    }
    if let Some(path) = &arguments.input {
        return run_file(&rows, path);
    }
    let folder = match attacked() {
        Ok(folder) => folder,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(2);
        }
    };
    if !arguments.headless {
        println!(
            "| name | what holds | inputs | failures | slowest, ms | peak memory, MB | seconds |"
        );
        println!("| --- | --- | --: | --: | --: | --: | --: |");
    }
    let is_fine = |row: &Row| match rows.len() {
        1 => print(*row, &arguments) == 0,
        _ => print_in_child(*row),
    };
    let failed = rows.iter().filter(|row| !is_fine(row)).count();
    drop(folder);
    ExitCode::from(u8::from(failed > 0))
}

/// Gives this program the name of the one that is attacked, for as long as the folder is there.
fn attacked() -> std::io::Result<tempfile::TempDir> {
    let folder = tempfile::tempdir()?;
    let name = format!("{ATTACKED}{}", std::env::consts::EXE_SUFFIX);
    let path = folder.path().join(name);
    let own = std::env::current_exe()?;
    std::fs::hard_link(&own, &path).or_else(|_| std::fs::copy(&own, &path).map(drop))?;
    testing::binary::use_binary(path);
    Ok(folder)
}

/// Runs a row in a process of its own, so that its peak of memory is its own; true if nothing has failed.
fn print_in_child(row: Row) -> bool {
    let given = std::env::args_os().skip(1);
    let options = given.skip_while(|it| !it.as_encoded_bytes().starts_with(b"-"));
    let child = std::env::current_exe().and_then(|own| {
        let mut command = Command::new(own);
        command.args([row.name(), "--headless"]).args(options);
        command.status()
    });
    child.is_ok_and(|status| status.success())
}

/// Runs a row and prints it; the number of failures.
fn print(row: Row, arguments: &Arguments) -> usize {
    let count = row.count(arguments);
    if count == 0 {
        return 0;
    }
    let start = Instant::now();
    let mut report = row.run(arguments.seed, count);
    let seconds = 60.0 * arguments.minutes.unwrap_or(0.0);
    for seed in arguments.seed.saturating_add(1).. {
        if start.elapsed().as_secs_f64() >= seconds || report.is_hopeless() {
            break;
        }
        report.add(row.run(seed, count));
    }
    // Where the program has run in processes of its own, the memory of the row is theirs.
    let peak = match report.peak {
        0 => memory::peak(),
        peak => peak,
    };
    println!(
        "| {} | {} | {} | {} | {:.0} | {:.0} | {:.0} |",
        row.name(),
        row.about(),
        report.inputs,
        report.failures.len(),
        1e3 * report.slowest.as_secs_f64(),
        peak as f64 / 1e6,
        start.elapsed().as_secs_f64(),
    );
    for (k, input) in report.failures.iter().enumerate() {
        keep(
            &arguments.findings,
            row,
            &format!("{}-{k}", arguments.seed),
            input,
        );
    }
    keep(&arguments.findings, row, "slowest", &report.slowest_input);
    report.failures.len()
}

fn run_file(rows: &[Row], path: &Path) -> ExitCode {
    let input = match std::fs::read(path) {
        Ok(input) => input,
        Err(error) => {
            eprintln!("error: cannot read `{}`: {error}", path.display());
            return ExitCode::from(2);
        }
    };
    for row in rows {
        if let Row::Target(target) = row {
            (target.run)(&input);
            println!("{}: passed", target.name);
        }
    }
    ExitCode::SUCCESS
}

/// Writes an input to the folder of findings.
fn keep(folder: &Path, row: Row, name: &str, input: &[u8]) {
    let path = folder.join(format!("{}-{name}", row.name().replace(' ', "-")));
    let written = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&path, input));
    match written {
        Ok(()) if name == "slowest" => {}
        Ok(()) => println!("  failed: {}", path.display()),
        Err(error) => eprintln!("error: cannot write `{}`: {error}", path.display()),
    }
}
