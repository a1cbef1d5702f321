//! An edit: the chunks that are cut again, and the chunks that are read again because a name has changed.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use crate::span::Span;
use crate::symbol::SymbolId;

use super::Document;
use super::chunk::{Chunk, ChunkDiagnostic};
use super::grammar::{Definition, Grammar, Reading};
use super::lookups::Lookup;
use super::names::NameId;
use super::scope::ScopeView;
use super::sequence::ChunkId;
use super::snapshot::Snapshot;

type Signature<G> = <<G as Grammar>::Symbol as Definition>::Signature;

/// The state of an edit in progress.
#[derive(Debug)]
pub(super) struct Pass<G: Grammar> {
    /// The previous definitions of the chunks that are being read, by name.
    before: HashMap<NameId, (SymbolId, Signature<G>)>,
    /// The handles of symbols that are currently undefined, by name.
    pub(super) pool: HashMap<Arc<str>, SymbolId>,
    /// The names whose shadowed splits may have changed.
    pub(super) touched: BTreeSet<NameId>,
    /// The chunks that remain to be read again, by rank.
    affected: BTreeMap<u32, ChunkId>,
    /// The number of chunks above the new text.
    above: u32,
    pub(super) removed: Vec<ChunkId>,
    pub(super) read: Vec<ChunkId>,
}

impl<G: Grammar> Default for Pass<G> {
    fn default() -> Self {
        Self {
            before: HashMap::new(),
            pool: HashMap::new(),
            touched: BTreeSet::new(),
            affected: BTreeMap::new(),
            above: 0,
            removed: Vec::new(),
            read: Vec::new(),
        }
    }
}

impl<G: Grammar> Document<G> {
    fn chunk_mut(&mut self, chunk: ChunkId) -> &mut Chunk<G> {
        let place = self.snapshot.chunks.get_mut(chunk.0 as usize);
        let read = place.and_then(Option::as_mut);
        Arc::make_mut(read.expect("a chunk of this document"))
    }

    pub(super) fn allocate(&mut self, text: &str) -> ChunkId {
        let chunk = Chunk::unread(text, self.version);
        let id = self.free.pop().unwrap_or(ChunkId(self.chunks.len() as u32));
        let place = id.0 as usize;
        let chunks = &mut self.snapshot.chunks;
        chunks.set(place, Some(Arc::new(chunk)), None);
        self.insert_declared(id);
        id
    }

    fn insert_declared(&mut self, id: ChunkId) {
        let Snapshot { chunks, names, .. } = &mut self.snapshot;
        let chunk = chunks.get(id.0 as usize).and_then(Option::as_deref);
        for (name, _) in chunk.into_iter().flat_map(Chunk::declared) {
            names.insert_declared(name, id);
        }
    }

    fn remove_declared(&mut self, id: ChunkId) {
        let Snapshot { chunks, names, .. } = &mut self.snapshot;
        let chunk = chunks.get(id.0 as usize).and_then(Option::as_deref);
        for (name, _) in chunk.into_iter().flat_map(Chunk::declared) {
            names.remove_declared(name, id);
        }
    }

    /// Returns the chunks that an edit replaces, and the texts of their replacements.
    ///
    /// The new text is cut from the start of the first chunk that the edit touches. Chunks below are included until the new
    /// text ends at a chunk's end: an edit that opens a comment or a block may move many ends.
    pub(super) fn replace(&mut self, range: Span, text: &str) -> (Vec<ChunkId>, Vec<String>) {
        let Some((touched, before)) = self.sequence.at_byte(range.start) else {
            return (Vec::new(), Vec::new());
        };
        let mut old = vec![touched];
        let mut last = touched;
        let mut start = before.bytes;
        while start + (self.chunk(last).text.len() as u32) <= range.end
            && range.end > range.start
            && let Some(next) = self.sequence.next(last)
        {
            start += self.chunk(last).text.len() as u32;
            last = next;
            old.push(last);
        }
        let mut head = self.chunk(touched).text[..(range.start - before.bytes) as usize].to_owned();
        let mut first = before.bytes;
        // The beginning of a chunk may determine where the chunk above ends.
        while head.trim_start().len() < G::LOOKAHEAD
            && let Some((above, before)) = first
                .checked_sub(1)
                .and_then(|at| self.sequence.at_byte(at))
        {
            head.insert_str(0, &self.chunk(above).text);
            old.insert(0, above);
            first = before.bytes;
        }
        let tail = &self.chunk(last).text[(range.end - start) as usize..];
        let mut all = [&head, text, tail].concat();
        let mut ends = Vec::new();
        let mut cut_to = 0;
        let mut state = G::CutState::default();
        // The start of the last included chunk, for its beginning.
        let mut boundary = None;
        loop {
            state = G::cut(&all, cut_to, state, &mut ends);
            if let Some(boundary) = boundary
                && ends.binary_search(&boundary).is_ok()
            {
                ends.retain(|end| *end <= boundary);
                old.pop();
                break;
            }
            cut_to = all.len();
            let Some(next) = self.sequence.next(last) else {
                G::cut_last(&all, state, &mut ends);
                ends.push(all.len());
                break;
            };
            if G::LOOKAHEAD > 0 {
                boundary = Some(all.len());
            } else if ends.last() == Some(&all.len()) {
                break;
            }
            all.push_str(&self.chunk(next).text);
            old.push(next);
            last = next;
        }
        self.counters.cut += all.len() as u64;
        let mut start = 0;
        let texts = ends.into_iter().map(|end| {
            let piece = all[start..end].to_owned();
            start = end;
            piece
        });
        (old, texts.collect())
    }

    /// Replaces old chunks by chunks with new texts, and returns the chunks that have to be read.
    ///
    /// Chunks at either end whose text is unchanged are left as they are. The definitions and look-ups of the others
    /// are removed. Their handles are assigned to the new texts from the end, because the last new text most likely
    /// corresponds to the last old chunk.
    pub(super) fn rearrange(
        &mut self,
        mut old: Vec<ChunkId>,
        mut new: Vec<String>,
        pass: &mut Pass<G>,
    ) -> Vec<ChunkId> {
        let start = old.first().map_or(0, |first| self.start(*first));
        let above = start
            .checked_sub(1)
            .and_then(|last| self.sequence.at_byte(last));
        let above = above.map(|(chunk, _)| chunk);
        let is_same = |document: &Self, chunk: Option<&ChunkId>, text: Option<&String>| {
            matches!((chunk, text), (Some(chunk), Some(text))
                if *document.chunk(*chunk).text == **text && !text.starts_with('\u{FEFF}'))
        };
        while is_same(self, old.last(), new.last()) {
            old.pop();
            new.pop();
        }
        let mut kept = 0;
        while is_same(self, old.get(kept), new.get(kept)) {
            kept += 1;
        }
        let mut after = match kept.checked_sub(1) {
            Some(index) => old.get(index).copied(),
            None => above,
        };
        pass.above = after.map_or(0, |chunk| self.sequence.rank(chunk) + 1);
        let old = old.split_off(kept);
        let new = new.split_off(kept);
        for chunk in &old {
            self.clear_reading(*chunk, pass);
            self.remove_declared(*chunk);
        }
        let surplus = old.len().saturating_sub(new.len());
        let fresh = new.len().saturating_sub(old.len());
        for chunk in &old[..surplus] {
            self.snapshot.sequence.remove(*chunk);
            self.snapshot.chunks.set(chunk.0 as usize, None, None);
            pass.removed.push(*chunk);
        }
        let mut chunks = Vec::with_capacity(new.len());
        for (index, text) in new.iter().enumerate() {
            let chunk = match index.checked_sub(fresh) {
                Some(index) => {
                    let chunk = old[surplus + index];
                    let read = self.chunk_mut(chunk);
                    read.set_text(text);
                    self.insert_declared(chunk);
                    let measure = self.chunk(chunk).measure();
                    self.snapshot.sequence.measure(chunk, measure);
                    chunk
                }
                None => {
                    let chunk = self.allocate(text);
                    let measure = self.chunk(chunk).measure();
                    self.snapshot.sequence.insert(after, chunk, measure);
                    chunk
                }
            };
            after = Some(chunk);
            chunks.push(chunk);
        }
        self.free.extend(&pass.removed);
        chunks
    }

    /// Removes all definitions and look-ups of a chunk. Its symbols are pooled: if they are defined again under the
    /// same names, they keep their handles.
    fn clear_reading(&mut self, id: ChunkId, pass: &mut Pass<G>) {
        let Some(chunk) = self.snapshot.chunks[id.0 as usize].clone() else {
            return;
        };
        self.touch(&chunk, &mut pass.touched);
        for lookup in &chunk.lookups {
            match *lookup {
                Lookup::Used(name) => self.snapshot.names.remove_use(name, id),
                Lookup::Open {
                    start,
                    end,
                    length,
                    is_split,
                } => {
                    let rest = &chunk.text[start as usize..end as usize];
                    self.unresolved.remove(id, rest, length, is_split);
                }
            }
        }
        let names = &mut self.snapshot.names;
        for symbol in chunk.defined() {
            if let (Some(signature), Some(defined)) = (names.signature(symbol), names.get(symbol)) {
                let name = defined.name();
                let text = Arc::clone(defined.symbol.name());
                pass.before.insert(name, (symbol, signature));
                pass.pool.insert(text, symbol);
                names.undefine(symbol);
            }
        }
        let cleared = Arc::new(chunk.without_reading());
        let chunks = &mut self.snapshot.chunks;
        chunks.set(id.0 as usize, Some(cleared), None);
    }

    /// Reads a chunk with the names above it. Its previous definitions and look-ups have been removed.
    pub(super) fn read(
        &mut self,
        id: ChunkId,
        rank: Option<u32>,
        pool: &mut HashMap<Arc<str>, SymbolId>,
        touched: &mut BTreeSet<NameId>,
    ) {
        let is_first = match rank {
            Some(rank) => rank == 0,
            None => self.sequence.first() == Some(id),
        };
        let version = self.version;
        let chunk = self.chunk(id);
        let scope = ScopeView::new(&self.names, &self.sequence, rank, pool);
        let (scope, reading) = G::read(&chunk.text, is_first, scope);
        let (symbols, lookups) = scope.finish();
        let Reading {
            analysis,
            diagnostics,
            deferred,
            known_from,
        } = reading;
        let mut deferred = deferred.into_iter().peekable();
        let diagnostics = diagnostics.into_iter().enumerate();
        let diagnostics = diagnostics.map(|(index, diagnostic)| ChunkDiagnostic {
            diagnostic,
            deferred: deferred
                .next_if(|(at, _)| *at == index)
                .map(|(_, deferred)| Box::new(deferred)),
        });
        let diagnostics = diagnostics.collect();
        let known_from: HashMap<SymbolId, u32> = known_from.into_iter().collect();
        let chunk = self.chunk_mut(id);
        chunk.analysis = analysis;
        chunk.diagnostics = diagnostics;
        chunk.lookups = lookups.into_boxed_slice();
        chunk.version = version;
        let names = &mut self.snapshot.names;
        for (symbol, meaning) in symbols {
            let known_from = known_from.get(&symbol).copied().unwrap_or_default();
            names.define(symbol, meaning, id, known_from);
            touched.extend(names.name_of(symbol));
        }
        let Some(Some(chunk)) = self.snapshot.chunks.get(id.0 as usize) else {
            return;
        };
        for lookup in &chunk.lookups {
            match *lookup {
                Lookup::Used(name) => names.insert_use(name, id),
                Lookup::Open {
                    start,
                    end,
                    length,
                    is_split,
                } => {
                    let rest = &chunk.text[start as usize..end as usize];
                    self.unresolved.insert(id, rest, length, is_split);
                }
            }
        }
        self.snapshot.sequence.measure(id, chunk.measure());
        self.touch(self.snapshot.chunk(id), touched);
    }

    /// Reads the chunks whose text is new.
    pub(super) fn read_edited(&mut self, chunks: &[ChunkId], pass: &mut Pass<G>) {
        let first = pass.above;
        for (rank, chunk) in (first..).zip(chunks) {
            self.read(*chunk, Some(rank), &mut pass.pool, &mut pass.touched);
            self.counters.edited += 1;
            pass.read.push(*chunk);
        }
        self.compare(chunks, first + chunks.len() as u32, pass);
    }

    /// Reads the chunks below that a change of names affects.
    ///
    /// Reading a chunk may change further names, but that affects only chunks below it. So the affected chunk of the
    /// lowest rank is always read next, and each chunk is read at most once.
    pub(super) fn read_below(&mut self, pass: &mut Pass<G>) {
        while let Some((rank, chunk)) = pass.affected.pop_first() {
            self.clear_reading(chunk, pass);
            self.read(chunk, Some(rank), &mut pass.pool, &mut pass.touched);
            self.counters.reread += 1;
            pass.read.push(chunk);
            self.compare(&[chunk], rank + 1, pass);
        }
    }

    /// Compares the definitions of chunks with their previous definitions, and marks the chunks below that a difference
    /// affects. `rank` is the rank of the first chunk below.
    ///
    /// A changed or removed name affects the chunks that use it. A new name also affects the chunks that contain a word
    /// that begins with it and was read differently.
    fn compare(&mut self, chunks: &[ChunkId], rank: u32, pass: &mut Pass<G>) {
        let mut before = std::mem::take(&mut pass.before);
        let mut changed: Vec<(NameId, bool)> = Vec::new();
        for chunk in chunks {
            for symbol in self.chunk(*chunk).defined() {
                let Some(name) = self.names.name_of(symbol) else {
                    continue;
                };
                match before.remove(&name) {
                    None => changed.push((name, true)),
                    Some((known, signature)) => {
                        let same = known == symbol
                            && self.names.signature(symbol).as_ref() == Some(&signature);
                        if !same {
                            changed.push((name, false));
                        }
                    }
                }
            }
        }
        changed.extend(before.into_keys().map(|name| (name, false)));
        for (name, is_new) in changed {
            let users = self.names.users(name);
            let words = self.unresolved.beginning_with(self.names.text(name));
            let words = words.filter(|_| is_new);
            for chunk in users.chain(words) {
                let place = self.sequence.rank(chunk);
                if place >= rank {
                    pass.affected.insert(place, chunk);
                }
            }
            pass.touched.insert(name);
        }
    }
}

impl<G: Grammar> Snapshot<G> {
    /// Adds to `touched` the names whose letters a chunk reads as several tokens.
    pub(super) fn touch(&self, chunk: &Chunk<G>, touched: &mut BTreeSet<NameId>) {
        for lookup in &chunk.lookups {
            if let Lookup::Open {
                start,
                end,
                length,
                is_split: true,
            } = *lookup
            {
                let rest = &chunk.text[start as usize..end as usize];
                self.names.longer_prefixes(rest, length, |name| {
                    touched.insert(name);
                });
            }
        }
    }
}
