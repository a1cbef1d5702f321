//! `geotrace lsp`: the language server on standard input and output.

use clap::Args;

use crate::failure::Failure;
use crate::output;

/// Serve an editor: the language server on standard input and output.
///
/// Editors start it by themselves. It ends with status 0 after `shutdown`, else with 1.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Standard input and output, which is what it does anyway: some editors always add it
    #[arg(long, hide = true)]
    stdio: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { stdio: _ } = arguments;
    let clean = server::run().map_err(|error| Failure::Internal {
        message: format!(
            "the language server cannot start: {}",
            output::reason(&error)
        ),
    })?;
    if clean {
        Ok(())
    } else {
        Err(Failure::EditorGone)
    }
}
