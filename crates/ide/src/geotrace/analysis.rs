//! A text as seen by the features: tokens with their meanings, and declarations, by number.
//!
//! ```text
//! text alone ──▶ syntax::document ─┐
//! a document that is edited ───────┴─▶ its snapshot ──▶ GeotraceAnalysis ──▶ tokens, items, targets
//! ```
//!
//! Creating an analysis costs almost nothing, and the cost of a query depends only on its answer: a token or a
//! declaration is found in logarithmic time, the uses of a name in time proportional to their number. Results that
//! require the whole text are computed on the first query: [`GeotraceAnalysis::text`],
//! [`GeotraceAnalysis::compilation`].

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use scene::geotrace::{Compilation, Excerpt};
use syntax::diagnostic::Diagnostic;
use syntax::geotrace::declarations::Category;
use syntax::geotrace::document::{Document, PlacedChunk, Snapshot};
use syntax::geotrace::symbols::Symbol;
use syntax::geotrace::token::{Token, TokenKind};
use syntax::span::Span;
use syntax::symbol::SymbolId;

use super::item::Item;
use super::targets::{ChunkTargets, Target};

/// The analysis of a text. Offsets are bytes of the text.
#[derive(Debug)]
pub struct GeotraceAnalysis {
    document: Snapshot,
    text: OnceLock<String>,
    found: OnceLock<Arc<[Diagnostic]>>,
    compilation: OnceLock<Compilation>,
    /// True for symbols that read a param or a grid, for the symbols queried so far.
    dependent: Mutex<HashMap<SymbolId, bool>>,
}

/// A token with its text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lexeme<'r> {
    /// Its kind.
    pub kind: TokenKind,
    /// Its range.
    pub span: Span,
    /// Its text.
    pub text: &'r str,
}

impl GeotraceAnalysis {
    /// Reads a text.
    pub fn new(text: impl AsRef<str>) -> Self {
        let read = |text| Document::new(text, &scene::geotrace::vocabulary());
        // A text of 4 GiB is not read: there are no results for it.
        let document = read(text.as_ref()).or_else(|_| read(""));
        Self::of(document.expect("an empty text is read").snapshot(), None)
    }

    /// Creates the analysis of a document's snapshot. `found` are its diagnostics, if known.
    pub fn of(document: Snapshot, found: Option<Arc<[Diagnostic]>>) -> Self {
        Self {
            document,
            text: OnceLock::new(),
            found: found.map_or_else(OnceLock::new, OnceLock::from),
            compilation: OnceLock::new(),
            dependent: Mutex::default(),
        }
    }

    /// Returns the snapshot of the document.
    pub fn document(&self) -> &Snapshot {
        &self.document
    }

    /// Returns the whole text, which is assembled on the first query.
    pub fn text(&self) -> &str {
        self.text.get_or_init(|| self.document.text())
    }

    /// Returns the length of the text in bytes.
    pub fn len(&self) -> u32 {
        self.document.len()
    }

    /// Returns true if the text is empty.
    pub fn is_empty(&self) -> bool {
        self.document.is_empty()
    }

    /// Returns the text of a range; empty if the range is outside the text.
    pub fn slice(&self, span: Span) -> String {
        self.document.slice(span).unwrap_or_default()
    }

    /// Returns the number of tokens, including comments.
    pub fn token_count(&self) -> usize {
        self.document.token_count() as usize
    }

    /// Returns a token by its number, from 0.
    pub fn token(&self, token: usize) -> Option<Lexeme<'_>> {
        let (placed, index) = self
            .document
            .placed_chunk_of_token(u32::try_from(token).ok()?)?;
        Some(lexeme(placed, placed.tokens().get(index)?))
    }

    /// Returns tokens by number, in the order of the text.
    pub fn tokens(&self, range: Range<usize>) -> impl Iterator<Item = Lexeme<'_>> {
        let first = u32::try_from(range.start).ok();
        let first = first.and_then(|first| self.document.placed_chunk_of_token(first));
        let skipped = first.map_or(0, |(_, index)| index);
        let placed_chunks = self
            .document
            .placed_chunks_from(first.map(|(placed, _)| placed));
        let all = placed_chunks
            .flat_map(|placed| placed.tokens().iter().map(move |it| lexeme(placed, it)));
        all.skip(skipped).take(range.len())
    }

    /// Returns the tokens before a token, in reverse order.
    pub(crate) fn tokens_before(&self, token: usize) -> impl Iterator<Item = Lexeme<'_>> {
        (0..token.min(self.token_count()))
            .rev()
            .filter_map(|k| self.token(k))
    }

    /// Returns the numbers of the tokens that touch a range.
    pub(crate) fn tokens_in(&self, span: Span) -> Range<usize> {
        let first = self.document.tokens_ended(span.start) as usize;
        let last = self.document.tokens_begun(span.end) as usize;
        first..last.max(first)
    }

    /// Returns the number of declarations.
    pub(crate) fn item_count(&self) -> usize {
        self.document.declaration_count() as usize
    }

    /// Returns a declaration by its number, from 0.
    pub fn item(&self, item: usize) -> Option<Item<'_>> {
        let number = u32::try_from(item).ok()?;
        let (placed, index) = self.document.placed_chunk_of_declaration(number)?;
        let (read, events) = placed.declarations().nth(index)?;
        Some(Item::new(item, placed.start, read, events))
    }

    /// Returns the declarations from a number on, in the order of the text.
    pub(crate) fn items_from(&self, item: usize) -> impl Iterator<Item = Item<'_>> {
        let first = u32::try_from(item).ok();
        let first = first.and_then(|first| self.document.placed_chunk_of_declaration(first));
        let skipped = first.map_or(0, |(_, index)| index);
        let placed_chunks = self
            .document
            .placed_chunks_from(first.map(|(placed, _)| placed));
        let all = placed_chunks.flat_map(|placed| {
            let number = placed.first_declaration as usize..;
            let declarations = number.zip(placed.declarations());
            declarations.map(move |(k, (read, events))| Item::new(k, placed.start, read, events))
        });
        all.skip(skipped)
    }

    /// Returns every declaration, in the order of the text.
    pub fn items(&self) -> impl Iterator<Item = Item<'_>> {
        self.items_from(0)
    }

    /// Returns the declarations that touch a range.
    pub(crate) fn items_in(&self, span: Span) -> impl Iterator<Item = Item<'_>> {
        let first = self.document.declarations_ended(span.start) as usize;
        let from = self.items_from(first);
        from.take_while(move |item| item.span.start < span.end)
    }

    /// Returns a builtin, or a symbol that the text declares; its spans are relative to the start of its chunk.
    pub fn symbol(&self, id: SymbolId) -> Option<&Symbol> {
        self.document.symbol(id)
    }

    /// Returns the span of the name in a symbol's declaration; `None` for a builtin.
    pub fn place(&self, id: SymbolId) -> Option<Span> {
        self.document.place(id)
    }

    /// Returns the compilation of the text, which is computed on the first call.
    pub fn compilation(&self) -> &Compilation {
        self.compilation
            .get_or_init(|| scene::geotrace::compile(self.text()))
    }

    /// Returns the diagnostics of the text.
    pub fn diagnostics(&self) -> &Arc<[Diagnostic]> {
        self.found
            .get_or_init(|| self.compilation().diagnostics.as_slice().into())
    }

    /// Returns an excerpt of some declarations and everything that they use, in time proportional to these: values are
    /// available regardless of errors elsewhere.
    pub fn excerpt(&self, items: impl IntoIterator<Item = usize>) -> Excerpt {
        let numbers = items
            .into_iter()
            .filter_map(|item| u32::try_from(item).ok());
        Excerpt::new(&self.document, numbers)
    }

    /// Returns the symbols that the tokens in a range denote.
    pub(crate) fn symbols_in(&self, span: Span) -> Vec<SymbolId> {
        let tokens = self.tokens(self.tokens_in(span));
        let symbols = tokens.filter_map(|token| match token.kind {
            TokenKind::Constant(id) | TokenKind::Function(id) => Some(id),
            _ => None,
        });
        symbols.collect()
    }

    /// Returns the number of the token at an offset: the token that contains it, or else the word or number that ends
    /// there.
    pub(crate) fn token_at(&self, offset: u32) -> Option<usize> {
        let next = self.document.tokens_ended(offset) as usize;
        let holds = self.token(next).filter(|it| it.span.start <= offset);
        let ends = next.checked_sub(1).and_then(|k| self.token(k));
        let ends = ends.filter(|it| it.span.end == offset);
        let is_word = |it: &Lexeme<'_>| it.text.starts_with(|c: char| c.is_ascii_alphanumeric());
        match (holds, ends) {
            (Some(it), _) if is_word(&it) => Some(next),
            (_, Some(it)) if is_word(&it) => Some(next - 1),
            (Some(_), _) => Some(next),
            (None, Some(_)) => Some(next - 1),
            (None, None) => None,
        }
    }

    /// Returns the declaration that contains an offset, or ends there.
    pub(crate) fn item_at(&self, offset: u32) -> Option<Item<'_>> {
        let begun = self.document.declarations_begun(offset) as usize;
        let item = self.item(begun.checked_sub(1)?)?;
        (offset <= item.span.end).then_some(item)
    }

    /// Returns the last declaration before an offset, if it has not ended with a `;`.
    pub(crate) fn unfinished_item_before(&self, offset: u32) -> Option<Item<'_>> {
        // A declaration that starts at the offset is not before it.
        let begun = self.document.declarations_begun(offset.checked_sub(1)?) as usize;
        let item = self.item(begun.checked_sub(1)?)?;
        let end = item.span.end;
        // A `;` is a chunk's end: distant declarations are closed, and no long text is inspected.
        let rest = self.slice(Span::new(end.saturating_sub(1), offset.max(end)));
        (!rest.contains(';')).then_some(item)
    }

    /// Returns the number of the declaration of a symbol; `None` for a builtin.
    pub fn item_of(&self, symbol: SymbolId) -> Option<usize> {
        self.document.declaration_of(symbol).map(|it| it as usize)
    }

    /// Returns the declaration that defines a name.
    pub fn declared(&self, name: &str) -> Option<Item<'_>> {
        let symbol = self.document.named(name)?;
        self.item(self.item_of(symbol)?)
    }

    /// Returns the meaning of a token, including at its declaration.
    pub fn target(&self, token: usize) -> Option<Target> {
        let (placed, index) = self
            .document
            .placed_chunk_of_token(u32::try_from(token).ok()?)?;
        ChunkTargets::new(placed).target(self, index)
    }

    /// Returns the span where a name is introduced; `None` for a builtin.
    pub(crate) fn introduction(&self, target: Target) -> Option<Span> {
        match target {
            Target::Symbol(id) => self.place(id),
            Target::Parameter { item, position } => {
                Some(self.item(item)?.parameters().nth(position)?.1)
            }
        }
    }

    /// Returns the name that a token denotes.
    pub fn name(&self, target: Target) -> &str {
        match target {
            Target::Symbol(id) => self.symbol(id).map_or("", |symbol| &symbol.name),
            Target::Parameter { item, position } => {
                let item = self.item(item);
                let named = item.and_then(|item| item.variables().nth(position));
                named.unwrap_or("")
            }
        }
    }

    /// Returns the numbers of all tokens that denote `target`, with the one that introduces it first.
    pub fn occurrences(&self, target: Target) -> Vec<usize> {
        let name = self.name(target);
        let symbol = match target {
            Target::Symbol(id) => Some(id),
            // After `f_` the parameters of `f` can be named, wherever `f` is used.
            Target::Parameter { item, .. } => self.item(item).and_then(|item| item.symbol),
        };
        let document = &self.document;
        let placed_chunks: Vec<PlacedChunk<'_>> = match (symbol, target) {
            (Some(id), _) if document.home(id).is_some() => {
                let chunks = document.readers(id).chain(document.home(id));
                let mut placed_chunks: Vec<_> =
                    chunks.map(|chunk| document.placed_chunk(chunk)).collect();
                placed_chunks.sort_by_key(|placed| placed.start);
                placed_chunks.dedup_by_key(|placed| placed.chunk);
                placed_chunks
            }
            (_, Target::Parameter { item, .. }) => {
                let found = u32::try_from(item).ok();
                let found = found.and_then(|item| document.placed_chunk_of_declaration(item));
                found.into_iter().map(|(placed, _)| placed).collect()
            }
            // The readers of builtins are not recorded.
            _ => document
                .placed_chunks_from(document.placed_chunk_at(0))
                .collect(),
        };
        let mut found = Vec::new();
        for placed in placed_chunks {
            let targets = ChunkTargets::new(placed);
            // Compare the text before looking up the meaning.
            let is_named = |k: &usize| {
                let span = placed.tokens().span(*k);
                span.is_some_and(|span| span.text(placed.text) == name)
            };
            let named = (0..placed.tokens().len()).filter(is_named);
            let same = named.filter(|&k| targets.target(self, k) == Some(target));
            found.extend(same.map(|k| placed.first_token as usize + k));
        }
        found
    }

    /// Returns true if the value of a symbol reads a param or a grid, directly or indirectly. Attributes are not part of it.
    pub(crate) fn depends_on_settings(&self, symbol: SymbolId) -> bool {
        let mut known = self
            .dependent
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let mut seen: HashSet<SymbolId> = HashSet::from([symbol]);
        let mut open = vec![symbol];
        let mut found = false;
        while let Some(id) = open.pop() {
            match known.get(&id) {
                Some(true) => found = true,
                Some(false) => continue,
                None => {}
            }
            let Some(item) = self.item_of(id).and_then(|k| self.item(k)) else {
                continue;
            };
            found |= matches!(item.keyword.category(), Category::Slider | Category::Grid);
            if found {
                break;
            }
            let mut start = item.span.start;
            let mut values: Vec<Span> = item.attributes().map(|(_, _, value)| value).collect();
            values.sort_unstable();
            values.push(Span::new(item.span.end, item.span.end));
            for value in values {
                let used = self.symbols_in(Span::new(start, value.start.max(start)));
                open.extend(used.into_iter().filter(|id| seen.insert(*id)));
                start = start.max(value.end);
            }
        }
        if found {
            known.insert(symbol, true);
        } else {
            known.extend(seen.into_iter().map(|id| (id, false)));
        }
        found
    }
}

/// Returns a token of a chunk, with its span in the text.
pub(crate) fn lexeme(placed: PlacedChunk<'_>, token: Token) -> Lexeme<'_> {
    Lexeme {
        kind: token.kind,
        span: token.span.moved(placed.start),
        text: token.span.text(placed.text),
    }
}
