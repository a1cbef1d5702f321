//! Ambiguity lints of products: warnings about factors that look like a component, one number, an interval or a vector.

use super::Parser;
use super::lints::is_bracket;
use super::messages::quote;
use crate::geotrace::actions::Actions;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::symbols::NameScope;
use crate::geotrace::token::TokenKind;
use crate::span::Span;

/// Returns true for white space within a line.
fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

impl<A: Actions, S: NameScope> Parser<'_, '_, A, S> {
    /// `v[1]`, `v(1)`: looks like a component. The current token is a factor after a product.
    #[inline]
    pub(super) fn warn_index(&mut self, product: Span) {
        let touches = self.previous.span.end == self.current.span.start;
        let may_be_index = match self.current.kind {
            TokenKind::BracketOpen => touches,
            // A product with a number is usual, but not in this order with a vector.
            TokenKind::ParenOpen => touches && self.is_vector(),
            _ => false,
        };
        if !may_be_index {
            return;
        }
        if self.previous.kind.is_value() {
            self.warn_brackets_behind(self.previous.span);
        } else if is_bracket(product.text(self.source)) {
            self.warn_brackets_behind(product);
        }
    }

    /// Returns true if the previous token is the name of a declared point or vector.
    fn is_vector(&self) -> bool {
        let TokenKind::Constant(id) = self.previous.kind else {
            return false;
        };
        let keyword = self.parsed.symbol(id).keyword;
        matches!(
            keyword,
            Some(DeclarationKeyword::Point | DeclarationKeyword::Vector)
        )
    }

    /// `1 000`, `3.14.15`, `2. 3`: looks like one number. The current token is a factor after a product.
    #[inline]
    pub(super) fn warn_numbers(&mut self, product: Span) {
        if matches!(self.current.kind, TokenKind::Number(_))
            && (matches!(self.previous.kind, TokenKind::Number(_))
                || self.previous.span.end == self.current.span.start)
        {
            self.warn_joined_numbers(product);
        }
    }

    #[cold]
    fn warn_joined_numbers(&mut self, product: Span) {
        let next = self.current.span;
        let first = match self.previous.kind {
            TokenKind::Number(_) | TokenKind::Variable(_) | TokenKind::Constant(_) => {
                self.previous.span
            }
            _ if is_bracket(product.text(self.source)) => product,
            _ => return,
        };
        if first.start < self.lints.numbers_end {
            return;
        }
        let between = Span::new(first.end, next.start).text(self.source);
        if first.text(self.source).ends_with('.') {
            self.warn_pointed_number(first, between, next);
            return;
        }
        let is_fraction = between.is_empty() && next.text(self.source).starts_with('.');
        let is_group = |text: &str| text.len() == 3 && text.bytes().all(|it| it.is_ascii_digit());
        let is_grouped = between.bytes().all(is_blank)
            && !between.is_empty()
            && first
                .text(self.source)
                .bytes()
                .all(|it| it.is_ascii_digit())
            && first.end - first.start <= 3
            && is_group(next.text(self.source));
        if !is_fraction && !is_grouped {
            return;
        }
        let mut end = next.end;
        while is_grouped
            && let rest = &self.source[end as usize..]
            && let blanks = rest.bytes().take_while(|byte| is_blank(*byte)).count()
            && let group = &rest[blanks..]
            && let length = group.bytes().take_while(u8::is_ascii_alphanumeric).count()
            && blanks > 0
            && is_group(&group[..length])
        {
            end += (blanks + length) as u32;
        }
        self.lints.numbers_end = end;
        let place = first.to(Span::new(next.start, end));
        let written = place.text(self.source);
        let parts: Vec<&str> = match is_grouped {
            true => written.split_ascii_whitespace().collect(),
            false => vec![first.text(self.source), next.text(self.source)],
        };
        let read = parts.join("*");
        let message = format!("{} is read as {}, a product", quote(written), quote(&read));
        if is_fraction {
            let hint = format!("write {} if that is meant", quote(&read));
            self.warn(place, message, hint, &[&read]);
            return;
        }
        let meant = parts.concat();
        let (one, product) = (quote(&meant), quote(&read));
        let hint = format!("write {one} for the number, or {product} if that is meant");
        self.warn(place, message, hint, &[&meant, &read]);
    }

    /// `0..1`, `2. 3`: looks like an interval in another notation, or like one number.
    #[cold]
    fn warn_pointed_number(&mut self, first: Span, between: &str, next: Span) {
        let number = first.text(self.source).trim_end_matches('.');
        let behind = next.text(self.source);
        let place = first.to(next);
        let read = format!("{number}*{behind}");
        let written = quote(place.text(self.source));
        let message = format!("{written} is read as {}, a product", quote(&read));
        let is_plain = behind.bytes().all(|byte| byte.is_ascii_digit());
        if let Some(end) = behind.strip_prefix('.').filter(|_| between.is_empty()) {
            let keyword = self.state.keyword;
            let has_intervals = keyword.is_some_and(|keyword| {
                keyword.may_have_parameters() && !self.state.in_body
                    || matches!(
                        keyword,
                        DeclarationKeyword::Param | DeclarationKeyword::Grid
                    )
            });
            // There it is an error.
            if !has_intervals {
                let interval = quote(&format!("[{number}, {end}]"));
                let product = quote(&read);
                let hint = format!(
                    "an interval is written {interval}; write {product} if the product is meant"
                );
                self.warn(place, message, hint, &[&read]);
            }
        } else if is_plain && between.bytes().all(is_blank) {
            let meant = format!("{number}.{behind}");
            let (one, product) = (quote(&meant), quote(&read));
            let hint = format!("write {one} for the number, or {product} if that is meant");
            self.warn(place, message, hint, &[&meant, &read]);
        }
    }

    /// `(1 2 3)`: looks like a vector. The span is that of a bracket whose content ends with a number.
    pub(super) fn warn_row(&mut self, bracket: Span) {
        let inside = Span::new(bracket.start + 1, bracket.end - 1).text(self.source);
        let is_number = |part: &str| {
            let mut signs = part.bytes();
            signs.all(|byte| byte.is_ascii_digit() || byte == b'.')
        };
        let parts: Vec<&str> = inside.split_ascii_whitespace().collect();
        let is_known = bracket.start < self.lints.numbers_end;
        if parts.len() < 2 || is_known || !parts.iter().all(|part| is_number(part)) {
            return;
        }
        let [open, close] =
            [bracket.start, bracket.end - 1].map(|at| Span::new(at, at + 1).text(self.source));
        let meant = format!("{open}{}{close}", parts.join(", "));
        let read = format!("{open}{}{close}", parts.join("*"));
        let written = quote(bracket.text(self.source));
        let (vector, product) = (quote(&meant), quote(&read));
        let message = format!("{written} is read as {product}, a product");
        let hint = format!("write {vector} for the vector, or {product} if that is meant");
        self.warn(bracket, message, hint, &[&meant, &read]);
    }

    #[cold]
    fn warn_brackets_behind(&mut self, value: Span) {
        let bracket = self.current.span;
        let behind = &self.source[bracket.end as usize..];
        let digits = behind.bytes().take_while(u8::is_ascii_digit).count();
        let is_closed = match bracket.text(self.source) {
            "[" => behind[digits..].starts_with(']'),
            // Other numbers are no components of a point or a vector.
            _ => matches!(&behind[..digits], "1" | "2" | "3") && behind[digits..].starts_with(')'),
        };
        if digits == 0 || !is_closed {
            return;
        }
        let (name, index) = (value.text(self.source), &behind[..digits]);
        let (meant, read) = (format!("{name}_{index}"), format!("{name} {index}"));
        let place = Span::new(value.start, bracket.end + digits as u32 + 1);
        let written = quote(place.text(self.source));
        let (read_as, component) = (quote(&read), quote(&meant));
        let message = format!("{written} is read as {read_as}, a product");
        if index.bytes().all(|digit| digit == b'0') {
            let first = quote(&format!("{name}_1"));
            let hint = format!("components count from 1: write {first} for the first one");
            self.warn(place, message, hint, &[]);
            return;
        }
        let hint = format!("write {component} for the component, or {read_as} if that is meant");
        self.warn(place, message, hint, &[&meant, &read]);
    }
}
