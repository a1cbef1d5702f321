//! The context of a completion: the expected kind of text, and the part of a word that is already written.
//!
//! After a `,` of a declaration, in a set and after an attribute's `:` a word is read as a whole; in an expression it is
//! split into names, of which the last is being written.

use syntax::geotrace::attributes::{self, AttributeRow, AttributeType, AttributeWord};
use syntax::geotrace::declarations::{Category, Syntax};
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::{GeotraceAnalysis, Lexeme};
use super::item::Item;
use super::names_in_scope::NamesInScope;
use super::signature::function_before;

/// The kind of text expected at an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Expected {
    Nothing,
    Declaration,
    /// A parameter or an attribute of this item: after a `,` in it.
    Item(usize),
    /// A word that is a value of this attribute.
    Word(&'static AttributeRow),
    /// A parameter of the function that this item declares: after `f_`.
    ParameterOf(usize),
    /// A surface, a metric or a solid: after the colon of a geodesic.
    Surface,
    /// A solid or a function that stands for one: in a set.
    Atom,
    /// A map, or an operand: after the `@` of a set.
    Place,
    /// An operand that depends on no param and no grid: in an interval, or the initial value of a param.
    Constant,
    /// Any operand, in the body of this item.
    Operand(Option<usize>),
}

/// A position where something can be completed.
pub(super) struct CompletionPlace {
    pub(super) wanted: Expected,
    /// The part of the word that is already written.
    pub(super) range: Span,
}

impl CompletionPlace {
    pub(super) fn of(analysis: &GeotraceAnalysis, offset: u32) -> Self {
        let whole = analysis.document().word_start(offset);
        let of_whole = Self::from(analysis, whole, offset);
        match of_whole.wanted {
            Expected::Operand(_)
            | Expected::Constant
            | Expected::ParameterOf(_)
            | Expected::Nothing => {
                Self::from(analysis, part_start(analysis, whole, offset), offset)
            }
            _ => of_whole,
        }
    }

    /// Determines the context of the word that starts at an offset.
    fn from(analysis: &GeotraceAnalysis, start: u32, offset: u32) -> Self {
        let range = Span::new(start, offset);
        let next = analysis.document().tokens_begun(start) as usize;
        let last = next.checked_sub(1).and_then(|k| analysis.token(k));
        if last.is_some_and(|t| t.kind == TokenKind::Comment && offset <= t.span.end) {
            return Self {
                wanted: Expected::Nothing,
                range,
            };
        }
        let before = (0..next)
            .rev()
            .filter_map(|k| Some((k, analysis.token(k)?)));
        let mut before = before.filter(|(_, token)| token.kind != TokenKind::Comment);
        // A declaration that starts here is not yet the one being written.
        let item = analysis
            .item_at(start)
            .filter(|item| item.span.start < start);
        let item = item.or_else(|| analysis.unfinished_item_before(start));
        let wanted = match (before.next(), item) {
            (None, _) => Expected::Declaration,
            (Some((at, token)), item) => behind(analysis, item.as_ref(), at, token),
        };
        Self { wanted, range }
    }
}

/// Returns the kind of text expected after a token of an item.
fn behind(
    analysis: &GeotraceAnalysis,
    item: Option<&Item<'_>>,
    at: usize,
    token: Lexeme<'_>,
) -> Expected {
    match token.kind {
        TokenKind::Semicolon => return Expected::Declaration,
        TokenKind::Declare(_) => return Expected::Nothing,
        _ => {}
    }
    if item.is_some_and(|item| in_head(analysis, item, at)) {
        return Expected::Nothing;
    }
    if item.is_some_and(|item| in_interval(analysis, item, at)) {
        return Expected::Constant;
    }
    if let Some(expected) = item.and_then(|item| in_set(analysis, item, at)) {
        return expected;
    }
    let operand = item.map_or(Expected::Operand(None), |item| operand(analysis, item, at));
    match token.kind {
        TokenKind::Underscore => {
            let function = function_before(analysis, at);
            match function.and_then(|id| analysis.item_of(id)) {
                Some(item) => Expected::ParameterOf(item),
                None => Expected::Nothing,
            }
        }
        TokenKind::Colon => item.map_or(Expected::Nothing, |item| behind_colon(analysis, item, at)),
        TokenKind::Comma => match item {
            Some(item) if ends_body(analysis, item, at) => match takes_items(item) {
                true => Expected::Item(item.index),
                false => Expected::Nothing,
            },
            _ => operand,
        },
        _ => operand,
    }
}

/// Returns the kind of operand expected in an expression after a token of an item, outside its intervals.
fn operand(analysis: &GeotraceAnalysis, item: &Item<'_>, at: usize) -> Expected {
    let row = item.keyword.row();
    if row.category == Category::Slider {
        return Expected::Constant;
    }
    // The start and the direction of a geodesic do not depend on its parameter.
    if row.syntax == Syntax::InSurface && !is_behind_body(analysis, item, at) {
        return Expected::Operand(None);
    }
    Expected::Operand(Some(item.index))
}

/// Returns true if a comma outside all brackets of an item stands before a token.
fn is_behind_body(analysis: &GeotraceAnalysis, item: &Item<'_>, token: usize) -> bool {
    let first = analysis.document().tokens_begun(item.span.start) as usize;
    let mut open = 0;
    analysis.tokens(first..token).any(|token| {
        open += depth(token);
        open == 0 && token.kind == TokenKind::Comma
    })
}

/// Returns the kind of text expected after a colon of an item: the surface of a geodesic, or the value of an attribute.
fn behind_colon(analysis: &GeotraceAnalysis, item: &Item<'_>, colon: usize) -> Expected {
    let before = colon.checked_sub(1).and_then(|k| analysis.token(k));
    let Some(word) = before.filter(is_word) else {
        return match item.keyword.row().syntax {
            Syntax::InSurface => Expected::Surface,
            _ => Expected::Nothing,
        };
    };
    // A parameter is followed by its interval.
    let stated = AttributeWord::from_text(word.text);
    let stated = stated.filter(|_| item.variables().all(|name| name != word.text));
    match stated.and_then(|stated| stated.row(item.keyword)) {
        Some(row) => match row.value {
            AttributeType::Choice(_) => Expected::Word(row),
            AttributeType::Name => Expected::Nothing,
            _ => Expected::Operand(Some(item.index)),
        },
        None => Expected::Nothing,
    }
}

fn is_word(token: &Lexeme<'_>) -> bool {
    let last = token.text.bytes().next_back();
    last.is_some_and(|byte| byte.is_ascii_alphanumeric())
}

/// Returns true if a declaration has intervals or attributes after its body.
fn takes_items(item: &Item<'_>) -> bool {
    item.keyword.has_domain() || attributes::of(item.keyword).next().is_some()
}

/// Returns true if a comma is outside all brackets of an item.
fn ends_body(analysis: &GeotraceAnalysis, item: &Item<'_>, comma: usize) -> bool {
    let first = analysis.document().tokens_begun(item.span.start) as usize;
    let depth: i32 = analysis.tokens(first..comma).map(depth).sum();
    depth == 0
}

/// Returns true if an item has no `=` or `:` up to a token: only new names may follow.
fn in_head(analysis: &GeotraceAnalysis, item: &Item<'_>, last: usize) -> bool {
    let first = analysis.document().tokens_begun(item.span.start) as usize;
    let mut tokens = analysis.tokens(first..last + 1);
    tokens.all(|token| !matches!(token.kind, TokenKind::Equals | TokenKind::Colon))
}

/// Returns true if an interval of a parameter, a param or a grid is open after a token of an item.
fn in_interval(analysis: &GeotraceAnalysis, item: &Item<'_>, last: usize) -> bool {
    let first = analysis.document().tokens_begun(item.span.start) as usize;
    let tokens = analysis.tokens(first..last + 1);
    let tokens = tokens.filter(|token| token.kind != TokenKind::Comment);
    let (mut word, mut before, mut open) = ("", None, 0);
    let mut is_interval = false;
    for token in tokens {
        if open == 0 && token.kind == TokenKind::BracketOpen {
            let is_parameter = item.variables().any(|name| name == word);
            let is_own = matches!(item.keyword.category(), Category::Slider | Category::Grid);
            is_interval = match before {
                Some(TokenKind::Colon) => is_parameter || is_own,
                Some(TokenKind::Comma) => is_own,
                _ => false,
            };
        } else if open == 0 && depth(token) > 0 {
            is_interval = false;
        }
        open += depth(token);
        if token.kind != TokenKind::Colon {
            word = token.text;
        }
        before = Some(token.kind);
    }
    open > 0 && is_interval
}

/// Returns the change in bracket depth at a token.
fn depth(token: Lexeme<'_>) -> i32 {
    match token.kind {
        TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => 1,
        TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => -1,
        _ => 0,
    }
}

/// Returns the kind of text expected after a token within the set of a solid; `None` outside sets.
pub(super) fn in_set(
    analysis: &GeotraceAnalysis,
    item: &Item<'_>,
    last: usize,
) -> Option<Expected> {
    if !item.is_set() {
        return None;
    }
    let first = analysis.document().tokens_ended(item.name_span.end) as usize;
    let tokens = analysis.tokens(first..last + 1);
    let mut tokens = tokens.filter(|token| token.kind != TokenKind::Comment);
    if tokens.next()?.kind != TokenKind::Equals {
        return None;
    }
    // The open brackets of sets; within a placement, those of expressions.
    let (mut sets, mut brackets) = (0, 0);
    let mut state = SetState::Atom;
    for token in tokens {
        let change = depth(token);
        state = match (state, token.kind) {
            (SetState::Place | SetState::Expression, _) if brackets > 0 || change > 0 => {
                brackets += change;
                SetState::Expression
            }
            (_, TokenKind::Bar | TokenKind::Ampersand | TokenKind::Backslash) => SetState::Atom,
            (_, TokenKind::At) => SetState::Place,
            (_, TokenKind::Comma) if sets <= 0 => return None,
            (SetState::Atom, _) if change > 0 => {
                sets += 1;
                SetState::Atom
            }
            (_, _) if change < 0 => {
                sets -= 1;
                SetState::Set
            }
            (SetState::Place | SetState::Expression, _) => SetState::Expression,
            _ => SetState::Set,
        };
    }
    Some(match state {
        SetState::Atom => Expected::Atom,
        SetState::Place => Expected::Place,
        // Placements do not read coordinates.
        SetState::Expression => Expected::Operand(None),
        SetState::Set => Expected::Nothing,
    })
}

/// A state within a set.
#[derive(Clone, Copy, Debug, PartialEq)]
enum SetState {
    /// An atom is expected.
    Atom,
    /// After an atom, or a set in brackets.
    Set,
    /// Right after an `@`.
    Place,
    /// Within the expression after an `@`.
    Expression,
}

/// Returns the start of the part of a word, from `whole` on, that is being written before an offset: the first boundary
/// between names from which a name continues the written text, else the last boundary. For `2pive` the part is `ve` if
/// `vel` is defined.
fn part_start(analysis: &GeotraceAnalysis, whole: u32, offset: u32) -> u32 {
    let mut start = whole;
    // Digits before the first letter form a number.
    let word = analysis.slice(Span::new(start, offset));
    let digits = word.bytes().take_while(u8::is_ascii_digit).count();
    let (word, from) = (&word[digits..], start + digits as u32);
    start = from;
    let tokens = analysis.tokens(analysis.tokens_in(Span::new(start, offset)));
    let seams = tokens.map(|t| t.span.start).filter(|&at| at >= start);
    let item = analysis.item_at(offset);
    let visible = NamesInScope::at(analysis, offset);
    let goes_on = |at: &u32| {
        let written = &word[(*at - from) as usize..];
        let mut variables = item.iter().flat_map(|item| item.variables());
        visible.begins(written) || variables.any(|name| name.starts_with(written))
    };
    let mut last = start;
    for at in seams {
        if goes_on(&at) {
            return at;
        }
        last = at;
    }
    last
}
