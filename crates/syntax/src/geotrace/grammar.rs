//! The productions of the language as data, in the LL(1) form that the parser follows: left recursion is replaced by
//! tails, and common prefixes are factored out. Tests compute FIRST and FOLLOW from this table, and compare the table
//! with the parser on random texts, and with the productions in the language's documentation.

use crate::geotrace::declarations::DeclarationKeyword as Keyword;
use crate::geotrace::token::{TokenKind, with_symbols};
use crate::productions::{self, productions};

macro_rules! terminals {
    ($($symbol:ident $byte:literal)*) => {
        /// A token as a terminal of the productions.
        #[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
        #[allow(missing_docs)]
        pub enum Terminal {
            /// A keyword that opens a declaration.
            Keyword(Keyword),
            /// A new name.
            Id,
            Const,
            /// A function's name.
            Func,
            Var,
            Num,
            /// The name of a parameter before its interval. The lexer reads it as a variable.
            Tag,
            /// The word of an attribute whose value is an expression.
            Attr,
            /// The word of an attribute whose value is a word.
            Key,
            /// The value of such an attribute.
            Word,
            /// `scale` or `rotate`.
            Map,
            $($symbol,)*
        }

        impl Terminal {
            /// Returns the terminal of a token; `None` for comments, errors and the end of input. An undefined word is
            /// a name, which expressions do not contain.
            pub fn from_token(kind: TokenKind) -> Option<Self> {
                Some(match kind {
                    TokenKind::Declare(keyword) => Self::Keyword(keyword),
                    TokenKind::Undefined => Self::Id,
                    TokenKind::Constant(_) => Self::Const,
                    TokenKind::Function(_) => Self::Func,
                    TokenKind::Variable(_) => Self::Var,
                    TokenKind::Number(_) => Self::Num,
                    TokenKind::Attribute(word) if word.is_key() => Self::Key,
                    TokenKind::Attribute(_) => Self::Attr,
                    TokenKind::Word => Self::Word,
                    TokenKind::Map(_) => Self::Map,
                    $(TokenKind::$symbol => Self::$symbol,)*
                    TokenKind::Comment | TokenKind::Error | TokenKind::Eoi => return None,
                })
            }
        }
    };
}

with_symbols!(terminals);

/// A nonterminal. A `…Tail` is the rest of a list or a chain of operators after the first operand.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
#[allow(missing_docs)]
pub enum Nonterminal {
    Prog,
    Decl,
    /// The initial value of a param.
    Opening,
    /// The start of a geodesic, if it has a direction.
    Origin,
    Fdecl,
    Head,
    Ids,
    IdsTail,
    Int,
    Ints,
    IntsTail,
    Grid,
    Grids,
    GridsTail,
    /// Further items, or none.
    Attrs,
    Items,
    Item,
    /// The number of samples of an interval.
    Count,
    /// A solid after its name.
    Body,
    /// A light after its `=`.
    Light,
    /// A background after its name.
    Sky,
    Set,
    SetTail,
    Meet,
    MeetTail,
    Put,
    PutTail,
    Place,
    /// The rest of a placement that begins with a function: an image under it, or an expression.
    Image,
    Atom,
    Expr,
    Add,
    AddTail,
    Jux,
    JuxTail,
    Mult,
    MultTail,
    Mult2,
    Unary,
    App,
    Func,
    FuncTail,
    Func2,
    Func2Tail,
    Pow,
    PowTail,
    Comp,
    CompTail,
    Fact,
    Tuple,
    TupleTail,
}

/// One alternative of a nonterminal.
pub type Production = productions::Production<Nonterminal, Terminal>;

/// The grammar; its start symbol is [`Nonterminal::Prog`].
pub const PRODUCTIONS: &[Production] = {
    productions! {
        Prog = N(Decl) N(Prog);
        Prog =;

        Decl = K(Param) T(Id) N(Opening) T(Colon) N(Ints) T(Semicolon);
        Decl = K(Grid) T(Id) T(Colon) N(Grids) T(Semicolon);
        Decl = K(Define) T(Id) T(Equals) N(Expr) T(Semicolon);
        Decl = K(Function) N(Fdecl) T(Semicolon);
        Decl = K(Curve) N(Fdecl) T(Comma) N(Items) T(Semicolon);
        Decl = K(Surface) N(Fdecl) T(Comma) N(Items) T(Semicolon);
        Decl = K(Point) T(Id) T(Equals) N(Expr) N(Attrs) T(Semicolon);
        Decl = K(Vector) T(Id) T(Equals) N(Expr) T(At) N(Expr) N(Attrs) T(Semicolon);
        Decl = K(Metric) N(Fdecl) T(Comma) N(Items) T(Semicolon);
        Decl = K(Geodesic) N(Head) T(Colon) T(Func) T(Equals) N(Expr) N(Origin) T(Comma) N(Items) T(Semicolon);
        Decl = K(Solid) T(Id) N(Body) N(Attrs) T(Semicolon);
        Decl = K(Light) T(Id) T(Equals) N(Light) N(Attrs) T(Semicolon);
        Decl = K(Camera) T(Id) T(Equals) N(Expr) T(At) N(Expr) N(Attrs) T(Semicolon);
        Decl = K(Background) T(Id) N(Sky) N(Attrs) T(Semicolon);

        Opening = T(Equals) N(Expr);
        Opening =;
        Origin = T(At) N(Expr);
        Origin =;
        Fdecl = N(Head) T(Equals) N(Expr);
        Head = T(Id) T(ParenOpen) N(Ids) T(ParenClose);
        Ids = T(Id) N(IdsTail);
        IdsTail = T(Comma) T(Id) N(IdsTail);
        IdsTail =;

        Int = T(BracketOpen) N(Expr) T(Comma) N(Expr) T(BracketClose);
        Ints = N(Int) N(IntsTail);
        IntsTail = T(Comma) N(Int) N(IntsTail);
        IntsTail =;
        Grid = T(BracketOpen) N(Expr) T(Comma) N(Expr) T(Comma) N(Expr) T(BracketClose);
        Grids = N(Grid) N(GridsTail);
        GridsTail = T(Comma) N(Grid) N(GridsTail);
        GridsTail =;
        Attrs = T(Comma) N(Item) N(Attrs);
        Attrs =;
        Items = N(Item) N(Attrs);
        Item = T(Tag) T(Colon) T(BracketOpen) N(Expr) T(Comma) N(Expr) N(Count) T(BracketClose);
        Item = T(Attr) T(Colon) N(Expr);
        Item = T(Key) T(Colon) T(Word);
        Count = T(Comma) N(Expr);
        Count =;

        Body = T(ParenOpen) N(Ids) T(ParenClose) T(Equals) N(Expr);
        Body = T(Equals) N(Set);
        Light = T(At) N(Expr);
        Light = N(Expr) N(Origin);
        Sky = T(ParenOpen) N(Ids) T(ParenClose) T(Equals) N(Expr);
        Sky = T(Equals) N(Expr);
        Set = N(Meet) N(SetTail);
        SetTail = T(Bar) N(Meet) N(SetTail);
        SetTail = T(Backslash) N(Meet) N(SetTail);
        SetTail =;
        Meet = N(Put) N(MeetTail);
        MeetTail = T(Ampersand) N(Put) N(MeetTail);
        MeetTail =;
        Put = N(Atom) N(PutTail);
        PutTail = T(At) N(Place) N(PutTail);
        PutTail =;
        Place = T(Map) N(Unary);
        Place = N(Func2) N(Image);
        Place = N(Pow) N(MultTail) N(JuxTail) N(AddTail);
        Place = T(Plus) N(Unary) N(MultTail) N(JuxTail) N(AddTail);
        Place = T(Minus) N(Unary) N(MultTail) N(JuxTail) N(AddTail);
        Place = T(Star) N(Unary) N(MultTail) N(JuxTail) N(AddTail);
        Place = T(Slash) N(Unary) N(MultTail) N(JuxTail) N(AddTail);
        Image = N(FuncTail) N(Unary) N(MultTail) N(JuxTail) N(AddTail);
        Image =;
        Atom = T(Func);
        Atom = T(ParenOpen) N(Set) T(ParenClose);
        Atom = T(BracketOpen) N(Set) T(BracketClose);
        Atom = T(BraceOpen) N(Set) T(BraceClose);

        Expr = N(Add);
        Add = N(Jux) N(AddTail);
        AddTail = T(Plus) N(Jux) N(AddTail);
        AddTail = T(Minus) N(Jux) N(AddTail);
        AddTail =;
        Jux = N(Mult) N(JuxTail);
        JuxTail = N(Mult2) N(JuxTail);
        JuxTail =;
        Mult = N(Unary) N(MultTail);
        MultTail = T(Star) N(Unary) N(MultTail);
        MultTail = T(Slash) N(Unary) N(MultTail);
        MultTail =;
        Mult2 = N(App) N(MultTail);
        Unary = T(Plus) N(Unary);
        Unary = T(Minus) N(Unary);
        Unary = T(Star) N(Unary);
        Unary = T(Slash) N(Unary);
        Unary = N(App);
        App = N(Func) N(Unary);
        App = N(Pow);
        Func = N(Func2) N(FuncTail);
        FuncTail = T(Caret) N(Unary);
        FuncTail =;
        Func2 = T(Func) N(Func2Tail);
        Func2Tail = T(Underscore) T(Var) N(Func2Tail);
        Func2Tail = T(Prime) N(Func2Tail);
        Func2Tail =;
        Pow = N(Comp) N(PowTail);
        PowTail = T(Caret) N(Unary);
        PowTail =;
        Comp = N(Fact) N(CompTail);
        CompTail = T(Underscore) T(Num) N(CompTail);
        CompTail =;
        Fact = T(Const);
        Fact = T(Num);
        Fact = T(Var);
        Fact = T(ParenOpen) N(Tuple) T(ParenClose);
        Fact = T(BracketOpen) N(Tuple) T(BracketClose);
        Fact = T(BraceOpen) N(Tuple) T(BraceClose);
        Tuple = N(Add) N(TupleTail);
        TupleTail = T(Comma) N(Add) N(TupleTail);
        TupleTail =;
    }
};
