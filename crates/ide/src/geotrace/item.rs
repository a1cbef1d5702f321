//! A declaration in its text.

use syntax::geotrace::actions::StatedAttribute;
use syntax::geotrace::attributes::AttributeWord;
use syntax::geotrace::declarations::{COORDINATES, DeclarationKeyword};
use syntax::geotrace::document::{Parameters, ParseEvent, ParseEvents, ReadDeclaration};
use syntax::span::Span;
use syntax::symbol::SymbolId;

/// A declaration. Offsets are bytes of the text.
#[derive(Clone, Copy, Debug)]
pub struct Item<'r> {
    /// Its number among the declarations, from 0.
    pub index: usize,
    /// The keyword.
    pub keyword: DeclarationKeyword,
    /// The span from the keyword to the `;`.
    pub span: Span,
    /// Its name; empty if it was not read.
    pub name: &'r str,
    /// The span of its name.
    pub name_span: Span,
    /// The symbol that it declares; `None` if its name was not read or not free.
    pub symbol: Option<SymbolId>,
    /// True if it contains an error.
    pub faulty: bool,
    start: u32,
    parameters: Parameters<'r>,
    events: ParseEvents<'r>,
}

impl<'r> Item<'r> {
    /// Creates the item of a declaration; its spans are relative to `start`.
    pub(crate) fn new(
        index: usize,
        start: u32,
        read: ReadDeclaration<'r>,
        events: ParseEvents<'r>,
    ) -> Self {
        Self {
            index,
            keyword: read.keyword,
            span: read.span.moved(start),
            name: read.name,
            name_span: read.name_span.moved(start),
            symbol: read.symbol,
            faulty: read.faulty,
            start,
            parameters: read.parameters,
            events,
        }
    }

    /// Returns its parameters with their spans.
    pub fn parameters(&self) -> impl ExactSizeIterator<Item = (&'r str, Span)> + use<'r> {
        let start = self.start;
        self.parameters
            .map(move |(name, span)| (name, span.moved(start)))
    }

    /// Returns the names that its expressions may use in addition to those in scope: its parameters, or the coordinates of a
    /// solid that lists none.
    pub fn variables(&self) -> impl Iterator<Item = &'r str> + use<'r> {
        let implied: &[&str] = match self.is_set() {
            true => &COORDINATES,
            false => &[],
        };
        let stated = self.parameters.map(|(name, _)| name);
        stated.chain(implied.iter().copied())
    }

    /// Returns true if it is a solid given by a set of other solids.
    pub fn is_set(&self) -> bool {
        self.keyword == DeclarationKeyword::Solid && self.parameters.len() == 0
    }

    /// Returns its attributes, each with the spans of its word and of its value.
    pub fn attributes(&self) -> impl Iterator<Item = (AttributeWord, Span, Span)> + use<'r> {
        let start = self.start;
        self.events.filter_map(move |event| match event {
            ParseEvent::Attribute(
                StatedAttribute {
                    word,
                    word_span,
                    value_span,
                },
                _,
            ) => Some((word, word_span.moved(start), value_span.moved(start))),
            _ => None,
        })
    }

    /// Returns true if a span is that of a parameter in its list.
    pub(crate) fn has_parameter(&self, span: Span) -> bool {
        self.parameters().any(|(_, place)| place == span)
    }

    /// Returns its intervals, from `[` to `]`.
    pub fn intervals(&self) -> impl Iterator<Item = Span> + use<'r> {
        let start = self.start;
        self.events.filter_map(move |event| match event {
            ParseEvent::Interval(interval) => Some(interval.span.moved(start)),
            _ => None,
        })
    }

    /// Returns the operands and operations of its expressions, in no particular order.
    pub fn operands(&self) -> impl Iterator<Item = Span> + use<'r> {
        let start = self.start;
        self.events.filter_map(move |event| match event {
            ParseEvent::Operator(_, span) => Some(span.moved(start)),
            _ => None,
        })
    }
}
