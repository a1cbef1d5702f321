//! The meaning of names: the builtins that are passed in, and the symbols that the declarations of a text define.

use std::sync::Arc;

use crate::geotrace::actions::Parameter;
use crate::geotrace::declarations::{COORDINATES, DeclarationKeyword};
use crate::geotrace::token::TokenKind;
use crate::span::Span;
use crate::spelling::Search;
use crate::symbol::SymbolId;
use crate::trie::Trie;

/// The maximum length of a name, in bytes.
pub const MAX_NAME_LENGTH: usize = 255;

/// The hint at a condition of another language.
pub const NO_CONDITIONS: &str =
    "there are no conditions: `abs`, `min` and `max` are the functions with a kink";

/// The names defined at a point of a text.
pub type SymbolTrie = Trie<SymbolId>;

/// The names that a language starts with.
#[derive(Clone, Debug, Default)]
pub struct Vocabulary {
    builtins: Vec<Symbol>,
    words: Arc<SpecialWords>,
}

/// The words of a vocabulary that are not names.
#[derive(Clone, Debug, Default)]
pub(crate) struct SpecialWords {
    /// The words of other notations.
    pub(crate) foreign: &'static [ForeignWord],
    /// The builtin functions that are words of their own only before a bracket, and only if nothing else has their name.
    pub(crate) weak: Vec<(Arc<str>, SymbolId)>,
}

/// A word of another notation, and its equivalent here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForeignWord {
    /// The word.
    pub word: &'static str,
    /// True if it applies only before a bracket, false if only without one; `None` for both.
    pub is_applied: Option<bool>,
    /// The hint.
    pub hint: &'static str,
    /// The text that replaces the word, if it is the same in every context.
    pub replacement: Option<&'static str>,
    /// True if it stands for a solid, or for an operation on solids.
    pub is_of_sets: bool,
}

/// The way in which a name is used.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum SymbolKind {
    /// A value: `pi`, and declared params, grids, defines, points, vectors.
    Constant,
    /// Applied to operands: `sin`, and declared functions, curves, surfaces, metrics, geodesics.
    Function,
}

/// A name and its meaning.
#[derive(Clone, Debug)]
pub struct Symbol {
    /// The name.
    pub name: Arc<str>,
    /// The way in which it is used.
    pub kind: SymbolKind,
    /// The keyword that declares it; `None` for a builtin.
    pub keyword: Option<DeclarationKeyword>,
    /// The span of the name in its declaration; `None` for a builtin.
    pub name_span: Option<Span>,
    /// The parameters of a declaration with parameters; empty for all others. A solid that lists none has the
    /// parameters [`COORDINATES`].
    pub parameters: Vec<Parameter>,
    /// True if its declaration contains an error, which has been reported: uses of it must not be reported.
    pub faulty: bool,
    /// The parameters by name, if there are more than [`FEW_PARAMETERS`].
    parameter_trie: Trie<u32>,
    /// The inverse of this builtin, if it is a builtin too.
    pub(crate) inverse: Option<Box<str>>,
    /// For a builtin: the special words of its vocabulary.
    pub(crate) words: Option<Arc<SpecialWords>>,
    /// True for a builtin that is a word of its own only before a bracket.
    pub(crate) is_weak: bool,
}

/// Every symbol of a text, the builtins first.
#[derive(Clone, Debug, Default)]
pub struct Symbols(Vec<Symbol>);

/// The names that the parser sees at a point of a text, and the names that it defines.
pub(crate) trait NameScope {
    /// True if the parser reads a chunk without knowing the rest of the text: the parts of diagnostics that depend on
    /// it are deferred.
    const IS_CHUNK: bool;

    /// Returns the longest name that is a prefix of `word`: its length in bytes, and its symbol.
    fn longest_prefix(&self, word: &str) -> Option<(usize, SymbolId)>;

    /// Returns the symbol with exactly this name.
    fn get(&self, name: &str) -> Option<SymbolId>;

    /// Returns a symbol by a handle that another method has returned.
    fn symbol(&self, id: SymbolId) -> &Symbol;

    /// Adds a symbol whose name is free.
    fn define(&mut self, symbol: Symbol) -> SymbolId;

    /// Records that the rest of a word, from `start` on, was looked up and its first `length` bytes became a token. Any longer
    /// name that is a prefix of the rest would have been taken instead.
    fn record_prefix_lookup(&mut self, rest: &str, start: u32, length: usize, kind: TokenKind);

    /// Returns the words that are not names; `None` if the builtins have none.
    fn words(&self) -> Option<&SpecialWords>;

    /// Passes all names to a search.
    fn search(&self, search: &mut Search<'_>);

    /// Records that exactly this name was looked up.
    fn record_name_lookup(&mut self, name: &str, start: u32, kind: TokenKind);
}

/// The names and symbols of a whole text.
#[derive(Clone, Debug, Default)]
pub struct Parsed {
    /// The names at the end of the text.
    pub trie: SymbolTrie,
    /// Their symbols.
    pub symbols: Symbols,
}

impl Vocabulary {
    /// Creates a vocabulary of builtin constants and functions. Their [`SymbolId`]s count up from 0 in this order,
    /// constants first. A name that is empty, contains characters outside `a-z A-Z 0-9` or occurs twice keeps its
    /// identifier but is never found in a text.
    pub fn new(constants: &[&str], functions: &[&str]) -> Self {
        let constants = constants.iter().map(|name| (name, SymbolKind::Constant));
        let functions = functions.iter().map(|name| (name, SymbolKind::Function));
        let builtins = constants.chain(functions).map(|(name, kind)| Symbol {
            name: Arc::from(*name),
            kind,
            keyword: None,
            name_span: None,
            parameters: Vec::new(),
            faulty: false,
            parameter_trie: Trie::default(),
            inverse: None,
            words: None,
            is_weak: false,
        });
        Self {
            builtins: builtins.collect(),
            words: Arc::default(),
        }
    }

    /// Replaces the words that are not names.
    fn set_words(&mut self, words: SpecialWords) {
        self.words = Arc::new(words);
        for builtin in &mut self.builtins {
            builtin.words = Some(Arc::clone(&self.words));
        }
    }

    /// Returns the vocabulary with words of other notations, which have no meaning here: their diagnostics show the
    /// equivalent.
    #[must_use]
    pub fn with_foreign(mut self, words: &'static [ForeignWord]) -> Self {
        let weak = self.words.weak.clone();
        self.set_words(SpecialWords {
            foreign: words,
            weak,
        });
        self
    }

    /// Returns the vocabulary with these builtin functions as words of their own only before a bracket. A text may declare
    /// their names, which then have the declared meaning.
    #[must_use]
    pub fn with_weak(mut self, functions: &[&str]) -> Self {
        let mut words = SpecialWords::clone(&self.words);
        for (builtin, id) in self.builtins.iter_mut().zip((0..).map(SymbolId)) {
            if functions.contains(&&*builtin.name) {
                builtin.is_weak = true;
                words.weak.push((Arc::clone(&builtin.name), id));
            }
        }
        self.set_words(words);
        self
    }

    /// Returns the vocabulary with `inverse` as the inverse of `function`: the warning at `sin^-1 x` then names `asin`.
    #[must_use]
    pub fn with_inverse(mut self, function: &str, inverse: &str) -> Self {
        for builtin in &mut self.builtins {
            if *builtin.name == *function {
                builtin.inverse = Some(inverse.into());
            }
        }
        self
    }

    /// Returns the builtins in the order of their handles.
    pub(crate) fn symbols(&self) -> &[Symbol] {
        &self.builtins
    }

    /// Returns the names at the start of a text.
    pub(crate) fn start(&self) -> Parsed {
        let mut parsed = Parsed::default();
        for symbol in &self.builtins {
            parsed.define(symbol.clone());
        }
        parsed
    }
}

/// The maximum number of parameters for linear search: for these a trie takes more memory and is not faster.
const FEW_PARAMETERS: usize = 8;

impl Symbol {
    /// Creates a symbol that a declaration introduces. `trie` contains its parameters by name; of equal names, the
    /// first.
    pub(crate) fn declared(
        name: &str,
        keyword: DeclarationKeyword,
        name_span: Span,
        parameters: Vec<Parameter>,
        trie: Trie<u32>,
        faulty: bool,
    ) -> Self {
        let kind = match keyword.declares_function(!parameters.is_empty()) {
            true => SymbolKind::Function,
            false => SymbolKind::Constant,
        };
        let is_long = parameters.len() > FEW_PARAMETERS;
        Self {
            name: name.into(),
            kind,
            keyword: Some(keyword),
            name_span: Some(name_span),
            parameters,
            faulty,
            parameter_trie: if is_long { trie } else { Trie::default() },
            inverse: None,
            words: None,
            is_weak: false,
        }
    }

    /// Returns the parameters that make up a text, one after the other; `None` if it contains anything else.
    pub(crate) fn split_parameters<'t>(&self, text: &'t str) -> Option<Vec<&'t str>> {
        let mut names = Vec::new();
        let mut rest = text;
        while !rest.is_empty() {
            let (length, _) = self.longest_parameter(rest)?;
            let (name, behind) = rest.split_at(length);
            names.push(name);
            rest = behind;
        }
        Some(names)
    }

    /// Returns the longest parameter that is a prefix of a word; of equal ones, the first. Returns its length in bytes
    /// and its index.
    pub(crate) fn longest_parameter(&self, word: &str) -> Option<(usize, u32)> {
        if self.parameters.is_empty() && self.keyword == Some(DeclarationKeyword::Solid) {
            let named = COORDINATES.iter().position(|name| word.starts_with(name));
            return named.map(|position| (1, position as u32));
        }
        if self.parameters.len() > FEW_PARAMETERS {
            return self.parameter_trie.longest_prefix(word);
        }
        let mut longest = None;
        for (parameter, position) in self.parameters.iter().zip(0..) {
            let length = parameter.name.len();
            let known = longest.map_or(0, |(length, _)| length);
            if length > known && word.starts_with(&parameter.name) {
                longest = Some((length, position));
            }
        }
        longest
    }
}

impl NameScope for Parsed {
    const IS_CHUNK: bool = false;

    #[inline]
    fn longest_prefix(&self, word: &str) -> Option<(usize, SymbolId)> {
        self.trie.longest_prefix(word)
    }

    #[inline]
    fn get(&self, name: &str) -> Option<SymbolId> {
        self.trie.get(name)
    }

    #[inline]
    fn symbol(&self, id: SymbolId) -> &Symbol {
        &self.symbols[id]
    }

    fn define(&mut self, symbol: Symbol) -> SymbolId {
        Self::define(self, symbol)
    }

    #[inline]
    fn words(&self) -> Option<&SpecialWords> {
        self.symbols.0.first()?.words.as_deref()
    }

    fn search(&self, search: &mut Search<'_>) {
        search.among(&self.trie, |_| true);
    }

    #[inline]
    fn record_prefix_lookup(&mut self, _: &str, _: u32, _: usize, _: TokenKind) {}

    #[inline]
    fn record_name_lookup(&mut self, _: &str, _: u32, _: TokenKind) {}
}

impl Parsed {
    /// Adds a symbol under the next identifier, and its name to the trie unless the name is taken or found before brackets
    /// only.
    pub(crate) fn define(&mut self, symbol: Symbol) -> SymbolId {
        let id = SymbolId(self.symbols.0.len() as u32);
        if !symbol.is_weak && self.trie.get(&symbol.name).is_none() {
            // A name outside the trie's alphabet is never found.
            let _ = self.trie.insert(&symbol.name, id);
        }
        self.symbols.0.push(symbol);
        id
    }
}

impl SpecialWords {
    /// Returns the builtin function with this name that is a word of its own only before a bracket.
    pub(crate) fn weak(&self, word: &str) -> Option<SymbolId> {
        let mut all = self.weak.iter();
        all.find(|(name, _)| **name == *word).map(|(_, id)| *id)
    }
}

impl Symbols {
    /// Returns the symbol, unless it belongs to another text.
    pub fn get(&self, id: SymbolId) -> Option<&Symbol> {
        self.0.get(id.0 as usize)
    }

    /// Returns all symbols in the order of their identifiers.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (SymbolId, &Symbol)> {
        let ids = 0..self.0.len() as u32;
        ids.map(SymbolId).zip(&self.0)
    }

    /// Returns the number of symbols.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns true if there are no symbols, not even builtins.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl std::ops::Index<SymbolId> for Symbols {
    type Output = Symbol;

    /// # Panics
    /// If the handle belongs to another text.
    fn index(&self, id: SymbolId) -> &Symbol {
        &self.0[id.0 as usize]
    }
}
