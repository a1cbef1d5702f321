//! Values of the language: numbers, and vectors of numbers.
//!
//! What flows in: values and a graph. What flows out: the value of an operator, or what is wrong with the
//! dimensions. Each function is a row of the language's table of operators.

use std::fmt;

use crate::graph::{Graph, NodeId};

/// A number, or a vector of dimension two or more.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub enum Value {
    /// A number.
    Number(NodeId),
    /// A vector by its components, at least two.
    Vector(Vec<NodeId>),
}

/// An operation that takes two values, for messages.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Pairing {
    /// `a + b`.
    Sum,
    /// `a - b`.
    Difference,
}

/// Why values do not go together. Dimension 1 stands for a number.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum DimensionError {
    /// A sum or difference of values that are not of one dimension.
    Unequal {
        /// Which of the two.
        pairing: Pairing,
        /// The dimension on the left.
        left: usize,
        /// The dimension on the right.
        right: usize,
    },
    /// A dot product of vectors of two dimensions.
    DotProduct {
        /// The dimension on the left.
        left: usize,
        /// The dimension on the right.
        right: usize,
    },
    /// A cross product of vectors that are not both of dimension 3.
    CrossProduct {
        /// The dimension on the left.
        left: usize,
        /// The dimension on the right.
        right: usize,
    },
    /// A division by a vector.
    Divisor {
        /// The dimension of what is divided.
        left: usize,
        /// The dimension of the divisor.
        right: usize,
    },
    /// The reciprocal of a vector.
    Reciprocal {
        /// Its dimension.
        dimension: usize,
    },
    /// A power with a vector as its base or its exponent.
    Power {
        /// The dimension of the base.
        base: usize,
        /// The dimension of the exponent.
        exponent: usize,
    },
    /// A component that the value does not have.
    NoComponent {
        /// Which, from 1.
        component: u32,
        /// The value's dimension.
        dimension: usize,
    },
    /// A vector among the components of a vector.
    ComponentNotNumber {
        /// Which component, from 1.
        component: usize,
        /// Its dimension.
        dimension: usize,
    },
    /// A vector of no components.
    NoComponents,
    /// A vector where a function takes a number.
    Argument {
        /// The function's name.
        function: &'static str,
        /// The vector's dimension.
        dimension: usize,
    },
}

impl Value {
    /// Its dimension; 1 for a number.
    pub fn dimension(&self) -> usize {
        self.components().len()
    }

    /// Its components; a number is its own.
    pub fn components(&self) -> &[NodeId] {
        match self {
            Self::Number(node) => std::slice::from_ref(node),
            Self::Vector(nodes) => nodes,
        }
    }

    /// The node of a number.
    pub fn number(&self) -> Option<NodeId> {
        match self {
            Self::Number(node) => Some(*node),
            Self::Vector(_) => None,
        }
    }

    /// The value with these components; `None` if there are none.
    pub fn from_components(nodes: Vec<NodeId>) -> Option<Self> {
        match nodes[..] {
            [] => None,
            [node] => Some(Self::Number(node)),
            _ => Some(Self::Vector(nodes)),
        }
    }

    fn map(&self, mut to: impl FnMut(NodeId) -> NodeId) -> Self {
        match self {
            Self::Number(node) => Self::Number(to(*node)),
            Self::Vector(nodes) => Self::Vector(nodes.iter().map(|&node| to(node)).collect()),
        }
    }
}

/// `a + b`: numbers, or vectors of one dimension.
///
/// # Errors
/// [`DimensionError::Unequal`].
pub fn add(graph: &mut Graph, a: &Value, b: &Value) -> Result<Value, DimensionError> {
    componentwise(a, b, Pairing::Sum, |a, b| graph.add(a, b))
}

/// `a - b`: numbers, or vectors of one dimension.
///
/// # Errors
/// [`DimensionError::Unequal`].
pub fn subtract(graph: &mut Graph, a: &Value, b: &Value) -> Result<Value, DimensionError> {
    componentwise(a, b, Pairing::Difference, |a, b| graph.sub(a, b))
}

/// `+a`: the value itself.
///
/// # Errors
/// None; a result like that of the other operators.
pub fn plus(a: &Value) -> Result<Value, DimensionError> {
    Ok(a.clone())
}

/// `-a`.
///
/// # Errors
/// None; a result like that of the other operators.
pub fn negate(graph: &mut Graph, a: &Value) -> Result<Value, DimensionError> {
    Ok(a.map(|a| graph.neg(a)))
}

/// `a b`, side by side: the product of numbers, a vector scaled, the dot product of vectors of one dimension.
///
/// # Errors
/// [`DimensionError::DotProduct`].
pub fn juxtapose(graph: &mut Graph, a: &Value, b: &Value) -> Result<Value, DimensionError> {
    match (a, b) {
        (Value::Vector(x), Value::Vector(y)) => {
            if x.len() == y.len() {
                Ok(Value::Number(dot(graph, x, y)))
            } else {
                Err(DimensionError::DotProduct {
                    left: x.len(),
                    right: y.len(),
                })
            }
        }
        (Value::Number(scale), vector) | (vector, Value::Number(scale)) => {
            Ok(vector.map(|component| graph.mul(*scale, component)))
        }
    }
}

/// `a * b`: the product of numbers, a vector scaled, the cross product of vectors of dimension 3.
///
/// # Errors
/// [`DimensionError::CrossProduct`].
pub fn multiply(graph: &mut Graph, a: &Value, b: &Value) -> Result<Value, DimensionError> {
    match (a, b) {
        (Value::Vector(x), Value::Vector(y)) => match (&x[..], &y[..]) {
            (&[x1, x2, x3], &[y1, y2, y3]) => {
                let mut minor = |a, b, c, d| {
                    let first = graph.mul(a, b);
                    let second = graph.mul(c, d);
                    graph.sub(first, second)
                };
                Ok(Value::Vector(vec![
                    minor(x2, y3, x3, y2),
                    minor(x3, y1, x1, y3),
                    minor(x1, y2, x2, y1),
                ]))
            }
            _ => Err(DimensionError::CrossProduct {
                left: x.len(),
                right: y.len(),
            }),
        },
        _ => juxtapose(graph, a, b),
    }
}

/// `a / b`: a number or a vector by a number.
///
/// # Errors
/// [`DimensionError::Divisor`].
pub fn divide(graph: &mut Graph, a: &Value, b: &Value) -> Result<Value, DimensionError> {
    match b {
        Value::Number(divisor) => Ok(a.map(|a| graph.div(a, *divisor))),
        Value::Vector(_) => Err(DimensionError::Divisor {
            left: a.dimension(),
            right: b.dimension(),
        }),
    }
}

/// `a ^ b`: a number to the power of a number, see [`crate::ops::power`].
///
/// # Errors
/// [`DimensionError::Power`].
pub fn power(graph: &mut Graph, a: &Value, b: &Value) -> Result<Value, DimensionError> {
    match (a, b) {
        (Value::Number(base), Value::Number(exponent)) => {
            Ok(Value::Number(graph.power(*base, *exponent)))
        }
        _ => Err(DimensionError::Power {
            base: a.dimension(),
            exponent: b.dimension(),
        }),
    }
}

/// `*a`: a·a of a number, the dot product with itself of a vector.
///
/// # Errors
/// None; a result like that of the other operators.
pub fn square(graph: &mut Graph, a: &Value) -> Result<Value, DimensionError> {
    Ok(Value::Number(dot(graph, a.components(), a.components())))
}

/// `/a`: 1/a of a number.
///
/// # Errors
/// [`DimensionError::Reciprocal`].
pub fn reciprocal(graph: &mut Graph, a: &Value) -> Result<Value, DimensionError> {
    match a {
        Value::Number(a) => {
            let one = graph.constant(1.0);
            Ok(Value::Number(graph.div(one, *a)))
        }
        Value::Vector(nodes) => Err(DimensionError::Reciprocal {
            dimension: nodes.len(),
        }),
    }
}

/// `a_n`: a component of a vector, counted from 1.
///
/// # Errors
/// [`DimensionError::NoComponent`]; a number has none.
pub fn component(a: &Value, n: u32) -> Result<Value, DimensionError> {
    let missing = DimensionError::NoComponent {
        component: n,
        dimension: a.dimension(),
    };
    match a {
        Value::Number(_) => Err(missing),
        Value::Vector(nodes) => (n as usize)
            .checked_sub(1)
            .and_then(|index| nodes.get(index))
            .map(|&node| Value::Number(node))
            .ok_or(missing),
    }
}

/// `(a, b, …)`: a vector of numbers; of one value, that value.
///
/// # Errors
/// [`DimensionError::ComponentNotNumber`]; [`DimensionError::NoComponents`] where there are none.
pub fn tuple(values: &[Value]) -> Result<Value, DimensionError> {
    if let [value] = values {
        return Ok(value.clone());
    }
    let mut nodes = Vec::with_capacity(values.len());
    for (index, value) in values.iter().enumerate() {
        match value {
            Value::Number(node) => nodes.push(*node),
            Value::Vector(_) => {
                return Err(DimensionError::ComponentNotNumber {
                    component: index + 1,
                    dimension: value.dimension(),
                });
            }
        }
    }
    Value::from_components(nodes).ok_or(DimensionError::NoComponents)
}

impl DimensionError {
    /// What to write instead, where that is known.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::CrossProduct { left, right } if left == right => {
                Some("write them side by side for the dot product")
            }
            Self::Power { base, exponent: 1 } if *base > 1 => {
                Some("`*v` is the square of a vector's length")
            }
            Self::Reciprocal { .. } => Some("divide by its length: `v/sqrt*v` has length 1"),
            _ => None,
        }
    }
}

impl fmt::Display for DimensionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Unequal {
                pairing: Pairing::Sum,
                left,
                right,
            } => write!(f, "cannot add {} and {}", Kind(left), Kind(right)),
            Self::Unequal {
                pairing: Pairing::Difference,
                left,
                right,
            } => write!(f, "cannot subtract {} from {}", Kind(right), Kind(left)),
            Self::DotProduct { left, right } => write!(
                f,
                "a dot product needs two vectors of the same dimension, not of dimension {left} and dimension {right}"
            ),
            Self::CrossProduct { left, right } => write!(
                f,
                "a cross product needs two vectors of dimension 3, not of dimension {left} and dimension {right}"
            ),
            Self::Divisor { left, right } => {
                write!(f, "cannot divide {} by {}", Kind(left), Kind(right))
            }
            Self::Reciprocal { dimension } => {
                write!(f, "{} has no reciprocal", Kind(dimension))
            }
            Self::Power { base, exponent } => write!(
                f,
                "cannot raise {} to the power of {}",
                Kind(base),
                Kind(exponent)
            ),
            Self::NoComponent {
                component,
                dimension: 1,
            } => write!(f, "a number has no components, so no component {component}"),
            Self::NoComponent {
                component,
                dimension,
            } => write!(
                f,
                "there is no component {component} of {}",
                Kind(dimension)
            ),
            Self::ComponentNotNumber {
                component,
                dimension,
            } => write!(
                f,
                "each component must be a number, but component {component} is {}",
                Kind(dimension)
            ),
            Self::NoComponents => write!(f, "a vector needs at least two components"),
            Self::Argument {
                function,
                dimension,
            } => write!(f, "`{function}` takes a number, not {}", Kind(dimension)),
        }
    }
}

impl std::error::Error for DimensionError {}

/// A dimension in words.
struct Kind(usize);

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            1 => f.write_str("a number"),
            dimension => write!(f, "a vector of dimension {dimension}"),
        }
    }
}

fn componentwise(
    a: &Value,
    b: &Value,
    pairing: Pairing,
    mut operation: impl FnMut(NodeId, NodeId) -> NodeId,
) -> Result<Value, DimensionError> {
    let mut zip = |x: &[NodeId], y: &[NodeId]| {
        let pairs = x.iter().zip(y);
        pairs.map(|(&x, &y)| operation(x, y)).collect::<Vec<_>>()
    };
    match (a, b) {
        (Value::Number(x), Value::Number(y)) => Ok(Value::Number(operation(*x, *y))),
        (Value::Vector(x), Value::Vector(y)) if x.len() == y.len() => Ok(Value::Vector(zip(x, y))),
        _ => Err(DimensionError::Unequal {
            pairing,
            left: a.dimension(),
            right: b.dimension(),
        }),
    }
}

/// The sum of products, from left to right.
fn dot(graph: &mut Graph, a: &[NodeId], b: &[NodeId]) -> NodeId {
    let mut sum = None;
    for (&a, &b) in a.iter().zip(b) {
        let product = graph.mul(a, b);
        sum = Some(match sum {
            None => product,
            Some(sum) => graph.add(sum, product),
        });
    }
    sum.unwrap_or_else(|| graph.constant(0.0))
}
