//! The names as the parser sees them that reads a chunk, and what it asks of them.

use std::collections::HashMap;
use std::sync::Arc;

use crate::geotrace::symbols::{Scope, Symbol};
use crate::geotrace::token::TokenKind;
use crate::spelling::Search;
use crate::symbol::SymbolId;
use crate::trie::Trie;

use super::names::Names;
use super::open_words::Lookup;
use super::sequence::Sequence;

/// The names as a chunk sees them that is being read.
#[derive(Debug)]
pub(super) struct Above<'d> {
    names: &'d Names,
    sequence: &'d Sequence,
    /// How many chunks stand above; none where all that have been read do.
    rank: Option<u32>,
    /// Identifiers to be used again, by name.
    pool: &'d mut HashMap<Arc<str>, SymbolId>,
    fresh: usize,
    own: HashMap<SymbolId, Symbol>,
    own_trie: Option<Trie<SymbolId>>,
    /// What the chunk declares, in order.
    pub(super) defines: Vec<SymbolId>,
    pub(super) lookups: Vec<Lookup>,
}

impl<'d> Above<'d> {
    pub(super) fn new(
        names: &'d Names,
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
            defines: Vec::new(),
            lookups: Vec::new(),
        }
    }

    /// What the chunk declares and what it has asked.
    pub(super) fn finish(self) -> (Vec<(SymbolId, Symbol)>, Vec<Lookup>) {
        let Self {
            mut own,
            defines,
            mut lookups,
            ..
        } = self;
        // One of each kind is enough; of splits the first, which a warning shows.
        lookups.sort_unstable();
        lookups.dedup();
        let symbols = defines.into_iter();
        let symbols = symbols.filter_map(|id| Some((id, own.remove(&id)?)));
        (symbols.collect(), lookups)
    }

    fn use_name(&mut self, id: SymbolId) {
        // What the chunk declares itself changes with it alone.
        if !self.own.contains_key(&id)
            && !self.names.is_builtin(id)
            && let Some(name) = self.names.name_of(id)
        {
            self.lookups.push(Lookup::Used(name));
        }
    }
}

impl Scope for Above<'_> {
    const IS_PIECE: bool = true;

    fn longest_prefix(&self, word: &str) -> Option<(usize, SymbolId)> {
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

    fn get(&self, name: &str) -> Option<SymbolId> {
        let own = self.own_trie.as_ref().and_then(|trie| trie.get(name));
        own.or_else(|| {
            let name = self.names.trie.get(name)?;
            self.names.visible(name, self.sequence, self.rank)
        })
    }

    fn symbol(&self, id: SymbolId) -> &Symbol {
        match self.own.get(&id) {
            Some(symbol) => symbol,
            None => self.names.symbol(id),
        }
    }

    fn define(&mut self, symbol: Symbol) -> SymbolId {
        let id = self.pool.remove(&symbol.name).unwrap_or_else(|| {
            let id = self.names.fresh(self.fresh);
            self.fresh += 1;
            id
        });
        let trie = self.own_trie.get_or_insert_default();
        let _ = trie.insert(&symbol.name, id);
        self.own.insert(id, symbol);
        self.defines.push(id);
        id
    }

    fn note(&mut self, rest: &str, start: u32, length: usize, kind: TokenKind) {
        let mut length = length;
        match kind {
            TokenKind::Constant(id) | TokenKind::Function(id) => self.use_name(id),
            TokenKind::Undefined => length = 0,
            TokenKind::Declare(_) => return,
            // A parameter that a name hides is not free, and has been looked up where it is declared.
            _ => {}
        }
        if length < rest.len() {
            self.lookups.push(Lookup::Open {
                start,
                end: start + rest.len() as u32,
                length: length as u32,
                is_split: length > 0,
            });
        }
    }

    fn note_whole(&mut self, name: &str, start: u32, kind: TokenKind) {
        match kind {
            TokenKind::Constant(id) | TokenKind::Function(id) => self.use_name(id),
            TokenKind::Declare(_) => {}
            _ => self.lookups.push(Lookup::Open {
                start,
                end: start + name.len() as u32,
                length: name.len() as u32 - 1,
                is_split: false,
            }),
        }
    }

    fn search(&self, _: &mut Search<'_>) {
        // What is spelt alike is told later.
    }
}
