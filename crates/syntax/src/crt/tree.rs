//! The syntax tree of a script; every node has its span.
//!
//! The spans in a [`Piece`] are relative to its start, so that an edit above it does not change it. A clone of a [`Script`]
//! shares its trees. Left-associative operators of one level form one [`Chain`](ExpressionKind::Chain), and the parts after a
//! primary expression form one list of suffixes. So the depth of a tree is the nesting depth of the text, which
//! [`MAX_DEPTH`](super::parser::MAX_DEPTH) limits.

use std::sync::Arc;

use crate::span::Span;

/// A script, as the pieces that a document reads.
#[derive(Clone, Debug, Default)]
pub struct Script {
    /// The pieces, in the order of the text.
    pub pieces: Arc<[Piece]>,
    /// True if the text begins with `-----BEGIN`: then it is a certificate rather than a script, and has no pieces.
    pub is_certificate: bool,
}

/// A piece of a script: usually one block.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The offset in the text to which the piece's spans are relative.
    pub start: u32,
    /// The blocks, in the order of the text.
    pub blocks: Arc<[Block]>,
}

/// A part of a script at top level.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// The kind with its parts.
    pub kind: BlockKind,
    /// The span.
    pub span: Span,
}

/// The kind of a block.
#[derive(Clone, Debug, PartialEq)]
pub enum BlockKind {
    /// `Settings { … }`, with the span of the braces.
    Settings(Box<[Attribute]>, Span),
    /// `Scene { … }`.
    Scene(Body),
    /// A statement.
    Statement(Statement),
}

/// Statements between braces.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// The statements.
    pub statements: Box<[Statement]>,
    /// The span from `{` to `}`.
    pub span: Span,
}

/// A statement.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// The kind with its parts.
    pub kind: StatementKind,
    /// The span.
    pub span: Span,
}

/// The kind of a statement.
#[derive(Clone, Debug, PartialEq)]
pub enum StatementKind {
    /// An expression.
    Expression(Expression),
    /// `while (…) { … }`.
    While(Arm),
    /// `if (…) { … }`, each `else if (…) { … }`, and the body of the `else`.
    If(Box<[Arm]>, Option<Body>),
}

/// A condition with the body that it guards.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// The condition.
    pub condition: Expression,
    /// The body.
    pub body: Body,
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// The kind with its parts.
    pub kind: ExpressionKind,
    /// The span.
    pub span: Span,
}

/// The kind of an expression.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpressionKind {
    /// A missing or invalid expression. An error has been reported.
    Missing,
    /// A whole number.
    Integer(i32),
    /// A number with a decimal point.
    Float(f64),
    /// A string, without quotes and escapes.
    Text(Arc<str>),
    /// `true` or `false`.
    Boolean(bool),
    /// A variable or the name of a function.
    Identifier(Arc<str>),
    /// `Sphere { … }`.
    Object(Box<Object>),
    /// `[a, b]`.
    List(Box<[Expression]>),
    /// `Macro (a, b) { … }`.
    Macro(Arc<Macro>),
    /// `(a)`.
    Group(Box<Expression>),
    /// `a = b`. The target is an [`Identifier`](Self::Identifier), or an error has been reported.
    Assignment(Box<[Expression; 2]>),
    /// `a ? b : c`.
    Conditional(Box<[Expression; 3]>),
    /// `a + b - c`: operators of one level, from left to right. There is at least one link.
    Chain(Box<Expression>, Vec<Link>),
    /// `-a`.
    Prefix(PrefixOperator, Box<Expression>),
    /// `a[0](1) <scale 2>`: the parts after a primary expression, from left to right. There is at least one suffix.
    Suffixed(Box<Expression>, Vec<Suffix>),
}

/// A word and its span.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    /// The text.
    pub text: Arc<str>,
    /// The span.
    pub span: Span,
}

/// An object.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name. A name that is not in the table of objects has been reported.
    pub name: Word,
    /// Its attributes as stated. Unknown, missing and duplicate attributes have been reported.
    pub attributes: Box<[Attribute]>,
    /// The span from `{` to `}`.
    pub braces: Span,
}

/// `name -> value`.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// The name.
    pub name: Word,
    /// The value.
    pub value: Expression,
    /// The span.
    pub span: Span,
}

/// A macro.
#[derive(Clone, Debug, PartialEq)]
pub struct Macro {
    /// The parameters. Duplicates have been reported.
    pub parameters: Box<[Word]>,
    /// The body.
    pub body: Body,
}

/// An operator between two operands, and the operand after it.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// The operator.
    pub operator: BinaryOperator,
    /// The span of the operator.
    pub operator_span: Span,
    /// The operand after it.
    pub operand: Expression,
}

/// A part after a primary expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Suffix {
    /// The kind with its parts.
    pub kind: SuffixKind,
    /// The span from its first to its last token.
    pub span: Span,
}

/// The kind of a suffix.
#[derive(Clone, Debug, PartialEq)]
pub enum SuffixKind {
    /// `[i]`.
    Element(Expression),
    /// `(a, b)`.
    Call(Box<[Expression]>),
    /// `<scale 2, rotate v>`.
    Modifiers(Box<[Modifier]>),
}

/// `scale a`, `translate a` or `rotate a`.
#[derive(Clone, Debug, PartialEq)]
pub struct Modifier {
    /// The kind.
    pub kind: ModifierKind,
    /// The operand.
    pub value: Expression,
    /// The span.
    pub span: Span,
}

/// The kind of a modifier.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum ModifierKind {
    /// By a number, or by one number along each axis.
    Scale,
    /// By a vector.
    Translate,
    /// By degrees about x, then y, then z.
    Rotate,
}

/// An operator before its operand.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum PrefixOperator {
    /// `+a`.
    Plus,
    /// `-a`.
    Minus,
    /// `!a`.
    Not,
}

/// An operator between two operands.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
#[allow(missing_docs)]
pub enum BinaryOperator {
    Or,
    And,
    LessEqual,
    GreaterEqual,
    Less,
    Greater,
    Equal,
    NotEqual,
    Add,
    Subtract,
    /// `a ^ b`.
    Intersect,
    Multiply,
    Divide,
    Remainder,
}

impl BinaryOperator {
    /// Returns the precedence of the operator: greater levels bind more tightly.
    pub fn level(self) -> u8 {
        match self {
            Self::Or => 0,
            Self::And => 1,
            Self::LessEqual
            | Self::GreaterEqual
            | Self::Less
            | Self::Greater
            | Self::Equal
            | Self::NotEqual => 2,
            Self::Add | Self::Subtract | Self::Intersect => 3,
            Self::Multiply | Self::Divide | Self::Remainder => 4,
        }
    }

    /// Returns the operator as written.
    pub fn text(self) -> &'static str {
        match self {
            Self::Or => "||",
            Self::And => "&&",
            Self::LessEqual => "<=",
            Self::GreaterEqual => ">=",
            Self::Less => "<",
            Self::Greater => ">",
            Self::Equal => "==",
            Self::NotEqual => "!=",
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Intersect => "^",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Remainder => "%",
        }
    }
}

impl Expression {
    /// Returns the expression without brackets around it.
    pub fn ungrouped(&self) -> &Self {
        let mut expression = self;
        while let ExpressionKind::Group(inner) = &expression.kind {
            expression = inner;
        }
        expression
    }

    /// Returns the name, if the expression is an identifier, possibly in brackets.
    pub fn identifier(&self) -> Option<&Arc<str>> {
        match &self.ungrouped().kind {
            ExpressionKind::Identifier(name) => Some(name),
            _ => None,
        }
    }
}

impl Statement {
    /// Passes each name that the statement may assign to `found`, except names assigned in macros.
    pub fn each_assigned(&self, found: &mut dyn FnMut(&Arc<str>)) {
        match &self.kind {
            StatementKind::Expression(expression) => expression.each_assigned(found),
            StatementKind::While(arm) => arm.each_assigned(found),
            StatementKind::If(arms, rest) => {
                for arm in arms {
                    arm.each_assigned(found);
                }
                if let Some(body) = rest {
                    body.each_assigned(found);
                }
            }
        }
    }
}

impl Arm {
    fn each_assigned(&self, found: &mut dyn FnMut(&Arc<str>)) {
        self.condition.each_assigned(found);
        self.body.each_assigned(found);
    }
}

impl Body {
    fn each_assigned(&self, found: &mut dyn FnMut(&Arc<str>)) {
        for statement in &self.statements {
            statement.each_assigned(found);
        }
    }
}

impl Expression {
    fn each_assigned(&self, found: &mut dyn FnMut(&Arc<str>)) {
        match &self.kind {
            ExpressionKind::Missing
            | ExpressionKind::Integer(_)
            | ExpressionKind::Float(_)
            | ExpressionKind::Text(_)
            | ExpressionKind::Boolean(_)
            | ExpressionKind::Identifier(_)
            | ExpressionKind::Macro(_) => {}
            ExpressionKind::Object(object) => {
                for attribute in &object.attributes {
                    attribute.value.each_assigned(found);
                }
            }
            ExpressionKind::List(parts) => {
                for part in parts {
                    part.each_assigned(found);
                }
            }
            ExpressionKind::Group(inner) | ExpressionKind::Prefix(_, inner) => {
                inner.each_assigned(found);
            }
            ExpressionKind::Assignment(sides) => {
                if let Some(name) = sides[0].identifier() {
                    found(name);
                }
                sides[1].each_assigned(found);
            }
            ExpressionKind::Conditional(parts) => {
                for part in &**parts {
                    part.each_assigned(found);
                }
            }
            ExpressionKind::Chain(first, links) => {
                first.each_assigned(found);
                for link in links {
                    link.operand.each_assigned(found);
                }
            }
            ExpressionKind::Suffixed(first, suffixes) => {
                first.each_assigned(found);
                for suffix in suffixes {
                    match &suffix.kind {
                        SuffixKind::Element(index) => index.each_assigned(found),
                        SuffixKind::Call(arguments) => {
                            for argument in arguments {
                                argument.each_assigned(found);
                            }
                        }
                        SuffixKind::Modifiers(modifiers) => {
                            for modifier in modifiers {
                                modifier.value.each_assigned(found);
                            }
                        }
                    }
                }
            }
        }
    }
}

impl Script {
    /// Returns all blocks, each with the offset to which its spans are relative.
    pub fn blocks(&self) -> impl Iterator<Item = (u32, &Block)> {
        let pieces = self.pieces.iter();
        pieces.flat_map(|piece| piece.blocks.iter().map(move |block| (piece.start, block)))
    }
}
