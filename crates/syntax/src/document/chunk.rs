//! One piece of a document: a text that ends with its `;`, and what reading it has given.
//!
//! All places in a chunk count from its own start, so that nothing of it changes when it moves.

use crate::diagnostic::Diagnostic;
use crate::geotrace::actions::{Actions, Declaration, Interval, Operator, Parameter};
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::parser::elsewhere::Elsewhere;
use crate::geotrace::parser::suggestions::each_declared;
use crate::geotrace::token::Token;
use crate::span::Span;
use crate::symbol::SymbolId;

use super::open_words::Lookup;
use super::record::{EventRecorder, Events, Parameters, Records, Tokens};
use super::sequence::Measure;

/// What was read of a chunk, in the order in which the hooks are called.
#[derive(Clone, Copy, Debug)]
pub enum Event<'d> {
    /// A declaration opens.
    Open(DeclarationKeyword, Span),
    /// A step of an expression.
    Operator(Operator, Span),
    /// An interval.
    Interval(Interval),
    /// A declaration has been read.
    Declaration(ReadDeclaration<'d>),
    /// A diagnostic: the next one of the chunk's.
    Finding,
}

/// A [`Declaration`] that is kept.
#[derive(Clone, Copy, Debug)]
pub struct ReadDeclaration<'d> {
    /// The word that opens it.
    pub word: DeclarationKeyword,
    /// From the word to the `;`.
    pub span: Span,
    /// What it declares, unless its name was not read or not free.
    pub symbol: Option<SymbolId>,
    /// The name as it is written; empty where it was not read.
    pub name: &'d str,
    /// Where the name stands; empty where it was not read.
    pub name_span: Span,
    /// The parameters, for what is applied.
    pub parameters: Parameters<'d>,
    /// An error lies in it.
    pub faulty: bool,
}

impl<'d> ReadDeclaration<'d> {
    /// As the hooks take it, with its parameters as they take those.
    pub fn as_declaration<'a>(&self, parameters: &'a [Parameter]) -> Declaration<'a>
    where
        'd: 'a,
    {
        Declaration {
            word: self.word,
            span: self.span,
            symbol: self.symbol,
            name: self.name,
            name_span: self.name_span,
            parameters,
            faulty: self.faulty,
        }
    }
}

/// A diagnostic of the parser, and what it has yet to tell of other places.
#[derive(Clone, Debug)]
pub(super) struct Finding {
    pub(super) diagnostic: Diagnostic,
    pub(super) elsewhere: Option<Elsewhere>,
}

/// A name that stands behind a declaring word: where it does last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Declared {
    pub(super) start: u32,
    pub(super) end: u32,
}

/// A piece of the text and what it was read as.
#[derive(Clone, Debug, Default)]
pub(super) struct Chunk {
    pub(super) text: Box<str>,
    pub(super) tokens: Records,
    pub(super) events: Records,
    pub(super) findings: Box<[Finding]>,
    /// What was asked of the names above.
    pub(super) lookups: Box<[Lookup]>,
    pub(super) declared: Box<[Declared]>,
    /// The version of the document since which it is read so.
    pub(super) version: u64,
}

impl Chunk {
    pub(super) fn measure(&self) -> Measure {
        let elsewhere = self.findings.iter().filter_map(|it| it.elsewhere.as_ref());
        let searches = elsewhere.filter(|elsewhere| elsewhere.is_search());
        Measure {
            chunks: 1,
            bytes: self.text.len() as u32,
            lines: count_lines(&self.text),
            characters: self.text.chars().count() as u32,
            findings: self.findings.len() as u32,
            searches: searches.count() as u32,
            tokens: self.tokens.len() as u32,
            declarations: self.declarations().count() as u32,
        }
    }

    /// The declarations, in order.
    pub(super) fn declarations(&self) -> impl Iterator<Item = ReadDeclaration<'_>> {
        self.events()
            .declarations()
            .map(|(declaration, _)| declaration)
    }

    /// The symbols it declares, in order.
    pub(super) fn defines(&self) -> impl Iterator<Item = SymbolId> {
        self.declarations()
            .filter_map(|declaration| declaration.symbol)
    }

    /// The names that stand behind declaring words, each with where it does last.
    pub(super) fn declared(&self) -> impl Iterator<Item = (&str, u32)> {
        let declared = self.declared.iter();
        declared.map(|it| (&self.text[it.start as usize..it.end as usize], it.start))
    }

    pub(super) fn events(&self) -> Events<'_> {
        Events::new(&self.events, &self.text)
    }

    /// The tokens, in order.
    pub(super) fn tokens(&self) -> Tokens<'_> {
        Tokens::new(&self.tokens, &self.text)
    }

    /// Notes the names behind declaring words.
    pub(super) fn scan(&mut self) {
        let mut declared: Vec<(&str, u32)> = Vec::new();
        each_declared(&self.text, |name, start| declared.push((name, start)));
        // The last of each name.
        declared.sort_by(|(a, at), (b, other)| (a, other).cmp(&(b, at)));
        declared.dedup_by_key(|(name, _)| *name);
        let places = declared.into_iter().map(|(name, start)| Declared {
            start,
            end: start + name.len() as u32,
        });
        self.declared = places.collect();
    }
}

/// Keeps all that the hooks are told.
#[derive(Debug, Default)]
pub(super) struct Recorder {
    pub(super) tokens: Vec<Token>,
    pub(super) events: EventRecorder,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// The symbols that are declared, in order, each with where it is known from.
    pub(super) declared: Vec<(SymbolId, u32)>,
}

impl Actions for Recorder {
    fn act_advance(&mut self, token: Token) {
        self.tokens.push(token);
    }

    fn act_declaration_start(&mut self, word: DeclarationKeyword, span: Span) {
        self.events.open(word, span);
    }

    fn act_operator(&mut self, operator: Operator, span: Span) {
        self.events.operator(operator, span);
    }

    fn act_interval(&mut self, interval: Interval) {
        self.events.interval(interval);
    }

    fn act_declaration(&mut self, declaration: &Declaration<'_>) {
        self.events.declaration(declaration);
        let known_from = declaration.span.end;
        let declared = declaration.symbol.map(|symbol| (symbol, known_from));
        self.declared.extend(declared);
    }

    fn act_error(&mut self, diagnostic: Diagnostic) {
        self.events.finding();
        self.diagnostics.push(diagnostic);
    }
}

/// Where declarations end: behind each `;` that stands in no comment. Goes on at `from`, in a comment or not,
/// and says whether it ends in one.
pub(super) fn cut(text: &str, from: usize, mut in_comment: bool, ends: &mut Vec<usize>) -> bool {
    for (at, byte) in text.bytes().enumerate().skip(from) {
        match byte {
            b'\n' => in_comment = false,
            b'#' => in_comment = true,
            b';' if !in_comment => ends.push(at + 1),
            _ => {}
        }
    }
    in_comment
}

pub(super) fn count_lines(text: &str) -> u32 {
    text.bytes().filter(|byte| *byte == b'\n').count() as u32
}
