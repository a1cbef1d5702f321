//! A text that is edited: read declaration by declaration, and again only where an edit can be noticed.
//!
//! ```text
//! edit ──▶ chunk.rs     cuts the text behind each `;`: a chunk is a declaration with what stands before it
//!          sequence.rs  the chunks in order, with sums: offsets and lines in logarithmic time
//!          names.rs     what a word means at a place; who reads a name, or would if it were defined
//!          parser       reads a chunk with the names above it, through `symbols::Scope`
//!          findings.rs  diagnostics, finished with lines and names of other places when they are asked for
//! ```
//!
//! `;` and `#` delimit declarations whatever any name means, so an edit cuts anew only the chunks it touches.
//! They are read again, and so are those below that read a name whose meaning has changed, or would read a
//! new one: a chunk tells each word that it has looked up. Reading a chunk may change names in turn; going
//! down the text, each is read once at most. Equal to reading the whole text after every edit, always.
//!
//! All that is kept of a chunk counts from its start, and a symbol keeps its identifier for as long as its
//! declaration does: what is above and below may change without a chunk being touched.

mod chunk;
mod findings;
mod names;
mod sequence;

use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};

use crate::line_index::Position;
use crate::parser::parse_piece;
use crate::span::Span;
use crate::symbols::{Parsed, Symbol, Vocabulary};
use crate::token::{SymbolId, Token};

use chunk::{Chunk, Finding, Recorder, count_lines, cut};
use findings::HiddenSplit;
use names::{Above, ChunkSet, Lookup, NameId, Names, Signature};
use sequence::Sequence;

pub use chunk::{Event, ReadDeclaration};
pub use sequence::ChunkId;

/// A text and what it has been read as.
#[derive(Clone, Debug)]
pub struct Document {
    sequence: Sequence,
    chunks: Vec<Option<Chunk>>,
    free: Vec<ChunkId>,
    names: Names,
    /// The chunks in which a name stands behind a declaring word.
    declared: HashMap<Box<str>, ChunkSet>,
    /// The symbols whose letters are split above them.
    hidden: HashMap<SymbolId, HiddenSplit>,
    version: u64,
    journal: VecDeque<Change>,
    work: Work,
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
        let mut document = Self {
            sequence: Sequence::default(),
            chunks: Vec::new(),
            free: Vec::new(),
            names: Names::new(vocabulary),
            declared: HashMap::new(),
            hidden: HashMap::new(),
            version: 0,
            journal: VecDeque::new(),
            work: Work::default(),
        };
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
            document.sequence.insert(last, chunk, measure);
            document.read(chunk, None, &mut pool, &mut touched);
            document.work.edited += 1;
            (start, last) = (end, Some(chunk));
        }
        for name in touched {
            document.find_hidden(name);
        }
        Ok(document)
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
            self.names.free(*id);
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

    /// The length of the text in bytes.
    pub fn len(&self) -> u32 {
        self.sequence.total().bytes
    }

    /// Whether there is no text.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The whole text.
    pub fn text(&self) -> String {
        self.slice(Span::new(0, self.len())).unwrap_or_default()
    }

    /// The text of a range; none where there is no such range or it ends inside a character.
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

    /// How many lines there are, at least 1.
    pub fn line_count(&self) -> u32 {
        self.sequence.total().lines + 1
    }

    /// The line and column of the character that starts at `offset`; an offset past the end counts as the end.
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

    /// The line, from 1, of an offset.
    pub fn line(&self, offset: u32) -> u32 {
        let Some((chunk, before)) = self.sequence.at_byte(offset) else {
            return 1;
        };
        let text = self.chunk(chunk).text.as_bytes();
        let inside = ((offset - before.bytes) as usize).min(text.len());
        let ends = text[..inside].iter().filter(|byte| **byte == b'\n');
        before.lines + ends.count() as u32 + 1
    }

    /// Where a line, from 1, starts; none where there is no such line.
    pub fn line_start(&self, line: u32) -> Option<u32> {
        let ends = line.checked_sub(1)?;
        if ends == 0 {
            return Some(0);
        }
        if ends > self.sequence.total().lines {
            return None;
        }
        let (chunk, before) = self.sequence.at_line_end(ends)?;
        let text = self.chunk(chunk).text.bytes();
        let mut places = text.enumerate().filter(|(_, byte)| *byte == b'\n');
        let (at, _) = places.nth((ends - before.lines) as usize - 1)?;
        Some(before.bytes + at as u32 + 1)
    }

    /// The offset of the character at a place. A column past the line's end gives the line's end; none where
    /// there is no such line, or for a 0.
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
        let text = &self.chunk(chunk).text;
        let inside = (wanted - before.characters) as usize;
        let (at, _) = text.char_indices().nth(inside)?;
        Some(before.bytes + at as u32)
    }

    /// All chunks, from top to bottom.
    pub fn chunks(&self) -> impl Iterator<Item = ChunkId> + '_ {
        self.sequence.from(self.sequence.first())
    }

    /// The chunks that a range touches, each with the offset of its start.
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

    /// Where a chunk starts.
    pub fn start(&self, chunk: ChunkId) -> u32 {
        self.sequence.before(chunk).bytes
    }

    /// How many chunks stand above a chunk.
    pub fn rank(&self, chunk: ChunkId) -> u32 {
        self.sequence.rank(chunk)
    }

    /// The text of a chunk: declarations up to a `;`, one as a rule, with what stands before it.
    pub fn chunk_text(&self, chunk: ChunkId) -> &str {
        &self.chunk(chunk).text
    }

    /// The version since which a chunk has been read as it is.
    pub fn chunk_version(&self, chunk: ChunkId) -> u64 {
        self.chunk(chunk).version
    }

    /// What was read of a chunk; places count from its start.
    pub fn events(&self, chunk: ChunkId) -> &[Event] {
        &self.chunk(chunk).events
    }

    /// The tokens that a range touches, comments too, in order; places are those of the text.
    pub fn tokens(&self, range: Span) -> impl Iterator<Item = Token> + '_ {
        let chunks = self.chunks_in(range);
        chunks.flat_map(move |(chunk, start)| {
            let tokens = self.chunk(chunk).tokens.iter();
            let moved = tokens.map(move |token| Token {
                kind: token.kind,
                span: token.span.moved(start),
            });
            moved
                .filter(move |token| token.span.end >= range.start && token.span.start <= range.end)
        })
    }

    /// The declarations in order, each with its chunk; places count from the chunk's start.
    pub fn declarations(&self) -> impl Iterator<Item = (ChunkId, &ReadDeclaration)> {
        self.chunks().flat_map(|chunk| {
            let events = self.chunk(chunk).events.iter();
            events.filter_map(move |event| match event {
                Event::Declaration(declaration) => Some((chunk, &**declaration)),
                _ => None,
            })
        })
    }

    /// A builtin, or a symbol that the text declares; its places count from the start of its chunk.
    pub fn symbol(&self, id: SymbolId) -> Option<&Symbol> {
        Some(&self.names.get(id)?.symbol)
    }

    /// The chunk that declares a symbol; none for a builtin.
    pub fn home(&self, id: SymbolId) -> Option<ChunkId> {
        self.names.get(id)?.home
    }

    /// Where the text names a symbol that it declares.
    pub fn place(&self, id: SymbolId) -> Option<Span> {
        let defined = self.names.get(id)?;
        let start = self.start(defined.home?);
        Some(defined.symbol.name_span?.moved(start))
    }

    /// All symbols, the builtins first, then in no order.
    pub fn symbols(&self) -> impl Iterator<Item = (SymbolId, &Symbol)> {
        self.names.iter().map(|(id, defined)| (id, &defined.symbol))
    }

    /// The chunks that read a symbol, in no order; its own may be among them.
    pub fn readers(&self, id: SymbolId) -> impl Iterator<Item = ChunkId> + '_ {
        let name = self.names.name_of(id);
        name.into_iter().flat_map(|name| self.names.users(name))
    }

    /// The names as they stand at the end of the text, as [`parse_program`](crate::parse_program) gives them:
    /// with other identifiers, which count up in the order of the text.
    pub fn parsed(&self) -> Parsed {
        let builtins = self.names.iter().map(|(_, defined)| defined);
        let builtins = builtins.filter(|defined| defined.home.is_none());
        let mut parsed = Parsed::default();
        for builtin in builtins {
            parsed.define(builtin.symbol.clone());
        }
        let mut start = 0;
        for chunk in self.chunks() {
            let chunk = self.chunk(chunk);
            for defined in chunk.defines.iter().filter_map(|id| self.names.get(*id)) {
                let mut symbol = defined.symbol.clone();
                symbol.name_span = symbol.name_span.map(|span| span.moved(start));
                for parameter in &mut symbol.parameters {
                    parameter.span = parameter.span.moved(start);
                }
                parsed.define(symbol);
            }
            start += chunk.text.len() as u32;
        }
        parsed
    }

    fn chunk(&self, chunk: ChunkId) -> &Chunk {
        self.chunks[chunk.0 as usize]
            .as_ref()
            .expect("a chunk of this document")
    }

    fn chunk_mut(&mut self, chunk: ChunkId) -> &mut Chunk {
        self.chunks[chunk.0 as usize]
            .as_mut()
            .expect("a chunk of this document")
    }

    fn byte(&self, offset: u32) -> Option<u8> {
        let (chunk, before) = self.sequence.at_byte(offset)?;
        let text = self.chunk(chunk).text.as_bytes();
        text.get((offset - before.bytes) as usize).copied()
    }

    fn is_boundary(&self, offset: u32) -> bool {
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
        let text = &self.chunk(chunk).text;
        let inside = &text[..(offset - before.bytes) as usize];
        before.characters + inside.chars().count() as u32
    }

    fn allocate(&mut self, text: &str) -> ChunkId {
        let mut chunk = Chunk {
            text: text.into(),
            version: self.version,
            ..Chunk::default()
        };
        chunk.scan();
        let id = self.free.pop().unwrap_or(ChunkId(self.chunks.len() as u32));
        match self.chunks.get_mut(id.0 as usize) {
            Some(place) => *place = Some(chunk),
            None => self.chunks.push(Some(chunk)),
        }
        self.enter_declared(id);
        id
    }

    fn enter_declared(&mut self, id: ChunkId) {
        let Some(Some(chunk)) = self.chunks.get(id.0 as usize) else {
            return;
        };
        for declared in &chunk.declared {
            if !self.declared.contains_key(&declared.name) {
                let name = declared.name.clone();
                self.declared.insert(name, ChunkSet::default());
            }
            if let Some(chunks) = self.declared.get_mut(&declared.name) {
                chunks.insert(id);
            }
        }
    }

    fn strike_declared(&mut self, id: ChunkId) {
        let Some(Some(chunk)) = self.chunks.get(id.0 as usize) else {
            return;
        };
        for declared in &chunk.declared {
            if let Some(chunks) = self.declared.get_mut(&declared.name) {
                chunks.remove(id);
                if chunks.is_empty() {
                    self.declared.remove(&declared.name);
                }
            }
        }
    }

    /// The chunks that an edit touches, and the texts that take their place: as many as need be for the last
    /// to end where the chunk after it begins.
    fn replace(&mut self, range: Span, text: &str) -> (Vec<ChunkId>, Vec<String>) {
        let Some((first, before)) = self.sequence.at_byte(range.start) else {
            return (Vec::new(), Vec::new());
        };
        let mut old = vec![first];
        let mut last = first;
        let mut start = before.bytes;
        while start + (self.chunk(last).text.len() as u32) <= range.end
            && range.end > range.start
            && let Some(next) = self.sequence.next(last)
        {
            start += self.chunk(last).text.len() as u32;
            last = next;
            old.push(last);
        }
        let head = &self.chunk(first).text[..(range.start - before.bytes) as usize];
        let tail = &self.chunk(last).text[(range.end - start) as usize..];
        let mut all = [head, text, tail].concat();
        let mut ends = Vec::new();
        let mut cut_to = 0;
        let mut in_comment = false;
        loop {
            in_comment = cut(&all, cut_to, in_comment, &mut ends);
            cut_to = all.len();
            let Some(next) = self.sequence.next(last) else {
                ends.push(all.len());
                break;
            };
            if ends.last() == Some(&all.len()) {
                break;
            }
            all.push_str(&self.chunk(next).text);
            old.push(next);
            last = next;
        }
        self.work.cut += all.len() as u64;
        let mut start = 0;
        let texts = ends.into_iter().map(|end| {
            let piece = all[start..end].to_owned();
            start = end;
            piece
        });
        (old, texts.collect())
    }

    /// Puts new texts in the place of old chunks and says which chunks are to be read. What the old ones
    /// declared and asked is struck out; where a text has not changed, the chunk stays.
    fn rearrange(
        &mut self,
        mut old: Vec<ChunkId>,
        mut new: Vec<String>,
        pass: &mut Pass,
    ) -> Vec<ChunkId> {
        let start = old.first().map_or(0, |first| self.start(*first));
        let above = start
            .checked_sub(1)
            .and_then(|last| self.sequence.at_byte(last));
        let above = above.map(|(chunk, _)| chunk);
        let is_same = |document: &Self, chunk: Option<&ChunkId>, text: Option<&String>| {
            matches!((chunk, text), (Some(chunk), Some(text))
                if *document.chunk(*chunk).text == **text && !text.starts_with('\u{FEFF}'))
        };
        while is_same(self, old.last(), new.last()) {
            old.pop();
            new.pop();
        }
        let mut kept = 0;
        while is_same(self, old.get(kept), new.get(kept)) {
            kept += 1;
        }
        let mut after = match kept.checked_sub(1) {
            Some(index) => old.get(index).copied(),
            None => above,
        };
        pass.above = after.map_or(0, |chunk| self.sequence.rank(chunk) + 1);
        let old = old.split_off(kept);
        let new = new.split_off(kept);
        for chunk in &old {
            self.withdraw(*chunk, pass);
            self.strike_declared(*chunk);
        }
        // The last new text is most likely what the last old chunk has become.
        let surplus = old.len().saturating_sub(new.len());
        let fresh = new.len().saturating_sub(old.len());
        for chunk in &old[..surplus] {
            self.sequence.remove(*chunk);
            self.chunks[chunk.0 as usize] = None;
            pass.removed.push(*chunk);
        }
        let mut chunks = Vec::with_capacity(new.len());
        for (index, text) in new.iter().enumerate() {
            let chunk = match index.checked_sub(fresh) {
                Some(index) => {
                    let chunk = old[surplus + index];
                    let read = self.chunk_mut(chunk);
                    read.text = text.as_str().into();
                    read.scan();
                    self.enter_declared(chunk);
                    let measure = self.chunk(chunk).measure();
                    self.sequence.measure(chunk, measure);
                    chunk
                }
                None => {
                    let chunk = self.allocate(text);
                    let measure = self.chunk(chunk).measure();
                    self.sequence.insert(after, chunk, measure);
                    chunk
                }
            };
            after = Some(chunk);
            chunks.push(chunk);
        }
        self.free.extend(&pass.removed);
        chunks
    }

    /// Strikes out all that a chunk has declared and asked. Its symbols may be declared again, under the same
    /// identifiers.
    fn withdraw(&mut self, id: ChunkId, pass: &mut Pass) {
        let chunk = self.chunks[id.0 as usize].take().unwrap_or_default();
        self.touch(&chunk, &mut pass.touched);
        self.names.strike(id, &chunk.text, &chunk.lookups);
        for &symbol in &chunk.defines {
            if let (Some(signature), Some(defined)) =
                (self.names.signature(symbol), self.names.get(symbol))
            {
                let name = defined.name();
                let text = defined.symbol.name.clone();
                pass.before.insert(name, (symbol, signature));
                pass.pool.insert(text, symbol);
                self.names.withdraw(symbol);
            }
        }
        let text = chunk.text;
        self.chunks[id.0 as usize] = Some(Chunk {
            text,
            declared: chunk.declared,
            ..Chunk::default()
        });
    }

    /// Notes the names whose letters a chunk splits.
    fn touch(&self, chunk: &Chunk, touched: &mut BTreeSet<NameId>) {
        for lookup in &chunk.lookups {
            if let Lookup::Open {
                start,
                end,
                length,
                is_split: true,
            } = *lookup
            {
                let rest = &chunk.text[start as usize..end as usize];
                self.names.hiding(rest, length, |name| {
                    touched.insert(name);
                });
            }
        }
    }

    /// Reads a chunk with the names above it. All that it had declared and asked has been struck out.
    fn read(
        &mut self,
        id: ChunkId,
        rank: Option<u32>,
        pool: &mut HashMap<String, SymbolId>,
        touched: &mut BTreeSet<NameId>,
    ) {
        let is_first = match rank {
            Some(rank) => rank == 0,
            None => self.sequence.first() == Some(id),
        };
        let version = self.version;
        let chunk = self.chunk(id);
        let above = Above::new(&self.names, &self.sequence, rank, pool);
        let mut recorder = Recorder::default();
        let (above, untold) = parse_piece(&chunk.text, is_first, above, &mut recorder);
        let (symbols, lookups) = above.finish();
        let mut untold = untold.into_iter().peekable();
        let findings = recorder.diagnostics.into_iter().enumerate();
        let findings = findings.map(|(number, diagnostic)| Finding {
            diagnostic,
            elsewhere: untold
                .next_if(|(told, _)| *told == number)
                .map(|(_, elsewhere)| elsewhere),
        });
        let findings = findings.collect();
        let mut known_from: HashMap<SymbolId, u32> = HashMap::new();
        for event in &recorder.events {
            if let Event::Declaration(declaration) = event
                && let Some(symbol) = declaration.symbol
            {
                known_from.insert(symbol, declaration.span.end);
            }
        }
        let chunk = self.chunk_mut(id);
        chunk.tokens = recorder.tokens.into_boxed_slice();
        chunk.events = recorder.events.into_boxed_slice();
        chunk.findings = findings;
        chunk.lookups = lookups.into_boxed_slice();
        chunk.defines = symbols.iter().map(|(symbol, _)| *symbol).collect();
        chunk.version = version;
        for (symbol, meaning) in symbols {
            let known_from = known_from.get(&symbol).copied().unwrap_or_default();
            self.names.define(symbol, meaning, id, known_from);
            touched.extend(self.names.name_of(symbol));
        }
        let chunk = self.chunks[id.0 as usize].take().unwrap_or_default();
        self.names.enter(id, &chunk.text, &chunk.lookups);
        self.touch(&chunk, touched);
        self.sequence.measure(id, chunk.measure());
        self.chunks[id.0 as usize] = Some(chunk);
    }

    /// Reads the chunks whose text is new.
    fn read_edited(&mut self, chunks: &[ChunkId], pass: &mut Pass) {
        let first = pass.above;
        for (rank, chunk) in (first..).zip(chunks) {
            self.read(*chunk, Some(rank), &mut pass.pool, &mut pass.touched);
            self.work.edited += 1;
            pass.read.push(*chunk);
        }
        self.compare(chunks, first + chunks.len() as u32, pass);
    }

    /// Reads the chunks below that notice what has changed.
    fn read_below(&mut self, pass: &mut Pass) {
        while let Some((rank, chunk)) = pass.affected.pop_first() {
            self.withdraw(chunk, pass);
            self.read(chunk, Some(rank), &mut pass.pool, &mut pass.touched);
            self.work.reread += 1;
            pass.read.push(chunk);
            self.compare(&[chunk], rank + 1, pass);
        }
    }

    /// Compares what chunks declare with what they declared before, and marks whoever below notices; `rank`
    /// is that of the first chunk below.
    fn compare(&mut self, chunks: &[ChunkId], rank: u32, pass: &mut Pass) {
        let mut before = std::mem::take(&mut pass.before);
        let mut changed: Vec<(NameId, bool)> = Vec::new();
        for chunk in chunks {
            for &symbol in &self.chunk(*chunk).defines {
                let Some(name) = self.names.name_of(symbol) else {
                    continue;
                };
                match before.remove(&name) {
                    None => changed.push((name, true)),
                    Some((known, signature)) => {
                        let same = known == symbol
                            && self.names.signature(symbol).as_ref() == Some(&signature);
                        if !same {
                            changed.push((name, false));
                        }
                    }
                }
            }
        }
        changed.extend(before.into_keys().map(|name| (name, false)));
        for (name, is_new) in changed {
            let users = self.names.users(name);
            let open = self.names.open_to(name).filter(|_| is_new);
            for chunk in users.chain(open.map(|(chunk, _)| chunk)) {
                let place = self.sequence.rank(chunk);
                if place >= rank {
                    pass.affected.insert(place, chunk);
                }
            }
            pass.touched.insert(name);
        }
    }
}

/// What is known while an edit goes on.
#[derive(Debug, Default)]
struct Pass {
    /// What the chunks declared that are being read, by name.
    before: HashMap<NameId, (SymbolId, Signature)>,
    /// The symbols that are not declared at the moment, by name.
    pool: HashMap<String, SymbolId>,
    /// The names for whose letters splits are to be looked for.
    touched: BTreeSet<NameId>,
    /// The chunks to be read again, from top to bottom.
    affected: BTreeMap<u32, ChunkId>,
    /// How many chunks stand above what is new.
    above: u32,
    removed: Vec<ChunkId>,
    read: Vec<ChunkId>,
}

fn check_size(length: usize) -> Result<(), EditError> {
    match u32::try_from(length) {
        Ok(length) if length < u32::MAX => Ok(()),
        _ => Err(EditError::TooLarge),
    }
}
