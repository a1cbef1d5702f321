//! The language's operators on numbers and vectors, and what is said where dimensions do not fit.

use expr::Graph;
use expr::ops::{Unary, builtin};
use expr::tape::{Registers, Tape};
use expr::value::{self, DimensionError, Value};

fn number(graph: &mut Graph, x: f64) -> Value {
    Value::Number(graph.constant(x))
}

fn vector(graph: &mut Graph, components: &[f64]) -> Value {
    Value::Vector(components.iter().map(|&x| graph.constant(x)).collect())
}

fn evaluate(graph: &Graph, value: &Value) -> Vec<f64> {
    let tape = Tape::new(graph, value.components());
    let mut out = vec![f64::NAN; tape.root_count()];
    tape.eval(&mut Registers::default(), &[], &mut out);
    out
}

#[test]
fn operators_mean_what_the_language_says() {
    let g = &mut Graph::default();
    let (two, three) = (number(g, 2.0), number(g, 3.0));
    let (a, b) = (vector(g, &[1.0, 2.0, 3.0]), vector(g, &[4.0, 5.0, -6.0]));
    let cases = [
        (value::add(g, &a, &b), vec![5.0, 7.0, -3.0]),
        (value::subtract(g, &a, &b), vec![-3.0, -3.0, 9.0]),
        (Ok(value::negate(g, &a)), vec![-1.0, -2.0, -3.0]),
        (value::juxtapose(g, &a, &b), vec![-4.0]),
        (value::juxtapose(g, &two, &a), vec![2.0, 4.0, 6.0]),
        (value::juxtapose(g, &a, &two), vec![2.0, 4.0, 6.0]),
        (value::multiply(g, &a, &b), vec![-27.0, 18.0, -3.0]),
        (value::multiply(g, &two, &a), vec![2.0, 4.0, 6.0]),
        (value::multiply(g, &two, &three), vec![6.0]),
        (value::divide(g, &a, &two), vec![0.5, 1.0, 1.5]),
        (value::divide(g, &three, &two), vec![1.5]),
        (value::power(g, &two, &three), vec![8.0]),
        (Ok(value::square(g, &a)), vec![14.0]),
        (Ok(value::square(g, &three)), vec![9.0]),
        (value::reciprocal(g, &two), vec![0.5]),
        (value::component(&a, 3), vec![3.0]),
        (value::tuple(&[two.clone(), three.clone()]), vec![2.0, 3.0]),
        (value::tuple(std::slice::from_ref(&a)), vec![1.0, 2.0, 3.0]),
    ];
    for (result, expected) in cases {
        assert_eq!(evaluate(g, &result.unwrap()), expected);
    }
}

#[test]
fn errors_name_both_dimensions() {
    let g = &mut Graph::default();
    let (one, two, three) = (
        number(g, 1.0),
        vector(g, &[1.0, 2.0]),
        vector(g, &[1.0, 2.0, 3.0]),
    );
    let errors: [(Result<Value, DimensionError>, &str); 15] = [
        (
            value::add(g, &three, &two),
            "cannot add a vector of dimension 3 and a vector of dimension 2",
        ),
        (
            value::add(g, &one, &two),
            "cannot add a number and a vector of dimension 2",
        ),
        (
            value::subtract(g, &two, &one),
            "cannot subtract a number from a vector of dimension 2",
        ),
        (
            value::juxtapose(g, &two, &three),
            "a dot product needs two vectors of the same dimension, not a vector of dimension 2 and a vector of dimension 3",
        ),
        (
            value::multiply(g, &three, &two),
            "a cross product needs two vectors of dimension 3, not a vector of dimension 3 and a vector of dimension 2",
        ),
        (
            value::multiply(g, &two, &two),
            "a cross product needs two vectors of dimension 3, not a vector of dimension 2 and a vector of dimension 2",
        ),
        (
            value::divide(g, &one, &three),
            "cannot divide a number by a vector of dimension 3",
        ),
        (
            value::divide(g, &two, &three),
            "cannot divide a vector of dimension 2 by a vector of dimension 3",
        ),
        (
            value::power(g, &two, &one),
            "cannot raise a vector of dimension 2 to the power of a number",
        ),
        (
            value::power(g, &one, &two),
            "cannot raise a number to the power of a vector of dimension 2",
        ),
        (
            value::reciprocal(g, &three),
            "cannot take the reciprocal of a vector of dimension 3",
        ),
        (
            value::component(&three, 4),
            "a vector of dimension 3 has no component 4",
        ),
        (value::component(&one, 1), "a number has no component 1"),
        (
            value::tuple(&[one.clone(), two.clone()]),
            "component 2 of this tuple is a vector of dimension 2, but components are numbers",
        ),
        (
            value::apply(g, Unary::Sin, &three),
            "`sin` takes a number, not a vector of dimension 3",
        ),
    ];
    for (result, sentence) in errors {
        assert_eq!(result.unwrap_err().to_string(), sentence);
    }
    assert!(value::component(&three, 0).is_err());
}

#[test]
fn the_language_has_these_functions_and_no_others() {
    let mut names: Vec<_> = Unary::ALL
        .iter()
        .filter_map(|op| op.row().builtin)
        .collect();
    names.sort_unstable();
    let expected = "abs acos asin atan cos cosh exp log sin sinh sqrt tan tanh";
    assert_eq!(names.join(" "), expected);
    assert_eq!(builtin("sqrt"), Some(Unary::Sqrt));
    assert_eq!(builtin("sign"), None);
}
