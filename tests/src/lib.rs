//! What the integration tests under `tests/` share.
//!
//! ```text
//! cases/language/*.cases ──cases.rs──▶ cases ──conformance.rs──▶ what differs from scene::geotrace::compile
//! the binary `geotrace`  ──binary.rs──▶ status, output, peak memory
//! a language server      ──editor.rs, talk.rs──▶ answers, notifications, a transcript; random edits by random_edits.rs
//! two numbers or pictures ─close.rs, pictures.rs──▶ equal to a stated tolerance, or a message with both
//! ```

pub mod binary;
pub mod cases;
pub mod close;
pub mod draw;
pub mod editor;
pub mod examples;
pub mod great_circles;
pub mod inside;
pub mod pictures;
pub mod random_edits;
pub mod stiff;
pub mod structure;
pub mod talk;
pub mod toy_language;
pub mod toy_view;
pub mod wanted;

use syntax::diagnostic::Code;

/// Whether tests write what they expect in place of comparing with it: `UPDATE=1`, and no other value.
pub fn writes_expected() -> bool {
    std::env::var_os("UPDATE").is_some_and(|value| value == "1")
}

/// Every code that reading and running a CRT script can give, with what it means.
pub fn crt_codes() -> impl Iterator<Item = (Code, &'static str)> {
    let reading = syntax::crt::codes::CODES.iter();
    reading.chain(scene::crt::codes::CODES).copied()
}

/// Every code that compiling a program can give, with what it means.
pub fn codes() -> impl Iterator<Item = (Code, &'static str)> {
    let kernel = syntax::codes::CODES.iter();
    let language = syntax::geotrace::codes::CODES.iter();
    let all = kernel.chain(language).chain(scene::geotrace::CODES);
    all.copied()
}
pub mod window;
