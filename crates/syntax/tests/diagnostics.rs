//! Every message of the front-end, as `diagnostics.txt` and `crt_diagnostics.txt` hold them: a program between `===` and `---`,
//! then one line for each diagnostic, `line:column severity[code] text | message | hint`, and one for each fix.
//!
//! After a change of wording: `UPDATE=1 cargo test -p geotrace-syntax --test diagnostics`, and read the diff.

#[path = "support/recorder.rs"]
mod support;

use std::fmt::Write as _;

use support::{diagnostic_lines, parse};
use syntax::diagnostic::{Diagnostic, Fix};
use syntax::line_index::LineIndex;
use syntax::{codes, geotrace};

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/diagnostics.txt");
const CRT_PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/crt_diagnostics.txt");

/// The fixes of the diagnostics, `title: old → new`, and when an editor may apply each.
fn fixes(source: &str, diagnostics: &[Diagnostic]) -> Vec<String> {
    let index = LineIndex::new(source);
    let fixes = diagnostics.iter().flat_map(|diagnostic| &diagnostic.fixes);
    let show = |fix: &Fix| {
        let start = index.position(fix.span.start);
        format!(
            "  {}:{} {}: ‹{}› → ‹{}›{}{}",
            start.line,
            start.column,
            fix.title,
            fix.span.text(source),
            fix.replacement,
            if fix.preferred { ", preferred" } else { "" },
            if fix.all { ", with all" } else { "" },
        )
        .replace('\n', "⏎")
    };
    fixes.map(show).collect()
}

/// Compares the diagnostics of the programs in a file with those that stand there.
fn check(path: &str, diagnostics: impl Fn(&str) -> Vec<Diagnostic>) {
    let agreed = std::fs::read_to_string(path).expect("a file of diagnostics");
    let mut actual = String::new();
    for case in agreed.split("===\n").skip(1) {
        let (program, _) = case
            .split_once("\n---\n")
            .expect("a program and its diagnostics");
        let _ = write!(actual, "===\n{program}\n---\n");
        let mut found = diagnostics(program);
        found.sort_by_key(|diagnostic| diagnostic.span);
        let lines = diagnostic_lines(program, &found)
            .into_iter()
            .chain(fixes(program, &found));
        for line in lines {
            let _ = writeln!(actual, "{line}");
        }
    }
    if std::env::var_os("UPDATE").is_some_and(|value| value == "1") {
        std::fs::write(path, &actual).expect("a file of diagnostics is writable");
        return;
    }
    for (line, (actual, agreed)) in actual.lines().zip(agreed.lines()).enumerate() {
        assert_eq!(actual, agreed, "line {} of {path}", line + 1);
    }
    assert_eq!(actual.lines().count(), agreed.lines().count());
}

#[test]
fn every_finding_reads_as_it_was_agreed() {
    check(PATH, |program| parse(program).0.diagnostics);
}

#[test]
fn every_finding_of_a_script_reads_as_it_was_agreed() {
    check(CRT_PATH, |script| {
        let script = syntax::crt::document::Document::new(script, &());
        script.expect("a small text").diagnostics()
    });
}

#[test]
fn every_code_has_a_finding_and_every_finding_has_a_code() {
    // What needs a file of its own.
    let elsewhere = [
        codes::FILE_TOO_LARGE,
        codes::INVALID_UTF8,
        codes::TOO_MANY_ERRORS,
    ];
    let agreed = std::fs::read_to_string(PATH).expect("diagnostics.txt");
    let all = || codes::CODES.iter().chain(geotrace::codes::CODES);
    for (code, explanation) in all() {
        assert!(explanation.ends_with('.'));
        let shown = agreed.contains(&format!("[{}]", code.0));
        assert!(shown || elsewhere.contains(code), "{} is not shown", code.0);
    }
    let (recorder, _) = parse(&agreed);
    for diagnostic in recorder.diagnostics {
        assert!(all().any(|(code, _)| *code == diagnostic.code));
    }
}

#[test]
fn related_places_show_what_is_meant() {
    for (source, related) in [
        ("define a = (1, 2];", "("),
        ("define ab = 1; define ab = 2;", "ab"),
        ("define a = zz; define zz = 2;", "zz"),
        ("define x = 1; define a = sinx; define sinx = 2;", "sinx"),
        ("function f(u, u) = 1;", "u"),
        ("define a = sin;", "sin"),
    ] {
        let (recorder, _) = parse(source);
        let places: Vec<&str> = (recorder.diagnostics.iter())
            .flat_map(|diagnostic| &diagnostic.related)
            .map(|place| place.span.text(source))
            .collect();
        assert_eq!(places, [related], "{source}");
    }
}
