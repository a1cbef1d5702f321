//! Sign changes of values along lines.
//!
//! In: a function along one line or along the lines of a block, with a part of the lines at whose ends its signs differ.
//! Out: the parameter of the change on each line, to the last bits.

use expr::Input;
use expr::processor::Processor;
use expr::tape::{Tape, VectorRegisters};
use expr::vectors::{Instructions, Lanes, MOST_LANES, Mask, Vector, VectorWork};

/// The starts and directions of the lines of a block, coordinate by coordinate.
pub(super) type LineBlock = [[[f64; MOST_LANES]; 3]; 2];

/// The changes of membership on a part of each line of a block. On the part the value, or that of the expression in a shell,
/// is monotone.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockChanges {
    /// The lines that are inside at the beginning of the part.
    pub(super) inside: Lanes,
    /// The lines on which membership changes.
    pub(super) changing: Lanes,
    /// The first parameter of a change.
    pub(super) places: [f64; MOST_LANES],
}

/// The search for changes on the lines of a block.
pub(super) struct BlockSearch<'a> {
    pub(super) tape: &'a Tape,
    /// The number for each input that is not a coordinate.
    pub(super) numbers: &'a [f64],
    pub(super) lines: &'a LineBlock,
    pub(super) part: [f64; 2],
    /// The lines for which the caller needs the changes.
    pub(super) wanted: Lanes,
    pub(super) negated: bool,
    /// The level of a shell, whose value is |u| − level.
    pub(super) level: Option<f64>,
}

impl VectorWork for BlockSearch<'_> {
    type Output = BlockChanges;

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) -> BlockChanges {
        let mut found = BlockChanges {
            inside: Lanes::default(),
            changing: Lanes::default(),
            places: [f64::NAN; MOST_LANES],
        };
        let number = |x: f64| Vector::splat(s, x);
        let zero = number(0.0);
        let mut function = TapeAlongLines {
            instructions: s,
            tape: self.tape,
            registers: VectorRegisters::new(s, self.tape),
            inputs: self.numbers.iter().map(|&x| number(x)).collect(),
            lines: [[zero; 3]; 2],
            sign: number(1.0),
            level: zero,
        };
        let [a, b] = self.part.map(number);
        let [mut is_inside, mut is_changing] = [[0.0; MOST_LANES]; 2];
        for part in 0..Vector::<S>::PARTS {
            let wanted = Mask::of(s, self.wanted, part);
            if !wanted.any() {
                continue;
            }
            for (vectors, blocks) in function.lines.iter_mut().zip(self.lines) {
                for (vector, block) in vectors.iter_mut().zip(blocks) {
                    *vector = Vector::load(s, block, part);
                }
            }
            function.sign = number(if self.negated { -1.0 } else { 1.0 });
            function.level = zero;
            let mut ends = [function.at(a), function.at(b)];
            let mut inside = ends[0].le(zero);
            let mut changes = ends[1].le(zero).differs(inside);
            if let Some(level) = self.level {
                // A rising u leaves at the level and enters at the negated level.
                let level = number(level);
                inside = (ends[0].abs() - level).le(zero);
                let falls_into_or_rises_out = !ends[0].lt(ends[1]).differs(inside);
                function.sign = falls_into_or_rises_out.choose(number(1.0), number(-1.0));
                function.level = level;
                ends = [
                    function.sign * ends[0] - level,
                    function.sign * ends[1] - level,
                ];
                let leaves = inside & zero.lt(ends[1]);
                changes = leaves | (!inside & zero.lt(ends[0]) & ends[1].le(zero));
            }
            let places = brackets(s, &mut function, [a, b], ends, inside, wanted & changes);
            places.store(&mut found.places, part);
            let (one, none) = (number(1.0), zero);
            inside.choose(one, none).store(&mut is_inside, part);
            changes.choose(one, none).store(&mut is_changing, part);
        }
        found.inside = Lanes::of(|lane| is_inside[lane] > 0.0);
        found.changing = Lanes::of(|lane| is_changing[lane] > 0.0);
        found
    }
}

/// A function along lines.
trait AlongLines<S: Instructions> {
    /// Returns its value at t on each line.
    fn at(&mut self, t: Vector<S>) -> Vector<S>;
}

/// The value u of a tape along one line for each lane of a vector, as `sign`·u − `level`.
struct TapeAlongLines<'a, S: Instructions> {
    instructions: S,
    tape: &'a Tape,
    registers: VectorRegisters<S>,
    inputs: Vec<Vector<S>>,
    lines: [[Vector<S>; 3]; 2],
    sign: Vector<S>,
    level: Vector<S>,
}

impl<S: Instructions> AlongLines<S> for TapeAlongLines<'_, S> {
    #[inline(always)]
    fn at(&mut self, t: Vector<S>) -> Vector<S> {
        let [origin, direction] = &self.lines;
        for (place, input) in self.inputs.iter_mut().zip(self.tape.inputs()) {
            if let Input::Variable(k @ 0..3) = *input {
                *place = origin[k as usize] + t * direction[k as usize];
            }
        }
        let tape = self.tape;
        let u = tape.eval_vector(self.instructions, &mut self.registers, &self.inputs);
        self.sign * u - self.level
    }
}

/// A function along one line, as one lane.
struct OneLine<'f> {
    function: &'f mut dyn FnMut(f64) -> f64,
    part: [f64; 2],
    ends: [f64; 2],
    inside: bool,
}

impl VectorWork for OneLine<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) -> f64 {
        let [part, ends] = [self.part, self.ends].map(|all| all.map(|x| Vector::splat(s, x)));
        let inside = Mask::splat(s, self.inside);
        let all = Mask::splat(s, true);
        let function = &mut OneLane(s, &mut *self.function);
        brackets(s, function, part, ends, inside, all).least_lane()
    }
}

struct OneLane<'f, S>(S, &'f mut dyn FnMut(f64) -> f64);

impl<S: Instructions> AlongLines<S> for OneLane<'_, S> {
    #[inline(always)]
    fn at(&mut self, t: Vector<S>) -> Vector<S> {
        Vector::splat(self.0, (self.1)(t.least_lane()))
    }
}

/// Returns the parameter where a function changes its sign between the ends of a part. `ends` are the values there: with
/// `inside`, the first is not positive and the second is; otherwise the reverse.
pub(super) fn bracketed(
    function: &mut dyn FnMut(f64) -> f64,
    part: [f64; 2],
    ends: [f64; 2],
    inside: bool,
) -> f64 {
    Processor::least().run_vectors(OneLine {
        function,
        part,
        ends,
        inside,
    })
}

/// Returns, for each wanted line, the parameter where a function changes its sign between `a`, where it is not positive if
/// `inside`, and `b`, where the opposite holds. The method is inverse quadratic interpolation, with bisection where that is
/// unreliable or a value is NaN (Chandrupatla, *A new hybrid quadratic/bisection algorithm for finding the zero of a
/// nonlinear function without using derivatives*, Advances in Engineering Software 28, 1997).
#[inline(always)]
fn brackets<S: Instructions>(
    s: S,
    function: &mut impl AlongLines<S>,
    [mut a, mut b]: [Vector<S>; 2],
    [mut at_a, mut at_b]: [Vector<S>; 2],
    inside: Mask<S>,
    wanted: Mask<S>,
) -> Vector<S> {
    let number = |x: f64| Vector::splat(s, x);
    let (zero, half, one) = (number(0.0), number(0.5), number(1.0));
    let (unit, normal) = (number(2.0 * f64::EPSILON), number(f64::MIN_POSITIVE));
    let mut is_a_inside = inside;
    let mut open = wanted;
    // The next point, as a fraction of the way from a to b: first that of the secant.
    let mut share = at_a / (at_a - at_b);
    for _ in 0..120 {
        let width = (b - a).abs();
        let least = unit * a.abs().greatest(b.abs()) + normal;
        open = open & (least + least).lt(width);
        if !open.any() {
            break;
        }
        // A step below the resolution would never close the bracket from the other side.
        let shortest = least / width;
        let clamped = share.greatest(shortest).least(one - shortest);
        let share_taken = share.equals(share).choose(clamped, half);
        let middle = a + share_taken * (b - a);
        let at_middle = function.at(middle);
        // The new point becomes a, and b is across the change; `before` is the remaining one of the two old points.
        let is_inside = at_middle.le(zero);
        let crosses = is_inside.differs(is_a_inside);
        let (before, at_before) = (crosses.choose(b, a), crosses.choose(at_b, at_a));
        (b, at_b) = (
            (open & crosses).choose(a, b),
            (open & crosses).choose(at_a, at_b),
        );
        (a, at_a) = (open.choose(middle, a), open.choose(at_middle, at_a));
        is_a_inside = is_inside;
        let place = (a - b) / (before - b);
        let height = (at_a - at_b) / (at_before - at_b);
        let rest = one - height;
        let is_trusted = (height * height).lt(place) & (rest * rest).lt(one - place);
        let secant = at_a / (at_b - at_a) * at_before / (at_b - at_before);
        let bend = (before - a) / (b - a) * at_a / (at_before - at_a) * at_b / (at_before - at_b);
        share = is_trusted.choose(secant + bend, half);
    }
    half * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use expr::tape::Registers;
    use expr::{Graph, ops::Unary};

    const LINES: LineBlock = [
        [
            [0.1, -0.7, 0.3, 1.1, -1.2, 0.0, 2.0, 0.5],
            [0.2, 0.9, -0.4, 0.8, 0.0, -2.0, 1.3, 0.6],
            [0.0; MOST_LANES],
        ],
        [
            [1.0, 0.6, -0.8, 0.2, 0.0, 0.7, -1.0, 0.3],
            [0.1, 0.8, 0.5, -0.9, 1.0, 0.7, 0.2, -0.6],
            [0.0; MOST_LANES],
        ],
    ];

    /// sin(2x) cos y − 0.1.
    fn waves() -> Tape {
        let mut graph = Graph::default();
        let [x, y] = [0, 1].map(|k| graph.input(Input::Variable(k)));
        let twice = graph.add(x, x);
        let (a, b) = (graph.unary(Unary::Sin, twice), graph.unary(Unary::Cos, y));
        let product = graph.mul(a, b);
        let tenth = graph.constant(0.1);
        let root = graph.sub(product, tenth);
        Tape::new(&graph, &[root])
    }

    #[test]
    fn a_block_has_the_changes_of_each_of_its_lines() {
        let tape = waves();
        let mut registers = Registers::default();
        let mut count = 0;
        for (negated, level) in [(false, None), (true, None), (false, Some(0.05))] {
            for step in 0..80 {
                let part = [0.0, 0.05].map(|t| f64::from(step) * 0.05 + t);
                for processor in [Processor::here(), Processor::least()] {
                    let wanted = Lanes::of(|lane| lane != 5);
                    let found = processor.run_vectors(BlockSearch {
                        tape: &tape,
                        numbers: &[f64::NAN; 2],
                        lines: &LINES,
                        part,
                        wanted,
                        negated,
                        level,
                    });
                    for lane in wanted.each() {
                        let mut u = |t: f64| {
                            let at = |k: usize| LINES[0][k][lane] + t * LINES[1][k][lane];
                            let mut value = [0.0];
                            tape.eval(&mut registers, &[at(0), at(1)], &mut value);
                            value[0]
                        };
                        let mut value = |t: f64| match level {
                            Some(level) => u(t).abs() - level,
                            None if negated => -u(t),
                            None => u(t),
                        };
                        let ends = part.map(&mut value);
                        let inside = ends.map(|end| end <= 0.0);
                        assert_eq!(found.inside.has(lane), inside[0]);
                        let place = found.places[lane];
                        if !found.changing.has(lane) {
                            assert_eq!(inside[0], inside[1]);
                        } else if inside[0] == inside[1] {
                            // Through a shell from one side to the other.
                            assert!(level.is_some() && value(place).abs() < 1e-14);
                        } else {
                            let expected = bracketed(&mut value, part, ends, inside[0]);
                            assert!((place - expected).abs() < 1e-14, "{place}, not {expected}");
                            count += 1;
                        }
                    }
                }
            }
        }
        assert!(count > 60, "{count}");
    }
}
