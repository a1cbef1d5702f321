//! Ambiguity lints: warnings about text that is legal but is not read as it seems.

use std::collections::HashSet;

use super::messages::quote;
use super::names::{Mode, meaning};
use super::{Parser, foreign};
use crate::diagnostic::{Diagnostic, Fix};
use crate::document::ShadowedSplit;
use crate::geotrace::actions::Actions;
use crate::geotrace::codes;
use crate::geotrace::lexer::Word;
use crate::geotrace::symbols::{NameScope, Parsed};
use crate::geotrace::token::TokenKind;
use crate::span::Span;
use crate::symbol::SymbolId;

/// The state of the lints between declarations.
#[derive(Default)]
pub(super) struct LintState {
    /// The last bracket that opens right after a function. The operand that begins with it removes it from here.
    pub(super) touching: Option<Touching>,
    /// The last application whose operand ended with a number or a name.
    pub(super) argument: Option<Argument>,
    /// The end of the last word that looks like a derivative by several parameters.
    derivative_end: u32,
    /// The end of the last numbers that look like one number.
    pub(super) numbers_end: u32,
    splits: Vec<Split>,
}

/// `sin(`: the function and the position of its bracket.
#[derive(Clone, Copy)]
pub(super) struct Touching {
    pub(super) function: Span,
    pub(super) bracket: u32,
}

/// `sin 2`: the function and its operand.
#[derive(Clone, Copy)]
pub(super) struct Argument {
    pub(super) function: Span,
    pub(super) operand: Span,
}

/// `sin 2x`: the application, and the start of the factors after its operand.
#[derive(Clone, Copy)]
pub(super) struct ShortArgument {
    argument: Argument,
    rest: u32,
}

/// A word, or the rest of one, from which a token was split off.
struct Split {
    start: u32,
    token_end: u32,
    word_end: u32,
}

/// The maximum number of splits, from the top, that are compared with later names.
const MAX_SPLITS: usize = 1_000_000;

/// The maximum length of an exponent that is inspected as a possible `-1`.
const MAX_INVERSE_LENGTH: usize = 16;

impl LintState {
    /// Records that a token of `length` bytes was split off a word.
    #[inline]
    pub(super) fn record_split(&mut self, word: Word<'_>, length: usize) {
        if self.splits.len() < MAX_SPLITS {
            self.splits.push(Split {
                start: word.start,
                token_end: word.start + length as u32,
                word_end: word.start + word.rest.len() as u32,
            });
        }
    }
}

impl<A: Actions, S: NameScope> Parser<'_, '_, A, S> {
    /// Reports a warning. `written` are unambiguous texts for the possible readings, for fixes.
    pub(super) fn warn(&mut self, span: Span, message: String, hint: String, written: &[&str]) {
        if self.state.quiet {
            return;
        }
        let fixes = written.iter().map(|text| Fix::write(span, text));
        self.warn_with(span, message, hint, fixes.collect());
    }

    /// Reports a warning about a text that may be meant in one way but is read in another; both can be written
    /// unambiguously.
    fn warn_of_reading(&mut self, place: Span, written: &str, meant: &str, read: &str) {
        let message = format!("{} is read as {}", quote(written), quote(read));
        let hint = format!(
            "write {}, or {} if that is meant",
            quote(meant),
            quote(read)
        );
        self.warn(place, message, hint, &[meant, read]);
    }

    /// Reports a warning whose first fix writes the apparent meaning: it may be applied together with others.
    fn warn_of_argument(&mut self, span: Span, message: String, hint: String, written: &[&str]) {
        let fixes = written.iter().map(|text| Fix::write(span, text));
        let mut fixes: Vec<Fix> = fixes.collect();
        if let Some(first) = fixes.first_mut() {
            first.all = true;
        }
        self.warn_with(span, message, hint, fixes);
    }

    fn warn_with(&mut self, span: Span, message: String, hint: String, fixes: Vec<Fix>) {
        if !self.state.silent {
            let mut warning = Diagnostic::warning(codes::SURPRISING_READING, span, message);
            warning.fixes = fixes;
            self.report(warning.with_hint(hint));
        }
    }

    /// `sin 2x`, `sin 2 x`, `sin nt`: returns the operand if the current token is a factor after it that may be meant to be
    /// part of it.
    #[inline]
    pub(super) fn short_argument(&self) -> Option<ShortArgument> {
        let argument = self.lints.argument?;
        match argument.operand.end == self.previous.span.end {
            true => self.factor_behind(argument),
            false => None,
        }
    }

    #[cold]
    fn factor_behind(&self, argument: Argument) -> Option<ShortArgument> {
        let operand = argument.operand;
        let signs = Span::new(operand.start, self.previous.span.start).text(self.source);
        let is_literal = |c: char| c.is_ascii_whitespace() || "+-*/".contains(c);
        let rest = self.current.span.start;
        let between = Span::new(operand.end, rest).text(self.source);
        let is_number = matches!(self.previous.kind, TokenKind::Number(_));
        let is_value = self.is_value();
        let looks_joined = match (is_number, between) {
            (true, "") => !matches!(self.current.kind, TokenKind::Undefined | TokenKind::Error),
            (true, between) => is_value && between.bytes().all(|byte| byte == b' '),
            (false, "") => is_value,
            // Nobody means a factor sin π.
            (false, between) => {
                let is_pi = self.previous.span.text(self.source) == "pi";
                is_value && is_pi && between.bytes().all(|byte| byte == b' ')
            }
        };
        // The whole of `f_xyz` has been warned about.
        let is_known = operand.end <= self.lints.derivative_end;
        (looks_joined && !is_known && signs.chars().all(is_literal))
            .then_some(ShortArgument { argument, rest })
    }

    /// Returns true if the current token begins a factor that may or may not be meant to be part of an operand: `sin 2x cos y`,
    /// `sin 2x (1, 0, 0)`.
    pub(super) fn is_apart(&self) -> bool {
        !self.is_value()
            && !matches!(self.current.kind, TokenKind::Number(_))
            && self.previous.span.end != self.current.span.start
    }

    /// Warns about an operand whose product ends with the previous token. `is_whole` is true if the term ends there
    /// too.
    #[cold]
    pub(super) fn warn_short_argument(&mut self, short: ShortArgument, is_whole: bool) {
        let ShortArgument {
            argument: Argument { function, operand },
            rest,
        } = short;
        let span = function.to(self.previous.span);
        let between = Span::new(operand.end, rest).text(self.source);
        let next = Span::new(rest, span.end).text(self.source);
        let (name, number) = (function.text(self.source), operand.text(self.source));
        let read = format!("({name} {number}) {next}");
        let meant = format!("{name}({number}{between}{next})");
        let written = quote(&format!("{name} {number}{between}{next}"));
        let message = format!("{written} is read as {}", quote(&read));
        if operand.start == function.end
            && let Some(known) = self.foreign_word(&format!("{name}{number}"), true)
        {
            let written = quote(&format!("{name}{number}{next}"));
            let message = format!("{written} is read as {}", quote(&read));
            self.warn(span, message, known.hint.to_owned(), &[]);
            return;
        }
        if number == "-1"
            && operand.start == function.end
            && let Some(inverse) = self.inverse(name)
        {
            let hint = format!(
                "write `{inverse} x` for the inverse, or {} if that is meant",
                quote(&read)
            );
            let place = function.to(operand);
            let behind = &self.source[place.end as usize..];
            let meant = Fix::write(place, &foreign::apart("", inverse, behind));
            let fixes = vec![meant, Fix::write(span, &read)];
            self.warn_with(span, message, hint, fixes);
            return;
        }
        if !is_whole || !is_plain_product(next) {
            let hint = format!("write the argument of {} between brackets", quote(name));
            self.warn(span, message, hint, &[]);
            return;
        }
        let written = format!("{name} {number}{between}{next}");
        self.warn_of_reading(span, &written, &meant, &read);
    }

    /// Returns the inverse of the function with this name, if both are builtins.
    fn inverse(&self, name: &str) -> Option<&str> {
        let id = self.parsed.get(name)?;
        self.parsed.symbol(id).inverse.as_deref()
    }

    /// Returns true for the name of a builtin that is a word of its own only before a bracket.
    fn is_weak(&self, name: &str) -> bool {
        let words = self.parsed.words();
        self.parsed.get(name).is_none() && words.is_some_and(|words| words.weak(name).is_some())
    }

    /// `acost` where `a` is declared: looks like a product with the cosine. The current token is the function, and the rest of
    /// its word follows.
    #[cold]
    pub(super) fn warn_product_of_function(&mut self, id: SymbolId) {
        let function = self.current.span;
        if self.parsed.symbol(id).keyword.is_some() {
            return;
        }
        let name = function.text(self.source);
        for split in 1..name.len() {
            let (factor, inner) = name.split_at(split);
            let is_builtin = |id| self.parsed.symbol(id).keyword.is_none();
            let Some(inner_id) = self.parsed.get(inner).filter(|id| is_builtin(*id)) else {
                continue;
            };
            if !matches!(meaning(&self.parsed, inner_id), TokenKind::Function(_)) {
                continue;
            }
            let declared = self.parsed.get(factor);
            let kind = declared.map_or(TokenKind::Undefined, |id| meaning(&self.parsed, id));
            self.parsed.record_name_lookup(factor, function.start, kind);
            let is_parameter =
                self.state.in_body && self.state.parameter_trie.get(factor).is_some();
            if is_parameter || matches!(kind, TokenKind::Constant(_)) {
                let place = Span::new(function.start, self.lexer.word().end);
                let rest = Span::new(function.end, place.end).text(self.source);
                let (meant, read) = (format!("{factor} {inner} {rest}"), format!("{name} {rest}"));
                let written = place.text(self.source);
                self.warn_of_reading(place, written, &meant, &read);
            }
        }
    }

    /// `sqrt[3](2)`: looks like a root. A `(` follows the operand.
    #[cold]
    pub(super) fn warn_root(&mut self, function: Span, operand: Span) {
        let name = function.text(self.source);
        let index = operand.text(self.source);
        let index = index.strip_prefix('[').and_then(|it| it.strip_suffix(']'));
        let is_index = |index: &&str| index.bytes().all(|byte| byte.is_ascii_digit());
        let Some(index) = index.filter(is_index).filter(|_| name == "sqrt") else {
            return;
        };
        let place = function.to(operand);
        let read = format!("({name} {index})");
        let message = format!(
            "`{name}[{index}](x)` is read as {}, a product",
            quote(&format!("{read}(x)"))
        );
        let hint = format!(
            "write `x^(1/{index})` for the root, or {} if that is meant",
            quote(&format!("{read}(x)"))
        );
        self.warn(place, message, hint, &[&read]);
    }

    /// `a//b`: looks like a quotient of integers, or a comment. The current token is the second slash, and touches the first.
    #[cold]
    pub(super) fn warn_slashes(&mut self, slash: Span) {
        let message = "`a//b` is read as `a/(/b)`, a times b".to_owned();
        let hint = "write `/` for a quotient, `#` before a comment, or `/ /` if that is meant";
        self.warn(
            slash.to(self.current.span),
            message,
            hint.to_owned(),
            &["/", "/ /"],
        );
    }

    /// `f_xy`: looks like a derivative by x and y. `derivative` is `f_x`, and the current token begins the rest of the word.
    #[cold]
    pub(super) fn check_second_derivative(&mut self, id: SymbolId, derivative: Span) {
        let rest = Span::new(derivative.end, self.lexer.word().end);
        let Some(names) = self
            .parsed
            .symbol(id)
            .split_parameters(rest.text(self.source))
        else {
            return;
        };
        self.lints.derivative_end = rest.end;
        let first = derivative.text(self.source);
        let meant = format!("{first}_{}", names.join("_"));
        let read = format!("{first} {}", names.join(" "));
        let place = derivative.to(rest);
        let message = format!(
            "{} is read as {}",
            quote(place.text(self.source)),
            quote(&read)
        );
        let which = match (first.matches('_').count(), names.len()) {
            (1, 1) => "the second derivative",
            _ => "the higher derivative",
        };
        let hint = format!("write {} for {which}", quote(&meant));
        if self.current.kind != TokenKind::Undefined {
            let hint = format!("{hint}, or {} if that is meant", quote(&read));
            self.warn_of_argument(place, message, hint, &[&meant, &read]);
            return;
        }
        let message = format!("{} is not defined: {message}", self.found());
        let fix = Fix::change(place, &meant, true).with_all();
        let diagnostic = Diagnostic::error(codes::UNDEFINED_NAME, place, message);
        self.report(diagnostic.with_hint(hint).with_fix(fix));
        self.state.silent = true;
        self.advance(Mode::Expression);
    }

    /// `a**b`: looks like a power of `base`. The current token is the second star, and touches the first.
    #[cold]
    pub(super) fn warn_power(&mut self, base: Span, star: Span) {
        let message = "`a**b` is read as `a*(*b)`, a times the square of b".to_owned();
        let stars = star.to(self.current.span);
        let text = base.text(self.source);
        let is_single = text
            .bytes()
            .all(|byte| byte.is_ascii_alphanumeric() || byte == b'.');
        // Powers of powers are grouped from the right, as in the language of this sign.
        if is_single || is_bracket(text) || text.contains("**") {
            let hint = "write `^` for a power, or `* *` if that is meant".to_owned();
            self.warn(stars, message, hint, &["^", "* *"]);
            return;
        }
        // `f(x)^2` is the function of a square.
        let fixes = [format!("({text})^"), format!("{text}* *")];
        let hint = format!(
            "write {} for a power, or `* *` if that is meant",
            quote(&format!("({text})^…"))
        );
        let place = base.to(stars);
        let fixes = fixes.iter().map(|text| Fix::write(place, text)).collect();
        self.warn_with(stars, message, hint, fixes);
    }

    /// `a^1/2`: looks like a root. The quotient belongs to the power as a whole.
    pub(super) fn warn_fraction_of_power(&mut self, slash: Span, denominator: Span) {
        let before = &self.source[..slash.start as usize];
        let numerators = ["1", "-1"].into_iter();
        let numerator = numerators.rev().find(|numerator| {
            before
                .strip_suffix(numerator)
                .is_some_and(|power| power.ends_with('^'))
        });
        let Some(numerator) = numerator.filter(|_| slash.end == denominator.start) else {
            return;
        };
        let fraction = Span::new(slash.start - numerator.len() as u32, denominator.end);
        let text = fraction.text(self.source);
        let number = denominator.text(self.source);
        let (read, meant) = (format!("(a^{numerator})/{number}"), format!("({text})"));
        let written = quote(&format!("a^{text}"));
        let message = format!("{written} is read as {}", quote(&read));
        let hint = format!("write {} for the root", quote(&format!("a^{meant}")));
        self.warn(fraction, message, hint, &[&meant]);
    }

    /// `e^-2t`, `2^xy`: looks as if the factor after the number or the name were in the exponent. The current token is that
    /// factor. With other bases such a power is usual: `x^2y`.
    #[inline]
    pub(super) fn warn_short_exponent(&mut self, base: Span, exponent: Span) {
        let touches = self.previous.span.end == self.current.span.start;
        if !touches || !self.is_value() {
            return;
        }
        let text = base.text(self.source);
        let is_number = || {
            text.bytes()
                .all(|byte| byte.is_ascii_digit() || byte == b'.')
        };
        let signs = Span::new(exponent.start, self.previous.span.start).text(self.source);
        let looks_longer = match self.previous.kind {
            TokenKind::Number(_) => text == "e",
            TokenKind::Variable(_) | TokenKind::Constant(_) => {
                (text == "e" || is_number()) && signs.trim_start_matches(['+', '-']).is_empty()
            }
            _ => false,
        };
        if looks_longer {
            self.warn_exponent(base, exponent);
        }
    }

    #[cold]
    fn warn_exponent(&mut self, base: Span, exponent: Span) {
        let (number, factor) = (exponent.text(self.source), self.current.span);
        let power = format!("{}^", base.text(self.source));
        let read = format!("{power}{number} {}", factor.text(self.source));
        let meant = format!("{power}({number}{})", factor.text(self.source));
        let place = base.to(factor);
        // More factors, or a power of this one, may be meant to be in the exponent too.
        let rest = self.source[factor.end as usize..].trim_start_matches([' ', '\t']);
        if !rest.starts_with([',', ';', ')', ']', '}', '+', '-', '\n', '\r']) && !rest.is_empty() {
            let written = quote(place.text(self.source));
            let message = format!("{written} is read as {}", quote(&read));
            let hint = "write the exponent between brackets".to_owned();
            self.warn(place, message, hint, &[]);
            return;
        }
        let written = place.text(self.source);
        self.warn_of_reading(place, written, &meant, &read);
    }

    /// `sin 1/` and `sin pi/`: returns the application of a function to the number that is followed by a slash.
    pub(super) fn argument_before_slash(&self, slash: Span) -> Option<Argument> {
        let argument = self.lints.argument?;
        let touches = argument.operand.end == slash.start && slash.text(self.source) == "/";
        let is_numerator = matches!(argument.operand.text(self.source), "1" | "pi");
        (touches && is_numerator).then_some(argument)
    }

    /// `sin 1/x`, `sin pi/2`: looks as if the fraction were the operand.
    #[cold]
    pub(super) fn warn_fraction_behind(&mut self, argument: Argument, divisor: Span) {
        let Argument { function, operand } = argument;
        let place = function.to(divisor);
        let name = function.text(self.source);
        let rest = Span::new(operand.end, divisor.end).text(self.source);
        let number = operand.text(self.source);
        let read = format!("({name} {number}){rest}");
        let meant = format!("{name}({number}{rest})");
        let written = place.text(self.source);
        self.warn_of_reading(place, written, &meant, &read);
    }

    /// `f + h`: looks like a sum of functions, but the sign is a part of the operand. `sign` is the sign.
    #[cold]
    pub(super) fn warn_operator_behind(&mut self, function: Span, sign: Span, operand: Span) {
        let name = function.text(self.source);
        let rest = Span::new(sign.end, operand.end)
            .text(self.source)
            .trim_start();
        let sign = sign.text(self.source);
        let written = quote(&format!("{name} {sign} {rest}"));
        let read = format!("{name}({sign}{rest})");
        let message = format!("{written} is read as {}", quote(&read));
        let hint = format!(
            "write an argument after {}, or {} if that is meant",
            quote(name),
            quote(&read)
        );
        self.warn(function.to(operand), message, hint, &[&read]);
    }

    /// `sin^-1`: looks like the inverse function.
    pub(super) fn warn_inverse(&mut self, id: SymbolId, function: Span, exponent: Span) {
        let text = exponent.text(self.source);
        let signs = text.bytes().filter(|byte| !b" \t\r\n()[]{}".contains(byte));
        if text.len() > MAX_INVERSE_LENGTH || !signs.eq(*b"-1") {
            return;
        }
        let symbol = self.parsed.symbol(id);
        let name = function.text(self.source);
        let reciprocal = quote(&format!("1/{name} x"));
        let hint = match symbol.inverse.as_deref().filter(|_| *symbol.name == *name) {
            Some(inverse) => {
                format!("write `{inverse} x` for the inverse, {reciprocal} if that is meant")
            }
            None => format!("write {reciprocal} if that is meant"),
        };
        let message = format!(
            "{} is read as {reciprocal}, not as the inverse of {}",
            quote(&format!("{name}^-1 x")),
            quote(name)
        );
        // The operand has not been read yet.
        self.warn(function.to(exponent), message, hint, &[]);
    }

    /// `sin(x)^y`: the exponent belongs to the operand.
    pub(super) fn warn_power_of_argument(
        &mut self,
        touching: Option<Touching>,
        base: Span,
        exponent: Span,
    ) {
        // A component that was read before has been warned about.
        if let Some(Touching { function, bracket }) = touching
            && bracket == base.start
            && base.text(self.source).ends_with([')', ']', '}'])
        {
            let name = function.text(self.source);
            let (base, power) = (base.text(self.source), exponent.text(self.source));
            let meant = format!("({name}{base})^{power}");
            let short = format!("{name}^{power} {base}");
            let quoted = quote(&meant);
            // Some names are words before a bracket only; and `f^-1` looks like the inverse.
            let takes_power = !name.contains('^')
                && !self.is_weak(name)
                && power.bytes().all(|byte| byte.is_ascii_alphanumeric());
            let (hint, fixes) = match takes_power {
                false => (
                    format!("write {quoted} for the power of the value"),
                    &[meant.as_str()][..],
                ),
                true => (
                    format!(
                        "write {quoted} or {} for the power of the value",
                        quote(&short)
                    ),
                    &[meant.as_str(), short.as_str()][..],
                ),
            };
            let written = quote(&format!("{name}{base}^{power}"));
            let read = quote(&format!("{name}({base}^{power})"));
            let message = format!("{written} is read as {read}");
            self.warn_of_argument(function.to(exponent), message, hint, fixes);
        }
    }

    /// `f(x)_1`: the component is the operand's.
    pub(super) fn warn_component_of_argument(
        &mut self,
        touching: Option<Touching>,
        value: Span,
        component: Span,
    ) {
        if let Some(Touching { function, bracket }) = touching
            && bracket == value.start
        {
            let name = function.text(self.source);
            let (value_text, text) = (value.text(self.source), component.text(self.source));
            let index = text.get(value_text.len()..).unwrap_or_default();
            let written = quote(&format!("{name}{text}"));
            let read = quote(&format!("{name}({text})"));
            let meant = format!("({name}{value_text}){index}");
            let message = format!("{written} is read as {read}");
            let hint = format!("write {} for a component of the value", quote(&meant));
            self.warn_of_argument(function.to(component), message, hint, &[&meant]);
        }
    }
}

impl<A: Actions> Parser<'_, '_, A, Parsed> {
    /// Reports each name that is declared below a word that begins with the name's letters but was split after fewer
    /// letters.
    ///
    /// Called once, at the end of the text, when all names are known: one walk through the trie for each split.
    pub(super) fn warn_shadowed_splits(&mut self) {
        let mut warned = HashSet::new();
        let mut warnings = Vec::new();
        for split in std::mem::take(&mut self.lints.splits) {
            let rest = Span::new(split.start, split.word_end).text(self.source);
            let token = Span::new(split.start, split.token_end).text(self.source);
            self.parsed.trie.each_prefix(rest, |length, id| {
                let symbol = &self.parsed.symbols[id];
                if length > token.len()
                    && let Some(name_span) = symbol.name_span
                    && name_span.start > split.start
                    && warned.insert(id)
                {
                    let place = Span::new(split.start, split.start + length as u32);
                    let line = self.line_of(split.start);
                    warnings.push(shadowed_split(ShadowedSplit {
                        name: &symbol.name,
                        name_span,
                        token_length: token.len(),
                        place,
                        line,
                    }));
                }
            });
        }
        for warning in warnings {
            self.report(warning);
        }
    }
}

/// Returns true if a text is a single bracket without others inside.
pub(super) fn is_bracket(text: &str) -> bool {
    text.starts_with(['(', '[', '{']) && text.find([')', ']', '}']) == Some(text.len() - 1)
}

/// Returns true if a text has one line and contains no `*` or `/` outside brackets.
fn is_plain_product(text: &str) -> bool {
    let mut depth = 0_u32;
    text.chars().all(|sign| {
        match sign {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            '*' | '/' => return depth > 0,
            '#' | '\n' => return false,
            _ => {}
        }
        true
    })
}

/// Returns the warning for a name whose letters are read as several tokens above.
pub(crate) fn shadowed_split(split: ShadowedSplit<'_>) -> Diagnostic {
    let ShadowedSplit {
        name,
        name_span,
        token_length: token,
        place,
        line,
    } = split;
    let reading = quote(&format!("{} {}", &name[..token], &name[token..]));
    let name = quote(name);
    let message =
        format!("above, in line {line}, {name} is read as {reading}; below it is this name");
    Diagnostic::warning(codes::SURPRISING_READING, name_span, message)
        .with_hint(format!("write {reading} above, or choose another name"))
        .with_related(place, format!("here {name} is read as {reading}"))
        .with_fix(Fix::insert(
            "Insert a space above",
            place.start + token as u32,
            " ",
        ))
}
