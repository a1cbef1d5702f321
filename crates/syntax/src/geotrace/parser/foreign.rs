//! Declarations, comments and intervals of other notations, and their equivalents in this one.
//!
//! In: the text from an offset on, which has no meaning there. Out: the intended meaning. Names of other notations are
//! part of the vocabulary.

use crate::geotrace::attributes::AttributeWord;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::symbols::NO_CONDITIONS;

/// An interval in another notation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ForeignInterval<'s> {
    /// The whole of its text.
    pub(super) text: &'s str,
    /// The parameter, if it is named.
    pub(super) parameter: Option<&'s str>,
    pub(super) ends: [&'s str; 2],
}

/// Returns the keyword for a word that opens a declaration in other languages. `is_applied` is true if a name and a
/// bracket follow.
pub(super) fn keyword(word: &str, is_applied: bool) -> Option<DeclarationKeyword> {
    match word {
        "func" | "fn" | "fun" => Some(DeclarationKeyword::Function),
        "let" | "const" | "var" | "def" | "set" if is_applied => Some(DeclarationKeyword::Function),
        "let" | "const" | "var" | "def" | "set" => Some(DeclarationKeyword::Define),
        "slider" | "parameter" => Some(DeclarationKeyword::Param),
        "union" | "intersection" | "difference" | "implicit" | "csg" => {
            Some(DeclarationKeyword::Solid)
        }
        "spotlight" | "lamp" => Some(DeclarationKeyword::Light),
        "sky" => Some(DeclarationKeyword::Background),
        _ => None,
    }
}

/// Returns the hint for a word that sets the appearance of objects in other languages.
pub(super) fn style(word: &str) -> Option<&'static str> {
    Some(match word {
        "color" | "colour" => {
            "a colour is an attribute of the object that has it: `point p = (1, 2, 3), color : (1, 0, 0);`"
        }
        "texture" => {
            "an image is an attribute of the object that has it: `surface s(u, v) = …, image : earth;`"
        }
        "view" => {
            "a program declares objects: write `camera eye = direction @ position;` for a view"
        }
        "style" | "plot" | "draw" | "print" | "show" | "hide" | "label" | "width" => {
            "a program declares objects: all of them are drawn, and attributes such as `, color : 0.5` set their look"
        }
        _ => return None,
    })
}

/// Returns the sign that begins a comment in another language, if the text begins with one.
pub(super) fn comment(text: &str) -> Option<&'static str> {
    let signs = ["//", "/*", "(*", "<!--", "%", "--"];
    signs.into_iter().find(|sign| text.starts_with(sign))
}

/// Returns the comment `/* … */` at the start of a text: its length, and its equivalent here. Returns `None` if it does
/// not end before a `;`, where the text is cut.
pub(super) fn block_comment(text: &str) -> Option<(usize, String)> {
    let inside = text.strip_prefix("/*")?;
    let end = inside
        .find("*/")
        .filter(|end| !inside[..*end].contains(';'))?;
    let lines: Vec<String> = inside[..end]
        .lines()
        .map(|line| format!("# {}", line.trim().trim_start_matches('*').trim()))
        .map(|line| line.trim_end().to_owned())
        .collect();
    let length = end + "/**/".len();
    let ends_line = text[length..].chars().find(|c| !" \t\r".contains(*c)) == Some('\n');
    let end = if ends_line { "" } else { "\n" };
    Some((length, lines.join("\n") + end))
}

/// Returns the interval at the start of a text, if it is written as `a <= t <= b`, `a..b`, or `t in`, `t =` or `t :`
/// before `a..b` or `[a, b]`.
pub(super) fn interval(text: &str) -> Option<ForeignInterval<'_>> {
    let text = first_item(text);
    let sides: Vec<&str> = text.split(['<', '≤']).collect();
    if let [a, parameter, b] = sides[..] {
        let [parameter, b] = [parameter, b].map(|side| side.strip_prefix('=').unwrap_or(side));
        let [a, parameter, b] = [a, parameter, b].map(str::trim);
        return (is_word(parameter) && !a.is_empty() && !b.is_empty()).then_some(ForeignInterval {
            text,
            parameter: Some(parameter),
            ends: [a, b],
        });
    }
    let (parameter, rest) = [" in ", "∈", "=", ":"]
        .into_iter()
        .find_map(|sign| text.split_once(sign))
        .map_or((None, text), |(parameter, rest)| {
            (Some(parameter.trim()), rest.trim())
        });
    let (a, b) = match rest.split_once("..") {
        Some((a, b)) => (a, b.trim_start_matches('.')),
        // Brackets alone are a correct interval.
        None if parameter.is_some() => rest
            .strip_prefix(['[', '('])?
            .strip_suffix([']', ')'])?
            .split_once(',')?,
        None => return None,
    };
    let (a, b) = (a.trim(), b.trim());
    let complete = !a.is_empty() && !b.is_empty() && parameter.is_none_or(is_word);
    complete.then_some(ForeignInterval {
        text,
        parameter,
        ends: [a, b],
    })
}

/// Returns the interval at the start of a text, if its ends are between two brackets of any kind, possibly in further ones of
/// which some are missing.
pub(super) fn bracketed_interval(text: &str) -> Option<ForeignInterval<'_>> {
    const OPEN: [char; 3] = ['(', '[', '{'];
    const CLOSE: [char; 3] = [')', ']', '}'];
    let text = first_item(text);
    let mut inside = text.strip_prefix(OPEN)?.strip_suffix(CLOSE)?.trim();
    while let (Some((first, _)), Some(rest)) = (inside.split_once(','), inside.strip_prefix(OPEN))
        && !is_balanced(first)
    {
        inside = rest.strip_suffix(CLOSE).unwrap_or(rest).trim();
    }
    let (a, b) = inside.split_once(',')?;
    let ends = [a, b].map(str::trim);
    let is_plain = |end: &str| !end.is_empty() && !end.contains(',') && is_balanced(end);
    ends.into_iter().all(is_plain).then_some(ForeignInterval {
        text,
        parameter: None,
        ends,
    })
}

/// Returns true if each bracket of a text is closed in it, whatever closes it.
fn is_balanced(text: &str) -> bool {
    let mut depth = 0;
    let is_open = text.bytes().all(|sign| {
        match sign {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth -= 1,
            _ => {}
        }
        depth >= 0
    });
    is_open && depth == 0
}

/// Returns the vector at the start of a text, if it is written as `<1, 2, 3>`.
pub(super) fn angle_vector(text: &str) -> Option<&str> {
    /// The maximum length of a vector, in bytes, that is inspected.
    const LONGEST: usize = 200;
    let inside = text.strip_prefix('<')?;
    let mut depth = 0;
    let mut commas = 0;
    for (at, sign) in inside.char_indices().take(LONGEST) {
        match sign {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            ',' if depth == 0 => commas += 1,
            '>' => return (depth == 0 && commas > 0).then(|| &text[..at + "<>".len()]),
            ';' | '\n' | '#' | '<' | ':' => return None,
            _ => {}
        }
        if depth < 0 {
            return None;
        }
    }
    None
}

/// Returns the colour `#ff8000` or `#f80` at the start of a text: its length, and its equivalent here.
pub(super) fn colour(text: &str) -> Option<(usize, String)> {
    let behind = text.strip_prefix('#')?;
    let end = behind.find(|c: char| !c.is_ascii_alphanumeric());
    let digits = &behind[..end.unwrap_or(behind.len())];
    let (size, greatest) = match digits.len() {
        3 => (1, 15.0),
        6 => (2, 255.0),
        _ => return None,
    };
    let parts: Option<Vec<String>> = (0..3)
        .map(|part| {
            let value = u8::from_str_radix(&digits[part * size..(part + 1) * size], 16).ok()?;
            let thousandths = (f64::from(value) / greatest * 1000.0).round();
            Some((thousandths / 1000.0).to_string())
        })
        .collect();
    Some((1 + digits.len(), format!("({})", parts?.join(", "))))
}

/// Returns the text between the bars of `|x|` or `||x||` at the start of a text, if it has one line and no comma outside
/// brackets.
pub(super) fn between_bars(text: &str) -> Option<&str> {
    let inside = text.strip_prefix('|')?;
    if inside.starts_with('|') {
        let between = between_bars(inside)?;
        let behind = &inside[between.len() + "||".len()..];
        return behind.starts_with('|').then_some(between);
    }
    let mut depth = 0;
    for (at, sign) in inside.char_indices() {
        match sign {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            '|' => {
                let inside = &inside[..at];
                return (depth == 0 && !inside.trim().is_empty()).then_some(inside);
            }
            ',' if depth == 0 => return None,
            ';' | '\n' | '#' => return None,
            _ => {}
        }
    }
    None
}

/// Returns the vector for an angle before or after a coordinate axis: `pi/2 (0, 0, 1)`.
pub(super) fn rotation(text: &str) -> Option<String> {
    let opening = text.find('(')?;
    let closing = opening + text[opening..].find(')')?;
    let is_between = |c: char| c.is_whitespace() || c == '*' || c == ',';
    let [before, behind] = [&text[..opening], &text[closing + 1..]];
    let [before, behind] = [before, behind].map(|side| side.trim_matches(is_between));
    let is_one_side = before.is_empty() != behind.is_empty();
    let angle = [before, behind].concat();
    if !is_one_side || angle.contains(['(', ')', ',']) {
        return None;
    }
    let axis: Vec<&str> = text[opening + 1..closing]
        .split(',')
        .map(str::trim)
        .collect();
    let is_axis = axis.len() == 3
        && axis.iter().filter(|part| **part == "1").count() == 1
        && axis.iter().filter(|part| **part == "0").count() == 2;
    let parts = axis
        .iter()
        .map(|part| if *part == "1" { &angle } else { "0" });
    let parts: Vec<&str> = parts.collect();
    is_axis.then(|| format!("({})", parts.join(", ")))
}

/// Returns the hint at a command of LaTeX, and the text that replaces it, if it is the same in every context.
pub(super) fn latex(command: &str) -> Option<(&'static str, Option<&'static str>)> {
    Some(match command.strip_prefix('\\')? {
        "cdot" => (
            "write `a b` for the product, of vectors the dot product",
            None,
        ),
        "times" => ("write `*`", Some("*")),
        "frac" | "dfrac" | "tfrac" => ("a fraction is written `a/b`", None),
        "left" | "right" => ("remove it", Some("")),
        "begin" | "end" => (NO_CONDITIONS, None),
        _ => return None,
    })
}

/// Returns the attribute for a word that sets the same property in other languages.
pub(super) fn attribute(word: &str) -> Option<AttributeWord> {
    Some(match word {
        "colour" | "pigment" => AttributeWord::Color,
        "reflection" | "reflectivity" => AttributeWord::Mirror,
        "transparency" => AttributeWord::Glass,
        "texture" => AttributeWord::Image,
        _ => return None,
    })
}

impl ForeignInterval<'_> {
    /// Returns the number of integers from one end to the other, if both ends are integers.
    pub(super) fn count(&self) -> Option<i64> {
        /// Larger counts are unlikely to be intended.
        const MOST: i64 = 1000;
        let [a, b] = self.ends.map(|end| end.parse::<i64>().ok());
        let count = b?.checked_sub(a?)?.checked_add(1)?;
        (2..=MOST).contains(&count).then_some(count)
    }

    /// Returns the ends in this notation, the smaller number first.
    pub(super) fn ends_written(&self) -> [String; 2] {
        let [a, b] = self.ends.map(|end| {
            let end = end.replace('τ', "(2pi)").replace(['\u{2212}', '–'], "-");
            let mut parts = end.split('π');
            let first = parts.next().unwrap_or_default().to_owned();
            parts.fold(first, |before, after| {
                let written = apart(&before, "pi", after);
                before + &written + after
            })
        });
        let number = |end: &str| end.parse::<f64>().ok();
        match (number(&a), number(&b)) {
            (Some(first), Some(second)) if first > second => [b, a],
            _ => [a, b],
        }
    }

    /// Returns the interval in this notation.
    pub(super) fn written(&self) -> String {
        let [a, b] = self.ends_written();
        match self.parameter {
            Some(parameter) => format!("{parameter} : [{a}, {b}]"),
            None => format!("[{a}, {b}]"),
        }
    }
}

/// Returns the replacement of a character, with spaces where it would merge with the adjacent text.
pub(super) fn apart(before: &str, text: &str, after: &str) -> String {
    let is_letter_or_digit = |c: char| c.is_ascii_alphanumeric();
    let begins_word = text.starts_with(|c: char| c.is_ascii_alphabetic());
    let run = before.trim_end_matches(is_letter_or_digit).len();
    let is_behind_word = before[run..].contains(|c: char| c.is_ascii_alphabetic());
    let joins = match text.ends_with(|c: char| c.is_ascii_digit()) {
        // A number also continues with `.` and `e`.
        true => after.starts_with(|c: char| c.is_ascii_digit() || ".e".contains(c)),
        // These signs become words.
        false => begins_word && after.starts_with(|c| is_letter_or_digit(c) || "π√".contains(c)),
    };
    let left = if begins_word && is_behind_word {
        " "
    } else {
        ""
    };
    let right = if joins { " " } else { "" };
    format!("{left}{text}{right}")
}

fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.bytes().all(|byte| byte.is_ascii_alphanumeric())
}

/// Returns the text up to the first comma outside brackets, or to the end of the line or of the declaration.
pub(super) fn first_item(text: &str) -> &str {
    /// The maximum length of an item, in bytes, that is inspected.
    const LONGEST: usize = 200;
    let mut depth = 0;
    for (at, sign) in text.char_indices() {
        match sign {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            ',' if depth == 0 => return text[..at].trim_end(),
            ';' | '\n' | '#' => return text[..at].trim_end(),
            _ => {}
        }
        if depth < 0 || at > LONGEST {
            return text[..at].trim_end();
        }
    }
    text.trim_end()
}

#[cfg(test)]
mod tests {
    use super::{
        angle_vector, apart, between_bars, block_comment, bracketed_interval, colour, interval,
        rotation,
    };

    #[test]
    fn intervals_of_other_notations_are_read() {
        for (text, written) in [
            ("0 <= t <= 2pi, u : [0, 1];", "t : [0, 2pi]"),
            ("0<t<1;", "t : [0, 1]"),
            ("-1 ≤ u ≤ (2, 3)_1", "u : [-1, (2, 3)_1]"),
            ("0..1;", "[0, 1]"),
            ("0.5...2 # the rest", "[0.5, 2]"),
            ("t in [0, 2pi];", "t : [0, 2pi]"),
            ("t = 0..1", "t : [0, 1]"),
            ("t ∈ (a, b)", "t : [a, b]"),
            ("0 ≤ t ≤ 2π", "t : [0, 2pi]"),
            ("-nπ ≤ t ≤ 2ππa", "t : [-n pi, 2pi pi a]"),
        ] {
            let found = interval(text).map(|found| found.written());
            assert_eq!(found.as_deref(), Some(written), "{text}");
        }
        for text in [
            "[0, 1]",
            "t",
            "t <= 1",
            "0 <= 2t <= 1",
            "t : [0",
            "..",
            "",
            "(0, 1)",
        ] {
            assert_eq!(interval(text), None, "{text}");
        }
    }

    #[test]
    fn a_text_in_the_place_of_a_character_stands_apart() {
        for (before, text, after, written) in [
            ("t", "^2", "3", "^2 "),
            ("2", "^2", ".5", "^2 "),
            ("t", "^2", "e3", "^2 "),
            ("t", "^2", "t", "^2"),
            ("ex", "pi", "", " pi"),
            ("x2", "pi", ")", " pi"),
            ("3 + 2", "pi", ";", "pi"),
            ("2", "pi", "r", "pi "),
            ("", "sqrt", "2", "sqrt "),
            ("2", "sqrt", "(2)", "sqrt"),
            ("", "sqrt", "π", "sqrt "),
            ("", "pi", "²", "pi"),
            ("a", "(2pi)", "3", "(2pi)"),
            ("a", "*", "3", "*"),
        ] {
            assert_eq!(apart(before, text, after), written, "{before}…{after}");
        }
    }

    #[test]
    fn brackets_around_two_ends_are_an_interval() {
        let written = |text| bracketed_interval(text).map(|found| found.written());
        assert_eq!(written("(0, 2pi);").as_deref(), Some("[0, 2pi]"));
        assert_eq!(written("{0, 1};").as_deref(), Some("[0, 1]"));
        assert_eq!(written("(-1,1), v : [0, 1]").as_deref(), Some("[-1, 1]"));
        for text in ["([0.5, 3]);", "([0.5, 3];", "( (0.5, 3) );"] {
            assert_eq!(written(text).as_deref(), Some("[0.5, 3]"), "{text}");
        }
        assert_eq!(written("((1 + 2)3, 9)").as_deref(), Some("[(1 + 2)3, 9]"));
        for text in ["(0, 1, 5)", "(0)", "(0, )", "0, 1", "", "(f(1, 2))"] {
            assert_eq!(written(text), None, "{text}");
        }
    }

    #[test]
    fn a_grid_counts_whole_numbers() {
        let count = |text| interval(text).and_then(|found| found.count());
        assert_eq!(count("1..5;"), Some(5));
        assert_eq!(count("i in [-1, 1]"), Some(3));
        for text in ["0..2pi", "5..1", "1..1", "0..1e9", "0..5000"] {
            assert_eq!(count(text), None, "{text}");
        }
    }

    #[test]
    fn angles_around_components_are_a_vector() {
        assert_eq!(
            angle_vector("<1, (2, 3)_1, 3>, t"),
            Some("<1, (2, 3)_1, 3>")
        );
        for text in [
            "<1>",
            "< 1, 2;",
            "<1, 2",
            "<(1, 2>",
            "< 1, 2 < 3>",
            "(1, 2)",
        ] {
            assert_eq!(angle_vector(text), None, "{text}");
        }
    }

    #[test]
    fn a_colour_in_hexadecimal_digits_is_a_vector() {
        for (text, expected) in [
            ("#ff0000;", Some((7, "(1, 0, 0)"))),
            ("#FF8000", Some((7, "(1, 0.502, 0)"))),
            ("#0f8, x", Some((4, "(0, 1, 0.533)"))),
            ("# ff0000", None),
            ("#ff00", None),
            ("#ff0000x", None),
            ("#red", None),
            ("ff0000", None),
        ] {
            let found = colour(text);
            let found = found
                .as_ref()
                .map(|(length, text)| (*length, text.as_str()));
            assert_eq!(found, expected, "{text}");
        }
    }

    #[test]
    fn an_angle_and_an_axis_are_one_vector() {
        for (text, written) in [
            ("pi/2 (0,0,1)", Some("(0, 0, pi/2)")),
            ("(1, 0, 0) pi", Some("(pi, 0, 0)")),
            ("2 * (0, 1, 0)", Some("(0, 2, 0)")),
            ("pi/2", None),
            ("pi/2 (1, 1, 0)", None),
            ("(0, 0, 1)", None),
            ("2(3) (0, 0, 1)", None),
        ] {
            assert_eq!(rotation(text).as_deref(), written, "{text}");
        }
    }

    #[test]
    fn bars_around_a_term_are_found() {
        assert_eq!(between_bars("|x - (y)| + 1"), Some("x - (y)"));
        assert_eq!(between_bars("|(x, y)|"), Some("(x, y)"));
        assert_eq!(between_bars("||v|| x|"), Some("v"));
        for text in ["|x", "||", "| |", "|x, y|", "|(x|", "x|y|"] {
            assert_eq!(between_bars(text), None, "{text}");
        }
    }

    #[test]
    fn a_block_comment_becomes_lines() {
        let found = block_comment("/* one\n * two */\ndefine a = 1;");
        assert_eq!(found, Some((16, "# one\n# two".to_owned())));
        let found = block_comment("/* one */ define a = 1;");
        assert_eq!(found, Some((9, "# one\n".to_owned())));
        assert_eq!(block_comment("/* one; */"), None);
        assert_eq!(block_comment("/* one"), None);
    }
}
