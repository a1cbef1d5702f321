//! The semantic hooks, which a compiler, a highlighter, an outline or a formatter implements.

use crate::diagnostic::Diagnostic;
use crate::geotrace::attributes::AttributeWord;
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::token::Token;
use crate::span::Span;
use crate::symbol::SymbolId;

/// A step of an expression, in postfix order: it pops its operands from an imagined stack and pushes one result.
/// `Function`, `Partial`, `Total` and `FunctionPower` build a function, `Apply` applies it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operator {
    /// Pushes a number.
    Number(f64),
    /// Pushes the value of a declared or builtin constant.
    Constant(SymbolId),
    /// Pushes a parameter of the body that is being read, by its index.
    Variable(u32),
    /// Pushes a function. In a geodesic, the function of the surface or metric comes by itself, before its direction
    /// and start.
    Function(SymbolId),
    /// `f_u`: function → its derivative by its parameter with this index.
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
    /// A bracketed list of this many values; 1 for a bracketed single value or set, which remains unchanged.
    Tuple(u32),
    /// `@ a` of a light without a direction: value → the same value, which is its position.
    Position,
    /// Function → the set of points that it denotes: a solid, or the points where it is not positive.
    Atom,
    /// `a | b`: two sets → the points in either.
    Union,
    /// `a & b`: two sets → the points in both.
    Intersection,
    /// `a \ b`: two sets → the points in the first that are not in the second.
    Difference,
    /// `a @ v`: set, vector → the set, translated.
    Move,
    /// `a @ scale v`: set, number or vector → the set, scaled.
    Scale,
    /// `a @ rotate v`: set, vector → the set, rotated about the vector by its length.
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
    /// For declarations with parameters: the index of the parameter that the tag names, if it names one, and the span
    /// of the tag. A tag that is missing, or names no parameter, has been reported.
    pub tag: Option<(Option<u32>, Span)>,
}

/// An attribute that a declaration states. If its value is an expression, it is the last value on the stack.
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

/// A declaration that has been read to its end. Its expressions, intervals and attributes were reported before. A param has
/// its initial value, if stated, and its intervals; a light its direction and its position, each if it has one.
#[derive(Clone, Debug, PartialEq)]
pub struct Declaration<'a> {
    /// Its keyword.
    pub keyword: DeclarationKeyword,
    /// The span from the keyword to the `;`.
    pub span: Span,
    /// The symbol that it declares; `None` if its name was not read or not free.
    pub symbol: Option<SymbolId>,
    /// The name as written; empty if it was not read.
    pub name: &'a str,
    /// The span of the name; empty if it was not read.
    pub name_span: Span,
    /// The parameters that it lists. A solid that lists none has the parameters x, y and z.
    pub parameters: &'a [Parameter],
    /// True if it contains an error, which has been reported: the stack may then be incomplete and must be dropped, and
    /// uses of the name must not be reported.
    pub faulty: bool,
}

/// The hooks that the parser calls. All do nothing unless implemented.
#[expect(unused_variables, reason = "a default uses no argument")]
pub trait Actions {
    /// The parser moved past a token. Called for every token in the order of the text, including comments and tokens
    /// skipped by recovery. Only white space and the end of input are not reported.
    fn act_advance(&mut self, token: Token) {}

    /// A declaration starts: its keyword has just been read.
    fn act_declaration_start(&mut self, keyword: DeclarationKeyword, span: Span) {}

    /// A step of an expression. `span` covers the operator with its operands. Once an error has made the steps of a
    /// declaration incomplete, no more of them are reported.
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
