//! From byte offsets to lines and columns, and back.
//!
//! Built once for a text in linear time. A query costs a binary search over the lines and the count of at
//! most one block of the text, wherever in a long line it lies.

/// A place as people count: the first character of a text is at line 1, column 1.
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
    /// The offset of each line's first byte; never empty.
    starts: Vec<u32>,
    /// The number of characters that start before byte `k · BLOCK`.
    characters: Vec<u32>,
}

/// Bytes between two checkpoints.
const BLOCK: usize = 1024;

impl<'t> LineIndex<'t> {
    /// Indexes a text of at most `u32::MAX` bytes.
    pub fn new(text: &'t str) -> Self {
        let mut starts = vec![0];
        let mut characters = Vec::with_capacity(text.len() / BLOCK + 1);
        let mut count = 0;
        for (block, bytes) in text.as_bytes().chunks(BLOCK).enumerate() {
            characters.push(count);
            count += count_characters(bytes);
            let offset = (block * BLOCK) as u32;
            let ends = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
            starts.extend(ends.map(|(k, _)| offset + k as u32 + 1));
        }
        if text.len().is_multiple_of(BLOCK) {
            characters.push(count);
        }
        Self {
            text,
            starts,
            characters,
        }
    }

    /// The number of lines, at least 1: a text that ends in `\n` has an empty last line.
    pub fn line_count(&self) -> u32 {
        self.starts.len() as u32
    }

    /// The line and column of the character that starts at `offset`; an offset past the end counts as the end.
    pub fn position(&self, offset: u32) -> Position {
        let line = self.starts.partition_point(|start| *start <= offset) - 1;
        let column = self.characters_before(offset) - self.characters_before(self.starts[line]);
        Position {
            line: line as u32 + 1,
            column: column + 1,
        }
    }

    /// The offset of the character at a place. A column past the line's end gives the line's end; `None`
    /// where there is no such line, or for a 0.
    pub fn offset(&self, position: Position) -> Option<u32> {
        let content = self.line(position.line)?;
        let (start, end) = (content.start, content.end);
        let wanted = self.characters_before(start as u32) + position.column.checked_sub(1)?;
        if wanted >= self.characters_before(end as u32) {
            return Some(end as u32);
        }
        let block = self.characters.partition_point(|count| *count <= wanted) - 1;
        let mut left = wanted - self.characters[block];
        let bytes = &self.text.as_bytes()[block * BLOCK..];
        for (k, byte) in bytes.iter().enumerate() {
            if starts_character(*byte) {
                if left == 0 {
                    return Some((block * BLOCK + k) as u32);
                }
                left -= 1;
            }
        }
        Some(end as u32)
    }

    /// The bytes of a line (from 1) without its end, or `None` where there is no such line.
    pub fn line(&self, line: u32) -> Option<std::ops::Range<usize>> {
        let index = line.checked_sub(1)? as usize;
        let start = *self.starts.get(index)? as usize;
        let Some(next) = self.starts.get(index + 1) else {
            return Some(start..self.text.len());
        };
        let bytes = &self.text.as_bytes()[start..*next as usize - 1];
        let content = bytes.strip_suffix(b"\r").unwrap_or(bytes);
        Some(start..start + content.len())
    }

    /// The number of characters that start before `offset`.
    fn characters_before(&self, offset: u32) -> u32 {
        let offset = (offset as usize).min(self.text.len());
        let block = offset / BLOCK;
        let bytes = &self.text.as_bytes()[block * BLOCK..offset];
        self.characters[block] + count_characters(bytes)
    }
}

fn count_characters(bytes: &[u8]) -> u32 {
    bytes.iter().filter(|byte| starts_character(**byte)).count() as u32
}

/// True unless the byte continues a character in UTF-8.
fn starts_character(byte: u8) -> bool {
    byte & 0xC0 != 0x80
}

#[cfg(test)]
mod tests {
    use super::{BLOCK, LineIndex, Position};

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
