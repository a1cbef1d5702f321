//! The programs that were opened last: a list of paths in the user's state folder, which all windows share.
//!
//! It is a convenience: a list that cannot be read is empty, and one that cannot be written is not kept.

use std::path::{Path, PathBuf};

use export::whole_file::write_whole;
use serde_json::Value;

/// The number of programs that are listed.
const MOST: usize = 10;

/// The list, newest first.
#[derive(Debug, Default)]
pub(crate) struct RecentPrograms {
    /// The file with the list; none where nothing is to be remembered.
    file: Option<PathBuf>,
    paths: Vec<PathBuf>,
}

impl RecentPrograms {
    /// Reads the list that is kept in a folder.
    pub(crate) fn in_folder(folder: &Path) -> Self {
        let file = folder.join("recent.json");
        let paths = read(&file);
        Self {
            file: Some(file),
            paths,
        }
    }

    /// The programs, newest first.
    pub(crate) fn paths(&self) -> &[PathBuf] {
        &self.paths
    }

    /// Puts a program at the head of the list.
    pub(crate) fn note(&mut self, program: &Path) {
        let Ok(program) = std::path::absolute(program) else {
            return;
        };
        self.write(|paths| {
            paths.retain(|path| *path != program);
            paths.insert(0, program.clone());
            paths.truncate(MOST);
        });
    }

    /// Takes a program off the list.
    pub(crate) fn forget(&mut self, program: &Path) {
        self.write(|paths| paths.retain(|path| path != program));
    }

    /// Changes the list as it is now: another window may have changed it.
    fn write(&mut self, change: impl FnOnce(&mut Vec<PathBuf>)) {
        let Some(file) = &self.file else {
            return;
        };
        self.paths = read(file);
        change(&mut self.paths);
        let texts = self.paths.iter().filter_map(|path| path.to_str());
        let list = Value::from_iter(texts);
        if let Some(folder) = file.parent()
            && std::fs::create_dir_all(folder).is_ok()
        {
            let _ = write_whole(file, format!("{list:#}\n").as_bytes());
        }
    }
}

/// Returns the paths of a list; those that make no sense are left out.
fn read(file: &Path) -> Vec<PathBuf> {
    let bytes = std::fs::read(file).unwrap_or_default();
    let Ok(Value::Array(entries)) = serde_json::from_slice(&bytes) else {
        return Vec::new();
    };
    let paths = entries.iter().filter_map(Value::as_str).map(PathBuf::from);
    paths.filter(|path| path.is_absolute()).take(MOST).collect()
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::{MOST, RecentPrograms};

    fn absolute(name: &str) -> PathBuf {
        std::path::absolute(Path::new("/programs").join(name)).expect("a path")
    }

    #[test]
    fn the_newest_program_is_the_first_and_each_is_listed_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path().join("not/there/yet");
        let mut list = RecentPrograms::in_folder(&folder);
        for k in 0..MOST + 3 {
            list.note(&absolute(&format!("{k}.gtr")));
        }
        list.note(&absolute("5.gtr"));
        assert_eq!(list.paths().len(), MOST);
        let expected = [absolute("5.gtr"), absolute("12.gtr"), absolute("11.gtr")];
        assert_eq!(list.paths()[..3], expected);
        assert_eq!(RecentPrograms::in_folder(&folder).paths(), list.paths());
        // Of two windows, each keeps what the other has noted.
        let mut other = RecentPrograms::in_folder(&folder);
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
            let mut list = RecentPrograms::in_folder(folder.path());
            assert!(list.paths().is_empty(), "{broken}");
            list.note(&absolute("a.gtr"));
            let again = RecentPrograms::in_folder(folder.path());
            assert_eq!(again.paths(), [absolute("a.gtr")]);
        }
    }

    #[test]
    fn without_a_folder_nothing_is_listed() {
        let mut list = RecentPrograms::default();
        list.note(&absolute("a.gtr"));
        assert!(list.paths().is_empty());
    }
}
