//! A script that is edited: the language as a [`Grammar`] of the kernel's document.
//!
//! A chunk is usually one block; no name changes the reading of another chunk.

use std::sync::Arc;

use super::cut::{CutState, LOOKAHEAD, cut};
use super::parser::{is_certificate, parse_tree};
use super::token::Token;
use super::tree::{Block, Piece, Script};
use crate::diagnostic::Diagnostic;
use crate::document::{self, Analysis, Definition, Grammar, Reading, ScopeView};
use crate::span::Span;
use crate::symbol::SymbolId;

/// The CRT scene language.
#[derive(Clone, Copy, Debug)]
pub struct Crt;

/// A script that is edited.
pub type Document = document::Document<Crt>;
/// A script at one version.
pub type Snapshot = document::Snapshot<Crt>;
/// A chunk of a script with its position.
pub type PlacedChunk<'d> = document::PlacedChunk<'d, Crt>;

/// The analysis of a chunk: its tokens and its blocks.
#[derive(Clone, Debug, Default)]
pub struct ChunkAnalysis {
    tokens: Box<[Token]>,
    blocks: Arc<[Block]>,
}

/// The meaning of a name: names have no meaning before a script is run.
#[derive(Clone, Copy, Debug)]
pub enum NoSymbol {}

impl Grammar for Crt {
    const LOOKAHEAD: usize = LOOKAHEAD;
    type CutState = CutState;
    type Builtins = ();
    type Symbol = NoSymbol;
    type Analysis = ChunkAnalysis;
    type Deferred = std::convert::Infallible;

    fn cut(text: &str, from: usize, state: CutState, ends: &mut Vec<usize>) -> CutState {
        cut(text, from, state, ends)
    }

    fn builtins((): &()) -> Vec<NoSymbol> {
        Vec::new()
    }

    fn each_declared<'t>(_: &'t str, _: impl FnMut(&'t str, u32)) {}

    fn read<'d>(
        text: &str,
        is_first: bool,
        scope: ScopeView<'d, Self>,
    ) -> (ScopeView<'d, Self>, Reading<Self>) {
        let (tokens, blocks, diagnostics) = parse_tree(text, is_first);
        let reading = Reading {
            analysis: ChunkAnalysis {
                tokens: tokens.into(),
                blocks: blocks.into(),
            },
            diagnostics,
            deferred: Vec::new(),
            known_from: Vec::new(),
        };
        (scope, reading)
    }

    fn complete(
        deferred: &std::convert::Infallible,
        _: &mut Diagnostic,
        _: &document::Surroundings<'_, Self>,
        _: usize,
    ) {
        match *deferred {}
    }
}

impl Definition for NoSymbol {
    type Signature = ();

    fn name(&self) -> &Arc<str> {
        match *self {}
    }

    fn share_name(&mut self, _: &Arc<str>) {}

    fn name_span(&self) -> Option<Span> {
        None
    }

    fn signature(&self) {}
}

impl Analysis for ChunkAnalysis {
    fn token_count(&self) -> usize {
        self.tokens.len()
    }

    fn token_span(&self, index: usize) -> Option<Span> {
        self.tokens.get(index).map(|token| token.span)
    }

    fn declaration_spans<'a>(&'a self, _: &'a str) -> impl Iterator<Item = Span> + 'a {
        self.blocks.iter().map(|block| block.span)
    }

    fn defined<'a>(&'a self, _: &'a str) -> impl Iterator<Item = SymbolId> + 'a {
        std::iter::empty()
    }
}

impl Snapshot {
    /// Returns the syntax tree of the script.
    pub fn script(&self) -> Script {
        let mut start = 0;
        let mut pieces = Vec::new();
        let mut is_first = true;
        for chunk in self.chunks() {
            let text = self.chunk_text(chunk);
            if std::mem::take(&mut is_first) && is_certificate(text) {
                return Script {
                    is_certificate: true,
                    ..Script::default()
                };
            }
            let blocks = Arc::clone(&self.analysis(chunk).blocks);
            pieces.push(Piece { start, blocks });
            start += text.len() as u32;
        }
        Script {
            pieces: pieces.into(),
            is_certificate: false,
        }
    }

    /// Returns the tokens that a range touches, including comments, in order. Their spans are relative to the text.
    pub fn tokens(&self, range: Span) -> impl Iterator<Item = Token> + '_ {
        let chunks = self.chunks_in(range);
        chunks.flat_map(move |(chunk, start)| {
            let tokens = self.analysis(chunk).tokens.iter();
            let moved = tokens.map(move |token| Token {
                kind: token.kind,
                span: token.span.moved(start),
            });
            moved
                .filter(move |token| token.span.end >= range.start && token.span.start <= range.end)
        })
    }
}

impl Document {
    /// Returns all diagnostics of the text, sorted by position: of its pieces and of the order of its blocks.
    pub fn all_diagnostics(&self) -> Vec<Diagnostic> {
        let mut all = self.diagnostics();
        all.extend(self.script().misplaced());
        Diagnostic::sort(&mut all);
        all
    }
}
