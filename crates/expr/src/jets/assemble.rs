//! From coefficients to code: only those that the roots need, in an order that uses few registers. Sums of products are
//! one instruction, and so are sine and cosine of the same angle.
//!
//! In: an [`Expansion`]. Out: [`StraightLineCode`] over registers: first the two variables, then fixed numbers, then
//! computed values. A register is reused after the last use of its value; those of fixed numbers never are, so that
//! they stay filled between evaluations.

use crate::jets::expand::Expansion;
use crate::jets::terms::{Micro, Term};
use crate::ops::{Binary, Unary};

/// Straight-line code.
#[derive(Clone, Debug)]
pub(super) struct StraightLineCode {
    pub(super) program: Instructions,
    /// The coefficients in the registers from [`FIRST_FIXED`] on.
    pub(super) fixed: Vec<u32>,
    /// The coefficient that is the factor of each element of `places`, and true if it is negated.
    pub(super) factors: Vec<(u32, bool)>,
    pub(super) register_count: usize,
}

/// Instructions and the registers of their results: over few registers, which is usual, or over many.
#[derive(Clone, Debug)]
pub(super) enum Instructions {
    /// All registers are among the first [`FEW`].
    Few(Steps<u8>),
    Many(Steps<u32>),
}

/// The number of registers that a byte can address.
pub(super) const FEW: usize = 256;

/// A program whose registers are addressed by `R`.
#[derive(Clone, Debug)]
pub(super) struct Steps<R> {
    pub(super) instructions: Vec<Instruction<R>>,
    /// The register of each coefficient and root, before its factor; all values first.
    pub(super) places: Vec<R>,
}

/// The register of the first fixed number; the variables come before it.
pub(super) const FIRST_FIXED: usize = 2;

/// One instruction: registers in, registers out. A result may overwrite an operand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instruction<R> {
    pub(super) op: Op,
    pub(super) out: R,
    /// The register of the second result, if there is one.
    pub(super) second: R,
    pub(super) operands: [R; 4],
}

/// An operation on the operands a, b, c, d.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Op {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Zmul,
    Min,
    Max,
    AtMost,
    /// a·b + c.
    ProductPlus,
    /// a·b − c.
    ProductMinus,
    /// c − a·b.
    MinusProduct,
    /// a·b + c·d.
    ProductsPlus,
    /// a·b − c·d.
    ProductsMinus,
    Neg,
    SinCos,
    SinhCosh,
    Tan,
    Exp,
    Log,
    Sqrt,
    Asin,
    Acos,
    Atan,
    Tanh,
    Sech,
    Abs,
    Sign,
}

/// No coefficient, or no register.
const NOWHERE: u32 = u32::MAX;

/// The computation of a coefficient.
#[derive(Clone, Copy, Debug)]
struct Plan {
    op: Op,
    operands: [u32; 4],
    count: usize,
}

/// Generates the code for roots of this many coefficients each.
pub(super) fn assemble(expansion: &Expansion, coefficients: usize) -> StraightLineCode {
    let uses = count_uses(expansion);
    let plans = Plans {
        expansion,
        uses: &uses,
    };
    let (order, partners) = plans.schedule();
    let mut registers = Allocation::new(expansion, &plans, &order);
    let mut instructions = Vec::with_capacity(order.len());
    for &id in &order {
        let plan = plans.of(id);
        let mut operands = [0; 4];
        for (place, &operand) in operands.iter_mut().zip(&plan.operands[..plan.count]) {
            *place = registers.take(operand);
        }
        // A pair's results are the sine and the cosine; an unused one frees its register at once.
        let pair = partners[id as usize];
        let results = match expansion.micros[id as usize] {
            Micro::Unary(Unary::Sin | Unary::Sinh, _) => vec![id, pair],
            Micro::Unary(Unary::Cos | Unary::Cosh, _) => vec![pair, id],
            _ => vec![id],
        };
        let places: Vec<u32> = results.iter().map(|&id| registers.give(id)).collect();
        for (&result, &place) in results.iter().zip(&places) {
            if result == NOWHERE {
                registers.free.push(place);
            }
        }
        let (out, second) = (places[0], places[places.len() - 1]);
        instructions.push(Instruction {
            op: plan.op,
            out,
            second,
            operands,
        });
    }
    let roots: Vec<Term> = (0..coefficients)
        .flat_map(|k| expansion.roots.iter().skip(k).step_by(coefficients))
        .copied()
        .collect();
    let places = roots.iter().map(|term| registers.places[term.id as usize]);
    let places = places.collect();
    let register_count = registers.count as usize;
    let steps = Steps {
        instructions,
        places,
    };
    StraightLineCode {
        program: if register_count <= FEW {
            Instructions::Few(steps.named(|register| register as u8))
        } else {
            Instructions::Many(steps)
        },
        register_count,
        fixed: registers.fixed,
        factors: roots
            .iter()
            .map(|term| (term.factor, term.negative))
            .collect(),
    }
}

impl Instructions {
    pub(super) fn instruction_count(&self) -> usize {
        match self {
            Self::Few(steps) => steps.instructions.len(),
            Self::Many(steps) => steps.instructions.len(),
        }
    }

    pub(super) fn place_count(&self) -> usize {
        match self {
            Self::Few(steps) => steps.places.len(),
            Self::Many(steps) => steps.places.len(),
        }
    }
}

impl<R: Copy> Steps<R> {
    /// Returns the steps with registers renamed.
    fn named<S>(self, name: impl Fn(R) -> S) -> Steps<S> {
        let instructions = self.instructions.into_iter().map(|i| Instruction {
            op: i.op,
            out: name(i.out),
            second: name(i.second),
            operands: i.operands.map(&name),
        });
        let places = self.places.into_iter();
        Steps {
            instructions: instructions.collect(),
            places: places.map(name).collect(),
        }
    }
}

/// Returns the number of uses of each coefficient in those that the roots need; all others have no uses.
fn count_uses(expansion: &Expansion) -> Vec<u32> {
    let mut uses = vec![0u32; expansion.micros.len()];
    for root in &expansion.roots {
        // A root's register is never freed.
        uses[root.id as usize] = u32::MAX;
    }
    for id in (0..expansion.micros.len()).rev() {
        if uses[id] > 0 && expansion.varying[id] {
            for operand in expansion.micros[id].operands() {
                let count = &mut uses[operand as usize];
                *count = count.saturating_add(1);
            }
        }
    }
    uses
}

struct Plans<'a> {
    expansion: &'a Expansion,
    uses: &'a [u32],
}

impl Plans<'_> {
    /// Returns the factors of a product that is used only here, and so does not need a register.
    fn absorbed(&self, id: u32) -> Option<(u32, u32)> {
        match self.expansion.micros[id as usize] {
            Micro::Binary(Binary::Mul, a, b)
                if self.uses[id as usize] == 1 && self.expansion.varying[id as usize] =>
            {
                Some((a, b))
            }
            _ => None,
        }
    }

    fn of(&self, id: u32) -> Plan {
        let plan = |op, operands: &[u32]| {
            let mut all = [0; 4];
            all[..operands.len()].copy_from_slice(operands);
            Plan {
                op,
                operands: all,
                count: operands.len(),
            }
        };
        match self.expansion.micros[id as usize] {
            // Leaves have no plan; this is never requested.
            Micro::Constant(_) | Micro::Uniform(_) | Micro::Variable(_) => plan(Op::Neg, &[id]),
            Micro::Neg(a) => plan(Op::Neg, &[a]),
            Micro::Unary(op, a) => plan(unary_op(op), &[a]),
            Micro::Binary(Binary::Add, a, b) => match (self.absorbed(a), self.absorbed(b)) {
                (Some((a, b)), Some((c, d))) => plan(Op::ProductsPlus, &[a, b, c, d]),
                (Some((a, b)), None) => plan(Op::ProductPlus, &[a, b, self.same(id, 1)]),
                (None, Some((c, d))) => plan(Op::ProductPlus, &[c, d, a]),
                (None, None) => plan(Op::Add, &[a, b]),
            },
            Micro::Binary(Binary::Sub, a, b) => match (self.absorbed(a), self.absorbed(b)) {
                (Some((a, b)), Some((c, d))) => plan(Op::ProductsMinus, &[a, b, c, d]),
                (Some((a, b)), None) => plan(Op::ProductMinus, &[a, b, self.same(id, 1)]),
                (None, Some((c, d))) => plan(Op::MinusProduct, &[c, d, a]),
                (None, None) => plan(Op::Sub, &[a, b]),
            },
            Micro::Binary(op, a, b) => plan(binary_op(op), &[a, b]),
        }
    }

    /// Returns an operand of a coefficient by its index.
    fn same(&self, id: u32, position: usize) -> u32 {
        self.expansion.micros[id as usize]
            .operands()
            .nth(position)
            .unwrap_or(id)
    }

    /// Returns the computations, operands first, each as late as possible; and for sines and cosines, circular or
    /// hyperbolic, the partner that is computed along with it if it is needed.
    fn schedule(&self) -> (Vec<u32>, Vec<u32>) {
        let count = self.expansion.micros.len();
        let partners = self.partners();
        let mut done = vec![false; count];
        let mut order = Vec::with_capacity(count);
        let mut stack: Vec<(u32, bool)> = Vec::new();
        for root in &self.expansion.roots {
            stack.push((root.id, false));
            while let Some((id, ready)) = stack.pop() {
                if !self.expansion.varying[id as usize]
                    || done[id as usize]
                    || matches!(self.expansion.micros[id as usize], Micro::Variable(_))
                {
                    continue;
                }
                if ready {
                    done[id as usize] = true;
                    let pair = partners[id as usize];
                    if pair != NOWHERE {
                        done[pair as usize] = true;
                    }
                    order.push(id);
                } else {
                    stack.push((id, true));
                    let plan = self.of(id);
                    for &operand in plan.operands[..plan.count].iter().rev() {
                        stack.push((operand, false));
                    }
                }
            }
        }
        (order, partners)
    }

    fn partners(&self) -> Vec<u32> {
        let mut partners = vec![NOWHERE; self.expansion.micros.len()];
        // For each operand, the first sine and hyperbolic sine, or their cosine.
        let mut first: [rustc_hash::FxHashMap<u32, u32>; 2] = Default::default();
        for (id, micro) in self.expansion.micros.iter().enumerate() {
            if self.uses[id] == 0 {
                continue;
            }
            let (kind, operand) = match *micro {
                Micro::Unary(Unary::Sin | Unary::Cos, a) => (0, a),
                Micro::Unary(Unary::Sinh | Unary::Cosh, a) => (1, a),
                _ => continue,
            };
            match first[kind].get(&operand) {
                None => {
                    first[kind].insert(operand, id as u32);
                }
                Some(&other) => {
                    partners[id] = other;
                    partners[other as usize] = id as u32;
                }
            }
        }
        partners
    }
}

fn unary_op(op: Unary) -> Op {
    match op {
        Unary::Neg => Op::Neg,
        Unary::Sin | Unary::Cos => Op::SinCos,
        Unary::Tan => Op::Tan,
        Unary::Exp => Op::Exp,
        Unary::Log => Op::Log,
        Unary::Sqrt => Op::Sqrt,
        Unary::Asin => Op::Asin,
        Unary::Acos => Op::Acos,
        Unary::Atan => Op::Atan,
        Unary::Sinh | Unary::Cosh => Op::SinhCosh,
        Unary::Tanh => Op::Tanh,
        Unary::Sech => Op::Sech,
        Unary::Abs => Op::Abs,
        Unary::Sign => Op::Sign,
    }
}

fn binary_op(op: Binary) -> Op {
    match op {
        Binary::Add => Op::Add,
        Binary::Sub => Op::Sub,
        Binary::Mul => Op::Mul,
        Binary::Div => Op::Div,
        Binary::Pow => Op::Pow,
        Binary::Zmul => Op::Zmul,
        Binary::Min => Op::Min,
        Binary::Max => Op::Max,
        Binary::AtMost => Op::AtMost,
    }
}

/// Allocates registers.
struct Allocation {
    /// The register of each coefficient that has one.
    places: Vec<u32>,
    /// The number of remaining reads of each; [`u32::MAX`] for a permanent one.
    reads: Vec<u32>,
    free: Vec<u32>,
    fixed: Vec<u32>,
    count: u32,
}

impl Allocation {
    fn new(expansion: &Expansion, plans: &Plans<'_>, order: &[u32]) -> Self {
        let micros = expansion.micros.len();
        let mut allocation = Self {
            places: vec![NOWHERE; micros],
            reads: vec![0; micros],
            free: Vec::new(),
            fixed: Vec::new(),
            count: FIRST_FIXED as u32,
        };
        for root in &expansion.roots {
            allocation.fix(expansion, root.id);
            allocation.reads[root.id as usize] = u32::MAX;
        }
        for &id in order {
            let plan = plans.of(id);
            for &operand in &plan.operands[..plan.count] {
                allocation.fix(expansion, operand);
                let reads = &mut allocation.reads[operand as usize];
                *reads = reads.saturating_add(1);
            }
        }
        allocation
    }

    /// Gives variables and fixed numbers permanent registers.
    fn fix(&mut self, expansion: &Expansion, id: u32) {
        let place = &mut self.places[id as usize];
        if *place != NOWHERE {
            return;
        }
        if let Micro::Variable(k) = expansion.micros[id as usize] {
            *place = k;
        } else if !expansion.varying[id as usize] {
            *place = self.count;
            self.count += 1;
            self.fixed.push(id);
        } else {
            return;
        }
        self.reads[id as usize] = u32::MAX;
    }

    fn take(&mut self, id: u32) -> u32 {
        let place = self.places[id as usize];
        let reads = &mut self.reads[id as usize];
        if *reads != u32::MAX {
            *reads -= 1;
            if *reads == 0 {
                self.free.push(place);
            }
        }
        place
    }

    fn give(&mut self, id: u32) -> u32 {
        let register = self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        });
        if id != NOWHERE {
            self.places[id as usize] = register;
        }
        register
    }
}
