//! A text that is edited: read declaration by declaration, and again only where an edit can be noticed.
//!
//! ```text
//! edit ──▶ edit.rs       which chunks are cut anew, and who reads again what has changed
//!          chunk.rs      cuts the text behind each `;`: a chunk is a declaration with what stands before it
//!          record.rs, tags.rs   what was read of a chunk, packed
//!          sequence.rs   the chunks in order, with sums: offsets and lines in logarithmic time
//!          names.rs      what a word means at a place; who reads a name
//!          open_words.rs who would read a name if it were defined
//!          above.rs      the names as the parser sees them, through `symbols::Scope`
//!          findings.rs   diagnostics, finished with lines and names of other places when they are asked for
//! ask  ──▶ snapshot.rs, pieces.rs   the text, its tokens, declarations, symbols and lines, at one version
//!          shelf.rs, chunk_set.rs   lists and sets that a snapshot shares with the document
//! ```
//!
//! `;` and `#` delimit declarations whatever any name means, so an edit cuts anew only the chunks it touches.
//! They are read again, and so are those below that read a name whose meaning has changed, or would read a
//! new one: a chunk tells each word that it has looked up. Reading a chunk may change names in turn; going
//! down the text, each is read once at most. Equal to reading the whole text after every edit, always.
//!
//! All that is kept of a chunk counts from its start, and a symbol keeps its identifier for as long as its
//! declaration does: what is above and below may change without a chunk being touched.

mod above;
mod chunk;
mod chunk_set;
mod edit;
mod findings;
mod names;
mod open_words;
mod pieces;
mod record;
mod sequence;
mod shelf;
mod snapshot;
mod tags;

use std::collections::{BTreeSet, HashMap, VecDeque};
use std::ops::Deref;

use crate::geotrace::symbols::Vocabulary;
use crate::span::Span;
use crate::symbol::SymbolId;

use chunk::cut;
use edit::Pass;
use findings::HiddenSplit;
use names::Names;
use open_words::{Lookup, OpenWords};
use sequence::Sequence;
use shelf::Shelf;

pub use chunk::{Event, ReadDeclaration};
pub use pieces::Piece;
pub use record::{Events, Parameters, Tokens};
pub use sequence::ChunkId;
pub use snapshot::Snapshot;

/// A text and what it has been read as: its present [`Snapshot`], and what is needed to change it.
#[derive(Clone, Debug)]
pub struct Document {
    snapshot: Snapshot,
    free: Vec<ChunkId>,
    open: OpenWords,
    /// The symbols whose letters are split above them.
    hidden: HashMap<SymbolId, HiddenSplit>,
    version: u64,
    journal: VecDeque<Change>,
    work: Work,
}

impl Deref for Document {
    type Target = Snapshot;

    fn deref(&self) -> &Snapshot {
        &self.snapshot
    }
}

/// What an edit has done.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Change {
    /// The document's version after it.
    pub version: u64,
    /// The chunks that are there no longer. A handle may come back for a new chunk.
    pub removed: Vec<ChunkId>,
    /// The chunks that were read, from top to bottom; new ones too.
    pub read: Vec<ChunkId>,
    /// The symbols that are declared no longer. A handle may come back for a new symbol.
    pub forgotten: Vec<SymbolId>,
}

/// How much has been done since the document was made.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Work {
    /// Bytes that were searched for the ends of declarations.
    pub cut: u64,
    /// Chunks that were lexed and parsed because their text is new.
    pub edited: u64,
    /// Chunks that were lexed and parsed again because of the names above them.
    pub reread: u64,
}

/// Why an edit is not made; the document is as it was.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum EditError {
    /// The range ends beyond the text, or before it starts.
    OutOfRange,
    /// An end of the range lies inside a character.
    InsideCharacter,
    /// The text would have 4 GiB or more.
    TooLarge,
}

impl std::fmt::Display for EditError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::OutOfRange => "the edit's range is not one of the text",
            Self::InsideCharacter => "the edit's range ends inside a character",
            Self::TooLarge => "the text would be too large: 4 GiB are the limit",
        })
    }
}

impl std::error::Error for EditError {}

/// How many changes are remembered.
const MAX_JOURNAL: usize = 256;

impl Document {
    /// Reads a text.
    ///
    /// # Errors
    /// [`EditError::TooLarge`].
    pub fn new(text: &str, vocabulary: &Vocabulary) -> Result<Self, EditError> {
        let mut document = Self::begun(Snapshot {
            sequence: Sequence::default(),
            chunks: Shelf::default(),
            names: Names::new(vocabulary),
        });
        check_size(text.len())?;
        let mut ends = Vec::new();
        cut(text, 0, false, &mut ends);
        document.work.cut += text.len() as u64;
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
            document.work.edited += 1;
            (start, last) = (end, Some(chunk));
        }
        for name in touched {
            document.find_hidden(name);
        }
        Ok(document)
    }

    /// A document of a snapshot, of which it knows no more than is in it.
    fn begun(snapshot: Snapshot) -> Self {
        Self {
            snapshot,
            free: Vec::new(),
            open: OpenWords::default(),
            hidden: HashMap::new(),
            version: 0,
            journal: VecDeque::new(),
            work: Work::default(),
        }
    }

    /// A document that goes on from what another was at a version: for trying edits out. Nothing is read for it.
    pub fn of(snapshot: Snapshot) -> Self {
        let mut document = Self::begun(snapshot);
        let Self {
            snapshot,
            free,
            open,
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
                    open.enter(id, rest, length, is_split);
                }
            }
            snapshot.touch(chunk, &mut touched);
        }
        for name in touched {
            document.find_hidden(name);
        }
        document
    }

    /// Replaces the bytes of a range.
    ///
    /// # Errors
    /// Where there is no such range, or the text would be too large; then nothing is done.
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
            self.find_hidden(name);
        }
        let mut forgotten: Vec<SymbolId> = pass.pool.into_values().collect();
        forgotten.sort_unstable();
        for id in &forgotten {
            self.hidden.remove(id);
            self.snapshot.names.free(*id);
        }
        let change = Change {
            version: self.version,
            removed: pass.removed,
            read: pass.read,
            forgotten,
        };
        if self.journal.len() == MAX_JOURNAL {
            self.journal.pop_front();
        }
        self.journal.push_back(change.clone());
        Ok(change)
    }

    /// The document as it is now, whatever becomes of it.
    pub fn snapshot(&self) -> Snapshot {
        self.snapshot.clone()
    }

    /// Counts the edits, from 0.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// What has been done since a version; none where that is too long ago, or yet to come.
    pub fn changes_since(&self, version: u64) -> Option<impl Iterator<Item = &Change>> {
        let oldest = self.version - self.journal.len() as u64;
        (oldest <= version && version <= self.version)
            .then(|| self.journal.iter().filter(move |it| it.version > version))
    }

    /// How much has been done so far.
    pub fn work(&self) -> Work {
        self.work
    }
}

fn check_size(length: usize) -> Result<(), EditError> {
    match u32::try_from(length) {
        Ok(length) if length < u32::MAX => Ok(()),
        _ => Err(EditError::TooLarge),
    }
}
