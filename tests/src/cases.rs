//! The format of the language cases: see `cases/language/README.md`.
//!
//! What flows in: the text of a `.cases` file. What flows out: its cases, each with its source and with what is
//! expected of it, and the lines they came from, so that messages and updates can name them.

use syntax::diagnostic::Severity;
use syntax::line_index::Position;

/// A program and what is expected of it.
#[derive(Clone, Debug, Default)]
pub struct Case {
    /// One sentence.
    pub title: String,
    /// The line of the title in the file, from 1.
    pub line: usize,
    /// The program.
    pub source: String,
    /// The diagnostics it must give, all of them.
    pub diagnostics: Vec<Expected>,
    /// Values set and expressions evaluated, in order.
    pub steps: Vec<Step>,
}

/// A diagnostic that must be reported.
#[derive(Clone, Debug)]
pub struct Expected {
    /// The line of the file that states it, from 1.
    pub line: usize,
    /// What is marked.
    pub mark: Mark,
    /// How grave it is.
    pub severity: Severity,
    /// Its code.
    pub code: String,
    /// Fragments of its message.
    pub message: Vec<String>,
    /// Fragments of its hint.
    pub hint: Vec<String>,
    /// Other places it must name.
    pub related: Vec<Mark>,
}

/// A marked place of a program.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Mark {
    /// Somewhere on a line.
    Line(u32),
    /// From a place to a place, exclusive.
    Exactly(Position, Position),
}

impl Mark {
    /// Whether a range lies as the mark says.
    pub fn holds(self, start: Position, end: Position) -> bool {
        match self {
            Self::Line(line) => start.line == line,
            Self::Exactly(from, to) => start == from && end == to,
        }
    }
}

/// A line that sets or evaluates.
#[derive(Clone, Debug)]
pub struct Step {
    /// The line of the file, from 1.
    pub line: usize,
    /// What is done.
    pub action: Action,
}

/// What a line that sets or evaluates does.
#[derive(Clone, Debug)]
pub enum Action {
    /// Gives a param or grid a value; with fragments, this must fail with a message that holds them.
    Set {
        /// The param or grid.
        name: String,
        /// Its new value.
        values: Vec<f64>,
        /// Fragments of the refusal.
        refusal: Option<Vec<String>>,
    },
    /// Evaluates an expression.
    Evaluate {
        /// The expression.
        text: String,
        /// What it must give.
        result: Result<Outcome, (String, Vec<String>)>,
    },
}

/// A number or a vector; none for what is undefined. A number is a list of one.
pub type Tuple = Vec<Option<f64>>;

/// The grids that a value depends on, each with its own value.
pub type Grids = Vec<(String, Vec<f64>)>;

/// What an expression gives.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// One value.
    Single(Tuple),
    /// For each instance the values of its grids, and the value.
    Instances(Vec<(Grids, Tuple)>),
    /// A value as its language writes it.
    Text(String),
}

/// Reads a file of cases.
///
/// # Errors
/// The line and what is wrong with it.
pub fn read(text: &str) -> Result<Vec<Case>, String> {
    let mut cases: Vec<Case> = Vec::new();
    let mut lines: Vec<&str> = Vec::new();
    let mut directives: Vec<&str> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        let fail = |what: &str| format!("line {number}: {what}: {line}");
        if let Some(title) = line.strip_prefix("=== ") {
            finish(cases.last_mut(), &mut lines, &mut directives);
            cases.push(Case {
                title: title.to_owned(),
                line: number,
                ..Case::default()
            });
            continue;
        }
        if line.trim().is_empty() || line.starts_with("//") {
            continue;
        }
        let case = cases
            .last_mut()
            .ok_or_else(|| fail("stands before the first case"))?;
        let (head, rest) = line.split_at(line.chars().next().map_or(0, char::len_utf8));
        match head {
            " " => lines.push(
                line.strip_prefix("  ")
                    .ok_or_else(|| fail("a source line is indented by two spaces"))?,
            ),
            "%" => directives.push(rest.trim()),
            "!" => {
                diagnostic(case, line, number, lines.len() as u32).map_err(|what| fail(&what))?
            }
            "?" | "$" => {
                let action = if head == "?" {
                    evaluation(rest.trim())
                } else {
                    setting(rest.trim())
                };
                case.steps.push(Step {
                    line: number,
                    action: action.map_err(|what| fail(&what))?,
                });
            }
            _ => return Err(fail("neither source nor expectation")),
        }
    }
    finish(cases.last_mut(), &mut lines, &mut directives);
    Ok(cases)
}

fn finish(case: Option<&mut Case>, lines: &mut Vec<&str>, directives: &mut Vec<&str>) {
    if let Some(case) = case {
        let end = if directives.contains(&"crlf") {
            "\r\n"
        } else {
            "\n"
        };
        if directives.contains(&"bom") {
            case.source.push('\u{FEFF}');
        }
        case.source.push_str(&lines.join(end));
        if !lines.is_empty() && !directives.contains(&"no-newline") {
            case.source.push_str(end);
        }
    }
    lines.clear();
    directives.clear();
}

/// Reads `! ^^^ error code: fragment | fragment; hint: fragment` or `! ^^^ related@3:`.
fn diagnostic(case: &mut Case, line: &str, number: usize, source_line: u32) -> Result<(), String> {
    let body = line.strip_prefix('!').unwrap_or(line);
    let blank = body.chars().take_while(|c| c.is_whitespace()).count();
    let rest = body.trim_start();
    // The `!` and one more character stand for the two spaces before a source line.
    let column = blank as u32;
    let marker = rest
        .chars()
        .take_while(|c| matches!(c, '^' | '~' | '|'))
        .count();
    let (carets, rest) = rest.split_at(marker);
    let (carets, rest) = match rest.strip_prefix("..") {
        Some(rest) => {
            let (end, rest) = rest.split_once(' ').ok_or("no end after `..`")?;
            let (end_line, end_column) = end.split_once(':').ok_or("an end is line:column")?;
            let end = Position {
                line: end_line.parse().map_err(|_| "bad end line")?,
                column: end_column.parse().map_err(|_| "bad end column")?,
            };
            ((carets, Some(end)), rest)
        }
        None => ((carets, None), rest),
    };
    let rest = rest.trim_start();
    let (head, texts) = rest.split_once(':').ok_or("no `:` after the code")?;
    let (kind, code) = head.split_once(' ').unwrap_or((head, ""));
    let (kind, place) = kind.split_once('@').unwrap_or((kind, ""));
    let at_line = if place.is_empty() {
        source_line
    } else {
        place.parse().map_err(|_| "bad line after `@`")?
    };
    let from = Position {
        line: at_line,
        column,
    };
    let mark = match carets {
        ("~", None) => Mark::Line(at_line),
        ("|", None) => Mark::Exactly(from, from),
        (_, Some(end)) => Mark::Exactly(from, end),
        ("", None) => return Err("nothing is marked".to_owned()),
        (carets, None) => Mark::Exactly(
            from,
            Position {
                line: at_line,
                column: column + carets.len() as u32,
            },
        ),
    };
    if kind == "related" {
        let owner = case.diagnostics.last_mut().ok_or("related to nothing")?;
        owner.related.push(mark);
        return Ok(());
    }
    let severity = match kind {
        "error" => Severity::Error,
        "warning" => Severity::Warning,
        "hint" => Severity::Hint,
        _ => return Err(format!("`{kind}` is no severity")),
    };
    let (message, hint) = texts.split_once("; hint:").unwrap_or((texts, ""));
    case.diagnostics.push(Expected {
        line: number,
        mark,
        severity,
        code: code.trim().to_owned(),
        message: fragments(message),
        hint: fragments(hint),
        related: Vec::new(),
    });
    Ok(())
}

fn fragments(text: &str) -> Vec<String> {
    text.split(" | ")
        .map(str::trim)
        .filter(|fragment| !fragment.is_empty())
        .map(str::to_owned)
        .collect()
}

/// Reads `name = 1, 2` or `name = 1 => error: fragment`.
fn setting(text: &str) -> Result<Action, String> {
    let (text, refusal) = match text.split_once("=> error:") {
        Some((text, refusal)) => (text, Some(fragments(refusal))),
        None => (text, None),
    };
    let (name, values) = text.split_once('=').ok_or("no `=`")?;
    let values: Result<Vec<f64>, _> = values
        .split(',')
        .map(|value| value.trim().parse())
        .collect();
    Ok(Action::Set {
        name: name.trim().to_owned(),
        values: values.map_err(|_| "a value is no number")?,
        refusal,
    })
}

/// Reads `expression => value`, `expression => is text` or `expression => error code: fragment`.
fn evaluation(text: &str) -> Result<Action, String> {
    let (text, result) = text.split_once("=>").ok_or("no `=>`")?;
    let result = result.trim();
    let result = if let Some(rest) = result.strip_prefix("error ") {
        let (code, message) = rest.split_once(':').ok_or("no `:` after the code")?;
        Err((code.trim().to_owned(), fragments(message)))
    } else if let Some(text) = result.strip_prefix("is ") {
        Ok(Outcome::Text(text.to_owned()))
    } else if result.contains(':') {
        let instances: Result<_, String> = result.split(';').map(instance).collect();
        Ok(Outcome::Instances(instances?))
    } else {
        Ok(Outcome::Single(tuple(result)?))
    };
    Ok(Action::Evaluate {
        text: text.trim().to_owned(),
        result,
    })
}

/// Reads `a=0,g=(1,2): value`.
fn instance(text: &str) -> Result<(Grids, Tuple), String> {
    let (mut grids, value) = text.split_once(':').ok_or("no `:` in an instance")?;
    let mut read = Vec::new();
    loop {
        grids = grids.trim_matches([' ', ',']);
        let Some((name, rest)) = grids.split_once('=') else {
            break;
        };
        let end = if rest.starts_with('(') {
            rest.find(')').ok_or("no `)`")? + 1
        } else {
            rest.find(',').unwrap_or(rest.len())
        };
        let (numbers, after) = rest.split_at(end);
        let numbers: Option<Vec<f64>> = tuple(numbers)?.into_iter().collect();
        read.push((
            name.trim().to_owned(),
            numbers.ok_or("a grid's value is null")?,
        ));
        grids = after;
    }
    Ok((read, tuple(value)?))
}

/// Reads `4`, `null` or `(1, null, 3)`.
fn tuple(text: &str) -> Result<Tuple, String> {
    let text = text.trim();
    let inner = text
        .strip_prefix('(')
        .and_then(|text| text.strip_suffix(')'))
        .unwrap_or(text);
    inner
        .split(',')
        .map(|number| match number.trim() {
            "null" => Ok(None),
            number => number
                .parse()
                .map(Some)
                .map_err(|_| format!("`{number}` is no number")),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{Action, Mark, Outcome, read};
    use syntax::line_index::Position;

    #[test]
    fn carets_give_columns_of_the_source_line() {
        let cases = read(
            "=== t\n  define a = é+1;\n!            ^^^ error some-code: one | two; hint: three\n! ~ related@1:\n",
        )
        .expect("readable");
        let expected = &cases[0].diagnostics[0];
        let (start, end) = (
            Position {
                line: 1,
                column: 12,
            },
            Position {
                line: 1,
                column: 15,
            },
        );
        assert_eq!(expected.mark, Mark::Exactly(start, end));
        assert_eq!(expected.code, "some-code");
        assert_eq!(expected.message, ["one", "two"]);
        assert_eq!(expected.hint, ["three"]);
        assert_eq!(expected.related, [Mark::Line(1)]);
        assert_eq!(cases[0].source, "define a = é+1;\n");
    }

    #[test]
    fn instances_are_read_with_their_grids() {
        let cases = read("=== t\n? a => a=1,g=(2,3): (1, null)\n").expect("readable");
        let Action::Evaluate {
            result: Ok(outcome),
            ..
        } = &cases[0].steps[0].action
        else {
            panic!("not an evaluation");
        };
        let grids = vec![
            ("a".to_owned(), vec![1.0]),
            ("g".to_owned(), vec![2.0, 3.0]),
        ];
        assert_eq!(
            *outcome,
            Outcome::Instances(vec![(grids, vec![Some(1.0), None])])
        );
    }

    #[test]
    fn a_line_that_means_nothing_is_refused() {
        assert!(read("=== t\nx = 3\n").is_err());
        assert!(read("  define a = 1;\n").is_err());
        assert!(read("=== t\n? 3\n").is_err());
    }
}
