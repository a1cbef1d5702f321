//! Coefficients: the results of the arithmetic of expansion.
//!
//! In: operations on [`Term`]s. Out: a list of [`Micro`] operations, without duplicates and with constants folded. A
//! term has a sign, and a factor that is the same at every point: neither negation nor scaling is an operation as long
//! as only products and equally scaled sums follow. So all derivatives of a sine of 2πu share the same two numbers.
//! Collected factors round in a different order than as written.

use rustc_hash::{FxBuildHasher, FxHashMap};

use crate::ops::{self, Arithmetic, Binary, Unary};

/// A coefficient times a factor, or the negative of that.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(super) struct Term {
    pub(super) id: u32,
    /// A coefficient that does not vary; 1 if the other one does not vary either.
    pub(super) factor: u32,
    pub(super) negative: bool,
}

/// The computation of a coefficient from earlier ones.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(super) enum Micro {
    /// The bits of a number that is never negative.
    Constant(u64),
    /// An index into the uniforms.
    Uniform(u32),
    /// The first or the second variable.
    Variable(u32),
    /// A negation, where a sign cannot be propagated.
    Neg(u32),
    /// Any other operation on one number.
    Unary(Unary, u32),
    /// Any operation on two numbers.
    Binary(Binary, u32, u32),
}

/// The constant 0 is always the first, the constant 1 the second.
pub(super) const ZERO: Term = Term {
    id: 0,
    factor: ONE,
    negative: false,
};
const ONE: u32 = 1;

/// Collected constant factors must be between this and its reciprocal, so that none overflows or underflows.
const LARGEST_FACTOR: f64 = 1e150;

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

/// Creates coefficients; as an [`Arithmetic`], it evaluates the table's rules.
pub(super) struct TermBuilder {
    pub(super) micros: Vec<Micro>,
    pub(super) varying: Vec<bool>,
    ids: FxHashMap<Micro, u32>,
    limit: usize,
    pub(super) overflowed: bool,
}

impl Arithmetic for TermBuilder {
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
        // The common factor, or 1 if factors have been multiplied out.
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
            // Quotients with the same denominator share their division.
            let quotient = self.positive(Micro::Binary(Binary::Div, ONE, b.id));
            self.scaled(quotient, a.id)
        };
        self.mul(quotient, reciprocal).signed(negative)
    }

    fn at_most(&mut self, a: Term, b: Term) -> Term {
        self.compared(Binary::AtMost, a, b)
    }

    fn unary(&mut self, op: Unary, a: Term) -> Term {
        if let Some(x) = self.value(a) {
            return self.constant(op.eval(x));
        }
        match op {
            Unary::Neg => self.neg(a),
            // Odd functions propagate the sign.
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
            // Even functions drop it.
            Unary::Cos | Unary::Cosh | Unary::Sech | Unary::Abs => {
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

impl TermBuilder {
    pub(super) fn new(limit: usize, nodes: usize) -> Self {
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

    /// Returns 1/a for a coefficient that does not vary.
    fn reciprocal(&mut self, a: u32) -> Term {
        let one = Term { id: ONE, ..ZERO };
        let a = Term { id: a, ..ZERO };
        if a == one { one } else { self.div(one, a) }
    }

    /// Returns a varying term multiplied by a factor that does not vary.
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

    /// Returns the term with its factor multiplied out.
    fn whole(&mut self, term: Term) -> Term {
        if term.factor == ONE {
            return term;
        }
        self.product_of(term.id, term.factor).signed(term.negative)
    }

    pub(super) fn leaf(&mut self, micro: Micro) -> Term {
        self.positive(micro)
    }

    fn value(&self, term: Term) -> Option<f64> {
        match self.micros[term.id as usize] {
            Micro::Constant(bits) if term.negative => Some(-f64::from_bits(bits)),
            Micro::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// Returns the coefficient with its sign and factor multiplied out.
    fn unsigned(&mut self, term: Term) -> u32 {
        let term = self.whole(term);
        if term.negative {
            self.intern(Micro::Neg(term.id))
        } else {
            term.id
        }
    }

    /// The multiplications of [`crate::ops::integer_power`], except those by 1.
    pub(super) fn positive_power(&mut self, x: Term, n: u32) -> Term {
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

    pub(super) fn integer_power(&mut self, x: Term, n: i32) -> Term {
        let power = self.positive_power(x, n.unsigned_abs());
        if n < 0 {
            let one = self.constant(1.0);
            self.div(one, power)
        } else {
            power
        }
    }

    pub(super) fn annihilating(&mut self, a: Term, b: Term) -> Term {
        // As the graph does.
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(ops::zmul(x, y)),
            (Some(_), None) => return self.mul(a, b),
            (None, Some(y)) if y.is_finite() => return self.mul(a, b),
            (None, None) if a.id == b.id => return self.mul(a, b),
            _ => {}
        }
        let (a, b) = (self.whole(a), self.whole(b));
        self.positive(Micro::Binary(Binary::Zmul, a.id, b.id))
            .signed(a.negative != b.negative)
    }

    /// Returns the smaller or larger of two numbers, or their comparison.
    pub(super) fn compared(&mut self, op: Binary, a: Term, b: Term) -> Term {
        if let (Some(x), Some(y)) = (self.value(a), self.value(b)) {
            return self.constant(op.eval(x, y));
        }
        let (a, b) = (self.unsigned(a), self.unsigned(b));
        self.positive(Micro::Binary(op, a, b))
    }

    pub(super) fn general_power(&mut self, a: Term, b: Term) -> Term {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(crate::ops::power(x, y)),
            (Some(1.0), None) => return a,
            _ => {}
        }
        let (a, b) = (self.unsigned(a), self.unsigned(b));
        self.positive(Micro::Binary(Binary::Pow, a, b))
    }
}
