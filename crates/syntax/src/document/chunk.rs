//! A piece of a document: a text, and the results of reading it.
//!
//! All offsets in a chunk are relative to its start, so that an edit above it does not change it.

use crate::checkpoints::Checkpoints;
use crate::diagnostic::Diagnostic;
use crate::symbol::SymbolId;

use super::grammar::{Analysis, Grammar};
use super::lookups::Lookup;
use super::sequence::Measure;

/// A diagnostic of a chunk, and the part of it that depends on other parts of the text.
#[derive(Clone, Debug)]
pub(super) struct ChunkDiagnostic<G: Grammar> {
    pub(super) diagnostic: Diagnostic,
    /// Boxed because few diagnostics have it: a text with a million mistakes has a million diagnostics.
    pub(super) deferred: Option<Box<G::Deferred>>,
}

/// The last position in the chunk of a name that the text seems to declare.
#[derive(Clone, Copy, Debug)]
pub(super) struct Declared {
    pub(super) start: u32,
    pub(super) end: u32,
}

/// A piece of the text and the results of reading it.
#[derive(Clone, Debug)]
pub(super) struct Chunk<G: Grammar> {
    pub(super) text: Box<str>,
    checkpoints: Checkpoints,
    pub(super) analysis: G::Analysis,
    pub(super) diagnostics: Box<[ChunkDiagnostic<G>]>,
    /// The look-ups in the names above that reading it made.
    pub(super) lookups: Box<[Lookup]>,
    pub(super) declared: Box<[Declared]>,
    /// The version of the document at which it was read.
    pub(super) version: u64,
}

impl<G: Grammar> Chunk<G> {
    /// Creates a chunk that has not been read.
    pub(super) fn unread(text: &str, version: u64) -> Self {
        let mut chunk = Self {
            text: Box::default(),
            checkpoints: Checkpoints::default(),
            analysis: G::Analysis::default(),
            diagnostics: Box::default(),
            lookups: Box::default(),
            declared: Box::default(),
            version,
        };
        chunk.set_text(text);
        chunk
    }

    /// Returns the chunk without the results of reading it.
    pub(super) fn without_reading(&self) -> Self {
        Self {
            text: self.text.clone(),
            checkpoints: self.checkpoints.clone(),
            analysis: G::Analysis::default(),
            diagnostics: Box::default(),
            lookups: Box::default(),
            declared: self.declared.clone(),
            version: 0,
        }
    }

    pub(super) fn measure(&self) -> Measure {
        let deferred = self
            .diagnostics
            .iter()
            .filter_map(|it| it.deferred.as_ref());
        let searches = deferred.filter(|deferred| G::searches(deferred));
        let declarations = self.analysis.declaration_spans(&self.text);
        Measure {
            chunks: 1,
            bytes: self.text.len() as u32,
            lines: self.line_ends_before(self.text.len() as u32),
            characters: self.characters_before(self.text.len() as u32),
            diagnostics: self.diagnostics.len() as u32,
            searches: searches.count() as u32,
            tokens: self.analysis.token_count() as u32,
            declarations: declarations.count() as u32,
        }
    }

    /// Returns the symbols that it defines, in the order of the text.
    pub(super) fn defined(&self) -> impl Iterator<Item = SymbolId> {
        self.analysis.defined(&self.text)
    }

    /// Returns the names that its text seems to declare, each with its last position.
    pub(super) fn declared(&self) -> impl Iterator<Item = (&str, u32)> {
        let declared = self.declared.iter();
        declared.map(|it| (&self.text[it.start as usize..it.end as usize], it.start))
    }

    /// Returns the number of line ends before an offset.
    pub(super) fn line_ends_before(&self, offset: u32) -> u32 {
        self.checkpoints.line_ends_before(&self.text, offset)
    }

    /// Returns the offset of the line end with this number, from 0.
    pub(super) fn line_end(&self, number: u32) -> Option<u32> {
        self.checkpoints.line_end(&self.text, number)
    }

    /// Returns the number of characters that start before an offset.
    pub(super) fn characters_before(&self, offset: u32) -> u32 {
        self.checkpoints.characters_before(&self.text, offset)
    }

    /// Returns the offset of the character with this number, from 0.
    pub(super) fn character(&self, number: u32) -> Option<u32> {
        self.checkpoints.character(&self.text, number)
    }

    /// Sets the text, and finds the names that it seems to declare. The results of reading remain unchanged.
    pub(super) fn set_text(&mut self, text: &str) {
        self.text = text.into();
        self.checkpoints = Checkpoints::new(text);
        let mut declared: Vec<(&str, u32)> = Vec::new();
        G::each_declared(&self.text, |name, start| declared.push((name, start)));
        // Keep the last position of each name.
        declared.sort_by(|(a, at), (b, other)| (a, other).cmp(&(b, at)));
        declared.dedup_by_key(|(name, _)| *name);
        let places = declared.into_iter().map(|(name, start)| Declared {
            start,
            end: start + name.len() as u32,
        });
        self.declared = places.collect();
    }
}
