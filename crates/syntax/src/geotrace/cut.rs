//! The ends of declarations, found without parsing them.
//!
//! A `;` ends a declaration, unless an item such as `t : [0, 1]` follows; the parser then reports that the item belongs to
//! the declaration. A `;` between brackets, which requires a bracket that was left open, ends the declaration if a
//! declaration, a comment or nothing follows; otherwise it was meant to separate components, which the parser reports. So
//! the beginning of a declaration also determines where the declaration above ends ([`LOOKAHEAD`]).

use super::declarations::DeclarationKeyword;
use crate::span::Span;

/// The number of bytes after the white space at a chunk's start that determine whether the chunk above ends there: the
/// length of the longest keyword, plus one byte that shows where it ends.
pub(super) const LOOKAHEAD: usize = "background".len() + 1;

/// The maximum distance, in bytes, in which the end of a bracket with a `;` is searched, so that long texts take linear
/// time.
const SEARCH_LENGTH: usize = 2000;

/// The state of the search after a part of a text.
#[derive(Clone, Copy, Debug, Default)]
pub struct CutState {
    /// The offset of the first unread byte.
    at: usize,
    in_comment: bool,
    /// The number of open brackets.
    depth: u32,
}

/// Appends to `ends` the offsets after the declarations that end in a text, as far as the text determines them. `state` is
/// the state after the previous call, with the beginning of this text.
pub(super) fn cut(text: &str, mut state: CutState, ends: &mut Vec<usize>) -> CutState {
    for (at, byte) in text.bytes().enumerate().skip(state.at) {
        match byte {
            b'\n' | b'\r' => state.in_comment = false,
            _ if state.in_comment => {}
            b'#' => state.in_comment = true,
            b'(' | b'[' | b'{' => state.depth = state.depth.saturating_add(1),
            b')' | b']' | b'}' => state.depth = state.depth.saturating_sub(1),
            b';' => {
                let is_end = match state.depth {
                    0 => is_item(&text[at + 1..]).map(|is_item| !is_item),
                    _ => is_end_between_brackets(&text[at + 1..]),
                };
                let Some(is_end) = is_end else {
                    state.at = at;
                    return state;
                };
                if is_end {
                    ends.push(at + 1);
                    state.depth = 0;
                }
            }
            _ => {}
        }
    }
    state.at = text.len();
    state
}

/// Appends the end after a `;` that [`cut`] left open, at the end of the whole text.
pub(super) fn cut_last(text: &str, state: CutState, ends: &mut Vec<usize>) {
    if state.depth == 0 && text.as_bytes().get(state.at) == Some(&b';') {
        ends.push(state.at + 1);
    }
}

/// Returns true if a `;` between brackets ends a declaration, given the text after it; `None` if that is too short to
/// decide.
fn is_end_between_brackets(behind: &str) -> Option<bool> {
    let behind = behind.trim_start();
    let end = behind.find(|c: char| !c.is_ascii_alphanumeric());
    if end.is_none() && behind.len() < LOOKAHEAD {
        return None;
    }
    let word = &behind[..end.unwrap_or(behind.len())];
    Some(behind.starts_with('#') || DeclarationKeyword::from_text(word).is_some())
}

/// Returns true if a word and a `:` follow, as before an interval, which begin no declaration; `None` if the text is too short
/// to decide.
pub(super) fn is_item(behind: &str) -> Option<bool> {
    let behind = behind.trim_start();
    let bytes = &behind.as_bytes()[..behind.len().min(LOOKAHEAD)];
    let word = bytes.iter().position(|byte| !byte.is_ascii_alphanumeric());
    let begins_word = bytes.first().is_none_or(u8::is_ascii_alphabetic);
    let end = bytes[word.unwrap_or(bytes.len())..]
        .iter()
        .find(|byte| !matches!(byte, b' ' | b'\t'));
    match end {
        _ if !begins_word => Some(false),
        Some(end) => Some(*end == b':'),
        None if bytes.len() < LOOKAHEAD => None,
        None => Some(false),
    }
}

/// Returns the span from a `;` between brackets to the last one before the innermost of these brackets closes; `None` if
/// it does not close before the declaration ends.
pub(super) fn separators(text: &str, first: u32) -> Option<Span> {
    let start = first as usize;
    let mut last = start;
    let mut depth = 0u32;
    for (at, byte) in text.bytes().enumerate().skip(start).take(SEARCH_LENGTH) {
        match byte {
            b'#' => return None,
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' if depth == 0 => return Some(Span::new(first, last as u32 + 1)),
            b')' | b']' | b'}' => depth -= 1,
            b';' => {
                let behind = text[at + 1..].trim_start();
                if behind.is_empty() || is_end_between_brackets(behind) == Some(true) {
                    return None;
                }
                last = at;
            }
            _ => {}
        }
    }
    None
}
