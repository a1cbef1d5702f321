//! The binary `geotrace`: the command line with the standard languages and views.

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run(&cli::Registry::standard())
}
