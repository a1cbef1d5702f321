//! Tokens, operators and keywords as a tag and a number, and back.
//!
//! The value of a number is not part of them: it is read from the text again.

use crate::geotrace::actions::Operator;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::lexer::literal;
use crate::geotrace::token::TokenKind;
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

// A kind without a value has its place in `TokenKind::PLAIN` as its tag.
const NUMBER: u8 = 22;
const DECLARE: u8 = 23;
const CONSTANT: u8 = 24;
const FUNCTION: u8 = 25;
const VARIABLE: u8 = 26;

/// The tag and the number of a token.
pub(super) fn of_token(kind: TokenKind) -> (u8, u32) {
    match kind {
        TokenKind::Number(_) => (NUMBER, 0),
        TokenKind::Declare(keyword) => (DECLARE, u32::from(keyword_index(keyword))),
        TokenKind::Constant(id) => (CONSTANT, id.0),
        TokenKind::Function(id) => (FUNCTION, id.0),
        TokenKind::Variable(position) => (VARIABLE, position),
        kind => {
            let tag = TokenKind::PLAIN.iter().position(|plain| *plain == kind);
            (tag.unwrap_or_default() as u8, 0)
        }
    }
}

/// The token of a tag, a number and the text where it stands.
pub(super) fn token_kind(tag: u8, number: u32, text: &str) -> TokenKind {
    match tag {
        NUMBER => TokenKind::Number(literal(text)),
        DECLARE => TokenKind::Declare(keyword(number as u8)),
        CONSTANT => TokenKind::Constant(SymbolId(number)),
        FUNCTION => TokenKind::Function(SymbolId(number)),
        VARIABLE => TokenKind::Variable(number),
        plain => TokenKind::PLAIN[usize::from(plain)],
    }
}

/// The operators that are nothing but themselves; a tag is a position.
pub(super) const STEPS: [Operator; 13] = [
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
];
// The tags of the others, which are all below `STEPS_END`.
const PUSH_NUMBER: u8 = 13;
const PUSH_CONSTANT: u8 = 14;
const PUSH_VARIABLE: u8 = 15;
const PUSH_FUNCTION: u8 = 16;
const PARTIAL: u8 = 17;
const COMPONENT: u8 = 18;
const TUPLE: u8 = 19;
/// Above the tags of all steps.
pub(super) const STEPS_END: u8 = 32;

/// The tag and the number of a step, which is below [`STEPS_END`].
pub(super) fn of_operator(operator: Operator) -> (u8, u32) {
    match operator {
        // It is pushed where it stands.
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

/// The step of a tag, a number and the text where it stands.
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
