//! Parametric surfaces.
//!
//! Input: three expressions in u and v over a rectangle, then rays. Output: where a ray meets the surface. The rectangle is
//! divided into cells, each with a box that contains its image, by interval arithmetic. In a cell that a ray meets, either
//! the boxes of its parts no longer do, or the determinant of (σu, σv, −d) excludes 0 for all derivatives on it: then the
//! ray meets it once at most, and Newton's method decides where. Else it is divided.

use expr::interval::Interval;
use expr::ops::{Binary, Unary};
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId, TooLarge};
use glam::{DMat3, DVec3};

use crate::bounds::BoundingBox;
use crate::bvh::Hierarchy;

/// A surface over a rectangle.
#[derive(Debug)]
pub struct Sheet {
    position: Tape,
    /// σ, σu, σv.
    frame: Tape,
    uniforms: Vec<(Input, f64)>,
    cells: Vec<Cell>,
    hierarchy: Hierarchy,
}

/// A place where a ray meets a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetHit {
    /// The place is origin + t·direction.
    pub t: f64,
    /// The parameters.
    pub uv: [f64; 2],
    /// The place.
    pub position: DVec3,
    /// The unit normal σu × σv, on the side of the ray's start.
    pub normal: DVec3,
    /// True if σu × σv itself points to that side.
    pub is_front: bool,
}

/// A part of the rectangle.
#[derive(Clone, Copy, Debug)]
struct Cell {
    sides: [[f64; 2]; 2],
}

/// Memory for casting; one for each thread.
#[derive(Debug, Default)]
pub struct SheetScratch {
    registers: Registers,
    stack: Vec<u32>,
    met: Vec<u32>,
    parts: Vec<(Cell, u32)>,
    hits: Vec<SheetHit>,
}

/// A rectangle is divided into this many cells, if their boxes are not small before.
const CELLS: usize = 1 << 12;
/// A cell whose box is smaller than this share of the whole is not divided before rays come.
const SMALL: f64 = 1.0 / 48.0;
/// The number of times that a cell is halved for a ray.
const DEEPEST: u32 = 44;
/// The number of parts of cells that are looked at for a ray.
const MOST_PARTS: usize = 1 << 14;
/// Cells are taken to be larger by this share, so that none is missed where two meet.
const MARGIN: f64 = 1e-9;

impl Sheet {
    /// Prepares the surface with these components over u in `domain[0]` and v in `domain[1]` (the variables 0 and 1).
    ///
    /// # Errors
    /// If the derivatives are too large.
    pub fn new(
        graph: &Graph,
        components: [NodeId; 3],
        domain: [[f64; 2]; 2],
        uniform: &dyn Fn(Input) -> f64,
    ) -> Result<Self, TooLarge> {
        let (mut graph, roots) = graph.extract(&components);
        let mut all = roots.clone();
        for k in 0..2 {
            all.extend(graph.derivatives(&roots, Input::Variable(k))?);
        }
        let inputs = graph.inputs(&roots).into_iter();
        let mut sheet = Self {
            position: Tape::new(&graph, &roots),
            frame: Tape::new(&graph, &all),
            uniforms: inputs.map(|input| (input, uniform(input))).collect(),
            cells: Vec::new(),
            hierarchy: Hierarchy::default(),
        };
        sheet.divide(domain);
        Ok(sheet)
    }

    /// The box of the surface, empty if it is defined nowhere.
    pub fn bounds(&self) -> BoundingBox {
        self.hierarchy.bounds()
    }

    /// All places with t > 0 where the ray meets the surface, by t. With `leaving`, it starts on the surface at these
    /// parameters, and does not meet it there.
    pub fn cast<'s>(
        &self,
        scratch: &'s mut SheetScratch,
        origin: DVec3,
        direction: DVec3,
        leaving: Option<[f64; 2]>,
    ) -> &'s [SheetHit] {
        let SheetScratch {
            stack, met, hits, ..
        } = scratch;
        met.clear();
        hits.clear();
        if !(origin.is_finite() && direction.is_finite()) || direction == DVec3::ZERO {
            return &scratch.hits;
        }
        self.hierarchy
            .met(origin, direction, stack, &mut |k, _| met.push(k as u32));
        for k in 0..scratch.met.len() {
            let cell = self.cells[scratch.met[k] as usize];
            self.search(scratch, cell, origin, direction, leaving);
        }
        let hits = &mut scratch.hits;
        hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t));
        // Where cells meet, both find the place.
        hits.dedup_by(|b, a| {
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + a.abs());
            close(a.t, b.t)
                && a.position.distance(b.position) <= 1e-9 * (1.0 + a.position.length())
                && close(a.uv[0], b.uv[0])
                && close(a.uv[1], b.uv[1])
        });
        &scratch.hits
    }

    fn divide(&mut self, domain: [[f64; 2]; 2]) {
        let mut registers = Registers::default();
        let mut done: Vec<(Cell, BoundingBox)> = Vec::new();
        let mut rest = std::collections::VecDeque::from([Cell { sides: domain }]);
        let mut whole: Option<f64> = None;
        while let Some(cell) = rest.pop_front() {
            let bounds = self.on_cell(&mut registers, &cell);
            if bounds.is_empty() {
                continue;
            }
            let size = (bounds.upper - bounds.lower).max_element();
            // The first boxes are far too large: the finest of a level says how large the surface is.
            let count = done.len() + rest.len() + 1;
            if count == CELLS / 16 {
                whole = rest
                    .iter()
                    .map(|cell| self.on_cell(&mut registers, cell))
                    .reduce(|a, b| a.union(&b))
                    .map(|all| (all.upper - all.lower).max_element());
            }
            if count >= CELLS || whole.is_some_and(|whole| size <= SMALL * whole) {
                done.push((cell, bounds));
            } else {
                rest.extend(cell.halves(self.longer(&mut registers, &cell)));
            }
        }
        let (cells, boxes): (Vec<Cell>, Vec<BoundingBox>) = done.into_iter().unzip();
        self.cells = cells;
        self.hierarchy = Hierarchy::new(boxes);
    }

    /// The side of a cell along which its image is longer.
    fn longer(&self, registers: &mut Registers, cell: &Cell) -> usize {
        let [[u0, u1], [v0, v1]] = cell.sides;
        let (u, v) = (0.5 * (u0 + u1), 0.5 * (v0 + v1));
        let at = |registers: &mut Registers, u, v| self.frame_at(registers, [u, v])[0];
        let along_u = at(registers, u0, v).distance(at(registers, u, v))
            + at(registers, u, v).distance(at(registers, u1, v));
        let along_v = at(registers, u, v0).distance(at(registers, u, v))
            + at(registers, u, v).distance(at(registers, u, v1));
        usize::from(along_v > along_u)
    }

    /// A box that contains the image of a cell.
    fn on_cell(&self, registers: &mut Registers, cell: &Cell) -> BoundingBox {
        let mut out = [Interval::WHOLE; 3];
        let inputs = self.intervals(&self.position, cell);
        self.position.eval_intervals(registers, &inputs, &mut out);
        if out.iter().any(|side| side.is_empty()) {
            return BoundingBox::EMPTY;
        }
        BoundingBox {
            lower: DVec3::from_array(out.map(Interval::lower)),
            upper: DVec3::from_array(out.map(Interval::upper)),
        }
    }

    fn search(
        &self,
        scratch: &mut SheetScratch,
        cell: Cell,
        origin: DVec3,
        direction: DVec3,
        leaving: Option<[f64; 2]>,
    ) {
        let reciprocal = direction.recip();
        scratch.parts.clear();
        scratch.parts.push((cell, 0));
        let mut budget = MOST_PARTS;
        while let Some((cell, depth)) = scratch.parts.pop() {
            if budget == 0 {
                return;
            }
            budget -= 1;
            let mut out = [Interval::WHOLE; 9];
            let inputs = self.intervals(&self.frame, &cell);
            self.frame
                .eval_intervals(&mut scratch.registers, &inputs, &mut out);
            if out[..3].iter().any(|side| side.is_empty()) {
                continue;
            }
            let bounds = BoundingBox {
                lower: DVec3::new(out[0].lower(), out[1].lower(), out[2].lower()),
                upper: DVec3::new(out[0].upper(), out[1].upper(), out[2].upper()),
            };
            let [near, far] = bounds.part(origin, reciprocal);
            if near > far || far < 0.0 {
                continue;
            }
            let regular =
                excludes_zero(&out, direction) && !out.iter().any(|part| part.is_partial());
            if regular {
                if leaving.is_some_and(|uv| cell.contains(uv)) {
                    continue;
                }
                match self.newton(scratch, &cell, origin, direction) {
                    Newton::Ahead(hit) => {
                        scratch.hits.push(hit);
                        continue;
                    }
                    Newton::Behind => continue,
                    Newton::Unknown => {}
                }
            }
            if depth >= DEEPEST {
                continue;
            }
            let side = usize::from(depth % 2 == 1);
            scratch
                .parts
                .extend(cell.halves(side).map(|half| (half, depth + 1)));
        }
    }

    /// Solves σ(u, v) = origin + t·direction from the middle of a cell on which there is one solution at most.
    fn newton(
        &self,
        scratch: &mut SheetScratch,
        cell: &Cell,
        origin: DVec3,
        direction: DVec3,
    ) -> Newton {
        let [[u0, u1], [v0, v1]] = cell.sides;
        let (mut u, mut v) = (0.5 * (u0 + u1), 0.5 * (v0 + v1));
        let (du, dv) = (u1 - u0, v1 - v0);
        let mut last = f64::INFINITY;
        for _ in 0..24 {
            let [s, su, sv] = self.frame_at(&mut scratch.registers, [u, v]);
            let matrix = DMat3::from_cols(su, sv, -direction);
            let step = matrix.inverse() * (origin - s);
            if !step.is_finite() {
                return Newton::Unknown;
            }
            // The steps as shares of the cell.
            let size = (step.x / du).abs().max((step.y / dv).abs());
            (u, v) = (u + step.x, v + step.y);
            let away = [(u - u0) / du, (v - v0) / dv]
                .iter()
                .fold(0.0f64, |most, share| most.max(-share).max(share - 1.0));
            if size <= 1e-14 || size <= 1e-9 && size >= last {
                if away > MARGIN {
                    // Where the solution lies is known, but only within the cell is it the only one.
                    return Newton::Unknown;
                }
                let [s, su, sv] = self.frame_at(&mut scratch.registers, [u, v]);
                let t = (s - origin).dot(direction) / direction.length_squared();
                if t <= 0.0 {
                    return Newton::Behind;
                }
                let normal = su.cross(sv).normalize_or(-direction.normalize_or(DVec3::Z));
                let faces = normal.dot(direction) < 0.0;
                return Newton::Ahead(SheetHit {
                    t,
                    uv: [u, v],
                    position: s,
                    normal: if faces { normal } else { -normal },
                    is_front: faces,
                });
            }
            if away > 4.0 {
                return Newton::Unknown;
            }
            last = size;
        }
        Newton::Unknown
    }

    /// σ, σu and σv.
    fn frame_at(&self, registers: &mut Registers, uv: [f64; 2]) -> [DVec3; 3] {
        let inputs: Vec<f64> = self
            .frame
            .inputs()
            .iter()
            .map(|input| match *input {
                Input::Variable(k @ 0..2) => uv[k as usize],
                input => self.uniform(input),
            })
            .collect();
        let mut out = [f64::NAN; 9];
        self.frame.eval(registers, &inputs, &mut out);
        [0, 3, 6].map(|k| DVec3::new(out[k], out[k + 1], out[k + 2]))
    }

    fn intervals(&self, tape: &Tape, cell: &Cell) -> Vec<Interval> {
        let inputs = tape.inputs().iter();
        inputs
            .map(|input| match *input {
                Input::Variable(k @ 0..2) => {
                    let [a, b] = cell.sides[k as usize];
                    Interval::new(a, b)
                }
                input => Interval::point(self.uniform(input)),
            })
            .collect()
    }

    fn uniform(&self, input: Input) -> f64 {
        let found = self.uniforms.iter().find(|(other, _)| *other == input);
        found.map_or(f64::NAN, |(_, value)| *value)
    }
}

/// The outcome of Newton's method on a cell.
enum Newton {
    /// The solution.
    Ahead(SheetHit),
    /// The solution is behind the start.
    Behind,
    /// It has not been found on the cell.
    Unknown,
}

impl Cell {
    fn halves(&self, side: usize) -> [Self; 2] {
        let [a, b] = self.sides[side];
        let middle = 0.5 * (a + b);
        [[a, middle], [middle, b]].map(|half| {
            let mut cell = *self;
            cell.sides[side] = half;
            cell
        })
    }

    /// True if the parameters lie in the cell, or on its edge.
    fn contains(&self, uv: [f64; 2]) -> bool {
        self.sides.iter().zip(uv).all(|(&[a, b], x)| {
            let margin = MARGIN * (b - a);
            a - margin <= x && x <= b + margin
        })
    }
}

/// True if det(σu, σv, d) excludes 0 for all values of the derivatives.
fn excludes_zero(frame: &[Interval; 9], direction: DVec3) -> bool {
    let product = |a, b| Interval::binary(Binary::Mul, a, b);
    let difference = |a, b| Interval::binary(Binary::Sub, a, b);
    let [su, sv] = [&frame[3..6], &frame[6..9]];
    let mut sum = Interval::point(0.0);
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let cross = difference(product(su[i], sv[j]), product(su[j], sv[i]));
        let term = product(cross, Interval::point(direction[k]));
        sum = Interval::binary(Binary::Add, sum, term);
    }
    let size = Interval::unary(Unary::Abs, sum);
    size.lower() > 0.0 && !size.is_empty()
}
