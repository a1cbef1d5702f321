//! `geotrace lsp`: the language server on standard input and output.

use std::ffi::OsString;
use std::sync::Arc;

use clap::Args;
use server::{End, WindowProgram};

use crate::failure::Failure;
use crate::interruption;
use crate::output;
use crate::registry::Context;

/// Run the language server for an editor, on standard input and output.
///
/// Editors start it themselves. It exits with status 0 after `shutdown`, else with 1.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Use standard input and output, as always: accepted because some editors pass it
    #[arg(long, hide = true)]
    stdio: bool,
    /// Another program, with its arguments, in place of the preview window: for tests
    #[arg(long, hide = true, num_args = 1.., allow_hyphen_values = true, value_name = "PROGRAM")]
    window: Vec<OsString>,
}

pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let languages = context.languages()?;
    // A signal would leave its windows open.
    let end = Arc::<End>::default();
    let asked = end.clone();
    interruption::ask_first(move || {
        asked.now();
        true
    });
    let clean = server::run(languages, window(&arguments.window), end).map_err(|error| {
        let reason = output::reason(&error);
        Failure::Internal {
            message: format!("the language server cannot start: {reason}"),
        }
    })?;
    if clean {
        Ok(())
    } else {
        Err(Failure::EditorGone)
    }
}

/// The program that the server starts for a preview: this program, if it was built with a window.
fn window(given: &[OsString]) -> Option<WindowProgram> {
    if let Some((program, arguments)) = given.split_first() {
        return Some(WindowProgram {
            program: program.into(),
            arguments: arguments.to_vec(),
            version_timeout: WindowProgram::VERSION_TIMEOUT,
            close_delay: WindowProgram::CLOSE_DELAY,
        });
    }
    if cfg!(feature = "window") {
        // Fails if the system does not report the path of this program; then there is no window.
        WindowProgram::own(["preview", "--attached"]).ok()
    } else {
        None
    }
}
