//! The diagnostics of a document: those of its chunks, completed with parts that depend on other chunks, and the warnings
//! about shadowed splits, which compare a chunk with the chunks below it.

use std::ops::ControlFlow;

use super::Document;
use super::grammar::{Definition, Grammar, ShadowedSplit};
use super::lookups::Lookup;
use super::names::NameId;
use super::sequence::ChunkId;
use super::surroundings::Surroundings;
use crate::diagnostic::Diagnostic;
use crate::span::Span;
use crate::symbol::SymbolId;
use crate::text::{MAX_DIAGNOSTICS, too_many_diagnostics};

/// The first position above a name's declaration where its letters are read as several tokens.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct Split {
    chunk: ChunkId,
    /// The start of the first token in the chunk.
    start: u32,
    end: u32,
}

impl<G: Grammar> Document<G> {
    /// Returns all diagnostics, sorted by position: the same as reading the whole text at once.
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut all = Vec::new();
        if self.is_overfull() {
            self.each_limited(|_, diagnostic| all.push(diagnostic));
            Diagnostic::sort(&mut all);
            return all;
        }
        for chunk in self.diagnosed() {
            all.extend(self.diagnostics_of(chunk));
        }
        all
    }

    /// Returns the chunks with diagnostics, from top to bottom.
    pub fn diagnosed(&self) -> Vec<ChunkId> {
        let mut chunks = Vec::new();
        let mut next = 0;
        while next < self.sequence.total().diagnostics
            && let Some((chunk, before)) = self.sequence.at_diagnostic(next)
        {
            chunks.push((before.chunks, chunk));
            next = before.diagnostics + self.chunk(chunk).diagnostics.len() as u32;
        }
        for symbol in self.shadowed.keys() {
            let home = self.names.get(*symbol).and_then(|defined| defined.home);
            chunks.extend(home.map(|home| (self.sequence.rank(home), home)));
        }
        chunks.sort_unstable();
        chunks.dedup();
        chunks.into_iter().map(|(_, chunk)| chunk).collect()
    }

    /// Returns the diagnostics of one chunk, sorted by position, without the limit on the number of diagnostics of a
    /// text.
    pub fn diagnostics_of(&self, chunk: ChunkId) -> Vec<Diagnostic> {
        let mut all = self.diagnostics_of_reading(chunk);
        all.extend(self.shadowed_splits_of(chunk));
        Diagnostic::sort(&mut all);
        all
    }

    /// Returns the completed diagnostics of reading a chunk, in the order in which they were found.
    pub fn diagnostics_of_reading(&self, chunk: ChunkId) -> Vec<Diagnostic> {
        let read = self.chunk(chunk);
        if read.diagnostics.is_empty() {
            return Vec::new();
        }
        let surroundings = Surroundings::new(self, chunk);
        let before = surroundings.before();
        let mut searches = before.searches as usize;
        let diagnostics = read.diagnostics.iter().map(|read| {
            let mut diagnostic = read.diagnostic.clone().moved(before.bytes);
            if let Some(deferred) = &read.deferred {
                G::complete(deferred, &mut diagnostic, &surroundings, searches);
                searches += usize::from(G::searches(deferred));
            }
            diagnostic
        });
        diagnostics.collect()
    }

    /// Returns the warnings about names that a chunk declares and whose letters are read as several tokens above it.
    pub fn shadowed_splits_of(&self, chunk: ChunkId) -> Vec<Diagnostic> {
        if self.shadowed.is_empty() {
            return Vec::new();
        }
        let symbols = self.chunk(chunk).defined();
        symbols
            .filter_map(|symbol| self.shadowed_split(symbol))
            .collect()
    }

    /// Returns true if the text has more diagnostics than [`MAX_DIAGNOSTICS`].
    pub fn is_overfull(&self) -> bool {
        self.sequence.total().diagnostics as usize + self.shadowed.len() >= MAX_DIAGNOSTICS
    }

    /// Calls `give` with the first [`MAX_DIAGNOSTICS`] diagnostics, each with its chunk, in the order in which reading the
    /// whole text finds them; the last one reports that others are omitted.
    fn each_limited(&self, mut give: impl FnMut(ChunkId, Diagnostic)) {
        let mut count = 0;
        let mut offer = |chunk, diagnostic: Diagnostic| {
            count += 1;
            if count < MAX_DIAGNOSTICS {
                give(chunk, diagnostic);
                return ControlFlow::Continue(());
            }
            give(chunk, too_many_diagnostics(diagnostic.span));
            ControlFlow::Break(())
        };
        for chunk in self.sequence.from(self.sequence.first()) {
            for diagnostic in self.diagnostics_of_reading(chunk) {
                if offer(chunk, diagnostic).is_break() {
                    return;
                }
            }
        }
        let place = |split: &Split| self.sequence.before(split.chunk).bytes + split.start;
        let mut shadowed: Vec<_> = self.shadowed.iter().collect();
        shadowed.sort_by_key(|(symbol, split)| {
            let length = self.names.get(**symbol).map(|it| it.symbol.name().len());
            (place(split), length)
        });
        for (symbol, _) in shadowed {
            let home = self.names.get(*symbol).and_then(|defined| defined.home);
            if let (Some(home), Some(warning)) = (home, self.shadowed_split(*symbol))
                && offer(home, warning).is_break()
            {
                return;
            }
        }
    }

    fn shadowed_split(&self, id: SymbolId) -> Option<Diagnostic> {
        let split = self.shadowed.get(&id)?;
        let defined = self.names.get(id)?;
        let place = self.place(id)?;
        let before = self.sequence.before(split.chunk);
        let chunk = self.chunk(split.chunk);
        let token = &chunk.text[split.start as usize..split.end as usize];
        let line = before.lines + chunk.line_ends_before(split.start) + 1;
        let name = defined.symbol.name();
        let start = before.bytes + split.start;
        G::shadowed_split(ShadowedSplit {
            name,
            name_span: place,
            token_length: token.len(),
            place: Span::new(start, start + name.len() as u32),
            line,
        })
    }

    /// Recomputes the shadowed split of a name.
    pub(super) fn find_shadowed(&mut self, name: NameId) {
        let Some(id) = self.names.declared(name) else {
            return;
        };
        let found = self.first_split(id, name);
        match found {
            Some(split) => self.shadowed.insert(id, split),
            None => self.shadowed.remove(&id),
        };
    }

    fn first_split(&self, id: SymbolId, name: NameId) -> Option<Split> {
        let defined = self.names.get(id)?;
        let home = defined.home?;
        let declared_at = (self.sequence.rank(home), defined.symbol.name_span()?.start);
        let name = self.names.text(name);
        let splitting = self.unresolved.split_beginning_with(name);
        let ranked = splitting.map(|chunk| (self.sequence.rank(chunk), chunk));
        let (rank, chunk) = ranked.min()?;
        let read = self.chunk(chunk);
        let splits = read.lookups.iter().filter_map(|lookup| match *lookup {
            Lookup::Open {
                start,
                end,
                length,
                is_split: true,
            } if (length as usize) < name.len()
                && read.text[start as usize..end as usize].starts_with(name) =>
            {
                Some(Split {
                    chunk,
                    start,
                    end: start + length,
                })
            }
            _ => None,
        });
        splits
            .min_by_key(|split| split.start)
            .filter(|split| (rank, split.start) < declared_at)
    }
}
