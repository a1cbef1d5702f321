//! The messages of syntax errors: what was expected, and what is meant.

use super::deferred::Deferred;
use super::{Parser, Stop, foreign};
use crate::diagnostic::{Code, Diagnostic, Fix};
use crate::geotrace::actions::Actions;
use crate::geotrace::attributes::{self, AttributeWord};
use crate::geotrace::codes;
use crate::geotrace::cut::separators;
use crate::geotrace::declarations::{COORDINATES, DeclarationKeyword};
use crate::geotrace::symbols::{NO_CONDITIONS, NameScope};
use crate::geotrace::token::{MapWord, Token, TokenKind};
use crate::span::Span;

/// The number of characters of the text that a sentence quotes at most.
pub(super) const QUOTE_LENGTH: usize = 40;

/// Returns a piece of the text in backquotes, truncated if it is long.
pub(super) fn quote(text: &str) -> String {
    let mut cut: String = text.chars().take(QUOTE_LENGTH).collect();
    cut = cut.replace(['\n', '\r', '\t'], " ");
    if cut.len() < text.len() {
        cut.push('…');
    }
    format!("`{cut}`")
}

/// Returns a token or its text as it is named in a sentence.
pub(super) fn describe(source: &str, token: Token) -> String {
    match token.kind {
        TokenKind::Eoi => "the end of the text".to_owned(),
        _ => quote(token.span.text(source)),
    }
}

/// The hint at a comparison in the expression of a solid.
const SOLID: &str = "a solid is where its function is at most 0";

/// The hint at a comma in a number.
const DECIMAL: &str = "the sign in a number is `.`; a tuple is written in brackets: `(1, 2)`";

/// The hint at a comment of another language.
pub(super) const COMMENT: &str = "a comment begins with `#`";

/// The hint at a `'` behind something else than a function.
pub(super) const DERIVATIVE: &str = "only a function has a derivative: write `f' x`, not `(f x)'`";

/// The hint at a loop of another language.
const LOOPS: &str = "there are no loops: a `grid` draws an object once for each of its values: `grid k : [0, 1, 5];`";

/// Returns the keyword that a word is but for its capitals.
pub(super) fn lowercase_keyword(word: &str) -> Option<DeclarationKeyword> {
    DeclarationKeyword::from_text(&word.to_ascii_lowercase())
}

/// Returns the error of an interval in another notation.
pub(super) fn foreign_interval(source: &str, place: Span, written: &str) -> Diagnostic {
    let found = quote(place.text(source));
    let message = format!("an interval is written `[min, max]`, found {found}");
    Diagnostic::error(codes::UNEXPECTED_TOKEN, place, message)
        .with_hint(format!("write {}", quote(written)))
        .with_fix(Fix::change(place, written, true).with_all())
}

/// Returns true if a text begins with digits that no list continues.
fn is_last_digits(text: &str) -> bool {
    let behind = text.trim_start_matches(|c: char| c.is_ascii_digit());
    behind.len() < text.len() && !behind.trim_start().starts_with(',')
}

impl<A: Actions, S: NameScope> Parser<'_, '_, A, S> {
    /// Returns, as a hint, the form of a solid that is given by a function, if the set that is read looks like one.
    pub(super) fn field_form(&self) -> Option<(String, Fix)> {
        let name = self.state.name_span;
        let behind = self.source[name.end as usize..]
            .trim_start()
            .strip_prefix('=')?;
        let body = foreign::first_item(behind.trim_start());
        let mut words = body.split(|c: char| !c.is_ascii_alphabetic());
        let is_coordinate = |word| COORDINATES.contains(&word) && self.parsed.get(word).is_none();
        let is_set = self.state.keyword == Some(DeclarationKeyword::Solid)
            && self.state.parameters.is_empty()
            && self.state.attributes.is_empty();
        let is_field = is_set && words.any(is_coordinate) && !body.contains('@');
        let form = quote(&format!("solid {}(x, y, z) = …", self.state.name));
        let hint = format!("a solid by a function is written {form}");
        let fix = Fix::insert("Insert `(x, y, z)`", name.end, "(x, y, z)");
        is_field.then_some((hint, fix))
    }

    /// Returns the error of the token after a map's operand, with the correct form of the operand.
    fn with_map(&self, diagnostic: Diagnostic, map: MapWord, operand: Span) -> Diagnostic {
        let behind = &self.source[operand.start as usize..];
        let item = foreign::first_item(behind);
        let end = item.find(['|', '&', '\\', '@']).unwrap_or(item.len());
        let item = item[..end].trim_end();
        let place = Span::new(operand.start, operand.start + item.len() as u32);
        let (reason, written) = match map {
            MapWord::Scale => ("a factor of several parts is written in brackets", {
                Some(format!("({item})")).filter(|_| !item.contains(','))
            }),
            MapWord::Rotate => (
                "the axis times the angle is one vector",
                foreign::rotation(item),
            ),
        };
        let example = written.as_deref().unwrap_or(match map {
            MapWord::Scale => "(1/2)",
            MapWord::Rotate => "(0, 0, pi/2)",
        });
        let form = quote(&format!("{} {example}", map.text()));
        let diagnostic = diagnostic.with_hint(format!("{reason}: write {form}"));
        match written {
            Some(written) => diagnostic.with_fix(Fix::change(place, &written, true)),
            None => diagnostic,
        }
    }

    /// Returns the error of a comparison in the expression of a solid, with its equivalent. Its span is that of the
    /// comparison.
    pub(super) fn with_bound(&self, diagnostic: Diagnostic) -> Diagnostic {
        let start = diagnostic.span.start;
        let rest = &self.source[start as usize..];
        let behind = rest.trim_start_matches(['<', '>', '≤', '≥', '=']);
        let sign = &rest[..rest.len() - behind.len()];
        let bound = foreign::first_item(behind).trim();
        let item = &rest[..rest.len() - behind.len() + foreign::first_item(behind).len()];
        let place = Span::new(start, start + item.len() as u32);
        let next = self.source[place.end as usize..].trim_start();
        let end = next.find(|c: char| !c.is_ascii_alphanumeric());
        let word = &next[..end.unwrap_or(next.len())];
        let is_end = next.is_empty() || DeclarationKeyword::from_text(word).is_some();
        if !is_end && !next.starts_with([';', ',']) {
            // The equation goes on in the next line.
            return diagnostic.with_hint(SOLID);
        }
        let is_plain = bound
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || ".^_".contains(c));
        let is_upper = matches!(sign, "<" | "<=" | "≤" | "=" | "==");
        match bound {
            "0" if is_upper => diagnostic
                .with_hint(format!("{SOLID}: leave out {}", quote(item)))
                .with_fix(Fix::remove(place, item)),
            _ if bound.is_empty() || bound.contains(['<', '>', '≤', '≥', '=']) => {
                diagnostic.with_hint(SOLID)
            }
            _ if is_upper => {
                let written = match is_plain {
                    true => format!("- {bound}"),
                    false => format!("- ({bound})"),
                };
                let hint = format!("{SOLID}: write {} for {}", quote(&written), quote(item));
                diagnostic
                    .with_hint(hint)
                    .with_fix(Fix::change(place, &written, true))
            }
            _ => diagnostic.with_hint(format!("{SOLID}: write `b - f` for `f {sign} b`")),
        }
    }

    /// Reports that the current token was not accepted, unless the text before it or the token itself has already been
    /// reported.
    pub(super) fn reject(&mut self, diagnostic: Diagnostic) -> Stop {
        self.reject_deferred(diagnostic, None)
    }

    /// Rejects as [`reject`](Self::reject) does, with a diagnostic that may have a deferred part.
    pub(super) fn reject_deferred(
        &mut self,
        diagnostic: Diagnostic,
        deferred: Option<Deferred>,
    ) -> Stop {
        self.state.faulty = true;
        self.state.silent = true;
        // A missing `;` is reported even if the text before it has been.
        let is_own = diagnostic.code == codes::MISSING_SEMICOLON;
        if !self.state.rejected && (is_own || !self.flagged) {
            match deferred {
                Some(deferred) => self.report_deferred(diagnostic, deferred),
                None => self.report(diagnostic),
            }
        }
        self.state.rejected = true;
        Stop
    }

    /// Creates an error at the current token.
    pub(super) fn here(&self, code: Code, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, self.current.span, message)
    }

    pub(super) fn found(&self) -> String {
        describe(self.source, self.current)
    }

    /// Reports that something other than the current token is expected.
    pub(super) fn expected(&mut self, what: &str) -> Stop {
        let diagnostic = self.expected_diagnostic(what);
        self.reject(diagnostic)
    }

    pub(super) fn expected_diagnostic(&self, what: &str) -> Diagnostic {
        let message = format!("expected {what}, found {}", self.found());
        let diagnostic = self.here(codes::UNEXPECTED_TOKEN, message);
        let start = self.current.span.start;
        let rest = &self.source[start as usize..];
        if !rest.starts_with("//") {
            return diagnostic;
        }
        let line = rest.lines().next().unwrap_or_default();
        let diagnostic = diagnostic.with_hint(COMMENT);
        match line.contains(';') {
            // The rest of the declaration follows it.
            true => diagnostic,
            false => diagnostic.with_fix(Fix::change(Span::new(start, start + 2), "#", true)),
        }
    }

    /// Reports that the current token begins no expression.
    pub(super) fn expected_expression(&mut self) -> Stop {
        if let Some(diagnostic) = self.hexadecimal_colour() {
            return self.reject(diagnostic);
        }
        let found = self.found();
        // Comments are skipped and do not count as the previous token.
        let message = if self.previous.kind == TokenKind::Eoi {
            format!("expected an expression, found {found}")
        } else {
            let after = describe(self.source, self.previous);
            format!("expected an expression after {after}, found {found}")
        };
        let diagnostic = self.here(codes::UNEXPECTED_TOKEN, message);
        self.reject(diagnostic)
    }

    /// Returns the error of a colour `#ff0000` before the current token, which was read as a comment.
    fn hexadecimal_colour(&self) -> Option<Diagnostic> {
        let is_value = matches!(self.previous.kind, TokenKind::Colon | TokenKind::Equals);
        let start = self.previous.span.end;
        let passed = Span::new(start, self.current.span.start.max(start)).text(self.source);
        let comment = passed.trim_start();
        let (length, written) = foreign::colour(comment).filter(|_| is_value)?;
        let start = start + (passed.len() - comment.len()) as u32;
        let place = Span::new(start, start + length as u32);
        let message = format!("`#` begins a comment here: a colour is written `{written}`");
        let fix = Fix::change(place, &written, true).with_all();
        Some(Diagnostic::error(codes::UNEXPECTED_TOKEN, place, message).with_fix(fix))
    }

    /// Reports that the bracket opened at `opening` is not closed by the current token.
    pub(super) fn unclosed(&mut self, opening: Span, close: char, separator: &str) -> Stop {
        let open = opening.text(self.source);
        let found = self.found();
        let before = self.source[..self.previous.span.start as usize].trim_end();
        let diagnostic = match self.current.kind {
            TokenKind::Colon
                if self.state.in_body
                    && matches!(self.previous.kind, TokenKind::Variable(_))
                    && before.ends_with(',') =>
            {
                let end = before.len() as u32 - 1;
                let message = format!(
                    "`{open}` is not closed: expected `{close}` before the interval of {}",
                    quote(self.previous.span.text(self.source))
                );
                let title = format!("Insert `{close}`");
                let fix = Fix::insert(&title, end, &close.to_string());
                Diagnostic::error(codes::UNCLOSED_BRACKET, Span::new(end, end + 1), message)
                    .with_fix(fix.with_all())
            }
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => self.here(
                codes::MISMATCHED_BRACKET,
                format!("`{open}` is closed by {found}: each kind of bracket closes with its own, `{close}`"),
            ),
            TokenKind::Semicolon | TokenKind::Declare(_) | TokenKind::Eoi => self.here(
                codes::UNCLOSED_BRACKET,
                format!("`{open}` is not closed: expected `{close}`, found {found}"),
            ),
            _ => self.here(
                codes::UNEXPECTED_TOKEN,
                format!("expected {separator}`{close}`, found {found}"),
            ),
        };
        let diagnostic = diagnostic.with_related(opening, format!("`{open}` opens here"));
        self.reject(diagnostic)
    }

    /// Returns true at a `,` between brackets, and at a `;` that was meant to be a `,`, which it reports.
    pub(super) fn is_separator(&mut self) -> bool {
        match self.current.kind {
            TokenKind::Comma => true,
            TokenKind::Semicolon => self.takes_semicolon(),
            _ => false,
        }
    }

    #[cold]
    fn takes_semicolon(&mut self) -> bool {
        let Some(place) = separators(self.source, self.current.span.start) else {
            return false;
        };
        let written = place.text(self.source).replace(';', ",");
        let diagnostic = self.here(
            codes::UNEXPECTED_TOKEN,
            "expected `,` between brackets, found `;`",
        );
        let before = &self.source[..self.current.span.start as usize];
        let number = before.trim_end_matches(|c: char| c.is_ascii_digit());
        let whole = number.strip_suffix(',').unwrap_or_default();
        if number.len() < before.len() && whole.ends_with(|c: char| c.is_ascii_digit()) {
            // `(1,5; 2; 3)`: the commas stand in numbers.
            let is_metric = self.state.keyword == Some(DeclarationKeyword::Metric);
            let hint = match is_metric && self.state.in_body {
                true => self.metric_form(),
                false => "components are separated by `,`, and the sign in a number is `.`: `(1.5, 2, 3)`".to_owned(),
            };
            self.reject(diagnostic.with_hint(hint));
            return true;
        }
        let diagnostic = diagnostic
            .with_hint(
                "a `;` ends a declaration: components are separated by `,`, as in `(1, 2, 3)`",
            )
            .with_fix(Fix {
                title: "Write `,` for `;`".to_owned(),
                ..Fix::change(place, &written, true).with_all()
            });
        self.reject(diagnostic);
        true
    }

    /// Reports that no declaration begins with the current token, and the probable intention: a misspelt word, or a
    /// word omitted before the name.
    pub(super) fn reject_opening(
        &mut self,
        name: &str,
        guess: Option<DeclarationKeyword>,
        unworded: Option<DeclarationKeyword>,
    ) {
        if self.is_muted() {
            self.state.faulty = true;
            return;
        }
        let rest = &self.source[self.current.span.start as usize..];
        if let Some(sign) = foreign::comment(rest) {
            self.reject_comment(rest, sign);
            return;
        }
        let hint = match (guess, unworded) {
            (Some(guess), _) => format!("did you mean `{}`?", guess.text()),
            _ if let Some(hint) = foreign::style(name) => hint.to_owned(),
            _ if matches!(name, "if" | "else") => NO_CONDITIONS.to_owned(),
            _ if matches!(name, "while" | "for") => LOOPS.to_owned(),
            (None, Some(word)) => {
                let written = quote(&format!("{} {name}", word.text()));
                format!("write {written}")
            }
            _ if self.current.kind == TokenKind::Semicolon => "remove it".to_owned(),
            _ if let Some(keyword) = lowercase_keyword(name) => {
                let row = keyword.row();
                format!("did you mean `{}`, as in `{}`?", row.text, row.example)
            }
            _ if let Some(foreign) = self.foreign_word(name, true) => foreign.hint.to_owned(),
            _ => {
                let words = DeclarationKeyword::ALL
                    .map(DeclarationKeyword::text)
                    .join("`, `");
                format!("a declaration begins with one of `{words}`")
            }
        };
        let message = format!("expected a declaration, found {}", self.found());
        let mut diagnostic = self
            .here(codes::EXPECTED_DECLARATION, message)
            .with_hint(hint);
        if let Some(guess) = guess {
            let fix = Fix::change(self.current.span, guess.text(), true);
            diagnostic = diagnostic.with_fix(fix);
        } else if let Some(word) = unworded {
            let word = word.text();
            let fix = Fix::insert(
                &format!("Insert `{word}`"),
                self.current.span.start,
                &format!("{word} "),
            );
            diagnostic = diagnostic.with_fix(fix);
        }
        self.reject(diagnostic);
    }

    /// Rejects a comment of another language in place of a declaration.
    fn reject_comment(&mut self, rest: &str, sign: &str) {
        let start = self.current.span.start;
        let place = |length: usize| Span::new(start, start + length as u32);
        let message = format!("expected a declaration, found `{sign}`");
        let mut diagnostic =
            Diagnostic::error(codes::EXPECTED_DECLARATION, place(sign.len()), message)
                .with_hint(COMMENT);
        let fix = match sign {
            "/*" => foreign::block_comment(rest).map(|(length, text)| Fix {
                title: "Write lines that begin with `#`".to_owned(),
                ..Fix::change(place(length), &text, true)
            }),
            sign => Some(Fix::change(place(sign.len()), "#", true)),
        };
        diagnostic.fixes.extend(fix.map(Fix::with_all));
        self.reject(diagnostic);
        self.state.quiet = true;
    }

    /// Returns true at a `,` that touches the numbers on both sides.
    pub(super) fn is_decimal_comma(&self) -> bool {
        let comma = self.current.span;
        self.current.kind == TokenKind::Comma
            && matches!(self.previous.kind, TokenKind::Number(_))
            && self.previous.span.end == comma.start
            && is_last_digits(&self.source[comma.end as usize..])
    }

    /// Returns the error of the current comma, which is the sign in a number.
    pub(super) fn with_decimal_point(&self, diagnostic: Diagnostic) -> Diagnostic {
        let fix = Fix::change(self.current.span, ".", true);
        diagnostic.with_hint(DECIMAL).with_fix(fix)
    }

    /// Returns true if a name and a `=` follow the current token.
    fn is_before_name(&self) -> bool {
        let rest = self.source[self.current.span.end as usize..].trim_start();
        let behind = rest.trim_start_matches(|c: char| c.is_ascii_alphanumeric());
        rest.starts_with(|c: char| c.is_ascii_alphabetic()) && behind.trim_start().starts_with('=')
    }

    /// Returns a hint if a parameter and the sign of a comparison follow the current token.
    fn interval_hint(&self) -> Option<String> {
        let rest = self.source[self.current.span.end as usize..].trim_start();
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric())?;
        let (word, rest) = rest.split_at(end);
        let is_compared = rest.trim_start().starts_with(['<', '>', '≤', '≥', '=']);
        self.state.parameter_trie.get(word)?;
        let form = quote(&format!("{word} : [min, max]"));
        is_compared.then(|| format!("an interval bounds a parameter: write {form}"))
    }

    /// Returns true if the word of an attribute and a `:` follow the current token.
    fn is_before_attribute(&self) -> bool {
        let rest = self.source[self.current.span.end as usize..].trim_start();
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric());
        let (word, rest) = rest.split_at(end.unwrap_or(rest.len()));
        AttributeWord::from_text(word).is_some() && rest.trim_start().starts_with(':')
    }

    /// Rejects the current token in place of the `;` that ends a declaration.
    pub(super) fn expected_end(&mut self, keyword: DeclarationKeyword) -> Stop {
        let end = self.previous.span.end;
        let found = self.found();
        let diagnostic = match self.current.kind {
            TokenKind::Declare(_) | TokenKind::Eoi => {
                let message = format!("missing `;` after this declaration, found {found}");
                let mut diagnostic = self.here(codes::MISSING_SEMICOLON, message);
                if self.current.kind == TokenKind::Eoi {
                    // The text may end many lines below: report the declaration's end.
                    diagnostic.span = self.previous.span;
                }
                let diagnostic = diagnostic
                    .with_related(Span::new(end, end), "the `;` belongs here")
                    .with_fix(Fix::insert("Insert `;`", end, ";").with_all());
                let deferred = Deferred::Semicolon {
                    after: describe(self.source, self.previous),
                    offset: self.previous.span.start,
                };
                return self.reject_deferred(diagnostic, Some(deferred));
            }
            TokenKind::Equals if keyword == DeclarationKeyword::Solid => {
                let diagnostic = self.expected_diagnostic("`;`");
                self.with_bound(diagnostic)
            }
            TokenKind::Slash
            | TokenKind::ParenOpen
            | TokenKind::BracketOpen
            | TokenKind::Number(_)
            | TokenKind::Constant(_)
            | TokenKind::Function(_)
                if let Some((map, operand)) = self.state.map
                    && operand.end == self.previous.span.end =>
            {
                let diagnostic = self.expected_diagnostic("`;`");
                self.with_map(diagnostic, map, operand)
            }
            _ if let Some((hint, fix)) = self.field_form() => {
                let diagnostic = self.expected_diagnostic("`;`");
                diagnostic.with_hint(hint).with_fix(fix)
            }
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => self.here(
                codes::UNEXPECTED_TOKEN,
                format!("expected `;`, found {found}, which closes no bracket"),
            ),
            TokenKind::Comma
                if attributes::of(keyword).next().is_none() && self.is_before_attribute() =>
            {
                self.expected_diagnostic("`;`").with_hint(format!(
                    "a `{}` has no attributes; objects that are drawn have them",
                    keyword.text()
                ))
            }
            TokenKind::Comma if self.is_decimal_comma() => {
                self.with_decimal_point(self.expected_diagnostic("`;`"))
            }
            TokenKind::Comma
                if keyword == DeclarationKeyword::Solid
                    && let Some(hint) = self.interval_hint() =>
            {
                // The sign of the comparison is part of this report.
                self.state.quiet = true;
                let diagnostic = self.expected_diagnostic("`;`").with_hint(hint);
                let behind = &self.source[self.current.span.end as usize..];
                let start = (self.source.len() - behind.trim_start().len()) as u32;
                match foreign::interval(behind.trim_start()) {
                    Some(found) => {
                        let place = Span::new(start, start + found.text.len() as u32);
                        diagnostic.with_fix(Fix::change(place, &found.written(), true))
                    }
                    None => diagnostic,
                }
            }
            TokenKind::Comma if keyword == DeclarationKeyword::Function => self
                .expected_diagnostic("`;`")
                .with_hint("a function has no intervals: a `curve` or a `surface` has"),
            TokenKind::Equals if self.source[self.current.span.end as usize..].starts_with('=') => {
                self.expected_diagnostic("`;`").with_hint(NO_CONDITIONS)
            }
            TokenKind::Plus | TokenKind::Minus | TokenKind::Star
                if keyword == DeclarationKeyword::Solid && self.state.parameters.is_empty() =>
            {
                let (sign, hint) = match self.current.kind {
                    TokenKind::Plus => ("|", "the points of either are `a | b`"),
                    TokenKind::Minus => ("\\", "the points of a that are not of b are `a \\ b`"),
                    _ => ("&", "the points of both are `a & b`"),
                };
                let fix = Fix::change(self.current.span, sign, true);
                let diagnostic = self.expected_diagnostic("`;`");
                diagnostic.with_hint(hint).with_fix(fix.with_all())
            }
            TokenKind::Comma if self.is_before_name() => {
                self.state.quiet = true;
                let hint = format!("each declaration has one name: write `; {} …`", keyword.text());
                self.expected_diagnostic("`;`").with_hint(hint)
            }
            TokenKind::Comma => self
                .expected_diagnostic("`;`")
                .with_hint("a tuple is written in brackets: `(1, 2)`"),
            TokenKind::At => self
                .expected_diagnostic("`;`")
                .with_hint("a position follows `@` in a `vector`, a `geodesic`, a `light`, a `camera` and a set"),
            TokenKind::Prime => self
                .expected_diagnostic("`;`")
                .with_hint(DERIVATIVE),
            _ => self.expected_diagnostic("`;`"),
        };
        self.reject(diagnostic)
    }
}
