//! Results: texts and JSON on standard output, files by `export::whole_file`.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use export::whole_file::{check_target, phrase, write_whole_with};

use crate::failure::Failure;
use crate::style::TextColours;

/// Writes to standard output.
///
/// # Errors
/// [`Failure::ReaderGone`] if the reader has closed it, [`Failure::Unwritable`] for a full disk and the like.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    print_bytes(text.as_bytes())
}

/// Writes bytes to standard output; fails like [`print()`].
pub(crate) fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(bytes)
        .and_then(|()| stdout.flush())
        .map_err(stdout_failure)
}

/// Writes to standard error, and ignores errors: there is no other stream on which to report them.
pub(crate) fn print_error(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Reports a failure on standard error.
pub(crate) fn print_failure(failure: &Failure) {
    if let Some(text) = failure.text(TextColours::for_stderr()) {
        print_error(&text);
    }
}

/// Writes one JSON document to standard output; fails like [`print()`].
pub(crate) fn print_json(document: &impl serde::Serialize) -> Result<(), Failure> {
    let mut stdout = io::BufWriter::new(io::stdout().lock());
    serde_json::to_writer(&mut stdout, document)
        .map_err(io::Error::from)
        .and_then(|()| stdout.write_all(b"\n"))
        .and_then(|()| stdout.flush())
        .map_err(stdout_failure)
}

/// Returns the failure of writing to standard output.
pub(crate) fn stdout_failure(error: io::Error) -> Failure {
    if error.kind() == ErrorKind::BrokenPipe {
        Failure::ReaderGone
    } else {
        Failure::Unwritable {
            file: crate::failure::STDOUT.into(),
            reason: reason(&error),
        }
    }
}

/// Saves a text in the directory for temporary files, for a report of an internal error. Returns `None` if that fails.
pub(crate) fn keep_for_report(text: &str) -> Option<PathBuf> {
    let path = std::env::temp_dir().join(format!("geotrace-{}.wgsl", std::process::id()));
    fs::write(&path, text).ok()?;
    Some(path)
}

/// Formats a system's error as a phrase.
pub(crate) fn reason(error: &io::Error) -> String {
    phrase(&error.to_string())
}

/// The files that a command reads, which it must not overwrite.
#[derive(Debug)]
pub(crate) struct Inputs {
    program: Option<PathBuf>,
    images: Vec<PathBuf>,
}

impl Inputs {
    /// Returns the files of a program and the images that it shows.
    pub(crate) fn new<'i>(program: &Path, images: impl IntoIterator<Item = &'i Path>) -> Self {
        // Paths that do not exist, or are not files, cannot be overwritten.
        let images = images.into_iter().filter_map(|it| it.canonicalize().ok());
        Self {
            program: program.canonicalize().ok(),
            images: images.collect(),
        }
    }

    /// Returns the reason why a file must not be written, if it is one of these.
    fn reason(&self, path: &Path) -> Option<&'static str> {
        let path = path.canonicalize().ok()?;
        if self.program.as_ref() == Some(&path) {
            return Some("it is the program itself");
        }
        let is_image = self.images.contains(&path);
        is_image.then_some("it is one of the images of the picture")
    }
}

/// A file, or standard output, that will be written: it is checked before the work starts, and a file appears only when
/// it is complete.
#[derive(Debug)]
pub(crate) struct OutputTarget {
    /// `None` for standard output, given as `-`.
    path: Option<PathBuf>,
}

/// The reason why a file was not written.
#[derive(Debug)]
pub(crate) enum WriteError {
    /// The system refused.
    System(io::Error),
    /// The content could not be produced.
    Content(Failure),
}

impl From<io::Error> for WriteError {
    fn from(error: io::Error) -> Self {
        Self::System(error)
    }
}

impl OutputTarget {
    /// Checks that a file can be written at `path`, as far as that can be known in advance.
    ///
    /// # Errors
    /// [`Failure::Unwritable`] for a directory, a missing or inaccessible parent directory, a read-only file.
    pub(crate) fn new(path: &Path) -> Result<Self, Failure> {
        if path.as_os_str() == "-" {
            return Ok(Self { path: None });
        }
        check_target(path).map_err(|error| Failure::Unwritable {
            file: path.display().to_string(),
            reason: error.to_string(),
        })?;
        Ok(Self {
            path: Some(path.into()),
        })
    }

    /// Checks a target like [`Self::new`], and that it is not one of the files that are read, which would be lost.
    ///
    /// # Errors
    /// [`Failure::Unwritable`].
    pub(crate) fn apart_from(path: &Path, inputs: &Inputs) -> Result<Self, Failure> {
        if let Some(reason) = inputs.reason(path) {
            return Err(Failure::Unwritable {
                file: path.display().to_string(),
                reason: reason.to_owned(),
            });
        }
        Self::new(path)
    }

    /// Returns the path as it was given; `standard output` for `-`.
    pub(crate) fn name(&self) -> String {
        match &self.path {
            None => crate::failure::STDOUT.into(),
            Some(path) => path.display().to_string(),
        }
    }

    /// Writes the file, completely or not at all.
    ///
    /// # Errors
    /// [`Failure::Unwritable`]; an existing file is unchanged.
    pub(crate) fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        self.write_with(|out| Ok(out.write_all(bytes)?))
    }

    /// Writes the file piece by piece, completely or not at all. Standard output and devices keep the bytes that were
    /// written before a failure.
    ///
    /// # Errors
    /// [`Failure::Unwritable`], or the failure of `write`; an existing file is unchanged.
    pub(crate) fn write_with(
        &self,
        write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
    ) -> Result<(), Failure> {
        let Some(path) = &self.path else {
            let mut stdout = io::BufWriter::new(io::stdout().lock());
            let written = write(&mut stdout).and_then(|()| Ok(stdout.flush()?));
            return written.map_err(|error| match error {
                WriteError::System(error) => stdout_failure(error),
                WriteError::Content(failure) => failure,
            });
        };
        write_whole_with(path, write).map_err(|error| failure_of(path, error))
    }
}

fn failure_of(path: &Path, error: WriteError) -> Failure {
    match error {
        WriteError::System(error) => unwritable(path, &error),
        WriteError::Content(failure) => failure,
    }
}

/// Returns the failure of a file that the system refused to write.
pub(crate) fn unwritable(path: &Path, error: &io::Error) -> Failure {
    Failure::Unwritable {
        file: path.display().to_string(),
        reason: reason(error),
    }
}
