//! The messages of lexical and syntax errors, in the user's words.

use super::Parser;
use crate::crt::actions::{Actions, ParseStep};
use crate::crt::codes;
use crate::crt::lexer::{Fault, Lexeme};
use crate::crt::token::{RESERVED, TokenKind};
use crate::diagnostic::{Diagnostic, Fix};
use crate::span::Span;

/// The number of characters of the text that a sentence quotes at most.
const QUOTE_LENGTH: usize = 40;

/// The hint at a comment of another language.
const COMMENT: &str = "a comment begins with `--`";

pub(super) fn quote(text: &str) -> String {
    let mut cut: String = text.chars().take(QUOTE_LENGTH).collect();
    if cut.len() < text.len() {
        cut.push('…');
    }
    format!("`{}`", cut.replace(['\n', '\r', '\t'], " "))
}

impl<A: Actions> Parser<'_, '_, A> {
    /// Skips comments and characters that begin no token. A run of such characters is reported once.
    #[cold]
    pub(super) fn fetch_slowly(&mut self, mut lexeme: Lexeme) {
        let mut run: Option<(Span, char)> = None;
        let mut was_bad = false;
        loop {
            let token = lexeme.token;
            match (run, lexeme.fault) {
                (Some((span, first)), Some(Fault::Character(next)))
                    if span.end == token.span.start && joins(first, next) =>
                {
                    run = Some((span.to(token.span), first));
                }
                (ended, fault) => {
                    if let Some((span, first)) = ended {
                        let mut found = bad_characters(span.text(self.source), span, first);
                        if first == ';' && self.is_in_parentheses(span.start) {
                            // The head of a loop in another language: removing the character does not fix it.
                            found.fixes.clear();
                        }
                        self.report(found);
                        was_bad = true;
                    }
                    run = match fault {
                        Some(Fault::Character(first)) => Some((token.span, first)),
                        _ => None,
                    };
                }
            }
            if run.is_none() && token.kind != TokenKind::Comment {
                break;
            }
            if lexeme.fault == Some(Fault::ForeignComment) {
                self.report(bad_comment(token.span));
            }
            self.actions.act_advance(token);
            lexeme = self.lexer.read();
        }
        self.current = lexeme.token;
        if let Some(fault) = lexeme.fault {
            let span = lexeme.token.span;
            self.report(bad_token(span.text(self.source), span, fault));
            was_bad = true;
        }
        if was_bad {
            self.reported = Some(self.current.span.start);
        }
    }

    /// Returns true if a `(` is open on the line before an offset.
    fn is_in_parentheses(&self, place: u32) -> bool {
        let before = &self.source[..place as usize];
        let line = before.rsplit('\n').next().unwrap_or_default();
        line.matches('(').count() > line.matches(')').count()
    }

    /// Reports that the current token is unexpected.
    pub(super) fn unexpected(&mut self, expected: &str) {
        let hint = self.reserved_hint();
        self.unexpected_with(expected, hint);
    }

    /// Reports that the current token is unexpected, with a hint.
    pub(super) fn unexpected_with(&mut self, expected: &str, hint: Option<String>) {
        let (span, message) = match self.current.kind {
            // The statement ends here, and so does this piece of the script.
            TokenKind::Eoi => {
                let before = self.previous.span;
                let text = quote(before.text(self.source));
                (before, format!("{expected} is expected after {text}"))
            }
            _ => {
                let text = quote(self.text());
                (
                    self.current.span,
                    format!("{expected} is expected, not {text}"),
                )
            }
        };
        if let Some(found) = self.fault(codes::UNEXPECTED_TOKEN, span, message) {
            self.report(match hint {
                Some(hint) => found.with_hint(hint),
                None => found,
            });
        }
    }

    /// Reports that an expression is missing before the current token.
    pub(super) fn missing(&mut self) {
        let span = self.current.span;
        let message = match self.current.kind {
            TokenKind::Eoi => "an expression is missing at the end of the statement".to_owned(),
            _ => format!("an expression is missing before {}", quote(self.text())),
        };
        let hint = self.increment_hint().or_else(|| self.reserved_hint());
        if let Some(found) = self.fault(codes::MISSING_OPERAND, span, message) {
            self.report(match hint {
                Some(hint) => found.with_hint(hint),
                None => found,
            });
        }
        let place = Span::new(span.start, span.start);
        self.actions.act_step(ParseStep::Missing, place);
    }

    /// Returns the hint for `i++` and `i += 1` of other languages.
    fn increment_hint(&self) -> Option<String> {
        let (before, sign) = (self.previous.span, self.text());
        let is_double = before.end == self.current.span.start
            && matches!(
                (before.text(self.source), sign),
                ("+", "+" | "=") | ("-" | "*" | "/", "=")
            );
        let is_postfix = self.source[..before.end as usize].ends_with("++");
        (is_double || is_postfix).then(|| "a variable is changed by `i = i + 1`".to_owned())
    }

    fn reserved_hint(&self) -> Option<String> {
        let kind = self.current.kind;
        let is_word = RESERVED.iter().any(|(_, reserved)| *reserved == kind);
        is_word.then(|| format!("`{}` is a keyword and cannot be a name", self.text()))
    }
}

/// Returns true if a bad character is reported together with the one before it: the message for the first holds for
/// both.
fn joins(first: char, next: char) -> bool {
    let is_known = |character| matches!(character, ';' | '#' | '\'' | '&' | '|' | '−' | '–' | '→');
    first == next || !is_known(first) && !is_known(next)
}

/// Returns the error of a run of characters that begin no token.
fn bad_characters(text: &str, span: Span, first: char) -> Diagnostic {
    let is_single = text.len() == first.len_utf8();
    let shown = match first {
        _ if first.is_control() || first.is_whitespace() || first == '\u{FEFF}' => {
            format!("the invisible character U+{:04X}", u32::from(first))
        }
        _ if is_single => format!("the character `{first}`"),
        _ => format!("the characters {}", quote(text)),
    };
    let diagnostic = Diagnostic::error(
        codes::BAD_CHARACTER,
        span,
        format!("{shown} cannot be used here"),
    );
    let change = |word: &str| Fix::change(span, word, true);
    match first {
        '&' | '|' if is_single => {
            let sign = text.repeat(2);
            let (sense, set) = match first {
                '&' => ("and", "the intersection of solids is `^`"),
                _ => ("or", "the union of solids is `+`"),
            };
            diagnostic
                .with_hint(format!("“{sense}” is `{sign}`; {set}"))
                .with_fix(Fix::change(span, &sign, false))
        }
        ';' => diagnostic
            .with_hint("a statement has no terminator")
            .with_fix(Fix::remove(span, ";").with_all()),
        '#' => diagnostic.with_hint(COMMENT).with_fix(change("--")),
        '\'' => diagnostic.with_hint("a string is enclosed in `\"`"),
        '→' if is_single => diagnostic.with_fix(change("->").with_all()),
        '−' | '–' if is_single => diagnostic.with_fix(change("-").with_all()),
        _ if first.is_alphabetic() || first == '_' => {
            diagnostic.with_hint("names consist of the letters a-z, A-Z and digits")
        }
        _ => diagnostic,
    }
}

/// Returns the error of a comment that begins with `//`.
fn bad_comment(comment: Span) -> Diagnostic {
    let sign = Span::new(comment.start, comment.start + 2);
    Diagnostic::error(codes::BAD_CHARACTER, sign, "`//` does not begin a comment")
        .with_hint(COMMENT)
        .with_fix(Fix::change(sign, "--", true).with_all())
}

/// Returns the error of a malformed number or string.
fn bad_token(text: &str, span: Span, fault: Fault) -> Diagnostic {
    match fault {
        Fault::Character(first) => bad_characters(text, span, first),
        Fault::ForeignComment => bad_comment(span),
        Fault::LonePoint => {
            let message = "a `.` without digits is not a number";
            Diagnostic::error(codes::BAD_NUMBER, span, message)
        }
        Fault::IntegerTooLarge => {
            let message = format!("{} is too large: the limit is 2147483647", quote(text));
            let fix = Fix::write(span, &format!("{text}."));
            Diagnostic::error(codes::INTEGER_TOO_LARGE, span, message)
                .with_hint("with a `.` it is a number of 64 bits")
                .with_fix(fix)
        }
        Fault::Overflow => {
            let message = format!("{} is too large for a number", quote(text));
            Diagnostic::error(codes::NUMBER_OUT_OF_RANGE, span, message)
        }
        Fault::UnclosedString => {
            let message = "this string is not closed on its line";
            let fix = Fix::insert("Insert `\"`", span.end, "\"");
            Diagnostic::error(codes::UNCLOSED_STRING, span, message).with_fix(fix)
        }
        Fault::Escape(place) => {
            let message = "this is not a string escape";
            Diagnostic::error(codes::BAD_ESCAPE, place, message)
                .with_hint("a `\\` itself is written `\\\\`")
        }
    }
}
