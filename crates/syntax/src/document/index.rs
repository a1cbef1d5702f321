//! Tokens and declarations by their number, in the order of the text.
//!
//! What flows in: a number, or an offset. What flows out: the chunk that holds it, with what reading it has given, in
//! logarithmic time.

use crate::span::Span;

use super::grammar::{Analysis, Grammar};
use super::sequence::{ChunkId, Measure};
use super::snapshot::Snapshot;

/// A chunk at its place in the text. The places in its analysis count from its start.
#[derive(Debug)]
pub struct Piece<'d, G: Grammar> {
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
    /// What reading it has given.
    pub analysis: &'d G::Analysis,
}

impl<G: Grammar> Clone for Piece<'_, G> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<G: Grammar> Copy for Piece<'_, G> {}

impl<'d, G: Grammar> Piece<'d, G> {
    fn declaration_spans(&self) -> impl Iterator<Item = Span> + use<'d, G> {
        self.analysis.declaration_spans(self.text)
    }

    /// The number of tokens at its start for which `holds`, a predicate that is true up to some token and false behind it.
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
    /// The number of tokens.
    pub fn token_count(&self) -> u32 {
        self.sequence.total().tokens
    }

    /// The number of declarations.
    pub fn declaration_count(&self) -> u32 {
        self.sequence.total().declarations
    }

    /// The piece that holds the token of this number, from 0, and the token's number in it.
    pub fn piece_of_token(&self, token: u32) -> Option<(Piece<'_, G>, usize)> {
        if token >= self.token_count() {
            return None;
        }
        let piece = self.piece(self.sequence.at_token(token)?);
        Some((piece, (token - piece.first_token) as usize))
    }

    /// The piece that holds the declaration of this number, from 0, and the declaration's number in it.
    pub fn piece_of_declaration(&self, declaration: u32) -> Option<(Piece<'_, G>, usize)> {
        if declaration >= self.declaration_count() {
            return None;
        }
        let piece = self.piece(self.sequence.at_declaration(declaration)?);
        Some((piece, (declaration - piece.first_declaration) as usize))
    }

    /// The piece that holds the byte at an offset, or the last one.
    pub fn piece_at(&self, offset: u32) -> Option<Piece<'_, G>> {
        Some(self.piece(self.sequence.at_byte(offset)?))
    }

    /// A chunk in its place.
    pub fn piece_of(&self, chunk: ChunkId) -> Piece<'_, G> {
        self.piece((chunk, self.sequence.before(chunk)))
    }

    /// A piece and all below it.
    pub fn pieces_from<'d>(
        &'d self,
        first: Option<Piece<'d, G>>,
    ) -> impl Iterator<Item = Piece<'d, G>> {
        std::iter::successors(first, |piece| {
            let chunk = self.sequence.next(piece.chunk)?;
            let read = self.chunk(chunk);
            Some(Piece {
                chunk,
                start: piece.start + piece.text.len() as u32,
                first_token: piece.first_token + piece.analysis.token_count() as u32,
                first_declaration: piece.first_declaration
                    + piece.declaration_spans().count() as u32,
                text: &read.text,
                analysis: &read.analysis,
            })
        })
    }

    /// The number of tokens that end at an offset or before it.
    pub fn tokens_ended(&self, offset: u32) -> u32 {
        self.tokens_that(offset, |token, offset| token.end <= offset)
    }

    /// The number of tokens that start before an offset.
    pub fn tokens_begun(&self, offset: u32) -> u32 {
        self.tokens_that(offset, |token, offset| token.start < offset)
    }

    /// The number of tokens for which `holds`, a predicate that is true up to some token and false behind it.
    fn tokens_that(&self, offset: u32, holds: impl Fn(Span, u32) -> bool) -> u32 {
        self.piece_at(offset).map_or(0, |piece| {
            let inside = offset - piece.start;
            piece.first_token + piece.tokens_that(|span| holds(span, inside)) as u32
        })
    }

    /// The number of declarations that start at an offset or before it.
    pub fn declarations_begun(&self, offset: u32) -> u32 {
        self.declarations_that(offset, |span, offset| span.start <= offset)
    }

    /// The number of declarations that end at an offset or before it.
    pub fn declarations_ended(&self, offset: u32) -> u32 {
        self.declarations_that(offset, |span, offset| span.end <= offset)
    }

    fn declarations_that(&self, offset: u32, holds: impl Fn(Span, u32) -> bool) -> u32 {
        self.piece_at(offset).map_or(0, |piece| {
            let inside = offset - piece.start;
            let spans = piece.declaration_spans();
            let count = spans.take_while(|span| holds(*span, inside)).count();
            piece.first_declaration + count as u32
        })
    }

    fn piece(&self, (chunk, before): (ChunkId, Measure)) -> Piece<'_, G> {
        let read = self.chunk(chunk);
        Piece {
            chunk,
            start: before.bytes,
            first_token: before.tokens,
            first_declaration: before.declarations,
            text: &read.text,
            analysis: &read.analysis,
        }
    }
}
