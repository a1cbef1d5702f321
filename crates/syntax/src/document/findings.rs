//! The diagnostics of a document: those of its chunks, finished with what they tell of other places, and
//! those that compare a chunk with what stands below it.

use std::ops::ControlFlow;

use super::Document;
use super::chunk::count_lines;
use super::names::NameId;
use super::open_words::Lookup;
use super::sequence::{ChunkId, Measure};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::geotrace::parser::MAX_DIAGNOSTICS;
use crate::geotrace::parser::elsewhere::Surroundings;
use crate::geotrace::parser::readings::hidden_split;
use crate::span::Span;
use crate::spelling::Search;
use crate::symbol::SymbolId;
use crate::trie::Trie;

/// Where the letters of a name are split above its declaration.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct HiddenSplit {
    chunk: ChunkId,
    /// In the chunk: where the token starts and where it ends.
    start: u32,
    end: u32,
}

impl Document {
    /// Everything the parser has found, in the order of the text: what
    /// [`parse_program`](crate::geotrace::parse_program) finds, sorted by place.
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut all = Vec::new();
        if self.is_overfull() {
            self.each_limited(|_, diagnostic| all.push(diagnostic));
            Diagnostic::sort(&mut all);
            return all;
        }
        for chunk in self.diagnosed() {
            all.extend(self.diagnostics_of(chunk));
        }
        all
    }

    /// The chunks in which the parser has found something, from top to bottom.
    pub fn diagnosed(&self) -> Vec<ChunkId> {
        let mut chunks = Vec::new();
        let mut next = 0;
        while next < self.sequence.total().findings
            && let Some((chunk, before)) = self.sequence.at_finding(next)
        {
            chunks.push((before.chunks, chunk));
            next = before.findings + self.chunk(chunk).findings.len() as u32;
        }
        for symbol in self.hidden.keys() {
            let home = self.names.get(*symbol).and_then(|defined| defined.home);
            chunks.extend(home.map(|home| (self.sequence.rank(home), home)));
        }
        chunks.sort_unstable();
        chunks.dedup();
        chunks.into_iter().map(|(_, chunk)| chunk).collect()
    }

    /// What the parser has found in one chunk, sorted by place. The limit of diagnostics for a text is
    /// disregarded.
    pub fn diagnostics_of(&self, chunk: ChunkId) -> Vec<Diagnostic> {
        let mut all = self.findings_of(chunk);
        all.extend(self.hidden_of(chunk));
        Diagnostic::sort(&mut all);
        all
    }

    /// The parser's diagnostics of a chunk in the order in which it gives them: one for each
    /// [`Event::Finding`](super::Event::Finding).
    pub fn findings_of(&self, chunk: ChunkId) -> Vec<Diagnostic> {
        let read = self.chunk(chunk);
        if read.findings.is_empty() {
            return Vec::new();
        }
        let around = Around {
            document: self,
            chunk,
            before: self.sequence.before(chunk),
        };
        let mut searches = around.before.searches as usize;
        let findings = read.findings.iter().map(|finding| {
            let mut diagnostic = finding.diagnostic.clone().moved(around.before.bytes);
            if let Some(elsewhere) = &finding.elsewhere {
                elsewhere.complete(&mut diagnostic, &around, searches);
                searches += usize::from(elsewhere.is_search());
            }
            diagnostic
        });
        findings.collect()
    }

    /// The warnings about the names of a chunk whose letters are split above.
    pub fn hidden_of(&self, chunk: ChunkId) -> Vec<Diagnostic> {
        if self.hidden.is_empty() {
            return Vec::new();
        }
        let symbols = self.chunk(chunk).defines();
        symbols
            .filter_map(|symbol| self.hidden_warning(symbol))
            .collect()
    }

    /// There are more diagnostics than are given for a text.
    pub fn is_overfull(&self) -> bool {
        self.sequence.total().findings as usize + self.hidden.len() >= MAX_DIAGNOSTICS
    }

    /// The diagnostics that are given for a text with too many, each with its chunk, in the order in which the
    /// parser gives them.
    fn each_limited(&self, mut give: impl FnMut(ChunkId, Diagnostic)) {
        let mut count = 0;
        let mut offer = |chunk, diagnostic: Diagnostic| {
            count += 1;
            if count < MAX_DIAGNOSTICS {
                give(chunk, diagnostic);
                return ControlFlow::Continue(());
            }
            let message = format!("more than {MAX_DIAGNOSTICS} findings: the rest is left out");
            let last = Diagnostic::error(codes::TOO_MANY_ERRORS, diagnostic.span, message);
            give(chunk, last);
            ControlFlow::Break(())
        };
        for chunk in self.sequence.from(self.sequence.first()) {
            for diagnostic in self.findings_of(chunk) {
                if offer(chunk, diagnostic).is_break() {
                    return;
                }
            }
        }
        let place = |split: &HiddenSplit| self.sequence.before(split.chunk).bytes + split.start;
        let mut hidden: Vec<_> = self.hidden.iter().collect();
        hidden.sort_by_key(|(symbol, split)| {
            let length = self.names.get(**symbol).map(|it| it.symbol.name.len());
            (place(split), length)
        });
        for (symbol, _) in hidden {
            let home = self.names.get(*symbol).and_then(|defined| defined.home);
            if let (Some(home), Some(warning)) = (home, self.hidden_warning(*symbol))
                && offer(home, warning).is_break()
            {
                return;
            }
        }
    }

    fn hidden_warning(&self, id: SymbolId) -> Option<Diagnostic> {
        let split = self.hidden.get(&id)?;
        let defined = self.names.get(id)?;
        let place = self.place(id)?;
        let before = self.sequence.before(split.chunk);
        let text = &self.chunk(split.chunk).text;
        let token = &text[split.start as usize..split.end as usize];
        let line = before.lines + count_lines(&text[..split.start as usize]) + 1;
        let name = &defined.symbol.name;
        let start = before.bytes + split.start;
        let there = Span::new(start, start + name.len() as u32);
        Some(hidden_split(name, place, token.len(), there, line))
    }

    /// Looks again for a split above of the letters of a name.
    pub(super) fn find_hidden(&mut self, name: NameId) {
        let Some(id) = self.names.declared(name) else {
            return;
        };
        let found = self.first_split(id, name);
        match found {
            Some(split) => self.hidden.insert(id, split),
            None => self.hidden.remove(&id),
        };
    }

    fn first_split(&self, id: SymbolId, name: NameId) -> Option<HiddenSplit> {
        let defined = self.names.get(id)?;
        let home = defined.home?;
        let declared_at = (self.sequence.rank(home), defined.symbol.name_span?.start);
        let name = self.names.text(name);
        let open = self.open.of(self.names.text(defined.name()));
        let splitting = open.filter(|(_, is_split)| *is_split);
        let ranked = splitting.map(|(chunk, _)| (self.sequence.rank(chunk), chunk));
        let (rank, chunk) = ranked.min()?;
        let read = self.chunk(chunk);
        let splits = read.lookups.iter().filter_map(|lookup| match *lookup {
            Lookup::Open {
                start,
                end,
                length,
                is_split: true,
            } if (length as usize) < name.len()
                && read.text[start as usize..end as usize].starts_with(name) =>
            {
                Some(HiddenSplit {
                    chunk,
                    start,
                    end: start + length,
                })
            }
            _ => None,
        });
        splits
            .min_by_key(|split| split.start)
            .filter(|split| (rank, split.start) < declared_at)
    }
}

/// The document as one of its chunks sees it.
struct Around<'d> {
    document: &'d Document,
    chunk: ChunkId,
    before: Measure,
}

impl Surroundings for Around<'_> {
    fn line(&self, offset: u32) -> u32 {
        let text = &self.document.chunk(self.chunk).text;
        self.before.lines + count_lines(&text[..offset as usize]) + 1
    }

    fn declaration(&self, symbol: SymbolId) -> Option<(&str, &'static str, Span, u32)> {
        let span = self.document.place(symbol)?;
        let symbol = &self.document.names.get(symbol)?.symbol;
        let line = self.document.line(span.start);
        Some((&symbol.name, symbol.word?.text(), span, line))
    }

    fn declared_below(&self, name: &str, offset: u32) -> Option<(Span, u32)> {
        let document = self.document;
        let ranked = document
            .names
            .declaring(name)
            .map(|chunk| (document.sequence.before(chunk), chunk));
        let (before, chunk) = ranked.max_by_key(|(before, _)| before.chunks)?;
        let read = document.chunk(chunk);
        let (_, last) = read.declared().find(|(declared, _)| *declared == name)?;
        let start = before.bytes + last;
        if start <= self.before.bytes + offset {
            return None;
        }
        let line = before.lines + count_lines(&read.text[..last as usize]) + 1;
        Some((Span::new(start, start + name.len() as u32), line))
    }

    fn nearest(&self, parameters: Option<&Trie<u32>>, word: &str, offset: u32) -> Option<String> {
        let (names, sequence) = (&self.document.names, &self.document.sequence);
        Search::nearest(word, |search| {
            if let Some(parameters) = parameters {
                search.among(parameters, |_| true);
            }
            names.search(search, sequence, self.chunk, offset);
        })
    }
}
