//! The interface of a language to a document.

use std::fmt::Debug;
use std::sync::Arc;

use crate::diagnostic::Diagnostic;
use crate::span::Span;
use crate::symbol::SymbolId;

use super::scope::ScopeView;
use super::surroundings::Surroundings;

/// A language whose texts a [`Document`](super::Document) holds.
///
/// The document cuts a text into chunks and reads each with the names that the chunks above it define. It reads a chunk
/// again only if its text changes or a name that it has looked up. For an edited document to equal one that is made
/// from the whole text, the language keeps two rules:
///
/// - Where a chunk ends depends on the text from its start to its end only ([`cut`](Self::cut)), and on the beginning of the
///   chunk below it if the language says so ([`LOOKAHEAD`](Self::LOOKAHEAD)).
/// - What [`read`](Self::read) returns depends on its arguments only, and it records at the [`ScopeView`] each name that it
///   uses and each word that it would read otherwise if another name were defined.
///
/// A language without such chunks cuts nothing; its texts are documents of one chunk.
pub trait Grammar: Clone + Debug + Sized {
    /// The number of bytes, after the white space at the start of a chunk, that together with the text above decide that
    /// the chunk above ends there; 0 if the text above decides it alone. What they do not decide is no end.
    const LOOKAHEAD: usize = 0;
    /// The state of [`cut`](Self::cut) between two calls, such as a comment that has not ended or the depth of nested
    /// blocks. The default is the state at the start of a chunk.
    type CutState: Copy + Default;
    /// The names that every text starts with.
    type Builtins: ?Sized;
    /// The meaning of a name.
    type Symbol: Definition;
    /// The result of reading a chunk.
    type Analysis: Analysis;
    /// A part of a diagnostic that depends on other places of the text: it is completed when the diagnostic is
    /// requested, because it may change while the chunk does not.
    type Deferred: Clone + Debug;

    /// Appends to `ends` the offsets after the chunks that end in `text[from..]`, and returns the state after it. `state` is
    /// the one before `from`.
    fn cut(text: &str, from: usize, state: Self::CutState, ends: &mut Vec<usize>)
    -> Self::CutState;

    /// Appends the ends that [`cut`](Self::cut) left open, where no text follows.
    fn cut_last(text: &str, state: Self::CutState, ends: &mut Vec<usize>) {
        let _ = (text, state, ends);
    }

    /// Returns the builtin symbols. Their handles count up from 0 in this order; of equal names the first is found.
    fn builtins(builtins: &Self::Builtins) -> Vec<Self::Symbol>;

    /// Calls `found` with each name that a chunk seems to declare, and its place, without reading the chunk.
    fn each_declared<'t>(text: &'t str, found: impl FnMut(&'t str, u32));

    /// Reads a chunk with the names above it. Places count from its start. `is_first` says that it is the first of the text,
    /// where a byte order mark is white space.
    fn read<'d>(
        text: &str,
        is_first: bool,
        scope: ScopeView<'d, Self>,
    ) -> (ScopeView<'d, Self>, Reading<Self>);

    /// Returns true if completing the diagnostic searches all names. The document counts these, so that
    /// [`complete`](Self::complete) can limit them.
    fn searches(deferred: &Self::Deferred) -> bool {
        let _ = deferred;
        false
    }

    /// Completes a diagnostic of a chunk. `searches` diagnostics before it search all names.
    fn complete(
        deferred: &Self::Deferred,
        diagnostic: &mut Diagnostic,
        surroundings: &Surroundings<'_, Self>,
        searches: usize,
    );

    /// Returns the warning about a name whose letters are read as several tokens above its declaration. A language that does
    /// not split words into tokens has none.
    fn shadowed_split(split: ShadowedSplit<'_>) -> Option<Diagnostic> {
        let _ = split;
        None
    }
}

/// The meaning of a name, as far as a document looks at it.
pub trait Definition: Clone + Debug {
    /// The part of it that the text below notices: while this stays equal, nothing below is read again.
    type Signature: Clone + Debug + Eq;

    /// Returns the name.
    fn name(&self) -> &Arc<str>;

    /// Replaces the name by an equal one that the document shares, and returns room that is not used.
    fn share_name(&mut self, name: &Arc<str>);

    /// Returns false for a builtin that no look-up finds: the grammar finds it by itself, where nothing has its name.
    fn is_found(&self) -> bool {
        true
    }

    /// Returns the span where the text declares it, counted from its chunk's start. Builtins have none.
    fn name_span(&self) -> Option<Span>;

    /// Returns the part that the text below notices.
    fn signature(&self) -> Self::Signature;
}

/// The part of a chunk's analysis that a document reads. The default is that of a chunk that has not been read.
///
/// The text of the chunk is handed to what may leave to the text what it says.
pub trait Analysis: Clone + Debug + Default {
    /// Returns the number of tokens.
    fn token_count(&self) -> usize;

    /// Returns the span of a token by its number, from 0. Tokens are in the order of the text and do not overlap.
    fn token_span(&self, index: usize) -> Option<Span>;

    /// Returns the places of the declarations, in the order of the text.
    fn declaration_spans<'a>(&'a self, text: &'a str) -> impl Iterator<Item = Span> + 'a;

    /// Returns the symbols that [`ScopeView::define`] has returned, in the order of the text.
    fn defined<'a>(&'a self, text: &'a str) -> impl Iterator<Item = SymbolId> + 'a;
}

/// The result of reading a chunk, with all that is found on the way.
#[derive(Clone, Debug)]
pub struct Reading<G: Grammar> {
    /// The part that the document keeps.
    pub analysis: G::Analysis,
    /// The diagnostics, in the order in which they were found.
    pub diagnostics: Vec<Diagnostic>,
    /// The parts of diagnostics that are still to be completed, by the index of the diagnostic, in ascending order.
    pub deferred: Vec<(usize, G::Deferred)>,
    /// The offset from which on each defined symbol is known, for suggestions.
    pub known_from: Vec<(SymbolId, u32)>,
}

/// A name that is declared below a place where its letters are read as several tokens.
#[derive(Clone, Copy, Debug)]
pub struct ShadowedSplit<'d> {
    /// The name.
    pub name: &'d str,
    /// The span of its declaration.
    pub name_span: Span,
    /// The length of the first token that is read above.
    pub token_length: usize,
    /// The span above, as long as the name.
    pub place: Span,
    /// The line of that place, from 1.
    pub line: u32,
}
