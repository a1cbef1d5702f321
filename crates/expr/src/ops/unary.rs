//! The rows of operations on one number.
//!
//! In: nothing, or an operand. Out: the enum [`Unary`], and each column as a function.

use crate::arithmetic::sign;
use crate::ops::lanes::each;
use crate::ops::slopes::{
    Arithmetic, one_minus_square, reciprocal_of_complement, reciprocal_of_one_plus_square,
};
use crate::ops::{ExpressionBuilder, Row, Wgsl};

macro_rules! unary_operations {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident = $name:literal, builtin: $builtin:expr, wgsl: $wgsl:expr,
        eval: |$x:ident| $value:expr,
        derivative: $text:literal, |$graph:ident, $a:ident, $y:ident, $da:ident| $rule:expr,
        slopes: |$n:ident, $s:ident, $t:ident| $slopes:expr;
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

            /// Its description, for readers.
            pub fn doc(self) -> &'static str {
                match self { $(Self::$variant => concat!($($doc),+).trim_ascii(),)+ }
            }

            /// The name of the function in programs, if it has one.
            pub fn builtin(self) -> Option<&'static str> {
                match self { $(Self::$variant => $builtin,)+ }
            }

            /// Its WGSL.
            pub fn wgsl(self) -> Wgsl {
                match self { $(Self::$variant => $wgsl,)+ }
            }

            /// The rule of its derivative, for readers: x is the operand, x' its derivative.
            pub(crate) fn derivative_text(self) -> &'static str {
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
            pub(crate) fn eval_lanes<const N: usize>(self, x: &[f64; N], out: &mut [f64; N]) {
                match self { $(Self::$variant => each(x, out, |$x| $value),)+ }
            }

            /// Returns its first and second derivative at `x`, where its value is `y`, in any arithmetic. A derivative
            /// that is zero everywhere is the constant 0.
            pub fn slopes<A: Arithmetic>(
                self,
                arithmetic: &mut A,
                x: A::Number,
                y: A::Number,
            ) -> [A::Number; 2] {
                match self {
                    $(Self::$variant => {
                        let ($n, $s, $t) = (arithmetic, x, y);
                        $slopes
                    })+
                }
            }

            /// Returns the derivative of `y`, which is this operation on `x`, given the derivative `dx` of `x`.
            pub(crate) fn derivative<B: ExpressionBuilder>(
                self,
                graph: &mut B,
                x: B::Number,
                y: B::Number,
                dx: B::Number,
            ) -> B::Number {
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
    derivative: "-x'", |g, _x, _y, dx| g.neg(dx),
    slopes: |n, _x, _y| [n.constant(-1.0), n.constant(0.0)];

    /// Sine of an angle in radians.
    Sin = "sin", builtin: Some("sin"), wgsl: Wgsl::Builtin("sin"),
    eval: |x| x.sin(),
    derivative: "x' cos x", |g, x, _y, dx| { let c = g.unary(Unary::Cos, x); g.mul(c, dx) },
    slopes: |n, x, y| [n.unary(Unary::Cos, x), n.neg(y)];

    /// Cosine of an angle in radians.
    Cos = "cos", builtin: Some("cos"), wgsl: Wgsl::Builtin("cos"),
    eval: |x| x.cos(),
    derivative: "-x' sin x", |g, x, _y, dx| {
        let s = g.unary(Unary::Sin, x);
        let product = g.mul(s, dx);
        g.neg(product)
    },
    slopes: |n, x, y| { let s = n.unary(Unary::Sin, x); [n.neg(s), n.neg(y)] };

    /// Tangent of an angle in radians.
    Tan = "tan", builtin: Some("tan"), wgsl: Wgsl::Builtin("tan"),
    eval: |x| x.tan(),
    derivative: "x'/cos^2 x", |g, _x, y, dx| {
        let one = g.constant(1.0);
        let square = g.mul(y, y);
        let sum = g.add(one, square);
        g.mul(sum, dx)
    },
    slopes: |n, _x, y| {
        let (one, two) = (n.constant(1.0), n.constant(2.0));
        let square = n.mul(y, y);
        let first = n.add(one, square);
        let twice = n.mul(two, y);
        [first, n.mul(twice, first)]
    };

    /// The exponential function: e to a power.
    Exp = "exp", builtin: Some("exp"), wgsl: Wgsl::Builtin("exp"),
    eval: |x| x.exp(),
    derivative: "x' exp x", |g, _x, y, dx| g.mul(y, dx),
    slopes: |_n, _x, y| [y, y];

    /// Natural logarithm; undefined below zero, minus infinity at zero.
    Log = "log", builtin: Some("log"), wgsl: Wgsl::Builtin("log"),
    eval: |x| x.ln(),
    derivative: "x'/x", |g, x, _y, dx| {
        let defined = at_least_zero(g, x);
        let (dx, x) = (g.mul(defined, dx), g.mul(defined, x));
        g.div(dx, x)
    },
    slopes: |n, x, _y| {
        let defined = at_least_zero(n, x);
        let x = n.mul(defined, x);
        let first = n.div(defined, x);
        let square = n.mul(first, first);
        [first, n.neg(square)]
    };

    /// Square root; undefined below zero.
    Sqrt = "sqrt", builtin: Some("sqrt"), wgsl: Wgsl::Builtin("sqrt"),
    eval: |x| x.sqrt(),
    derivative: "x'/(2 sqrt x)", |g, _x, y, dx| {
        let two = g.constant(2.0);
        let double = g.mul(two, y);
        g.div(dx, double)
    },
    slopes: |n, _x, y| {
        let (one, half) = (n.constant(1.0), n.constant(0.5));
        let reciprocal = n.div(one, y);
        let first = n.mul(half, reciprocal);
        let square = n.mul(first, first);
        let second = n.mul(square, reciprocal);
        [first, n.neg(second)]
    };

    /// The angle in [-π/2, π/2] with this sine; undefined outside [-1, 1].
    Asin = "asin", builtin: Some("asin"), wgsl: Wgsl::Builtin("asin"),
    eval: |x| x.asin(),
    derivative: "x'/sqrt(1 - x^2)", |g, x, _y, dx| {
        let root = sine_of_complement(g, x);
        g.div(dx, root)
    },
    slopes: |n, x, _y| reciprocal_of_complement(n, x);

    /// The angle in [0, π] with this cosine; undefined outside [-1, 1].
    Acos = "acos", builtin: Some("acos"), wgsl: Wgsl::Builtin("acos"),
    eval: |x| x.acos(),
    derivative: "-x'/sqrt(1 - x^2)", |g, x, _y, dx| {
        let root = sine_of_complement(g, x);
        let quotient = g.div(dx, root);
        g.neg(quotient)
    },
    slopes: |n, x, _y| { let [first, second] = reciprocal_of_complement(n, x); [n.neg(first), n.neg(second)] };

    /// The angle in (-π/2, π/2) with this tangent.
    Atan = "atan", builtin: Some("atan"), wgsl: Wgsl::Builtin("atan"),
    eval: |x| x.atan(),
    derivative: "x'/(1 + x^2)", |g, x, _y, dx| {
        let one = g.constant(1.0);
        let square = g.mul(x, x);
        let sum = g.add(one, square);
        g.div(dx, sum)
    },
    slopes: |n, x, _y| reciprocal_of_one_plus_square(n, x);

    /// Hyperbolic sine.
    Sinh = "sinh", builtin: Some("sinh"), wgsl: Wgsl::Builtin("sinh"),
    eval: |x| x.sinh(),
    derivative: "x' cosh x", |g, x, _y, dx| { let c = g.unary(Unary::Cosh, x); g.mul(c, dx) },
    slopes: |n, x, y| [n.unary(Unary::Cosh, x), y];

    /// Hyperbolic cosine.
    Cosh = "cosh", builtin: Some("cosh"), wgsl: Wgsl::Builtin("cosh"),
    eval: |x| x.cosh(),
    derivative: "x' sinh x", |g, x, _y, dx| { let s = g.unary(Unary::Sinh, x); g.mul(s, dx) },
    slopes: |n, x, y| [n.unary(Unary::Sinh, x), y];

    /// Hyperbolic tangent.
    Tanh = "tanh", builtin: Some("tanh"), wgsl: Wgsl::Builtin("tanh"),
    eval: |x| x.tanh(),
    // 1 − tanh² x would lose its digits with growing x, and the derivatives of 1/cosh² x would be 0·∞.
    derivative: "x'/cosh^2 x", |g, x, _y, dx| {
        let sech = g.unary(Unary::Sech, x);
        let square = g.mul(sech, sech);
        g.mul(square, dx)
    },
    slopes: |n, x, y| {
        let minus_two = n.constant(-2.0);
        let sech = n.unary(Unary::Sech, x);
        let first = n.mul(sech, sech);
        let twice = n.mul(minus_two, y);
        [first, n.mul(twice, first)]
    };

    /// Hyperbolic secant: 1/cosh x.
    Sech = "sech", builtin: None, wgsl: Wgsl::Library("sech"),
    eval: |x| 1.0 / x.cosh(),
    derivative: "-x' tanh x/cosh x", |g, x, y, dx| {
        let tanh = g.unary(Unary::Tanh, x);
        let first = g.mul(y, tanh);
        let product = g.mul(first, dx);
        g.neg(product)
    },
    slopes: |n, x, y| {
        let (one, minus_two) = (n.constant(1.0), n.constant(-2.0));
        let tanh = n.unary(Unary::Tanh, x);
        let first = n.mul(y, tanh);
        let square = n.mul(y, y);
        let twice = n.mul(minus_two, square);
        let sum = n.add(one, twice);
        [n.neg(first), n.mul(y, sum)]
    };

    /// Absolute value. Its derivative at zero is taken to be zero.
    Abs = "abs", builtin: Some("abs"), wgsl: Wgsl::Builtin("abs"),
    eval: |x| x.abs(),
    derivative: "x' x/abs x", |g, x, _y, dx| { let s = g.unary(Unary::Sign, x); g.mul(s, dx) },
    slopes: |n, x, _y| [n.unary(Unary::Sign, x), n.constant(0.0)];

    /// The sign of a number: -1, 0 or 1; 0 for both zeros.
    Sign = "sign", builtin: None, wgsl: Wgsl::Builtin("sign"),
    eval: |x| sign(x),
    derivative: "0", |g, _x, _y, _dx| g.constant(0.0),
    slopes: |n, _x, _y| [n.constant(0.0), n.constant(0.0)];
}

/// 1 where x is at least 0, else 0: a quotient of two products with it is undefined below 0, as a logarithm is.
fn at_least_zero<A: Arithmetic>(n: &mut A, x: A::Number) -> A::Number {
    let zero = n.constant(0.0);
    n.at_most(zero, x)
}

/// √(1 − x²).
fn sine_of_complement<B: ExpressionBuilder>(graph: &mut B, x: B::Number) -> B::Number {
    let square = one_minus_square(graph, x);
    graph.unary(Unary::Sqrt, square)
}
