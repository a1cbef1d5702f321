//! The one table of scalar operations.
//!
//! What flows in: nothing. What flows out: for each operation its name, documentation, exact f64 meaning (one
//! number and blocks of lanes, from one expression), derivative rule, WGSL text, and the name under which
//! programs know it. To add an operation, add a row, and cases to [`crate::conformance`].
//!
//! f64 functions are those of `std`, which round as the system's mathematical library does.

pub(crate) use crate::arithmetic::small_integer;
pub use crate::arithmetic::{
    LARGEST_INTEGER_POWER, integer_power, integer_power_lanes, power, sign, zmul,
};
use crate::graph::{Graph, NodeId};

/// How an operation is written in WGSL.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Wgsl {
    /// Before its operand: `-a`.
    Prefix(&'static str),
    /// Between its operands: `a + b`.
    Infix(&'static str),
    /// A function of WGSL itself: `sin(a)`.
    Builtin(&'static str),
    /// A function that the shader library provides, with the meaning of the function of this name here.
    Library(&'static str),
}

/// Any operation of the table.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Operation {
    /// On one number.
    Unary(Unary),
    /// On two numbers.
    Binary(Binary),
    /// [`integer_power`] with this exponent.
    Power(i32),
}

/// An operand of a block operation.
#[derive(Clone, Copy, Debug)]
pub enum Lanes<'a, const N: usize> {
    /// A number for each lane.
    Each(&'a [f64; N]),
    /// The same number in all lanes.
    Same(f64),
}

macro_rules! unary_operations {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident = $name:literal, builtin: $builtin:expr, wgsl: $wgsl:expr,
        eval: |$x:ident| $value:expr,
        derivative: $text:literal, |$graph:ident, $a:ident, $y:ident, $da:ident| $rule:expr;
    )+) => {
        /// An operation on one number.
        #[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
        pub enum Unary {
            $( $(#[doc = $doc])+ $variant, )+
        }

        impl Unary {
            /// All of them, in the table's order.
            pub const ALL: [Self; [$(Self::$variant),+].len()] = [$(Self::$variant),+];

            /// Its name in listings.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)+ }
            }

            /// What it is, for readers.
            pub fn doc(self) -> &'static str {
                match self { $(Self::$variant => concat!($($doc),+).trim_ascii(),)+ }
            }

            /// The name under which programs know it as a function.
            pub fn builtin(self) -> Option<&'static str> {
                match self { $(Self::$variant => $builtin,)+ }
            }

            /// Its WGSL.
            pub fn wgsl(self) -> Wgsl {
                match self { $(Self::$variant => $wgsl,)+ }
            }

            /// The rule of its derivative, for readers: x is the operand, x' its derivative, y the result.
            pub fn derivative_text(self) -> &'static str {
                match self { $(Self::$variant => $text,)+ }
            }

            /// The operation's row.
            pub fn row(self) -> Row {
                Row {
                    name: self.name(),
                    builtin: self.builtin(),
                    wgsl: self.wgsl(),
                    derivative: self.derivative_text(),
                    doc: self.doc(),
                }
            }

            /// Its value.
            #[inline]
            pub fn eval(self, x: f64) -> f64 {
                match self { $(Self::$variant => { let $x = x; $value })+ }
            }

            /// Its value in each lane.
            pub fn eval_lanes<const N: usize>(self, x: &[f64; N], out: &mut [f64; N]) {
                match self { $(Self::$variant => each(x, out, |$x| $value),)+ }
            }

            /// The derivative of `y`, which is this operation on `x`, where that of `x` is `dx`.
            pub(crate) fn derivative(
                self,
                graph: &mut Graph,
                x: NodeId,
                y: NodeId,
                dx: NodeId,
            ) -> NodeId {
                match self {
                    $(Self::$variant => {
                        let ($graph, $a, $y, $da) = (graph, x, y, dx);
                        $rule
                    })+
                }
            }
        }
    };
}

unary_operations! {
    /// The number with the other sign.
    Neg = "neg", builtin: None, wgsl: Wgsl::Prefix("-"),
    eval: |x| -x,
    derivative: "-x'", |g, _x, _y, dx| g.neg(dx);

    /// Sine of an angle in radians.
    Sin = "sin", builtin: Some("sin"), wgsl: Wgsl::Builtin("sin"),
    eval: |x| x.sin(),
    derivative: "cos x · x'", |g, x, _y, dx| { let c = g.unary(Unary::Cos, x); g.mul(c, dx) };

    /// Cosine of an angle in radians.
    Cos = "cos", builtin: Some("cos"), wgsl: Wgsl::Builtin("cos"),
    eval: |x| x.cos(),
    derivative: "-sin x · x'", |g, x, _y, dx| {
        let s = g.unary(Unary::Sin, x);
        let product = g.mul(s, dx);
        g.neg(product)
    };

    /// Tangent of an angle in radians.
    Tan = "tan", builtin: Some("tan"), wgsl: Wgsl::Builtin("tan"),
    eval: |x| x.tan(),
    derivative: "(1 + y²) x'", |g, _x, y, dx| {
        let one = g.constant(1.0);
        let square = g.mul(y, y);
        let sum = g.add(one, square);
        g.mul(sum, dx)
    };

    /// The exponential function: e to a power.
    Exp = "exp", builtin: Some("exp"), wgsl: Wgsl::Builtin("exp"),
    eval: |x| x.exp(),
    derivative: "y x'", |g, _x, y, dx| g.mul(y, dx);

    /// Natural logarithm; undefined below zero, minus infinity at zero.
    Log = "log", builtin: Some("log"), wgsl: Wgsl::Builtin("log"),
    eval: |x| x.ln(),
    derivative: "x' / x", |g, x, _y, dx| g.div(dx, x);

    /// Square root; undefined below zero.
    Sqrt = "sqrt", builtin: Some("sqrt"), wgsl: Wgsl::Builtin("sqrt"),
    eval: |x| x.sqrt(),
    derivative: "x' / 2y", |g, _x, y, dx| {
        let two = g.constant(2.0);
        let double = g.mul(two, y);
        g.div(dx, double)
    };

    /// The angle in [-π/2, π/2] with this sine; undefined outside [-1, 1].
    Asin = "asin", builtin: Some("asin"), wgsl: Wgsl::Builtin("asin"),
    eval: |x| x.asin(),
    derivative: "x' / √((1 - x)(1 + x))", |g, x, _y, dx| {
        let root = sine_of_complement(g, x);
        g.div(dx, root)
    };

    /// The angle in [0, π] with this cosine; undefined outside [-1, 1].
    Acos = "acos", builtin: Some("acos"), wgsl: Wgsl::Builtin("acos"),
    eval: |x| x.acos(),
    derivative: "-x' / √((1 - x)(1 + x))", |g, x, _y, dx| {
        let root = sine_of_complement(g, x);
        let quotient = g.div(dx, root);
        g.neg(quotient)
    };

    /// The angle in (-π/2, π/2) with this tangent.
    Atan = "atan", builtin: Some("atan"), wgsl: Wgsl::Builtin("atan"),
    eval: |x| x.atan(),
    derivative: "x' / (1 + x²)", |g, x, _y, dx| {
        let one = g.constant(1.0);
        let square = g.mul(x, x);
        let sum = g.add(one, square);
        g.div(dx, sum)
    };

    /// Hyperbolic sine.
    Sinh = "sinh", builtin: Some("sinh"), wgsl: Wgsl::Builtin("sinh"),
    eval: |x| x.sinh(),
    derivative: "cosh x · x'", |g, x, _y, dx| { let c = g.unary(Unary::Cosh, x); g.mul(c, dx) };

    /// Hyperbolic cosine.
    Cosh = "cosh", builtin: Some("cosh"), wgsl: Wgsl::Builtin("cosh"),
    eval: |x| x.cosh(),
    derivative: "sinh x · x'", |g, x, _y, dx| { let s = g.unary(Unary::Sinh, x); g.mul(s, dx) };

    /// Hyperbolic tangent.
    Tanh = "tanh", builtin: Some("tanh"), wgsl: Wgsl::Builtin("tanh"),
    eval: |x| x.tanh(),
    derivative: "(1 - y)(1 + y) x'", |g, _x, y, dx| {
        let product = one_minus_square(g, y);
        g.mul(product, dx)
    };

    /// Absolute value. Its derivative at zero is taken to be zero.
    Abs = "abs", builtin: Some("abs"), wgsl: Wgsl::Builtin("abs"),
    eval: |x| x.abs(),
    derivative: "sign x · x'", |g, x, _y, dx| { let s = g.unary(Unary::Sign, x); g.mul(s, dx) };

    /// The sign of a number: -1, 0 or 1; 0 for both zeros.
    Sign = "sign", builtin: None, wgsl: Wgsl::Builtin("sign"),
    eval: |x| sign(x),
    derivative: "0", |g, _x, _y, _dx| g.constant(0.0);
}

macro_rules! binary_operations {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident = $name:literal, wgsl: $wgsl:expr,
        eval: |$a:ident, $b:ident| $value:expr,
        derivative: $text:literal, |$graph:ident, $operands:pat_param, $y:ident, $d:pat_param| $rule:expr;
    )+) => {
        /// An operation on two numbers.
        #[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
        pub enum Binary {
            $( $(#[doc = $doc])+ $variant, )+
        }

        impl Binary {
            /// All of them, in the table's order.
            pub const ALL: [Self; [$(Self::$variant),+].len()] = [$(Self::$variant),+];

            /// Its name in listings.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)+ }
            }

            /// What it is, for readers.
            pub fn doc(self) -> &'static str {
                match self { $(Self::$variant => concat!($($doc),+).trim_ascii(),)+ }
            }

            /// Its WGSL.
            pub fn wgsl(self) -> Wgsl {
                match self { $(Self::$variant => $wgsl,)+ }
            }

            /// The rule of its derivative, for readers: a and b are the operands, a' and b' their derivatives,
            /// y the result.
            pub fn derivative_text(self) -> &'static str {
                match self { $(Self::$variant => $text,)+ }
            }

            /// The operation's row.
            pub fn row(self) -> Row {
                Row {
                    name: self.name(),
                    builtin: None,
                    wgsl: self.wgsl(),
                    derivative: self.derivative_text(),
                    doc: self.doc(),
                }
            }

            /// Its value.
            #[inline]
            pub fn eval(self, a: f64, b: f64) -> f64 {
                match self { $(Self::$variant => { let ($a, $b) = (a, b); $value })+ }
            }

            /// Its value in each lane.
            pub fn eval_lanes<const N: usize>(
                self,
                a: Lanes<'_, N>,
                b: Lanes<'_, N>,
                out: &mut [f64; N],
            ) {
                match self { $(Self::$variant => each_pair(a, b, out, |$a, $b| $value),)+ }
            }

            /// The derivative of `y`, which is this operation on `operands`, where those of the operands are
            /// `d`.
            pub(crate) fn derivative(
                self,
                graph: &mut Graph,
                operands: [NodeId; 2],
                y: NodeId,
                d: [NodeId; 2],
            ) -> NodeId {
                match self {
                    $(Self::$variant => {
                        let ($graph, $operands, $y, $d) = (graph, operands, y, d);
                        $rule
                    })+
                }
            }
        }
    };
}

binary_operations! {
    /// Sum.
    Add = "add", wgsl: Wgsl::Infix("+"),
    eval: |a, b| a + b,
    derivative: "a' + b'", |g, _, _y, [da, db]| g.add(da, db);

    /// Difference.
    Sub = "sub", wgsl: Wgsl::Infix("-"),
    eval: |a, b| a - b,
    derivative: "a' - b'", |g, _, _y, [da, db]| g.sub(da, db);

    /// Product.
    Mul = "mul", wgsl: Wgsl::Infix("*"),
    eval: |a, b| a * b,
    derivative: "a' b + a b'", |g, [a, b], _y, [da, db]| {
        let first = g.mul(da, b);
        let second = g.mul(a, db);
        // For a square both are one node, and their sum is its double.
        g.add(first, second)
    };

    /// Quotient.
    Div = "div", wgsl: Wgsl::Infix("/"),
    eval: |a, b| a / b,
    derivative: "(a' - y b') / b", |g, [_, b], y, [da, db]| {
        let product = g.mul(y, db);
        let difference = g.sub(da, product);
        g.div(difference, b)
    };

    /// Power: exact repeated multiplication where the exponent is an integer.
    Pow = "pow", wgsl: Wgsl::Library("power"),
    eval: |a, b| power(a, b),
    derivative: "b a^(b-1) a' + b' a^b log a, a factor that is zero annihilating what is undefined",
    |g, [a, b], y, [da, db]| {
        let by_base = power_by_base(g, a, b, da);
        let by_exponent = power_by_exponent(g, a, y, db);
        g.add(by_base, by_exponent)
    };

    /// Product that is zero where the first factor is zero, whatever the second is.
    Zmul = "zmul", wgsl: Wgsl::Library("zmul"),
    eval: |a, b| zmul(a, b),
    derivative: "a' b + a b', a zero a' or a annihilating", |g, [a, b], _y, [da, db]| {
        let first = g.zmul(da, b);
        let second = g.zmul(a, db);
        g.add(first, second)
    };
}

/// The WGSL of an integer power: a function of the shader library that takes the base and an `i32`.
pub const INTEGER_POWER_WGSL: Wgsl = Wgsl::Library("integer_power");

/// The constants that programs know by name: name, value, and what it is for readers.
pub const CONSTANTS: [(&str, f64, &str); 2] = [
    (
        "pi",
        std::f64::consts::PI,
        "Half of a full turn in radians, 3.14159…",
    ),
    (
        "e",
        std::f64::consts::E,
        "The base of natural logarithms, 2.71828…",
    ),
];

/// The operation that programs write as the function `name`. (`id`, which the language has too, is none: it
/// hands its operand on, a number or a vector.)
pub fn builtin(name: &str) -> Option<Unary> {
    Unary::ALL
        .iter()
        .copied()
        .find(|op| op.row().builtin == Some(name))
}

/// A row of the table, as data.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Row {
    /// Its name in listings.
    pub name: &'static str,
    /// The name under which programs know it as a function.
    pub builtin: Option<&'static str>,
    /// Its WGSL.
    pub wgsl: Wgsl,
    /// The rule of its derivative, for readers.
    pub derivative: &'static str,
    /// What it is, for readers.
    pub doc: &'static str,
}

impl Operation {
    /// Every operation of the table; for the integer power, exponents of every kind.
    pub fn all() -> impl Iterator<Item = Self> {
        let powers = [3, 4, 7, -2, -3].into_iter().map(Self::Power);
        let unary = Unary::ALL.iter().copied().map(Self::Unary);
        unary
            .chain(Binary::ALL.iter().copied().map(Self::Binary))
            .chain(powers)
    }

    /// How many operands it takes.
    pub fn arity(self) -> usize {
        match self {
            Self::Unary(_) | Self::Power(_) => 1,
            Self::Binary(_) => 2,
        }
    }

    /// Its name in listings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unary(op) => op.name(),
            Self::Binary(op) => op.name(),
            Self::Power(_) => "power",
        }
    }

    /// Its WGSL.
    pub fn wgsl(self) -> Wgsl {
        match self {
            Self::Unary(op) => op.wgsl(),
            Self::Binary(op) => op.wgsl(),
            Self::Power(_) => INTEGER_POWER_WGSL,
        }
    }

    /// Its value; `None` if the number of operands is not its arity.
    pub fn eval(self, operands: &[f64]) -> Option<f64> {
        match (self, operands) {
            (Self::Unary(op), &[x]) => Some(op.eval(x)),
            (Self::Power(n), &[x]) => Some(integer_power(x, n)),
            (Self::Binary(op), &[a, b]) => Some(op.eval(a, b)),
            _ => None,
        }
    }

    /// The operation on nodes; `b` counts for two operands only.
    pub fn node(self, graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
        match self {
            Self::Unary(op) => graph.unary(op, a),
            Self::Power(n) => graph.integer_power(a, n),
            Self::Binary(op) => graph.binary(op, a, b),
        }
    }

    /// The operation on nodes; `None` if the number of operands is not its arity.
    pub fn build(self, graph: &mut Graph, operands: &[NodeId]) -> Option<NodeId> {
        match (self, operands) {
            (Self::Unary(op), &[x]) => Some(graph.unary(op, x)),
            (Self::Power(n), &[x]) => Some(graph.integer_power(x, n)),
            (Self::Binary(op), &[a, b]) => Some(graph.binary(op, a, b)),
            _ => None,
        }
    }
}

/// n x^(n−1) x'.
pub(crate) fn integer_power_derivative(graph: &mut Graph, x: NodeId, n: i32, dx: NodeId) -> NodeId {
    let lower = match n.checked_sub(1) {
        Some(lower) => graph.integer_power(x, lower),
        None => {
            let lower = graph.constant(f64::from(n) - 1.0);
            graph.power(x, lower)
        }
    };
    let exponent = graph.constant(f64::from(n));
    let slope = graph.mul(exponent, lower);
    graph.mul(slope, dx)
}

/// b a^(b−1) a'.
fn power_by_base(graph: &mut Graph, a: NodeId, b: NodeId, da: NodeId) -> NodeId {
    if graph.value(da) == Some(0.0) {
        return da;
    }
    let one = graph.constant(1.0);
    let less = graph.sub(b, one);
    let lower = graph.power(a, less);
    let slope = graph.zmul(b, lower);
    graph.mul(slope, da)
}

/// b' y log a for y = a^b.
fn power_by_exponent(graph: &mut Graph, a: NodeId, y: NodeId, db: NodeId) -> NodeId {
    if graph.value(db) == Some(0.0) {
        return db;
    }
    let logarithm = graph.unary(Unary::Log, a);
    let growth = graph.zmul(y, logarithm);
    graph.zmul(db, growth)
}

/// (1 − x)(1 + x): 1 − x² without its cancellation near ±1.
fn one_minus_square(graph: &mut Graph, x: NodeId) -> NodeId {
    let one = graph.constant(1.0);
    let less = graph.sub(one, x);
    let more = graph.add(one, x);
    graph.mul(less, more)
}

/// √(1 − x²).
fn sine_of_complement(graph: &mut Graph, x: NodeId) -> NodeId {
    let square = one_minus_square(graph, x);
    graph.unary(Unary::Sqrt, square)
}

#[inline]
fn each<const N: usize>(x: &[f64; N], out: &mut [f64; N], f: impl Fn(f64) -> f64) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out = f(x);
    }
}

#[inline]
fn each_pair<const N: usize>(
    a: Lanes<'_, N>,
    b: Lanes<'_, N>,
    out: &mut [f64; N],
    f: impl Fn(f64, f64) -> f64,
) {
    match (a, b) {
        (Lanes::Each(a), Lanes::Each(b)) => {
            for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
                *out = f(a, b);
            }
        }
        (Lanes::Same(a), Lanes::Each(b)) => each(b, out, |b| f(a, b)),
        (Lanes::Each(a), Lanes::Same(b)) => each(a, out, |a| f(a, b)),
        (Lanes::Same(a), Lanes::Same(b)) => *out = [f(a, b); N],
    }
}
