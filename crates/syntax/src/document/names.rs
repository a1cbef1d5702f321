//! The names that a document defines, where they are defined, and the chunks that a change of a name affects.
//!
//! In: the symbols that each chunk defines, and the names that it uses. Out: the meaning of a word at a position (one
//! trie contains the names of all chunks; the rank of the defining chunk decides), and the chunks that use a name.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::persistent_vector::PersistentVector;
use crate::spelling::Search;
use crate::symbol::SymbolId;
use crate::trie::Trie;

use super::chunk_set::ChunkSet;
use super::grammar::{Definition, Grammar};
use super::sequence::{ChunkId, Sequence};

/// Identifies a name that the document has defined or looked up.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub(super) struct NameId(u32);

/// All names of a document. A clone shares them.
#[derive(Clone, Debug)]
pub(super) struct Names<G: Grammar> {
    pub(super) trie: Trie<NameId>,
    entries: PersistentVector<Arc<NameEntry>>,
    /// The symbols by [`SymbolId`], the builtins first.
    symbols: PersistentVector<Option<Arc<Defined<G>>>>,
    free: Vec<SymbolId>,
    builtins: usize,
}

#[derive(Clone, Debug)]
struct NameEntry {
    name: Arc<str>,
    /// The symbols of this name: at most one between edits; a builtin is always the only one.
    definers: Vec<SymbolId>,
    uses: ChunkSet,
    /// The chunks that seem to declare it.
    declared: ChunkSet,
}

/// A symbol and the chunk that defines it.
#[derive(Clone, Debug)]
pub(super) struct Defined<G: Grammar> {
    /// The symbol; its spans are relative to the start of its chunk.
    pub(super) symbol: G::Symbol,
    /// The chunk that defines it; `None` for a builtin.
    pub(super) home: Option<ChunkId>,
    /// The offset in its chunk from which it is known.
    pub(super) known_from: u32,
    name: NameId,
}

impl<G: Grammar> Defined<G> {
    pub(super) fn name(&self) -> NameId {
        self.name
    }
}

impl<G: Grammar> Names<G> {
    pub(super) fn new(builtins: Vec<G::Symbol>) -> Self {
        let mut names = Self {
            trie: Trie::default(),
            entries: PersistentVector::default(),
            symbols: PersistentVector::default(),
            free: Vec::new(),
            builtins: builtins.len(),
        };
        for (id, symbol) in (0..).map(SymbolId).zip(builtins) {
            let name = names.name(symbol.name());
            // Of equal names the first is found.
            let definers = &mut names.entry_mut(name).definers;
            if definers.is_empty() && symbol.is_found() {
                definers.push(id);
            }
            names.symbols.push(Some(Arc::new(Defined {
                symbol,
                home: None,
                known_from: 0,
                name,
            })));
        }
        names
    }

    pub(super) fn get(&self, id: SymbolId) -> Option<&Defined<G>> {
        self.symbols.get(id.0 as usize)?.as_deref()
    }

    /// Returns the handle of the next new symbol, after `taken` others that are about to be defined.
    pub(super) fn fresh(&self, taken: usize) -> SymbolId {
        match self.free.len().checked_sub(1 + taken) {
            Some(index) => self.free[index],
            None => SymbolId((self.symbols.len() + taken - self.free.len()) as u32),
        }
    }

    pub(super) fn is_builtin(&self, id: SymbolId) -> bool {
        (id.0 as usize) < self.builtins
    }

    /// Returns all defined symbols.
    pub(super) fn iter(&self) -> impl Iterator<Item = (SymbolId, &Defined<G>)> {
        let ids = (0..).map(SymbolId);
        ids.zip(self.symbols.iter())
            .filter_map(|(id, symbol)| Some((id, symbol.as_deref()?)))
    }

    pub(super) fn signature(&self, id: SymbolId) -> Option<<G::Symbol as Definition>::Signature> {
        Some(self.get(id)?.symbol.signature())
    }

    /// Returns the name's handle. The name need not be defined.
    pub(super) fn name(&mut self, name: &str) -> NameId {
        if let Some(id) = self.trie.get(name) {
            return id;
        }
        let id = NameId(self.entries.len() as u32);
        self.entries.push(Arc::new(NameEntry {
            name: name.into(),
            definers: Vec::new(),
            uses: ChunkSet::default(),
            declared: ChunkSet::default(),
        }));
        // A name outside the trie's alphabet is never found.
        let _ = self.trie.insert(name, id);
        id
    }

    fn entry_mut(&mut self, name: NameId) -> &mut NameEntry {
        let entry = self.entries.get_mut(name.0 as usize);
        Arc::make_mut(entry.expect("a name of this document"))
    }

    /// Returns the symbol of a handle that is in use.
    pub(super) fn symbol(&self, id: SymbolId) -> &G::Symbol {
        let defined = self.get(id).expect("a symbol that a lookup has returned");
        &defined.symbol
    }

    pub(super) fn text(&self, name: NameId) -> &str {
        &self.entries[name.0 as usize].name
    }

    pub(super) fn name_of(&self, id: SymbolId) -> Option<NameId> {
        Some(self.get(id)?.name)
    }

    /// Returns the symbol of a name that the text defines. It is unique only between edits.
    pub(super) fn declared(&self, name: NameId) -> Option<SymbolId> {
        let definers = &self.entries[name.0 as usize].definers;
        definers.first().copied().filter(|id| !self.is_builtin(*id))
    }

    /// Returns the symbol that a name means at the end of the text.
    pub(super) fn named(&self, name: &str) -> Option<SymbolId> {
        let name = self.trie.get(name)?;
        self.entries[name.0 as usize].definers.first().copied()
    }

    /// Visits the symbols that the names that begin with `prefix` mean at the end of the text.
    pub(super) fn each_named(
        &self,
        prefix: &str,
        mut visit: impl FnMut(SymbolId, &Defined<G>) -> ControlFlow<()>,
    ) {
        self.trie.each_from(prefix, |_, name| {
            let id = self.entries[name.0 as usize].definers.first().copied();
            match id.and_then(|id| Some((id, self.get(id)?))) {
                Some((id, defined)) => visit(id, defined),
                None => ControlFlow::Continue(()),
            }
        });
    }

    /// Adds a symbol that a chunk defines.
    pub(super) fn define(
        &mut self,
        id: SymbolId,
        mut symbol: G::Symbol,
        home: ChunkId,
        known_from: u32,
    ) {
        let name = self.name(symbol.name());
        symbol.share_name(&self.entries[name.0 as usize].name);
        let index = id.0 as usize;
        // Fresh handles are taken from the end of the list, in order.
        if self.free.last() == Some(&id) {
            self.free.pop();
        }
        let defined = Arc::new(Defined {
            symbol,
            home: Some(home),
            known_from,
            name,
        });
        self.symbols.set(index, Some(defined), None);
        self.entry_mut(name).definers.push(id);
    }

    /// Removes the definition of a symbol whose chunk is about to be read again or removed. Its handle remains
    /// reserved.
    pub(super) fn undefine(&mut self, id: SymbolId) {
        if let Some(name) = self.name_of(id) {
            let definers = &mut self.entry_mut(name).definers;
            definers.retain(|definer| *definer != id);
        }
    }

    /// Frees the handle of an undefined symbol.
    pub(super) fn free(&mut self, id: SymbolId) {
        self.symbols.set(id.0 as usize, None, None);
        self.free.push(id);
    }

    /// Adds a chunk that seems to declare a name.
    pub(super) fn insert_declared(&mut self, name: &str, chunk: ChunkId) {
        let name = self.name(name);
        self.entry_mut(name).declared.insert(chunk);
    }

    /// Removes a chunk that seemed to declare a name.
    pub(super) fn remove_declared(&mut self, name: &str, chunk: ChunkId) {
        let name = self.name(name);
        self.entry_mut(name).declared.remove(chunk);
    }

    /// Returns the chunks that seem to declare a name.
    pub(super) fn declaring(&self, name: &str) -> impl Iterator<Item = ChunkId> + '_ {
        let name = self.trie.get(name).into_iter();
        name.flat_map(|name| self.entries[name.0 as usize].declared.iter())
    }

    /// Adds a chunk that uses this name as a token.
    pub(super) fn insert_use(&mut self, name: NameId, chunk: ChunkId) {
        self.entry_mut(name).uses.insert(chunk);
    }

    /// Removes a chunk that used this name as a token.
    pub(super) fn remove_use(&mut self, name: NameId, chunk: ChunkId) {
        self.entry_mut(name).uses.remove(chunk);
    }

    /// Returns the chunks that use this name as a token.
    pub(super) fn users(&self, name: NameId) -> impl Iterator<Item = ChunkId> + '_ {
        self.entries[name.0 as usize].uses.iter()
    }

    /// Calls `found` with each name that the text defines, that is a prefix of `rest` and that is longer than `length`.
    pub(super) fn longer_prefixes(&self, rest: &str, length: u32, mut found: impl FnMut(NameId)) {
        self.trie.each_prefix(rest, |name_length, name| {
            if name_length > length as usize && self.declared(name).is_some() {
                found(name);
            }
        });
    }

    /// Returns the symbol that a name denotes in a chunk with `rank` chunks above it, or without a rank at the end of
    /// the text.
    pub(super) fn visible(
        &self,
        name: NameId,
        sequence: &Sequence,
        rank: Option<u32>,
    ) -> Option<SymbolId> {
        let definers = &self.entries[name.0 as usize].definers;
        let Some(rank) = rank else {
            return definers.first().copied();
        };
        definers
            .iter()
            .filter_map(|id| {
                let above = match self.get(*id)?.home {
                    Some(home) => sequence.rank(home) + 1,
                    None => 0,
                };
                (above <= rank).then_some((above, *id))
            })
            .min()
            .map(|(_, id)| id)
    }

    /// Passes the names that are known at an offset of a chunk to a search.
    pub(super) fn search(
        &self,
        search: &mut Search<'_>,
        sequence: &Sequence,
        chunk: ChunkId,
        offset: u32,
    ) {
        let rank = sequence.rank(chunk);
        search.among(&self.trie, |name| {
            let definers = self.entries[name.0 as usize].definers.iter();
            definers.filter_map(|id| self.get(*id)).any(|defined| {
                defined.home.is_none_or(|home| {
                    if home == chunk {
                        return defined.known_from <= offset;
                    }
                    sequence.rank(home) < rank
                })
            })
        });
    }
}
