//! Sets of points: `SET` and everything below it. Each function reads its nonterminal from the current token on, passes its
//! steps to the hooks in postfix order and returns its span.

use super::names::Mode;
use super::{MAX_DEPTH, Parse, Parser};
use crate::diagnostic::Fix;
use crate::geotrace::actions::{Actions, Operator};
use crate::geotrace::symbols::NameScope;
use crate::geotrace::token::{MapWord, TokenKind};

impl<A: Actions, S: NameScope> Parser<'_, '_, A, S> {
    /// `SET = SET "|" MEET | SET "\" MEET | MEET`. Its first token has been read by [`Mode::Name`].
    pub(super) fn set(&mut self) -> Parse {
        let mut span = self.meet()?;
        loop {
            let operator = match self.current.kind {
                TokenKind::Bar => Operator::Union,
                TokenKind::Backslash => Operator::Difference,
                _ => return Ok(span),
            };
            self.advance(Mode::Name);
            span = span.to(self.meet()?);
            self.operator(operator, span);
        }
    }

    /// `MEET = MEET "&" PUT | PUT`
    fn meet(&mut self) -> Parse {
        let mut span = self.put()?;
        while self.current.kind == TokenKind::Ampersand {
            self.advance(Mode::Name);
            span = span.to(self.put()?);
            self.operator(Operator::Intersection, span);
        }
        Ok(span)
    }

    /// `PUT = PUT "@" PLACE | ATOM`
    fn put(&mut self) -> Parse {
        let set = self.atom()?;
        let mut span = set;
        while self.current.kind == TokenKind::At {
            self.advance(Mode::Place);
            let (operator, place) = self.place()?;
            span = set.to(place);
            self.operator(operator, span);
        }
        Ok(span)
    }

    /// `PLACE = EXPR | FUNC2 | map UNARY`: returns its effect on the set before it, and its span.
    fn place(&mut self) -> Result<(Operator, crate::span::Span), super::Stop> {
        match self.current.kind {
            TokenKind::Map(map) => {
                let word = self.current.span;
                self.advance(Mode::Expression);
                let operand = self.unary()?;
                self.state.map = Some((map, operand));
                let operator = match map {
                    MapWord::Scale => Operator::Scale,
                    MapWord::Rotate => Operator::Rotate,
                };
                Ok((operator, word.to(operand)))
            }
            TokenKind::Function(id) => {
                let function = self.func2(id)?;
                if self.current.kind == TokenKind::Caret || self.starts_operand() {
                    let applied = self.applied(id, function)?;
                    return Ok((Operator::Move, self.add_from(applied)?));
                }
                Ok((Operator::Image, function))
            }
            _ => Ok((Operator::Move, self.expression()?)),
        }
    }

    /// `ATOM = func | "(" SET ")" | "[" SET "]" | "{" SET "}"`
    fn atom(&mut self) -> Parse {
        let span = self.current.span;
        let (close, closing) = match self.current.kind {
            TokenKind::Function(id) => {
                self.operator(Operator::Function(id), span);
                self.operator(Operator::Atom, span);
                self.advance(Mode::Expression);
                return Ok(span);
            }
            TokenKind::Undefined => {
                self.undefined_function();
                return Ok(span);
            }
            TokenKind::ParenOpen => (TokenKind::ParenClose, ')'),
            TokenKind::BracketOpen => (TokenKind::BracketClose, ']'),
            TokenKind::BraceOpen => (TokenKind::BraceClose, '}'),
            _ => return Err(self.expected_set()),
        };
        if self.state.depth > MAX_DEPTH {
            return Err(self.too_deep());
        }
        self.state.depth += 1;
        self.advance(Mode::Name);
        self.set()?;
        self.state.depth -= 1;
        if self.current.kind != close {
            return Err(self.unclosed(span, closing, "`|`, `&`, `\\`, `@` or "));
        }
        let span = span.to(self.current.span);
        self.advance(Mode::Expression);
        self.operator(Operator::Tuple(1), span);
        Ok(span)
    }

    /// Rejects the current token in place of a solid.
    #[cold]
    fn expected_set(&mut self) -> super::Stop {
        let mut diagnostic = self.expected_diagnostic("a solid or a function");
        if let TokenKind::Constant(_) | TokenKind::Number(_) = self.current.kind {
            let hint = "a set names solids; a solid by a function lists its parameters, as in `solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;`";
            diagnostic = diagnostic.with_hint(hint);
        }
        if self.current.kind == self.previous.kind
            && let TokenKind::Ampersand | TokenKind::Bar = self.current.kind
        {
            let sign = self.current.span.text(self.source);
            diagnostic = diagnostic
                .with_hint(format!("a set is written with one sign: `a {sign} b`"))
                .with_fix(Fix::remove(self.current.span, sign).with_all());
        }
        if let Some((hint, fix)) = self.field_form() {
            diagnostic = diagnostic.with_hint(hint).with_fix(fix);
        }
        self.reject(diagnostic)
    }
}
