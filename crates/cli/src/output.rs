//! Where results go: standard output, and files that are whole or absent.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// Writes to standard output.
///
/// # Errors
/// [`Failure::ReaderGone`] where the reader has left, [`Failure::Unwritable`] for a full disk and the like.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    print_bytes(text.as_bytes())
}

/// Writes bytes to standard output; fails as [`print()`] does.
pub(crate) fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(bytes)
        .and_then(|()| stdout.flush())
        .map_err(stdout_failure)
}

/// Writes to standard error. Nothing is left to be done where even that fails.
pub(crate) fn print_error(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Writes one JSON document to standard output; fails as [`print()`] does.
pub(crate) fn print_json(document: &impl serde::Serialize) -> Result<(), Failure> {
    let mut stdout = io::BufWriter::new(io::stdout().lock());
    serde_json::to_writer(&mut stdout, document)
        .map_err(io::Error::from)
        .and_then(|()| stdout.write_all(b"\n"))
        .and_then(|()| stdout.flush())
        .map_err(stdout_failure)
}

fn stdout_failure(error: io::Error) -> Failure {
    if error.kind() == ErrorKind::BrokenPipe {
        Failure::ReaderGone
    } else {
        Failure::Unwritable {
            file: crate::failure::STDOUT.into(),
            reason: reason(&error),
        }
    }
}

/// Keeps a text in the directory for temporary files, for a report of our own mistake.
pub(crate) fn keep_for_report(text: &str) -> Option<PathBuf> {
    let path = std::env::temp_dir().join(format!("geotrace-{}.wgsl", std::process::id()));
    fs::write(&path, text).ok()?;
    Some(path)
}

/// A system error as one phrase.
pub(crate) fn reason(error: &io::Error) -> String {
    phrase(&error.to_string())
}

/// A system's words to stand after a colon: without the number that Rust adds, and in lower case.
pub(crate) fn phrase(text: &str) -> String {
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

/// A file that will be written: it is checked before the work starts, and appears only when it is whole.
#[derive(Debug)]
pub(crate) struct Target {
    /// As it was given.
    name: String,
    place: Place,
}

/// Why a file was not written.
#[derive(Debug)]
pub(crate) enum Fault {
    /// The system refused.
    Write(io::Error),
    /// What was to be written could not be made.
    Other(Failure),
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

#[derive(Debug)]
enum Place {
    /// Standard output, given as `-`.
    Stdout,
    /// A file, or nothing yet: a temporary file beside it takes its name when it is whole.
    File(PathBuf),
    /// A device or a pipe: it cannot be replaced, only written to.
    Device(PathBuf),
}

impl Target {
    /// Checks that a file can be written at `path`, as far as that shows beforehand.
    ///
    /// # Errors
    /// [`Failure::Unwritable`] for a directory, a missing or closed directory above it, a read-only file.
    pub(crate) fn new(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let unwritable = |reason: String| Failure::Unwritable {
            file: name.clone(),
            reason,
        };
        if path.as_os_str() == "-" {
            return Ok(Self {
                name,
                place: Place::Stdout,
            });
        }
        let place = match fs::metadata(path) {
            Ok(existing) if existing.is_dir() => {
                return Err(unwritable("it is a directory".into()));
            }
            Ok(existing) if !existing.is_file() => Place::Device(path.into()),
            Ok(existing) if existing.permissions().readonly() => {
                return Err(unwritable("it is read-only".into()));
            }
            // A symbolic link keeps pointing to what it points to.
            Ok(_) => {
                Place::File(fs::canonicalize(path).map_err(|error| unwritable(reason(&error)))?)
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {
                if path.file_name().is_none() {
                    return Err(unwritable("it names no file".into()));
                }
                let folder = folder_of(path);
                match fs::metadata(folder) {
                    Ok(above) if above.is_dir() => {}
                    Ok(_) => {
                        return Err(unwritable(format!(
                            "`{}` is not a directory",
                            folder.display()
                        )));
                    }
                    Err(_) => {
                        return Err(unwritable(format!(
                            "the directory `{}` does not exist",
                            folder.display()
                        )));
                    }
                }
                Place::File(path.into())
            }
            Err(error) => return Err(unwritable(reason(&error))),
        };
        let target = Self { name, place };
        target.try_out()?;
        Ok(target)
    }

    /// As it was given; `standard output` for `-`.
    pub(crate) fn name(&self) -> &str {
        match self.place {
            Place::Stdout => crate::failure::STDOUT,
            _ => &self.name,
        }
    }

    /// Writes the file: all of it, or nothing.
    ///
    /// # Errors
    /// [`Failure::Unwritable`]; what stood there before still stands.
    pub(crate) fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        self.write_with(|out| Ok(out.write_all(bytes)?))
    }

    /// Writes the file piece by piece: all of it, or nothing, unless it is standard output or a device, which have
    /// what was written before a failure.
    ///
    /// # Errors
    /// [`Failure::Unwritable`], or what the writer failed with; what stood there before still stands.
    pub(crate) fn write_with(
        &self,
        write: impl FnOnce(&mut dyn Write) -> Result<(), Fault>,
    ) -> Result<(), Failure> {
        let written = match &self.place {
            Place::Stdout => {
                let mut stdout = io::BufWriter::new(io::stdout().lock());
                let written = write(&mut stdout).and_then(|()| Ok(stdout.flush()?));
                return written.map_err(|fault| match fault {
                    Fault::Write(error) => stdout_failure(error),
                    Fault::Other(failure) => failure,
                });
            }
            Place::Device(path) => OpenOptions::new()
                .write(true)
                .open(path)
                .map_err(Fault::from)
                .and_then(|device| {
                    let mut device = io::BufWriter::new(device);
                    write(&mut device)?;
                    Ok(device.flush()?)
                }),
            Place::File(path) => write_whole(path, |file| {
                let mut file = io::BufWriter::new(file);
                write(&mut file)?;
                Ok(file.flush()?)
            }),
        };
        written.map_err(|fault| match fault {
            Fault::Write(error) => self.unwritable(&error),
            Fault::Other(failure) => failure,
        })
    }

    /// Creates and removes a temporary file, so that a picture is not computed in vain.
    fn try_out(&self) -> Result<(), Failure> {
        if let Place::File(path) = &self.place {
            let temporary = temporary_beside(path);
            create(&temporary)
                .and_then(|_| fs::remove_file(&temporary))
                .map_err(|error| self.unwritable(&error))?;
        }
        Ok(())
    }

    fn unwritable(&self, error: &io::Error) -> Failure {
        Failure::Unwritable {
            file: self.name.clone(),
            reason: reason(error),
        }
    }
}

/// Numbered files that appear together, once all are whole.
#[derive(Debug)]
pub(crate) struct Series {
    /// The files as they are called while they are made, and in the end.
    files: Vec<[PathBuf; 2]>,
}

impl Series {
    /// None yet.
    pub(crate) fn new() -> Self {
        Self { files: Vec::new() }
    }

    /// Makes a file that will be called `path`.
    ///
    /// # Errors
    /// [`Failure::Unwritable`].
    pub(crate) fn add(&mut self, path: PathBuf, bytes: &[u8]) -> Result<(), Failure> {
        let number = self.files.len();
        let temporary =
            folder_of(&path).join(format!(".geotrace-{}-{number}.tmp", std::process::id()));
        let unwritable = |error: io::Error| Failure::Unwritable {
            file: path.display().to_string(),
            reason: reason(&error),
        };
        let mut file = create(&temporary).map_err(unwritable)?;
        self.files.push([temporary, path.clone()]);
        file.write_all(bytes).map_err(unwritable)
    }

    /// Gives all files their names.
    ///
    /// # Errors
    /// [`Failure::Unwritable`]: those that have their names by then keep them.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        self.files.reverse();
        while let Some([temporary, path]) = self.files.last() {
            fs::rename(temporary, path).map_err(|error| Failure::Unwritable {
                file: path.display().to_string(),
                reason: reason(&error),
            })?;
            self.files.pop();
        }
        Ok(())
    }
}

impl Drop for Series {
    fn drop(&mut self) {
        for [temporary, _] in &self.files {
            let _ = fs::remove_file(temporary);
        }
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// A name in the same directory, so that renaming stays within one file system, and short, so that a name of
/// greatest length can still be written.
fn temporary_beside(path: &Path) -> PathBuf {
    folder_of(path).join(format!(".geotrace-{}.png.tmp", std::process::id()))
}

fn create(path: &Path) -> io::Result<File> {
    OpenOptions::new().write(true).create_new(true).open(path)
}

fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let temporary = temporary_beside(path);
    let result = create(&temporary)
        .map_err(Fault::from)
        .and_then(|mut file| {
            write(&mut file)?;
            file.sync_all()?;
            // Whoever set the rights of the file that is replaced meant them.
            if let Ok(existing) = fs::metadata(path) {
                fs::set_permissions(&temporary, existing.permissions())?;
            }
            Ok(fs::rename(&temporary, path)?)
        });
    if result.is_err() {
        // The first error is the one to report; a leftover is all that a second one can leave.
        let _ = fs::remove_file(&temporary);
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A directory of its own for each test, removed at its end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(test: &str) -> Self {
            let path = std::env::temp_dir().join(format!("geotrace-{}-{test}", std::process::id()));
            fs::create_dir_all(&path).expect("a temporary directory");
            Self(path)
        }

        fn names(&self) -> Vec<String> {
            let mut names: Vec<String> = fs::read_dir(&self.0)
                .expect("the directory")
                .map(|entry| {
                    entry
                        .expect("an entry")
                        .file_name()
                        .to_string_lossy()
                        .into_owned()
                })
                .collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_file_is_replaced_whole_and_nothing_else_is_left() {
        let folder = Folder::new("replaced");
        let path = folder.0.join("a.png");
        fs::write(&path, b"the old picture, longer").expect("writing");
        Target::new(&path)
            .and_then(|target| target.write(b"new"))
            .expect("writing");
        assert_eq!(fs::read(&path).expect("reading"), b"new");
        assert_eq!(folder.names(), ["a.png"]);
    }

    #[test]
    fn nothing_appears_before_the_file_is_whole() {
        let folder = Folder::new("nothing");
        let target = Target::new(&folder.0.join("a.png")).expect("a target");
        assert!(folder.names().is_empty());
        target.write(b"x").expect("writing");
        assert_eq!(folder.names(), ["a.png"]);
    }

    #[test]
    fn what_cannot_be_made_leaves_the_old_file_and_nothing_else() {
        let folder = Folder::new("unmade");
        let path = folder.0.join("a.obj");
        fs::write(&path, b"old").expect("writing");
        let target = Target::new(&path).expect("a target");
        let result = target.write_with(|out| {
            out.write_all(b"the first half")?;
            Err(Fault::Other(Failure::usage("no")))
        });
        assert!(matches!(result, Err(Failure::Usage { .. })), "{result:?}");
        assert_eq!(fs::read(&path).expect("reading"), b"old");
        assert_eq!(folder.names(), ["a.obj"]);
    }

    #[test]
    fn directories_and_missing_directories_are_refused() {
        let folder = Folder::new("refused");
        let message = |path: &Path| match Target::new(path) {
            Err(Failure::Unwritable { reason, .. }) => reason,
            other => panic!("{other:?}"),
        };
        assert_eq!(message(&folder.0), "it is a directory");
        assert!(message(&folder.0.join("no/a.png")).contains("does not exist"));
        fs::write(folder.0.join("file"), b"").expect("writing");
        assert!(!message(&folder.0.join("file/a.png")).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn a_symbolic_link_keeps_pointing_to_the_file() {
        let folder = Folder::new("link");
        let (file, link) = (folder.0.join("a.png"), folder.0.join("b.png"));
        fs::write(&file, b"old").expect("writing");
        std::os::unix::fs::symlink(&file, &link).expect("a link");
        Target::new(&link)
            .and_then(|target| target.write(b"new"))
            .expect("writing");
        assert_eq!(fs::read(&file).expect("reading"), b"new");
        assert!(fs::symlink_metadata(&link).expect("the link").is_symlink());
    }

    #[test]
    fn system_errors_read_as_a_phrase() {
        let error = io::Error::from_raw_os_error(2);
        assert_eq!(reason(&error), "no such file or directory");
    }
}
