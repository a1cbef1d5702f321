//! Declarations: `DECL` and everything below it except expressions.

use super::intervals::IntervalOwner;
use super::messages::{lowercase_keyword, quote};
use super::names::{self, Mode};
use super::suggestions::nearest_keyword;
use super::{DeclarationState, Parser, Stop, foreign};
use crate::diagnostic::{Diagnostic, Fix};
use crate::geotrace::actions::{Actions, Declaration, Operator};
use crate::geotrace::codes;
use crate::geotrace::declarations::{COORDINATES, DeclarationKeyword, Syntax};
use crate::geotrace::symbols::{NameScope, Symbol};
use crate::geotrace::token::TokenKind;
use crate::span::Span;
use crate::symbol::SymbolId;

/// A geodesic as written.
const GEODESIC: &str = "geodesic g(t) : s = (a, b) @ (u, v), t : [0, length];";

/// Returns the keyword that begins a word, if the rest of the word may be a name.
fn joined_keyword(word: &str) -> Option<DeclarationKeyword> {
    let mut all = DeclarationKeyword::ALL.into_iter();
    all.find(|keyword| {
        let rest = word.strip_prefix(keyword.text());
        !keyword.is_soft() && rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_alphabetic()))
    })
}

impl<A: Actions, S: NameScope> Parser<'_, '_, A, S> {
    /// Reads a declaration whose keyword is the current token. This depends only on the names defined above it, and
    /// leaves the parser at the token after it.
    pub(super) fn declaration(&mut self, keyword: DeclarationKeyword) {
        self.state = DeclarationState::default();
        self.declaration_with_keyword(keyword);
    }

    /// Reads a declaration whose keyword is the current token, or a misspelt word in its place.
    fn declaration_with_keyword(&mut self, keyword: DeclarationKeyword) {
        let start = self.current.span;
        self.accept();
        self.actions.act_declaration_start(keyword, start);
        self.fetch(Mode::Name);
        self.declaration_from_name(keyword, start);
    }

    /// Reads a declaration whose first token is not a keyword. Guesses the keyword from a misspelt word, or from the token
    /// after the name, so that the name is defined and its uses are not reported as well.
    #[cold]
    pub(super) fn declaration_without_keyword(&mut self) {
        self.state = DeclarationState::default();
        let word = self.lexer.word();
        let is_word = word.start == self.current.span.start && word.end > word.start;
        let text = if is_word { word.text(self.source) } else { "" };
        let following = self.following(word.end);
        let guess = nearest_keyword(text)
            .or_else(|| foreign::keyword(text, self.is_head(word.end)))
            .filter(|_| is_word && following.is_some_and(|byte| byte.is_ascii_alphabetic()));
        let is_free = is_word && self.parsed.get(text).is_none();
        let joined = is_free
            .then(|| joined_keyword(text))
            .flatten()
            .filter(|_| matches!(following, Some(b'(' | b'=' | b':')));
        if is_word {
            let found = self
                .parsed
                .get(text)
                .map(|id| names::meaning(&self.parsed, id));
            (self.parsed).record_name_lookup(
                text,
                word.start,
                found.unwrap_or(TokenKind::Undefined),
            );
        }
        if is_word && (guess.is_some() || is_free) {
            // Inspect the whole word, even if tokens were split off it. Earlier reports still count.
            let flagged = self.flagged;
            self.lexer.rewind(word.start);
            self.fetch(Mode::Name);
            self.flagged |= flagged;
        }
        let unworded = match following {
            _ if !is_free || foreign::style(text).is_some() => None,
            // `Curve(cos(t), sin(t), t)` of another language has no name and no parameters.
            Some(b'(') if lowercase_keyword(text).is_some() => None,
            Some(b'=') => Some(DeclarationKeyword::Define),
            Some(b':')
                if self.source[word.end as usize..]
                    .trim_start()
                    .starts_with(":=") =>
            {
                Some(DeclarationKeyword::Define)
            }
            Some(b'(') => Some(DeclarationKeyword::Function),
            _ => None,
        };
        if let Some(keyword) = joined {
            let start = Span::new(word.start, word.start + keyword.text().len() as u32);
            self.reject_joined(keyword, Span::new(start.end, word.end));
            self.actions.act_declaration_start(keyword, start);
            self.lexer.rewind(start.end);
            self.fetch(Mode::Name);
            self.declaration_from_name(keyword, start);
            return;
        }
        self.reject_opening(text, guess, unworded);
        match (guess, unworded) {
            (Some(word), _) => self.declaration_with_keyword(word),
            (None, Some(word)) => {
                let start = self.current.span;
                self.actions.act_declaration_start(word, start);
                self.declaration_from_name(word, start);
            }
            (None, None) => {
                self.recover();
                if self.current.kind == TokenKind::Semicolon {
                    self.accept();
                    // What follows is read as at the start of a text.
                    self.state = DeclarationState::default();
                    self.fetch(Mode::Start);
                }
            }
        }
    }

    /// Rejects a keyword without a space before the name.
    fn reject_joined(&mut self, keyword: DeclarationKeyword, name: Span) {
        let message = format!("expected a declaration, found {}", self.found());
        let form = quote(&format!("{} {}", keyword.text(), name.text(self.source)));
        let diagnostic = self
            .here(codes::EXPECTED_DECLARATION, message)
            .with_hint(format!("write {form}"))
            .with_fix(Fix::insert("Insert a space", name.start, " ").with_all());
        self.reject(diagnostic);
        // What follows is read as a declaration.
        self.state = DeclarationState::default();
    }

    /// Returns true if a name and an opening bracket follow at an offset.
    fn is_head(&self, offset: u32) -> bool {
        let rest = self.source[offset as usize..].trim_start();
        let name = rest.trim_start_matches(|c: char| c.is_ascii_alphanumeric());
        name.len() < rest.len() && name.trim_start().starts_with('(')
    }

    /// Reads the rest of a declaration, from its name (the current token) through its `;`.
    fn declaration_from_name(&mut self, keyword: DeclarationKeyword, start: Span) {
        if self.decl(keyword).is_err() {
            self.state.faulty = true;
            self.recover();
        }
        self.state.in_body = false;
        let ends = self.current.kind == TokenKind::Semicolon;
        let last = if ends { self.current } else { self.previous };
        // The name is defined before the parser reads the token after the `;`.
        let symbol = self.define(keyword);
        if ends {
            self.accept();
        }
        let parameters = match symbol {
            Some(id) => &self.parsed.symbol(id).parameters,
            None => &self.state.parameters,
        };
        self.actions.act_declaration(&Declaration {
            keyword,
            span: start.to(last.span),
            symbol,
            name: self.state.name,
            name_span: self.state.name_span,
            parameters,
            faulty: self.state.faulty,
        });
        self.state = DeclarationState::default();
        if ends {
            self.fetch(Mode::Start);
        }
    }

    /// Defines the name that was read, if it is free.
    fn define(&mut self, keyword: DeclarationKeyword) -> Option<SymbolId> {
        if !self.state.name_is_free {
            return None;
        }
        Some(self.parsed.define(Symbol::declared(
            self.state.name,
            keyword,
            self.state.name_span,
            std::mem::take(&mut self.state.parameters),
            std::mem::take(&mut self.state.parameter_trie),
            self.state.faulty,
        )))
    }

    /// `DECL` after its keyword, up to its `;`.
    fn decl(&mut self, keyword: DeclarationKeyword) -> Result<(), Stop> {
        self.state.keyword = Some(keyword);
        match keyword.row().syntax {
            Syntax::Slider => {
                self.new_name(keyword)?;
                self.opening(keyword)?;
                self.intervals(IntervalOwner::Param)?;
            }
            Syntax::Grid => {
                self.new_name(keyword)?;
                self.after_name(keyword, TokenKind::Colon, "`:`")?;
                self.intervals(IntervalOwner::Grid)?;
            }
            Syntax::Value => {
                self.new_name(keyword)?;
                self.after_name(keyword, TokenKind::Equals, "`=`")?;
                self.expression()?;
                if keyword != DeclarationKeyword::Define {
                    self.attrs()?;
                }
            }
            Syntax::Anchored => {
                self.new_name(keyword)?;
                self.after_name(keyword, TokenKind::Equals, "`=`")?;
                self.expression()?;
                let (what, form) = match keyword {
                    DeclarationKeyword::Camera => (
                        "the camera's position",
                        "camera eye = direction @ position;",
                    ),
                    _ => ("the vector's origin", "vector v = direction @ origin;"),
                };
                self.origin(what, form)?;
                self.attrs()?;
            }
            Syntax::Function => self.fdecl(keyword)?,
            Syntax::Parametrized => {
                self.fdecl(keyword)?;
                self.domain_items()?;
            }
            Syntax::Solid => {
                self.state.is_of_space = true;
                self.new_name(keyword)?;
                match self.current.kind {
                    TokenKind::ParenOpen => self.list_and_body()?,
                    _ => self.set_body(keyword)?,
                }
                self.attrs()?;
            }
            Syntax::Light => {
                self.new_name(keyword)?;
                self.after_name(keyword, TokenKind::Equals, "`=`")?;
                self.light()?;
                self.attrs()?;
            }
            Syntax::Background => {
                self.new_name(keyword)?;
                match self.current.kind {
                    TokenKind::ParenOpen => self.list_and_body()?,
                    _ => {
                        self.after_name(keyword, TokenKind::Equals, "`=`")?;
                        self.expression()?;
                    }
                }
                self.attrs()?;
            }
            Syntax::InSurface => {
                self.head(keyword)?;
                self.surface()?;
                let place = self.expression()?;
                if self.current.kind == TokenKind::Comma {
                    self.reject_loose_place(place)?;
                } else {
                    let what =
                        "the parameters where it starts, or `,` and an interval after two points";
                    self.origin(what, GEODESIC)?;
                }
                self.domain_items()?;
            }
        }
        match self.current.kind {
            TokenKind::Semicolon => Ok(()),
            _ => Err(self.expected_end(keyword)),
        }
    }

    /// `OPENING ":"` of a param: its initial value, if it has one.
    fn opening(&mut self, keyword: DeclarationKeyword) -> Result<(), Stop> {
        if self.current.kind != TokenKind::Equals {
            if self.current.kind == TokenKind::BracketOpen
                && let Some((place, found)) = self.bracketed_interval_at(self.current.span.start)
            {
                return Err(self.foreign_interval(place, &format!(": {}", found.written())));
            }
            return self.after_name(keyword, TokenKind::Colon, "`:`");
        }
        let equals = self.current.span.start;
        self.advance(Mode::Expression);
        let value = self.expression()?;
        if self.current.kind == TokenKind::Colon {
            self.advance(Mode::Expression);
            return Ok(());
        }
        let text = value.text(self.source);
        if let Some(interval) =
            foreign::interval(text).or_else(|| foreign::bracketed_interval(text))
        {
            let written = format!(": {}", interval.written());
            let place = Span::new(equals, value.end);
            return Err(self.foreign_interval(place, &written));
        }
        let opening = text.rfind('[').map(|at| value.start + at as u32);
        if let Some((place, found)) = opening.and_then(|at| self.bracketed_interval_at(at))
            && place.end == value.end
        {
            return Err(self.foreign_interval(place, &format!(": {}", found.written())));
        }
        let form = format!(
            "param {} = {} : [min, max];",
            self.state.name,
            value.text(self.source)
        );
        let diagnostic = self.expected_diagnostic("`:` and an interval after the param's value");
        let diagnostic = match self.is_decimal_comma() {
            true => self.with_decimal_point(diagnostic),
            false => diagnostic.with_hint(format!(
                "write {}, or use `define` for a constant",
                quote(&form)
            )),
        };
        Err(self.reject(diagnostic))
    }

    /// Returns the token that is required after the name.
    fn after_name(
        &mut self,
        keyword: DeclarationKeyword,
        wanted: TokenKind,
        what: &str,
    ) -> Result<(), Stop> {
        let expected = format!("{what} after the name");
        if wanted == TokenKind::Equals
            && let Some(sign) = self.foreign_equals()
        {
            return Err(self.reject_sign(&expected, sign, "="));
        }
        if self.current.kind == wanted {
            self.advance(Mode::Expression);
            return Ok(());
        }
        let name = quote(self.state.name);
        let mut diagnostic = self.expected_diagnostic(&format!("{what} after the name {name}"));
        let is_in = matches!(self.current.span.text(self.source), "in" | "∈");
        if wanted == TokenKind::Colon && is_in {
            let fix = Fix::change(self.current.span, ":", true);
            diagnostic = diagnostic.with_fix(fix.with_all());
        }
        let text = self.state.name;
        let hint = match self.current.kind {
            _ if wanted == TokenKind::Colon && is_in => Some("write `:`".to_owned()),
            TokenKind::Equals if keyword == DeclarationKeyword::Grid => Some(format!(
                "write `grid {text} : [a, b, n];`, or use `define` for a constant"
            )),
            TokenKind::Equals if keyword == DeclarationKeyword::Function => Some(format!(
                "write `function {text}(x) = …`, or use `define` for a constant"
            )),
            TokenKind::Comma => Some("each declaration has one name".to_owned()),
            TokenKind::At if keyword == DeclarationKeyword::Light => {
                let end = self.state.name_span.end;
                diagnostic = diagnostic.with_fix(Fix::insert("Insert `=`", end, " ="));
                Some("write `=` before the `@`".to_owned())
            }
            TokenKind::Undefined if let Some((hint, fix)) = self.parameter_without_bracket(wanted) => {
                diagnostic = diagnostic.with_fix(fix);
                Some(hint)
            }
            _ if keyword == DeclarationKeyword::Surface
                && matches!(
                    self.current.kind,
                    TokenKind::Caret
                        | TokenKind::Plus
                        | TokenKind::Minus
                        | TokenKind::Star
                        | TokenKind::Slash
                ) =>
            {
                Some("an equation describes the face of a solid: write `solid s(x, y, z) = x^2 + y^2 + z^2 - 1;`".to_owned())
            }
            TokenKind::Colon if keyword == DeclarationKeyword::Function => {
                Some(format!("write `function {text}(x) = …`"))
            }
            TokenKind::Colon if keyword == DeclarationKeyword::Curve => {
                Some(format!("write `curve {text}(t) = …`"))
            }
            TokenKind::Equals => Some(match keyword {
                DeclarationKeyword::Curve => format!("write `curve {text}(t) = …`"),
                DeclarationKeyword::Geodesic => format!("write `{GEODESIC}`"),
                keyword => format!("write `{} {text}(u, v) = …`", keyword.text()),
            }),
            TokenKind::Colon if keyword == DeclarationKeyword::Geodesic => {
                Some(format!("write `{GEODESIC}`"))
            }
            TokenKind::ParenOpen if !self.is_list_of_words() => {
                let end = self.state.name_span.end;
                let fix = Fix::insert(
                    &format!("Insert {what}"),
                    end,
                    &format!(" {}", what.trim_matches('`')),
                );
                diagnostic = diagnostic.with_fix(fix);
                Some(format!("write {what} after the name"))
            }
            TokenKind::ParenOpen => {
                let words = DeclarationKeyword::ALL
                    .into_iter()
                    .filter(|word| word.may_have_parameters());
                let words: Vec<_> = words
                    .map(|keyword| format!("`{}`", keyword.text()))
                    .collect();
                Some(format!("parameters belong to {}", words.join(", ")))
            }
            TokenKind::Colon => {
                Some("only `param` and `grid` have `:` after their name".to_owned())
            }
            TokenKind::Underscore
            | TokenKind::Prime
            | TokenKind::Undefined
            | TokenKind::Constant(_)
            | TokenKind::Function(_) => Some("a name is one word of letters and digits".to_owned()),
            _ => None,
        };
        let diagnostic = match hint {
            Some(hint) => diagnostic.with_hint(hint),
            None => diagnostic,
        };
        Err(self.reject(diagnostic))
    }

    /// Returns the form of a declaration whose only parameter, the current token, is not in brackets: `function f x = x^2`.
    fn parameter_without_bracket(&self, wanted: TokenKind) -> Option<(String, Fix)> {
        let word = self.lexer.word();
        let is_whole = word == self.current.span;
        let is_last = self.following(word.end) == Some(b'=');
        let parameter = word.text(self.source);
        let name = self.state.name_span;
        let form = quote(&format!("{}({parameter}) = …", self.state.name));
        let place = Span::new(name.end, word.end);
        let fix = Fix::change(place, &format!("({parameter})"), true);
        (wanted == TokenKind::ParenOpen && is_whole && is_last)
            .then(|| (format!("parameters are in brackets: write {form}"), fix))
    }

    /// Returns true if the bracket that opens here contains only words, as a list of parameters does.
    fn is_list_of_words(&self) -> bool {
        let behind = &self.source[self.current.span.end as usize..];
        let inside = behind.split([')', ';']).next().unwrap_or_default();
        inside.split(',').all(|word| {
            let word = word.trim();
            word.starts_with(|c: char| c.is_ascii_alphabetic())
                && word.bytes().all(|byte| byte.is_ascii_alphanumeric())
        })
    }

    /// `"@" EXPR` of a vector, a camera or a geodesic.
    fn origin(&mut self, what: &str, form: &str) -> Result<(), Stop> {
        if self.current.kind != TokenKind::At {
            let diagnostic = self
                .expected_diagnostic(&format!("`@` and {what}"))
                .with_hint(format!("write `{form}`"));
            return Err(self.reject(diagnostic));
        }
        self.advance(Mode::Expression);
        self.expression()?;
        Ok(())
    }

    /// `":" func "="` of a geodesic: the surface, metric or solid on which it is, as a whole word.
    fn surface(&mut self) -> Result<(), Stop> {
        if self.current.kind != TokenKind::Colon {
            let diagnostic = self
                .expected_diagnostic("`:` and a surface after the parameters")
                .with_hint(format!("write `{GEODESIC}`"));
            return Err(self.reject(diagnostic));
        }
        self.advance(Mode::Name);
        match self.current.kind {
            TokenKind::Function(id) => {
                self.operator(Operator::Function(id), self.current.span);
                self.advance(Mode::Expression);
            }
            TokenKind::Undefined => self.undefined_function(),
            _ => return Err(self.expected("the name of a surface, a metric or a solid after `:`")),
        }
        if self.current.kind != TokenKind::Equals {
            let diagnostic = self
                .expected_diagnostic("`=` and the geodesic's direction or its two points")
                .with_hint(format!("write `{GEODESIC}`"));
            return Err(self.reject(diagnostic));
        }
        self.advance(Mode::Expression);
        Ok(())
    }

    /// Rejects the second of two points of a geodesic, if it follows the current comma without sharing a bracket with the
    /// first: `(a, b), (c, d)`.
    fn reject_loose_place(&mut self, first: Span) -> Result<(), Stop> {
        let comma = self.current.span.end;
        let behind = &self.source[comma as usize..];
        let item = foreign::first_item(behind.trim_start());
        let is_pair = item.starts_with('(') && item.ends_with(')');
        if !is_pair || first.text(self.source).starts_with("((") {
            return Ok(());
        }
        let blanks = behind.len() - behind.trim_start().len();
        let place = first.to(Span::new(comma, comma + (blanks + item.len()) as u32));
        let message = "the two points of a geodesic are written in one bracket";
        Err(self.reject_unbracketed(place, message))
    }

    /// `SET` of a solid, and the `=` before it.
    fn set_body(&mut self, keyword: DeclarationKeyword) -> Result<(), Stop> {
        if self.current.kind != TokenKind::Equals {
            return self.after_name(keyword, TokenKind::Equals, "`=` or `(`");
        }
        self.state.in_set = true;
        self.advance(Mode::Name);
        self.set()?;
        self.state.in_set = false;
        for (name, position) in COORDINATES.into_iter().zip(0..) {
            // They are names, and the trie accepts all names.
            let _ = self.state.parameter_trie.insert(name, position);
        }
        Ok(())
    }

    /// `LIGHT = "@" EXPR | EXPR | EXPR "@" EXPR`
    fn light(&mut self) -> Result<(), Stop> {
        let start = self.current.span;
        if self.current.kind == TokenKind::At {
            self.advance(Mode::Expression);
            let place = self.expression()?;
            self.operator(Operator::Position, start.to(place));
            return Ok(());
        }
        self.expression()?;
        if self.current.kind == TokenKind::At {
            self.advance(Mode::Expression);
            self.expression()?;
        }
        Ok(())
    }

    /// `FDECL = HEAD "=" EXPR`
    fn fdecl(&mut self, keyword: DeclarationKeyword) -> Result<(), Stop> {
        self.head(keyword)?;
        self.body()
    }

    /// `"(" IDS ")" "=" EXPR`
    fn list_and_body(&mut self) -> Result<(), Stop> {
        let opening = self.current.span;
        self.advance(Mode::Name);
        self.ids(opening)?;
        self.body()
    }

    /// `"=" EXPR` over the parameters.
    fn body(&mut self) -> Result<(), Stop> {
        if let Some(sign) = self.foreign_equals() {
            return Err(self.reject_sign("`=` after the parameters", sign, "="));
        }
        if self.current.kind != TokenKind::Equals {
            let rest = &self.source[self.current.span.start as usize..];
            if let Some(sign) = ["->", ":"].into_iter().find(|it| rest.starts_with(it)) {
                return Err(self.reject_sign("`=` after the parameters", sign, "="));
            }
            return Err(self.expected("`=` after the parameters"));
        }
        self.state.in_body = true;
        self.advance(Mode::Expression);
        self.state.body = self.expression()?;
        self.state.in_body = false;
        Ok(())
    }

    /// Returns the sign `:=`, `==` or `=>` of other languages, if it begins at the current token.
    fn foreign_equals(&self) -> Option<&'static str> {
        let rest = &self.source[self.current.span.start as usize..];
        let signs = [":=", "==", "=>"];
        signs.into_iter().find(|sign| rest.starts_with(sign))
    }

    /// Rejects a sign of another language, with its equivalent.
    #[cold]
    fn reject_sign(&mut self, expected: &str, sign: &str, written: &str) -> Stop {
        let start = self.current.span.start;
        let place = Span::new(start, start + sign.len() as u32);
        let message = format!("expected {expected}, found `{sign}`");
        let diagnostic = Diagnostic::error(codes::UNEXPECTED_TOKEN, place, message)
            .with_hint(format!("write `{written}`"))
            .with_fix(Fix::change(place, written, true).with_all());
        let stop = self.reject(diagnostic);
        self.state.quiet = true;
        stop
    }

    /// `HEAD = id "(" IDS ")"`
    fn head(&mut self, keyword: DeclarationKeyword) -> Result<(), Stop> {
        self.new_name(keyword)?;
        let opening = self.current.span;
        if self.current.kind != TokenKind::ParenOpen {
            return self.after_name(keyword, TokenKind::ParenOpen, "`(`");
        }
        self.advance(Mode::Name);
        self.ids(opening)
    }

    /// `IDS = IDS "," id | id`, and the `)` after it.
    fn ids(&mut self, opening: Span) -> Result<(), Stop> {
        self.new_parameter()?;
        while self.is_separator() {
            self.advance(Mode::Name);
            self.new_parameter()?;
        }
        if self.current.kind != TokenKind::ParenClose {
            return Err(self.unclosed(opening, ')', "`,` or "));
        }
        self.advance(Mode::Expression);
        Ok(())
    }
}
