//! A text that is edited: it is read chunk by chunk, and only chunks that an edit affects are read again.
//!
//! ```text
//! edit ──▶ edit.rs          the chunks that are cut again, and the chunks that are read again
//!          grammar.rs       the interface of a language
//!          chunk.rs         a piece of the text, with the results of reading it
//!          sequence.rs      the chunks in order, with sums: offsets and lines in logarithmic time
//!          names.rs         the meaning of a word at a position; the chunks that use a name
//!          lookups.rs       the chunks that a new name would change
//!          scope.rs         the names as a grammar sees them while it reads a chunk
//!          diagnostics.rs   diagnostics, completed with lines and names of other locations on request
//!          surroundings.rs  the text around a chunk, to complete diagnostics
//! query ─▶ snapshot.rs, index.rs   the text, its tokens, symbols and lines, at one version
//!          chunk_set.rs     sets of chunks that snapshots share with the document
//! ```
//!
//! The language, a [`Grammar`], cuts the text into chunks without knowing the meaning of any name. An edit recuts only the
//! chunks that it touches. These are read again, and so are the chunks below that use a name whose meaning has changed, or
//! contain a word that a new name changes: reading a chunk records each name and word that it looks up. Reading a chunk may
//! change further names; chunks are read from top to bottom, each at most once. After every edit the document equals a
//! document made from the whole text.
//!
//! All offsets in a chunk are relative to its start, and a symbol keeps its handle as long as its declaration exists, so
//! that edits above and below leave a chunk unchanged.

mod chunk;
mod chunk_set;
mod diagnostics;
mod edit;
mod grammar;
mod index;
mod lookups;
mod names;
mod scope;
mod sequence;
mod snapshot;
mod surroundings;

use std::collections::{BTreeSet, HashMap};
use std::ops::Deref;

use crate::persistent_vector::PersistentVector;
use crate::span::Span;
use crate::symbol::SymbolId;

use diagnostics::Split;
use edit::Pass;
use lookups::{Lookup, UnresolvedWords};
use names::Names;
use sequence::Sequence;

pub use grammar::{Analysis, Definition, Grammar, Reading, ShadowedSplit};
pub use index::PlacedChunk;
pub use scope::ScopeView;
pub use sequence::ChunkId;
pub use snapshot::Snapshot;
pub use surroundings::Surroundings;

/// A text and the results of reading it: its present [`Snapshot`], and the indexes that edits require.
#[derive(Clone, Debug)]
pub struct Document<G: Grammar> {
    snapshot: Snapshot<G>,
    free: Vec<ChunkId>,
    unresolved: UnresolvedWords,
    /// The symbols whose names are read as several tokens above their declarations.
    shadowed: HashMap<SymbolId, Split>,
    version: u64,
    counters: ReadCounters,
}

impl<G: Grammar> Deref for Document<G> {
    type Target = Snapshot<G>;

    fn deref(&self) -> &Snapshot<G> {
        &self.snapshot
    }
}

/// The effect of an edit.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Change {
    /// The document's version after the edit.
    pub version: u64,
    /// The chunks that the edit has removed. A later edit may reuse their handles for new chunks.
    pub removed: Vec<ChunkId>,
    /// The chunks that were read, including new ones, from top to bottom.
    pub read: Vec<ChunkId>,
    /// The symbols that are no longer defined. A later edit may reuse their handles for new symbols.
    pub forgotten: Vec<SymbolId>,
}

/// Counters of the work of a document since it was created.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct ReadCounters {
    /// The number of bytes searched for the ends of chunks.
    pub cut: u64,
    /// The number of chunks read because their text was new.
    pub edited: u64,
    /// The number of chunks read again because of the names above them.
    pub reread: u64,
}

/// The reason why an edit is refused. The document is then unchanged.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum EditError {
    /// The range ends after the text's end, or before its own start.
    OutOfRange,
    /// An end of the range is inside a character.
    InsideCharacter,
    /// The text would have 4 GiB or more.
    TooLarge,
}

impl std::fmt::Display for EditError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::OutOfRange => "the edit's range is not one of the text",
            Self::InsideCharacter => "the edit's range ends inside a character",
            Self::TooLarge => "the text would be too large: the limit is 4 GiB",
        })
    }
}

impl std::error::Error for EditError {}

impl<G: Grammar> Document<G> {
    /// Reads a text.
    ///
    /// # Errors
    /// [`EditError::TooLarge`].
    pub fn new(text: &str, builtins: &G::Builtins) -> Result<Self, EditError> {
        let mut document = Self::unindexed(Snapshot {
            sequence: Sequence::default(),
            chunks: PersistentVector::default(),
            names: Names::new(G::builtins(builtins)),
        });
        check_size(text.len())?;
        let mut ends = Vec::new();
        let state = G::cut(text, 0, G::CutState::default(), &mut ends);
        G::cut_last(text, state, &mut ends);
        document.counters.cut += text.len() as u64;
        ends.push(text.len());
        let mut start = 0;
        let mut last = None;
        let mut pool = HashMap::new();
        let mut touched = BTreeSet::new();
        for end in ends {
            let chunk = document.allocate(&text[start..end]);
            let measure = document.chunk(chunk).measure();
            let sequence = &mut document.snapshot.sequence;
            sequence.insert(last, chunk, measure);
            document.read(chunk, None, &mut pool, &mut touched);
            document.counters.edited += 1;
            (start, last) = (end, Some(chunk));
        }
        for name in touched {
            document.find_shadowed(name);
        }
        Ok(document)
    }

    /// Creates a document from a snapshot, without the indexes that a snapshot lacks.
    fn unindexed(snapshot: Snapshot<G>) -> Self {
        Self {
            snapshot,
            free: Vec::new(),
            unresolved: UnresolvedWords::default(),
            shadowed: HashMap::new(),
            version: 0,
            counters: ReadCounters::default(),
        }
    }

    /// Creates a document that continues from a snapshot of another, to try out edits. Nothing is read.
    pub fn from_snapshot(snapshot: Snapshot<G>) -> Self {
        let mut document = Self::unindexed(snapshot);
        let Self {
            snapshot,
            free,
            unresolved,
            ..
        } = &mut document;
        let mut touched = BTreeSet::new();
        for (id, chunk) in (0..).map(ChunkId).zip(snapshot.chunks.iter()) {
            let Some(chunk) = chunk else {
                free.push(id);
                continue;
            };
            for lookup in &chunk.lookups {
                if let Lookup::Open {
                    start,
                    end,
                    length,
                    is_split,
                } = *lookup
                {
                    let rest = &chunk.text[start as usize..end as usize];
                    unresolved.insert(id, rest, length, is_split);
                }
            }
            snapshot.touch(chunk, &mut touched);
        }
        for name in touched {
            document.find_shadowed(name);
        }
        document
    }

    /// Replaces the bytes of a range.
    ///
    /// # Errors
    /// If the text does not have the range, or would be too large. The document is then unchanged.
    pub fn edit(&mut self, range: Span, text: &str) -> Result<Change, EditError> {
        let length = self.len();
        if range.start > range.end || range.end > length {
            return Err(EditError::OutOfRange);
        }
        check_size((length - (range.end - range.start)) as usize + text.len())?;
        if !self.is_boundary(range.start) || !self.is_boundary(range.end) {
            return Err(EditError::InsideCharacter);
        }
        let (old, new) = self.replace(range, text);
        self.version += 1;
        let mut pass = Pass::default();
        let chunks = self.rearrange(old, new, &mut pass);
        self.read_edited(&chunks, &mut pass);
        self.read_below(&mut pass);
        for name in std::mem::take(&mut pass.touched) {
            self.find_shadowed(name);
        }
        let mut forgotten: Vec<SymbolId> = pass.pool.into_values().collect();
        forgotten.sort_unstable();
        for id in &forgotten {
            self.shadowed.remove(id);
            self.snapshot.names.free(*id);
        }
        Ok(Change {
            version: self.version,
            removed: pass.removed,
            read: pass.read,
            forgotten,
        })
    }

    /// Returns the present state of the document. Later edits do not change the snapshot.
    pub fn snapshot(&self) -> Snapshot<G> {
        self.snapshot.clone()
    }

    /// Returns the number of edits so far.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Returns the counters of the work since the document was created.
    pub fn counters(&self) -> ReadCounters {
        self.counters
    }
}

fn check_size(length: usize) -> Result<(), EditError> {
    match u32::try_from(length) {
        Ok(length) if length < u32::MAX => Ok(()),
        _ => Err(EditError::TooLarge),
    }
}
