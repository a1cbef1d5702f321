//! The names that may be used at an offset: the builtins and the names declared above it.
//!
//! The cost of a query, which occurs at each keystroke, depends on its answer and not on the length of the text: names
//! are looked up in the document's trie, and only then their declarations.

use std::ops::{ControlFlow, Range};

use syntax::geotrace::symbols::Symbol;
use syntax::symbol::SymbolId;

use super::analysis::GeotraceAnalysis;

/// The names that may be used at an offset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NamesInScope<'r> {
    analysis: &'r GeotraceAnalysis,
    /// The offset before which declared names are visible.
    limit: u32,
    /// The number of declarations above.
    above: usize,
}

impl<'r> NamesInScope<'r> {
    /// Returns the names that may be used at an offset.
    pub(crate) fn at(analysis: &'r GeotraceAnalysis, offset: u32) -> Self {
        let item = analysis.item_at(offset);
        let item = item.or_else(|| analysis.unfinished_item_before(offset));
        let begun = analysis.document().declarations_begun(offset) as usize;
        match item {
            Some(item) => Self {
                analysis,
                limit: item.span.start,
                above: item.index,
            },
            None => Self {
                analysis,
                limit: offset,
                above: begun.min(analysis.item_count()),
            },
        }
    }

    /// Returns the number of declarations above the offset.
    pub(crate) fn above(self) -> usize {
        self.above
    }

    /// Returns the builtins whose names are not redeclared at the offset.
    pub(crate) fn builtins(self) -> impl Iterator<Item = (SymbolId, &'r Symbol)> {
        let all = (0..scene::geotrace::builtin_count()).map(SymbolId);
        let all = all.filter_map(move |id| Some((id, self.analysis.symbol(id)?)));
        all.filter(move |(_, symbol)| {
            !symbol.name.is_empty() && self.declared(&symbol.name).is_none()
        })
    }

    /// Returns the symbols of the last `most` declarations above, in the order of the text.
    pub(crate) fn nearest(self, most: usize) -> impl Iterator<Item = (SymbolId, &'r Symbol)> {
        let numbers: Range<usize> = self.above.saturating_sub(most)..self.above;
        let items = self.analysis.items_from(numbers.start).take(numbers.len());
        let symbols = items.filter_map(|item| item.symbol);
        symbols
            .filter_map(move |id| Some((id, self.analysis.symbol(id)?)))
            // A name that was not free is empty.
            .filter(|(_, symbol)| !symbol.name.is_empty())
    }

    /// Returns the first `most` declared names that begin with `prefix`, in alphabetical order.
    pub(crate) fn beginning(self, prefix: &str, most: usize) -> Vec<SymbolId> {
        let mut found = Vec::new();
        self.analysis.document().each_named(prefix, |id, symbol| {
            if symbol.keyword.is_some() && self.has(id) {
                found.push(id);
            }
            match found.len() < most {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        });
        found
    }

    /// Returns true if a name, builtin or declared, begins with `prefix`.
    pub(crate) fn begins(self, prefix: &str) -> bool {
        let mut found = false;
        self.analysis.document().each_named(prefix, |id, _| {
            found = self.has(id);
            match found {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        found
    }

    /// Returns the symbol of a name, including words that are names only before a bracket.
    pub(crate) fn named(self, name: &str) -> Option<SymbolId> {
        let mut builtins = self.builtins();
        self.declared(name)
            .or_else(|| Some(builtins.find(|(_, symbol)| *symbol.name == *name)?.0))
    }

    /// Returns the symbol of a name that is declared above.
    fn declared(self, name: &str) -> Option<SymbolId> {
        let id = self.analysis.document().named(name)?;
        (self.has(id) && id.0 >= scene::geotrace::builtin_count()).then_some(id)
    }

    /// Returns true if a symbol is builtin, or declared above.
    fn has(self, id: SymbolId) -> bool {
        let place = self.analysis.place(id);
        place.map_or(id.0 < scene::geotrace::builtin_count(), |place| {
            place.start < self.limit
        })
    }
}
