//! The binary `geotrace`.
//!
//! ```text
//! arguments ──command/*──▶ program.rs ──▶ scene::geotrace::Compilation ──▶ render, geodesic, expr
//!                 │             └──▶ report/ (diagnostics: text with snippets, or JSON)
//!                 └──▶ output.rs (standard output, files written whole or not at all) ──▶ exit status
//! ```
//!
//! Exit status: 0 fine, 1 the program or the input has errors, 2 wrong usage or an unreadable file.

mod argument;
mod command;
mod failure;
mod number;
mod output;
mod program;
mod progress;
mod report;
mod source;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let arguments = command::Arguments::parse();
    match command::run(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            failure.exit_code()
        }
    }
}
