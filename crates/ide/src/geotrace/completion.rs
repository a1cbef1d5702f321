//! Completion in a program.

use syntax::geotrace::attributes::{self, AttributeRow, AttributeType, AttributeWord};
use syntax::geotrace::declarations::{Category, DeclarationKeyword, DeclarationRow, TABLE};
use syntax::geotrace::symbols::{Symbol, SymbolKind};
use syntax::geotrace::token::{MapWord, TokenKind};
use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use super::completion_place::{CompletionPlace, Expected};
use super::describe;
use super::item::Item;
use super::names_in_scope::NamesInScope;
use super::outline::{parameters, parameters_of};
use crate::completion::{Completion, CompletionKind, Completions, behind_word};
use crate::description::Description;

/// The maximum number of declared names in the list: if more are declared above, only names that continue the written
/// text are listed.
const MOST_NAMES: usize = 256;

/// Returns the completions at an offset.
pub fn completions(analysis: &GeotraceAnalysis, offset: u32, snippets: bool) -> Completions {
    let place = CompletionPlace::of(analysis, offset);
    let names = Names {
        visible: NamesInScope::at(analysis, offset),
        written: analysis.slice(place.range),
    };
    let mut is_complete = true;
    let list = match place.wanted {
        Expected::Nothing => Vec::new(),
        Expected::Declaration => {
            let behind = behind_word(analysis.document(), offset);
            let is_named = behind.starts_with(|c: char| c.is_ascii_alphabetic());
            let rows = TABLE
                .iter()
                .filter(|row| may_be_declared(analysis, row, offset));
            let rows = rows.map(|row| declaration(row, snippets));
            let alone = |it| if is_named { word_alone(it) } else { it };
            rows.map(alone).collect()
        }
        Expected::Item(item) => items(analysis, item, offset, snippets),
        Expected::Word(row) => words(row),
        Expected::ParameterOf(item) => own_parameters(analysis, item),
        Expected::Surface => {
            is_complete = names.are_few();
            let is_surface = |symbol: &&Symbol| {
                matches!(
                    symbol.keyword.map(DeclarationKeyword::category),
                    Some(Category::Surface | Category::Metric | Category::Solid)
                )
            };
            let all = names.list(analysis).into_iter();
            all.filter(is_surface).map(of_symbol).collect()
        }
        Expected::Atom => {
            is_complete = names.are_few();
            let all = names.list(analysis).into_iter();
            all.filter(|symbol| is_atom(symbol))
                .map(of_symbol)
                .collect()
        }
        Expected::Place => {
            is_complete = names.are_few();
            let mut list: Vec<Completion> = MapWord::ALL.into_iter().map(map).collect();
            list.extend(names.list(analysis).into_iter().map(of_symbol));
            list
        }
        Expected::Constant => {
            is_complete = names.are_few();
            let all = names.list(analysis).into_iter();
            all.filter(|symbol| is_constant(analysis, symbol))
                .map(of_symbol)
                .collect()
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

/// Returns true for a declaration that a program may contain another one of. A program has one background; the one that
/// is being written at an offset does not count.
fn may_be_declared(analysis: &GeotraceAnalysis, row: &DeclarationRow, offset: u32) -> bool {
    row.keyword != DeclarationKeyword::Background
        || analysis.items().all(|item| {
            item.keyword != row.keyword || item.span.start <= offset && offset <= item.span.end
        })
}

/// Returns the completions that continue the written text, then those that contain its letters in order, ignoring case.
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

/// Returns the description of a completion, requested when it is selected in the list.
pub fn describe(analysis: &GeotraceAnalysis, offset: u32, label: &str) -> Option<Description> {
    let keyword = DeclarationKeyword::from_text(label);
    let symbol = || {
        let id = NamesInScope::at(analysis, offset).named(label)?;
        describe::of_symbol(analysis, id)
    };
    match CompletionPlace::of(analysis, offset).wanted {
        Expected::Declaration => keyword.map(describe::keyword),
        Expected::Item(item) => {
            let item = analysis.item(item)?;
            let mut rows = attributes::of(item.keyword);
            let row = rows.find(|row| row.text == label)?;
            Some(describe::attribute(row))
        }
        Expected::Word(row) => Some(describe::attribute(row)),
        Expected::Place => match MapWord::from_text(label) {
            Some(map) => Some(describe::map(map)),
            None => symbol(),
        },
        _ => symbol().or_else(|| keyword.map(describe::keyword)),
    }
}

/// Returns the items that may follow a `,` of a declaration: its parameters, and its possible attributes except those
/// stated elsewhere.
fn items(
    analysis: &GeotraceAnalysis,
    number: usize,
    offset: u32,
    snippets: bool,
) -> Vec<Completion> {
    let Some(item) = analysis.item(number) else {
        return Vec::new();
    };
    let stated = stated(analysis, &item, offset);
    let is_free = |word: &str| stated.iter().all(|other| other != word);
    let mut list: Vec<Completion> = Vec::new();
    if item.keyword.has_domain() || item.keyword == DeclarationKeyword::Solid {
        let names = item.variables().filter(|name| is_free(name));
        list.extend(names.map(|name| parameter(name, &item)));
    }
    let rows = attributes::of(item.keyword).filter(|row| is_free(row.text));
    // A parameter takes precedence.
    let rows = rows.filter(|row| item.variables().all(|name| name != row.text));
    let has_value = behind_word(analysis.document(), offset).starts_with(':');
    let alone = |it| if has_value { word_alone(it) } else { it };
    list.extend(rows.map(|row| alone(attribute(row, &item, snippets))));
    list
}

/// Returns the words before a `:` in a declaration, without the one at an offset.
fn stated(analysis: &GeotraceAnalysis, item: &Item<'_>, offset: u32) -> Vec<String> {
    let body = Span::new(item.name_span.end, item.span.end);
    let tokens: Vec<_> = analysis.tokens(analysis.tokens_in(body)).collect();
    let pairs = tokens.windows(2);
    let named = pairs.filter(|pair| pair[1].kind == TokenKind::Colon);
    let others = named.filter(|pair| !(pair[0].span.start..=pair[0].span.end).contains(&offset));
    others.map(|pair| pair[0].text.to_owned()).collect()
}

/// Returns an entry that inserts only its word: the text required after it is already written.
fn word_alone(entry: Completion) -> Completion {
    Completion {
        insert: entry.label.clone(),
        snippet: false,
        ..entry
    }
}

/// Returns the words that are values of an attribute.
fn words(row: &AttributeRow) -> Vec<Completion> {
    let AttributeType::Choice(words) = row.value else {
        return Vec::new();
    };
    let words = words.iter().map(|word| Completion {
        label: (*word).to_owned(),
        kind: CompletionKind::Word,
        detail: match *word == row.default {
            true => format!("{}, unless stated", row.text),
            false => row.text.to_owned(),
        },
        insert: (*word).to_owned(),
        snippet: false,
    });
    words.collect()
}

fn attribute(row: &AttributeRow, owner: &Item<'_>, snippets: bool) -> Completion {
    let value = example_value(row, owner);
    Completion {
        label: row.text.to_owned(),
        kind: CompletionKind::Attribute,
        detail: describe::range_and_default(row),
        insert: match snippets {
            true => format!("{} : ${{1:{value}}}", row.text),
            false => format!("{} : ", row.text),
        },
        snippet: snippets,
    }
}

/// Returns an initial value for an attribute, over the parameters of its declaration.
fn example_value(row: &AttributeRow, owner: &Item<'_>) -> String {
    let names: Vec<&str> = owner.variables().collect();
    match (row.word, &names[..]) {
        (AttributeWord::Uv, [first, second, ..]) => format!("({first}, {second})"),
        // The letter e before digits continues a number.
        (AttributeWord::Bump, [.., last]) if last.starts_with('e') => format!("0.01sin(40 {last})"),
        (AttributeWord::Bump, [.., last]) => format!("0.01sin(40{last})"),
        _ => {
            let value = row.example.split_once(" : ");
            value.map_or("", |(_, value)| value).to_owned()
        }
    }
}

fn map(map: MapWord) -> Completion {
    Completion {
        label: map.text().to_owned(),
        kind: CompletionKind::Function,
        detail: match map {
            MapWord::Scale => "by a number, or by (a, b, c) along the axes",
            MapWord::Rotate => "about a vector, by its length in radians",
        }
        .to_owned(),
        insert: format!("{} ", map.text()),
        snippet: false,
    }
}

/// Returns true if a name may occur in a set: a solid, or a function of two or three numbers.
fn is_atom(symbol: &Symbol) -> bool {
    match symbol.keyword {
        Some(DeclarationKeyword::Solid) => true,
        Some(DeclarationKeyword::Function) => matches!(symbol.parameters.len(), 2 | 3),
        _ => false,
    }
}

fn own_parameters(analysis: &GeotraceAnalysis, item: usize) -> Vec<Completion> {
    let Some(item) = analysis.item(item) else {
        return Vec::new();
    };
    let names = item.variables();
    names.map(|name| parameter(name, &item)).collect()
}

fn parameter(name: &str, owner: &Item<'_>) -> Completion {
    Completion {
        label: name.to_owned(),
        kind: CompletionKind::Parameter,
        detail: format!("parameter of {}", owner.name),
        insert: name.to_owned(),
        snippet: false,
    }
}

/// The names that can be written as operands.
struct Names<'r> {
    visible: NamesInScope<'r>,
    /// The part of a name that has been written.
    written: String,
}

impl<'r> Names<'r> {
    /// Returns true if all names are listed.
    fn are_few(&self) -> bool {
        self.visible.above() <= MOST_NAMES
    }

    /// Returns the builtins first, then the declared names; if there are many, the nearest above or those that continue
    /// the written text.
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

/// Returns true if a symbol depends on no param and no grid.
fn is_constant(analysis: &GeotraceAnalysis, symbol: &Symbol) -> bool {
    let id = analysis.document().named(&symbol.name);
    !id.is_some_and(|id| analysis.depends_on_settings(id))
}

fn of_symbol(symbol: &Symbol) -> Completion {
    let kind = match (
        symbol.keyword.map(DeclarationKeyword::category),
        symbol.kind,
    ) {
        (Some(Category::Surface | Category::Metric), _) => CompletionKind::Surface,
        (Some(Category::Curve), _) => CompletionKind::Curve,
        (Some(Category::Solid), _) => CompletionKind::Solid,
        (_, SymbolKind::Function) => CompletionKind::Function,
        (_, SymbolKind::Constant) => CompletionKind::Constant,
    };
    let word = symbol.keyword.map_or("builtin", DeclarationKeyword::text);
    Completion {
        label: symbol.name.to_string(),
        kind,
        detail: format!(
            "{word} {}{}",
            symbol.name,
            parameters(parameters_of(symbol))
        ),
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
