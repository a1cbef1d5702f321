//! The productions of the language as data, in the LL(1) form that the parser follows: left recursion is replaced by tails, and
//! common prefixes are factored out. Tests compute FIRST and FOLLOW from this table and compare the parser with it.
//!
//! Four cells of the LL(1) table have two productions; the one that continues the expression is chosen. After an
//! expression, `+` and `-` are binary, and `[` and `(` belong to the expression ([`GREEDY`]).

use super::token::TokenKind as Terminal;
use crate::productions::{self, productions};

/// A nonterminal. A `…Tail` is the rest of a list or a chain of operators after the first operand.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
#[allow(missing_docs)]
pub enum Nonterminal {
    Script,
    Block,
    Attrs,
    Stmts,
    Stmt,
    If,
    Else,
    /// The body of an `else`, or another `if`.
    Alternative,
    Expr,
    /// The right side of an assignment, or none.
    Assign,
    Cond,
    /// The two values of a condition, or none.
    Choice,
    Or,
    OrTail,
    And,
    AndTail,
    Cmp,
    CmpTail,
    Sum,
    SumTail,
    Prod,
    ProdTail,
    Sign,
    Post,
    PostTail,
    Mods,
    ModsTail,
    Mod,
    Prim,
    Attr,
    Args,
    ArgsTail,
    Params,
    ParamsTail,
}

/// One alternative of a nonterminal.
pub type Production = productions::Production<Nonterminal, Terminal>;

/// The cells of the table with two productions: the nonempty one is chosen.
pub const GREEDY: [(Nonterminal, Terminal); 4] = [
    (Nonterminal::SumTail, Terminal::Plus),
    (Nonterminal::SumTail, Terminal::Minus),
    (Nonterminal::PostTail, Terminal::BracketOpen),
    (Nonterminal::PostTail, Terminal::ParenOpen),
];

/// The grammar; its start symbol is [`Nonterminal::Script`].
pub const PRODUCTIONS: &[Production] = {
    productions! {
        Script = N(Block) N(Script);
        Script =;
        Block = T(Settings) T(BraceOpen) N(Attrs) T(BraceClose);
        Block = T(Scene) T(BraceOpen) N(Stmts) T(BraceClose);
        Block = N(Stmt);
        Attrs = N(Attr) N(Attrs);
        Attrs =;
        Stmts = N(Stmt) N(Stmts);
        Stmts =;

        Stmt = N(Expr);
        Stmt = T(While) T(ParenOpen) N(Expr) T(ParenClose) T(BraceOpen) N(Stmts) T(BraceClose);
        Stmt = N(If);
        If = T(If) T(ParenOpen) N(Expr) T(ParenClose) T(BraceOpen) N(Stmts) T(BraceClose) N(Else);
        Else = T(Else) N(Alternative);
        Else =;
        Alternative = T(BraceOpen) N(Stmts) T(BraceClose);
        Alternative = N(If);

        Expr = N(Cond) N(Assign);
        Assign = T(Assign) N(Expr);
        Assign =;
        Cond = N(Or) N(Choice);
        Choice = T(Question) N(Expr) T(Colon) N(Cond);
        Choice =;
        Or = N(And) N(OrTail);
        OrTail = T(Or) N(And) N(OrTail);
        OrTail =;
        And = N(Cmp) N(AndTail);
        AndTail = T(And) N(Cmp) N(AndTail);
        AndTail =;
        Cmp = N(Sum) N(CmpTail);
        CmpTail = T(LessEqual) N(Sum) N(CmpTail);
        CmpTail = T(GreaterEqual) N(Sum) N(CmpTail);
        CmpTail = T(Less) N(Sum) N(CmpTail);
        CmpTail = T(Greater) N(Sum) N(CmpTail);
        CmpTail = T(Equal) N(Sum) N(CmpTail);
        CmpTail = T(NotEqual) N(Sum) N(CmpTail);
        CmpTail =;
        Sum = N(Prod) N(SumTail);
        SumTail = T(Plus) N(Prod) N(SumTail);
        SumTail = T(Minus) N(Prod) N(SumTail);
        SumTail = T(Caret) N(Prod) N(SumTail);
        SumTail =;
        Prod = N(Sign) N(ProdTail);
        ProdTail = T(Star) N(Sign) N(ProdTail);
        ProdTail = T(Slash) N(Sign) N(ProdTail);
        ProdTail = T(Percent) N(Sign) N(ProdTail);
        ProdTail =;
        Sign = T(Plus) N(Sign);
        Sign = T(Minus) N(Sign);
        Sign = T(Not) N(Sign);
        Sign = N(Post);
        Post = N(Prim) N(PostTail);
        PostTail = T(BracketOpen) N(Expr) T(BracketClose) N(PostTail);
        PostTail = T(ParenOpen) N(Args) T(ParenClose) N(PostTail);
        PostTail = T(Modify) N(Mods) T(Greater) N(PostTail);
        PostTail =;
        Mods = N(Mod) N(ModsTail);
        ModsTail = T(Comma) N(Mod) N(ModsTail);
        ModsTail =;
        Mod = T(Scale) N(Sum);
        Mod = T(Translate) N(Sum);
        Mod = T(Rotate) N(Sum);

        Prim = T(ParenOpen) N(Expr) T(ParenClose);
        Prim = T(Integer);
        Prim = T(Float);
        Prim = T(Text);
        Prim = T(True);
        Prim = T(False);
        Prim = T(Identifier);
        Prim = T(Name) T(BraceOpen) N(Attrs) T(BraceClose);
        Prim = T(BracketOpen) N(Args) T(BracketClose);
        Prim = T(Macro) T(ParenOpen) N(Params) T(ParenClose) T(BraceOpen) N(Stmts) T(BraceClose);
        Attr = T(Identifier) T(Arrow) N(Expr);
        Args = N(Expr) N(ArgsTail);
        Args =;
        ArgsTail = T(Comma) N(Expr) N(ArgsTail);
        ArgsTail =;
        Params = T(Identifier) N(ParamsTail);
        Params =;
        ParamsTail = T(Comma) T(Identifier) N(ParamsTail);
        ParamsTail =;
    }
};
