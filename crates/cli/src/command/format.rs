//! `geotrace format`: programs in the canonical layout.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::failure::Failure;
use crate::number;
use crate::output::{self, OutputTarget};
use crate::registry::Context;
use crate::source::SourceText;

/// Format programs in the canonical layout; their meaning never changes.
///
/// Files are rewritten in place; `-` is read from standard input and written to standard output. Comments, line
/// breaks within a declaration and the joining of words are preserved. A program with errors is formatted as far as
/// it can be parsed.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  geotrace format circle.gtr
  geotrace format --check *.gtr
  geotrace format - < circle.gtr")]
pub(super) struct Arguments {
    /// The programs; `-` is standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Change nothing; list the programs that are not in the canonical layout, and exit with status 1 if there are any
    #[arg(long)]
    check: bool,
}

pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let standard = arguments
        .files
        .iter()
        .filter(|file| *file == Path::new("-"));
    if standard.count() > 1 {
        return Err(Failure::usage("standard input (`-`) can be read only once"));
    }
    let mut others = 0;
    let mut failed = None;
    for file in &arguments.files {
        match one(file, arguments.check, context) {
            Ok(same) => others += usize::from(!same),
            Err(failure) => {
                // The other files are formatted nevertheless; the last such failure ends the run.
                if let Some(earlier) = failed.replace(failure) {
                    output::print_failure(&earlier);
                }
            }
        }
    }
    if let Some(failure) = failed {
        return Err(failure);
    }
    if arguments.check && others > 0 {
        let files = number::count(others, "program");
        return Err(Failure::Input {
            message: format!("{files} not in the canonical layout"),
            hint: Some("`geotrace format FILE…` formats them".to_owned()),
        });
    }
    Ok(())
}

/// Formats one program, or only compares it. Returns whether it had the canonical layout already.
fn one(file: &Path, check: bool, context: &Context) -> Result<bool, Failure> {
    let is_stream = || fs::metadata(file).is_ok_and(|it| !it.is_file() && !it.is_dir());
    if !check && file != Path::new("-") && is_stream() {
        return Err(Failure::Usage {
            message: format!("`{}` is not a file that can be rewritten", file.display()),
            hint: Some("`-` is read from standard input and written to standard output".into()),
        });
    }
    let source = SourceText::read(file)?;
    if source.undecodable.is_some() {
        return Err(Failure::Unreadable {
            file: source.name,
            reason: "it is not UTF-8".to_owned(),
        });
    }
    let text = context.language(file)?.laid_out(&source.text);
    let same = text == source.text;
    if check {
        if !same {
            output::print(&format!("{}\n", source.name))?;
        }
    } else if file == Path::new("-") {
        output::print(&text)?;
    } else if !same {
        OutputTarget::new(file)?.write(text.as_bytes())?;
    }
    Ok(same)
}
