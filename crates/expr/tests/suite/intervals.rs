//! Intervals against the values that they must contain: of every operation, of random expressions, of slopes.

use expr::conformance::{Operation, anchors, cases};
use expr::interval::{Affine, Interval, Slope};
use expr::ops::{Binary, Unary};
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId};
use proptest::prelude::*;

/// Numbers at which functions have poles, kinks, ends and jumps, and moderate ones.
fn numbers() -> impl Strategy<Value = f64> {
    let special = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        2.0,
        -2.0,
        3.0,
        0.5,
        1e-300,
        -1e-300,
        5e-324,
        1e-9,
        1e5,
        1e300,
        -1e300,
        f64::INFINITY,
        f64::NEG_INFINITY,
        std::f64::consts::FRAC_PI_2,
        std::f64::consts::PI,
        -std::f64::consts::FRAC_PI_2,
    ];
    prop_oneof![
        prop::sample::select(special.to_vec()),
        -4.0..4.0f64,
        -4.0..4.0f64,
        -1e3..1e3f64,
    ]
}

fn within(box_: [f64; 2], share: f64) -> f64 {
    let [a, b] = [box_[0].min(box_[1]), box_[0].max(box_[1])];
    let point = a + share * (b - a);
    if point.is_nan() {
        if share < 0.5 { a } else { b }
    } else {
        point.clamp(a, b)
    }
}

fn interval([a, b]: [f64; 2]) -> Interval {
    Interval::new(a.min(b), a.max(b))
}

fn operations() -> impl Strategy<Value = Operation> {
    let powers = (-9..10i32).prop_map(Operation::Power);
    let all: Vec<Operation> = Operation::all().collect();
    prop_oneof![4 => prop::sample::select(all), 1 => powers]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60_000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn no_operation_misses_a_value(
        operation in operations(),
        boxes in prop::array::uniform2(prop::array::uniform2(numbers())),
        shares in prop::array::uniform2(prop_oneof![Just(0.0), Just(1.0), 0.0..1.0f64]),
    ) {
        let points = [within(boxes[0], shares[0]), within(boxes[1], shares[1])];
        let value = operation.eval(&points[..operation.arity()]).unwrap();
        let range = Interval::operation(operation, interval(boxes[0]), interval(boxes[1]));
        prop_assert!(range.contains(value), "{operation:?} at {points:?} in {boxes:?}: {value} is not in {range:?}");
    }
}

#[test]
fn a_power_of_what_is_undefined_is_1_where_the_tape_has_it_so() {
    let undefined = Interval::unary(Unary::Sqrt, Interval::point(-1.0));
    assert!(undefined.is_empty());
    let about_zero = Interval::new(-0.25, 0.25);
    let power = Interval::binary(Binary::Pow, undefined, about_zero);
    assert!(power.contains(f64::powf(f64::NAN, 0.0)), "{power:?}");
    let about_one = Interval::new(0.75, 1.25);
    let power = Interval::binary(Binary::Pow, about_one, undefined);
    assert!(power.contains(f64::powf(1.0, f64::NAN)), "{power:?}");
    assert!(power.is_partial());
}

#[test]
fn every_case_of_the_conformance_list_has_its_value_and_true_values_are_contained() {
    for case in cases().iter().chain(&anchors()) {
        for width in [0.0, 1e-9, 0.25] {
            let [a, b] = case
                .operands
                .map(|x| Interval::new(x - width, x + width / 2.0));
            let range = Interval::operation(case.operation, a, b);
            assert!(range.contains(case.expected), "{case:?} in {range:?}");
        }
        // At a point where nothing jumps the interval is nearly one, so that the tests above say something.
        let [a, b] = case.operands.map(Interval::point);
        let range = Interval::operation(case.operation, a, b);
        let jumps = case.operands.contains(&0.0) || range.width() == 1.0;
        // Exponents beyond those that multiply take a negative base as an integer of either parity.
        let large = case.operands[1] >= 1024.0 || case.operands[1] <= -1024.0;
        assert!(
            jumps || large || range.width() <= 1e-13 * case.expected.abs().max(1e-3),
            "{case:?}: {range:?}"
        );
    }
}

#[test]
fn the_first_power_is_what_it_is_taken_of() {
    let third = Interval::new(1.0 / 3.0, 2.0 / 3.0);
    assert_eq!(third.integer_power(1), third);
}

#[test]
fn sines_between_crests_reach_from_one_end_to_the_other() {
    for turn in [-3.0, 0.0, 1.0, 1000.0] {
        let turn = turn * std::f64::consts::TAU;
        // The interval, and between which values the sine and the cosine lie.
        let cases = [
            (
                [0.25, 0.5],
                [0.25f64.sin(), 0.5f64.sin()],
                [0.5f64.cos(), 0.25f64.cos()],
            ),
            ([1.0, 2.0], [1f64.sin(), 1.0], [2f64.cos(), 1f64.cos()]),
            ([2.0, 4.0], [4f64.sin(), 2f64.sin()], [-1.0, 2f64.cos()]),
            ([4.0, 5.0], [-1.0, 4f64.sin()], [4f64.cos(), 5f64.cos()]),
            ([5.0, 7.0], [5f64.sin(), 7f64.sin()], [5f64.cos(), 1.0]),
        ];
        for ([from, to], sines, cosines) in cases {
            let range = Interval::new(from + turn, to + turn);
            for (op, [least, most]) in [(Unary::Sin, sines), (Unary::Cos, cosines)] {
                let values = Interval::unary(op, range);
                let rounding = 1e-15 + f64::EPSILON * turn.abs();
                let is_near = |x: f64, expected: f64| (x - expected).abs() <= rounding;
                let is_tight = is_near(values.lower(), least) && is_near(values.upper(), most);
                assert!(is_tight, "{op:?} of {range:?}: {values:?}");
            }
        }
    }
}

#[test]
fn crests_between_large_numbers_are_seen() {
    // Neighbouring numbers of this size are 0.0001 apart.
    for turn in 0..2_000 {
        let crest = (1e11 + f64::from(turn)) * std::f64::consts::TAU + std::f64::consts::FRAC_PI_2;
        let mut numbers = [crest; 7];
        for k in 1..7 {
            numbers[k] = numbers[k - 1].next_up();
        }
        let range = Interval::unary(Unary::Sin, Interval::new(numbers[0], numbers[6]));
        for x in numbers {
            assert!(range.contains(x.sin()), "sin {x}: {} in {range:?}", x.sin());
        }
    }
}

#[test]
fn undefined_values_empty_results_and_poles_are_seen() {
    let sqrt = |a, b| Interval::unary(Unary::Sqrt, Interval::new(a, b));
    assert!(sqrt(-2.0, -1.0).is_empty() && sqrt(-2.0, -1.0).is_partial());
    assert!(sqrt(-1.0, 4.0).is_partial() && sqrt(-1.0, 4.0).contains(2.0));
    assert!(!sqrt(0.0, 4.0).is_partial());
    assert!(Interval::new(2.0, 1.0).is_empty() && Interval::point(f64::NAN).is_empty());
    let tan = Interval::unary(Unary::Tan, Interval::new(1.5, 1.6));
    assert!(tan.contains(1e300) && tan.contains(-1e300));
    let tan = Interval::unary(Unary::Tan, Interval::new(-1.5, 1.5));
    assert!(tan.upper() < 15.0);
    let over = |a, b| Interval::binary(Binary::Div, a, b);
    let one = Interval::point(1.0);
    assert!(over(one, Interval::new(-1.0, 1.0)).contains(f64::INFINITY));
    assert!(over(Interval::point(0.0), Interval::point(0.0)).is_partial());
    // A square is never −0: its reciprocal is positive.
    let square = Interval::new(-1.0, 1.0).square();
    assert!(over(one, square).lower() > 0.99);
    assert!(over(one, Interval::new(0.0, 1.0)).lower() == f64::NEG_INFINITY);
    let empty = Interval::binary(Binary::Add, one, Interval::UNDEFINED);
    assert!(empty.is_empty() && empty.is_partial());
}

#[test]
fn the_sign_of_a_zero_is_kept_by_minimum_and_maximum() {
    // Squares are never −0.
    let square = Interval::new(-1.0, 1.0).square();
    let below = Interval::unary(Unary::Neg, square);
    let one = Interval::point(1.0);
    let over = |range: Interval| Interval::binary(Binary::Div, one, range);
    let [minus, plus] = [-0.0, 0.0].map(Interval::point);
    for (a, b) in [(square, minus), (minus, square), (plus, minus)] {
        let least = Interval::binary(Binary::Min, a, b);
        assert!(over(least).contains(1.0 / -0.0), "{a:?} {b:?}: {least:?}");
        assert!(over(a.union(b)).contains(1.0 / -0.0), "{a:?} {b:?}");
    }
    for (a, b) in [(below, plus), (plus, below), (minus, plus)] {
        let greatest = Interval::binary(Binary::Max, a, b);
        assert!(
            over(greatest).contains(1.0 / 0.0),
            "{a:?} {b:?}: {greatest:?}"
        );
        assert!(over(a.union(b)).contains(1.0 / 0.0), "{a:?} {b:?}");
    }
}

/// A random expression in three variables, as instructions on a stack.
fn programs() -> impl Strategy<Value = Vec<(Operation, usize, usize)>> {
    let moderate: Vec<Operation> = Operation::all()
        .filter(|op| !matches!(op, Operation::Binary(Binary::Pow)))
        .collect();
    prop::collection::vec(
        (prop::sample::select(moderate), 0..12usize, 0..12usize),
        1..14,
    )
}

fn build(graph: &mut Graph, program: &[(Operation, usize, usize)]) -> NodeId {
    let mut nodes: Vec<NodeId> = (0..3).map(|k| graph.input(Input::Variable(k))).collect();
    nodes.push(graph.constant(0.75));
    nodes.push(graph.constant(-2.0));
    for &(operation, a, b) in program {
        let (a, b) = (
            nodes[nodes.len() - 1 - a % nodes.len()],
            nodes[nodes.len() - 1 - b % nodes.len()],
        );
        nodes.push(operation.node(graph, a, b));
    }
    nodes[nodes.len() - 1]
}

fn value(tape: &Tape, at: &[f64; 3]) -> f64 {
    let inputs: Vec<f64> = pick(tape, |k| at[k]);
    let mut out = [0.0];
    tape.eval(&mut Registers::default(), &inputs, &mut out);
    out[0]
}

fn pick<T>(tape: &Tape, of: impl Fn(usize) -> T) -> Vec<T> {
    let inputs = tape.inputs().iter();
    inputs
        .map(|input| match input {
            Input::Variable(k) => of(*k as usize),
            Input::Uniform(_) => unreachable!(),
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn no_expression_leaves_its_interval(
        program in programs(),
        corner in prop::array::uniform3(-3.0..3.0f64),
        size in prop::array::uniform3(prop_oneof![Just(0.0), 0.0..0.1f64, 0.0..3.0f64]),
        shares in prop::collection::vec(prop::array::uniform3(0.0..1.0f64), 6),
    ) {
        let mut graph = Graph::default();
        let root = build(&mut graph, &program);
        let tape = Tape::new(&graph, &[root]);
        let boxes = pick(&tape, |k| Interval::new(corner[k], corner[k] + size[k]));
        let mut range = [Interval::WHOLE];
        tape.eval_intervals(&mut Registers::default(), &boxes, &mut range);
        for share in shares {
            let at = [0, 1, 2].map(|k| (corner[k] + share[k] * size[k]).min(corner[k] + size[k]));
            let exact = value(&tape, &at);
            prop_assert!(range[0].contains(exact), "{exact} at {at:?} is not in {:?}", range[0]);
        }
    }

    #[test]
    fn no_expression_is_farther_from_its_linear_function_than_its_error(
        program in programs(),
        corner in prop::array::uniform2(-3.0..3.0f64),
        size in prop::array::uniform2(prop_oneof![Just(0.0), 1e-6..1e-2f64, 0.0..3.0f64]),
        last in -3.0..3.0f64,
        shares in prop::collection::vec(prop::array::uniform2(0.0..1.0f64), 8),
    ) {
        let mut graph = Graph::default();
        let root = build(&mut graph, &program);
        let tape = Tape::new(&graph, &[root]);
        let sides = [0, 1].map(|k| [corner[k], corner[k] + size[k]]);
        let inputs = pick(&tape, |k| match k {
            0 | 1 => Affine::coordinate(k, sides[k]),
            _ => Affine::constant(last),
        });
        let mut out = [Affine::constant(0.0)];
        tape.eval_affine(&mut Registers::default(), &inputs, &mut out);
        let [range] = out;
        for share in shares {
            let [u, v] = [0, 1].map(|k| (corner[k] + share[k] * size[k]).min(sides[k][1]));
            let exact = value(&tape, &[u, v, last]);
            prop_assert!(range.value().contains(exact), "{exact} at {u}, {v} is not in {range:?}");
            if exact.is_nan() || range.error().is_infinite() {
                continue;
            }
            let [x, y] = [(u, 0), (v, 1)].map(|(at, k)| match size[k] {
                0.0 => 0.0,
                size => 2.0 * (at - corner[k]) / size - 1.0,
            });
            let [a, b] = range.slopes();
            let near = range.middle() + a * x + b * y;
            // x and y are rounded here.
            let slack = 1e-7 * (a.abs() + b.abs()) + 1e-15 * near.abs();
            prop_assert!((exact - near).abs() <= range.error() + slack, "{exact} against {range:?}");
        }
    }

    #[test]
    fn no_difference_leaves_its_slopes(
        program in programs(),
        origin in prop::array::uniform3(-3.0..3.0f64),
        direction in prop::array::uniform3(-1.0..1.0f64),
        length in prop_oneof![1e-6..1e-2f64, 0.0..2.0f64],
        shares in prop::collection::vec(0.0..1.0f64, 8),
    ) {
        let mut graph = Graph::default();
        let root = build(&mut graph, &program);
        let tape = Tape::new(&graph, &[root]);
        let t = Interval::new(0.0, length);
        let lines = pick(&tape, |k| Slope::line(origin[k], direction[k], t));
        let mut out = [Slope::constant(0.0)];
        tape.eval_slopes(&mut Registers::default(), &lines, &mut out);
        let [Slope { value: range, slope }] = out;
        let mut places: Vec<f64> = shares.iter().map(|share| share * length).collect();
        places.sort_by(f64::total_cmp);
        let at = |t: f64| value(&tape, &[0, 1, 2].map(|k| origin[k] + t * direction[k]));
        let rounded = |t: f64| {
            let inputs = pick(&tape, |k| Interval::point(origin[k] + t * direction[k]));
            let mut out = [Interval::point(0.0)];
            tape.eval_intervals(&mut Registers::default(), &inputs, &mut out);
            out[0].width()
        };
        for pair in places.windows(2) {
            let [a, b] = [at(pair[0]), at(pair[1])];
            prop_assert!(range.contains(a), "{a} is not in {range:?}");
            let bounded = slope.lower().is_finite() && slope.upper().is_finite();
            let finite = a.is_finite() && b.is_finite();
            if range.is_partial() || !finite || !bounded && !out[0].is_monotone() {
                continue;
            }
            let step = pair[1] - pair[0];
            // Rounding of the values, also of larger ones on the way to them, and of t where the function is steep.
            let steep = if bounded { slope.lower().abs().max(slope.upper().abs()) } else { 0.0 };
            let slack = 1e-9 * (1.0 + a.abs().max(b.abs()) + steep) + rounded(pair[0]) + rounded(pair[1]);
            if bounded {
                prop_assert!(b - a >= slope.lower() * step - slack, "{a}, {b} against {slope:?}");
                prop_assert!(b - a <= slope.upper() * step + slack, "{a}, {b} against {slope:?}");
            }
            if out[0].is_monotone() && bounded {
                let follows = if slope.lower() > 0.0 { b >= a - slack } else { b <= a + slack };
                prop_assert!(follows, "{a}, {b} against {slope:?}");
            }
        }
    }
}

#[test]
fn what_jumps_is_never_monotone() {
    let mut graph = Graph::default();
    let x = graph.input(Input::Variable(0));
    let one = graph.constant(1.0);
    let ten = graph.constant(10.0);
    let sign = graph.unary(Unary::Sign, x);
    let step = graph.mul(ten, sign);
    let comparison = graph.binary(Binary::AtMost, x, one);
    let far = graph.mul(ten, comparison);
    let pole = graph.div(one, x);
    let smooth_pole = graph.unary(Unary::Atan, pole);
    let roots = [
        graph.sub(x, step),
        graph.sub(x, far),
        graph.unary(Unary::Tan, x),
        graph.add(x, pole),
        graph.add(x, smooth_pole),
        graph.integer_power(x, -3),
    ];
    for root in roots {
        let tape = Tape::new(&graph, &[root]);
        let mut out = [Slope::constant(0.0)];
        let line = Slope::line(0.0, 1.0, Interval::new(-1.5, 2.0));
        tape.eval_slopes(&mut Registers::default(), &[line], &mut out);
        assert!(
            !out[0].is_monotone(),
            "{:?}: {:?}",
            graph.node(root),
            out[0]
        );
    }
    let tape = Tape::new(&graph, &roots[..1]);
    let mut out = [Slope::constant(0.0)];
    let line = Slope::line(0.0, 1.0, Interval::new(0.5, 2.0));
    tape.eval_slopes(&mut Registers::default(), &[line], &mut out);
    assert!(out[0].is_monotone());
}

#[test]
fn the_slope_of_a_quotient_is_tight_where_its_divisor_has_no_zero() {
    let reciprocal = |value: Interval| {
        let slope = Interval::point(1.0);
        let divisor = Slope { value, slope };
        let Slope { slope, .. } = Slope::binary(Binary::Div, Slope::constant(1.0), divisor);
        [slope.lower(), slope.upper()]
    };
    // −1/t² on [1, 2].
    let [least, most] = reciprocal(Interval::new(1.0, 2.0));
    assert!((-1.000001..=-1.0).contains(&least) && (-0.25..=-0.249999).contains(&most));
    // A pole: the slope of what jumps is everything, also where only an end of the interval is one, and where that is +0.
    let all = Interval::new(-1.0, 2.0);
    for value in [
        all,
        Interval::new(0.0, 2.0),
        Interval::unary(Unary::Abs, all),
    ] {
        assert_eq!(reciprocal(value), [f64::NEG_INFINITY, f64::INFINITY]);
    }
}

#[test]
fn the_error_of_a_linear_function_shrinks_by_squares() {
    // A unit vector along (cos u, sin u, v): each of its intervals shrinks by the side of the rectangle alone.
    let mut graph = Graph::default();
    let [u, v] = [0, 1].map(|k| graph.input(Input::Variable(k)));
    let along = [graph.unary(Unary::Cos, u), graph.unary(Unary::Sin, u), v];
    let squares = along.map(|x| graph.integer_power(x, 2));
    let sum = graph.add(squares[0], squares[1]);
    let sum = graph.add(sum, squares[2]);
    let length = graph.unary(Unary::Sqrt, sum);
    let unit = along.map(|x| graph.div(x, length));
    let tape = Tape::new(&graph, &unit);
    let error = |half: f64| {
        let sides = [0.7, 0.4].map(|at| [at - half, at + half]);
        let inputs = [0, 1].map(|k| Affine::coordinate(k, sides[k]));
        let mut out = [Affine::constant(0.0); 3];
        tape.eval_affine(&mut Registers::default(), &inputs, &mut out);
        out.iter().map(Affine::error).fold(0.0, f64::max)
    };
    // The second derivatives are about 1.
    assert!(error(1e-2) < 4e-4 && error(1e-4) < 3e-8, "{}", error(1e-2));
    let ratio = error(1e-2) / error(1e-3);
    assert!((90.0..110.0).contains(&ratio), "{ratio}");
}
