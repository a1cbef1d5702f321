//! Evaluation of fields for all rays of a bundle at once.
//!
//! In: an expression and the rays of a bundle in its coordinates. Out: the range of t divided into parts, each with what
//! interval arithmetic shows for all rays of the bundle. Most of space is decided once for the bundle instead of once for
//! each ray; a part on which the value is monotone along each ray needs only the signs at its ends.

use expr::interval::{Interval, Slope};
use expr::ops::Binary;
use expr::tape::LineInput;
use expr::vectors::{Lanes, MOST_LANES};
use glam::DVec3;

use crate::field::crossings::{BlockChanges, BlockSearch, LineBlock};
use crate::field::{Field, FieldScratch, Line};

/// A part of a range of t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BundlePart {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) kind: PartKind,
}

impl BundlePart {
    /// Returns a part about which nothing is known.
    pub(crate) fn open(from: f64, to: f64) -> Self {
        Self {
            from,
            to,
            kind: PartKind::Open,
        }
    }
}

/// The kind of a part, for each ray.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum PartKind {
    /// The value is positive or undefined throughout.
    Outside,
    /// The value is defined and not positive throughout.
    Inside,
    /// The value is defined, continuous and strictly monotone; of a shell, that of the expression in it.
    Monotone,
    /// The part is too short to be halved.
    Shortest,
    Open,
    /// Open for the bundle; the kinds for its lines are computed together at this node.
    Shared(u32),
}

/// A range of t for the lines of a bundle.
#[derive(Clone, Debug)]
pub(crate) struct DividedBundle {
    /// In ascending order, with the kind for all lines.
    pub(crate) parts: Vec<BundlePart>,
    lines: Vec<LineBlock>,
    nodes: Vec<LineNode>,
}

/// A part of the range that is open for the bundle.
#[derive(Clone, Debug)]
struct LineNode {
    from: f64,
    to: f64,
    depth: u32,
    /// For each block of lines, the kinds for them, computed on demand.
    found: Vec<Option<[Option<PartKind>; MOST_LANES]>>,
    /// For each block of lines, the changes on those with monotone values, computed on demand.
    changes: Vec<Option<BlockChanges>>,
    /// The first of its halves, created on demand; the second one follows it.
    halves: Option<u32>,
}

/// The maximum number of times that a part is halved for all lines.
const MOST_HALVINGS: u32 = 6;

impl DividedBundle {
    /// Returns a division about which nothing is known.
    pub(crate) fn unknown() -> Self {
        Self {
            parts: Vec::new(),
            lines: Vec::new(),
            nodes: Vec::new(),
        }
    }

    fn add_node(&mut self, [from, to]: [f64; 2], depth: u32) -> u32 {
        self.nodes.push(LineNode {
            from,
            to,
            depth,
            found: vec![None; self.lines.len()],
            changes: vec![None; self.lines.len()],
            halves: None,
        });
        (self.nodes.len() - 1) as u32
    }

    /// Returns the kind of a node for a line; `None` if it is open.
    pub(crate) fn kind(
        &mut self,
        field: &Field,
        scratch: &mut FieldScratch,
        node: u32,
        line: usize,
    ) -> Option<PartKind> {
        let node = &mut self.nodes[node as usize];
        let (block, lane) = (line / MOST_LANES, line % MOST_LANES);
        scratch.evaluations += 1;
        let found = node.found[block].get_or_insert_with(|| {
            let [origins, directions] = &self.lines[block];
            let coordinates = [0, 1, 2].map(|k| LineInput::Coordinate {
                origin: &origins[k],
                direction: &directions[k],
            });
            let part = [[node.from; MOST_LANES], [node.to; MOST_LANES]];
            let ranges = field.in_vectors(scratch, coordinates, &part);
            ranges.map(|range| range.and_then(|range| field.kind(range)))
        });
        found[lane]
    }

    /// Returns the membership of a line at the beginning of a node on which the value is monotone, and the point where it
    /// changes in the node.
    pub(crate) fn change(
        &mut self,
        field: &Field,
        scratch: &mut FieldScratch,
        node: u32,
        line: usize,
    ) -> (bool, Option<f64>) {
        let node = &mut self.nodes[node as usize];
        let (block, lane) = (line / MOST_LANES, line % MOST_LANES);
        let found = node.found[block];
        let is_monotone = |lane| found.is_some_and(|found| found[lane] == Some(PartKind::Monotone));
        let changes = node.changes[block].get_or_insert_with(|| {
            field.changes(
                scratch,
                &self.lines[block],
                [node.from, node.to],
                Lanes::of(is_monotone),
            )
        });
        let place = changes.changing.has(lane).then(|| changes.places[lane]);
        (changes.inside.has(lane), place)
    }

    /// Returns the membership of a line throughout the part that contains the parameter `place`, if it is constant there.
    pub(crate) fn membership(
        &mut self,
        field: &Field,
        scratch: &mut FieldScratch,
        line: usize,
        place: f64,
    ) -> Option<bool> {
        let part = self
            .parts
            .iter()
            .find(|part| part.from <= place && place < part.to)?;
        let kind = match part.kind {
            PartKind::Shared(node) => self.kind(field, scratch, node, line)?,
            kind => kind,
        };
        match kind {
            PartKind::Inside => Some(true),
            PartKind::Outside => Some(false),
            _ => None,
        }
    }

    /// Returns the range of a node.
    pub(crate) fn range(&self, node: u32) -> [f64; 2] {
        let node = &self.nodes[node as usize];
        [node.from, node.to]
    }

    /// Returns both halves of a node, with their ranges; `None` if the lines are to be continued one by one.
    pub(crate) fn halves(&mut self, node: u32) -> Option<[BundlePart; 2]> {
        let LineNode {
            from,
            to,
            depth,
            halves,
            ..
        } = self.nodes[node as usize];
        let middle = 0.5 * (from + to);
        if depth == MOST_HALVINGS || !(from < middle && middle < to) {
            return None;
        }
        let first = halves.unwrap_or_else(|| {
            let first = self.add_node([from, middle], depth + 1);
            self.add_node([middle, to], depth + 1);
            self.nodes[node as usize].halves = Some(first);
            first
        });
        let part = |from: f64, to: f64, node: u32| BundlePart {
            from,
            to,
            kind: PartKind::Shared(node),
        };
        Some([part(from, middle, first), part(middle, to, first + 1)])
    }
}

/// Rays in the coordinates of a field: intervals that contain their starts and directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LineBundle {
    origin: [Interval; 3],
    direction: [Interval; 3],
}

/// The maximum number of evaluations for a bundle and a field.
const MOST_EVALUATIONS: usize = 128;

/// The cost of finding the change on a line, about eight evaluations on numbers, in evaluations on intervals.
const BRACKETING: usize = 2;

impl LineBundle {
    /// Returns the bounds of these lines.
    pub(crate) fn new(lines: impl Iterator<Item = Line>) -> Self {
        let mut bundle = Self {
            origin: [Interval::UNDEFINED; 3],
            direction: [Interval::UNDEFINED; 3],
        };
        let [mut least, mut most] = [[f64::INFINITY; 6], [f64::NEG_INFINITY; 6]];
        for line in lines {
            let all = line.origin.to_array().into_iter();
            for (k, x) in all.chain(line.direction.to_array()).enumerate() {
                least[k] = least[k].min(x);
                most[k] = most[k].max(x);
            }
        }
        for k in 0..3 {
            bundle.origin[k] = Interval::new(least[k], most[k]);
            bundle.direction[k] = Interval::new(least[k + 3], most[k + 3]);
        }
        bundle
    }

    fn coordinate(&self, k: usize, t: Interval) -> Slope {
        let step = Interval::binary(Binary::Mul, t, self.direction[k]);
        Slope {
            value: Interval::binary(Binary::Add, self.origin[k], step),
            slope: self.direction[k],
        }
    }

    /// Returns true if the part is shorter than the bundle is wide: dividing it further gains little.
    fn is_wider_than(&self, [a, b]: [f64; 2]) -> bool {
        let middle = 0.5 * (a + b).abs();
        let (mut width, mut length) = (0.0f64, 0.0f64);
        for (origin, direction) in self.origin.iter().zip(&self.direction) {
            width = width.max(origin.width() + middle * direction.width());
            length = length.max(direction.lower().abs().max(direction.upper().abs()));
        }
        (b - a) * length <= 0.5 * width
    }
}

impl Field {
    /// Returns the changes on the lines of a block; only lines with a monotone value are `wanted`.
    fn changes(
        &self,
        scratch: &mut FieldScratch,
        lines: &LineBlock,
        part: [f64; 2],
        wanted: Lanes,
    ) -> BlockChanges {
        let tape = self.tape();
        self.inputs(tape, DVec3::NAN, &mut scratch.numbers);
        scratch.work.take(MOST_LANES * BRACKETING, self.work);
        scratch.processor.run_vectors(BlockSearch {
            tape,
            numbers: &scratch.numbers,
            lines,
            part,
            wanted,
            negated: self.negated,
            level: self.shell.as_ref().map(|shell| shell.level),
        })
    }

    /// Divides the range for lines with similar directions.
    pub(crate) fn divided(
        &self,
        scratch: &mut FieldScratch,
        lines: impl Iterator<Item = Line> + Clone,
        range: [f64; 2],
    ) -> DividedBundle {
        let mut divided = DividedBundle::unknown();
        divided.parts = self.divide(scratch, &LineBundle::new(lines.clone()), range);
        if !self.is_of_vectors {
            return divided;
        }
        for (k, line) in lines.enumerate() {
            let lane = k % MOST_LANES;
            let all = [line.origin, line.direction].map(|v| v.to_array());
            if lane == 0 {
                divided.lines.push(all.map(|v| v.map(|x| [x; MOST_LANES])));
            } else if let Some(block) = divided.lines.last_mut() {
                for (lanes, x) in block.as_flattened_mut().iter_mut().zip(all.as_flattened()) {
                    lanes[lane] = *x;
                }
            }
        }
        for k in 0..divided.parts.len() {
            let BundlePart { from, to, kind } = divided.parts[k];
            if matches!(kind, PartKind::Open | PartKind::Monotone) {
                let node = divided.add_node([from, to], 0);
                divided.parts[k].kind = PartKind::Shared(node);
                if kind == PartKind::Monotone {
                    let found = &mut divided.nodes[node as usize].found;
                    found.fill(Some([Some(kind); MOST_LANES]));
                }
            }
        }
        divided
    }

    /// Divides the range into parts, in ascending order.
    fn divide(
        &self,
        scratch: &mut FieldScratch,
        bundle: &LineBundle,
        [from, to]: [f64; 2],
    ) -> Vec<BundlePart> {
        let at_once = match self.is_of_vectors {
            true => MOST_LANES,
            false => 1,
        };
        let halves = |[a, b]: [f64; 2]| {
            let middle = 0.5 * (a + b);
            [[a, middle], [middle, b]]
        };
        let mut open = vec![[from, to]];
        while open.len() < at_once && !bundle.is_wider_than(open[0]) {
            open = open.into_iter().flat_map(halves).collect();
        }
        let mut found: Vec<BundlePart> = Vec::new();
        let mut budget = MOST_EVALUATIONS;
        while !open.is_empty() {
            let parts = open.split_off(open.len().saturating_sub(at_once));
            let is_known = budget > 0;
            let ranges = match is_known {
                true => self.ranges_of_bundle(scratch, bundle, &parts),
                false => [None; MOST_LANES],
            };
            budget = budget.saturating_sub(parts.len());
            for ([a, b], range) in parts.into_iter().zip(ranges) {
                let kind = range.and_then(|range| self.kind(range));
                let goes_on = is_known && !bundle.is_wider_than([a, b]) && b - a > 0.0;
                if kind.is_none() && goes_on {
                    open.extend(halves([a, b]));
                    continue;
                }
                found.push(BundlePart {
                    from: a,
                    to: b,
                    kind: kind.unwrap_or(PartKind::Open),
                });
            }
        }
        found.sort_unstable_by(|a, b| a.from.total_cmp(&b.from));
        // Neighbouring parts with the same decision, or both open, are merged.
        found.dedup_by(|part, last| {
            let is_one = part.kind == last.kind && part.kind != PartKind::Monotone;
            if is_one {
                last.to = part.to;
            }
            is_one
        });
        found
    }

    /// Returns the values and slopes of all lines on some parts: at least one, and at most one for each lane of a vector.
    fn ranges_of_bundle(
        &self,
        scratch: &mut FieldScratch,
        bundle: &LineBundle,
        parts: &[[f64; 2]],
    ) -> [Option<Slope>; MOST_LANES] {
        if let [[a, b]] = *parts {
            let part = Interval::new(a, b);
            let mut found = [None; MOST_LANES];
            found[0] = Some(self.range(scratch, &|k| bundle.coordinate(k, part)));
            return found;
        }
        scratch.evaluations += parts.len() as u64;
        let last = parts.len() - 1;
        let mut t = [[0.0; MOST_LANES]; 2];
        for lane in 0..MOST_LANES {
            [t[0][lane], t[1][lane]] = parts[lane.min(last)];
        }
        let coordinates = [0, 1, 2].map(|k| {
            let bounds = |interval: Interval| [interval.lower(), interval.upper()];
            LineInput::Bundle {
                origin: bounds(bundle.origin[k]),
                direction: bounds(bundle.direction[k]),
            }
        });
        self.in_vectors(scratch, coordinates, &t)
    }
}
