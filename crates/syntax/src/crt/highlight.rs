//! Colours for a script: a second implementation of the hooks.

use super::actions::{Actions, ParseStep};
use super::parser::parse_script;
use super::token::{Token, TokenKind};
use crate::highlight::HighlightKind;
use crate::span::Span;

/// Returns every token of a script with its colour, in the order of the text and without overlaps.
pub fn highlight(source: &str) -> Vec<(Span, HighlightKind)> {
    let mut highlighter = Highlighter::default();
    parse_script(source, &mut highlighter);
    highlighter.highlights
}

/// Collects the colours while the parser runs.
#[derive(Clone, Debug, Default)]
pub struct Highlighter {
    /// The coloured pieces so far.
    pub highlights: Vec<(Span, HighlightKind)>,
}

impl Highlighter {
    /// Changes the colour of the token at a span.
    fn recolour(&mut self, span: Span, kind: HighlightKind) {
        let found = self.highlights.binary_search_by_key(&span, |it| it.0);
        if let Ok(index) = found {
            self.highlights[index].1 = kind;
        }
    }
}

impl Actions for Highlighter {
    fn act_advance(&mut self, token: Token) {
        if let Some(kind) = kind(token.kind) {
            self.highlights.push((token.span, kind));
        }
    }

    fn act_step(&mut self, step: ParseStep<'_>, span: Span) {
        match step {
            ParseStep::Attribute(name) => self.recolour(name, HighlightKind::Constant),
            ParseStep::Call(brackets, _) => {
                // A name right before the brackets is called.
                let before = self
                    .highlights
                    .partition_point(|it| it.0.start < brackets.start);
                let called = self.highlights[..before].iter_mut().rev();
                let mut called = called.skip_while(|it| it.1 == HighlightKind::Comment);
                if let Some(last) = called.next()
                    && last.1 == HighlightKind::Variable
                    && last.0.start >= span.start
                {
                    last.1 = HighlightKind::Function;
                }
            }
            _ => {}
        }
    }
}

/// Returns the default colour of a token; `None` at the end of the text.
pub fn kind(token: TokenKind) -> Option<HighlightKind> {
    use TokenKind::{
        And, Arrow, Assign, BraceClose, BraceOpen, BracketClose, BracketOpen, Caret, Colon, Comma,
        Comment, Else, Eoi, Equal, Error, False, Float, Greater, GreaterEqual, Identifier, If,
        Integer, Less, LessEqual, Macro, Minus, Modify, Name, Not, NotEqual, Or, ParenClose,
        ParenOpen, Percent, Plus, Question, Rotate, Scale, Scene, Settings, Slash, Star, Text,
        Translate, True, While,
    };
    Some(match token {
        Comment => HighlightKind::Comment,
        Integer | Float => HighlightKind::Number,
        Text => HighlightKind::Text,
        Identifier => HighlightKind::Variable,
        Name => HighlightKind::Function,
        True | False => HighlightKind::Constant,
        Settings | Scene | Macro | Scale | Translate | Rotate | While | If | Else => {
            HighlightKind::Keyword
        }
        LessEqual | GreaterEqual | Equal | NotEqual | And | Or | Assign | Question | Colon
        | Less | Greater | Plus | Minus | Caret | Star | Slash | Percent | Not | Modify => {
            HighlightKind::Operator
        }
        Arrow | ParenOpen | ParenClose | BracketOpen | BracketClose | BraceOpen | BraceClose
        | Comma => HighlightKind::Punctuation,
        Error => HighlightKind::Error,
        Eoi => return None,
    })
}
