//! The semantic hooks, which build the syntax tree of a script, or colour it.

use super::token::Token;
use super::tree::{BinaryOperator, ModifierKind, PrefixOperator};
use crate::diagnostic::Diagnostic;
use crate::span::Span;

/// A step of parsing, in postfix order: it takes the parts that earlier steps returned, and returns one part. Even in a
/// text with errors, no part is absent: [`Missing`](Self::Missing) represents a missing expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParseStep<'s> {
    /// An expression that is missing.
    Missing,
    /// A whole number.
    Integer(i32),
    /// A number with a decimal point.
    Float(f64),
    /// A string, without quotes and with its escapes replaced.
    Text(&'s str),
    /// `true` or `false`.
    Boolean(bool),
    /// A variable or the name of a function.
    Identifier(&'s str),
    /// `(a)`: one expression.
    Group,
    /// `[a, b]`: this many expressions.
    List(usize),
    /// `a -> b`, with the span of the name: one expression → an attribute.
    Attribute(Span),
    /// `Sphere { … }`, with the span of the name, this many attributes, and the span of the braces.
    Object(Span, usize, Span),
    /// A parameter of a macro: an identifier.
    Parameter,
    /// `Macro (…) { … }`, with this many parameters and a body.
    Macro(usize),
    /// `a = b`: two expressions.
    Assignment,
    /// `a ? b : c`: three expressions.
    Conditional,
    /// `a + b`, with the span of the operator: two expressions.
    Binary(BinaryOperator, Span),
    /// `-a`: one expression.
    Prefix(PrefixOperator),
    /// `a[i]`, with the span of the brackets: two expressions.
    Element(Span),
    /// `a(b, c)`, with the span of the brackets: an expression, and this many arguments.
    Call(Span, usize),
    /// `scale a`: one expression → a modifier.
    Modifier(ModifierKind),
    /// `a <scale b>`, with the span of the brackets: an expression, and this many modifiers.
    Modifiers(Span, usize),
    /// An expression → a statement.
    Expression,
    /// Statements between braces: this many statements → a body.
    Body(usize),
    /// A condition and a body → an arm.
    Arm,
    /// An arm → a statement.
    While,
    /// This many arms, and a body if there is an `else` → a statement.
    If(usize, bool),
    /// `Settings { … }`, with the span of the braces: this many attributes → a block.
    Settings(Span, usize),
    /// `Scene { … }`: a body → a block.
    Scene,
    /// A statement → a block.
    Statement,
}

/// The hooks that the parser calls. All do nothing unless implemented.
#[expect(unused_variables, reason = "a default uses no argument")]
pub trait Actions {
    /// The parser moved past a token. Called for every token in the order of the text, including comments and tokens
    /// skipped by recovery. Only white space and the end of input are not reported.
    fn act_advance(&mut self, token: Token) {}

    /// A step of parsing. `span` covers the step with its parts.
    fn act_step(&mut self, step: ParseStep<'_>, span: Span) {}

    /// An error, a warning or a hint.
    fn act_error(&mut self, diagnostic: Diagnostic) {}
}
