//! The cases that every evaluator of expressions must satisfy.
//!
//! Out: operations with operands and values. The f64 tape, its blocks, jets and generated WGSL are each run over
//! [`cases`], whose values come from the table's definition; this crate's tests compare that definition with
//! [`anchors`], whose values were computed independently.

pub use crate::ops::Operation;
use crate::ops::{Binary, Unary};

/// One case: an operation, its operands and its value.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The operation.
    pub operation: Operation,
    /// The operands; the second is used only by operations on two numbers. Representable in f32, so that a shader
    /// starts from the same numbers.
    pub operands: [f64; 2],
    /// The value in f64, always finite.
    pub expected: f64,
}

/// Operands, each representable in f32.
const NUMBERS: [f64; 11] = [
    -2.5, -2.0, -1.0, -0.75, -0.125, 0.0, 0.125, 0.5, 1.0, 1.5, 3.0,
];

/// Exponents of integer powers: each length of binary expansion, both signs, and those that become other nodes.
const EXPONENTS: [i32; 11] = [-5, -3, -2, -1, 0, 1, 2, 3, 4, 7, 13];

/// Powers beyond those that [`crate::ops::power`] multiplies: integers accept negative bases there too, and odd ones
/// preserve the sign. In f32 all numbers beyond 2^24 are even; bases are exact in f32.
const LARGE_POWERS: [(f64, f64); 12] = [
    (-1.0, 1025.0),
    (-1.0, 1026.0),
    (-1.0, -4097.0),
    (-1.0, 16_777_215.0),
    (-1.0, 16_777_216.0),
    (-1.0, 4e9),
    (1.0, -4e9),
    (-0.9921875, 1501.0),
    (-1.0078125, -2000.0),
    (1.0009765625, 5001.0),
    (0.0, 1025.0),
    (0.0, 4e9),
];

/// Returns every operation at every operand, or pair of operands, where it is finite.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut push = |operation: Operation, a: f64, b: f64| {
        let operands = [a, b];
        let value = operation.eval(&operands[..operation.arity()]);
        if let Some(expected) = value.filter(|value| value.is_finite()) {
            cases.push(Case {
                operation,
                operands,
                expected,
            });
        }
    };
    for a in NUMBERS {
        for op in Unary::ALL {
            push(Operation::Unary(op), a, 0.0);
        }
        for n in EXPONENTS {
            push(Operation::Power(n), a, 0.0);
        }
        for b in NUMBERS {
            for op in Binary::ALL {
                push(Operation::Binary(op), a, b);
            }
        }
    }
    for (a, b) in LARGE_POWERS {
        push(Operation::Binary(Binary::Pow), a, b);
    }
    cases
}

/// Returns values of every operation that do not come from the table: exact ones, and true values computed with 40
/// digits and rounded once. An evaluator in f64 agrees to a relative error of 4·10⁻¹⁶.
pub fn anchors() -> Vec<Case> {
    ANCHORS
        .iter()
        .map(|&(operation, operands, expected)| Case {
            operation,
            operands,
            expected,
        })
        .collect()
}

// Decimals of true values, some of which are constants of `std`.
#[allow(clippy::approx_constant)]
const ANCHORS: &[(Operation, [f64; 2], f64)] = &[
    (Operation::Unary(Unary::Neg), [1.5, 0.0], -1.5),
    (Operation::Unary(Unary::Neg), [-0.125, 0.0], 0.125),
    (Operation::Unary(Unary::Sin), [0.5, 0.0], 0.479425538604203),
    (
        Operation::Unary(Unary::Sin),
        [-2.5, 0.0],
        -0.5984721441039565,
    ),
    (Operation::Unary(Unary::Sin), [1.5, 0.0], 0.9974949866040544),
    (Operation::Unary(Unary::Cos), [0.5, 0.0], 0.8775825618903728),
    (
        Operation::Unary(Unary::Cos),
        [-2.5, 0.0],
        -0.8011436155469337,
    ),
    (Operation::Unary(Unary::Cos), [1.5, 0.0], 0.0707372016677029),
    (Operation::Unary(Unary::Tan), [0.5, 0.0], 0.5463024898437905),
    (
        Operation::Unary(Unary::Tan),
        [-0.75, 0.0],
        -0.9315964599440725,
    ),
    (Operation::Unary(Unary::Exp), [1.0, 0.0], 2.718281828459045),
    (
        Operation::Unary(Unary::Exp),
        [-2.5, 0.0],
        0.0820849986238988,
    ),
    (
        Operation::Unary(Unary::Log),
        [0.125, 0.0],
        -2.0794415416798357,
    ),
    (Operation::Unary(Unary::Log), [3.0, 0.0], 1.0986122886681098),
    (
        Operation::Unary(Unary::Sqrt),
        [2.0, 0.0],
        1.4142135623730951,
    ),
    (Operation::Unary(Unary::Sqrt), [0.0, 0.0], 0.0),
    (Operation::Unary(Unary::Sqrt), [6.25, 0.0], 2.5),
    (
        Operation::Unary(Unary::Asin),
        [0.5, 0.0],
        0.5235987755982989,
    ),
    (
        Operation::Unary(Unary::Asin),
        [-0.75, 0.0],
        -0.848062078981481,
    ),
    (
        Operation::Unary(Unary::Acos),
        [0.5, 0.0],
        1.0471975511965979,
    ),
    (
        Operation::Unary(Unary::Acos),
        [-0.75, 0.0],
        2.4188584057763776,
    ),
    (Operation::Unary(Unary::Atan), [1.5, 0.0], 0.982793723247329),
    (
        Operation::Unary(Unary::Atan),
        [-2.0, 0.0],
        -1.1071487177940904,
    ),
    (
        Operation::Unary(Unary::Sinh),
        [1.5, 0.0],
        2.1292794550948173,
    ),
    (
        Operation::Unary(Unary::Sinh),
        [-0.125, 0.0],
        -0.12532577524111546,
    ),
    (Operation::Unary(Unary::Cosh), [1.5, 0.0], 2.352409615243247),
    (
        Operation::Unary(Unary::Cosh),
        [-0.125, 0.0],
        1.0078226778257109,
    ),
    (
        Operation::Unary(Unary::Tanh),
        [1.5, 0.0],
        0.9051482536448664,
    ),
    (
        Operation::Unary(Unary::Tanh),
        [-0.125, 0.0],
        -0.12435300177159621,
    ),
    (
        Operation::Unary(Unary::Sech),
        [1.5, 0.0],
        0.4250960349422805,
    ),
    (
        Operation::Unary(Unary::Sech),
        [-0.125, 0.0],
        0.9922380414751257,
    ),
    (Operation::Unary(Unary::Abs), [-2.5, 0.0], 2.5),
    (Operation::Unary(Unary::Abs), [0.5, 0.0], 0.5),
    (Operation::Unary(Unary::Abs), [0.0, 0.0], 0.0),
    (Operation::Unary(Unary::Sign), [-2.5, 0.0], -1.0),
    (Operation::Unary(Unary::Sign), [0.0, 0.0], 0.0),
    (Operation::Unary(Unary::Sign), [0.5, 0.0], 1.0),
    (Operation::Binary(Binary::Add), [1.5, -2.5], -1.0),
    (Operation::Binary(Binary::Sub), [1.5, -2.5], 4.0),
    (Operation::Binary(Binary::Mul), [1.5, -2.5], -3.75),
    (
        Operation::Binary(Binary::Div),
        [1.0, 3.0],
        0.3333333333333333,
    ),
    (Operation::Binary(Binary::Div), [-2.5, 0.125], -20.0),
    (Operation::Binary(Binary::Pow), [0.0, 0.0], 1.0),
    (Operation::Binary(Binary::Pow), [-2.0, 3.0], -8.0),
    (Operation::Binary(Binary::Pow), [-2.5, -2.0], 0.16),
    (
        Operation::Binary(Binary::Pow),
        [2.0, 0.5],
        1.4142135623730951,
    ),
    (
        Operation::Binary(Binary::Pow),
        [3.0, -1.5],
        0.19245008972987526,
    ),
    (Operation::Binary(Binary::Pow), [0.0, 1.5], 0.0),
    (Operation::Binary(Binary::Pow), [-1.0, 1025.0], -1.0),
    (Operation::Binary(Binary::Pow), [-1.0, 4e9], 1.0),
    (Operation::Binary(Binary::Zmul), [1.5, -2.5], -3.75),
    (Operation::Binary(Binary::Zmul), [0.0, 3.0], 0.0),
    // Zero annihilates infinities and NaN.
    (Operation::Binary(Binary::Zmul), [0.0, f64::INFINITY], 0.0),
    (Operation::Binary(Binary::Zmul), [0.0, f64::NAN], 0.0),
    (Operation::Binary(Binary::Min), [1.5, -2.5], -2.5),
    (Operation::Binary(Binary::Min), [-2.5, 0.5], -2.5),
    (Operation::Binary(Binary::Max), [1.5, -2.5], 1.5),
    (Operation::Binary(Binary::Max), [0.125, 0.5], 0.5),
    (Operation::Binary(Binary::AtMost), [1.5, -2.5], 0.0),
    (Operation::Binary(Binary::AtMost), [-2.5, 1.5], 1.0),
    (Operation::Binary(Binary::AtMost), [0.5, 0.5], 1.0),
    (Operation::Power(3), [-2.5, 0.0], -15.625),
    (Operation::Power(7), [1.5, 0.0], 17.0859375),
    (Operation::Power(4), [-0.75, 0.0], 0.31640625),
    (Operation::Power(-3), [3.0, 0.0], 0.037037037037037035),
    (Operation::Power(-2), [-2.0, 0.0], 0.25),
    (Operation::Power(0), [0.0, 0.0], 1.0),
    (Operation::Power(13), [0.5, 0.0], 0.0001220703125),
];
