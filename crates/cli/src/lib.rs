//! The command line `geotrace`, as a library: `main.rs` runs it with the standard languages and views.
//!
//! ```text
//! arguments ──command/*──▶ program.rs ──▶ scene::geotrace::Compilation ──▶ render, geodesic, expr
//!                 │             └──▶ report.rs (diagnostics: text with snippets, or JSON)
//!                 └──▶ output.rs (standard output; whole files by `export`) ──▶ exit status
//! ```
//!
//! Exit status: 0 success, 1 errors in the program or the input or a result that cannot be made, 2 wrong usage or a file
//! that cannot be read or written.

mod argument;
mod command;
mod failure;
mod interruption;
mod number;
mod output;
mod program;
mod progress;
mod registry;
mod report;
mod source;
mod style;

use std::process::ExitCode;

pub use command::{LONGEST_LINE, MOST_EQUAL_STEPS, MOST_RAYS};
pub use registry::Registry;

/// Reads the arguments of this process, runs the command that they name, and returns the exit status.
pub fn run(registry: &Registry) -> ExitCode {
    let parsed = command::Arguments::parse_with(registry, std::env::args_os());
    let arguments = match parsed {
        Ok(arguments) => arguments,
        Err(text) => return print_usage(&text),
    };
    interruption::remove_what_is_half_written();
    match command::run(arguments, registry) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::print_failure(&failure);
            failure.exit_code()
        }
    }
}

/// Prints help, the version, or wrong usage with its exit status.
fn print_usage(text: &clap::Error) -> ExitCode {
    match text.print() {
        Err(error) if !text.use_stderr() => {
            let failure = output::stdout_failure(error);
            output::print_failure(&failure);
            failure.exit_code()
        }
        _ => ExitCode::from(u8::try_from(text.exit_code()).unwrap_or(2)),
    }
}
