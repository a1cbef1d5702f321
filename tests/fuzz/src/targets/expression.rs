//! Expressions: an input is a program for a stack of nodes.

use expr::interval::{Interval, Slope};
use expr::ops::Operation;
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId};
use wgsl::kernel::GenerateError;

/// The most operations of an expression.
const LONGEST: usize = 64;
/// The numbers that an expression has.
const CONSTANTS: [f64; 12] = [
    0.0, -0.0, 1.0, -1.0, 2.0, 0.5, -3.0, 0.1, 1e-9, 1e9, 1e150, -1e-150,
];
/// The places at which it is evaluated.
const PLACES: [[f64; 2]; 4] = [[0.0, 1.0], [0.7, -1.3], [-2.0, 2.0], [3.5, 1e-3]];

/// Inputs of different lengths that use all of the table.
pub(crate) fn seeds() -> Vec<Vec<u8>> {
    (1..12_u8)
        .map(|k| {
            (0..6 * k)
                .map(|at| at.wrapping_mul(29).wrapping_add(k))
                .collect()
        })
        .collect()
}

/// A node, and its value at each place as the expression stands; `None` where a number on the way is not finite: there
/// simplification may remove it.
#[derive(Clone)]
struct Term {
    node: NodeId,
    values: [Option<f64>; 4],
}

/// Builds an expression. Its tape has the value of the expression as it stands, intervals about its places contain it, its
/// derivative lies among its slopes, and the kernel of each eighth expression is valid WGSL or too large.
pub(crate) fn run(input: &[u8]) {
    let mut graph = Graph::default();
    let mut stack = Vec::new();
    let operations: Vec<Operation> = Operation::all().collect();
    for &byte in input.iter().take(LONGEST) {
        let next = match byte {
            0..48 => variable(&mut graph, usize::from(byte % 2)),
            48..80 => {
                let value = CONSTANTS[usize::from(byte) % CONSTANTS.len()];
                let node = graph.constant(value);
                Term {
                    node,
                    values: [Some(value); 4],
                }
            }
            // The same operand twice, which chance makes seldom.
            80..96 => match stack.last() {
                Some(term) => Term::clone(term),
                None => variable(&mut graph, 0),
            },
            _ => {
                let operation = operations[usize::from(byte - 96) % operations.len()];
                let mut operands: Vec<Term> = Vec::new();
                for k in 0..operation.arity() {
                    operands.push(stack.pop().unwrap_or_else(|| variable(&mut graph, k % 2)));
                }
                apply(&mut graph, operation, &operands)
            }
        };
        stack.push(next);
    }
    let Some(term) = stack.pop() else {
        return;
    };
    check_values(&graph, &term);
    check_derivative(&mut graph, &term);
    // Validating a kernel takes a hundred times as long as all else.
    if !input.len().is_multiple_of(8) {
        return;
    }
    let zero = graph.constant(0.0);
    match wgsl::kernel::sample_surface(&graph, [term.node, zero, zero]) {
        Ok(_) | Err(GenerateError::TooLarge { .. }) => {}
        Err(error) => panic!("{}: {error}", text(&graph, term.node)),
    }
}

fn variable(graph: &mut Graph, k: usize) -> Term {
    let node = graph.input(Input::Variable(k as u32));
    let values = PLACES.map(|place| Some(place[k]));
    Term { node, values }
}

fn apply(graph: &mut Graph, operation: Operation, operands: &[Term]) -> Term {
    let nodes: Vec<NodeId> = operands.iter().map(|it| it.node).collect();
    let [first, second] = [nodes[0], *nodes.last().expect("an operand")];
    let node = operation.node(graph, first, second);
    let values = std::array::from_fn(|at| {
        let numbers: Option<Vec<f64>> = operands.iter().map(|it| it.values[at]).collect();
        let value = operation.eval(&numbers?)?;
        value.is_finite().then_some(value)
    });
    Term { node, values }
}

/// An expression for a message.
fn text(graph: &Graph, node: NodeId) -> String {
    expr::print::expression(graph, node, 500)
}

/// The values of a tape's inputs at a place.
fn row(tape: &Tape, place: [f64; 2]) -> Vec<f64> {
    let of = |input: &Input| match *input {
        Input::Variable(k) => place[k as usize],
        Input::Uniform(_) => f64::NAN,
    };
    tape.inputs().iter().map(of).collect()
}

/// Checks the derivative by the first variable: its range at a place and that of the slopes there both contain the true one.
fn check_derivative(graph: &mut Graph, term: &Term) {
    let Ok(found) = graph.derivatives(&[term.node], Input::Variable(0)) else {
        return;
    };
    let [function, derivative] = [term.node, found[0]].map(|node| Tape::new(graph, &[node]));
    for place in PLACES {
        let points: Vec<Interval> = row(&derivative, place)
            .into_iter()
            .map(Interval::point)
            .collect();
        let mut range = [Interval::point(0.0)];
        derivative.eval_intervals(&mut Registers::default(), &points, &mut range);
        let lines = function.inputs().iter().map(|input| match *input {
            Input::Variable(0) => Slope::line(place[0], 1.0, Interval::point(0.0)),
            Input::Variable(_) => Slope::constant(place[1]),
            Input::Uniform(_) => Slope::constant(f64::NAN),
        });
        let mut out = [Slope::constant(0.0)];
        let lines: Vec<Slope> = lines.collect();
        function.eval_slopes(&mut Registers::default(), &lines, &mut out);
        let [Slope { value, slope }] = out;
        let is_known = |it: Interval| !it.is_partial() && it.width().is_finite();
        if is_known(range[0]) && is_known(value) && is_known(slope) {
            let meet = range[0].lower() <= slope.upper() && slope.lower() <= range[0].upper();
            assert!(
                meet,
                "{} at {place:?} has the derivative {:?}, and slopes {slope:?}",
                text(graph, term.node),
                range[0]
            );
        }
    }
}

fn check_values(graph: &Graph, term: &Term) {
    let tape = Tape::new(graph, &[term.node]);
    for (place, expected) in PLACES.into_iter().zip(term.values) {
        let row = row(&tape, place);
        let mut out = [f64::NAN];
        tape.eval(&mut Registers::default(), &row, &mut out);
        let text = || text(graph, term.node);
        if let Some(expected) = expected {
            assert!(
                out[0] == expected,
                "{} at {place:?} is {:?}, not {expected:?}",
                text(),
                out[0]
            );
        }
        let about: Vec<Interval> = row
            .iter()
            .map(|x| Interval::new(x - 0.25, x + 0.25))
            .collect();
        let mut ranges = [Interval::point(0.0)];
        tape.eval_intervals(&mut Registers::default(), &about, &mut ranges);
        if !out[0].is_nan() {
            assert!(
                ranges[0].contains(out[0]),
                "{} at {place:?} is {:?}, not in {:?}",
                text(),
                out[0],
                ranges[0]
            );
        }
    }
}
