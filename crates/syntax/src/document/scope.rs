//! The names that a grammar sees while it reads a chunk, and the record of its look-ups.

use std::collections::HashMap;
use std::sync::Arc;

use crate::span::Span;
use crate::symbol::SymbolId;
use crate::trie::Trie;

use super::grammar::{Definition, Grammar};
use super::lookups::Lookup;
use super::names::Names;
use super::sequence::Sequence;

/// The names above a chunk that is being read, and the names that it has defined so far.
///
/// The grammar records its look-ups: [`record_use`](Self::record_use) for a token that is a name,
/// [`record_prefix_lookup`](Self::record_prefix_lookup) and [`record_name_lookup`](Self::record_name_lookup) for words
/// that another name would change. The document reads the chunk again when the result of a look-up changes.
#[derive(Debug)]
pub struct ScopeView<'d, G: Grammar> {
    names: &'d Names<G>,
    sequence: &'d Sequence,
    /// The number of chunks above; `None` if all chunks that have been read are above.
    rank: Option<u32>,
    /// The handles of symbols that are currently undefined, by name: a name that is defined again gets its old handle.
    pool: &'d mut HashMap<Arc<str>, SymbolId>,
    fresh: usize,
    own: HashMap<SymbolId, G::Symbol>,
    own_trie: Option<Trie<SymbolId>>,
    /// The symbols that the chunk defines, in order.
    defined: Vec<SymbolId>,
    lookups: Vec<Lookup>,
}

impl<'d, G: Grammar> ScopeView<'d, G> {
    pub(super) fn new(
        names: &'d Names<G>,
        sequence: &'d Sequence,
        rank: Option<u32>,
        pool: &'d mut HashMap<Arc<str>, SymbolId>,
    ) -> Self {
        Self {
            names,
            sequence,
            rank,
            pool,
            fresh: 0,
            own: HashMap::new(),
            own_trie: None,
            defined: Vec::new(),
            lookups: Vec::new(),
        }
    }

    /// Returns the symbols that the chunk defines and its look-ups.
    pub(super) fn finish(self) -> (Vec<(SymbolId, G::Symbol)>, Vec<Lookup>) {
        let Self {
            mut own,
            defined,
            mut lookups,
            ..
        } = self;
        // Equal look-ups are stored once. Among the splits of equal words, the warning shows the first.
        lookups.sort_unstable();
        lookups.dedup();
        let symbols = defined.into_iter();
        let symbols = symbols.filter_map(|id| Some((id, own.remove(&id)?)));
        (symbols.collect(), lookups)
    }

    /// Returns the longest name that is a prefix of `word`: its length in bytes, and its symbol.
    pub fn longest_prefix(&self, word: &str) -> Option<(usize, SymbolId)> {
        let own = self.own_trie.as_ref();
        let mut longest = own.and_then(|trie| trie.longest_prefix(word));
        self.names.trie.each_prefix(word, |length, name| {
            if longest.is_none_or(|(known, _)| known < length)
                && let Some(id) = self.names.visible(name, self.sequence, self.rank)
            {
                longest = Some((length, id));
            }
        });
        longest
    }

    /// Returns the symbol with exactly this name.
    pub fn get(&self, name: &str) -> Option<SymbolId> {
        let own = self.own_trie.as_ref().and_then(|trie| trie.get(name));
        own.or_else(|| {
            let name = self.names.trie.get(name)?;
            self.names.visible(name, self.sequence, self.rank)
        })
    }

    /// Returns the first builtin symbol.
    pub fn first_builtin(&self) -> Option<&G::Symbol> {
        let first = self.names.get(SymbolId(0))?;
        first.home.is_none().then_some(&first.symbol)
    }

    /// Returns a symbol by a handle that another method has returned.
    pub fn symbol(&self, id: SymbolId) -> &G::Symbol {
        match self.own.get(&id) {
            Some(symbol) => symbol,
            None => self.names.symbol(id),
        }
    }

    /// Defines a symbol whose name is free.
    pub fn define(&mut self, symbol: G::Symbol) -> SymbolId {
        let id = self.pool.remove(symbol.name()).unwrap_or_else(|| {
            let id = self.names.fresh(self.fresh);
            self.fresh += 1;
            id
        });
        let trie = self.own_trie.get_or_insert_default();
        // A name outside the trie's alphabet is never found.
        let _ = trie.insert(symbol.name(), id);
        self.own.insert(id, symbol);
        self.defined.push(id);
        id
    }

    /// Records that a token of the chunk is this symbol's name.
    pub fn record_use(&mut self, id: SymbolId) {
        // Symbols of the chunk itself change only with it, and builtins never change.
        if !self.own.contains_key(&id)
            && !self.names.is_builtin(id)
            && let Some(name) = self.names.name_of(id)
        {
            self.lookups.push(Lookup::Used(name));
        }
    }

    /// Records that the longest prefix of the chunk's text in `range` was looked up, and `taken` bytes became a token:
    /// any longer name that is a prefix of the text would have been taken instead.
    pub fn record_prefix_lookup(&mut self, range: Span, taken: u32) {
        if taken < range.end - range.start {
            self.lookups.push(Lookup::Open {
                start: range.start,
                end: range.end,
                length: taken,
                is_split: taken > 0,
            });
        }
    }

    /// Records that exactly the chunk's text in `range` was looked up and is not a name.
    pub fn record_name_lookup(&mut self, range: Span) {
        self.lookups.push(Lookup::Open {
            start: range.start,
            end: range.end,
            length: (range.end - range.start).saturating_sub(1),
            is_split: false,
        });
    }
}
