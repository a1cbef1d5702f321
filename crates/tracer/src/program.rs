//! Polynomials along rays, by the operations of their expressions.
//!
//! In: an expression of sums and products of coordinates and numbers, then rays. Out: the polynomial along a ray. A product
//! of factors has far more terms than the factors together; its expression multiplies the factors as polynomials of one
//! variable.

use expr::ops::{Binary, Unary};
use expr::{Graph, Input, Node, NodeId};
use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::roots::{Coefficients, LARGEST_DEGREE};

/// The operations that compute a polynomial of one variable.
#[derive(Clone, Debug)]
pub(crate) struct PolynomialProgram {
    /// Each step with the degree of its result.
    steps: Vec<(PolynomialStep, usize)>,
}

/// An operation on results of earlier steps.
#[derive(Clone, Copy, Debug)]
enum PolynomialStep {
    /// middle + half·coordinate.
    Coordinate {
        axis: usize,
        middle: f64,
        half: f64,
    },
    Number(f64),
    Scaled(usize, f64),
    Sum(usize, usize),
    Difference(usize, usize),
    Product(usize, usize),
}

/// The maximum number of steps of a program.
const MOST_STEPS: usize = 64;

/// Reads an expression.
struct ProgramReader {
    steps: Vec<(PolynomialStep, usize)>,
    known: FxHashMap<NodeId, usize>,
}

impl PolynomialProgram {
    /// Reads an expression in the coordinates of `frame`, which gives the centre and half the side of each. Returns `None`
    /// if the expression has other operations, or too many.
    pub(crate) fn new(
        graph: &Graph,
        root: NodeId,
        uniform: &dyn Fn(Input) -> f64,
        frame: &[[f64; 2]; 3],
    ) -> Option<Self> {
        let mut reader = ProgramReader {
            steps: Vec::new(),
            known: FxHashMap::default(),
        };
        let mut last = 0;
        for id in graph.order(&[root]) {
            last = reader.read(graph.node(id), uniform, frame)?;
            reader.known.insert(id, last);
        }
        (last + 1 == reader.steps.len()).then_some(Self {
            steps: reader.steps,
        })
    }

    /// Returns the maximum degree of the polynomial.
    pub(crate) fn degree(&self) -> usize {
        self.steps.last().map_or(0, |(_, degree)| *degree)
    }

    /// Returns the approximate number of multiplications for a ray.
    pub(crate) fn cost(&self) -> usize {
        let degree = |k: usize| self.steps[k].1 + 1;
        let cost = |(step, own): &(PolynomialStep, usize)| match *step {
            PolynomialStep::Product(a, b) => degree(a) * degree(b),
            _ => own + 1,
        };
        self.steps.iter().map(cost).sum()
    }

    /// Returns the polynomial at `point` + s·`direction`, in s.
    pub(crate) fn along(&self, point: DVec3, direction: DVec3) -> Coefficients {
        let mut values = [[0.0; LARGEST_DEGREE + 1]; MOST_STEPS];
        for (k, &(step, degree)) in self.steps.iter().enumerate() {
            let (before, rest) = values.split_at_mut(k);
            let out = &mut rest[0];
            match step {
                PolynomialStep::Coordinate { axis, middle, half } => {
                    out[0] = middle + half * point[axis];
                    out[1] = half * direction[axis];
                }
                PolynomialStep::Number(x) => out[0] = x,
                PolynomialStep::Scaled(a, factor) => {
                    for (out, a) in out[..=degree].iter_mut().zip(&before[a]) {
                        *out = factor * a;
                    }
                }
                PolynomialStep::Sum(a, b) => {
                    let operands = before[a].iter().zip(&before[b]);
                    for (out, (a, b)) in out[..=degree].iter_mut().zip(operands) {
                        *out = a + b;
                    }
                }
                PolynomialStep::Difference(a, b) => {
                    let operands = before[a].iter().zip(&before[b]);
                    for (out, (a, b)) in out[..=degree].iter_mut().zip(operands) {
                        *out = a - b;
                    }
                }
                PolynomialStep::Product(a, b) => {
                    let (of_a, of_b) = (self.steps[a].1, self.steps[b].1);
                    let (a, b) = (&before[a][..=of_a], &before[b][..=of_b]);
                    for (i, a) in a.iter().enumerate() {
                        for (out, b) in out[i..].iter_mut().zip(b) {
                            *out += a * b;
                        }
                    }
                }
            }
        }
        values[self.steps.len() - 1]
    }
}

impl ProgramReader {
    /// Returns the step whose result is the value of a node.
    fn read(
        &mut self,
        node: Node,
        uniform: &dyn Fn(Input) -> f64,
        frame: &[[f64; 2]; 3],
    ) -> Option<usize> {
        let known = |id: NodeId| self.known[&id];
        match node {
            Node::Constant(x) => self.push(PolynomialStep::Number(x), 0),
            Node::Input(Input::Variable(k @ 0..3)) => {
                let [middle, half] = frame[k as usize];
                let axis = k as usize;
                self.push(PolynomialStep::Coordinate { axis, middle, half }, 1)
            }
            Node::Input(input) => self.push(PolynomialStep::Number(uniform(input)), 0),
            Node::Unary(Unary::Neg, a) => self.scaled(known(a), -1.0),
            Node::Binary(op, a, b) => {
                let (a, b) = (known(a), known(b));
                let most = self.steps[a].1.max(self.steps[b].1);
                match op {
                    Binary::Add => self.push(PolynomialStep::Sum(a, b), most),
                    Binary::Sub => self.push(PolynomialStep::Difference(a, b), most),
                    Binary::Mul => self.product(a, b),
                    Binary::Div => match self.steps[b].0 {
                        PolynomialStep::Number(x) if x != 0.0 => self.scaled(a, 1.0 / x),
                        _ => None,
                    },
                    _ => None,
                }
            }
            Node::Power(a, n @ 1..) => {
                let a = known(a);
                let mut power = a;
                // From the second bit on: square, and multiply by the base if the bit is set.
                for bit in (0..n.ilog2()).rev() {
                    power = self.product(power, power)?;
                    if n >> bit & 1 == 1 {
                        power = self.product(power, a)?;
                    }
                }
                Some(power)
            }
            _ => None,
        }
    }

    fn product(&mut self, a: usize, b: usize) -> Option<usize> {
        match (self.steps[a].0, self.steps[b].0) {
            (_, PolynomialStep::Number(x)) => self.scaled(a, x),
            (PolynomialStep::Number(x), _) => self.scaled(b, x),
            _ => {
                let degree = self.steps[a].1 + self.steps[b].1;
                self.push(PolynomialStep::Product(a, b), degree)
            }
        }
    }

    fn scaled(&mut self, a: usize, factor: f64) -> Option<usize> {
        let degree = self.steps[a].1;
        self.push(PolynomialStep::Scaled(a, factor), degree)
    }

    fn push(&mut self, step: PolynomialStep, degree: usize) -> Option<usize> {
        if self.steps.len() == MOST_STEPS || degree > LARGEST_DEGREE {
            return None;
        }
        self.steps.push((step, degree));
        Some(self.steps.len() - 1)
    }
}
