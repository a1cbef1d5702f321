//! The open documents: they have one owner, and change in the order of the messages; readers work on snapshots.
//!
//! A document is read and checked as it changes, declaration by declaration, so that its diagnostics are known at once.
//! A query (hover, rename, …) works on a snapshot, which is created by the first query and shares everything that has
//! been read with the document.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use ide::language::EditError;
use ide::text::Text;
use ide::{Analysis, Language, Languages, Program};
use protocol::changes::Changes;
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;

use crate::encoding::{Encoding, LineStarts, Place};

/// The maximum distance in bytes over which a position is counted from another.
const NEAR: u32 = 4096;

/// The positions of a text's spans, in its editor's units.
pub(crate) trait Places {
    /// Returns both ends of a span.
    fn range(&self, span: Span) -> [Place; 2];
}

/// A document as it was at a version: for workers, whatever happens to the document meanwhile.
///
/// Positions can be requested in any order of the spans, and are cheapest in the order of the text: each is counted
/// from the last one. Each request therefore has its own copy.
#[derive(Clone, Debug)]
pub(crate) struct Snapshot {
    /// The document's URI, as the editor writes it.
    pub(crate) uri: String,
    /// The editor's version.
    pub(crate) version: i32,
    /// The unit of the editor's columns.
    pub(crate) encoding: Encoding,
    analysis: Arc<dyn Analysis>,
    lines: Option<Arc<LineStarts>>,
    last: LastPlaces,
}

impl Snapshot {
    /// Returns the snapshot of a text that need not be open.
    pub(crate) fn new(uri: &str, language: &dyn Language, text: &str, encoding: Encoding) -> Self {
        Self {
            uri: uri.to_owned(),
            version: 0,
            encoding,
            lines: own_lines(text),
            analysis: language.read(text),
            last: LastPlaces::default(),
        }
    }

    /// Returns the analysis of the document.
    pub(crate) fn analysis(&self) -> &dyn Analysis {
        &*self.analysis
    }

    /// Returns the text.
    pub(crate) fn text(&self) -> &dyn Text {
        self.analysis.text()
    }

    /// Returns the offset of a position.
    pub(crate) fn offset(&self, place: Place) -> u32 {
        self.counted().offset(place)
    }

    fn counted(&self) -> Counted<'_> {
        Counted {
            text: self.text(),
            lines: self.lines.as_deref(),
            encoding: self.encoding,
            last: &self.last,
        }
    }
}

impl Places for Snapshot {
    fn range(&self, span: Span) -> [Place; 2] {
        self.counted().range(span)
    }
}

/// Returns the lines of a text as the protocol defines them, if they may differ from a document's, which end only at
/// `\n`.
fn own_lines(text: &str) -> Option<Arc<LineStarts>> {
    text.contains('\r').then(|| Arc::new(LineStarts::new(text)))
}

/// The last two offsets that were counted, with their positions: a result may refer to a range far above it. A line may
/// be as long as the text, so not every position is counted from the start of its line.
#[derive(Debug, Default)]
struct LastPlaces(Mutex<[(u32, Place); 2]>);

impl LastPlaces {
    fn lock(&self) -> MutexGuard<'_, [(u32, Place); 2]> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Clone for LastPlaces {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// A text, and the editor's way of counting positions in it.
#[derive(Clone, Copy)]
struct Counted<'t> {
    text: &'t dyn Text,
    lines: Option<&'t LineStarts>,
    encoding: Encoding,
    last: &'t LastPlaces,
}

impl Counted<'_> {
    fn offset(self, place: Place) -> u32 {
        let text = self.text;
        let bounds = match self.lines {
            Some(lines) => lines.bounds(place.line),
            None => text
                .line_start(place.line.saturating_add(1))
                .map(|start| (start, text.line_start(place.line.saturating_add(2)))),
        };
        let Some((start, next)) = bounds else {
            return text.len();
        };
        let line = text.slice(Span::new(start, next.unwrap_or(text.len())));
        let line = line.unwrap_or_default();
        let content = line.trim_end_matches(['\n', '\r']);
        start + self.encoding.byte(content, place.column) as u32
    }

    fn place(self, offset: u32) -> Place {
        let offset = offset.min(self.text.len());
        let mut last = self.last.lock();
        // The second is the older one; it is replaced if neither is near.
        let near = |last: (u32, Place)| self.place_near(last, offset);
        let place = match near(last[0]) {
            Some(place) => place,
            None => {
                last.swap(0, 1);
                near(last[0]).unwrap_or_else(|| self.place_anew(offset))
            }
        };
        last[0] = (offset, place);
        place
    }

    /// Returns the position of an offset, counted from another position; `None` if the two are far apart, or separated
    /// by line ends that require a lookup.
    fn place_near(self, (from, place): (u32, Place), offset: u32) -> Option<Place> {
        if from.abs_diff(offset) > NEAR {
            return None;
        }
        let between = Span::new(from.min(offset), from.max(offset));
        let between = self.text.slice(between)?;
        let end = match self.lines {
            Some(_) if between.contains(['\n', '\r']) => return None,
            _ => between.rfind('\n'),
        };
        let length = |text: &str| self.encoding.length(text);
        match end {
            Some(_) if offset < from => None,
            Some(end) => Some(Place {
                line: place.line + between.matches('\n').count() as u32,
                column: length(&between[end + 1..]),
            }),
            None if offset < from => Some(Place {
                column: place.column - length(&between),
                ..place
            }),
            None => Some(Place {
                column: place.column + length(&between),
                ..place
            }),
        }
    }

    /// Returns the position of an offset, counted from the start of its line.
    fn place_anew(self, offset: u32) -> Place {
        let text = self.text;
        let (line, start) = match self.lines {
            Some(lines) => lines.line_of(offset),
            None => {
                let line = text.line(offset);
                (line - 1, text.line_start(line).unwrap_or(0))
            }
        };
        let before = text.slice(Span::new(start, offset)).unwrap_or_default();
        Place {
            line,
            column: self.encoding.length(&before),
        }
    }

    fn range(self, span: Span) -> [Place; 2] {
        [span.start, span.end].map(|offset| self.place(offset))
    }
}

/// A change of a document.
#[derive(Clone, Debug)]
pub(crate) struct ContentChange {
    /// The range that is replaced; the whole text if `None`.
    pub(crate) range: Option<[Place; 2]>,
    /// The new text.
    pub(crate) text: String,
}

/// All open documents.
#[derive(Debug)]
pub(crate) struct Documents {
    /// The supported languages.
    pub(crate) languages: Languages,
    /// The unit of the editor's columns.
    pub(crate) encoding: Encoding,
    open: HashMap<String, Open>,
    revision: u64,
}

/// A document in its current state.
#[derive(Debug)]
pub(crate) struct Open {
    uri: String,
    /// The editor's version.
    pub(crate) version: i32,
    /// The number of changes of all documents up to this state; it identifies the state.
    pub(crate) revision: u64,
    encoding: Encoding,
    program: Box<dyn Program>,
    lines: Option<Arc<LineStarts>>,
    last: LastPlaces,
    snapshot: OnceLock<Arc<Snapshot>>,
    /// The changes that led to this version, if they are recorded.
    changes: Changes,
}

impl Documents {
    /// Returns an empty set of documents, with positions in the default encoding.
    pub(crate) fn new(languages: Languages) -> Self {
        Self {
            languages,
            encoding: Encoding::default(),
            open: HashMap::new(),
            revision: 0,
        }
    }

    /// Returns the language of a document: that of its extension, or else the one that the editor names, or else the
    /// default.
    fn language(&self, uri: &str, name: &str) -> Arc<dyn Language> {
        let languages = &self.languages;
        let language = languages.by_extension(Path::new(uri));
        let language = language.or_else(|| languages.named(name));
        language.unwrap_or(languages.default_language()).clone()
    }

    /// Opens a document, or replaces it. `language` is the editor's name of its language.
    ///
    /// # Errors
    /// If the text is too large; the document is then not open.
    pub(crate) fn open(
        &mut self,
        uri: &str,
        language: &str,
        version: i32,
        text: &str,
    ) -> Result<&Open, EditError> {
        self.open.remove(uri);
        let program = self.language(uri, language).open(text)?;
        self.revision += 1;
        let opened = Open {
            uri: uri.to_owned(),
            version,
            revision: self.revision,
            encoding: self.encoding,
            program,
            lines: own_lines(text),
            last: LastPlaces::default(),
            snapshot: OnceLock::new(),
            changes: Changes::default(),
        };
        Ok(self.open.entry(uri.to_owned()).or_insert(opened))
    }

    /// Applies changes in order. Returns `None` for a document that is not open. If they are `recorded`,
    /// [`Open::changes`] returns them.
    ///
    /// # Errors
    /// If a text would be too large; the changes before it have been made.
    pub(crate) fn change(
        &mut self,
        uri: &str,
        version: i32,
        changes: Vec<ContentChange>,
        recorded: bool,
    ) -> Option<Result<&Open, EditError>> {
        let open = self.open.get_mut(uri)?;
        self.revision += 1;
        open.version = version;
        open.revision = self.revision;
        open.snapshot = OnceLock::new();
        open.last = LastPlaces::default();
        open.changes = Changes::default();
        let made = changes
            .into_iter()
            .try_for_each(|change| open.apply(&change, recorded));
        Some(made.map(|()| &*open))
    }

    /// Closes a document.
    pub(crate) fn close(&mut self, uri: &str) {
        self.open.remove(uri);
    }

    /// Returns the current state of a document.
    pub(crate) fn get(&self, uri: &str) -> Option<&Open> {
        self.open.get(uri)
    }

    /// Returns snapshots of all documents, by name.
    pub(crate) fn snapshots(&self) -> Vec<Arc<Snapshot>> {
        let mut all: Vec<_> = self.open.values().map(Open::snapshot).collect();
        all.sort_by(|a, b| a.uri.cmp(&b.uri));
        all
    }

    /// Returns true if a document is open and has not changed since a revision.
    pub(crate) fn is_current(&self, uri: &str, revision: u64) -> bool {
        self.open
            .get(uri)
            .is_some_and(|open| open.revision == revision)
    }
}

impl Open {
    /// Returns a snapshot for workers.
    pub(crate) fn snapshot(&self) -> Arc<Snapshot> {
        let made = self.snapshot.get_or_init(|| {
            Arc::new(Snapshot {
                uri: self.uri.clone(),
                version: self.version,
                encoding: self.encoding,
                analysis: self.program.snapshot(),
                lines: self.lines.clone(),
                last: LastPlaces::default(),
            })
        });
        made.clone()
    }

    /// Returns the diagnostics that are known without running the program, and whether a run may find more.
    pub(crate) fn findings(&self) -> (Arc<[Diagnostic]>, bool) {
        match self.program.diagnostics_of_reading() {
            Some(found) => (found, true),
            None => (self.program.diagnostics(), false),
        }
    }

    /// Returns the current text.
    pub(crate) fn text(&self) -> &dyn Text {
        self.program.text()
    }

    /// Returns the changes that led to this version, if they were recorded.
    pub(crate) fn changes(&self) -> &Changes {
        &self.changes
    }

    fn apply(&mut self, change: &ContentChange, recorded: bool) -> Result<(), EditError> {
        let text = self.program.text();
        let span = match change.range {
            None => Span::new(0, text.len()),
            Some(range) => {
                let [start, end] = range.map(|place| self.counted().offset(place));
                Span::new(start.min(end), start.max(end))
            }
        };
        let made = match (recorded, change.range) {
            (false, _) => None,
            (true, Some(_)) => Some(Changes::one([span.start, span.end], change.text.as_str())),
            // Most of the text may be unchanged.
            (true, None) => Some(Changes::between(&text.string(), &change.text)),
        };
        self.program.edit(span, &change.text)?;
        if let Some(made) = made {
            self.changes = self.changes.then(&made);
        }
        if self.lines.is_some() || change.text.contains('\r') {
            // A rare case: a text with carriage returns. Its lines are found anew for each change.
            self.lines = Some(Arc::new(LineStarts::new(&self.program.text().string())));
        }
        Ok(())
    }

    fn counted(&self) -> Counted<'_> {
        Counted {
            text: self.program.text(),
            lines: self.lines.as_deref(),
            encoding: self.encoding,
            last: &self.last,
        }
    }
}

impl Places for Open {
    fn range(&self, span: Span) -> [Place; 2] {
        self.counted().range(span)
    }
}

#[cfg(test)]
mod tests {
    use super::{ContentChange, Documents, Places, Snapshot};
    use crate::encoding::{Encoding, LineStarts, Place};
    use ide::Languages;
    use syntax::span::Span;

    #[test]
    fn a_document_that_is_edited_is_the_text_an_editor_has() {
        let pieces = [
            "",
            "\n",
            "# 𝛼é\n",
            "\r\n",
            "define a = 1;",
            ";",
            "\r",
            "sin x",
            "é",
        ];
        let mut seed = 3_u64;
        let mut random = |limit: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as usize % limit
        };
        for encoding in [Encoding::Utf8, Encoding::Utf16, Encoding::Utf32] {
            let mut documents = Documents::new(Languages::standard());
            documents.encoding = encoding;
            let geotrace = documents.languages.default_language().clone();
            for carriage in [false, true] {
                let mut text = String::new();
                documents.open("a", "geotrace", 0, "").expect("small");
                for version in 1..400 {
                    let before = Snapshot::new("a", &*geotrace, &text, encoding);
                    let mut ends = [(); 2].map(|()| Place {
                        line: random(8) as u32,
                        column: random(12) as u32,
                    });
                    ends.sort_unstable();
                    let [start, end] = ends.map(|place| before.offset(place) as usize);
                    let new = pieces[random(pieces.len())];
                    if new.contains('\r') && !carriage {
                        continue;
                    }
                    text.replace_range(start..end, new);
                    let change = ContentChange {
                        range: Some(ends),
                        text: new.to_owned(),
                    };
                    let open = documents.change("a", version, vec![change], true);
                    let open = open.expect("open").expect("small");
                    let snapshot = open.snapshot();
                    assert_eq!(snapshot.text().string(), text);
                    let edited = open.changes().apply(&before.text().string());
                    assert_eq!(edited.as_ref(), Some(&text));
                    let lines = LineStarts::new(&text);
                    for offset in (0..=text.len()).filter(|&k| text.is_char_boundary(k)) {
                        let span = Span::new(offset as u32, text.len() as u32);
                        assert_eq!(open.range(span), snapshot.range(span));
                        assert_eq!(
                            open.range(span),
                            lines.range(&text, encoding, span),
                            "{text:?} at {offset}"
                        );
                    }
                    if text.len() > 80 {
                        text.clear();
                        documents.open("a", "geotrace", version, "").expect("small");
                    }
                }
            }
        }
    }
}
