//! One edit: which chunks are cut anew, and who reads again what has changed.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use crate::geotrace::parser::parse_piece;
use crate::span::Span;
use crate::symbol::SymbolId;

use super::Document;
use super::above::Above;
use super::chunk::{Chunk, Finding, Recorder, cut};
use super::names::{NameId, Signature};
use super::open_words::Lookup;
use super::record::Records;
use super::sequence::ChunkId;
use super::snapshot::Snapshot;

/// What is known while an edit goes on.
#[derive(Debug, Default)]
pub(super) struct Pass {
    /// What the chunks declared that are being read, by name.
    before: HashMap<NameId, (SymbolId, Signature)>,
    /// The symbols that are not declared at the moment, by name.
    pub(super) pool: HashMap<Arc<str>, SymbolId>,
    /// The names for whose letters splits are to be looked for.
    pub(super) touched: BTreeSet<NameId>,
    /// The chunks to be read again, from top to bottom.
    affected: BTreeMap<u32, ChunkId>,
    /// How many chunks stand above what is new.
    above: u32,
    pub(super) removed: Vec<ChunkId>,
    pub(super) read: Vec<ChunkId>,
}

impl Document {
    fn chunk_mut(&mut self, chunk: ChunkId) -> &mut Chunk {
        let place = self.snapshot.chunks.get_mut(chunk.0 as usize);
        let read = place.and_then(Option::as_mut);
        Arc::make_mut(read.expect("a chunk of this document"))
    }

    pub(super) fn allocate(&mut self, text: &str) -> ChunkId {
        let mut chunk = Chunk {
            text: text.into(),
            version: self.version,
            ..Chunk::default()
        };
        chunk.scan();
        let id = self.free.pop().unwrap_or(ChunkId(self.chunks.len() as u32));
        let place = id.0 as usize;
        let chunks = &mut self.snapshot.chunks;
        chunks.set(place, Some(Arc::new(chunk)), None);
        self.enter_declared(id);
        id
    }

    fn enter_declared(&mut self, id: ChunkId) {
        let Snapshot { chunks, names, .. } = &mut self.snapshot;
        let chunk = chunks.get(id.0 as usize).and_then(Option::as_deref);
        for (name, _) in chunk.into_iter().flat_map(Chunk::declared) {
            names.enter_declared(name, id);
        }
    }

    fn strike_declared(&mut self, id: ChunkId) {
        let Snapshot { chunks, names, .. } = &mut self.snapshot;
        let chunk = chunks.get(id.0 as usize).and_then(Option::as_deref);
        for (name, _) in chunk.into_iter().flat_map(Chunk::declared) {
            names.strike_declared(name, id);
        }
    }

    /// The chunks that an edit touches, and the texts that take their place: as many as need be for the last
    /// to end where the chunk after it begins.
    pub(super) fn replace(&mut self, range: Span, text: &str) -> (Vec<ChunkId>, Vec<String>) {
        let Some((first, before)) = self.sequence.at_byte(range.start) else {
            return (Vec::new(), Vec::new());
        };
        let mut old = vec![first];
        let mut last = first;
        let mut start = before.bytes;
        while start + (self.chunk(last).text.len() as u32) <= range.end
            && range.end > range.start
            && let Some(next) = self.sequence.next(last)
        {
            start += self.chunk(last).text.len() as u32;
            last = next;
            old.push(last);
        }
        let head = &self.chunk(first).text[..(range.start - before.bytes) as usize];
        let tail = &self.chunk(last).text[(range.end - start) as usize..];
        let mut all = [head, text, tail].concat();
        let mut ends = Vec::new();
        let mut cut_to = 0;
        let mut in_comment = false;
        loop {
            in_comment = cut(&all, cut_to, in_comment, &mut ends);
            cut_to = all.len();
            let Some(next) = self.sequence.next(last) else {
                ends.push(all.len());
                break;
            };
            if ends.last() == Some(&all.len()) {
                break;
            }
            all.push_str(&self.chunk(next).text);
            old.push(next);
            last = next;
        }
        self.work.cut += all.len() as u64;
        let mut start = 0;
        let texts = ends.into_iter().map(|end| {
            let piece = all[start..end].to_owned();
            start = end;
            piece
        });
        (old, texts.collect())
    }

    /// Puts new texts in the place of old chunks and says which chunks are to be read. What the old ones
    /// declared and asked is struck out; where a text has not changed, the chunk stays.
    pub(super) fn rearrange(
        &mut self,
        mut old: Vec<ChunkId>,
        mut new: Vec<String>,
        pass: &mut Pass,
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
            self.withdraw(*chunk, pass);
            self.strike_declared(*chunk);
        }
        // The last new text is most likely what the last old chunk has become.
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
                    read.text = text.as_str().into();
                    read.scan();
                    self.enter_declared(chunk);
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

    /// Strikes out all that a chunk has declared and asked. Its symbols may be declared again, under the same
    /// identifiers.
    fn withdraw(&mut self, id: ChunkId, pass: &mut Pass) {
        let chunk = self.snapshot.chunks[id.0 as usize].clone();
        let chunk = chunk.unwrap_or_default();
        self.touch(&chunk, &mut pass.touched);
        for lookup in &chunk.lookups {
            match *lookup {
                Lookup::Used(name) => self.snapshot.names.strike_use(name, id),
                Lookup::Open {
                    start,
                    end,
                    length,
                    is_split,
                } => {
                    let rest = &chunk.text[start as usize..end as usize];
                    self.open.strike(id, rest, length, is_split);
                }
            }
        }
        let names = &mut self.snapshot.names;
        for symbol in chunk.defines() {
            if let (Some(signature), Some(defined)) = (names.signature(symbol), names.get(symbol)) {
                let name = defined.name();
                let text = Arc::clone(&defined.symbol.name);
                pass.before.insert(name, (symbol, signature));
                pass.pool.insert(text, symbol);
                names.withdraw(symbol);
            }
        }
        let withdrawn = Chunk {
            text: chunk.text.clone(),
            declared: chunk.declared.clone(),
            ..Chunk::default()
        };
        let chunks = &mut self.snapshot.chunks;
        chunks.set(id.0 as usize, Some(Arc::new(withdrawn)), None);
    }

    /// Reads a chunk with the names above it. All that it had declared and asked has been struck out.
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
        let above = Above::new(&self.names, &self.sequence, rank, pool);
        let mut recorder = Recorder::default();
        let (above, untold) = parse_piece(&chunk.text, is_first, above, &mut recorder);
        let (symbols, lookups) = above.finish();
        let mut untold = untold.into_iter().peekable();
        let findings = recorder.diagnostics.into_iter().enumerate();
        let findings = findings.map(|(number, diagnostic)| Finding {
            diagnostic,
            elsewhere: untold
                .next_if(|(told, _)| *told == number)
                .map(|(_, elsewhere)| elsewhere),
        });
        let findings = findings.collect();
        let text = &chunk.text;
        let tokens = Records::of_tokens(&recorder.tokens, text);
        let events = recorder.events.finish(text);
        let known_from: HashMap<SymbolId, u32> = recorder.declared.into_iter().collect();
        let chunk = self.chunk_mut(id);
        chunk.tokens = tokens;
        chunk.events = events;
        chunk.findings = findings;
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
                Lookup::Used(name) => names.enter_use(name, id),
                Lookup::Open {
                    start,
                    end,
                    length,
                    is_split,
                } => {
                    let rest = &chunk.text[start as usize..end as usize];
                    self.open.enter(id, rest, length, is_split);
                }
            }
        }
        self.snapshot.sequence.measure(id, chunk.measure());
        self.touch(self.snapshot.chunk(id), touched);
    }

    /// Reads the chunks whose text is new.
    pub(super) fn read_edited(&mut self, chunks: &[ChunkId], pass: &mut Pass) {
        let first = pass.above;
        for (rank, chunk) in (first..).zip(chunks) {
            self.read(*chunk, Some(rank), &mut pass.pool, &mut pass.touched);
            self.work.edited += 1;
            pass.read.push(*chunk);
        }
        self.compare(chunks, first + chunks.len() as u32, pass);
    }

    /// Reads the chunks below that notice what has changed.
    pub(super) fn read_below(&mut self, pass: &mut Pass) {
        while let Some((rank, chunk)) = pass.affected.pop_first() {
            self.withdraw(chunk, pass);
            self.read(chunk, Some(rank), &mut pass.pool, &mut pass.touched);
            self.work.reread += 1;
            pass.read.push(chunk);
            self.compare(&[chunk], rank + 1, pass);
        }
    }

    /// Compares what chunks declare with what they declared before, and marks whoever below notices; `rank`
    /// is that of the first chunk below.
    fn compare(&mut self, chunks: &[ChunkId], rank: u32, pass: &mut Pass) {
        let mut before = std::mem::take(&mut pass.before);
        let mut changed: Vec<(NameId, bool)> = Vec::new();
        for chunk in chunks {
            for symbol in self.chunk(*chunk).defines() {
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
            let open = self.open.of(self.names.text(name)).filter(|_| is_new);
            for chunk in users.chain(open.map(|(chunk, _)| chunk)) {
                let place = self.sequence.rank(chunk);
                if place >= rank {
                    pass.affected.insert(place, chunk);
                }
            }
            pass.touched.insert(name);
        }
    }
}

impl Snapshot {
    /// Notes the names whose letters a chunk splits.
    pub(super) fn touch(&self, chunk: &Chunk, touched: &mut BTreeSet<NameId>) {
        for lookup in &chunk.lookups {
            if let Lookup::Open {
                start,
                end,
                length,
                is_split: true,
            } = *lookup
            {
                let rest = &chunk.text[start as usize..end as usize];
                self.names.hiding(rest, length, |name| {
                    touched.insert(name);
                });
            }
        }
    }
}
