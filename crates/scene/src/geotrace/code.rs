//! Expressions as read: steps in postfix order.
//!
//! In: the parser's operators, in sequence. Out: the ranges of steps for a declaration's last values. The steps remain in
//! postfix order, which can be run on a stack without recursion, however deep an expression is.

use std::ops::Range;

use syntax::geotrace::actions::Operator;
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geotrace::operation::operation;

/// One operator, and the span of it with its operands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CodeStep {
    pub(crate) operator: Operator,
    pub(crate) span: Span,
}

/// A range of a [`Code`]: the steps of one expression.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct Expression {
    start: u32,
    end: u32,
}

impl Expression {
    pub(crate) fn steps(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// The steps of all expressions that may still be run: those of functions, curves and surfaces, and those of the
/// declaration that is being read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Code {
    steps: Vec<CodeStep>,
    /// The start of the steps of the declaration that is being read.
    open: usize,
}

impl Code {
    /// Appends an operator.
    pub(crate) fn push(&mut self, operator: Operator, span: Span) {
        self.steps.push(CodeStep { operator, span });
    }

    pub(crate) fn step(&self, index: usize) -> CodeStep {
        self.steps[index]
    }

    /// Returns the span of an expression in the text.
    pub(crate) fn span(&self, expression: Expression) -> Span {
        // The last operator's span covers all its operands.
        self.steps[expression.steps()]
            .last()
            .map(|step| step.span)
            .unwrap_or_default()
    }

    /// Returns the number of steps: the end of the last expression read.
    pub(crate) fn end(&self) -> usize {
        self.steps.len()
    }

    /// Returns the last `N` expressions read before the step `end`, in the order of the text; `None` if this
    /// declaration has fewer.
    pub(crate) fn last_before<const N: usize>(&self, mut end: usize) -> Option<[Expression; N]> {
        let mut found = [Expression { start: 0, end: 0 }; N];
        for place in found.iter_mut().rev() {
            *place = self.one_before(end)?;
            end = place.steps().start;
        }
        Some(found)
    }

    fn one_before(&self, end: usize) -> Option<Expression> {
        let mut missing = 1;
        let mut start = end;
        while missing > 0 {
            if start == self.open {
                return None;
            }
            start -= 1;
            missing = missing - 1 + operation(self.steps[start].operator).operand_count();
        }
        Some(Expression {
            start: u32::try_from(start).ok()?,
            end: u32::try_from(end).ok()?,
        })
    }

    /// Ends the declaration and keeps its steps before `end`.
    pub(crate) fn keep(&mut self, end: usize) {
        self.steps.truncate(end);
        self.open = self.steps.len();
    }

    /// Ends the declaration and drops its steps.
    pub(crate) fn forget(&mut self) {
        self.steps.truncate(self.open);
    }

    /// Returns the distance in bytes between two expressions with the same steps, the second moved as a whole; `None`
    /// if they differ.
    pub(crate) fn shift(&self, a: Expression, b: Expression) -> Option<i64> {
        let (a, b) = (&self.steps[a.steps()], &self.steps[b.steps()]);
        let apart = |a: Span, b: Span| i64::from(b.start) - i64::from(a.start);
        let shift = apart(a.first()?.span, b.first()?.span);
        let same = |(a, b): (&CodeStep, &CodeStep)| {
            let ends = i64::from(b.span.end) - i64::from(a.span.end);
            a.operator == b.operator && apart(a.span, b.span) == shift && ends == shift
        };
        (a.len() == b.len() && a.iter().zip(b).all(same)).then_some(shift)
    }

    /// Returns the operator that computes an expression's value.
    pub(crate) fn last_operator(&self, expression: Expression) -> Option<Operator> {
        Some(self.steps[expression.steps()].last()?.operator)
    }

    /// Returns the functions in an expression, each with its span.
    pub(crate) fn functions(
        &self,
        expression: Expression,
    ) -> impl Iterator<Item = (SymbolId, Span)> + '_ {
        let steps = self.steps[expression.steps()].iter();
        steps.filter_map(|step| match step.operator {
            Operator::Function(symbol) => Some((symbol, step.span)),
            _ => None,
        })
    }

    /// Returns the spans in an expression where `'` follows a function, each with the function.
    pub(crate) fn totals(
        &self,
        expression: Expression,
    ) -> impl Iterator<Item = (SymbolId, Span)> + '_ {
        let mut function = None;
        self.steps[expression.steps()]
            .iter()
            .filter_map(move |step| {
                match step.operator {
                    // Derivatives directly follow their function.
                    Operator::Function(symbol) => function = Some(symbol),
                    Operator::Total => return function.map(|symbol| (symbol, step.span)),
                    _ => {}
                }
                None
            })
    }
}

/// Replaces the symbol of an operator, if it has one.
pub(crate) fn with_symbol(
    operator: Operator,
    replace: impl FnOnce(SymbolId) -> SymbolId,
) -> Operator {
    match operator {
        Operator::Constant(symbol) => Operator::Constant(replace(symbol)),
        Operator::Function(symbol) => Operator::Function(replace(symbol)),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use syntax::geotrace::actions::Operator;
    use syntax::span::Span;
    use syntax::symbol::SymbolId;

    use super::Code;

    fn code(operators: &[Operator]) -> Code {
        let mut code = Code::default();
        for (index, &operator) in operators.iter().enumerate() {
            code.push(operator, Span::new(index as u32, index as u32 + 1));
        }
        code
    }

    #[test]
    fn the_last_expressions_are_found_from_the_back() {
        // (1, 2) then sin 3 then 4 + 5.
        let code = code(&[
            Operator::Number(1.0),
            Operator::Number(2.0),
            Operator::Tuple(2),
            Operator::Function(SymbolId(0)),
            Operator::Number(3.0),
            Operator::Apply,
            Operator::Number(4.0),
            Operator::Number(5.0),
            Operator::Add,
        ]);
        let [tuple, sine, sum] = code.last_before(code.end()).unwrap();
        assert_eq!(tuple.steps(), 0..3);
        assert_eq!(sine.steps(), 3..6);
        assert_eq!(sum.steps(), 6..9);
        assert_eq!(code.last_before::<4>(code.end()), None);
        assert_eq!(code.span(sine), Span::new(5, 6));
    }

    #[test]
    fn an_incomplete_expression_is_none() {
        assert_eq!(code(&[Operator::Add]).last_before::<1>(1), None);
        assert_eq!(code(&[]).last_before::<1>(0), None);
    }
}
