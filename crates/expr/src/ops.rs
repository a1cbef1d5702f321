//! The one table of scalar operations.
//!
//! In: nothing. Out: for each operation its name, documentation, exact f64 meaning (for one number and for blocks of
//! lanes, from one expression), derivative rule, first and second derivative at a number, WGSL text, and the name by
//! which programs call it. The rows are in `ops/unary.rs` and `ops/binary.rs`. To add an operation, add a row, and
//! cases to [`crate::conformance`].
//!
//! f64 functions are those of `std`, which round as the system's mathematical library does.

pub use crate::arithmetic::{
    LARGEST_INTEGER_POWER, at_most, greatest, integer_power, least, power, sign, zmul,
};
pub(crate) use crate::arithmetic::{integer_power_lanes, small_integer};

mod binary;
mod lanes;
mod power;
mod slopes;
mod unary;
pub use binary::Binary;
pub use lanes::Lanes;
pub(crate) use power::integer_power_derivative;
pub use slopes::{Arithmetic, ExpressionBuilder, Numbers};
pub use unary::Unary;

/// The WGSL of an operation.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Wgsl {
    /// Before its operand: `-a`.
    Prefix(&'static str),
    /// Between its operands: `a + b`.
    Infix(&'static str),
    /// A function of WGSL itself: `sin(a)`.
    Builtin(&'static str),
    /// A function that the shader library provides, with the meaning of the function of this name here.
    Library(&'static str),
}

/// Any operation of the table.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Operation {
    /// On one number.
    Unary(Unary),
    /// On two numbers.
    Binary(Binary),
    /// [`integer_power`] with this exponent.
    Power(i32),
}

/// The WGSL of an integer power: a function of the shader library that takes the base and an `i32`.
pub(crate) const INTEGER_POWER_WGSL: Wgsl = Wgsl::Library("integer_power");

/// The named constants of programs: name, value, and description.
pub const CONSTANTS: [(&str, f64, &str); 2] = [
    (
        "pi",
        std::f64::consts::PI,
        "Half of a full turn in radians, 3.14159…",
    ),
    (
        "e",
        std::f64::consts::E,
        "The base of natural logarithms, 2.71828…",
    ),
];

/// Returns the operation that programs call as the function `name`. (The language's `id` is not one: it returns its
/// operand, a number or a vector.)
pub fn builtin(name: &str) -> Option<Unary> {
    Unary::ALL
        .iter()
        .copied()
        .find(|op| op.row().builtin == Some(name))
}

/// A row of the table, as data.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Row {
    /// Its name in listings.
    pub name: &'static str,
    /// The name of the function in programs, if it has one.
    pub builtin: Option<&'static str>,
    /// Its WGSL.
    pub wgsl: Wgsl,
    /// The rule of its derivative, for readers.
    pub derivative: &'static str,
    /// Its description, for readers.
    pub doc: &'static str,
}

impl Operation {
    /// Returns every operation of the table; for the integer power, exponents of every kind.
    pub fn all() -> impl Iterator<Item = Self> {
        let powers = [3, 4, 7, -2, -3].into_iter().map(Self::Power);
        let unary = Unary::ALL.iter().copied().map(Self::Unary);
        unary
            .chain(Binary::ALL.iter().copied().map(Self::Binary))
            .chain(powers)
    }

    /// Returns the number of operands.
    pub fn arity(self) -> usize {
        match self {
            Self::Unary(_) | Self::Power(_) => 1,
            Self::Binary(_) => 2,
        }
    }

    /// Its name in listings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unary(op) => op.name(),
            Self::Binary(op) => op.name(),
            Self::Power(_) => "power",
        }
    }

    /// Its WGSL.
    pub fn wgsl(self) -> Wgsl {
        match self {
            Self::Unary(op) => op.wgsl(),
            Self::Binary(op) => op.wgsl(),
            Self::Power(_) => INTEGER_POWER_WGSL,
        }
    }

    /// Returns its value; `None` if the number of operands is not its arity.
    pub fn eval(self, operands: &[f64]) -> Option<f64> {
        match (self, operands) {
            (Self::Unary(op), &[x]) => Some(op.eval(x)),
            (Self::Power(n), &[x]) => Some(integer_power(x, n)),
            (Self::Binary(op), &[a, b]) => Some(op.eval(a, b)),
            _ => None,
        }
    }

    /// Builds the operation on nodes; `b` is used only by operations on two numbers.
    pub fn node<B: ExpressionBuilder>(
        self,
        graph: &mut B,
        a: B::Number,
        b: B::Number,
    ) -> B::Number {
        match self {
            Self::Unary(op) => graph.unary(op, a),
            Self::Power(n) => graph.integer_power(a, n),
            Self::Binary(op) => graph.binary(op, a, b),
        }
    }

    /// Builds the operation on nodes; `None` if the number of operands is not its arity.
    pub fn build<B: ExpressionBuilder>(
        self,
        graph: &mut B,
        operands: &[B::Number],
    ) -> Option<B::Number> {
        match (self, operands) {
            (Self::Unary(op), &[x]) => Some(graph.unary(op, x)),
            (Self::Power(n), &[x]) => Some(graph.integer_power(x, n)),
            (Self::Binary(op), &[a, b]) => Some(graph.binary(op, a, b)),
            _ => None,
        }
    }
}
