//! The program `geotrace`, built with the tests: see `binary.rs`.

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run(&cli::Registry::standard())
}
