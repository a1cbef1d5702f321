//! Productions of a grammar as data.
//!
//! A language states its productions with `productions!`, in the LL(1) form that its parser follows. Tests compute their
//! tables, and hold the parsers to them.

/// A step of a production over nonterminals `N` and terminals `T`.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Item<N, T> {
    /// A token.
    T(T),
    /// A text that a nonterminal derives.
    N(N),
}

/// One alternative of a nonterminal; an empty one derives nothing.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Production<N: 'static, T: 'static> {
    /// The nonterminal.
    pub left: N,
    /// The steps that it derives.
    pub right: &'static [Item<N, T>],
}

/// A list of [`Production`]s. `N(Expr)` is `Nonterminal::Expr`, `T(Plus)` is `Terminal::Plus`, and `K(Param)`, in a language
/// with a kind of terminals for its keywords, `Terminal::Keyword(Keyword::Param)`, with the names of the place of the call.
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
