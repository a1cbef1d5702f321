//! Texts of any language: decodes the bytes of a file, or returns a diagnostic if they are not a text. Also the limits of
//! a text.

use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::span::Span;

/// The maximum number of diagnostics for a text; the last one reports that others are omitted.
pub const MAX_DIAGNOSTICS: usize = 100_000;

/// Returns the text with its first letter in upper case.
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

/// Returns the last diagnostic of a text with [`MAX_DIAGNOSTICS`] or more, at the span of the one that it replaces.
pub(crate) fn too_many_diagnostics(span: Span) -> Diagnostic {
    let message = format!("more than {MAX_DIAGNOSTICS} diagnostics: the rest is omitted");
    Diagnostic::error(codes::TOO_MANY_ERRORS, span, message)
}

/// Returns the diagnostic of a text of 4 GiB or more, which is not read.
pub(crate) fn too_large() -> Diagnostic {
    let message = "this text is too large: the limit is 4 GiB";
    Diagnostic::error(codes::FILE_TOO_LARGE, Span::default(), message)
}

/// Returns the number of bytes before the end of the first line.
pub(crate) fn line_length(bytes: &[u8]) -> usize {
    let end = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
    end.unwrap_or(bytes.len())
}

/// Returns the bytes as a text.
///
/// # Errors
/// One diagnostic, `invalid-utf8`, at the first byte that is not UTF-8. Its span refers to the lossy text
/// ([`String::from_utf8_lossy`]), which agrees with the bytes up to there, so that a
/// [`LineIndex`](crate::line_index::LineIndex) of the lossy text gives its line and column.
pub fn decode(bytes: &[u8]) -> Result<&str, Box<Diagnostic>> {
    std::str::from_utf8(bytes).map_err(|error| {
        let start = error.valid_up_to();
        let byte = bytes.get(start).copied().unwrap_or_default();
        let start = u32::try_from(start).unwrap_or(u32::MAX - REPLACEMENT_LENGTH);
        let diagnostic = Diagnostic::error(
            codes::INVALID_UTF8,
            Span::new(start, start + REPLACEMENT_LENGTH),
            format!("this is not UTF-8: the byte 0x{byte:02X} is not valid here"),
        )
        .with_hint("save the file with the encoding UTF-8");
        Box::new(diagnostic)
    })
}

/// The number of bytes of U+FFFD, which replaces the bad bytes in the lossy text.
const REPLACEMENT_LENGTH: u32 = char::REPLACEMENT_CHARACTER.len_utf8() as u32;

#[cfg(test)]
mod tests {
    use super::{decode, too_large};
    use crate::line_index::{LineIndex, Position};

    /// No test has a text of 4 GiB.
    #[test]
    fn a_text_that_is_too_large_has_a_code_and_names_the_limit() {
        let diagnostic = too_large();
        assert_eq!(diagnostic.code.0, "file-too-large");
        assert!(diagnostic.message.contains("4 GiB"));
    }

    #[test]
    fn a_text_is_decoded_without_a_copy() {
        assert_eq!(decode("π\n".as_bytes()), Ok("π\n"));
    }

    #[test]
    fn the_first_bad_byte_has_a_line_and_a_column() {
        for (bytes, line, column) in [
            (&b"ab\n\xC3\xA9\xFFx"[..], 2, 2),
            (b"\xFF", 1, 1),
            (b"abc\xE2\x82", 1, 4),
        ] {
            let diagnostic = decode(bytes).expect_err("invalid");
            let lossy = String::from_utf8_lossy(bytes);
            let index = LineIndex::new(&lossy);
            assert_eq!(
                index.position(diagnostic.span.start),
                Position { line, column }
            );
            assert!(lossy.is_char_boundary(diagnostic.span.end as usize));
        }
    }
}
