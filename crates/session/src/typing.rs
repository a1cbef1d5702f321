//! An editor's typing aids: brackets in pairs, comments, indentation. Positions are byte offsets.

use std::ops::Range;

/// The brackets that come in pairs.
const PAIRS: [(char, char); 3] = [('(', ')'), ('[', ']'), ('{', '}')];

/// Returns the matching closing bracket, if this is an opening one.
pub fn closing(open: char) -> Option<char> {
    let pair = PAIRS.iter().find(|pair| pair.0 == open);
    pair.map(|pair| pair.1)
}

/// Returns whether this is a closing bracket.
pub fn is_closing(bracket: char) -> bool {
    PAIRS.iter().any(|pair| pair.1 == bracket)
}

/// Returns whether a bracket that is opened before this character is closed at once: not before a word.
pub fn closes_before(next: Option<char>) -> bool {
    next.is_none_or(|next| next.is_whitespace() || is_closing(next) || matches!(next, ',' | ';'))
}

/// Returns the white space at the start of the line that contains a position.
pub fn indentation(text: &str, at: usize) -> &str {
    let before = text.get(..at).unwrap_or(text);
    let line = &before[before.rfind('\n').map_or(0, |end| end + 1)..];
    let begin = line.find(|c| c != ' ' && c != '\t');
    &line[..begin.unwrap_or(line.len())]
}

/// One step of indentation, as the canonical layout has it.
const INDENT: &str = "    ";

/// Indents the lines of a selection of several lines; replaces any other selection by a step of indentation. Returns
/// the new text and selection.
pub fn indent(text: &str, selection: Range<usize>) -> (String, Range<usize>) {
    if !text[selection.clone()].contains('\n') {
        let end = selection.start + INDENT.len();
        let text = [&text[..selection.start], INDENT, &text[selection.end..]].concat();
        return (text, end..end);
    }
    change_lines(text, selection, |line| LineChange {
        added: if line.trim_end().is_empty() {
            ""
        } else {
            INDENT
        },
        ..LineChange::default()
    })
}

/// Removes a step of indentation from the lines of a selection. Returns the new text and selection.
pub fn unindent(text: &str, selection: Range<usize>) -> (String, Range<usize>) {
    change_lines(text, selection, |line| {
        let blanks = line.bytes().take_while(|byte| *byte == b' ').count();
        let tabs = usize::from(line.starts_with('\t'));
        LineChange {
            removed: blanks.min(INDENT.len()).max(tabs),
            ..LineChange::default()
        }
    })
}

/// A change of a line: `added` replaces `removed` bytes from a column.
#[derive(Default)]
struct LineChange<'a> {
    column: usize,
    removed: usize,
    added: &'a str,
}

/// Changes the lines that a selection touches. Returns the new text and selection.
fn change_lines<'a>(
    text: &str,
    selection: Range<usize>,
    change: impl Fn(&str) -> LineChange<'a>,
) -> (String, Range<usize>) {
    let lines = lines_of(text, &selection);
    let mut result = text[..lines.start].to_owned();
    let mut moved = [selection.start, selection.end];
    // The start of the line in the text.
    let mut from = lines.start;
    for (number, line) in text[lines.clone()].split('\n').enumerate() {
        if number > 0 {
            result.push('\n');
        }
        let change = change(line);
        result.push_str(&line[..change.column]);
        result.push_str(change.added);
        result.push_str(&line[change.column + change.removed..]);
        let changed = from + change.column;
        for (place, old) in moved.iter_mut().zip([selection.start, selection.end]) {
            // An end inside the removed bytes comes to stand at the column.
            if old >= changed {
                *place = *place + change.added.len() - change.removed.min(old - changed);
            }
        }
        from += line.len() + 1;
    }
    result.push_str(&text[lines.end..]);
    (result, moved[0]..moved[1])
}

/// Returns the range of the lines that a selection touches, without the last line break.
fn lines_of(text: &str, selection: &Range<usize>) -> Range<usize> {
    let first = text[..selection.start].rfind('\n').map_or(0, |at| at + 1);
    // A line of which only the preceding break is selected does not count.
    let last = match selection.end > selection.start && text[..selection.end].ends_with('\n') {
        true => selection.end - 1,
        false => selection.end,
    };
    first..text[last..].find('\n').map_or(text.len(), |at| last + at)
}

/// Comments out the lines of a selection, or uncomments them. Returns the new text and selection.
pub fn toggle_comment(text: &str, selection: Range<usize>, mark: &str) -> (String, Range<usize>) {
    let is_blank = |line: &str| line.trim().is_empty();
    let is_comment = |line: &str| line.trim_start().starts_with(mark);
    let lines = || text[lines_of(text, &selection)].split('\n');
    let removes = lines().all(|line| is_blank(line) || is_comment(line)) && !lines().all(is_blank);
    let has_several = lines().nth(1).is_some();
    let comment = format!("{mark} ");
    change_lines(text, selection.clone(), |line| {
        let column = line.len() - line.trim_start().len();
        if removes && is_comment(line) {
            let has_space = line[column..].starts_with(&comment);
            LineChange {
                column,
                removed: mark.len() + usize::from(has_space),
                added: "",
            }
        } else if removes || (is_blank(line) && has_several) {
            LineChange::default()
        } else {
            LineChange {
                column,
                removed: 0,
                added: &comment,
            }
        }
    })
}

/// Returns the position of the bracket at a position, before or after it, and that of its partner. Brackets in
/// comments, which start with `comment` and end at the end of the line, have none.
pub fn partners(text: &str, at: usize, comment: Option<&str>) -> Option<[usize; 2]> {
    let is_bracket = |c: char| closing(c).is_some() || is_closing(c);
    let before = text.get(..at)?.char_indices().next_back();
    let behind = text.get(at..)?.chars().next().map(|c| (at, c));
    let (place, _) = [before, behind]
        .into_iter()
        .flatten()
        .find(|(_, c)| is_bracket(*c))?;
    let mut open: Vec<(usize, char)> = Vec::new();
    let mut comments = false;
    for (at, c) in text.char_indices() {
        comments &= c != '\n';
        comments |= comment.is_some_and(|mark| text[at..].starts_with(mark));
        if comments {
            continue;
        }
        if let Some(close) = closing(c) {
            open.push((at, close));
        } else if is_closing(c) {
            // A closing bracket of another kind leaves the open ones without partners.
            let Some((partner, _)) = open.pop().filter(|(_, close)| *close == c) else {
                open.clear();
                continue;
            };
            if partner == place || at == place {
                return Some([partner, at]);
            }
        }
    }
    None
}

/// Returns the occurrences of a text in another; case matters if the wanted text has capitals.
pub fn find(text: &str, wanted: &str) -> Vec<Range<usize>> {
    if wanted.is_empty() {
        return Vec::new();
    }
    let has_capitals = wanted.chars().any(char::is_uppercase);
    let places = |text: &str, wanted: &str| {
        let found = text.match_indices(wanted);
        found
            .map(|(at, found)| at..at + found.len())
            .collect::<Vec<_>>()
    };
    match has_capitals {
        true => places(text, wanted),
        // ASCII lower case preserves offsets.
        false => places(&text.to_ascii_lowercase(), &wanted.to_ascii_lowercase()),
    }
}

#[cfg(test)]
mod tests {
    use super::{find, indent, indentation, partners, toggle_comment, unindent};

    #[test]
    fn lines_of_a_selection_are_indented_and_back() {
        let text = "a\n\n  b\r\nc";
        let (indented, selection) = indent(text, 0..7);
        assert_eq!(
            (indented.as_str(), selection.clone()),
            ("    a\n\n      b\r\nc", 4..15)
        );
        assert_eq!(unindent(&indented, selection), (text.to_owned(), 0..7));
        assert_eq!(indent("ab", 1..1), ("a    b".to_owned(), 5..5));
        assert_eq!(indent("abc", 1..2), ("a    c".to_owned(), 5..5));
        assert_eq!(unindent("  a\n\tb", 1..5), ("a\nb".to_owned(), 0..2));
        assert_eq!(unindent("", 0..0), (String::new(), 0..0));
    }

    #[test]
    fn a_selection_that_ends_in_an_indentation_keeps_its_lines() {
        let text = "a\n    b";
        assert_eq!(unindent(text, 0..3), ("a\nb".to_owned(), 0..2));
        assert_eq!(unindent("é\n    b", 0..5), ("é\nb".to_owned(), 0..3));
        assert_eq!(unindent("é\n      b", 0..10), ("é\n  b".to_owned(), 0..6));
        assert_eq!(
            unindent("    a\n    b\nc", 2..12),
            ("a\nb\nc".to_owned(), 0..4)
        );
        assert_eq!(
            indent("a\nb\nc", 0..4),
            ("    a\n    b\nc".to_owned(), 4..12)
        );
        assert_eq!(indent("ab\n\n", 1..3), ("    ab\n\n".to_owned(), 5..7));
    }

    #[test]
    fn comments_come_and_go_with_the_selection() {
        let text = "point p = (1, 2, 3);\n\n  point q = (3, 2, 1);\nlast";
        let end = text.find("\nlast").expect("a line");
        let (commented, selection) = toggle_comment(text, 3..end, "#");
        let expected = "# point p = (1, 2, 3);\n\n  # point q = (3, 2, 1);\nlast";
        assert_eq!(
            (commented.as_str(), selection.clone()),
            (expected, 5..end + 4)
        );
        assert_eq!(
            toggle_comment(&commented, selection, "#"),
            (text.to_owned(), 3..end)
        );
        // Lines of both kinds become comments; a line of which only the break before it is selected stays.
        let (both, _) = toggle_comment("# a\nb\nc", 0..6, "#");
        assert_eq!(both, "# # a\n# b\nc");
        assert_eq!(toggle_comment("#a", 0..1, "#"), ("a".to_owned(), 0..0));
        assert_eq!(toggle_comment("", 0..0, "#"), ("# ".to_owned(), 2..2));
        assert_eq!(toggle_comment("ä\n", 2..2, "#").0, "# ä\n");
    }

    #[test]
    fn brackets_find_their_partners() {
        let text = "f(a, [b]) # (\n+ {c}";
        let at = |part: &str| text.find(part).expect("there");
        let pair = |open: &str, close: &str| Some([at(open), at(close)]);
        assert_eq!(partners(text, at("("), Some("#")), pair("(", ")"));
        assert_eq!(partners(text, at(")") + 1, Some("#")), pair("(", ")"));
        assert_eq!(partners(text, at("[") + 1, Some("#")), pair("[", "]"));
        assert_eq!(partners(text, at("{"), Some("#")), pair("{", "}"));
        assert_eq!(partners(text, at("# (") + 2, Some("#")), None);
        assert_eq!(partners(text, at("a"), None), pair("(", ")"), "before it");
        for (broken, at) in [("(]", 0), ("(", 1), (")", 0), ("", 0), ("ab", 1), ("(", 7)] {
            assert_eq!(partners(broken, at, None), None, "{broken}");
        }
    }

    #[test]
    fn a_new_line_is_indented_like_the_one_before() {
        assert_eq!(indentation("a\n  b", 5), "  ");
        assert_eq!(indentation("a\n  b", 3), " ", "no further than the cursor");
        assert_eq!(indentation("\t\t", 2), "\t\t");
        assert_eq!(indentation("a", 1), "");
    }

    #[test]
    fn what_is_found_has_capitals_where_the_wanted_text_has() {
        assert_eq!(find("aAa Äa", "a"), [0..1, 1..2, 2..3, 6..7]);
        assert_eq!(find("aAaA", "A"), [1..2, 3..4]);
        assert!(find("abc", "").is_empty());
        assert_eq!(find(&"ab ".repeat(5000), "ab").len(), 5000, "all of them");
    }
}
