//! The programs in the folders of a workspace.

use std::collections::HashSet;
use std::fs::DirEntry;
use std::path::{Path, PathBuf};

use ide::Languages;
use ide::language::LONGEST_PROGRAM;
use ide::limited::read_file;

/// The maximum number of programs that are found, …
const MOST: usize = 2000;
/// … of folders, …
const MOST_FOLDERS: usize = 5000;
/// … and of nested folders.
const DEEPEST: usize = 12;

/// Returns the files with an extension of one of the languages, in the folders and their subfolders. Hidden files and
/// those of tools are skipped, and files whose paths are not UTF-8, for which no URI stands.
pub(crate) fn programs(folders: &[PathBuf], languages: &Languages) -> Vec<PathBuf> {
    let mut programs = Vec::new();
    let mut open: Vec<(PathBuf, usize)> = folders.iter().map(|f| (f.clone(), 0)).collect();
    // A folder may lie in another one.
    let mut visited: HashSet<PathBuf> = HashSet::new();
    'search: while let Some((folder, depth)) = open.pop() {
        if !visited.insert(folder.clone()) {
            continue;
        }
        if visited.len() > MOST_FOLDERS {
            break;
        }
        let Ok(entries) = std::fs::read_dir(&folder) else {
            continue;
        };
        // Sorted, so that the result does not depend on the order in which the system lists the entries.
        let mut entries: Vec<_> = entries.flatten().collect();
        entries.sort_by_key(DirEntry::file_name);
        for entry in entries {
            let path = entry.path();
            // A link may lead back to a parent: only real entries count.
            let Ok(kind) = entry.file_type() else {
                continue;
            };
            if kind.is_dir() && depth < DEEPEST && !is_skipped(&path) {
                open.push((path, depth + 1));
            } else if kind.is_file()
                && path.to_str().is_some()
                && languages.by_extension(&path).is_some()
            {
                programs.push(path);
                if programs.len() >= MOST {
                    break 'search;
                }
            }
        }
    }
    programs.sort();
    programs
}

/// Reads a program. Returns `None` if it cannot be read, is too long or is not UTF-8.
pub(crate) fn read(path: &Path) -> Option<String> {
    String::from_utf8(read_file(path, LONGEST_PROGRAM).ok()?).ok()
}

fn is_skipped(folder: &Path) -> bool {
    let name = folder.file_name().and_then(|name| name.to_str());
    name.is_none_or(|name| name.starts_with('.') || matches!(name, "target" | "node_modules"))
}

#[cfg(test)]
mod tests {
    use super::{Languages, programs};

    #[test]
    fn a_program_of_nested_folders_is_found_once() {
        let folder = std::env::temp_dir().join(format!("geotrace-nested-{}", std::process::id()));
        let inner = folder.join("inner");
        std::fs::create_dir_all(&inner).expect("a folder");
        std::fs::write(inner.join("a.gtr"), "").expect("a file");
        let languages = Languages::standard();
        for folders in [
            [folder.clone(), inner.clone()],
            [inner.clone(), folder.clone()],
        ] {
            assert_eq!(programs(&folders, &languages), [inner.join("a.gtr")]);
        }
        std::fs::remove_dir_all(&folder).expect("the folder");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_program_whose_name_is_no_text_is_skipped() {
        use std::os::unix::ffi::OsStrExt as _;

        let folder = std::env::temp_dir().join(format!("geotrace-no-text-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        for name in [&b"a\xFF.gtr"[..], b"b.gtr"] {
            let name = std::ffi::OsStr::from_bytes(name);
            std::fs::write(folder.join(name), "").expect("a file");
        }
        let found = programs(std::slice::from_ref(&folder), &Languages::standard());
        assert_eq!(found, [folder.join("b.gtr")]);
        std::fs::remove_dir_all(&folder).expect("the folder");
    }
}
