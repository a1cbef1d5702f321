//! Expressions that are not polynomials: where a ray enters and leaves the set on which such an expression is not positive.
//!
//! In: an expression, and segments of rays in its own coordinates. Out: the points where membership changes. A part of a
//! segment on which interval arithmetic shows the value to be positive, or defined and not positive, has none; a part on
//! which it shows the slope to exclude 0 has at most one, which a bracketed secant method finds. Any other part is halved,
//! down to the resolution of t; a jump or the end of a domain there is a change if membership differs at the ends. The work
//! on a ray is limited; once the limit is reached, the rest of the segment is sampled.

use std::cell::RefCell;
use std::sync::Arc;

use crossings::bracketed;
use expr::interval::{Interval, Slope};
use expr::processor::Processor;
use expr::tape::{LineInput, Registers, Tape};
use expr::vectors::MOST_LANES;
use expr::{Graph, Input, NodeId, TooLarge};
use glam::DVec3;
use rustc_hash::FxHashMap;
use shell::Shell;

mod bundle;
mod crossings;
mod shell;
pub(crate) use bundle::{BundlePart, DividedBundle, PartKind};

/// The maximum number of interval evaluations for a ray: enough for some thousand crossings of a function. Beyond it, the
/// rest of the ray is sampled.
pub const MOST_RAY_EVALUATIONS: usize = 1 << 15;
/// The average number of operations on functions, on intervals and numbers, for each ray of a tile of a picture, including
/// all secondary rays. Beyond it, rays are sampled; beyond twice this number, they do not meet the surfaces of functions.
pub const TILE_RAY_OPERATIONS: u64 = 1 << 16;
/// The number of samples of a segment once the evaluations are used up.
const SAMPLES: usize = 64;
/// Parts shorter than this fraction of 1 + t are not halved.
const RESOLUTION: f64 = 1e-13;

/// An expression with its gradient, compiled once for all instances of an object.
#[derive(Debug)]
struct FieldCode {
    value: Tape,
    gradient: Tape,
    inputs: Vec<Input>,
    /// A graph of the expression alone.
    graph: Graph,
    root: NodeId,
}

/// The expressions of a graph, each compiled once.
#[derive(Debug)]
pub(crate) struct FieldCompiler<'g> {
    pub(crate) graph: &'g Graph,
    codes: RefCell<FxHashMap<NodeId, Arc<FieldCode>>>,
}

impl<'g> FieldCompiler<'g> {
    /// Creates a compiler of expressions of a graph.
    pub(crate) fn new(graph: &'g Graph) -> Self {
        Self {
            graph,
            codes: RefCell::default(),
        }
    }

    fn code(&self, root: NodeId) -> Result<Arc<FieldCode>, TooLarge> {
        if let Some(code) = self.codes.borrow().get(&root) {
            return Ok(code.clone());
        }
        let (mut graph, roots) = self.graph.extract(&[root]);
        let mut gradient = Vec::new();
        for k in 0..3 {
            gradient.extend(graph.derivatives(&roots, Input::Variable(k))?);
        }
        let code = Arc::new(FieldCode {
            value: Tape::new(&graph, &roots),
            gradient: Tape::new(&graph, &gradient),
            inputs: graph.inputs(&roots),
            root: roots[0],
            graph,
        });
        self.codes.borrow_mut().insert(root, code.clone());
        Ok(code)
    }
}

/// An expression with its gradient and the values of its uniforms.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    code: Arc<FieldCode>,
    uniforms: Vec<(Input, f64)>,
    /// True if the set is that on which the negated expression is not positive.
    negated: bool,
    /// The expression as a shell, if it has that form.
    shell: Option<Shell>,
    /// True if intervals of its values are computed in vectors.
    is_of_vectors: bool,
    /// The work of an evaluation, in operations.
    work: u64,
}

/// Returns the kind of an open part that is too short to be halved.
fn shortest([a, b]: [f64; 2]) -> Option<PartKind> {
    let is_short = b - a <= RESOLUTION * (1.0 + a.abs().max(b.abs()));
    is_short.then_some(PartKind::Shortest)
}

/// A ray in the field's coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

/// Memory for evaluations; each thread needs its own.
#[derive(Debug, Default)]
pub(crate) struct FieldScratch {
    registers: Registers,
    numbers: Vec<f64>,
    slopes: Vec<Slope>,
    intervals: Vec<Interval>,
    processor: Processor,
    /// The parts of a segment, the first part last.
    parts: Vec<BundlePart>,
    work: FieldWork,
    /// The number of interval evaluations so far.
    pub(crate) evaluations: u64,
    /// The number of rays before this one that were cut short.
    cut_short: u64,
}

/// The remaining work for a ray, and for the rays of its tile.
#[derive(Debug)]
struct FieldWork {
    /// The remaining interval evaluations of the ray.
    evaluations: usize,
    /// True if a part of the ray was not divided as far as necessary.
    is_cut_short: bool,
    /// The remaining operations for the rays of the tile: on intervals, and after those on samples.
    intervals: u64,
    samples: u64,
    /// The number of operations so far.
    done: u64,
}

/// The cost of an evaluation on a single interval, and on a single number, in evaluations on vectors of intervals.
const ALONE: usize = 2 * MOST_LANES;
const PLAIN: usize = 2;
/// The overhead of an evaluation, in operations.
const EVALUATION: u64 = 8;

impl Default for FieldWork {
    fn default() -> Self {
        Self {
            evaluations: MOST_RAY_EVALUATIONS,
            is_cut_short: false,
            intervals: u64::MAX,
            samples: u64::MAX,
            done: 0,
        }
    }
}

impl FieldWork {
    /// Consumes the work of this number of vector evaluations; `work` is that of one.
    fn take(&mut self, evaluations: usize, work: u64) {
        let operations = evaluations as u64 * (work + EVALUATION);
        self.done += operations;
        let rest = operations.saturating_sub(self.intervals);
        self.intervals = self.intervals.saturating_sub(operations);
        self.samples = self.samples.saturating_sub(rest);
    }
}

impl FieldScratch {
    /// Begins a ray.
    pub(crate) fn begin(&mut self) {
        self.cut_short = self.cut_short();
        self.work.evaluations = MOST_RAY_EVALUATIONS;
        self.work.is_cut_short = false;
    }

    /// Limits the further operations: this number on intervals, and the same number on samples.
    pub(crate) fn limit(&mut self, operations: u64) {
        (self.work.intervals, self.work.samples) = (operations, operations);
    }

    /// Returns the number of rays of which a part was not divided as far as necessary, so that a crossing may be missing.
    pub(crate) fn cut_short(&self) -> u64 {
        self.cut_short + u64::from(self.work.is_cut_short)
    }

    /// Returns the number of operations so far.
    pub(crate) fn operations(&self) -> u64 {
        self.work.done
    }

    /// Sets the parts of a segment: these where they lie in it, and open ones before and after them.
    fn restrict(&mut self, parts: &[BundlePart], [from, to]: [f64; 2]) {
        self.parts.clear();
        let mut begin = to;
        for part in parts.iter().rev() {
            let [a, b] = [part.from.max(from), part.to.min(to)];
            if a < b {
                if self.parts.is_empty() && b < to {
                    self.parts.push(BundlePart::open(b, to));
                }
                self.parts.push(BundlePart {
                    from: a,
                    to: b,
                    ..*part
                });
                begin = a;
            }
        }
        if begin > from {
            self.parts.push(BundlePart::open(from, begin));
        }
    }

    /// Returns true if fields are still evaluated.
    pub(crate) fn may_evaluate(&mut self) -> bool {
        self.work.is_cut_short |= self.work.samples == 0;
        self.work.samples > 0
    }
}

impl Line {
    fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

impl Field {
    pub(crate) fn new(
        compiler: &FieldCompiler<'_>,
        root: NodeId,
        negated: bool,
        uniform: &dyn Fn(Input) -> f64,
    ) -> Result<Self, TooLarge> {
        let code = compiler.code(root)?;
        let inputs = code.inputs.iter();
        let shell = match negated {
            true => None,
            false => Shell::new(&code.graph, code.root, uniform),
        };
        let tape = shell.as_ref().map_or(&code.value, |shell| &shell.inner);
        Ok(Self {
            is_of_vectors: tape.is_of_vectors(),
            work: tape.work(),
            shell,
            uniforms: inputs.map(|&input| (input, uniform(input))).collect(),
            negated,
            code,
        })
    }

    /// Returns the expression in the variables 0, 1, 2 and uniforms, with its graph.
    pub(crate) fn expression(&self) -> (&Graph, NodeId) {
        (&self.code.graph, self.code.root)
    }

    /// Returns the work of an evaluation of its value, in operations.
    pub(crate) fn value_work(&self) -> u64 {
        self.code.value.work()
    }

    /// Returns true if the set is that on which the negated expression is not positive.
    pub(crate) fn is_negated(&self) -> bool {
        self.negated
    }

    /// Returns the bits of the uniforms that it reads, in the order of the uniforms.
    pub(crate) fn uniform_bits(&self) -> Vec<u64> {
        let uniforms = self.uniforms.iter();
        let own = uniforms.filter(|(input, _)| matches!(input, Input::Uniform(_)));
        own.map(|(_, value)| value.to_bits()).collect()
    }

    /// Returns the value at a point; NaN where it is undefined.
    pub(crate) fn value(&self, scratch: &mut FieldScratch, at: DVec3) -> f64 {
        let mut out = [f64::NAN];
        scratch.work.take(PLAIN, self.work);
        self.inputs(&self.code.value, at, &mut scratch.numbers);
        self.code
            .value
            .eval(&mut scratch.registers, &scratch.numbers, &mut out);
        if self.negated { -out[0] } else { out[0] }
    }

    /// Returns the gradient at a point.
    pub(crate) fn gradient(&self, scratch: &mut FieldScratch, at: DVec3) -> DVec3 {
        let mut out = [f64::NAN; 3];
        self.inputs(&self.code.gradient, at, &mut scratch.numbers);
        self.code
            .gradient
            .eval(&mut scratch.registers, &scratch.numbers, &mut out);
        let gradient = DVec3::from_array(out);
        if self.negated { -gradient } else { gradient }
    }

    /// Returns the membership immediately after the start of a part of a line, and the parameter at which the search for
    /// changes begins. With `leaving`, the line leaves the surface at `from` and does not meet it again there. `bundle` is as
    /// for [`Field::next_change`].
    pub(crate) fn start(
        &self,
        scratch: &mut FieldScratch,
        line: &Line,
        [from, to]: [f64; 2],
        leaving: bool,
        bundle: Option<(&mut DividedBundle, usize)>,
    ) -> (bool, f64) {
        if !leaving {
            let inside =
                bundle.and_then(|(bundle, line)| bundle.membership(self, scratch, line, from));
            let inside = inside.unwrap_or_else(|| self.value(scratch, line.at(from)) <= 0.0);
            return (inside, from);
        }
        let slope = self.gradient(scratch, line.at(from)).dot(line.direction);
        (slope < 0.0, self.departure(scratch, line, from, to))
    }

    /// Returns the first parameter in (from, to] where membership changes, `inside` being the membership immediately after
    /// `from`, and the parameter at which the search for the next change begins. `bundle` is the line's bundle, with the
    /// line's index in it.
    pub(crate) fn next_change(
        &self,
        scratch: &mut FieldScratch,
        line: &Line,
        [from, to]: [f64; 2],
        inside: bool,
        mut bundle: Option<(&mut DividedBundle, usize)>,
    ) -> Option<(f64, f64)> {
        let parts = bundle.as_ref().map_or(&[][..], |(it, _)| &it.parts);
        scratch.restrict(parts, [from, to]);
        while let Some(part) = scratch.parts.pop() {
            let change = match part.kind {
                PartKind::Outside | PartKind::Inside => {
                    // The membership is constant on the part; a change between two parts is at their common end.
                    let changes = (part.kind == PartKind::Inside) != inside;
                    changes.then(|| (part.from, part.from.max(from).next_up()))
                }
                PartKind::Monotone | PartKind::Shortest => {
                    self.only_change(scratch, line, part, inside)
                }
                PartKind::Shared(node) => match &mut bundle {
                    Some((bundle, line)) => {
                        self.change_in_node(scratch, (bundle, *line), node, part, inside)
                    }
                    None => {
                        scratch.parts.push(BundlePart::open(part.from, part.to));
                        None
                    }
                },
                PartKind::Open => {
                    if scratch.work.evaluations == 0 || scratch.work.intervals == 0 {
                        scratch.work.is_cut_short = true;
                        return self.sampled(scratch, line, [part.from, to], inside);
                    }
                    self.divide_part(scratch, line, [part.from, part.to]);
                    None
                }
            };
            if change.is_some() {
                return change;
            }
        }
        None
    }

    /// Returns the change on a part with at most one, as [`Field::next_change`] does.
    fn only_change(
        &self,
        scratch: &mut FieldScratch,
        line: &Line,
        part: BundlePart,
        inside: bool,
    ) -> Option<(f64, f64)> {
        let [a, b] = [part.from, part.to];
        if part.kind == PartKind::Monotone
            && let Some(shell) = &self.shell
        {
            let t = self.level_crossing(scratch, shell, line, [a, b], inside)?;
            return Some((t, t.next_up()));
        }
        let at_b = self.value(scratch, line.at(b));
        ((at_b <= 0.0) != inside).then(|| (self.between(scratch, line, [a, b], at_b, inside), b))
    }

    /// Returns the change on a part of a node of the line's bundle, if the node has it; otherwise the part, or its halves,
    /// are examined next.
    fn change_in_node(
        &self,
        scratch: &mut FieldScratch,
        (bundle, line): (&mut DividedBundle, usize),
        node: u32,
        part: BundlePart,
        inside: bool,
    ) -> Option<(f64, f64)> {
        let [a, b] = [part.from, part.to];
        if let Some(kind) = bundle.kind(self, scratch, node, line) {
            if kind == PartKind::Monotone && bundle.range(node) == [a, b] {
                let (starts_inside, place) = bundle.change(self, scratch, node, line);
                if starts_inside == inside {
                    let is_shell = self.shell.is_some();
                    return place.map(|t| (t, if is_shell { t.next_up() } else { b }));
                }
            }
            scratch.parts.push(BundlePart { kind, ..part });
        } else if let Some(halves) = bundle.halves(node) {
            for half in halves.into_iter().rev() {
                let (from, to) = (half.from.max(a), half.to.min(b));
                if from < to {
                    scratch.parts.push(BundlePart { from, to, ..half });
                }
            }
        } else {
            scratch.parts.push(BundlePart::open(a, b));
        }
        None
    }

    /// Evaluates an open part, or the parts that it is divided into; those that remain open are halved next.
    fn divide_part(&self, scratch: &mut FieldScratch, line: &Line, [a, b]: [f64; 2]) {
        if self.is_of_vectors {
            return self.find_in_parts(scratch, line, [a, b]);
        }
        scratch.work.evaluations -= 1;
        let range = self.range_on(scratch, line, [a, b]);
        let found = self.kind(range);
        if let Some(kind) = found.or(shortest([a, b])) {
            scratch.parts.push(BundlePart {
                from: a,
                to: b,
                kind,
            });
        } else {
            let middle = 0.5 * (a + b);
            scratch.parts.push(BundlePart::open(middle, b));
            scratch.parts.push(BundlePart::open(a, middle));
        }
    }

    /// Determines the kinds of parts of a part, about one for each lane of a vector.
    fn find_in_parts(&self, scratch: &mut FieldScratch, line: &Line, [a, b]: [f64; 2]) {
        let mut ends = [a; MOST_LANES + 1];
        ends[MOST_LANES] = b;
        let mut step = MOST_LANES;
        while step > 1 {
            for k in (0..MOST_LANES).step_by(step) {
                ends[k + step / 2] = 0.5 * (ends[k] + ends[k + step]);
            }
            step /= 2;
        }
        let mut t = [[0.0; MOST_LANES]; 2];
        t[0].copy_from_slice(&ends[..MOST_LANES]);
        t[1].copy_from_slice(&ends[1..]);
        scratch.work.evaluations = scratch.work.evaluations.saturating_sub(MOST_LANES);
        let ranges = self.ranges_on(scratch, line, &t);
        for lane in (0..MOST_LANES).rev() {
            let [from, to] = [t[0][lane], t[1][lane]];
            if from < to {
                let range = match ranges[lane] {
                    Some(range) => range,
                    None => self.range_on(scratch, line, [from, to]),
                };
                let found = self.kind(range).or(shortest([from, to]));
                scratch.parts.push(BundlePart {
                    from,
                    to,
                    kind: found.unwrap_or(PartKind::Open),
                });
            }
        }
    }

    /// Returns the first change between samples.
    fn sampled(
        &self,
        scratch: &mut FieldScratch,
        line: &Line,
        [from, to]: [f64; 2],
        inside: bool,
    ) -> Option<(f64, f64)> {
        let step = (to - from) / SAMPLES as f64;
        for k in 0..SAMPLES {
            if !scratch.may_evaluate() {
                break;
            }
            let [a, b] = [k, k + 1].map(|k| from + k as f64 * step);
            let at_b = self.value(scratch, line.at(b));
            if (at_b <= 0.0) != inside {
                return Some((self.between(scratch, line, [a, b], at_b, inside), b));
            }
        }
        None
    }

    /// Returns the kind of a part on which value and slope have this range; `None` if it is open.
    fn kind(&self, range: Slope) -> Option<PartKind> {
        if let Some(shell) = &self.shell {
            return shell.kind(range);
        }
        let value = range.value;
        if value.is_empty() || value.lower() > 0.0 {
            Some(PartKind::Outside)
        } else if value.upper() <= 0.0 && !value.is_partial() {
            Some(PartKind::Inside)
        } else {
            range.is_monotone().then_some(PartKind::Monotone)
        }
    }

    /// Returns the first point of a part at which the expression in a shell, monotone there, crosses a level.
    fn level_crossing(
        &self,
        scratch: &mut FieldScratch,
        shell: &Shell,
        line: &Line,
        [a, b]: [f64; 2],
        inside: bool,
    ) -> Option<f64> {
        let mut inner = |t: f64| {
            let mut out = [f64::NAN];
            self.inputs(&shell.inner, line.at(t), &mut scratch.numbers);
            shell
                .inner
                .eval(&mut scratch.registers, &scratch.numbers, &mut out);
            out[0]
        };
        let crossing = shell.crossing([a, b].map(&mut inner), inside)?;
        let mut value = |t: f64| crossing.sign * inner(t) - shell.level;
        Some(bracketed(&mut value, [a, b], crossing.ends, inside))
    }

    /// Returns an interval that contains the values on a box.
    pub(crate) fn on_box(&self, scratch: &mut FieldScratch, sides: [Interval; 3]) -> Interval {
        scratch.intervals.clear();
        for input in self.code.value.inputs() {
            scratch.intervals.push(match *input {
                Input::Variable(k @ 0..3) => sides[k as usize],
                input => Interval::point(self.uniform(input)),
            });
        }
        let mut out = [Interval::WHOLE];
        self.code
            .value
            .eval_intervals(&mut scratch.registers, &scratch.intervals, &mut out);
        if self.negated {
            Interval::unary(expr::ops::Unary::Neg, out[0])
        } else {
            out[0]
        }
    }

    /// Returns the end of a part from `from` on in which the value is monotone, so that the line does not meet the surface
    /// again there.
    fn departure(&self, scratch: &mut FieldScratch, line: &Line, from: f64, to: f64) -> f64 {
        let is_monotone = |range: Slope| match &self.shell {
            Some(shell) => shell.is_monotone(range),
            None => range.is_monotone(),
        };
        let shortest = RESOLUTION * (1.0 + from.abs());
        let mut length = to - from;
        while length > shortest {
            if self.is_of_vectors {
                let ends = std::array::from_fn(|k| from + length * 0.5f64.powi(k as i32));
                let ranges = self.ranges_on(scratch, line, &[[from; MOST_LANES], ends]);
                let found = ranges
                    .iter()
                    .zip(ends)
                    .find(|(range, _)| range.is_some_and(is_monotone));
                if let Some((_, end)) = found {
                    return end;
                }
                length *= 0.5f64.powi(MOST_LANES as i32);
            } else {
                let range = self.range_on(scratch, line, [from, from + length]);
                if is_monotone(range) {
                    return from + length;
                }
                length *= 0.5;
            }
        }
        from + length
    }

    /// Returns the expression that is evaluated on intervals: for a shell, the expression in it.
    fn tape(&self) -> &Tape {
        let shell = self.shell.as_ref();
        shell.map_or(&self.code.value, |shell| &shell.inner)
    }

    /// Returns the values and slopes on the lines of a block; `coordinates` gives x, y and z for t in `t`. The result is
    /// `None` where they are unbounded.
    fn in_vectors(
        &self,
        scratch: &mut FieldScratch,
        coordinates: [LineInput<'_>; 3],
        t: &[[f64; MOST_LANES]; 2],
    ) -> [Option<Slope>; MOST_LANES] {
        let tape = self.tape();
        scratch.work.take(MOST_LANES, self.work);
        let input = |input: &Input| match *input {
            Input::Variable(k @ 0..3) => coordinates[k as usize],
            input => LineInput::Number(self.uniform(input)),
        };
        let inputs: Vec<LineInput<'_>> = tape.inputs().iter().map(input).collect();
        let mut ranges = tape.eval_slopes_on_lines(scratch.processor, &inputs, t);
        if self.negated {
            for range in ranges.iter_mut().flatten() {
                *range = Slope::unary(expr::ops::Unary::Neg, *range);
            }
        }
        ranges
    }

    /// Returns the values and slopes on parts of a line, each given by its two ends.
    fn ranges_on(
        &self,
        scratch: &mut FieldScratch,
        line: &Line,
        t: &[[f64; MOST_LANES]; 2],
    ) -> [Option<Slope>; MOST_LANES] {
        scratch.evaluations += MOST_LANES as u64;
        let lines = [line.origin, line.direction].map(|v| v.to_array().map(|x| [x; MOST_LANES]));
        let [origins, directions] = &lines;
        let coordinates = [0, 1, 2].map(|k| LineInput::Coordinate {
            origin: &origins[k],
            direction: &directions[k],
        });
        self.in_vectors(scratch, coordinates, t)
    }

    /// Returns the value and the slope on a part of a line.
    fn range_on(&self, scratch: &mut FieldScratch, line: &Line, [a, b]: [f64; 2]) -> Slope {
        let t = Interval::new(a, b);
        self.range(scratch, &|k| {
            Slope::line(line.origin[k], line.direction[k], t)
        })
    }

    /// Returns the values and slopes; `coordinate` gives those of x, y and z. For a shell, they are those of the expression
    /// in it.
    fn range(&self, scratch: &mut FieldScratch, coordinate: &dyn Fn(usize) -> Slope) -> Slope {
        let tape = self.tape();
        scratch.evaluations += 1;
        scratch.work.take(ALONE, self.work);
        scratch.slopes.clear();
        for input in tape.inputs() {
            scratch.slopes.push(match *input {
                Input::Variable(k @ 0..3) => coordinate(k as usize),
                input => Slope::constant(self.uniform(input)),
            });
        }
        let mut out = [Slope::constant(f64::NAN)];
        tape.eval_slopes(&mut scratch.registers, &scratch.slopes, &mut out);
        if self.negated {
            out[0] = Slope::unary(expr::ops::Unary::Neg, out[0]);
        }
        out[0]
    }

    /// Returns the change between `a`, where membership is `inside`, and `b`, where it is the opposite and the value is
    /// `at_b`.
    fn between(
        &self,
        scratch: &mut FieldScratch,
        line: &Line,
        [a, b]: [f64; 2],
        at_b: f64,
        inside: bool,
    ) -> f64 {
        let at_a = self.value(scratch, line.at(a));
        let mut value = |t: f64| self.value(scratch, line.at(t));
        bracketed(&mut value, [a, b], [at_a, at_b], inside)
    }

    /// Returns the number of a uniform that it reads.
    pub(crate) fn uniform(&self, input: Input) -> f64 {
        let found = self.uniforms.iter().find(|(other, _)| *other == input);
        found.map_or(f64::NAN, |(_, value)| *value)
    }

    fn inputs(&self, tape: &Tape, at: DVec3, numbers: &mut Vec<f64>) {
        numbers.clear();
        for input in tape.inputs() {
            numbers.push(match *input {
                Input::Variable(k @ 0..3) => at[k as usize],
                input => self.uniform(input),
            });
        }
    }
}
