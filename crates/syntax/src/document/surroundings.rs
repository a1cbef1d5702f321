//! The text around a chunk, for diagnostics that refer to it.

use crate::span::Span;
use crate::spelling::Search;
use crate::symbol::SymbolId;
use crate::trie::Trie;

use super::Document;
use super::grammar::Grammar;
use super::sequence::{ChunkId, Measure};

/// A document as seen from one of its chunks.
#[derive(Debug)]
pub struct Surroundings<'d, G: Grammar> {
    document: &'d Document<G>,
    chunk: ChunkId,
    before: Measure,
}

impl<'d, G: Grammar> Surroundings<'d, G> {
    pub(super) fn new(document: &'d Document<G>, chunk: ChunkId) -> Self {
        Self {
            document,
            chunk,
            before: document.sequence.before(chunk),
        }
    }

    /// Returns the sum over the chunks above.
    pub(super) fn before(&self) -> Measure {
        self.before
    }

    /// Returns the line, from 1, of an offset of the chunk.
    pub fn line(&self, offset: u32) -> u32 {
        let chunk = self.document.chunk(self.chunk);
        self.before.lines + chunk.line_ends_before(offset) + 1
    }

    /// Returns a symbol that the text declares, the span of its name in the text, and the line of that span; `None` for a
    /// builtin.
    pub fn declaration(&self, symbol: SymbolId) -> Option<(&'d G::Symbol, Span, u32)> {
        let span = self.document.place(symbol)?;
        let symbol = &self.document.names.get(symbol)?.symbol;
        Some((symbol, span, self.document.line(span.start)))
    }

    /// Returns the last position where the text seems to declare a name, and its line, if it is after an offset of the
    /// chunk.
    pub fn declared_below(&self, name: &str, offset: u32) -> Option<(Span, u32)> {
        let document = self.document;
        let ranked = document
            .names
            .declaring(name)
            .map(|chunk| (document.sequence.before(chunk), chunk));
        let (before, chunk) = ranked.max_by_key(|(before, _)| before.chunks)?;
        let read = document.chunk(chunk);
        let (_, last) = read.declared().find(|(declared, _)| *declared == name)?;
        let start = before.bytes + last;
        if start <= self.before.bytes + offset {
            return None;
        }
        let line = before.lines + read.line_ends_before(last) + 1;
        Some((Span::new(start, start + name.len() as u32), line))
    }

    /// Returns the name most similar in spelling to `word`, among `parameters` and the names that are known at an offset of
    /// the chunk.
    pub fn nearest(
        &self,
        parameters: Option<&Trie<u32>>,
        word: &str,
        offset: u32,
    ) -> Option<String> {
        let (names, sequence) = (&self.document.names, &self.document.sequence);
        Search::nearest(word, |search| {
            if let Some(parameters) = parameters {
                search.among(parameters, |_| true);
            }
            names.search(search, sequence, self.chunk, offset);
        })
    }
}
