//! README and docs tell the truth: their commands, files and tables are checked.

use std::collections::BTreeMap;

use testing::draw::scene;
use testing::examples::repository;

fn read(path: &str) -> String {
    std::fs::read_to_string(repository().join(path))
        .unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The table of diagnostics, as it must stand in `docs/diagnostics.md`.
fn diagnostics() -> String {
    let codes: BTreeMap<&str, &str> = testing::codes()
        .map(|(code, text)| (code.0, text))
        .collect();
    let mut text = String::from(
        "# Diagnostics\n\nWhat `geotrace check` can say, by code. Each has a case in `tests/cases/language/` or in\n\
         `tests/tests/bad_input.rs`. `UPDATE=1 cargo test -p geotrace-tests --test documents` writes this page.\n\n\
         | code | what it means |\n| --- | --- |\n",
    );
    for (code, explanation) in codes {
        text.push_str(&format!("| `{code}` | {explanation} |\n"));
    }
    text
}

#[test]
fn every_code_stands_in_the_table_of_diagnostics() {
    let expected = diagnostics();
    let path = "docs/diagnostics.md";
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(repository().join(path), expected).expect("docs/ is writable");
        return;
    }
    assert_eq!(
        read(path),
        expected,
        "{path} is old; UPDATE=1 writes it anew"
    );
}

#[test]
fn links_and_pictures_of_the_readme_exist() {
    let text = read("README.md");
    let mut count = 0;
    for part in text.split("](").skip(1) {
        let target = part.split(')').next().unwrap_or("");
        if target.contains("://") {
            continue;
        }
        count += 1;
        assert!(
            repository().join(target).exists(),
            "README.md names {target}"
        );
    }
    assert!(count >= 5, "only {count} links were found");
}

#[test]
fn the_program_in_the_readme_compiles() {
    let text = read("README.md");
    let program = text
        .split("```text\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    let scene = scene(program.expect("a program in README.md"));
    assert_eq!(scene.objects.len(), 3);
}

#[test]
fn every_declaration_of_the_readmes_table_compiles() {
    let text = read("README.md");
    let mut program = String::new();
    for line in text.lines() {
        let Some(rest) = line.strip_prefix("| `") else {
            continue;
        };
        let declaration = rest.split('`').next().unwrap_or("");
        if declaration.ends_with(';') {
            program.push_str(declaration);
            program.push('\n');
        }
    }
    assert_eq!(program.lines().count(), 10, "{program}");
    scene(&program);
}

#[test]
fn the_files_that_the_readme_names_exist() {
    for path in [
        "tests/run",
        "docs/pictures",
        ".ci/run",
        "ARCHITECTURE.md",
        "CHANGELOG.md",
        "LICENSE-MIT",
        "LICENSE-APACHE",
        "crates/expr/src/ops.rs",
        "crates/expr/src/conformance.rs",
        "crates/render/src/plan.rs",
        "tests/cases/language/builtins.cases",
    ] {
        assert!(repository().join(path).exists(), "{path} is missing");
    }
    assert!(read(".ci/run").contains("bash tests/run"));
    assert!(read("README.md").contains("bash tests/run"));
}
