//! The state of lowering: everything on which an expression's meaning depends, and the items on the stack.
//!
//! ```text
//! lower.rs ──▶ runs steps ─┐
//! apply.rs ──▶ applies ────┼─▶ this file: the graph, the symbols, the bodies that have been lowered
//! geodesics.rs ──▶ values ─┘
//! ```

use std::sync::Arc;

use expr::value::{self, DimensionError, Value};
use expr::{Graph, NodeId};
use rustc_hash::FxHashMap;
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geodesic_value::numbers;
use crate::geotrace::code::{Code, Expression};
use crate::geotrace::dependencies::{Dependencies, DependencySets};
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::geodesics::{GeodesicFaults, Geodesics};
use crate::geotrace::operation::Derivation;
use crate::geotrace::sets::PointSet;
use crate::geotrace::symbol::Symbols;

/// Everything that the meaning of an expression depends on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lowerer {
    pub(crate) graph: Graph,
    pub(crate) code: Code,
    pub(crate) symbols: Symbols,
    pub(crate) applications: Applications,
    pub(crate) dependencies: DependencySets,
    pub(crate) geodesics: Geodesics,
    /// True if the variables of the expression that is being lowered are those of a curve, along which geodesics are
    /// followed.
    pub(crate) is_along_curve: bool,
    /// The uniforms for a grid inside a union over it that is surrounded by another such union, by the first of the grid's
    /// own uniforms, the number of surrounding unions, and the number of components.
    pub(crate) bound_uniforms: FxHashMap<(u32, u32, u32), u32>,
    /// True if the set that is being read depends on a grid at which a part of it closes.
    pub(crate) renames_parts: bool,
    /// True if the graph has reached its limit, which has been reported.
    pub(crate) full: bool,
}

/// The result of running an expression.
#[derive(Clone, Debug)]
pub(crate) struct Lowered {
    /// Its value; `None` after an error, or if it uses a name whose declaration failed.
    pub(crate) value: Option<Value>,
    /// The params and grids that it reads, whether or not its value depends on them.
    pub(crate) dependencies: Dependencies,
}

/// An item of the stack.
#[derive(Clone, Debug)]
pub(crate) enum StackItem {
    /// A number known at compile time, which has no node in the graph yet.
    Number(f64),
    Value(Value),
    /// A bracketed list that contains a vector: arguments, or an error where a value is required. With its span.
    List(Vec<Value>, Span),
    Function(Box<Function>),
    Set(Box<PointSet>),
    /// The result of an error that has been reported.
    Poison,
}

/// A function that is about to be applied.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) symbol: SymbolId,
    pub(crate) derivations: Vec<Derivation>,
    /// The exponents of `f^n`; `None` for an exponent that has failed.
    pub(crate) powers: Vec<Option<Value>>,
}

/// The effect of a step.
pub(crate) enum Effect {
    /// An item for the stack.
    Push(StackItem),
    /// Nothing yet: the body has to be run first, with these parameters, and then the step again.
    Run(BodyKey, Expression, Vec<Value>),
}

/// The key of a body: the function with the dimensions of its arguments (1 for a number).
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub(crate) struct BodyKey {
    pub(crate) symbol: SymbolId,
    pub(crate) dimensions: Vec<usize>,
}

/// An index into [`Applications::bodies`].
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(crate) struct BodyId(u32);

/// The result of lowering a body.
#[derive(Clone, Debug)]
pub(crate) enum BodyOutcome {
    /// Its value over the formal inputs, and the params and grids that it reads.
    Ready {
        value: Value,
        dependencies: Dependencies,
    },
    Failed(Arc<SemanticError>),
    /// It uses a name whose own declaration failed.
    Silent,
}

/// The numbers of some values, concatenated.
pub(crate) type Components = Box<[NodeId]>;

/// The lowered bodies, and their applications.
#[derive(Clone, Debug, Default)]
pub(crate) struct Applications {
    pub(crate) ids: FxHashMap<BodyKey, BodyId>,
    /// The derivatives of bodies, by the body that is differentiated: a row of primes costs one entry for each.
    pub(crate) derived: FxHashMap<(BodyId, Derivation), BodyId>,
    bodies: Vec<BodyOutcome>,
    /// The components of a body's value, by the components of its arguments: an application is expanded once, however
    /// often it occurs in the text.
    pub(crate) values: FxHashMap<(BodyId, Components), Components>,
}

impl Applications {
    /// Records that a body has been lowered.
    pub(crate) fn add(&mut self, key: BodyKey, outcome: BodyOutcome) -> BodyId {
        let id = self.push(outcome);
        self.ids.insert(key, id);
        id
    }

    /// Records that the derivative of a body has been computed.
    pub(crate) fn add_derived(
        &mut self,
        of: BodyId,
        by: Derivation,
        outcome: BodyOutcome,
    ) -> BodyId {
        let id = self.push(outcome);
        self.derived.insert((of, by), id);
        id
    }

    fn push(&mut self, outcome: BodyOutcome) -> BodyId {
        let id = BodyId(self.bodies.len() as u32);
        self.bodies.push(outcome);
        id
    }

    pub(crate) fn body(&self, id: BodyId) -> &BodyOutcome {
        &self.bodies[id.0 as usize]
    }
}

impl Lowerer {
    /// Returns the numbers of nodes that depend on no param and no grid, one each.
    pub(crate) fn numbers(&self, nodes: &[NodeId]) -> Vec<f64> {
        let (uniforms, _) = self.values_of_geodesics(nodes);
        numbers(&self.graph, nodes, &uniforms, &[])
    }

    /// Returns the uniforms, with the values of geodesics that nodes read and all others NaN; empty if they read no
    /// geodesic. Also returns the geodesics without a value.
    pub(crate) fn values_of_geodesics(&self, nodes: &[NodeId]) -> (Vec<f64>, GeodesicFaults) {
        if self.geodesics.read(&self.graph, nodes).is_empty() {
            return (Vec::new(), Vec::new());
        }
        let mut uniforms = vec![f64::NAN; self.dependencies.uniform_count() as usize];
        let faults = self.geodesics.fill(&self.graph, nodes, &mut uniforms);
        (uniforms, faults)
    }

    /// Returns the value of an item; `None` for the result of a reported error.
    pub(crate) fn value(
        &mut self,
        item: StackItem,
    ) -> Result<Option<Value>, (SemanticError, Span)> {
        match item {
            StackItem::Number(number) => Ok(Some(Value::Number(self.graph.constant(number)))),
            StackItem::Value(value) => Ok(Some(value)),
            StackItem::List(values, span) => match value::tuple(&values) {
                Ok(value) => Ok(Some(value)),
                Err(error) => Err((dimension_error(&error), span)),
            },
            StackItem::Function(_) | StackItem::Set(_) | StackItem::Poison => Ok(None),
        }
    }
}

/// Returns the error of the dimensions of an operation's operands.
pub(crate) fn dimension_error(error: &DimensionError) -> SemanticError {
    let code = match error {
        DimensionError::Component { .. } => error::NO_SUCH_COMPONENT,
        _ => error::DIMENSION_MISMATCH,
    };
    let found = SemanticError::new(code, error.to_string());
    match error.hint() {
        Some(hint) => found.with_hint(hint),
        None => found,
    }
}

/// Returns the error of an expression for which the graph has no room.
pub(crate) fn too_large() -> SemanticError {
    SemanticError::new(
        error::EXPRESSION_TOO_LARGE,
        "this expression, or a derivative in it, has more operations than a program may have",
    )
    .with_hint("derivatives of derivatives, and functions of functions, multiply their sizes")
}
