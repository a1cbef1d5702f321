//! Source texts. In: a path. Out: a text with its line index.

use std::fs::File;
use std::io;
use std::path::Path;

use export::whole_file::phrase;
use ide::language::LONGEST_PROGRAM;
use ide::limited::read;
use syntax::diagnostic::Diagnostic;
use syntax::line_index::LineIndex;

use crate::failure::Failure;

/// A text and its name.
#[derive(Debug)]
pub(crate) struct SourceText {
    /// The path as it was given, or `-` for standard input.
    pub(crate) name: String,
    /// The text. If the file is not UTF-8, replacement characters replace the invalid bytes.
    pub(crate) text: String,
    /// The diagnostic of a file that is not UTF-8.
    pub(crate) undecodable: Option<Diagnostic>,
}

impl SourceText {
    /// Reads a file, or standard input for `-`.
    ///
    /// # Errors
    /// [`Failure::Unreadable`]. Bytes that are not UTF-8 are an error of the program: see
    /// [`Source::undecodable`].
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let bytes = read_bytes(path).map_err(|reason| Failure::Unreadable {
            file: name.clone(),
            reason,
        })?;
        let text = String::from_utf8(bytes);
        Ok(match text {
            Ok(text) => Self::new(name, text),
            Err(error) => Self {
                undecodable: syntax::text::decode(error.as_bytes())
                    .err()
                    .map(|found| *found),
                ..Self::new(name, String::from_utf8_lossy(error.as_bytes()).into_owned())
            },
        })
    }

    /// Returns a text from elsewhere, such as an argument.
    pub(crate) fn new(name: String, text: String) -> Self {
        Self {
            name,
            text,
            undecodable: None,
        }
    }

    /// Builds the line index, which costs a pass over the text.
    pub(crate) fn lines(&self) -> LineIndex<'_> {
        LineIndex::new(&self.text)
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    let bytes = if path.as_os_str() == "-" {
        read(io::stdin().lock(), LONGEST_PROGRAM)
    } else if path.is_dir() {
        return Err("it is a directory".into());
    } else {
        File::open(path).and_then(|file| read(file, LONGEST_PROGRAM))
    };
    bytes.map_err(|error| phrase(&error.to_string()))
}
