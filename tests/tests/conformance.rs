//! Runs the language cases: each program's diagnostics and each expression's value are compared with what is
//! written beside the source. All that differ are reported at once.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use ide::Language;
use ide::crt::Crt;
use ide::geotrace::Geotrace;
use ide::language::Compiled;
use scene::ParamValues;
use scene::geotrace::compile;
use syntax::diagnostic::Diagnostic;
use syntax::line_index::{LineIndex, Position};
use testing::cases::{Action, Case, Expected, Outcome, Tuple, read};
use testing::close::close;
use testing::examples::repository;

/// Values are compared to this many digits.
const TOLERANCE: f64 = 2e-13;

fn folder() -> PathBuf {
    repository().join("tests/cases/language")
}

fn files() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder()).expect("the cases are readable");
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("the cases are readable").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "cases"))
        .collect();
    files.sort();
    files
}

#[test]
fn every_case_gives_what_is_written_beside_it() {
    let update = testing::writes_expected();
    let (mut count, mut failures) = (0, String::new());
    for file in files() {
        let text = std::fs::read_to_string(&file).expect("the cases are readable");
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let cases = read(&text).unwrap_or_else(|error| panic!("{name}, {error}"));
        let mut edits = Vec::new();
        for case in &cases {
            count += 1;
            let mut report = Report::default();
            check(language(&file), case, &mut report);
            edits.append(&mut report.edits);
            if !report.text.is_empty() {
                let _ = write!(
                    failures,
                    "\n{name}:{}: {}\n{}",
                    case.line, case.title, report.text
                );
            }
        }
        if update {
            rewrite(&file, &text, &edits);
        }
    }
    assert!(count > 150, "only {count} cases were found");
    let failed = failures.matches(".cases:").count();
    println!("{count} cases");
    assert!(
        failures.is_empty(),
        "{failed} of {count} cases fail:\n{failures}"
    );
}

/// What a case gives that it should not, and the lines that `UPDATE` would write anew.
#[derive(Default)]
struct Report {
    text: String,
    edits: Vec<(usize, String)>,
}

impl Report {
    fn report(&mut self, line: usize, what: impl AsRef<str>) {
        let _ = writeln!(self.text, "  line {line}: {}", what.as_ref());
    }
}

/// The language of a file's cases: CRT if its name begins so.
fn language(file: &Path) -> &'static dyn Language {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    match name.starts_with("crt_") {
        true => &Crt,
        false => &Geotrace,
    }
}

fn check(language: &dyn Language, case: &Case, report: &mut Report) {
    let compilation = language.compile(&case.source).expect("a small program");
    check_diagnostics(case, &compilation.diagnostics, report);
    if case.steps.is_empty() {
        return;
    }
    let Some(scene) = &compilation.scene else {
        report.report(case.line, "has no scene");
        return;
    };
    let mut settings = ParamValues::initial(scene);
    for step in &case.steps {
        match &step.action {
            Action::Set {
                name,
                values,
                refusal,
            } => match (settings.set(scene, name, values), refusal) {
                (Ok(()), None) => {}
                (Ok(()), Some(_)) => report.report(step.line, "is accepted"),
                (Err(error), None) => report.report(step.line, format!("is refused: {error}")),
                (Err(error), Some(fragments)) => {
                    let error = error.to_string();
                    if !holds(&error, fragments) {
                        report.report(step.line, format!("the refusal is: {error}"));
                    }
                }
            },
            Action::Evaluate { text, result } => {
                if let Err(what) = check_value(&compilation, &settings, text, result) {
                    report.report(step.line, format!("{text} gives {what}"));
                }
            }
        }
    }
}

fn check_diagnostics(case: &Case, actual: &[Diagnostic], report: &mut Report) {
    let lines = LineIndex::new(&case.source);
    let place = |diagnostic: &Diagnostic| {
        (
            lines.position(diagnostic.span.start),
            lines.position(diagnostic.span.end),
        )
    };
    let mut open: Vec<&Diagnostic> = actual.iter().collect();
    for expected in &case.diagnostics {
        let found = open.iter().position(|diagnostic| {
            let (start, end) = place(diagnostic);
            diagnostic.severity == expected.severity
                && (diagnostic.code.0 == expected.code || expected.code == "?")
                && expected.mark.holds(start, end)
        });
        let Some(found) = found else {
            report.report(
                expected.line,
                format!("is not reported at {:?}", expected.mark),
            );
            continue;
        };
        let diagnostic = open.remove(found);
        if expected.code == "?" {
            report.report(expected.line, format!("the code is {}", diagnostic.code.0));
            report
                .edits
                .push((expected.line, diagnostic.code.0.to_owned()));
        }
        check_texts(expected, diagnostic, report);
        for related in &expected.related {
            let names = diagnostic.related.iter().any(|other| {
                related.holds(
                    lines.position(other.span.start),
                    lines.position(other.span.end),
                )
            });
            if !names {
                report.report(
                    expected.line,
                    format!("does not name {related:?}, but {:?}", diagnostic.related),
                );
            }
        }
    }
    for diagnostic in open {
        let (start, end) = place(diagnostic);
        let hint = diagnostic.hint.as_deref().unwrap_or("no hint");
        report.report(
            case.line,
            format!(
                "reports as well {}–{} {:?}[{}]: {} ({hint})",
                show(start),
                show(end),
                diagnostic.severity,
                diagnostic.code.0,
                diagnostic.message,
            ),
        );
    }
}

fn check_texts(expected: &Expected, diagnostic: &Diagnostic, report: &mut Report) {
    if !holds(&diagnostic.message, &expected.message) {
        report.report(
            expected.line,
            format!("the message is: {}", diagnostic.message),
        );
    }
    let hint = diagnostic.hint.as_deref().unwrap_or("");
    if !holds(hint, &expected.hint) {
        report.report(expected.line, format!("the hint is: {hint}"));
    }
}

fn holds(text: &str, fragments: &[String]) -> bool {
    fragments
        .iter()
        .all(|fragment| text.contains(fragment.as_str()))
}

fn show(position: Position) -> String {
    format!("{}:{}", position.line, position.column)
}

fn check_value(
    compilation: &Compiled,
    settings: &ParamValues,
    text: &str,
    expected: &Result<Outcome, (String, Vec<String>)>,
) -> Result<(), String> {
    let actual = compilation.scope.evaluate(text, settings);
    match (actual, expected) {
        (Ok(evaluation), Ok(expected)) => {
            let actual = outcome(evaluation.outcome);
            if same_outcome(&actual, expected) {
                Ok(())
            } else {
                Err(format!("{actual:?}"))
            }
        }
        (Err(diagnostics), Err((code, fragments))) => {
            let known = diagnostics.iter().any(|diagnostic| {
                (diagnostic.code.0 == code.as_str() || code == "?")
                    && holds(&diagnostic.message, fragments)
            });
            if known {
                Ok(())
            } else {
                Err(format!("{diagnostics:?}"))
            }
        }
        (Ok(evaluation), Err(_)) => Err(format!("{:?}", evaluation.outcome)),
        (Err(diagnostics), Ok(_)) => Err(format!("{diagnostics:?}")),
    }
}

fn outcome(outcome: scene::Outcome) -> Outcome {
    match outcome {
        scene::Outcome::Single(scene::Value::Text(text)) => Outcome::Text(text),
        scene::Outcome::Single(value) => Outcome::Single(tuple(value)),
        scene::Outcome::Instances(instances) => Outcome::Instances(
            instances
                .into_iter()
                .map(|instance| (instance.grids, tuple(instance.value)))
                .collect(),
        ),
    }
}

fn tuple(value: scene::Value) -> Tuple {
    match value {
        scene::Value::Number(number) => vec![number],
        scene::Value::Vector(numbers) => numbers,
        scene::Value::Text(text) => panic!("no numbers: {text}"),
    }
}

fn same_outcome(actual: &Outcome, expected: &Outcome) -> bool {
    match (actual, expected) {
        (Outcome::Single(actual), Outcome::Single(expected)) => same_tuple(actual, expected),
        (Outcome::Text(actual), Outcome::Text(expected)) => actual == expected,
        (Outcome::Instances(actual), Outcome::Instances(expected)) => {
            actual.len() == expected.len()
                && actual.iter().zip(expected).all(|(actual, expected)| {
                    let grids = actual.0.len() == expected.0.len()
                        && actual.0.iter().zip(&expected.0).all(|(a, b)| {
                            a.0 == b.0
                                && a.1.len() == b.1.len()
                                && a.1.iter().zip(&b.1).all(|(a, b)| close(*a, *b, TOLERANCE))
                        });
                    grids && same_tuple(&actual.1, &expected.1)
                })
        }
        _ => false,
    }
}

fn same_tuple(actual: &Tuple, expected: &Tuple) -> bool {
    actual.len() == expected.len()
        && actual.iter().zip(expected).all(|pair| match pair {
            (Some(actual), Some(expected)) => close(*actual, *expected, TOLERANCE),
            (None, None) => true,
            _ => false,
        })
}

/// Writes codes that were left open as `?`.
fn rewrite(file: &Path, text: &str, edits: &[(usize, String)]) {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for (line, code) in edits {
        if let Some(line) = lines.get_mut(line - 1) {
            *line = line.replacen(" ?:", &format!(" {code}:"), 1);
        }
    }
    std::fs::write(file, lines.join("\n") + "\n").expect("the cases are writable");
}

/// Every code has a case, so that no diagnostic goes without an example. The exceptions stand here with the
/// file of the test that holds them.
#[test]
fn every_code_has_a_case() {
    const BAD_INPUT: &str = "tests/tests/bad_input.rs";
    const ELSEWHERE: &[(&str, &str)] = &[
        // They need bytes or sizes that a file of cases does not hold.
        ("invalid-utf8", BAD_INPUT),
        ("too-deep", BAD_INPUT),
        ("too-many-errors", BAD_INPUT),
        ("name-too-long", BAD_INPUT),
        ("expression-too-large", BAD_INPUT),
        ("too-many-params", BAD_INPUT),
        // Only `eval` gives it.
        ("geodesic-undefined", BAD_INPUT),
        // No file is read that is long enough.
        ("file-too-large", "crates/syntax/src/text.rs"),
        // `eval` says what the errors are.
        ("program-has-errors", "crates/scene/tests/meaning.rs"),
    ];
    for (code, file) in ELSEWHERE {
        let text = std::fs::read_to_string(repository().join(file)).expect("a test");
        let named = [format!("\"{code}\""), format!("[{code}]")];
        let has = named.iter().any(|named| text.contains(named));
        assert!(has, "{file} has no {code}");
    }
    let mut all = [BTreeSet::new(), BTreeSet::new()];
    for file in files() {
        let seen = &mut all[usize::from(language(&file).name() == Crt.name())];
        let text = std::fs::read_to_string(&file).expect("the cases are readable");
        for case in read(&text).unwrap_or_default() {
            seen.extend(case.diagnostics.into_iter().map(|expected| expected.code));
            for step in case.steps {
                if let Action::Evaluate {
                    result: Err((code, _)),
                    ..
                } = step.action
                {
                    seen.insert(code);
                }
            }
        }
    }
    let crt_codes = testing::crt_codes().map(|(code, _)| code.0);
    let crt_missing = crt_codes.filter(|code| !all[1].contains(*code));
    let missing: Vec<&str> = testing::codes()
        .map(|(code, _)| code.0)
        .filter(|code| !all[0].contains(*code))
        .chain(crt_missing)
        .filter(|code| ELSEWHERE.iter().all(|(elsewhere, _)| elsewhere != code))
        .collect();
    assert!(missing.is_empty(), "codes without a case: {missing:?}");
}

#[test]
fn the_programs_on_the_language_s_page_compile() {
    let path = repository().join("docs/language.md");
    let page = std::fs::read_to_string(path).expect("docs/language.md");
    let mut count = 0;
    for block in page.split("```gtr\n").skip(1) {
        let program = block.split("```").next().unwrap_or_default();
        let compilation = compile(program);
        assert!(
            compilation.diagnostics.is_empty(),
            "{program}\n{:#?}",
            compilation.diagnostics
        );
        count += 1;
    }
    assert!(count >= 3, "only {count} programs were found");
}
