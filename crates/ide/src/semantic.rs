//! Semantic tokens: colours by meaning, in the standard types of editors.

use syntax::span::Span;

/// The type of a token, in editors' standard terms.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
#[allow(missing_docs)]
pub enum TokenType {
    Keyword,
    Function,
    Variable,
    Parameter,
    Number,
    Operator,
    Comment,
    /// The word of an attribute.
    Property,
    /// A word that is the value of an attribute.
    EnumMember,
}

impl TokenType {
    /// All types, in the order of the legend.
    pub const ALL: [Self; 9] = [
        Self::Keyword,
        Self::Function,
        Self::Variable,
        Self::Parameter,
        Self::Number,
        Self::Operator,
        Self::Comment,
        Self::Property,
        Self::EnumMember,
    ];

    /// Returns its name in the legend.
    pub fn name(self) -> &'static str {
        match self {
            Self::Keyword => "keyword",
            Self::Function => "function",
            Self::Variable => "variable",
            Self::Parameter => "parameter",
            Self::Number => "number",
            Self::Operator => "operator",
            Self::Comment => "comment",
            Self::Property => "property",
            Self::EnumMember => "enumMember",
        }
    }
}

/// The modifiers of a token, as a set of bits in the order of [`Modifiers::NAMES`].
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub struct Modifiers(pub u32);

impl Modifiers {
    /// The names, in the order of the legend: two standard ones, then the program's own.
    pub const NAMES: [&'static str; 7] = [
        "declaration",
        "defaultLibrary",
        "curve",
        "surface",
        "grid",
        "param",
        "solid",
    ];
    /// The name is introduced here.
    pub const DECLARATION: Self = Self(1);
    /// It is builtin.
    pub const DEFAULT_LIBRARY: Self = Self(1 << 1);
    /// A curve or a geodesic.
    pub const CURVE: Self = Self(1 << 2);
    /// A surface or a metric.
    pub const SURFACE: Self = Self(1 << 3);
    /// A grid.
    pub const GRID: Self = Self(1 << 4);
    /// A param.
    pub const PARAM: Self = Self(1 << 5);
    /// A solid.
    pub const SOLID: Self = Self(1 << 6);

    pub(crate) fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// A coloured piece of the text.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct SemanticToken {
    /// Its range; never more than one line.
    pub span: Span,
    /// Its type.
    pub token_type: TokenType,
    /// Its modifiers.
    pub modifiers: Modifiers,
}
