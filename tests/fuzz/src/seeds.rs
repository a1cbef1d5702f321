//! The seeds of mutation: files of the repository that the targets read as they are.

use std::path::{Path, PathBuf};

/// The root of the repository.
fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The files of a folder with one of these extensions, in the order of their names.
fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| {
        let extension = path.extension().unwrap_or_default();
        extensions.iter().any(|known| extension == *known)
    });
    paths.sort();
    paths
}

fn contents(paths: &[PathBuf]) -> impl Iterator<Item = Vec<u8>> {
    paths
        .iter()
        .map(|path| std::fs::read(path).expect("a seed can be read"))
}

/// The inputs that once found a mistake in a target.
pub(crate) fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("corpus")
        .join(target);
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    contents(&paths).collect()
}

/// Programs of Geotrace: the examples, and the programs of the language cases.
pub(crate) fn programs() -> Vec<Vec<u8>> {
    let root = repository();
    let mut all: Vec<Vec<u8>> = contents(&files(&root.join("examples"), &["gtr"])).collect();
    all.extend(cases(|name| !name.starts_with("crt_")));
    assert!(all.len() > 100, "only {} programs", all.len());
    all
}

/// CRT scripts: the examples, and the scripts of the language cases.
pub(crate) fn scripts() -> Vec<Vec<u8>> {
    let root = repository();
    let mut all: Vec<Vec<u8>> = contents(&files(&root.join("examples"), &["crt"])).collect();
    all.extend(cases(|name| name.starts_with("crt_")));
    assert!(all.len() > 20, "only {} scripts", all.len());
    all
}

/// The texts of the language cases in the files that are wanted: what is indented below a title.
fn cases(is_wanted: impl Fn(&str) -> bool) -> Vec<Vec<u8>> {
    let paths = files(&repository().join("tests/cases/language"), &["cases"]);
    let mut all = Vec::new();
    for path in paths {
        if !is_wanted(&path.file_name().unwrap_or_default().to_string_lossy()) {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("cases are UTF-8");
        for case in text.split("\n=== ").skip(1) {
            let lines = case.lines().filter_map(|line| line.strip_prefix("  "));
            let program: Vec<&str> = lines.collect();
            all.push(program.join("\n").into_bytes());
        }
    }
    all
}

/// Pictures: the small ones of the documentation.
pub(crate) fn pictures() -> Vec<Vec<u8>> {
    let paths = files(&repository().join("docs/images/gallery"), &["png"]);
    let mut all: Vec<Vec<u8>> = contents(&paths).collect();
    all.sort_by_key(Vec::len);
    all.truncate(6);
    assert!(!all.is_empty(), "no pictures");
    all
}
