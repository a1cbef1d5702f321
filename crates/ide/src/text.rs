//! Texts by lines: the interface of every program, whatever its language.
//!
//! Lines count from 1 and end at `\n`; offsets are in bytes.

use std::fmt::Debug;

use syntax::document::{EditError, Grammar, Snapshot};
use syntax::span::Span;

/// A text of less than 4 GiB. The cost of each method except [`Text::string`] is far below the length of the text.
pub trait Text: Debug {
    /// Returns the length in bytes.
    fn len(&self) -> u32;

    /// Returns the text of a range, or `None` if the text does not have the range.
    fn slice(&self, range: Span) -> Option<String>;

    /// Returns the line of an offset, from 1; an offset past the end counts as the end.
    fn line(&self, offset: u32) -> u32;

    /// Returns the offset at which a line starts, or `None` if there is no such line.
    fn line_start(&self, line: u32) -> Option<u32>;

    /// Returns true if the text has no bytes.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns a copy of the whole text.
    fn string(&self) -> String {
        self.slice(Span::new(0, self.len())).unwrap_or_default()
    }
}

/// A plain string with an index of its lines, for languages without a document of their own.
#[derive(Clone, Debug)]
pub struct PlainText {
    text: String,
    /// The offset of each line's first byte; never empty.
    starts: Vec<u32>,
}

impl PlainText {
    /// Indexes a text.
    ///
    /// # Errors
    /// [`EditError`] if the text is too large.
    pub fn new(text: impl Into<String>) -> Result<Self, EditError> {
        let text = text.into();
        if u32::try_from(text.len()).is_err() {
            return Err(EditError::TooLarge);
        }
        let mut starts = vec![0];
        starts.extend(text.match_indices('\n').map(|(at, _)| at as u32 + 1));
        Ok(Self { text, starts })
    }

    /// Returns the text.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Replaces the bytes of a range, in time proportional to the text.
    ///
    /// # Errors
    /// [`EditError`] if the text does not have the range, or would be too large.
    pub fn edit(&mut self, range: Span, text: &str) -> Result<(), EditError> {
        let bytes = range.start as usize..range.end as usize;
        if bytes.start > bytes.end || bytes.end > self.text.len() {
            return Err(EditError::OutOfRange);
        }
        if self.text.get(bytes.clone()).is_none() {
            return Err(EditError::InsideCharacter);
        }
        let mut edited = self.text.clone();
        edited.replace_range(bytes, text);
        *self = Self::new(edited)?;
        Ok(())
    }
}

impl Default for PlainText {
    fn default() -> Self {
        Self {
            text: String::new(),
            starts: vec![0],
        }
    }
}

impl Text for PlainText {
    fn len(&self) -> u32 {
        self.text.len() as u32
    }

    fn slice(&self, range: Span) -> Option<String> {
        let text = self.text.get(range.start as usize..range.end as usize);
        text.map(str::to_owned)
    }

    fn line(&self, offset: u32) -> u32 {
        self.starts.partition_point(|start| *start <= offset) as u32
    }

    fn line_start(&self, line: u32) -> Option<u32> {
        let index = line.checked_sub(1)?;
        self.starts.get(index as usize).copied()
    }
}

impl<G: Grammar> Text for Snapshot<G> {
    fn len(&self) -> u32 {
        self.len()
    }

    fn slice(&self, range: Span) -> Option<String> {
        self.slice(range)
    }

    fn line(&self, offset: u32) -> u32 {
        self.line(offset)
    }

    fn line_start(&self, line: u32) -> Option<u32> {
        self.line_start(line)
    }

    fn string(&self) -> String {
        self.text()
    }
}
