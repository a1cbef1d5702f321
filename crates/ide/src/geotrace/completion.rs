//! Completion at a place of a program.

use syntax::geotrace::declarations::{Category, DeclarationKeyword, DeclarationRow, Syntax, TABLE};
use syntax::geotrace::symbols::{Symbol, SymbolKind};
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use super::describe;
use super::item::Item;
use super::names_in_scope::NamesInScope;
use super::outline::parameters;
use crate::completion::{Completion, CompletionKind, Completions};
use crate::description::Description;

/// The most names of declarations that the list holds: where more stand above, those that go on from what is written.
const MOST_NAMES: usize = 256;

/// Returns the completions at a place.
pub fn completions(analysis: &GeotraceAnalysis, offset: u32, snippets: bool) -> Completions {
    let place = CompletionPlace::of(analysis, offset);
    let names = Names {
        visible: NamesInScope::at(analysis, offset),
        written: analysis.slice(place.range),
    };
    let mut is_complete = true;
    let list = match place.wanted {
        Expected::Nothing => Vec::new(),
        Expected::Declaration => TABLE.iter().map(|row| declaration(row, snippets)).collect(),
        Expected::Parameter(item) => own_parameters(analysis, item),
        Expected::ParameterOf(item) => own_parameters(analysis, item),
        Expected::Surface => {
            is_complete = names.are_few();
            let all = names.list(analysis).into_iter();
            let is_surface = |symbol: &&Symbol| {
                matches!(
                    symbol.keyword.map(DeclarationKeyword::category),
                    Some(Category::Surface | Category::Metric)
                )
            };
            all.filter(is_surface).map(of_symbol).collect()
        }
        Expected::Operand(item) => {
            let mut list = item
                .map(|item| own_parameters(analysis, item))
                .unwrap_or_default();
            is_complete = names.are_few();
            list.extend(names.list(analysis).into_iter().map(of_symbol));
            list
        }
    };
    Completions {
        range: place.range,
        list: matching(list, &names.written),
        is_complete,
    }
}

/// The completions that go on from what is written, then those that hold its letters in order, in either case.
fn matching(list: Vec<Completion>, written: &str) -> Vec<Completion> {
    let written = written.to_lowercase();
    let (mut first, rest): (Vec<_>, Vec<_>) = list
        .into_iter()
        .partition(|it| it.label.to_lowercase().starts_with(&written));
    let holds = |it: &Completion| {
        let label = it.label.to_lowercase();
        let mut letters = label.chars();
        written
            .chars()
            .all(|letter| letters.any(|own| own == letter))
    };
    first.extend(rest.into_iter().filter(holds));
    first
}

/// The details of a completion, resolved when it is selected in the list.
pub fn describe(analysis: &GeotraceAnalysis, offset: u32, label: &str) -> Option<Description> {
    if let Some(keyword) = DeclarationKeyword::from_text(label) {
        return Some(describe::keyword(keyword));
    }
    let id = NamesInScope::at(analysis, offset).named(label)?;
    describe::of_symbol(analysis, id)
}

/// The kind of text that fits at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Expected {
    Nothing,
    Declaration,
    /// One of the declaration's own parameters: an interval's tag.
    Parameter(usize),
    /// A parameter of the function that this item declares: behind `f_`.
    ParameterOf(usize),
    /// A surface or a metric: behind the colon of a geodesic.
    Surface,
    /// Any operand, in the body of this item.
    Operand(Option<usize>),
}

struct CompletionPlace {
    wanted: Expected,
    range: Span,
}

impl CompletionPlace {
    fn of(analysis: &GeotraceAnalysis, offset: u32) -> Self {
        let start = word_start(analysis, offset);
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
        // A declaration that starts here is not yet the one that is being written.
        let item = analysis
            .item_at(start)
            .filter(|item| item.span.start < start);
        let item = item.or_else(|| open_item(analysis, start));
        let number = item.map(|item| item.index);
        let wanted = match before.next() {
            None => Expected::Declaration,
            Some((at, token)) => match token.kind {
                TokenKind::Semicolon => Expected::Declaration,
                TokenKind::Declare(_) => Expected::Nothing,
                TokenKind::Underscore => match function_before(analysis, at) {
                    Some(item) => Expected::ParameterOf(item),
                    None => Expected::Nothing,
                },
                TokenKind::Number(_) if range.start == range.end && token.span.end == start => {
                    Expected::Operand(number)
                }
                TokenKind::Colon => {
                    let geodesic =
                        item.is_some_and(|it| it.keyword.row().syntax == Syntax::InSurface);
                    let behind = at.checked_sub(1).and_then(|k| analysis.token(k));
                    let behind_list = behind.is_none_or(|t| {
                        let last = t.text.bytes().next_back();
                        !last.is_some_and(|byte| byte.is_ascii_alphanumeric())
                    });
                    if geodesic && behind_list {
                        Expected::Surface
                    } else {
                        Expected::Nothing
                    }
                }
                TokenKind::Comma if item.is_some_and(|item| expects_tag(analysis, &item, at)) => {
                    number.map_or(Expected::Nothing, Expected::Parameter)
                }
                _ => Expected::Operand(number),
            },
        };
        Self { wanted, range }
    }
}

/// Returns the start of the part of a word that is being written before a place: the first seam of the word from which
/// a name goes on as it is written, else at the last one. Of `2pive` that is `ve` where `vel` is defined.
fn word_start(analysis: &GeotraceAnalysis, offset: u32) -> u32 {
    let mut start = analysis.document().word_start(offset);
    // Digits before the first letter are a number.
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
        let mut parameters = item.iter().flat_map(|item| item.parameters());
        visible.begins(written) || parameters.any(|(name, _)| name.starts_with(written))
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

/// The last declaration before a place, where it has not ended with a `;`.
fn open_item(analysis: &GeotraceAnalysis, offset: u32) -> Option<Item<'_>> {
    // One that starts at the place does not stand before it.
    let begun = analysis
        .document()
        .declarations_begun(offset.checked_sub(1)?) as usize;
    let item = analysis.item(begun.checked_sub(1)?)?;
    let end = item.span.end;
    // A `;` is a chunk's end: far declarations are closed, and nothing long is looked at.
    let rest = analysis.slice(Span::new(end.saturating_sub(1), offset.max(end)));
    (!rest.contains(';')).then_some(item)
}

/// The item of the function before an underscore.
fn function_before(analysis: &GeotraceAnalysis, underscore: usize) -> Option<usize> {
    for token in analysis.tokens_before(underscore) {
        match token.kind {
            TokenKind::Function(id) => return analysis.item_of(id),
            TokenKind::Variable(_) | TokenKind::Underscore | TokenKind::Prime => {}
            _ => return None,
        }
    }
    None
}

/// Returns true if behind this comma an interval's tag comes: the comma stands outside all brackets, behind the body.
fn expects_tag(analysis: &GeotraceAnalysis, item: &Item<'_>, comma: usize) -> bool {
    let first = analysis.document().tokens_begun(item.span.start) as usize;
    let depth: i32 = analysis
        .tokens(first..comma)
        .map(|token| match token.kind {
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => 1,
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => -1,
            _ => 0,
        })
        .sum();
    item.keyword.has_domain() && depth == 0
}

fn own_parameters(analysis: &GeotraceAnalysis, item: usize) -> Vec<Completion> {
    let Some(item) = analysis.item(item) else {
        return Vec::new();
    };
    let parameters = item.parameters();
    parameters
        .map(|(name, _)| Completion {
            label: name.to_owned(),
            kind: CompletionKind::Parameter,
            detail: format!("parameter of {}", item.name),
            insert: name.to_owned(),
            snippet: false,
        })
        .collect()
}

/// The names that can be written as operands.
struct Names<'r> {
    visible: NamesInScope<'r>,
    /// The text that has been written of a name.
    written: String,
}

impl<'r> Names<'r> {
    /// Returns true if all of them are listed.
    fn are_few(&self) -> bool {
        self.visible.above() <= MOST_NAMES
    }

    /// The builtins first. Of many, those nearest above, or those that go on from what is written.
    fn list(&self, analysis: &'r GeotraceAnalysis) -> Vec<&'r Symbol> {
        let mut list: Vec<&Symbol> = self.visible.builtins().map(|(_, symbol)| symbol).collect();
        if self.are_few() || self.written.is_empty() {
            let nearest = self.visible.nearest(MOST_NAMES);
            list.extend(nearest.map(|(_, symbol)| symbol));
        } else {
            let found = self.visible.beginning(&self.written, MOST_NAMES);
            list.extend(found.into_iter().filter_map(|id| analysis.symbol(id)));
        }
        list
    }
}

fn of_symbol(symbol: &Symbol) -> Completion {
    let kind = match (
        symbol.keyword.map(DeclarationKeyword::category),
        symbol.kind,
    ) {
        (Some(Category::Surface | Category::Metric), _) => CompletionKind::Surface,
        (Some(Category::Curve), _) => CompletionKind::Curve,
        (_, SymbolKind::Function) => CompletionKind::Function,
        (_, SymbolKind::Constant) => CompletionKind::Constant,
    };
    let word = symbol.keyword.map_or("builtin", DeclarationKeyword::text);
    let names = symbol.parameters.iter().map(|p| p.name.as_str());
    Completion {
        label: symbol.name.to_string(),
        kind,
        detail: format!("{word} {}{}", symbol.name, parameters(names)),
        insert: symbol.name.to_string(),
        snippet: false,
    }
}

fn declaration(row: &DeclarationRow, snippets: bool) -> Completion {
    Completion {
        label: row.text.to_owned(),
        kind: CompletionKind::Keyword,
        detail: row.purpose.to_owned(),
        insert: if snippets {
            row.snippet.to_owned()
        } else {
            format!("{} ", row.text)
        },
        snippet: snippets,
    }
}
