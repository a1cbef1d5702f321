//! Evaluation in f64: a graph's roots as straight-line code over registers.

use rustc_hash::FxHashMap;

use crate::graph::{Graph, Input, Node, NodeId};
use crate::ops::{Binary, Unary, integer_power};

/// How many points [`Tape::eval_block`] evaluates at once.
pub const LANES: usize = 64;
/// One number for each lane.
pub type Block = [f64; LANES];

#[derive(Clone, Copy, Debug)]
enum Instruction {
    Constant(f64),
    Input(u32),
    Unary(Unary, u32),
    Binary(Binary, u32, u32),
    IntegerPower(u32, i32),
}

/// Straight-line code for some roots. Registers are used again once their value is no longer needed.
#[derive(Clone, Debug)]
pub struct Tape {
    inputs: Vec<Input>,
    code: Vec<(Instruction, u32)>,
    outputs: Vec<u32>,
    registers: usize,
}

/// Registers; reused between evaluations so that none allocates. One per thread.
#[derive(Clone, Debug, Default)]
pub struct Registers {
    scalars: Vec<f64>,
    blocks: Vec<Block>,
}

impl Tape {
    /// Compiles the roots.
    pub fn new(graph: &Graph, roots: &[NodeId]) -> Self {
        let order = graph.reachable(roots);
        let inputs = graph.inputs(roots);
        let mut last_use: FxHashMap<NodeId, usize> = FxHashMap::default();
        for (position, &id) in order.iter().enumerate() {
            for operand in graph.node(id).operands() {
                last_use.insert(operand, position);
            }
        }
        for &root in roots {
            last_use.insert(root, usize::MAX);
        }
        let mut free: Vec<u32> = Vec::new();
        let mut count = 0u32;
        let mut place: FxHashMap<NodeId, u32> = FxHashMap::default();
        let mut code = Vec::with_capacity(order.len());
        for (position, &id) in order.iter().enumerate() {
            let node = graph.node(id);
            let instruction = match node {
                Node::Constant(bits) => Instruction::Constant(f64::from_bits(bits)),
                Node::Input(input) => {
                    Instruction::Input(inputs.binary_search(&input).unwrap_or_default() as u32)
                }
                Node::Unary(op, a) => Instruction::Unary(op, place[&a]),
                Node::Binary(op, a, b) => Instruction::Binary(op, place[&a], place[&b]),
                Node::IntegerPower(a, n) => Instruction::IntegerPower(place[&a], n),
            };
            for operand in node.operands() {
                if last_use.get(&operand) == Some(&position) {
                    // Removed, so that `x op x` gives its register back once.
                    if let Some(register) = place.remove(&operand) {
                        free.push(register);
                    }
                }
            }
            let register = free.pop().unwrap_or_else(|| {
                count += 1;
                count - 1
            });
            place.insert(id, register);
            code.push((instruction, register));
        }
        Self {
            inputs,
            code,
            outputs: roots.iter().map(|root| place[root]).collect(),
            registers: count as usize,
        }
    }

    /// The inputs in the order in which evaluation takes them: sorted.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// How many numbers one evaluation gives.
    pub fn output_count(&self) -> usize {
        self.outputs.len()
    }

    /// How many registers an evaluation uses.
    pub fn register_count(&self) -> usize {
        self.registers
    }

    /// How many operations one evaluation runs; constants and inputs are none.
    pub fn operation_count(&self) -> usize {
        self.code
            .iter()
            .filter(|(instruction, _)| {
                !matches!(
                    instruction,
                    Instruction::Constant(_) | Instruction::Input(_)
                )
            })
            .count()
    }

    /// Evaluates at one point. `inputs` follows [`Tape::inputs`]; `out` has one place per root.
    ///
    /// # Panics
    /// Where `inputs` or `out` is too short.
    pub fn eval(&self, registers: &mut Registers, inputs: &[f64], out: &mut [f64]) {
        let file = &mut registers.scalars;
        if file.len() < self.registers {
            file.resize(self.registers, 0.0);
        }
        for &(instruction, target) in &self.code {
            file[target as usize] = match instruction {
                Instruction::Constant(value) => value,
                Instruction::Input(index) => inputs[index as usize],
                Instruction::Unary(op, a) => op.eval(file[a as usize]),
                Instruction::Binary(op, a, b) => op.eval(file[a as usize], file[b as usize]),
                Instruction::IntegerPower(a, n) => integer_power(file[a as usize], n),
            };
        }
        for (place, &register) in out.iter_mut().zip(&self.outputs) {
            *place = file[register as usize];
        }
    }

    /// Evaluates at [`LANES`] points: the same operations in the same order as [`Tape::eval`], so the same
    /// results to the last bit.
    ///
    /// # Panics
    /// Where `inputs` or `out` is too short.
    pub fn eval_block(&self, registers: &mut Registers, inputs: &[Block], out: &mut [Block]) {
        let file = &mut registers.blocks;
        if file.len() < self.registers {
            file.resize(self.registers, [0.0; LANES]);
        }
        for &(instruction, target) in &self.code {
            // A copy of each operand lets the compiler see that target and operands do not overlap.
            let value = match instruction {
                Instruction::Constant(value) => [value; LANES],
                Instruction::Input(index) => inputs[index as usize],
                Instruction::Unary(op, a) => unary_block(op, &file[a as usize]),
                Instruction::Binary(op, a, b) => {
                    binary_block(op, &file[a as usize], &file[b as usize])
                }
                Instruction::IntegerPower(a, n) => map(&file[a as usize], |x| integer_power(x, n)),
            };
            file[target as usize] = value;
        }
        for (place, &register) in out.iter_mut().zip(&self.outputs) {
            *place = file[register as usize];
        }
    }
}

fn map(a: &Block, f: impl Fn(f64) -> f64) -> Block {
    let mut out = [0.0; LANES];
    for (out, &a) in out.iter_mut().zip(a) {
        *out = f(a);
    }
    out
}

fn zip(a: &Block, b: &Block, f: impl Fn(f64, f64) -> f64) -> Block {
    let mut out = [0.0; LANES];
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = f(a, b);
    }
    out
}

/// One loop per operation, so that those the processor has become vector instructions.
fn unary_block(op: Unary, a: &Block) -> Block {
    match op {
        Unary::Negate => map(a, |a| -a),
        Unary::Abs => map(a, f64::abs),
        Unary::Sqrt => map(a, f64::sqrt),
        _ => map(a, |a| op.eval(a)),
    }
}

fn binary_block(op: Binary, a: &Block, b: &Block) -> Block {
    match op {
        Binary::Add => zip(a, b, |a, b| a + b),
        Binary::Subtract => zip(a, b, |a, b| a - b),
        Binary::Multiply => zip(a, b, |a, b| a * b),
        Binary::Divide => zip(a, b, |a, b| a / b),
        Binary::Power | Binary::AnnihilatingProduct => zip(a, b, |a, b| op.eval(a, b)),
    }
}
