//! Values of the language: a number, or a tuple of numbers; and the meaning of every operator on them.

use std::fmt;

use crate::graph::{Graph, NodeId};
use crate::ops::{Binary, Unary};

/// A value.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub enum Value {
    /// A number.
    Number(NodeId),
    /// A vector of dimension two or more.
    Vector(Vec<NodeId>),
}

impl Value {
    /// Returns 1 for a number, else the number of components.
    pub fn dimension(&self) -> usize {
        self.components().len()
    }

    /// Returns the components; the only component of a number is itself.
    pub fn components(&self) -> &[NodeId] {
        match self {
            Self::Number(node) => std::slice::from_ref(node),
            Self::Vector(nodes) => nodes,
        }
    }
}

/// A mismatch of dimensions. Its text is a sentence in the user's terms that names the dimensions; 1 stands for a
/// number.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum DimensionError {
    /// `a + b`.
    Sum {
        /// The dimension on the left.
        left: usize,
        /// The dimension on the right.
        right: usize,
    },
    /// `a - b`.
    Difference {
        /// The dimension on the left.
        left: usize,
        /// The dimension on the right.
        right: usize,
    },
    /// `a b` for vectors of different dimensions.
    Dot {
        /// The dimension on the left.
        left: usize,
        /// The dimension on the right.
        right: usize,
    },
    /// `a * b` for vectors that are not both of dimension 3.
    Cross {
        /// The dimension on the left.
        left: usize,
        /// The dimension on the right.
        right: usize,
    },
    /// `a / b` for a vector b.
    Quotient {
        /// The dimension on the left.
        left: usize,
        /// The dimension on the right.
        right: usize,
    },
    /// `a ^ b` with a vector.
    Power {
        /// The dimension of the base.
        base: usize,
        /// The dimension of the exponent.
        exponent: usize,
    },
    /// `/a` for a vector a.
    Reciprocal {
        /// The vector's dimension.
        dimension: usize,
    },
    /// `a_n` for a number.
    ComponentOfNumber {
        /// The index of the component, from 1.
        index: u32,
    },
    /// `a_n` past the last component.
    Component {
        /// The index of the component, from 1.
        index: u32,
        /// The vector's dimension.
        dimension: usize,
    },
    /// A vector inside a tuple.
    Nested {
        /// The index of the tuple's component, from 1.
        position: usize,
        /// The vector's dimension.
        dimension: usize,
    },
    /// A builtin function of vectors, applied to a number.
    Components {
        /// The function's name.
        name: &'static str,
    },
    /// A builtin function applied to a vector.
    Builtin {
        /// The function's name.
        name: &'static str,

        /// The vector's dimension.
        dimension: usize,
    },
}

struct Kind(usize);

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            1 => f.write_str("a number"),
            n => write!(f, "a vector of dimension {n}"),
        }
    }
}

impl fmt::Display for DimensionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Sum { left, right } => write!(f, "cannot add {} and {}", Kind(left), Kind(right)),
            Self::Difference { left, right } => {
                write!(f, "cannot subtract {} from {}", Kind(right), Kind(left))
            }
            Self::Dot { left, right } => write!(
                f,
                "a dot product needs two vectors of the same dimension, not {} and {}",
                Kind(left),
                Kind(right)
            ),
            Self::Cross { left, right } => write!(
                f,
                "a cross product needs two vectors of dimension 3, not {} and {}",
                Kind(left),
                Kind(right)
            ),
            Self::Quotient { left, right } => {
                write!(f, "cannot divide {} by {}", Kind(left), Kind(right))
            }
            Self::Power { base, exponent } => {
                write!(
                    f,
                    "cannot raise {} to the power of {}",
                    Kind(base),
                    Kind(exponent)
                )
            }
            Self::Reciprocal { dimension } => {
                write!(f, "cannot take the reciprocal of {}", Kind(dimension))
            }
            Self::ComponentOfNumber { index } => write!(f, "a number has no component {index}"),
            Self::Component { index, dimension } => {
                write!(f, "{} has no component {index}", Kind(dimension))
            }
            Self::Nested {
                position,
                dimension,
            } => write!(
                f,
                "component {position} of this tuple is {}, but components are numbers",
                Kind(dimension)
            ),
            Self::Components { name } => write!(
                f,
                "`{name}` compares the components of a vector, but this is a number"
            ),
            Self::Builtin { name, dimension } => {
                write!(f, "`{name}` takes a number, not {}", Kind(dimension))
            }
        }
    }
}

impl std::error::Error for DimensionError {}

impl DimensionError {
    /// Returns a suggested correction, if there is one.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Cross { left, right } if left == right => {
                Some("write the vectors side by side, without `*`, for their dot product")
            }
            Self::Dot { .. } => Some("take single components of a vector `a` with `a_1`, `a_2`, …"),
            Self::Power { base, exponent: 1 } if *base > 1 => {
                Some("`*a` is the square of the length of a vector `a`")
            }
            Self::Nested { .. } => Some("write its components one by one, as in `(a_1, a_2, b)`"),
            Self::Builtin { name: "abs", .. } => {
                Some("write `sqrt*a` for the length of a vector `a`")
            }
            _ => None,
        }
    }
}

type Outcome = Result<Value, DimensionError>;

fn each(value: &Value, mut f: impl FnMut(NodeId) -> NodeId) -> Value {
    match value {
        Value::Number(node) => Value::Number(f(*node)),
        Value::Vector(nodes) => Value::Vector(nodes.iter().map(|&node| f(node)).collect()),
    }
}

fn pairwise(graph: &mut Graph, op: Binary, a: &Value, b: &Value) -> Option<Value> {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => Some(Value::Number(graph.binary(op, *a, *b))),
        (Value::Vector(a), Value::Vector(b)) if a.len() == b.len() => Some(Value::Vector(
            a.iter()
                .zip(b)
                .map(|(&a, &b)| graph.binary(op, a, b))
                .collect(),
        )),
        _ => None,
    }
}

/// `a + b`.
///
/// # Errors
/// [`DimensionError::Sum`] unless the dimensions are equal.
pub fn add(graph: &mut Graph, a: &Value, b: &Value) -> Outcome {
    pairwise(graph, Binary::Add, a, b).ok_or(DimensionError::Sum {
        left: a.dimension(),
        right: b.dimension(),
    })
}

/// `a - b`.
///
/// # Errors
/// [`DimensionError::Difference`] unless the dimensions are equal.
pub fn subtract(graph: &mut Graph, a: &Value, b: &Value) -> Outcome {
    pairwise(graph, Binary::Sub, a, b).ok_or(DimensionError::Difference {
        left: a.dimension(),
        right: b.dimension(),
    })
}

/// `-a`.
pub fn negate(graph: &mut Graph, a: &Value) -> Value {
    each(a, |node| graph.unary(Unary::Neg, node))
}

/// `a b`: product, scaling, or dot product.
///
/// # Errors
/// [`DimensionError::Dot`] for vectors of different dimensions.
pub fn juxtapose(graph: &mut Graph, a: &Value, b: &Value) -> Outcome {
    match (a, b) {
        (Value::Vector(x), Value::Vector(y)) => {
            if x.len() != y.len() {
                return Err(DimensionError::Dot {
                    left: x.len(),
                    right: y.len(),
                });
            }
            let mut sum = None;
            for (&x, &y) in x.iter().zip(y) {
                let product = graph.mul(x, y);
                sum = Some(match sum {
                    None => product,
                    Some(sum) => graph.add(sum, product),
                });
            }
            let zero = graph.constant(0.0);
            Ok(Value::Number(sum.unwrap_or(zero)))
        }
        _ => Ok(scale(graph, a, b)),
    }
}

/// `a * b`: product, scaling, or cross product.
///
/// # Errors
/// [`DimensionError::Cross`] for vectors that are not both of dimension 3.
pub fn multiply(graph: &mut Graph, a: &Value, b: &Value) -> Outcome {
    match (a, b) {
        (Value::Vector(x), Value::Vector(y)) => {
            let (&[x1, x2, x3], &[y1, y2, y3]) = (&x[..], &y[..]) else {
                return Err(DimensionError::Cross {
                    left: x.len(),
                    right: y.len(),
                });
            };
            let mut minor = |a, b, c, d| {
                let left = graph.mul(a, d);
                let right = graph.mul(b, c);
                graph.sub(left, right)
            };
            Ok(Value::Vector(vec![
                minor(x2, x3, y2, y3),
                minor(x3, x1, y3, y1),
                minor(x1, x2, y1, y2),
            ]))
        }
        _ => Ok(scale(graph, a, b)),
    }
}

/// A product in which at most one factor is a vector.
fn scale(graph: &mut Graph, a: &Value, b: &Value) -> Value {
    match (a, b) {
        (Value::Number(a), b) => each(b, |node| graph.mul(*a, node)),
        (a, Value::Number(b)) => each(a, |node| graph.mul(node, *b)),
        (a, Value::Vector(_)) => a.clone(),
    }
}

/// `a / b`.
///
/// # Errors
/// [`DimensionError::Quotient`] where b is a vector.
pub fn divide(graph: &mut Graph, a: &Value, b: &Value) -> Outcome {
    match b {
        Value::Number(b) => Ok(each(a, |node| graph.div(node, *b))),
        Value::Vector(_) => Err(DimensionError::Quotient {
            left: a.dimension(),
            right: b.dimension(),
        }),
    }
}

/// `a ^ b`.
///
/// # Errors
/// [`DimensionError::Power`] where either is a vector.
pub fn power(graph: &mut Graph, a: &Value, b: &Value) -> Outcome {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            Ok(Value::Number(graph.binary(Binary::Pow, *a, *b)))
        }
        _ => Err(DimensionError::Power {
            base: a.dimension(),
            exponent: b.dimension(),
        }),
    }
}

/// `*a`: a·a, for a vector too.
pub fn square(graph: &mut Graph, a: &Value) -> Value {
    let square = juxtapose(graph, a, a);
    // A value has the same dimension as itself: the product cannot fail.
    square.unwrap_or_else(|_| a.clone())
}

/// `/a`: 1/a.
///
/// # Errors
/// [`DimensionError::Reciprocal`] for a vector.
pub fn reciprocal(graph: &mut Graph, a: &Value) -> Outcome {
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

/// `a_n`, counted from 1.
///
/// # Errors
/// [`DimensionError::ComponentOfNumber`] for a number, [`DimensionError::Component`] past the last component.
pub fn component(a: &Value, index: u32) -> Outcome {
    match a {
        Value::Number(_) => Err(DimensionError::ComponentOfNumber { index }),
        Value::Vector(nodes) => (index as usize)
            .checked_sub(1)
            .and_then(|place| nodes.get(place))
            .map(|&node| Value::Number(node))
            .ok_or(DimensionError::Component {
                index,
                dimension: nodes.len(),
            }),
    }
}

/// `(a, b, …)`; of a single value it is that value.
///
/// # Errors
/// [`DimensionError::Nested`] where a component is a vector.
pub fn tuple(values: &[Value]) -> Outcome {
    if let [value] = values {
        return Ok(value.clone());
    }
    let mut nodes = Vec::with_capacity(values.len());
    for (index, value) in values.iter().enumerate() {
        match value {
            Value::Number(node) => nodes.push(*node),
            Value::Vector(inner) => {
                return Err(DimensionError::Nested {
                    position: index + 1,
                    dimension: inner.len(),
                });
            }
        }
    }
    Ok(Value::Vector(nodes))
}

/// Returns the smallest or largest component of a vector, by [`Binary::Min`] or [`Binary::Max`] from the first to the
/// last.
///
/// # Errors
/// [`DimensionError::Components`] for a number.
pub fn extreme(graph: &mut Graph, op: Binary, a: &Value) -> Outcome {
    let components = a.components().iter().copied();
    let joined = components.reduce(|first, next| graph.binary(op, first, next));
    match (a, joined) {
        (Value::Vector(_), Some(node)) => Ok(Value::Number(node)),
        _ => Err(DimensionError::Components { name: op.name() }),
    }
}

/// Applies a builtin function to a number.
///
/// # Errors
/// [`DimensionError::Builtin`] for a vector.
pub fn apply(graph: &mut Graph, op: Unary, a: &Value) -> Outcome {
    match a {
        Value::Number(node) => Ok(Value::Number(graph.unary(op, *node))),
        Value::Vector(nodes) => {
            let row = op.row();
            Err(DimensionError::Builtin {
                name: row.builtin.unwrap_or(row.name),
                dimension: nodes.len(),
            })
        }
    }
}
