//! Slopes on several lines at once against those of one line, and against values on the lines.

use expr::interval::{Interval, Slope};
use expr::ops::{Binary, Unary};
use expr::processor::Processor;
use expr::tape::{LineInput, Registers, Tape};
use expr::vectors::MOST_LANES;
use expr::{Graph, Input, NodeId};

/// Numbers that are the same on every run.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        ((self.0 >> 33) as usize) % count
    }

    fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.below(1 << 20) as f64 / f64::from(1 << 20)
    }
}

/// The operations that are computed in vectors.
const UNARY: [Unary; 10] = [
    Unary::Sin,
    Unary::Cos,
    Unary::Neg,
    Unary::Abs,
    Unary::Sqrt,
    Unary::Exp,
    Unary::Log,
    Unary::Asin,
    Unary::Acos,
    Unary::Atan,
];
const BINARY: [Binary; 6] = [
    Binary::Add,
    Binary::Sub,
    Binary::Mul,
    Binary::Div,
    Binary::Min,
    Binary::Max,
];

/// An expression of operations that are computed in vectors.
fn expression(graph: &mut Graph, random: &mut Random, depth: usize) -> NodeId {
    if depth == 0 {
        return match random.below(6) {
            0 => graph.constant(random.between(-2.0, 2.0)),
            1 => graph.input(Input::Uniform(0)),
            _ => graph.input(Input::Variable(random.below(3) as u32)),
        };
    }
    let a = expression(graph, random, depth - 1);
    match random.below(8) {
        0 | 1 => graph.unary(UNARY[random.below(UNARY.len())], a),
        2 => graph.mul(a, a),
        3 => graph.integer_power(a, 3 + random.below(2) as i32),
        _ => {
            let b = expression(graph, random, depth - 1);
            graph.binary(BINARY[random.below(BINARY.len())], a, b)
        }
    }
}

/// True if bounds are as narrow as others, but for rounding.
fn are_as_narrow(found: Interval, expected: Interval) -> bool {
    let size = expected.lower().abs().max(expected.upper().abs());
    let slack = 1e-9 * (1.0 + size);
    found.lower() >= expected.lower() - slack && found.upper() <= expected.upper() + slack
}

/// The numbers of checks of an expression.
#[derive(Default)]
struct Checks {
    values: usize,
    undefined: usize,
    /// Of bounds that were found, those that are as narrow as on one line, and all.
    narrow: usize,
    found: usize,
}

/// Lines, and a part of each.
struct Lines {
    origin: [[f64; MOST_LANES]; 3],
    direction: [[f64; MOST_LANES]; 3],
    t: [[f64; MOST_LANES]; 2],
}

const UNIFORM: f64 = 0.7;

impl Lines {
    fn random(random: &mut Random) -> Self {
        let mut lines = Self {
            origin: [[0.0; MOST_LANES]; 3],
            direction: [[0.0; MOST_LANES]; 3],
            t: [[0.0; MOST_LANES]; 2],
        };
        let numbers = [&mut lines.origin, &mut lines.direction];
        for x in numbers.into_iter().flatten().flatten() {
            *x = random.between(-2.0, 2.0);
        }
        for lane in 0..MOST_LANES {
            let length = [1e-6, 0.01, 0.3, 9.0][random.below(4)];
            let from = random.between(-3.0, 3.0);
            (lines.t[0][lane], lines.t[1][lane]) = (from, from + length);
        }
        lines
    }

    fn inputs(&self, tape: &Tape) -> Vec<LineInput<'_>> {
        let input = |input: &Input| match *input {
            Input::Variable(k) => LineInput::Coordinate {
                origin: &self.origin[k as usize],
                direction: &self.direction[k as usize],
            },
            Input::Uniform(_) => LineInput::Number(UNIFORM),
        };
        tape.inputs().iter().map(input).collect()
    }

    /// The range on one of the lines by itself.
    fn slope_alone(&self, tape: &Tape, registers: &mut Registers, lane: usize) -> Slope {
        let t = Interval::new(self.t[0][lane], self.t[1][lane]);
        let input = |input: &Input| match *input {
            Input::Variable(k) => {
                let k = k as usize;
                Slope::line(self.origin[k][lane], self.direction[k][lane], t)
            }
            Input::Uniform(_) => Slope::constant(UNIFORM),
        };
        let inputs: Vec<Slope> = tape.inputs().iter().map(input).collect();
        let mut found = [Slope::constant(0.0)];
        tape.eval_slopes(registers, &inputs, &mut found);
        found[0]
    }

    /// The values of a tape's roots at a place on a line.
    fn at(&self, tape: &Tape, registers: &mut Registers, lane: usize, t: f64) -> Vec<f64> {
        let input = |input: &Input| match *input {
            Input::Variable(k) => {
                let k = k as usize;
                self.origin[k][lane] + t * self.direction[k][lane]
            }
            Input::Uniform(_) => UNIFORM,
        };
        let inputs: Vec<f64> = tape.inputs().iter().map(input).collect();
        let mut found = vec![0.0; tape.root_count()];
        tape.eval(registers, &inputs, &mut found);
        found
    }
}

#[test]
fn bounds_on_lines_contain_the_values_and_are_as_narrow_as_those_of_one_line() {
    let mut random = Random(5);
    let mut registers = Registers::default();
    let mut checks = Checks::default();
    for round in 0..3000 {
        let mut graph = Graph::default();
        let root = expression(&mut graph, &mut random, 1 + round % 5);
        let gradient: Vec<NodeId> = (0..3)
            .flat_map(|k| graph.derivatives(&[root], Input::Variable(k)).unwrap())
            .collect();
        let tape = Tape::new(&graph, &[root]);
        let gradient = Tape::new(&graph, &gradient);
        if !tape.is_of_vectors() {
            // A power of a power, or a constant that is NaN.
            continue;
        }
        let lines = Lines::random(&mut random);
        for processor in [Processor::here(), Processor::least()] {
            let found = tape.eval_slopes_on_lines(processor, &lines.inputs(&tape), &lines.t);
            for (lane, found) in found.into_iter().enumerate() {
                let Some(found) = found else { continue };
                let expected = lines.slope_alone(&tape, &mut registers, lane);
                if found.value.is_empty() {
                    assert!(expected.value.is_empty(), "{expected:?}");
                    continue;
                }
                for (found, expected) in
                    [(found.value, expected.value), (found.slope, expected.slope)]
                {
                    checks.found += 1;
                    checks.narrow += usize::from(are_as_narrow(found, expected));
                }
                let [from, to] = [lines.t[0][lane], lines.t[1][lane]];
                for step in 0..8 {
                    let t = from + (to - from) * f64::from(step) / 7.0;
                    let value = lines.at(&tape, &mut registers, lane, t)[0];
                    assert!(found.value.contains(value), "{value} in {found:?}");
                    if value.is_nan() {
                        checks.undefined += 1;
                        continue;
                    }
                    checks.values += 1;
                    let gradient = lines.at(&gradient, &mut registers, lane, t);
                    let slope: f64 = (0..3).map(|k| gradient[k] * lines.direction[k][lane]).sum();
                    let size = gradient.iter().fold(0.0f64, |most, g| most.max(g.abs()));
                    let slack = 1e-9 * (1.0 + size);
                    let [least, most] = [found.slope.lower(), found.slope.upper()];
                    assert!(
                        !slope.is_finite() || least - slack <= slope && slope <= most + slack,
                        "{slope} in {found:?}"
                    );
                }
            }
        }
    }
    let Checks {
        values,
        undefined,
        narrow,
        found,
    } = checks;
    assert!(
        values > 250_000 && undefined > 5000,
        "{values}, {undefined}"
    );
    assert!(narrow * 100 > found * 98, "{narrow} of {found}");
}

/// A line along x from 1 on.
const ONES: [f64; MOST_LANES] = [1.0; MOST_LANES];

/// The range on the first of some lines, for t from `from` to `to`, where x is 1 + t·`direction`.
fn first(tape: &Tape, direction: f64, [from, to]: [f64; 2]) -> Option<Slope> {
    let rates = [direction; MOST_LANES];
    let x = LineInput::Coordinate {
        origin: &ONES,
        direction: &rates,
    };
    let t = [[from; MOST_LANES], [to; MOST_LANES]];
    tape.eval_slopes_on_lines(Processor::here(), &[x], &t)[0]
}

#[test]
fn what_is_not_known_or_not_bounded_is_left_to_single_lines() {
    let mut graph = Graph::default();
    let x = graph.input(Input::Variable(0));
    let root = graph.unary(Unary::Tan, x);
    let tangent = Tape::new(&graph, &[root]);
    assert!(!tangent.is_of_vectors());
    let nothing = graph.constant(f64::NAN);
    let greatest = graph.binary(Binary::Max, x, nothing);
    assert!(!Tape::new(&graph, &[greatest]).is_of_vectors());

    let square = graph.mul(x, x);
    let square = Tape::new(&graph, &[square]);
    assert!(first(&square, 1.0, [0.0, 1.0]).is_some());
    for direction in [1e200, f64::INFINITY, f64::NAN] {
        assert!(
            first(&square, direction, [0.0, 1.0]).is_none(),
            "{direction}"
        );
    }
    assert!(first(&square, 1.0, [0.0, f64::INFINITY]).is_none());

    let root = graph.unary(Unary::Sqrt, x);
    let root = Tape::new(&graph, &[root]);
    let whole = first(&root, -1.0, [0.0, 0.5]).unwrap();
    assert!(!whole.value.is_partial() && whole.is_monotone());
    let part = first(&root, -1.0, [0.5, 2.0]).unwrap();
    assert!(part.value.is_partial() && !part.value.is_empty() && part.slope == Interval::WHOLE);
    let none = first(&root, -1.0, [1.5, 2.0]).unwrap();
    assert!(none.value.is_empty());
}

#[test]
fn each_operation_has_bounds() {
    // Where all of them are defined and have a slope.
    let [a, b] = [0.3, 0.4].map(|x| [x; MOST_LANES]);
    let line = |x| LineInput::Coordinate {
        origin: x,
        direction: x,
    };
    let mut roots = Vec::new();
    let mut graph = Graph::default();
    let [x, y] = [0, 1].map(|k| graph.input(Input::Variable(k)));
    roots.extend(UNARY.map(|op| graph.unary(op, x)));
    roots.extend(BINARY.map(|op| graph.binary(op, x, y)));
    roots.extend([3, 4].map(|n| graph.integer_power(x, n)));
    for root in roots {
        let tape = Tape::new(&graph, &[root]);
        let own = |input: &Input| match *input {
            Input::Variable(0) => line(&a),
            _ => line(&b),
        };
        let inputs: Vec<LineInput<'_>> = tape.inputs().iter().map(own).collect();
        for processor in [Processor::here(), Processor::least()] {
            let t = [[0.0; MOST_LANES], [0.01; MOST_LANES]];
            let found = tape.eval_slopes_on_lines(processor, &inputs, &t);
            for range in found {
                let Slope { value, slope } = range.expect("bounds");
                assert!(value.width() < 0.1 && slope.width() < 0.1, "{range:?}");
            }
        }
    }
}

#[test]
fn slopes_are_rounded_outward() {
    let mut graph = Graph::default();
    let [x, y] = [0, 1].map(|k| graph.input(Input::Variable(k)));
    let product = graph.mul(x, y);
    let tape = Tape::new(&graph, &[product]);
    // Both terms of the slope x'y + xy' have more digits than an f64, at sizes above, at and below 1.
    for scale in [1e6, 1.0, 1e-6] {
        let [a, b] = [scale * (1.0 + 2f64.powi(-29)), 1.0 + 2f64.powi(-29)];
        let (a, b) = ([a; MOST_LANES], [b; MOST_LANES]);
        let line = |x| LineInput::Coordinate {
            origin: x,
            direction: x,
        };
        let inputs = [line(&a), line(&b)];
        for processor in [Processor::here(), Processor::least()] {
            let t = [[0.0; MOST_LANES]; 2];
            let found = tape.eval_slopes_on_lines(processor, &inputs, &t)[0].unwrap();
            let nearest = a[0] * b[0] + a[0] * b[0];
            let Slope { slope, .. } = found;
            assert!(
                slope.lower() < nearest && nearest < slope.upper(),
                "{slope:?}"
            );
            assert!(slope.width() < 1e-14 * nearest, "{slope:?}");
        }
    }
}

#[test]
fn exponentials_roots_and_arcs_have_no_negative_values() {
    for op in [Unary::Exp, Unary::Sqrt, Unary::Acos] {
        let mut graph = Graph::default();
        let x = graph.input(Input::Variable(0));
        let root = graph.unary(op, x);
        let tape = Tape::new(&graph, &[root]);
        // From 1 down to −2000, and to the other side of 1.
        for (direction, ends) in [(-1.0, [0.0, 2000.0]), (-1.0, [0.5, 1.0]), (1.0, [0.0, 0.0])] {
            let found = first(&tape, direction, ends).unwrap();
            assert!(found.value.lower() >= 0.0, "{op:?} {ends:?}: {found:?}");
        }
    }
}

#[test]
fn a_bundle_has_the_values_of_all_its_lines() {
    let mut random = Random(9);
    let mut registers = Registers::default();
    for _ in 0..300 {
        let mut graph = Graph::default();
        let root = expression(&mut graph, &mut random, 3);
        let tape = Tape::new(&graph, &[root]);
        if !tape.is_of_vectors() {
            continue;
        }
        let mut lines = Lines::random(&mut random);
        let t = lines.t.map(|ends| ends[0]);
        lines.t = t.map(|end| [end; MOST_LANES]);
        let of = |lines: &[f64; MOST_LANES]| {
            let most = |a: f64, b: f64| a.max(b);
            let greatest = lines.iter().copied().fold(f64::NEG_INFINITY, most);
            [
                lines.iter().copied().fold(f64::INFINITY, f64::min),
                greatest,
            ]
        };
        let input = |input: &Input| match *input {
            Input::Variable(k) => LineInput::Bundle {
                origin: of(&lines.origin[k as usize]),
                direction: of(&lines.direction[k as usize]),
            },
            Input::Uniform(_) => LineInput::Number(UNIFORM),
        };
        let inputs: Vec<LineInput<'_>> = tape.inputs().iter().map(input).collect();
        let Some(all) = tape.eval_slopes_on_lines(Processor::here(), &inputs, &lines.t)[0] else {
            continue;
        };
        for lane in 0..MOST_LANES {
            for step in 0..4 {
                let t = t[0] + (t[1] - t[0]) * f64::from(step) / 3.0;
                let value = lines.at(&tape, &mut registers, lane, t)[0];
                assert!(all.value.contains(value), "{value} in {all:?}");
            }
        }
    }
}
