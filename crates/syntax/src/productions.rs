//! Productions of a grammar as data.
//!
//! A language states its productions with `productions!`, in the LL(1) form that its parser follows. Tests compute their
//! LL(1) tables and compare the parsers with them.

/// A step of a production over nonterminals `N` and terminals `T`.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Item<N, T> {
    /// A token.
    T(T),
    /// A nonterminal.
    N(N),
}

/// One alternative of a nonterminal; an empty one derives the empty text.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Production<N: 'static, T: 'static> {
    /// The nonterminal.
    pub left: N,
    /// The steps that it derives.
    pub right: &'static [Item<N, T>],
}

/// Creates a list of [`Production`]s. `N(Expr)` is `Nonterminal::Expr`, `T(Plus)` is `Terminal::Plus`, and `K(Param)`, in a
/// language whose terminals include keywords, is `Terminal::Keyword(Keyword::Param)`. The names are resolved at the call.
macro_rules! productions {
    ($($left:ident = $($item:ident($name:ident))*;)*) => {
        &[$($crate::productions::Production {
            left: Nonterminal::$left,
            right: &[$($crate::productions::productions!($item $name)),*],
        }),*]
    };
    (K $name:ident) => {
        $crate::productions::Item::T(Terminal::Keyword(Keyword::$name))
    };
    (T $name:ident) => {
        $crate::productions::Item::T(Terminal::$name)
    };
    (N $name:ident) => {
        $crate::productions::Item::N(Nonterminal::$name)
    };
}

pub(crate) use productions;
