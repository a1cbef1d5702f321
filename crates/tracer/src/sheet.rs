//! Parametric surfaces.
//!
//! Input: three expressions in u and v over a rectangle, then rays. Output: where a ray meets the surface. The rectangle is
//! divided into cells, each with a box that contains its image and a parallelogram that it is near (`sheet/cell.rs`). A ray
//! takes the cells whose boxes it meets from its start on. It passes the parallelogram of a cell by, or the slopes there
//! (`sheet/slopes.rs`) say that it meets the cell once at most: then Newton's method decides where. Else the cell is halved;
//! the halves are kept for other rays.

mod cell;
mod function;
mod slopes;

use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering};

use expr::tape::Registers;
use expr::{Graph, Input, NodeId, TooLarge};
use glam::DVec3;

use crate::bounds::BoundingBox;
use crate::bvh::{Hierarchy, MetBox};
use cell::{Cell, CellEdge, Meeting};
use function::SheetFunction;
use slopes::{CellSlopes, MARGIN, ROUNDING};

pub(crate) use slopes::SheetRay;

/// A surface over a rectangle.
#[derive(Debug)]
pub struct Sheet {
    function: SheetFunction,
    domain: [[f64; 2]; 2],
    cells: Vec<Cell>,
    hierarchy: Hierarchy,
    /// The number of cells that have been halved and whose halves are kept.
    halved: AtomicUsize,
    /// The greatest number of these.
    most_halved: usize,
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

/// Memory for casting; one for each thread.
#[derive(Debug, Default)]
pub struct SheetScratch {
    registers: Registers,
    inputs: Vec<f64>,
    stack: Vec<MetBox>,
    /// The places that the ray has met, as they are found.
    hits: Vec<SheetHit>,
    /// The numbers of evaluations of the surface so far.
    pub(crate) counters: SheetCounters,
    /// The work so far, in operations.
    pub(crate) operations: u64,
    /// Those of them for what is kept, which other rays have not to do again.
    pub(crate) once: u64,
}

/// The work of casting.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SheetCounters {
    /// Evaluations of σ, σu and σv at a place.
    pub places: u64,
    /// Evaluations of them, or of σ alone, on a cell.
    pub cells: u64,
    /// Cells whose boxes rays have met.
    pub met: u64,
    /// Cells that were examined for rays, halves of those that they have met among them.
    pub parts: u64,
}

/// A rectangle is divided into this many cells, if their boxes are not small before.
const CELLS: usize = 1 << 12;
/// A cell whose box is smaller than this share of the whole is not divided before rays come.
const SMALL: f64 = 1.0 / 48.0;
/// The work of a cell besides evaluations of the surface, in operations.
const CELL_OPERATIONS: u64 = 16;
/// The number of times that a cell is halved for a ray.
const DEEPEST: u32 = 44;
/// Places that differ by a smaller share of the surface are one.
const SAME: f64 = 1e-9;
/// The least sine of the angle between a ray and a speck of the surface that it meets.
const TOUCHING: f64 = 1e-7;
/// The number of parts of a cell that are examined for a ray.
const MOST_PARTS: usize = 1 << 14;
/// The number of cells whose halves are kept, of all surfaces together: they take some 100 MB.
pub const MOST_HALVED: usize = 1 << 17;

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
        let function = SheetFunction::new(graph, components, uniform)?;
        let (cells, boxes) = divide(&function, domain);
        Ok(Self {
            function,
            domain,
            cells,
            hierarchy: Hierarchy::new(boxes),
            halved: AtomicUsize::new(0),
            most_halved: MOST_HALVED,
        })
    }

    /// The box of the surface, empty if it is defined nowhere.
    pub fn bounds(&self) -> BoundingBox {
        self.hierarchy.bounds()
    }

    /// Keeps the halves of so many cells at most. Rays find the same places without.
    pub fn keep_at_most(&mut self, halved: usize) {
        self.most_halved = halved;
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
        let ray = SheetRay::new(origin, direction, leaving.is_some());
        self.each(scratch, &ray, leaving, f64::INFINITY, &mut |_| {
            f64::INFINITY
        });
        let hits = &mut scratch.hits;
        hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t));
        hits
    }

    /// Hands the places with 0 < t < `reach` where the ray meets the surface to `found`, each once, and about from the ray's
    /// start on. `found` returns the reach from then on. Returns the last one.
    pub(crate) fn each(
        &self,
        scratch: &mut SheetScratch,
        ray: &SheetRay,
        leaving: Option<[f64; 2]>,
        reach: f64,
        found: &mut dyn FnMut(&SheetHit) -> f64,
    ) -> f64 {
        scratch.hits.clear();
        let &SheetRay {
            origin, direction, ..
        } = ray;
        if !(origin.is_finite() && direction.is_finite()) || direction == DVec3::ZERO {
            return reach;
        }
        self.function.prepare(scratch);
        let mut stack = std::mem::take(&mut scratch.stack);
        let reach =
            self.hierarchy
                .each_met(origin, direction, reach, &mut stack, &mut |k, mut reach| {
                    scratch.counters.met += 1;
                    scratch.operations += CELL_OPERATIONS;
                    let before = scratch.hits.len();
                    let mut parts = MOST_PARTS;
                    self.meet(scratch, &self.cells[k], ray, leaving, reach, &mut parts);
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

    /// Adds the places where the ray meets a cell, or a part of one.
    fn meet(
        &self,
        scratch: &mut SheetScratch,
        cell: &Cell,
        ray: &SheetRay,
        leaving: Option<[f64; 2]>,
        reach: f64,
        parts: &mut usize,
    ) {
        if *parts == 0 {
            return;
        }
        *parts -= 1;
        scratch.counters.parts += 1;
        scratch.operations += CELL_OPERATIONS;
        let Some(meeting) = cell.meeting(ray, reach) else {
            return;
        };
        let slopes = cell.slopes.get_or_init(|| {
            let frame = scratch.once(|scratch| self.function.frame_on(scratch, cell.sides));
            CellSlopes::new(cell.sides, &frame).map(Box::new)
        });
        if let Some(slopes) = slopes
            && slopes.meets_once_at_most(ray)
            && self.meet_once(scratch, cell, slopes, &meeting, ray, leaving)
        {
            return;
        }
        if cell.depth == DEEPEST || meeting.is_short == [true; 2] {
            self.meet_speck(scratch, cell, ray, leaving);
            return;
        }
        let halve = |scratch: &mut SheetScratch| {
            let side = slopes.as_ref().and_then(|slopes| slopes.more_turned());
            let side = side.unwrap_or_else(|| {
                let function = &self.function;
                function.less_straight(scratch, cell.sides, self.domain)
            });
            self.function.halve(scratch, cell, side)
        };
        let not_kept;
        let halves = if let [true, false] | [false, true] = meeting.is_short {
            // For other rays the shorter side may be the one to halve.
            let longer = usize::from(meeting.is_short[0]);
            not_kept = self.function.halve(scratch, cell, longer);
            &not_kept
        } else {
            let kept = cell.halves.get_or_init(|| {
                let is_room = self.halved.fetch_add(1, Ordering::Relaxed) < self.most_halved;
                is_room.then(|| Box::new(scratch.once(halve)))
            });
            if let Some(kept) = kept {
                &**kept
            } else {
                not_kept = halve(scratch);
                &not_kept
            }
        };
        for half in halves {
            self.meet(scratch, half, ray, leaving, reach, parts);
        }
    }

    /// Adds the place where the ray meets a cell that it meets once at most; returns false if that has not been decided.
    fn meet_once(
        &self,
        scratch: &mut SheetScratch,
        cell: &Cell,
        slopes: &CellSlopes,
        meeting: &Meeting,
        ray: &SheetRay,
        leaving: Option<[f64; 2]>,
    ) -> bool {
        if leaving.is_some_and(|uv| cell.contains(uv)) {
            return true;
        }
        let start = cell.start(slopes, meeting);
        match self.newton(scratch, cell, start, ray) {
            Newton::Ahead(hit) => {
                self.add(scratch, hit, ray);
                true
            }
            Newton::Behind => true,
            Newton::Beyond(edge) => {
                let place = self.function.place_at(scratch, edge.at);
                slopes.is_passed(ray, edge.beyond, &place)
            }
            Newton::Unknown => false,
        }
    }

    /// Adds the place where the ray meets a cell that is not halved any more, unless it touches the surface there. Such cells
    /// remain at poles, and where the ray comes from so far away that rounding is larger than they are.
    fn meet_speck(
        &self,
        scratch: &mut SheetScratch,
        cell: &Cell,
        ray: &SheetRay,
        leaving: Option<[f64; 2]>,
    ) {
        if leaving.is_some_and(|uv| cell.contains(uv)) {
            return;
        }
        let middle = cell.sides.map(|[a, b]| 0.5 * (a + b));
        if let Newton::Ahead(hit) = self.newton(scratch, cell, middle, ray)
            && hit.normal.dot(ray.direction).abs() > TOUCHING * ray.square().sqrt()
        {
            self.add(scratch, hit, ray);
        }
    }

    /// Adds a place, unless it is one that a neighbouring cell has found: both have their common edge, or a pole, or they meet
    /// at a seam.
    fn add(&self, scratch: &mut SheetScratch, hit: SheetHit, ray: &SheetRay) {
        let far = ray.origin.abs().max_element() + hit.position.abs().max_element();
        let size = (self.bounds().upper - self.bounds().lower)
            .max_element()
            .min(1.0 + far);
        let reach = SAME * size + 4.0 * ROUNDING * far;
        for k in 0..scratch.hits.len() {
            let known = scratch.hits[k];
            if known.position.distance(hit.position) > reach {
                continue;
            }
            let [du, dv] = [0, 1].map(|k| (known.uv[k] - hit.uv[k]).abs());
            let [_, su, sv] = self.function.frame_at(scratch, known.uv);
            let is_near = du * su.length() + dv * sv.length() <= reach;
            if is_near || self.is_at_rim(known.uv) && self.is_at_rim(hit.uv) {
                return;
            }
        }
        scratch.hits.push(hit);
    }

    /// True if the parameters lie on the edge of the rectangle.
    fn is_at_rim(&self, uv: [f64; 2]) -> bool {
        self.domain.iter().zip(uv).any(|(&[a, b], x)| {
            let margin = SAME * (b - a);
            x <= a + margin || b - margin <= x
        })
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
            let [s, su, sv] = self.function.frame_at(scratch, [u, v]);
            let normal = su.cross(sv);
            let determinant = normal.dot(ray.direction);
            let turned = ray.direction.cross(ray.origin - s);
            let step_u = sv.dot(turned) / determinant;
            let step_v = -su.dot(turned) / determinant;
            // The steps as shares of the cell.
            let steps = [(step_u / du).abs(), (step_v / dv).abs()];
            let size = steps[0].max(steps[1]);
            if !size.is_finite() {
                return Newton::Unknown;
            }
            (u, v) = (u + step_u, v + step_v);
            let away = [(u - u0) / du, (v - v0) / dv].map(|share| (-share).max(share - 1.0));
            // Rounding moves a solution by so much: one on the common edge of two cells perhaps outside of both.
            let rounding = ROUNDING
                * (ray.origin.abs().max_element() + s.abs().max_element())
                * ray.square().sqrt()
                / determinant.abs();
            let rounded = [rounding * sv.length() / du, rounding * su.length() / dv];
            let is_beyond = |most: f64| (0..2).any(|k| away[k] > most + rounded[k]);
            // Steps shrink by their squares: the next one would be about size³/last².
            let is_last = size * size * size <= 1e-15 * last * last;
            let is_rounded = (0..2).all(|k| steps[k] <= rounded[k].max(1e-14));
            if is_rounded || size <= 1e-7 && (is_last || size >= last) {
                if is_beyond(MARGIN) {
                    // Only within the cell is the solution known to be the only one.
                    return Newton::Beyond(cell.edge([u, v]));
                }
                let position = s + step_u * su + step_v * sv;
                (u, v) = (u.clamp(u0, u1), v.clamp(v0, v1));
                let t = (position - ray.origin).dot(ray.direction) / ray.square();
                // Where a surface closes, or has an edge with another one, a ray that starts there finds its start again.
                let is_start = || position.distance(ray.origin) <= rounding * normal.length();
                if t <= 0.0 || ray.leaves && is_start() {
                    return Newton::Behind;
                }
                let against = -ray.direction.normalize_or(DVec3::Z);
                // The last step doubles the digits of the place; those of the normal take another look.
                let at_place = (size > 1e-14).then(|| self.function.frame_at(scratch, [u, v]));
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
            if is_beyond(4.0) {
                return Newton::Beyond(cell.edge([u, v]));
            }
            last = size;
        }
        Newton::Unknown
    }
}

/// The cells of a rectangle with their boxes.
fn divide(function: &SheetFunction, domain: [[f64; 2]; 2]) -> (Vec<Cell>, Vec<BoundingBox>) {
    let mut scratch = SheetScratch::default();
    let mut done: Vec<Cell> = Vec::new();
    let mut rest = VecDeque::from([function.cell(&mut scratch, domain, 0)]);
    let mut whole: Option<f64> = None;
    while let Some(cell) = rest.pop_front() {
        let bounds = cell.bounds;
        if bounds.is_empty() {
            continue;
        }
        let size = (bounds.upper - bounds.lower).max_element();
        let count = done.len() + rest.len() + 1;
        // The first boxes are far too large: the finest of a level says how large the surface is.
        if whole.is_none() && count >= CELLS / 16 {
            let bounded = rest.iter().filter_map(|cell| cell.bounds.if_finite());
            whole = bounded
                .reduce(|a, b| a.union(&b))
                .map(|all| (all.upper - all.lower).max_element());
        }
        if count >= CELLS || whole.is_some_and(|whole| size <= SMALL * whole) {
            done.push(cell);
        } else {
            let side = cell
                .longer()
                .unwrap_or_else(|| function.less_straight(&mut scratch, cell.sides, domain));
            rest.extend(function.halve(&mut scratch, &cell, side));
        }
    }
    for cell in &mut done {
        cell.depth = 0;
    }
    let boxes = done.iter().map(|cell| cell.bounds).collect();
    (done, boxes)
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

impl SheetScratch {
    /// The work so far.
    pub fn counters(&self) -> SheetCounters {
        self.counters
    }

    /// The work so far, in operations.
    pub fn operations(&self) -> u64 {
        self.operations
    }

    /// Does work whose outcome is kept.
    fn once<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.operations;
        let outcome = work(self);
        self.once += self.operations - before;
        outcome
    }
}
