//! Files that are complete or absent. In: bytes. Out: a file that gets its name when its last byte is on the disk.
//!
//! A temporary file beside the target (so that renaming stays within one file system) replaces the target. `tempfile`
//! chooses its name and removes it on failure. This module adds the following: a symbolic link keeps pointing to its
//! file, the permissions of a replaced file are preserved, a device, a pipe or an open file such as `/dev/stdout` is
//! written to instead of replaced, and several files appear together.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{NamedTempFile, TempPath};

/// The prefix of each temporary file's name; short, so that a target's name may have the maximum length.
const PREFIX: &str = ".geotrace-";
/// The maximum number of links that are followed to a file that does not exist, as on Linux.
const MOST_LINKS: u32 = 40;

/// Writes a file, completely or not at all.
///
/// # Errors
/// The system's; an existing file is unchanged, unless it is a stream: a device, a pipe or an open file.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_whole_with(path, |out| out.write_all(bytes))
}

/// Writes a file piece by piece, buffered, completely or not at all.
///
/// # Errors
/// The system's, and those of `write`; an existing file is unchanged, unless it is a stream.
pub fn write_whole_with<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<(), E>,
) -> Result<(), E> {
    let target = resolved(path);
    if is_stream(&target) {
        let mut stream = BufWriter::new(open_stream(&target)?);
        write(&mut stream)?;
        return Ok(stream.flush()?);
    }
    Ok(Unnamed::new(path, write)?.persist()?)
}

/// Writes a file that `create` creates at the path of a temporary file, completely or not at all. A replaced file keeps
/// its attributes.
///
/// # Errors
/// The system's; an existing file is unchanged. A stream is refused.
pub fn write_whole_created(
    path: &Path,
    create: impl FnMut(&Path) -> io::Result<File>,
    bytes: &[u8],
) -> io::Result<()> {
    let write = |mut file: &File, _: &Path| file.write_all(bytes);
    Unnamed::made(path, create, write)?.persist()
}

/// Writes a file by means of code that only takes paths: `write` receives the path of a temporary file. Completely or
/// not at all.
///
/// # Errors
/// The system's, and those of `write`; an existing file is unchanged. A stream is refused.
pub(crate) fn write_whole_at<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&Path) -> Result<(), E>,
) -> Result<(), E> {
    Ok(Unnamed::made(path, create_new, |_, temporary| write(temporary))?.persist()?)
}

/// Writes a file under the first free name of those that `name` returns for 1, 2, …, and returns its path.
///
/// The name is created first and the bytes follow, so that a text can be rescued even if the file system cannot rename
/// without replacing.
///
/// # Errors
/// The system's; no file is left.
pub fn write_new(folder: &Path, name: impl Fn(u32) -> String, bytes: &[u8]) -> io::Result<PathBuf> {
    let mut number = 1;
    let (mut file, path) = loop {
        let path = folder.join(name(number));
        match File::create_new(&path) {
            Ok(file) => break (file, path),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => number += 1,
            Err(error) => return Err(error),
        }
    };
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    if let Err(error) = written {
        let _ = fs::remove_file(&path);
        return Err(error);
    }
    Ok(path)
}

/// The reason why a file cannot be written, as far as it is known in advance. Displayed as a phrase.
#[derive(Debug)]
pub enum TargetError {
    /// The path is that of a directory.
    IsDirectory,
    /// The existing file is read-only.
    IsReadOnly,
    /// The path does not end in a name.
    NamesNoFile,
    /// A parent of the path is not a directory.
    NoDirectory(PathBuf),
    /// The directory of the file does not exist, or is not accessible to this user.
    NoSuchDirectory(PathBuf),
    /// The system refused.
    System(io::Error),
}

/// Checks that a file can be written before anything is computed for it. Creates and removes a temporary file.
///
/// # Errors
/// See [`TargetError`].
pub fn check_target(path: &Path) -> Result<(), TargetError> {
    let target = resolved(path);
    if is_descriptor(&target) {
        // The permissions of its entry are those with which it was opened.
        return match fs::symlink_metadata(&target) {
            Ok(entry) if entry.permissions().readonly() => Err(TargetError::IsReadOnly),
            Ok(_) => Ok(()),
            Err(error) => Err(TargetError::System(error)),
        };
    }
    match fs::metadata(path) {
        Ok(existing) if existing.is_dir() => return Err(TargetError::IsDirectory),
        Ok(existing) if !existing.is_file() => return Ok(()),
        Ok(existing) if existing.permissions().readonly() => return Err(TargetError::IsReadOnly),
        Ok(_) => {}
        Err(error) if error.kind() == ErrorKind::NotFound => {
            if path.file_name().is_none() {
                return Err(TargetError::NamesNoFile);
            }
            let folder = folder_of(&target);
            match fs::metadata(folder) {
                Ok(above) if above.is_dir() => {}
                Ok(_) => return Err(TargetError::NoDirectory(folder.to_owned())),
                Err(_) => return Err(TargetError::NoSuchDirectory(folder.to_owned())),
            }
        }
        Err(error) => return Err(TargetError::System(error)),
    }
    // An interruption waits until the file is removed.
    let _all = temporaries();
    temporary_beside(&target, create_new)
        .and_then(NamedTempFile::close)
        .map_err(TargetError::System)
}

/// Files that get their names together, when all of them are complete. Without [`finish`](Self::finish) none is left.
#[derive(Debug, Default)]
pub struct FileSeries {
    files: Vec<Unnamed>,
}

impl FileSeries {
    /// Writes a file that will be called `path`.
    ///
    /// # Errors
    /// The system's. A directory or a stream is refused.
    pub fn add(&mut self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let file = Unnamed::new(path, |out| out.write_all(bytes))?;
        self.files.push(file);
        Ok(())
    }

    /// Gives all files their names, unless one of the names is that of a directory or a stream. An interruption comes
    /// before the first or after the last.
    ///
    /// # Errors
    /// The file that could not be renamed, and why. If that is only detected while renaming, the files before it keep
    /// their names; those after it are removed.
    pub fn finish(self) -> Result<(), (PathBuf, io::Error)> {
        for file in &self.files {
            check_replaceable(&file.target).map_err(|error| (file.target.clone(), error))?;
        }
        let mut files = self.files.into_iter();
        let mut all = temporaries();
        let renamed = files.try_for_each(|file| {
            let target = file.target.clone();
            file.persist_with(&mut all).map_err(|error| (target, error))
        });
        // The files that are left lock it to remove themselves.
        drop(all);
        renamed
    }
}

/// The temporary files of this process, each from its creation until it is renamed or removed.
static TEMPORARIES: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn temporaries() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Kills the processes that write, removes the temporary files of all threads and calls `end`, which ends the process.
/// Until then no file is created or renamed.
pub fn abandon_all(end: impl FnOnce()) {
    let all = temporaries();
    crate::video::end_all();
    for path in all.iter() {
        // A file that cannot be removed is left.
        let _ = fs::remove_file(path);
    }
    end();
}

/// A complete file that does not have its name yet. It is removed when it is dropped.
#[derive(Debug)]
struct Unnamed {
    /// Closed, so that a series of thousands does not exceed the limit of open files.
    temporary: Option<TempPath>,
    target: PathBuf,
}

impl Drop for Unnamed {
    fn drop(&mut self) {
        if let Some(temporary) = self.temporary.take() {
            let mut all = temporaries();
            all.remove::<Path>(temporary.as_ref());
            drop(temporary);
        }
    }
}

impl Unnamed {
    fn new<E: From<io::Error>>(
        path: &Path,
        write: impl FnOnce(&mut dyn Write) -> Result<(), E>,
    ) -> Result<Self, E> {
        Self::made(path, create_new, |file, _| {
            let mut out = BufWriter::new(file);
            write(&mut out)?;
            Ok(out.flush()?)
        })
    }

    /// Returns a file that `create` creates and `write` fills. `write` receives the file and its path. Only a file can
    /// be replaced by it.
    fn made<E: From<io::Error>>(
        path: &Path,
        create: impl FnMut(&Path) -> io::Result<File>,
        write: impl FnOnce(&File, &Path) -> Result<(), E>,
    ) -> Result<Self, E> {
        let target = resolved(path);
        check_replaceable(&target)?;
        let (file, temporary) = {
            // Created and registered atomically, as seen by other threads.
            let mut all = temporaries();
            let created = temporary_beside(&target, create)?;
            all.insert(created.path().to_owned());
            created.into_parts()
        };
        let unnamed = Self {
            temporary: Some(temporary),
            target,
        };
        if let Some(path) = &unnamed.temporary {
            write(&file, path)?;
        }
        file.sync_all()?;
        if let Ok(existing) = fs::metadata(&unnamed.target) {
            file.set_permissions(existing.permissions())?;
        }
        Ok(unnamed)
    }

    fn persist(self) -> io::Result<()> {
        self.persist_with(&mut temporaries())
    }

    /// Gives the file its name. `all` are [`TEMPORARIES`].
    fn persist_with(mut self, all: &mut BTreeSet<PathBuf>) -> io::Result<()> {
        let Some(mut temporary) = self.temporary.take() else {
            return Ok(());
        };
        all.remove::<Path>(temporary.as_ref());
        check_replaceable(&self.target)?;
        // `tempfile` would drop the attributes that the file has on Windows.
        fs::rename(&temporary, &self.target)?;
        temporary.disable_cleanup(true);
        Ok(())
    }
}

/// Refuses a target that is not a file, which a rename would replace all the same.
fn check_replaceable(target: &Path) -> io::Result<()> {
    if fs::metadata(target).is_ok_and(|existing| existing.is_dir()) {
        return Err(ErrorKind::IsADirectory.into());
    }
    match is_stream(target) {
        true => Err(io::Error::other("it is not a file")),
        false => Ok(()),
    }
}

/// Returns true for a resolved path to which bytes are written in order: a device, a pipe or an open file.
fn is_stream(target: &Path) -> bool {
    is_descriptor(target) || fs::metadata(target).is_ok_and(|existing| !existing.is_file())
}

/// Returns true for the entry of an open file in the system's list of a process. What it links to is a name for people:
/// that of a file which may be gone.
fn is_descriptor(path: &Path) -> bool {
    let folder = fs::canonicalize(folder_of(path)).unwrap_or_default();
    folder == Path::new("/dev/fd") || folder.starts_with("/proc") && folder.ends_with("fd")
}

/// Opens a stream. What an open file holds is kept.
fn open_stream(target: &Path) -> io::Result<Box<dyn Write>> {
    let is_descriptor = is_descriptor(target);
    let is_own = || fs::canonicalize(folder_of(target)).ok() == fs::canonicalize("/dev/fd").ok();
    // Opened anew, they would have positions of their own, and other programs would write over these bytes.
    match target.file_name().and_then(OsStr::to_str) {
        Some("1") if is_descriptor && is_own() => return Ok(Box::new(io::stdout())),
        Some("2") if is_descriptor && is_own() => return Ok(Box::new(io::stderr())),
        _ => {}
    }
    let mut options = OpenOptions::new();
    options.write(true).append(is_descriptor);
    Ok(Box::new(options.open(target)?))
}

/// Returns the path with symbolic links resolved, also those to a file that does not exist yet, but not the entry of an
/// open file.
fn resolved(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        if is_descriptor(&path) {
            return path;
        }
        let Ok(target) = fs::read_link(&path) else {
            break;
        };
        path = folder_of(&path).join(target);
    }
    fs::canonicalize(&path).unwrap_or(path)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Creates a new empty file in the directory of `path`, by `create`.
fn temporary_beside(
    path: &Path,
    create: impl FnMut(&Path) -> io::Result<File>,
) -> io::Result<NamedTempFile> {
    tempfile::Builder::new()
        .prefix(PREFIX)
        .make_in(folder_of(path), create)
}

/// Creates a file with the default permissions of a new file: `tempfile` would make it private.
fn create_new(path: &Path) -> io::Result<File> {
    File::create_new(path)
}

/// Converts a system's message into a phrase that follows a colon: without the number that Rust adds, and in lower
/// case.
pub fn phrase(text: &str) -> String {
    let text = match text.find(" (os error") {
        Some(end) => &text[..end],
        None => text,
    };
    let mut letters = text.chars();
    match letters.next() {
        Some(first) => first.to_lowercase().chain(letters).collect(),
        None => "unknown reason".into(),
    }
}

impl fmt::Display for TargetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IsDirectory => write!(f, "it is a directory"),
            Self::IsReadOnly => write!(f, "it is read-only"),
            Self::NamesNoFile => write!(f, "it names no file"),
            Self::NoDirectory(path) => write!(f, "`{}` is not a directory", path.display()),
            Self::NoSuchDirectory(path) => {
                write!(f, "the directory `{}` does not exist", path.display())
            }
            Self::System(error) => write!(f, "{}", phrase(&error.to_string())),
        }
    }
}

impl std::error::Error for TargetError {}

#[cfg(test)]
mod tests;
