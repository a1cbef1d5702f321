//! Objects and the block `Settings`, with their attributes.

use super::Parser;
use crate::crt::actions::{Actions, ParseStep};
use crate::crt::codes;
use crate::crt::objects::{ObjectName, ValueType};
use crate::crt::token::TokenKind;
use crate::diagnostic::{Diagnostic, Fix};
use crate::span::Span;
use crate::spelling::nearest;

/// The attributes stated in an object, each with the span of its name.
type Stated<'s> = Vec<(&'s str, Span)>;

/// Returns a word with its first letter in lower case.
fn small(word: &str) -> String {
    let mut letters = word.chars();
    let first = letters.next().map(|letter| letter.to_ascii_lowercase());
    first.into_iter().chain(letters).collect()
}

/// Returns the name of the object that a word matches if capital letters are ignored.
pub(super) fn uncapitalized(word: &str) -> Option<&'static str> {
    let mut names = ObjectName::objects().map(ObjectName::text);
    names.find(|name| name.eq_ignore_ascii_case(word) && *name != word)
}

impl<'s, A: Actions> Parser<'s, '_, A> {
    /// `Prim = name "{" Attrs "}"`
    pub(super) fn object(&mut self) {
        let (text, name) = (self.text(), self.current.span);
        if self.lexer.peek() == TokenKind::Assign {
            return self.capital_variable();
        }
        let object = ObjectName::from_text(text);
        if let Some(meant) = uncapitalized(text) {
            let message = format!("there is no object `{text}`");
            let diagnostic = Diagnostic::error(codes::UNKNOWN_OBJECT, name, message)
                .with_hint(format!("write `{meant}`, with a capital letter"))
                .with_fix(Fix::change(name, meant, true).with_all());
            self.report(diagnostic);
        } else if object.is_none() {
            let message = format!("there is no object `{text}`");
            let mut diagnostic = Diagnostic::error(codes::UNKNOWN_OBJECT, name, message);
            if let Some(near) = nearest(text, ObjectName::objects().map(ObjectName::text)) {
                diagnostic = diagnostic
                    .with_hint(format!("did you mean `{near}`?"))
                    .with_fix(Fix::change(name, &near, true));
            }
            self.report(diagnostic);
        }
        self.advance();
        let (braces, count) = self.attributes(object.map(|object| (object, name)), false);
        self.step(ParseStep::Object(name, count, braces), name.start);
    }

    /// Reports a variable that begins with a capital letter, and reads it as a variable.
    fn capital_variable(&mut self) {
        let (text, span) = (self.text(), self.current.span);
        let written = small(text);
        let message = format!("a variable begins with a small letter, unlike `{text}`");
        if let Some(found) = self.fault(codes::UNEXPECTED_TOKEN, span, message) {
            let fix = Fix::change(span, &written, true);
            self.report(found.with_fix(fix));
        }
        self.advance();
        self.step(ParseStep::Identifier(text), span.start);
    }

    /// `"{" Attrs "}"` of an object, with the span of its name, or of the block `Settings`. Returns the span of the braces
    /// and the number of attributes.
    pub(super) fn attributes(
        &mut self,
        object: Option<(ObjectName, Span)>,
        is_settings: bool,
    ) -> (Span, usize) {
        let open = self.current.span;
        if !self.accept(TokenKind::BraceOpen, "a `{`") {
            let end = self.previous.span.end;
            return (Span::new(end, end), 0);
        }
        let name = match is_settings {
            true => Some(ObjectName::Settings),
            false => object.map(|(name, _)| name),
        };
        let errors = self.errors;
        let mut stated: Stated<'s> = Vec::new();
        let mut count = 0;
        self.brackets += 1;
        if self.enter() {
            while self.attribute(name, &mut stated, &mut count) {}
            self.leave();
        }
        let is_closed = self.at(TokenKind::BraceClose);
        self.close(TokenKind::BraceClose, open);
        self.brackets -= 1;
        // An error between the braces may hide an attribute that seems to be missing.
        if let Some((object, place)) = object
            && is_closed
            && (errors == self.errors || !stated.is_empty())
        {
            self.check_required(object, place, &stated);
        }
        (Span::new(open.start, self.previous.span.end), count)
    }

    /// `Attr = ident "->" Expr`, or an erroneous attribute. Returns false at the end of the list.
    fn attribute(
        &mut self,
        object: Option<ObjectName>,
        stated: &mut Stated<'s>,
        count: &mut usize,
    ) -> bool {
        let (word, span) = (self.text(), self.current.span);
        match self.current.kind {
            TokenKind::Name | TokenKind::Text if self.lexer.peek() == TokenKind::Arrow => {
                let name = small(word.trim_matches('"'));
                let row = object.and_then(|object| object.attribute(&name));
                let message = "the name of an attribute is a word that begins with a small letter";
                if let Some(mut found) = self.fault(codes::UNEXPECTED_TOKEN, span, message) {
                    let fix = row.map(|row| Fix::change(span, row.text, true));
                    found.fixes.extend(fix);
                    self.report(found);
                }
                stated.extend(row.map(|row| (row.text, span)));
                self.advance();
                self.advance();
                self.value(object, &name);
                self.step(ParseStep::Attribute(span), span.start);
                *count += 1;
                return true;
            }
            TokenKind::BraceClose | TokenKind::Settings | TokenKind::Scene | TokenKind::Eoi => {
                return false;
            }
            TokenKind::Identifier => {}
            TokenKind::Comma => {
                let message = "attributes are written one after another, without `,`";
                if let Some(found) = self.fault(codes::UNEXPECTED_TOKEN, span, message) {
                    self.report(found.with_fix(Fix::remove(span, ",").with_all()));
                }
                self.advance();
                self.reported = None;
                return true;
            }
            // The previous brace was meant to be closed.
            TokenKind::While | TokenKind::If | TokenKind::Name => return false,
            _ => {
                self.unexpected("an attribute");
                self.advance();
                return true;
            }
        }
        let known = object.map(|object| object.attribute(word).is_some());
        let next = self.lexer.peek();
        let is_attribute = next == TokenKind::Arrow
            || known == Some(true)
            || known.is_none() && next == TokenKind::Colon;
        if !is_attribute {
            // An assignment or another statement: the previous brace was meant to be closed.
            if matches!(
                next,
                TokenKind::Assign | TokenKind::ParenOpen | TokenKind::Modify
            ) {
                return false;
            }
            self.unexpected("an attribute, as in `radius -> 1`");
            self.advance();
            return true;
        }
        self.advance();
        if let (Some(object), Some(false)) = (object, known) {
            self.unknown_attribute(object, word, span);
        }
        if let Some((_, first)) = stated.iter().find(|(text, _)| *text == word) {
            let message = format!("`{word}` is stated twice: this one counts");
            let diagnostic = Diagnostic::warning(codes::DUPLICATE_ATTRIBUTE, span, message);
            let first = *first;
            self.report(diagnostic.with_related(first, "it is stated here first"));
        }
        stated.push((word, span));
        if self.at(TokenKind::Arrow) {
            self.advance();
        } else {
            self.missing_arrow(word, span);
        }
        self.value(object, word);
        self.step(ParseStep::Attribute(span), span.start);
        *count += 1;
        true
    }

    /// Reports that there is no `->` after the name of an attribute, and passes a sign that was meant to be one.
    fn missing_arrow(&mut self, word: &str, name: Span) {
        let mut place = self.current.span;
        let rest = &self.source[place.end as usize..];
        if self.at(TokenKind::Assign) && rest.starts_with('>') {
            // `=>` of other languages.
            place.end += 1;
        }
        let is_sign = match self.current.kind {
            TokenKind::Assign | TokenKind::Colon | TokenKind::Greater => true,
            // Without a blank behind it, the sign of a value.
            TokenKind::Minus => rest.starts_with(char::is_whitespace),
            _ => false,
        };
        let message = format!("`->` is missing between `{word}` and its value");
        if let Some(found) = self.fault(codes::UNEXPECTED_TOKEN, place, message) {
            let fix = match self.current.kind {
                TokenKind::Assign | TokenKind::Colon => Fix::change(place, "->", true).with_all(),
                _ if is_sign => Fix::change(place, "->", true),
                kind => Fix {
                    preferred: kind != TokenKind::Minus,
                    ..Fix::insert("Insert `->`", name.end, " ->")
                },
            };
            self.report(found.with_fix(fix));
        }
        if is_sign {
            self.advance();
        }
        if self.current.span.end == place.end && self.at(TokenKind::Greater) {
            self.advance();
        }
    }

    /// Reads the value of an attribute.
    fn value(&mut self, object: Option<ObjectName>, word: &str) {
        let row = object.and_then(|object| object.attribute(word));
        let is_colour = row.is_some_and(|row| matches!(row.value, ValueType::Colour));
        self.colour_start = is_colour.then_some(self.current.span.start);
        self.expression();
    }

    fn unknown_attribute(&mut self, object: ObjectName, word: &str, span: Span) {
        let name = object.text();
        let message = format!("`{name}` has no attribute `{word}`: it is ignored");
        let mut diagnostic = Diagnostic::warning(codes::UNKNOWN_ATTRIBUTE, span, message);
        let words = object.attributes().iter().map(|row| row.text);
        diagnostic = match nearest(word, words.clone()) {
            Some(near) => diagnostic
                .with_hint(format!("did you mean `{near}`?"))
                .with_fix(Fix::change(span, &near, true)),
            None => {
                let words: Vec<&str> = words.collect();
                diagnostic.with_hint(format!("it has {}", words.join(", ")))
            }
        };
        self.report(diagnostic);
    }

    /// Reports the required attributes that an object does not state.
    fn check_required(&mut self, object: ObjectName, place: Span, stated: &Stated<'_>) {
        let states = |word: &str| stated.iter().any(|(text, _)| *text == word);
        let required = object.attributes().iter().filter(|row| row.is_required());
        let mut missing: Vec<&str> = required.map(|row| row.text).collect();
        if object == ObjectName::Background && !states("image") && !states("color") {
            match (states("horizon"), states("sky")) {
                (true, false) => missing.push("sky"),
                (false, true) => missing.push("horizon"),
                _ => {}
            }
        }
        missing.retain(|word| !states(word));
        if missing.is_empty() {
            return;
        }
        let words: Vec<String> = missing.iter().map(|word| format!("`{word}`")).collect();
        let list = match words.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
            _ => words.concat(),
        };
        let message = format!("`{}` needs {list}", object.text());
        self.report(Diagnostic::error(codes::MISSING_ATTRIBUTE, place, message));
    }
}
