//! The meaning of tokens, for comparing two texts: the identifiers of symbols are valid in one text only.

use std::collections::HashMap;
use std::hash::{Hash, Hasher};
use std::mem::discriminant;

use syntax::geotrace::document::Snapshot;
use syntax::geotrace::token::TokenKind;
use syntax::symbol::SymbolId;

use super::analysis::GeotraceAnalysis;

/// The meaning of a token: equal in two texts that contain the same declarations in the same order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Meaning {
    /// Anything but a name.
    Plain(TokenKind),
    /// A builtin name, as a value or a function.
    Builtin(TokenKind),
    /// A name of the declaration with this number, as a value or a function.
    Declared(usize, bool),
}

// The value of a token that is not a name follows from its text, which is hashed beside it.
impl Hash for Meaning {
    fn hash<H: Hasher>(&self, state: &mut H) {
        discriminant(self).hash(state);
        match self {
            Self::Plain(kind) | Self::Builtin(kind) => discriminant(kind).hash(state),
            Self::Declared(item, is_function) => (item, is_function).hash(state),
        }
    }
}

impl Meaning {
    /// Returns the meaning of a token of a document, without a pass over all of it.
    pub(crate) fn of(document: &Snapshot, kind: TokenKind) -> Self {
        Self::by(kind, |id| document.declaration_of(id).map(|it| it as usize))
    }

    /// Returns the meaning of a token, given the number of each symbol's declaration.
    fn by(kind: TokenKind, declaration: impl FnOnce(SymbolId) -> Option<usize>) -> Self {
        let (id, is_function) = match kind {
            TokenKind::Constant(id) => (id, false),
            TokenKind::Function(id) => (id, true),
            kind => return Self::Plain(kind),
        };
        match declaration(id) {
            Some(item) => Self::Declared(item, is_function),
            None => Self::Builtin(kind),
        }
    }
}

/// The declarations of a text by symbol.
pub(crate) struct Meanings {
    declared: HashMap<SymbolId, usize>,
}

impl Meanings {
    pub(crate) fn of(analysis: &GeotraceAnalysis) -> Self {
        let items = analysis.items();
        let declared = items.filter_map(|item| Some((item.symbol?, item.index)));
        Self {
            declared: declared.collect(),
        }
    }

    pub(crate) fn get(&self, kind: TokenKind) -> Meaning {
        Meaning::by(kind, |id| self.declared.get(&id).copied())
    }
}
