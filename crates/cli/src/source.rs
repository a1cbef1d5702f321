//! Source texts: from a file or standard input to text with line numbers.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use export::whole_file::phrase;
use syntax::diagnostic::Diagnostic;
use syntax::line_index::LineIndex;

use crate::failure::Failure;

/// The longest program that is read. A text beyond it is not a program but a mistake (`/dev/zero`), and
/// would not fit in the memory that a check may take.
const LONGEST: u64 = 64 << 20;

/// A text, its name, and where its lines are.
#[derive(Debug)]
pub(crate) struct Source {
    /// As it was given: a path, or `-` for standard input.
    pub(crate) name: String,
    /// The text. Where the file is not UTF-8, its readable part.
    pub(crate) text: String,
    /// What stopped the reading of the text, if anything did.
    pub(crate) undecodable: Option<Diagnostic>,
}

impl Source {
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

    /// A text that came by another way, such as an argument.
    pub(crate) fn new(name: String, text: String) -> Self {
        Self {
            name,
            text,
            undecodable: None,
        }
    }

    /// Where its lines are: for questions about places. Building it costs a pass over the text.
    pub(crate) fn lines(&self) -> LineIndex<'_> {
        LineIndex::new(&self.text)
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    let (input, size): (Box<dyn Read>, u64) = if path.as_os_str() == "-" {
        (Box::new(io::stdin().lock()), 0)
    } else {
        let file = File::open(path).map_err(|error| phrase(&error.to_string()))?;
        let metadata = file
            .metadata()
            .map_err(|error| phrase(&error.to_string()))?;
        if metadata.is_dir() {
            return Err("it is a directory".into());
        }
        (Box::new(file), metadata.len())
    };
    let too_long = || format!("it is longer than {} MB", LONGEST >> 20);
    if size > LONGEST {
        return Err(too_long());
    }
    let mut bytes = Vec::with_capacity(size as usize);
    input
        .take(LONGEST + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| phrase(&error.to_string()))?;
    if bytes.len() as u64 > LONGEST {
        return Err(too_long());
    }
    Ok(bytes)
}
