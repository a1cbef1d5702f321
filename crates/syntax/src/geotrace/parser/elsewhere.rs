//! What a diagnostic tells of other places of the text: lines, names that are declared above or below, names
//! that are spelt alike.
//!
//! A declaration's own diagnostics flow in, each with what it wants to know ([`Elsewhere`]). The finished
//! diagnostic flows out. It is a step of its own because the answers change when nothing of the declaration
//! does: a line inserted at the top of a text moves every line below.

use super::messages::quote;
use crate::diagnostic::{Diagnostic, Fix, Related};
use crate::span::Span;
use crate::symbol::SymbolId;
use crate::trie::Trie;

/// How many words that mean nothing are looked up in a text for names that are spelt alike: the first ones.
/// Ten thousand misspelt words among ten thousand names would take longer than anyone reads.
pub(crate) const MAX_SEARCHES: usize = 1_000;

/// What is still to be told.
#[derive(Clone, Debug)]
pub(crate) enum Elsewhere {
    /// Where the name is declared that cannot be declared again.
    Taken(SymbolId),
    /// The function is declared there.
    Declared(SymbolId),
    /// The `;` is missing after the token, as it is described here, that starts at this offset.
    Semicolon { after: String, offset: u32 },
    /// A word that means nothing.
    Undefined(Undefined),
}

/// A word that means nothing: it may be declared below, or spelt wrong.
#[derive(Clone, Debug)]
pub(crate) struct Undefined {
    /// The whole word, and where it starts.
    pub(crate) whole: String,
    /// What is left of it once the tokens before have been split off.
    pub(crate) word: String,
    /// Where that starts.
    pub(crate) offset: u32,
    /// What to do about it, where that follows from the declaration alone.
    pub(crate) hint: Option<String>,
    /// The parameters that may have been meant.
    pub(crate) parameters: Option<Trie<u32>>,
}

/// What can be asked of the text around a declaration.
pub(crate) trait Surroundings {
    /// The line, from 1, of an offset of the declaration.
    fn line(&self, offset: u32) -> u32;

    /// A symbol that is declared in the text: its name, its word, the place of the name and its line. None
    /// for a builtin.
    fn declaration(&self, symbol: SymbolId) -> Option<(&str, &'static str, Span, u32)>;

    /// The last place in the text where the name stands behind a declaring word, if that comes after this
    /// offset of the declaration, and its line.
    fn declared_below(&self, name: &str, offset: u32) -> Option<(Span, u32)>;

    /// The name defined above this offset of the declaration that is spelt most like the word, or the
    /// parameter.
    fn nearest(&self, parameters: Option<&Trie<u32>>, word: &str, offset: u32) -> Option<String>;
}

impl Elsewhere {
    /// Whether names that are spelt alike may be looked for.
    pub(crate) fn is_search(&self) -> bool {
        matches!(self, Self::Undefined(_))
    }

    /// Finishes a diagnostic. `searches` words that mean nothing have been reported before it.
    pub(crate) fn complete(
        &self,
        diagnostic: &mut Diagnostic,
        around: &impl Surroundings,
        searches: usize,
    ) {
        match self {
            Self::Taken(symbol) => {
                if let Some((name, word, span, line)) = around.declaration(*symbol) {
                    let name = quote(name);
                    diagnostic.message =
                        format!("{name} is already declared, as a {word} in line {line}");
                    relate(diagnostic, span, format!("{name} is declared here"));
                }
            }
            Self::Declared(symbol) => {
                if let Some((_, _, span, _)) = around.declaration(*symbol) {
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
    fn complete(&self, diagnostic: &mut Diagnostic, around: &impl Surroundings, searches: usize) {
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
        if self.hint.is_none() && searches < MAX_SEARCHES {
            // The rest of a word ends where the whole does, and the diagnostic stands at it.
            let end = diagnostic.span.end;
            let split = self.word.len() < self.whole.len();
            let words = [Some(&self.whole), split.then_some(&self.word)];
            let found = words.into_iter().flatten().find_map(|word| {
                let name = around.nearest(self.parameters.as_ref(), word, self.offset)?;
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
