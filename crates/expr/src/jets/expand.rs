//! From roots to coefficients: truncated Taylor arithmetic (A. Griewank, A. Walther, *Evaluating Derivatives*, 2008,
//! chapter 13), unrolled.
//!
//! In: nodes of a graph. Out: a list of operations on coefficients, without duplicates and with constants folded
//! (`terms.rs`).
//!
//! The rules are those of symbolic derivatives ([`crate::ops`]), also at kinks and where something is undefined: an
//! operand that is zero everywhere annihilates, one that is zero at a point does not.

use rustc_hash::{FxBuildHasher, FxHashMap};

use crate::graph::{Graph, Input, Node, NodeId, TooLarge};
use crate::jets::Order;
use crate::jets::terms::{Micro, Term, TermBuilder, ZERO};
use crate::ops::{Arithmetic, Binary, Unary};

/// The coefficients that the roots need, and others.
#[derive(Clone, Debug)]
pub(super) struct Expansion {
    pub(super) micros: Vec<Micro>,
    /// True for those that depend on a variable.
    pub(super) varying: Vec<bool>,
    /// The coefficients of each root, root by root.
    pub(super) roots: Vec<Term>,
    pub(super) uniforms: Vec<Input>,
}

/// Value, ∂u, ∂v, ∂uu, ∂uv, ∂vv of a node.
type Coefficients = [Term; 6];

/// The index of each second derivative, and those of the two first derivatives from which it is computed.
const SECOND: [(usize, usize, usize); 3] = [(3, 1, 1), (4, 1, 2), (5, 2, 2)];

/// Expands the roots.
///
/// # Errors
/// [`TooLarge`] where there are more coefficients than the graph may hold nodes.
pub(super) fn expand(
    graph: &Graph,
    roots: &[NodeId],
    variables: [Input; 2],
    order: Order,
) -> Result<Expansion, TooLarge> {
    let nodes = graph.order(roots);
    let mut builder = TermBuilder::new(graph.limit(), nodes.len());
    let mut uniforms = Vec::new();
    let mut known: FxHashMap<NodeId, Coefficients> =
        FxHashMap::with_capacity_and_hasher(nodes.len(), FxBuildHasher);
    let inputs = graph.inputs(roots);
    uniforms.extend(
        inputs
            .into_iter()
            .filter(|input| !variables.contains(input)),
    );
    for &id in &nodes {
        let of = |operand: NodeId| known.get(&operand).copied().unwrap_or([ZERO; 6]);
        let mut jet = [ZERO; 6];
        match graph.node(id) {
            Node::Constant(value) => jet[0] = builder.constant(value),
            Node::Input(input) => {
                if let Some(k) = variables.iter().position(|variable| *variable == input) {
                    jet[0] = builder.leaf(Micro::Variable(k as u32));
                    // Both, if the two variables are the same.
                    for (k, variable) in variables.iter().enumerate() {
                        if *variable == input {
                            jet[1 + k] = builder.constant(1.0);
                        }
                    }
                } else {
                    let position = uniforms.partition_point(|other| *other < input);
                    jet[0] = builder.leaf(Micro::Uniform(position as u32));
                }
            }
            Node::Unary(op, a) => jet = builder.unary_jet(op, &of(a), order),
            Node::Power(a, n) => jet = builder.integer_power_jet(&of(a), n, order),
            Node::Binary(op, a, b) => jet = builder.binary_jet(op, &of(a), &of(b), order),
        }
        if builder.overflowed {
            return Err(TooLarge);
        }
        known.insert(id, jet);
    }
    let roots = roots
        .iter()
        .flat_map(|root| known[root][..order.coefficients()].to_vec());
    Ok(Expansion {
        roots: roots.collect(),
        micros: builder.micros,
        varying: builder.varying,
        uniforms,
    })
}

impl Expansion {
    /// Returns the values of some coefficients that do not vary.
    pub(super) fn fixed_numbers(&self, uniforms: &[f64], wanted: &[u32]) -> Vec<f64> {
        let mut needed = vec![false; self.micros.len()];
        for &id in wanted {
            needed[id as usize] = true;
        }
        for id in (0..self.micros.len()).rev() {
            if needed[id] {
                for operand in self.micros[id].operands() {
                    needed[operand as usize] = true;
                }
            }
        }
        let mut values = vec![0.0; self.micros.len()];
        for id in 0..self.micros.len() {
            if needed[id] {
                let value = |operand: u32| values[operand as usize];
                values[id] = match self.micros[id] {
                    Micro::Constant(bits) => f64::from_bits(bits),
                    Micro::Uniform(position) => uniforms[position as usize],
                    // Never requested.
                    Micro::Variable(_) => f64::NAN,
                    Micro::Neg(a) => -value(a),
                    Micro::Unary(op, a) => op.eval(value(a)),
                    Micro::Binary(op, a, b) => op.eval(value(a), value(b)),
                };
            }
        }
        wanted.iter().map(|&id| values[id as usize]).collect()
    }
}

impl TermBuilder {
    /// The chain rule: f(a), given the first and second derivatives of f at a's value.
    fn chain(
        &mut self,
        value: Term,
        [first, second]: [Term; 2],
        a: &Coefficients,
        order: Order,
    ) -> Coefficients {
        let mut jet = [value, ZERO, ZERO, ZERO, ZERO, ZERO];
        if order >= Order::First {
            for k in [1, 2] {
                jet[k] = self.mul(first, a[k]);
            }
        }
        if order >= Order::Second {
            for (k, i, j) in SECOND {
                let slopes = self.mul(a[i], a[j]);
                let bend = self.mul(second, slopes);
                let rest = self.mul(first, a[k]);
                jet[k] = self.add(bend, rest);
            }
        }
        jet
    }

    fn unary_jet(&mut self, op: Unary, a: &Coefficients, order: Order) -> Coefficients {
        let value = self.unary(op, a[0]);
        if a[1..].iter().all(|part| *part == ZERO) || order == Order::Value {
            return [value, ZERO, ZERO, ZERO, ZERO, ZERO];
        }
        let slopes = op.slopes(self, a[0], value);
        self.chain(value, slopes, a, order)
    }

    fn integer_power_jet(&mut self, a: &Coefficients, n: i32, order: Order) -> Coefficients {
        let value = self.integer_power(a[0], n);
        if a[1..].iter().all(|part| *part == ZERO) || order == Order::Value {
            return [value, ZERO, ZERO, ZERO, ZERO, ZERO];
        }
        let exponent = self.constant(f64::from(n));
        let less = self.constant(f64::from(n) - 1.0);
        let (lower, lowest) = if n < 0 {
            // One more division for both, rather than one for each.
            let one = self.constant(1.0);
            let reciprocal = self.div(one, a[0]);
            let lower = self.mul(value, reciprocal);
            (lower, self.mul(lower, reciprocal))
        } else {
            let n = n.unsigned_abs();
            let lower = self.positive_power(a[0], n.saturating_sub(1));
            (lower, self.positive_power(a[0], n.saturating_sub(2)))
        };
        let first = self.mul(exponent, lower);
        let second = self.mul(less, lowest);
        let second = self.mul(exponent, second);
        self.chain(value, [first, second], a, order)
    }

    fn binary_jet(
        &mut self,
        op: Binary,
        a: &Coefficients,
        b: &Coefficients,
        order: Order,
    ) -> Coefficients {
        let count = order.coefficients();
        let mut jet = [ZERO; 6];
        match op {
            Binary::Add => {
                for k in 0..count {
                    jet[k] = self.add(a[k], b[k]);
                }
            }
            Binary::Sub => {
                for k in 0..count {
                    jet[k] = self.sub(a[k], b[k]);
                }
            }
            Binary::Mul => return self.product(a, b, order, Self::mul),
            Binary::Zmul => return self.product(a, b, order, Self::annihilating),
            Binary::Div => return self.quotient(a, b, order),
            Binary::Pow => return self.power(a, b, order),
            Binary::Min => return self.chosen(op, [a, b], [a[0], b[0]], order),
            Binary::Max => return self.chosen(op, [a, b], [b[0], a[0]], order),
            Binary::AtMost => jet[0] = self.compared(op, a[0], b[0]),
        }
        jet
    }

    /// Returns the smaller or larger operand, with the derivatives of the first if `least` is at most `most`, else of
    /// the second.
    fn chosen(
        &mut self,
        op: Binary,
        [a, b]: [&Coefficients; 2],
        [least, most]: [Term; 2],
        order: Order,
    ) -> Coefficients {
        let mut jet = [ZERO; 6];
        jet[0] = self.compared(op, a[0], b[0]);
        if a == b || order == Order::Value {
            return if a == b { *a } else { jet };
        }
        let one = self.constant(1.0);
        let first = self.compared(Binary::AtMost, least, most);
        let second = self.sub(one, first);
        for k in 1..order.coefficients() {
            let left = self.annihilating(first, a[k]);
            let right = self.annihilating(second, b[k]);
            jet[k] = self.add(left, right);
        }
        jet
    }

    /// Leibniz' rule for a product of either kind.
    fn product(
        &mut self,
        a: &Coefficients,
        b: &Coefficients,
        order: Order,
        mul: fn(&mut Self, Term, Term) -> Term,
    ) -> Coefficients {
        let mut jet = [ZERO; 6];
        jet[0] = mul(self, a[0], b[0]);
        if order >= Order::First {
            for k in [1, 2] {
                let left = mul(self, a[k], b[0]);
                let right = mul(self, a[0], b[k]);
                jet[k] = self.add(left, right);
            }
        }
        if order >= Order::Second {
            for (k, i, j) in SECOND {
                let left = mul(self, a[k], b[0]);
                let right = mul(self, a[0], b[k]);
                let outer = self.add(left, right);
                let (first, second) = (mul(self, a[i], b[j]), mul(self, a[j], b[i]));
                // For i = j both are the same node, and their sum is its double.
                let inner = self.add(first, second);
                jet[k] = self.add(outer, inner);
            }
        }
        jet
    }

    /// y = a/b: y' = (a' − y b')/b, the division by b a product with its reciprocal.
    fn quotient(&mut self, a: &Coefficients, b: &Coefficients, order: Order) -> Coefficients {
        let y = self.div(a[0], b[0]);
        let mut jet = [y, ZERO, ZERO, ZERO, ZERO, ZERO];
        let is_constant = |jet: &Coefficients| jet[1..].iter().all(|part| *part == ZERO);
        if order == Order::Value || is_constant(a) && is_constant(b) {
            return jet;
        }
        let one = self.constant(1.0);
        let reciprocal = self.div(one, b[0]);
        for k in [1, 2] {
            let share = self.mul(y, b[k]);
            let rest = self.sub(a[k], share);
            jet[k] = self.mul(rest, reciprocal);
        }
        if order >= Order::Second {
            for (k, i, j) in SECOND {
                let (first, second) = (self.mul(jet[i], b[j]), self.mul(jet[j], b[i]));
                let inner = self.add(first, second);
                let share = self.mul(y, b[k]);
                let rest = self.sub(a[k], share);
                let rest = self.sub(rest, inner);
                jet[k] = self.mul(rest, reciprocal);
            }
        }
        jet
    }

    /// Returns the first derivatives of a^b, given its value y, the logarithm l of its base, and the slopes of a and b:
    /// b a^(b−1) a' + b' y l. Also returns b a^(b−1).
    fn power_slope(&mut self, y: Term, lower: Term, b: Term, l: Term, [da, db]: [Term; 2]) -> Term {
        let by_base = if da == ZERO {
            ZERO
        } else {
            let slope = self.annihilating(b, lower);
            self.mul(slope, da)
        };
        let by_exponent = if db == ZERO {
            ZERO
        } else {
            let growth = self.annihilating(y, l);
            self.annihilating(db, growth)
        };
        self.add(by_base, by_exponent)
    }

    /// y = a^b by the symbolic rule, applied twice.
    fn power(&mut self, a: &Coefficients, b: &Coefficients, order: Order) -> Coefficients {
        let y = self.general_power(a[0], b[0]);
        let mut jet = [y, ZERO, ZERO, ZERO, ZERO, ZERO];
        let constant = |jet: &Coefficients| jet[1..].iter().all(|part| *part == ZERO);
        if order == Order::Value || constant(a) && constant(b) {
            return jet;
        }
        let one = self.constant(1.0);
        let (b1, l) = (self.sub(b[0], one), self.unary(Unary::Log, a[0]));
        let lower = self.general_power(a[0], b1);
        for k in [1, 2] {
            jet[k] = self.power_slope(y, lower, b[0], l, [a[k], b[k]]);
        }
        if order == Order::Second {
            let b2 = self.sub(b1, one);
            let lowest = self.general_power(a[0], b2);
            let slope = self.annihilating(b[0], lower);
            let growth = self.annihilating(y, l);
            for (k, i, j) in SECOND {
                // (b a^(b−1))' a' + b a^(b−1) a''.
                let mut by_base = ZERO;
                if a[i] != ZERO {
                    let lower_slope = self.power_slope(lower, lowest, b1, l, [a[j], b[j]]);
                    let left = self.annihilating(b[j], lower);
                    let right = self.annihilating(b[0], lower_slope);
                    let bend = self.add(left, right);
                    by_base = self.mul(bend, a[i]);
                }
                let rest = self.mul(slope, a[k]);
                by_base = self.add(by_base, rest);
                // (y l)' b' + y l b''.
                let mut by_exponent = ZERO;
                if b[i] != ZERO {
                    let log_slope = if a[j] == ZERO {
                        ZERO
                    } else {
                        self.div(a[j], a[0])
                    };
                    let left = self.annihilating(jet[j], l);
                    let right = self.annihilating(y, log_slope);
                    let bend = self.add(left, right);
                    by_exponent = self.annihilating(b[i], bend);
                }
                let rest = self.annihilating(b[k], growth);
                by_exponent = self.add(by_exponent, rest);
                jet[k] = self.add(by_base, by_exponent);
            }
        }
        jet
    }
}
