//! The one table of operations.
//!
//! Everything that has to agree on what an operation is reads this table: the language's vocabulary
//! ([`builtin`]), evaluation in f64 ([`Unary::eval`], [`Binary::eval`], [`integer_power`]), the derivative
//! (in [`crate::derivative`], one arm per row), the text of a shader ([`Unary::row`] and its `wgsl`) and the
//! documentation.

/// An operation on one number.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
#[allow(missing_docs)]
pub enum Unary {
    Negate,
    Sin,
    Cos,
    Tan,
    Exp,
    Log,
    Sqrt,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Abs,
    Sign,
}

/// An operation on two numbers.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
#[allow(missing_docs)]
pub enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    /// `x^y` for an exponent that is not known while compiling.
    Power,
    /// `a·b`, but 0 wherever a is 0, even where b is infinite or undefined.
    AnnihilatingProduct,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Its name, unique in the table.
    pub name: &'static str,
    /// How a program writes it as a function, if it does.
    pub builtin: Option<&'static str>,
    /// Its value in WGSL, with `{0}` and `{1}` for the operands. A name that WGSL does not have is a function
    /// of the shaders' library.
    pub wgsl: &'static str,
    /// One sentence for documentation: domain and meaning.
    pub doc: &'static str,
}

const fn row(
    name: &'static str,
    builtin: Option<&'static str>,
    wgsl: &'static str,
    doc: &'static str,
) -> Row {
    Row {
        name,
        builtin,
        wgsl,
        doc,
    }
}

impl Unary {
    /// Every operation on one number, in the order of the table.
    pub const ALL: [Self; 15] = [
        Self::Negate,
        Self::Sin,
        Self::Cos,
        Self::Tan,
        Self::Exp,
        Self::Log,
        Self::Sqrt,
        Self::Asin,
        Self::Acos,
        Self::Atan,
        Self::Sinh,
        Self::Cosh,
        Self::Tanh,
        Self::Abs,
        Self::Sign,
    ];

    /// The operation's row.
    pub const fn row(self) -> Row {
        match self {
            Self::Negate => row("negate", None, "-{0}", "The number with the other sign."),
            Self::Sin => row(
                "sin",
                Some("sin"),
                "sin({0})",
                "The sine of an angle in radians.",
            ),
            Self::Cos => row(
                "cos",
                Some("cos"),
                "cos({0})",
                "The cosine of an angle in radians.",
            ),
            Self::Tan => row(
                "tan",
                Some("tan"),
                "tan({0})",
                "The tangent of an angle in radians.",
            ),
            Self::Exp => row(
                "exp",
                Some("exp"),
                "exp({0})",
                "The exponential, e to the power of x.",
            ),
            Self::Log => row(
                "log",
                Some("log"),
                "log({0})",
                "The natural logarithm of x > 0.",
            ),
            Self::Sqrt => row(
                "sqrt",
                Some("sqrt"),
                "sqrt({0})",
                "The square root of x ≥ 0.",
            ),
            Self::Asin => row(
                "asin",
                Some("asin"),
                "asin({0})",
                "The angle in [−π/2, π/2] whose sine is x, |x| ≤ 1.",
            ),
            Self::Acos => row(
                "acos",
                Some("acos"),
                "acos({0})",
                "The angle in [0, π] whose cosine is x, |x| ≤ 1.",
            ),
            Self::Atan => row(
                "atan",
                Some("atan"),
                "atan({0})",
                "The angle in (−π/2, π/2) whose tangent is x.",
            ),
            Self::Sinh => row("sinh", Some("sinh"), "sinh({0})", "The hyperbolic sine."),
            Self::Cosh => row("cosh", Some("cosh"), "cosh({0})", "The hyperbolic cosine."),
            Self::Tanh => row("tanh", Some("tanh"), "tanh({0})", "The hyperbolic tangent."),
            Self::Abs => row(
                "abs",
                Some("abs"),
                "abs({0})",
                "The absolute value; its derivative is the sign, 0 at 0.",
            ),
            Self::Sign => row(
                "sign",
                None,
                "sign({0})",
                "−1, 0 or 1; the derivative of the absolute value.",
            ),
        }
    }

    /// The value. Outside its domain it is NaN.
    pub fn eval(self, x: f64) -> f64 {
        match self {
            Self::Negate => -x,
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::Exp => x.exp(),
            Self::Log => x.ln(),
            Self::Sqrt => x.sqrt(),
            Self::Asin => x.asin(),
            Self::Acos => x.acos(),
            Self::Atan => x.atan(),
            Self::Sinh => x.sinh(),
            Self::Cosh => x.cosh(),
            Self::Tanh => x.tanh(),
            Self::Abs => x.abs(),
            Self::Sign => {
                if x > 0.0 {
                    1.0
                } else if x < 0.0 {
                    -1.0
                } else {
                    // Zero keeps its sign, an undefined number stays undefined.
                    x
                }
            }
        }
    }
}

impl Binary {
    /// Every operation on two numbers, in the order of the table.
    pub const ALL: [Self; 6] = [
        Self::Add,
        Self::Subtract,
        Self::Multiply,
        Self::Divide,
        Self::Power,
        Self::AnnihilatingProduct,
    ];

    /// The operation's row.
    pub const fn row(self) -> Row {
        match self {
            Self::Add => row("add", None, "{0} + {1}", "The sum."),
            Self::Subtract => row("subtract", None, "{0} - {1}", "The difference."),
            Self::Multiply => row("multiply", None, "{0} * {1}", "The product."),
            Self::Divide => row("divide", None, "{0} / {1}", "The quotient."),
            Self::Power => row(
                "power",
                None,
                "power({0}, {1})",
                "The power; an integer exponent is exact and takes a negative base; 0^0 is 1.",
            ),
            Self::AnnihilatingProduct => row(
                "zmul",
                None,
                "annihilating_product({0}, {1})",
                "The product, 0 where the first factor is 0 whatever the second is.",
            ),
        }
    }

    /// The value.
    pub fn eval(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => power(a, b),
            Self::AnnihilatingProduct => {
                if a == 0.0 {
                    0.0
                } else {
                    a * b
                }
            }
        }
    }
}

/// Exponents up to this size are taken by multiplication, in every evaluator alike.
pub const INTEGER_POWER_LIMIT: i32 = 1024;

/// `x^n` by repeated squaring, the lowest bit first: the definition that every evaluator follows, so that
/// an exponent known while compiling and the same one in a param give the same value. x^0 is 1; a negative
/// exponent is the reciprocal of the positive power.
pub fn integer_power(x: f64, n: i32) -> f64 {
    let mut rest = n.unsigned_abs();
    let mut square = x;
    let mut product = 1.0;
    let mut started = false;
    while rest > 0 {
        if rest & 1 == 1 {
            product = if started { product * square } else { square };
            started = true;
        }
        rest >>= 1;
        if rest > 0 {
            square *= square;
        }
    }
    if n < 0 { 1.0 / product } else { product }
}

/// `x^y`: by [`integer_power`] where y is an integer of at most [`INTEGER_POWER_LIMIT`], else `f64::powf`.
pub fn power(x: f64, y: f64) -> f64 {
    match as_integer_exponent(y) {
        Some(n) => integer_power(x, n),
        None => x.powf(y),
    }
}

/// The exponent as an integer, where it is one that is taken by multiplication.
pub fn as_integer_exponent(y: f64) -> Option<i32> {
    (y.abs() <= f64::from(INTEGER_POWER_LIMIT) && y == y.trunc()).then_some(y as i32)
}

/// The constants that the language starts with.
pub const CONSTANTS: [(&str, f64, &str); 2] = [
    (
        "pi",
        std::f64::consts::PI,
        "The half circumference of the unit circle, 3.14159…",
    ),
    (
        "e",
        std::f64::consts::E,
        "The base of the natural logarithm, 2.71828…",
    ),
];

/// The operation that a program writes as the function `name`. (`id`, which the language has too, is none:
/// it hands its operand on, whatever that is.)
pub fn builtin(name: &str) -> Option<Unary> {
    Unary::ALL
        .into_iter()
        .find(|op| op.row().builtin == Some(name))
}
