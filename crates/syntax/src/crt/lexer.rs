//! From text to lexemes.

use std::borrow::Cow;

use super::token::{Token, TokenKind};
use crate::span::Span;
use crate::text::line_length;

/// A token and its fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lexeme {
    /// The token; of kind [`TokenKind::Error`] where it has no value.
    pub token: Token,
    /// The fault of the token, if it has one.
    pub fault: Option<Fault>,
}

/// The fault of a token.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Fault {
    /// A character that begins no token.
    Character(char),
    /// A `.` without digits.
    LonePoint,
    /// A whole number that exceeds 32 bits.
    IntegerTooLarge,
    /// A number whose nearest 64-bit floating-point number is infinite.
    Overflow,
    /// A string that is not closed on its line.
    UnclosedString,
    /// A `\` in a string that does not begin an escape, with its span. The token is a string.
    Escape(Span),
    /// A comment of another language, which begins with `//`. The token is a comment.
    ForeignComment,
}

/// Reads a text from left to right.
#[derive(Clone, Debug)]
pub struct Lexer<'s> {
    source: &'s str,
    position: usize,
}

impl<'s> Lexer<'s> {
    /// Returns a lexer at an offset of a text of less than `u32::MAX` bytes.
    pub fn new(source: &'s str, offset: u32) -> Self {
        Self {
            source,
            position: offset as usize,
        }
    }

    /// Returns the next lexeme. Comments are lexemes; white space is skipped.
    #[inline]
    pub fn read(&mut self) -> Lexeme {
        let bytes = self.source.as_bytes();
        let mut start = self.position;
        while let Some(b' ' | b'\n' | b'\t' | b'\r') = bytes.get(start) {
            start += 1;
        }
        let rest = &bytes[start..];
        let mut fault = None;
        let (length, kind) = match rest {
            [] => (0, TokenKind::Eoi),
            [b'a'..=b'z' | b'A'..=b'Z', ..] => self.word(start),
            [b'0'..=b'9' | b'.', ..] => {
                let (length, result) = number(&self.source[start..]);
                let kind = result.unwrap_or_else(|found| {
                    fault = Some(found);
                    TokenKind::Error
                });
                (length, kind)
            }
            [b'-', b'-', ..] => (line_length(rest), TokenKind::Comment),
            [b'/', b'/', ..] => {
                fault = Some(Fault::ForeignComment);
                (line_length(rest), TokenKind::Comment)
            }
            [b'"', ..] => {
                let (length, is_closed) = string(rest);
                if is_closed {
                    let text = &self.source[start..start + length];
                    fault = string_value(text).err().map(|place| {
                        let start = start as u32;
                        Fault::Escape(place.moved(start))
                    });
                    (length, TokenKind::Text)
                } else {
                    fault = Some(Fault::UnclosedString);
                    (length, TokenKind::Error)
                }
            }
            _ => match TokenKind::from_sign(rest) {
                Some((TokenKind::Less, length)) if self.is_modifier(start + length) => {
                    (length, TokenKind::Modify)
                }
                Some((kind, length)) => (length, kind),
                None => {
                    let character = self.source[start..].chars().next();
                    let character = character.unwrap_or(char::REPLACEMENT_CHARACTER);
                    fault = Some(Fault::Character(character));
                    (character.len_utf8(), TokenKind::Error)
                }
            },
        };
        self.position = start + length;
        let span = Span::new(start as u32, self.position as u32);
        let token = Token { kind, span };
        Lexeme { token, fault }
    }

    /// Returns the kind of the next token that is not a comment, without consuming it.
    pub fn peek(&self) -> TokenKind {
        let mut ahead = self.clone();
        loop {
            let kind = ahead.read().token.kind;
            if kind != TokenKind::Comment {
                return kind;
            }
        }
    }

    fn word(&self, start: usize) -> (usize, TokenKind) {
        let rest = &self.source[start..];
        let end = rest.bytes().position(|byte| !byte.is_ascii_alphanumeric());
        let word = &rest[..end.unwrap_or(rest.len())];
        let plain = match word.as_bytes()[0] {
            b'A'..=b'Z' => TokenKind::Name,
            _ => TokenKind::Identifier,
        };
        (word.len(), TokenKind::from_word(word).unwrap_or(plain))
    }

    /// Returns true if the next token after an offset is the word of a modifier.
    fn is_modifier(&self, offset: usize) -> bool {
        let bytes = self.source.as_bytes();
        let mut at = offset;
        loop {
            match &bytes[at..] {
                [b' ' | b'\n' | b'\t' | b'\r', ..] => at += 1,
                [b'-', b'-', ..] => at += line_length(&bytes[at..]),
                [b's' | b't' | b'r', ..] => return self.word(at).1.is_modifier(),
                _ => return false,
            }
        }
    }
}

/// Returns the length of the string at the start of `bytes`, and whether it is closed. An unclosed string ends at the
/// end of its line.
fn string(bytes: &[u8]) -> (usize, bool) {
    let mut at = 1;
    loop {
        match bytes.get(at..).unwrap_or_default() {
            [b'"', ..] => return (at + 1, true),
            [b'\\', b'\n' | b'\r', ..] => at += 1,
            [b'\\', _, ..] => at += 2,
            [b'\n' | b'\r', ..] | [] => return (line_length(bytes), false),
            _ => at += 1,
        }
    }
}

/// Returns the value of a string literal between quotes, with Java's escapes: `\b \t \n \f \r \" \' \\`, `\0` to `\377`
/// and `\u0041` (The Java Language Specification, 3.3 and 3.10.7).
///
/// # Errors
/// The span of the first `\` that does not begin an escape.
pub(crate) fn string_value(literal: &str) -> Result<Cow<'_, str>, Span> {
    let end = literal.len().saturating_sub(1).max(1);
    let inside = &literal[1..end];
    if !inside.contains('\\') {
        return Ok(Cow::Borrowed(inside));
    }
    let mut units: Vec<u16> = Vec::with_capacity(inside.len());
    let mut rest = inside;
    let mut escape_of_surrogate = None;
    while let Some(first) = rest.chars().next() {
        let start = end - rest.len();
        if first != '\\' {
            units.extend(first.encode_utf16(&mut [0; 2]).iter());
            rest = &rest[first.len_utf8()..];
            continue;
        }
        let (unit, length) = escape(rest.as_bytes()).ok_or_else(|| {
            let shown = rest.chars().nth(1).map_or(0, char::len_utf8);
            Span::new(start as u32, (start + 1 + shown) as u32)
        })?;
        if (0xD800..0xE000).contains(&unit) {
            escape_of_surrogate = Some(Span::new(start as u32, (start + length) as u32));
        }
        units.push(unit);
        rest = &rest[length..];
    }
    match (String::from_utf16(&units), escape_of_surrogate) {
        (Ok(text), _) => Ok(Cow::Owned(text)),
        // Half of a surrogate pair is not a character.
        (Err(_), place) => Err(place.unwrap_or_default()),
    }
}

/// Returns the escape at the start of `bytes`, which begin with a `\`: its UTF-16 unit and its length.
fn escape(bytes: &[u8]) -> Option<(u16, usize)> {
    let unit = match bytes.get(1)? {
        b'b' => 8,
        b't' => 9,
        b'n' => 10,
        b'f' => 12,
        b'r' => 13,
        b'"' => 34,
        b'\'' => 39,
        b'\\' => 92,
        b'u' => {
            let marks = bytes[1..].iter().take_while(|byte| **byte == b'u').count();
            let digits = bytes.get(1 + marks..5 + marks)?;
            let digits = std::str::from_utf8(digits).ok()?;
            let is_hexadecimal = digits.bytes().all(|byte| byte.is_ascii_hexdigit());
            let unit = u16::from_str_radix(digits, 16).ok()?;
            return is_hexadecimal.then_some((unit, 5 + marks));
        }
        first @ b'0'..=b'7' => {
            let most = if *first <= b'3' { 3 } else { 2 };
            let digits = bytes[1..].iter().take(most);
            let digits = digits.take_while(|byte| matches!(byte, b'0'..=b'7'));
            let (value, count) = digits.fold((0, 0), |(value, count), byte| {
                (value * 8 + u16::from(byte - b'0'), count + 1)
            });
            return Some((value, 1 + count));
        }
        _ => return None,
    };
    Some((unit, 2))
}

/// Returns the longest number at the start of a text, which begins with a digit or a `.`: its length and its kind.
fn number(text: &str) -> (usize, Result<TokenKind, Fault>) {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        let rest = bytes.get(from..).unwrap_or_default();
        let count = rest.iter().position(|byte| !byte.is_ascii_digit());
        count.unwrap_or(rest.len())
    };
    let whole = digits(0);
    if bytes.get(whole) != Some(&b'.') {
        let result = match text[..whole].parse::<i32>() {
            Ok(_) => Ok(TokenKind::Integer),
            Err(_) => Err(Fault::IntegerTooLarge),
        };
        return (whole, result);
    }
    let fraction = digits(whole + 1);
    let length = whole + 1 + fraction;
    let result = match text[..length].parse::<f64>() {
        _ if whole + fraction == 0 => Err(Fault::LonePoint),
        Ok(value) if value.is_finite() => Ok(TokenKind::Float),
        _ => Err(Fault::Overflow),
    };
    (length, result)
}

#[cfg(test)]
mod tests {
    use super::{Fault, Lexer, string_value};
    use crate::crt::token::TokenKind::{self, *};

    fn lex(source: &str) -> Vec<(&str, TokenKind, Option<Fault>)> {
        let mut lexer = Lexer::new(source, 0);
        let mut lexemes = Vec::new();
        loop {
            let lexeme = lexer.read();
            if lexeme.token.kind == Eoi {
                return lexemes;
            }
            let text = lexeme.token.span.text(source);
            lexemes.push((text, lexeme.token.kind, lexeme.fault));
        }
    }

    fn kinds(source: &str) -> Vec<TokenKind> {
        lex(source).into_iter().map(|(_, kind, _)| kind).collect()
    }

    fn texts(source: &str) -> Vec<&str> {
        lex(source).into_iter().map(|(text, _, _)| text).collect()
    }

    #[test]
    fn words_are_reserved_whole_and_names_begin_with_capitals() {
        let expected = [Settings, Name, While, Identifier, Scale, Identifier, True];
        let source = "Settings Setting while whiles scale myMacro2 true";
        assert_eq!(kinds(source), expected);
    }

    #[test]
    fn two_signs_make_a_comment() {
        assert_eq!(texts("a --b\r\n c"), ["a", "--b", "c"]);
        assert_eq!(kinds("a---b"), [Identifier, Comment]);
        assert_eq!(kinds("a - -b"), [Identifier, Minus, Minus, Identifier]);
    }

    #[test]
    fn two_slashes_are_a_comment_of_another_language() {
        let expected = [
            ("a", Identifier, None),
            ("// b", Comment, Some(Fault::ForeignComment)),
            ("c", Identifier, None),
        ];
        assert_eq!(lex("a // b\nc"), expected);
        assert_eq!(kinds("a / / b"), [Identifier, Slash, Slash, Identifier]);
    }

    #[test]
    fn numbers_have_no_exponent() {
        assert_eq!(
            texts("1. 1.5 .5 1..5 1e3"),
            ["1.", "1.5", ".5", "1.", ".5", "1", "e3"]
        );
        assert_eq!(kinds("2147483647 7."), [Integer, Float]);
        assert_eq!(lex("2147483648")[0].2, Some(Fault::IntegerTooLarge));
        assert_eq!(lex(".")[0].2, Some(Fault::LonePoint));
        let long = format!("{}.", "9".repeat(400));
        assert_eq!(lex(&long)[0].2, Some(Fault::Overflow));
    }

    #[test]
    fn the_longest_sign_is_taken() {
        let expected = [
            Arrow,
            LessEqual,
            GreaterEqual,
            Equal,
            NotEqual,
            And,
            Or,
            Assign,
            Not,
        ];
        assert_eq!(kinds("-> <= >= == != && || = !"), expected);
        assert_eq!(lex("&")[0].2, Some(Fault::Character('&')));
    }

    #[test]
    fn a_sign_before_a_modifier_is_a_token_of_its_own() {
        assert_eq!(kinds("a <scale"), [Identifier, Modify, Scale]);
        assert_eq!(
            kinds("a < -- c\n rotate"),
            [Identifier, Modify, Comment, Rotate]
        );
        assert_eq!(kinds("a < scales"), [Identifier, Less, Identifier]);
        assert_eq!(kinds("a <= scale"), [Identifier, LessEqual, Scale]);
        assert_eq!(kinds("a <"), [Identifier, Less]);
    }

    #[test]
    fn strings_have_the_escapes_of_java() {
        let value = |literal: &'static str| string_value(literal).map(|text| text.into_owned());
        assert_eq!(
            value(r#""a\tb\"\\\101\7\477\u0041\uuu0042""#),
            Ok("a\tb\"\\A\u{7}'7AB".into())
        );
        assert_eq!(value(r#""\uD83D\uDE00""#), Ok("\u{1F600}".into()));
        let place = |literal| {
            string_value(literal)
                .map_err(|span| (span.start, span.end))
                .err()
        };
        assert_eq!(place(r#""a\q""#), Some((2, 4)));
        assert_eq!(place(r#""\uD83D""#), Some((1, 7)));
        assert_eq!(place(r#""\u12""#), Some((1, 3)));
        assert_eq!(
            lex("\"ab\nc")[0],
            ("\"ab", Error, Some(Fault::UnclosedString))
        );
        assert_eq!(
            lex("\"ab\\\nc")[0],
            ("\"ab\\", Error, Some(Fault::UnclosedString))
        );
        assert_eq!(lex("\"a\\\"")[0].2, Some(Fault::UnclosedString));
    }
}
