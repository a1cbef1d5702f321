//! Which names a document defines, where, and who would notice if that changed.
//!
//! What flows in: the symbols that a chunk declares, and the names it reads. What flows out: what a word means
//! at a place (the names defined above it, in one trie for all places), and the chunks that read a name.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::geotrace::symbols::{Parsed, Symbol, Vocabulary};
use crate::spelling::Search;
use crate::symbol::SymbolId;
use crate::trie::Trie;

use super::chunk_set::ChunkSet;
use super::sequence::{ChunkId, Sequence};
use super::shelf::Shelf;

/// Names a name that the document defines or has defined.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub(super) struct NameId(u32);

/// All names of a document. A clone costs next to nothing.
#[derive(Clone, Debug)]
pub(super) struct Names {
    pub(super) trie: Trie<NameId>,
    entries: Shelf<Arc<Entry>>,
    /// By [`SymbolId`], the builtins first.
    symbols: Shelf<Option<Arc<Defined>>>,
    free: Vec<SymbolId>,
    builtins: usize,
}

#[derive(Clone, Debug)]
struct Entry {
    name: Arc<str>,
    /// Those who declare it; but while an edit goes on, one. A builtin stays the only one.
    definers: Vec<SymbolId>,
    uses: ChunkSet,
    /// The chunks in which it stands behind a declaring word.
    declared: ChunkSet,
}

/// A symbol and where it is declared.
#[derive(Clone, Debug)]
pub(super) struct Defined {
    /// Its places count from the start of its chunk.
    pub(super) symbol: Symbol,
    /// None for a builtin.
    pub(super) home: Option<ChunkId>,
    /// Where in its chunk it is known from.
    pub(super) known_from: u32,
    name: NameId,
}

/// What those below see of a symbol.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(super) struct Signature {
    word: Option<crate::geotrace::declarations::DeclarationKeyword>,
    parameters: Vec<String>,
    faulty: bool,
}

impl Defined {
    pub(super) fn name(&self) -> NameId {
        self.name
    }
}

impl Names {
    pub(super) fn new(vocabulary: &Vocabulary) -> Self {
        let mut names = Self {
            trie: Trie::default(),
            entries: Shelf::default(),
            symbols: Shelf::default(),
            free: Vec::new(),
            builtins: 0,
        };
        let Parsed { trie, symbols } = vocabulary.start();
        for (id, symbol) in symbols.iter() {
            let name = names.name(&symbol.name);
            if trie.get(&symbol.name) == Some(id) {
                names.entry_mut(name).definers.push(id);
            }
            names.symbols.push(Some(Arc::new(Defined {
                symbol: symbol.clone(),
                home: None,
                known_from: 0,
                name,
            })));
        }
        names.builtins = names.symbols.len();
        names
    }

    pub(super) fn get(&self, id: SymbolId) -> Option<&Defined> {
        self.symbols.get(id.0 as usize)?.as_deref()
    }

    /// The identifier that the next new symbol takes where so many are about to be taken before it.
    pub(super) fn fresh(&self, taken: usize) -> SymbolId {
        match self.free.len().checked_sub(1 + taken) {
            Some(index) => self.free[index],
            None => SymbolId((self.symbols.len() + taken - self.free.len()) as u32),
        }
    }

    pub(super) fn is_builtin(&self, id: SymbolId) -> bool {
        (id.0 as usize) < self.builtins
    }

    /// All symbols that are declared.
    pub(super) fn iter(&self) -> impl Iterator<Item = (SymbolId, &Defined)> {
        let ids = (0..).map(SymbolId);
        ids.zip(self.symbols.iter())
            .filter_map(|(id, symbol)| Some((id, symbol.as_deref()?)))
    }

    pub(super) fn signature(&self, id: SymbolId) -> Option<Signature> {
        let symbol = &self.get(id)?.symbol;
        let parameters = symbol.parameters.iter();
        Some(Signature {
            word: symbol.word,
            parameters: parameters.map(|parameter| parameter.name.clone()).collect(),
            faulty: symbol.faulty,
        })
    }

    /// The name's handle; it may be one that nobody declares.
    pub(super) fn name(&mut self, name: &str) -> NameId {
        if let Some(id) = self.trie.get(name) {
            return id;
        }
        let id = NameId(self.entries.len() as u32);
        self.entries.push(Arc::new(Entry {
            name: name.into(),
            definers: Vec::new(),
            uses: ChunkSet::default(),
            declared: ChunkSet::default(),
        }));
        // What is no name is never found by the lexer either.
        let _ = self.trie.insert(name, id);
        id
    }

    fn entry_mut(&mut self, name: NameId) -> &mut Entry {
        let entry = self.entries.get_mut(name.0 as usize);
        Arc::make_mut(entry.expect("a name of this document"))
    }

    /// The symbol of an identifier that is known to be in use.
    pub(super) fn symbol(&self, id: SymbolId) -> &Symbol {
        let defined = self.get(id).expect("a symbol that a lookup has returned");
        &defined.symbol
    }

    pub(super) fn text(&self, name: NameId) -> &str {
        &self.entries[name.0 as usize].name
    }

    pub(super) fn name_of(&self, id: SymbolId) -> Option<NameId> {
        Some(self.get(id)?.name)
    }

    /// The one symbol of a name that the document declares, once an edit is done.
    pub(super) fn declared(&self, name: NameId) -> Option<SymbolId> {
        let definers = &self.entries[name.0 as usize].definers;
        definers.first().copied().filter(|id| !self.is_builtin(*id))
    }

    /// The symbol that a name stands for below all chunks.
    pub(super) fn named(&self, name: &str) -> Option<SymbolId> {
        let name = self.trie.get(name)?;
        self.entries[name.0 as usize].definers.first().copied()
    }

    /// Visits the symbols that names which begin with `prefix` stand for below all chunks.
    pub(super) fn each_named(
        &self,
        prefix: &str,
        mut visit: impl FnMut(SymbolId, &Defined) -> ControlFlow<()>,
    ) {
        self.trie.each_from(prefix, |_, name| {
            let id = self.entries[name.0 as usize].definers.first().copied();
            match id.and_then(|id| Some((id, self.get(id)?))) {
                Some((id, defined)) => visit(id, defined),
                None => ControlFlow::Continue(()),
            }
        });
    }

    /// A chunk declares a symbol.
    pub(super) fn define(
        &mut self,
        id: SymbolId,
        mut symbol: Symbol,
        home: ChunkId,
        known_from: u32,
    ) {
        let name = self.name(&symbol.name);
        // A list that grew by itself has room for four; the name is there already.
        symbol.parameters.shrink_to_fit();
        symbol.name = Arc::clone(&self.entries[name.0 as usize].name);
        let index = id.0 as usize;
        // Fresh identifiers are taken from the end of the list, in order.
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

    /// The chunk that declares a symbol does so no longer, or is about to be read again.
    pub(super) fn withdraw(&mut self, id: SymbolId) {
        if let Some(name) = self.name_of(id) {
            let definers = &mut self.entry_mut(name).definers;
            definers.retain(|definer| *definer != id);
        }
    }

    /// Nothing names the symbol any more.
    pub(super) fn free(&mut self, id: SymbolId) {
        self.symbols.set(id.0 as usize, None, None);
        self.free.push(id);
    }

    /// A name stands behind a declaring word of a chunk.
    pub(super) fn enter_declared(&mut self, name: &str, chunk: ChunkId) {
        let name = self.name(name);
        self.entry_mut(name).declared.insert(chunk);
    }

    /// A name stands behind no declaring word of a chunk any more.
    pub(super) fn strike_declared(&mut self, name: &str, chunk: ChunkId) {
        let name = self.name(name);
        self.entry_mut(name).declared.remove(chunk);
    }

    /// The chunks in which a name stands behind a declaring word.
    pub(super) fn declaring(&self, name: &str) -> impl Iterator<Item = ChunkId> + '_ {
        let name = self.trie.get(name).into_iter();
        name.flat_map(|name| self.entries[name.0 as usize].declared.iter())
    }

    /// A token of a chunk is this name.
    pub(super) fn enter_use(&mut self, name: NameId, chunk: ChunkId) {
        self.entry_mut(name).uses.insert(chunk);
    }

    /// No token of a chunk is this name any more.
    pub(super) fn strike_use(&mut self, name: NameId, chunk: ChunkId) {
        self.entry_mut(name).uses.remove(chunk);
    }

    /// The chunks in which a token is this name.
    pub(super) fn users(&self, name: NameId) -> impl Iterator<Item = ChunkId> + '_ {
        self.entries[name.0 as usize].uses.iter()
    }

    /// The declared names that `rest` begins with and that are longer than `length`.
    pub(super) fn hiding(&self, rest: &str, length: u32, mut found: impl FnMut(NameId)) {
        self.trie.each_prefix(rest, |name_length, name| {
            if name_length > length as usize && self.declared(name).is_some() {
                found(name);
            }
        });
    }

    /// The symbol that a name stands for where `rank` chunks stand above; none: below all.
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

    /// Considers the names that are known at an offset of a chunk.
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
