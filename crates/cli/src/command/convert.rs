//! `geotrace convert`: a script as a program in Geotrace's language.

use std::path::{Path, PathBuf};

use clap::Args;
use ide::conversion::ConvertError;

use crate::argument::{Assignment, Format, assignment};
use crate::failure::Failure;
use crate::output::{self, Inputs, OutputTarget};
use crate::program::LoadedProgram;
use crate::registry::Context;

/// Convert a CRT script to a program in Geotrace's language that draws the same picture.
///
/// The script is run for one value of t. The program states the resulting objects without loops, macros and random
/// numbers, with y and z swapped; its first comment is the command that draws the script's picture.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  geotrace convert forest.crt -o forest.gtr
  geotrace convert gears.crt -o gears.gtr --set t=5
  geotrace convert spheres.crt -o -                   to standard output
  geotrace convert - --language crt -o spheres.gtr    from standard input")]
pub(super) struct Arguments {
    /// The script; `-` is standard input, and needs `--language crt`
    file: PathBuf,
    /// The program to write; `-` is standard output
    #[arg(short, long, value_name = "OUT.gtr")]
    output: PathBuf,
    /// A value for t
    #[arg(long, value_name = "t=VALUE", value_parser = assignment, allow_hyphen_values = true)]
    set: Vec<Assignment>,
}

pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let language = context.language(&arguments.file)?;
    let mut program = LoadedProgram::load(context, &arguments.file, Format::Human)?;
    let params = program.set_params(&arguments.set)?;
    let analysis = language.read(&program.source.text);
    let Some(extension) = analysis.conversion() else {
        return Err(refused(ConvertError::NotOffered));
    };
    let standard = Path::new("-");
    if arguments.output != standard
        && arguments
            .output
            .extension()
            .is_none_or(|it| it != extension)
    {
        return Err(Failure::usage(format!(
            "{} is not a valid program name: a program in Geotrace's language ends in .{extension}",
            arguments.output.display()
        )));
    }
    let target = OutputTarget::apart_from(&arguments.output, &Inputs::new(&arguments.file, []))?;
    let named = match arguments.output == standard {
        false => arguments.output.clone(),
        true if arguments.file == standard => Path::new("program").with_extension(extension),
        true => arguments.file.with_extension(extension),
    };
    let name = named.file_name().unwrap_or_default().to_string_lossy();
    let text = analysis
        .convert(params.uniforms(), &name)
        .map_err(refused)?;
    target.write(text.as_bytes())?;
    if !analysis.links().is_empty() && folder(&arguments.file) != folder(&named) {
        output::print_error(
            "note: the images of the script are sought beside the program; with `--images FOLDER`, `render` takes those beside the script\n",
        );
    }
    Ok(())
}

/// Returns the folder of a file.
fn folder(file: &Path) -> Option<PathBuf> {
    let folder = file.parent().filter(|it| !it.as_os_str().is_empty());
    folder.unwrap_or(Path::new(".")).canonicalize().ok()
}

fn refused(error: ConvertError) -> Failure {
    Failure::Input {
        message: error.to_string(),
        hint: None,
    }
}
