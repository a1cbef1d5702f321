//! One piece of a document: a text, and what reading it has given.
//!
//! All places in a chunk count from its own start, so that an edit above it changes nothing of it.

use crate::diagnostic::Diagnostic;
use crate::symbol::SymbolId;

use super::grammar::{Analysis, Grammar};
use super::lookups::Lookup;
use super::sequence::Measure;

/// A diagnostic of a chunk, and the part of it that depends on other places of the text.
#[derive(Clone, Debug)]
pub(super) struct Finding<G: Grammar> {
    pub(super) diagnostic: Diagnostic,
    /// Boxed, since few have it: a text of a million mistakes has a million findings.
    pub(super) deferred: Option<Box<G::Deferred>>,
}

/// The place of a name that the text seems to declare: its last place in the chunk.
#[derive(Clone, Copy, Debug)]
pub(super) struct Declared {
    pub(super) start: u32,
    pub(super) end: u32,
}

/// A piece of the text and what reading it has given.
#[derive(Clone, Debug)]
pub(super) struct Chunk<G: Grammar> {
    pub(super) text: Box<str>,
    pub(super) analysis: G::Analysis,
    pub(super) findings: Box<[Finding<G>]>,
    /// The look-ups that reading it has made in the names above.
    pub(super) lookups: Box<[Lookup]>,
    pub(super) declared: Box<[Declared]>,
    /// The version of the document at which it was read.
    pub(super) version: u64,
}

impl<G: Grammar> Chunk<G> {
    /// A chunk that has not been read yet.
    pub(super) fn unread(text: &str, version: u64) -> Self {
        let mut chunk = Self {
            text: text.into(),
            analysis: G::Analysis::default(),
            findings: Box::default(),
            lookups: Box::default(),
            declared: Box::default(),
            version,
        };
        chunk.find_declared();
        chunk
    }

    /// Returns the chunk without what reading it has given.
    pub(super) fn without_reading(&self) -> Self {
        Self {
            text: self.text.clone(),
            analysis: G::Analysis::default(),
            findings: Box::default(),
            lookups: Box::default(),
            declared: self.declared.clone(),
            version: 0,
        }
    }

    pub(super) fn measure(&self) -> Measure {
        let deferred = self.findings.iter().filter_map(|it| it.deferred.as_ref());
        let searches = deferred.filter(|deferred| G::searches(deferred));
        let declarations = self.analysis.declaration_spans(&self.text);
        Measure {
            chunks: 1,
            bytes: self.text.len() as u32,
            lines: count_lines(&self.text),
            characters: self.text.chars().count() as u32,
            findings: self.findings.len() as u32,
            searches: searches.count() as u32,
            tokens: self.analysis.token_count() as u32,
            declarations: declarations.count() as u32,
        }
    }

    /// The symbols that it defines, in the order of the text.
    pub(super) fn defined(&self) -> impl Iterator<Item = SymbolId> {
        self.analysis.defined(&self.text)
    }

    /// The names that its text seems to declare, each with its last place.
    pub(super) fn declared(&self) -> impl Iterator<Item = (&str, u32)> {
        let declared = self.declared.iter();
        declared.map(|it| (&self.text[it.start as usize..it.end as usize], it.start))
    }

    /// Finds the names that its text seems to declare.
    pub(super) fn find_declared(&mut self) {
        let mut declared: Vec<(&str, u32)> = Vec::new();
        G::each_declared(&self.text, |name, start| declared.push((name, start)));
        // Keeps the last place of each name.
        declared.sort_by(|(a, at), (b, other)| (a, other).cmp(&(b, at)));
        declared.dedup_by_key(|(name, _)| *name);
        let places = declared.into_iter().map(|(name, start)| Declared {
            start,
            end: start + name.len() as u32,
        });
        self.declared = places.collect();
    }
}

pub(super) fn count_lines(text: &str) -> u32 {
    text.bytes().filter(|byte| *byte == b'\n').count() as u32
}
