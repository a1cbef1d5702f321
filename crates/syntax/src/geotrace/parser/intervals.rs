//! Intervals: `INTS`, `GRIDS`, `INT`, `GRID` and the intervals of domains.

use super::foreign::ForeignInterval;
use super::messages::quote;
use super::names::Mode;
use super::{Parser, Stop, foreign, messages};
use crate::diagnostic::{Diagnostic, Fix};
use crate::geotrace::actions::{Actions, Interval, IntervalKind};
use crate::geotrace::codes;
use crate::geotrace::symbols::NameScope;
use crate::geotrace::token::{Token, TokenKind};
use crate::span::Span;

/// An interval's tag: the index of the parameter that it names, if it names one, and the tag's span.
type Tag = Option<(Option<u32>, Span)>;

/// The owner of an interval, which determines whether it may or must have a count.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum IntervalOwner {
    Param,
    Grid,
    Domain,
}

impl<'s, A: Actions, S: NameScope> Parser<'s, '_, A, S> {
    /// `INTS` of a param, `GRIDS` of a grid.
    pub(super) fn intervals(&mut self, owner: IntervalOwner) -> Result<(), Stop> {
        self.interval(owner, None)?;
        while self.current.kind == TokenKind::Comma {
            self.advance(Mode::Expression);
            self.interval(owner, None)?;
        }
        Ok(())
    }

    /// Rejects an interval with one end, or whose ends are written `a..b`.
    #[cold]
    fn missing_end(&mut self, opening: Span, owner: IntervalOwner) -> Stop {
        let inside = Span::new(opening.end, self.current.span.start);
        let place = opening.to(self.current.span);
        match foreign::interval(inside.text(self.source)) {
            Some(found) if owner == IntervalOwner::Grid => self.foreign_grid(place, found),
            Some(found) => self.foreign_interval(place, &found.written()),
            None => self.expected("`,` and the interval's other end"),
        }
    }

    /// Rejects an interval in another notation.
    #[cold]
    pub(super) fn foreign_interval(&mut self, place: Span, written: &str) -> Stop {
        let diagnostic = messages::foreign_interval(self.source, place, written);
        let stop = self.reject(diagnostic);
        self.state.quiet = true;
        stop
    }

    /// Rejects an interval in another notation in place of a grid's.
    #[cold]
    fn foreign_grid(&mut self, place: Span, interval: ForeignInterval<'_>) -> Stop {
        let found = quote(place.text(self.source));
        let message = format!("an interval of a grid is written `[min, max, n]`, found {found}");
        let diagnostic = Diagnostic::error(codes::UNEXPECTED_TOKEN, place, message);
        let [a, b] = interval.ends_written();
        let diagnostic = match interval.count() {
            Some(count) => {
                let written = format!("[{a}, {b}, {count}]");
                diagnostic
                    .with_hint(format!("write {} for {count} values", quote(&written)))
                    .with_fix(Fix::change(place, &written, true))
            }
            None => {
                let written = quote(&format!("[{a}, {b}, 5]"));
                diagnostic.with_hint(format!(
                    "write {written} for 5 values, both ends among them"
                ))
            }
        };
        let stop = self.reject(diagnostic);
        self.state.quiet = true;
        stop
    }

    /// Returns the interval in another notation that begins with the current token, unless it is valid in this one.
    fn interval_here(&self) -> Option<(Span, ForeignInterval<'s>)> {
        self.interval_at(self.current.span.start)
    }

    /// Returns the interval in another notation that begins at an offset.
    pub(super) fn interval_at(&self, start: u32) -> Option<(Span, ForeignInterval<'s>)> {
        let text = &self.source[start as usize..];
        let found = match text.starts_with(['(', '{']) {
            true => foreign::bracketed_interval(text)?,
            false => foreign::interval(text)?,
        };
        let names_parameter = found.parameter.is_none_or(|name| {
            self.state.parameter_trie.get(name).is_some() || name == self.state.name
        });
        let place = Span::new(start, start + found.text.len() as u32);
        names_parameter.then_some((place, found))
    }

    /// Returns the two ends between brackets at an offset.
    pub(super) fn bracketed_interval_at(&self, start: u32) -> Option<(Span, ForeignInterval<'s>)> {
        let found = foreign::bracketed_interval(&self.source[start as usize..])?;
        let place = Span::new(start, start + found.text.len() as u32);
        Some((place, found))
    }

    /// Rejects an interval in another notation in place of an item.
    pub(super) fn reject_foreign_interval(&mut self) -> Result<(), Stop> {
        match self.interval_here() {
            Some((place, found)) => Err(self.foreign_interval(place, &found.written())),
            None => Ok(()),
        }
    }

    /// `INT = "[" EXPR "," EXPR "]"` of a param, `GRID = "[" EXPR "," EXPR "," EXPR "]"` of a grid, either of a curve
    /// or a surface.
    pub(super) fn interval(&mut self, owner: IntervalOwner, tag: Tag) -> Result<(), Stop> {
        let opening = self.current.span;
        if self.current.kind != TokenKind::BracketOpen {
            if let Some((place, found)) = self.interval_here() {
                let [a, b] = found.ends_written();
                return Err(match owner {
                    IntervalOwner::Grid => self.foreign_grid(place, found),
                    _ => self.foreign_interval(place, &format!("[{a}, {b}]")),
                });
            }
            let form = match owner {
                IntervalOwner::Grid => "an interval `[a, b, n]`",
                _ => "an interval `[a, b]`",
            };
            let mut diagnostic = self.expected_diagnostic(form);
            if owner == IntervalOwner::Param && self.current.kind == TokenKind::Equals {
                let behind = self.source[self.current.span.end as usize..].trim_start();
                let value = foreign::first_item(behind);
                let form = quote(&format!(
                    "param {} = {value} : [min, max];",
                    self.state.name
                ));
                diagnostic = diagnostic.with_hint(format!("write {form}"));
            }
            return Err(self.reject(diagnostic));
        }
        self.advance(Mode::Expression);
        self.expression()?;
        if !self.is_separator() {
            return Err(match self.current.kind {
                TokenKind::BracketClose => self.missing_end(opening, owner),
                _ => self.unclosed(opening, ']', "`,` or "),
            });
        }
        self.advance(Mode::Expression);
        self.expression()?;
        let mut kind = IntervalKind::Range;
        match (self.current.kind, owner) {
            (TokenKind::Semicolon, _) if !self.is_separator() => {}
            (TokenKind::Comma | TokenKind::Semicolon, IntervalOwner::Param) => {
                let diagnostic = self.expected_diagnostic("`]`").with_hint(
                    "a param's interval is `[min, max]`; one with a count belongs to a `grid`",
                );
                return Err(self.reject(diagnostic));
            }
            (TokenKind::BracketClose, IntervalOwner::Grid) => {
                let diagnostic = self
                    .expected_diagnostic("`,` and the number of values")
                    .with_hint("a grid's interval is `[a, b, n]`");
                return Err(self.reject(diagnostic));
            }
            (TokenKind::Comma | TokenKind::Semicolon, _) => {
                self.advance(Mode::Expression);
                self.expression()?;
                kind = IntervalKind::Grid;
            }
            _ => {}
        }
        let Token { kind: found, span } = self.current;
        if found != TokenKind::BracketClose {
            let separator = match (kind, owner) {
                (IntervalKind::Range, IntervalOwner::Domain) => "`,` or ",
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
