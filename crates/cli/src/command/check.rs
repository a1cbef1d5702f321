//! `geotrace check`: all diagnostics of some programs.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::argument::Format;
use crate::failure::Failure;
use crate::number;
use crate::output;
use crate::program;
use crate::registry::Context;
use crate::report::{self, SeverityCounts, json};
use crate::style::TextColours;

/// Check programs and report errors with location and hint.
///
/// Prints one line `file:line:column: error[code]: sentence` for each diagnostic, followed by the source.
/// All errors of a program are reported in one run. Warnings do not change the exit status.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  geotrace check circle.gtr
  geotrace check *.gtr --format json
  echo 'point p = (1, 2, 3);' | geotrace check -")]
pub(super) struct Arguments {
    /// The programs; `-` is standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Human-readable text, or one JSON document {"diagnostics": [...]}
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    format: Format,
}

/// Checks every file, also if one of them cannot be read.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let twice = arguments
        .files
        .iter()
        .filter(|file| *file == Path::new("-"))
        .count()
        > 1;
    if twice {
        return Err(Failure::usage("standard input (`-`) can be read only once"));
    }
    let colours = TextColours::for_stdout();
    let mut document = json::DiagnosticsJson::default();
    let mut counts = SeverityCounts::default();
    let mut checked = 0;
    let mut unreadable = None;
    // A reader that has closed the stream does not change the exit status.
    let mut printed = Ok(());
    for file in &arguments.files {
        let (source, compiled) = match program::compile(context, file) {
            Ok(compiled) => compiled,
            Err(failure) => {
                // The other files are checked nevertheless; the last such failure ends the run.
                if let Some(earlier) = unreadable.replace(failure) {
                    output::print_failure(&earlier);
                }
                continue;
            }
        };
        checked += 1;
        counts = counts.plus(SeverityCounts::count(&compiled.diagnostics));
        match arguments.format {
            Format::Human => {
                let text = report::text(&source, &compiled.diagnostics, colours);
                if !text.is_empty() && printed.is_ok() {
                    printed = output::print(&text);
                }
            }
            Format::Json => document.add(&source, &compiled.diagnostics),
        }
    }
    match arguments.format {
        Format::Human if checked == 0 => {}
        Format::Human => {
            let what = match &arguments.files[..] {
                [only] => only.display().to_string(),
                _ => format!("{} checked", number::count(checked, "file")),
            };
            output::print_error(&format!("{what}: {}\n", counts.text()));
        }
        Format::Json => printed = output::print_json(&document),
    }
    match (unreadable, printed) {
        (Some(failure), _) => Err(failure),
        (None, Ok(()) | Err(Failure::ReaderGone)) if counts.errors > 0 => {
            Err(Failure::ProgramHasErrors)
        }
        (None, printed) => printed,
    }
}
