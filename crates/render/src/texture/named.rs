//! The images that a program names: words flow in, files flow out.

use std::path::{Component, Path, PathBuf};

/// The endings of the files that a word may stand for, the first first.
const ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// The file of an image that a program names, in the first folder that has one of [`named_files`]. Only regular files count.
pub fn named_file(name: &str, folders: &[PathBuf]) -> Option<PathBuf> {
    let file = |folder: &PathBuf| {
        named_files(name, folder)
            .into_iter()
            .find(|it| it.is_file())
    };
    folders.iter().find_map(file)
}

/// The files in a folder that an image's name may stand for, the first first. The word `earth` is `earth.png`, `earth.jpg` or
/// `earth.jpeg`; a path whose last part has an ending, as scripts write it, is itself: a `/` in front is dropped, and one with
/// `..` leads nowhere.
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

/// A sentence about an image that a program names and that none of these folders, that of the program and perhaps another
/// one, has as a regular file.
pub fn missing_file(name: &str, folders: &[PathBuf]) -> String {
    let hidden = format!("the image `{name}` is not shown");
    let mut files = folders.iter().flat_map(|it| named_files(name, it));
    // A directory, a pipe, a link that leads nowhere.
    if let Some(other) = files.find(|it| it.symlink_metadata().is_ok()) {
        return format!("{hidden}: {} is not a regular file", other.display());
    }
    let place = match folders {
        [_, other] => format!("beside the program or in {}", other.display()),
        _ => "beside the program".to_owned(),
    };
    let [a, b, c] = ENDINGS;
    match path_below(name) {
        None => {
            format!("{hidden}: its path leads out of the program's folder; name it without `..`")
        }
        Some(path) if has_ending(path) => {
            format!("{hidden}: there is no {} {place}", path.display())
        }
        Some(_) => format!("{hidden}: there is no {name}.{a}, {name}.{b} or {name}.{c} {place}"),
    }
}

/// The path below a folder that a name stands for; `None` if it leads out of it.
fn path_below(name: &str) -> Option<&Path> {
    let path = Path::new(name.trim_start_matches(['/', '\\']));
    let mut parts = path.components();
    let is_below = parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    (is_below && path.file_name().is_some()).then_some(path)
}

fn has_ending(path: &Path) -> bool {
    path.extension().is_some()
}
