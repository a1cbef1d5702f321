//! The constructors of operations, which simplify as they go.
//!
//! In: operands. Out: a node with the operation's value. Constants are folded by the same f64 operations that
//! evaluation uses, operands of sums and products are ordered, and identities that hold exactly in floating point are
//! applied. Nothing is reassociated or distributed, since that would round differently.
//!
//! A value changes only in the following cases, which sparse derivatives require:
//!
//! - `0·x`, `x − x` and the product that zero annihilates are 0, even where x is infinite or NaN: a NaN may become
//!   0. (`0/x` is kept: 0/0 is undefined, and a program gets a diagnostic.)
//! - `x + 0` is x and `0 − x` is −x, even where x is a zero: a zero result may have the other sign. So may those
//!   of the rules above. The sign of a zero is visible only in the sign of an infinity that results from dividing by
//!   it.

use crate::graph::{Graph, Node, NodeId};
use crate::ops::{self, Arithmetic, Binary, ExpressionBuilder, Unary};

impl Graph {
    /// a + b.
    pub fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(x + y),
            (Some(0.0), None) => return b,
            (None, Some(0.0)) => return a,
            _ => {}
        }
        if a == b {
            let two = self.constant(2.0);
            return self.mul(two, a);
        }
        if let Some(b) = self.negated(b) {
            return self.sub(a, b);
        }
        if let Some(a) = self.negated(a) {
            return self.sub(b, a);
        }
        let (a, b) = self.ordered(a, b);
        self.intern(Node::Binary(Binary::Add, a, b))
    }

    /// a − b.
    pub fn sub(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(x - y),
            (Some(0.0), None) => return self.neg(b),
            (None, Some(0.0)) => return a,
            _ => {}
        }
        if a == b {
            return self.constant(0.0);
        }
        if let Some(b) = self.negated(b) {
            return self.add(a, b);
        }
        self.intern(Node::Binary(Binary::Sub, a, b))
    }

    /// a·b.
    pub fn mul(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let (a, b) = self.ordered(a, b);
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(x * y),
            (Some(0.0), None) => return self.constant(0.0),
            (Some(1.0), None) => return b,
            (Some(-1.0), None) => return self.neg(b),
            (Some(x), None) => {
                if let Some(b) = self.negated(b) {
                    let minus = self.constant(-x);
                    return self.mul(minus, b);
                }
            }
            _ => {}
        }
        match (self.negated(a), self.negated(b)) {
            (None, None) => self.intern(Node::Binary(Binary::Mul, a, b)),
            (Some(a), Some(b)) => self.mul(a, b),
            (minus_a, minus_b) => {
                let product = self.mul(minus_a.unwrap_or(a), minus_b.unwrap_or(b));
                self.neg(product)
            }
        }
    }

    /// a/b. Division by a power of two becomes multiplication by its reciprocal, which rounds identically.
    pub fn div(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(x / y),
            (Some(x), None) => {
                if let Some(b) = self.negated(b) {
                    let minus = self.constant(-x);
                    return self.div(minus, b);
                }
            }
            (None, Some(y)) => {
                if has_exact_reciprocal(y) {
                    let reciprocal = self.constant(1.0 / y);
                    return self.mul(a, reciprocal);
                }
                if let Some(a) = self.negated(a) {
                    let minus = self.constant(-y);
                    return self.div(a, minus);
                }
            }
            (None, None) => {}
        }
        match (self.negated(a), self.negated(b)) {
            (None, None) => self.intern(Node::Binary(Binary::Div, a, b)),
            (Some(a), Some(b)) => self.div(a, b),
            (minus_a, minus_b) => {
                let quotient = self.div(minus_a.unwrap_or(a), minus_b.unwrap_or(b));
                self.neg(quotient)
            }
        }
    }

    /// −a.
    pub fn neg(&mut self, a: NodeId) -> NodeId {
        match self.node(a) {
            Node::Constant(x) => self.constant(-x),
            Node::Unary(Unary::Neg, a) => a,
            Node::Binary(op @ (Binary::Mul | Binary::Div), c, b) => match self.value(c) {
                // The sign moves to the constant: one operation less.
                Some(c) => {
                    let minus = self.constant(-c);
                    self.binary(op, minus, b)
                }
                None => self.intern(Node::Unary(Unary::Neg, a)),
            },
            _ => self.intern(Node::Unary(Unary::Neg, a)),
        }
    }

    /// a^n by repeated squaring, see [`ops::integer_power`].
    pub fn integer_power(&mut self, a: NodeId, n: i32) -> NodeId {
        if let Some(x) = self.value(a) {
            return self.constant(ops::integer_power(x, n));
        }
        match n {
            0 => return self.constant(1.0),
            1 => return a,
            2 => return self.mul(a, a),
            -1 => {
                let one = self.constant(1.0);
                return self.div(one, a);
            }
            _ => {}
        }
        match self.negated(a) {
            Some(a) if n % 2 == 0 => self.integer_power(a, n),
            Some(a) => {
                let power = self.integer_power(a, n);
                self.neg(power)
            }
            None => self.intern(Node::Power(a, n)),
        }
    }

    /// a^b, see [`ops::power`]. A constant exponent that is an integer of moderate magnitude gives an integer power.
    pub fn power(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (self.value(a), self.value(b)) {
            (_, Some(y)) if ops::small_integer(y).is_some() => {
                self.integer_power(a, ops::small_integer(y).unwrap_or(0))
            }
            (Some(x), Some(y)) => self.constant(ops::power(x, y)),
            // 1^y is 1, even for NaN.
            (Some(1.0), None) => self.constant(1.0),
            _ => self.intern(Node::Binary(Binary::Pow, a, b)),
        }
    }

    /// The product that a zero first factor annihilates, see [`ops::zmul`].
    pub fn zmul(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => self.constant(ops::zmul(x, y)),
            // A constant zero annihilates in a product, too, and a zero times a finite number is zero.
            (Some(_), None) => self.mul(a, b),
            (None, Some(y)) if y.is_finite() => self.mul(a, b),
            (None, None) if a == b => self.mul(a, b),
            _ => self.intern(Node::Binary(Binary::Zmul, a, b)),
        }
    }

    /// Any operation on one number.
    pub fn unary(&mut self, op: Unary, a: NodeId) -> NodeId {
        if let Some(x) = self.value(a) {
            return self.constant(op.eval(x));
        }
        match (op, self.node(a)) {
            (Unary::Neg, _) => self.neg(a),
            (Unary::Abs, Node::Unary(Unary::Abs, _)) => a,
            (Unary::Abs, Node::Unary(Unary::Neg, b)) => self.unary(Unary::Abs, b),
            _ => self.intern(Node::Unary(op, a)),
        }
    }

    /// Any operation on two numbers.
    pub fn binary(&mut self, op: Binary, a: NodeId, b: NodeId) -> NodeId {
        match op {
            Binary::Add => self.add(a, b),
            Binary::Sub => self.sub(a, b),
            Binary::Mul => self.mul(a, b),
            Binary::Div => self.div(a, b),
            Binary::Pow => self.power(a, b),
            Binary::Zmul => self.zmul(a, b),
            Binary::Min | Binary::Max | Binary::AtMost => self.compared(op, a, b),
        }
    }

    /// The smaller or larger of two numbers, or their comparison.
    fn compared(&mut self, op: Binary, a: NodeId, b: NodeId) -> NodeId {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => self.constant(op.eval(x, y)),
            _ if a == b && op != Binary::AtMost => a,
            _ => self.intern(Node::Binary(op, a, b)),
        }
    }

    /// Returns the b of a node −b.
    fn negated(&self, a: NodeId) -> Option<NodeId> {
        match self.node(a) {
            Node::Unary(Unary::Neg, b) => Some(b),
            _ => None,
        }
    }

    /// Returns the operands of a commutative operation in canonical order: constants first, then by age.
    fn ordered(&self, a: NodeId, b: NodeId) -> (NodeId, NodeId) {
        let rank = |id| (self.value(id).is_none(), id);
        if rank(b) < rank(a) { (b, a) } else { (a, b) }
    }
}

/// The rules of derivatives use the same constructors.
impl Arithmetic for Graph {
    type Number = NodeId;

    fn constant(&mut self, value: f64) -> NodeId {
        Self::constant(self, value)
    }

    fn neg(&mut self, a: NodeId) -> NodeId {
        Self::neg(self, a)
    }

    fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        Self::add(self, a, b)
    }

    fn sub(&mut self, a: NodeId, b: NodeId) -> NodeId {
        Self::sub(self, a, b)
    }

    fn mul(&mut self, a: NodeId, b: NodeId) -> NodeId {
        Self::mul(self, a, b)
    }

    fn div(&mut self, a: NodeId, b: NodeId) -> NodeId {
        Self::div(self, a, b)
    }

    fn at_most(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.compared(Binary::AtMost, a, b)
    }

    fn unary(&mut self, op: Unary, a: NodeId) -> NodeId {
        Self::unary(self, op, a)
    }
}

impl ExpressionBuilder for Graph {
    fn value(&self, a: NodeId) -> Option<f64> {
        Self::value(self, a)
    }

    fn integer_power(&mut self, a: NodeId, n: i32) -> NodeId {
        Self::integer_power(self, a, n)
    }

    fn power(&mut self, a: NodeId, b: NodeId) -> NodeId {
        Self::power(self, a, b)
    }

    fn zmul(&mut self, a: NodeId, b: NodeId) -> NodeId {
        Self::zmul(self, a, b)
    }

    fn binary(&mut self, op: Binary, a: NodeId, b: NodeId) -> NodeId {
        Self::binary(self, op, a, b)
    }
}

/// Returns true for ±2^k where 2^−k is exact too.
fn has_exact_reciprocal(x: f64) -> bool {
    let mantissa = x.to_bits() & ((1 << 52) - 1);
    mantissa == 0 && x.is_normal() && (1.0 / x).is_normal()
}
