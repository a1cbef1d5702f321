//! The text in the page's offsets: UTF-16 code units, where the core counts bytes of UTF-8.

use std::fmt;
use std::ops::Range;

use serde::{Deserialize, Serialize};
use syntax::span::Span;

/// The number of bytes between two marks.
const STRIDE: usize = 256;

/// A text whose offsets can be converted both ways, in a time that does not grow with the text.
#[derive(Clone, Debug, Default)]
pub struct Utf16Text {
    text: String,
    /// The UTF-16 units of the characters that start before each multiple of [`STRIDE`].
    marks: Vec<u32>,
}

/// A half-open range in UTF-16 units.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Utf16Range {
    /// The first unit.
    pub from: u32,
    /// The unit after the last.
    pub to: u32,
}

/// A range of a text, and its replacement.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Utf16Edit {
    /// The first unit.
    pub from: u32,
    /// The unit after the last.
    pub to: u32,
    /// The new text.
    pub insert: String,
}

/// The error that the ranges of edits are not ordered ranges of the text.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct EditsDoNotFit;

impl fmt::Display for EditsDoNotFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the edits are not those of the text")
    }
}

impl std::error::Error for EditsDoNotFit {}

/// Returns the number of UTF-16 units of the characters that start in some bytes.
fn units(bytes: &[u8]) -> u32 {
    let of = |byte: &u8| match *byte {
        0x80..0xC0 => 0,
        0xF0.. => 2,
        _ => 1,
    };
    bytes.iter().map(of).sum()
}

impl Utf16Text {
    /// Returns a text with its marks.
    pub fn new(text: impl Into<String>) -> Self {
        let mut source = Self {
            text: text.into(),
            marks: Vec::new(),
        };
        source.mark_from(0);
        source
    }

    /// Returns the text.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Recomputes the marks after a byte.
    fn mark_from(&mut self, byte: usize) {
        self.marks.truncate(byte / STRIDE + 1);
        if self.marks.is_empty() {
            self.marks.push(0);
        }
        let bytes = self.text.as_bytes();
        while self.marks.len() * STRIDE <= bytes.len() {
            let start = (self.marks.len() - 1) * STRIDE;
            let last = self.marks[self.marks.len() - 1];
            self.marks.push(last + units(&bytes[start..start + STRIDE]));
        }
    }

    /// Returns the UTF-16 offset of a byte; for a byte beyond the end, that of the end.
    pub fn utf16(&self, byte: u32) -> u32 {
        let bytes = self.text.as_bytes();
        let byte = (byte as usize).min(bytes.len());
        let mark = byte / STRIDE;
        self.marks[mark] + units(&bytes[mark * STRIDE..byte])
    }

    /// Returns the byte of a UTF-16 offset; for one beyond the end, the end; for one inside a character, the
    /// character's start.
    pub fn byte(&self, utf16: u32) -> u32 {
        let mark = self.marks.partition_point(|units| *units <= utf16) - 1;
        let mut left = utf16 - self.marks[mark];
        let bytes = self.text.as_bytes();
        let mut at = mark * STRIDE;
        // A mark may be inside a character, whose units count before the mark.
        while at < bytes.len() {
            let width = units(&bytes[at..=at]);
            if width > left || (left == 0 && self.text.is_char_boundary(at)) {
                break;
            }
            left -= width;
            at += 1;
        }
        at as u32
    }

    /// Returns the range of a span.
    pub fn range(&self, span: Span) -> Utf16Range {
        Utf16Range {
            from: self.utf16(span.start),
            to: self.utf16(span.end),
        }
    }

    /// Returns the span of a range.
    pub fn span(&self, range: Utf16Range) -> Span {
        let start = self.byte(range.from);
        Span::new(start, self.byte(range.to).max(start))
    }

    /// Applies edits whose ranges refer to the present text, in order and without overlap. `each` receives the replaced
    /// bytes, from the last edit to the first, so that the offsets of the others stay valid.
    ///
    /// # Errors
    /// [`EditsDoNotFit`]; the text is then unchanged, and `each` has not been called.
    pub fn edit(
        &mut self,
        edits: &[Utf16Edit],
        mut each: impl FnMut(Span, &str),
    ) -> Result<(), EditsDoNotFit> {
        let end = self.utf16(u32::MAX);
        let ends = edits.iter().map(|edit| edit.to);
        let before = std::iter::once(0).chain(ends);
        let fits = |(edit, before): (&Utf16Edit, u32)| {
            before <= edit.from && edit.from <= edit.to && edit.to <= end
        };
        if !edits.iter().zip(before).all(fits) {
            return Err(EditsDoNotFit);
        }
        let mut first = self.text.len();
        for edit in edits.iter().rev() {
            let Range { start, end } = self.byte(edit.from)..self.byte(edit.to);
            each(Span::new(start, end), &edit.insert);
            self.text
                .replace_range(start as usize..end as usize, &edit.insert);
            // Marks before the edit are valid, and earlier edits read none beyond it.
            first = start as usize;
        }
        self.mark_from(first);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Utf16Edit, Utf16Text};

    /// A text with characters of 1 to 4 bytes, longer than some strides.
    fn mixed() -> String {
        "π = 3; # 𝕊² → ∞\n".repeat(60)
    }

    #[test]
    fn offsets_are_those_of_utf16() {
        let text = mixed();
        let source = Utf16Text::new(text.as_str());
        let mut utf16 = 0;
        for (byte, character) in text.char_indices() {
            assert_eq!(source.utf16(byte as u32), utf16);
            assert_eq!(source.byte(utf16), byte as u32, "{utf16}");
            if character.len_utf16() == 2 {
                assert_eq!(source.byte(utf16 + 1), byte as u32);
            }
            utf16 += character.len_utf16() as u32;
        }
        assert_eq!(source.byte(utf16), text.len() as u32);
        assert_eq!(source.byte(utf16 + 9), text.len() as u32);
        assert_eq!(source.utf16(u32::MAX), utf16);
    }

    #[test]
    fn edits_are_those_of_a_string_of_utf16() {
        let mut units: Vec<u16> = mixed().encode_utf16().collect();
        let mut source = Utf16Text::new(mixed());
        let mut seed = 1_u64;
        let mut random = |below: usize| {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 33) as usize % below
        };
        for _ in 0..500 {
            let mut places: Vec<usize> = (0..4).map(|_| random(units.len() + 1)).collect();
            places.sort_unstable();
            let is_inside = |at: usize| {
                units
                    .get(at)
                    .is_some_and(|unit| (0xDC00..0xE000).contains(unit))
            };
            for place in &mut places {
                *place -= usize::from(is_inside(*place));
            }
            let edits: Vec<Utf16Edit> = places
                .chunks(2)
                .map(|pair| Utf16Edit {
                    from: pair[0] as u32,
                    to: (pair[0] + (pair[1] - pair[0]).min(3)) as u32,
                    insert: ["", "a", "∞", "𝕊π"][random(4)].to_owned(),
                })
                .map(|edit| Utf16Edit {
                    to: edit.to - u32::from(is_inside(edit.to as usize)),
                    ..edit
                })
                .collect();
            for edit in edits.iter().rev() {
                let insert = edit.insert.encode_utf16();
                units.splice(edit.from as usize..edit.to as usize, insert);
            }
            source.edit(&edits, |_, _| {}).expect("they fit");
            assert_eq!(source.as_str(), String::from_utf16_lossy(&units));
            let fresh = Utf16Text::new(source.as_str());
            assert_eq!(source.marks, fresh.marks);
        }
    }

    #[test]
    fn edits_that_do_not_fit_change_nothing() {
        let edit = |from, to| Utf16Edit {
            from,
            to,
            insert: "x".to_owned(),
        };
        for edits in [
            vec![edit(2, 1)],
            vec![edit(0, 4)],
            vec![edit(1, 2), edit(0, 1)],
        ] {
            let mut source = Utf16Text::new("abc");
            let refused = source.edit(&edits, |_, _| panic!("it is called"));
            assert!(refused.is_err());
            assert_eq!(source.as_str(), "abc");
        }
    }
}
