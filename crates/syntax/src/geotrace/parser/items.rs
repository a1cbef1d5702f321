//! The items after the commas of a declaration: `ATTRS`, `ITEMS` and everything below them except intervals.

use super::intervals::IntervalOwner;
use super::messages::quote;
use super::names::{Mode, list};
use super::{Parser, Stop, foreign};
use crate::diagnostic::{Diagnostic, Fix};
use crate::geotrace::actions::{Actions, StatedAttribute};
use crate::geotrace::attributes::{self, AttributeRow, AttributeType, AttributeWord};
use crate::geotrace::codes;
use crate::geotrace::cut::is_item;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::symbols::NameScope;
use crate::geotrace::token::TokenKind;
use crate::span::Span;
use crate::spelling::nearest;

impl<A: Actions, S: NameScope> Parser<'_, '_, A, S> {
    /// `"," ITEMS` of a declaration with a domain.
    pub(super) fn domain_items(&mut self) -> Result<(), Stop> {
        if self.current.kind != TokenKind::Comma {
            let ends = matches!(
                self.current.kind,
                TokenKind::Semicolon | TokenKind::Declare(_) | TokenKind::Eoi
            );
            if self.current.kind == TokenKind::Colon
                && matches!(self.previous.kind, TokenKind::Variable(_))
            {
                return Err(self.missing_comma(self.previous.span));
            }
            if !ends {
                return Err(self.expected("`,` and an interval for each parameter"));
            }
            if self.is_before_item() {
                return self.items();
            }
            let name = quote(self.state.name);
            let missing: Vec<String> = (self.state.parameters.iter())
                .take(2)
                .map(|parameter| format!(", {} : [min, max]", parameter.name))
                .collect();
            let found = self.found();
            let message = format!("{name} needs an interval for each parameter, found {found}");
            let hint = format!("write {} before the `;`", quote(&missing.concat()));
            let diagnostic = self.here(codes::MISSING_INTERVAL, message).with_hint(hint);
            let diagnostic = match self.implicit_form() {
                Some(form) => {
                    let form = quote(&form);
                    diagnostic.with_hint(format!(
                        "a surface has two parameters; where a function of three is at most 0 is a solid: write {form}"
                    ))
                }
                None => diagnostic,
            };
            return Err(self.reject(diagnostic));
        }
        self.items()
    }

    /// Returns the solid that is probably meant by a surface with three parameters and a number as its value.
    fn implicit_form(&self) -> Option<String> {
        let is_surface = self.state.keyword == Some(DeclarationKeyword::Surface);
        let value = self.state.body.text(self.source);
        let is_tuple = value.starts_with('(') && value.ends_with(')') && value.contains(',');
        let [a, b, c] = &self.state.parameters[..] else {
            return None;
        };
        let (a, b, c, name) = (&a.name, &b.name, &c.name, self.state.name);
        (is_surface && !is_tuple).then(|| format!("solid {name}({a}, {b}, {c}) = …"))
    }

    /// Returns true at a `,` before an item, and at a `;` that was meant to be a `,`, which it reports.
    fn is_before_item(&mut self) -> bool {
        match self.current.kind {
            TokenKind::Comma => true,
            TokenKind::Semicolon => self.takes_end(),
            _ => false,
        }
    }

    #[cold]
    fn takes_end(&mut self) -> bool {
        let place = self.current.span;
        let behind = &self.source[place.end as usize..];
        let word = behind.trim_start();
        let end = word.find(|c: char| !c.is_ascii_alphanumeric());
        let word = &word[..end.unwrap_or(word.len())];
        let is_parameter = self.state.parameter_trie.get(word).is_some();
        let is_known = is_parameter || AttributeWord::from_text(word).is_some();
        if !is_known || is_item(behind) != Some(true) {
            return false;
        }
        let (item, name) = (quote(word), quote(self.state.name));
        let message = match is_parameter {
            true => format!("the interval of {item} belongs to {name}: it comes before the `;`"),
            false => format!("{item} belongs to {name}: it comes before the `;`"),
        };
        let diagnostic = self
            .here(codes::UNEXPECTED_TOKEN, message)
            .with_hint("write `,` instead of this `;`")
            .with_fix(Fix {
                title: "Write `,` for `;`".to_owned(),
                ..Fix::change(place, ",", true).with_all()
            });
        self.reject(diagnostic);
        true
    }

    /// `ATTRS = "," ITEMS |`
    pub(super) fn attrs(&mut self) -> Result<(), Stop> {
        if self.current.kind == TokenKind::Comma && !self.begins_item(self.current.span.end) {
            // No item follows: the comma is superfluous.
            return Ok(());
        }
        self.items()
    }

    fn items(&mut self) -> Result<(), Stop> {
        while self.is_before_item() {
            self.advance(Mode::Item);
            self.item()?;
        }
        let word = self.lexer.word();
        let text = word.text(self.source);
        let is_item = |text| {
            self.state.parameter_trie.get(text).is_some()
                || AttributeWord::from_text(text).is_some()
        };
        if word.start == self.current.span.start
            && word.end > word.start
            && self.following(word.end) == Some(b':')
            && is_item(text)
        {
            return Err(self.missing_comma(word));
        }
        Ok(())
    }

    /// Returns true if the text at an offset looks like an item: a word with a `:`, an attribute, or an interval.
    fn begins_item(&self, offset: u32) -> bool {
        let rest = self.source[offset as usize..].trim_start();
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric());
        let (word, rest) = rest.split_at(end.unwrap_or(rest.len()));
        if word.is_empty() {
            // A comment may come between; an interval without its parameter is reported as such.
            let has_parameters = !self.state.parameters.is_empty();
            return rest.starts_with('#') || (rest.starts_with('[') && has_parameters);
        }
        let is_word = word.starts_with(|c: char| c.is_ascii_alphabetic());
        is_word && (rest.trim_start().starts_with(':') || AttributeWord::from_text(word).is_some())
    }

    /// Rejects an item without a comma before it.
    #[cold]
    fn missing_comma(&mut self, word: Span) -> Stop {
        let end = self.source[..word.start as usize].trim_end().len() as u32;
        let text = word.text(self.source);
        let what = match self.state.parameter_trie.get(text) {
            Some(_) => format!("the interval of {}", quote(text)),
            None => quote(text),
        };
        let message = format!("expected `,` before {what}");
        let diagnostic = Diagnostic::error(codes::UNEXPECTED_TOKEN, word, message)
            .with_fix(Fix::insert("Insert `,`", end, ",").with_all());
        self.reject(diagnostic)
    }

    /// `ITEM = tag ":" INT | tag ":" GRID | attr ":" EXPR | key ":" word`
    fn item(&mut self) -> Result<(), Stop> {
        let span = self.current.span;
        if let TokenKind::Attribute(word) = self.current.kind {
            return self.attribute(word);
        }
        if self.current.kind != TokenKind::BracketOpen && self.following(span.end) != Some(b':') {
            self.reject_foreign_interval()?;
            self.reject_loose_components(span.start)?;
        }
        let tag = match self.current.kind {
            TokenKind::Variable(parameter) => Some((Some(parameter), span)),
            TokenKind::Undefined if self.has_interval(span.end) => {
                let names = match self.state.parameters.is_empty() && self.state.is_of_space {
                    true => ": its parameters are `x`, `y` and `z`".to_owned(),
                    false => list(&self.state.parameters),
                };
                let message = format!(
                    "{} is not a parameter of {}{names}",
                    self.found(),
                    quote(self.state.name)
                );
                let mut diagnostic = self.here(codes::UNKNOWN_TAG, message);
                if self.state.is_of_space
                    && let [first, second] = &self.state.parameters[..]
                    && span.text(self.source) == "z"
                {
                    let name = self.state.name;
                    let form = format!("solid {name}({}, {}, z)", first.name, second.name);
                    let end = second.span.end;
                    diagnostic = diagnostic
                        .with_hint(format!("name it too: {}", quote(&form)))
                        .with_fix(Fix::insert("Insert `, z`", end, ", z"));
                }
                self.report(diagnostic);
                Some((None, span))
            }
            TokenKind::Undefined => return self.unknown_attribute(),
            TokenKind::BracketOpen => {
                let name = match self.state.parameters.first() {
                    Some(parameter) => &parameter.name,
                    None => "t",
                };
                let form = quote(&format!("{name} : […]"));
                let message = format!("this interval needs its parameter before it, as in {form}");
                let diagnostic = self.here(codes::MISSING_TAG, message);
                self.report(diagnostic);
                None
            }
            _ => {
                let has_domain = self
                    .state
                    .keyword
                    .is_some_and(DeclarationKeyword::has_domain);
                let mut diagnostic = self.expected_diagnostic(match has_domain {
                    true => "the name of a parameter and its interval",
                    false => "an attribute",
                });
                if matches!(self.current.kind, TokenKind::Number(_))
                    && let Some((word, _)) = self.state.attributes.last()
                {
                    let hint = format!(
                        "a vector is written in brackets: `{} : (a, b, c)`",
                        word.text()
                    );
                    diagnostic = diagnostic.with_hint(hint);
                }
                return Err(self.reject(diagnostic));
            }
        };
        if tag.is_some() {
            self.advance(Mode::Expression);
            if self.current.kind != TokenKind::Colon {
                let mut diagnostic =
                    self.expected_diagnostic("`:` after the name of the parameter");
                if let Some(interval) = self.shared_interval() {
                    let title = format!("Insert `{interval}`");
                    let fix = Fix::insert(&title, span.end, &format!(" {interval}"));
                    diagnostic = diagnostic
                        .with_hint("each parameter has its own interval")
                        .with_fix(fix.with_all());
                }
                return Err(self.reject(diagnostic));
            }
            self.advance(Mode::Expression);
        }
        self.interval(IntervalOwner::Domain, tag)
    }

    /// Returns the interval, with its `:`, of the parameter after the current comma: `u, v : [0, 1]`.
    fn shared_interval(&self) -> Option<&str> {
        let comma = self.current.span;
        let rest = self.source[comma.end as usize..].trim_start();
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric())?;
        let (word, rest) = rest.split_at(end);
        self.state.parameter_trie.get(word)?;
        let interval = foreign::first_item(rest.trim_start());
        let is_interval = interval.starts_with(':') && interval.ends_with(']');
        (is_interval && self.current.kind == TokenKind::Comma).then_some(interval)
    }

    /// Rejects the text after the value of a curve, a surface or a metric, if it is not an item: the value's components
    /// are probably meant to be in brackets.
    fn reject_loose_components(&mut self, start: u32) -> Result<(), Stop> {
        let body = self.state.body;
        let has_components = matches!(
            self.state.keyword,
            Some(
                DeclarationKeyword::Curve
                    | DeclarationKeyword::Surface
                    | DeclarationKeyword::Metric
            )
        );
        let before = Span::new(body.end, start.max(body.end)).text(self.source);
        let is_next = before.trim() == "," && body.end > body.start;
        let value = body.text(self.source);
        let is_bracket = value.starts_with('(') && value.ends_with(')');
        if !has_components || !is_next || !self.starts_operand() || is_bracket {
            return Ok(());
        }
        let mut count = 1;
        let mut end = body.end;
        let mut next = &self.source[start as usize..];
        loop {
            let item = foreign::first_item(next);
            if item.is_empty() || item.contains([':', '[']) {
                break;
            }
            count += 1;
            end = (self.source.len() - next.len() + item.len()) as u32;
            match self.source[end as usize..].trim_start().strip_prefix(',') {
                Some(behind) => next = behind.trim_start(),
                None => break,
            }
        }
        // `c(t) = f t, t [0, 1]` lacks a colon.
        let may_be_parameter = matches!(self.current.kind, TokenKind::Variable(_));
        if count != 3 && (count != 2 || may_be_parameter) {
            return Ok(());
        }
        let components = Span::new(body.start, end);
        let message = "the components of a value are written in brackets";
        Err(self.reject_unbracketed(components, message))
    }

    /// Rejects a list without brackets around it, or without the opening one.
    pub(super) fn reject_unbracketed(&mut self, list: Span, message: &str) -> Stop {
        let written = format!("({})", list.text(self.source));
        let is_closed = self.following(list.end) == Some(b')');
        let fix = match is_closed {
            true => Fix::insert("Insert `(`", list.start, "("),
            false => Fix::change(list, &written, true),
        };
        let diagnostic = Diagnostic::error(codes::UNEXPECTED_TOKEN, list, message)
            .with_hint(format!("write {}", quote(&written)))
            .with_fix(fix.with_all());
        self.reject(diagnostic)
    }

    /// Returns true if a `:` and an interval, or the beginning of one, follow at an offset: not the value of an
    /// attribute.
    fn has_interval(&self, offset: u32) -> bool {
        let rest = self.source[offset as usize..].trim_start();
        let Some(value) = rest.strip_prefix(':') else {
            return self
                .state
                .keyword
                .is_some_and(DeclarationKeyword::has_domain);
        };
        value.trim_start().starts_with('[')
    }

    /// Reads the value of an attribute whose word is the current token; the declaration may not allow the attribute.
    fn attribute(&mut self, word: AttributeWord) -> Result<(), Stop> {
        let span = self.current.span;
        let keyword = self.state.keyword.unwrap_or(DeclarationKeyword::Define);
        let row = word.row(keyword);
        let first = self
            .state
            .attributes
            .iter()
            .find(|(stated, _)| *stated == word);
        let fault = match (first, row) {
            (Some((_, first)), _) => {
                let message = format!("`{}` is stated twice", word.text());
                let diagnostic = self.here(codes::DUPLICATE_ATTRIBUTE, message);
                Some(diagnostic.with_related(*first, "the first one is here"))
            }
            (None, None) => {
                let message = format!("{} has no `{}`", with_article(keyword), word.text());
                let diagnostic = self.here(codes::ATTRIBUTE_NOT_HERE, message);
                Some(diagnostic.with_hint(attributes_of(keyword)))
            }
            (None, Some(_)) => None,
        };
        self.state.attributes.push((word, span));
        let is_sound = fault.is_none();
        if let Some(fault) = fault {
            self.report(fault);
            self.state.silent = true;
        }
        self.advance(Mode::Expression);
        if self.current.kind != TokenKind::Colon {
            let message = format!("`:` and a value after `{}`", word.text());
            let mut diagnostic = self.expected_diagnostic(&message);
            if let Some(row) = row {
                diagnostic = diagnostic.with_hint(format!("write `{}`", row.example));
            }
            return Err(self.reject(diagnostic));
        }
        let value_span = if word.is_key() {
            self.advance(Mode::Word);
            if self.current.kind != TokenKind::Word {
                return Err(self.expected(&format!("a word after `{} :`", word.text())));
            }
            let value = self.current.span;
            if let Some(row) = row.filter(|_| is_sound) {
                self.check_choice(row);
            }
            self.advance(Mode::Expression);
            value
        } else {
            self.value()?
        };
        if !self.state.silent {
            let attribute = StatedAttribute {
                word,
                word_span: span,
                value_span,
            };
            let value = value_span.text(self.source);
            self.actions.act_attribute(attribute, value);
        }
        Ok(())
    }

    /// Reads the expression after a `:`, over the parameters of the declaration.
    fn value(&mut self) -> Result<Span, Stop> {
        self.state.in_body = true;
        self.advance(Mode::Expression);
        let value = self.expression()?;
        self.state.in_body = false;
        Ok(value)
    }

    /// Reports the current token if it is not one of the words that an attribute allows.
    fn check_choice(&mut self, row: &AttributeRow) {
        let AttributeType::Choice(words) = row.value else {
            return;
        };
        let found = self.current.span.text(self.source);
        if words.contains(&found) {
            return;
        }
        let message = format!("{} is not a `{}`", quote(found), row.text);
        let mut diagnostic = self.here(codes::ATTRIBUTE_RANGE, message);
        if let Some(meant) = nearest(found, words.iter().copied()) {
            let fix = Fix::change(self.current.span, &meant, true);
            diagnostic = diagnostic.with_fix(fix);
        }
        let hint = format!("use one of `{}`", words.join("`, `"));
        self.report(diagnostic.with_hint(hint));
    }

    /// Reports and skips a word that is neither a parameter nor an attribute, with its apparent value.
    #[cold]
    fn unknown_attribute(&mut self) -> Result<(), Stop> {
        let keyword = self.state.keyword.unwrap_or(DeclarationKeyword::Define);
        let word = self.current.span;
        let text = word.text(self.source);
        let message = format!(
            "{} is not an attribute of {}",
            quote(text),
            with_article(keyword)
        );
        let mut diagnostic = self.here(codes::UNKNOWN_ATTRIBUTE, message);
        let known: Vec<&str> = attributes::of(keyword).map(|row| row.text).collect();
        let meant = match foreign::attribute(text).map(AttributeWord::text) {
            Some(word) => Some(word.to_owned()).filter(|_| known.contains(&word)),
            None => nearest(text, known.iter().copied()),
        };
        diagnostic = match meant {
            Some(meant) => diagnostic
                .with_hint(format!("did you mean `{meant}`?"))
                .with_fix(Fix::change(word, &meant, true)),
            None => diagnostic.with_hint(attributes_of(keyword)),
        };
        self.report(diagnostic);
        self.state.silent = true;
        self.advance(Mode::Expression);
        if self.current.kind != TokenKind::Colon {
            self.state.rejected = true;
            return Err(self.expected("`:` after the attribute"));
        }
        if self.is_lone_word(self.current.span.end) {
            self.advance(Mode::Word);
            self.advance(Mode::Expression);
            return Ok(());
        }
        self.value()?;
        Ok(())
    }

    /// Returns true if a word is at an offset, and the end of an item follows it.
    fn is_lone_word(&self, offset: u32) -> bool {
        let rest = self.source[offset as usize..].trim_start();
        let behind = rest.trim_start_matches(|c: char| c.is_ascii_alphanumeric());
        rest.starts_with(|c: char| c.is_ascii_alphabetic())
            && behind.trim_start().starts_with([',', ';'])
    }
}

/// Returns a declaration's keyword with its article: `a solid`.
fn with_article(keyword: DeclarationKeyword) -> String {
    format!("a `{}`", keyword.text())
}

/// Returns a hint that lists the attributes of a declaration.
fn attributes_of(keyword: DeclarationKeyword) -> String {
    let words: Vec<&str> = attributes::of(keyword).map(|row| row.text).collect();
    format!("its attributes are `{}`", words.join("`, `"))
}
