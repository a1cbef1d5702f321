//! The scene of a text with errors.
//!
//! ```text
//! text ──▶ checker ──▶ which declarations have errors       diagnostics: always those of compiling the text
//!                            │
//!                            ▼
//! each declaration, from top to bottom, is the first of these that has a meaning given those above it:
//!     its own reading, if it has no error ──▶ its last good reading ──▶ nothing (the scene is incomplete)
//!                            │
//!                            ▼
//!                     a scene, and what is stale in it
//! ```
//!
//! To the checker, a declaration with an error has no meaning, and its uses are not reported. Here it keeps its last
//! meaning. Meanings cannot be carried over, because they are built from others that may have changed; *readings* can:
//! the parser's results for the declaration when it was last shown without an error. So declarations that depend on a
//! stale meaning are lowered with it, and none of that is reported. The scene is that of a text in which each faulty
//! declaration is replaced by its last good text, with the names as read then; but no text is assembled or parsed.
//!
//! - A last good reading is found by the name of the declaration. If the name cannot be read, the word after the declaration's
//!   first word is used.
//! - A declaration that no longer exists is restored before the first last good reading that uses it.
//! - A declaration is good if it was shown as written. A declaration that reads a stale meaning can thus become good itself.
//! - The readings of the last text without errors are stored as one snapshot, which shares unchanged parts with the
//!   document; declarations that became good later have their own snapshots.
//!
//! An attempt that fails may leave nodes in the graph, and uses a symbol. If one has failed, the declarations that are
//! known to work are assembled once more, so that the scene does not depend on the attempts.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use syntax::document::ChunkId;
use syntax::geotrace::document::Snapshot;
use syntax::span::Span;

use crate::geotrace::assembler::{Assembled, Assembler, NamePlace, Reading};
use crate::program_scene::ProgramScene;
use crate::scene::Scene;

/// The maximum number of attempts, each of which excludes one more declaration that cannot be in the scene.
const ROUNDS: usize = 12;

/// The last good reading of each declaration.
#[derive(Clone, Debug, Default)]
pub(super) struct LastGood {
    /// The last text without errors.
    whole: Option<(Snapshot, u64)>,
    /// The declarations that became good since then, by name.
    since: HashMap<Box<str>, Good>,
}

/// A declaration of a text that had errors elsewhere.
#[derive(Clone, Debug)]
struct Good {
    snapshot: Snapshot,
    chunk: ChunkId,
}

/// The scene shown for a text.
#[derive(Clone, Debug)]
pub(super) struct Shown {
    pub(super) program: ProgramScene,
    /// True if the text has no errors.
    is_whole: bool,
    /// For a text with errors: the declarations that are shown as written.
    own: Vec<(Box<str>, ChunkId)>,
}

impl Shown {
    /// Returns the shown scene of a text without errors.
    pub(super) fn whole(scene: Scene) -> Self {
        Self {
            program: ProgramScene {
                scene: Some(Arc::new(scene)),
                ..ProgramScene::default()
            },
            is_whole: true,
            own: Vec::new(),
        }
    }

    fn nothing() -> Self {
        Self {
            program: ProgramScene::default(),
            is_whole: false,
            own: Vec::new(),
        }
    }
}

impl LastGood {
    /// Records the declarations that were shown for a text, which is about to change.
    pub(super) fn note(&mut self, text: &syntax::geotrace::document::Document, shown: Shown) {
        if shown.is_whole {
            self.whole = Some((text.snapshot(), text.version()));
            self.since.clear();
        }
        for (name, chunk) in shown.own {
            let is_known = match (self.since.get(&name), &self.whole) {
                (Some(good), _) => {
                    let version = good.snapshot.chunk_version(good.chunk);
                    good.chunk == chunk && version == text.chunk_version(chunk)
                }
                (None, Some((_, version))) => text.chunk_version(chunk) <= *version,
                (None, None) => false,
            };
            if !is_known {
                let snapshot = text.snapshot();
                self.since.insert(name, Good { snapshot, chunk });
            }
        }
    }

    /// Assembles the scene of a text with errors in these chunks.
    pub(super) fn show(&self, text: &Snapshot, faulty: &HashSet<ChunkId>) -> Shown {
        let chunks = text.chunks();
        let declared: HashSet<&str> = chunks.flat_map(|chunk| names(text, chunk)).collect();
        let mut rejected = HashSet::new();
        for round in 1..=ROUNDS {
            let attempt = Recovery {
                last_good: self,
                text,
                faulty,
                declared: &declared,
                rejected: &rejected,
                is_last: round == ROUNDS,
                assembler: Assembler::new(),
                parts: Vec::new(),
                put_back: HashSet::new(),
                has_failed: false,
                shown: Shown::nothing(),
            };
            match attempt.run() {
                Ok(shown) => return shown,
                Err(candidate) => rejected.insert(candidate),
            };
        }
        Shown::nothing()
    }

    /// Returns the last good reading of a declaration.
    fn reading(&self, name: &str) -> Option<Reading<'_>> {
        let (snapshot, chunk) = match (self.since.get(name), &self.whole) {
            (Some(good), _) => (&good.snapshot, good.chunk),
            (None, Some((whole, _))) => (whole, whole.home(whole.named(name)?)?),
            (None, None) => return None,
        };
        let mut all = snapshot.events(chunk).declarations();
        let (declaration, events) = all.find(|(declaration, _)| declaration.name == name)?;
        Some(Reading {
            snapshot,
            declaration,
            events,
        })
    }
}

/// A declaration's own reading, or its last good one.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
struct Candidate<'s> {
    name: &'s str,
    /// The chunk in place of which it is shown.
    home: ChunkId,
    is_own: bool,
}

/// One pass down a text with errors.
#[derive(Debug)]
struct Recovery<'a, 's> {
    last_good: &'s LastGood,
    text: &'s Snapshot,
    faulty: &'s HashSet<ChunkId>,
    /// The names declared in the text, with or without errors.
    declared: &'s HashSet<&'s str>,
    /// Candidates for which the graph has no room, or that have no meaning even with all restored declarations.
    rejected: &'a HashSet<Candidate<'s>>,
    /// True if no further attempt follows.
    is_last: bool,
    assembler: Assembler<'s>,
    /// The readings that have a meaning, in order.
    parts: Vec<(Reading<'s>, NamePlace)>,
    /// The declarations that have been restored, or would have been.
    put_back: HashSet<&'s str>,
    has_failed: bool,
    shown: Shown,
}

impl<'s> Recovery<'_, 's> {
    /// Returns the scene, or the candidate that the next attempt must exclude.
    fn run(mut self) -> Result<Shown, Candidate<'s>> {
        let text = self.text;
        let mut start = 0;
        for chunk in text.chunks() {
            let end = start + text.chunk_text(chunk).len() as u32;
            let instead = NamePlace::Instead(Span::new(start, end));
            if self.faulty.contains(&chunk) {
                let names = names(text, chunk);
                self.shown.program.incomplete |= names.is_empty();
                for name in names {
                    self.stand_in(name, chunk, instead)?;
                }
            } else {
                for (declaration, events) in text.events(chunk).declarations() {
                    let own = Reading {
                        snapshot: text,
                        declaration,
                        events,
                    };
                    if self.add(own, chunk, NamePlace::Chunk(start))? {
                        let name = declaration.name.into();
                        self.shown.own.push((name, chunk));
                    } else {
                        self.stand_in(declaration.name, chunk, instead)?;
                    }
                }
            }
            start = end;
        }
        if self.has_failed {
            self.assembler = Assembler::new();
            for (reading, place) in &self.parts {
                self.assembler.add(*reading, *place);
            }
        }
        let scene = self.assembler.declarations.scene();
        let parts: HashSet<&str> = scene.parts.iter().map(|part| &*part.name).collect();
        let is_shown = |name: &String| !parts.contains(&**name);
        self.shown.program.stale.retain(is_shown);
        self.shown.program.scene = Some(Arc::new(scene));
        Ok(self.shown)
    }

    /// Adds the last good reading of a declaration, preceded by the readings that it uses and that no longer exist.
    fn stand_in(
        &mut self,
        name: &'s str,
        home: ChunkId,
        place: NamePlace,
    ) -> Result<(), Candidate<'s>> {
        let candidate = Candidate {
            name,
            home,
            is_own: false,
        };
        if self.rejected.contains(&candidate) {
            self.shown.program.incomplete = true;
            return Ok(());
        }
        let above = self.parts.len();
        // Not recursive: restored declarations may require others, through a whole program.
        let mut open = vec![(name, false)];
        let mut is_shown = false;
        while let Some((wanted, is_prepared)) = open.pop() {
            let is_put_back = !self.declared.contains(wanted);
            if is_put_back && !is_prepared && !self.put_back.insert(wanted) {
                continue;
            }
            let Some(reading) = self.last_good.reading(wanted) else {
                continue;
            };
            if is_prepared {
                // The last one is the requested one.
                is_shown = self.add(reading, home, place)?;
                continue;
            }
            open.push((wanted, true));
            let used = reading.symbols().filter_map(|symbol| {
                reading.snapshot.home(symbol)?;
                Some(&*reading.snapshot.symbol(symbol)?.name)
            });
            let used: Vec<&'s str> = used.collect();
            for missing in used.into_iter().rev() {
                if !self.declared.contains(missing) {
                    open.push((missing, false));
                }
            }
        }
        self.shown.program.incomplete |= !is_shown;
        if !is_shown && self.parts.len() > above && !self.is_last {
            // Nothing is restored for a declaration that is not shown.
            return Err(candidate);
        }
        Ok(())
    }

    /// Adds a declaration, and returns whether it has a meaning here.
    fn add(
        &mut self,
        reading: Reading<'s>,
        home: ChunkId,
        place: NamePlace,
    ) -> Result<bool, Candidate<'s>> {
        let name = reading.declaration.name;
        let candidate = Candidate {
            name,
            home,
            is_own: matches!(place, NamePlace::Chunk(_)),
        };
        if self.rejected.contains(&candidate) {
            return Ok(false);
        }
        let Some(Assembled { is_drawn, is_stale }) = self.assembler.add(reading, place) else {
            self.has_failed = true;
            return match self.assembler.is_full() {
                true => Err(candidate),
                false => Ok(false),
            };
        };
        self.parts.push((reading, place));
        if is_drawn && is_stale {
            self.shown.program.stale.push(name.to_owned());
        }
        Ok(true)
    }
}

/// Returns the names that a chunk declares, empty for a name that was not read. If no name was read, returns the word
/// after its first word.
fn names(text: &Snapshot, chunk: ChunkId) -> Vec<&str> {
    let read = text.events(chunk).declarations();
    let names: Vec<&str> = read.map(|(declaration, _)| declaration.name).collect();
    if names.iter().any(|name| !name.is_empty()) {
        return names;
    }
    let lines = text.chunk_text(chunk).lines();
    let code = lines.map(|line| line.split('#').next().unwrap_or(""));
    let words = code.flat_map(|line| line.split(|c: char| !c.is_ascii_alphanumeric()));
    let name = words.filter(|word| !word.is_empty()).nth(1);
    let name = name.filter(|name| name.starts_with(|c: char| c.is_ascii_alphabetic()));
    name.into_iter().collect()
}
