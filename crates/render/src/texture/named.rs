//! The images that a program names. In: names. Out: files.

use std::path::{Component, Path, PathBuf};

/// The extensions of the files that a word may refer to, in order of preference.
const ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// Returns the file of an image that a program names, in the first folder that has one of [`named_files`]. Only regular
/// files count.
pub fn named_file(name: &str, folders: &[PathBuf]) -> Option<PathBuf> {
    let file = |folder: &PathBuf| {
        named_files(name, folder)
            .into_iter()
            .find(|it| it.is_file())
    };
    folders.iter().find_map(file)
}

/// Returns the files in a folder that an image's name may refer to, in order of preference. The word `earth` refers to
/// `earth.png`, `earth.jpg` or `earth.jpeg`; a path whose last part has an extension, as in scripts, refers to itself: a
/// leading `/` is dropped, and a path with `..` refers to nothing.
pub fn named_files(name: &str, folder: &Path) -> Vec<PathBuf> {
    let Some(path) = path_below(name) else {
        return Vec::new();
    };
    let below = folder.join(path);
    match has_ending(path) {
        true => vec![below],
        false => ENDINGS.map(|ending| below.with_extension(ending)).to_vec(),
    }
}

/// Returns a sentence about an image that a program names and that none of these folders, that of the program and perhaps
/// another one, has as a regular file.
pub fn missing_file(name: &str, folders: &[PathBuf]) -> String {
    let hidden = format!("the image `{name}` is not shown");
    let mut files = folders.iter().flat_map(|it| named_files(name, it));
    // A directory, a pipe, a dangling link.
    if let Some(other) = files.find(|it| it.symlink_metadata().is_ok()) {
        return format!("{hidden}: {} is not a regular file", other.display());
    }
    let place = match folders {
        [_, other] => format!("beside the program or in {}", other.display()),
        _ => "beside the program".to_owned(),
    };
    let [a, b, c] = ENDINGS;
    match path_below(name) {
        None if !name.contains("..") => format!("{hidden}: its path names no file"),
        None => {
            format!("{hidden}: its path leads out of the program's folder; name it without `..`")
        }
        Some(path) if has_ending(path) => {
            format!("{hidden}: there is no {} {place}", path.display())
        }
        Some(_) => format!("{hidden}: there is no {name}.{a}, {name}.{b} or {name}.{c} {place}"),
    }
}

/// Returns the path below a folder that a name refers to; `None` if it leads out of the folder.
fn path_below(name: &str) -> Option<&Path> {
    let path = Path::new(name.trim_start_matches(['/', '\\']));
    let mut parts = path.components();
    let is_below = parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    (is_below && path.file_name().is_some()).then_some(path)
}

fn has_ending(path: &Path) -> bool {
    path.extension().is_some()
}
