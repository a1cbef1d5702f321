//! The table of operations against values found elsewhere, and every evaluator of this crate against the table.

use expr::conformance::{Case, Operation, anchors, cases};
use expr::ops::Unary;
use expr::processor::Processor;
use expr::tape::{Block, LANES, Registers, Tape, VectorRegisters};
use expr::vectors::{Instructions, MOST_LANES, Vector, VectorWork};
use expr::{Graph, Input, NodeId, number};

fn assert_close(actual: f64, expected: f64, relative: f64, what: &dyn std::fmt::Debug) {
    let close = actual == expected || (actual - expected).abs() <= relative * expected.abs();
    assert!(close, "{what:?}: {actual:?}, not {expected:?}");
}

fn bits(x: f64) -> u64 {
    if x.is_nan() {
        f64::NAN.to_bits()
    } else {
        x.to_bits()
    }
}

fn variables(graph: &mut Graph) -> (NodeId, NodeId) {
    (
        graph.input(Input::Variable(0)),
        graph.input(Input::Variable(1)),
    )
}

/// The operands of a case as the inputs of a tape over [`variables`].
fn inputs_of(tape: &Tape, case: &Case) -> Vec<f64> {
    let operand = |input: &Input| case.operands[usize::from(*input == Input::Variable(1))];
    tape.inputs().iter().map(operand).collect()
}

#[test]
#[should_panic(expected = "not 2.0")]
fn closeness_can_fail() {
    assert_close(2.001, 2.0, 1e-9, &"bad pair");
}

#[test]
fn the_table_agrees_with_true_values_for_every_operation() {
    let anchors = anchors();
    for case in &anchors {
        let operation = case.operation;
        let value = operation.eval(&case.operands[..operation.arity()]).unwrap();
        assert_close(value, case.expected, 4e-16, case);
    }
    for operation in Operation::all().filter(|op| !matches!(op, Operation::Power(_))) {
        assert!(
            anchors.iter().any(|case| case.operation == operation),
            "{operation:?}"
        );
        assert!(
            cases().iter().any(|case| case.operation == operation),
            "{operation:?}"
        );
    }
}

#[test]
fn an_operation_is_built_of_as_many_operands_as_it_takes() {
    let mut graph = Graph::default();
    let (a, b) = variables(&mut graph);
    for operation in Operation::all() {
        let arity = operation.arity();
        let node = operation.node(&mut graph, a, b);
        for operands in [&[][..], &[a], &[a, b], &[a, b, b]] {
            let expected = (operands.len() == arity).then_some(node);
            assert_eq!(
                operation.build(&mut graph, operands),
                expected,
                "{operation:?}"
            );
        }
    }
}

#[test]
fn tape_and_lanes_give_the_value_of_every_case() {
    let mut registers = Registers::default();
    for case in cases().iter().chain(&anchors()) {
        let mut graph = Graph::default();
        let (a, b) = variables(&mut graph);
        let root = case.operation.node(&mut graph, a, b);
        let tape = Tape::new(&graph, &[root]);
        let row = inputs_of(&tape, case);
        let mut out = [f64::NAN];
        tape.eval(&mut registers, &row, &mut out);
        let definition = case
            .operation
            .eval(&case.operands[..case.operation.arity()]);
        assert_eq!(bits(out[0]), bits(definition.unwrap()), "{case:?}");
        let columns: Vec<Block> = row.iter().map(|&x| [x; LANES]).collect();
        let mut blocks = [[f64::NAN; LANES]];
        tape.eval_block(&mut registers, &columns, &mut blocks);
        assert!(
            blocks[0].iter().all(|&x| bits(x) == bits(out[0])),
            "{case:?}"
        );
    }
}

#[test]
fn an_exponent_in_a_param_gives_what_the_same_literal_gives() {
    let mut graph = Graph::default();
    let (x, y) = variables(&mut graph);
    let run = graph.power(x, y);
    for exponent in [
        -1024.0, -7.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 10.0, 1024.0, 1025.0, 0.5,
    ] {
        let literal = graph.constant(exponent);
        let literal = graph.power(x, literal);
        for base in [-2.5, -1.0, -0.0, 0.0, 0.3, 1.0, 7.0, f64::INFINITY] {
            let mut registers = Registers::default();
            let (mut a, mut b) = ([0.0], [0.0]);
            Tape::new(&graph, &[run]).eval(&mut registers, &[base, exponent], &mut a);
            let tape = Tape::new(&graph, &[literal]);
            let inputs = &[base][..tape.inputs().len()];
            tape.eval(&mut registers, inputs, &mut b);
            assert_eq!(bits(a[0]), bits(b[0]), "{base}^{exponent}");
        }
    }
}

#[test]
fn registers_are_used_again_and_roots_keep_theirs() {
    let mut graph = Graph::default();
    let (x, y) = variables(&mut graph);
    let mut chain = x;
    let mut roots = vec![x];
    for _ in 0..100 {
        chain = graph.unary(expr::ops::Unary::Sin, chain);
    }
    roots.push(chain);
    assert_eq!(Tape::new(&graph, &roots).register_count(), 1);
    let sum = graph.add(chain, y);
    let product = graph.mul(sum, chain);
    let seven = graph.constant(7.0);
    roots.extend([sum, product, seven, sum]);
    let tape = Tape::new(&graph, &roots);
    let mut out = [0.0; 6];
    tape.eval(&mut Registers::default(), &[0.5, 2.0], &mut out);
    let sine = (0..100).fold(0.5f64, |x, _| x.sin());
    assert_eq!(
        out,
        [0.5, sine, sine + 2.0, (sine + 2.0) * sine, 7.0, sine + 2.0]
    );
    assert_eq!(tape.operation_count(), 102);
}

#[test]
fn numbers_as_text_read_back_as_themselves() {
    assert_eq!(number::wgsl_literal(1.0).unwrap(), "1.0");
    assert_eq!(
        number::wgsl_literal(2.0 * std::f64::consts::PI).unwrap(),
        "6.2831855"
    );
    assert_eq!(number::wgsl_literal(-1e-7).unwrap(), "-1e-7");
    assert_eq!(
        number::wgsl_literal(1e39),
        Err(number::LiteralError::Infinite)
    );
    assert_eq!(
        number::wgsl_literal(-1e300),
        Err(number::LiteralError::MinusInfinite)
    );
    assert_eq!(
        number::wgsl_literal(f64::NAN),
        Err(number::LiteralError::Undefined)
    );
    for x in [
        0.1,
        1.0 / 3.0,
        1e300,
        5e-324,
        std::f64::consts::TAU,
        2.0,
        -1e20,
    ] {
        assert_eq!(number::text(x).parse::<f64>().unwrap(), x);
        if let Ok(text) = number::wgsl_literal(x) {
            assert_eq!(text.parse::<f32>().unwrap(), x as f32);
        }
    }
    assert_eq!(number::text(2.0), "2");
}

/// The value of a tape at a point in all lanes.
struct InAllLanes<'a> {
    tape: &'a Tape,
    inputs: &'a [f64],
}

impl VectorWork for InAllLanes<'_> {
    type Output = [f64; MOST_LANES];

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) -> Self::Output {
        let mut registers = VectorRegisters::new(s, self.tape);
        let inputs = self.inputs.iter().map(|&x| Vector::splat(s, x));
        let inputs: Vec<Vector<S>> = inputs.collect();
        let value = self.tape.eval_vector(s, &mut registers, &inputs);
        let mut lanes = [0.0; MOST_LANES];
        for part in 0..Vector::<S>::PARTS {
            value.store(&mut lanes, part);
        }
        lanes
    }
}

#[test]
fn vectors_give_the_value_of_every_case() {
    for case in cases().iter().chain(&anchors()) {
        let mut graph = Graph::default();
        let (a, b) = variables(&mut graph);
        let root = case.operation.node(&mut graph, a, b);
        let tape = Tape::new(&graph, &[root]);
        let inputs = inputs_of(&tape, case);
        let value = case
            .operation
            .eval(&case.operands[..case.operation.arity()])
            .unwrap();
        for processor in [Processor::here(), Processor::least()] {
            let lanes = processor.run_vectors(InAllLanes {
                tape: &tape,
                inputs: &inputs,
            });
            for found in lanes {
                match case.operation {
                    Operation::Unary(Unary::Sin | Unary::Cos) if value.is_finite() => {
                        assert_close(found, value, 2.5e-16, case);
                    }
                    _ => assert_eq!(bits(found), bits(value), "{case:?}: {found}, not {value}"),
                }
            }
        }
    }
}
