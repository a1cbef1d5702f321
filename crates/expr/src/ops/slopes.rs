//! Arithmetics in which the rules of derivatives are written: numbers, code for them, and expressions.

use crate::arithmetic::at_most;
use crate::ops::{Binary, Unary};

/// The arithmetic in which a rule is written.
pub trait Arithmetic {
    /// A number, or its representation.
    type Number: Copy;
    /// A constant.
    fn constant(&mut self, value: f64) -> Self::Number;
    /// −a.
    fn neg(&mut self, a: Self::Number) -> Self::Number;
    /// a + b.
    fn add(&mut self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// a − b.
    fn sub(&mut self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// a·b.
    fn mul(&mut self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// a/b.
    fn div(&mut self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// 1 where a is at most b, else 0; NaN where they do not compare.
    fn at_most(&mut self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// Any operation on one number.
    fn unary(&mut self, op: Unary, a: Self::Number) -> Self::Number;
}

/// An arithmetic whose numbers are expressions: the interface that symbolic differentiation needs. The graph implements
/// it, so that the table does not depend on the graph.
pub trait ExpressionBuilder: Arithmetic {
    /// Returns the value of a constant; `None` for any other expression.
    fn value(&self, a: Self::Number) -> Option<f64>;
    /// a^n, see [`crate::ops::integer_power`].
    fn integer_power(&mut self, a: Self::Number, n: i32) -> Self::Number;
    /// a^b, see [`crate::ops::power`].
    fn power(&mut self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// The product that a zero first factor annihilates, see [`crate::ops::zmul`].
    fn zmul(&mut self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// Any operation on two numbers.
    fn binary(&mut self, op: Binary, a: Self::Number, b: Self::Number) -> Self::Number;
}

/// The arithmetic of numbers themselves.
#[derive(Clone, Copy, Debug, Default)]
pub struct Numbers;

impl Arithmetic for Numbers {
    type Number = f64;

    fn constant(&mut self, value: f64) -> f64 {
        value
    }

    fn neg(&mut self, a: f64) -> f64 {
        -a
    }

    fn add(&mut self, a: f64, b: f64) -> f64 {
        a + b
    }

    fn sub(&mut self, a: f64, b: f64) -> f64 {
        a - b
    }

    fn mul(&mut self, a: f64, b: f64) -> f64 {
        a * b
    }

    fn div(&mut self, a: f64, b: f64) -> f64 {
        a / b
    }

    fn at_most(&mut self, a: f64, b: f64) -> f64 {
        at_most(a, b)
    }

    fn unary(&mut self, op: Unary, a: f64) -> f64 {
        op.eval(a)
    }
}

/// p and −2·x·p²: the slopes of a function whose first is p = 1/(1 + x²).
pub(super) fn reciprocal_of_one_plus_square<A: Arithmetic>(
    n: &mut A,
    x: A::Number,
) -> [A::Number; 2] {
    let one = n.constant(1.0);
    let minus_two = n.constant(-2.0);
    let square = n.mul(x, x);
    let sum = n.add(one, square);
    let first = n.div(one, sum);
    let twice = n.mul(minus_two, x);
    let first_square = n.mul(first, first);
    [first, n.mul(twice, first_square)]
}

/// p and x·p³ for p = 1/√((1 − x)(1 + x)).
pub(super) fn reciprocal_of_complement<A: Arithmetic>(n: &mut A, x: A::Number) -> [A::Number; 2] {
    let one = n.constant(1.0);
    let square = one_minus_square(n, x);
    let root = n.unary(Unary::Sqrt, square);
    let first = n.div(one, root);
    let first_square = n.mul(first, first);
    let steep = n.mul(x, first);
    [first, n.mul(steep, first_square)]
}

/// (1 − x)(1 + x): 1 − x² without its cancellation near ±1.
pub(super) fn one_minus_square<A: Arithmetic>(n: &mut A, x: A::Number) -> A::Number {
    let one = n.constant(1.0);
    let less = n.sub(one, x);
    let more = n.add(one, x);
    n.mul(less, more)
}
