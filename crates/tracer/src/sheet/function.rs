//! The function of a parametric surface with its derivatives.
//!
//! Input: three expressions in u and v. Output: σ, σu and σv at places and on cells.

use expr::interval::{Affine, Interval};
use expr::tape::Tape;
use expr::{Graph, Input, NodeId, TooLarge};
use glam::DVec3;

use crate::sheet::cell::Cell;
use crate::sheet::{CELL_OPERATIONS, SheetScratch};

/// σ with its derivatives.
#[derive(Debug)]
pub(super) struct SheetFunction {
    position: Tape,
    /// σ, σu, σv.
    frame: Tape,
    /// The work of evaluating the position, and the frame, in operations.
    work: [u64; 2],
    uniforms: Vec<(Input, f64)>,
    /// The inputs of the frame: the uniforms have their values, and the variables stand at these positions.
    inputs: Vec<f64>,
    variables: [Option<usize>; 2],
}

impl SheetFunction {
    pub(super) fn new(
        graph: &Graph,
        components: [NodeId; 3],
        uniform: &dyn Fn(Input) -> f64,
    ) -> Result<Self, TooLarge> {
        let (mut graph, roots) = graph.extract(&components);
        let mut all = roots.clone();
        for k in 0..2 {
            all.extend(graph.derivatives(&roots, Input::Variable(k))?);
        }
        let inputs = graph.inputs(&roots).into_iter();
        let (position, frame) = (Tape::new(&graph, &roots), Tape::new(&graph, &all));
        let mut function = Self {
            work: [position.work(), frame.work()],
            position,
            frame,
            uniforms: inputs.map(|input| (input, uniform(input))).collect(),
            inputs: Vec::new(),
            variables: [None; 2],
        };
        let inputs = function.frame.inputs().iter();
        function.inputs = inputs.map(|input| function.uniform(*input)).collect();
        let position = |k: u32| {
            let mut inputs = function.frame.inputs().iter();
            inputs.position(|input| *input == Input::Variable(k))
        };
        function.variables = [position(0), position(1)];
        Ok(function)
    }

    /// Prepares a scratch for places of this surface.
    pub(super) fn prepare(&self, scratch: &mut SheetScratch) {
        scratch.inputs.clone_from(&self.inputs);
    }

    /// σ, σu and σv at a place, for which the scratch has been prepared.
    #[inline]
    pub(super) fn frame_at(&self, scratch: &mut SheetScratch, uv: [f64; 2]) -> [DVec3; 3] {
        scratch.counters.places += 1;
        scratch.operations += 2 * self.work[1] + CELL_OPERATIONS;
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

    /// Intervals that contain σ at a place.
    pub(super) fn place_at(&self, scratch: &mut SheetScratch, uv: [f64; 2]) -> [Interval; 3] {
        scratch.operations += 8 * self.work[0] + CELL_OPERATIONS;
        let inputs: Vec<Interval> = self
            .position
            .inputs()
            .iter()
            .map(|input| match *input {
                Input::Variable(k @ 0..2) => Interval::point(uv[k as usize]),
                input => Interval::point(self.uniform(input)),
            })
            .collect();
        let mut out = [Interval::WHOLE; 3];
        self.position
            .eval_intervals(&mut scratch.registers, &inputs, &mut out);
        out
    }

    /// σ, σu and σv on a cell.
    pub(super) fn frame_on(&self, scratch: &mut SheetScratch, sides: [[f64; 2]; 2]) -> [Affine; 9] {
        scratch.counters.cells += 1;
        scratch.operations += 16 * self.work[1] + CELL_OPERATIONS;
        let mut out = [Affine::constant(f64::NAN); 9];
        let inputs = self.ranges(&self.frame, sides);
        self.frame
            .eval_affine(&mut scratch.registers, &inputs, &mut out);
        out
    }

    /// The cell between these sides.
    pub(super) fn cell(
        &self,
        scratch: &mut SheetScratch,
        sides: [[f64; 2]; 2],
        depth: u32,
    ) -> Cell {
        Cell::new(sides, &self.position_on(scratch, sides), depth)
    }

    /// The side along which a cell is farther from a straight one, by its lines through the middle; of two that are alike, the
    /// one that has been halved less.
    pub(super) fn less_straight(
        &self,
        scratch: &mut SheetScratch,
        sides: [[f64; 2]; 2],
        domain: [[f64; 2]; 2],
    ) -> usize {
        let [u, v] = [0, 1].map(|k| {
            let mut line = sides;
            line[1 - k] = [0.5 * (sides[1 - k][0] + sides[1 - k][1]); 2];
            let place = self.position_on(scratch, line);
            place.iter().map(Affine::error).fold(0.0, f64::max)
        });
        let share = |k: usize| (sides[k][1] - sides[k][0]) / (domain[k][1] - domain[k][0]);
        usize::from(v > u || v == u && share(1) > share(0))
    }

    fn position_on(&self, scratch: &mut SheetScratch, sides: [[f64; 2]; 2]) -> [Affine; 3] {
        scratch.counters.cells += 1;
        scratch.operations += 16 * self.work[0] + CELL_OPERATIONS;
        let mut out = [Affine::constant(f64::NAN); 3];
        let inputs = self.ranges(&self.position, sides);
        self.position
            .eval_affine(&mut scratch.registers, &inputs, &mut out);
        out
    }

    /// The halves of a cell along a side.
    pub(super) fn halve(&self, scratch: &mut SheetScratch, cell: &Cell, side: usize) -> [Cell; 2] {
        cell.halves_along(side)
            .map(|sides| self.cell(scratch, sides, cell.depth + 1))
    }

    fn ranges(&self, tape: &Tape, sides: [[f64; 2]; 2]) -> Vec<Affine> {
        let inputs = tape.inputs().iter();
        inputs
            .map(|input| match *input {
                Input::Variable(k @ 0..2) => Affine::coordinate(k as usize, sides[k as usize]),
                input => Affine::constant(self.uniform(input)),
            })
            .collect()
    }

    fn uniform(&self, input: Input) -> f64 {
        let found = self.uniforms.iter().find(|(other, _)| *other == input);
        found.map_or(f64::NAN, |(_, value)| *value)
    }
}
