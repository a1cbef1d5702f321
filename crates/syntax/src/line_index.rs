//! Conversion between byte offsets and lines and columns.
//!
//! The index of a text is built once, in linear time. A query costs a binary search over checkpoints and a count within
//! one block of the text, however long the line.

use crate::checkpoints::Checkpoints;

/// A line and a column, both counted from 1.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct Position {
    /// The line, from 1.
    pub line: u32,
    /// The column, from 1, in Unicode scalar values.
    pub column: u32,
}

/// The lines of a text. A line ends at `\n`; a `\r` just before it belongs to the line's end.
#[derive(Clone, Debug)]
pub struct LineIndex<'t> {
    text: &'t str,
    checkpoints: Checkpoints,
}

impl<'t> LineIndex<'t> {
    /// Indexes a text of at most `u32::MAX` bytes.
    pub fn new(text: &'t str) -> Self {
        Self {
            text,
            checkpoints: Checkpoints::new(text),
        }
    }

    /// Returns the number of lines, at least 1: a text that ends in `\n` has an empty last line.
    pub fn line_count(&self) -> u32 {
        self.line_of(self.text.len() as u32)
    }

    /// Returns the line and column of the character that starts at `offset`; an offset past the end counts as the end.
    pub fn position(&self, offset: u32) -> Position {
        let line = self.line_of(offset);
        let start = self.start(line).unwrap_or_default();
        let column = self.characters_before(offset) - self.characters_before(start);
        Position {
            line,
            column: column + 1,
        }
    }

    /// Returns the offset of the character at a position. A column past the line's end is the line's end; `None` if
    /// there is no such line, or for a 0.
    pub fn offset(&self, position: Position) -> Option<u32> {
        let content = self.line(position.line)?;
        let (start, end) = (content.start as u32, content.end as u32);
        let wanted = self.characters_before(start) + position.column.checked_sub(1)?;
        if wanted >= self.characters_before(end) {
            return Some(end);
        }
        self.checkpoints.character(self.text, wanted)
    }

    /// Returns the bytes of a line, from 1, without its end; `None` if there is no such line.
    pub fn line(&self, line: u32) -> Option<std::ops::Range<usize>> {
        let start = self.start(line)? as usize;
        let Some(end) = self.checkpoints.line_end(self.text, line - 1) else {
            return Some(start..self.text.len());
        };
        let bytes = &self.text.as_bytes()[start..end as usize];
        let content = bytes.strip_suffix(b"\r").unwrap_or(bytes);
        Some(start..start + content.len())
    }

    /// Returns the line, from 1, of an offset.
    fn line_of(&self, offset: u32) -> u32 {
        self.checkpoints.line_ends_before(self.text, offset) + 1
    }

    /// Returns the offset at which a line, from 1, starts.
    fn start(&self, line: u32) -> Option<u32> {
        match line.checked_sub(1)?.checked_sub(1) {
            None => Some(0),
            Some(end) => Some(self.checkpoints.line_end(self.text, end)? + 1),
        }
    }

    fn characters_before(&self, offset: u32) -> u32 {
        self.checkpoints.characters_before(self.text, offset)
    }
}

#[cfg(test)]
mod tests {
    use super::{LineIndex, Position};
    use crate::checkpoints::BLOCK;

    fn slow_position(text: &str, offset: usize) -> Position {
        let before = &text[..offset];
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        Position {
            line: before.matches('\n').count() as u32 + 1,
            column: text[start..offset].chars().count() as u32 + 1,
        }
    }

    #[test]
    fn every_offset_agrees_with_counting_from_the_start_and_comes_back() {
        let mixed = "aπ\r\n\n𝛼x\ny\r".repeat(300);
        let exact = "x".repeat(2 * BLOCK);
        for text in ["", "\n", "a", "a\r\nb", "é\n", &mixed, &exact] {
            let index = LineIndex::new(text);
            for (offset, character) in text.char_indices() {
                let position = index.position(offset as u32);
                assert_eq!(position, slow_position(text, offset));
                let ends_line = character == '\n' || text[offset..].starts_with("\r\n");
                if !ends_line {
                    assert_eq!(index.offset(position), Some(offset as u32));
                }
            }
            let end = text.len();
            assert_eq!(index.position(end as u32), slow_position(text, end));
            assert_eq!(index.line_count() as usize, text.matches('\n').count() + 1);
        }
    }

    #[test]
    fn a_column_past_the_line_gives_its_end_and_a_line_past_the_text_gives_nothing() {
        let index = LineIndex::new("ab\r\ncd");
        let at = |line, column| index.offset(Position { line, column });
        assert_eq!(at(1, 9), Some(2));
        assert_eq!(at(2, 9), Some(6));
        assert_eq!(at(3, 1), None);
        assert_eq!(at(0, 1), None);
        assert_eq!(at(1, 0), None);
    }

    #[test]
    fn places_in_one_endless_line_are_found() {
        let text = "é".repeat(1_000_000);
        let index = LineIndex::new(&text);
        for k in (0..1_000_000).step_by(997) {
            let position = Position {
                line: 1,
                column: k + 1,
            };
            assert_eq!(index.position(2 * k), position);
            assert_eq!(index.offset(position), Some(2 * k));
        }
    }
}
