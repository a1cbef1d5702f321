//! The parser of the Geotrace language: LL(1) recursive descent, one function per nonterminal of
//! [`grammar`](super::grammar), calling the hooks of [`Actions`].
//!
//! In: a text and a vocabulary. Out: calls of hooks, and at the end the names that the text defines. Parsing never
//! fails: an error becomes a diagnostic, and the parser continues at the next `;` or declaration keyword.
//!
//! - `declaration`: `DECL` and everything in it except expressions.
//! - `items`: the intervals and attributes after a declaration's commas.
//! - `intervals`: the intervals of params, grids and domains.
//! - `sets`: `SET` and all below it.
//! - `expression`: `EXPR` and all below it.
//! - `names`: the token that a word forms, new names, undefined words.
//! - `lints`: warnings about legal text that is not read as it seems.
//! - `products`: those about factors that look like something else.
//! - `deferred`: the parts of diagnostics that depend on other parts of the text.
//! - `suggestions`: the words that an undefined word may be meant to be.
//! - `foreign`: the equivalents of words and signs of other notations.
//! - `characters`: the messages of characters that begin no token.
//! - `messages`: the messages of syntax errors.

mod characters;
mod declaration;
pub(crate) mod deferred;
mod expression;
mod foreign;
mod intervals;
mod items;
pub(crate) mod lints;
mod messages;
mod names;
mod products;
mod sets;
pub(crate) mod suggestions;

use std::cell::OnceCell;

use crate::diagnostic::{Diagnostic, Severity};
use crate::geotrace::actions::{Actions, Interval, Operator, Parameter};
use crate::geotrace::attributes::AttributeWord;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::lexer::{Fault, Lexer, quoted_name};
use crate::geotrace::symbols::{NameScope, Parsed, Symbol, Vocabulary};
use crate::geotrace::token::{MapWord, Token, TokenKind};
use crate::line_index::LineIndex;
use crate::span::Span;
use crate::spelling::Search;
use crate::symbol::SymbolId;
use crate::text::{MAX_DIAGNOSTICS, too_large, too_many_diagnostics};
use crate::trie::Trie;
use deferred::{Deferred, References};
use names::Mode;
use suggestions::DeclaredNames;

/// The maximum nesting depth of an expression, which counts brackets, prefix operators, exponents and functions of
/// functions. In a debug build, 2 MiB of stack suffice for it.
pub const MAX_DEPTH: u32 = 256;

/// Reads a whole program, `PROG`.
///
/// A name is defined from the end of its declaration on. Texts of 4 GiB or more are refused with one diagnostic.
pub fn parse_program<A: Actions>(source: &str, vocabulary: &Vocabulary, actions: &mut A) -> Parsed {
    let parsed = vocabulary.start();
    let Some(source) = accept_length(source, actions) else {
        return parsed;
    };
    let mut parser = Parser::new(Lexer::new(source), parsed, actions, Mode::Start);
    parser.program();
    parser.warn_shadowed_splits();
    parser.parsed
}

/// Reads a lone expression, `EXPR`, with the names at the end of a program; nothing may follow it. Returns true if it
/// has no errors: then its steps are complete.
pub fn parse_expression<A: Actions>(source: &str, parsed: &Parsed, actions: &mut A) -> bool {
    let Some(source) = accept_length(source, actions) else {
        return false;
    };
    let lexer = Lexer::new(source);
    let mut parser = Parser::new(lexer, parsed.clone(), actions, Mode::Expression);
    parser.is_expression = true;
    parser.lone_expression();
    !parser.state.faulty
}

/// Reads a chunk of a program, which begins and ends where declarations do, with the names above it. Returns the scope and,
/// by diagnostic index, the cross-references that the caller has to complete.
///
/// The caller also compares the chunk with the names below it ([`shadowed_split`](lints::shadowed_split)).
pub(crate) fn parse_chunk<A: Actions, S: NameScope>(
    source: &str,
    is_first: bool,
    scope: S,
    actions: &mut A,
) -> (S, Vec<(usize, Deferred)>) {
    let lexer = match is_first {
        true => Lexer::new(source),
        false => Lexer::inside(source),
    };
    let mut parser = Parser::new(lexer, scope, actions, Mode::Start);
    parser.program();
    (parser.parsed, parser.deferred)
}

fn accept_length<'s>(source: &'s str, actions: &mut impl Actions) -> Option<&'s str> {
    if u32::try_from(source.len()).is_ok_and(|length| length < u32::MAX) {
        return Some(source);
    }
    actions.act_error(too_large());
    None
}

/// The parser has given up on the declaration; the reason has been reported.
struct Stop;

/// The span of a nonterminal, from its first token to its last.
type Parse = Result<Span, Stop>;

/// A part of the text that forms no token and that one error reports.
#[derive(Clone, Copy)]
struct BadRun {
    span: Span,
    first: char,
    /// True if it is recognised as a whole, such as `|x|`: adjacent characters are not part of it.
    is_whole: bool,
}

struct Parser<'s, 'a, A, S> {
    source: &'s str,
    lexer: Lexer<'s>,
    /// The names defined so far.
    parsed: S,
    actions: &'a mut A,
    /// The next token to accept; there is no further lookahead.
    current: Token,
    /// The last accepted token.
    previous: Token,
    /// True if the text just skipped (a bad character, an undefined word) has been reported: it is most likely the
    /// reason why the current token does not fit.
    flagged: bool,
    /// The number of accepted tokens, so that loops can assert progress.
    accepted: usize,
    diagnostics: usize,
    state: DeclarationState<'s>,
    lints: lints::LintState,
    /// The number of undefined words reported so far.
    searches: usize,
    /// The deferred cross-references of a chunk, by the index of their diagnostics.
    deferred: Vec<(usize, Deferred)>,
    lines: OnceCell<LineIndex<'s>>,
    declared_below: OnceCell<suggestions::DeclaredNames<'s>>,
    /// True if the text is a lone expression, whose names are declared in another text.
    is_expression: bool,
}

/// The state of the declaration that is being read.
#[derive(Default)]
struct DeclarationState<'s> {
    /// True if it contains an error.
    faulty: bool,
    /// True if its steps are incomplete: no more are reported.
    silent: bool,
    depth: u32,
    keyword: Option<DeclarationKeyword>,
    name: &'s str,
    name_span: Span,
    name_is_free: bool,
    parameters: Vec<Parameter>,
    parameter_trie: Trie<u32>,
    /// True while the body or the value of an attribute is read, in which parameters are variables.
    in_body: bool,
    /// True while a set is read, in which its signs are tokens.
    in_set: bool,
    /// The last map of a set, and the span of its operand.
    map: Option<(MapWord, Span)>,
    /// True for a solid, whose parameters are x, y and z if it lists none.
    is_of_space: bool,
    /// The attributes read so far, with their spans.
    attributes: Vec<(AttributeWord, Span)>,
    /// The span of the expression over the parameters, once it has been read.
    body: Span,
    /// The undefined words that have been reported.
    undefined: Vec<&'s str>,
    /// True once a syntax error has been reported: a declaration gets at most one.
    rejected: bool,
    /// True if a report covers the rest of the declaration: illegal characters and undefined words in it are skipped without a
    /// report.
    quiet: bool,
}

impl<'s, 'a, A: Actions, S: NameScope> Parser<'s, 'a, A, S> {
    /// Creates a parser whose first token is read in the given mode.
    fn new(lexer: Lexer<'s>, parsed: S, actions: &'a mut A, mode: Mode) -> Self {
        let start = Token {
            kind: TokenKind::Eoi,
            span: Span::default(),
        };
        let mut parser = Self {
            source: lexer.source(),
            lexer,
            parsed,
            actions,
            current: start,
            previous: start,
            flagged: false,
            accepted: 0,
            diagnostics: 0,
            state: DeclarationState::default(),
            lints: lints::LintState::default(),
            searches: 0,
            deferred: Vec::new(),
            lines: OnceCell::new(),
            declared_below: OnceCell::new(),
            is_expression: false,
        };
        parser.fetch(mode);
        parser
    }

    /// `PROG = DECL PROG |`
    fn program(&mut self) {
        while self.current.kind != TokenKind::Eoi {
            let before = self.accepted;
            match self.current.kind {
                TokenKind::Declare(keyword) => self.declaration(keyword),
                _ => self.declaration_without_keyword(),
            }
            assert!(self.accepted > before, "the parser stands still");
        }
    }

    fn lone_expression(&mut self) {
        let read = self.expression();
        if read.is_ok() && self.current.kind != TokenKind::Eoi {
            let mut diagnostic = self.expected_diagnostic("the end of the expression");
            if self.current.kind == TokenKind::Prime {
                diagnostic = diagnostic.with_hint(messages::DERIVATIVE);
            }
            self.reject(diagnostic);
        }
        while self.current.kind != TokenKind::Eoi {
            self.advance(Mode::Expression);
        }
    }

    /// Accepts the current token and reads the next in the given mode.
    #[inline]
    fn advance(&mut self, mode: Mode) {
        self.accept();
        self.fetch(mode);
    }

    /// Consumes the current token, without reading the next yet.
    fn accept(&mut self) {
        self.actions.act_advance(self.current);
        self.accepted += 1;
        self.previous = self.current;
    }

    /// Reads the next token. Comments and characters that begin no token are skipped on the way.
    #[inline]
    fn fetch(&mut self, mode: Mode) {
        self.flagged = false;
        let lexeme = self.lex(mode);
        self.current = lexeme.token;
        if lexeme.fault.is_some() || lexeme.token.kind == TokenKind::Comment {
            self.fetch_slowly(mode, lexeme);
        }
    }

    #[cold]
    fn fetch_slowly(&mut self, mode: Mode, mut lexeme: crate::geotrace::lexer::Lexeme) {
        // A run of bad characters is reported once, at its end, and so is a name in quotes, `<1, 2, 3>`, `\cdot`, or the `.x` of
        // `v.x`.
        let mut run: Option<BadRun> = None;
        loop {
            let token = lexeme.token;
            match (run, lexeme.fault) {
                (Some(run), _) if token.span.start < run.span.end => {}
                (
                    Some(BadRun {
                        span,
                        first,
                        is_whole: false,
                    }),
                    Some(Fault::Character(next)),
                ) if span.end == token.span.start && self.joins(first, next, mode) => {
                    run = Some(BadRun {
                        span: span.to(token.span),
                        first,
                        is_whole: false,
                    });
                }
                (ended, fault) => {
                    if let Some(run) = ended {
                        self.report_characters(run, mode);
                    }
                    run = match fault {
                        Some(Fault::Character(first)) => {
                            let known = quoted_name(self.source, token.span)
                                .or_else(|| self.latex_command(token.span))
                                .or_else(|| self.angle_vector(token.span))
                                .or_else(|| self.absolute_value(token.span))
                                .or_else(|| Some(self.foreign_item(token.span, mode)?.0));
                            Some(BadRun {
                                span: known.unwrap_or(token.span),
                                first,
                                is_whole: known.is_some(),
                            })
                        }
                        Some(Fault::LonePoint) => {
                            let known = self.lettered_component(token.span);
                            let known = known.or_else(|| self.point_behind_word(token.span));
                            known.map(|span| BadRun {
                                span,
                                first: '.',
                                is_whole: true,
                            })
                        }
                        _ => None,
                    };
                }
            }
            if run.is_none() && token.kind != TokenKind::Comment {
                break;
            }
            self.flagged |= run.is_some();
            self.actions.act_advance(token);
            self.accepted += 1;
            lexeme = self.lex(mode);
        }
        if let Some(fault) = lexeme.fault {
            // A malformed number remains the current token: it is an operand.
            self.report(characters::bad_number(
                self.source,
                lexeme.token.span,
                fault,
            ));
            self.flagged |= lexeme.token.kind == TokenKind::Error;
        }
        self.current = lexeme.token;
    }

    /// Skips to the end of the declaration: a `;`, a keyword, or the end of the text.
    fn recover(&mut self) {
        loop {
            match self.current.kind {
                TokenKind::Semicolon | TokenKind::Declare(_) | TokenKind::Eoi => return,
                _ => self.advance(Mode::Expression),
            }
        }
    }

    /// Reports a diagnostic; an error makes the declaration faulty.
    fn report(&mut self, diagnostic: Diagnostic) {
        self.state.faulty |= diagnostic.severity == Severity::Error;
        self.diagnostics += 1;
        if self.diagnostics < MAX_DIAGNOSTICS {
            self.actions.act_error(diagnostic);
        } else if self.diagnostics == MAX_DIAGNOSTICS {
            self.actions
                .act_error(too_many_diagnostics(diagnostic.span));
        }
    }

    /// Reports a diagnostic with a part that depends on other parts of the text. In a whole text it is completed now.
    #[cold]
    fn report_deferred(&mut self, mut diagnostic: Diagnostic, deferred: Deferred) {
        let searches = self.searches;
        self.searches += usize::from(deferred.searches());
        if S::IS_CHUNK {
            self.deferred.push((self.diagnostics, deferred));
        } else if !self.is_muted() {
            deferred.complete(&mut diagnostic, self, searches);
        }
        self.report(diagnostic);
    }

    #[inline]
    fn operator(&mut self, operator: Operator, span: Span) {
        if !self.state.silent {
            self.actions.act_operator(operator, span);
        }
    }

    fn act_interval(&mut self, interval: Interval) {
        if !self.state.silent {
            self.actions.act_interval(interval);
        }
    }

    /// Returns true if the limit of diagnostics is reached, so that composing another is useless.
    fn is_muted(&self) -> bool {
        self.diagnostics >= MAX_DIAGNOSTICS
    }

    /// Returns the line, from 1, of an offset.
    fn line_of(&self, offset: u32) -> u32 {
        let lines = self.lines.get_or_init(|| LineIndex::new(self.source));
        lines.position(offset).line
    }
}

/// A whole text is its own surroundings.
impl<A: Actions, S: NameScope> References for Parser<'_, '_, A, S> {
    fn line(&self, offset: u32) -> u32 {
        self.line_of(offset)
    }

    fn declaration(&self, symbol: SymbolId) -> Option<(&Symbol, Span, u32)> {
        let symbol = self.parsed.symbol(symbol);
        let span = symbol.name_span.filter(|_| !self.is_expression)?;
        Some((symbol, span, self.line_of(span.start)))
    }

    fn declared_below(&self, name: &str, offset: u32) -> Option<(Span, u32)> {
        let names = self
            .declared_below
            .get_or_init(|| DeclaredNames::scan(self.source));
        let start = names.place(name).filter(|start| *start > offset)?;
        let span = Span::new(start, start + name.len() as u32);
        Some((span, self.line_of(start)))
    }

    fn nearest(&self, parameters: Option<&Trie<u32>>, word: &str, _: u32) -> Option<String> {
        Search::nearest(word, |search| {
            if let Some(parameters) = parameters {
                search.among(parameters, |_| true);
            }
            self.parsed.search(search);
        })
    }
}
