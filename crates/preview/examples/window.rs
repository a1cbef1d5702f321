//! Opens the window: `cargo run -p geotrace-preview --example window FILE [REPORT [BACKEND [FAULT…]]]`. The file `-`
//! stands for a server on standard input and output. Counters go to REPORT, one JSON object a line. A FAULT of the GPU is
//! `lose=SIGN`: it is given up when there is a file SIGN, once, or as often as this stands there; `lose-in-frame=SIGN`:
//! the same, when a frame is laid out and not yet painted; or `refuse`: it refuses the shaders of samples.

use std::process::ExitCode;

use preview::{Backend, Faults, Options, Source};

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
        ending: preview::Ending::default(),
        languages: ide::Languages::standard(),
        views: render::Views::standard(),
        backend: match given(2) {
            Some("gpu") => Backend::Gpu,
            Some("software") => Backend::Software,
            _ => Backend::Auto,
        },
        report: given(1).map(Into::into),
    };
    let mut faults = Faults::default();
    for fault in arguments.iter().skip(3) {
        match fault.split_once('=') {
            Some((loss @ ("lose" | "lose-in-frame"), sign)) => {
                faults.loses_gpu = Some(sign.into());
                faults.loses_in_frame = loss == "lose-in-frame";
                faults.losses += 1;
            }
            None if fault == "refuse" => faults.refuses_samples = true,
            _ => {
                eprintln!("`{fault}` is no fault");
                return ExitCode::from(2);
            }
        }
    }
    match preview::run_with_faults(options, &faults) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::FAILURE
        }
    }
}
