//! From steps to values: runs an expression's steps over a stack of items, and functions' bodies where they
//! are applied.
//!
//! What flows in: expressions as steps ([`crate::code`]) and what each symbol means. What flows out: language
//! values over the nodes of one graph, or faults.
//!
//! A body whose value is needed is run as a further [`Frame`], not by recursion: ten thousand functions, each
//! applying the one above, are no deeper than one.

use std::sync::Arc;

use expr::Graph;
use expr::ops::power;
use expr::value::{self, DimensionError, Value};
use syntax::actions::Operator;
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;
use syntax::token::SymbolId;

use crate::apply::{Applications, BodyKey, BodyOutcome, Derivation};
use crate::code::{Code, Expression};
use crate::fault::{self, Fault};
use crate::reads::{ReadSets, Reads};
use crate::symbol::{Constant, Meaning, Symbols};

/// Everything that the meaning of an expression depends on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lowerer {
    pub(crate) graph: Graph,
    pub(crate) code: Code,
    pub(crate) symbols: Symbols,
    pub(crate) applications: Applications,
    pub(crate) reads: ReadSets,
    /// The graph has reached its limit, and that has been reported.
    full: bool,
}

/// What running an expression gives.
#[derive(Clone, Debug)]
pub(crate) struct Lowered {
    /// Its value; none where a fault or a name that failed before leaves it without one.
    pub(crate) value: Option<Value>,
    /// The params and grids that it reads, whether or not its value depends on them.
    pub(crate) reads: Reads,
}

/// What lies on the stack.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    /// A number known while compiling, which no node of the graph stands for yet.
    Number(f64),
    Value(Value),
    /// A bracketed list with a vector in it: arguments, or a fault where a value is needed. With its place.
    List(Vec<Value>, Span),
    Function(Box<Function>),
    /// Left behind by a fault that has been reported.
    Poison,
}

/// A function that is about to be applied.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) symbol: SymbolId,
    pub(crate) derivations: Vec<Derivation>,
    /// The exponents of `f^n`; none where an exponent has failed.
    pub(crate) powers: Vec<Option<Value>>,
}

/// One expression being run.
struct Frame {
    /// The next step.
    next: usize,
    end: usize,
    /// What `Operator::Variable` stands for.
    parameters: Vec<Value>,
    /// The function whose body it is; none for the outermost expression.
    body: Option<BodyKey>,
    /// The first fault in a body.
    fault: Option<Fault>,
    reads: Reads,
}

/// What a step leaves.
pub(crate) enum Effect {
    /// An item for the stack.
    Push(Item),
    /// Nothing yet: the body has to be run first, with these parameters, and then the step again.
    Run(BodyKey, Expression, Vec<Value>),
}

impl Lowerer {
    /// Runs an expression whose variables stand for `parameters`. What is wrong goes to `diagnostics`, each
    /// at the place of its whole operation.
    pub(crate) fn lower(
        &mut self,
        expression: Expression,
        parameters: Vec<Value>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Lowered {
        let nothing = Lowered {
            value: None,
            reads: Reads::default(),
        };
        if self.full {
            return nothing;
        }
        let mut stack = Vec::new();
        let mut frames = vec![Frame::new(expression, parameters, None)];
        while let Some(frame) = frames.last_mut() {
            if frame.next < frame.end {
                self.step(&mut frames, &mut stack, diagnostics);
                continue;
            }
            let place = self.code.step(frame.end - 1).span;
            let value = self.value(pop(&mut stack)).and_then(|value| {
                if self.graph.overflowed() {
                    return Err((too_large(), place));
                }
                Ok(value)
            });
            let value = match value {
                Ok(value) => value,
                Err((fault, place)) => {
                    frame.report(fault, place, &self.symbols, diagnostics);
                    None
                }
            };
            let Some(frame) = frames.pop() else { break };
            let Some(key) = frame.body else {
                // There is no room for anything else in a graph that is full, and one error says so.
                self.full = self.graph.overflowed();
                return Lowered {
                    value,
                    reads: frame.reads,
                };
            };
            let outcome = match (frame.fault, value) {
                (Some(fault), _) => BodyOutcome::Failed(Arc::new(fault)),
                (None, None) => BodyOutcome::Silent,
                (None, Some(value)) => BodyOutcome::Ready {
                    value,
                    reads: frame.reads,
                },
            };
            self.applications.add(key, outcome);
        }
        nothing
    }

    /// Runs the innermost frame's next step.
    fn step(
        &mut self,
        frames: &mut Vec<Frame>,
        stack: &mut Vec<Item>,
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
                frames.push(Frame::new(expression, parameters, Some(key)));
            }
            Err((fault, place)) => {
                frame.report(fault, place, &self.symbols, diagnostics);
                frame.next += 1;
                stack.push(Item::Poison);
            }
        }
    }

    /// What an operator does to the items it takes from the stack; a fault comes with its place.
    fn perform(
        &mut self,
        frame: &mut Frame,
        stack: &mut Vec<Item>,
        operator: Operator,
        span: Span,
    ) -> Result<Effect, (Fault, Span)> {
        let item = match operator {
            Operator::Number(number) => Item::Number(number),
            Operator::Constant(symbol) => self.constant(frame, symbol),
            Operator::Variable(position) => match frame.parameters.get(position as usize) {
                Some(value) => Item::Value(value.clone()),
                None => Item::Poison,
            },
            Operator::Function(symbol) => Item::Function(Box::new(Function {
                symbol,
                derivations: Vec::new(),
                powers: Vec::new(),
            })),
            Operator::Partial(position) => derived(pop(stack), Derivation::By(position)),
            Operator::Total => self.total(pop(stack), span)?,
            Operator::FunctionPower => {
                let exponent = self.value(pop(stack))?;
                match pop(stack) {
                    Item::Function(mut function) => {
                        function.powers.push(exponent);
                        Item::Function(function)
                    }
                    _ => Item::Poison,
                }
            }
            Operator::Apply => {
                let operand = pop(stack);
                let function = pop(stack);
                return self.apply(function, operand, span, stack, &mut frame.reads);
            }
            Operator::Tuple(count) => self.tuple(stack, count as usize, span)?,
            Operator::Plus
            | Operator::Negate
            | Operator::Square
            | Operator::Reciprocal
            | Operator::Component(_) => {
                let a = pop(stack);
                if let Some(number) = folded_unary(operator, &a) {
                    return Ok(Effect::Push(Item::Number(number)));
                }
                let Some(a) = self.value(a)? else {
                    return Ok(Effect::Push(Item::Poison));
                };
                let graph = &mut self.graph;
                let result = match operator {
                    Operator::Negate => Ok(value::negate(graph, &a)),
                    Operator::Square => Ok(value::square(graph, &a)),
                    Operator::Reciprocal => value::reciprocal(graph, &a),
                    Operator::Component(n) => value::component(&a, n),
                    _ => Ok(a),
                };
                Item::Value(result.map_err(|error| (dimension_fault(&error), span))?)
            }
            Operator::Add
            | Operator::Subtract
            | Operator::Juxtapose
            | Operator::Multiply
            | Operator::Divide
            | Operator::Power => {
                let (b, a) = (pop(stack), pop(stack));
                if let (Item::Number(a), Item::Number(b)) = (&a, &b) {
                    return Ok(Effect::Push(Item::Number(folded(operator, *a, *b))));
                }
                let b = self.value(b);
                let a = self.value(a)?;
                match (a, b?) {
                    (Some(a), Some(b)) => {
                        let graph = &mut self.graph;
                        let result = match operator {
                            Operator::Add => value::add(graph, &a, &b),
                            Operator::Subtract => value::subtract(graph, &a, &b),
                            Operator::Juxtapose => value::juxtapose(graph, &a, &b),
                            Operator::Multiply => value::multiply(graph, &a, &b),
                            Operator::Divide => value::divide(graph, &a, &b),
                            _ => value::power(graph, &a, &b),
                        };
                        Item::Value(result.map_err(|error| (dimension_fault(&error), span))?)
                    }
                    _ => Item::Poison,
                }
            }
        };
        Ok(Effect::Push(item))
    }

    fn constant(&mut self, frame: &mut Frame, symbol: SymbolId) -> Item {
        match self.symbols.meaning(symbol) {
            Meaning::Constant(Constant { value, reads }) => {
                frame.reads = self.reads.union(frame.reads, *reads);
                Item::Value(value.clone())
            }
            _ => Item::Poison,
        }
    }

    /// `f'`: only a function of one parameter has *the* derivative.
    fn total(&self, item: Item, span: Span) -> Result<Item, (Fault, Span)> {
        if let Item::Function(function) = &item
            && let Some(fault) = self.symbols.total_fault(function.symbol)
        {
            return Err((fault, span));
        }
        Ok(derived(item, Derivation::Total))
    }

    /// A bracketed list. One with vectors in it may still be an argument list.
    fn tuple(
        &mut self,
        stack: &mut Vec<Item>,
        count: usize,
        span: Span,
    ) -> Result<Item, (Fault, Span)> {
        if count == 1 {
            return Ok(pop(stack));
        }
        let items = stack.split_off(stack.len().saturating_sub(count));
        let mut values = Vec::with_capacity(items.len());
        for item in items {
            match self.value(item)? {
                Some(value) => values.push(value),
                None => return Ok(Item::Poison),
            }
        }
        Ok(match value::tuple(&values) {
            Ok(value) => Item::Value(value),
            Err(_) => Item::List(values, span),
        })
    }

    /// The value that an item is; none for what a reported fault left behind.
    pub(crate) fn value(&mut self, item: Item) -> Result<Option<Value>, (Fault, Span)> {
        match item {
            Item::Number(number) => Ok(Some(Value::Number(self.graph.constant(number)))),
            Item::Value(value) => Ok(Some(value)),
            Item::List(values, span) => match value::tuple(&values) {
                Ok(value) => Ok(Some(value)),
                Err(error) => Err((dimension_fault(&error), span)),
            },
            Item::Function(_) | Item::Poison => Ok(None),
        }
    }
}

impl Frame {
    fn new(expression: Expression, parameters: Vec<Value>, body: Option<BodyKey>) -> Self {
        let steps = expression.steps();
        Self {
            next: steps.start,
            end: steps.end,
            parameters,
            body,
            fault: None,
            reads: Reads::default(),
        }
    }

    /// Reports a fault of the outermost expression; keeps the first one of a body for those who apply it.
    fn report(
        &mut self,
        fault: Fault,
        place: Span,
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        match &self.body {
            None => diagnostics.push(fault.at(place)),
            Some(_) if self.fault.is_some() => {}
            Some(key) => self.fault = Some(fault.in_body(symbols.name(key.symbol), place)),
        }
    }
}

/// The item on top. Every operator's operands have been pushed, for steps come in postfix order.
fn pop(stack: &mut Vec<Item>) -> Item {
    stack.pop().unwrap_or(Item::Poison)
}

/// The value of an operator on two known numbers: as the graph folds it, but without a node for each step of
/// a long sum.
fn folded(operator: Operator, a: f64, b: f64) -> f64 {
    match operator {
        Operator::Add => a + b,
        Operator::Subtract => a - b,
        Operator::Divide => a / b,
        Operator::Power => power(a, b),
        _ => a * b,
    }
}

/// The same for an operator on one known number; none for anything else.
fn folded_unary(operator: Operator, a: &Item) -> Option<f64> {
    let Item::Number(a) = *a else { return None };
    match operator {
        Operator::Plus => Some(a),
        Operator::Negate => Some(-a),
        Operator::Square => Some(a * a),
        Operator::Reciprocal => Some(1.0 / a),
        _ => None,
    }
}

fn derived(item: Item, derivation: Derivation) -> Item {
    match item {
        Item::Function(mut function) => {
            function.derivations.push(derivation);
            Item::Function(function)
        }
        _ => Item::Poison,
    }
}

/// What is wrong with the dimensions of an operation's operands.
pub(crate) fn dimension_fault(error: &DimensionError) -> Fault {
    let code = match error {
        DimensionError::Component { .. } => fault::NO_SUCH_COMPONENT,
        _ => fault::DIMENSION_MISMATCH,
    };
    let fault = Fault::new(code, error.to_string());
    match error.hint() {
        Some(hint) => fault.with_hint(hint),
        None => fault,
    }
}

/// The graph has no room for an expression.
pub(crate) fn too_large() -> Fault {
    Fault::new(
        fault::EXPRESSION_TOO_LARGE,
        "this expression, or a derivative in it, has more operations than a program may have",
    )
    .with_hint("derivatives of derivatives, and functions of functions, multiply their sizes")
}
