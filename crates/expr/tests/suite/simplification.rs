//! Simplification never changes a value: random trees, evaluated as they stand and through the graph.

use expr::ops::{Binary, Unary, integer_power};
use expr::tape::{Block, LANES, Registers, Tape};
use expr::{Graph, Input, NodeId};
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum Tree {
    Constant(f64),
    Input(u32),
    Unary(Unary, Box<Tree>),
    Binary(Binary, Box<Tree>, Box<Tree>),
    Power(Box<Tree>, i32),
}

fn trees() -> impl Strategy<Value = Tree> {
    let constants = [0.0, -0.0, 1.0, -1.0, 2.0, -0.5, 3.0, 0.1, 4.0];
    let leaf = prop_oneof![
        prop::sample::select(constants.to_vec()).prop_map(Tree::Constant),
        (0u32..3).prop_map(Tree::Input),
        (0u32..3).prop_map(Tree::Input),
    ];
    leaf.prop_recursive(6, 60, 2, |inner| {
        let pair = (inner.clone(), inner.clone());
        // Signs more often than chance has it: most rules are about them.
        let unary = prop_oneof![Just(Unary::Neg), prop::sample::select(Unary::ALL.to_vec())];
        prop_oneof![
            (unary, inner.clone()).prop_map(|(op, a)| Tree::Unary(op, Box::new(a))),
            (prop::sample::select(Binary::ALL.to_vec()), pair)
                .prop_map(|(op, (a, b))| Tree::Binary(op, Box::new(a), Box::new(b))),
            // Equal operands, which independent trees never are.
            (prop::sample::select(Binary::ALL.to_vec()), inner.clone())
                .prop_map(|(op, a)| Tree::Binary(op, Box::new(a.clone()), Box::new(a))),
            (inner, -4i32..6).prop_map(|(a, n)| Tree::Power(Box::new(a), n)),
        ]
    })
}

/// The value as the tree stands; `None` where a number on the way is not finite: there the documented cases
/// apply.
fn naive(tree: &Tree, inputs: &[f64; 3]) -> Option<f64> {
    let value = match tree {
        Tree::Constant(value) => *value,
        Tree::Input(index) => inputs[*index as usize],
        Tree::Unary(op, a) => op.eval(naive(a, inputs)?),
        Tree::Binary(op, a, b) => op.eval(naive(a, inputs)?, naive(b, inputs)?),
        Tree::Power(a, n) => integer_power(naive(a, inputs)?, *n),
    };
    value.is_finite().then_some(value)
}

fn build(tree: &Tree, graph: &mut Graph) -> NodeId {
    match tree {
        Tree::Constant(value) => graph.constant(*value),
        Tree::Input(index) => graph.input(Input::Variable(*index)),
        Tree::Unary(op, a) => {
            let a = build(a, graph);
            graph.unary(*op, a)
        }
        Tree::Binary(op, a, b) => {
            let (a, b) = (build(a, graph), build(b, graph));
            graph.binary(*op, a, b)
        }
        Tree::Power(a, n) => {
            let a = build(a, graph);
            graph.integer_power(a, *n)
        }
    }
}

fn values() -> impl Strategy<Value = [f64; 3]> {
    let special = prop::sample::select(&[0.0, 1.0, -1.0, 2.0, 0.5, -3.0][..]);
    prop::array::uniform3(prop_oneof![special, -3.0..3.0])
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_simplified_expression_has_the_value_of_its_tree(tree in trees(), inputs in values()) {
        let mut graph = Graph::default();
        let root = build(&tree, &mut graph);
        if let Some(expected) = naive(&tree, &inputs) {
            let tape = Tape::new(&graph, &[root]);
            let row: Vec<f64> = tape.inputs().iter().map(|input| match input {
                Input::Variable(index) => inputs[*index as usize],
                Input::Uniform(_) => f64::NAN,
            }).collect();
            let mut out = [f64::NAN];
            tape.eval(&mut Registers::default(), &row, &mut out);
            // Zeros may differ in sign; all else to the last bit.
            prop_assert!(out[0] == expected, "{} is {:?}, not {expected:?}",
                expr::print::expression(&graph, root, 500), out[0]);
        }
    }

    #[test]
    fn lanes_compute_what_one_point_does(tree in trees(), rows in prop::collection::vec(values(), LANES)) {
        let mut graph = Graph::default();
        let root = build(&tree, &mut graph);
        let slope = graph.derivatives(&[root], Input::Variable(0)).unwrap();
        let roots = [root, slope[0]];
        let tape = Tape::new(&graph, &roots);
        let pick = |row: &[f64; 3], input: &Input| match input {
            Input::Variable(index) => row[*index as usize],
            Input::Uniform(_) => f64::NAN,
        };
        let columns: Vec<Block> = tape.inputs().iter()
            .map(|input| std::array::from_fn(|lane| pick(&rows[lane], input)))
            .collect();
        let mut registers = Registers::default();
        let mut blocks = [[0.0; LANES]; 2];
        tape.eval_block(&mut registers, &columns, &mut blocks);
        for (lane, row) in rows.iter().enumerate() {
            let row: Vec<f64> = tape.inputs().iter().map(|input| pick(row, input)).collect();
            let mut out = [0.0; 2];
            tape.eval(&mut registers, &row, &mut out);
            for (root, value) in out.iter().enumerate() {
                prop_assert!(same(*value, blocks[root][lane]), "root {root}, lane {lane}");
            }
        }
    }

    #[test]
    fn extracting_keeps_the_expression(tree in trees()) {
        let mut graph = Graph::default();
        let root = build(&tree, &mut graph);
        let (small, roots) = graph.extract(&[root]);
        let text = |graph: &Graph, root| expr::print::expression(graph, root, 10_000);
        prop_assert_eq!(text(&small, roots[0]), text(&graph, root));
    }
}

#[test]
fn equal_expressions_are_one_node() {
    let mut graph = Graph::default();
    let (x, y) = (
        graph.input(Input::Variable(0)),
        graph.input(Input::Variable(1)),
    );
    assert_eq!(graph.add(x, y), graph.add(y, x));
    assert_eq!(graph.mul(x, y), graph.mul(y, x));
    assert_eq!(graph.mul(x, x), graph.integer_power(x, 2));
    let two = graph.constant(2.0);
    assert_eq!(graph.power(x, two), graph.mul(x, x));
    assert_eq!(graph.add(x, x), graph.mul(two, x));
    let zero = graph.constant(0.0);
    assert_eq!([graph.add(x, zero), graph.add(zero, x)], [x; 2]);
    let half = graph.constant(0.5);
    assert_eq!(graph.div(x, two), graph.mul(half, x));
    assert_ne!(graph.power(x, half), graph.unary(Unary::Sqrt, x));
}

#[test]
fn the_documented_cases_turn_nan_into_zero() {
    let mut graph = Graph::default();
    let x = graph.input(Input::Variable(0));
    let zero = graph.constant(0.0);
    let results = [graph.mul(zero, x), graph.sub(x, x)];
    assert_eq!(results.map(|node| graph.value(node)), [Some(0.0); 2]);
}

#[test]
fn zero_over_zero_is_undefined_whenever_it_is_found_out() {
    let mut graph = Graph::default();
    let x = graph.input(Input::Variable(0));
    let zero = graph.constant(0.0);
    // Constants are folded as they are evaluated.
    let folded = graph.div(zero, zero);
    assert!(graph.value(folded).is_some_and(f64::is_nan));
    let evaluated = graph.div(zero, x);
    assert_eq!(graph.value(evaluated), None);
}
