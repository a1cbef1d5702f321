//! A Geotrace program that is edited: the language as a [`Grammar`] of the kernel's document.
//!
//! `;` delimits declarations and `#` comments whatever any name means (`cut`), so a chunk is a declaration up to its `;`, with
//! the white space and comments before it. The parser reads a chunk through a `NameScope` that the document's [`ScopeView`]
//! implements. The calls of the hooks are recorded in packed form.

use std::sync::Arc;

use crate::diagnostic::Diagnostic;
use crate::document::{
    self, Analysis, ChunkId, Definition, Grammar, Reading, ScopeView, ShadowedSplit,
};
use crate::span::Span;
use crate::spelling::Search;
use crate::symbol::SymbolId;
use crate::trie::Trie;

use super::actions::{Actions, Declaration, Interval, Operator, Parameter, StatedAttribute};
use super::cut::{CutState, LOOKAHEAD, cut, cut_last};
use super::declarations::DeclarationKeyword;
use super::parser::deferred::{Deferred, References};
use super::parser::lints::shadowed_split;
use super::parser::parse_chunk;
use super::parser::suggestions::each_declared;
use super::records::{EventRecorder, Records};
use super::symbols::{
    MAX_NAME_LENGTH, NameScope, Parsed, SpecialWords, Symbol, SymbolKind, Vocabulary,
};
use super::token::{Token, TokenKind};

pub use super::records::{Parameters, ParseEvents, Tokens};

/// The Geotrace language.
#[derive(Clone, Copy, Debug)]
pub struct Geotrace;

/// A program that is edited.
pub type Document = document::Document<Geotrace>;
/// A program at one version.
pub type Snapshot = document::Snapshot<Geotrace>;
/// A chunk of a program with its position.
pub type PlacedChunk<'d> = document::PlacedChunk<'d, Geotrace>;

/// The analysis of a chunk: its tokens and the calls of the hooks, in packed form.
#[derive(Clone, Debug, Default)]
pub struct ChunkAnalysis {
    tokens: Records,
    events: Records,
}

/// The part of a symbol that affects the declarations below.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Signature {
    keyword: Option<DeclarationKeyword>,
    kind: SymbolKind,
    parameters: Vec<String>,
    faulty: bool,
}

/// A recorded call of a hook.
#[derive(Clone, Copy, Debug)]
pub enum ParseEvent<'d> {
    /// A declaration starts.
    Open(DeclarationKeyword, Span),
    /// A step of an expression.
    Operator(Operator, Span),
    /// An interval.
    Interval(Interval),
    /// An attribute, with the text of its value.
    Attribute(StatedAttribute, &'d str),
    /// A declaration has been read.
    Declaration(ReadDeclaration<'d>),
    /// A diagnostic: the next one of [`diagnostics_of_reading`](Document::diagnostics_of_reading).
    Diagnostic,
}

/// A [`Declaration`] that a document stores.
#[derive(Clone, Copy, Debug)]
pub struct ReadDeclaration<'d> {
    /// The keyword.
    pub keyword: DeclarationKeyword,
    /// The span from the keyword to the `;`.
    pub span: Span,
    /// The symbol that it declares. `None` if its name was not read or not free.
    pub symbol: Option<SymbolId>,
    /// The name as written; empty if it was not read.
    pub name: &'d str,
    /// The span of the name; empty if it was not read.
    pub name_span: Span,
    /// The parameters, if it has any.
    pub parameters: Parameters<'d>,
    /// True if it contains an error.
    pub faulty: bool,
}

impl<'d> ReadDeclaration<'d> {
    /// Returns the declaration in the form of the hooks, with its parameters.
    pub fn as_declaration<'a>(&self, parameters: &'a [Parameter]) -> Declaration<'a>
    where
        'd: 'a,
    {
        Declaration {
            keyword: self.keyword,
            span: self.span,
            symbol: self.symbol,
            name: self.name,
            name_span: self.name_span,
            parameters,
            faulty: self.faulty,
        }
    }
}

impl Grammar for Geotrace {
    const LOOKAHEAD: usize = LOOKAHEAD;
    type CutState = CutState;
    type Builtins = Vocabulary;
    type Symbol = Symbol;
    type Analysis = ChunkAnalysis;
    type Deferred = Deferred;

    fn cut(text: &str, _: usize, state: CutState, ends: &mut Vec<usize>) -> CutState {
        cut(text, state, ends)
    }

    fn cut_last(text: &str, state: CutState, ends: &mut Vec<usize>) {
        cut_last(text, state, ends);
    }

    fn builtins(vocabulary: &Vocabulary) -> Vec<Symbol> {
        vocabulary.symbols().to_vec()
    }

    fn each_declared<'t>(text: &'t str, found: impl FnMut(&'t str, u32)) {
        each_declared(text, found);
    }

    fn read<'d>(
        text: &str,
        is_first: bool,
        scope: ScopeView<'d, Self>,
    ) -> (ScopeView<'d, Self>, Reading<Self>) {
        let mut recorder = Recorder::with_capacity(text.len() / BYTES_PER_TOKEN);
        let (scope, deferred) = parse_chunk(text, is_first, scope, &mut recorder);
        let analysis = ChunkAnalysis {
            tokens: Records::from_tokens(&recorder.tokens, text),
            events: recorder.events.finish(text),
        };
        let reading = Reading {
            analysis,
            diagnostics: recorder.diagnostics,
            deferred,
            known_from: recorder.known_from,
        };
        (scope, reading)
    }

    fn searches(deferred: &Deferred) -> bool {
        deferred.searches()
    }

    fn complete(
        deferred: &Deferred,
        diagnostic: &mut Diagnostic,
        surroundings: &document::Surroundings<'_, Self>,
        searches: usize,
    ) {
        deferred.complete(diagnostic, surroundings, searches);
    }

    fn shadowed_split(split: ShadowedSplit<'_>) -> Option<Diagnostic> {
        Some(shadowed_split(split))
    }
}

impl Definition for Symbol {
    type Signature = Signature;

    fn name(&self) -> &Arc<str> {
        &self.name
    }

    fn share_name(&mut self, name: &Arc<str>) {
        self.name = Arc::clone(name);
        // A vector that has grown by itself has room for four.
        self.parameters.shrink_to_fit();
    }

    fn is_found(&self) -> bool {
        !self.is_weak
    }

    fn name_span(&self) -> Option<Span> {
        self.name_span
    }

    fn signature(&self) -> Signature {
        let parameters = self.parameters.iter();
        Signature {
            keyword: self.keyword,
            kind: self.kind,
            parameters: parameters.map(|parameter| parameter.name.clone()).collect(),
            faulty: self.faulty,
        }
    }
}

impl Analysis for ChunkAnalysis {
    fn token_count(&self) -> usize {
        self.tokens.len()
    }

    fn token_span(&self, index: usize) -> Option<Span> {
        self.tokens.span(index)
    }

    fn declaration_spans<'a>(&'a self, text: &'a str) -> impl Iterator<Item = Span> + 'a {
        let declarations = self.events(text).declarations();
        declarations.map(|(declaration, _)| declaration.span)
    }

    fn defined<'a>(&'a self, text: &'a str) -> impl Iterator<Item = SymbolId> + 'a {
        let declarations = self.events(text).declarations();
        declarations.filter_map(|(declaration, _)| declaration.symbol)
    }
}

impl ChunkAnalysis {
    fn tokens<'d>(&'d self, text: &'d str) -> Tokens<'d> {
        Tokens::new(&self.tokens, text)
    }

    fn events<'d>(&'d self, text: &'d str) -> ParseEvents<'d> {
        ParseEvents::new(&self.events, text)
    }
}

impl NameScope for ScopeView<'_, Geotrace> {
    const IS_CHUNK: bool = true;

    fn longest_prefix(&self, word: &str) -> Option<(usize, SymbolId)> {
        self.longest_prefix(word)
    }

    fn get(&self, name: &str) -> Option<SymbolId> {
        self.get(name)
    }

    fn symbol(&self, id: SymbolId) -> &Symbol {
        self.symbol(id)
    }

    fn define(&mut self, symbol: Symbol) -> SymbolId {
        self.define(symbol)
    }

    fn record_prefix_lookup(&mut self, rest: &str, start: u32, length: usize, kind: TokenKind) {
        let mut length = length as u32;
        match kind {
            TokenKind::Constant(id) | TokenKind::Function(id) => self.record_use(id),
            TokenKind::Undefined => length = 0,
            TokenKind::Declare(_) => return,
            // A parameter that loses letters to a longer name is reported at its declaration.
            _ => {}
        }
        // No name is longer, but a word may be as long as the text.
        let candidate = rest.len().min(MAX_NAME_LENGTH) as u32;
        self.record_prefix_lookup(Span::new(start, start + candidate), length);
    }

    fn record_name_lookup(&mut self, name: &str, start: u32, kind: TokenKind) {
        match kind {
            TokenKind::Constant(id) | TokenKind::Function(id) => self.record_use(id),
            TokenKind::Declare(_) => {}
            _ if name.len() > MAX_NAME_LENGTH => {}
            _ => self.record_name_lookup(Span::new(start, start + name.len() as u32)),
        }
    }

    fn words(&self) -> Option<&SpecialWords> {
        self.first_builtin()?.words.as_deref()
    }

    fn search(&self, _: &mut Search<'_>) {
        // The diagnostics of a chunk name similarly spelt words only when they are completed.
    }
}

impl References for document::Surroundings<'_, Geotrace> {
    fn line(&self, offset: u32) -> u32 {
        self.line(offset)
    }

    fn declaration(&self, symbol: SymbolId) -> Option<(&Symbol, Span, u32)> {
        self.declaration(symbol)
    }

    fn declared_below(&self, name: &str, offset: u32) -> Option<(Span, u32)> {
        self.declared_below(name, offset)
    }

    fn nearest(&self, parameters: Option<&Trie<u32>>, word: &str, offset: u32) -> Option<String> {
        self.nearest(parameters, word, offset)
    }
}

/// A low estimate of the length of a token with its spaces, in bytes, so that few lists of tokens have to grow.
const BYTES_PER_TOKEN: usize = 2;

/// Records the calls of the hooks while a chunk is read.
#[derive(Debug)]
struct Recorder {
    tokens: Vec<Token>,
    events: EventRecorder,
    diagnostics: Vec<Diagnostic>,
    /// The declared symbols, each with the offset from which it is known.
    known_from: Vec<(SymbolId, u32)>,
}

impl Recorder {
    /// Creates a recorder with room for this many tokens, and as many events.
    fn with_capacity(tokens: usize) -> Self {
        Self {
            tokens: Vec::with_capacity(tokens),
            events: EventRecorder::with_capacity(tokens),
            diagnostics: Vec::new(),
            known_from: Vec::new(),
        }
    }
}

impl Actions for Recorder {
    fn act_advance(&mut self, token: Token) {
        self.tokens.push(token);
    }

    fn act_declaration_start(&mut self, keyword: DeclarationKeyword, span: Span) {
        self.events.open(keyword, span);
    }

    fn act_operator(&mut self, operator: Operator, span: Span) {
        self.events.operator(operator, span);
    }

    fn act_interval(&mut self, interval: Interval) {
        self.events.interval(interval);
    }

    fn act_attribute(&mut self, attribute: StatedAttribute, _: &str) {
        self.events.attribute(attribute);
    }

    fn act_declaration(&mut self, declaration: &Declaration<'_>) {
        self.events.declaration(declaration);
        let known_from = declaration.span.end;
        let known = declaration.symbol.map(|symbol| (symbol, known_from));
        self.known_from.extend(known);
    }

    fn act_error(&mut self, diagnostic: Diagnostic) {
        self.events.diagnostic();
        self.diagnostics.push(diagnostic);
    }
}

impl<'d> PlacedChunk<'d> {
    /// Returns its tokens, including comments, in order.
    pub fn tokens(&self) -> Tokens<'d> {
        self.analysis.tokens(self.text)
    }

    /// Returns the calls of the hooks, in order.
    pub fn events(&self) -> ParseEvents<'d> {
        self.analysis.events(self.text)
    }

    /// Returns the declarations in order, each with its steps and intervals.
    pub fn declarations(
        &self,
    ) -> impl Iterator<Item = (ReadDeclaration<'d>, ParseEvents<'d>)> + use<'d> {
        self.events().declarations()
    }
}

impl Snapshot {
    /// Returns the calls of the hooks for a chunk. Spans are relative to its start.
    pub fn events(&self, chunk: ChunkId) -> ParseEvents<'_> {
        self.analysis(chunk).events(self.chunk_text(chunk))
    }

    /// Returns the tokens that a range touches, including comments, in order. Their spans are relative to the text.
    pub fn tokens(&self, range: Span) -> impl Iterator<Item = Token> + '_ {
        let chunks = self.chunks_in(range);
        chunks.flat_map(move |(chunk, start)| {
            let tokens = self.analysis(chunk).tokens(self.chunk_text(chunk)).iter();
            let moved = tokens.map(move |token| Token {
                kind: token.kind,
                span: token.span.moved(start),
            });
            moved
                .filter(move |token| token.span.end >= range.start && token.span.start <= range.end)
        })
    }

    /// Returns the declarations in order, each with its chunk. Spans are relative to the chunk's start.
    pub fn declarations(&self) -> impl Iterator<Item = (ChunkId, ReadDeclaration<'_>)> {
        self.chunks().flat_map(|chunk| {
            let declarations = self.events(chunk).declarations();
            declarations.map(move |(declaration, _)| (chunk, declaration))
        })
    }

    /// Returns the number of the declaration of a symbol; `None` for a builtin.
    pub fn declaration_of(&self, symbol: SymbolId) -> Option<u32> {
        let placed = self.placed_chunk(self.home(symbol)?);
        let mut declarations = placed.declarations();
        let place = declarations.position(|(it, _)| it.symbol == Some(symbol))?;
        Some(placed.first_declaration + place as u32)
    }

    /// Returns the names at the end of the text as [`parse_program`](super::parse_program) would: with other handles,
    /// which count up in the order of the text.
    pub fn parsed(&self) -> Parsed {
        let mut parsed = Parsed::default();
        let builtins = self
            .symbols()
            .take_while(|(id, _)| self.home(*id).is_none());
        for (_, builtin) in builtins {
            parsed.define(builtin.clone());
        }
        let mut start = 0;
        for chunk in self.chunks() {
            let text = self.chunk_text(chunk);
            let defined = self.analysis(chunk).defined(text);
            for symbol in defined.filter_map(|id| self.symbol(id)) {
                let mut symbol = symbol.clone();
                symbol.name_span = symbol.name_span.map(|span| span.moved(start));
                for parameter in &mut symbol.parameters {
                    parameter.span = parameter.span.moved(start);
                }
                parsed.define(symbol);
            }
            start += text.len() as u32;
        }
        parsed
    }
}
