//! The kinds of coloured pieces of a text, whatever its language.

/// The kind of a coloured piece of a text.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum HighlightKind {
    /// A comment.
    Comment,
    /// A number.
    Number,
    /// A string.
    Text,
    /// A word of the language.
    Keyword,
    /// A name that stands for a value.
    Constant,
    /// A name that is applied.
    Function,
    /// A parameter.
    Variable,
    /// An operator.
    Operator,
    /// Brackets and separators.
    Punctuation,
    /// An undefined word.
    Undefined,
    /// Characters that are not a token.
    Error,
}
