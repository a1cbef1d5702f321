//! Expressions.

use super::Parser;
use super::messages::quote;
use super::object::uncapitalized;
use crate::crt::actions::{Actions, ParseStep};
use crate::crt::codes;
use crate::crt::lexer::string_value;
use crate::crt::token::{Token, TokenKind};
use crate::crt::tree::{BinaryOperator, ModifierKind, PrefixOperator};
use crate::diagnostic::{Diagnostic, Fix};
use crate::span::Span;
use crate::spelling::nearest;

/// The words of modifiers.
const MODIFIERS: [&str; 3] = ["scale", "translate", "rotate"];

impl<A: Actions> Parser<'_, '_, A> {
    /// `Expr = Cond Assign`, `Assign = "=" Expr |`
    pub(super) fn expression(&mut self) {
        if !self.enter() {
            return self.step(ParseStep::Missing, self.current.span.start);
        }
        let first = self.current;
        self.conditional();
        if self.at(TokenKind::Assign) {
            let target = Span::new(
                first.span.start,
                self.previous.span.end.max(first.span.start),
            );
            // A name with a capital letter has been reported.
            let is_word = matches!(first.kind, TokenKind::Identifier | TokenKind::Name);
            let is_name = is_word && first.span == target;
            if !is_name {
                self.not_assignable(target);
            }
            self.advance();
            self.expression();
            self.step(ParseStep::Assignment, first.span.start);
        }
        self.leave();
    }

    fn not_assignable(&mut self, target: Span) {
        let message = "the left side of `=` must be a name";
        if let Some(mut diagnostic) = self.fault(codes::NOT_ASSIGNABLE, target, message) {
            if self.brackets > 0 {
                let fix = Fix::change(self.current.span, "==", false);
                diagnostic = diagnostic
                    .with_hint("use `==` to compare two values")
                    .with_fix(fix);
            }
            self.report(diagnostic);
        }
        // Errors after this one may be independent.
        self.reported = None;
    }

    /// `Cond = Or Choice`, `Choice = "?" Expr ":" Cond |`
    fn conditional(&mut self) {
        let start = self.current.span.start;
        self.binary(0);
        if !self.at(TokenKind::Question) {
            return;
        }
        self.advance();
        self.expression();
        self.accept(TokenKind::Colon, "the `:` of `?`");
        if self.enter() {
            self.conditional();
            self.leave();
        } else {
            self.step(ParseStep::Missing, self.current.span.start);
        }
        self.step(ParseStep::Conditional, start);
    }

    /// Reads the chains of left-associative operators from a level upwards: `Or`, `And`, `Cmp`, `Sum` and `Prod` with
    /// their tails.
    fn binary(&mut self, least: u8) {
        let start = self.current.span.start;
        let first = self.current;
        self.sign();
        while let Some(operator) = binary_operator(self.current.kind)
            && operator.level() >= least
            && !self.closes_modifiers()
        {
            self.check_continued_line();
            let span = self.current.span;
            let left = self.previous;
            self.advance();
            let right = self.current;
            self.binary(operator.level() + 1);
            if operator == BinaryOperator::Divide && right == self.previous {
                self.check_fraction(first, left, right);
            }
            self.step(ParseStep::Binary(operator, span), start);
        }
    }

    /// Returns true if the current token is a `>` that compares with nothing, and so closes the modifiers that are being read.
    fn closes_modifiers(&self) -> bool {
        self.at(TokenKind::Greater)
            && self.modifiers.is_some()
            && !self.lexer.peek().begins_expression()
    }

    /// `Sign = "+" Sign | "-" Sign | "!" Sign | Post`
    fn sign(&mut self) {
        let operator = match self.current.kind {
            TokenKind::Plus => PrefixOperator::Plus,
            TokenKind::Minus => PrefixOperator::Minus,
            TokenKind::Not => PrefixOperator::Not,
            _ => return self.suffixed(),
        };
        let start = self.current.span.start;
        self.advance();
        if self.enter() {
            self.sign();
            self.leave();
        } else {
            self.step(ParseStep::Missing, self.current.span.start);
        }
        self.step(ParseStep::Prefix(operator), start);
    }

    /// `Post = Prim PostTail`, with `PostTail` as a loop.
    fn suffixed(&mut self) {
        let start = self.current.span.start;
        self.primary();
        loop {
            let open = self.current.span;
            let suffix = match self.current.kind {
                TokenKind::BracketOpen => {
                    self.check_continued_line();
                    let begins_line = self.begins_line();
                    self.advance();
                    self.brackets += 1;
                    self.expression();
                    if self.at(TokenKind::Comma) {
                        self.pass_more_indices(open, begins_line);
                    }
                    self.close(TokenKind::BracketClose, open);
                    self.brackets -= 1;
                    ParseStep::Element(Span::new(open.start, self.previous.span.end))
                }
                TokenKind::ParenOpen => {
                    self.check_continued_line();
                    let count = self.arguments(TokenKind::ParenClose);
                    ParseStep::Call(Span::new(open.start, self.previous.span.end), count)
                }
                TokenKind::Less if !self.at_mistyped_modifier() => break,
                TokenKind::Modify | TokenKind::Less => {
                    let count = self.modifiers();
                    ParseStep::Modifiers(Span::new(open.start, self.previous.span.end), count)
                }
                _ => break,
            };
            self.step(suffix, start);
        }
    }

    /// `"<m" Mods ">"`, `Mods = Mod ModsTail`
    fn modifiers(&mut self) -> usize {
        let open = self.current.span;
        self.advance();
        self.brackets += 1;
        let outer = self.modifiers.replace(open.start);
        let mut count = 0;
        if self.enter() {
            count = self.modifier_list();
            self.leave();
            self.modifiers = outer;
            self.close(TokenKind::Greater, open);
        }
        self.modifiers = outer;
        self.brackets -= 1;
        count
    }

    /// Returns true if the current token is a `<` before a mistyped modifier: a word, and on the same line a value.
    fn at_mistyped_modifier(&self) -> bool {
        let mut ahead = self.lexer.clone();
        let [word, value] = [(); 2].map(|()| ahead.read().token);
        let is_near = || nearest(word.span.text(self.source), MODIFIERS.into_iter()).is_some();
        let between = || Span::new(word.span.end, value.span.start).text(self.source);
        // No statement begins with a number.
        let is_number = matches!(value.kind, TokenKind::Integer | TokenKind::Float);
        self.at(TokenKind::Less)
            && word.kind == TokenKind::Identifier
            && value.kind.begins_primary()
            && !matches!(value.kind, TokenKind::ParenOpen | TokenKind::BracketOpen)
            && !between().contains('\n')
            && (is_near() || is_number || value.span.text(self.source) == "vec3")
    }

    /// Reports a mistyped modifier and returns the kind that it is read as; `None` if no value follows it.
    fn mistyped_modifier(&mut self) -> Option<ModifierKind> {
        if !self.at(TokenKind::Identifier) || !self.lexer.peek().begins_primary() {
            return None;
        }
        let (text, span) = (self.text(), self.current.span);
        let message = format!("there is no modifier `{text}`");
        let near = nearest(text, MODIFIERS.into_iter());
        if let Some(found) = self.fault(codes::UNEXPECTED_TOKEN, span, message) {
            self.report(match &near {
                Some(near) => found
                    .with_hint(format!("did you mean `{near}`?"))
                    .with_fix(Fix::change(span, near, true)),
                None => found.with_hint("the modifiers are `scale`, `translate` and `rotate`"),
            });
        }
        // Errors after this one may be independent.
        self.reported = None;
        Some(match near.as_deref() {
            Some("scale") => ModifierKind::Scale,
            Some("rotate") => ModifierKind::Rotate,
            _ => ModifierKind::Translate,
        })
    }

    /// Reports a missing `,` before a modifier; returns true if there is one.
    fn lacks_modifier_comma(&mut self) -> bool {
        let (place, span) = (self.previous.span.end, self.current.span);
        if !self.current.kind.is_modifier() {
            return false;
        }
        let message = "a `,` is missing before this";
        if let Some(found) = self.fault(codes::UNEXPECTED_TOKEN, span, message) {
            self.report(found.with_fix(Fix::insert("Insert `,`", place, ",")));
        }
        true
    }

    /// `Mods`. Returns the number of modifiers.
    fn modifier_list(&mut self) -> usize {
        let mut count = 0;
        loop {
            let start = self.current.span.start;
            let kind = match self.current.kind {
                TokenKind::Scale => ModifierKind::Scale,
                TokenKind::Translate => ModifierKind::Translate,
                TokenKind::Rotate => ModifierKind::Rotate,
                _ => match self.mistyped_modifier() {
                    Some(kind) => kind,
                    None => {
                        self.unexpected("`scale`, `translate` or `rotate`");
                        while !self.begins_line()
                            && (self.current.kind.begins_primary() || self.at(TokenKind::Comma))
                        {
                            self.advance();
                        }
                        break;
                    }
                },
            };
            self.advance();
            self.binary(BinaryOperator::Add.level());
            self.step(ParseStep::Modifier(kind), start);
            count += 1;
            if self.at(TokenKind::Comma) {
                self.advance();
            } else if !self.lacks_modifier_comma() {
                break;
            }
        }
        count
    }

    /// `Args`, between brackets. Returns the number of arguments.
    fn arguments(&mut self, closer: TokenKind) -> usize {
        let open = self.current.span;
        self.advance();
        self.brackets += 1;
        let mut count = 0;
        if !self.at(closer) {
            loop {
                self.expression();
                count += 1;
                if self.at(TokenKind::Comma) {
                    self.advance();
                } else if self.lacks_comma() {
                    let place = self.previous.span.end;
                    let message = "a `,` is missing before this";
                    let span = self.current.span;
                    if let Some(found) = self.fault(codes::UNEXPECTED_TOKEN, span, message) {
                        self.report(found.with_fix(Fix::insert("Insert `,`", place, ",")));
                    }
                } else {
                    break;
                }
            }
        }
        self.close(closer, open);
        self.brackets -= 1;
        count
    }

    /// Reports a list that stands where one index is expected, and reads the rest of it, from the `,` after its first element.
    fn pass_more_indices(&mut self, open: Span, begins_line: bool) {
        let message = "`[ ]` after a value takes one index";
        if let Some(diagnostic) = self.fault(codes::UNEXPECTED_TOKEN, self.current.span, message) {
            let hint = "a `[` at the start of a line continues the line above: give the list a name, as in `list = [a, b]`";
            self.report(match begins_line {
                true => diagnostic.with_hint(hint),
                false => diagnostic,
            });
        }
        let mut count = 1;
        while self.at(TokenKind::Comma) {
            self.advance();
            self.expression();
            count += 1;
        }
        self.step(ParseStep::List(count), open.end);
    }

    /// Returns true if another argument seems to begin here: on the same line, and not an attribute.
    fn lacks_comma(&self) -> bool {
        self.current.kind.begins_primary()
            && !self.begins_line()
            && self.lexer.peek() != TokenKind::Arrow
    }

    /// `Prim`
    fn primary(&mut self) {
        let token = self.current;
        let start = token.span.start;
        let text = self.text();
        match token.kind {
            TokenKind::Integer => {
                self.operand(ParseStep::Integer(text.parse().unwrap_or(i32::MAX)))
            }
            TokenKind::Float => self.operand(ParseStep::Float(text.parse().unwrap_or(f64::MAX))),
            TokenKind::Text => {
                let value = string_value(text).unwrap_or_default();
                self.operand(ParseStep::Text(&value));
            }
            TokenKind::True => self.operand(ParseStep::Boolean(true)),
            TokenKind::False => self.operand(ParseStep::Boolean(false)),
            TokenKind::Identifier
                if uncapitalized(text).is_some() && self.lexer.peek() == TokenKind::BraceOpen =>
            {
                self.object();
            }
            TokenKind::Identifier => self.operand(ParseStep::Identifier(text)),
            TokenKind::Name => self.object(),
            TokenKind::Macro => self.macro_literal(),
            TokenKind::ParenOpen => {
                self.advance();
                self.brackets += 1;
                self.expression();
                if self.at(TokenKind::Comma) {
                    self.bare_vector(token.span);
                } else {
                    self.close(TokenKind::ParenClose, token.span);
                    self.step(ParseStep::Group, start);
                }
                self.brackets -= 1;
            }
            TokenKind::BracketOpen => {
                let count = self.arguments(TokenKind::BracketClose);
                self.step(ParseStep::List(count), start);
            }
            // A malformed number or string has been reported.
            TokenKind::Error => self.operand(ParseStep::Missing),
            _ => match self.angle_vector() {
                Some(place) => self.pass_angle_vector(place),
                None => self.missing(),
            },
        }
    }

    /// Reads the rest of an unnamed vector `(1, 2, 3)`, from the `,` after its first component.
    fn bare_vector(&mut self, open: Span) {
        let mut count = 1;
        while self.at(TokenKind::Comma) {
            self.advance();
            self.expression();
            count += 1;
        }
        let is_closed = self.at(TokenKind::ParenClose);
        self.close(TokenKind::ParenClose, open);
        let place = Span::new(open.start, self.previous.span.end);
        if is_closed {
            self.report(self.bare_vector_error(place, count));
        }
        self.step(ParseStep::List(count), open.start);
    }

    fn bare_vector_error(&self, place: Span, count: usize) -> Diagnostic {
        let is_colour = self.colour_start == Some(place.start);
        let (what, word) = match is_colour {
            true => ("colour", "rgb"),
            false => ("vector", "vec3"),
        };
        let message = format!("brackets alone do not make a {what}");
        let diagnostic = Diagnostic::error(codes::UNEXPECTED_TOKEN, place, message);
        if count != 3 {
            return diagnostic.with_hint(match is_colour {
                true => "a colour is `rgb(1, 0.5, 0)`",
                false => "a vector is `vec3(1, 2, 3)`, a list `[1, 2]`",
            });
        }
        let before = &self.source[..place.start as usize];
        let touches = before.ends_with(|c: char| c.is_ascii_alphanumeric());
        let blank = if touches { " " } else { "" };
        let title = format!("Insert `{word}`");
        let fix = Fix::insert(&title, place.start, &format!("{blank}{word}"));
        let value = quote(&format!("{word}{}", place.text(self.source)));
        diagnostic
            .with_hint(format!("write {value}"))
            .with_fix(fix.with_all())
    }

    /// Returns the span of `<1, 2, 3>`, if it begins with the current token and ends on the same line.
    fn angle_vector(&self) -> Option<Span> {
        let start = self.current.span.start;
        let rest = &self.source[start as usize..];
        let end = rest.find(['>', '\n', '{', '}', '"'])?;
        let is_vector = rest[..end].matches(',').count() == 2
            && !rest[..end].contains("--")
            && rest[end..].starts_with('>');
        let place = Span::new(start, start + end as u32 + 1);
        (self.at(TokenKind::Less) && is_vector).then_some(place)
    }

    /// Reports and skips `<1, 2, 3>`.
    fn pass_angle_vector(&mut self, place: Span) {
        let text = place.text(self.source);
        let written = format!("vec3({})", &text[1..text.len() - 1]);
        let message = "angle brackets do not make a vector";
        if let Some(found) = self.fault(codes::UNEXPECTED_TOKEN, place, message) {
            let fix = Fix::change(place, &written, true).with_all();
            let found = found.with_hint(format!("write {}", quote(&written)));
            self.report(found.with_fix(fix));
        }
        while self.current.span.start < place.end && !self.at(TokenKind::Eoi) {
            self.advance();
        }
        self.step(ParseStep::Missing, place.start);
    }

    fn operand(&mut self, step: ParseStep<'_>) {
        let start = self.current.span.start;
        self.advance();
        self.step(step, start);
    }

    /// `"Macro" "(" Params ")" "{" Stmts "}"`
    fn macro_literal(&mut self) {
        let start = self.current.span.start;
        self.advance();
        let open = self.current.span;
        let mut names: Vec<&str> = Vec::new();
        if self.accept(TokenKind::ParenOpen, "a `(`") {
            while self.at(TokenKind::Identifier) {
                let (name, span) = (self.text(), self.current.span);
                if names.contains(&name) {
                    let message = format!("the parameter `{name}` is listed twice");
                    self.report(Diagnostic::error(codes::DUPLICATE_PARAMETER, span, message));
                }
                names.push(name);
                self.operand(ParseStep::Parameter);
                if !self.at(TokenKind::Comma) {
                    break;
                }
                self.advance();
                if !self.at(TokenKind::Identifier) {
                    self.unexpected("the name of a parameter");
                }
            }
            self.close(TokenKind::ParenClose, open);
        }
        self.body();
        self.step(ParseStep::Macro(names.len()), start);
    }

    /// Warns about a quotient of whole numbers whose fraction is dropped; `first` is the number on the left, or its sign.
    fn check_fraction(&mut self, first: Token, left: Token, right: Token) {
        let is_next = || {
            let between = first.span.end as usize..left.span.start as usize;
            let text = self.source.get(between);
            text.is_some_and(|text| text.trim().is_empty())
        };
        let sign = match first.kind {
            TokenKind::Minus if is_next() => -1,
            _ if first == left => 1,
            _ => return,
        };
        let [a, b] = [left, right].map(|token| match token.kind {
            TokenKind::Integer => token.span.text(self.source).parse::<i32>().ok(),
            _ => None,
        });
        let (Some(a), Some(b)) = (a, b) else {
            return;
        };
        if b == 0 || a % b == 0 {
            return;
        }
        let a = sign * a;
        let place = first.span.to(right.span);
        let (text, quotient) = (quote(&format!("{a}/{b}")), a / b);
        let message = format!("{text} is {quotient}: `/` of whole numbers drops the fraction");
        let diagnostic = Diagnostic::warning(codes::DROPPED_FRACTION, place, message)
            .with_hint(format!("write `{a} / {b}.0` for the number"))
            .with_fix(Fix::insert("Insert `.0`", right.span.end, ".0"));
        self.report(diagnostic);
    }

    /// Warns about a line that continues the statement above, though it may be meant to begin one.
    fn check_continued_line(&mut self) {
        let Token { kind, span } = self.current;
        if !kind.may_continue_line() || self.brackets > 0 || !self.begins_line() {
            return;
        }
        let (indentation, line) = self.indentation(span.start);
        if indentation > self.indentation(self.statement_start).0 {
            return;
        }
        let sign = span.text(self.source);
        let message = format!("a line that begins with `{sign}` continues the line above");
        let diagnostic = Diagnostic::warning(codes::CONTINUES_LINE, span, message)
            .with_hint("indent the line further if that is intended")
            .with_fix(Fix::insert("Indent the line", line, "    "));
        self.report(diagnostic);
    }

    /// Returns the indentation of the line that contains an offset, in columns, and the line's start.
    fn indentation(&self, offset: u32) -> (usize, u32) {
        let before = &self.source[..offset as usize];
        let start = before.rfind('\n').map_or(0, |end| end + 1);
        let line = &self.source[start..];
        let blanks = line.bytes().take_while(|byte| matches!(byte, b' ' | b'\t'));
        let columns = blanks.fold(0, |column, byte| match byte {
            b'\t' => column / 4 * 4 + 4,
            _ => column + 1,
        });
        (columns, start as u32)
    }
}

fn binary_operator(kind: TokenKind) -> Option<BinaryOperator> {
    Some(match kind {
        TokenKind::Or => BinaryOperator::Or,
        TokenKind::And => BinaryOperator::And,
        TokenKind::LessEqual => BinaryOperator::LessEqual,
        TokenKind::GreaterEqual => BinaryOperator::GreaterEqual,
        TokenKind::Less => BinaryOperator::Less,
        TokenKind::Greater => BinaryOperator::Greater,
        TokenKind::Equal => BinaryOperator::Equal,
        TokenKind::NotEqual => BinaryOperator::NotEqual,
        TokenKind::Plus => BinaryOperator::Add,
        TokenKind::Minus => BinaryOperator::Subtract,
        TokenKind::Caret => BinaryOperator::Intersect,
        TokenKind::Star => BinaryOperator::Multiply,
        TokenKind::Slash => BinaryOperator::Divide,
        TokenKind::Percent => BinaryOperator::Remainder,
        _ => return None,
    })
}
