//! From the calls of the hooks to the syntax tree.

use std::sync::Arc;

use super::actions::{Actions, ParseStep};
use super::tree::{
    Arm, Attribute, Block, BlockKind, Body, Expression, ExpressionKind, Link, Macro, Modifier,
    Object, Statement, StatementKind, Suffix, SuffixKind, Word,
};
use crate::span::Span;

/// Builds the blocks of a text while the parser runs.
#[derive(Debug, Default)]
pub(super) struct Builder<'s> {
    source: &'s str,
    expressions: Vec<Expression>,
    attributes: Vec<Attribute>,
    parameters: Vec<Word>,
    modifiers: Vec<Modifier>,
    statements: Vec<Statement>,
    bodies: Vec<Body>,
    arms: Vec<Arm>,
    /// The complete blocks.
    pub(super) blocks: Vec<Block>,
}

impl<'s> Builder<'s> {
    pub(super) fn new(source: &'s str) -> Self {
        Self {
            source,
            ..Self::default()
        }
    }

    /// Returns the last expression.
    pub(super) fn expression(&mut self) -> Option<Expression> {
        self.expressions.pop()
    }

    fn word(&self, span: Span) -> Word {
        Word {
            text: span.text(self.source).into(),
            span,
        }
    }

    /// Returns the last expression; the parser reports no step before its parts.
    fn pop(&mut self) -> Expression {
        self.expressions.pop().unwrap_or(Expression {
            kind: ExpressionKind::Missing,
            span: Span::default(),
        })
    }

    fn pop_body(&mut self) -> Body {
        self.bodies.pop().unwrap_or(Body {
            statements: Box::default(),
            span: Span::default(),
        })
    }

    fn push(&mut self, kind: ExpressionKind, span: Span) {
        self.expressions.push(Expression { kind, span });
    }

    fn suffix(&mut self, kind: SuffixKind, suffix: Span, span: Span) {
        let base = self.pop();
        let suffix = Suffix { kind, span: suffix };
        let kind = match base.kind {
            ExpressionKind::Suffixed(base, mut suffixes) => {
                suffixes.push(suffix);
                ExpressionKind::Suffixed(base, suffixes)
            }
            _ => ExpressionKind::Suffixed(Box::new(base), vec![suffix]),
        };
        self.push(kind, span);
    }

    fn block(&mut self, kind: BlockKind, span: Span) {
        self.blocks.push(Block { kind, span });
    }
}

/// Returns the last `count` elements of a list.
fn last<T>(list: &mut Vec<T>, count: usize) -> Box<[T]> {
    list.drain(list.len().saturating_sub(count)..).collect()
}

impl Actions for Builder<'_> {
    fn act_step(&mut self, step: ParseStep<'_>, span: Span) {
        let kind = match step {
            ParseStep::Missing => ExpressionKind::Missing,
            ParseStep::Integer(number) => ExpressionKind::Integer(number),
            ParseStep::Float(number) => ExpressionKind::Float(number),
            ParseStep::Text(text) => ExpressionKind::Text(text.into()),
            ParseStep::Boolean(value) => ExpressionKind::Boolean(value),
            ParseStep::Identifier(name) => ExpressionKind::Identifier(name.into()),
            ParseStep::Group => ExpressionKind::Group(Box::new(self.pop())),
            ParseStep::List(count) => ExpressionKind::List(last(&mut self.expressions, count)),
            ParseStep::Object(name, count, braces) => ExpressionKind::Object(Box::new(Object {
                name: self.word(name),
                attributes: last(&mut self.attributes, count),
                braces,
            })),
            ParseStep::Macro(count) => ExpressionKind::Macro(Arc::new(Macro {
                parameters: last(&mut self.parameters, count),
                body: self.pop_body(),
            })),
            ParseStep::Assignment => {
                let value = self.pop();
                ExpressionKind::Assignment(Box::new([self.pop(), value]))
            }
            ParseStep::Conditional => {
                let (otherwise, value) = (self.pop(), self.pop());
                ExpressionKind::Conditional(Box::new([self.pop(), value, otherwise]))
            }
            ParseStep::Binary(operator, operator_span) => {
                let link = Link {
                    operator,
                    operator_span,
                    operand: self.pop(),
                };
                let first = self.pop();
                match first.kind {
                    ExpressionKind::Chain(first, mut links)
                        if links[0].operator.level() == operator.level() =>
                    {
                        links.push(link);
                        ExpressionKind::Chain(first, links)
                    }
                    _ => ExpressionKind::Chain(Box::new(first), vec![link]),
                }
            }
            ParseStep::Prefix(operator) => ExpressionKind::Prefix(operator, Box::new(self.pop())),
            ParseStep::Element(brackets) => {
                let index = self.pop();
                return self.suffix(SuffixKind::Element(index), brackets, span);
            }
            ParseStep::Call(brackets, count) => {
                let arguments = last(&mut self.expressions, count);
                return self.suffix(SuffixKind::Call(arguments), brackets, span);
            }
            ParseStep::Modifiers(brackets, count) => {
                let modifiers = last(&mut self.modifiers, count);
                return self.suffix(SuffixKind::Modifiers(modifiers), brackets, span);
            }
            ParseStep::Modifier(kind) => {
                let value = self.pop();
                return self.modifiers.push(Modifier { kind, value, span });
            }
            ParseStep::Attribute(name) => {
                let (name, value) = (self.word(name), self.pop());
                return self.attributes.push(Attribute { name, value, span });
            }
            ParseStep::Parameter => {
                let word = self.word(span);
                return self.parameters.push(word);
            }
            ParseStep::Expression => {
                let kind = StatementKind::Expression(self.pop());
                return self.statements.push(Statement { kind, span });
            }
            ParseStep::Body(count) => {
                let statements = last(&mut self.statements, count);
                return self.bodies.push(Body { statements, span });
            }
            ParseStep::Arm => {
                let (condition, body) = (self.pop(), self.pop_body());
                return self.arms.push(Arm { condition, body });
            }
            ParseStep::While => {
                let arm = self.arms.pop();
                let kind = arm.map(StatementKind::While);
                return self
                    .statements
                    .extend(kind.map(|kind| Statement { kind, span }));
            }
            ParseStep::If(count, has_else) => {
                let otherwise = has_else.then(|| self.pop_body());
                let kind = StatementKind::If(last(&mut self.arms, count), otherwise);
                return self.statements.push(Statement { kind, span });
            }
            ParseStep::Settings(braces, count) => {
                let attributes = last(&mut self.attributes, count);
                return self.block(BlockKind::Settings(attributes, braces), span);
            }
            ParseStep::Scene => {
                let body = self.pop_body();
                return self.block(BlockKind::Scene(body), span);
            }
            ParseStep::Statement => {
                let kind = self.statements.pop().map(BlockKind::Statement);
                return self.blocks.extend(kind.map(|kind| Block { kind, span }));
            }
        };
        self.push(kind, span);
    }
}
