//! Jets against symbolic derivatives, dual numbers and themselves in other numbers of lanes.

use expr::conformance::{Operation, anchors, cases};
use expr::jets::{JetRegisters, JetTape, Order};
use expr::ops::{Binary, Numbers, Unary};
use expr::processor::Processor;
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId, TooLarge};
use num_dual::{Dual2_64, DualNum};
use proptest::prelude::*;

const U: Input = Input::Variable(0);
const V: Input = Input::Variable(1);
const PARTS: [&str; 6] = ["value", "du", "dv", "duu", "duv", "dvv"];

/// The six coefficients of a root, the uniforms being `k`.
fn jet<const N: usize>(graph: &Graph, root: NodeId, at: &[[f64; N]; 2], k: f64) -> [[f64; N]; 6] {
    jet_on(&mut JetRegisters::default(), graph, root, at, k)
}

fn jet_on<const N: usize>(
    registers: &mut JetRegisters,
    graph: &Graph,
    root: NodeId,
    at: &[[f64; N]; 2],
    k: f64,
) -> [[f64; N]; 6] {
    let tape = JetTape::new(graph, &[root], [U, V], Order::Second).unwrap();
    let fixed = tape.fix(&vec![k; tape.uniforms().len()]);
    let mut out = [[f64::NAN; N]; 6];
    tape.eval(registers, &fixed, at, &mut out);
    out
}

/// The same by symbolic derivatives and the scalar tape.
fn symbolic(graph: &Graph, root: NodeId, at: [f64; 2], k: f64) -> [f64; 6] {
    let mut graph = graph.clone();
    let du = graph.derivatives(&[root], U).unwrap()[0];
    let dv = graph.derivatives(&[root], V).unwrap()[0];
    let duu = graph.derivatives(&[du], U).unwrap()[0];
    let duv = graph.derivatives(&[du], V).unwrap()[0];
    let dvv = graph.derivatives(&[dv], V).unwrap()[0];
    let tape = Tape::new(&graph, &[root, du, dv, duu, duv, dvv]);
    let inputs: Vec<f64> = tape
        .inputs()
        .iter()
        .map(|input| match *input {
            U => at[0],
            V => at[1],
            _ => k,
        })
        .collect();
    let mut out = [f64::NAN; 6];
    tape.eval(&mut Registers::default(), &inputs, &mut out);
    out
}

#[track_caller]
fn assert_jet(actual: [f64; 6], expected: [f64; 6], tolerance: f64, what: &dyn std::fmt::Debug) {
    for ((part, a), e) in PARTS.iter().zip(actual).zip(expected) {
        let close = a == e
            // An infinite slope times a slope that vanishes here, or at another place of the product.
            || !a.is_finite() && !e.is_finite()
            || (a - e).abs() <= tolerance * e.abs().max(1.0);
        assert!(close, "{what:?}, {part}: {a:?}, not {e:?}");
    }
}

fn bits<const N: usize>(jet: [[f64; N]; 6]) -> Vec<u64> {
    let number = |x: f64| if x.is_nan() { f64::NAN } else { x + 0.0 };
    jet.iter().flatten().map(|&x| number(x).to_bits()).collect()
}

fn variables(graph: &mut Graph) -> [NodeId; 3] {
    [U, V, Input::Uniform(0)].map(|input| graph.input(input))
}

#[test]
#[should_panic(expected = "not 1.0")]
fn closeness_can_fail() {
    assert_jet(
        [0.0, 1.0 + 1e-11, 0.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        1e-12,
        &"bad pair",
    );
}

#[test]
fn every_case_of_the_conformance_list_has_its_value() {
    for case in cases().iter().chain(&anchors()) {
        let mut graph = Graph::default();
        let [u, v, _] = variables(&mut graph);
        let root = case.operation.node(&mut graph, u, v);
        let [a, b] = case.operands;
        let value = jet(&graph, root, &[[a], [b]], 0.0)[0][0];
        let expected = case
            .operation
            .eval(&case.operands[..case.operation.arity()])
            .unwrap();
        // Three units in the last place.
        let close = value == expected || (value - expected).abs() <= 6.7e-16 * expected.abs();
        assert!(close, "{case:?}: {value:?}");
    }
}

#[test]
fn every_operation_has_the_derivatives_of_its_symbolic_rule_also_where_they_are_undefined() {
    let numbers = [-2.5, -1.0, -0.4, 0.0, 0.3, 1.0, 2.0];
    for operation in Operation::all() {
        let mut graph = Graph::default();
        let [u, v, k] = variables(&mut graph);
        let (product, square) = (graph.mul(u, v), graph.mul(u, u));
        let (bent, sum) = (graph.add(square, v), graph.add(product, k));
        let operands = match operation.arity() {
            1 => vec![(u, u), (v, v), (bent, bent), (product, product), (k, k)],
            _ => vec![
                (u, v),
                (u, k),
                (k, v),
                (u, u),
                (bent, sum),
                (product, bent),
                (k, k),
            ],
        };
        for (a, b) in operands {
            let root = operation.node(&mut graph, a, b);
            for x in numbers {
                for y in numbers {
                    for k in [-2.0, 0.0, 1.0, 1.7] {
                        let actual = jet(&graph, root, &[[x], [y]], k).map(|[x]| x);
                        let expected = symbolic(&graph, root, [x, y], k);
                        assert_jet(actual, expected, 1e-13, &(operation, a, b, x, y, k));
                    }
                }
            }
        }
    }
}

#[test]
fn slopes_of_every_unary_operation_are_those_of_dual_numbers() {
    for op in Unary::ALL {
        for at in [-0.9, -0.4, 0.2, 0.7, 3.0] {
            let x = Dual2_64::from(at).derivative();
            let expected = match op {
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
                Unary::Abs if at < 0.0 => -x,
                Unary::Abs => x,
                Unary::Sign => Dual2_64::from(at.signum()),
            };
            if expected.re.is_nan() {
                continue;
            }
            let [first, second] = op.slopes(&mut Numbers, at, op.eval(at));
            for (actual, expected) in [(first, expected.v1), (second, expected.v2)] {
                let error = (actual - expected).abs() / expected.abs().max(1.0);
                assert!(
                    error < 1e-13,
                    "{op:?} at {at}: {actual:?}, not {expected:?}"
                );
            }
        }
    }
}

#[test]
fn a_kink_has_slope_zero_and_what_does_not_vary_has_no_derivative_where_a_slope_is_infinite() {
    let mut graph = Graph::default();
    let [u, _, k] = variables(&mut graph);
    let kink = graph.unary(Unary::Abs, u);
    assert_eq!(
        jet(&graph, kink, &[[0.0], [0.0]], 0.0).map(|[x]| x),
        [0.0; 6]
    );
    // √k at k = 0, times u.
    let root = graph.unary(Unary::Sqrt, k);
    let scaled = graph.mul(root, u);
    assert_eq!(
        jet(&graph, scaled, &[[3.0], [0.0]], 0.0).map(|[x]| x),
        [0.0; 6]
    );
}

#[test]
fn two_times_the_same_variable_derive_a_curve() {
    let mut graph = Graph::default();
    let u = graph.input(U);
    let cube = graph.integer_power(u, 3);
    let tape = JetTape::new(&graph, &[cube], [U, U], Order::Second).unwrap();
    let mut out = [[f64::NAN]; 6];
    tape.eval(
        &mut JetRegisters::default(),
        &tape.fix(&[]),
        &[[2.0]; 2],
        &mut out,
    );
    assert_eq!(out.map(|[x]| x), [8.0, 12.0, 12.0, 12.0, 12.0, 12.0]);
}

#[test]
fn what_is_not_needed_costs_nothing() {
    let count = |build: &dyn Fn(&mut Graph) -> Vec<NodeId>, order| {
        let mut graph = Graph::default();
        let roots = build(&mut graph);
        JetTape::new(&graph, &roots, [U, V], order)
            .unwrap()
            .instruction_count()
    };
    let plane = |graph: &mut Graph| {
        let [u, v, _] = variables(graph);
        let zero = graph.constant(0.0);
        vec![u, v, zero]
    };
    assert_eq!(count(&plane, Order::Second), 0);
    // Values of a u-only and a v-only factor with two coefficients each take their products alone: six, and two
    // pairs of sine and cosine; derivatives of sines are cosines, which are there.
    let product = |graph: &mut Graph| {
        let [u, v, _] = variables(graph);
        let (sin, cos) = (graph.unary(Unary::Sin, u), graph.unary(Unary::Cos, v));
        vec![graph.mul(sin, cos)]
    };
    assert_eq!(count(&product, Order::Value), 3);
    assert_eq!(count(&product, Order::First), 5);
    // ∂uu and ∂vv are minus the value.
    assert_eq!(count(&product, Order::Second), 6);
    // What depends on uniforms alone is computed beforehand, and a factor that does is one of the result.
    let fixed = |graph: &mut Graph| {
        let [u, _, k] = variables(graph);
        let exp = graph.unary(Unary::Exp, k);
        let sin = graph.unary(Unary::Sin, exp);
        vec![graph.mul(sin, u)]
    };
    assert_eq!(count(&fixed, Order::Second), 0);
}

#[test]
fn the_torus_takes_nine_instructions() {
    let mut graph = Graph::default();
    let [u, v, r] = variables(&mut graph);
    let (cos_v, sin_v) = (graph.unary(Unary::Cos, v), graph.unary(Unary::Sin, v));
    let (cos_u, sin_u) = (graph.unary(Unary::Cos, u), graph.unary(Unary::Sin, u));
    let (tube, one) = (graph.mul(r, cos_v), graph.constant(1.0));
    let radius = graph.add(one, tube);
    let roots = [
        graph.mul(radius, cos_u),
        graph.mul(radius, sin_u),
        graph.mul(r, sin_v),
    ];
    let tape = JetTape::new(&graph, &roots, [U, V], Order::Second).unwrap();
    assert_eq!((tape.instruction_count(), tape.root_count()), (9, 3));
    assert_eq!(tape.uniforms(), [Input::Uniform(0)]);
}

#[test]
fn an_expression_too_large_for_its_graph_is_refused() {
    let mut graph = Graph::with_limit(40);
    let [u, v, _] = variables(&mut graph);
    let mut root = graph.mul(u, v);
    for _ in 0..12 {
        root = graph.unary(Unary::Tan, root);
    }
    assert!(!graph.overflowed());
    assert_eq!(
        JetTape::new(&graph, &[root], [U, V], Order::Second).map(|_| ()),
        Err(TooLarge)
    );
    assert!(JetTape::new(&graph, &[root], [U, V], Order::Value).is_ok());
}

#[test]
fn registers_serve_several_tapes_by_turns() {
    let mut graph = Graph::default();
    let [u, v, k] = variables(&mut graph);
    let (a, b) = (graph.mul(k, u), graph.add(k, v));
    let tapes = [a, b].map(|root| JetTape::new(&graph, &[root], [U, V], Order::Value).unwrap());
    let mut registers = JetRegisters::default();
    for round in 0..4 {
        let k = f64::from(round);
        for (tape, expected) in tapes.iter().zip([k * 5.0, k + 7.0]) {
            let fixed = tape.fix(&[k]);
            let mut eight = [[0.0; 8]];
            tape.eval(&mut registers, &fixed, &[[5.0; 8], [7.0; 8]], &mut eight);
            let mut one = [[0.0]];
            tape.eval(&mut registers, &fixed, &[[5.0], [7.0]], &mut one);
            assert_eq!((eight, one), ([[expected; 8]], [[expected]]));
        }
    }
}

/// A random expression of u, v and k.
fn expressions() -> impl Strategy<Value = Vec<(u8, u16, u16)>> {
    prop::collection::vec((any::<u8>(), any::<u16>(), any::<u16>()), 1..24)
}

fn build(graph: &mut Graph, steps: &[(u8, u16, u16)]) -> NodeId {
    let mut nodes = variables(graph).to_vec();
    nodes.push(graph.constant(0.5));
    let operations: Vec<Operation> = Operation::all().collect();
    for &(op, a, b) in steps {
        let [a, b] = [a, b].map(|k| nodes[usize::from(k) % nodes.len()]);
        let operation = operations[usize::from(op) % operations.len()];
        nodes.push(operation.node(graph, a, b));
    }
    nodes[nodes.len() - 1]
}

proptest! {
    #[test]
    fn bits_do_not_depend_on_the_number_of_lanes_nor_on_the_processor(
        steps in expressions(),
        u in prop::collection::vec(-3.0..3.0f64, 64),
        v in prop::collection::vec(-3.0..3.0f64, 64),
    ) {
        let mut graph = Graph::default();
        let root = build(&mut graph, &steps);
        let at: [[f64; 64]; 2] = [u.try_into().unwrap(), v.try_into().unwrap()];
        let all = jet(&graph, root, &at, 0.7);
        let least = jet_on(&mut JetRegisters::on(Processor::least()), &graph, root, &at, 0.7);
        prop_assert_eq!(bits(all), bits(least));
        let eight = at.map(|lanes| std::array::from_fn::<f64, 8, _>(|k| lanes[k]));
        let first = all.map(|lanes| std::array::from_fn::<f64, 8, _>(|k| lanes[k]));
        prop_assert_eq!(bits(jet(&graph, root, &eight, 0.7)), bits(first));
        let one = at.map(|lanes| [lanes[0]]);
        prop_assert_eq!(bits(jet(&graph, root, &one, 0.7)), bits(all.map(|lanes| [lanes[0]])));
        // A number of lanes that is no whole number of vectors.
        let three = at.map(|lanes| [lanes[0], lanes[1], lanes[2]]);
        let first = all.map(|lanes| [lanes[0], lanes[1], lanes[2]]);
        prop_assert_eq!(bits(jet(&graph, root, &three, 0.7)), bits(first));
    }

    #[test]
    fn random_expressions_have_their_symbolic_derivatives(
        steps in prop::collection::vec((any::<u8>(), any::<u16>(), any::<u16>()), 1..7),
        u in -1.5..1.5f64,
        v in -1.5..1.5f64,
    ) {
        let mut graph = Graph::default();
        let root = build(&mut graph, &steps);
        let actual = jet(&graph, root, &[[u], [v]], 0.7).map(|[x]| x);
        let expected = symbolic(&graph, root, [u, v], 0.7);
        // Where the expression is tame: what is badly conditioned rounds differently.
        if expected.iter().all(|x| x.abs() < 1e3) {
            assert_jet(actual, expected, 1e-9, &steps);
        }
    }
}

#[test]
fn many_registers_have_the_bits_of_one_lane_in_all_lanes() {
    // Sines of many places that are all needed at the end, so that as many registers are in use.
    let mut graph = Graph::default();
    let [u, v, _] = variables(&mut graph);
    let place = |k: usize| {
        let k = k as f64;
        (0.1 * k - 3.0, 2.0 - 0.07 * k)
    };
    let all: [[f64; 64]; 2] = [
        std::array::from_fn(|k| place(k).0),
        std::array::from_fn(|k| place(k).1),
    ];
    for terms in [20, 60, 400] {
        let mut angle = graph.mul(u, v);
        let mut sines = Vec::new();
        for k in 0..terms {
            let step = graph.constant(0.25 + f64::from(k));
            let next = graph.add(angle, step);
            angle = graph.unary(Unary::Sin, next);
            sines.push(angle);
        }
        let mut root = u;
        for &sine in sines.iter().rev() {
            let product = graph.mul(root, sine);
            root = graph.add(product, sine);
        }
        let wide = jet(&graph, root, &all, 0.7);
        for lane in [0, 7, 8, 63] {
            let at = all.map(|lanes| [lanes[lane]]);
            let one = wide.map(|lanes| [lanes[lane]]);
            assert_eq!(
                bits(jet(&graph, root, &at, 0.7)),
                bits(one),
                "{terms} {lane}"
            );
        }
    }
}

#[test]
fn powers_just_above_those_that_multiply_have_their_symbolic_derivatives() {
    // The exponents of their derivatives are among those that do.
    for exponent in [1025.0, 1026.0, -1025.0] {
        let mut graph = Graph::default();
        let [u, v, _] = variables(&mut graph);
        let base = graph.mul(u, v);
        let exponent = graph.constant(exponent);
        let root = graph.binary(Binary::Pow, base, exponent);
        let at = [1.0625, 0.9375];
        let actual = jet(&graph, root, &at.map(|x| [x]), 0.0).map(|[x]| x);
        assert_jet(actual, symbolic(&graph, root, at, 0.0), 1e-12, &at);
    }
}

#[test]
fn powers_by_a_param_have_the_derivatives_of_a_literal() {
    for exponent in [-3.0, -1.0, 0.0, 1.0, 2.0, 3.0, 0.5] {
        let mut graph = Graph::default();
        let [u, v, k] = variables(&mut graph);
        let base = graph.mul(u, v);
        let literal = graph.constant(exponent);
        let roots = [k, literal].map(|exponent| graph.binary(Binary::Pow, base, exponent));
        for at in [[1.5, 0.7], [0.0, 2.0], [-0.5, 1.0]] {
            let [by_param, by_literal] =
                roots.map(|root| jet(&graph, root, &at.map(|x| [x]), exponent).map(|[x]| x));
            if by_literal.iter().all(|x| x.is_finite()) {
                assert_jet(by_param, by_literal, 1e-13, &(exponent, at));
            }
        }
    }
}
