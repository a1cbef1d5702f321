//! Semantic errors: their codes, and how they are reported.

use syntax::diagnostic::{Code, Diagnostic, Related, Severity};
use syntax::span::Span;

/// The operands' dimensions do not fit the operation.
pub(crate) const DIMENSION_MISMATCH: Code = Code("dimension-mismatch");
/// `a_n` with `n` above the vector's dimension.
pub(crate) const NO_SUCH_COMPONENT: Code = Code("no-such-component");
/// A function is applied to the wrong number of arguments.
pub(crate) const ARGUMENT_COUNT: Code = Code("argument-count");
/// `f'` of a function of several parameters.
pub(crate) const AMBIGUOUS_DERIVATIVE: Code = Code("ambiguous-derivative");
/// A derivative by a parameter that is a vector.
pub(crate) const VECTOR_DERIVATIVE: Code = Code("vector-derivative");
/// An expression or its derivative has too many operations.
pub(crate) const EXPRESSION_TOO_LARGE: Code = Code("expression-too-large");
/// An interval's end or count depends on a param or a grid.
pub(crate) const INTERVAL_NOT_CONSTANT: Code = Code("interval-not-constant");
/// An interval's end or count is a vector.
pub(crate) const INTERVAL_NOT_NUMBER: Code = Code("interval-not-number");
/// An interval's end or count is undefined or infinite.
pub(crate) const INTERVAL_UNDEFINED: Code = Code("interval-undefined");
/// An interval's minimum is not below its maximum.
pub(crate) const INTERVAL_EMPTY: Code = Code("interval-empty");
/// A sampling count below 2 or too large.
pub(crate) const INTERVAL_COUNT: Code = Code("interval-count");
/// The initial value of a param depends on a param or a grid.
pub(crate) const INITIAL_NOT_CONSTANT: Code = Code("opening-not-constant");
/// The initial value of a param does not have one component for each interval.
pub(crate) const INITIAL_DIMENSION: Code = Code("opening-dimension");
/// The initial value of a param is undefined or infinite.
pub(crate) const INITIAL_UNDEFINED: Code = Code("opening-undefined");
/// The initial value of a param is outside its interval.
pub(crate) const INITIAL_OUTSIDE: Code = Code("opening-outside");
/// Two intervals for one parameter.
pub(crate) const DUPLICATE_TAG: Code = Code("duplicate-tag");
/// A curve or a geodesic does not have exactly one parameter, or a surface or a metric exactly two.
pub(crate) const PARAMETER_COUNT: Code = Code("parameter-count");
/// A drawn value is not in space.
pub(crate) const NOT_IN_SPACE: Code = Code("not-in-space");
/// An object depends on grids with too many values.
pub(crate) const TOO_MANY_INSTANCES: Code = Code("too-many-instances");
/// The objects have too many samples in total.
pub(crate) const TOO_MANY_SAMPLES: Code = Code("too-many-samples");
/// The params and grids have too many components.
pub(crate) const TOO_MANY_UNIFORMS: Code = Code("too-many-params");
/// A metric's value is not (E, F, G).
pub(crate) const NOT_A_METRIC: Code = Code("not-a-metric");
/// A metric is not positive definite everywhere inside its domain.
pub(crate) const DEGENERATE_METRIC: Code = Code("degenerate-metric");
/// A geodesic is declared on something that is neither a surface nor a metric.
pub(crate) const NOT_A_SURFACE: Code = Code("not-a-surface");
/// A geodesic's direction or start does not have two components, or on a solid three.
pub(crate) const NOT_IN_CHART: Code = Code("not-in-chart");
/// A geodesic that cannot start.
pub(crate) const GEODESIC_NOT_DRAWN: Code = Code("geodesic-not-drawn");
/// A geodesic has no value for its argument.
pub(crate) const GEODESIC_UNDEFINED: Code = Code("geodesic-undefined");
/// A geodesic is used where its argument is not a number.
pub(crate) const NO_FORMULA: Code = Code("no-formula");
/// A set names something that is not a set of points.
pub(crate) const NOT_A_SOLID: Code = Code("not-a-solid");
/// A set is placed by a function that is not an affine map of space.
pub(crate) const NOT_AFFINE: Code = Code("not-affine");
/// A set is placed by a constant map that flattens it.
pub(crate) const SINGULAR_MAP: Code = Code("singular-map");
/// The solids have too many leaves.
pub(crate) const TOO_MANY_LEAVES: Code = Code("too-many-leaves");
/// A parallel light shines upwards along a vector that looks like a position.
pub(crate) const LIGHT_FROM_BELOW: Code = Code("light-from-below");
/// An attribute of a light has no effect on lights of its kind.
pub(crate) const UNUSED_ATTRIBUTE: Code = Code("unused-attribute");
/// The instances of a set fill each other's holes.
pub(crate) const FILLED_HOLES: Code = Code("filled-holes");
/// A background's colour has components in the range of bytes.
pub(crate) const BRIGHT_BACKGROUND: Code = Code("bright-background");
/// A light's colour has components in the range of bytes.
pub(crate) const BRIGHT_LIGHT: Code = Code("bright-light");
/// There is a background already.
pub(crate) const SECOND_BACKGROUND: Code = Code("second-background");
/// The value of an attribute, or a background, has the wrong dimension.
pub(crate) const ATTRIBUTE_DIMENSION: Code = Code("attribute-dimension");
/// An expression is evaluated in a program with errors.
pub(crate) const PROGRAM_HAS_ERRORS: Code = Code("program-has-errors");

/// All codes that compiling a program can return in addition to those of `syntax`, each with one sentence that explains
/// it.
pub const CODES: &[(Code, &str)] = &[
    (
        DIMENSION_MISMATCH,
        "The dimensions of the operands do not fit the operation: numbers and vectors are mixed, or vectors of different dimensions.",
    ),
    (
        NO_SUCH_COMPONENT,
        "A vector has no component of this number; components count from 1.",
    ),
    (
        ARGUMENT_COUNT,
        "A function is applied to more or fewer arguments than it has parameters.",
    ),
    (
        AMBIGUOUS_DERIVATIVE,
        "`f'` is the derivative of a function of one parameter; for several, `f_u` names the parameter.",
    ),
    (
        VECTOR_DERIVATIVE,
        "A derivative is taken with respect to a number; a parameter that is a vector must be split into its components.",
    ),
    (
        EXPRESSION_TOO_LARGE,
        "An expression, or its derivative, has more operations than the limit.",
    ),
    (
        INTERVAL_NOT_CONSTANT,
        "The ends and the count of an interval are constants: they must not depend on params or grids.",
    ),
    (
        INTERVAL_NOT_NUMBER,
        "The ends and the count of an interval are numbers, not vectors.",
    ),
    (
        INTERVAL_UNDEFINED,
        "The ends and the count of an interval have finite values.",
    ),
    (
        INTERVAL_EMPTY,
        "An interval's first end, its minimum, is below its second end, its maximum.",
    ),
    (
        INTERVAL_COUNT,
        "A sampling count is at least 2 after rounding down, and not above the limit.",
    ),
    (
        INITIAL_NOT_CONSTANT,
        "The initial value of a param is a constant: it must not depend on params or grids.",
    ),
    (
        INITIAL_DIMENSION,
        "The initial value of a param has a component for each of its intervals.",
    ),
    (INITIAL_UNDEFINED, "The initial value of a param is finite."),
    (
        INITIAL_OUTSIDE,
        "The initial value of a param lies within its intervals.",
    ),
    (DUPLICATE_TAG, "A parameter has one interval, not two."),
    (
        PARAMETER_COUNT,
        "A curve and a geodesic have one parameter, a surface and a metric have two, a solid has two or three, a background that is a function has three.",
    ),
    (
        NOT_IN_SPACE,
        "Points, vectors, curves, surfaces, lights and cameras lie in space: their values, and those by which solids are placed, are vectors of dimension 3.",
    ),
    (
        TOO_MANY_INSTANCES,
        "An object is drawn once for each combination of the values of the grids it depends on, up to a limit.",
    ),
    (
        TOO_MANY_SAMPLES,
        "All objects together have more samples than the limit.",
    ),
    (
        TOO_MANY_UNIFORMS,
        "The params and grids have more components together than the limit.",
    ),
    (
        NOT_A_METRIC,
        "A metric's value is (E, F, G), the coefficients of its first fundamental form: a vector of dimension 3.",
    ),
    (
        DEGENERATE_METRIC,
        "A metric is positive definite: inside its domain E and E G - F^2 are positive.",
    ),
    (
        NOT_A_SURFACE,
        "A geodesic lies on a surface, a metric or a solid that is declared above it.",
    ),
    (
        NOT_IN_CHART,
        "A geodesic's direction and start are vectors of dimension 2, in the parameters of its surface; on a solid they have dimension 3.",
    ),
    (
        GEODESIC_NOT_DRAWN,
        "A geodesic starts inside the domain of its surface, or near a solid, and has a direction along it; otherwise it is not drawn.",
    ),
    (
        NO_FORMULA,
        "A geodesic is integrated: its argument may depend on constants, params and grids, and on the parameter of a curve, but not on the parameters of a surface, a metric, a solid or a background, nor, in an attribute, on those of its declaration.",
    ),
    (
        GEODESIC_UNDEFINED,
        "A geodesic has no value there: it ends before, it cannot start, or no geodesic between its two points was found.",
    ),
    (
        NOT_A_SOLID,
        "A set is made of solids, and of functions of 2 or 3 numbers whose values are numbers.",
    ),
    (
        NOT_AFFINE,
        "A solid's image is taken under an affine function of 3 numbers: its derivatives depend on none of them.",
    ),
    (
        SINGULAR_MAP,
        "A map that places a solid must be defined and invertible.",
    ),
    (
        TOO_MANY_LEAVES,
        "All solids together have more leaves, with the instances that grids give them, than the limit.",
    ),
    (
        LIGHT_FROM_BELOW,
        "A parallel light shines upwards along a long vector: probably a position is meant, which follows an `@`.",
    ),
    (
        UNUSED_ATTRIBUTE,
        "A light has an attribute that has no effect on lights of its kind: a cone has an angle, light from a point or in a cone has a size, and parallel light does not fade.",
    ),
    (
        FILLED_HOLES,
        "A set is the union of its instances: where a grid moves only what is taken away, each instance fills the holes of the others.",
    ),
    (
        BRIGHT_BACKGROUND,
        "The components of a background's colour are about 0…1: where they are far above that, up to 255, bytes are meant.",
    ),
    (
        BRIGHT_LIGHT,
        "The components of a light's colour are about 0…1, and `power` makes it brighter: where they are whole numbers up to 255, bytes are meant.",
    ),
    (SECOND_BACKGROUND, "A program has one background."),
    (
        ATTRIBUTE_DIMENSION,
        "The value of an attribute is a number, or a vector of the attribute's dimension; a colour is a grey or three numbers.",
    ),
    (
        PROGRAM_HAS_ERRORS,
        "An expression has a value only in a program without errors.",
    ),
];

/// Returns true if any diagnostic is an error rather than a warning.
pub(crate) fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics
        .iter()
        .any(|diagnostic| diagnostic.severity == Severity::Error)
}

/// The maximum number of related locations for a fault in nested function applications.
const MAX_TRAIL: usize = 8;

/// An error in the meaning of an operation, before the span of its report is known.
#[derive(Clone, Debug)]
pub(crate) struct SemanticError {
    pub(crate) code: Code,
    pub(crate) message: String,
    pub(crate) hint: Option<String>,
    /// The locations inside functions' bodies that lead to it, innermost first. Empty outside any body.
    pub(crate) trail: Vec<Related>,
    /// The function in whose body it occurs, as seen from outside.
    function: Option<String>,
}

impl SemanticError {
    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
            hint: None,
            trail: Vec::new(),
            function: None,
        }
    }

    pub(crate) fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Returns the error with its span in the body of a function added.
    pub(crate) fn in_body(mut self, function: &str, place: Span) -> Self {
        if self.trail.len() < MAX_TRAIL {
            let message = if self.trail.is_empty() {
                format!("here, in the body of `{function}`")
            } else {
                format!("reached from here, in the body of `{function}`")
            };
            self.trail.push(Related {
                span: place,
                message,
            });
        }
        self.function = Some(function.to_owned());
        self
    }

    /// Returns the error as a diagnostic at `span`, which for a fault inside a function's body is the function's
    /// application.
    pub(crate) fn at(self, span: Span) -> Diagnostic {
        let message = match self.function {
            Some(function) => format!("in `{function}`: {}", self.message),
            None => self.message,
        };
        Diagnostic {
            severity: Severity::Error,
            code: self.code,
            span,
            message,
            hint: self.hint,
            related: self.trail,
            fixes: Vec::new(),
        }
    }
}
