//! The derivative rules of powers.
//!
//! In: base, exponent and their derivatives. Out: the terms of the power's derivative, written so that a zero factor
//! annihilates undefined ones.

use crate::ops::{ExpressionBuilder, Unary};

/// n x^(n−1) x'.
pub(crate) fn integer_power_derivative<B: ExpressionBuilder>(
    graph: &mut B,
    x: B::Number,
    n: i32,
    dx: B::Number,
) -> B::Number {
    let lower = match n.checked_sub(1) {
        Some(lower) => graph.integer_power(x, lower),
        None => {
            let lower = graph.constant(f64::from(n) - 1.0);
            graph.power(x, lower)
        }
    };
    let exponent = graph.constant(f64::from(n));
    let slope = graph.mul(exponent, lower);
    graph.mul(slope, dx)
}

/// b a^(b−1) a'.
pub(super) fn power_by_base<B: ExpressionBuilder>(
    graph: &mut B,
    a: B::Number,
    b: B::Number,
    da: B::Number,
) -> B::Number {
    if graph.value(da) == Some(0.0) {
        return da;
    }
    let one = graph.constant(1.0);
    let less = graph.sub(b, one);
    let lower = graph.power(a, less);
    let slope = graph.zmul(b, lower);
    graph.mul(slope, da)
}

/// b' y log a for y = a^b.
pub(super) fn power_by_exponent<B: ExpressionBuilder>(
    graph: &mut B,
    a: B::Number,
    y: B::Number,
    db: B::Number,
) -> B::Number {
    if graph.value(db) == Some(0.0) {
        return db;
    }
    let logarithm = graph.unary(Unary::Log, a);
    let growth = graph.zmul(y, logarithm);
    graph.zmul(db, growth)
}
