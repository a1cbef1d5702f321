//! `geotrace show`: the live window, or what it would show as pictures.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::Args;

use super::preview::{self, NoWindow};
use crate::argument::Format;
use crate::failure::Failure;
use crate::output;
use crate::program::LoadedProgram;
use crate::registry::Context;

/// Show a program in the live window, or, without a display, as pictures.
///
/// Without a display it prints a note and writes pictures to the current folder, over no other file: the 3D view
/// (of a CRT script the traced view), unless there are only metrics, and, if there is a surface or a metric, the geodesic
/// view of the first one.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// The program
    file: PathBuf,
}

pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    match preview::open_file(Some(arguments.file.clone()), context) {
        Ok(()) => return Ok(()),
        Err(NoWindow::Other(failure)) => return Err(failure),
        Err(NoWindow::NotHere(reason)) => {
            output::print_error(&format!("note: {reason}; pictures are drawn instead\n"));
        }
    }
    let program = LoadedProgram::load(context, &arguments.file, Format::Human)?;
    let has_inside = program.surface(None).is_ok();
    // A program of metrics alone is seen only from inside, one without a surface or a metric only in space.
    let scene = program.scene();
    if !has_inside || scene.objects.iter().any(|it| scene.is_in_space(it)) {
        draw(arguments, context, &[], "")?;
    }
    if has_inside {
        draw(arguments, context, &["--view", "geodesic"], "-inside")?;
    }
    Ok(())
}

/// Runs `geotrace render` with options, to a file that is named after the program.
fn draw(
    arguments: &Arguments,
    context: &Context,
    options: &[&str],
    ending: &str,
) -> Result<(), Failure> {
    let output = free_name(&arguments.file, ending);
    // A name may begin with a dash.
    let mut target = OsString::from("--output=");
    target.push(output);
    let words = [&["geotrace", "render"], options].concat();
    let words = words.into_iter().map(OsString::from);
    let words = words.chain([target, "--".into(), arguments.file.clone().into_os_string()]);
    let parsed = super::Arguments::parse_with(&context.registry, words);
    let mut render = parsed.map_err(|error| Failure::Internal {
        message: format!("the arguments of a picture are not accepted: {error}"),
    })?;
    render.language.clone_from(&context.language);
    super::run(render, &context.registry)
}

/// Returns the first of `PROGRAM.png`, `PROGRAM-2.png`, … that no file in the current folder has; `ending` follows the
/// program's name.
fn free_name(program: &Path, ending: &str) -> OsString {
    let mut stem = program.file_stem().unwrap_or_default().to_owned();
    stem.push(ending);
    let mut number = 1;
    loop {
        let mut name = stem.clone();
        if number > 1 {
            name.push(format!("-{number}"));
        }
        name.push(".png");
        // A link that leads nowhere is one, too.
        if Path::new(&name).symlink_metadata().is_err() {
            return name;
        }
        number += 1;
    }
}
