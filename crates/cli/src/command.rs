//! The subcommands: one file each, with its arguments, its work and its output.

mod accuracy;
mod animation;
mod cast;
mod check;
mod convert;
mod eval;
mod explain;
mod export;
mod format;
mod lsp;
mod measure;
mod preview;
mod render;
mod show;
mod trace;

pub use cast::{LONGEST_LINE, MOST_RAYS};
pub use trace::MOST_EQUAL_STEPS;

use std::ffi::OsString;
use std::path::Path;

use clap::builder::ValueParser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::argument;
use crate::failure::Failure;
use crate::output;
use crate::registry::{Context, Registry};
use preview::NoWindow;

/// The program that the help shows; a test compiles it.
const FIRST_PROGRAM: &str = "\
# circle.gtr: a circle, a point that moves on it, and the tangent there
param r : [1/2, 1];
param o : [0, 2pi];
curve c(t) = r(cos t, sin t, 0), t : [0, 2pi];
point p = c(o);
vector v = c'(o) @ p;
";

/// Draw curves, surfaces and solids written as text: in 3D, traced, and from inside.
///
/// A program declares params, grids and functions; points, vectors, curves, surfaces, metrics, geodesics and solids;
/// lights, cameras and a background. `geotrace` draws them in 3D, or traced with lights, shadows, mirrors and glass.
/// It also draws the geodesic view of a surface, a metric or a solid: what an inhabitant sees, where light runs along
/// geodesics.
#[derive(Debug, Parser)]
#[command(
    name = "geotrace",
    version,
    override_usage = "geotrace [FILE]\n       geotrace <COMMAND>",
    max_term_width = 100,
    after_help = after_help()
)]
pub(crate) struct Arguments {
    /// The language of programs: geotrace, or crt for CRT scripts [default: by the file's extension, else geotrace]
    #[arg(long, global = true, value_name = "NAME")]
    language: Option<String>,
    #[command(subcommand)]
    command: Option<Command>,
}

impl Arguments {
    /// Parses the words of a command line, with the views of a registry.
    ///
    /// # Errors
    /// Wrong usage; also `--help` and `--version`, which are texts for standard output.
    pub(crate) fn parse_with<W: Into<OsString> + Clone>(
        registry: &Registry,
        words: impl IntoIterator<Item = W>,
    ) -> Result<Self, clap::Error> {
        Self::parse_words(registry, words, false)
    }

    /// Parses the words of `geotrace render`, where an option may be given again: the last one applies.
    ///
    /// # Errors
    /// [`Failure::Usage`].
    fn parse_render(
        registry: &Registry,
        words: Vec<OsString>,
    ) -> Result<Box<render::Arguments>, Failure> {
        let parsed = Self::parse_words(registry, words, true);
        match parsed
            .map_err(|error| Failure::usage(error.to_string()))?
            .command
        {
            Some(Command::Render(arguments)) => Ok(arguments),
            _ => Err(Failure::usage(
                "these are not arguments of `geotrace render`",
            )),
        }
    }

    fn parse_words<W: Into<OsString> + Clone>(
        registry: &Registry,
        words: impl IntoIterator<Item = W>,
        overrides: bool,
    ) -> Result<Self, clap::Error> {
        let views = registry.views.clone();
        let help = argument::view_help(&views);
        let parser = ValueParser::new(move |text: &str| argument::view(text, &views));
        let mut command = Self::command().mut_subcommand(render::NAME, |render| {
            let render = render.mut_arg("view", |view| view.help(help).value_parser(parser));
            render.args_override_self(overrides)
        });
        let words = with_show(&command, registry, words);
        let matches = command.try_get_matches_from_mut(words.clone());
        let matches = matches.map_err(|error| with_tip_on_render(error, &command, &words))?;
        let parsed = Self::from_arg_matches(&matches);
        let mut parsed = parsed.map_err(|error| error.format(&mut command))?;
        if let Some(Command::Render(arguments)) = &mut parsed.command {
            arguments.words = words;
        }
        Ok(parsed)
    }
}

/// Adds to the error about an option of `geotrace render` without that word that the command has it.
fn with_tip_on_render(
    mut error: clap::Error,
    command: &clap::Command,
    words: &[OsString],
) -> clap::Error {
    let other = words.iter().skip(1).find_map(|word| {
        let found = command.find_subcommand(word)?;
        (found.get_name() != "show").then_some(found)
    });
    let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg) else {
        return error;
    };
    let is_option = |it: &clap::Arg| {
        let long = it.get_long().map(|long| format!("--{long}"));
        let short = it.get_short().map(|short| format!("-{short}"));
        long.as_ref() == Some(option) || short.as_ref() == Some(option)
    };
    let render = command.find_subcommand(render::NAME);
    let is_of_render = render.is_some_and(|render| render.get_arguments().any(is_option));
    if error.kind() == ErrorKind::UnknownArgument && other.is_none() && is_of_render {
        let tip = "`geotrace render FILE -o PICTURE` draws a picture, and has this option";
        error.insert(
            ContextKind::Suggested,
            ContextValue::StyledStrs(vec![tip.into()]),
        );
    }
    error
}

/// Inserts the word `show` where a file stands in the place of a command: `geotrace FILE` is `geotrace show FILE`.
fn with_show<W: Into<OsString>>(
    command: &clap::Command,
    registry: &Registry,
    words: impl IntoIterator<Item = W>,
) -> Vec<OsString> {
    let mut words: Vec<OsString> = words.into_iter().map(Into::into).collect();
    let mut at = 1;
    // The option of all commands may stand before.
    while let Some(word) = words.get(at).and_then(|word| word.to_str()) {
        at += match word {
            "--language" => 2,
            _ if word.starts_with("--language=") => 1,
            _ => break,
        };
    }
    let is_escaped = words.get(at).is_some_and(|word| word == "--");
    if let Some(word) = words.get(at + usize::from(is_escaped)) {
        let path = Path::new(word);
        let is_file =
            word == "-" || registry.languages.by_extension(path).is_some() || path.is_file();
        if is_file && (is_escaped || command.find_subcommand(word).is_none()) {
            words.insert(at, "show".into());
        }
    }
    words
}

#[derive(Debug, Subcommand)]
enum Command {
    Show(show::Arguments),
    Preview(preview::Arguments),
    Check(check::Arguments),
    Render(Box<render::Arguments>),
    Export(export::Arguments),
    Convert(convert::Arguments),
    Cast(Box<cast::Arguments>),
    Trace(Box<trace::Arguments>),
    Measure(Box<measure::Arguments>),
    Eval(eval::Arguments),
    Explain(explain::Arguments),
    Accuracy(accuracy::Arguments),
    Format(format::Arguments),
    Lsp(lsp::Arguments),
}

/// Runs the command that the arguments name.
pub(crate) fn run(arguments: Arguments, registry: &Registry) -> Result<(), Failure> {
    let context = Context {
        registry: registry.clone(),
        language: arguments.language,
    };
    let Some(command) = arguments.command else {
        return without_command(&context);
    };
    match command {
        Command::Show(arguments) => show::run(&arguments, &context),
        Command::Preview(arguments) => preview::run(&arguments, &context),
        Command::Check(arguments) => check::run(&arguments, &context),
        Command::Render(arguments) => render::run(&arguments, &context),
        Command::Export(arguments) => export::run(&arguments, &context),
        Command::Convert(arguments) => convert::run(&arguments, &context),
        Command::Cast(arguments) => cast::run(&arguments, &context),
        Command::Trace(arguments) => trace::run(&arguments, &context),
        Command::Measure(arguments) => measure::run(&arguments, &context),
        Command::Eval(arguments) => eval::run(&arguments, &context),
        Command::Explain(arguments) => explain::run(&arguments, &context),
        Command::Accuracy(arguments) => accuracy::run(&arguments, &context),
        Command::Format(arguments) => format::run(&arguments, &context),
        Command::Lsp(arguments) => lsp::run(&arguments, &context),
    }
}

/// Opens the window without a program, or prints the help where there can be no window.
fn without_command(context: &Context) -> Result<(), Failure> {
    match preview::open_file(None, context) {
        Ok(()) => Ok(()),
        Err(NoWindow::Other(failure)) => Err(failure),
        Err(NoWindow::NotHere(_)) => {
            let help = Arguments::command().render_help();
            output::print(&help.to_string())
        }
    }
}

fn after_help() -> String {
    let mut text = String::from("A first program:\n\n");
    for line in FIRST_PROGRAM.lines() {
        text.push_str("  ");
        text.push_str(line);
        text.push('\n');
    }
    text.push_str(
        "
What to do with it:

  geotrace show circle.gtr                         the live window; without a display, pictures
  geotrace check circle.gtr                        errors with location and hint
  geotrace render circle.gtr -o circle.png         a picture
  geotrace render circle.gtr -o c.png --set o=1.5  a picture with another value of a param
  geotrace eval circle.gtr \"c'(0)\"                 the value of an expression

And with a surface s:

  geotrace render torus.gtr -o inside.png --view geodesic:s    seen from inside
  geotrace export torus.gtr -o torus.glb           a mesh; also .obj, .ply, .stl, .gltf
  geotrace trace torus.gtr --surface s --from 0,0 --heading 30 --length 2
  geotrace measure torus.gtr --between 0,0 1,2     distance, curvature, circles, triangles
  geotrace cast die.gtr --from 3,0.4,0.4 --direction -1,0,0    where a ray meets a solid
  geotrace convert forest.crt -o forest.gtr        a CRT script as a program in Geotrace's language
  geotrace explain torus.gtr                       what is built for it, and what is left out
  geotrace accuracy torus.gtr                      error against run time of every method

FILE may be `-` for standard input, except for the window: `geotrace FILE`, `show`, `preview`.
`geotrace help COMMAND` explains the options.
Exit status:
  0  success
  1  errors in the program or the input, or a result that cannot be made, such as a video without ffmpeg
  2  wrong usage, or a file that cannot be read or written",
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn values_may_start_with_a_minus_sign() {
        for arguments in [
            "geotrace trace a.gtr --surface s --from -2,0.3 --direction -1,-1 --length 1",
            "geotrace trace a.gtr --surface s --from 0,0 --heading -30 --length 1 --set a=-1",
            "geotrace render a.gtr -o a.png --at -1,-.5 --angle -90 --eye -1,-1,-1 --target -1,0,0",
            "geotrace eval a.gtr -x^2 --set a=-1",
            "geotrace eval a.gtr --set a=-1 -/2",
            "geotrace eval - - --format json",
            "geotrace preview a.gtr --backend software",
            "geotrace preview --attached",
            "geotrace preview",
            "geotrace",
            "geotrace lsp --window a --b c",
        ] {
            let parsed = Arguments::try_parse_from(arguments.split(' '));
            assert!(parsed.is_ok(), "{arguments}: {parsed:?}");
        }
    }

    #[test]
    fn a_file_is_shown_also_behind_an_option() {
        let registry = Registry::standard();
        for words in [
            "geotrace a.gtr",
            "geotrace -- a.gtr",
            "geotrace --language crt a.gtr",
            "geotrace --language=crt -- a.gtr",
            "geotrace a.gtr --language crt",
        ] {
            let parsed = Arguments::parse_with(&registry, words.split(' '));
            let parsed = parsed.unwrap_or_else(|error| panic!("{words}: {error}"));
            assert!(matches!(parsed.command, Some(Command::Show(_))), "{words}");
            let language = words.contains("crt").then_some("crt");
            assert_eq!(parsed.language.as_deref(), language, "{words}");
        }
        let parsed = Arguments::parse_with(&registry, ["geotrace", "--language", "crt"]);
        assert!(parsed.is_ok_and(|parsed| parsed.command.is_none()));
    }

    #[test]
    fn options_of_render_without_its_name_have_a_tip() {
        let registry = Registry::standard();
        let error = |words: &str| {
            let parsed = Arguments::parse_with(&registry, words.split(' '));
            parsed.expect_err(words).to_string()
        };
        for words in [
            "geotrace a.gtr -o a.png",
            "geotrace -o a.png a.gtr",
            "geotrace a.gtr --view geodesic",
        ] {
            let error = error(words);
            assert!(error.contains("tip: `geotrace render FILE"), "{error}");
            assert!(!error.contains("as a value"), "{error}");
        }
        for words in ["geotrace check a.gtr -o a.png", "geotrace a.gtr --verbose"] {
            let error = error(words);
            assert!(!error.contains("geotrace render FILE"), "{error}");
        }
    }

    #[test]
    fn wrong_usage_is_refused() {
        for arguments in [
            "geotrace check",
            "geotrace draw a.gtr",
            "geotrace preview a.gtr --attached",
            "geotrace preview a.gtr b.gtr",
            "geotrace show",
            "geotrace check a.gtr --format xml",
            "geotrace render a.gtr",
            "geotrace render a.gtr -o a.png --size 0x0",
            "geotrace render a.gtr -o a.png --at 1",
            "geotrace render a.gtr -o a.png --set r",
            "geotrace trace a.gtr --surface s --from 0,0 --length 1",
            "geotrace trace a.gtr --surface s --from 0,0 --length 1 --heading 0 --direction 1,0",
            "geotrace eval a.gtr",
            "geotrace export a.gtr",
            "geotrace export a.gtr -o a.obj --format dxf",
        ] {
            let refused = Arguments::try_parse_from(arguments.split(' '));
            assert_eq!(
                refused.err().map(|error| error.exit_code()),
                Some(2),
                "{arguments}"
            );
        }
    }

    #[test]
    fn the_program_in_the_help_has_no_errors() {
        let compilation = scene::geotrace::compile(FIRST_PROGRAM);
        assert_eq!(compilation.diagnostics, []);
    }
}
