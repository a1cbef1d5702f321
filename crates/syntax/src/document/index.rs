//! Tokens and declarations by number, in the order of the text.
//!
//! In: a number, or an offset. Out: the chunk that contains it, with its analysis, in logarithmic time.

use crate::span::Span;

use super::grammar::{Analysis, Grammar};
use super::sequence::{ChunkId, Measure};
use super::snapshot::Snapshot;

/// A chunk with its position in the text. The spans in its analysis are relative to its start.
#[derive(Debug)]
pub struct PlacedChunk<'d, G: Grammar> {
    /// The chunk.
    pub chunk: ChunkId,
    /// Its start in the text.
    pub start: u32,
    /// The number of tokens above it.
    pub first_token: u32,
    /// The number of declarations above it.
    pub first_declaration: u32,
    /// Its text.
    pub text: &'d str,
    /// The analysis of its text.
    pub analysis: &'d G::Analysis,
}

impl<G: Grammar> Clone for PlacedChunk<'_, G> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<G: Grammar> Copy for PlacedChunk<'_, G> {}

impl<'d, G: Grammar> PlacedChunk<'d, G> {
    fn declaration_spans(&self) -> impl Iterator<Item = Span> + use<'d, G> {
        self.analysis.declaration_spans(self.text)
    }

    /// Returns the number of tokens at its start for which `holds`, a predicate that is true up to some token and false after
    /// it.
    fn tokens_that(&self, holds: impl Fn(Span) -> bool) -> usize {
        let (mut low, mut high) = (0, self.analysis.token_count());
        while low < high {
            let middle = low.midpoint(high);
            match self.analysis.token_span(middle).is_some_and(&holds) {
                true => low = middle + 1,
                false => high = middle,
            }
        }
        low
    }
}

impl<G: Grammar> Snapshot<G> {
    /// Returns the number of tokens.
    pub fn token_count(&self) -> u32 {
        self.sequence.total().tokens
    }

    /// Returns the number of declarations.
    pub fn declaration_count(&self) -> u32 {
        self.sequence.total().declarations
    }

    /// Returns the chunk that contains the token with this number, from 0, and the token's number in it.
    pub fn placed_chunk_of_token(&self, token: u32) -> Option<(PlacedChunk<'_, G>, usize)> {
        if token >= self.token_count() {
            return None;
        }
        let placed = self.placed(self.sequence.at_token(token)?);
        Some((placed, (token - placed.first_token) as usize))
    }

    /// Returns the chunk that contains the declaration with this number, from 0, and the declaration's number in it.
    pub fn placed_chunk_of_declaration(
        &self,
        declaration: u32,
    ) -> Option<(PlacedChunk<'_, G>, usize)> {
        if declaration >= self.declaration_count() {
            return None;
        }
        let placed = self.placed(self.sequence.at_declaration(declaration)?);
        Some((placed, (declaration - placed.first_declaration) as usize))
    }

    /// Returns the chunk that contains the byte at an offset, or the last one.
    pub fn placed_chunk_at(&self, offset: u32) -> Option<PlacedChunk<'_, G>> {
        Some(self.placed(self.sequence.at_byte(offset)?))
    }

    /// Returns a chunk with its position.
    pub fn placed_chunk(&self, chunk: ChunkId) -> PlacedChunk<'_, G> {
        self.placed((chunk, self.sequence.before(chunk)))
    }

    /// Returns a chunk and all below it.
    pub fn placed_chunks_from<'d>(
        &'d self,
        first: Option<PlacedChunk<'d, G>>,
    ) -> impl Iterator<Item = PlacedChunk<'d, G>> {
        std::iter::successors(first, |placed| {
            let chunk = self.sequence.next(placed.chunk)?;
            let read = self.chunk(chunk);
            Some(PlacedChunk {
                chunk,
                start: placed.start + placed.text.len() as u32,
                first_token: placed.first_token + placed.analysis.token_count() as u32,
                first_declaration: placed.first_declaration
                    + placed.declaration_spans().count() as u32,
                text: &read.text,
                analysis: &read.analysis,
            })
        })
    }

    /// Returns the number of tokens that end at or before an offset.
    pub fn tokens_ended(&self, offset: u32) -> u32 {
        self.tokens_that(offset, |token, offset| token.end <= offset)
    }

    /// Returns the number of tokens that start before an offset.
    pub fn tokens_begun(&self, offset: u32) -> u32 {
        self.tokens_that(offset, |token, offset| token.start < offset)
    }

    /// Returns the number of tokens for which `holds`, a predicate that is true up to some token and false after it.
    fn tokens_that(&self, offset: u32, holds: impl Fn(Span, u32) -> bool) -> u32 {
        self.placed_chunk_at(offset).map_or(0, |placed| {
            let inside = offset - placed.start;
            placed.first_token + placed.tokens_that(|span| holds(span, inside)) as u32
        })
    }

    /// Returns the number of declarations that start at or before an offset.
    pub fn declarations_begun(&self, offset: u32) -> u32 {
        self.declarations_that(offset, |span, offset| span.start <= offset)
    }

    /// Returns the number of declarations that end at or before an offset.
    pub fn declarations_ended(&self, offset: u32) -> u32 {
        self.declarations_that(offset, |span, offset| span.end <= offset)
    }

    fn declarations_that(&self, offset: u32, holds: impl Fn(Span, u32) -> bool) -> u32 {
        self.placed_chunk_at(offset).map_or(0, |placed| {
            let inside = offset - placed.start;
            let spans = placed.declaration_spans();
            let count = spans.take_while(|span| holds(*span, inside)).count();
            placed.first_declaration + count as u32
        })
    }

    fn placed(&self, (chunk, before): (ChunkId, Measure)) -> PlacedChunk<'_, G> {
        let read = self.chunk(chunk);
        PlacedChunk {
            chunk,
            start: before.bytes,
            first_token: before.tokens,
            first_declaration: before.declarations,
            text: &read.text,
            analysis: &read.analysis,
        }
    }
}
