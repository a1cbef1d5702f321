//! From steps to values: runs an expression's steps on a stack of items, and functions' bodies where they are applied.
//!
//! In: expressions as steps ([`crate::geotrace::code`]) and the meanings of symbols. Out: values over the nodes of one
//! graph, or errors.
//!
//! A required body is run as a further [`CallFrame`], not by recursion: ten thousand functions, each applying the one
//! above, require no more stack than one.

use std::sync::Arc;

use expr::value::{self, DimensionError, Value};
use syntax::diagnostic::Diagnostic;
use syntax::geotrace::actions::Operator;
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geotrace::code::Expression;
use crate::geotrace::dependencies::Dependencies;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::lowerer::{
    BodyKey, BodyOutcome, Effect, Function, Lowered, Lowerer, StackItem, dimension_error, too_large,
};
use crate::geotrace::operation::{Derivation, Operation, operation};
use crate::geotrace::sets::PointSet;
use crate::geotrace::symbol::{Constant, Meaning, Symbols};

/// An expression that is being run.
struct CallFrame {
    /// The next step.
    next: usize,
    end: usize,
    /// The values of `Operator::Variable`.
    parameters: Vec<Value>,
    /// The function whose body it is; `None` for the outermost expression.
    body: Option<BodyKey>,
    /// The first error in a body.
    error: Option<SemanticError>,
    dependencies: Dependencies,
}

impl Lowerer {
    /// Runs an expression whose variables have the values `parameters`. Errors are added to `diagnostics`, each with the
    /// span of its whole operation.
    pub(crate) fn lower(
        &mut self,
        expression: Expression,
        parameters: Vec<Value>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Lowered {
        self.run(expression, parameters, diagnostics, |lowerer, item| {
            lowerer.value(item)
        })
    }

    /// Runs an expression whose value may be a bracketed list of values of any dimensions. The list is `None` as in
    /// [`Lowered`], or if the value is not such a list; the value is returned with it.
    pub(crate) fn lower_list(
        &mut self,
        expression: Expression,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> (Option<Vec<Value>>, Lowered) {
        let mut list = None;
        let lowered = self.run(expression, Vec::new(), diagnostics, |lowerer, item| {
            if let StackItem::List(values, _) = item {
                list = Some(values);
                return Ok(None);
            }
            lowerer.value(item)
        });
        (list, lowered)
    }

    /// Runs a set. `None` as in [`Lowered`].
    pub(crate) fn lower_set(
        &mut self,
        set: Expression,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> (Option<PointSet>, Dependencies) {
        let mut found = None;
        let lowered = self.run(set, Vec::new(), diagnostics, |_, item| {
            if let StackItem::Set(set) = item {
                found = Some(*set);
            }
            Ok(None)
        });
        (found, lowered.dependencies)
    }

    /// Runs an expression; `finish` computes its value from the last item.
    fn run(
        &mut self,
        expression: Expression,
        parameters: Vec<Value>,
        diagnostics: &mut Vec<Diagnostic>,
        mut finish: impl FnMut(&mut Self, StackItem) -> Result<Option<Value>, (SemanticError, Span)>,
    ) -> Lowered {
        let nothing = Lowered {
            value: None,
            dependencies: Dependencies::default(),
        };
        if self.full {
            return nothing;
        }
        let mut stack = Vec::new();
        let mut frames = vec![CallFrame::new(expression, parameters, None)];
        while let Some(frame) = frames.last_mut() {
            if frame.next < frame.end {
                self.step(&mut frames, &mut stack, diagnostics);
                continue;
            }
            let place = self.code.step(frame.end - 1).span;
            let item = pop(&mut stack);
            let value = match frame.body {
                None => finish(self, item),
                Some(_) => self.value(item),
            };
            let value = value.and_then(|value| {
                if self.graph.overflowed() {
                    return Err((too_large(), place));
                }
                Ok(value)
            });
            let value = match value {
                Ok(value) => value,
                Err((error, place)) => {
                    frame.report(error, place, &self.symbols, diagnostics);
                    None
                }
            };
            let Some(frame) = frames.pop() else { break };
            let Some(key) = frame.body else {
                // A full graph has no room for anything else, and one error reports that.
                self.full = self.graph.overflowed();
                return Lowered {
                    value,
                    dependencies: frame.dependencies,
                };
            };
            let outcome = match (frame.error, value) {
                (Some(error), _) => BodyOutcome::Failed(Arc::new(error)),
                (None, None) => BodyOutcome::Silent,
                (None, Some(value)) => BodyOutcome::Ready {
                    value,
                    dependencies: frame.dependencies,
                },
            };
            self.applications.add(key, outcome);
        }
        nothing
    }

    /// Runs the innermost frame's next step.
    fn step(
        &mut self,
        frames: &mut Vec<CallFrame>,
        stack: &mut Vec<StackItem>,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let Some(frame) = frames.last_mut() else {
            return;
        };
        let step = self.code.step(frame.next);
        let effect = self.perform(frame, stack, step.operator, step.span);
        match effect {
            Ok(Effect::Push(item)) => {
                frame.next += 1;
                stack.push(item);
            }
            Ok(Effect::Run(key, expression, parameters)) => {
                frames.push(CallFrame::new(expression, parameters, Some(key)));
            }
            Err((error, place)) => {
                frame.report(error, place, &self.symbols, diagnostics);
                frame.next += 1;
                stack.push(StackItem::Poison);
            }
        }
    }

    /// Applies an operator to the items that it pops from the stack; an error comes with its span.
    fn perform(
        &mut self,
        frame: &mut CallFrame,
        stack: &mut Vec<StackItem>,
        operator: Operator,
        span: Span,
    ) -> Result<Effect, (SemanticError, Span)> {
        let item = match operation(operator) {
            Operation::Number(number) => StackItem::Number(number),
            Operation::Constant(symbol) => self.constant(frame, symbol),
            Operation::Variable(position) => match frame.parameters.get(position as usize) {
                Some(value) => StackItem::Value(value.clone()),
                None => StackItem::Poison,
            },
            Operation::Function(symbol) => StackItem::Function(Box::new(Function {
                symbol,
                derivations: Vec::new(),
                powers: Vec::new(),
            })),
            Operation::Derive(derivation) => self.derived(pop(stack), derivation, span)?,
            Operation::FunctionPower => {
                let exponent = self.value(pop(stack))?;
                match pop(stack) {
                    StackItem::Function(mut function) => {
                        function.powers.push(exponent);
                        StackItem::Function(function)
                    }
                    _ => StackItem::Poison,
                }
            }
            Operation::Apply => {
                let operand = pop(stack);
                let function = pop(stack);
                let listed = match &function {
                    StackItem::Function(function) => self.listed(frame, function.symbol),
                    _ => None,
                };
                let effect = self
                    .apply(function, operand, span, stack, &mut frame.dependencies)
                    .map_err(|(error, place)| match listed {
                        Some(hint) if error.code == error::DIMENSION_MISMATCH => {
                            (error.with_hint(hint), place)
                        }
                        _ => (error, place),
                    })?;
                // In a body, the parameters are known only at its application.
                if frame.body.is_none()
                    && !self.is_along_curve
                    && let Effect::Push(StackItem::Value(value)) = &effect
                    && let Some(name) = self.geodesics.open_name(&self.graph, value.components())
                {
                    return Err((no_formula(name), span));
                }
                return Ok(effect);
            }
            Operation::Atom => {
                let function = pop(stack);
                return self.atom(function, span, stack, &mut frame.dependencies);
            }
            Operation::Join(step) => {
                let second = pop(stack);
                self.joined(pop(stack), second, step, span)?
            }
            Operation::Place(placement) => {
                let by = pop(stack);
                self.placed(pop(stack), by, placement, span)?
            }
            Operation::Image => {
                let function = pop(stack);
                let set = pop(stack);
                return self.image(set, function, span, stack, &mut frame.dependencies);
            }
            Operation::Tuple(count) => self.tuple(stack, count as usize, span)?,
            Operation::Component(index) => match self.value(pop(stack))? {
                Some(value) => computed(value::component(&value, index), span)?,
                None => StackItem::Poison,
            },
            Operation::Unary(row) => match pop(stack) {
                StackItem::Number(number) => StackItem::Number((row.number)(number)),
                item => match self.value(item)? {
                    Some(value) => computed((row.value)(&mut self.graph, &value), span)?,
                    None => StackItem::Poison,
                },
            },
            Operation::Binary(row) => match (pop(stack), pop(stack)) {
                (StackItem::Number(b), StackItem::Number(a)) => {
                    StackItem::Number((row.numbers)(a, b))
                }
                (b, a) => {
                    // The right operand's node comes first, as it is popped first: the order of nodes is part of the scene.
                    // Of two errors, the left one is reported.
                    let b = self.value(b);
                    let a = self.value(a)?;
                    match (a, b?) {
                        (Some(a), Some(b)) => {
                            computed((row.values)(&mut self.graph, &a, &b), span)?
                        }
                        _ => StackItem::Poison,
                    }
                }
            },
        };
        Ok(Effect::Push(item))
    }

    /// Returns the hint at an error of a function of one parameter that is applied to a list in brackets. The next step applies
    /// it.
    fn listed(&self, frame: &CallFrame, symbol: SymbolId) -> Option<String> {
        let Meaning::Declared(declared) = self.symbols.meaning(symbol) else {
            return None;
        };
        let operand = self.code.step(frame.next.checked_sub(1)?).operator;
        let is_list = matches!(operand, Operator::Tuple(count) if count > 1);
        let name = self.symbols.name(symbol);
        (is_list && declared.parameters.len() == 1)
            .then(|| format!("`{name}` has one parameter: a list in brackets is one vector"))
    }

    fn constant(&mut self, frame: &mut CallFrame, symbol: SymbolId) -> StackItem {
        match self.symbols.meaning(symbol) {
            Meaning::Constant(Constant {
                value,
                dependencies,
            }) => {
                frame.dependencies = self.dependencies.union(frame.dependencies, *dependencies);
                StackItem::Value(value.clone())
            }
            _ => StackItem::Poison,
        }
    }

    /// Returns a function with one more derivative; only a function of a single parameter has *the* derivative, `f'`.
    fn derived(
        &self,
        item: StackItem,
        derivation: Derivation,
        span: Span,
    ) -> Result<StackItem, (SemanticError, Span)> {
        let StackItem::Function(mut function) = item else {
            return Ok(StackItem::Poison);
        };
        if derivation == Derivation::Total
            && let Some(error) = self.symbols.total_error(function.symbol)
        {
            return Err((error, span));
        }
        function.derivations.push(derivation);
        Ok(StackItem::Function(function))
    }

    /// Returns a bracketed list. A list that contains vectors may still be an argument list.
    fn tuple(
        &mut self,
        stack: &mut Vec<StackItem>,
        count: usize,
        span: Span,
    ) -> Result<StackItem, (SemanticError, Span)> {
        if count == 1 {
            return Ok(pop(stack));
        }
        let items = stack.split_off(stack.len().saturating_sub(count));
        let mut values = Vec::with_capacity(items.len());
        for item in items {
            match self.value(item)? {
                Some(value) => values.push(value),
                None => return Ok(StackItem::Poison),
            }
        }
        Ok(match value::tuple(&values) {
            Ok(value) => StackItem::Value(value),
            Err(_) => StackItem::List(values, span),
        })
    }
}

impl CallFrame {
    fn new(expression: Expression, parameters: Vec<Value>, body: Option<BodyKey>) -> Self {
        let steps = expression.steps();
        Self {
            next: steps.start,
            end: steps.end,
            parameters,
            body,
            error: None,
            dependencies: Dependencies::default(),
        }
    }

    /// Reports an error of the outermost expression; stores the first error of a body for its applications.
    fn report(
        &mut self,
        error: SemanticError,
        place: Span,
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        match &self.body {
            None => diagnostics.push(error.at(place)),
            Some(_) if self.error.is_some() => {}
            Some(key) => self.error = Some(error.in_body(symbols.name(key.symbol), place)),
        }
    }
}

/// Returns the error of a geodesic whose argument is not a number before its reader is drawn.
fn no_formula(name: &str) -> SemanticError {
    SemanticError::new(
        error::NO_FORMULA,
        format!(
            "`{name}` is a geodesic: its argument must not depend on the parameters of a surface, metric, solid or background, nor, in an attribute, on those of its declaration"
        ),
    )
    .with_hint(format!(
        "the argument of `{name}` may depend on constants, params and grids, and on the parameter of a curve"
    ))
}

/// Returns the top item. Every operator's operands have been pushed, because steps are in postfix order.
fn pop(stack: &mut Vec<StackItem>) -> StackItem {
    stack.pop().unwrap_or(StackItem::Poison)
}

/// Returns the value of an operation on values, or the error of their dimensions.
fn computed(
    result: Result<Value, DimensionError>,
    span: Span,
) -> Result<StackItem, (SemanticError, Span)> {
    match result {
        Ok(value) => Ok(StackItem::Value(value)),
        Err(error) => Err((dimension_error(&error), span)),
    }
}
