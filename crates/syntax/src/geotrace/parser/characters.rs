//! The messages of characters that begin no token.

use super::messages::{COMMENT, QUOTE_LENGTH, foreign_interval, quote};
use super::names::Mode;
use super::{BadRun, Parser, foreign};
use crate::diagnostic::{Diagnostic, Fix};
use crate::geotrace::actions::Actions;
use crate::geotrace::codes;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::lexer::Fault;
use crate::geotrace::symbols::{NO_CONDITIONS, NameScope};
use crate::geotrace::token::TokenKind;
use crate::span::Span;

/// The hint at a sign of sets in an expression of a solid.
const SET_HINT: &str = "a set names solids and lists no parameters: `solid s = a | b;`; functions are joined by `min(f, g)` and `max(f, g)`";

/// The hint at a comparison where an interval may stand.
const INTERVAL: &str = "an interval is written `t : [a, b]`";

/// The hint at a root in LaTeX whose degree is in brackets.
const ROOT: &str = "a root of degree n is written `x^(1/n)`";

/// The hint at the sign around a formula in LaTeX.
const NO_DOLLARS: &str = "formulas have no `$` around them";

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
    let is_mixed_number = first == '½' && before.ends_with(|c: char| c.is_ascii_digit());
    if let Some(text) = equivalent(first).filter(|_| single && !is_mixed_number) {
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
        Fault::LonePoint if source[span.end as usize..].starts_with(['^', '*', '/']) => {
            let message = "a `.` cannot be used here: operators have no point before them";
            Diagnostic::error(codes::BAD_NUMBER, span, message)
                .with_fix(Fix::remove(span, span.text(source)).with_all())
        }
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

/// Returns the character that a full-width one stands for.
fn half_width(character: char) -> Option<char> {
    let is_full_width = matches!(character, '\u{FF01}'..='\u{FF5E}');
    char::from_u32(u32::from(character).wrapping_sub(0xFEE0)).filter(|_| is_full_width)
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
        '⅓' => "write `(1/3)`",
        '¼' => "write `(1/4)`",
        '¾' => "write `(3/4)`",
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
        if half_width(first).is_some() {
            return self.report_full_width(span, first);
        }
        let text = span.text(self.source);
        if first == '.' {
            return self.report_point(span);
        }
        let mut diagnostic = bad_characters(self.source, span, first);
        if equivalent(first).is_some() && self.is_in_name(mode) {
            diagnostic.fixes.clear();
            diagnostic.hint = Some("choose a name of letters and digits".to_owned());
        }
        match first {
            '\\' if let Some((hint, written)) = foreign::latex(text) => {
                diagnostic = diagnostic.with_hint(hint);
                if hint == NO_CONDITIONS {
                    return self.report_alone(diagnostic);
                }
                diagnostic
                    .fixes
                    .extend(written.map(|written| match written {
                        "" => Fix::remove(span, text).with_all(),
                        written => Fix::change(span, written, true).with_all(),
                    }));
            }
            '⁻' if text == "⁻¹"
                && self.previous.span.end == span.start
                && let TokenKind::Function(id) = self.previous.kind
                && let Some(inverse) = self.parsed.symbol(id).inverse.as_deref() =>
            {
                let place = self.previous.span.to(span);
                let before = &self.source[..place.start as usize];
                let behind = &self.source[place.end as usize..];
                let written = foreign::apart(before, inverse, behind);
                diagnostic = diagnostic
                    .with_hint(format!("write `{inverse}` for the inverse"))
                    .with_fix(Fix {
                        replacement: written,
                        ..Fix::change(place, inverse, true).with_all()
                    });
            }
            '|' if text.contains(|c: char| c.is_ascii_alphanumeric()) => {
                let inside = text.trim_matches('|').trim();
                let is_word = inside.bytes().all(|byte| byte.is_ascii_alphanumeric());
                let behind = self.source[span.end as usize..].trim_start();
                let is_factor = |c: char| c.is_ascii_alphanumeric() || "(|^_²³.".contains(c);
                let written = |by: &str, space: &str| {
                    let written = match is_word {
                        true => format!("{by}{space}{inside}"),
                        false => format!("{by}({inside})"),
                    };
                    // Otherwise what follows might become part of the argument.
                    match behind.starts_with(is_factor) {
                        true => format!("({written})"),
                        false => written,
                    }
                };
                let is_vector =
                    text.starts_with("||") || inside.starts_with('(') && inside.contains(',');
                let (magnitude, length) = (written("abs", " "), written("sqrt*", ""));
                let certain = match (is_vector, self.state.is_of_space) {
                    (true, _) => Some(&length),
                    (false, true) => Some(&magnitude),
                    (false, false) => None,
                };
                diagnostic = match certain {
                    Some(certain) => diagnostic
                        .with_hint(format!("write {}", quote(certain)))
                        .with_fix(Fix::change(span, certain, true).with_all()),
                    None => diagnostic.with_fix(Fix::change(span, &magnitude, false)),
                };
                let may_be_vector = inside.contains(|c: char| c.is_ascii_alphabetic());
                if certain.is_none() && may_be_vector {
                    diagnostic = diagnostic.with_fix(Fix::change(span, &length, false));
                }
            }
            '\\' if !self.state.is_of_space => {
                let behind = &self.source[span.end as usize..];
                if behind.starts_with("sqrt[") {
                    return self.report_alone(diagnostic.with_hint(ROOT));
                }
                if behind.starts_with(|c: char| c.is_ascii_alphabetic()) {
                    diagnostic = diagnostic.with_fix(Fix::remove(span, text).with_all());
                }
            }
            '$' => return self.report_alone(diagnostic.with_hint(NO_DOLLARS)),
            '⟨' => return self.report_alone(diagnostic),
            '<' if self.source[span.start as usize..].starts_with("<!--") => {
                return self.report_alone(diagnostic.with_hint(COMMENT));
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

    /// Reports the full-width characters from this one to the last of its line, which an input method writes, as the only
    /// report of the declaration.
    fn report_full_width(&mut self, span: Span, first: char) {
        /// The maximum number of characters that are inspected.
        const LONGEST: usize = 200;
        let line = self.source[span.start as usize..]
            .char_indices()
            .take(LONGEST)
            .take_while(|(_, c)| !";#\r\n".contains(*c));
        let length = line
            .filter(|(_, c)| half_width(*c).is_some())
            .map(|(at, c)| at + c.len_utf8())
            .last();
        let place = Span::new(span.start, span.start + length.unwrap_or_default() as u32);
        let characters = place.text(self.source).chars();
        let written: String = characters.map(|c| half_width(c).unwrap_or(c)).collect();
        let form = quote(&written);
        let diagnostic = bad_characters(self.source, span, first)
            .with_hint(format!("write {form}, without full-width characters"))
            .with_fix(Fix::change(place, &written, true).with_all());
        self.report(diagnostic);
        self.state.quiet = true;
        self.state.rejected = true;
    }

    /// Reports a `.` right after a word, with the letters that belong to it.
    fn report_point(&mut self, span: Span) {
        let text = span.text(self.source);
        let message = "a `.` cannot be used here";
        let diagnostic = Diagnostic::error(codes::BAD_NUMBER, span, message);
        let diagnostic = match self.previous.kind {
            TokenKind::Undefined
                if { &self.state.undefined }.contains(&self.previous.span.text(self.source)) =>
            {
                // Its report has the hint.
                return;
            }
            TokenKind::Undefined => {
                diagnostic.with_hint("a name is one word of letters and digits")
            }
            TokenKind::Word => {
                let name = self.previous.span.text(self.source);
                diagnostic
                    .with_hint(format!(
                        "files are named without their extension: write `{name}`"
                    ))
                    .with_fix(Fix::remove(span, text).with_all())
            }
            _ if text == "." => diagnostic
                .with_hint("write `a b` for the product, of vectors the dot product")
                .with_fix(Fix {
                    title: "Write a space".to_owned(),
                    ..Fix::change(span, " ", true)
                }),
            _ => {
                self.state.silent = true;
                self.bad_component(span)
            }
        };
        self.report(diagnostic);
    }

    /// Returns the span of a command of LaTeX that has an equivalent, if it begins with this backslash.
    pub(super) fn latex_command(&self, backslash: Span) -> Option<Span> {
        let rest = &self.source[backslash.start as usize..];
        let length = rest.strip_prefix('\\')?;
        let length = length.find(|c: char| !c.is_ascii_alphabetic());
        let command = &rest[..1 + length.unwrap_or(rest.len() - 1)];
        foreign::latex(command)?;
        Some(Span::new(
            backslash.start,
            backslash.start + command.len() as u32,
        ))
    }

    /// Returns the span of a `.` between two words, if it is this one: with the word behind it, if that is the extension of a
    /// file.
    pub(super) fn point_behind_word(&self, point: Span) -> Option<Span> {
        let rest = &self.source[point.end as usize..];
        let length = rest.find(|c: char| !c.is_ascii_alphanumeric());
        let word = &rest[..length.unwrap_or(rest.len())];
        let touches = self.previous.span.end == point.start;
        let is_between = touches && word.starts_with(|c: char| c.is_ascii_alphabetic());
        match self.previous.kind {
            TokenKind::Word => Some(Span::new(point.start, point.end + word.len() as u32)),
            TokenKind::Variable(_) | TokenKind::Constant(_) | TokenKind::Undefined => Some(point),
            _ => None,
        }
        .filter(|_| is_between)
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
                | TokenKind::BracketOpen
                | TokenKind::BraceOpen
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
        let text = &self.source[bar.start as usize..];
        let inside = foreign::between_bars(text)?;
        let bars = if text.starts_with("||") { 4 } else { 2 };
        Some(Span::new(bar.start, bar.start + inside.len() as u32 + bars))
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
        self.report_alone(diagnostic.with_hint(NO_CONDITIONS));
    }

    /// Reports what makes the rest of its declaration unreadable.
    fn report_alone(&mut self, diagnostic: Diagnostic) {
        self.report(diagnostic);
        self.state.quiet = true;
        self.state.rejected = true;
    }
}
