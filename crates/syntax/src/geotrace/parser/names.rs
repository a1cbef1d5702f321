//! Words: the token that a word forms in its context, new names, and the reports of undefined words.

use super::deferred::{Deferred, Undefined};
use super::messages::{COMMENT, quote};
use super::suggestions::nearest_keyword;
use super::{DeclarationState, Parser, Stop};
use crate::diagnostic::{Diagnostic, Fix};
use crate::geotrace::actions::{Actions, Parameter};
use crate::geotrace::attributes::AttributeWord;
use crate::geotrace::codes;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::lexer::{Fault, Lexeme, Word};
use crate::geotrace::symbols::{
    ForeignWord, MAX_NAME_LENGTH, NO_CONDITIONS, NameScope, Symbol, SymbolKind,
};
use crate::geotrace::token::{MapWord, Token, TokenKind};
use crate::span::Span;
use crate::symbol::SymbolId;

/// The way in which the next word is split into a token.
#[derive(Clone, Copy, Debug)]
pub(super) enum Mode {
    /// The longest defined prefix is one token.
    Expression,
    /// The whole word is one token, even if defined names begin it.
    Name,
    /// A declaration may begin here: words that are keywords only here are keywords.
    Start,
    /// The whole word is one token: one of the parameters, an attribute, or undefined.
    Item,
    /// The whole word is one token, the value of an attribute.
    Word,
    /// The word of a map, otherwise as [`Mode::Expression`].
    Place,
    /// The longest prefix that is a parameter of this function is one token.
    ParameterOf(SymbolId),
}

/// The maximum number of undefined words that are reported in one declaration.
const MAX_UNDEFINED: usize = 32;

impl<'s, A: Actions, S: NameScope> Parser<'s, '_, A, S> {
    /// Returns the next lexeme of the text.
    #[inline]
    pub(super) fn lex(&mut self, mode: Mode) -> Lexeme {
        let Self {
            lexer,
            parsed,
            state,
            lints,
            ..
        } = self;
        let source = lexer.source();
        let is_in_set = state.in_set;
        let lexeme = lexer.next(|word| {
            if let Some(keyword) = soft_keyword(source, mode, word) {
                if let Mode::Start = mode {
                    return (word.rest.len(), TokenKind::Declare(keyword));
                }
                // A `;` is missing, if no name begins the word.
                let (length, kind) = expression_word(parsed, state, source, word);
                if kind == TokenKind::Undefined {
                    parsed.record_prefix_lookup(word.rest, word.start, length, kind);
                    return (length, TokenKind::Declare(keyword));
                }
                if !matches!(mode, Mode::Expression | Mode::Place) {
                    // Without the name at its beginning, it would be a keyword.
                    parsed.record_name_lookup(&word.rest[..length], word.start, kind);
                }
            }
            let map = match mode {
                Mode::Place if word.is_whole() => MapWord::from_text(word.rest),
                _ => None,
            };
            if let Some(map) = map.filter(|_| parsed.get(word.rest).is_none()) {
                parsed.record_name_lookup(word.rest, word.start, TokenKind::Undefined);
                return (word.rest.len(), TokenKind::Map(map));
            }
            match mode {
                Mode::Expression | Mode::Start | Mode::Place => {
                    if let Some(id) = weak_function(parsed, state, source, word) {
                        // A declared name takes precedence.
                        parsed.record_name_lookup(word.rest, word.start, TokenKind::Undefined);
                        return (word.rest.len(), TokenKind::Function(id));
                    }
                    let (length, kind) = expression_word(parsed, state, source, word);
                    if length < word.rest.len() && !S::IS_CHUNK {
                        lints.record_split(word, length);
                    }
                    parsed.record_prefix_lookup(word.rest, word.start, length, kind);
                    if state.is_of_space && matches!(kind, TokenKind::Variable(_)) {
                        // A declared name of the same letters would take precedence.
                        let name = &word.rest[..length];
                        parsed.record_name_lookup(name, word.start, TokenKind::Undefined);
                    }
                    (length, kind)
                }
                Mode::Name => {
                    let (length, kind) = whole_word(parsed, word);
                    parsed.record_name_lookup(word.rest, word.start, kind);
                    (length, kind)
                }
                Mode::Item => {
                    let parameter = state.parameter_trie.get(word.rest);
                    match (parameter, AttributeWord::from_text(word.rest)) {
                        (Some(parameter), _) => (word.rest.len(), TokenKind::Variable(parameter)),
                        (None, Some(known)) => (word.rest.len(), TokenKind::Attribute(known)),
                        (None, None) => declaring_or(word, TokenKind::Undefined),
                    }
                }
                Mode::Word => declaring_or(word, TokenKind::Word),
                Mode::ParameterOf(function) => {
                    match parsed.symbol(function).longest_parameter(word.rest) {
                        Some((length, parameter)) => (length, TokenKind::Variable(parameter)),
                        None => declaring_or(word, TokenKind::Undefined),
                    }
                }
            }
        });
        match lexeme.token.kind {
            TokenKind::Bar | TokenKind::Ampersand | TokenKind::Backslash if !is_in_set => {
                let sign = lexeme.token.span.text(source).chars().next();
                Lexeme {
                    token: Token {
                        kind: TokenKind::Error,
                        ..lexeme.token
                    },
                    fault: sign.map(Fault::Character),
                }
            }
            _ => lexeme,
        }
    }

    /// Returns true if the current token is the name of a value.
    pub(super) fn is_value(&self) -> bool {
        self.current.kind.is_value()
    }

    /// Reads the name that a declaration introduces. A name that is not free is reported and skipped.
    pub(super) fn new_name(&mut self, keyword: DeclarationKeyword) -> Result<(), Stop> {
        let free = self.free_name(&format!("a name after `{}`", keyword.text()))?;
        self.state.name = self.current.span.text(self.source);
        self.state.name_span = self.current.span;
        self.state.name_is_free = free;
        self.advance(Mode::Expression);
        Ok(())
    }

    /// The name of a parameter as an expected item in a sentence.
    const PARAMETER: &'static str = "the name of a parameter";

    /// Reads a name in a parameter list. A name that is not free is reported; it keeps its index in the list.
    pub(super) fn new_parameter(&mut self) -> Result<(), Stop> {
        let mut free = self.free_name(Self::PARAMETER)?;
        let span = self.current.span;
        let name = span.text(self.source);
        if free && name == self.state.name {
            let message = format!("{} is the name of the function itself", quote(name));
            let diagnostic = self
                .here(codes::NAME_TAKEN, message)
                .with_hint("a parameter may not shadow another name")
                .with_related(self.state.name_span, "it is named here");
            self.report(diagnostic);
            free = false;
        }
        let position = self.state.parameters.len() as u32;
        match self.state.parameter_trie.get(name) {
            Some(earlier) => {
                let message = format!("the parameter {} is listed twice", quote(name));
                let mut diagnostic = self.here(codes::DUPLICATE_PARAMETER, message);
                if let Some(earlier) = self.state.parameters.get(earlier as usize) {
                    diagnostic = diagnostic.with_related(earlier.span, "the first one is here");
                }
                self.report(diagnostic);
            }
            None => {
                // After `f_` a parameter that is not free is recognised, but not in the body.
                let _ = self.state.parameter_trie.insert(name, position);
            }
        }
        if !free {
            self.state.faulty = true;
            // In the body it is read with its earlier meaning: errors there are consequences.
            self.state.rejected = true;
        }
        let name = name.to_owned();
        self.state.parameters.push(Parameter { name, span });
        self.advance(Mode::Expression);
        Ok(())
    }

    /// Returns true if the current token, read by [`Mode::Name`], is a free name. Otherwise reports it.
    fn free_name(&mut self, what: &str) -> Result<bool, Stop> {
        let name = self.current.span.text(self.source);
        let diagnostic = match self.current.kind {
            TokenKind::Undefined if name.len() <= MAX_NAME_LENGTH => return Ok(true),
            TokenKind::Undefined => {
                let message = format!("the name {} is too long", quote(name));
                let hint = format!("a name has at most {MAX_NAME_LENGTH} characters");
                self.here(codes::NAME_TOO_LONG, message).with_hint(hint)
            }
            TokenKind::Constant(id) | TokenKind::Function(id) => {
                let mut diagnostic = self.name_taken(id);
                if what == Self::PARAMETER {
                    let hint = "a parameter may not hide a name declared above: rename one of them";
                    diagnostic = diagnostic.with_hint(hint);
                }
                self.report_deferred(diagnostic, Deferred::Taken(id));
                return Ok(false);
            }
            TokenKind::Declare(_) if !self.is_followed_by_word() => {
                let message = format!("`{name}` is a keyword: it cannot be a name");
                self.here(codes::NAME_TAKEN, message)
                    .with_hint("choose another name")
            }
            TokenKind::Number(_) => {
                let diagnostic = self
                    .expected_diagnostic(what)
                    .with_hint("a name starts with a letter");
                return Err(self.reject(diagnostic));
            }
            found => {
                let mut diagnostic = self.expected_diagnostic(what);
                let is_function = self.state.keyword == Some(DeclarationKeyword::Function);
                diagnostic.hint = match self.state.keyword {
                    Some(keyword) if found == TokenKind::Equals && what != Self::PARAMETER => {
                        Some(format!("write `{} name = …`", keyword.text()))
                    }
                    _ if is_function
                        && found == TokenKind::ParenClose
                        && self.state.parameters.is_empty() =>
                    {
                        let hint = "a function has a parameter: use `define` for a constant";
                        Some(hint.to_owned())
                    }
                    _ => diagnostic.hint,
                };
                return Err(self.reject(diagnostic));
            }
        };
        self.report(diagnostic);
        Ok(false)
    }

    /// Returns the error of a name that is not free. For a name that the text declares, [`Deferred::Taken`] adds the
    /// location of its declaration.
    fn name_taken(&self, id: SymbolId) -> Diagnostic {
        let symbol = self.parsed.symbol(id);
        let kind = match symbol.kind {
            SymbolKind::Constant => "constant",
            SymbolKind::Function => "function",
        };
        let message = format!("{} is already a builtin {kind}", quote(&symbol.name));
        self.here(codes::NAME_TAKEN, message)
            .with_hint("choose another name: the earlier meaning stays")
    }

    /// Returns true if a word follows the current token.
    pub(super) fn is_followed_by_word(&self) -> bool {
        self.following(self.current.span.end)
            .is_some_and(|byte| byte.is_ascii_alphabetic())
    }

    /// Returns the first byte at or after `offset` that is not white space.
    pub(super) fn following(&self, offset: u32) -> Option<u8> {
        let mut rest = self.source.as_bytes()[offset as usize..].iter().copied();
        rest.find(|byte| !matches!(byte, b' ' | b'\t' | b'\r' | b'\n'))
    }

    /// Reports an undefined word in place of an operand and reads it as one, so that the following text is still read.
    /// Returns its span.
    #[cold]
    pub(super) fn undefined_operand(&mut self) -> Span {
        let span = self.current.span;
        self.report_undefined(true);
        self.state.faulty = true;
        self.state.silent = true;
        self.advance(Mode::Expression);
        // If it had been a function, it might have been differentiated.
        loop {
            match self.current.kind {
                TokenKind::Prime => self.advance(Mode::Expression),
                TokenKind::Underscore => {
                    self.advance(Mode::Name);
                    if matches!(
                        self.current.kind,
                        TokenKind::Undefined
                            | TokenKind::Constant(_)
                            | TokenKind::Function(_)
                            | TokenKind::Number(_)
                    ) {
                        self.advance(Mode::Expression);
                    }
                }
                _ => break,
            }
        }
        self.flagged = true;
        span.to(self.previous.span)
    }

    /// Reports and skips an undefined word in place of the name of a surface or a solid.
    #[cold]
    pub(super) fn undefined_function(&mut self) {
        self.report_undefined(false);
        self.state.faulty = true;
        self.state.silent = true;
        self.advance(Mode::Expression);
        self.flagged = true;
    }

    /// Returns the entry of a word of another notation. `is_applied` is true if a bracket follows.
    pub(super) fn foreign_word(&self, word: &str, is_applied: bool) -> Option<ForeignWord> {
        let mut all = self.parsed.words()?.foreign.iter();
        let fits = |it: &&ForeignWord| {
            it.word == word && it.is_applied.is_none_or(|applied| applied == is_applied)
        };
        all.find(fits).copied()
    }

    /// Reports an undefined word; `is_operand` is false in place of the name of a surface or a solid.
    fn report_undefined(&mut self, is_operand: bool) {
        let span = self.current.span;
        let word = span.text(self.source);
        let known = &self.state.undefined;
        if self.state.quiet || known.len() >= MAX_UNDEFINED || known.contains(&word) {
            return;
        }
        if self.is_behind_backslash(span) {
            return;
        }
        if let Some(diagnostic) = self.word_of_sign(span) {
            self.reject(diagnostic);
            return;
        }
        if self.is_differential(word) && known.iter().any(|word| self.is_differential(word)) {
            return;
        }
        let whole_span = self.lexer.word();
        let differentials = self.quotient_of_differentials(whole_span);
        if let Some(numerator) = differentials
            && numerator != whole_span.text(self.source)
            && known.contains(&numerator)
        {
            return;
        }
        self.state.undefined.push(word);
        let whole = whole_span.text(self.source);
        let mut message = format!("{} is not defined", quote(word));
        if whole.len() > word.len() {
            let front = Span::new(whole_span.start, span.start).text(self.source);
            let reading = quote(&format!("{front} {word}"));
            message.push_str(&format!(": {} is read as {reading}", quote(whole)));
        }
        let mut diagnostic = self.here(codes::UNDEFINED_NAME, message);
        let is_applied = self.following(whole_span.end) == Some(b'(');
        let equivalent = [whole, word]
            .into_iter()
            .find_map(|word| Some((word.len() as u32, self.foreign_word(word, is_applied)?)))
            .filter(|(_, foreign)| is_operand || foreign.is_of_sets);
        let mut own = self.undefined_hint(whole, word);
        if own.is_none() && differentials.is_some() {
            own = self.foreign_word("dx", false).map(|it| it.hint.to_owned());
        }
        let form = self
            .field_form()
            .or_else(|| self.without_module(word == whole));
        if own.as_deref() == Some(COMMENT)
            && let Some(sign) = self.comment_before(span)
        {
            let line = self.source[span.end as usize..].lines().next();
            let is_line = sign.text(self.source) == "//";
            // Otherwise the rest of the declaration follows it.
            if is_line && !line.is_some_and(|line| line.contains(';')) {
                diagnostic = diagnostic.with_fix(Fix::change(sign, "#", true));
            }
        }
        if let Some(fix) = self.comma_before_attribute(whole_span) {
            diagnostic = diagnostic.with_fix(fix);
        }
        if let Some((hint, fix)) = form.filter(|_| own.is_none()) {
            own = Some(hint);
            diagnostic = diagnostic.with_fix(fix);
        }
        let replacement = equivalent
            .filter(|_| own.is_none())
            .and_then(|(length, it)| Some((length, it.replacement?)));
        let hint = own.or_else(|| Some(equivalent?.1.hint.to_owned()));
        if matches!(hint.as_deref(), Some(NO_CONDITIONS | COMMENT)) {
            // What follows `if` or `//` is no expression here.
            self.state.quiet = true;
            self.state.rejected = true;
        }
        let undefined = Undefined {
            whole: whole.to_owned(),
            word: word.to_owned(),
            offset: span.start,
            hint,
            replacement,
            parameters: (self.state.in_body).then(|| self.state.parameter_trie.clone()),
        };
        self.report_deferred(diagnostic, Deferred::Undefined(undefined));
    }

    /// Returns the place of `//` or `/*`, if it precedes a word.
    fn comment_before(&self, word: Span) -> Option<Span> {
        let front = self.source[..word.start as usize].trim_end();
        let opens = front.ends_with("//") || front.ends_with("/*");
        let end = front.len() as u32;
        opens.then(|| Span::new(end - 2, end))
    }

    /// Returns true after the backslash of a command of LaTeX, which has been reported.
    fn is_behind_backslash(&self, word: Span) -> bool {
        let before = &self.source[..word.start as usize];
        before.ends_with('\\') && !self.state.in_set
    }

    /// Returns the error of an undefined word in place of a sign: `param r = 1 in [0, 2];`, `vector v = d at p;`.
    fn word_of_sign(&self, word: Span) -> Option<Diagnostic> {
        let next = self.following(word.end)?;
        let (sign, what) = match (self.state.keyword?, word.text(self.source)) {
            (DeclarationKeyword::Param, "in") if matches!(next, b'[' | b'(') => {
                (":", "`:` and an interval after the param's value")
            }
            (DeclarationKeyword::Vector, "at") => ("@", "`@` and the vector's origin"),
            (DeclarationKeyword::Camera, "at") => ("@", "`@` and the camera's position"),
            _ => return None,
        };
        let diagnostic = self.expected_diagnostic(what);
        Some(
            diagnostic
                .with_hint(format!("write `{sign}`"))
                .with_fix(Fix::change(word, sign, true).with_all()),
        )
    }

    /// Returns the fix of a missing comma, if a word is an attribute before its `:`.
    fn comma_before_attribute(&self, word: Span) -> Option<Fix> {
        let is_attribute = AttributeWord::from_text(word.text(self.source)).is_some();
        let is_stated = is_attribute && self.following(word.end) == Some(b':');
        let end = self.source[..word.start as usize].trim_end().len() as u32;
        is_stated.then(|| Fix::insert("Insert `,`", end, ",").with_all())
    }

    /// Returns, as a hint, the name without the module that the current token, an undefined word, stands for: `math.pi`.
    fn without_module(&self, is_whole: bool) -> Option<(String, Fix)> {
        let module = self.current.span;
        let behind = self.source[module.end as usize..].strip_prefix('.')?;
        let end = behind.find(|c: char| !c.is_ascii_alphanumeric());
        let name = &behind[..end.unwrap_or(behind.len())];
        // `.x` is a component.
        let is_name = name.len() > 1 && name.starts_with(|c: char| c.is_ascii_alphabetic());
        let place = Span::new(module.start, module.end + 1);
        let hint = format!("names have no module before them: write {}", quote(name));
        (is_whole && is_name)
            .then(|| (hint, Fix::remove(place, place.text(self.source)).with_all()))
    }

    /// Returns true for `dx` in the value of a metric with the parameter x.
    fn is_differential(&self, word: &str) -> bool {
        let is_metric = self.state.keyword == Some(DeclarationKeyword::Metric);
        let parameters = &self.state.parameter_trie;
        let rest = word
            .strip_prefix('d')
            .filter(|_| is_metric && self.state.in_body);
        rest.is_some_and(|rest| parameters.longest_prefix(rest).is_some())
    }

    /// Returns `df` where the word at a place is a part of `df/du`, a derivative in another notation: `u` is a parameter, or `du` a
    /// known word of that notation.
    fn quotient_of_differentials(&self, place: Span) -> Option<&'s str> {
        let source = self.source;
        let is_letter = |c: char| c.is_ascii_alphanumeric();
        let word = place.text(source);
        let behind = source[place.end as usize..].trim_start_matches(' ');
        let (numerator, denominator) = match behind.strip_prefix('/') {
            Some(behind) => {
                let behind = behind.trim_start_matches(' ');
                let end = behind.find(|c| !is_letter(c)).unwrap_or(behind.len());
                (word, &behind[..end])
            }
            None => {
                let before = source[..place.start as usize].trim_end_matches(' ');
                let before = before.strip_suffix('/')?.trim_end_matches(' ');
                let start = before.trim_end_matches(is_letter).len();
                (&before[start..], word)
            }
        };
        let variable = denominator.strip_prefix('d')?;
        let derivative = self.foreign_word("dx", false)?.hint;
        let known = self.foreign_word(denominator, false);
        let is_known = self.state.parameter_trie.get(variable).is_some()
            || known.is_some_and(|it| it.hint == derivative);
        let is_quotient = is_known && numerator.starts_with('d');
        is_quotient.then_some(numerator)
    }

    /// Returns a hint with the form of a metric's value.
    pub(super) fn metric_form(&self) -> String {
        let names: Vec<&str> = self.state.parameters.iter().map(|it| &*it.name).collect();
        let [x, y] = names[..].first_chunk().copied().unwrap_or(["u", "v"]);
        format!("a metric's value is `(E, F, G)` for E d{x}² + 2F d{x} d{y} + G d{y}²")
    }

    /// Returns the hint for an undefined word that is not declared below, as far as it follows from the declaration
    /// alone.
    fn undefined_hint(&self, whole: &str, word: &str) -> Option<String> {
        if word == whole && self.comment_before(self.current.span).is_some() {
            return Some(COMMENT.to_owned());
        }
        let name = self.state.name;
        if !name.is_empty() && (word == name || whole == name) {
            return Some(if self.state.parameters.is_empty() {
                format!("{} is defined only after its `;`", quote(name))
            } else {
                format!(
                    "a function may not use itself: {} is defined only after its `;`",
                    quote(name)
                )
            });
        }
        if !self.state.in_body && self.state.parameter_trie.get(word).is_some() {
            let name = quote(word);
            return Some(
                if self.state.keyword == Some(DeclarationKeyword::Geodesic) {
                    format!("{name} is the length along the geodesic: nothing else depends on it")
                } else {
                    format!("{name} is a parameter: an interval's ends are constants")
                },
            );
        }
        if self.is_differential(word) {
            return Some(self.metric_form());
        }
        match word {
            "max" if self.state.in_set => return Some("the points of both are `a & b`".to_owned()),
            "min" if self.state.in_set => {
                return Some("the points of either are `a | b`".to_owned());
            }
            _ => {}
        }
        let map = MapWord::ALL
            .into_iter()
            .find(|map| whole.starts_with(map.text()));
        if let Some(map) = map.filter(|_| self.state.in_set) {
            let form = match map {
                MapWord::Scale => "scale 2",
                MapWord::Rotate => "rotate (0, 0, pi)",
            };
            return Some(format!(
                "a map is written alone after an `@`: write {}",
                quote(&format!("@ {form}"))
            ));
        }
        if AttributeWord::from_text(whole).is_some()
            && self.following(self.lexer.word().end) == Some(b':')
        {
            return Some(format!(
                "an attribute follows a `,`: write {}",
                quote(&format!(", {whole} : …"))
            ));
        }
        let after_number = matches!(self.previous.kind, TokenKind::Number(_));
        let touches = self.previous.span.end == self.current.span.start;
        let exponent = word
            .strip_prefix('E')
            .is_some_and(|rest| rest.is_empty() || rest.bytes().all(|byte| byte.is_ascii_digit()));
        if after_number && touches && exponent {
            return Some("an exponent is written with a lower-case `e`".to_owned());
        }
        if word == whole
            && self.is_followed_by_word()
            && let Some(declaring) = nearest_keyword(word)
        {
            return Some(format!("did you mean `{}`, after a `;`?", declaring.text()));
        }
        None
    }

    /// Returns the parameters between braces that open at the current token, as in `f_{xy}`: the span of the braces, and their
    /// equivalent here.
    fn parameters_in_braces(&self, function: &Symbol) -> Option<(Span, String)> {
        let start = self.current.span.start;
        let (inside, length) = in_braces(&self.source[start as usize..])?;
        let letters = inside.replace([' ', ','], "");
        let names = function.split_parameters(&letters)?;
        let place = Span::new(start, start + length);
        (!names.is_empty()).then(|| (place, names.join("_")))
    }

    /// Reports the current token, which follows `f_` and is not a parameter of `f`, and skips it if it is a word.
    #[cold]
    pub(super) fn no_such_parameter(&mut self, function: SymbolId) -> Result<(), Stop> {
        let symbol = self.parsed.symbol(function);
        let name = &symbol.name;
        let is_word = self.current.kind == TokenKind::Undefined;
        let found = self.found();
        let diagnostic = if symbol.keyword.is_none() {
            let message = format!("a builtin function has no named parameters, found {found}");
            let digits = self.current.span.text(self.source);
            // `log_2 8`: a logarithm is explained for base 10.
            let logarithm = self
                .foreign_word(&format!("{name}10"), true)
                .filter(|_| matches!(self.current.kind, TokenKind::Number(_)));
            let hint = match logarithm {
                Some(known) => known.hint.replace("10", digits),
                None => format!("use `{name}'` for the derivative"),
            };
            self.here(codes::NO_PARAMETERS, message).with_hint(hint)
        } else {
            let names = list(&symbol.parameters);
            let message = match is_word {
                true => format!("{found} is not a parameter of `{name}`{names}"),
                false => format!("expected a parameter of `{name}` after `_`, found {found}"),
            };
            let mut diagnostic = self.here(codes::UNKNOWN_PARAMETER, message);
            if let TokenKind::Number(_) = self.current.kind {
                let hint = format!("a component of its value is written `({name}(…))_1`");
                diagnostic = diagnostic.with_hint(hint);
            }
            if let Some((place, written)) = self.parameters_in_braces(symbol) {
                diagnostic = diagnostic
                    .with_hint(format!("write `{name}_{written}`, without braces"))
                    .with_fix(Fix::change(place, &written, true).with_all());
            }
            diagnostic
        };
        let deferred = Deferred::Declared(function);
        if !is_word {
            // As in `r_0(1)`, where the declaration of `r_0` has been reported.
            self.flagged |= symbol.faulty;
            return Err(self.reject_deferred(diagnostic, Some(deferred)));
        }
        // A function whose own declaration failed may lack parameters.
        if !symbol.faulty {
            self.report_deferred(diagnostic, deferred);
        }
        self.state.faulty = true;
        self.state.silent = true;
        self.advance(Mode::Expression);
        Ok(())
    }
}

/// Returns the words and numbers between braces at the start of a text, and the length with the braces.
pub(super) fn in_braces(text: &str) -> Option<(&str, u32)> {
    let inside = text.strip_prefix('{')?;
    let end = inside.find(|c: char| !c.is_ascii_alphanumeric() && !" ,".contains(c))?;
    let is_closed = inside[end..].starts_with('}');
    is_closed.then(|| (inside[..end].trim(), end as u32 + 2))
}

/// Returns a list of a function's parameters for the end of a sentence.
pub(super) fn list(parameters: &[Parameter]) -> String {
    const SHOWN: usize = 8;
    let names: Vec<String> = parameters
        .iter()
        .take(SHOWN)
        .map(|p| quote(&p.name))
        .collect();
    match names.as_slice() {
        [] => ", which has none".to_owned(),
        [name] => format!(": its parameter is {name}"),
        _ if parameters.len() > SHOWN => format!(": its parameters are {}, …", names.join(", ")),
        [front @ .., last] => format!(": its parameters are {} and {last}", front.join(", ")),
    }
}

/// Returns the keyword that a word is where a declaration may begin, among the keywords that are ordinary words
/// elsewhere. It is a keyword only if another word follows.
#[inline]
fn soft_keyword(source: &str, mode: Mode, word: Word<'_>) -> Option<DeclarationKeyword> {
    let keyword = DeclarationKeyword::from_text(word.rest)?;
    let is_candidate = keyword.is_soft() && word.is_whole();
    let counts = is_candidate
        && match mode {
            Mode::Start => true,
            Mode::ParameterOf(_) | Mode::Item => false,
            _ => is_before_word(source, word),
        };
    counts.then_some(keyword)
}

/// Returns true if a word follows this one.
fn is_before_word(source: &str, word: Word<'_>) -> bool {
    let behind = &source[word.start as usize + word.rest.len()..];
    let behind = behind.trim_start_matches([' ', '\t', '\r', '\n']);
    behind.starts_with(|c: char| c.is_ascii_alphabetic())
}

/// Returns the keyword that a word is in any context.
fn hard_keyword(word: Word<'_>) -> Option<DeclarationKeyword> {
    let keyword = DeclarationKeyword::from_text(word.rest)?;
    (word.is_whole() && !keyword.is_soft()).then_some(keyword)
}

fn expression_word(
    parsed: &impl NameScope,
    state: &DeclarationState<'_>,
    source: &str,
    word: Word<'_>,
) -> (usize, TokenKind) {
    if let Some(declaring) = hard_keyword(word) {
        let kind = match state.parameter_trie.get(word.rest) {
            // It has been reported in the list of parameters.
            Some(parameter) if state.in_body && !is_before_word(source, word) => {
                TokenKind::Variable(parameter)
            }
            _ => TokenKind::Declare(declaring),
        };
        return (word.rest.len(), kind);
    }
    let symbol = parsed.longest_prefix(word.rest);
    if state.in_body
        && let Some((length, parameter)) = state.parameter_trie.longest_prefix(word.rest)
        && symbol.is_none_or(|(symbol_length, _)| symbol_length < length)
    {
        return (length, TokenKind::Variable(parameter));
    }
    match symbol {
        Some((length, id)) => (length, meaning(parsed, id)),
        None => (word.rest.len(), TokenKind::Undefined),
    }
}

/// Returns the builtin function that the rest of a word names, among those that are words of their own only before a bracket.
#[inline]
fn weak_function(
    parsed: &impl NameScope,
    state: &DeclarationState<'_>,
    source: &str,
    word: Word<'_>,
) -> Option<SymbolId> {
    let id = parsed.words()?.weak(word.rest)?;
    let is_parameter = state.in_body && state.parameter_trie.get(word.rest).is_some();
    let is_taken = is_parameter || parsed.get(word.rest).is_some();
    let end = word.start as usize + word.rest.len();
    (!is_taken && is_before_bracket(&source[end..])).then_some(id)
}

/// Returns true if the first token of a text is an opening bracket.
fn is_before_bracket(mut text: &str) -> bool {
    loop {
        text = text.trim_start_matches([' ', '\t', '\r', '\n']);
        if !text.starts_with('#') {
            return text.starts_with(['(', '[', '{']);
        }
        text = text.split_once('\n').map_or("", |(_, rest)| rest);
    }
}

fn whole_word(parsed: &impl NameScope, word: Word<'_>) -> (usize, TokenKind) {
    match parsed.get(word.rest) {
        Some(id) => (word.rest.len(), meaning(parsed, id)),
        None => declaring_or(word, TokenKind::Undefined),
    }
}

fn declaring_or(word: Word<'_>, otherwise: TokenKind) -> (usize, TokenKind) {
    let kind = hard_keyword(word).map_or(otherwise, TokenKind::Declare);
    (word.rest.len(), kind)
}

pub(super) fn meaning(parsed: &impl NameScope, id: SymbolId) -> TokenKind {
    match parsed.symbol(id).kind {
        SymbolKind::Constant => TokenKind::Constant(id),
        SymbolKind::Function => TokenKind::Function(id),
    }
}
