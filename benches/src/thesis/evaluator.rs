//! Symbolic derivatives in lanes of either precision: expressions in, an interpreter over vectors out.
//!
//! Each node of the graph has a register of its own; shared subexpressions, and the sine and cosine of one angle, are
//! computed once. Constants and uniforms are filled in beforehand.

use expr::graph::{Node, TooLarge};
use expr::ops::{Binary, Unary};
use expr::processor::{Processor, Work};
use expr::{Graph, Input, NodeId};

use super::Pair;
use super::real::Real;

/// Straight-line code: a register for each node.
#[derive(Clone, Debug)]
pub(crate) struct Code {
    steps: Vec<Step>,
    /// The registers that hold the same number at every point.
    fixed: Vec<(u32, f64)>,
    variables: Vec<(u32, usize)>,
    roots: Vec<u32>,
    registers: usize,
}

#[derive(Clone, Copy, Debug)]
struct Step {
    operation: Operation,
    /// The operands' registers.
    from: [u32; 2],
    /// The registers of the result, and of a second one.
    to: [u32; 2],
}

#[derive(Clone, Copy, Debug)]
enum Operation {
    Unary(Unary),
    Binary(Binary),
    Power(i32),
    SinCos,
    SinhCosh,
}

impl Code {
    /// Compiles the roots; a uniform without a value is NaN.
    pub(super) fn new(graph: &Graph, roots: &[NodeId], uniforms: &[f64]) -> Self {
        let order = graph.order(roots);
        // Results that nothing wants.
        let spare = order.len() as u32;
        let place = |id: NodeId| order.binary_search(&id).map_or(spare, |place| place as u32);
        let partner = |op: Unary, operand: NodeId| {
            let wanted = Node::Unary(op, operand);
            let found = order.iter().find(|id| graph.node(**id) == wanted);
            found.map_or(spare, |id| place(*id))
        };
        let mut code = Self {
            steps: Vec::new(),
            fixed: Vec::new(),
            variables: Vec::new(),
            roots: roots.iter().map(|root| place(*root)).collect(),
            registers: order.len() + 1,
        };
        let mut done = vec![false; order.len() + 1];
        for &id in &order {
            let to = place(id);
            if done[to as usize] {
                continue;
            }
            let mut step = |operation, from: [NodeId; 2], to: [u32; 2]| {
                let from = from.map(place);
                for register in to {
                    done[register as usize] = true;
                }
                code.steps.push(Step {
                    operation,
                    from,
                    to,
                });
            };
            match graph.node(id) {
                Node::Constant(value) => code.fixed.push((to, value)),
                Node::Input(Input::Variable(k)) => code.variables.push((to, k as usize)),
                Node::Input(Input::Uniform(k)) => {
                    let value = uniforms.get(k as usize).copied().unwrap_or(f64::NAN);
                    code.fixed.push((to, value));
                }
                Node::Unary(Unary::Sin | Unary::Cos, a) => {
                    let pair = [Unary::Sin, Unary::Cos].map(|op| partner(op, a));
                    step(Operation::SinCos, [a; 2], pair);
                }
                Node::Unary(Unary::Sinh | Unary::Cosh, a) => {
                    let pair = [Unary::Sinh, Unary::Cosh].map(|op| partner(op, a));
                    step(Operation::SinhCosh, [a; 2], pair);
                }
                Node::Unary(op, a) => step(Operation::Unary(op), [a; 2], [to; 2]),
                Node::Power(a, n) => step(Operation::Power(n), [a; 2], [to; 2]),
                Node::Binary(op, a, b) => step(Operation::Binary(op), [a, b], [to; 2]),
            }
        }
        code
    }

    /// The position and its derivatives up to order two: σ, σu, σv, σuu, σuv, σvv.
    pub(super) fn embedded(
        graph: &Graph,
        position: [NodeId; 3],
        uniforms: &[f64],
    ) -> Result<Self, TooLarge> {
        let [u, v] = [Input::Variable(0), Input::Variable(1)];
        let (mut graph, position) = graph.extract(&position);
        let du = graph.derivatives(&position, u)?;
        let dv = graph.derivatives(&position, v)?;
        let duu = graph.derivatives(&du, u)?;
        let duv = graph.derivatives(&du, v)?;
        let dvv = graph.derivatives(&dv, v)?;
        let roots = [position, du, dv, duu, duv, dvv].concat();
        Ok(Self::new(&graph, &roots, uniforms))
    }

    /// E, F, G, then their derivatives by u, then by v.
    pub(super) fn intrinsic(
        graph: &Graph,
        form: [NodeId; 3],
        uniforms: &[f64],
    ) -> Result<Self, TooLarge> {
        let (mut graph, form) = graph.extract(&form);
        let by_u = graph.derivatives(&form, Input::Variable(0))?;
        let by_v = graph.derivatives(&form, Input::Variable(1))?;
        Ok(Self::new(&graph, &[form, by_u, by_v].concat(), uniforms))
    }

    /// Registers for its evaluations.
    pub(super) fn registers<T: Real, const N: usize>(&self) -> Vec<[T; N]> {
        let mut registers = vec![[T::default(); N]; self.registers];
        for &(register, value) in &self.fixed {
            registers[register as usize] = [T::nearest(value); N];
        }
        registers
    }

    /// Evaluates the roots at `N` points.
    #[inline(always)]
    pub(super) fn eval<T: Real, const N: usize>(
        &self,
        processor: Processor,
        registers: &mut [[T; N]],
        at: &Pair<T, N>,
        out: &mut [[T; N]],
    ) {
        processor.run(Evaluation {
            code: self,
            registers,
            at,
            out,
        });
    }
}

/// One evaluation, compiled for the processor's vectors.
struct Evaluation<'a, T, const N: usize> {
    code: &'a Code,
    registers: &'a mut [[T; N]],
    at: &'a Pair<T, N>,
    out: &'a mut [[T; N]],
}

impl<T: Real, const N: usize> Work for Evaluation<'_, T, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let registers = self.registers;
        for &(register, k) in &self.code.variables {
            registers[register as usize] = self.at[k.min(1)];
        }
        for step in &self.code.steps {
            let [a, b] = step.from.map(|register| register as usize);
            let [first, second] = step.to.map(|register| register as usize);
            match step.operation {
                Operation::SinCos => {
                    let a = registers[a];
                    (registers[first], registers[second]) = T::sin_cos(&a);
                }
                Operation::SinhCosh => {
                    let a = registers[a];
                    (registers[first], registers[second]) = T::sinh_cosh(&a);
                }
                Operation::Unary(op) => unary(op, registers, a, first),
                Operation::Binary(op) => binary(op, registers, [a, b], first),
                Operation::Power(n) => power(registers, a, n, first),
            }
        }
        for (out, &root) in self.out.iter_mut().zip(&self.code.roots) {
            *out = registers[root as usize];
        }
    }
}

/// Fills a register from others, in a loop of its own. Each operation reads and writes the registers itself: results
/// that several operations handed back by value would meet in one place on the stack, written in narrower pieces than
/// they are read in, and the processor would wait for each of those.
macro_rules! each {
    ($registers:ident[$to:ident], |$($x:ident),+| $value:expr) => {{
        $(let $x = $registers[$x];)+
        let out = &mut $registers[$to];
        for lane in 0..N {
            $(let $x = $x[lane];)+
            out[lane] = $value;
        }
    }};
}

#[inline(always)]
fn unary<T: Real, const N: usize>(op: Unary, registers: &mut [[T; N]], x: usize, to: usize) {
    match op {
        Unary::Neg => each!(registers[to], |x| -x),
        Unary::Sin => registers[to] = T::sin_cos(&{ registers[x] }).0,
        Unary::Cos => registers[to] = T::sin_cos(&{ registers[x] }).1,
        Unary::Tan => registers[to] = T::tan(&{ registers[x] }),
        Unary::Exp => registers[to] = T::exp(&{ registers[x] }),
        Unary::Log => registers[to] = T::log(&{ registers[x] }),
        Unary::Sinh => registers[to] = T::sinh_cosh(&{ registers[x] }).0,
        Unary::Cosh => registers[to] = T::sinh_cosh(&{ registers[x] }).1,
        Unary::Tanh => registers[to] = T::tanh(&{ registers[x] }),
        Unary::Sech => {
            let (_, cosh) = T::sinh_cosh(&{ registers[x] });
            registers[to] = cosh.map(|cosh| T::ONE / cosh);
        }
        Unary::Sqrt => each!(registers[to], |x| x.sqrt()),
        Unary::Asin => each!(registers[to], |x| x.asin()),
        Unary::Acos => each!(registers[to], |x| x.acos()),
        Unary::Atan => each!(registers[to], |x| x.atan()),
        Unary::Abs => each!(registers[to], |x| x.abs()),
        Unary::Sign => each!(registers[to], |x| sign(x)),
    }
}

#[inline(always)]
fn binary<T: Real, const N: usize>(
    op: Binary,
    registers: &mut [[T; N]],
    [a, b]: [usize; 2],
    to: usize,
) {
    match op {
        Binary::Add => each!(registers[to], |a, b| a + b),
        Binary::Sub => each!(registers[to], |a, b| a - b),
        Binary::Mul => each!(registers[to], |a, b| a * b),
        Binary::Div => each!(registers[to], |a, b| a / b),
        Binary::Pow => each!(registers[to], |a, b| T::power(a, b)),
        Binary::Zmul => each!(registers[to], |a, b| if a == T::default() {
            a
        } else {
            a * b
        }),
        Binary::Min => each!(registers[to], |a, b| if a <= b { a } else { b }),
        Binary::Max => each!(registers[to], |a, b| if a >= b { a } else { b }),
        Binary::AtMost => each!(registers[to], |a, b| if a <= b {
            T::ONE
        } else {
            T::default()
        }),
    }
}

/// As [`expr::ops::integer_power`].
#[inline(always)]
fn power<T: Real, const N: usize>(registers: &mut [[T; N]], x: usize, n: i32, to: usize) {
    let mut remaining = n.unsigned_abs();
    let mut square = registers[x];
    let mut result = [T::ONE; N];
    while remaining != 0 {
        if remaining & 1 == 1 {
            for lane in 0..N {
                result[lane] = result[lane] * square[lane];
            }
        }
        for square in &mut square {
            *square = *square * *square;
        }
        remaining >>= 1;
    }
    let out = &mut registers[to];
    for lane in 0..N {
        out[lane] = if n < 0 {
            T::ONE / result[lane]
        } else {
            result[lane]
        };
    }
}

/// As [`expr::ops::sign`].
#[inline(always)]
fn sign<T: Real>(x: T) -> T {
    let zero = T::default();
    if x > zero {
        T::ONE
    } else if x < zero {
        -T::ONE
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use expr::conformance::{anchors, cases};

    /// Values in both precisions, eight and sixteen at a time.
    fn values(graph: &Graph, root: NodeId, operands: [f64; 2]) -> ([f64; 8], [f32; 16]) {
        let code = Code::new(graph, &[root], &[]);
        let (mut double, mut single) = ([[f64::NAN; 8]], [[f32::NAN; 16]]);
        let processor = Processor::here();
        let at = operands.map(|x| [x; 8]);
        code.eval(processor, &mut code.registers(), &at, &mut double);
        let at = operands.map(|x| [x as f32; 16]);
        code.eval(processor, &mut code.registers(), &at, &mut single);
        (double[0], single[0])
    }

    #[test]
    fn both_precisions_are_held_to_the_conformance_list() {
        for case in cases().iter().chain(&anchors()) {
            let mut graph = Graph::default();
            let [u, v] = [0, 1].map(|k| graph.input(Input::Variable(k)));
            let root = case.operation.node(&mut graph, u, v);
            let (double, single) = values(&graph, root, case.operands);
            let expected = |operands: [f64; 2]| {
                let operands = &operands[..case.operation.arity()];
                case.operation.eval(operands).expect("as many operands")
            };
            let exact = expected(case.operands);
            let close = double
                .iter()
                .all(|&value| value == exact || (value - exact).abs() <= 6.7e-16 * exact.abs());
            assert!(close, "{case:?}: {double:?}");
            let exact = expected(case.operands.map(|x| f64::from(x as f32)));
            let close = single.iter().all(|&value| {
                value == exact as f32 || (f64::from(value) - exact).abs() <= 4e-7 * exact.abs()
            });
            assert!(close, "{case:?}: {single:?}");
        }
    }
}
