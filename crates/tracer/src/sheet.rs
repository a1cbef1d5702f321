//! Parametric surfaces.
//!
//! Input: three expressions in u and v over a rectangle, then rays. Output: where a ray meets the surface. The rectangle is
//! divided into cells, each with a box that contains its image, by interval arithmetic. A ray takes the cells whose boxes it
//! meets from its start on. Of each the linear map (`linear.rs`) says that the ray passes it by, or that it meets it once at
//! most: then Newton's method decides where. Else the cell is divided.

mod linear;

use std::sync::OnceLock;

use expr::interval::Interval;
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId, TooLarge};
use glam::DVec3;

use crate::bounds::BoundingBox;
use crate::bvh::{Hierarchy, MetBox};
use linear::{LinearCell, MARGIN, Meetings, ROUNDING, SheetRay, middle};

/// A surface over a rectangle.
#[derive(Debug)]
pub struct Sheet {
    position: Tape,
    /// σ, σu, σv.
    frame: Tape,
    /// The work of evaluating it, in operations.
    work: u64,
    uniforms: Vec<(Input, f64)>,
    /// The inputs of the frame: the uniforms have their values, and the variables stand at these positions.
    inputs: Vec<f64>,
    variables: [Option<usize>; 2],
    domain: [[f64; 2]; 2],
    cells: Vec<Cell>,
    /// The linear maps of the cells that rays have met.
    linear: Vec<OnceLock<Option<Box<LinearCell>>>>,
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
    inputs: Vec<f64>,
    stack: Vec<MetBox>,
    parts: Vec<(Cell, u32)>,
    /// The places that the ray has met, as they are found.
    hits: Vec<SheetHit>,
    /// The numbers of evaluations of the surface so far.
    pub(crate) counters: SheetCounters,
    /// The work so far, in operations.
    pub(crate) operations: u64,
}

/// The work of casting.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SheetCounters {
    /// Evaluations of σ, σu and σv at a place.
    pub places: u64,
    /// Evaluations of them on a cell.
    pub cells: u64,
    /// Cells whose boxes rays have met.
    pub met: u64,
}

/// A rectangle is divided into this many cells, if their boxes are not small before.
const CELLS: usize = 1 << 12;
/// A cell whose box is smaller than this share of the whole is not divided before rays come.
const SMALL: f64 = 1.0 / 48.0;
/// The work of a cell besides evaluations of the surface, in operations.
const CELL_OPERATIONS: u64 = 16;
/// The number of times that a cell is halved for a ray.
const DEEPEST: u32 = 44;
/// The number of parts of cells that are looked at for a ray.
const MOST_PARTS: usize = 1 << 14;

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
        let frame = Tape::new(&graph, &all);
        let mut sheet = Self {
            position: Tape::new(&graph, &roots),
            work: frame.work(),
            frame,
            uniforms: inputs.map(|input| (input, uniform(input))).collect(),
            inputs: Vec::new(),
            variables: [None; 2],
            domain,
            cells: Vec::new(),
            linear: Vec::new(),
            hierarchy: Hierarchy::default(),
        };
        let inputs = sheet.frame.inputs().iter();
        sheet.inputs = inputs.map(|input| sheet.uniform(*input)).collect();
        let position = |k: u32| {
            let mut inputs = sheet.frame.inputs().iter();
            inputs.position(|input| *input == Input::Variable(k))
        };
        sheet.variables = [position(0), position(1)];
        sheet.divide();
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
        self.each(
            scratch,
            origin,
            direction,
            leaving,
            f64::INFINITY,
            &mut |_| f64::INFINITY,
        );
        let hits = &mut scratch.hits;
        hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t));
        hits
    }

    /// Hands the places with 0 < t < `reach` where the ray meets the surface to `found`, each once, and about from the ray's
    /// start on. `found` returns the reach from then on. Returns the last one.
    pub(crate) fn each(
        &self,
        scratch: &mut SheetScratch,
        origin: DVec3,
        direction: DVec3,
        leaving: Option<[f64; 2]>,
        reach: f64,
        found: &mut dyn FnMut(&SheetHit) -> f64,
    ) -> f64 {
        scratch.hits.clear();
        if !(origin.is_finite() && direction.is_finite()) || direction == DVec3::ZERO {
            return reach;
        }
        scratch.inputs.clone_from(&self.inputs);
        let ray = SheetRay::new(origin, direction);
        let mut stack = std::mem::take(&mut scratch.stack);
        let reach =
            self.hierarchy
                .each_met(origin, direction, reach, &mut stack, &mut |k, mut reach| {
                    scratch.counters.met += 1;
                    scratch.operations += CELL_OPERATIONS;
                    let before = scratch.hits.len();
                    self.meet(scratch, k, &ray, leaving, reach);
                    for k in before..scratch.hits.len() {
                        if scratch.hits[k].t < reach {
                            reach = reach.min(found(&scratch.hits[k]));
                        }
                    }
                    reach
                });
        scratch.stack = stack;
        reach
    }

    /// Adds the places where the ray meets a cell.
    fn meet(
        &self,
        scratch: &mut SheetScratch,
        k: usize,
        ray: &SheetRay,
        leaving: Option<[f64; 2]>,
        reach: f64,
    ) {
        let cell = self.cells[k];
        let linear = self.linear[k].get_or_init(|| {
            let frame = self.frame_on(scratch, &cell);
            self.linear_cell(scratch, &cell, &frame).map(Box::new)
        });
        if let Some(linear) = linear
            && self.meet_linear(scratch, &cell, linear, ray, leaving)
        {
            return;
        }
        self.search(scratch, cell, ray, leaving, reach);
    }

    /// Adds the place where the ray meets a cell with its linear map; returns false if the cell has to be divided.
    fn meet_linear(
        &self,
        scratch: &mut SheetScratch,
        cell: &Cell,
        linear: &LinearCell,
        ray: &SheetRay,
        leaving: Option<[f64; 2]>,
    ) -> bool {
        let start = match linear.meetings(ray) {
            Meetings::None => return true,
            Meetings::Unknown => return false,
            Meetings::AtMostOne(start) => start,
        };
        if leaving.is_some_and(|uv| cell.contains(uv)) {
            return true;
        }
        match self.newton(scratch, cell, start, ray) {
            Newton::Ahead(hit) => {
                scratch.add(hit);
                true
            }
            Newton::Behind => true,
            Newton::Beyond(edge) => {
                let sides = edge.at.map(|at| [at, at]);
                let place = self.place_on(&mut scratch.registers, &Cell { sides });
                linear.is_passed(ray, edge.beyond, &place)
            }
            Newton::Unknown => false,
        }
    }

    fn divide(&mut self) {
        let mut scratch = SheetScratch::default();
        let mut done: Vec<(Cell, BoundingBox)> = Vec::new();
        let mut rest = std::collections::VecDeque::from([Cell { sides: self.domain }]);
        let mut whole: Option<f64> = None;
        while let Some(cell) = rest.pop_front() {
            let bounds = self.on_cell(&mut scratch.registers, &cell);
            if bounds.is_empty() {
                continue;
            }
            let size = (bounds.upper - bounds.lower).max_element();
            // The first boxes are far too large: the finest of a level says how large the surface is.
            let count = done.len() + rest.len() + 1;
            if count == CELLS / 16 {
                whole = rest
                    .iter()
                    .map(|cell| self.on_cell(&mut scratch.registers, cell))
                    .reduce(|a, b| a.union(&b))
                    .map(|all| (all.upper - all.lower).max_element());
            }
            if count >= CELLS || whole.is_some_and(|whole| size <= SMALL * whole) {
                done.push((cell, bounds));
            } else {
                rest.extend(cell.halves(self.longer(&mut scratch, &cell)));
            }
        }
        let (cells, boxes): (Vec<Cell>, Vec<BoundingBox>) = done.into_iter().unzip();
        self.linear = cells.iter().map(|_| OnceLock::new()).collect();
        self.cells = cells;
        self.hierarchy = Hierarchy::new(boxes);
    }

    /// The side of a cell along which its image may be longer: where nothing is known, that which has been halved less.
    fn longer(&self, scratch: &mut SheetScratch, cell: &Cell) -> usize {
        let frame = self.frame_on(scratch, cell);
        let longest = |side: usize| {
            let slope = &frame[3 + 3 * side..][..3];
            let sizes = slope
                .iter()
                .map(|it| it.lower().abs().max(it.upper().abs()));
            let [a, b] = cell.sides[side];
            sizes.fold(0.0f64, |most, size| most.max(size)) * (b - a)
        };
        let share = |side: usize| {
            let [[a, b], [c, d]] = [cell.sides[side], self.domain[side]];
            (b - a) / (d - c)
        };
        let [u, v] = [longest(0), longest(1)];
        if u.is_finite() && v.is_finite() && u != v {
            usize::from(v > u)
        } else {
            usize::from(share(1) > share(0))
        }
    }

    /// A box that contains the image of a cell.
    fn on_cell(&self, registers: &mut Registers, cell: &Cell) -> BoundingBox {
        around(&self.place_on(registers, cell))
    }

    /// Intervals that contain σ on a cell.
    fn place_on(&self, registers: &mut Registers, cell: &Cell) -> [Interval; 3] {
        let mut out = [Interval::WHOLE; 3];
        let inputs = self.intervals(&self.position, cell);
        self.position.eval_intervals(registers, &inputs, &mut out);
        out
    }

    /// Intervals that contain σ, σu and σv on a cell.
    fn frame_on(&self, scratch: &mut SheetScratch, cell: &Cell) -> [Interval; 9] {
        scratch.counters.cells += 1;
        scratch.operations += 8 * self.work + CELL_OPERATIONS;
        let mut out = [Interval::WHOLE; 9];
        let inputs = self.intervals(&self.frame, cell);
        self.frame
            .eval_intervals(&mut scratch.registers, &inputs, &mut out);
        out
    }

    /// The linear map of a cell on which the frame lies in these intervals.
    fn linear_cell(
        &self,
        scratch: &mut SheetScratch,
        cell: &Cell,
        frame: &[Interval; 9],
    ) -> Option<LinearCell> {
        let sides = cell.sides.map(middle).map(|at| [at, at]);
        let place = self.place_on(&mut scratch.registers, &Cell { sides });
        LinearCell::new(cell.sides, frame, &place)
    }

    /// Adds the places where the ray meets a cell that has to be divided.
    fn search(
        &self,
        scratch: &mut SheetScratch,
        cell: Cell,
        ray: &SheetRay,
        leaving: Option<[f64; 2]>,
        reach: f64,
    ) {
        scratch.parts.clear();
        let side = self.longer(scratch, &cell);
        scratch
            .parts
            .extend(cell.halves(side).map(|half| (half, 1)));
        let mut budget = MOST_PARTS;
        while let Some((cell, depth)) = scratch.parts.pop() {
            if budget == 0 {
                return;
            }
            budget -= 1;
            let frame = self.frame_on(scratch, &cell);
            let bounds = around(&[frame[0], frame[1], frame[2]]);
            if bounds.is_empty() {
                continue;
            }
            let met = bounds.met(ray.origin, ray.reciprocal);
            if met.is_none_or(|[near, _]| near >= reach) {
                continue;
            }
            let mut side = usize::from(depth % 2 == 1);
            if let Some(linear) = self.linear_cell(scratch, &cell, &frame) {
                if self.meet_linear(scratch, &cell, &linear, ray, leaving) {
                    continue;
                }
                side = linear.longer();
            }
            if depth < DEEPEST {
                let halves = cell.halves(side);
                scratch.parts.extend(halves.map(|half| (half, depth + 1)));
            }
        }
    }

    /// Solves σ(u, v) = origin + t·direction on a cell on which there is one solution at most.
    fn newton(
        &self,
        scratch: &mut SheetScratch,
        cell: &Cell,
        start: [f64; 2],
        ray: &SheetRay,
    ) -> Newton {
        let [[u0, u1], [v0, v1]] = cell.sides;
        let [mut u, mut v] = start;
        let (du, dv) = (u1 - u0, v1 - v0);
        let mut last = f64::INFINITY;
        for _ in 0..24 {
            let [s, su, sv] = self.frame_at(scratch, [u, v]);
            let normal = su.cross(sv);
            let determinant = normal.dot(ray.direction);
            let turned = ray.direction.cross(ray.origin - s);
            let step_u = sv.dot(turned) / determinant;
            let step_v = -su.dot(turned) / determinant;
            // The steps as shares of the cell.
            let size = (step_u / du).abs().max((step_v / dv).abs());
            if !size.is_finite() {
                return Newton::Unknown;
            }
            (u, v) = (u + step_u, v + step_v);
            let away = [(u - u0) / du, (v - v0) / dv]
                .iter()
                .fold(0.0f64, |most, share| most.max(-share).max(share - 1.0));
            // Rounding moves a solution by so much: one on the common edge of two cells perhaps outside of both.
            let rounded = ROUNDING
                * (ray.origin.abs().max_element() + s.abs().max_element())
                * ray.square().sqrt()
                / determinant.abs();
            let rounded = rounded * (sv.length() / du).max(su.length() / dv);
            // Steps shrink by their squares: the next one would be about size³/last².
            let is_last = size * size * size <= 1e-15 * last * last;
            if size <= rounded.max(1e-14) || size <= 1e-7 && (is_last || size >= last) {
                if away > MARGIN + rounded {
                    // Only within the cell is the solution known to be the only one.
                    return Newton::Beyond(cell.nearest([u, v]));
                }
                let position = s + step_u * su + step_v * sv;
                let t = (position - ray.origin).dot(ray.direction) / ray.square();
                if t <= 0.0 {
                    return Newton::Behind;
                }
                let against = -ray.direction.normalize_or(DVec3::Z);
                // The last step doubles the digits of the place; those of the normal take another look.
                let at_place = (size > 1e-14).then(|| self.frame_at(scratch, [u, v]));
                let at_place = at_place.and_then(|[_, su, sv]| su.cross(sv).try_normalize());
                let normal = at_place.unwrap_or_else(|| normal.normalize_or(against));
                let is_front = normal.dot(ray.direction) < 0.0;
                return Newton::Ahead(SheetHit {
                    t,
                    uv: [u, v],
                    position,
                    normal: if is_front { normal } else { -normal },
                    is_front,
                });
            }
            if away > 4.0 {
                return Newton::Beyond(cell.nearest([u, v]));
            }
            last = size;
        }
        Newton::Unknown
    }

    /// σ, σu and σv at a place.
    #[inline]
    fn frame_at(&self, scratch: &mut SheetScratch, uv: [f64; 2]) -> [DVec3; 3] {
        scratch.counters.places += 1;
        scratch.operations += 4 * self.work + CELL_OPERATIONS;
        if scratch.inputs.len() != self.inputs.len() {
            scratch.inputs.clone_from(&self.inputs);
        }
        for (position, at) in self.variables.iter().zip(uv) {
            if let Some(position) = *position {
                scratch.inputs[position] = at;
            }
        }
        let mut out = [f64::NAN; 9];
        self.frame
            .eval(&mut scratch.registers, &scratch.inputs, &mut out);
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
    /// The steps lead out of the cell.
    Beyond(CellEdge),
    /// It has not been found on the cell.
    Unknown,
}

/// The place of a cell that is nearest to one outside of it.
struct CellEdge {
    at: [f64; 2],
    /// For u and v: 1 where that is beyond the cell's greatest, −1 where it is below its least, else 0.
    beyond: [f64; 2],
}

impl Cell {
    fn nearest(&self, uv: [f64; 2]) -> CellEdge {
        let beyond = [0, 1].map(|k| {
            let [a, b] = self.sides[k];
            f64::from(u8::from(uv[k] > b)) - f64::from(u8::from(uv[k] < a))
        });
        let at = [0, 1].map(|k| uv[k].clamp(self.sides[k][0], self.sides[k][1]));
        CellEdge { at, beyond }
    }

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

/// The box of three sides, empty if one of them is.
fn around(sides: &[Interval; 3]) -> BoundingBox {
    if sides.iter().any(|side| side.is_empty()) {
        return BoundingBox::EMPTY;
    }
    BoundingBox {
        lower: DVec3::from_array(sides.map(Interval::lower)),
        upper: DVec3::from_array(sides.map(Interval::upper)),
    }
}

impl SheetScratch {
    /// The work so far.
    pub fn counters(&self) -> SheetCounters {
        self.counters
    }

    /// Adds a place, unless it is one that a neighbouring cell has found: both have their common edge.
    fn add(&mut self, hit: SheetHit) {
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + a.abs());
        let is_same = |known: &SheetHit| {
            close(known.t, hit.t)
                && known.position.distance(hit.position) <= 1e-9 * (1.0 + known.position.length())
                && close(known.uv[0], hit.uv[0])
                && close(known.uv[1], hit.uv[1])
        };
        if !self.hits.iter().any(is_same) {
            self.hits.push(hit);
        }
    }
}
