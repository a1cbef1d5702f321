//! Tokens, operators and keywords as a tag and a number, and back.
//!
//! The value of a number is not part of them: it is read from the text again.

use crate::geotrace::actions::Operator;
use crate::geotrace::attributes::AttributeWord;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::lexer::literal;
use crate::geotrace::token::{MapWord, TokenKind};
use crate::symbol::SymbolId;

pub(super) fn keyword_index(keyword: DeclarationKeyword) -> u8 {
    let index = DeclarationKeyword::ALL
        .iter()
        .position(|other| *other == keyword);
    index.unwrap_or_default() as u8
}

pub(super) fn keyword(index: u8) -> DeclarationKeyword {
    let keyword = DeclarationKeyword::ALL.get(usize::from(index)).copied();
    keyword.unwrap_or(DeclarationKeyword::Define)
}

/// Returns the attribute with this number.
pub(super) fn attribute(number: u32) -> AttributeWord {
    let word = AttributeWord::ALL.get(number as usize).copied();
    word.unwrap_or(AttributeWord::Color)
}

// The tag of a kind without a value is its index in `TokenKind::PLAIN`.
const NUMBER: u8 = TokenKind::PLAIN.len() as u8;
const DECLARE: u8 = NUMBER + 1;
const CONSTANT: u8 = NUMBER + 2;
const FUNCTION: u8 = NUMBER + 3;
const VARIABLE: u8 = NUMBER + 4;
const ATTRIBUTE_WORD: u8 = NUMBER + 5;
const MAP_WORD: u8 = NUMBER + 6;

/// Returns the tag and the number of a token.
pub(super) fn of_token(kind: TokenKind) -> (u8, u32) {
    match kind {
        TokenKind::Number(_) => (NUMBER, 0),
        TokenKind::Declare(keyword) => (DECLARE, u32::from(keyword_index(keyword))),
        TokenKind::Constant(id) => (CONSTANT, id.0),
        TokenKind::Function(id) => (FUNCTION, id.0),
        TokenKind::Variable(position) => (VARIABLE, position),
        TokenKind::Attribute(word) => (ATTRIBUTE_WORD, word as u32),
        TokenKind::Map(map) => (MAP_WORD, map as u32),
        kind => {
            let tag = TokenKind::PLAIN.iter().position(|plain| *plain == kind);
            (tag.unwrap_or_default() as u8, 0)
        }
    }
}

/// Returns the token of a tag, a number and the token's text.
pub(super) fn token_kind(tag: u8, number: u32, text: &str) -> TokenKind {
    match tag {
        NUMBER => TokenKind::Number(literal(text)),
        DECLARE => TokenKind::Declare(keyword(number as u8)),
        CONSTANT => TokenKind::Constant(SymbolId(number)),
        FUNCTION => TokenKind::Function(SymbolId(number)),
        VARIABLE => TokenKind::Variable(number),
        ATTRIBUTE_WORD => TokenKind::Attribute(attribute(number)),
        MAP_WORD => TokenKind::Map(match number {
            0 => MapWord::Scale,
            _ => MapWord::Rotate,
        }),
        plain => TokenKind::PLAIN[usize::from(plain)],
    }
}

/// The operators without a value; the tag is the index.
pub(super) const STEPS: [Operator; 22] = [
    Operator::Apply,
    Operator::Add,
    Operator::Subtract,
    Operator::Juxtapose,
    Operator::Multiply,
    Operator::Divide,
    Operator::Power,
    Operator::Plus,
    Operator::Negate,
    Operator::Square,
    Operator::Reciprocal,
    Operator::Total,
    Operator::FunctionPower,
    Operator::Position,
    Operator::Atom,
    Operator::Union,
    Operator::Intersection,
    Operator::Difference,
    Operator::Move,
    Operator::Scale,
    Operator::Rotate,
    Operator::Image,
];
// The tags of the others, which are all below `STEPS_END`.
const PUSH_NUMBER: u8 = STEPS.len() as u8;
const PUSH_CONSTANT: u8 = STEPS.len() as u8 + 1;
const PUSH_VARIABLE: u8 = STEPS.len() as u8 + 2;
const PUSH_FUNCTION: u8 = STEPS.len() as u8 + 3;
const PARTIAL: u8 = STEPS.len() as u8 + 4;
const COMPONENT: u8 = STEPS.len() as u8 + 5;
const TUPLE: u8 = STEPS.len() as u8 + 6;
/// A bound above the tags of all steps.
pub(super) const STEPS_END: u8 = 32;

/// Returns the tag, which is below [`STEPS_END`], and the number of a step.
pub(super) fn of_operator(operator: Operator) -> (u8, u32) {
    match operator {
        // Its value is read from the text.
        Operator::Number(_) => (PUSH_NUMBER, 0),
        Operator::Constant(id) => (PUSH_CONSTANT, id.0),
        Operator::Variable(position) => (PUSH_VARIABLE, position),
        Operator::Function(id) => (PUSH_FUNCTION, id.0),
        Operator::Partial(position) => (PARTIAL, position),
        Operator::Component(number) => (COMPONENT, number),
        Operator::Tuple(count) => (TUPLE, count),
        step => {
            let tag = STEPS.iter().position(|other| *other == step);
            (tag.unwrap_or_default() as u8, 0)
        }
    }
}

/// Returns the step of a tag, a number and the step's text.
pub(super) fn operator(tag: u8, number: u32, text: &str) -> Operator {
    match tag {
        PUSH_NUMBER => Operator::Number(literal(text)),
        PUSH_CONSTANT => Operator::Constant(SymbolId(number)),
        PUSH_VARIABLE => Operator::Variable(number),
        PUSH_FUNCTION => Operator::Function(SymbolId(number)),
        PARTIAL => Operator::Partial(number),
        COMPONENT => Operator::Component(number),
        TUPLE => Operator::Tuple(number),
        step => STEPS[usize::from(step)],
    }
}
