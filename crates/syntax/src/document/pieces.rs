//! Tokens and declarations by their number, in the order of the text.
//!
//! What flows in: a number, or an offset. What flows out: the chunk that it lies in, with all that was read of it,
//! in logarithmic time.

use crate::span::Span;
use crate::symbol::SymbolId;

use super::chunk::ReadDeclaration;
use super::record::{Events, Tokens};
use super::sequence::{ChunkId, Measure};
use super::snapshot::Snapshot;

/// A chunk in its place. What was read of it counts from its start.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'d> {
    /// Which chunk it is.
    pub chunk: ChunkId,
    /// Where it starts in the text.
    pub start: u32,
    /// How many tokens stand before it.
    pub first_token: u32,
    /// How many declarations stand before it.
    pub first_declaration: u32,
    /// Its text.
    pub text: &'d str,
    /// Its tokens, comments too.
    pub tokens: Tokens<'d>,
    /// What was read of it, in order.
    pub events: Events<'d>,
}

impl<'d> Piece<'d> {
    /// The declarations in order, each with what was read of it: its steps and intervals.
    pub fn declarations(
        &self,
    ) -> impl Iterator<Item = (ReadDeclaration<'d>, Events<'d>)> + use<'d> {
        self.events.declarations()
    }
}

impl Snapshot {
    /// How many tokens there are, comments too.
    pub fn token_count(&self) -> u32 {
        self.sequence.total().tokens
    }

    /// How many declarations there are.
    pub fn declaration_count(&self) -> u32 {
        self.sequence.total().declarations
    }

    /// The piece that holds the token of this number, from 0, and the token's number in it.
    pub fn piece_of_token(&self, token: u32) -> Option<(Piece<'_>, usize)> {
        if token >= self.token_count() {
            return None;
        }
        let piece = self.piece(self.sequence.at_token(token)?);
        Some((piece, (token - piece.first_token) as usize))
    }

    /// The piece that holds the declaration of this number, from 0, and the declaration's number in it.
    pub fn piece_of_declaration(&self, declaration: u32) -> Option<(Piece<'_>, usize)> {
        if declaration >= self.declaration_count() {
            return None;
        }
        let piece = self.piece(self.sequence.at_declaration(declaration)?);
        Some((piece, (declaration - piece.first_declaration) as usize))
    }

    /// The piece that holds the byte at an offset, or the last one.
    pub fn piece_at(&self, offset: u32) -> Option<Piece<'_>> {
        Some(self.piece(self.sequence.at_byte(offset)?))
    }

    /// A chunk in its place.
    pub fn piece_of(&self, chunk: ChunkId) -> Piece<'_> {
        self.piece((chunk, self.sequence.before(chunk)))
    }

    /// A piece and all below it.
    pub fn pieces_from<'d>(&'d self, first: Option<Piece<'d>>) -> impl Iterator<Item = Piece<'d>> {
        std::iter::successors(first, |piece| {
            let chunk = self.sequence.next(piece.chunk)?;
            let read = self.chunk(chunk);
            Some(Piece {
                chunk,
                start: piece.start + piece.text.len() as u32,
                first_token: piece.first_token + piece.tokens.len() as u32,
                first_declaration: piece.first_declaration + piece.declarations().count() as u32,
                text: &read.text,
                tokens: read.tokens(),
                events: read.events(),
            })
        })
    }

    /// How many tokens end at an offset or before it.
    pub fn tokens_ended(&self, offset: u32) -> u32 {
        self.tokens_that(offset, |token, offset| token.end <= offset)
    }

    /// How many tokens start before an offset.
    pub fn tokens_begun(&self, offset: u32) -> u32 {
        self.tokens_that(offset, |token, offset| token.start < offset)
    }

    /// How many tokens hold what holds of all before an offset and of none behind it.
    fn tokens_that(&self, offset: u32, holds: impl Fn(Span, u32) -> bool) -> u32 {
        self.piece_at(offset).map_or(0, |piece| {
            let inside = offset - piece.start;
            let tokens = piece.tokens;
            let count = tokens.partition_point(|span| holds(span, inside));
            piece.first_token + count as u32
        })
    }

    /// How many declarations start at an offset or before it.
    pub fn declarations_begun(&self, offset: u32) -> u32 {
        self.declarations_that(offset, |span, offset| span.start <= offset)
    }

    /// How many declarations end at an offset or before it.
    pub fn declarations_ended(&self, offset: u32) -> u32 {
        self.declarations_that(offset, |span, offset| span.end <= offset)
    }

    fn declarations_that(&self, offset: u32, holds: impl Fn(Span, u32) -> bool) -> u32 {
        self.piece_at(offset).map_or(0, |piece| {
            let inside = offset - piece.start;
            let begun = piece
                .declarations()
                .take_while(|(it, _)| holds(it.span, inside));
            piece.first_declaration + begun.count() as u32
        })
    }

    /// The number of the declaration of a symbol; none for a builtin.
    pub fn declaration_of(&self, symbol: SymbolId) -> Option<u32> {
        let piece = self.piece_of(self.home(symbol)?);
        let mut declarations = piece.declarations();
        let place = declarations.position(|(it, _)| it.symbol == Some(symbol))?;
        Some(piece.first_declaration + place as u32)
    }

    fn piece(&self, (chunk, before): (ChunkId, Measure)) -> Piece<'_> {
        let read = self.chunk(chunk);
        Piece {
            chunk,
            start: before.bytes,
            first_token: before.tokens,
            first_declaration: before.declarations,
            text: &read.text,
            tokens: read.tokens(),
            events: read.events(),
        }
    }
}
