//! Opens the window on a file: `cargo run -p geotrace-preview --example window FILE [REPORT]`. Counters go to REPORT,
//! one JSON object a line.

use std::path::PathBuf;

fn main() -> std::process::ExitCode {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let Some(file) = arguments.next() else {
        eprintln!("which file?");
        return std::process::ExitCode::from(2);
    };
    let options = preview::Options {
        source: preview::Source::File(file),
        backend: preview::Backend::Auto,
        report: arguments.next(),
    };
    match preview::run(options) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            std::process::ExitCode::FAILURE
        }
    }
}
