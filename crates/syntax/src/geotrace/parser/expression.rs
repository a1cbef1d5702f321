//! Expressions: `EXPR` and everything below it. Each function reads its nonterminal from the current token on, passes
//! its steps to the hooks in postfix order and returns its span.

use super::lints::{Argument, Touching};
use super::names::{Mode, in_braces};
use super::{MAX_DEPTH, Parse, Parser, Stop};
use crate::diagnostic::Fix;
use crate::geotrace::actions::{Actions, Operator};
use crate::geotrace::codes;
use crate::geotrace::symbols::NameScope;
use crate::geotrace::token::TokenKind;
use crate::span::Span;
use crate::symbol::SymbolId;

impl<A: Actions, S: NameScope> Parser<'_, '_, A, S> {
    /// `EXPR = ADD`
    pub(super) fn expression(&mut self) -> Parse {
        self.add()
    }

    /// `ADD = ADD "+" JUX | ADD "-" JUX | JUX`
    fn add(&mut self) -> Parse {
        let first = self.jux()?;
        self.add_tail(first)
    }

    /// Reads the rest of `EXPR` after its first `APP`.
    pub(super) fn add_from(&mut self, app: Span) -> Parse {
        let factor = self.mult_tail(app)?;
        let first = self.jux_tail(factor)?;
        self.add_tail(first)
    }

    fn add_tail(&mut self, mut span: Span) -> Parse {
        loop {
            let operator = match self.current.kind {
                TokenKind::Plus => Operator::Add,
                TokenKind::Minus => Operator::Subtract,
                _ => return Ok(span),
            };
            self.advance(Mode::Expression);
            span = span.to(self.jux()?);
            self.operator(operator, span);
        }
    }

    /// `JUX = JUX MULT2 | MULT`
    fn jux(&mut self) -> Parse {
        let first = self.mult()?;
        self.jux_tail(first)
    }

    fn jux_tail(&mut self, mut span: Span) -> Parse {
        let mut short = None;
        while self.starts_app() {
            if let Some(argument) = short
                && self.is_apart()
            {
                self.warn_short_argument(argument, false);
                short = None;
            }
            short = short.or_else(|| self.short_argument());
            self.warn_index(span);
            self.warn_numbers(span);
            span = span.to(self.mult2()?);
            self.operator(Operator::Juxtapose, span);
        }
        if let Some(argument) = short {
            self.warn_short_argument(argument, true);
        }
        Ok(span)
    }

    /// `MULT = MULT "*" UNARY | MULT "/" UNARY | UNARY`
    fn mult(&mut self) -> Parse {
        let first = self.unary()?;
        self.mult_tail(first)
    }

    /// `MULT2 = MULT2 "*" UNARY | MULT2 "/" UNARY | APP`
    fn mult2(&mut self) -> Parse {
        let first = self.app()?;
        self.mult_tail(first)
    }

    /// Reads the rest of `MULT` and of `MULT2` after the first operand.
    fn mult_tail(&mut self, mut span: Span) -> Parse {
        loop {
            let operator = match self.current.kind {
                TokenKind::Star => Operator::Multiply,
                TokenKind::Slash => Operator::Divide,
                _ => return Ok(span),
            };
            let sign = self.current;
            self.advance(Mode::Expression);
            let next = self.current;
            if [sign.kind, next.kind] == [TokenKind::Star; 2] && sign.span.end == next.span.start {
                self.warn_power(span, sign.span);
            }
            if [sign.kind, next.kind] == [TokenKind::Slash; 2] && sign.span.end == next.span.start {
                self.warn_slashes(sign.span);
            }
            let argument = self.argument_before_slash(sign.span);
            if sign.kind == TokenKind::Slash && matches!(next.kind, TokenKind::Number(_)) {
                self.warn_fraction_of_power(sign.span, next.span);
            }
            let divisor = self.unary()?;
            span = span.to(divisor);
            self.operator(operator, span);
            if let Some(argument) = argument {
                self.warn_fraction_behind(argument, divisor);
            }
        }
    }

    /// `UNARY = "+" UNARY | "-" UNARY | "*" UNARY | "/" UNARY | APP`
    ///
    /// All nesting goes through this function, so it counts the depth.
    pub(super) fn unary(&mut self) -> Parse {
        if self.state.depth > MAX_DEPTH {
            return Err(self.too_deep());
        }
        self.state.depth += 1;
        let span = match self.prefix_operator() {
            Some(operator) => {
                let start = self.current.span;
                self.advance(Mode::Expression);
                let span = start.to(self.unary()?);
                self.operator(operator, span);
                span
            }
            None => self.app()?,
        };
        self.state.depth -= 1;
        Ok(span)
    }

    fn prefix_operator(&self) -> Option<Operator> {
        Some(match self.current.kind {
            TokenKind::Plus => Operator::Plus,
            TokenKind::Minus => Operator::Negate,
            TokenKind::Star => Operator::Square,
            TokenKind::Slash => Operator::Reciprocal,
            _ => return None,
        })
    }

    /// `APP = FUNC UNARY | POW`
    fn app(&mut self) -> Parse {
        let TokenKind::Function(id) = self.current.kind else {
            return self.pow();
        };
        let function = self.func2(id)?;
        self.applied(id, function)
    }

    /// Returns true if the current token begins a `UNARY`.
    pub(super) fn starts_operand(&self) -> bool {
        self.prefix_operator().is_some() || self.starts_app()
    }

    /// Reads the rest of `APP` after its `FUNC2`.
    pub(super) fn applied(&mut self, id: SymbolId, function: Span) -> Parse {
        let function = self.func(id, function)?;
        if !self.starts_operand() {
            return Err(self.missing_argument(id, function));
        }
        if self.is_empty_list_of_faulty(id) {
            self.state.faulty = true;
            self.state.silent = true;
            self.state.rejected = true;
        }
        if self.opens_bracket() && self.current.span.start == function.end {
            let bracket = self.current.span.start;
            self.lints.touching = Some(Touching { function, bracket });
        }
        let sign = self.spaced_operator();
        let operand = self.unary()?;
        let span = function.to(operand);
        self.operator(Operator::Apply, span);
        if let Some(sign) = sign {
            self.warn_operator_behind(function, sign, operand);
        }
        if self.opens_bracket() && self.current.span.start == operand.end {
            self.warn_root(function, operand);
        }
        if matches!(
            self.previous.kind,
            TokenKind::Number(_) | TokenKind::Variable(_) | TokenKind::Constant(_)
        ) {
            self.lints.argument = Some(Argument { function, operand });
        }
        Ok(span)
    }

    /// Returns the current token if it is an operator between blanks.
    fn spaced_operator(&self) -> Option<Span> {
        self.prefix_operator()?;
        let sign = self.current.span;
        let is_blank = |at: Option<&u8>| at.is_some_and(u8::is_ascii_whitespace);
        let bytes = self.source.as_bytes();
        let before = (sign.start as usize).checked_sub(1)?;
        (is_blank(bytes.get(before)) && is_blank(bytes.get(sign.end as usize))).then_some(sign)
    }

    /// Returns true at `()` after a function whose declaration lacks parameters, which has been reported: `function f() = 3;`.
    fn is_empty_list_of_faulty(&self, id: SymbolId) -> bool {
        let symbol = self.parsed.symbol(id);
        let is_empty = symbol.faulty && symbol.parameters.is_empty();
        let token = self.current;
        is_empty
            && token.kind == TokenKind::ParenOpen
            && self.following(token.span.end) == Some(b')')
    }

    /// Reads the rest of `FUNC = FUNC2 "^" UNARY | FUNC2` after its `FUNC2`.
    fn func(&mut self, id: SymbolId, function: Span) -> Parse {
        if self.current.kind != TokenKind::Caret {
            return Ok(function);
        }
        self.advance(Mode::Expression);
        let exponent = self.unary()?;
        let span = function.to(exponent);
        self.operator(Operator::FunctionPower, span);
        self.warn_inverse(id, function, exponent);
        Ok(span)
    }

    /// `FUNC2 = FUNC2 "_" var | FUNC2 "'" | func`
    pub(super) fn func2(&mut self, id: SymbolId) -> Parse {
        let mut span = self.current.span;
        self.operator(Operator::Function(id), span);
        if self.lexer.word().end > span.end {
            self.warn_product_of_function(id);
        }
        self.advance(Mode::Expression);
        loop {
            match self.current.kind {
                TokenKind::Prime => {
                    span = span.to(self.current.span);
                    self.operator(Operator::Total, span);
                    self.advance(Mode::Expression);
                }
                TokenKind::Underscore => {
                    self.advance(Mode::ParameterOf(id));
                    span = span.to(self.current.span);
                    match self.current.kind {
                        TokenKind::Variable(parameter) => {
                            self.operator(Operator::Partial(parameter), span);
                            let ends_word = self.lexer.word().end == span.end;
                            self.advance(Mode::Expression);
                            if !ends_word {
                                self.check_second_derivative(id, span);
                            }
                        }
                        _ => self.no_such_parameter(id)?,
                    }
                }
                _ => return Ok(span),
            }
        }
    }

    /// `POW = COMP "^" UNARY | COMP`
    fn pow(&mut self) -> Parse {
        let touching = self.lints.touching.take();
        let base = self.comp(touching)?;
        if self.current.kind != TokenKind::Caret {
            return Ok(base);
        }
        self.advance(Mode::Expression);
        let exponent = self.unary()?;
        let span = base.to(exponent);
        self.operator(Operator::Power, span);
        self.warn_power_of_argument(touching, base, exponent);
        self.warn_short_exponent(base, exponent);
        Ok(span)
    }

    /// `COMP = COMP "_" num | FACT`
    fn comp(&mut self, touching: Option<Touching>) -> Parse {
        let value = self.fact()?;
        let mut span = value;
        while self.current.kind == TokenKind::Underscore {
            // `r_0`, where the declaration of `r_0` has been reported.
            let is_reported = match self.previous.kind {
                TokenKind::Constant(id) => self.parsed.symbol(id).faulty,
                _ => false,
            };
            self.advance(Mode::Expression);
            let index = match self.current.kind {
                TokenKind::Number(_) => self.component_index(),
                // A number that has been reported.
                TokenKind::Error => Some(1),
                _ => None,
            };
            let Some(index) = index else {
                self.flagged |= is_reported;
                return Err(self.not_a_component(value));
            };
            let is_first = span == value;
            span = span.to(self.current.span);
            self.advance(Mode::Expression);
            self.operator(Operator::Component(index), span);
            if is_first {
                self.warn_component_of_argument(touching, value, span);
            }
        }
        Ok(span)
    }

    /// `FACT = const | num | var | "(" TUPLE ")" | "[" TUPLE "]" | "{" TUPLE "}"`
    fn fact(&mut self) -> Parse {
        let span = self.current.span;
        match self.current.kind {
            TokenKind::Constant(id) => self.operator(Operator::Constant(id), span),
            TokenKind::Number(value) => self.operator(Operator::Number(value), span),
            TokenKind::Variable(parameter) => self.operator(Operator::Variable(parameter), span),
            TokenKind::ParenOpen => return self.bracket(TokenKind::ParenClose, ')'),
            TokenKind::BracketOpen => return self.bracket(TokenKind::BracketClose, ']'),
            TokenKind::BraceOpen => return self.bracket(TokenKind::BraceClose, '}'),
            TokenKind::Undefined => return Ok(self.undefined_operand()),
            // A number that has been reported.
            TokenKind::Error => self.state.silent = true,
            _ => return Err(self.expected_expression()),
        }
        self.advance(Mode::Expression);
        Ok(span)
    }

    /// `TUPLE` between brackets.
    fn bracket(&mut self, close: TokenKind, closing: char) -> Parse {
        let opening = self.current.span;
        self.advance(Mode::Expression);
        let count = self.tuple()?;
        if self.current.kind != close {
            return Err(self.unclosed(opening, closing, "`,` or "));
        }
        let span = opening.to(self.current.span);
        if count == 1 && matches!(self.previous.kind, TokenKind::Number(_)) {
            self.warn_row(span);
        }
        self.advance(Mode::Expression);
        self.operator(Operator::Tuple(count), span);
        Ok(span)
    }

    /// `TUPLE = ADD "," TUPLE | ADD`; returns the number of components.
    fn tuple(&mut self) -> Result<u32, Stop> {
        let mut count = 1;
        self.add()?;
        while self.is_separator() {
            self.advance(Mode::Expression);
            self.add()?;
            count += 1;
        }
        Ok(count)
    }

    /// Returns true if the current token begins an `APP`.
    fn starts_app(&self) -> bool {
        matches!(
            self.current.kind,
            TokenKind::Function(_)
                | TokenKind::Constant(_)
                | TokenKind::Number(_)
                | TokenKind::Variable(_)
                | TokenKind::Undefined
                | TokenKind::Error
        ) || self.opens_bracket()
    }

    fn opens_bracket(&self) -> bool {
        matches!(
            self.current.kind,
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen
        )
    }

    /// Returns the current number as the number of a component: only digits, and not 0.
    fn component_index(&mut self) -> Option<u32> {
        let digits = self.current.span.text(self.source);
        let is_integer = digits.bytes().all(|byte| byte.is_ascii_digit());
        let positive = is_integer && digits.bytes().any(|byte| byte != b'0');
        positive.then(|| match digits.parse() {
            Ok(index) => index,
            Err(_) => self.component_beyond_number(),
        })
    }

    /// Reports that the current number exceeds the number of components; returns one that is in range.
    #[cold]
    fn component_beyond_number(&mut self) -> u32 {
        let message = format!("no value has this many components: {}", self.found());
        let diagnostic = self.here(codes::COMPONENT_INDEX, message);
        self.report(diagnostic);
        self.state.silent = true;
        1
    }

    #[cold]
    fn not_a_component(&mut self, value: Span) -> Stop {
        let found = self.found();
        let message =
            format!("a component is selected by a positive integer after `_`, found {found}");
        let mut diagnostic = self.here(codes::COMPONENT_INDEX, message);
        let first = found.trim_start_matches('`').chars().next();
        if first.is_some_and(char::is_alphabetic) && self.current.kind != TokenKind::Eoi {
            let value = super::messages::quote(value.text(self.source));
            let hint =
                format!("{value} is not a function: only a function can be differentiated by `_`");
            diagnostic = diagnostic.with_hint(hint);
        }
        let start = self.current.span.start;
        if let Some((inside, length)) = in_braces(&self.source[start as usize..])
            && !inside.is_empty()
            && inside.bytes().all(|byte| byte.is_ascii_digit())
        {
            let written = super::messages::quote(&format!("{}_{inside}", value.text(self.source)));
            let place = Span::new(start, start + length);
            diagnostic = diagnostic
                .with_hint(format!("write {written}, without braces"))
                .with_fix(Fix::change(place, inside, true).with_all());
        }
        self.reject(diagnostic)
    }

    #[cold]
    fn missing_argument(&mut self, id: SymbolId, function: Span) -> Stop {
        // As in `K(s)`, where `K` is undefined: that has been reported, and `s` would be correct after a word that takes
        // it.
        self.flagged |= self.state.silent
            && self.current.kind == TokenKind::ParenClose
            && self.is_argument_of_word(function.start);
        let written = function.text(self.source);
        let name = super::messages::quote(written);
        let message = format!("{name} needs an argument, found {}", self.found());
        let mut diagnostic = self
            .here(codes::MISSING_ARGUMENT, message)
            .with_related(function, "this is a function");
        let symbol = self.parsed.symbol(id);
        // A function whose own declaration failed may lack parameters.
        self.flagged |= symbol.faulty;
        if symbol.keyword.is_some() && !symbol.parameters.is_empty() {
            let parameters: Vec<&str> = symbol.parameters.iter().map(|it| &*it.name).collect();
            let parameters = parameters.join(", ");
            let form = super::messages::quote(&format!("{written}({parameters})"));
            diagnostic = diagnostic.with_hint(format!("write {form}"));
        }
        self.reject(diagnostic)
    }

    /// Returns whether a `(`, and before it the end of a word, precede an offset.
    fn is_argument_of_word(&self, place: u32) -> bool {
        let before = self.source[..place as usize].trim_end();
        before.strip_suffix('(').is_some_and(|before| {
            before
                .trim_end()
                .ends_with(|c: char| c.is_ascii_alphabetic())
        })
    }

    #[cold]
    pub(super) fn too_deep(&mut self) -> Stop {
        let message = format!("this is nested deeper than {MAX_DEPTH} levels");
        let diagnostic = self
            .here(codes::TOO_DEEP, message)
            .with_hint("give a part of it a name, with `define` or `function`");
        self.reject(diagnostic)
    }
}
