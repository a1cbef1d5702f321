//! Files that are whole or not there: each is written beside its place and renamed.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Writes a file beside its place and renames it.
///
/// # Errors
/// The system's; the old file stands.
pub(crate) fn write_whole(place: &Path, bytes: &[u8]) -> io::Result<()> {
    write_whole_with(place, |file| file.write_all(bytes))
}

/// Writes a file beside its place, piece by piece, and renames it.
///
/// # Errors
/// The system's and those of `write`; the old file stands, and nothing else is left.
pub(crate) fn write_whole_with<E: From<io::Error>>(
    place: &Path,
    write: impl FnOnce(&mut File) -> Result<(), E>,
) -> Result<(), E> {
    // A link is followed, so that what it points to is written and not the link.
    let place = std::fs::canonicalize(place).unwrap_or_else(|_| place.to_owned());
    let beside = beside(&place);
    let written = (|| {
        let mut file = File::create(&beside)?;
        write(&mut file)?;
        file.sync_all()?;
        if let Ok(old) = std::fs::metadata(&place) {
            file.set_permissions(old.permissions())?;
        }
        drop(file);
        Ok(std::fs::rename(&beside, &place)?)
    })();
    if written.is_err() {
        let _ = std::fs::remove_file(&beside);
    }
    written
}

/// Writes a file under the first name that nothing has yet, of those that `name` gives for 1, 2, …; where.
///
/// # Errors
/// The system's; nothing is left.
pub(crate) fn write_new(
    folder: &Path,
    name: impl Fn(u32) -> String,
    bytes: &[u8],
) -> io::Result<PathBuf> {
    let mut number = 1;
    let (mut file, place) = loop {
        let place = folder.join(name(number));
        match OpenOptions::new().write(true).create_new(true).open(&place) {
            Ok(file) => break (file, place),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => number += 1,
            Err(error) => return Err(error),
        }
    };
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    if let Err(error) = written {
        let _ = std::fs::remove_file(&place);
        return Err(error);
    }
    Ok(place)
}

/// What a file is called while it is made: in the same folder, so that renaming stays within one file system.
pub(crate) fn beside(place: &Path) -> PathBuf {
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    place.with_file_name(format!(".{name}.{}.part", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::write_new;

    #[test]
    fn a_new_file_takes_the_place_of_none() {
        let folder = tempfile::tempdir().expect("a folder");
        let name = |number| format!("{number}.txt");
        for number in 1..=3 {
            let place = write_new(folder.path(), name, &[number]).expect("written");
            assert_eq!(place, folder.path().join(format!("{number}.txt")));
        }
        for number in 1..=3 {
            let bytes = std::fs::read(folder.path().join(format!("{number}.txt")));
            assert_eq!(bytes.expect("there"), [number]);
        }
        assert!(write_new(&folder.path().join("none"), name, &[]).is_err());
    }
}
