//! The canonical layout: one attribute per line, four spaces per level. Lines of statements are neither joined nor split. A
//! script that cannot be read is left unchanged.
//!
//! White space in a script has no meaning except between two tokens that would otherwise merge; the tokens are compared
//! afterwards.

use std::collections::HashSet;

use syntax::crt::codes::CONTINUES_LINE;
use syntax::crt::document::Document;
use syntax::crt::lexer::Lexer;
use syntax::crt::token::{Token, TokenKind};
use syntax::diagnostic::Severity;
use syntax::span::Span;

use super::CrtAnalysis;
use super::names::ScriptNames;
use crate::edit::{Edit, apply};
use crate::text::Text;

/// The number of columns of a level.
const LEVEL: usize = 4;

/// Returns the edits that format the text, or the lines of it that begin in a range, or in which it begins.
pub(super) fn format(analysis: &CrtAnalysis, range: Option<Span>) -> Vec<Edit> {
    let text = analysis.snapshot_text().string();
    // A script with run-time errors is formatted all the same.
    let read = Document::new(&text, &());
    let found = read.map_or_else(|_| Vec::new(), |document| document.all_diagnostics());
    if found.iter().any(|it| it.severity == Severity::Error) {
        return Vec::new();
    }
    let continuing = found.iter().filter(|it| it.code == CONTINUES_LINE);
    let continuing = continuing.map(|it| it.span.start).collect();
    let tokens = analysis.all_tokens();
    let mut edits = lay_out(analysis, &text, &tokens, &continuing);
    if words(&text) != words(&apply(&text, &edits)) {
        return Vec::new();
    }
    if let Some(range) = range {
        let snapshot = analysis.snapshot_text();
        let line = snapshot.line(range.start);
        let start = snapshot.line_start(line).unwrap_or(range.start);
        edits.retain(|edit| edit.span.end >= start && edit.span.end <= range.end);
        let edits = edits.into_iter();
        return edits
            .filter_map(|edit| edit.clipped(start, snapshot))
            .collect();
    }
    edits
}

/// Returns the tokens of a text with their text.
fn words(text: &str) -> Vec<(TokenKind, &str)> {
    let mark = if text.starts_with('\u{FEFF}') { 3 } else { 0 };
    let mut lexer = Lexer::new(text, mark);
    let tokens = std::iter::from_fn(|| {
        let token = lexer.read().token;
        (token.kind != TokenKind::Eoi).then(|| (token.kind, token.span.text(text)))
    });
    tokens.collect()
}

/// An open bracket.
struct OpenBracket {
    /// The indentation of the lines in it.
    inside: usize,
    /// The indentation of the line that opens it.
    outside: usize,
    /// It is a brace: a line in it that begins no statement or attribute continues the line above.
    is_brace: bool,
    /// The indentation of the line on which the statement around it begins.
    statement: usize,
}

/// The places where lines begin.
struct LineStarts {
    /// Those of statements and attributes.
    all: HashSet<u32>,
    /// Those that have a line of their own: the attributes of objects with several attributes, and the closing braces of
    /// these objects.
    alone: HashSet<u32>,
}

impl LineStarts {
    fn of(names: &ScriptNames) -> Self {
        let mut all: HashSet<u32> = names.starts.iter().copied().collect();
        let mut alone: HashSet<u32> = HashSet::new();
        for object in &names.objects {
            let attributes = object.attributes.iter().map(|(span, _)| span.start);
            all.extend(attributes.clone());
            if object.attributes.len() > 1 {
                alone.extend(attributes);
                alone.insert(object.braces.end.saturating_sub(1));
            }
        }
        Self { all, alone }
    }
}

/// Returns the indentation of a line in a bracket, or in none, that begins with this token; `is_start` is true if the token
/// begins a statement or an attribute.
fn indentation_of(token: Token, bracket: Option<&OpenBracket>, is_start: bool) -> usize {
    let closes = is_closer(token.kind);
    let begins = is_start || matches!(token.kind, TokenKind::Comment | TokenKind::Else);
    match bracket {
        Some(bracket) if closes => bracket.outside,
        Some(bracket) if !bracket.is_brace || begins => bracket.inside,
        Some(bracket) => bracket.inside + LEVEL,
        None if begins || closes => 0,
        None => LEVEL,
    }
}

/// Returns the indentation of a line that begins with `+`, `-`, `^`, `[` or `(` and continues the statement above, whose line
/// has the indentation `statement`. A line with a warning must not be indented further, and others must be.
fn continued(usual: usize, statement: usize, has_warning: bool) -> usize {
    match has_warning {
        true => usual.min(statement),
        false => usual.max(statement + LEVEL),
    }
}

/// Formats a text. The lines that begin at `continuing` have a warning: they remain in the column of their statement, so that
/// the warning remains.
fn lay_out(
    analysis: &CrtAnalysis,
    text: &str,
    tokens: &[Token],
    continuing: &HashSet<u32>,
) -> Vec<Edit> {
    let new_line = new_line(text);
    let names = analysis.names();
    let line_starts = LineStarts::of(names);
    let statements: HashSet<u32> = names.starts.iter().copied().collect();
    let modifier_ends: HashSet<u32> = names.modifier_ends.iter().copied().collect();
    let mut edits = Vec::new();
    let mut open: Vec<OpenBracket> = Vec::new();
    let mut indentation = 0;
    // The indentation of the line on which the current statement begins. It is counted from a statement at top level on, if
    // one begins within the line: the parser reads these one by one.
    let (mut statement, mut counted) = (0, 0);
    let mut previous: Option<Token> = None;
    let mut is_prefix = false;
    for &token in tokens {
        let start = token.span.start;
        let before = previous.map_or(0, |it| it.span.end);
        let gap = Span::new(before, start);
        let old = gap.text(text);
        let breaks = old.matches('\n').count();
        let closes = is_closer(token.kind);
        let is_own = line_starts.alone.contains(&start);
        let new = match previous {
            None => old.chars().filter(|c| *c == '\u{FEFF}').collect(),
            Some(_) if breaks > 0 || is_own => {
                let has_warning = continuing.contains(&start);
                let is_start = line_starts.all.contains(&start);
                indentation = indentation_of(token, open.last(), is_start || has_warning);
                let is_bare = open.last().is_none_or(|it| it.is_brace);
                if !is_start && is_bare && token.kind.may_continue_line() {
                    indentation = continued(indentation, statement, has_warning);
                }
                counted = indentation;
                let lines = if breaks > 1 && !closes { 2 } else { 1 };
                format!("{}{}", new_line.repeat(lines), " ".repeat(indentation))
            }
            Some(_) if token.kind == TokenKind::Comment => match old.is_empty() {
                true => " ".to_owned(),
                false => old.to_owned(),
            },
            Some(last) => {
                let end = modifier_ends.contains(&start);
                let is_spaced = !end && is_spaced(last, token, is_prefix, &modifier_ends);
                if is_spaced { " " } else { "" }.to_owned()
            }
        };
        if new != old {
            edits.push(Edit::replace(gap, new));
        }
        if statements.contains(&start) {
            if open.is_empty() && breaks == 0 {
                counted = 0;
            }
            statement = counted;
        }
        if closes && let Some(bracket) = open.pop() {
            statement = bracket.statement;
        }
        if matches!(
            token.kind,
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen
        ) {
            open.push(OpenBracket {
                inside: indentation + LEVEL,
                outside: indentation,
                is_brace: token.kind == TokenKind::BraceOpen,
                statement,
            });
        }
        if token.kind != TokenKind::Comment {
            let is_sign = matches!(
                token.kind,
                TokenKind::Plus | TokenKind::Minus | TokenKind::Not
            );
            let after_operand = previous_operand(tokens, token, &modifier_ends);
            is_prefix = is_sign && !after_operand;
        }
        previous = Some(token);
    }
    if let Some(last) = previous {
        let rest = Span::new(last.span.end, text.len() as u32);
        if rest.text(text) != new_line {
            edits.push(Edit::replace(rest, new_line));
        }
    }
    edits
}

/// Returns the text's line ending, which is that of its first line.
fn new_line(text: &str) -> &'static str {
    let first = text.split_inclusive('\n').next();
    match first.is_some_and(|line| line.ends_with("\r\n")) {
        true => "\r\n",
        false => "\n",
    }
}

fn is_closer(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose
    )
}

/// Returns true if the token before `token` ends an operand, so that a sign between them is not a prefix.
fn previous_operand(tokens: &[Token], token: Token, modifier_ends: &HashSet<u32>) -> bool {
    let index = tokens.partition_point(|it| it.span.start < token.span.start);
    let before = tokens[..index].iter().rev();
    let mut before = before.filter(|it| it.kind != TokenKind::Comment);
    before
        .next()
        .is_some_and(|it| ends_operand(*it, modifier_ends))
}

fn ends_operand(token: Token, modifier_ends: &HashSet<u32>) -> bool {
    is_closer(token.kind)
        || matches!(
            token.kind,
            TokenKind::Integer
                | TokenKind::Float
                | TokenKind::Text
                | TokenKind::Identifier
                | TokenKind::True
                | TokenKind::False
        )
        || modifier_ends.contains(&token.span.start)
}

/// Returns true if there is a blank between two tokens of a line.
fn is_spaced(last: Token, token: Token, is_prefix: bool, modifier_ends: &HashSet<u32>) -> bool {
    use TokenKind::{
        BraceClose, BraceOpen, BracketClose, BracketOpen, Comma, Minus, Modify, ParenClose,
        ParenOpen,
    };
    match (last.kind, token.kind) {
        (BraceOpen, BraceClose) => false,
        (ParenOpen | BracketOpen | Modify, _) => false,
        (_, ParenClose | BracketClose | Comma) => false,
        // Two of them would begin a comment.
        (Minus, Minus) => true,
        _ if is_prefix => false,
        (_, ParenOpen | BracketOpen) => !ends_operand(last, modifier_ends),
        _ => true,
    }
}
