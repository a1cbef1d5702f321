//! From roots to coefficients: truncated Taylor arithmetic, unrolled.
//!
//! What flows in: nodes of a graph. What flows out: a list of operations on coefficients, in which equal ones are one
//! and constants are folded. A coefficient is referred to with a sign and a factor that is the same at every point
//! ([`Term`]): neither negation nor scaling is an operation as long as only products and equally scaled sums follow.
//! So all derivatives of a sine of 2πu are the same two numbers.
//!
//! The rules are those of symbolic derivatives ([`crate::ops`]), also at kinks and where something is undefined: what
//! is zero everywhere annihilates, what is zero at a point does not. Factors that are gathered round in another order
//! than they were written in.

use rustc_hash::{FxBuildHasher, FxHashMap};

use crate::graph::{Graph, Input, Node, NodeId, TooLarge};
use crate::jets::Order;
use crate::ops::{Arithmetic, Binary, Unary};

/// A coefficient times a factor, or the negative of that.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(super) struct Term {
    pub(super) id: u32,
    /// A coefficient that does not vary; 1 where the other one does not either.
    pub(super) factor: u32,
    pub(super) negative: bool,
}

/// How a coefficient is computed from others, which come before it.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(super) enum Micro {
    /// Its bits. Never negative.
    Constant(u64),
    /// A position in [`Expansion::uniforms`].
    Uniform(u32),
    /// The first or the second variable.
    Variable(u32),
    /// Where a sign cannot be carried along.
    Neg(u32),
    /// Any other operation on one number.
    Unary(Unary, u32),
    /// Any operation on two numbers.
    Binary(Binary, u32, u32),
}

/// What the roots need, and more.
#[derive(Clone, Debug)]
pub(super) struct Expansion {
    pub(super) micros: Vec<Micro>,
    /// For each whether it depends on a variable.
    pub(super) varying: Vec<bool>,
    /// The coefficients of each root, root by root.
    pub(super) roots: Vec<Term>,
    pub(super) uniforms: Vec<Input>,
}

/// Value, ∂u, ∂v, ∂uu, ∂uv, ∂vv of a node.
type Coefficients = [Term; 6];

/// The constant 0 is always the first, the constant 1 the second.
const ZERO: Term = Term {
    id: 0,
    factor: ONE,
    negative: false,
};
const ONE: u32 = 1;

/// Constant factors are gathered between this and its reciprocal, so that none over- or underflows.
const LARGEST_FACTOR: f64 = 1e150;

/// For each second derivative its position, and those of the two first derivatives that it comes from.
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
    let mut builder = Builder::new(graph.limit(), nodes.len());
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
                    // Both, where the two variables are the same.
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
    /// The values of some coefficients that do not vary.
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
                    // Not asked for.
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

impl Micro {
    pub(super) fn operands(self) -> impl Iterator<Item = u32> {
        let (first, second) = match self {
            Self::Constant(_) | Self::Uniform(_) | Self::Variable(_) => (None, None),
            Self::Neg(a) | Self::Unary(_, a) => (Some(a), None),
            Self::Binary(_, a, b) => (Some(a), Some(b)),
        };
        first.into_iter().chain(second)
    }
}

/// Makes coefficients; as an [`Arithmetic`], what the table's rules are run in.
struct Builder {
    micros: Vec<Micro>,
    varying: Vec<bool>,
    ids: FxHashMap<Micro, u32>,
    limit: usize,
    overflowed: bool,
}

impl Arithmetic for Builder {
    type Number = Term;

    fn constant(&mut self, value: f64) -> Term {
        let constant = self.positive(Micro::Constant(value.abs().to_bits()));
        constant.signed(value < 0.0)
    }

    fn neg(&mut self, a: Term) -> Term {
        // Zero is its own negative.
        a.signed(!a.negative && a != ZERO)
    }

    fn add(&mut self, a: Term, b: Term) -> Term {
        let minus_b = self.neg(b);
        self.sub(a, minus_b)
    }

    fn sub(&mut self, a: Term, b: Term) -> Term {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(x - y),
            (Some(0.0), None) => return self.neg(b),
            (None, Some(0.0)) => return a,
            _ => {}
        }
        if a.id == b.id && a.factor == b.factor && a.negative != b.negative {
            let two = self.constant(2.0);
            return self.mul(two, a);
        }
        let factor = a.factor;
        let (a, b) = if self.varying(a) && self.varying(b) && factor == b.factor {
            (a, b)
        } else {
            (self.whole(a), self.whole(b))
        };
        let difference = match (a.negative, b.negative) {
            (false, false) => self.positive(Micro::Binary(Binary::Sub, a.id, b.id)),
            (true, true) => self.positive(Micro::Binary(Binary::Sub, b.id, a.id)),
            (negative, _) => {
                let (a, b) = (a.id.min(b.id), a.id.max(b.id));
                self.positive(Micro::Binary(Binary::Add, a, b))
                    .signed(negative)
            }
        };
        // That of both, or 1 where they have been carried out.
        let factor = a.factor;
        Term {
            factor,
            ..difference
        }
    }

    fn mul(&mut self, a: Term, b: Term) -> Term {
        let negative = a.negative != b.negative;
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(x * y),
            (Some(0.0), None) | (None, Some(0.0)) => return ZERO,
            (Some(1.0 | -1.0), None) => return b.signed(negative),
            (None, Some(1.0 | -1.0)) => return a.signed(negative),
            _ => {}
        }
        match (self.varying(a), self.varying(b)) {
            (false, false) => self.product_of(a.id, b.id).signed(negative),
            (false, true) => self.scaled(b, a.id).signed(negative),
            (true, false) => self.scaled(a, b.id).signed(negative),
            (true, true) => {
                let product = self.product_of(a.id, b.id);
                let product = self.scaled(product, a.factor);
                self.scaled(product, b.factor).signed(negative)
            }
        }
    }

    fn div(&mut self, a: Term, b: Term) -> Term {
        let negative = a.negative != b.negative;
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(x / y),
            (None, Some(1.0 | -1.0)) => return a.signed(negative),
            _ => {}
        }
        if !self.varying(b) {
            if !self.varying(a) {
                let quotient = self.positive(Micro::Binary(Binary::Div, a.id, b.id));
                return quotient.signed(negative);
            }
            if a.factor == ONE {
                // As written, to the last bit: arguments of functions may be sensitive to it.
                let quotient = self.positive(Micro::Binary(Binary::Div, a.id, b.id));
                return quotient.signed(negative);
            }
            let reciprocal = self.reciprocal(b.id);
            return self.mul(a, reciprocal).signed(negative);
        }
        let reciprocal = self.reciprocal(b.factor);
        let quotient = if self.varying(a) || a == ZERO {
            let quotient = self.positive(Micro::Binary(Binary::Div, a.id, b.id));
            self.scaled(quotient, a.factor)
        } else {
            // Numbers over the same denominator share their division.
            let quotient = self.positive(Micro::Binary(Binary::Div, ONE, b.id));
            self.scaled(quotient, a.id)
        };
        self.mul(quotient, reciprocal).signed(negative)
    }

    fn unary(&mut self, op: Unary, a: Term) -> Term {
        if let Some(x) = self.value(a) {
            return self.constant(op.eval(x));
        }
        match op {
            Unary::Neg => self.neg(a),
            // Odd ones hand the sign on.
            Unary::Sin
            | Unary::Tan
            | Unary::Asin
            | Unary::Atan
            | Unary::Sinh
            | Unary::Tanh
            | Unary::Sign => {
                let a = self.whole(a);
                self.positive(Micro::Unary(op, a.id)).signed(a.negative)
            }
            // Even ones drop it.
            Unary::Cos | Unary::Cosh | Unary::Abs => {
                let a = self.whole(a);
                self.positive(Micro::Unary(op, a.id))
            }
            Unary::Exp | Unary::Log | Unary::Sqrt | Unary::Acos => {
                let a = self.unsigned(a);
                self.positive(Micro::Unary(op, a))
            }
        }
    }
}

impl Term {
    fn signed(self, negative: bool) -> Self {
        Self { negative, ..self }
    }
}

impl Builder {
    fn new(limit: usize, nodes: usize) -> Self {
        let room = 4 * nodes.min(1 << 16);
        let mut builder = Self {
            micros: Vec::with_capacity(room),
            varying: Vec::with_capacity(room),
            ids: FxHashMap::with_capacity_and_hasher(room, FxBuildHasher),
            limit,
            overflowed: false,
        };
        for first in [0.0, 1.0] {
            builder.constant(first);
        }
        builder
    }

    fn intern(&mut self, micro: Micro) -> u32 {
        if let Some(&id) = self.ids.get(&micro) {
            return id;
        }
        if self.micros.len() >= self.limit.max(2) {
            self.overflowed = true;
            return ZERO.id;
        }
        let id = self.micros.len() as u32;
        let varying = matches!(micro, Micro::Variable(_))
            || micro
                .operands()
                .any(|operand| self.varying[operand as usize]);
        self.micros.push(micro);
        self.varying.push(varying);
        self.ids.insert(micro, id);
        id
    }

    fn positive(&mut self, micro: Micro) -> Term {
        Term {
            id: self.intern(micro),
            ..ZERO
        }
    }

    fn varying(&self, term: Term) -> bool {
        self.varying[term.id as usize]
    }

    fn product_of(&mut self, a: u32, b: u32) -> Term {
        self.positive(Micro::Binary(Binary::Mul, a.min(b), a.max(b)))
    }

    /// 1/a for what does not vary.
    fn reciprocal(&mut self, a: u32) -> Term {
        let one = Term { id: ONE, ..ZERO };
        let a = Term { id: a, ..ZERO };
        if a == one { one } else { self.div(one, a) }
    }

    /// A term that varies, by a factor that does not.
    fn scaled(&mut self, term: Term, factor: u32) -> Term {
        if factor == ONE {
            return term;
        }
        let [old, new] = [term.factor, factor].map(|id| Term { id, ..ZERO });
        let product = self.mul(old, new);
        let fits = self.value(product).is_none_or(|x| {
            let size = x.abs();
            (1.0 / LARGEST_FACTOR..LARGEST_FACTOR).contains(&size)
        });
        if fits {
            // Positive, as both are.
            let factor = product.id;
            Term { factor, ..term }
        } else {
            let whole = self.whole(term);
            self.product_of(whole.id, factor).signed(whole.negative)
        }
    }

    /// The term with its factor carried out.
    fn whole(&mut self, term: Term) -> Term {
        if term.factor == ONE {
            return term;
        }
        self.product_of(term.id, term.factor).signed(term.negative)
    }

    fn leaf(&mut self, micro: Micro) -> Term {
        self.positive(micro)
    }

    fn value(&self, term: Term) -> Option<f64> {
        match self.micros[term.id as usize] {
            Micro::Constant(bits) if term.negative => Some(-f64::from_bits(bits)),
            Micro::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// The coefficient with its sign and factor carried out.
    fn unsigned(&mut self, term: Term) -> u32 {
        let term = self.whole(term);
        if term.negative {
            self.intern(Micro::Neg(term.id))
        } else {
            term.id
        }
    }

    /// The chain rule: f(a) with the first and second derivative of f at a's value.
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

    /// The multiplications of [`crate::ops::integer_power`], as far as they are not by 1.
    fn positive_power(&mut self, x: Term, n: u32) -> Term {
        let mut remaining = n;
        let mut square = x;
        let mut result = None;
        while remaining != 0 {
            if remaining & 1 == 1 {
                result = Some(match result {
                    None => square,
                    Some(result) => self.mul(result, square),
                });
            }
            remaining >>= 1;
            if remaining != 0 {
                square = self.mul(square, square);
            }
        }
        result.unwrap_or_else(|| self.constant(1.0))
    }

    fn integer_power(&mut self, x: Term, n: i32) -> Term {
        let power = self.positive_power(x, n.unsigned_abs());
        if n < 0 {
            let one = self.constant(1.0);
            self.div(one, power)
        } else {
            power
        }
    }

    fn integer_power_jet(&mut self, a: &Coefficients, n: i32, order: Order) -> Coefficients {
        let value = self.integer_power(a[0], n);
        if a[1..].iter().all(|part| *part == ZERO) || order == Order::Value {
            return [value, ZERO, ZERO, ZERO, ZERO, ZERO];
        }
        let exponent = self.constant(f64::from(n));
        let less = self.constant(f64::from(n) - 1.0);
        let (lower, lowest) = if n < 0 {
            // One division more for both, rather than one for each.
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
                // For i = j both are one, and their sum its double.
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

    fn annihilating(&mut self, a: Term, b: Term) -> Term {
        // As the graph does: a constant multiplies.
        if self.value(a).is_some() || self.value(b).is_some() || a.id == b.id {
            return self.mul(a, b);
        }
        let (a, b) = (self.whole(a), self.whole(b));
        self.positive(Micro::Binary(Binary::Zmul, a.id, b.id))
            .signed(a.negative != b.negative)
    }

    fn general_power(&mut self, a: Term, b: Term) -> Term {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(crate::ops::power(x, y)),
            (_, Some(y)) => {
                if let Some(n) = crate::ops::small_integer(y) {
                    return self.integer_power(a, n);
                }
            }
            (Some(1.0), None) => return a,
            _ => {}
        }
        let (a, b) = (self.unsigned(a), self.unsigned(b));
        self.positive(Micro::Binary(Binary::Pow, a, b))
    }

    /// The first derivatives of a^b, whose value is y and whose base's logarithm is l, for given slopes of a and b:
    /// b a^(b−1) a' + b' y l. Also gives b a^(b−1).
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
