//! A program that is edited: checked declaration by declaration, and only declarations that an edit affects are checked
//! again.
//!
//! ```text
//! edit ──▶ syntax::document   the chunks that were read again
//!          checker.rs         diagnostics of each declaration, and the symbols whose meaning has changed
//!          this file          checks the readers of those symbols in turn, from top to bottom
//!          compilation()      the scene, assembled on request
//!          last_good.rs       the scene of a text with errors
//! ```
//!
//! After every edit, diagnostics and scene equal those of [`compile`] for the text. The diagnostics are updated with
//! each edit. The scene is built from recorded declarations, without lexing or parsing, in time proportional to the
//! program.
//!
//! Some limits apply to a program as a whole: the numbers of samples, leaves, params, backgrounds and operations. A
//! declaration is checked as if it were the only one that counts towards them; if a limit is exceeded, the whole program
//! is compiled for its diagnostics.

mod checker;
mod last_good;

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::sync::OnceLock;

use rustc_hash::FxHashMap;
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::document::{Change, ChunkId, EditError};
use syntax::geotrace::document::{ParseEvent, Snapshot};
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geotrace::assembler::{Assembler, NamePlace, Reading};
use crate::geotrace::builtin;
use crate::geotrace::compile::{Compilation, compile};
use crate::geotrace::error::has_errors;
use crate::geotrace::evaluate::Scope;
use crate::limits::{MAX_LEAVES, MAX_SAMPLES, MAX_UNIFORMS};
use crate::program_scene::ProgramScene;
use crate::scene::Scene;
use checker::{Checked, Checker};
use last_good::{LastGood, Shown};

/// A program's text, its declarations, and their diagnostics.
#[derive(Clone, Debug)]
pub struct Document {
    text: syntax::geotrace::document::Document,
    checker: Checker,
    checked: FxHashMap<ChunkId, CheckedChunk>,
    /// The chunks with diagnostics in addition to the parser's.
    found: HashSet<ChunkId>,
    /// The chunks to be checked again when the intervals of a param or a grid change.
    watchers: FxHashMap<SymbolId, BTreeSet<ChunkId>>,
    watchers_of_all: BTreeSet<ChunkId>,
    totals: Totals,
    counters: Counters,
    compilation: OnceLock<Compilation>,
    last_good: LastGood,
    shown: OnceLock<Shown>,
}

/// The stored results of checking a chunk.
#[derive(Clone, Debug)]
struct CheckedChunk {
    samples: u64,
    components: u32,
    backgrounds: u32,
    /// The start of the chunk's range of positions; further starts are in `rest`.
    base: u32,
    /// The parts that most chunks lack.
    rest: Option<Box<Details>>,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct Details {
    /// The diagnostics of each declaration; empty if there are none.
    diagnostics: Vec<Vec<Diagnostic>>,
    watches: Vec<SymbolId>,
    watches_all: bool,
    is_limited: bool,
    leaves: u64,
    bases: Vec<u32>,
}

impl CheckedChunk {
    fn new(checked: Checked) -> Self {
        let mut bases = checked.bases;
        let base = bases.pop().unwrap_or_default();
        let mut diagnostics = checked.diagnostics;
        if diagnostics.iter().all(Vec::is_empty) {
            diagnostics = Vec::new();
        }
        let rest = Details {
            diagnostics,
            watches: checked.watches,
            watches_all: checked.watches_all,
            is_limited: checked.is_limited,
            leaves: checked.leaves,
            bases,
        };
        Self {
            samples: checked.samples,
            components: checked.components,
            backgrounds: checked.backgrounds,
            base,
            rest: (rest != Details::default()).then(|| Box::new(rest)),
        }
    }

    /// Returns the diagnostics of each declaration; empty if there are none.
    fn diagnostics(&self) -> &[Vec<Diagnostic>] {
        self.rest.as_ref().map_or(&[], |rest| &rest.diagnostics)
    }
}

/// Sums that are limited for a program as a whole.
#[derive(Clone, Copy, Debug, Default)]
struct Totals {
    samples: u64,
    components: u64,
    backgrounds: u64,
    leaves: u64,
    /// The number of chunks that have reached a limit.
    limited: usize,
}

/// The work since the document was created.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Counters {
    /// The parser's part.
    pub reading: syntax::document::ReadCounters,
    /// The number of chunks that were checked.
    pub checked: u64,
    /// The number of declarations that were lowered.
    pub lowered: u64,
    /// The number of times that everything was checked again by a new checker.
    pub renewed: u64,
}

impl Document {
    /// Reads and checks a text.
    ///
    /// # Errors
    /// If the text is too large.
    pub fn new(text: &str) -> Result<Self, EditError> {
        let mut document = Self {
            text: syntax::geotrace::document::Document::new(text, &builtin::vocabulary())?,
            checker: Checker::new(),
            checked: FxHashMap::default(),
            found: HashSet::new(),
            watchers: FxHashMap::default(),
            watchers_of_all: BTreeSet::new(),
            totals: Totals::default(),
            counters: Counters::default(),
            compilation: OnceLock::new(),
            last_good: LastGood::default(),
            shown: OnceLock::new(),
        };
        document.renew();
        Ok(document)
    }

    /// Replaces the bytes of a range.
    ///
    /// # Errors
    /// If the text does not have the range, or would be too large; the document is then unchanged.
    pub fn edit(&mut self, range: Span, text: &str) -> Result<Change, EditError> {
        if let Some(shown) = self.shown.take() {
            self.last_good.note(&self.text, shown);
        }
        let change = self.text.edit(range, text)?;
        self.compilation = OnceLock::new();
        if self.checker.is_full() {
            self.renew();
            return Ok(change);
        }
        for chunk in &change.removed {
            self.drop_checked(*chunk);
        }
        for symbol in &change.forgotten {
            self.checker.forget(*symbol);
        }
        let is_new = |chunk: &ChunkId| !self.checked.contains_key(chunk);
        if !change.removed.is_empty() || change.read.iter().any(is_new) {
            self.checker.reorder(&self.text);
        }
        let read = change.read.iter();
        let queue = read.map(|chunk| (self.text.rank(*chunk), *chunk)).collect();
        self.check(queue);
        if self.checker.needs_compaction() || self.checker.is_full() {
            self.renew();
        }
        Ok(change)
    }

    /// Returns the text with its declarations as read.
    pub fn text(&self) -> &syntax::geotrace::document::Document {
        &self.text
    }

    /// Returns the work since the document was created.
    pub fn counters(&self) -> Counters {
        Counters {
            reading: self.text.counters(),
            ..self.counters
        }
    }

    /// Returns all errors, warnings and hints, sorted by position: the diagnostics of [`compile`].
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        if self.is_beyond_limits() {
            return self.compilation().diagnostics.clone();
        }
        self.own_diagnostics()
    }

    /// Returns the compilation of the text, assembled at the first call after an edit.
    pub fn compilation(&self) -> &Compilation {
        self.compilation.get_or_init(|| {
            if self.is_beyond_limits() {
                return compile(&self.text.text());
            }
            let diagnostics = self.own_diagnostics();
            let program = (!has_errors(&diagnostics)).then(|| self.assemble());
            Compilation::new(diagnostics, program)
        })
    }

    fn is_beyond_limits(&self) -> bool {
        let totals = &self.totals;
        totals.limited > 0
            || totals.samples > MAX_SAMPLES
            || totals.components > u64::from(MAX_UNIFORMS)
            || totals.leaves > MAX_LEAVES
            || totals.backgrounds > 1
            || self.text.is_overfull()
            || self.checker.is_full()
    }

    fn own_diagnostics(&self) -> Vec<Diagnostic> {
        let mut chunks = self.text.diagnosed();
        if !self.found.is_empty() {
            let ranked = |chunk: ChunkId| (self.text.rank(chunk), chunk);
            let mut all: Vec<_> = chunks.iter().copied().map(ranked).collect();
            all.extend(self.found.iter().copied().map(ranked));
            all.sort_unstable();
            all.dedup();
            chunks = all.into_iter().map(|(_, chunk)| chunk).collect();
        }
        let all = chunks.into_iter();
        all.flat_map(|chunk| self.diagnostics_of(chunk)).collect()
    }

    /// Returns the diagnostics of one chunk, sorted by position, as if no limit for the whole program were exceeded.
    pub fn diagnostics_of(&self, chunk: ChunkId) -> Vec<Diagnostic> {
        let mut diagnostics = self.text.diagnostics_of_reading(chunk).into_iter();
        let checked = self.checked.get(&chunk);
        let mut of_declarations = checked.into_iter().flat_map(CheckedChunk::diagnostics);
        let mut all = Vec::new();
        for event in self.text.events(chunk) {
            match event {
                ParseEvent::Diagnostic => all.extend(diagnostics.next()),
                ParseEvent::Declaration(_) => {
                    let found = of_declarations.next().into_iter().flatten();
                    let start = |chunk| self.text.start(chunk);
                    all.extend(found.map(|it| self.checker.translate(it, start)));
                }
                _ => {}
            }
        }
        all.extend(self.text.shadowed_splits_of(chunk));
        Diagnostic::sort(&mut all);
        all
    }

    /// Checks everything again with a new checker.
    fn renew(&mut self) {
        self.checker = Checker::new();
        self.checked.clear();
        self.found.clear();
        self.watchers.clear();
        self.watchers_of_all.clear();
        self.totals = Totals::default();
        self.counters.renewed += 1;
        let chunks: Vec<ChunkId> = self.text.chunks().collect();
        for chunk in chunks {
            let checked = self.checker.check(&self.text, chunk);
            self.keep(chunk, checked);
        }
        self.checker.settle();
    }

    /// Checks chunks, and the chunks below that depend on a changed meaning, from top to bottom.
    fn check(&mut self, mut queue: BTreeMap<u32, ChunkId>) {
        while let Some((rank, chunk)) = queue.pop_first() {
            let checked = self.checker.check(&self.text, chunk);
            let mut affected: Vec<ChunkId> = Vec::new();
            for symbol in &checked.changed {
                affected.extend(self.text.readers(*symbol));
            }
            for symbol in &checked.moved {
                affected.extend(self.watchers.get(symbol).into_iter().flatten());
            }
            if !checked.moved.is_empty() {
                affected.extend(&self.watchers_of_all);
            }
            for chunk in affected {
                let place = self.text.rank(chunk);
                if place > rank {
                    queue.insert(place, chunk);
                }
            }
            self.drop_checked_but(chunk, &checked.bases);
            self.keep(chunk, checked);
        }
    }

    fn keep(&mut self, chunk: ChunkId, checked: Checked) {
        self.counters.checked += 1;
        self.counters.lowered += u64::from(checked.lowered);
        let kept = CheckedChunk::new(checked);
        self.totals.samples += kept.samples;
        self.totals.components += u64::from(kept.components);
        self.totals.backgrounds += u64::from(kept.backgrounds);
        if let Some(rest) = &kept.rest {
            self.totals.leaves += rest.leaves;
            self.totals.limited += usize::from(rest.is_limited);
            for symbol in &rest.watches {
                self.watchers.entry(*symbol).or_default().insert(chunk);
            }
            if rest.watches_all {
                self.watchers_of_all.insert(chunk);
            }
            if !rest.diagnostics.is_empty() {
                self.found.insert(chunk);
            }
        }
        self.checked.insert(chunk, kept);
    }

    fn drop_checked(&mut self, chunk: ChunkId) {
        self.drop_checked_but(chunk, &[]);
    }

    /// Drops the results of checking a chunk; the positions in `kept` remain valid.
    fn drop_checked_but(&mut self, chunk: ChunkId, kept: &[u32]) {
        let Some(checked) = self.checked.remove(&chunk) else {
            return;
        };
        self.totals.samples -= checked.samples;
        self.totals.components -= u64::from(checked.components);
        self.totals.backgrounds -= u64::from(checked.backgrounds);
        let mut bases = vec![checked.base];
        if let Some(rest) = checked.rest {
            self.totals.leaves -= rest.leaves;
            self.totals.limited -= usize::from(rest.is_limited);
            for symbol in &rest.watches {
                if let Some(watchers) = self.watchers.get_mut(symbol) {
                    watchers.remove(&chunk);
                    if watchers.is_empty() {
                        self.watchers.remove(symbol);
                    }
                }
            }
            if rest.watches_all {
                self.watchers_of_all.remove(&chunk);
            }
            self.found.remove(&chunk);
            bases.extend(rest.bases);
        }
        bases.retain(|base| !kept.contains(base));
        self.checker.release(&bases);
    }

    /// Compiles the recorded declarations, as the parser would have passed them to the compiler.
    fn assemble(&self) -> (Scene, Scope) {
        let mut assembler = Assembler::new();
        let snapshot: &Snapshot = &self.text;
        let mut start = 0;
        for chunk in snapshot.chunks() {
            for (declaration, events) in snapshot.events(chunk).declarations() {
                let reading = Reading {
                    snapshot,
                    declaration,
                    events,
                };
                assembler.add(reading, NamePlace::Chunk(start));
            }
            start += snapshot.chunk_text(chunk).len() as u32;
        }
        let mut declarations = assembler.declarations;
        // They are known: an expression that is evaluated in the program has its own.
        declarations.diagnostics.clear();
        let scene = declarations.scene();
        let scope = Scope::new(&self.text.text(), self.text.parsed(), declarations);
        (scene, scope)
    }

    /// Returns the scene of the text. For a text with errors, it contains everything that can be shown, with the last
    /// good version of each faulty declaration. The scene is assembled at the first call after an edit. Declarations
    /// are recorded as good only when the scene has been requested.
    pub fn scene_with_last_good(&self) -> &ProgramScene {
        &self.shown().program
    }

    fn shown(&self) -> &Shown {
        self.shown.get_or_init(|| match &self.compilation().scene {
            Some(scene) => Shown::whole(scene.clone()),
            None => self.last_good.show(&self.text, &self.faulty()),
        })
    }

    /// Returns the chunks with errors.
    fn faulty(&self) -> HashSet<ChunkId> {
        let is_error = |found: &Diagnostic| found.severity == Severity::Error;
        let chunks = self.text.diagnosed().into_iter();
        let mut faulty: HashSet<ChunkId> = chunks
            .filter(|chunk| self.text.errors(*chunk).next().is_some())
            .collect();
        if self.is_beyond_limits() {
            let found = self.compilation().diagnostics.iter();
            let places = found
                .filter(|found| is_error(found))
                .map(|it| it.span.start);
            faulty.extend(places.filter_map(|at| Some(self.text.placed_chunk_at(at)?.chunk)));
        } else {
            let has_error = |chunk: &ChunkId| {
                let checked = self.checked.get(chunk).into_iter();
                checked
                    .flat_map(CheckedChunk::diagnostics)
                    .flatten()
                    .any(is_error)
            };
            faulty.extend(self.found.iter().copied().filter(has_error));
        }
        faulty
    }
}
