//! The rows of operations on two numbers.
//!
//! In: nothing, or operands. Out: the enum [`Binary`], and each column as a function.

use crate::arithmetic::{at_most, greatest, least, power, zmul};
use crate::ops::lanes::{Lanes, each_pair};
use crate::ops::power::{power_by_base, power_by_exponent};
use crate::ops::{ExpressionBuilder, Row, Wgsl};

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

            /// Its description, for readers.
            pub fn doc(self) -> &'static str {
                match self { $(Self::$variant => concat!($($doc),+).trim_ascii(),)+ }
            }

            /// Its WGSL.
            pub fn wgsl(self) -> Wgsl {
                match self { $(Self::$variant => $wgsl,)+ }
            }

            /// The rule of its derivative, for readers: a and b are the operands, a' and b' their derivatives,
            /// y the result.
            pub(crate) fn derivative_text(self) -> &'static str {
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
            pub(crate) fn eval_lanes<const N: usize>(
                self,
                a: Lanes<'_, N>,
                b: Lanes<'_, N>,
                out: &mut [f64; N],
            ) {
                match self { $(Self::$variant => each_pair(a, b, out, |$a, $b| $value),)+ }
            }

            /// Returns the derivative of `y`, which is this operation on `operands`, given the derivatives `d` of the
            /// operands.
            pub(crate) fn derivative<B: ExpressionBuilder>(
                self,
                graph: &mut B,
                operands: [B::Number; 2],
                y: B::Number,
                d: [B::Number; 2],
            ) -> B::Number {
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
        // For a square both are the same node, and their sum is its double.
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

    /// The lesser of two numbers.
    Min = "min", wgsl: Wgsl::Library("least"),
    eval: |a, b| least(a, b),
    derivative: "that of the first operand to attain it", |g, [a, b], _y, d| {
        let first = g.at_most(a, b);
        chosen(g, first, d)
    };

    /// The greater of two numbers.
    Max = "max", wgsl: Wgsl::Library("greatest"),
    eval: |a, b| greatest(a, b),
    derivative: "that of the first operand to attain it", |g, [a, b], _y, d| {
        let first = g.at_most(b, a);
        chosen(g, first, d)
    };

    /// 1 where the first number is at most the second, else 0. Its derivative is taken to be zero.
    AtMost = "at_most", wgsl: Wgsl::Library("at_most"),
    eval: |a, b| at_most(a, b),
    derivative: "0", |g, _, _y, _d| g.constant(0.0);
}

/// Returns da where `first` is 1, db where it is 0; the other one may be undefined.
fn chosen<B: ExpressionBuilder>(
    graph: &mut B,
    first: B::Number,
    [da, db]: [B::Number; 2],
) -> B::Number {
    let one = graph.constant(1.0);
    let second = graph.sub(one, first);
    let left = graph.zmul(first, da);
    let right = graph.zmul(second, db);
    graph.add(left, right)
}
