//! Derivatives against dual numbers, and at the places where a rule is easily wrong.

use expr::ops::{Binary, Unary};
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId};
use num_dual::{Dual2_64, DualNum};

const X: Input = Input::Variable(0);

fn eval(graph: &Graph, root: NodeId, at: impl Fn(Input) -> f64) -> f64 {
    let tape = Tape::new(graph, &[root]);
    let inputs: Vec<f64> = tape.inputs().iter().map(|&input| at(input)).collect();
    let mut out = [f64::NAN];
    tape.eval(&mut Registers::default(), &inputs, &mut out);
    out[0]
}

fn derivative(graph: &mut Graph, root: NodeId) -> NodeId {
    graph.derivatives(&[root], X).unwrap()[0]
}

#[track_caller]
fn assert_close(actual: f64, expected: f64) {
    let error = (actual - expected).abs() / expected.abs().max(1.0);
    assert!(error <= 1e-12, "{actual:?}, not {expected:?}");
}

/// The operation in dual numbers that nobody here wrote.
fn dual(op: Unary, x: Dual2_64) -> Dual2_64 {
    match op {
        Unary::Neg => -x,
        Unary::Sin => x.sin(),
        Unary::Cos => x.cos(),
        Unary::Tan => x.tan(),
        Unary::Exp => x.exp(),
        Unary::Log => x.ln(),
        Unary::Sqrt => x.sqrt(),
        Unary::Asin => x.asin(),
        Unary::Acos => x.acos(),
        Unary::Atan => x.atan(),
        Unary::Sinh => x.sinh(),
        Unary::Cosh => x.cosh(),
        Unary::Tanh => x.tanh(),
        Unary::Sech => x.cosh().recip(),
        // These have no curvature; by their definition, piece by piece.
        Unary::Abs => {
            if x.re < 0.0 {
                -x
            } else {
                x
            }
        }
        Unary::Sign => Dual2_64::from(x.re.signum()),
    }
}

#[test]
#[should_panic(expected = "not 1.0")]
fn closeness_can_fail() {
    assert_close(1.0 + 1e-11, 1.0);
}

#[test]
fn first_and_second_derivatives_of_every_unary_operation_are_those_of_dual_numbers() {
    for op in Unary::ALL {
        let mut graph = Graph::default();
        let x = graph.input(X);
        let factor = graph.constant(0.3);
        let scaled = graph.mul(factor, x);
        let inner = graph.mul(scaled, x); // 0.3 x², so that the chain rule counts
        for operand in [x, inner] {
            let y = graph.unary(op, operand);
            let first = derivative(&mut graph, y);
            let second = derivative(&mut graph, first);
            for at in [-0.9, -0.4, 0.2, 0.7] {
                let variable = Dual2_64::from(at).derivative();
                let argument = if operand == x {
                    variable
                } else {
                    variable * variable * 0.3
                };
                let expected = dual(op, argument);
                if expected.re.is_nan() {
                    continue;
                }
                assert_close(eval(&graph, y, |_| at), expected.re);
                assert_close(eval(&graph, first, |_| at), expected.v1);
                assert_close(eval(&graph, second, |_| at), expected.v2);
            }
        }
    }
}

#[test]
fn first_and_second_derivatives_of_every_binary_operation_are_those_of_dual_numbers() {
    for op in Binary::ALL {
        let mut graph = Graph::default();
        let x = graph.input(X);
        let a = graph.unary(Unary::Exp, x);
        let b = graph.unary(Unary::Sin, x);
        let k = graph.input(Input::Uniform(0));
        for (a, b) in [(a, b), (a, k), (k, b)] {
            let y = graph.binary(op, a, b);
            let first = derivative(&mut graph, y);
            let second = derivative(&mut graph, first);
            for at in [-0.8, 0.3, 1.1] {
                let variable = Dual2_64::from(at).derivative();
                let side = |node| match node {
                    node if node == k => Dual2_64::from(1.7),
                    node if node == b => variable.sin(),
                    _ => variable.exp(),
                };
                let (da, db) = (side(a), side(b));
                let expected = match op {
                    Binary::Add => da + db,
                    Binary::Sub => da - db,
                    Binary::Mul | Binary::Zmul => da * db,
                    Binary::Div => da / db,
                    Binary::Pow => da.powd(db),
                    Binary::Min if da.re <= db.re => da,
                    Binary::Max if da.re >= db.re => da,
                    Binary::Min | Binary::Max => db,
                    Binary::AtMost => Dual2_64::from(f64::from(u8::from(da.re <= db.re))),
                };
                let values = |input| if input == X { at } else { 1.7 };
                assert_close(eval(&graph, y, values), expected.re);
                assert_close(eval(&graph, first, values), expected.v1);
                assert_close(eval(&graph, second, values), expected.v2);
            }
        }
    }
}

#[test]
fn derivatives_of_integer_powers_are_those_of_dual_numbers() {
    for n in [-3, -2, -1, 1, 2, 3, 4, 9] {
        let mut graph = Graph::default();
        let x = graph.input(X);
        let y = graph.integer_power(x, n);
        let first = derivative(&mut graph, y);
        let second = derivative(&mut graph, first);
        for at in [-1.5, -0.5, 0.75] {
            let expected = Dual2_64::from(at).derivative().powi(n);
            assert_close(eval(&graph, first, |_| at), expected.v1);
            assert_close(eval(&graph, second, |_| at), expected.v2);
        }
    }
}

#[test]
fn derivatives_of_powers_at_zero_are_numbers() {
    for (n, slope, bend) in [(0, 0.0, 0.0), (1, 1.0, 0.0), (2, 0.0, 2.0), (3, 0.0, 0.0)] {
        // The exponent as a literal, and as a param.
        for literal in [true, false] {
            let mut graph = Graph::default();
            let x = graph.input(X);
            let exponent = if literal {
                graph.constant(f64::from(n))
            } else {
                graph.input(Input::Uniform(0))
            };
            let y = graph.power(x, exponent);
            let first = derivative(&mut graph, y);
            let second = derivative(&mut graph, first);
            let at = |input| if input == X { 0.0 } else { f64::from(n) };
            assert_eq!(eval(&graph, first, at), slope, "x^{n}, literal: {literal}");
            assert_eq!(eval(&graph, second, at), bend, "x^{n}, literal: {literal}");
        }
    }
}

#[test]
fn an_eighth_derivative_is_exact() {
    let mut graph = Graph::default();
    let x = graph.input(X);
    let (tangent, growth) = (graph.unary(Unary::Tan, x), graph.unary(Unary::Exp, x));
    let mut y = graph.mul(tangent, growth);
    for _ in 0..8 {
        y = derivative(&mut graph, y);
    }
    // d⁸/dx⁸ (tan x · exp x) at 0.3, computed with 40 digits.
    assert_close(eval(&graph, y, |_| 0.3), 22_418.349_151_632_58);
}

#[test]
fn a_kink_of_abs_has_slope_zero() {
    let mut graph = Graph::default();
    let x = graph.input(X);
    let y = graph.unary(Unary::Abs, x);
    let first = derivative(&mut graph, y);
    assert_eq!(eval(&graph, first, |_| 0.0), 0.0);
    assert_eq!(eval(&graph, first, |_| -3.0), -1.0);
}

#[test]
fn min_and_max_have_the_derivative_of_the_first_to_attain_them() {
    let mut graph = Graph::default();
    let x = graph.input(X);
    let double = graph.add(x, x);
    for op in [Binary::Min, Binary::Max] {
        for (a, b, slope) in [(x, double, 1.0), (double, x, 2.0)] {
            let y = graph.binary(op, a, b);
            let first = derivative(&mut graph, y);
            assert_eq!(eval(&graph, first, |_| 0.0), slope);
        }
    }
    // What is not attained may be undefined: max(x, log x) at −1 is undefined, min(x, 1/(x−1)²) at 1 is not.
    let one = graph.constant(1.0);
    let less = graph.sub(x, one);
    let pole = graph.integer_power(less, -2);
    let y = graph.binary(Binary::Min, x, pole);
    let first = derivative(&mut graph, y);
    assert_eq!(eval(&graph, y, |_| 1.0), 1.0);
    assert_eq!(eval(&graph, first, |_| 1.0), 1.0);
    let log = graph.unary(Unary::Log, x);
    for op in [Binary::Min, Binary::Max, Binary::AtMost] {
        let y = graph.binary(op, x, log);
        assert!(eval(&graph, y, |_| -1.0).is_nan());
        let y = graph.binary(op, log, x);
        assert!(eval(&graph, y, |_| -1.0).is_nan());
    }
}

#[test]
fn a_logarithm_has_a_derivative_only_where_it_is_defined() {
    let mut graph = Graph::default();
    let x = graph.input(X);
    let y = graph.unary(Unary::Log, x);
    let first = derivative(&mut graph, y);
    let second = derivative(&mut graph, first);
    for x in [1e-300, 0.3, 2.0, 1e300] {
        assert_eq!(eval(&graph, first, |_| x), 1.0 / x);
    }
    assert_close(eval(&graph, second, |_| 0.3), -1.0 / 0.09);
    for x in [-1e-300, -2.0] {
        assert!(eval(&graph, first, |_| x).is_nan(), "{x}");
        assert!(eval(&graph, second, |_| x).is_nan(), "{x}");
    }
    assert_eq!(eval(&graph, first, |_| 0.0), f64::INFINITY);
}

#[test]
fn the_derivative_of_tanh_keeps_its_digits() {
    let mut graph = Graph::default();
    let x = graph.input(X);
    let y = graph.unary(Unary::Tanh, x);
    let first = derivative(&mut graph, y);
    // 4/(e^x + e^−x)², computed with 50 digits.
    for (x, expected) in [
        (10.0, 8.244_614_455_767_397e-9),
        (18.0, 9.278_091_320_974_273e-16),
        (20.0, 1.699_341_702_116_632_6e-17),
    ] {
        let found = eval(&graph, first, |_| x);
        assert!((found / expected - 1.0).abs() < 1e-14, "{x}: {found:e}");
    }
    // All of them tend to 0.
    let mut higher = first;
    for order in 1..=4 {
        for x in [-1e300, -1000.0, 356.0, 720.0, f64::MAX] {
            let value = eval(&graph, higher, |_| x);
            assert!(value.abs() < 1e-300, "{order} at {x}: {value:e}");
        }
        higher = derivative(&mut graph, higher);
    }
}

#[test]
fn a_zero_annihilates_what_is_undefined_in_constants_too() {
    let numbers = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        2.5,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];
    let is_same = |x: f64, y: f64| x == y || x.is_nan() && y.is_nan();
    for a in numbers {
        for b in numbers {
            let product = expr::ops::zmul(a, b);
            let mut graph = Graph::default();
            let given = [graph.constant(a), graph.constant(b)];
            let read = [0, 1].map(|k| graph.input(Input::Variable(k)));
            for choice in 0..4 {
                let [left, right] = [0, 1].map(|k| {
                    if choice >> k & 1 == 0 {
                        given[k]
                    } else {
                        read[k]
                    }
                });
                let root = graph.zmul(left, right);
                let found = eval(&graph, root, |input| match input {
                    Input::Variable(0) => a,
                    _ => b,
                });
                // A constant zero is one in any product.
                let expected = if choice == 1 && b == 0.0 {
                    0.0
                } else {
                    product
                };
                assert!(is_same(found, expected), "{a} {b} {choice}: {found}");
            }
        }
    }
}

#[test]
fn what_does_not_depend_on_an_input_has_derivative_zero_at_no_cost() {
    let mut graph = Graph::default();
    let mut y = graph.input(Input::Uniform(3));
    graph.constant(0.0);
    for _ in 0..1000 {
        y = graph.unary(Unary::Log, y);
    }
    let before = graph.len();
    let result = derivative(&mut graph, y);
    assert_eq!(graph.value(result), Some(0.0));
    assert_eq!(graph.len(), before);
}

#[test]
fn a_substitution_is_simultaneous_and_simplifies() {
    let mut graph = Graph::default();
    let (x, y) = (graph.input(X), graph.input(Input::Variable(1)));
    let difference = graph.sub(x, y);
    let swap = |input| Some(if input == X { y } else { x });
    let swapped = graph.substitute(&[difference], &swap).unwrap();
    assert_eq!(swapped, [graph.sub(y, x)]);
    let same = graph.substitute(&[difference], &|_| Some(x)).unwrap();
    assert_eq!(graph.value(same[0]), Some(0.0));
}
