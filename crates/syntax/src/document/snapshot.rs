//! A text and the results of reading it, at one version.
//!
//! A snapshot shares its parts with its document; the document copies a part before an edit changes it. A snapshot costs a
//! few reference counts and never changes.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::diagnostic::{Code, Severity};
use crate::line_index::Position;
use crate::persistent_vector::PersistentVector;
use crate::span::Span;
use crate::symbol::SymbolId;

use super::chunk::Chunk;
use super::grammar::{Definition, Grammar};
use super::names::Names;
use super::sequence::{ChunkId, Sequence};

/// A text and the results of reading it.
#[derive(Clone, Debug)]
pub struct Snapshot<G: Grammar> {
    pub(super) sequence: Sequence,
    pub(super) chunks: PersistentVector<Option<Arc<Chunk<G>>>>,
    pub(super) names: Names<G>,
}

impl<G: Grammar> Snapshot<G> {
    /// Returns the length of the text in bytes.
    pub fn len(&self) -> u32 {
        self.sequence.total().bytes
    }

    /// Returns true if the text is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the whole text.
    pub fn text(&self) -> String {
        self.slice(Span::new(0, self.len())).unwrap_or_default()
    }

    /// Returns the text of a range; `None` if the text does not have the range or an end is inside a character.
    pub fn slice(&self, range: Span) -> Option<String> {
        if range.end > self.len() || range.start > range.end {
            return None;
        }
        let mut text = String::with_capacity((range.end - range.start) as usize);
        for (chunk, start) in self.chunks_in(range) {
            let piece = &self.chunk(chunk).text;
            let from = range.start.saturating_sub(start) as usize;
            let to = ((range.end - start) as usize).min(piece.len());
            text.push_str(piece.get(from..to)?);
        }
        Some(text)
    }

    /// Returns the number of lines, at least 1.
    pub fn line_count(&self) -> u32 {
        self.sequence.total().lines + 1
    }

    /// Returns the line and column of the character that starts at `offset`; an offset past the end counts as the end.
    pub fn position(&self, offset: u32) -> Position {
        let offset = offset.min(self.len());
        let line = self.line(offset);
        let start = self.line_start(line).unwrap_or_default();
        let column = self.characters_before(offset) - self.characters_before(start);
        Position {
            line,
            column: column + 1,
        }
    }

    /// Returns the line, from 1, of an offset.
    pub fn line(&self, offset: u32) -> u32 {
        let Some((chunk, before)) = self.sequence.at_byte(offset) else {
            return 1;
        };
        before.lines + self.chunk(chunk).line_ends_before(offset - before.bytes) + 1
    }

    /// Returns the offset at which a line, from 1, starts; `None` if the text has fewer lines.
    pub fn line_start(&self, line: u32) -> Option<u32> {
        let ends = line.checked_sub(1)?;
        if ends == 0 {
            return Some(0);
        }
        if ends > self.sequence.total().lines {
            return None;
        }
        let (chunk, before) = self.sequence.at_line_end(ends)?;
        let end = self.chunk(chunk).line_end(ends - before.lines - 1)?;
        Some(before.bytes + end + 1)
    }

    /// Returns the offset of the character at a position. A column past the line's end is the line's end. Returns `None` if
    /// the text has fewer lines, or for a line or column 0.
    pub fn offset(&self, position: Position) -> Option<u32> {
        let start = self.line_start(position.line)?;
        let end = match self.line_start(position.line + 1) {
            Some(next) => {
                let end = next - 1;
                let is_return = end > start && self.byte(end - 1) == Some(b'\r');
                end - u32::from(is_return)
            }
            None => self.len(),
        };
        let wanted = self.characters_before(start) + position.column.checked_sub(1)?;
        if wanted >= self.characters_before(end) {
            return Some(end);
        }
        let (chunk, before) = self.sequence.at_character(wanted)?;
        let at = self.chunk(chunk).character(wanted - before.characters)?;
        Some(before.bytes + at)
    }

    /// Returns all chunks, from top to bottom.
    pub fn chunks(&self) -> impl Iterator<Item = ChunkId> + '_ {
        self.sequence.from(self.sequence.first())
    }

    /// Returns the chunks that a range touches, each with the offset of its start.
    pub fn chunks_in(&self, range: Span) -> impl Iterator<Item = (ChunkId, u32)> + '_ {
        let first = self.sequence.at_byte(range.start);
        let mut start = first.map_or(0, |(_, before)| before.bytes);
        self.sequence
            .from(first.map(|(chunk, _)| chunk))
            .map(move |chunk| {
                let at = start;
                start += self.chunk(chunk).text.len() as u32;
                (chunk, at)
            })
            .take_while(move |(_, start)| *start < range.end || *start <= range.start)
    }

    /// Returns the offset at which a chunk starts.
    pub fn start(&self, chunk: ChunkId) -> u32 {
        self.sequence.before(chunk).bytes
    }

    /// Returns the number of chunks above a chunk.
    pub fn rank(&self, chunk: ChunkId) -> u32 {
        self.sequence.rank(chunk)
    }

    /// Returns the text of a chunk.
    pub fn chunk_text(&self, chunk: ChunkId) -> &str {
        &self.chunk(chunk).text
    }

    /// Returns the version of the document at which a chunk was read.
    pub fn chunk_version(&self, chunk: ChunkId) -> u64 {
        self.chunk(chunk).version
    }

    /// Returns the errors of a chunk in the order in which they were found. Their spans are relative to the chunk's
    /// start.
    pub fn errors(&self, chunk: ChunkId) -> impl Iterator<Item = (Code, Span)> + '_ {
        let diagnostics = self.chunk(chunk).diagnostics.iter();
        let errors = diagnostics.filter(|it| it.diagnostic.severity == Severity::Error);
        errors.map(|it| (it.diagnostic.code, it.diagnostic.span))
    }

    /// Returns a builtin, or a symbol that the text defines. Its spans are relative to the start of its chunk.
    pub fn symbol(&self, id: SymbolId) -> Option<&G::Symbol> {
        Some(&self.names.get(id)?.symbol)
    }

    /// Returns the chunk that defines a symbol; `None` for a builtin.
    pub fn home(&self, id: SymbolId) -> Option<ChunkId> {
        self.names.get(id)?.home
    }

    /// Returns the symbol that a name denotes at the end of the text.
    pub fn named(&self, name: &str) -> Option<SymbolId> {
        self.names.named(name)
    }

    /// Visits the symbols of the names that begin with `prefix` at the end of the text, in alphabetical order, until
    /// `visit` breaks.
    pub fn each_named(
        &self,
        prefix: &str,
        mut visit: impl FnMut(SymbolId, &G::Symbol) -> ControlFlow<()>,
    ) {
        self.names
            .each_named(prefix, |id, defined| visit(id, &defined.symbol));
    }

    /// Returns the start of the run of letters and digits that ends at an offset, which is the offset itself if the run
    /// is empty.
    pub fn word_start(&self, offset: u32) -> u32 {
        // A chunk never ends inside a word.
        let before = offset
            .checked_sub(1)
            .and_then(|last| self.placed_chunk_at(last));
        before.map_or(offset, |piece| {
            let inside = ((offset - piece.start) as usize).min(piece.text.len());
            let letters = piece.text.as_bytes()[..inside].iter().rev();
            let length = letters
                .take_while(|byte| byte.is_ascii_alphanumeric())
                .count();
            offset - length as u32
        })
    }

    /// Returns the span of the name in a symbol's declaration; `None` for a builtin.
    pub fn place(&self, id: SymbolId) -> Option<Span> {
        let defined = self.names.get(id)?;
        let start = self.start(defined.home?);
        Some(defined.symbol.name_span()?.moved(start))
    }

    /// Returns all symbols: first the builtins in order, then the others in no particular order.
    pub fn symbols(&self) -> impl Iterator<Item = (SymbolId, &G::Symbol)> {
        self.names.iter().map(|(id, defined)| (id, &defined.symbol))
    }

    /// Returns the chunks that use a symbol, in no particular order. The defining chunk may be among them.
    pub fn readers(&self, id: SymbolId) -> impl Iterator<Item = ChunkId> + '_ {
        let name = self.names.name_of(id);
        name.into_iter().flat_map(|name| self.names.users(name))
    }

    /// Returns the analysis of a chunk. Its spans are relative to the chunk's start.
    pub fn analysis(&self, chunk: ChunkId) -> &G::Analysis {
        &self.chunk(chunk).analysis
    }

    pub(super) fn chunk(&self, chunk: ChunkId) -> &Chunk<G> {
        self.chunks[chunk.0 as usize]
            .as_deref()
            .expect("a chunk of this document")
    }

    pub(super) fn byte(&self, offset: u32) -> Option<u8> {
        let (chunk, before) = self.sequence.at_byte(offset)?;
        let text = self.chunk(chunk).text.as_bytes();
        text.get((offset - before.bytes) as usize).copied()
    }

    pub(super) fn is_boundary(&self, offset: u32) -> bool {
        self.sequence
            .at_byte(offset)
            .is_some_and(|(chunk, before)| {
                let text = &self.chunk(chunk).text;
                text.is_char_boundary((offset - before.bytes) as usize)
            })
    }

    fn characters_before(&self, offset: u32) -> u32 {
        let Some((chunk, before)) = self.sequence.at_byte(offset) else {
            return 0;
        };
        before.characters + self.chunk(chunk).characters_before(offset - before.bytes)
    }
}
