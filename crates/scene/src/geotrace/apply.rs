//! Application of functions: arguments, derivatives, and bodies that are lowered once.
//!
//! In: a function (with the `'`, `_u` and `^n` that follow its name) and its operand. Out: the value, or a request to
//! lower the function's body first.
//!
//! A function has no type of its own. Its body is lowered for the dimensions of the given arguments, over formal inputs
//! `Variable(0..)` that count the components of all its parameters. The result is stored, derivatives are taken of it,
//! and each application substitutes its arguments into it.

use std::sync::Arc;

use expr::value::{self, Value};
use expr::{Graph, Input, NodeId};
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geotrace::dependencies::Dependencies;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::lowerer::{
    BodyId, BodyKey, BodyOutcome, Components, Effect, Function, Lowerer, StackItem,
    dimension_error, too_large,
};
use crate::geotrace::operation::Derivation;
use crate::geotrace::sets::DeclaredSolid;
use crate::geotrace::symbol::Meaning;

impl Lowerer {
    /// Applies a function: `f x`. The function and its operand have been popped from the stack; they are pushed back if
    /// the body has to be lowered first.
    pub(crate) fn apply(
        &mut self,
        function: StackItem,
        operand: StackItem,
        span: Span,
        stack: &mut Vec<StackItem>,
        dependencies: &mut Dependencies,
    ) -> Result<Effect, (SemanticError, Span)> {
        let StackItem::Function(function) = function else {
            return Ok(Effect::Push(StackItem::Poison));
        };
        let symbol = function.symbol;
        let (arguments, body) = match self.symbols.meaning(symbol) {
            Meaning::Poisoned | Meaning::Constant(_) => return Ok(Effect::Push(StackItem::Poison)),
            Meaning::Builtin(_) | Meaning::Geodesic(_) => match self.value(operand.clone())? {
                Some(value) => (vec![value], None),
                None => return Ok(Effect::Push(StackItem::Poison)),
            },
            Meaning::Declared(declared) => {
                let declared = declared.clone();
                match self.arguments(symbol, &declared.parameters, &operand, span)? {
                    Some(arguments) => (arguments, Some(declared.body)),
                    None => return Ok(Effect::Push(StackItem::Poison)),
                }
            }
            Meaning::Solid(solid) => {
                let solid = Arc::clone(solid);
                match self.arguments(symbol, &solid.parameters, &operand, span)? {
                    Some(arguments) => (arguments, None),
                    None => return Ok(Effect::Push(StackItem::Poison)),
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
                stack.push(StackItem::Function(function));
                stack.push(operand);
                let parameters = self.formal_parameters(&key.dimensions);
                return Ok(Effect::Run(key, body, parameters));
            }
            (None, None) => {
                let outcome = self.own_body(&key).unwrap_or_else(failed);
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
            BodyOutcome::Silent => return Ok(Effect::Push(StackItem::Poison)),
            BodyOutcome::Failed(error) => {
                return Err((SemanticError::clone(error), span));
            }
            BodyOutcome::Ready {
                dependencies: body, ..
            } => {
                *dependencies = self.dependencies.union(*dependencies, *body);
                self.substitute(id, &arguments)
                    .ok_or_else(|| (too_large(), span))?
            }
        };
        self.raise(value, &function, span)
    }

    /// Computes `f^n x`, which is `(f x)^n`.
    fn raise(
        &mut self,
        mut value: Value,
        function: &Function,
        span: Span,
    ) -> Result<Effect, (SemanticError, Span)> {
        for exponent in &function.powers {
            let Some(exponent) = exponent else {
                return Ok(Effect::Push(StackItem::Poison));
            };
            value = value::power(&mut self.graph, &value, exponent)
                .map_err(|error| (dimension_error(&error), span))?;
        }
        Ok(Effect::Push(StackItem::Value(value)))
    }

    /// Returns one value per parameter; `None` if the operand has failed.
    fn arguments(
        &mut self,
        symbol: SymbolId,
        parameters: &[Box<str>],
        operand: &StackItem,
        span: Span,
    ) -> Result<Option<Vec<Value>>, (SemanticError, Span)> {
        let expected = parameters.len();
        let given = match operand {
            StackItem::Function(_) | StackItem::Set(_) | StackItem::Poison => return Ok(None),
            // A single parameter takes the whole operand.
            operand if expected == 1 => {
                return Ok(self.value(operand.clone())?.map(|value| vec![value]));
            }
            StackItem::Number(number) => vec![Value::Number(self.graph.constant(*number))],
            StackItem::List(values, _) => values.clone(),
            StackItem::Value(value) => value
                .components()
                .iter()
                .map(|&component| Value::Number(component))
                .collect(),
        };
        if given.len() == expected {
            return Ok(Some(given));
        }
        let name = self.symbols.name(symbol);
        let names: Vec<&str> = parameters.iter().take(8).map(|name| &**name).collect();
        let more = if expected > names.len() { ",…" } else { "" };
        Err((
            SemanticError::new(
                error::ARGUMENT_COUNT,
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

    /// Returns formal parameters of these dimensions, over which a body is lowered.
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

    /// Returns the body of a builtin or of a geodesic, which have no body in the text.
    fn own_body(&mut self, key: &BodyKey) -> Result<BodyOutcome, SemanticError> {
        let parameters = self.formal_parameters(&key.dimensions);
        if let Meaning::Solid(solid) = self.symbols.meaning(key.symbol) {
            return self.solid_body(&Arc::clone(solid), key);
        }
        match (self.symbols.meaning(key.symbol), &parameters[..]) {
            (Meaning::Builtin(builtin), [parameter]) => Ok(BodyOutcome::Ready {
                value: builtin
                    .apply(&mut self.graph, parameter)
                    .map_err(|error| dimension_error(&error))?,
                dependencies: Dependencies::default(),
            }),
            (&Meaning::Geodesic(id), [Value::Number(_)]) => {
                let geodesic = self.geodesics.get(id);
                let dependencies = geodesic.map(|it| it.dependencies).unwrap_or_default();
                let (graph, sets) = (&mut self.graph, &mut self.dependencies);
                let place = self.geodesics.body(graph, sets, id);
                Ok(
                    place.map_or(BodyOutcome::Silent, |place| BodyOutcome::Ready {
                        value: Value::Vector(place),
                        dependencies,
                    }),
                )
            }
            (Meaning::Geodesic(_), [argument]) => Err(SemanticError::new(
                error::DIMENSION_MISMATCH,
                format!(
                    "the parameter of the geodesic `{}` is a number, but this is a vector of dimension {}",
                    self.symbols.name(key.symbol),
                    argument.dimension()
                ),
            )),
            _ => Ok(BodyOutcome::Silent),
        }
    }

    /// Returns the body of a solid as a function of numbers.
    fn solid_body(
        &mut self,
        solid: &DeclaredSolid,
        key: &BodyKey,
    ) -> Result<BodyOutcome, SemanticError> {
        if let Some(position) = key.dimensions.iter().position(|dimension| *dimension != 1) {
            let message = format!(
                "the parameter `{}` of the solid `{}` is a number, but this is a vector of dimension {}",
                self.symbols.parameter(key.symbol, position),
                self.symbols.name(key.symbol),
                key.dimensions[position]
            );
            return Err(SemanticError::new(error::DIMENSION_MISMATCH, message));
        }
        Ok(BodyOutcome::Ready {
            value: Value::Number(self.solid_function(solid)?),
            dependencies: solid.value_dependencies,
        })
    }

    /// Returns the derivative of the body `id`, which is the body of `key` or one of its derivatives.
    fn derive(
        &mut self,
        id: BodyId,
        derivation: Derivation,
        key: &BodyKey,
    ) -> Result<BodyOutcome, SemanticError> {
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
            return Err(SemanticError::new(
                error::VECTOR_DERIVATIVE,
                format!(
                    "a derivative is taken with respect to a number, but the parameter `{parameter}` of `{name}` is a vector of dimension {dimension} here"
                ),
            )
            .with_hint(format!(
                "give the function one parameter for each component of `{parameter}`, and differentiate by those"
            )));
        }
        let offset: usize = key.dimensions[..position.min(key.dimensions.len())]
            .iter()
            .sum();
        let (graph, sets) = (&mut self.graph, &mut self.dependencies);
        let by = Input::Variable(offset as u32);
        let derivatives = self
            .geodesics
            .derivatives(graph, value.components(), by)
            .map_err(|_| too_large())?;
        Ok(BodyOutcome::Ready {
            dependencies: self.geodesics.dependencies(graph, sets, &derivatives),
            value: like(&value, derivatives),
        })
    }

    /// Returns a body's value for given arguments; `None` if the graph is full.
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
        let (graph, sets) = (&mut self.graph, &mut self.dependencies);
        let nodes = self
            .geodesics
            .substitute(graph, sets, value.components(), &application.1)
            .ok()?;
        let components = nodes.as_slice().into();
        self.applications.values.insert(application, components);
        Some(like(&value, nodes))
    }
}

/// Returns a value of the same dimension with other components.
fn like(value: &Value, nodes: Vec<NodeId>) -> Value {
    match (value, &nodes[..]) {
        (Value::Number(_), [node]) => Value::Number(*node),
        _ => Value::Vector(nodes),
    }
}

fn failed(error: SemanticError) -> BodyOutcome {
    BodyOutcome::Failed(Arc::new(error))
}
