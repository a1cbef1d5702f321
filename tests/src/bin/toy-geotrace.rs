//! The command line with a toy language and a toy view: what each of them takes, registered in one place.

use std::process::ExitCode;

use cli::Registry;
use testing::toy_language::Dots;

fn main() -> ExitCode {
    let standard = Registry::standard();
    cli::run(&Registry {
        languages: standard.languages.with(Dots),
        ..standard
    })
}
