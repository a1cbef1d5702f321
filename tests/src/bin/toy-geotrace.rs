//! The command line with a toy language and a toy view, each registered in one place.

use std::process::ExitCode;

use cli::Registry;
use testing::toy_language::Dots;
use testing::toy_view::BandsView;

fn main() -> ExitCode {
    let standard = Registry::standard();
    cli::run(&Registry {
        languages: standard.languages.with(Dots),
        views: standard.views.with(BandsView),
    })
}
