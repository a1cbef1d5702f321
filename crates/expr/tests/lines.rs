//! Slopes on several lines at once against those of one line, and against values on the lines.

use expr::interval::{Interval, Slope};
use expr::ops::Unary;
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
        0 => graph.unary(Unary::Sin, a),
        1 => graph.unary(Unary::Cos, a),
        2 => graph.neg(a),
        3 => graph.mul(a, a),
        other => {
            let b = expression(graph, random, depth - 1);
            match other {
                4 => graph.add(a, b),
                5 => graph.sub(a, b),
                _ => graph.mul(a, b),
            }
        }
    }
}

/// True if two bounds are the same but for rounding in numbers of this size.
fn are_near(a: f64, b: f64, size: f64) -> bool {
    (a - b).abs() <= 1e-9 * (1.0 + size)
}

#[test]
fn bounds_on_lines_contain_the_values_and_are_as_narrow_as_those_of_one_line() {
    const UNIFORM: f64 = 0.7;
    let mut random = Random(5);
    let mut registers = Registers::default();
    let mut checked = 0;
    for round in 0..600 {
        let mut graph = Graph::default();
        let root = expression(&mut graph, &mut random, 1 + round % 5);
        let tape = Tape::new(&graph, &[root]);
        assert!(tape.is_of_vectors());
        let length = [1e-6, 0.01, 0.3, 9.0][random.below(4)];
        let from = random.between(-3.0, 3.0);
        let t = Interval::new(from, from + length);
        let mut lines = [[[0.0; MOST_LANES]; 3]; 2];
        for x in lines.as_flattened_mut().as_flattened_mut() {
            *x = random.between(-2.0, 2.0);
        }
        let [origin, direction] = lines;
        let inputs: Vec<LineInput> = tape
            .inputs()
            .iter()
            .map(|input| match *input {
                Input::Variable(k) => LineInput::Coordinate {
                    origin: origin[k as usize],
                    direction: direction[k as usize],
                },
                _ => LineInput::Number(UNIFORM),
            })
            .collect();
        for processor in [Processor::here(), Processor::least()] {
            let Some(found) = tape.eval_slopes_on_lines(processor, &inputs, t) else {
                continue;
            };
            for (lane, found) in found.iter().enumerate() {
                let alone: Vec<Slope> = tape
                    .inputs()
                    .iter()
                    .map(|input| match *input {
                        Input::Variable(k) => {
                            let k = k as usize;
                            Slope::line(origin[k][lane], direction[k][lane], t)
                        }
                        _ => Slope::constant(UNIFORM),
                    })
                    .collect();
                let mut expected = [Slope::constant(0.0)];
                tape.eval_slopes(&mut registers, &alone, &mut expected);
                for (found, expected) in [
                    (found.value, expected[0].value),
                    (found.slope, expected[0].slope),
                ] {
                    let size = expected.lower().abs().max(expected.upper().abs());
                    assert!(
                        are_near(found.lower(), expected.lower(), size)
                            && are_near(found.upper(), expected.upper(), size),
                        "{found:?}, not {expected:?}"
                    );
                }
                for step in 0..8 {
                    let t = from + length * f64::from(step) / 7.0;
                    let numbers: Vec<f64> = tape
                        .inputs()
                        .iter()
                        .map(|input| match *input {
                            Input::Variable(k) => {
                                let k = k as usize;
                                origin[k][lane] + t * direction[k][lane]
                            }
                            _ => UNIFORM,
                        })
                        .collect();
                    let mut value = [0.0];
                    tape.eval(&mut registers, &numbers, &mut value);
                    assert!(found.value.contains(value[0]), "{value:?} in {found:?}");
                    checked += 1;
                }
            }
        }
    }
    assert!(checked > 60_000, "{checked}");
}

#[test]
fn what_is_not_known_or_not_bounded_is_left_to_single_lines() {
    let mut graph = Graph::default();
    let x = graph.input(Input::Variable(0));
    let root = graph.unary(Unary::Sqrt, x);
    let tape = Tape::new(&graph, &[root]);
    assert!(!tape.is_of_vectors());
    let line = |direction: f64| LineInput::Coordinate {
        origin: [1.0; MOST_LANES],
        direction: [direction; MOST_LANES],
    };
    let t = Interval::new(0.0, 1.0);
    let here = Processor::here();
    assert!(tape.eval_slopes_on_lines(here, &[line(1.0)], t).is_none());

    let square = graph.mul(x, x);
    let tape = Tape::new(&graph, &[square]);
    assert!(tape.eval_slopes_on_lines(here, &[line(1.0)], t).is_some());
    for direction in [1e200, f64::INFINITY, f64::NAN] {
        let found = tape.eval_slopes_on_lines(here, &[line(direction)], t);
        assert!(found.is_none(), "{direction}");
    }
    let endless = Interval::new(0.0, f64::INFINITY);
    assert!(
        tape.eval_slopes_on_lines(here, &[line(1.0)], endless)
            .is_none()
    );
}
