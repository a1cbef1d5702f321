//! The semantic hooks: what a compiler, a highlighter, an outline or a formatter implements.

use crate::diagnostic::Diagnostic;
use crate::geotrace::attributes::AttributeWord;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::token::Token;
use crate::span::Span;
use crate::symbol::SymbolId;

/// One step of an expression, in postfix order: each pops its operands from an imagined stack and pushes
/// one result. `Function`, `Partial`, `Total` and `FunctionPower` build a function, `Apply` applies it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operator {
    /// Pushes a number.
    Number(f64),
    /// Pushes the value of a declared or builtin constant.
    Constant(SymbolId),
    /// Pushes a parameter of the body that is being read, by its position.
    Variable(u32),
    /// Pushes a function. That of a geodesic's surface or metric comes alone, before its direction and start.
    Function(SymbolId),
    /// `f_u`: function → its derivative by its parameter at this position.
    Partial(u32),
    /// `f'`: function → its derivative.
    Total,
    /// `f^n`: function, exponent → function.
    FunctionPower,
    /// `f x`: function, operand → value.
    Apply,
    /// `a + b`.
    Add,
    /// `a - b`.
    Subtract,
    /// `a b`, juxtaposed.
    Juxtapose,
    /// `a * b`.
    Multiply,
    /// `a / b`.
    Divide,
    /// `a ^ b`.
    Power,
    /// `+a`.
    Plus,
    /// `-a`.
    Negate,
    /// `*a`.
    Square,
    /// `/a`.
    Reciprocal,
    /// `a_n`: the component, from 1.
    Component(u32),
    /// A bracketed list of this many values; 1 for a bracketed single value or set, which it leaves as it is.
    Tuple(u32),
    /// `@ a` of a light that has no direction: value → the same value, which is its place.
    Position,
    /// Function → the set of points that it stands for: a solid, or the points where it is not positive.
    Atom,
    /// `a | b`: two sets → the points of either.
    Union,
    /// `a & b`: two sets → the points of both.
    Intersection,
    /// `a \ b`: two sets → the points of the first that are not of the second.
    Difference,
    /// `a @ v`: set, vector → the set, moved.
    Move,
    /// `a @ scale v`: set, number or vector → the set, scaled.
    Scale,
    /// `a @ rotate v`: set, vector → the set, turned about the vector by its length.
    Rotate,
    /// `a @ f`: set, function → its image under the function.
    Image,
}

/// The form of an interval.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum IntervalKind {
    /// `[a, b]`: pops two values.
    Range,
    /// `[a, b, n]`: pops three values.
    Grid,
}

/// An interval; its ends (and count) are the last values on the stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The kind: with or without a count.
    pub kind: IntervalKind,
    /// The span from `[` to `]`.
    pub span: Span,
    /// For what has parameters: the position of the parameter that the tag names, where it names one,
    /// and the tag's own place. A tag that is missing, or names no parameter, has been reported.
    pub tag: Option<(Option<u32>, Span)>,
}

/// An attribute that a declaration states. If its value is an expression, that is the last value on the stack.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub struct StatedAttribute {
    /// The word.
    pub word: AttributeWord,
    /// The span of the word.
    pub word_span: Span,
    /// The span of the value: of the expression, or of the word.
    pub value_span: Span,
}

/// A parameter in a declaration's list.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its span in the list.
    pub span: Span,
}

/// A declaration that has been read to its end; its expressions, intervals and attributes came before. Those of a param are
/// the value that it opens with, if one is written, and its intervals. Those of a light are its direction, if it has one, and
/// its place, if it has one.
#[derive(Clone, Debug, PartialEq)]
pub struct Declaration<'a> {
    /// Its keyword.
    pub keyword: DeclarationKeyword,
    /// The span from the keyword to the `;`.
    pub span: Span,
    /// The symbol that it declares. `None` if its name was not read or not free.
    pub symbol: Option<SymbolId>,
    /// The name as written; empty if it was not read.
    pub name: &'a str,
    /// The span of the name; empty if it was not read.
    pub name_span: Span,
    /// The parameters that it lists. A solid that lists none has the parameters x, y and z.
    pub parameters: &'a [Parameter],
    /// An error lies in it, and has been reported: what the stack holds may be incomplete and is to be
    /// dropped, and uses of the name are to be silent.
    pub faulty: bool,
}

/// The hooks that the parser calls. All do nothing unless implemented.
#[expect(unused_variables, reason = "a default uses no argument")]
pub trait Actions {
    /// The parser moved past a token. Comes for every token, comments and tokens skipped by recovery too,
    /// in the order of the text and without gaps but for white space; the end of input is not reported.
    fn act_advance(&mut self, token: Token) {}

    /// A declaration starts: its keyword has just been read.
    fn act_declaration_start(&mut self, keyword: DeclarationKeyword, span: Span) {}

    /// One step of an expression. `span` covers the operator with its operands. No more come in a
    /// declaration once an error has made them incomplete.
    fn act_operator(&mut self, operator: Operator, span: Span) {}

    /// An interval has been read.
    fn act_interval(&mut self, interval: Interval) {}

    /// An attribute has been read. `value` is the text of its value.
    fn act_attribute(&mut self, attribute: StatedAttribute, value: &str) {}

    /// A declaration has been read.
    fn act_declaration(&mut self, declaration: &Declaration<'_>) {}

    /// An error, a warning or a hint.
    fn act_error(&mut self, diagnostic: Diagnostic) {}
}
