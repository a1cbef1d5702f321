//! Assembles declarations that have already been read, without lexing or parsing, in time proportional to them.
//!
//! In: declarations as read by the incremental document, from top to bottom; they may be from different versions of a
//! text. Out: the state of the compiler as after parsing them, and whether each of them has a meaning there. Symbols are
//! found by name, because each version of a text numbers them independently.

use rustc_hash::FxHashMap;
use syntax::diagnostic::Severity;
use syntax::geotrace::actions::{self, Actions, Declaration, Operator, StatedAttribute};
use syntax::geotrace::document::{ParseEvent, ParseEvents, ReadDeclaration, Snapshot};
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geotrace::builtin;
use crate::geotrace::code::with_symbol;
use crate::geotrace::declarations::{Declarations, Understood};
use crate::geotrace::symbol::Meaning;

/// A symbol without a definition.
pub(crate) const MEANINGLESS: SymbolId = SymbolId(u32::MAX);

/// The compiler, driven by recorded declarations.
#[derive(Debug)]
pub(crate) struct Assembler<'s> {
    pub(crate) declarations: Declarations,
    names: FxHashMap<&'s str, Named>,
    /// The number of builtin names; their symbols come first in every version of a text.
    builtins: u32,
    next: u32,
}

/// A name with a meaning.
#[derive(Clone, Copy, Debug)]
struct Named {
    symbol: SymbolId,
    is_stale: bool,
}

/// A declaration from a version of a text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading<'s> {
    pub(crate) snapshot: &'s Snapshot,
    pub(crate) declaration: ReadDeclaration<'s>,
    /// Its steps and intervals.
    pub(crate) events: ParseEvents<'s>,
}

/// The span of an assembled declaration's name.
#[derive(Clone, Copy, Debug)]
pub(crate) enum NamePlace {
    /// Its span in its chunk, which starts at this offset.
    Chunk(u32),
    /// This span, whose text it replaces.
    Instead(Span),
}

/// A declaration that has been assembled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Assembled {
    /// True if it is drawn.
    pub(crate) is_drawn: bool,
    /// True if it replaces another, or depends on one that does.
    pub(crate) is_stale: bool,
}

impl<'s> Reading<'s> {
    /// Returns the names of the symbols in its expressions, including builtins.
    pub(crate) fn symbols(self) -> impl Iterator<Item = SymbolId> + use<'s> {
        self.events.filter_map(|event| match event {
            ParseEvent::Operator(Operator::Constant(symbol) | Operator::Function(symbol), _) => {
                Some(symbol)
            }
            _ => None,
        })
    }
}

impl<'s> Assembler<'s> {
    /// Creates an assembler with only the builtins.
    pub(crate) fn new() -> Self {
        Self {
            declarations: Declarations::new(),
            names: FxHashMap::default(),
            builtins: builtin::count(),
            next: builtin::count(),
        }
    }

    /// Returns the symbol of a name that has a meaning and is not builtin.
    pub(crate) fn symbol(&self, name: &str) -> Option<SymbolId> {
        Some(self.names.get(name)?.symbol)
    }

    /// Adds a declaration below the ones already added. Returns `None` and adds nothing if it has no meaning there: it has
    /// an error, its name is taken, or it uses a name without a meaning.
    pub(crate) fn add(&mut self, reading: Reading<'s>, place: NamePlace) -> Option<Assembled> {
        let read = reading.declaration;
        let mut is_stale = matches!(place, NamePlace::Instead(_));
        // A replacement has the span of the text that it replaces.
        let placed = |span: Span| match place {
            NamePlace::Chunk(start) => span.moved(start),
            NamePlace::Instead(place) => place,
        };
        let mut is_sound = read.symbol.is_some() && !self.names.contains_key(read.name);
        for event in reading.events {
            match event {
                ParseEvent::Operator(operator, span) => {
                    let operator = with_symbol(operator, |symbol| {
                        if symbol.0 < self.builtins {
                            return symbol;
                        }
                        let named = self.resolve(reading.snapshot, operator, symbol);
                        is_sound &= named.is_some();
                        is_stale |= named.is_some_and(|named| named.is_stale);
                        named.map_or(MEANINGLESS, |named| named.symbol)
                    });
                    self.declarations.act_operator(operator, placed(span));
                }
                ParseEvent::Interval(interval) => {
                    self.declarations.act_interval(moved(interval, placed));
                }
                ParseEvent::Attribute(attribute, value) => {
                    let attribute = moved_attribute(attribute, placed);
                    self.declarations.act_attribute(attribute, value);
                }
                ParseEvent::Declaration(_) | ParseEvent::Open(..) | ParseEvent::Diagnostic => {}
            }
        }
        let symbol = SymbolId(self.next);
        let mut parameters = read.parameters.moved(0);
        for parameter in &mut parameters {
            parameter.span = placed(parameter.span);
        }
        let declaration = Declaration {
            symbol: Some(symbol),
            span: placed(read.span),
            name_span: placed(read.name_span),
            faulty: read.faulty || !is_sound,
            ..read.as_declaration(&parameters)
        };
        let understood = self.declarations.understand(&declaration);
        // A symbol is used only once, because the results for its bodies are stored under it.
        self.next += 1;
        if !is_understood(&understood) || self.is_full() {
            return None;
        }
        let is_drawn = understood.drawn.is_some();
        self.declarations.add(&declaration, understood);
        self.names.insert(read.name, Named { symbol, is_stale });
        Some(Assembled { is_drawn, is_stale })
    }

    /// Returns the present meaning of a declared symbol, if it is still of the same kind: a constant, or applied.
    fn resolve(&self, snapshot: &Snapshot, operator: Operator, symbol: SymbolId) -> Option<Named> {
        let named = *self.names.get(&*snapshot.symbol(symbol)?.name)?;
        let meaning = self.declarations.lowerer.symbols.meaning(named.symbol);
        let is_constant = matches!(meaning, Meaning::Constant(_));
        (is_constant == matches!(operator, Operator::Constant(_))).then_some(named)
    }

    /// Returns true if the graph has no room for more expressions; results since then are unreliable.
    pub(crate) fn is_full(&self) -> bool {
        self.declarations.lowerer.graph.overflowed()
    }
}

/// Returns an interval with its spans moved.
pub(crate) fn moved(
    interval: actions::Interval,
    placed: impl Fn(Span) -> Span,
) -> actions::Interval {
    actions::Interval {
        kind: interval.kind,
        span: placed(interval.span),
        tag: interval.tag.map(|(at, span)| (at, placed(span))),
    }
}

/// Returns an attribute with its spans moved.
pub(crate) fn moved_attribute(
    attribute: StatedAttribute,
    placed: impl Fn(Span) -> Span,
) -> StatedAttribute {
    StatedAttribute {
        word: attribute.word,
        word_span: placed(attribute.word_span),
        value_span: placed(attribute.value_span),
    }
}

/// Returns true if a declaration has a meaning and no error.
fn is_understood(understood: &Understood) -> bool {
    let mut found = understood.diagnostics.iter();
    understood.meaning.is_some() && found.all(|found| found.severity != Severity::Error)
}
