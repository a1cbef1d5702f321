//! Checks declarations one at a time, in the order in which they are edited.
//!
//! In: the events of a chunk. Out: its diagnostics, and the symbols whose meaning has changed.
//!
//! A meaning is never replaced: a declaration that is checked again gets a new symbol, so that lowered bodies remain
//! valid, and the declarations that read the old symbol are checked again in turn. If the new meaning equals the old one
//! (the same nodes, since equal expressions share a node; or the same steps), the old symbol remains and no other
//! declaration is checked. Unused meanings are kept until they outnumber the used ones; then the document starts again
//! with an empty checker.
//!
//! Positions are offsets into a space in which each checked chunk gets a range of its own that is never reused.
//! [`Checker::translate`] converts them to offsets of the text.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;
use syntax::diagnostic::{Code, Diagnostic};
use syntax::document::ChunkId;
use syntax::geotrace::actions::Declaration;
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::document::{ParseEvent, ReadDeclaration};
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geotrace::assembler::{MEANINGLESS, moved, moved_attribute};
use crate::geotrace::code::with_symbol;
use crate::geotrace::declarations::{Declarations, Drawn, SourceData, Uniforms};
use crate::geotrace::error;
use crate::geotrace::symbol::Meaning;
use crate::scene::{Object, Range, Sampling, Shape};

/// Checks declarations and stores their meanings.
#[derive(Clone, Debug)]
pub(super) struct Checker {
    declarations: Declarations,
    /// The number of builtin names; their symbols come first, both in the document and here.
    builtins: u32,
    /// The next symbol of the checker.
    next_symbol: u32,
    /// The symbols of the document.
    known: FxHashMap<SymbolId, Known>,
    /// The document's symbols of the params and the grids of the checker's scene.
    params: Vec<SymbolId>,
    grids: Vec<SymbolId>,
    /// The document's symbols of the sources of dependencies.
    sources: Vec<SymbolId>,
    /// The start of the next chunk's range in the space of positions.
    next_base: u32,
    bases: BTreeMap<u32, Home>,
    /// The size when everything was in use.
    fresh: Size,
}

/// A symbol of the document.
#[derive(Clone, Debug)]
struct Known {
    keyword: DeclarationKeyword,
    /// The checker's symbol.
    own: SymbolId,
    chunk: ChunkId,
    /// The start of the chunk's range when its body was stored.
    base: u32,
    /// For a param or a grid: its uniforms and intervals. Few symbols have them.
    source: Option<Box<KnownSource>>,
}

/// A param or a grid of the document.
#[derive(Clone, Debug)]
struct KnownSource {
    uniforms: Uniforms,
    data: Data,
}

/// The intervals of a param or a grid, and the initial value of a param.
#[derive(Clone, Debug, PartialEq)]
enum Data {
    Param(Vec<Range>, Vec<f64>),
    Grid(Vec<Sampling>),
}

impl Known {
    fn uniforms(&self) -> Option<Uniforms> {
        Some(self.source.as_ref()?.uniforms)
    }

    fn data(&self) -> Option<&Data> {
        Some(&self.source.as_ref()?.data)
    }
}

/// The chunk that owns a range in the space of positions.
#[derive(Clone, Copy, Debug)]
struct Home {
    chunk: ChunkId,
    /// The difference between an offset in the chunk and a position.
    shift: i64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Size {
    nodes: usize,
    symbols: usize,
    places: usize,
}

/// The result of checking a chunk.
#[derive(Clone, Debug, Default)]
pub(super) struct Checked {
    /// The diagnostics of each declaration.
    pub(super) diagnostics: Vec<Vec<Diagnostic>>,
    /// The document's symbols whose meaning has changed.
    pub(super) changed: Vec<SymbolId>,
    /// Params and grids for which only the intervals or the initial value have changed.
    pub(super) moved: Vec<SymbolId>,
    /// The params and grids on whose intervals or initial values the diagnostics depend.
    pub(super) watches: Vec<SymbolId>,
    /// True if the diagnostics may depend on every grid.
    pub(super) watches_all: bool,
    /// The starts of the ranges that contain the chunk's positions.
    pub(super) bases: Vec<u32>,
    /// The number of drawn samples.
    pub(super) samples: u64,
    /// The number of leaves of its solids, including their instances.
    pub(super) leaves: u64,
    /// The number of backgrounds.
    pub(super) backgrounds: u32,
    /// The number of components of its params and grids.
    pub(super) components: u32,
    /// The number of declarations that were lowered.
    pub(super) lowered: u32,
    /// True if a limit that depends on all declarations above has been reached.
    pub(super) is_limited: bool,
}

/// The number of unused expressions that may be kept, and the number of unused blocks of 64 positions.
const SLACK: usize = 50_000;
/// The number of unused symbols that may be kept. Each has steps, positions and a meaning, usually half a kilobyte.
const SLACK_SYMBOLS: usize = 4_000;

impl Checker {
    pub(super) fn new() -> Self {
        let mut declarations = Declarations::new();
        declarations.is_checker = true;
        declarations.lowerer.dependencies.place(Vec::new());
        let builtins = declarations.lowerer.symbols.len() as u32;
        Self {
            builtins,
            next_symbol: builtins,
            declarations,
            known: FxHashMap::default(),
            params: Vec::new(),
            grids: Vec::new(),
            sources: Vec::new(),
            next_base: 0,
            bases: BTreeMap::new(),
            fresh: Size::default(),
        }
    }

    /// Records that everything stored is in use.
    pub(super) fn settle(&mut self) {
        self.fresh = self.size();
    }

    /// Returns true if so much of it is unused that a new checker is worth its cost.
    pub(super) fn needs_compaction(&self) -> bool {
        let (now, fresh) = (self.size(), self.fresh);
        // The slack grows with the program, so that the amortised cost of starting again remains constant.
        let exceeds = |now: usize, fresh: usize, slack: usize| now > fresh + fresh / 4 + slack;
        exceeds(now.nodes, fresh.nodes, SLACK)
            || exceeds(now.symbols, fresh.symbols, SLACK_SYMBOLS)
            || exceeds(now.places / 64, fresh.places / 64, SLACK)
    }

    /// Returns true if the graph has no room for more expressions; results since then are unreliable.
    pub(super) fn is_full(&self) -> bool {
        self.declarations.lowerer.graph.overflowed() || self.next_base > u32::MAX / 2
    }

    fn size(&self) -> Size {
        Size {
            nodes: self.declarations.lowerer.graph.len(),
            symbols: self.next_symbol as usize,
            places: self.next_base as usize,
        }
    }

    /// Removes a symbol that is no longer declared.
    pub(super) fn forget(&mut self, symbol: SymbolId) {
        self.known.remove(&symbol);
    }

    /// Frees the ranges of positions with these starts.
    pub(super) fn release(&mut self, bases: &[u32]) {
        for base in bases {
            self.bases.remove(base);
        }
    }

    /// Updates the order of the params and grids from the document.
    pub(super) fn reorder(&mut self, document: &syntax::geotrace::document::Document) {
        let place = |symbol: &SymbolId| {
            let home = document.home(*symbol);
            home.map_or(0, |home| document.rank(home))
        };
        let places = self.sources.iter().map(place).collect();
        self.declarations.lowerer.dependencies.place(places);
    }

    /// Returns a diagnostic with its positions as offsets of the text.
    pub(super) fn translate(
        &self,
        diagnostic: &Diagnostic,
        start: impl Fn(ChunkId) -> u32,
    ) -> Diagnostic {
        diagnostic.clone().mapped(|span| {
            let Some((_, home)) = self.bases.range(..=span.start).next_back() else {
                return span;
            };
            let start = i64::from(start(home.chunk)) + home.shift;
            let place = |at: u32| u32::try_from(i64::from(at) + start).unwrap_or_default();
            Span::new(place(span.start), place(span.end))
        })
    }

    /// Checks the declarations of a chunk, with the present meanings of the names above.
    pub(super) fn check(
        &mut self,
        document: &syntax::geotrace::document::Document,
        chunk: ChunkId,
    ) -> Checked {
        let base = self.next_base;
        self.next_base += document.chunk_text(chunk).len() as u32 + 1;
        let shift = -i64::from(base);
        self.bases.insert(base, Home { chunk, shift });
        let mut checked = Checked {
            bases: vec![base],
            ..Checked::default()
        };
        for event in document.events(chunk) {
            match event {
                ParseEvent::Operator(operator, span) => {
                    let operator = with_symbol(operator, |symbol| self.own(symbol));
                    let code = &mut self.declarations.lowerer.code;
                    code.push(operator, span.moved(base));
                }
                ParseEvent::Interval(interval) => {
                    let interval = moved(interval, |span| span.moved(base));
                    self.declarations.interval(interval);
                }
                ParseEvent::Attribute(attribute, value) => {
                    let attribute = moved_attribute(attribute, |span| span.moved(base));
                    self.declarations.attribute(attribute, value);
                }
                ParseEvent::Declaration(declaration) => {
                    let rank = document.rank(chunk);
                    self.declare(declaration, chunk, rank, base, &mut checked);
                }
                ParseEvent::Open(..) | ParseEvent::Diagnostic => {}
            }
        }
        checked
    }

    fn own(&self, symbol: SymbolId) -> SymbolId {
        if symbol.0 < self.builtins {
            return symbol;
        }
        self.known
            .get(&symbol)
            .map_or(MEANINGLESS, |known| known.own)
    }

    fn declare(
        &mut self,
        read: ReadDeclaration<'_>,
        chunk: ChunkId,
        rank: u32,
        base: u32,
        checked: &mut Checked,
    ) {
        let own = SymbolId(self.next_symbol);
        self.next_symbol += u32::from(read.symbol.is_some());
        let before = read.symbol.and_then(|symbol| self.known.get(&symbol));
        let before = before.cloned();
        let declarations = &mut self.declarations;
        // A declaration is checked as if no other drew anything.
        declarations.samples = 0;
        declarations.leaves = 0;
        // A param that keeps its uniforms keeps its nodes: the expressions of its readers remain unchanged.
        declarations.kept = before
            .as_ref()
            .filter(|before| before.keyword == read.keyword && before.chunk == chunk)
            .and_then(Known::uniforms);
        let parameters = read.parameters.moved(base);
        let declaration = Declaration {
            keyword: read.keyword,
            span: read.span.moved(base),
            symbol: read.symbol.map(|_| own),
            name: read.name,
            name_span: read.name_span.moved(base),
            parameters: &parameters,
            faulty: read.faulty,
        };
        let mut understood = declarations.understand(&declaration);
        declarations.kept = None;
        let diagnostics = std::mem::take(&mut understood.diagnostics);
        let has = |code: Code| diagnostics.iter().any(|found| found.code == code);
        checked.is_limited |= has(error::TOO_MANY_SAMPLES) || has(error::EXPRESSION_TOO_LARGE);
        checked.watches_all |= has(error::TOO_MANY_SAMPLES)
            || has(error::TOO_MANY_INSTANCES)
            || has(error::TOO_MANY_LEAVES);
        checked.diagnostics.push(diagnostics);
        checked.lowered += u32::from(!read.faulty);
        if let Some(drawn) = &understood.drawn {
            checked.samples += drawn.samples;
            checked.leaves += drawn.leaves;
            let is_background = matches!(drawn.object.shape, Shape::Background(_));
            checked.backgrounds += u32::from(is_background);
            // A solid closes at its grids.
            let (_, closed) = declarations.sources_of(drawn.closed);
            let closed = closed.iter().map(|id| self.grids[id.0 as usize]);
            checked.watches.extend(closed);
            if read.symbol.is_some() {
                watch(&drawn.object, &self.params, &self.grids, checked);
            }
        }
        // Later declarations query only objects that geodesics may lie on; others would accumulate with each edit.
        let is_manifold = |drawn: &Drawn| drawn.object.shape.manifold().is_some();
        understood.drawn = understood.drawn.filter(is_manifold);
        let source = understood
            .source
            .as_ref()
            .map(|it| (it.uniforms, it.data.clone(), it.is_fresh));
        self.declarations.add(&declaration, understood);
        let Some(symbol) = read.symbol else { return };

        let source = source.map(|(uniforms, data, is_fresh)| {
            if is_fresh {
                self.sources.push(symbol);
                self.declarations.lowerer.dependencies.place_next(rank);
            }
            Box::new(KnownSource {
                uniforms,
                data: self.data(symbol, data),
            })
        });
        let known = Known {
            keyword: read.keyword,
            own,
            chunk,
            base,
            source,
        };
        checked.components += known.uniforms().map_or(0, |uniforms| uniforms.count);
        self.remember(symbol, before, known, checked);
    }

    /// Records that a param or grid of the checker's scene belongs to this symbol, and returns the part that readers may
    /// depend on.
    fn data(&mut self, symbol: SymbolId, data: SourceData) -> Data {
        match data {
            SourceData::Param(param) => {
                self.params.push(symbol);
                Data::Param(param.ranges, param.initial)
            }
            SourceData::Grid(grid) => {
                self.grids.push(symbol);
                Data::Grid(grid.axes)
            }
        }
    }

    /// Stores a symbol, and records whether its readers have to be checked again.
    fn remember(
        &mut self,
        symbol: SymbolId,
        before: Option<Known>,
        mut known: Known,
        checked: &mut Checked,
    ) {
        let same = before
            .as_ref()
            .and_then(|before| self.same(before, &known, checked));
        match (before, same) {
            (Some(before), Some(shift)) => {
                // The readers' nodes and steps refer to the old symbol, so it remains. A body that has only moved keeps
                // its old positions, which lead to the chunk by another shift from now on.
                known.own = before.own;
                known.base = before.base;
                if let Some(shift) = shift {
                    let home = Home {
                        chunk: known.chunk,
                        shift,
                    };
                    self.bases.insert(before.base, home);
                    if !checked.bases.contains(&before.base) {
                        checked.bases.push(before.base);
                    }
                }
                if before.data() != known.data() {
                    checked.moved.push(symbol);
                }
            }
            _ => checked.changed.push(symbol),
        }
        self.known.insert(symbol, known);
    }

    /// Returns `Some` if the meaning of a symbol is unchanged; for a symbol with a stored body, with the shift from the
    /// positions of that body to offsets in the chunk.
    fn same(&self, before: &Known, now: &Known, checked: &Checked) -> Option<Option<i64>> {
        if before.keyword != now.keyword {
            return None;
        }
        let symbols = &self.declarations.lowerer.symbols;
        match (symbols.meaning(before.own), symbols.meaning(now.own)) {
            (Meaning::Poisoned, Meaning::Poisoned) => Some(None),
            (Meaning::Solid(a), Meaning::Solid(b)) => a.is_same(b).then_some(None),
            (Meaning::Geodesic(a), Meaning::Geodesic(b)) => (a == b).then_some(None),
            (Meaning::Constant(a), Meaning::Constant(b)) => {
                (a.value == b.value && a.dependencies == b.dependencies).then_some(None)
            }
            (Meaning::Declared(a), Meaning::Declared(b)) => {
                let manifold = |own| {
                    let manifold = self.declarations.manifold_of(own);
                    manifold.map(|it| (it.nodes.domain, it.dependencies))
                };
                if before.chunk != now.chunk
                    || a.parameters != b.parameters
                    || manifold(before.own) != manifold(now.own)
                {
                    return None;
                }
                let code = &self.declarations.lowerer.code;
                let shift = code.shift(a.body, b.body)? - i64::from(now.base);
                // Two bodies of one chunk must have the same relative positions as before.
                let settled = checked.bases.contains(&before.base);
                let there = self.bases.get(&before.base).map(|home| home.shift);
                (!settled || there == Some(shift)).then_some(Some(shift))
            }
            _ => None,
        }
    }
}

/// Records the params and grids on whose intervals the diagnostics of an object depend.
fn watch(object: &Object, params: &[SymbolId], grids: &[SymbolId], checked: &mut Checked) {
    let read = object.grids.iter().map(|id| grids[id.0 as usize]);
    checked.watches.extend(read);
    if object.shape.is_metric() {
        let read = object.params.iter().map(|id| params[id.0 as usize]);
        checked.watches.extend(read);
    }
}
