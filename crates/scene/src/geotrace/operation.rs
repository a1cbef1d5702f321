//! The table of operators.
//!
//! Each operator on values has one row: its effect on numbers known at compile time (so that a long sum does not take a
//! node of the graph for each step), and on values over the graph.

use expr::Graph;
use expr::ops::power;
use expr::value::{self, DimensionError, Value};
use syntax::geotrace::actions::Operator;
use syntax::symbol::SymbolId;

use crate::geotrace::sets::SetMotion;
use crate::solid::SolidStep;

/// A derivative of a function.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(crate) enum Derivation {
    /// `f_u`, by the parameter with this index.
    By(u32),
    /// `f'`, by the only parameter.
    Total,
}

/// The effect of an operator on the stack: it pops its operands and pushes one item.
#[derive(Clone, Debug)]
pub(crate) enum Operation {
    Number(f64),
    Constant(SymbolId),
    Variable(u32),
    Function(SymbolId),
    /// Differentiates the function on top.
    Derive(Derivation),
    /// Raises the value of the function below the exponent.
    FunctionPower,
    Apply,
    Tuple(u32),
    Component(u32),
    Unary(&'static Unary),
    Binary(&'static Binary),
    /// Converts the function on top to a set.
    Atom,
    /// Joins two sets.
    Join(SolidStep),
    /// Places the set below a value by the value.
    Place(SetMotion),
    /// Replaces the set below a function by its image under the function.
    Image,
}

/// An operator on one value.
#[derive(Debug)]
pub(crate) struct Unary {
    pub(crate) number: fn(f64) -> f64,
    pub(crate) value: fn(&mut Graph, &Value) -> Result<Value, DimensionError>,
}

/// An operator on two values.
#[derive(Debug)]
pub(crate) struct Binary {
    pub(crate) numbers: fn(f64, f64) -> f64,
    pub(crate) values: fn(&mut Graph, &Value, &Value) -> Result<Value, DimensionError>,
}

/// Returns the operation of an operator.
pub(crate) fn operation(operator: Operator) -> Operation {
    use Operation::{Binary, Unary};
    match operator {
        Operator::Number(number) => Operation::Number(number),
        Operator::Constant(symbol) => Operation::Constant(symbol),
        Operator::Variable(position) => Operation::Variable(position),
        Operator::Function(symbol) => Operation::Function(symbol),
        Operator::Partial(position) => Operation::Derive(Derivation::By(position)),
        Operator::Total => Operation::Derive(Derivation::Total),
        Operator::FunctionPower => Operation::FunctionPower,
        Operator::Apply => Operation::Apply,
        Operator::Tuple(count) => Operation::Tuple(count),
        Operator::Component(index) => Operation::Component(index),
        Operator::Plus => Unary(&PLUS),
        Operator::Negate => Unary(&NEGATE),
        Operator::Square => Unary(&SQUARE),
        Operator::Reciprocal => Unary(&RECIPROCAL),
        Operator::Add => Binary(&ADD),
        Operator::Subtract => Binary(&SUBTRACT),
        Operator::Juxtapose => Binary(&JUXTAPOSE),
        Operator::Multiply => Binary(&MULTIPLY),
        Operator::Divide => Binary(&DIVIDE),
        Operator::Power => Binary(&POWER),
        // It only marks the position of a light.
        Operator::Position => Operation::Tuple(1),
        Operator::Atom => Operation::Atom,
        Operator::Union => Operation::Join(SolidStep::Union),
        Operator::Intersection => Operation::Join(SolidStep::Intersection),
        Operator::Difference => Operation::Join(SolidStep::Difference),
        Operator::Move => Operation::Place(SetMotion::Move),
        Operator::Scale => Operation::Place(SetMotion::Scale),
        Operator::Rotate => Operation::Place(SetMotion::Rotate),
        Operator::Image => Operation::Image,
    }
}

impl Operation {
    /// Returns the number of items that it pops from the stack; each operation pushes one.
    pub(crate) fn operand_count(&self) -> usize {
        match self {
            Self::Number(_) | Self::Constant(_) | Self::Variable(_) | Self::Function(_) => 0,
            Self::Derive(_) | Self::Unary(_) | Self::Component(_) | Self::Atom => 1,
            Self::FunctionPower | Self::Apply | Self::Binary(_) => 2,
            Self::Join(_) | Self::Place(_) | Self::Image => 2,
            Self::Tuple(count) => *count as usize,
        }
    }
}

static PLUS: Unary = Unary {
    number: |a| a,
    value: |_, a| Ok(a.clone()),
};

static NEGATE: Unary = Unary {
    number: |a| -a,
    value: |graph, a| Ok(value::negate(graph, a)),
};

static SQUARE: Unary = Unary {
    number: |a| a * a,
    value: |graph, a| Ok(value::square(graph, a)),
};

static RECIPROCAL: Unary = Unary {
    number: |a| 1.0 / a,
    value: value::reciprocal,
};

static ADD: Binary = Binary {
    numbers: |a, b| a + b,
    values: value::add,
};

static SUBTRACT: Binary = Binary {
    numbers: |a, b| a - b,
    values: value::subtract,
};

static JUXTAPOSE: Binary = Binary {
    numbers: |a, b| a * b,
    values: value::juxtapose,
};

static MULTIPLY: Binary = Binary {
    numbers: |a, b| a * b,
    values: value::multiply,
};

static DIVIDE: Binary = Binary {
    numbers: |a, b| a / b,
    values: value::divide,
};

static POWER: Binary = Binary {
    numbers: power,
    values: value::power,
};
