//! Deferred cross-references: the parts of a diagnostic that depend on other parts of the text, such as lines, names that
//! are declared above or below, and similarly spelt names.
//!
//! In: a declaration's own diagnostics, some with a [`Deferred`] part. Out: the completed diagnostics. Completing is a
//! separate step because the answers change while the declaration does not: a line inserted at the top of a text moves every
//! line below.

use super::messages::quote;
use crate::diagnostic::{Diagnostic, Fix, Related};
use crate::geotrace::symbols::Symbol;
use crate::span::Span;
use crate::symbol::SymbolId;
use crate::trie::Trie;

/// The number of undefined words, from the top of a text, for which similarly spelt names are searched. Ten thousand
/// misspelt words among ten thousand names would take seconds.
pub(crate) const MAX_SEARCHES: usize = 1_000;

/// The part of a diagnostic that remains to be completed.
#[derive(Clone, Debug)]
pub enum Deferred {
    /// The declaration whose name cannot be declared again.
    Taken(SymbolId),
    /// The declaration of a function.
    Declared(SymbolId),
    /// The line of the token after which a `;` is missing.
    Semicolon {
        /// The token as it is named in a sentence.
        after: String,
        /// The offset at which it starts.
        offset: u32,
    },
    /// A word that is not defined.
    Undefined(Undefined),
}

/// An undefined word: it may be declared below, or misspelt.
#[derive(Clone, Debug)]
pub struct Undefined {
    /// The whole word.
    pub(crate) whole: String,
    /// The rest of it after the tokens that have been split off.
    pub(crate) word: String,
    /// The offset at which the rest starts.
    pub(crate) offset: u32,
    /// The hint that follows from the declaration alone.
    pub(crate) hint: Option<String>,
    /// The replacement for the last bytes of the word, with their number.
    pub(crate) replacement: Option<(u32, &'static str)>,
    /// The parameters that may have been meant.
    pub(crate) parameters: Option<Trie<u32>>,
}

/// Queries about the text around a declaration.
pub(crate) trait References {
    /// Returns the line, from 1, of an offset of the declaration.
    fn line(&self, offset: u32) -> u32;

    /// Returns a symbol that the text declares, the span of its name, and the line of that span; `None` for a builtin.
    fn declaration(&self, symbol: SymbolId) -> Option<(&Symbol, Span, u32)>;

    /// Returns the last position where the text has the name after a declaration keyword, and its line, if that position is
    /// after this offset of the declaration.
    fn declared_below(&self, name: &str, offset: u32) -> Option<(Span, u32)>;

    /// Returns the name most similar in spelling to the word, among the parameters and the names defined above this
    /// offset of the declaration.
    fn nearest(&self, parameters: Option<&Trie<u32>>, word: &str, offset: u32) -> Option<String>;
}

impl Deferred {
    /// Returns true if completing it may search for similarly spelt names.
    pub(crate) fn searches(&self) -> bool {
        matches!(self, Self::Undefined(_))
    }

    /// Completes a diagnostic. `searches` is the number of diagnostics before it that searched for names.
    pub(crate) fn complete(
        &self,
        diagnostic: &mut Diagnostic,
        around: &impl References,
        searches: usize,
    ) {
        match self {
            Self::Taken(symbol) => {
                if let Some((symbol, span, line)) = around.declaration(*symbol)
                    && let Some(word) = symbol.keyword
                {
                    let (name, word) = (quote(&symbol.name), word.text());
                    diagnostic.message =
                        format!("{name} is already declared, as a {word} in line {line}");
                    relate(diagnostic, span, format!("{name} is declared here"));
                }
            }
            Self::Declared(symbol) => {
                if let Some((_, span, _)) = around.declaration(*symbol) {
                    relate(diagnostic, span, "it is declared here".to_owned());
                }
            }
            Self::Semicolon { after, offset } => {
                let line = around.line(*offset);
                diagnostic.hint = Some(format!("put a `;` after {after}, in line {line}"));
            }
            Self::Undefined(undefined) => undefined.complete(diagnostic, around, searches),
        }
    }
}

impl Undefined {
    fn complete(&self, diagnostic: &mut Diagnostic, around: &impl References, searches: usize) {
        let below = |name| around.declared_below(name, self.offset);
        if let Some((name, (span, line))) = [&self.whole, &self.word]
            .into_iter()
            .find_map(|name| Some((name, below(name)?)))
        {
            let named = if *name == self.word {
                "it".to_owned()
            } else {
                quote(name)
            };
            diagnostic.hint = Some(format!(
                "{named} is declared below, at line {line}: move it up"
            ));
            relate(diagnostic, span, "it is declared here".to_owned());
            return;
        }
        diagnostic.hint = self.hint.clone();
        if let Some((length, text)) = self.replacement {
            let end = diagnostic.span.end;
            let place = Span::new(end - length, end);
            let fix = match text {
                // The components may count to 255, which only the user can decide.
                "" if self.whole.starts_with("rgb") => Fix {
                    preferred: false,
                    ..Fix::remove(place, &self.whole)
                },
                "" => Fix::remove(place, &self.whole).with_all(),
                text => Fix::change(place, text, true).with_all(),
            };
            diagnostic.fixes.push(fix);
        }
        if self.hint.is_none() && searches < MAX_SEARCHES {
            // The rest of a word ends where the whole word does, and the diagnostic's span covers the rest.
            let end = diagnostic.span.end;
            let split = self.word.len() < self.whole.len();
            let words = [Some(&self.whole), split.then_some(&self.word)];
            let front = self.whole.strip_suffix(&self.word).unwrap_or_default();
            let found = words.into_iter().flatten().find_map(|word| {
                let name = around.nearest(self.parameters.as_ref(), word, self.offset)?;
                // In `cosx`, which is `cos x`, the rest is the mistake, unless it is the last letter once more.
                if name == front && !front.ends_with(self.word.as_str()) {
                    return None;
                }
                Some((Span::new(end - word.len() as u32, end), name))
            });
            if let Some((span, name)) = found {
                diagnostic.hint = Some(format!("did you mean `{name}`?"));
                diagnostic.fixes.push(Fix::change(span, &name, true));
            }
        }
    }
}

fn relate(diagnostic: &mut Diagnostic, span: Span, message: String) {
    diagnostic.related.push(Related { span, message });
}
