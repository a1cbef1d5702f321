//! Opens the window: `cargo run -p geotrace-preview --example window FILE [REPORT] [BACKEND] [SECONDS]`. The file `-`
//! stands for a server on standard input and output. Counters go to REPORT, one JSON object a line; the GPU is given up
//! after some seconds.

use std::process::ExitCode;
use std::time::Duration;

use preview::{Backend, Options, Source};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let given = |k: usize| arguments.get(k).map(String::as_str);
    let Some(file) = given(0) else {
        eprintln!("which file?");
        return ExitCode::from(2);
    };
    let options = Options {
        source: match file {
            "-" => Source::Attached,
            file => Source::File(file.into()),
        },
        backend: match given(2) {
            Some("gpu") => Backend::Gpu,
            Some("software") => Backend::Software,
            _ => Backend::Auto,
        },
        report: given(1).map(Into::into),
    };
    let loses = given(3).and_then(|seconds| seconds.parse().ok());
    let result = match loses.map(Duration::from_secs) {
        Some(after) => preview::run_and_lose_gpu(options, after),
        None => preview::run(options),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::FAILURE
        }
    }
}
