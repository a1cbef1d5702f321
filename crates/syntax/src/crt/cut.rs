//! The ends of the pieces of a script, found without parsing it.
//!
//! A statement has no terminator: it ends before a token that begins a statement and cannot continue one. A piece ends
//! before that token: at the end of the line before, or right before the token if they share a line. So the beginning of a
//! piece also determines where the piece above ends ([`LOOKAHEAD`]).

use super::lexer::{Fault, Lexer};
use super::parser::is_certificate;
use super::token::TokenKind;

/// The number of bytes after the white space at a piece's start that determine whether the piece above ends there: the
/// length of the longest word, plus one byte that shows where the word ends.
pub(super) const LOOKAHEAD: usize = "Settings".len() + 1;

/// The state of the search after a part of a text.
#[derive(Clone, Copy, Debug, Default)]
pub struct CutState {
    /// The offset of the first token that more text can change.
    at: usize,
    /// The end of the previous token.
    previous_end: usize,
    phase: Phase,
    brackets: Brackets,
    /// The number of open modifiers outside brackets.
    modifiers: u32,
    /// True if the previous token is a `<`.
    is_less: bool,
}

/// The position within a block, outside its brackets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Phase {
    /// Before the block.
    #[default]
    Start,
    /// In an expression, before an operand.
    Operand,
    /// In an expression, after an operand.
    Operator,
    /// Before the `(` of a condition; `true` for an `if`.
    Condition(bool),
    /// Before a `{`; `true` for an `if`.
    Body(bool),
    /// After the final `}`; `true` for an `if`.
    End(bool),
    /// After `else`.
    Else,
}

/// The open brackets.
#[derive(Clone, Copy, Debug, Default)]
struct Brackets {
    depth: u32,
    /// One bit for each of the outermost brackets: set for a brace.
    braces: [u64; 4],
}

impl Brackets {
    /// The maximum depth at which the kind of a bracket is stored. Deeper text is an error, which the parser reports.
    const KNOWN: u32 = 256;

    fn is_brace(&self, level: u32) -> bool {
        level < Self::KNOWN && self.braces[level as usize / 64] >> (level % 64) & 1 == 1
    }

    fn open(&mut self, is_brace: bool) {
        if self.depth < Self::KNOWN {
            let bit = 1 << (self.depth % 64);
            let word = &mut self.braces[self.depth as usize / 64];
            *word = if is_brace { *word | bit } else { *word & !bit };
        }
        self.depth = self.depth.saturating_add(1);
    }

    /// Closes a bracket. A `}` closes all brackets up to the last `{`; another bracket does not close a brace.
    fn close(&mut self, is_brace: bool) {
        if self.depth > Self::KNOWN {
            self.depth -= 1;
        } else if is_brace {
            let last = (0..self.depth).rev().find(|level| self.is_brace(*level));
            self.depth = last.unwrap_or(self.depth);
        } else if self.depth > 0 && !self.is_brace(self.depth - 1) {
            self.depth -= 1;
        }
    }
}

/// Appends to `ends` the offsets after the pieces that end in a text, as far as the text determines them. `from` and `state`
/// are the length of the text in the previous call and the state after it.
pub(super) fn cut(text: &str, from: usize, mut state: CutState, ends: &mut Vec<usize>) -> CutState {
    if is_certificate(text) {
        return state;
    }
    // Do not read a comment or a string again unless the new text can end it.
    let begun = text.get(state.at..from).unwrap_or_default().as_bytes();
    let is_open = matches!(begun, [b'-', b'-', ..]) || matches!(begun, [b'"', ..]);
    if is_open && begun.len() >= LOOKAHEAD && !text[from..].contains(['\n', '\r', '"', '\\']) {
        return state;
    }
    let mut lexer = Lexer::new(text, state.at as u32);
    loop {
        let lexeme = lexer.read();
        let (kind, span) = (lexeme.token.kind, lexeme.token.span);
        let (start, end) = (span.start as usize, span.end as usize);
        if kind == TokenKind::Eoi {
            return state;
        }
        let is_whole = end < text.len() || !may_go_on(kind, lexeme.fault);
        if !is_whole && text.len() - start < LOOKAHEAD {
            state.at = start;
            return state;
        }
        if state.ends_before(kind, lexeme.fault) {
            let between = &text[state.previous_end..start];
            let line = between.rfind('\n').map(|at| state.previous_end + at + 1);
            ends.push(line.unwrap_or(start));
            state = CutState::default();
        }
        if !is_whole {
            state.at = start;
            return state;
        }
        state.at = end;
        if kind == TokenKind::Comment {
            continue;
        }
        state.take(kind, lexeme.fault);
        state.previous_end = end;
    }
}

/// Returns true if more text after a token can extend it or change its kind.
fn may_go_on(kind: TokenKind, fault: Option<Fault>) -> bool {
    use TokenKind::{
        BraceClose, BraceOpen, BracketClose, BracketOpen, Comma, Error, ParenClose, ParenOpen, Text,
    };
    match kind {
        ParenOpen | ParenClose | BracketOpen | BracketClose | BraceOpen | BraceClose | Comma
        | Text => false,
        Error => !matches!(fault, Some(Fault::Character(_))),
        _ => true,
    }
}

impl CutState {
    /// Returns true if a token begins another block.
    fn ends_before(&self, kind: TokenKind, fault: Option<Fault>) -> bool {
        use TokenKind::{BraceOpen, Comment, Else, If, Not, ParenOpen, Scene, Settings, While};
        let is_passed = kind == Comment || matches!(fault, Some(Fault::Character(_)));
        match self.phase {
            Phase::Start => false,
            // These occur at top level only: all open brackets were meant to be closed.
            _ if matches!(kind, Settings | Scene) => true,
            _ if self.brackets.depth > 0 || is_passed => false,
            Phase::Operand => matches!(kind, While | If),
            Phase::Operator => match kind {
                ParenOpen | TokenKind::BracketOpen => false,
                While | If | Else | Not | TokenKind::Error => true,
                _ => kind.begins_primary(),
            },
            Phase::Condition(_) => matches!(kind, While | If),
            Phase::Body(_) => kind != BraceOpen,
            Phase::End(is_if) => !(is_if && kind == Else),
            Phase::Else => !matches!(kind, If | BraceOpen),
        }
    }

    /// Advances the state past a token of the block.
    fn take(&mut self, kind: TokenKind, fault: Option<Fault>) {
        use TokenKind::{
            BraceClose, BraceOpen, BracketClose, BracketOpen, Else, Error, Greater, If, ParenClose,
            ParenOpen, Scene, Settings, While,
        };
        let was_less = std::mem::replace(
            &mut self.is_less,
            matches!(kind, TokenKind::Less | TokenKind::Modify),
        );
        let was_inside = self.brackets.depth > 0;
        match kind {
            ParenOpen | BracketOpen | BraceOpen => self.brackets.open(kind == BraceOpen),
            ParenClose | BracketClose | BraceClose => self.brackets.close(kind == BraceClose),
            _ => {}
        }
        if self.brackets.depth > 0 {
            return;
        }
        self.phase = match (self.phase, kind) {
            (Phase::Start, While) => Phase::Condition(false),
            (Phase::Start | Phase::Else, If) => Phase::Condition(true),
            (Phase::Start, Settings | Scene) => Phase::Body(false),
            (Phase::Condition(is_if), _) if was_inside => Phase::Body(is_if),
            (Phase::Body(is_if), _) if was_inside => Phase::End(is_if),
            (Phase::Else, _) if was_inside => Phase::End(false),
            (Phase::End(true), Else) => Phase::Else,
            (Phase::Start | Phase::Operand | Phase::Operator, _) => match kind {
                Error if matches!(fault, Some(Fault::Character(_))) => match self.phase {
                    Phase::Start => Phase::Operand,
                    phase => phase,
                },
                Error | ParenClose | BracketClose | BraceClose => Phase::Operator,
                Greater if self.modifiers > 0 => {
                    self.modifiers -= 1;
                    Phase::Operator
                }
                _ if kind.is_modifier() && was_less => {
                    self.modifiers += 1;
                    Phase::Operand
                }
                // The brackets that a macro requires follow it.
                TokenKind::Macro => Phase::Operand,
                _ if kind.begins_primary() => Phase::Operator,
                _ => Phase::Operand,
            },
            (phase, _) => phase,
        };
    }
}
