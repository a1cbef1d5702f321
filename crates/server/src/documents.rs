//! The open documents: one owner, changed in the order of the messages; readers take snapshots.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use ide::Reading;
use syntax::span::Span;

use crate::encoding::{Encoding, Lines, Place};

/// A document as it was at a version: for workers, whatever happens to the document meanwhile.
#[derive(Debug)]
pub(crate) struct Snapshot {
    /// The document's name: its URI as the editor writes it.
    pub(crate) uri: String,
    /// The editor's version.
    pub(crate) version: i32,
    /// Counts the changes of all documents: tells two snapshots apart.
    pub(crate) revision: u64,
    /// The text.
    pub(crate) text: Arc<str>,
    /// Its lines.
    pub(crate) lines: Arc<Lines>,
    /// How the editor counts columns.
    pub(crate) encoding: Encoding,
    reading: OnceLock<Reading>,
}

impl Snapshot {
    /// The text, read; by the first who asks.
    pub(crate) fn reading(&self) -> &Reading {
        self.reading.get_or_init(|| Reading::new(self.text.clone()))
    }

    /// The offset of a place.
    pub(crate) fn offset(&self, place: Place) -> u32 {
        self.lines.offset(&self.text, self.encoding, place)
    }

    /// Both ends of a span, as places.
    pub(crate) fn range(&self, span: Span) -> [Place; 2] {
        self.lines.range(&self.text, self.encoding, span)
    }
}

/// A change of a document.
#[derive(Clone, Debug)]
pub(crate) struct Change {
    /// What is replaced; the whole text if `None`.
    pub(crate) range: Option<[Place; 2]>,
    /// What takes its place.
    pub(crate) text: String,
}

/// All open documents.
#[derive(Debug, Default)]
pub(crate) struct Documents {
    /// How the editor counts columns.
    pub(crate) encoding: Encoding,
    open: HashMap<String, Document>,
    revision: u64,
}

#[derive(Debug)]
struct Document {
    text: String,
    lines: Lines,
    snapshot: Arc<Snapshot>,
}

impl Documents {
    /// Opens a document, or replaces it.
    pub(crate) fn open(&mut self, uri: String, version: i32, text: String) -> Arc<Snapshot> {
        let lines = Lines::new(&text);
        let snapshot = self.snapshot(&uri, version, &text, &lines);
        let document = Document {
            text,
            lines,
            snapshot: snapshot.clone(),
        };
        self.open.insert(uri, document);
        snapshot
    }

    /// Applies changes in their order; `None` for a document that is not open.
    pub(crate) fn change(
        &mut self,
        uri: &str,
        version: i32,
        changes: Vec<Change>,
    ) -> Option<Arc<Snapshot>> {
        let mut document = self.open.remove(uri)?;
        for change in changes {
            match change.range {
                None => {
                    document.text = change.text;
                    document.lines = Lines::new(&document.text);
                }
                Some(range) => {
                    let mut ends = range
                        .map(|place| document.lines.offset(&document.text, self.encoding, place));
                    ends.sort_unstable();
                    let [start, end] = ends;
                    document
                        .text
                        .replace_range(start as usize..end as usize, &change.text);
                    document
                        .lines
                        .replace(&document.text, Span::new(start, end), &change.text);
                }
            }
        }
        document.snapshot = self.snapshot(uri, version, &document.text, &document.lines);
        let snapshot = document.snapshot.clone();
        self.open.insert(uri.to_owned(), document);
        Some(snapshot)
    }

    /// Closes a document.
    pub(crate) fn close(&mut self, uri: &str) {
        self.open.remove(uri);
    }

    /// The document as it is now.
    pub(crate) fn get(&self, uri: &str) -> Option<Arc<Snapshot>> {
        self.open.get(uri).map(|document| document.snapshot.clone())
    }

    /// All documents as they are now, by name.
    pub(crate) fn all(&self) -> Vec<Arc<Snapshot>> {
        let mut all: Vec<_> = self.open.values().map(|d| d.snapshot.clone()).collect();
        all.sort_by(|a, b| a.uri.cmp(&b.uri));
        all
    }

    /// Whether a snapshot is of a document that is open and has not changed since.
    pub(crate) fn is_current(&self, snapshot: &Snapshot) -> bool {
        let open = self.open.get(&snapshot.uri);
        open.is_some_and(|document| document.snapshot.revision == snapshot.revision)
    }

    fn snapshot(&mut self, uri: &str, version: i32, text: &str, lines: &Lines) -> Arc<Snapshot> {
        self.revision += 1;
        Arc::new(Snapshot {
            uri: uri.to_owned(),
            version,
            revision: self.revision,
            text: text.into(),
            lines: Arc::new(lines.clone()),
            encoding: self.encoding,
            reading: OnceLock::new(),
        })
    }
}

/// The snapshot of a text that no editor has open.
pub(crate) fn unopened(uri: String, text: String, encoding: Encoding) -> Snapshot {
    let lines = Arc::new(Lines::new(&text));
    Snapshot {
        uri,
        version: 0,
        revision: 0,
        text: text.into(),
        lines,
        encoding,
        reading: OnceLock::new(),
    }
}
