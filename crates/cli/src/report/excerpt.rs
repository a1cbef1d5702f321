//! Excerpts. In: a text and a range. Out: the few lines that a diagnostic shows, even if lines are megabytes long.
//!
//! `annotate-snippets` also trims lines to a width, but reads them in full first.

use std::ops::Range;

use syntax::span::Span;

/// The maximum number of characters on either side of the marked range. The renderer trims further.
const REACH: usize = 200;
/// The maximum number of marked characters on a line of a longer range: as many as fit into the renderer's width.
const MARKED: usize = 96;
/// The maximum number of lines that are shown of a longer range.
const LINES: usize = 4;

/// A piece of a text, from the line on which a range starts.
#[derive(Debug)]
pub(super) struct Excerpt {
    /// The lines, truncated with `…` if they are too long.
    pub(super) text: String,
    /// The marked range in `text`.
    pub(super) marked: Range<usize>,
}

impl Excerpt {
    /// Returns the lines around `span`. Reads no more than it returns.
    pub(super) fn new(text: &str, span: Span) -> Self {
        let start = (span.start as usize).min(text.len());
        let end = (span.end as usize).clamp(start, text.len());

        let (before, cut_before) = line_before(&text[..start]);
        let marked = marked_part(&text[start..end]);
        let (after, cut_after) = line_after(&text[start + marked.len()..]);

        let mut shown = String::new();
        if cut_before {
            shown.push('…');
        }
        shown.push_str(before);
        let marked_start = shown.len();
        shown.push_str(marked);
        let marked_end = shown.len();
        shown.push_str(after);
        if cut_after {
            shown.push('…');
        }
        Self {
            text: shown,
            marked: marked_start..marked_end,
        }
    }
}

/// Returns the last line of `text`, and whether it was truncated.
fn line_before(text: &str) -> (&str, bool) {
    let mut letters = text.char_indices().rev();
    let mut start = text.len();
    for _ in 0..REACH {
        match letters.next() {
            None | Some((_, '\n')) => return (&text[start..], false),
            Some((offset, _)) => start = offset,
        }
    }
    (
        &text[start..],
        !matches!(letters.next(), None | Some((_, '\n'))),
    )
}

/// Returns the first line of `text`, and whether it was truncated.
fn line_after(text: &str) -> (&str, bool) {
    let mut letters = text.char_indices();
    for _ in 0..REACH {
        match letters.next() {
            None => return (text, false),
            Some((offset, '\n')) => return (text[..offset].trim_end_matches('\r'), false),
            Some(_) => {}
        }
    }
    let end = letters.offset();
    (
        &text[..end],
        !matches!(letters.next(), None | Some((_, '\n'))),
    )
}

/// Returns the part of a range's text that is shown.
fn marked_part(text: &str) -> &str {
    let mut newlines = 0;
    let mut on_line = 0;
    for (offset, letter) in text.char_indices() {
        if letter == '\n' {
            newlines += 1;
            on_line = 0;
            if newlines == LINES {
                return text[..offset].trim_end_matches('\r');
            }
        } else {
            on_line += 1;
            if on_line > MARKED {
                return &text[..offset];
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str, start: u32, end: u32) -> (String, String) {
        let excerpt = Excerpt::new(text, Span::new(start, end));
        let marked = excerpt.text[excerpt.marked.clone()].to_owned();
        (excerpt.text, marked)
    }

    #[test]
    fn the_whole_line_is_shown() {
        let text = "one\ntwo three\r\nfour";
        assert_eq!(shown(text, 8, 13), ("two three".into(), "three".into()));
        assert_eq!(shown(text, 15, 19), ("four".into(), "four".into()));
        assert_eq!(shown(text, 3, 3), ("one".into(), String::new()));
        assert_eq!(
            shown(text, 0, 7),
            ("one\ntwo three".into(), "one\ntwo".into())
        );
    }

    #[test]
    fn long_lines_are_cut_on_both_sides() {
        let text = "é".repeat(10_000);
        let (excerpt, marked) = shown(&text, 10_000, 10_002);
        assert_eq!(marked, "é");
        assert_eq!(excerpt.chars().count(), 2 * REACH + 3);
        assert!(excerpt.starts_with('…') && excerpt.ends_with('…'));
    }

    #[test]
    fn long_ranges_are_cut() {
        let text = "ab\n".repeat(50);
        let (excerpt, marked) = shown(&text, 0, 150);
        assert_eq!(excerpt, marked);
        assert_eq!(excerpt.lines().count(), LINES);
    }
}
