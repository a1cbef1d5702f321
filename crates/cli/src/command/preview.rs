//! `geotrace preview`: the live window.

use std::path::PathBuf;

use clap::Args;
use render::Backend;

use crate::argument::{self, Choice};
use crate::failure::Failure;
use crate::registry::Context;

/// Open the live window on a program: its 3D view, and its surfaces from inside.
///
/// Without a FILE the window offers a new program, recent programs and examples. It follows changes of the file on
/// disk, and has an editor of its own. Editors start it themselves, attached to the text that is typed there. Without
/// a display it exits with status 1; `geotrace show` then draws pictures, and `geotrace render` always does.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// The program
    #[arg(conflicts_with = "attached")]
    file: Option<PathBuf>,
    /// Receive the text from an editor's language server, over standard input and output: for editors
    #[arg(long)]
    attached: bool,
    /// The renderer: auto uses a hardware GPU if there is one
    #[arg(long, value_parser = argument::choice(&BACKENDS), default_value = "auto", value_name = "BACKEND")]
    backend: Backend,
    /// A log of the window's actions, one JSON object per line: for tests
    #[arg(long, value_name = "FILE", hide = true)]
    report: Option<PathBuf>,
}

const BACKENDS: [Choice<Backend>; 3] = [
    Choice::new(
        "auto",
        "A hardware GPU if there is one, else the processor",
        Backend::Auto,
    ),
    Choice::new(
        "gpu",
        "Any GPU, even one emulated in software",
        Backend::Gpu,
    ),
    Choice::new(
        "software",
        "The processor's cores, in double precision",
        Backend::Software,
    ),
];

/// The reason for which no window was opened.
#[derive(Debug)]
pub(super) enum NoWindow {
    /// No window is possible here; a sentence without its full stop.
    NotHere(String),
    /// Something other than the window failed.
    #[cfg_attr(
        not(feature = "window"),
        expect(dead_code, reason = "without a window nothing else can fail")
    )]
    Other(Failure),
}

/// Opens the window and waits until it is closed.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let hint = match &arguments.file {
        Some(file) => format!(
            "`geotrace render {} -o OUT.png` makes a picture without a window",
            file.display()
        ),
        None => "`geotrace render FILE -o OUT.png` makes a picture without a window".to_owned(),
    };
    open(arguments, context).map_err(|failure| match failure {
        NoWindow::NotHere(message) => Failure::Input {
            message,
            hint: Some(hint),
        },
        NoWindow::Other(failure) => failure,
    })
}

/// Opens the window on a file, or without a program, and waits until it is closed.
pub(super) fn open_file(file: Option<PathBuf>, context: &Context) -> Result<(), NoWindow> {
    let arguments = Arguments {
        file,
        attached: false,
        backend: Backend::Auto,
        report: None,
    };
    open(&arguments, context)
}

#[cfg(feature = "window")]
fn open(arguments: &Arguments, context: &Context) -> Result<(), NoWindow> {
    use preview::{Ending, Options, Source};

    let source = match &arguments.file {
        Some(file) if file.as_os_str() == "-" => {
            return Err(NoWindow::Other(Failure::Usage {
                message: "the window cannot show standard input".into(),
                hint: Some("`geotrace render - -o OUT.png` draws a picture of it".into()),
            }));
        }
        Some(file) => Source::File(file.clone()),
        None if arguments.attached => Source::Attached,
        None => Source::Welcome,
    };
    // A signal would lose what was typed and not saved.
    let ending = Ending::default();
    let asked = ending.clone();
    crate::interruption::ask_first(move || asked.ask());
    let options = Options {
        source,
        ending,
        languages: context.languages().map_err(NoWindow::Other)?,
        views: context.registry.views.clone(),
        backend: arguments.backend,
        report: arguments.report.clone(),
    };
    preview::run(options).map_err(|failure| match failure {
        preview::Failure::Unreadable { path, reason } => NoWindow::Other(Failure::Unreadable {
            file: path.display().to_string(),
            reason,
        }),
        other => NoWindow::NotHere(other.to_string()),
    })
}

#[cfg(not(feature = "window"))]
fn open(_: &Arguments, _: &Context) -> Result<(), NoWindow> {
    let message = "this build of geotrace has no window: it was made without the feature `window`";
    Err(NoWindow::NotHere(message.to_owned()))
}
