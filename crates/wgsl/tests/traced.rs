//! The pass of traced pictures with the expressions of scenes: every operation validates on ranges, and equal texts are one
//! pass.

use expr::ops::{Binary, Unary};
use expr::{Graph, Input, NodeId};
use wgsl::library;
use wgsl::traced::{TracedFunctions, UsedNumber, trace_scene};

fn coordinates(graph: &mut Graph) -> [NodeId; 3] {
    [0, 1, 2].map(|k| graph.input(Input::Variable(k)))
}

/// Every operation of the table.
fn operations(graph: &mut Graph) -> Vec<NodeId> {
    let [x, y, z] = coordinates(graph);
    let mut all: Vec<NodeId> = Unary::ALL.iter().map(|&op| graph.unary(op, x)).collect();
    all.extend(Binary::ALL.iter().map(|&op| graph.binary(op, y, z)));
    all.extend([-3, 3, 7].map(|n| graph.integer_power(z, n)));
    let uniform = graph.input(Input::Uniform(7));
    all.push(graph.binary(Binary::Pow, x, uniform));
    all.push(graph.mul(y, y));
    all
}

#[test]
fn every_operation_validates_on_ranges() {
    let mut graph = Graph::default();
    let mut functions = TracedFunctions::default();
    for root in operations(&mut graph) {
        functions.list(&graph, &[root]).expect("small");
    }
    trace_scene(&functions.text()).unwrap_or_else(|error| panic!("{}", error.message));
}

#[test]
fn fields_validate_alone_and_beside_attributes() {
    let mut graph = Graph::default();
    let mut functions = TracedFunctions::default();
    for (k, root) in (0..).zip(operations(&mut graph)) {
        assert_eq!(functions.field(&graph, root).expect("small").function, k);
        // The same text is the same function.
        assert_eq!(functions.field(&graph, root).expect("small").function, k);
    }
    trace_scene(&functions.text()).unwrap_or_else(|error| panic!("{}", error.message));
    let [x, y, z] = coordinates(&mut graph);
    functions.list(&graph, &[z, x, y]).expect("small");
    let text = functions.text();
    trace_scene(&text).unwrap_or_else(|error| panic!("{}", error.message));
    let another = text.replace("field_range(field: u32", "field_range(field: i32");
    let error = trace_scene(&another).expect_err("another signature");
    assert!(error.message.contains("field_range"), "{}", error.message);
}

#[test]
fn constants_are_numbers_that_a_function_reads() {
    let mut graph = Graph::default();
    let [x, ..] = coordinates(&mut graph);
    let width = graph.input(Input::Uniform(3));
    let mut functions = TracedFunctions::default();
    let mut list = |value: f64| {
        let constant = graph.constant(value);
        let scaled = graph.mul(constant, x);
        let root = graph.add(scaled, width);
        functions.list(&graph, &[root]).expect("small")
    };
    let (first, second) = (list(2.5), list(0.5));
    assert_eq!((first.function, second.function), (0, 0));
    for (used, value) in [(first, 2.5), (second, 0.5)] {
        let mut numbers = used.numbers;
        numbers.sort_by_key(|number| *number == UsedNumber::Uniform(3));
        assert_eq!(
            numbers,
            [UsedNumber::Constant(value), UsedNumber::Uniform(3)]
        );
    }
    let text = functions.text();
    assert!(!text.contains("2.5") && !text.contains("0.5"), "{text}");
}

#[test]
fn equal_expressions_are_one_function_whatever_was_read_before_them() {
    let mut graph = Graph::default();
    let mut functions = TracedFunctions::default();
    let mut list = |graph: &mut Graph, factor: f64, shift: f64| {
        let [x, y, _] = coordinates(graph);
        let factor = graph.constant(factor);
        let shift = graph.constant(shift);
        let difference = graph.sub(x, y);
        let greater = graph.binary(Binary::Max, difference, shift);
        let product = graph.mul(greater, factor);
        let wave = graph.unary(Unary::Sin, product);
        functions.list(graph, &[wave, shift]).expect("small")
    };
    let first = list(&mut graph, 4.0, 0.5);
    // Its numbers are known in another order, and later than what they are joined with.
    let mut other = Graph::default();
    other.constant(9.0);
    let second = list(&mut other, 9.0, 0.25);
    let third = list(&mut graph, 0.5, 4.0);
    assert_eq!([first.function, second.function, third.function], [0; 3]);
    assert_eq!(first.numbers.len(), second.numbers.len());
}

#[test]
fn one_of_two_equal_constants_may_change() {
    let mut graph = Graph::default();
    let [x, y, _] = coordinates(&mut graph);
    let mut functions = TracedFunctions::default();
    let mut field = |numbers: [f64; 2]| {
        let [a, b] = numbers.map(|number| graph.constant(number));
        let products = [graph.mul(a, x), graph.mul(b, y)];
        let root = graph.add(products[0], products[1]);
        functions.field(&graph, root).expect("small")
    };
    let (equal, unequal) = (field([4.0, 4.0]), field([4.0, 5.0]));
    assert_eq!((equal.function, unequal.function), (0, 0));
    assert_eq!((equal.numbers.len(), unequal.numbers.len()), (2, 2));
}

#[test]
fn what_is_too_large_is_refused_and_leaves_nothing() {
    let mut graph = Graph::default();
    let [x, ..] = coordinates(&mut graph);
    let mut root = x;
    for _ in 0..=wgsl::traced::RANGE_OPERATION_LIMIT {
        root = graph.unary(Unary::Sin, root);
    }
    let mut functions = TracedFunctions::default();
    let refused = functions.list(&graph, &[root]);
    let refused = refused.expect_err("too large").to_string();
    assert!(refused.contains("2001 operations"), "{refused}");
    assert!(refused.contains("2000"), "{refused}");
    assert_eq!(functions.text(), "");
}

#[test]
fn the_shader_has_the_limits_of_lists() {
    let most = format!(
        "const MOST_ATTRIBUTES: u32 = {}u;",
        wgsl::traced::MOST_ATTRIBUTES
    );
    assert!(library::PASS_TRACE_VARIED.text.contains(&most), "{most}");
}
