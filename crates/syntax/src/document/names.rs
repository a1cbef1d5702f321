//! Which names a document defines, where, and who would notice if that changed.
//!
//! What flows in: the symbols that a chunk declares, and the words it has looked up. What flows out: what a
//! word means at a place (the names defined above it, in one trie for all places), and the chunks below that
//! read a name, or would.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Bound;

use crate::parser::suggestions::Search;
use crate::symbols::{Parsed, Scope, Symbol, Vocabulary};
use crate::token::{SymbolId, TokenKind};
use crate::trie::Trie;

use super::sequence::{ChunkId, Sequence};

/// Names a name that the document defines or has defined.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub(super) struct NameId(u32);

/// What a chunk has asked of the names above it.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(super) enum Lookup {
    /// A token is this name, which the document declares.
    Used(NameId),
    /// The chunk's text from `start` to `end` was looked up, and every name longer than `length` that it
    /// begins with would be noticed.
    Open {
        start: u32,
        end: u32,
        length: u32,
        /// A token of `length` bytes was split off.
        is_split: bool,
    },
}

/// All names of a document.
#[derive(Clone, Debug)]
pub(super) struct Names {
    trie: Trie<NameId>,
    entries: Vec<Entry>,
    /// By [`SymbolId`], the builtins first.
    symbols: Vec<Option<Defined>>,
    free: Vec<SymbolId>,
    builtins: usize,
    /// By the words that were looked up and are not one whole name: in lexicographic order, so that those
    /// that begin with a name stand together.
    open: BTreeMap<Box<str>, Vec<Group>>,
}

#[derive(Clone, Debug)]
struct Entry {
    name: Box<str>,
    /// Those who declare it; but while an edit goes on, one. A builtin stays the only one.
    definers: Vec<SymbolId>,
    uses: ChunkSet,
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

/// Chunks that have looked up the same word with the same result.
#[derive(Clone, Debug)]
struct Group {
    length: u32,
    is_split: bool,
    chunks: ChunkSet,
}

/// What those below see of a symbol.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(super) struct Signature {
    word: Option<crate::token::DeclareWord>,
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
            entries: Vec::new(),
            symbols: Vec::new(),
            free: Vec::new(),
            builtins: 0,
            open: BTreeMap::new(),
        };
        let Parsed { trie, symbols } = vocabulary.start();
        for (id, symbol) in symbols.iter() {
            let name = names.name(&symbol.name);
            if trie.get(&symbol.name) == Some(id) {
                names.entries[name.0 as usize].definers.push(id);
            }
            names.symbols.push(Some(Defined {
                symbol: symbol.clone(),
                home: None,
                known_from: 0,
                name,
            }));
        }
        names.builtins = names.symbols.len();
        names
    }

    pub(super) fn get(&self, id: SymbolId) -> Option<&Defined> {
        self.symbols.get(id.0 as usize)?.as_ref()
    }

    pub(super) fn is_builtin(&self, id: SymbolId) -> bool {
        (id.0 as usize) < self.builtins
    }

    /// All symbols that are declared.
    pub(super) fn iter(&self) -> impl Iterator<Item = (SymbolId, &Defined)> {
        let ids = (0..).map(SymbolId);
        ids.zip(&self.symbols)
            .filter_map(|(id, symbol)| Some((id, symbol.as_ref()?)))
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
        self.entries.push(Entry {
            name: name.into(),
            definers: Vec::new(),
            uses: ChunkSet::default(),
        });
        // What is no name is never found by the lexer either.
        let _ = self.trie.insert(name, id);
        id
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

    /// A chunk declares a symbol.
    pub(super) fn define(&mut self, id: SymbolId, symbol: Symbol, home: ChunkId, known_from: u32) {
        let name = self.name(&symbol.name);
        let index = id.0 as usize;
        if self.symbols.len() <= index {
            self.symbols.resize(index + 1, None);
        }
        // Fresh identifiers are taken from the end of the list, in order.
        if self.free.last() == Some(&id) {
            self.free.pop();
        }
        self.symbols[index] = Some(Defined {
            symbol,
            home: Some(home),
            known_from,
            name,
        });
        self.entries[name.0 as usize].definers.push(id);
    }

    /// The chunk that declares a symbol does so no longer, or is about to be read again.
    pub(super) fn withdraw(&mut self, id: SymbolId) {
        if let Some(name) = self.name_of(id) {
            let definers = &mut self.entries[name.0 as usize].definers;
            definers.retain(|definer| *definer != id);
        }
    }

    /// Nothing names the symbol any more.
    pub(super) fn free(&mut self, id: SymbolId) {
        self.symbols[id.0 as usize] = None;
        self.free.push(id);
    }

    /// Enters a chunk's lookups.
    pub(super) fn enter(&mut self, chunk: ChunkId, text: &str, lookups: &[Lookup]) {
        for lookup in lookups {
            match *lookup {
                Lookup::Used(name) => self.entries[name.0 as usize].uses.insert(chunk),
                Lookup::Open {
                    start,
                    end,
                    length,
                    is_split,
                } => {
                    let rest = &text[start as usize..end as usize];
                    if !self.open.contains_key(rest) {
                        self.open.insert(rest.into(), Vec::new());
                    }
                    let Some(groups) = self.open.get_mut(rest) else {
                        continue;
                    };
                    let same =
                        |group: &&mut Group| group.length == length && group.is_split == is_split;
                    match groups.iter_mut().find(same) {
                        Some(group) => group.chunks.insert(chunk),
                        None => {
                            let mut chunks = ChunkSet::default();
                            chunks.insert(chunk);
                            groups.push(Group {
                                length,
                                is_split,
                                chunks,
                            });
                        }
                    }
                }
            }
        }
    }

    /// Strikes out a chunk's lookups.
    pub(super) fn strike(&mut self, chunk: ChunkId, text: &str, lookups: &[Lookup]) {
        for lookup in lookups {
            match *lookup {
                Lookup::Used(name) => self.entries[name.0 as usize].uses.remove(chunk),
                Lookup::Open {
                    start,
                    end,
                    length,
                    is_split,
                } => {
                    let rest = &text[start as usize..end as usize];
                    let Some(groups) = self.open.get_mut(rest) else {
                        continue;
                    };
                    for group in groups.iter_mut() {
                        if group.length == length && group.is_split == is_split {
                            group.chunks.remove(chunk);
                        }
                    }
                    groups.retain(|group| !group.chunks.is_empty());
                    if groups.is_empty() {
                        self.open.remove(rest);
                    }
                }
            }
        }
    }

    /// The chunks in which a token is this name.
    pub(super) fn users(&self, name: NameId) -> impl Iterator<Item = ChunkId> + '_ {
        self.entries[name.0 as usize].uses.iter()
    }

    /// The chunks that would notice the name if it were defined above them, each with what the lookup took.
    pub(super) fn open_to(&self, name: NameId) -> impl Iterator<Item = (ChunkId, bool)> + '_ {
        let name = self.text(name);
        let from = (Bound::Included(name), Bound::Unbounded);
        self.open
            .range::<str, _>(from)
            .take_while(move |(rest, _)| rest.starts_with(name))
            .flat_map(|(_, groups)| groups)
            .filter(move |group| (group.length as usize) < name.len())
            .flat_map(|group| {
                let split = group.is_split;
                group.chunks.iter().map(move |chunk| (chunk, split))
            })
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
    fn visible(&self, name: NameId, sequence: &Sequence, rank: Option<u32>) -> Option<SymbolId> {
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

/// The names as a chunk sees them that is being read.
#[derive(Debug)]
pub(super) struct Above<'d> {
    names: &'d Names,
    sequence: &'d Sequence,
    /// How many chunks stand above; none where all that have been read do.
    rank: Option<u32>,
    /// Identifiers to be used again, by name.
    pool: &'d mut HashMap<String, SymbolId>,
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
        pool: &'d mut HashMap<String, SymbolId>,
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
            None => {
                &self.names.symbols[id.0 as usize]
                    .as_ref()
                    .expect("a symbol that a lookup has returned")
                    .symbol
            }
        }
    }

    fn define(&mut self, symbol: Symbol) -> SymbolId {
        let id = self.pool.remove(&symbol.name).unwrap_or_else(|| {
            let free = &self.names.free;
            let id = match free.len().checked_sub(1 + self.fresh) {
                Some(index) => free[index],
                None => {
                    let beyond = self.fresh - free.len();
                    SymbolId((self.names.symbols.len() + beyond) as u32)
                }
            };
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

/// Chunks without an order: most often one or two, sometimes nearly all.
#[derive(Clone, Debug)]
pub(super) enum ChunkSet {
    Few(Vec<ChunkId>),
    Many(HashSet<ChunkId>),
}

/// The most chunks in a list.
const MAX_FEW: usize = 16;

impl Default for ChunkSet {
    fn default() -> Self {
        Self::Few(Vec::new())
    }
}

impl ChunkSet {
    pub(super) fn insert(&mut self, chunk: ChunkId) {
        match self {
            Self::Many(chunks) => {
                chunks.insert(chunk);
            }
            Self::Few(chunks) if chunks.contains(&chunk) => {}
            Self::Few(chunks) if chunks.len() < MAX_FEW => chunks.push(chunk),
            Self::Few(chunks) => {
                let mut all: HashSet<ChunkId> = chunks.iter().copied().collect();
                all.insert(chunk);
                *self = Self::Many(all);
            }
        }
    }

    pub(super) fn remove(&mut self, chunk: ChunkId) {
        match self {
            Self::Few(chunks) => chunks.retain(|other| *other != chunk),
            Self::Many(chunks) => {
                chunks.remove(&chunk);
                if chunks.len() < MAX_FEW / 2 {
                    *self = Self::Few(chunks.iter().copied().collect());
                }
            }
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        match self {
            Self::Few(chunks) => chunks.is_empty(),
            Self::Many(chunks) => chunks.is_empty(),
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = ChunkId> + '_ {
        let (few, many) = match self {
            Self::Few(chunks) => (Some(chunks), None),
            Self::Many(chunks) => (None, Some(chunks)),
        };
        let few = few.into_iter().flatten();
        few.chain(many.into_iter().flatten()).copied()
    }
}
