//! The programs under `examples/`.

use std::path::PathBuf;

/// One example.
#[derive(Clone, Debug)]
pub struct Example {
    /// Its file name without the ending.
    pub name: String,
    /// Its file.
    pub path: PathBuf,
    /// Its text.
    pub source: String,
}

/// The root of the repository.
pub fn repository() -> PathBuf {
    let mut path = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    path.pop();
    path
}

/// All examples, by name.
///
/// # Panics
/// When the folder cannot be read, or holds nothing: a suite over no example would pass for nothing.
pub fn all() -> Vec<Example> {
    let folder = repository().join("examples");
    let entries = std::fs::read_dir(&folder).expect("examples/ is readable");
    let mut examples: Vec<Example> = entries
        .map(|entry| entry.expect("examples/ is readable").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "gtr"))
        .map(|path| Example {
            name: path
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            source: std::fs::read_to_string(&path).expect("an example is UTF-8"),
            path,
        })
        .collect();
    examples.sort_by(|a, b| a.name.cmp(&b.name));
    assert!(examples.len() >= 16, "only {} examples", examples.len());
    examples
}

/// One example by its name.
///
/// # Panics
/// When there is none.
pub fn one(name: &str) -> Example {
    all()
        .into_iter()
        .find(|example| example.name == name)
        .unwrap_or_else(|| panic!("there is no example {name}"))
}
