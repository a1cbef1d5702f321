//! A text as the features see it: one pass of the parser's hooks in, tokens with their meanings out.

use std::collections::{BTreeSet, HashSet};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use scene::Compilation;
use syntax::actions::{Actions, Declaration, Interval, Operator, Parameter};
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::parse_program;
use syntax::span::Span;
use syntax::symbols::{Symbol, Symbols};
use syntax::token::{DeclareWord, SymbolId, Token, TokenKind};

/// A text, read once. Offsets are bytes of the text.
#[derive(Debug)]
pub struct Reading {
    text: Arc<str>,
    tokens: Vec<Token>,
    items: Vec<Item>,
    symbols: Symbols,
    operands: Vec<Span>,
    compilation: OnceLock<Compilation>,
    dependent: OnceLock<HashSet<SymbolId>>,
}

/// A declaration as it stands in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// The word that opens it.
    pub word: DeclareWord,
    /// From the word to the `;`.
    pub span: Span,
    /// Its name; empty where none was read.
    pub name: String,
    /// Where the name stands.
    pub name_span: Span,
    /// What it declares, unless its name was not read or not free.
    pub symbol: Option<SymbolId>,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Whether an error lies in it.
    pub faulty: bool,
    /// Its intervals, from `[` to `]`.
    pub intervals: Vec<Span>,
}

/// What a token stands for.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Target {
    /// A name that is declared or builtin.
    Symbol(SymbolId),
    /// A parameter of the declaration at this position in [`Reading::items`], by its position in the list.
    Parameter {
        /// The declaration.
        item: usize,
        /// The parameter.
        position: usize,
    },
}

impl Reading {
    /// Reads a text.
    pub fn new(text: impl Into<Arc<str>>) -> Self {
        let text = text.into();
        let mut reader = Reader::default();
        let parsed = parse_program(&text, &scene::vocabulary(), &mut reader);
        // A bracket is read before what it holds.
        reader.operands.sort_unstable();
        reader.operands.dedup();
        Self {
            text,
            tokens: reader.tokens,
            items: reader.items,
            symbols: parsed.symbols,
            operands: reader.operands,
            compilation: OnceLock::new(),
            dependent: OnceLock::new(),
        }
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Every token, comments too, in the order of the text.
    pub fn tokens(&self) -> &[Token] {
        &self.tokens
    }

    /// Every declaration, in the order of the text.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// Every symbol, the builtins first.
    pub fn symbols(&self) -> &Symbols {
        &self.symbols
    }

    /// Every operand and operation of the expressions, by its start.
    pub fn operands(&self) -> &[Span] {
        &self.operands
    }

    /// What the text compiles to; compiled when first asked for.
    pub fn compilation(&self) -> &Compilation {
        self.compilation.get_or_init(|| scene::compile(&self.text))
    }

    /// What some declarations (positions in [`Reading::items`]) and all that they use compile to, in time proportional
    /// to them: values are told whatever else is being written. Declarations with errors are left out, and what uses
    /// them; none if nothing is sound. No word is read otherwise than in the text: a name that no word uses can go.
    pub fn compile_alone(&self, items: impl IntoIterator<Item = usize>) -> Option<Compilation> {
        let mut kept = BTreeSet::new();
        let mut open: Vec<usize> = items.into_iter().collect();
        while let Some(k) = open.pop() {
            if kept.insert(k) {
                let used = self.symbols_in(self.items[k].span);
                open.extend(used.filter_map(|id| self.item_of(id)));
            }
        }
        self.prune(&mut kept, |k| {
            self.items[k].faulty || self.items[k].symbol.is_none()
        });
        // Where something is wrong in the first round, nothing is in the second.
        for _ in 0..2 {
            let mut text = String::new();
            let mut starts: Vec<(u32, usize)> = Vec::new();
            for &k in &kept {
                starts.push((text.len() as u32, k));
                text.push_str(self.items[k].span.text(&self.text));
                text.push('\n');
            }
            if kept.is_empty() {
                return None;
            }
            let compilation = scene::compile(&text);
            if compilation.scene.is_some() {
                return Some(compilation);
            }
            let errors = compilation.diagnostics.iter();
            let errors = errors.filter(|d| d.severity == Severity::Error);
            let wrong: HashSet<usize> = errors
                .filter_map(|d| {
                    let after = starts.partition_point(|(start, _)| *start <= d.span.start);
                    Some(starts.get(after.checked_sub(1)?)?.1)
                })
                .collect();
            self.prune(&mut kept, |k| wrong.contains(&k));
        }
        None
    }

    /// Leaves out what is wrong, and what uses what has been left out: declarations only use what stands above them.
    fn prune(&self, kept: &mut BTreeSet<usize>, is_wrong: impl Fn(usize) -> bool) {
        let mut lost: HashSet<SymbolId> = HashSet::new();
        kept.retain(|&k| {
            let item = &self.items[k];
            let stays = !is_wrong(k) && !self.symbols_in(item.span).any(|id| lost.contains(&id));
            if !stays {
                lost.extend(item.symbol);
            }
            stays
        });
    }

    /// The symbols that the tokens in a range stand for.
    fn symbols_in(&self, span: Span) -> impl Iterator<Item = SymbolId> + '_ {
        let tokens = self.tokens[self.tokens_in(span)].iter();
        tokens.filter_map(|token| match token.kind {
            TokenKind::Constant(id) | TokenKind::Function(id) => Some(id),
            _ => None,
        })
    }

    /// What is wrong with the text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.compilation().diagnostics
    }

    /// The tokens that touch a range, as positions in [`Reading::tokens`].
    pub fn tokens_in(&self, span: Span) -> Range<usize> {
        let first = self.tokens.partition_point(|t| t.span.end <= span.start);
        let last = self.tokens.partition_point(|t| t.span.start < span.end);
        first..last.max(first)
    }

    /// The token at a place: the one that holds it, or else the word or number that ends there.
    pub fn token_at(&self, offset: u32) -> Option<usize> {
        let next = self.tokens.partition_point(|t| t.span.end <= offset);
        let holds = |k: usize| {
            let token = self.tokens.get(k)?;
            (token.span.start <= offset && offset < token.span.end).then_some(k)
        };
        let is_word = |k: &usize| {
            self.text.as_bytes()[self.tokens[*k].span.start as usize].is_ascii_alphanumeric()
        };
        let ends = || {
            let k = next.checked_sub(1)?;
            (self.tokens[k].span.end == offset).then_some(k)
        };
        match holds(next) {
            Some(k) if is_word(&k) => Some(k),
            found => ends().filter(is_word).or(found).or_else(ends),
        }
    }

    /// The declaration that holds a place, or ends there.
    pub fn item_at(&self, offset: u32) -> Option<usize> {
        let after = self.items.partition_point(|item| item.span.start <= offset);
        let k = after.checked_sub(1)?;
        (offset <= self.items[k].span.end).then_some(k)
    }

    /// The declaration of a symbol; none for a builtin.
    pub fn item_of(&self, symbol: SymbolId) -> Option<usize> {
        let place = self.symbols.get(symbol)?.name_span?;
        let found = self
            .items
            .binary_search_by_key(&place.start, |item| item.name_span.start);
        found.ok()
    }

    /// What a token stands for, at its declaration too.
    pub fn target(&self, token: usize) -> Option<Target> {
        let Token { kind, span } = *self.tokens.get(token)?;
        match kind {
            TokenKind::Constant(id) | TokenKind::Function(id) => {
                // Where a name that is taken is declared again, the word is no use of it.
                Some(Target::Symbol(id)).filter(|_| !self.declares_taken(span))
            }
            TokenKind::Variable(position) => {
                let position = position as usize;
                let item = match self.derived_function(token) {
                    Some(function) => self.item_of(function)?,
                    None => self.item_at(span.start)?,
                };
                Some(Target::Parameter { item, position })
            }
            TokenKind::Undefined => {
                let item = self.item_at(span.start)?;
                let declaration = &self.items[item];
                if declaration.name_span == span {
                    return declaration.symbol.map(Target::Symbol);
                }
                let position = declaration.parameters.iter().position(|p| p.span == span)?;
                Some(Target::Parameter { item, position })
            }
            _ => None,
        }
    }

    /// Whether a token stands where a name is introduced.
    pub fn introduces(&self, span: Span) -> bool {
        self.item_at(span.start).is_some_and(|item| {
            let item = &self.items[item];
            item.name_span == span && item.symbol.is_some()
                || item.parameters.iter().any(|p| p.span == span)
        })
    }

    fn declares_taken(&self, span: Span) -> bool {
        self.item_at(span.start).is_some_and(|item| {
            let item = &self.items[item];
            item.symbol.is_none() && item.name_span == span
                || item.parameters.iter().any(|p| p.span == span)
        })
    }

    /// The function whose parameter a token behind `_` names: `f_u`, `f_u_v`, `f'_u`.
    fn derived_function(&self, token: usize) -> Option<SymbolId> {
        let mut at = token.checked_sub(1)?;
        if self.tokens[at].kind != TokenKind::Underscore {
            return None;
        }
        loop {
            at = at.checked_sub(1)?;
            match self.tokens[at].kind {
                TokenKind::Function(id) => return Some(id),
                TokenKind::Variable(_) | TokenKind::Underscore | TokenKind::Prime => {}
                _ => return None,
            }
        }
    }

    /// The name of what a token stands for.
    pub fn name(&self, target: Target) -> &str {
        match target {
            Target::Symbol(id) => self.symbols.get(id).map_or("", |symbol| &symbol.name),
            Target::Parameter { item, position } => &self.items[item].parameters[position].name,
        }
    }

    /// Every token that stands for `target`, where it is introduced first, as positions in [`Reading::tokens`].
    pub fn occurrences(&self, target: Target) -> Vec<usize> {
        let name = self.name(target);
        (0..self.tokens.len())
            // The text is compared before the meaning is looked for.
            .filter(|&k| self.tokens[k].span.text(&self.text) == name)
            .filter(|&k| self.target(k) == Some(target))
            .collect()
    }

    /// Whether a symbol reads a param or a grid, directly or not.
    pub fn depends_on_settings(&self, symbol: SymbolId) -> bool {
        self.dependent
            .get_or_init(|| self.dependent())
            .contains(&symbol)
    }

    /// Declarations only use what stands above them, so one pass downwards sees all.
    fn dependent(&self) -> HashSet<SymbolId> {
        let mut dependent = HashSet::new();
        for item in &self.items {
            let Some(symbol) = item.symbol else { continue };
            let itself = matches!(item.word, DeclareWord::Param | DeclareWord::Grid);
            if itself || self.symbols_in(item.span).any(|id| dependent.contains(&id)) {
                dependent.insert(symbol);
            }
        }
        dependent
    }

    /// The symbols that may be used at a place, with their identifiers: the builtins and what is declared above.
    pub fn visible(&self, offset: u32) -> impl Iterator<Item = (SymbolId, &Symbol)> {
        let limit = self
            .item_at(offset)
            .map_or(offset, |item| self.items[item].span.start);
        self.symbols
            .iter()
            .filter(move |(_, symbol)| symbol.name_span.is_none_or(|span| span.start < limit))
            // A name that was not free is no name.
            .filter(|(_, symbol)| !symbol.name.is_empty())
    }
}

/// Collects what the features need as the parser goes.
#[derive(Default)]
struct Reader {
    tokens: Vec<Token>,
    items: Vec<Item>,
    operands: Vec<Span>,
    intervals: Vec<Span>,
}

impl Actions for Reader {
    fn act_advance(&mut self, token: Token) {
        self.tokens.push(token);
    }

    fn act_operator(&mut self, _operator: Operator, span: Span) {
        self.operands.push(span);
    }

    fn act_interval(&mut self, interval: Interval) {
        self.intervals.push(interval.span);
    }

    fn act_declaration(&mut self, declaration: &Declaration<'_>) {
        self.items.push(Item {
            word: declaration.word,
            span: declaration.span,
            name: declaration.name.to_owned(),
            name_span: declaration.name_span,
            symbol: declaration.symbol,
            parameters: declaration.parameters.to_vec(),
            faulty: declaration.faulty,
            intervals: std::mem::take(&mut self.intervals),
        });
    }
}
