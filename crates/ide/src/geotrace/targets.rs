//! The meaning of tokens: the name that each denotes.
//!
//! One pass over the declarations of a chunk serves all of its tokens: an expression may have very many.

use std::cell::Cell;

use syntax::geotrace::document::PlacedChunk;
use syntax::geotrace::token::{Token, TokenKind};
use syntax::symbol::SymbolId;

use super::analysis::GeotraceAnalysis;
use super::item::Item;

/// The meaning of a token.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Target {
    /// A declared or builtin name.
    Symbol(SymbolId),
    /// A parameter of a declaration, by its index in the list.
    Parameter {
        /// The declaration.
        item: usize,
        /// The parameter.
        position: usize,
    },
}

/// The meanings of the tokens of a chunk.
#[derive(Debug)]
pub(crate) struct ChunkTargets<'r> {
    placed: PlacedChunk<'r>,
    /// Its declarations, in order; spans are relative to its start.
    items: Vec<Item<'r>>,
    /// The last token after a derivative's `_`, and the function: a chain of them is traversed once.
    derived: Cell<Option<(usize, SymbolId)>>,
}

impl<'r> ChunkTargets<'r> {
    /// Collects the declarations of a chunk.
    pub(crate) fn new(placed: PlacedChunk<'r>) -> Self {
        let numbers = placed.first_declaration as usize..;
        let items = numbers.zip(placed.declarations());
        let items = items.map(|(index, (read, events))| Item::new(index, 0, read, events));
        Self {
            placed,
            items: items.collect(),
            derived: Cell::new(None),
        }
    }

    /// Returns the meaning of a token by its number in the chunk, including at its declaration.
    pub(crate) fn target(&self, analysis: &GeotraceAnalysis, index: usize) -> Option<Target> {
        let Token { kind, span } = self.placed.tokens().get(index)?;
        match kind {
            TokenKind::Constant(id) | TokenKind::Function(id) => {
                // If a name that is not free is declared again, the word is not a use of it.
                let taken = self.item_at(span.start).is_some_and(|item| {
                    item.symbol.is_none() && item.name_span == span || item.has_parameter(span)
                });
                (!taken).then_some(Target::Symbol(id))
            }
            TokenKind::Variable(position) => {
                let position = position as usize;
                let item = match self.derived_function(index) {
                    Some(function) => analysis.item_of(function)?,
                    None => self.item_at(span.start)?.index,
                };
                Some(Target::Parameter { item, position })
            }
            TokenKind::Undefined => {
                let item = self.item_at(span.start)?;
                if item.name_span == span {
                    return item.symbol.map(Target::Symbol);
                }
                let position = item.parameters().position(|(_, place)| place == span)?;
                Some(Target::Parameter {
                    item: item.index,
                    position,
                })
            }
            _ => None,
        }
    }

    /// Returns true if a token, by its number in the chunk, introduces a name.
    pub(crate) fn introduces(&self, index: usize) -> bool {
        let span = self.placed.tokens().span(index);
        span.is_some_and(|span| {
            self.item_at(span.start).is_some_and(|item| {
                item.name_span == span && item.symbol.is_some() || item.has_parameter(span)
            })
        })
    }

    /// Returns the declaration that contains an offset of the chunk, or ends there.
    fn item_at(&self, offset: u32) -> Option<&Item<'r>> {
        let begun = self.items.partition_point(|item| item.span.start <= offset);
        let item = self.items.get(begun.checked_sub(1)?)?;
        (offset <= item.span.end).then_some(item)
    }

    /// Returns the function whose parameter a token names: `f_u`, `f_u_v`, `f'_u`.
    fn derived_function(&self, index: usize) -> Option<SymbolId> {
        let tokens = self.placed.tokens();
        let mut before = (0..index).rev().filter_map(|k| Some((k, tokens.get(k)?)));
        if before.next()?.1.kind != TokenKind::Underscore {
            return None;
        }
        let function = before.find_map(|(k, token)| match (self.derived.get(), token.kind) {
            (Some((known, function)), _) if known == k => Some(Some(function)),
            (_, TokenKind::Function(id)) => Some(Some(id)),
            (_, TokenKind::Variable(_) | TokenKind::Underscore | TokenKind::Prime) => None,
            _ => Some(None),
        });
        let function = function.flatten()?;
        self.derived.set(Some((index, function)));
        Some(function)
    }
}
