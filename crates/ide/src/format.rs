//! The canonical layout: how a text is written, never what it means.
//!
//! Each declaration starts a line of its own; lines that go on are indented; blanks stand around `=`, `:`, `@` and
//! between summands, after `,` and never inside brackets. How words are joined (`2piu`), where lines break within a
//! declaration and what comments say is the writer's. What comes out is read again: where a single token would be read
//! otherwise, the text stays as it is.

use syntax::span::Span;
use syntax::token::{Token, TokenKind};

use crate::edit::{self, Edit};
use crate::reading::Reading;

/// The indentation of lines that go on.
const INDENT: &str = "    ";

/// The edits that bring a text, or the declarations that touch a range of it, into the canonical layout. Empty where
/// nothing is to be done.
pub fn format(reading: &Reading, range: Option<Span>) -> Vec<Edit> {
    let edits = gaps(reading, range);
    if edits.is_empty() || reads_alike(reading, &edit::apply(reading.text(), &edits)) {
        edits
    } else {
        Vec::new()
    }
}

/// The edits of the white space between tokens.
fn gaps(reading: &Reading, range: Option<Span>) -> Vec<Edit> {
    let text = reading.text();
    let tokens = reading.tokens();
    let wanted = range.map(|range| whole_items(reading, range));
    let mut edits = Vec::new();
    let mut layout = Layout::default();
    let new_line = new_line(text);
    let mark = if text.starts_with('\u{FEFF}') { 3 } else { 0 };
    let mut end = mark;
    for (k, token) in tokens.iter().enumerate() {
        let gap = Span::new(end, token.span.start);
        let next = layout.gap(text, k.checked_sub(1).map(|k| tokens[k]), *token, gap);
        let next = next.replace('\n', new_line);
        let inside = wanted.is_none_or(|wanted| wanted.start <= gap.start && gap.end <= wanted.end);
        if inside && next != gap.text(text) {
            edits.push(Edit::replace(gap, next));
        }
        layout.pass(*token);
        end = token.span.end;
    }
    let rest = Span::new(end, text.len() as u32);
    let last = if tokens.is_empty() { "" } else { new_line };
    if wanted.is_none() && rest.text(text) != last {
        edits.push(Edit::replace(rest, last));
    }
    edits
}

/// What ends lines: what ends the first, so that a text of another system stays one.
fn new_line(text: &str) -> &'static str {
    match text.find('\n') {
        Some(end) if text[..end].ends_with('\r') => "\r\n",
        _ => "\n",
    }
}

/// From the first token of the first declaration that touches the range to the end of the last.
fn whole_items(reading: &Reading, range: Span) -> Span {
    let items = reading.items().iter().map(|item| item.span);
    items
        .filter(|span| span.start <= range.end && range.start <= span.end)
        .reduce(Span::to)
        .unwrap_or(Span::new(range.start, range.start))
}

/// Whether a text has the same tokens, written alike.
fn reads_alike(reading: &Reading, text: &str) -> bool {
    let again = Reading::new(text);
    let tokens = |reading: &Reading| -> Vec<(TokenKind, String)> {
        let tokens = reading.tokens().iter();
        tokens
            .map(|token| {
                (
                    token.kind,
                    token.span.text(reading.text()).trim_end().to_owned(),
                )
            })
            .collect()
    };
    tokens(reading) == tokens(&again)
        && reading.items().len() == again.items().len()
        && reading
            .items()
            .iter()
            .zip(again.items())
            .all(|(one, other)| one.faulty == other.faulty)
}

/// What has been passed on the way through the tokens.
#[derive(Default)]
struct Layout {
    /// A declaration has begun and not ended.
    inside: bool,
    /// The last token was a sign before an operand rather than between two.
    after_sign: bool,
    /// Whether the token before ends an operand.
    after_operand: bool,
}

impl Layout {
    /// The white space before a token that is now behind `gap`.
    fn gap(&self, text: &str, before: Option<Token>, token: Token, gap: Span) -> String {
        let written = gap.text(text);
        let lines = written.matches('\n').count();
        let Some(before) = before else {
            return String::new();
        };
        let opens = matches!(token.kind, TokenKind::Declare(_)) && !self.inside;
        if before.kind == TokenKind::Comment || lines > 0 && token.kind == TokenKind::Comment {
            return self.new_line(lines, opens || !self.inside);
        }
        if token.kind == TokenKind::Comment {
            // Columns of comments are the writer's.
            return if written.is_empty() {
                " ".to_owned()
            } else {
                written.to_owned()
            };
        }
        if before.kind == TokenKind::Semicolon || opens {
            return self.new_line(lines.max(1), true);
        }
        let tight = self.is_tight(before.kind, token.kind);
        if lines > 0 && !matches!(token.kind, TokenKind::Semicolon | TokenKind::Comma) {
            return self.new_line(1, false);
        }
        if tight {
            return String::new();
        }
        let spaced = self.is_spaced(before.kind, token.kind);
        if spaced || !written.is_empty() {
            " ".to_owned()
        } else {
            String::new()
        }
    }

    /// A new line, with a blank one before it where the writer left some.
    fn new_line(&self, lines: usize, outside: bool) -> String {
        let mut gap = "\n".repeat(if outside { lines.clamp(1, 2) } else { 1 });
        if !outside {
            gap.push_str(INDENT);
        }
        gap
    }

    fn is_tight(&self, before: TokenKind, token: TokenKind) -> bool {
        matches!(
            before,
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen
        ) || matches!(
            token,
            TokenKind::ParenClose
                | TokenKind::BracketClose
                | TokenKind::BraceClose
                | TokenKind::Comma
                | TokenKind::Semicolon
        )
    }

    fn is_spaced(&self, before: TokenKind, token: TokenKind) -> bool {
        let relation = |kind| matches!(kind, TokenKind::Equals | TokenKind::Colon | TokenKind::At);
        let sum = |kind| matches!(kind, TokenKind::Plus | TokenKind::Minus);
        relation(before)
            || relation(token)
            || matches!(before, TokenKind::Comma | TokenKind::Declare(_))
            || sum(token) && self.after_operand
            || sum(before) && !self.after_sign
    }

    fn pass(&mut self, token: Token) {
        match token.kind {
            TokenKind::Comment => return,
            TokenKind::Declare(_) => {
                self.inside = true;
            }
            TokenKind::Semicolon => self.inside = false,
            _ => {}
        }
        self.after_sign =
            matches!(token.kind, TokenKind::Plus | TokenKind::Minus) && !self.after_operand;
        self.after_operand = matches!(
            token.kind,
            TokenKind::Number(_)
                | TokenKind::Constant(_)
                | TokenKind::Variable(_)
                | TokenKind::Undefined
                | TokenKind::Error
                | TokenKind::ParenClose
                | TokenKind::BracketClose
                | TokenKind::BraceClose
        );
    }
}
