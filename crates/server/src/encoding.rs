//! Positions in a text as editors count them: lines from 0, columns in code units of an agreed encoding.

#[cfg(test)]
use syntax::span::Span;

/// The unit of an editor's columns.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub(crate) enum Encoding {
    /// Bytes.
    Utf8,
    /// Code units of UTF-16, in which a character beyond the basic plane is two: every editor supports it.
    #[default]
    Utf16,
    /// Unicode scalar values.
    Utf32,
}

/// A position as an editor specifies it.
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub(crate) struct Place {
    /// The line, from 0.
    pub(crate) line: u32,
    /// The column, from 0, in code units of the encoding.
    pub(crate) column: u32,
}

/// A text with its lines.
#[derive(Clone, Debug)]
pub(crate) struct LineStarts {
    /// The offset of each line's first byte; never empty.
    starts: Vec<u32>,
}

impl Encoding {
    /// Returns the length of a text in code units.
    pub(crate) fn length(self, text: &str) -> u32 {
        let length = match self {
            Self::Utf8 => text.len(),
            // Bytes that begin a character; characters of four bytes are two code units.
            Self::Utf16 => text
                .bytes()
                .map(|byte| usize::from(byte & 0xC0 != 0x80) + usize::from(byte >= 0xF0))
                .sum(),
            Self::Utf32 => text.bytes().filter(|byte| byte & 0xC0 != 0x80).count(),
        };
        length as u32
    }

    /// Returns the byte offset of a column in a line; for a column past the line's end, the end; for one within a
    /// character, its start.
    pub(crate) fn byte(self, line: &str, column: u32) -> usize {
        if self == Self::Utf8 || line.is_ascii() {
            let mut byte = (column as usize).min(line.len());
            while !line.is_char_boundary(byte) {
                byte -= 1;
            }
            return byte;
        }
        let mut left = column;
        for (byte, character) in line.char_indices() {
            let units = match self {
                Self::Utf16 => character.len_utf16() as u32,
                _ => 1,
            };
            if left < units {
                return byte;
            }
            left -= units;
        }
        line.len()
    }
}

impl LineStarts {
    /// Returns the lines of a text of less than 4 GiB; a line ends at `\n`, `\r\n` or `\r`, as in the protocol.
    pub(crate) fn new(text: &str) -> Self {
        let bytes = text.as_bytes();
        let mut starts = vec![0];
        starts.extend(ends(bytes));
        Self { starts }
    }

    /// Returns the start of a line, and that of the next; `None` for a line past the last.
    pub(crate) fn bounds(&self, line: u32) -> Option<(u32, Option<u32>)> {
        let line = line as usize;
        let start = *self.starts.get(line)?;
        Some((start, self.starts.get(line + 1).copied()))
    }

    /// Returns the line, from 0, that contains an offset, and the start of the line.
    pub(crate) fn line_of(&self, offset: u32) -> (u32, u32) {
        let line = self.starts.partition_point(|start| *start <= offset) - 1;
        (line as u32, self.starts[line])
    }
}

/// Returns the starts of the lines that follow a line end.
fn ends(bytes: &[u8]) -> impl Iterator<Item = u32> + '_ {
    let all = bytes.iter().enumerate();
    all.filter_map(move |(k, byte)| {
        let next = k + 1;
        let ends = match byte {
            b'\n' => true,
            b'\r' => bytes.get(next) != Some(&b'\n'),
            _ => false,
        };
        ends.then_some(next as u32)
    })
}

/// The direct way through a whole text, with which documents are compared.
#[cfg(test)]
impl LineStarts {
    /// Returns the offset of a position. For a line past the last, it is the text's end.
    pub(crate) fn offset(&self, text: &str, encoding: Encoding, place: Place) -> u32 {
        let Some(&start) = self.starts.get(place.line as usize) else {
            return text.len() as u32;
        };
        let line = &text[start as usize..self.line_end(text, place.line as usize)];
        start + encoding.byte(line, place.column) as u32
    }

    /// Returns the position of an offset; for an offset past the end, that of the end.
    pub(crate) fn place(&self, text: &str, encoding: Encoding, offset: u32) -> Place {
        let mut offset = (offset as usize).min(text.len());
        while !text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self
            .starts
            .partition_point(|start| *start as usize <= offset)
            - 1;
        let start = self.starts[line] as usize;
        Place {
            line: line as u32,
            column: encoding.length(&text[start..offset]),
        }
    }

    /// Returns both ends of a span.
    pub(crate) fn range(&self, text: &str, encoding: Encoding, span: Span) -> [Place; 2] {
        [span.start, span.end].map(|offset| self.place(text, encoding, offset))
    }

    /// Returns the end of a line without its line terminator.
    fn line_end(&self, text: &str, line: usize) -> usize {
        let start = self.starts[line] as usize;
        let next = self
            .starts
            .get(line + 1)
            .map_or(text.len(), |next| *next as usize);
        let content = &text[start..next];
        start + content.trim_end_matches(['\n', '\r']).len()
    }
}

#[cfg(test)]
mod tests {
    use super::{Encoding, LineStarts, Place};

    const TEXT: &str = "a𝛼é\r\n\rx\n";

    #[test]
    fn columns_count_code_units_of_each_encoding() {
        let lines = LineStarts::new(TEXT);
        let end = "a𝛼é".len() as u32;
        for (encoding, column) in [
            (Encoding::Utf8, 7),
            (Encoding::Utf16, 4),
            (Encoding::Utf32, 3),
        ] {
            let place = Place { line: 0, column };
            assert_eq!(lines.place(TEXT, encoding, end), place);
            assert_eq!(lines.offset(TEXT, encoding, place), end);
        }
    }

    #[test]
    fn places_out_of_range_are_brought_to_the_nearest_there_is() {
        let lines = LineStarts::new(TEXT);
        let at = |line, column| lines.offset(TEXT, Encoding::Utf16, Place { line, column });
        assert_eq!(at(0, 99), 7);
        // Within the pair of code units of one character.
        assert_eq!(at(0, 2), 1);
        assert_eq!(at(1, 5), 9);
        assert_eq!(at(99, 0), TEXT.len() as u32);
        assert_eq!(
            lines.place(TEXT, Encoding::Utf16, 999),
            Place { line: 3, column: 0 }
        );
    }
}
