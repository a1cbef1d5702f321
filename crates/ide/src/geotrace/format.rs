//! The canonical layout: it changes the appearance of a text, but never its meaning.
//!
//! Each declaration starts on its own line; continuation lines are indented. There are blanks around `=`, `:`, `@`, the
//! operators of sets and between summands, and after `,`, but never inside brackets. How words are joined (`2piu`), line
//! breaks within a declaration and the text of comments are left to the author. Text that cannot be read remains unchanged,
//! with the white space before it: it may be a comment or a sign of another notation. The result is read again: if a single
//! token would be read differently, the text remains unchanged.

use std::hash::{DefaultHasher, Hash, Hasher};

use syntax::diagnostic::Code;
use syntax::geotrace::codes;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::{GeotraceAnalysis, Lexeme};
use super::meaning::Meanings;
use crate::edit::{self, Edit};
use crate::text::Text;

/// The indentation of continuation lines.
const INDENT: &str = "    ";

/// Returns the edits that convert a text, or the declarations that touch a range of it, to the canonical layout; empty
/// if nothing changes.
pub fn format(analysis: &GeotraceAnalysis, range: Option<Span>) -> Vec<Edit> {
    let edits = gaps(analysis, range);
    if edits.is_empty() {
        return edits;
    }
    let after = GeotraceAnalysis::new(edit::apply(analysis.text(), &edits));
    match TextReading::of(analysis) == TextReading::of(&after) {
        true => edits,
        false => Vec::new(),
    }
}

/// Returns a text in the canonical layout. Only one analysis is in memory at a time: the analysis of a text that
/// consists only of tokens is hundreds of times larger than the text.
pub fn laid_out(text: &str) -> String {
    let (before, result) = {
        let analysis = GeotraceAnalysis::new(text);
        let edits = gaps(&analysis, None);
        if edits.is_empty() {
            return text.to_owned();
        }
        (TextReading::of(&analysis), edit::apply(text, &edits))
    };
    match TextReading::of(&GeotraceAnalysis::new(&result)) == before {
        true => result,
        false => text.to_owned(),
    }
}

/// Returns the edits of the white space between tokens.
fn gaps(analysis: &GeotraceAnalysis, range: Option<Span>) -> Vec<Edit> {
    let wanted = range.map(|range| whole_items(analysis, range));
    let text: &dyn Text = analysis.document();
    let first_line = wanted.and_then(|wanted| text.line_start(text.line(wanted.start)));
    // A range is formatted from the end of the token before it: no declaration is open there.
    let first = wanted.map_or(0, |wanted| {
        analysis.document().tokens_ended(wanted.start) as usize
    });
    let last = match wanted {
        Some(wanted) => analysis.document().tokens_begun(wanted.end) as usize,
        None => analysis.token_count(),
    };
    let mut before = first.checked_sub(1).and_then(|k| analysis.token(k));
    let mut edits = Vec::new();
    let mut layout = Layout::default();
    let new_line = new_line(analysis);
    let mark = match analysis.slice(Span::new(0, analysis.len().min(3))) == "\u{FEFF}" {
        true => 3,
        false => 0,
    };
    let mut end = before.map_or(mark, |token| token.span.end);
    let whole = Span::new(0, analysis.len());
    let mut unreadable = unreadable(analysis, wanted.unwrap_or(whole)).peekable();
    for token in analysis.tokens(first..last.max(first)) {
        let gap = Span::new(end, token.span.start);
        let written = analysis.slice(gap);
        let next = layout.gap(&written, before, token);
        let next = next.replace('\n', new_line);
        let inside = wanted.is_none_or(|wanted| wanted.start <= gap.start && gap.end <= wanted.end);
        // The indentation of the first declaration is its own, and the lines above are not.
        let is_first =
            wanted.is_some_and(|wanted| wanted.start == gap.end) && first_line >= Some(gap.start);
        while unreadable
            .next_if(|part| part.end <= token.span.start)
            .is_some()
        {}
        let stays = unreadable.peek().is_some_and(|part| {
            // A declaration starts a line all the same.
            let starts_line =
                matches!(token.kind, TokenKind::Declare(_)) && gap.start <= part.start;
            part.start <= token.span.start && !starts_line
        });
        if (inside || is_first) && !stays && next != written {
            let edit = Edit::replace(gap, next);
            edits.extend(edit.clipped(first_line.unwrap_or(0), text));
        }
        layout.pass(token.kind);
        end = token.span.end;
        before = Some(token);
    }
    if wanted.is_none() {
        let rest = Span::new(end, analysis.len());
        let last = if before.is_none() { "" } else { new_line };
        if analysis.slice(rest) != last {
            edits.push(Edit::replace(rest, last));
        }
    }
    edits
}

/// Returns the parts of a range that cannot be read: up to the `;` after them, with the white space and the comments before
/// them.
fn unreadable(analysis: &GeotraceAnalysis, range: Span) -> impl Iterator<Item = Span> {
    let document = analysis.document();
    let parts = document.chunks_in(range).filter(|(chunk, _)| {
        let mut errors = document.errors(*chunk);
        errors.any(|(code, _)| is_of_syntax(code))
    });
    parts.map(|(chunk, start)| Span::new(start, start + document.chunk_text(chunk).len() as u32))
}

/// Returns true for the code of an error after which the text may not have been read.
fn is_of_syntax(code: Code) -> bool {
    matches!(
        code,
        codes::BAD_CHARACTER
            | codes::BAD_NUMBER
            | codes::COMPONENT_INDEX
            | codes::EXPECTED_DECLARATION
            | codes::MISMATCHED_BRACKET
            | codes::MISSING_ARGUMENT
            | codes::MISSING_SEMICOLON
            | codes::TOO_DEEP
            | codes::UNCLOSED_BRACKET
            | codes::UNEXPECTED_TOKEN
    )
}

/// Returns the text's line ending: that of its first line that is not blank, so that the conventions of other systems are
/// preserved. Blank lines at the start are removed.
fn new_line(analysis: &GeotraceAnalysis) -> &'static str {
    let document = analysis.document();
    let starts = (1..).map_while(|line| document.line_start(line));
    let ends = starts.clone().skip(1);
    let mut lines = starts.zip(ends).map(|(start, end)| Span::new(start, end));
    let first = lines.find_map(|line| {
        let text = document.slice(line)?;
        (!text.trim().is_empty()).then_some(text)
    });
    match first {
        Some(line) if line.ends_with("\r\n") => "\r\n",
        _ => "\n",
    }
}

/// Returns the range from the first token of the first declaration that touches the range to the end of the last such
/// declaration.
fn whole_items(analysis: &GeotraceAnalysis, range: Span) -> Span {
    // The previous declaration may end where the range starts.
    let first = analysis.document().declarations_begun(range.start) as usize;
    let items = analysis.items_from(first.saturating_sub(1));
    let items = items.map(|item| item.span);
    items
        .skip_while(|span| span.end < range.start)
        .take_while(|span| span.start <= range.end)
        .reduce(Span::to)
        .unwrap_or(Span::new(range.start, range.start))
}

/// The reading of a text: two texts with the same reading have the same tokens with the same text.
#[derive(PartialEq)]
struct TextReading {
    tokens: usize,
    /// A hash of the meaning and text of each token, of the faulty declarations, and of the errors.
    digest: u64,
}

impl TextReading {
    fn of(analysis: &GeotraceAnalysis) -> Self {
        let meanings = Meanings::of(analysis);
        let tokens = analysis.token_count();
        let mut digest = DefaultHasher::new();
        for token in analysis.tokens(0..tokens) {
            meanings.get(token.kind).hash(&mut digest);
            token.text.trim_end().hash(&mut digest);
        }
        for item in analysis.items() {
            item.faulty.hash(&mut digest);
        }
        let document = analysis.document();
        for (code, _) in document.chunks().flat_map(|chunk| document.errors(chunk)) {
            code.hash(&mut digest);
        }
        Self {
            tokens,
            digest: digest.finish(),
        }
    }
}

/// The state of the pass over the tokens.
#[derive(Default)]
struct Layout {
    /// True if a declaration has begun and not ended.
    inside: bool,
    /// True if the previous token was a prefix sign rather than a binary operator.
    after_sign: bool,
    /// True if the previous token ends an operand.
    after_operand: bool,
}

impl Layout {
    /// Returns the white space before a token, which is `written` at present.
    fn gap(&self, written: &str, before: Option<Lexeme<'_>>, token: Lexeme<'_>) -> String {
        let lines = written.matches('\n').count();
        let Some(before) = before else {
            return String::new();
        };
        let opens = matches!(token.kind, TokenKind::Declare(_)) && !self.inside;
        if before.kind == TokenKind::Comment || lines > 0 && token.kind == TokenKind::Comment {
            return self.new_line(lines, opens || !self.inside);
        }
        if token.kind == TokenKind::Comment {
            // The columns of comments are left to the author.
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
        if written.is_empty()
            && matches!(token.text, "=" | ">")
            && matches!(before.text, "-" | ":" | "=" | "<" | ">" | "!")
        {
            // These form one sign of another language, such as `<=`.
            return String::new();
        }
        let spaced = self.is_spaced(before.kind, token.kind);
        if spaced || !written.is_empty() {
            " ".to_owned()
        } else {
            String::new()
        }
    }

    /// Returns a new line, with a blank line before it if the author left one.
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
        let relation = |kind| {
            matches!(
                kind,
                TokenKind::Equals
                    | TokenKind::Colon
                    | TokenKind::At
                    | TokenKind::Bar
                    | TokenKind::Ampersand
                    | TokenKind::Backslash
            )
        };
        let sum = |kind| matches!(kind, TokenKind::Plus | TokenKind::Minus);
        relation(before)
            || relation(token)
            || matches!(before, TokenKind::Comma | TokenKind::Declare(_))
            || sum(token) && self.after_operand
            || sum(before) && !self.after_sign
    }

    fn pass(&mut self, kind: TokenKind) {
        match kind {
            TokenKind::Comment => return,
            TokenKind::Declare(_) => {
                self.inside = true;
            }
            TokenKind::Semicolon => self.inside = false,
            _ => {}
        }
        self.after_sign = matches!(kind, TokenKind::Plus | TokenKind::Minus) && !self.after_operand;
        self.after_operand = matches!(
            kind,
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
