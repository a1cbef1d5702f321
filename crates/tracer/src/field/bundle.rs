//! Rays that go nearly the same way, read together.
//!
//! Input: an expression and the rays of a bundle in its coordinates. Output: the range of t divided into parts, each with
//! what interval arithmetic shows for all rays of the bundle at once. Most of space is decided once for a bundle in place of
//! once for each ray, and a part on which the value is monotone along each ray needs nothing but the signs at its ends.

use expr::interval::{Interval, Slope};
use expr::ops::Binary;
use expr::tape::LineInput;
use expr::vectors::MOST_LANES;

use crate::field::{Field, FieldScratch, Line};

/// A part of a range of t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BundlePart {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) finding: PartFinding,
}

/// The knowledge about a part, for each ray.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum PartFinding {
    /// The value is positive or undefined throughout.
    Outside,
    /// The value is defined and not positive throughout.
    Inside,
    /// The value is defined, continuous and strictly monotone; of a shell, that of the expression in it.
    Monotone,
    /// The part is too short to be halved.
    Shortest,
    Open,
    /// Open for the bundle; what is known of each of its lines is found together, at this node.
    Shared(u32),
}

/// A range of t for the lines of a bundle.
#[derive(Clone, Debug)]
pub(crate) struct DividedBundle {
    /// In ascending order, with what is known of all lines.
    pub(crate) parts: Vec<BundlePart>,
    /// The starts and directions of the lines.
    lines: Vec<[[[f64; MOST_LANES]; 3]; 2]>,
    nodes: Vec<LineNode>,
}

/// A part of the range that is open for the bundle.
#[derive(Clone, Debug)]
struct LineNode {
    from: f64,
    to: f64,
    depth: u32,
    /// For each block of lines, the findings about them, once they are asked for.
    found: Vec<Option<[Option<PartFinding>; MOST_LANES]>>,
    /// The first of its halves, once they are asked for; the second one follows it.
    halves: Option<u32>,
}

/// The number of times that a part is halved for all lines.
const MOST_HALVINGS: u32 = 6;

impl DividedBundle {
    /// Nothing is known.
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
            halves: None,
        });
        (self.nodes.len() - 1) as u32
    }

    /// The finding about a line at a node; `None` if it is open.
    pub(crate) fn finding(
        &mut self,
        field: &Field,
        scratch: &mut FieldScratch,
        node: u32,
        line: usize,
    ) -> Option<PartFinding> {
        let node = &mut self.nodes[node as usize];
        let (block, lane) = (line / MOST_LANES, line % MOST_LANES);
        scratch.evaluations += 1;
        let found = node.found[block].get_or_insert_with(|| {
            let [origins, directions] = &self.lines[block];
            let coordinate = |k: usize| LineInput::Coordinate {
                origin: origins[k],
                direction: directions[k],
            };
            let ranges = field.in_vectors(scratch, &coordinate, Interval::new(node.from, node.to));
            ranges.map_or([None; MOST_LANES], |ranges| {
                ranges.map(|range| field.finding(range))
            })
        });
        found[lane]
    }

    /// Both halves of a node, with their ranges; `None` if each line is to go on alone.
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
            finding: PartFinding::Shared(node),
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

/// The number of evaluations for a bundle and a field.
const MOST_EVALUATIONS: usize = 128;

impl LineBundle {
    /// The rays.
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

    /// True if the part is shorter than the bundle is wide: shorter parts say little more.
    fn is_wider_than(&self, [a, b]: [f64; 2]) -> bool {
        let middle = Interval::point(0.5 * (a + b));
        let widths = (0..3).map(|k| self.coordinate(k, middle).value.width());
        let lengths = (0..3).map(|k| {
            let direction = self.direction[k];
            (b - a) * direction.lower().abs().max(direction.upper().abs())
        });
        lengths.fold(0.0, f64::max) <= 0.5 * widths.fold(0.0, f64::max)
    }
}

impl Field {
    /// Divides the range for lines that go nearly the same way.
    pub(crate) fn divided(
        &self,
        scratch: &mut FieldScratch,
        lines: impl Iterator<Item = Line> + Clone,
        range: [f64; 2],
    ) -> DividedBundle {
        let mut divided = DividedBundle::unknown();
        divided.parts = self.divide(scratch, &LineBundle::new(lines.clone()), range);
        if !self.tape().is_of_vectors() {
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
            let BundlePart { from, to, finding } = divided.parts[k];
            if finding == PartFinding::Open {
                let node = divided.add_node([from, to], 0);
                divided.parts[k].finding = PartFinding::Shared(node);
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
        let at_once = if self.tape().is_of_vectors() {
            MOST_LANES
        } else {
            1
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
            let ranges = if budget > 0 {
                self.ranges_of_bundle(scratch, bundle, &parts)
            } else {
                Vec::new()
            };
            budget = budget.saturating_sub(parts.len());
            for (k, [a, b]) in parts.into_iter().enumerate() {
                let finding = ranges.get(k).and_then(|range| self.finding(*range));
                let goes_on = k < ranges.len() && !bundle.is_wider_than([a, b]) && b - a > 0.0;
                if finding.is_none() && goes_on {
                    open.extend(halves([a, b]));
                    continue;
                }
                found.push(BundlePart {
                    from: a,
                    to: b,
                    finding: finding.unwrap_or(PartFinding::Open),
                });
            }
        }
        found.sort_unstable_by(|a, b| a.from.total_cmp(&b.from));
        // Two parts that are both decided alike, or both open, are one.
        found.dedup_by(|part, last| {
            let is_one = part.finding == last.finding && part.finding != PartFinding::Monotone;
            if is_one {
                last.to = part.to;
            }
            is_one
        });
        found
    }

    /// The values and slopes of all lines on some parts, as many at most as vectors have lanes.
    fn ranges_of_bundle(
        &self,
        scratch: &mut FieldScratch,
        bundle: &LineBundle,
        parts: &[[f64; 2]],
    ) -> Vec<Slope> {
        if parts.len() > 1 {
            let last = parts.len() - 1;
            let coordinate = |k: usize| {
                let ranges: [Slope; MOST_LANES] = std::array::from_fn(|lane| {
                    let [a, b] = parts[lane.min(last)];
                    bundle.coordinate(k, Interval::new(a, b))
                });
                let bounds = |of: fn(Slope) -> Interval| {
                    [
                        ranges.map(|range| of(range).lower()),
                        ranges.map(|range| of(range).upper()),
                    ]
                };
                LineInput::Range {
                    value: bounds(|range| range.value),
                    slope: bounds(|range| range.slope),
                }
            };
            if let Some(ranges) = self.in_vectors(scratch, &coordinate, Interval::point(0.0)) {
                scratch.evaluations += parts.len() as u64;
                return ranges[..parts.len()].to_vec();
            }
        }
        let mut range = |&[a, b]: &[f64; 2]| {
            self.range(scratch, &|k| bundle.coordinate(k, Interval::new(a, b)))
        };
        parts.iter().map(&mut range).collect()
    }
}
