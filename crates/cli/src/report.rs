//! Diagnostics as text: one line with the position and the sentence, the source below it (by `annotate-snippets`), and
//! a hint.
//!
//! ```text
//! sphere.gtr:3:12: error[undefined-name]: `foo` is not defined
//!   |
//! 3 | point p = (foo, 1, 2);
//!   |            ^^^
//!   |
//!   = help: did you mean `f`?
//! ```

mod excerpt;
pub(crate) mod json;

use std::fmt::Write;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::line_index::LineIndex;
use syntax::span::Span;

use crate::number;
use crate::source::SourceText;
use crate::style::{TextColours, escaped};
use excerpt::Excerpt;

/// The maximum number of diagnostics of a file that are shown with their source.
const WITH_SNIPPET: usize = 100;
/// The maximum number of diagnostics of a file that are shown. JSON has all of them.
const SHOWN: usize = 1000;
/// The maximum number of characters of a sentence, which may quote a word of any length.
const LONGEST_SENTENCE: usize = 400;
/// The width of snippets, in columns.
const WIDTH: usize = 110;

/// The numbers of errors and warnings.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub(crate) struct SeverityCounts {
    /// Errors.
    pub(crate) errors: usize,
    /// Warnings.
    pub(crate) warnings: usize,
}

impl SeverityCounts {
    /// Counts diagnostics by severity.
    pub(crate) fn count(diagnostics: &[Diagnostic]) -> Self {
        let of = |severity| {
            diagnostics
                .iter()
                .filter(|one| one.severity == severity)
                .count()
        };
        Self {
            errors: of(Severity::Error),
            warnings: of(Severity::Warning),
        }
    }

    /// Returns the sum of two counts.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            errors: self.errors + other.errors,
            warnings: self.warnings + other.warnings,
        }
    }

    /// Formats the counts: `2 errors, 1 warning`, or `no errors`.
    pub(crate) fn text(self) -> String {
        let mut parts = Vec::new();
        if self.errors > 0 {
            parts.push(number::count(self.errors, "error"));
        }
        if self.warnings > 0 {
            parts.push(number::count(self.warnings, "warning"));
        }
        if parts.is_empty() {
            "no errors".into()
        } else {
            parts.join(", ")
        }
    }
}

/// Formats the diagnostics of one text, in order.
pub(crate) fn text(
    source: &SourceText,
    diagnostics: &[Diagnostic],
    colours: TextColours,
) -> String {
    let page = Page {
        source,
        lines: source.lines(),
        renderer: colours.renderer().term_width(WIDTH),
        colours,
    };
    let mut text = String::new();
    for (index, diagnostic) in diagnostics.iter().take(SHOWN).enumerate() {
        page.head(&mut text, diagnostic);
        if index >= WITH_SNIPPET {
            continue;
        }
        let level = match diagnostic.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
            Severity::Hint => Level::HELP,
        };
        let hint = diagnostic.hint.as_deref().map(readable);
        page.snippet(&mut text, diagnostic.span, level, hint.as_deref());
        for related in &diagnostic.related {
            page.place(&mut text, related.span);
            let _ = writeln!(
                text,
                "{}: {}",
                colours.help("note"),
                readable(&related.message)
            );
            page.snippet(&mut text, related.span, Level::NOTE, None);
        }
        text.push('\n');
    }
    if diagnostics.len() > SHOWN {
        let _ = writeln!(
            text,
            "… and {} more in {}; `--format json` has them all",
            number::grouped((diagnostics.len() - SHOWN) as u64),
            escaped(&source.name),
        );
    }
    text
}

/// The parts that all diagnostics of a text share.
struct Page<'a> {
    source: &'a SourceText,
    lines: LineIndex<'a>,
    renderer: Renderer,
    colours: TextColours,
}

impl Page<'_> {
    /// Writes `file:line:column: `.
    fn place(&self, text: &mut String, span: Span) {
        let start = self.lines.position(span.start);
        let name = escaped(&self.source.name);
        let place = format!("{name}:{}:{}:", start.line, start.column);
        let _ = write!(text, "{} ", self.colours.strong(&place));
    }

    /// Writes `file:line:column: error[code]: sentence`.
    fn head(&self, text: &mut String, diagnostic: &Diagnostic) {
        self.place(text, diagnostic.span);
        let word = format!("{}[{}]", diagnostic.severity.name(), diagnostic.code.0);
        let word = match diagnostic.severity {
            Severity::Error => self.colours.error(&word),
            Severity::Warning => self.colours.warning(&word),
            Severity::Hint => self.colours.help(&word),
        };
        let sentence = self.colours.strong(&readable(&diagnostic.message));
        let _ = writeln!(text, "{word}: {sentence}");
    }

    /// Writes the source at a range, and a hint.
    fn snippet(&self, text: &mut String, span: Span, level: Level<'_>, hint: Option<&str>) {
        let excerpt = Excerpt::new(&self.source.text, span);
        let mut group = Group::with_level(level).element(
            Snippet::source(excerpt.text.as_str())
                .line_start(self.lines.position(span.start).line as usize)
                .fold(false)
                .annotation(AnnotationKind::Primary.span(excerpt.marked.clone())),
        );
        if let Some(hint) = hint {
            group = group.element(Level::HELP.message(hint));
        }
        text.push_str(&self.renderer.render(&[group]));
        text.push('\n');
    }
}

/// Converts a sentence to one line of limited length, without control characters.
fn readable(sentence: &str) -> String {
    match sentence.char_indices().nth(LONGEST_SENTENCE) {
        Some((end, _)) => escaped(&sentence[..end]) + "…",
        None => escaped(sentence),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use syntax::diagnostic::{Code, Related};

    fn source(text: &str) -> SourceText {
        SourceText::new("a.gtr".into(), text.into())
    }

    fn error(span: Span, message: &str) -> Diagnostic {
        Diagnostic {
            severity: Severity::Error,
            code: Code("undefined-name"),
            span,
            message: message.into(),
            hint: None,
            related: Vec::new(),
            fixes: Vec::new(),
        }
    }

    #[test]
    fn a_diagnostic_says_where_what_and_what_to_do() {
        let source = source("# a\npoint p = (foo, 1, 2);\n");
        let diagnostic = Diagnostic {
            hint: Some("did you mean `f`?".into()),
            related: vec![Related {
                span: Span::new(0, 3),
                message: "see here".into(),
            }],
            ..error(Span::new(15, 18), "`foo` is not defined")
        };
        let expected = "\
a.gtr:2:12: error[undefined-name]: `foo` is not defined
  |
2 | point p = (foo, 1, 2);
  |            ^^^
  |
  = help: did you mean `f`?
a.gtr:1:1: note: see here
  |
1 | # a
  | ^^^

";
        assert_eq!(text(&source, &[diagnostic], TextColours::plain()), expected);
    }

    #[test]
    fn the_name_of_a_file_does_not_move_the_cursor() {
        let named = SourceText::new("\u{1b}[31ma\n.gtr".into(), "foo".into());
        let text = text(
            &named,
            &[error(Span::new(0, 3), "no")],
            TextColours::plain(),
        );
        let place = r"\u{1b}[31ma\n.gtr:1:1: error[undefined-name]: no";
        assert_eq!(text.lines().next(), Some(place));
    }

    #[test]
    fn every_place_of_a_text_can_be_marked() {
        let texts = [
            "",
            "\n",
            "a",
            "a\n",
            "a\r\nb",
            "\u{feff}é\t\0\u{1b}[31m\n\n",
            "\n\n\n\n\n\n\n\nend",
        ];
        for sample in texts {
            let source = source(sample);
            let ends: Vec<usize> = (0..=sample.len())
                .filter(|end| sample.is_char_boundary(*end))
                .collect();
            for &start in &ends {
                for &end in ends.iter().filter(|end| **end >= start) {
                    let span = Span::new(start as u32, end as u32);
                    let shown = text(&source, &[error(span, "wrong")], TextColours::plain());
                    assert!(
                        shown.contains("error[undefined-name]: wrong\n"),
                        "{sample:?} {span:?}"
                    );
                    assert!(
                        !shown.contains(['\0', '\u{1b}']),
                        "{sample:?} {span:?}: {shown:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn endless_lines_are_clipped() {
        let line = "x".repeat(1_000_000);
        let source = source(&line);
        for (start, end) in [
            (0, 1),
            (500_000, 500_003),
            (999_999, 1_000_000),
            (10, 999_990),
        ] {
            let shown = text(
                &source,
                &[error(Span::new(start, end), &line)],
                TextColours::plain(),
            );
            let widest = shown.lines().skip(1).map(|line| line.chars().count()).max();
            assert!(widest < Some(130), "{shown}");
            assert!(shown.contains('^'), "{shown}");
        }
    }

    #[test]
    fn a_flood_is_capped_and_counted() {
        let source = source("x\n");
        let diagnostics = vec![error(Span::new(0, 1), "wrong"); 5000];
        let shown = text(&source, &diagnostics, TextColours::plain());
        assert_eq!(shown.matches("error[undefined-name]").count(), SHOWN);
        assert_eq!(shown.matches('^').count(), WITH_SNIPPET);
        assert!(shown.contains("… and 4,000 more in a.gtr"), "{shown}");
    }

    #[test]
    fn colours_come_only_when_asked_for() {
        let source = source("x\n");
        let diagnostics = [error(Span::new(0, 1), "wrong")];
        assert!(!text(&source, &diagnostics, TextColours::plain()).contains('\u{1b}'));
        assert!(
            text(&source, &diagnostics, TextColours::coloured()).contains("\u{1b}[1m\u{1b}[31m")
        );
    }

    #[test]
    fn counts_read_as_a_phrase() {
        assert_eq!(SeverityCounts::default().text(), "no errors");
        let counts = SeverityCounts {
            errors: 1,
            warnings: 2,
        };
        assert_eq!(counts.text(), "1 error, 2 warnings");
    }
}
