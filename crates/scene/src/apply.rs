//! Functions where they are applied: arguments, derivatives, and bodies that are lowered once.
//!
//! What flows in: a function (with the `'`, `_u` and `^n` that follow its name) and its operand. What flows
//! out: the value, or the demand to lower the function's body first.
//!
//! A function has no type of its own. Its body is lowered for the dimensions of the arguments at hand, over
//! formal inputs `Variable(0..)` that count the components of all its parameters; it is kept, derivatives are
//! taken of it, and each application substitutes its arguments into it.

use std::sync::Arc;

use expr::value::{self, Value};
use expr::{Graph, Input, NodeId};
use rustc_hash::FxHashMap;
use syntax::span::Span;
use syntax::token::SymbolId;

use crate::fault::{self, Fault};
use crate::lower::{Effect, Function, Item, Lowerer, dimension_fault, too_large};
use crate::reads::Reads;
use crate::symbol::{Declared, Meaning};

/// One derivative of a function.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(crate) enum Derivation {
    /// `f_u`, by the parameter at this position.
    By(u32),
    /// `f'`, by the only parameter.
    Total,
}

/// Which body: that of a function for these dimensions of its arguments (1 for a number).
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub(crate) struct BodyKey {
    pub(crate) symbol: SymbolId,
    dimensions: Vec<usize>,
}

/// A position in [`Applications::bodies`].
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(crate) struct BodyId(u32);

/// What lowering a body has given.
#[derive(Clone, Debug)]
pub(crate) enum BodyOutcome {
    /// Its value over the formal inputs, and the params and grids that it reads.
    Ready {
        value: Value,
        reads: Reads,
    },
    Failed(Arc<Fault>),
    /// It uses a name whose own declaration failed.
    Silent,
}

/// The numbers of some values, one after the other.
type Components = Box<[NodeId]>;

/// The bodies that have been lowered, and the applications that have been made.
#[derive(Clone, Debug, Default)]
pub(crate) struct Applications {
    ids: FxHashMap<BodyKey, BodyId>,
    /// The derivatives of bodies, each by the body that it is taken of: a row of primes costs one entry each.
    derived: FxHashMap<(BodyId, Derivation), BodyId>,
    bodies: Vec<BodyOutcome>,
    /// The components of a body's value for those of its arguments: an application is written out once, however
    /// often it stands in the text.
    values: FxHashMap<(BodyId, Components), Components>,
}

impl Applications {
    /// A body has been lowered.
    pub(crate) fn add(&mut self, key: BodyKey, outcome: BodyOutcome) -> BodyId {
        let id = self.push(outcome);
        self.ids.insert(key, id);
        id
    }

    /// The derivative of a body has been taken.
    fn add_derived(&mut self, of: BodyId, by: Derivation, outcome: BodyOutcome) -> BodyId {
        let id = self.push(outcome);
        self.derived.insert((of, by), id);
        id
    }

    fn push(&mut self, outcome: BodyOutcome) -> BodyId {
        let id = BodyId(self.bodies.len() as u32);
        self.bodies.push(outcome);
        id
    }

    fn body(&self, id: BodyId) -> &BodyOutcome {
        &self.bodies[id.0 as usize]
    }
}

impl Lowerer {
    /// `f x`. The function and its operand have been taken from the stack; they are put back where the body
    /// has to be lowered first.
    pub(crate) fn apply(
        &mut self,
        function: Item,
        operand: Item,
        span: Span,
        stack: &mut Vec<Item>,
        reads: &mut Reads,
    ) -> Result<Effect, (Fault, Span)> {
        let Item::Function(function) = function else {
            return Ok(Effect::Push(Item::Poison));
        };
        let symbol = function.symbol;
        let (arguments, body) = match self.symbols.meaning(symbol) {
            Meaning::Poisoned | Meaning::Constant(_) => return Ok(Effect::Push(Item::Poison)),
            Meaning::Geodesic => {
                let fault = self.symbols.value_fault(symbol);
                return fault.map_or(Ok(Effect::Push(Item::Poison)), |fault| Err((fault, span)));
            }
            Meaning::Builtin(_) => match self.value(operand.clone())? {
                Some(value) => (vec![value], None),
                None => return Ok(Effect::Push(Item::Poison)),
            },
            Meaning::Declared(declared) => {
                let declared = declared.clone();
                match self.arguments(symbol, &declared, &operand, span)? {
                    Some(arguments) => (arguments, Some(declared.body)),
                    None => return Ok(Effect::Push(Item::Poison)),
                }
            }
        };
        let key = BodyKey {
            symbol,
            dimensions: arguments.iter().map(Value::dimension).collect(),
        };
        let mut id = match (self.applications.ids.get(&key), body) {
            (Some(&id), _) => id,
            (None, Some(body)) => {
                stack.push(Item::Function(function));
                stack.push(operand);
                let parameters = self.formal_parameters(&key.dimensions);
                return Ok(Effect::Run(key, body, parameters));
            }
            (None, None) => {
                let outcome = self.builtin_body(&key).unwrap_or_else(failed);
                self.applications.add(key.clone(), outcome)
            }
        };
        for &derivation in &function.derivations {
            id = match self.applications.derived.get(&(id, derivation)) {
                Some(&known) => known,
                None => {
                    let outcome = self.derive(id, derivation, &key).unwrap_or_else(failed);
                    self.applications.add_derived(id, derivation, outcome)
                }
            };
        }
        let value = match self.applications.body(id) {
            BodyOutcome::Silent => return Ok(Effect::Push(Item::Poison)),
            BodyOutcome::Failed(fault) => {
                return Err((Fault::clone(fault), span));
            }
            BodyOutcome::Ready { reads: body, .. } => {
                *reads = self.reads.union(*reads, *body);
                self.substitute(id, &arguments)
                    .ok_or_else(|| (too_large(), span))?
            }
        };
        self.raise(value, &function, span)
    }

    /// `f^n x` is `(f x)^n`.
    fn raise(
        &mut self,
        mut value: Value,
        function: &Function,
        span: Span,
    ) -> Result<Effect, (Fault, Span)> {
        for exponent in &function.powers {
            let Some(exponent) = exponent else {
                return Ok(Effect::Push(Item::Poison));
            };
            value = value::power(&mut self.graph, &value, exponent)
                .map_err(|error| (dimension_fault(&error), span))?;
        }
        Ok(Effect::Push(Item::Value(value)))
    }

    /// One value per parameter; none where the operand has failed.
    fn arguments(
        &mut self,
        symbol: SymbolId,
        declared: &Declared,
        operand: &Item,
        span: Span,
    ) -> Result<Option<Vec<Value>>, (Fault, Span)> {
        let expected = declared.parameters.len();
        let given = match operand {
            Item::Function(_) | Item::Poison => return Ok(None),
            // One parameter takes the whole operand.
            operand if expected == 1 => {
                return Ok(self.value(operand.clone())?.map(|value| vec![value]));
            }
            Item::Number(number) => vec![Value::Number(self.graph.constant(*number))],
            Item::List(values, _) => values.clone(),
            Item::Value(value) => value
                .components()
                .iter()
                .map(|&component| Value::Number(component))
                .collect(),
        };
        if given.len() == expected {
            return Ok(Some(given));
        }
        let name = self.symbols.name(symbol);
        let names: Vec<&str> = declared
            .parameters
            .iter()
            .take(8)
            .map(|name| &**name)
            .collect();
        let more = if expected > names.len() { ",…" } else { "" };
        Err((
            Fault::new(
                fault::ARGUMENT_COUNT,
                format!(
                    "`{name}` takes {expected} arguments, but {} given",
                    match given.len() {
                        1 => "1 is".to_owned(),
                        count => format!("{count} are"),
                    }
                ),
            )
            .with_hint(format!(
                "write `{name}({}{more})`, or give it one vector of dimension {expected}",
                names.join(",")
            )),
            span,
        ))
    }

    /// The values that stand for parameters of these dimensions while a body is lowered.
    fn formal_parameters(&mut self, dimensions: &[usize]) -> Vec<Value> {
        let mut next = 0;
        let mut input = |graph: &mut Graph| {
            next += 1;
            graph.input(Input::Variable(next - 1))
        };
        dimensions
            .iter()
            .map(|&dimension| match dimension {
                1 => Value::Number(input(&mut self.graph)),
                _ => Value::Vector((0..dimension).map(|_| input(&mut self.graph)).collect()),
            })
            .collect()
    }

    /// The body of a builtin.
    fn builtin_body(&mut self, key: &BodyKey) -> Result<BodyOutcome, Fault> {
        let parameters = self.formal_parameters(&key.dimensions);
        let (Meaning::Builtin(builtin), [parameter]) =
            (self.symbols.meaning(key.symbol), &parameters[..])
        else {
            return Ok(BodyOutcome::Silent);
        };
        let value = builtin
            .apply(&mut self.graph, parameter)
            .map_err(|error| dimension_fault(&error))?;
        Ok(BodyOutcome::Ready {
            value,
            reads: Reads::default(),
        })
    }

    /// The derivative of the body `id`, which is one of `key`'s or of its derivatives.
    fn derive(
        &mut self,
        id: BodyId,
        derivation: Derivation,
        key: &BodyKey,
    ) -> Result<BodyOutcome, Fault> {
        let BodyOutcome::Ready { value, .. } = self.applications.body(id).clone() else {
            return Ok(self.applications.body(id).clone());
        };
        let position = match derivation {
            Derivation::By(position) => position as usize,
            Derivation::Total => 0,
        };
        let dimension = key.dimensions.get(position).copied().unwrap_or(1);
        if dimension != 1 {
            let name = self.symbols.name(key.symbol);
            let parameter = self.symbols.parameter(key.symbol, position);
            return Err(Fault::new(
                fault::VECTOR_DERIVATIVE,
                format!(
                    "a derivative is taken by a number, but the parameter `{parameter}` of `{name}` is a vector of dimension {dimension} here"
                ),
            )
            .with_hint(format!(
                "give the function one parameter for each component of `{parameter}`, and derive by those"
            )));
        }
        let offset: usize = key.dimensions[..position.min(key.dimensions.len())]
            .iter()
            .sum();
        let derivatives = self
            .graph
            .derivatives(value.components(), Input::Variable(offset as u32))
            .map_err(|_| too_large())?;
        Ok(BodyOutcome::Ready {
            reads: self.reads.of(&self.graph.inputs(&derivatives)),
            value: like(&value, derivatives),
        })
    }

    /// A body's value for some arguments; none where the graph is full.
    fn substitute(&mut self, id: BodyId, arguments: &[Value]) -> Option<Value> {
        let BodyOutcome::Ready { value, .. } = self.applications.body(id).clone() else {
            return None;
        };
        let replacements: Components = arguments
            .iter()
            .flat_map(|argument| argument.components().iter().copied())
            .collect();
        let application = (id, replacements);
        if let Some(known) = self.applications.values.get(&application) {
            return Some(like(&value, known.to_vec()));
        }
        let replacements = &application.1;
        let replace = |input| match input {
            Input::Variable(index) => replacements.get(index as usize).copied(),
            Input::Uniform(_) => None,
        };
        let nodes = self.graph.substitute(value.components(), &replace).ok()?;
        let components = nodes.as_slice().into();
        self.applications.values.insert(application, components);
        Some(like(&value, nodes))
    }
}

/// A value of the same dimension with other components.
fn like(value: &Value, nodes: Vec<NodeId>) -> Value {
    match (value, &nodes[..]) {
        (Value::Number(_), [node]) => Value::Number(*node),
        _ => Value::Vector(nodes),
    }
}

fn failed(fault: Fault) -> BodyOutcome {
    BodyOutcome::Failed(Arc::new(fault))
}
