//! From text to lexemes. The lexer knows no names: its caller determines how a word is split into tokens.

use crate::geotrace::token::{Token, TokenKind};
use crate::span::Span;
use crate::text::line_length;

/// A token and its fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lexeme {
    /// The token; of kind [`TokenKind::Error`] where there is a fault other than [`Fault::Underflow`].
    pub token: Token,
    /// The fault of the token, if it has one.
    pub fault: Option<Fault>,
}

/// The fault of a token.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Fault {
    /// A character that begins no token.
    Character(char),
    /// A `.` without digits.
    LonePoint,
    /// A number whose nearest 64-bit floating-point number is infinite.
    Overflow,
    /// A number other than 0 whose nearest 64-bit floating-point number is 0.
    Underflow,
}

/// The rest of a word (a run of `a-z A-Z 0-9` that starts with a letter) from which the next token is taken.
#[derive(Clone, Copy, Debug)]
pub struct Word<'s> {
    /// The rest, at least one letter.
    pub rest: &'s str,
    /// The offset of the rest.
    pub start: u32,
    /// The offset of the word: less than `start` if tokens have been split off.
    pub word_start: u32,
}

impl Word<'_> {
    /// Returns true if no tokens have been split off.
    pub fn is_whole(&self) -> bool {
        self.start == self.word_start
    }
}

/// Reads a text from left to right.
#[derive(Clone, Debug)]
pub struct Lexer<'s> {
    source: &'s str,
    position: usize,
    /// The start of the word that is being split, or was split last.
    word_start: usize,
    word_end: usize,
}

impl<'s> Lexer<'s> {
    /// Creates a lexer at the start of a text of less than `u32::MAX` bytes. A byte order mark there is white space.
    pub fn new(source: &'s str) -> Self {
        let position = match source.strip_prefix('\u{FEFF}') {
            Some(rest) => source.len() - rest.len(),
            None => 0,
        };
        Self {
            source,
            position,
            word_start: 0,
            word_end: 0,
        }
    }

    /// Creates a lexer at the start of a chunk inside a text, where a byte order mark is not white space.
    pub(crate) fn inside(source: &'s str) -> Self {
        Self {
            position: 0,
            ..Self::new(source)
        }
    }

    /// Returns the text.
    pub fn source(&self) -> &'s str {
        self.source
    }

    /// Returns the span of the word that contains the last token, if that was part of a word.
    pub fn word(&self) -> Span {
        Span::new(self.word_start as u32, self.word_end as u32)
    }

    /// Goes back to the start of a token, to read it in another mode.
    pub(crate) fn rewind(&mut self, start: u32) {
        debug_assert!(
            start as usize <= self.position && self.source.is_char_boundary(start as usize)
        );
        self.position = start as usize;
    }

    /// Returns the next lexeme. At a word, `split` returns the number of bytes of its rest that form the token (at
    /// least 1, at most all) and the token's kind.
    #[inline]
    pub fn next(&mut self, split: impl FnOnce(Word<'s>) -> (usize, TokenKind)) -> Lexeme {
        let bytes = self.source.as_bytes();
        let mut start = self.position;
        while let Some(b' ' | b'\n' | b'\t' | b'\r') = bytes.get(start) {
            start += 1;
        }
        let Some(&first) = bytes.get(start) else {
            self.position = start;
            return self.lexeme(start, TokenKind::Eoi, None);
        };
        let mut fault = None;
        let (length, kind) = match first {
            b'a'..=b'z' | b'A'..=b'Z' => {
                let word = self.word_at(start);
                let (length, kind) = split(word);
                debug_assert!(0 < length && length <= word.rest.len());
                (length.clamp(1, word.rest.len()), kind)
            }
            b'0'..=b'9' | b'.' => {
                let (length, result) = number(&bytes[start..]);
                match result {
                    Ok(value) => (length, TokenKind::Number(value)),
                    Err(Fault::Underflow) => {
                        fault = Some(Fault::Underflow);
                        (length, TokenKind::Number(0.0))
                    }
                    Err(found) => {
                        fault = Some(found);
                        (length, TokenKind::Error)
                    }
                }
            }
            b'#' => (line_length(&bytes[start..]), TokenKind::Comment),
            _ => match TokenKind::from_byte(first) {
                Some(symbol) => (1, symbol),
                None => {
                    let character = self.source[start..].chars().next();
                    let character = character.unwrap_or(char::REPLACEMENT_CHARACTER);
                    fault = Some(Fault::Character(character));
                    (character.len_utf8(), TokenKind::Error)
                }
            },
        };
        self.position = start + length;
        self.lexeme(start, kind, fault)
    }

    fn lexeme(&self, start: usize, kind: TokenKind, fault: Option<Fault>) -> Lexeme {
        let span = Span::new(start as u32, self.position as u32);
        let token = Token { kind, span };
        Lexeme { token, fault }
    }

    /// Returns the word at `start`, or the rest of it. Each word is measured once, however often it is split.
    fn word_at(&mut self, start: usize) -> Word<'s> {
        if start >= self.word_end {
            self.word_start = start;
            let bytes = &self.source.as_bytes()[start..];
            let length = bytes.iter().position(|byte| !byte.is_ascii_alphanumeric());
            self.word_end = start + length.unwrap_or(bytes.len());
        }
        Word {
            rest: &self.source[start..self.word_end],
            start: start as u32,
            word_start: self.word_start as u32,
        }
    }
}

/// Returns the span of a name in double quotes, `"earth"` or `"earth.png"`, including the quotes; `first` is the span of the
/// first quote. The span is limited to one word and its extension: an edit after them must not change what was read before.
pub(crate) fn quoted_name(source: &str, first: Span) -> Option<Span> {
    let inner = source[first.start as usize..].strip_prefix('"')?;
    let length_of_word = |text: &str| {
        let bytes = text.bytes();
        bytes.take_while(u8::is_ascii_alphanumeric).count()
    };
    let mut length = length_of_word(inner);
    if let Some(ending) = inner[length..].strip_prefix('.') {
        length += 1 + length_of_word(ending);
    }
    let is_closed = inner[length..].starts_with('"');
    (is_closed && length > 0).then(|| Span::new(first.start, first.end + length as u32 + 1))
}

/// Returns the value of a text that has been read as a number.
pub(crate) fn literal(text: &str) -> f64 {
    match number(text.as_bytes()) {
        (_, Ok(value)) => value,
        // A number nearer to 0 than any other was read as 0.
        (_, Err(_)) => 0.0,
    }
}

/// Returns the longest decimal literal at the start of `bytes`, which begin with a digit or a `.`: its length and its
/// value, correctly rounded.
fn number(bytes: &[u8]) -> (usize, Result<f64, Fault>) {
    let digits = |from: usize| {
        let rest = bytes.get(from..).unwrap_or_default();
        let count = rest.iter().position(|byte| !byte.is_ascii_digit());
        count.unwrap_or(rest.len())
    };
    let whole = digits(0);
    let mut length = whole;
    let mut plain = true;
    if bytes.get(length) == Some(&b'.') {
        let fraction = digits(length + 1);
        if whole + fraction == 0 {
            return (1, Err(Fault::LonePoint));
        }
        length += 1 + fraction;
        plain = false;
    }
    if bytes.get(length) == Some(&b'e') {
        let sign = matches!(bytes.get(length + 1), Some(b'+' | b'-'));
        let exponent = digits(length + 1 + usize::from(sign));
        if exponent > 0 {
            length += 1 + usize::from(sign) + exponent;
            plain = false;
        }
    }
    let literal = &bytes[..length];
    // Fifteen digits are exact in 53 bits.
    if plain && length <= 15 {
        let fold = |value: u64, byte: &u8| value * 10 + u64::from(byte - b'0');
        return (length, Ok(literal.iter().fold(0, fold) as f64));
    }
    let text = std::str::from_utf8(literal).unwrap_or_default();
    let value = text.parse::<f64>().unwrap_or(f64::INFINITY);
    let mantissa = literal.split(|byte| *byte == b'e').next();
    let is_zero = |mantissa: &[u8]| mantissa.iter().all(|byte| matches!(byte, b'0' | b'.'));
    let result = if value.is_infinite() {
        Err(Fault::Overflow)
    } else if value == 0.0 && !mantissa.is_some_and(is_zero) {
        Err(Fault::Underflow)
    } else {
        Ok(value)
    };
    (length, result)
}

#[cfg(test)]
mod tests {
    use super::{Fault, Lexeme, Lexer, quoted_name};
    use crate::geotrace::token::TokenKind;
    use crate::span::Span;

    /// The lexemes of a text whose words are never split.
    fn lex(source: &str) -> Vec<Lexeme> {
        let mut lexer = Lexer::new(source);
        let mut lexemes = Vec::new();
        loop {
            let lexeme = lexer.next(|word| (word.rest.len(), TokenKind::Undefined));
            if lexeme.token.kind == TokenKind::Eoi {
                return lexemes;
            }
            lexemes.push(lexeme);
        }
    }

    fn texts(source: &str) -> Vec<&str> {
        let lexemes = lex(source);
        lexemes.iter().map(|l| l.token.span.text(source)).collect()
    }

    #[test]
    fn a_name_in_quotes_is_one_word_and_its_ending() {
        for (source, expected) in [
            ("\"earth\"", Some("\"earth\"")),
            ("\"earth.png\" \"", Some("\"earth.png\"")),
            ("\"e1\"\"e2\"", Some("\"e1\"")),
            ("\"\"", None),
            ("\"earth", None),
            ("\"earth;\"", None),
            ("\"two words\"", None),
            ("\"a.b.c\"", None),
            ("earth\"", None),
        ] {
            let found = quoted_name(source, Span::new(0, 1));
            assert_eq!(found.map(|span| span.text(source)), expected, "{source}");
        }
        assert_eq!(
            quoted_name("a \"b\"", Span::new(2, 3)),
            Some(Span::new(2, 5))
        );
    }

    #[test]
    fn a_comment_ends_with_its_line() {
        for end in ["\n", "\r\n", "\r"] {
            let source = format!("# one{end}a # two{end}");
            assert_eq!(texts(&source), ["# one", "a", "# two"], "{source:?}");
        }
    }

    #[test]
    fn numbers_are_the_longest_decimal_literals() {
        for (source, expected) in [
            ("2", vec!["2"]),
            (".5", vec![".5"]),
            ("1.", vec!["1."]),
            ("1.25", vec!["1.25"]),
            ("3e-4", vec!["3e-4"]),
            ("3e+4x", vec!["3e+4", "x"]),
            ("2e", vec!["2", "e"]),
            ("2e-x", vec!["2", "e", "-", "x"]),
            ("2exp x", vec!["2", "exp", "x"]),
            ("1..2", vec!["1.", ".2"]),
            ("1.2.3", vec!["1.2", ".3"]),
            ("1.e3", vec!["1.e3"]),
            (".e3", vec![".", "e3"]),
        ] {
            assert_eq!(texts(source), expected, "{source}");
        }
    }

    #[test]
    fn numbers_have_the_nearest_value() {
        for literal in [
            "0",
            "2",
            "007",
            "999999999999999",
            "9007199254740993",
            "0.1",
            "1.",
            ".5",
            "3e-4",
            "123456789012345678901234567890",
            "4.9e-324",
            "1.7976931348623157e308",
            "0e999",
            "0.000e9",
        ] {
            let value: f64 = literal.parse().expect("a number");
            assert_eq!(
                lex(literal)[0].token.kind,
                TokenKind::Number(value),
                "{literal}"
            );
            assert_eq!(lex(literal)[0].fault, None, "{literal}");
        }
    }

    #[test]
    fn numbers_out_of_range_and_lone_points_are_faults() {
        for (source, kind, fault) in [
            ("1e999", TokenKind::Error, Fault::Overflow),
            (".", TokenKind::Error, Fault::LonePoint),
            ("1e-999", TokenKind::Number(0.0), Fault::Underflow),
            ("\0", TokenKind::Error, Fault::Character('\0')),
            ("π", TokenKind::Error, Fault::Character('π')),
        ] {
            let lexemes = lex(source);
            assert_eq!(lexemes.len(), 1);
            assert_eq!(
                (lexemes[0].token.kind, lexemes[0].fault),
                (kind, Some(fault))
            );
        }
        let long = format!("1{}", "0".repeat(1000));
        assert_eq!(lex(&long)[0].fault, Some(Fault::Overflow));
    }

    #[test]
    fn a_comment_ends_before_the_end_of_its_line() {
        assert_eq!(texts("a#π ; \r\nb#"), ["a", "#π ; ", "b", "#"]);
    }

    #[test]
    fn a_word_is_split_as_it_is_told_to_be() {
        let mut lexer = Lexer::new("abc2d x");
        let mut seen = Vec::new();
        for _ in 0..5 {
            lexer.next(|word| {
                seen.push((word.rest, word.start, word.word_start));
                (1, TokenKind::Undefined)
            });
        }
        // The 2 is a number: a word starts with a letter, and so does what is left of it.
        let expected = [("abc2d", 0, 0), ("bc2d", 1, 0), ("c2d", 2, 0), ("d", 4, 0)];
        assert_eq!(seen, expected);
    }

    #[test]
    fn a_byte_order_mark_is_white_space_at_the_start_alone() {
        assert_eq!(texts("\u{FEFF}a\u{FEFF}"), ["a", "\u{FEFF}"]);
    }
}
