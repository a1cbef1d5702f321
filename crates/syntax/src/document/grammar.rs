//! The interface between a language and a document.

use std::fmt::Debug;
use std::sync::Arc;

use crate::diagnostic::Diagnostic;
use crate::span::Span;
use crate::symbol::SymbolId;

use super::scope::ScopeView;
use super::surroundings::Surroundings;

/// A language whose texts a [`Document`](super::Document) can hold.
///
/// The document cuts a text into chunks and reads each with the names that the chunks above it define. It reads a chunk
/// again only if its text changes, or a name that it looked up. For an edited document to equal a document made from
/// the whole text, the language must satisfy two rules:
///
/// - The end of a chunk depends only on the text from its start to its end ([`cut`](Self::cut)), and on the beginning of the
///   chunk below it if [`LOOKAHEAD`](Self::LOOKAHEAD) is not 0.
/// - The result of [`read`](Self::read) depends only on its arguments, and it records with the [`ScopeView`] each name that it
///   uses and each word that it would read differently if another name were defined.
///
/// A language without such chunks cuts nothing; its texts are documents of one chunk.
pub trait Grammar: Clone + Debug + Sized {
    /// The number of bytes, after the white space at the start of a chunk, that together with the text above determine
    /// whether the chunk above ends there; 0 if the text above determines it alone. If they leave it open, it does not
    /// end there.
    const LOOKAHEAD: usize = 0;
    /// The state of [`cut`](Self::cut) between two calls, such as an unfinished comment or the depth of nested blocks.
    /// The default is the state at the start of a chunk.
    type CutState: Copy + Default;
    /// The names that every text starts with.
    type Builtins: ?Sized;
    /// The meaning of a name.
    type Symbol: Definition;
    /// The result of reading a chunk.
    type Analysis: Analysis;
    /// A part of a diagnostic that depends on other parts of the text. It is completed when the diagnostic is
    /// requested, because it may change while the chunk does not.
    type Deferred: Clone + Debug;

    /// Appends to `ends` the offsets after the chunks that end in `text[from..]`, and returns the state after the text.
    /// `state` is the state before `from`.
    fn cut(text: &str, from: usize, state: Self::CutState, ends: &mut Vec<usize>)
    -> Self::CutState;

    /// Appends the ends that [`cut`](Self::cut) left open, at the end of the whole text.
    fn cut_last(text: &str, state: Self::CutState, ends: &mut Vec<usize>) {
        let _ = (text, state, ends);
    }

    /// Returns the builtin symbols. Their handles count up from 0 in this order; of equal names the first is found.
    fn builtins(builtins: &Self::Builtins) -> Vec<Self::Symbol>;

    /// Calls `found` with each name that a chunk seems to declare, and its position, without reading the chunk.
    fn each_declared<'t>(text: &'t str, found: impl FnMut(&'t str, u32));

    /// Reads a chunk with the names above it. Spans are relative to its start. `is_first` is true for the first chunk of the
    /// text, where a byte order mark is white space.
    fn read<'d>(
        text: &str,
        is_first: bool,
        scope: ScopeView<'d, Self>,
    ) -> (ScopeView<'d, Self>, Reading<Self>);

    /// Returns true if completing the diagnostic searches all names. The document counts such diagnostics, so that
    /// [`complete`](Self::complete) can limit the searches.
    fn searches(deferred: &Self::Deferred) -> bool {
        let _ = deferred;
        false
    }

    /// Completes a diagnostic of a chunk. `searches` is the number of diagnostics before it that search all names.
    fn complete(
        deferred: &Self::Deferred,
        diagnostic: &mut Diagnostic,
        surroundings: &Surroundings<'_, Self>,
        searches: usize,
    );

    /// Returns the warning about a name whose letters are read as several tokens above its declaration. Languages that do
    /// not split words into tokens have no such warning.
    fn shadowed_split(split: ShadowedSplit<'_>) -> Option<Diagnostic> {
        let _ = split;
        None
    }
}

/// The meaning of a name, as far as it concerns a document.
pub trait Definition: Clone + Debug {
    /// The part that affects the text below: while it remains equal, nothing below is read again.
    type Signature: Clone + Debug + Eq;

    /// Returns the name.
    fn name(&self) -> &Arc<str>;

    /// Replaces the name by an equal one that the document shares, and frees unused space.
    fn share_name(&mut self, name: &Arc<str>);

    /// Returns false for a builtin that no look-up finds: the grammar finds it itself, where no other symbol has its
    /// name.
    fn is_found(&self) -> bool {
        true
    }

    /// Returns the span of the name in its declaration, relative to its chunk's start; `None` for a builtin.
    fn name_span(&self) -> Option<Span>;

    /// Returns the part that affects the text below.
    fn signature(&self) -> Self::Signature;
}

/// The part of a chunk's analysis that a document reads. The default is the analysis of an unread chunk.
///
/// The text of the chunk is passed in, so that the analysis need not repeat parts of it.
pub trait Analysis: Clone + Debug + Default {
    /// Returns the number of tokens.
    fn token_count(&self) -> usize;

    /// Returns the span of a token by its number, from 0. Tokens are in the order of the text and do not overlap.
    fn token_span(&self, index: usize) -> Option<Span>;

    /// Returns the spans of the declarations, in the order of the text.
    fn declaration_spans<'a>(&'a self, text: &'a str) -> impl Iterator<Item = Span> + 'a;

    /// Returns the symbols that [`ScopeView::define`] has returned, in the order of the text.
    fn defined<'a>(&'a self, text: &'a str) -> impl Iterator<Item = SymbolId> + 'a;
}

/// The result of reading a chunk.
#[derive(Clone, Debug)]
pub struct Reading<G: Grammar> {
    /// The analysis, which the document stores.
    pub analysis: G::Analysis,
    /// The diagnostics, in the order in which they were found.
    pub diagnostics: Vec<Diagnostic>,
    /// The parts of diagnostics that remain to be completed, by the index of the diagnostic, in ascending order.
    pub deferred: Vec<(usize, G::Deferred)>,
    /// The offset from which each defined symbol is known, for suggestions.
    pub known_from: Vec<(SymbolId, u32)>,
}

/// A name that is declared below a position where its letters are read as several tokens.
#[derive(Clone, Copy, Debug)]
pub struct ShadowedSplit<'d> {
    /// The name.
    pub name: &'d str,
    /// The span of its declaration.
    pub name_span: Span,
    /// The length of the first token of the name's letters above.
    pub token_length: usize,
    /// The span of these letters above, as long as the name.
    pub place: Span,
    /// The line of that span, from 1.
    pub line: u32,
}
