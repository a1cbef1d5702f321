//! The handle of a symbol.

/// Identifies a symbol: a builtin or a declared name. The builtins come first, in the order in which the language lists
/// them. If a whole text is read at once, the declared names follow in the order of the text.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct SymbolId(pub u32);
