//! README and docs tell the truth: their commands, files and tables are checked.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use expr::ops::{CONSTANTS, Unary};
use ide::Language;
use ide::crt::Crt;
use ide::geotrace::Geotrace;
use syntax::diagnostic::{Code, Severity};
use syntax::geotrace::attributes::{self, AttributeType, AttributeWord};
use syntax::geotrace::declarations::{DeclarationKeyword, DeclarationRow, TABLE};
use syntax::geotrace::token::MapWord;
use testing::binary::geotrace;
use testing::draw::scene;
use testing::examples::repository;
use testing::pictures::difference;
use testing::writes_expected;

fn read(path: &str) -> String {
    std::fs::read_to_string(repository().join(path))
        .unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The table of diagnostics, as it must stand in `docs/diagnostics.md`.
fn diagnostics() -> String {
    let mut text = String::from(
        "# Diagnostics\n\nWhat `geotrace check` can say, by code. Each has a case in `tests/cases/language/`, or in a\n\
         test that `tests/tests/conformance.rs` names. `UPDATE=1 cargo test --workspace --test documents` writes this page.\n\n\
         | code | what it means |\n| --- | --- |\n",
    );
    let rows = |codes: &mut dyn Iterator<Item = (Code, &'static str)>| -> String {
        let sorted: BTreeMap<&str, &str> = codes.map(|(code, text)| (code.0, text)).collect();
        let rows = sorted.into_iter();
        rows.map(|(code, text)| format!("| `{code}` | {text} |\n"))
            .collect()
    };
    text.push_str(&rows(&mut testing::codes()));
    text.push_str("\n## In CRT scripts\n\n| code | what it means |\n| --- | --- |\n");
    text.push_str(&rows(&mut testing::crt_codes()));
    text
}

#[test]
fn every_code_stands_in_the_table_of_diagnostics() {
    let expected = diagnostics();
    let path = "docs/diagnostics.md";
    if writes_expected() {
        std::fs::write(repository().join(path), expected).expect("docs/ is writable");
        return;
    }
    assert_eq!(
        read(path),
        expected,
        "{path} is old; UPDATE=1 writes it anew"
    );
}

/// The pages for users, with the folder that their links start from.
fn pages() -> Vec<(String, PathBuf)> {
    let mut pages: Vec<String> = ["README.md", "CONTRIBUTING.md", "ARCHITECTURE.md"]
        .map(str::to_owned)
        .into();
    for entry in std::fs::read_dir(repository().join("docs")).expect("docs/") {
        let name = entry.expect("an entry").file_name();
        let name = name.to_str().expect("a name in UTF-8");
        if name.ends_with(".md") {
            pages.push(format!("docs/{name}"));
        }
    }
    let folder = |page: &str| {
        let path = repository().join(page);
        path.parent().expect("a folder").to_owned()
    };
    let pages = pages.into_iter();
    pages.map(|page| (page.clone(), folder(&page))).collect()
}

/// The blocks of a page in a language.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let text = read(page);
    let fence = format!("```{language}\n");
    let rest = text.split(fence.as_str()).skip(1);
    rest.map(|block| block.split("```").next().unwrap_or("").to_owned())
        .collect()
}

#[test]
fn links_and_pictures_of_the_pages_exist() {
    let mut count = 0;
    for (page, folder) in pages() {
        for part in read(&page).split("](").skip(1) {
            let target = part.split(')').next().unwrap_or("");
            // The page of releases is beside the repository's files, not among them.
            if target.contains("://") || target == "../../releases" {
                continue;
            }
            let (file, section) = target.split_once('#').unwrap_or((target, ""));
            let path = if file.is_empty() {
                repository().join(&page)
            } else {
                folder.join(file)
            };
            assert!(path.exists(), "{page} names {target}");
            if !section.is_empty() {
                let text = std::fs::read_to_string(&path).expect("a page");
                let heads = text.lines().filter(|line| line.starts_with('#'));
                let mut anchors = heads.map(|line| {
                    let head = line.trim_start_matches('#').trim().to_lowercase();
                    head.replace([',', '…'], "").replace(' ', "-")
                });
                assert!(anchors.any(|it| it == section), "{page} names {target}");
            }
            count += 1;
        }
    }
    assert!(count >= 80, "only {count} links were found");
}

#[test]
fn the_programs_of_the_readme_and_the_tutorial_compile() {
    let [first] = &blocks("README.md", "gtr")[..] else {
        panic!("README.md has one program");
    };
    assert_eq!(scene(first).objects.len(), 3);
    let steps = blocks("docs/tutorial.md", "gtr");
    assert_eq!(steps.len(), 4);
    for (k, program) in steps.iter().enumerate() {
        assert!(!scene(program).objects.is_empty());
        let file = format!("docs/tutorial/{}.gtr", k + 1);
        assert_eq!(*program, read(&file), "the tutorial shows {file}");
    }
}

/// The words behind `geotrace` in a command of the documentation; files of the repository are named by their paths.
fn words_of(line: &str) -> Vec<std::ffi::OsString> {
    let words = line.strip_prefix("geotrace ").expect("a command");
    let words = words.split_whitespace().map(|word| {
        let path = repository().join(word);
        if path.exists() {
            path.into_os_string()
        } else {
            word.into()
        }
    });
    words.collect()
}

/// A word's number, with what stands before and behind it.
fn number(word: &str) -> Option<(&str, f64, &str)> {
    let text = word.trim_matches(|c: char| !(c.is_ascii_digit() || c == '-'));
    let (before, behind) = word.split_once(text)?;
    Some((before, text.parse().ok()?, behind))
}

/// Compares two texts word by word: numbers to nine digits, but for estimates of errors, which are compared by their size.
fn is_same_text(a: &str, b: &str) -> bool {
    a.lines().count() == b.lines().count()
        && a.lines().zip(b.lines()).all(|(a, b)| {
            let is_near = |x: f64, y: f64| match a.contains("error estimate") {
                true => x == y || (0.2..=5.0).contains(&(x / y)),
                false => (x - y).abs() <= 1e-9 * x.abs().max(1.0),
            };
            let [words, others] = [a, b].map(|line| line.split_whitespace().collect::<Vec<_>>());
            let near = |(a, b): (&&str, &&str)| match (number(a), number(b)) {
                (Some((p, x, s)), Some((q, y, t))) => (p, s) == (q, t) && is_near(x, y),
                _ => a == b,
            };
            words.len() == others.len() && words.iter().zip(&others).all(near)
        })
}

#[test]
fn the_lesson_shows_what_its_commands_print() {
    let page = read("docs/lesson.md");
    let mut count = 0;
    for part in page.split("```sh\n").skip(1) {
        let (line, rest) = part.split_once("\n```\n\n").expect("a command");
        let Some(shown) = rest.strip_prefix("```text\n") else {
            continue;
        };
        let shown = shown.split("```").next().unwrap_or("");
        let run = geotrace(words_of(line)).run();
        let printed = &run.expect_status(0).stdout;
        assert!(is_same_text(shown, printed), "{line}\n{printed}");
        count += 1;
    }
    assert_eq!(count, 9);
    for (a, b) in [
        ("K = 1.0", "K = 1.1"),
        ("K = 1", "H = 1"),
        ("k1 = 2", "k2 = 2"),
        ("k1 = 2", "h1 = 2"),
        ("(1.5°)", "1.5°"),
        ("error estimate 1e-9", "error estimate 6e-9"),
        ("error estimate 1e-9", "error estimate 1e-10"),
        ("error estimate 1e-9", "error estimate -1e-9"),
    ] {
        assert!(!is_same_text(a, b), "{a} is not {b}");
    }
    assert!(is_same_text("(1.5°), 2", "(1.50000000001°), 2"));
    assert!(is_same_text("error estimate 1e-9", "error estimate 3e-9"));
}

/// Our own programs have the layout that `geotrace format` writes.
#[test]
fn programs_and_blocks_have_the_canonical_layout() {
    let laid_out = |what: &str, text: &str| {
        let edits =
            ide::geotrace::format::format(&ide::geotrace::GeotraceAnalysis::new(text), None);
        assert!(edits.is_empty(), "{what} is not laid out: {edits:?}");
    };
    let mut count = 0;
    for folder in ["examples", "docs/tutorial", "docs/lesson"] {
        for entry in std::fs::read_dir(repository().join(folder)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|ending| ending == "gtr") {
                let text = std::fs::read_to_string(&path).expect("a program");
                laid_out(&path.display().to_string(), &text);
                count += 1;
            }
        }
    }
    let mut pages: Vec<String> = pages().into_iter().map(|(page, _)| page).collect();
    pages.extend(
        [
            "editors/vscode/README.md",
            "editors/vscode/walkthrough/new.md",
        ]
        .map(str::to_owned),
    );
    for page in pages {
        for block in blocks(&page, "gtr") {
            laid_out(&page, &block);
            count += 1;
        }
    }
    for row in &TABLE {
        laid_out("an example of the table", &format!("{}\n", row.example));
        let text = read("editors/vscode/snippets/geotrace.json");
        assert!(
            !text.contains("},${"),
            "a snippet has no space after a comma"
        );
    }
    let text = read("README.md");
    for line in text.lines().filter_map(|line| line.strip_prefix("| `")) {
        let declaration = line.split('`').next().unwrap_or("");
        if declaration.ends_with(';') {
            laid_out("the table of README.md", &format!("{declaration}\n"));
            count += 1;
        }
    }
    assert!(count >= 40, "only {count} programs were found");
}

#[test]
fn the_commands_of_the_tutorial_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut count = 0;
    for block in blocks("docs/tutorial.md", "sh") {
        for line in block.lines() {
            let run = geotrace(words_of(line)).folder(folder.path()).run();
            run.expect_status(0);
            count += 1;
        }
    }
    assert_eq!(count, 3);
    for name in ["figure.png", "walk.gif", "torus.glb"] {
        assert!(folder.path().join(name).exists(), "{name} was not written");
    }
}

/// The words of a command, for a picture of few pixels, frames and samples.
fn small(line: &str) -> Vec<std::ffi::OsString> {
    // Behind it stands what is written, for the reader.
    let line = line.split(" #").next().unwrap_or("");
    let mut words = words_of(line);
    let renders = line.starts_with("geotrace render ");
    let moves = ["--animate", "--walk", "--turntable"].map(|it| line.contains(it));
    let is_traced = line.contains("--view traced") || line.contains(".crt");
    for (option, value, fits) in [
        ("--size", "40x30", renders),
        ("--frames", "3", renders && moves.contains(&true)),
        ("--samples", "1", renders && is_traced),
    ] {
        match words.iter().position(|word| word == option) {
            Some(k) => words[k + 1] = value.into(),
            None if fits => words.extend([option.into(), value.into()]),
            None => {}
        }
    }
    words
}

#[test]
fn the_commands_of_the_pages_on_output_solids_and_scripts_run() {
    for (page, expected) in [("output", 11), ("solids", 9), ("crt", 2)] {
        let folder = tempfile::tempdir().expect("a folder");
        let mut count = 0;
        for block in blocks(&format!("docs/{page}.md"), "sh") {
            for line in block.lines() {
                let words = small(line);
                let output = words.iter().position(|word| word == "-o");
                let output = output.map(|k| words[k + 1].clone());
                let run = geotrace(words).folder(folder.path()).run();
                run.expect_status(0);
                match output.filter(|name| name != "-") {
                    Some(name) => {
                        // Frames are numbered.
                        let first = name.to_string_lossy().replace(".png", "-0001.png");
                        let names = [folder.path().join(&name), folder.path().join(first)];
                        assert!(names.iter().any(|name| name.exists()), "{line}");
                    }
                    None => assert!(!run.stdout.is_empty(), "{line}"),
                }
                count += 1;
            }
        }
        assert_eq!(count, expected, "docs/{page}.md");
    }
}

#[test]
fn the_programs_and_scripts_of_the_pages_compile() {
    let languages: [(&str, &dyn Language); 2] = [("gtr", &Geotrace), ("crt", &Crt)];
    let mut counts = [0; 2];
    for (page, _) in pages() {
        for ((ending, language), count) in languages.iter().zip(&mut counts) {
            for block in blocks(&page, ending) {
                let compiled = language.compile(&block).expect("a small program");
                let mut found = compiled.diagnostics.iter();
                let error = found.find(|it| it.severity == Severity::Error);
                assert!(error.is_none(), "{page}: {error:?}\n{block}");
                *count += 1;
            }
        }
    }
    assert_eq!(counts, [16, 1]);
}

#[test]
fn the_commands_of_the_page_on_figures_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut count = 0;
    for block in blocks("docs/figures.md", "sh") {
        for line in block.lines() {
            let words = words_of(line);
            let output = words.iter().position(|word| word == "-o");
            let output = folder.path().join(&words[output.expect("a file") + 1]);
            geotrace(words).folder(folder.path()).run().expect_status(0);
            assert!(output.exists(), "{line}");
            count += 1;
        }
    }
    assert_eq!(count, 5);
}

/// The words of a text between two others.
fn words_between<'t>(path: &str, text: &'t str, start: &str, end: &str) -> BTreeSet<&'t str> {
    let (_, rest) = text
        .split_once(start)
        .unwrap_or_else(|| panic!("{path} has no `{start}`"));
    let list = rest.split_once(end).map_or(rest, |(list, _)| list);
    list.split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect()
}

#[test]
fn every_list_of_words_is_that_of_the_language() {
    let constants: BTreeSet<&str> = CONSTANTS.iter().map(|(name, ..)| *name).collect();
    // These are no operations on a number: the identity takes vectors too, the others only vectors.
    let functions = Unary::ALL.into_iter().filter_map(Unary::builtin);
    let functions: BTreeSet<&str> = functions.chain(["id", "min", "max"]).collect();
    // A soft keyword is a name elsewhere: the files for colours have patterns for the places where it stands.
    let (soft, keywords): (Vec<&DeclarationRow>, Vec<&DeclarationRow>) =
        TABLE.iter().partition(|row| row.keyword.is_soft());
    let [soft, keywords] =
        [soft, keywords].map(|rows| rows.iter().map(|row| row.text).collect::<BTreeSet<_>>());
    let attributes: BTreeSet<&str> = AttributeWord::ALL.map(AttributeWord::text).into();
    let maps: BTreeSet<&str> = MapWord::ALL.map(MapWord::text).into();
    let vim = "editors/neovim/syntax/geotrace.vim";
    let vscode = "editors/vscode/syntaxes/geotrace.tmLanguage.json";
    let indentation = "editors/vscode/language-configuration.json";
    let tree_sitter = "editors/tree-sitter/queries/highlights.scm";
    for (path, start, end, expected) in [
        ("README.md", "functions are `", "`", &functions),
        ("docs/language.md", "functions are `", "`", &functions),
        ("docs/language.md", "longer word:\n", ".\n", &keywords),
        ("docs/language.md", "declaration begins:\n", ".\n", &soft),
        (vim, "geotraceFunction ", "\n", &functions),
        (vim, "geotraceConstant ", "\n", &constants),
        (vim, "geotraceKeyword ", "\n", &keywords),
        (vim, r"geotraceKeyword /\v%(^|;)\s*\zs%(", ")", &soft),
        (
            vim,
            r"geotraceAttribute /\v%(^|,)\s*\zs%(",
            ")",
            &attributes,
        ),
        (vim, r"geotraceFunction /\v\@\s*\zs%(", ")", &maps),
        (
            vscode,
            r#"support.function.geotrace",
          "match": "\\b("#,
            ")",
            &functions,
        ),
        (
            vscode,
            r#"support.constant.geotrace", "match": "\\b("#,
            ")",
            &constants,
        ),
        (
            vscode,
            r#""keyword": {
      "match": "\\b("#,
            ")",
            &keywords,
        ),
        (
            indentation,
            r#"increaseIndentPattern": "^\\s*(("#,
            ")",
            &keywords,
        ),
        (indentation, r")\\b|(", ")", &soft),
        (indentation, r"[)\\]}]|(", ")", &soft),
        (indentation, "[=(]|(", ")", &keywords),
        (tree_sitter, "any-of? @function.builtin", ")", &functions),
        (tree_sitter, "any-of? @constant.builtin", ")", &constants),
        (
            vscode,
            r#""map": {
      "comment": "Behind the @ of a set.",
      "match": "(?<=@)\\s*("#,
            ")",
            &maps,
        ),
        (vscode, r"(?:^|(?<=,))\\s*(", ")", &attributes),
        (tree_sitter, "[", "]", &keywords),
        (tree_sitter, "@keyword\n[", "]", &soft),
        (tree_sitter, "\"background\"] @keyword\n[", "]", &maps),
    ] {
        let text = read(path);
        assert_eq!(
            words_between(path, &text, start, end),
            *expected,
            "{path}: {start}"
        );
    }
}

#[test]
fn the_page_of_the_language_has_every_attribute_with_its_declarations_its_range_and_its_default() {
    let mut lines = vec!["| attribute | on | value | default | what it is |".to_owned()];
    lines.push("| --- | --- | --- | --- | --- |".to_owned());
    for row in &attributes::TABLE {
        let on: Vec<&str> = row.on.iter().map(|keyword| keyword.text()).collect();
        let value = match row.value {
            AttributeType::Number(range) => range.text().unwrap_or("a number").to_owned(),
            AttributeType::Colour(range) => {
                let range = range.text().unwrap_or("a number");
                format!("{range}, or three")
            }
            AttributeType::Pair => "two numbers".to_owned(),
            AttributeType::Choice(words) => format!("`{}`", words.join("` `")),
            AttributeType::Name => "a word".to_owned(),
        };
        lines.push(format!(
            "| `{}` | {} | {value} | {} | {}, as in `{}` |",
            row.text,
            on.join(", "),
            row.default,
            row.purpose,
            row.example
        ));
    }
    let table = lines.join("\n");
    let path = repository().join("docs/language.md");
    let page = read("docs/language.md");
    if writes_expected() {
        let (before, rest) = page.split_once("| attribute |").expect("the table");
        let (_, after) = rest.split_once("\n\n").expect("the end of the table");
        std::fs::write(path, format!("{before}{table}\n\n{after}")).expect("the page is writable");
        return;
    }
    assert!(
        page.contains(&table),
        "docs/language.md is old; UPDATE=1 writes it anew"
    );
}

#[test]
fn the_gallery_shows_every_example() {
    let text = read("README.md");
    for example in testing::examples::all() {
        let name = example.name;
        let cell = format!("](docs/images/gallery/{name}.png)](examples/{name}.gtr)");
        assert!(text.contains(&cell), "README.md does not show {name}.gtr");
    }
}

/// The pictures that stand in the docs are those that the program draws now.
#[test]
fn the_pictures_of_the_docs_are_drawn_as_they_stand() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = std::process::Command::new("bash")
        .arg(repository().join("docs/pictures"))
        .arg(folder.path())
        .env("GEOTRACE_BIN", testing::binary::binary())
        .env("GEOTRACE_STILLS", "1")
        .output()
        .expect("bash");
    let printed = String::from_utf8_lossy(&script.stderr);
    assert!(script.status.success(), "{printed}");
    let gallery = Path::new("gallery");
    let mut count = 0;
    for part in ["".as_ref(), gallery] {
        for entry in std::fs::read_dir(folder.path().join(part)).expect("a folder") {
            let entry = entry.expect("an entry");
            if entry.path().is_dir() {
                continue;
            }
            let name = part.join(entry.file_name());
            let kept = repository().join("docs/images").join(&name);
            let [drawn, kept] = [entry.path(), kept].map(|path| {
                let image = image::open(&path);
                image
                    .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
                    .to_rgba8()
            });
            let difference = difference(&drawn, &kept, 12);
            assert!(
                difference.share <= 0.002,
                "{}: {difference:?}; look at what `bash docs/pictures` draws",
                name.display()
            );
            count += 1;
        }
    }
    assert!(count >= 40, "only {count} pictures were drawn");
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
    // A solid is declared by a function or as a set.
    let count = DeclarationKeyword::ALL.len() + 1;
    assert_eq!(program.lines().count(), count, "{program}");
    scene(&program);
}

#[test]
fn the_files_that_the_readme_names_exist() {
    for path in [
        "tests/run",
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
