//! Deep and exploding expressions end in an answer or in `TooLarge`.

use expr::graph::Node;
use expr::ops::Unary;
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId, TooLarge, print, statistics};

const X: Input = Input::Variable(0);

/// Depth of what must not overflow the stack.
const DEEP: usize = 1_000_000;

fn chain(graph: &mut Graph, depth: usize) -> NodeId {
    let x = graph.input(X);
    let one = graph.constant(1.0);
    let mut y = x;
    for step in 0..depth {
        // Alternating, so that nothing folds.
        y = if step % 2 == 0 {
            graph.add(one, y)
        } else {
            graph.unary(Unary::Atan, y)
        };
    }
    y
}

#[test]
fn expressions_a_million_operations_deep_are_handled_on_a_small_stack() {
    let deep = || {
        let mut graph = Graph::with_limit(20 * DEEP);
        let y = chain(&mut graph, DEEP);
        let slope = chain(&mut graph, DEEP / 10);
        let slope = graph.derivatives(&[slope], X).unwrap();
        let k = graph.input(Input::Uniform(0));
        let image = graph.substitute(&[y], &|_| Some(k)).unwrap();
        assert_eq!(graph.inputs(&image), [Input::Uniform(0)]);
        let (small, roots) = graph.extract(&[y]);
        assert_eq!(statistics::operation_count(&small, &roots), DEEP);
        assert_eq!(statistics::tree_size(&small, &roots), DEEP as u64);
        let tape = Tape::new(&graph, &[y, slope[0]]);
        let mut out = [f64::NAN; 2];
        tape.eval(&mut Registers::default(), &[0.5], &mut out);
        assert!(out[0].is_finite() && out[1] == 0.0, "{out:?}");
        assert!(print::expression(&graph, y, 50).ends_with('…'));
        assert!(print::listing(&small, &roots).lines().count() > DEEP);
    };
    let thread = std::thread::Builder::new().stack_size(256 * 1024);
    thread.spawn(deep).unwrap().join().unwrap();
}

/// A product in a function in a product, five times over.
fn nasty(graph: &mut Graph) -> NodeId {
    let x = graph.input(X);
    let mut y = x;
    for op in [
        Unary::Tan,
        Unary::Log,
        Unary::Asin,
        Unary::Sqrt,
        Unary::Tanh,
    ] {
        let inner = graph.unary(op, y);
        y = graph.mul(inner, x);
    }
    y
}

#[test]
fn forty_nested_derivatives_share_their_work() {
    let mut graph = Graph::default();
    let mut y = nasty(&mut graph);
    for _ in 0..40 {
        y = graph.derivatives(&[y], X).unwrap()[0];
    }
    assert!(graph.len() < 110_000, "{}", graph.len());
}

#[test]
fn derivatives_without_room_are_too_large_and_leave_the_graph_as_it_was() {
    let mut graph = Graph::with_limit(2_000);
    let mut y = nasty(&mut graph);
    let x = graph.input(X);
    let mut reached = 0;
    let outcome = (0..40).try_for_each(|_| {
        y = graph.derivatives(&[y], X)?[0];
        reached += 1;
        Ok::<(), TooLarge>(())
    });
    assert_eq!(outcome, Err(TooLarge));
    assert!((5..20).contains(&reached), "{reached}");
    assert!(!graph.overflowed());
    let before = graph.len();
    assert!(before <= graph.limit());
    assert_eq!(graph.derivatives(&[y], X), Err(TooLarge));
    assert_eq!(graph.len(), before);
    // It still works for what has room.
    let square = graph.mul(x, x);
    assert!(graph.derivatives(&[square], X).is_ok());
}

#[test]
fn failing_for_ever_is_not_possible() {
    let mut graph = Graph::with_limit(1_000);
    let x = graph.input(X);
    let mut y = x;
    for _ in 0..200 {
        let sine = graph.unary(Unary::Sin, y);
        y = graph.mul(sine, x);
    }
    // The work of failures is bounded too: in the end even a failure is refused at once.
    let mut visits = 0;
    while graph.substitute(&[y], &|_| None).is_ok() {
        visits += 1;
        assert!(visits < 1_000);
    }
}

#[test]
fn a_full_graph_says_so_and_never_grows() {
    let mut graph = Graph::with_limit(10);
    assert!(graph.is_empty());
    for k in 0..100 {
        let k = graph.input(Input::Uniform(k));
        graph.unary(Unary::Sin, k);
    }
    assert!(graph.overflowed());
    assert!(graph.len() == 11 && !graph.is_empty());
    assert_eq!(graph.derivatives(&[], X), Err(TooLarge));
}

#[test]
fn shared_expressions_are_computed_once_and_counted_as_trees_too() {
    let mut graph = Graph::default();
    let mut y = graph.input(X);
    for _ in 0..100 {
        let sine = graph.unary(Unary::Sin, y);
        let cosine = graph.unary(Unary::Cos, y);
        y = graph.mul(sine, cosine);
    }
    assert_eq!(statistics::operation_count(&graph, &[y]), 300);
    assert_eq!(graph.operation_count(&[y]), 300);
    assert_eq!(statistics::tree_size(&graph, &[y]), u64::MAX);
    assert_eq!(graph.tree_size(&[y]), u64::MAX);
    let slope = graph.derivatives(&[y], X).unwrap();
    assert!(statistics::operation_count(&graph, &slope) < 1_500);
}

#[test]
fn extracting_keeps_what_is_needed_alone() {
    let mut graph = Graph::default();
    let (k, x) = (graph.input(Input::Uniform(2)), graph.input(X));
    let y = graph.add(k, x);
    graph.unary(Unary::Exp, y);
    let (mut small, roots) = graph.extract(&[y, y]);
    assert_eq!(small.len(), 3);
    assert_eq!(print::listing(&small, &roots), "t0 = add k2 v0\n(t0, t0)\n");
    let (k, x) = (small.input(Input::Uniform(2)), small.input(X));
    assert_eq!([small.add(x, k); 2], roots[..]);
    assert_eq!(print::expression(&small, roots[0], 100), "(add k2 v0)");
}

#[test]
fn the_inputs_of_an_expression_are_those_that_its_nodes_are() {
    let mut graph = Graph::default();
    let every = |count: u32| (0..count).step_by(3);
    let variables = every(40).map(Input::Variable);
    let inputs: Vec<Input> = variables.chain(every(20).map(Input::Uniform)).collect();
    let mut sums = vec![graph.constant(2.0)];
    for &input in &inputs {
        let (last, input) = (sums[sums.len() - 1], graph.input(input));
        let sine = graph.unary(Unary::Sin, input);
        sums.push(graph.mul(last, sine));
        sums.push(sine);
    }
    for k in 0..sums.len() {
        let roots = [sums[k], sums[k / 2]];
        let order = graph.order(&roots).into_iter();
        let mut found: Vec<Input> = order
            .filter_map(|id| match graph.node(id) {
                Node::Input(input) => Some(input),
                _ => None,
            })
            .collect();
        found.sort_unstable();
        assert_eq!(graph.inputs(&roots), found);
    }
}
