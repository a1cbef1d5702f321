//! Evaluation in f64: a graph's roots as straight-line code over registers.
//!
//! In: roots, then numbers for their inputs. Out: a number for each root. A register is reused after the last use of
//! its value, so that the registers in use stay in the processor's cache. Constants and inputs are read in place,
//! without a register.
//!
//! Evaluation at one point and at blocks of [`LANES`] points run the same instructions from the same table
//! ([`crate::ops`]). `tape/vectors.rs` runs them on vectors; `tape/ranges.rs` on intervals; `tape/lines.rs` on intervals
//! of several lines at once.

use rustc_hash::FxHashMap;

use crate::graph::{Graph, Input, Node, NodeId};
use crate::interval::{Affine, Interval, Slope};
use crate::ops::{self, Binary, Lanes, Unary};

mod lines;
mod ranges;
mod vectors;

pub use lines::LineInput;
pub use vectors::VectorRegisters;

/// The number of points that [`Tape::eval_block`] evaluates at once.
pub const LANES: usize = 64;
/// One number for each lane.
pub type Block = [f64; LANES];

/// Straight-line code for some roots.
#[derive(Clone, Debug)]
pub struct Tape {
    instructions: Vec<Instruction>,
    inputs: Vec<Input>,
    roots: Vec<Operand>,
    register_count: usize,
}

/// Registers, reused between evaluations to avoid allocations. One set per thread, for any tapes.
#[derive(Clone, Debug, Default)]
pub struct Registers {
    numbers: Vec<f64>,
    // Boxed, so that a result is exchanged with a register by swapping pointers.
    #[allow(clippy::vec_box)]
    blocks: Vec<Box<Block>>,
    intervals: Vec<Interval>,
    interval_waves: ranges::InputWaves<Interval>,
    slopes: Vec<Slope>,
    slope_waves: ranges::InputWaves<Slope>,
    affines: Vec<Affine>,
    affine_waves: ranges::InputWaves<Affine>,
}

/// The source of an instruction's operand.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operand {
    Constant(f64),
    /// An index into [`Tape::inputs`].
    Input(u32),
    Register(u32),
}

/// One operation; its result is stored in the register `out`.
#[derive(Clone, Copy, Debug)]
struct Instruction {
    out: u32,
    operation: TapeOperation,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum TapeOperation {
    Unary(Unary, Operand),
    Binary(Binary, Operand, Operand),
    Power(Operand, i32),
}

impl TapeOperation {
    fn operands(self) -> (Operand, Option<Operand>) {
        match self {
            Self::Unary(_, a) | Self::Power(a, _) => (a, None),
            Self::Binary(_, a, b) => (a, Some(b)),
        }
    }
}

impl Tape {
    /// Compiles the roots.
    pub fn new(graph: &Graph, roots: &[NodeId]) -> Self {
        let order = post_order(graph, roots);
        let mut uses: FxHashMap<NodeId, u32> = FxHashMap::default();
        for &root in roots {
            // A root's register is never freed.
            uses.insert(root, u32::MAX);
        }
        for &id in &order {
            for operand in graph.node(id).operands() {
                let count = uses.entry(operand).or_insert(0);
                *count = count.saturating_add(1);
            }
        }
        let inputs = graph.inputs(roots);
        let mut compiler = Compiler {
            places: FxHashMap::default(),
            free: Vec::new(),
            register_count: 0,
            uses,
        };
        let mut instructions = Vec::new();
        for id in order {
            let operation = match graph.node(id) {
                Node::Constant(value) => {
                    compiler.places.insert(id, Operand::Constant(value));
                    continue;
                }
                Node::Input(input) => {
                    let position = inputs.partition_point(|other| *other < input);
                    compiler.places.insert(id, Operand::Input(position as u32));
                    continue;
                }
                Node::Unary(op, a) => TapeOperation::Unary(op, compiler.take(a)),
                Node::Binary(op, a, b) => {
                    TapeOperation::Binary(op, compiler.take(a), compiler.take(b))
                }
                Node::Power(a, n) => TapeOperation::Power(compiler.take(a), n),
            };
            let out = compiler.give(id);
            instructions.push(Instruction { out, operation });
        }
        Self {
            instructions,
            inputs,
            roots: roots.iter().map(|root| compiler.places[root]).collect(),
            register_count: compiler.register_count as usize,
        }
    }

    /// Returns the inputs in the order that evaluation expects: sorted, variables before uniforms.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// Returns the number of roots.
    pub fn root_count(&self) -> usize {
        self.roots.len()
    }

    /// Returns the number of operations of one evaluation.
    pub fn operation_count(&self) -> usize {
        self.instructions.len()
    }

    /// Returns the work of one evaluation, in sums and products: a function of one number counts as four.
    pub fn work(&self) -> u64 {
        let work = |instruction: &Instruction| match instruction.operation {
            TapeOperation::Unary(op, _) if op != Unary::Neg => 4,
            _ => 1,
        };
        self.instructions.iter().map(work).sum()
    }

    /// Returns the number of registers that an evaluation uses.
    pub fn register_count(&self) -> usize {
        self.register_count
    }

    /// Evaluates at one point. `inputs` are in the order of [`Tape::inputs`]; `out` has one element per root.
    ///
    /// # Panics
    /// If `inputs` or `out` has a different length.
    pub fn eval(&self, registers: &mut Registers, inputs: &[f64], out: &mut [f64]) {
        assert_eq!(inputs.len(), self.inputs.len(), "one number per input");
        assert_eq!(out.len(), self.roots.len(), "one place per root");
        let registers = &mut registers.numbers;
        if registers.len() < self.register_count {
            registers.resize(self.register_count, 0.0);
        }
        let read = |registers: &[f64], operand| match operand {
            Operand::Constant(value) => value,
            Operand::Input(position) => inputs[position as usize],
            Operand::Register(register) => registers[register as usize],
        };
        for instruction in &self.instructions {
            registers[instruction.out as usize] = match instruction.operation {
                TapeOperation::Unary(op, a) => op.eval(read(registers, a)),
                TapeOperation::Binary(op, a, b) => op.eval(read(registers, a), read(registers, b)),
                TapeOperation::Power(a, n) => ops::integer_power(read(registers, a), n),
            };
        }
        for (out, &root) in out.iter_mut().zip(&self.roots) {
            *out = read(registers, root);
        }
    }

    /// Evaluates at [`LANES`] points: the same operations in the same order as [`Tape::eval`], so the results are equal
    /// to the last bit (except for a NaN's sign and payload).
    ///
    /// # Panics
    /// If the length of `inputs` differs from that of [`Tape::inputs`], or `out` does not have one element per root.
    pub fn eval_block(&self, registers: &mut Registers, inputs: &[Block], out: &mut [Block]) {
        assert_eq!(inputs.len(), self.inputs.len(), "one block per input");
        assert_eq!(out.len(), self.roots.len(), "one place per root");
        let blocks = &mut registers.blocks;
        // One more than the registers: the destination of the next result. It is then swapped with the register of the
        // result, which may also be one of its operands.
        while blocks.len() <= self.register_count {
            blocks.push(Box::new([0.0; LANES]));
        }
        let Some((result, blocks)) = blocks.split_last_mut() else {
            return;
        };
        for instruction in &self.instructions {
            match instruction.operation {
                TapeOperation::Unary(op, a) => match lanes(blocks, inputs, a) {
                    Lanes::Each(a) => op.eval_lanes(a, result),
                    Lanes::Same(a) => **result = [op.eval(a); LANES],
                },
                TapeOperation::Binary(op, a, b) => {
                    op.eval_lanes(lanes(blocks, inputs, a), lanes(blocks, inputs, b), result);
                }
                TapeOperation::Power(a, n) => match lanes(blocks, inputs, a) {
                    Lanes::Each(a) => ops::integer_power_lanes(a, n, result),
                    Lanes::Same(a) => **result = [ops::integer_power(a, n); LANES],
                },
            }
            std::mem::swap(result, &mut blocks[instruction.out as usize]);
        }
        for (out, &root) in out.iter_mut().zip(&self.roots) {
            match lanes(blocks, inputs, root) {
                Lanes::Each(block) => *out = *block,
                Lanes::Same(value) => *out = [value; LANES],
            }
        }
    }
}

/// Allocates registers.
struct Compiler {
    places: FxHashMap<NodeId, Operand>,
    free: Vec<u32>,
    register_count: u32,
    /// The number of remaining uses of each node.
    uses: FxHashMap<NodeId, u32>,
}

impl Compiler {
    /// Returns the location of a node's value; after its last use its register is freed.
    fn take(&mut self, id: NodeId) -> Operand {
        let place = self.places[&id];
        if let (Operand::Register(register), Some(uses)) = (place, self.uses.get_mut(&id))
            && *uses != u32::MAX
        {
            *uses -= 1;
            if *uses == 0 {
                self.free.push(register);
            }
        }
        place
    }

    /// Returns a register for a node's value.
    fn give(&mut self, id: NodeId) -> u32 {
        let register = self.free.pop().unwrap_or_else(|| {
            self.register_count += 1;
            self.register_count - 1
        });
        self.places.insert(id, Operand::Register(register));
        register
    }
}

/// Returns the nodes that the roots need, each right after its operands where possible: values are used soon, which
/// requires few registers.
fn post_order(graph: &Graph, roots: &[NodeId]) -> Vec<NodeId> {
    let mut seen = rustc_hash::FxHashSet::default();
    let mut order = Vec::new();
    // A node, and whether its operands have been ordered.
    let mut stack: Vec<(NodeId, bool)> = Vec::new();
    for &root in roots {
        stack.push((root, false));
        while let Some((id, ready)) = stack.pop() {
            if ready {
                order.push(id);
            } else if seen.insert(id) {
                stack.push((id, true));
                let operands: Vec<NodeId> = graph.node(id).operands().collect();
                stack.extend(operands.into_iter().rev().map(|operand| (operand, false)));
            }
        }
    }
    order
}

fn lanes<'a>(blocks: &'a [Box<Block>], inputs: &'a [Block], operand: Operand) -> Lanes<'a, LANES> {
    match operand {
        Operand::Constant(value) => Lanes::Same(value),
        Operand::Input(position) => Lanes::Each(&inputs[position as usize]),
        Operand::Register(register) => Lanes::Each(&blocks[register as usize]),
    }
}
