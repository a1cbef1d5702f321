//! The messages of lexical and syntax errors, in the user's words.

use super::deferred::Deferred;
use super::names::Mode;
use super::{BadRun, Parser, Stop, foreign};
use crate::diagnostic::{Code, Diagnostic, Fix};
use crate::geotrace::actions::Actions;
use crate::geotrace::attributes::{self, AttributeWord};
use crate::geotrace::codes;
use crate::geotrace::cut::separators;
use crate::geotrace::declarations::{COORDINATES, DeclarationKeyword};
use crate::geotrace::lexer::Fault;
use crate::geotrace::symbols::{NO_CONDITIONS, NameScope};
use crate::geotrace::token::{MapWord, Token, TokenKind};
use crate::span::Span;

/// The number of characters of the text that a sentence quotes at most.
const QUOTE_LENGTH: usize = 40;

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

/// Returns the error of a run of characters that begin no token.
fn bad_characters(source: &str, span: Span, first: char) -> Diagnostic {
    let text = span.text(source);
    let single = text.len() == first.len_utf8();
    let shown = match first {
        '\0' => "a NUL byte (U+0000)".to_owned(),
        '\u{FEFF}' => "a byte order mark (U+FEFF)".to_owned(),
        '\u{A0}' => "a no-break space (U+00A0)".to_owned(),
        _ if first.is_control() || first.is_whitespace() || is_invisible(first) => {
            format!("the invisible character U+{:04X}", u32::from(first))
        }
        _ if single => format!("the character `{first}`"),
        _ => format!("the characters {}", quote(&visible(text))),
    };
    let message = if first.is_alphabetic() {
        format!("{shown} cannot be used here: names consist of the letters a-z, A-Z and digits")
    } else {
        format!("{shown} cannot be used here")
    };
    let mut diagnostic = Diagnostic::error(codes::BAD_CHARACTER, span, message);
    let before = source[..span.start as usize].trim_end_matches([' ', '\t']);
    if first == '%' && (before.is_empty() || before.ends_with(['\n', ';'])) {
        let fix = Fix::change(Span::new(span.start, span.start + 1), "#", true);
        return diagnostic.with_hint(COMMENT).with_fix(fix.with_all());
    }
    if let Some(text) = equivalent(first).filter(|_| single) {
        let (before, after) = (&source[..span.start as usize], &source[span.end as usize..]);
        let written = foreign::apart(before, text, after);
        diagnostic = diagnostic.with_fix(Fix {
            replacement: written,
            ..Fix::change(span, text, true).with_all()
        });
    }
    match substitute(first) {
        Some(hint) => diagnostic.with_hint(hint),
        None => diagnostic,
    }
}

/// The hint at a sign of sets in an expression of a solid.
const SET_HINT: &str = "a set names solids and lists no parameters: `solid s = a | b;`; functions are joined by `min(f, g)` and `max(f, g)`";

/// The hint at a comparison where an interval may stand.
const INTERVAL: &str = "an interval is written `t : [a, b]`";

/// The hint at a comparison in the expression of a solid.
const SOLID: &str = "a solid is where its function is at most 0";

/// The hint at a comma in a number.
const DECIMAL: &str = "the sign in a number is `.`; a tuple is written in brackets: `(1, 2)`";

/// The hint at a comment of another language.
const COMMENT: &str = "a comment begins with `#`";

/// Returns the error or warning of a number.
pub(super) fn bad_number(source: &str, span: Span, fault: Fault) -> Diagnostic {
    let number = quote(span.text(source));
    match fault {
        Fault::Underflow => Diagnostic::warning(
            codes::NUMBER_UNDERFLOW,
            span,
            format!("number out of range: {number} is so small that it is read as 0"),
        ),
        Fault::Overflow => Diagnostic::error(
            codes::NUMBER_OUT_OF_RANGE,
            span,
            format!("number out of range: {number} is larger than 1.797e308"),
        ),
        Fault::LonePoint | Fault::Character(_) => Diagnostic::error(
            codes::BAD_NUMBER,
            span,
            "a lone `.` is not a number: write a digit before or after it",
        ),
    }
}

fn is_invisible(character: char) -> bool {
    matches!(character, '\u{AD}' | '\u{200B}'..='\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2060}'..='\u{206F}')
}

fn visible(text: &str) -> String {
    let text = text.chars().take(QUOTE_LENGTH + 1);
    let show = |c: char| {
        if c.is_control() || is_invisible(c) {
            char::REPLACEMENT_CHARACTER
        } else {
            c
        }
    };
    text.map(show).collect()
}

/// Returns the text with the same meaning as a character in any context.
fn equivalent(character: char) -> Option<&'static str> {
    Some(match character {
        '\u{2212}' => "-",
        '×' | '∗' => "*",
        '÷' | '∕' => "/",
        '²' => "^2",
        '³' => "^3",
        '’' | '′' => "'",
        'π' => "pi",
        'τ' => "(2pi)",
        '½' => "(1/2)",
        '√' => "sqrt",
        _ => return None,
    })
}

/// Returns the hint for a character that is often pasted by mistake.
fn substitute(character: char) -> Option<&'static str> {
    Some(match character {
        '\u{2212}' | '\u{2010}'..='\u{2015}' => "write `-`",
        '×' | '∗' => "write `*`",
        '·' | '⋅' | '•' => "write `a b` for the product, of vectors the dot product",
        '÷' | '∕' => "write `/`",
        '²' => "write `^2`",
        '³' => "write `^3`",
        '‘' | '’' | '′' | '`' => "write `'`",
        '"' | '“' | '”' | '″' => {
            "words are written without quotes, and files without their extension: `image : earth`; a second derivative is `f''`"
        }
        'π' => "write `pi`",
        'τ' => "write `(2pi)`",
        '½' => "write `(1/2)`",
        '°' => "angles are in radians: 30° is `30pi/180`",
        '∞' => "an interval has two ends: write a large number",
        '⁰' | '¹' | '⁴'..='⁹' | '⁺' | '⁻' => "an exponent follows `^`: `x^-1`",
        '₀'..='₉' => "write components as `v_1`; digits in names need no underscore: `a1`",
        '⟨' | '⟩' => "a vector is written `(1, 2, 3)`",
        '∈' => "write `:`",
        '<' | '>' | '≤' | '≥' => INTERVAL,
        '√' => "write `sqrt`",
        '|' => "write `abs x` for a number, and `sqrt*v` for the length of a vector",
        '\\' => "names have no backslash before them: `cos`, `pi`",
        '&' => "write `max(a, b)` for what both functions bound; `a & b` is a set of solids",
        '!' | '%' | '?' | '~' | '$' => "the operators are `+ - * / ^ _ '`",
        '∪' | '∩' | '∖' => {
            "a set is written `a | b`, `a & b` or `a \\ b`, in a `solid` without parameters"
        }
        '\u{FEFF}' | '\u{200B}'..='\u{200F}' => "remove it",
        _ if character.is_whitespace() => "use an ordinary space",
        _ => return None,
    })
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

impl<'s, A: Actions, S: NameScope> Parser<'s, '_, A, S> {
    /// Reports a run of characters that begin no token.
    pub(super) fn report_characters(&mut self, run: BadRun, mode: Mode) {
        if self.state.quiet {
            return;
        }
        let BadRun { span, first, .. } = run;
        if let Some((place, found)) = self.foreign_item(span, mode) {
            let diagnostic = foreign_interval(self.source, place, &found.written());
            self.report(diagnostic);
            self.state.quiet = true;
            self.state.rejected = true;
            return;
        }
        let text = span.text(self.source);
        let mut diagnostic = bad_characters(self.source, span, first);
        if equivalent(first).is_some() && self.is_in_name(mode) {
            diagnostic.fixes.clear();
            diagnostic.hint = Some("choose a name of letters and digits".to_owned());
        }
        match first {
            '.' => {
                diagnostic = self.bad_component(span);
                self.state.silent = true;
            }
            '|' if text.contains(|c: char| c.is_ascii_alphanumeric()) => {
                let inside = text.trim_matches('|').trim();
                let mut written = match inside.bytes().all(|byte| byte.is_ascii_alphanumeric()) {
                    true => format!("abs {inside}"),
                    false => format!("abs({inside})"),
                };
                let behind = self.source[span.end as usize..].trim_start();
                let is_factor = |c: char| c.is_ascii_alphanumeric() || "(|^_²³.".contains(c);
                if behind.starts_with(is_factor) {
                    // Otherwise it might become part of the argument.
                    written = format!("({written})");
                }
                let fix = Fix::change(span, &written, self.state.is_of_space);
                diagnostic = match self.state.is_of_space {
                    true => diagnostic
                        .with_hint(format!("write {}", quote(&written)))
                        .with_fix(fix.with_all()),
                    // It may be the length of a vector.
                    false => diagnostic.with_fix(fix),
                };
            }
            '⟨' => {
                self.report(diagnostic);
                self.state.quiet = true;
                self.state.rejected = true;
                return;
            }
            '∈' if matches!(
                self.state.keyword,
                Some(DeclarationKeyword::Param | DeclarationKeyword::Grid)
            ) =>
            {
                diagnostic = diagnostic.with_fix(Fix::change(span, ":", true).with_all());
            }
            '>' if self.is_arrow(span) => return self.report_arrow(span),
            '<' if text.contains(',') => {
                let written = format!("({})", &text[1..text.len() - 1]);
                diagnostic = diagnostic
                    .with_hint(format!("a vector is written {}", quote(&written)))
                    .with_fix(Fix::change(span, &written, true).with_all());
            }
            '<' | '>' | '≤' | '≥' => return self.report_comparison(diagnostic),
            '?' => return self.report_condition(diagnostic),
            // If a set has ended with an error, its signs are correct.
            '|' | '&' | '\\'
                if self.state.rejected
                    && self.state.keyword == Some(DeclarationKeyword::Solid)
                    && self.state.parameters.is_empty() =>
            {
                return;
            }
            '|' | '&' | '\\' if self.state.is_of_space => {
                diagnostic.hint = Some(SET_HINT.to_owned());
            }
            '∪' | '∩' | '∖' if self.state.in_set && text.len() == first.len_utf8() => {
                let sign = match first {
                    '∪' => "|",
                    '∩' => "&",
                    _ => "\\",
                };
                diagnostic = diagnostic
                    .with_hint(format!("write `{sign}`"))
                    .with_fix(Fix::change(span, sign, true).with_all());
            }
            _ => {}
        }
        self.report(diagnostic);
    }

    /// Returns true if a bad character is reported together with the one before it.
    pub(super) fn joins(&self, first: char, next: char, mode: Mode) -> bool {
        let is_sign = |character| equivalent(character).is_some();
        self.is_in_name(mode)
            || !is_sign(first) && !is_sign(next) && substitute(first) == substitute(next)
    }

    /// Returns true if a name is being read, or has just been: a bad character is not part of an expression.
    fn is_in_name(&self, mode: Mode) -> bool {
        let is_behind = |name: Span| name.end > 0 && name == self.previous.span;
        let parameter = self.state.parameters.last();
        !matches!(mode, Mode::Expression | Mode::Place)
            || is_behind(self.state.name_span)
            || parameter.is_some_and(|parameter| is_behind(parameter.span))
    }

    /// Returns the interval in another notation in place of an item, if it begins with this character.
    pub(super) fn foreign_item(
        &self,
        first: Span,
        mode: Mode,
    ) -> Option<(Span, foreign::ForeignInterval<'s>)> {
        let found = matches!(mode, Mode::Item).then(|| self.interval_at(first.start))??;
        found.1.parameter.is_some().then_some(found)
    }

    /// Returns the error of a component chosen by a letter, `.x`.
    fn bad_component(&self, span: Span) -> Diagnostic {
        let number = match span.text(self.source) {
            ".x" => 1,
            ".y" => 2,
            _ => 3,
        };
        let written = format!("_{number}");
        let value = match self.previous.kind {
            TokenKind::ParenClose => "",
            _ => self.previous.span.text(self.source),
        };
        let message = "a component is selected by its number, after a `_`";
        Diagnostic::error(codes::BAD_NUMBER, span, message)
            .with_hint(format!("write {}", quote(&format!("{value}{written}"))))
            .with_fix(Fix::change(span, &written, true).with_all())
    }

    /// Returns the span of `.x`, `.y` or `.z` right after a value, if it begins with this point.
    pub(super) fn lettered_component(&self, point: Span) -> Option<Span> {
        let rest = &self.source.as_bytes()[point.end as usize..];
        let is_letter = matches!(rest, [b'x' | b'y' | b'z', ..]);
        let is_whole = !rest.get(1).is_some_and(u8::is_ascii_alphanumeric);
        let is_behind_value = self.previous.span.end == point.start
            && matches!(
                self.previous.kind,
                TokenKind::Constant(_) | TokenKind::Variable(_) | TokenKind::ParenClose
            );
        let place = Span::new(point.start, point.end + 1);
        (is_letter && is_whole && is_behind_value).then_some(place)
    }

    /// Returns the span of `<1, 2, 3>` where an operand is expected, if it begins with this character.
    pub(super) fn angle_vector(&self, first: Span) -> Option<Span> {
        let is_before_operand = matches!(
            self.previous.kind,
            TokenKind::Equals
                | TokenKind::Colon
                | TokenKind::Comma
                | TokenKind::At
                | TokenKind::ParenOpen
                | TokenKind::Plus
                | TokenKind::Minus
                | TokenKind::Star
                | TokenKind::Slash
        );
        let found = foreign::angle_vector(&self.source[first.start as usize..])?;
        is_before_operand.then(|| Span::new(first.start, first.start + found.len() as u32))
    }

    /// Returns the span of `|x|` in an expression, if it begins with this bar.
    pub(super) fn absolute_value(&self, bar: Span) -> Option<Span> {
        let is_set = self.state.is_of_space && self.state.parameters.is_empty();
        let is_behind_value = matches!(
            self.previous.kind,
            TokenKind::Variable(_) | TokenKind::Constant(_) | TokenKind::ParenClose
        );
        if is_set || is_behind_value {
            return None;
        }
        let inside = foreign::between_bars(&self.source[bar.start as usize..])?;
        Some(Span::new(bar.start, bar.end + inside.len() as u32 + 1))
    }

    /// Returns true if the sign `>` ends an arrow `->`.
    fn is_arrow(&self, sign: Span) -> bool {
        self.previous.kind == TokenKind::Minus && self.previous.span.end == sign.start
    }

    /// Reports an arrow as the only report of its declaration.
    fn report_arrow(&mut self, sign: Span) {
        self.state.quiet = true;
        if self.state.rejected {
            return;
        }
        let arrow = self.previous.span.to(sign);
        let mut diagnostic =
            Diagnostic::error(codes::BAD_CHARACTER, arrow, "`->` cannot be used here");
        let hint = match self.state.keyword {
            Some(DeclarationKeyword::Vector) => {
                Some("write `direction @ origin`: from p to q, the vector is `(q - p) @ p`")
            }
            Some(DeclarationKeyword::Define | DeclarationKeyword::Function) => {
                Some("a function is written `function f(x) = x^2;`")
            }
            _ => None,
        };
        diagnostic.hint = hint.map(str::to_owned);
        self.report(diagnostic);
        self.state.rejected = true;
    }

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

    /// Reports a comparison, with its equivalent here.
    fn report_comparison(&mut self, mut diagnostic: Diagnostic) {
        let in_items = |keyword: DeclarationKeyword| {
            keyword.has_domain() && !self.state.in_body
                || matches!(
                    keyword,
                    DeclarationKeyword::Param | DeclarationKeyword::Grid
                )
        };
        match self.state.keyword {
            Some(DeclarationKeyword::Solid) if self.state.attributes.is_empty() => {
                diagnostic = self.with_bound(diagnostic);
                self.report(diagnostic);
                self.state.quiet = true;
            }
            Some(keyword) if in_items(keyword) => self.report(diagnostic),
            _ => self.report_condition(diagnostic),
        }
    }

    /// Reports a sign of a condition as the only report of its declaration.
    fn report_condition(&mut self, diagnostic: Diagnostic) {
        self.report(diagnostic.with_hint(NO_CONDITIONS));
        self.state.quiet = true;
        self.state.rejected = true;
    }

    /// Returns the error of a comparison in the expression of a solid, with its equivalent. Its span is that of the
    /// comparison.
    fn with_bound(&self, diagnostic: Diagnostic) -> Diagnostic {
        let start = diagnostic.span.start;
        let rest = &self.source[start as usize..];
        let behind = rest.trim_start_matches(['<', '>', '≤', '≥', '=']);
        let sign = &rest[..rest.len() - behind.len()];
        let bound = foreign::first_item(behind).trim();
        let item = &rest[..rest.len() - behind.len() + foreign::first_item(behind).len()];
        let place = Span::new(start, start + item.len() as u32);
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
        if let Some(diagnostic) = self.hexadecimal_color() {
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
    fn hexadecimal_color(&self) -> Option<Diagnostic> {
        let is_value = matches!(self.previous.kind, TokenKind::Colon | TokenKind::Equals);
        let start = self.previous.span.end;
        let passed = Span::new(start, self.current.span.start.max(start)).text(self.source);
        let comment = passed.trim_start();
        let (length, written) = foreign::color(comment).filter(|_| is_value)?;
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
            let hint =
                "components are separated by `,`, and the sign in a number is `.`: `(1.5, 2, 3)`";
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
            _ if matches!(name, "if" | "else" | "while" | "for") => NO_CONDITIONS.to_owned(),
            (None, Some(word)) => {
                let written = quote(&format!("{} {name}", word.text()));
                format!("write {written}")
            }
            _ if self.current.kind == TokenKind::Semicolon => "remove it".to_owned(),
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
    }

    /// Returns true at a `,` that touches the numbers on both sides.
    fn is_decimal_comma(&self) -> bool {
        let comma = self.current.span;
        matches!(self.previous.kind, TokenKind::Number(_))
            && self.previous.span.end == comma.start
            && is_last_digits(&self.source[comma.end as usize..])
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
            TokenKind::Comma if self.is_decimal_comma() => {
                let fix = Fix::change(self.current.span, ".", true);
                let diagnostic = self.expected_diagnostic("`;`").with_hint(DECIMAL);
                diagnostic.with_fix(fix)
            }
            TokenKind::Comma => self
                .expected_diagnostic("`;`")
                .with_hint("a tuple is written in brackets: `(1, 2)`"),
            TokenKind::At => self
                .expected_diagnostic("`;`")
                .with_hint("a position follows `@` in a `vector`, a `geodesic`, a `light`, a `camera` and a set"),
            TokenKind::Prime => self
                .expected_diagnostic("`;`")
                .with_hint("only a function has a derivative: write `f' x`, not `(f x)'`"),
            _ => self.expected_diagnostic("`;`"),
        };
        self.reject(diagnostic)
    }
}
