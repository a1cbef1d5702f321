//! Intervals: `INTS`, `GRIDS`, `TINTS` and all below them.

use super::messages::quote;
use super::names::{Mode, list};
use super::{Parser, Stop, foreign};
use crate::diagnostic::{Diagnostic, Fix};
use crate::geotrace::actions::{Actions, Interval, IntervalKind};
use crate::geotrace::codes;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::symbols::NameScope;
use crate::geotrace::token::{Token, TokenKind};
use crate::span::Span;

/// An interval's tag: the position of the parameter that it names, if it names one, and its place.
type Tag = Option<(Option<u32>, Span)>;

impl<A: Actions, S: NameScope> Parser<'_, '_, A, S> {
    /// `INTS` of a param, `GRIDS` of a grid.
    pub(super) fn intervals(&mut self, keyword: DeclarationKeyword) -> Result<(), Stop> {
        self.interval(keyword, None)?;
        while self.current.kind == TokenKind::Comma {
            self.advance(Mode::Expression);
            self.interval(keyword, None)?;
        }
        Ok(())
    }

    /// `"," TINTS` of what has a domain.
    pub(super) fn tints(&mut self) -> Result<(), Stop> {
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
            let name = quote(self.state.name);
            let missing: Vec<String> = (self.state.parameters.iter())
                .take(2)
                .map(|parameter| format!(", {} : [min, max]", parameter.name))
                .collect();
            let found = self.found();
            let message = format!("{name} needs an interval for each parameter, found {found}");
            let hint = format!("write {} before the `;`", quote(&missing.concat()));
            let diagnostic = self.here(codes::MISSING_INTERVAL, message).with_hint(hint);
            return Err(self.reject(diagnostic));
        }
        while self.current.kind == TokenKind::Comma {
            self.advance(Mode::Tag);
            self.tint()?;
        }
        let word = self.lexer.word();
        if word.start == self.current.span.start
            && word.end > word.start
            && self.following(word.end) == Some(b':')
            && self
                .state
                .parameter_trie
                .get(word.text(self.source))
                .is_some()
        {
            return Err(self.missing_comma(word));
        }
        Ok(())
    }

    /// Rejects an interval's tag with no comma before it.
    #[cold]
    fn missing_comma(&mut self, tag: Span) -> Stop {
        let end = self.source[..tag.start as usize].trim_end().len() as u32;
        let name = quote(tag.text(self.source));
        let message = format!("expected `,` before the interval of {name}");
        let diagnostic = Diagnostic::error(codes::UNEXPECTED_TOKEN, tag, message)
            .with_fix(Fix::insert("Insert `,`", end, ",").with_all());
        self.reject(diagnostic)
    }

    /// Rejects an interval that has one end, or two that are written `a..b`.
    #[cold]
    fn missing_end(&mut self, opening: Span) -> Stop {
        let inside = Span::new(opening.end, self.current.span.start);
        match foreign::interval(inside.text(self.source)) {
            Some(found) => {
                let written = found.written();
                self.foreign_interval(opening.to(self.current.span), &written)
            }
            None => self.expected("`,` and the interval's other end"),
        }
    }

    /// Rejects an interval in another notation.
    #[cold]
    pub(super) fn foreign_interval(&mut self, place: Span, written: &str) -> Stop {
        let found = quote(place.text(self.source));
        let (message, hint) = (
            format!("an interval is written `[min, max]`, found {found}"),
            format!("write {}", quote(written)),
        );
        let diagnostic = Diagnostic::error(codes::UNEXPECTED_TOKEN, place, message)
            .with_hint(hint)
            .with_fix(Fix::change(place, written, true).with_all());
        let stop = self.reject(diagnostic);
        self.state.quiet = true;
        stop
    }

    /// The interval in another notation that begins with the current token, which is none of this one.
    fn interval_here(&self) -> Option<(Span, String)> {
        let start = self.current.span.start;
        let text = &self.source[start as usize..];
        let found = match self.current.kind {
            TokenKind::ParenOpen => foreign::round_interval(text)?,
            _ => foreign::interval(text)?,
        };
        let names_parameter = found.parameter.is_none_or(|name| {
            self.state.parameter_trie.get(name).is_some() || name == self.state.name
        });
        let place = Span::new(start, start + found.text.len() as u32);
        names_parameter.then(|| (place, found.written()))
    }

    /// `TINT = id ":" INT | id ":" GRID`
    fn tint(&mut self) -> Result<(), Stop> {
        let span = self.current.span;
        if self.current.kind != TokenKind::BracketOpen
            && self.following(span.end) != Some(b':')
            && let Some((place, written)) = self.interval_here()
        {
            return Err(self.foreign_interval(place, &written));
        }
        let tag = match self.current.kind {
            TokenKind::Variable(parameter) => Some((Some(parameter), span)),
            TokenKind::Undefined => {
                let names = list(&self.state.parameters);
                let message = format!(
                    "{} is not a parameter of {}{names}",
                    self.found(),
                    quote(self.state.name)
                );
                let diagnostic = self.here(codes::UNKNOWN_TAG, message);
                self.report(diagnostic);
                Some((None, span))
            }
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
            _ => return Err(self.expected("the name of a parameter and its interval")),
        };
        if tag.is_some() {
            self.advance(Mode::Expression);
            if self.current.kind != TokenKind::Colon {
                return Err(self.expected("`:` after the name of the parameter"));
            }
            self.advance(Mode::Expression);
        }
        self.interval(DeclarationKeyword::Curve, tag)
    }

    /// `INT = "[" EXPR "," EXPR "]"` of a param, `GRID = "[" EXPR "," EXPR "," EXPR "]"` of a grid, either
    /// of a curve or a surface.
    fn interval(&mut self, keyword: DeclarationKeyword, tag: Tag) -> Result<(), Stop> {
        let opening = self.current.span;
        if self.current.kind != TokenKind::BracketOpen {
            if let Some((place, written)) = self.interval_here() {
                let interval = written.rsplit(" : ").next().unwrap_or_default();
                return Err(self.foreign_interval(place, interval));
            }
            let form = match keyword {
                DeclarationKeyword::Grid => "an interval `[a, b, n]`",
                _ => "an interval `[a, b]`",
            };
            return Err(self.expected(form));
        }
        self.advance(Mode::Expression);
        self.expression()?;
        if self.current.kind != TokenKind::Comma {
            return Err(match self.current.kind {
                TokenKind::BracketClose => self.missing_end(opening),
                _ => self.unclosed(opening, ']', "`,` or "),
            });
        }
        self.advance(Mode::Expression);
        self.expression()?;
        let mut kind = IntervalKind::Range;
        match (self.current.kind, keyword) {
            (TokenKind::Comma, DeclarationKeyword::Param) => {
                let diagnostic = self.expected_diagnostic("`]`").with_hint(
                    "a param's interval is `[min, max]`; one with a count belongs to a `grid`",
                );
                return Err(self.reject(diagnostic));
            }
            (TokenKind::BracketClose, DeclarationKeyword::Grid) => {
                let diagnostic = self
                    .expected_diagnostic("`,` and the number of values")
                    .with_hint("a grid's interval is `[a, b, n]`");
                return Err(self.reject(diagnostic));
            }
            (TokenKind::Comma, _) => {
                self.advance(Mode::Expression);
                self.expression()?;
                kind = IntervalKind::Grid;
            }
            _ => {}
        }
        let Token { kind: found, span } = self.current;
        if found != TokenKind::BracketClose {
            let separator = match (kind, keyword) {
                (IntervalKind::Range, DeclarationKeyword::Curve) => "`,` or ",
                _ => "",
            };
            return Err(self.unclosed(opening, ']', separator));
        }
        self.advance(Mode::Expression);
        let span = opening.to(span);
        self.act_interval(Interval { kind, span, tag });
        Ok(())
    }
}
