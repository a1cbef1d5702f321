//! The images that a program names: words flow in, files flow out.

use std::path::{Path, PathBuf};

/// The endings of the files that a word may stand for, the first first.
const ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// The file of an image that a program names: `earth` is `earth.png`, `earth.jpg` or `earth.jpeg` in the first folder that has
/// one of them. Only regular files count.
pub fn named_file(word: &str, folders: &[PathBuf]) -> Option<PathBuf> {
    let file = |folder: &PathBuf| {
        let files = ENDINGS.map(|ending| folder.join(format!("{word}.{ending}")));
        files.into_iter().find(|file| file.is_file())
    };
    // A word is one name: it leads into no other folder.
    let is_name = Path::new(word).file_name().is_some_and(|name| name == word);
    is_name.then(|| folders.iter().find_map(file)).flatten()
}

/// A sentence about an image that a program names and that no folder has.
pub fn missing_file(word: &str) -> String {
    let [a, b, c] = ENDINGS;
    format!("the image `{word}` is not shown: there is no {word}.{a}, {word}.{b} or {word}.{c}")
}
