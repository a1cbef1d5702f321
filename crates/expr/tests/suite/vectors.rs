//! Operations on vectors against the same operations on numbers, for each kind of processor.

use expr::elementary;
use expr::ops::Operation;
use expr::processor::Processor;
use expr::tape::{Registers, Tape, VectorRegisters};
use expr::vectors::{Instructions, Lanes, MOST_LANES, Mask, Vector, VectorWork};
use expr::{Graph, Input};

type Block = [f64; MOST_LANES];

/// All operations on two blocks.
struct All<'a> {
    a: &'a Block,
    b: &'a Block,
    odd: Lanes,
}

/// The number of operations.
const OPERATIONS: usize = 26;

/// The results of numbers, and 1 or 0 for those of comparisons.
#[derive(Default)]
struct Results {
    blocks: [Block; OPERATIONS],
    least: f64,
    greatest: f64,
    any: bool,
    any_below_itself: bool,
}

impl VectorWork for All<'_> {
    type Output = Results;

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) -> Results {
        let mut results = Results {
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
            ..Results::default()
        };
        for part in 0..Vector::<S>::PARTS {
            let a = Vector::load(s, self.a, part);
            let b = Vector::load(s, self.b, part);
            let (one, zero) = (Vector::splat(s, 1.0), Vector::splat(s, 0.0));
            let (less, equal) = (a.lt(b), a.equals(b));
            let found = [
                a + b,
                a - b,
                a * b,
                a / b,
                -a,
                a.sqrt(),
                a.abs(),
                a.copysign(b),
                a.least(b),
                a.greatest(b),
                less.choose(one, zero),
                a.le(b).choose(one, zero),
                equal.choose(one, zero),
                (!less).choose(one, zero),
                (less | equal).choose(one, zero),
                (a.le(b) & b.le(a)).choose(one, zero),
                less.differs(a.le(b)).choose(one, zero),
                Mask::splat(s, true).choose(a, b),
                Mask::splat(s, false).choose(a, b),
                less.choose(a, b),
                a.is_finite().choose(one, zero),
                a.sin_cos().0,
                a.sin_cos().1,
                a.map(f64::exp),
                a.map_with(b, f64::hypot),
                Mask::of(s, self.odd, part).choose(a, b),
            ];
            for (block, found) in results.blocks.iter_mut().zip(found) {
                found.store(block, part);
            }
            results.least = results.least.min(a.least_lane());
            results.greatest = results.greatest.max(a.greatest_lane());
            results.any |= less.any();
            results.any_below_itself |= a.lt(a).any();
        }
        results
    }
}

/// What [`All`] finds for two numbers in an odd lane or in another one.
fn expected(a: f64, b: f64, is_odd: bool) -> [f64; OPERATIONS] {
    let ([sine], [cosine]) = elementary::sin_cos(&[a]);
    let flag = |yes: bool| f64::from(u8::from(yes));
    [
        a + b,
        a - b,
        a * b,
        a / b,
        -a,
        a.sqrt(),
        a.abs(),
        a.copysign(b),
        if a < b { a } else { b },
        if b < a { a } else { b },
        flag(a < b),
        flag(a <= b),
        flag(a == b),
        flag(!matches!(a.partial_cmp(&b), Some(std::cmp::Ordering::Less))),
        flag(a <= b),
        flag(a == b),
        flag(a == b),
        a,
        b,
        if a < b { a } else { b },
        flag(a.is_finite()),
        sine,
        cosine,
        a.exp(),
        a.hypot(b),
        if is_odd { a } else { b },
    ]
}

/// Equal to the last bit, or both NaN.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

#[test]
fn every_lane_is_computed_as_a_number_alone() {
    let numbers = [
        0.0,
        -0.0,
        1.0,
        -1.5,
        3.7e-310,
        1e300,
        -1e-200,
        std::f64::consts::PI,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];
    // A pattern that differs between the parts of a block.
    let odd = Lanes::of(|lane| lane % 3 == 1);
    for processor in [Processor::here(), Processor::least()] {
        for first in 0..numbers.len() {
            for second in 0..numbers.len() {
                let at = |k: usize| numbers[k % numbers.len()];
                let a: Block = std::array::from_fn(|lane| at(first + lane));
                let b: Block = std::array::from_fn(|lane| at(second + 3 * lane));
                let found = processor.run_vectors(All { a: &a, b: &b, odd });
                for lane in 0..MOST_LANES {
                    let expected = expected(a[lane], b[lane], odd.has(lane));
                    for (k, (block, expected)) in found.blocks.iter().zip(expected).enumerate() {
                        assert!(
                            same(block[lane], expected),
                            "operation {k} of {} and {}: {}, not {expected}",
                            a[lane],
                            b[lane],
                            block[lane]
                        );
                    }
                }
                assert_eq!(found.any, a.iter().zip(&b).any(|(a, b)| a < b));
                assert!(!found.any_below_itself);
                if a.iter().all(|a| !a.is_nan()) {
                    let least = a.iter().copied().fold(f64::INFINITY, f64::min);
                    let greatest = a.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                    assert_eq!([found.least, found.greatest], [least, greatest]);
                }
            }
        }
    }
}

/// The values of a tape at pairs of numbers.
struct Values<'a> {
    tape: &'a Tape,
    inputs: &'a [Block; 2],
}

impl VectorWork for Values<'_> {
    type Output = Block;

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) -> Block {
        let mut registers = VectorRegisters::new(s, self.tape);
        let mut values = [0.0; MOST_LANES];
        for part in 0..Vector::<S>::PARTS {
            let input = |input: &Input| match *input {
                Input::Variable(k) => Vector::load(s, &self.inputs[k as usize], part),
                Input::Uniform(_) => Vector::splat(s, f64::NAN),
            };
            let inputs: Vec<Vector<S>> = self.tape.inputs().iter().map(input).collect();
            let value = self.tape.eval_vector(s, &mut registers, &inputs);
            value.store(&mut values, part);
        }
        values
    }
}

#[test]
fn a_tape_has_the_values_of_numbers_in_every_lane() {
    let inputs: [Block; 2] = [
        [0.3, -1.7, 2.5, 0.0, -0.4, 11.0, -3.0, 0.9],
        [1.1, 0.6, -2.0, 5.0, -0.7, 0.2, 3.0, -8.0],
    ];
    let mut registers = Registers::default();
    for operation in Operation::all() {
        let mut graph = Graph::default();
        let [a, b] = [0, 1].map(|k| graph.input(Input::Variable(k)));
        let node = operation.node(&mut graph, a, b);
        // A sum with an input, and a product of results: registers are used anew.
        let sum = graph.add(node, b);
        let product = graph.mul(sum, node);
        for root in [node, product] {
            let tape = Tape::new(&graph, &[root]);
            for processor in [Processor::here(), Processor::least()] {
                let found = processor.run_vectors(Values {
                    tape: &tape,
                    inputs: &inputs,
                });
                for (lane, found) in found.into_iter().enumerate() {
                    let inputs = tape.inputs().iter().map(|input| match *input {
                        Input::Variable(k) => inputs[k as usize][lane],
                        Input::Uniform(_) => f64::NAN,
                    });
                    let inputs: Vec<f64> = inputs.collect();
                    let mut expected = [f64::NAN];
                    tape.eval(&mut registers, &inputs, &mut expected);
                    let [expected] = expected;
                    // Sine and cosine may differ in the last place.
                    let is_near = (found - expected).abs() <= 1e-14 * expected.abs();
                    let name = operation.name();
                    let is_wave = matches!(name, "sin" | "cos");
                    assert!(
                        same(found, expected) || is_wave && is_near,
                        "{name} of {inputs:?}: {found}, not {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn lanes_are_sets() {
    let odd = Lanes::of(|lane| lane % 2 == 1);
    assert_eq!(odd.each().collect::<Vec<_>>(), [1, 3, 5, 7]);
    let high = Lanes::of(|lane| lane > 4);
    assert_eq!((odd & high).each().collect::<Vec<_>>(), [5, 7]);
    assert_eq!(odd.without(high).each().collect::<Vec<_>>(), [1, 3]);
    assert!(odd.has(3) && !odd.has(2) && odd.any());
    let mut none = Lanes::default();
    none.add(4, false);
    assert!(!none.any() && none.each().next().is_none());
}
