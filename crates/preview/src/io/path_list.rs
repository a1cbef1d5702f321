//! The programs and images that were opened last: lists of paths in the user's state folder, which all windows share.
//!
//! They are a convenience: a list that cannot be read is empty, and one that cannot be written is not kept.

use std::path::{Path, PathBuf};

use export::whole_file::write_whole;
use serde_json::Value;

/// The maximum length of a list's file that is read, in bytes.
const LONGEST: u64 = 1 << 20;

/// The paths of a kind, newest first.
#[derive(Debug, Default)]
pub(crate) struct PathList {
    /// The file with the list; `None` if nothing is to be remembered.
    file: Option<PathBuf>,
    paths: Vec<PathBuf>,
    /// The maximum number of paths.
    most: usize,
}

impl PathList {
    /// Reads the list of programs in a folder.
    pub(crate) fn programs(folder: &Path) -> Self {
        Self::new(folder.join("recent.json"), 10)
    }

    /// Reads the list of images in a folder.
    pub(crate) fn images(folder: &Path) -> Self {
        Self::new(folder.join("images.json"), 1000)
    }

    fn new(file: PathBuf, most: usize) -> Self {
        Self {
            paths: read(&file, most),
            file: Some(file),
            most,
        }
    }

    /// Returns the paths, newest first.
    pub(crate) fn paths(&self) -> &[PathBuf] {
        &self.paths
    }

    /// Returns true if a path is on the list.
    pub(crate) fn contains(&self, path: &Path) -> bool {
        std::path::absolute(path).is_ok_and(|path| self.paths.contains(&path))
    }

    /// Moves a path to the head of the list.
    pub(crate) fn note(&mut self, path: &Path) {
        let Ok(path) = std::path::absolute(path) else {
            return;
        };
        let most = self.most;
        self.write(|paths| {
            paths.retain(|it| *it != path);
            paths.insert(0, path.clone());
            paths.truncate(most);
        });
    }

    /// Removes a path from the list.
    pub(crate) fn forget(&mut self, path: &Path) {
        self.write(|paths| paths.retain(|it| it != path));
    }

    /// Changes the current list, which another window may have changed.
    fn write(&mut self, change: impl FnOnce(&mut Vec<PathBuf>)) {
        let Some(file) = &self.file else {
            return;
        };
        self.paths = read(file, self.most);
        let before = self.paths.clone();
        change(&mut self.paths);
        if self.paths == before {
            return;
        }
        let texts = self.paths.iter().filter_map(|path| path.to_str());
        let list = Value::from_iter(texts);
        if let Some(folder) = file.parent()
            && std::fs::create_dir_all(folder).is_ok()
        {
            let _ = write_whole(file, format!("{list:#}\n").as_bytes());
        }
    }
}

/// Returns the paths of a list; invalid ones are left out.
fn read(file: &Path, most: usize) -> Vec<PathBuf> {
    let bytes = ide::limited::read_file(file, LONGEST).unwrap_or_default();
    let Ok(Value::Array(entries)) = serde_json::from_slice(&bytes) else {
        return Vec::new();
    };
    let paths = entries.iter().filter_map(Value::as_str).map(PathBuf::from);
    paths.filter(|path| path.is_absolute()).take(most).collect()
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::PathList;

    /// The number of programs that are listed.
    const MOST: usize = 10;

    fn absolute(name: &str) -> PathBuf {
        std::path::absolute(Path::new("/programs").join(name)).expect("a path")
    }

    #[test]
    fn the_newest_program_is_the_first_and_each_is_listed_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path().join("not/there/yet");
        let mut list = PathList::programs(&folder);
        for k in 0..MOST + 3 {
            list.note(&absolute(&format!("{k}.gtr")));
        }
        list.note(&absolute("5.gtr"));
        assert_eq!(list.paths().len(), MOST);
        let expected = [absolute("5.gtr"), absolute("12.gtr"), absolute("11.gtr")];
        assert_eq!(list.paths()[..3], expected);
        assert_eq!(PathList::programs(&folder).paths(), list.paths());
        // Of two windows, each keeps what the other has noted.
        let mut other = PathList::programs(&folder);
        other.note(&absolute("other.gtr"));
        list.forget(&absolute("5.gtr"));
        assert_eq!(list.paths()[0], absolute("other.gtr"));
        assert!(!list.paths().contains(&absolute("5.gtr")));
    }

    #[test]
    fn a_list_that_is_broken_is_empty_and_is_written_anew() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("recent.json");
        for broken in ["", "{", "{}", "[1, null, \"relative.gtr\"]", "\u{0}"] {
            std::fs::write(&file, broken).expect("written");
            let mut list = PathList::programs(folder.path());
            assert!(list.paths().is_empty(), "{broken}");
            list.note(&absolute("a.gtr"));
            let again = PathList::programs(folder.path());
            assert_eq!(again.paths(), [absolute("a.gtr")]);
        }
    }

    #[test]
    fn without_a_folder_nothing_is_listed() {
        let mut list = PathList::default();
        list.note(&absolute("a.gtr"));
        assert!(list.paths().is_empty());
    }
}
