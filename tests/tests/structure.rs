//! The structure of the code: what imports what, what few files may name, which words are no longer used.

use std::collections::BTreeSet;
use std::path::PathBuf;

use testing::examples::repository;
use testing::structure::{self, File};

#[test]
fn no_modules_import_each_other_in_a_cycle() {
    let files = structure::files();
    let cycles = structure::cycles(files);
    assert!(cycles.is_empty(), "modules import each other: {cycles:#?}");
}

#[test]
fn few_files_name_a_view_a_shape_or_a_keyword() {
    let files = structure::files();
    for limit in structure::limits(files) {
        assert!(
            limit.files.len() <= limit.most,
            "{}: {}, at most {}: {:#?}",
            limit.what,
            limit.files.len(),
            limit.most,
            limit.files
        );
    }
}

/// The names of types that are declared three times or more, each with the reason.
const REPEATED: &[(&str, &str)] = &[
    (
        "Arguments",
        "one for each sub-command, in its module, as clap's examples have it",
    ),
    (
        "Body",
        "a nonterminal of one language, statements between braces of the other, and a message's",
    ),
    (
        "Interval",
        "a parameter's as it is written, a part of a fan's ray, and the numbers of interval arithmetic",
    ),
    (
        "Lexeme",
        "a token as each language's lexer reads it, and as an editor sees it",
    ),
    (
        "Piece",
        "a part of a script, of a generated text, and of a path",
    ),
    (
        "Ray",
        "a geodesic that is integrated, one of a fan, and a straight half-line: none imports another",
    ),
];

#[test]
fn no_name_of_a_type_is_declared_three_times_without_a_reason() {
    let files = structure::files();
    let mut types = structure::types(files);
    types.retain(|_, places| places.len() > 2);
    let expected: Vec<&str> = REPEATED.iter().map(|(name, _)| *name).collect();
    let found: Vec<&String> = types.keys().collect();
    assert_eq!(found, expected, "{types:#?}");
}

/// Words for which the field has a standard term; ARCHITECTURE.md has the glossary.
const RETIRED: &[&str] = &[
    "artist",
    "easel",
    "mender",
    "hung",
    "pilot",
    "studio",
    "workshop",
    "shelf",
    "racks",
    "trickle",
    "keeper",
    "mail",
    "standing",
    "hands",
    "telling",
    "desk",
    "worn",
    "leniency",
    "launcher",
    "patience",
    "tally",
    "untold",
    "runner",
    "patchwork",
];

#[test]
fn retired_words_are_not_used_for_names() {
    let retired: BTreeSet<&str> = RETIRED.iter().copied().collect();
    let mut found = Vec::new();
    let files = structure::files().iter();
    let files = files.map(|file| (file.path.clone(), structure::words(file)));
    let scripts = structure::scripts();
    assert!(scripts.len() > 40, "only {} scripts", scripts.len());
    for (path, words) in files.chain(scripts) {
        let used = words.iter().filter(|it| retired.contains(it.as_str()));
        let used: Vec<&String> = used.collect();
        if !used.is_empty() {
            found.push(format!("{}: {used:?}", path.display()));
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// Words that make a relative clause of a sentence, where documentation says what an item is or does.
const FRAGMENTS: &[&str] = &[
    "How", "What", "Where", "Whether", "Which", "Who", "Whose", "Why",
];

#[test]
fn documentation_begins_with_a_subject_or_a_verb() {
    let mut found = Vec::new();
    for file in structure::files() {
        // The documentation of a command's arguments is their help.
        let is_help = file.path.starts_with("crates/cli/src/command");
        if is_help {
            continue;
        }
        for begin in documentation(&file.text) {
            let first = begin.split(|c: char| !c.is_alphanumeric()).next();
            if first.is_some_and(|word| FRAGMENTS.contains(&word)) {
                found.push(format!("{}: {begin}", file.path.display()));
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// The first lines of the documentation comments of a file.
fn documentation(text: &str) -> Vec<&str> {
    let mut begins = Vec::new();
    let mut is_inside = false;
    for line in text.lines().map(str::trim_start) {
        let line = line.strip_prefix("///").or(line.strip_prefix("//!"));
        if let Some(line) = line.filter(|_| !is_inside) {
            begins.push(line.trim_start());
        }
        is_inside = line.is_some();
    }
    begins
}

#[test]
fn a_comment_that_is_a_fragment_would_be_found() {
    let text = "//! What flows.\n//! Where.\n\n    /// The place.\nfn f() {} // Who.";
    assert_eq!(documentation(text), ["What flows.", "The place."]);
}

#[test]
fn a_folder_of_modules_stands_beside_the_file_that_declares_them() {
    let folders: Vec<PathBuf> = structure::files()
        .iter()
        .map(|file| file.path.clone())
        .filter(|path| path.ends_with("mod.rs"))
        .collect();
    assert!(folders.is_empty(), "{folders:#?}");
}

/// The files of a crate below a folder of its `src`, or not below it.
fn files_of(krate: &str, folder: &str, below: bool) -> Vec<&'static File> {
    let mut files: Vec<&File> = structure::files().iter().collect();
    files.retain(|file| {
        let is_below = file.modules.first().is_some_and(|module| module == folder);
        file.krate == krate && is_below == below && !file.modules.is_empty()
    });
    assert!(!files.is_empty(), "no files in `{krate}`");
    files
}

#[test]
fn the_kernels_of_syntax_and_scene_do_not_import_a_language() {
    for krate in ["syntax", "scene"] {
        for file in files_of(krate, "geotrace", false) {
            let imports = file.imports();
            assert!(
                !imports.contains("geotrace"),
                "{} imports a language",
                file.path.display()
            );
        }
    }
}

/// What stands between backticks and looks like a path of the repository.
fn paths(text: &str) -> Vec<&str> {
    let ends = [
        ".rs", ".md", ".gtr", ".wgsl", ".toml", ".snap", ".cases", ".mjs", ".py",
    ];
    let in_code = text.split('`').skip(1).step_by(2);
    let linked = text
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next());
    in_code
        .chain(linked)
        .filter(|it| !it.contains(|c: char| c.is_whitespace() || "*<>{}…:,()".contains(c)))
        .filter(|it| {
            it.contains('/') && (ends.iter().any(|end| it.ends_with(end)) || it.ends_with('/'))
        })
        .filter(|it| !it.starts_with("//") && !it.starts_with("../"))
        .collect()
}

#[test]
fn the_paths_that_the_documents_name_exist() {
    let mut missing = Vec::new();
    let mut count = 0;
    for document in documents() {
        let text = std::fs::read_to_string(&document).expect("a document");
        let folder = document.parent().expect("a folder");
        for path in paths(&text) {
            count += 1;
            let path = path.trim_start_matches('/');
            let crates = repository().join("crates");
            let places = [&repository(), &crates, folder].map(|place| place.join(path));
            if !places.iter().any(|place| place.exists()) {
                missing.push(format!("{}: {path}", document.display()));
            }
        }
    }
    assert!(count > 10, "only {count} paths were found");
    assert!(missing.is_empty(), "{missing:#?}");
}

/// The documents of the repository and the pages of `docs/`.
fn documents() -> Vec<PathBuf> {
    let names = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"];
    let mut documents: Vec<PathBuf> = names.map(|name| repository().join(name)).into();
    let pages = std::fs::read_dir(repository().join("docs")).expect("a folder of pages");
    let pages = pages.map(|page| page.expect("a readable folder").path());
    documents.extend(pages.filter(|page| page.extension().is_some_and(|end| end == "md")));
    documents
}

#[test]
fn paths_in_code_and_in_links_are_found() {
    assert_eq!(
        paths("see `no/such.rs` and [a](docs/b.md), `a / b`"),
        ["no/such.rs", "docs/b.md"]
    );
}

#[test]
fn the_glossary_says_where_each_word_is() {
    let text = std::fs::read_to_string(repository().join("ARCHITECTURE.md")).expect("a map");
    let glossary = text.split("\n## ").find(|it| it.starts_with("Glossary"));
    let rows = glossary.expect("a glossary").lines();
    let places = rows.filter_map(|row| row.strip_suffix(" |")?.rsplit(" | ").next());
    let places = places.flat_map(|it| it.split('`').skip(1).step_by(2));
    let places: BTreeSet<&str> = places.collect();
    assert!(places.len() > 30, "{places:?}");
    let missing: Vec<&&str> = places.iter().filter(|it| !is_item(it)).collect();
    assert!(missing.is_empty(), "{missing:#?}");
    assert!(!is_item("scene::no_such_module") && !is_item("scene::NoSuchType"));
}

/// True if there is something with this path: modules of a crate, then a type, then what that has.
fn is_item(path: &str) -> bool {
    let mut parts = path.split("::");
    let krate = parts.next();
    let parts: Vec<&str> = parts.collect();
    let is_type = |part: &&str| part.starts_with(char::is_uppercase);
    let (modules, names) = parts.split_at(parts.iter().position(is_type).unwrap_or(parts.len()));
    let own = structure::files().iter();
    let own: Vec<&File> = own.filter(|file| Some(&*file.krate) == krate).collect();
    let is_below = |file: &&File| modules.iter().zip(&file.modules).all(|(a, b)| a == b);
    let has_modules = |file: &&File| file.modules.len() >= modules.len() && is_below(file);
    let is_named = |name: &&str| own.iter().any(|file| file.names(name));
    own.iter().any(has_modules) && names.iter().all(is_named)
}
