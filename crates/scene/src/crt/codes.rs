//! The codes of a run's diagnostics, with their explanations.

use syntax::diagnostic::Code;

macro_rules! codes {
    ($($constant:ident = $name:literal, $explanation:literal;)*) => {
        $(#[doc = $explanation] pub const $constant: Code = Code($name);)*

        /// Every code of this module with one sentence that explains it, for documentation.
        pub const CODES: &[(Code, &str)] = &[$(($constant, $explanation)),*];
    };
}

/// The code of an internal error. It is a fault of this program and not of a script, so it is not in [`CODES`].
pub const INTERNAL_ERROR: Code = Code("internal-error");

codes! {
    ARGUMENT_COUNT = "argument-count", "A macro or a function is called with a wrong number of arguments.";
    CALL_DEPTH = "call-depth", "Calls within calls are limited to 200.";
    CIRCULAR_VARIABLE = "circular-variable", "A variable would point to itself.";
    DIVISION_BY_ZERO = "division-by-zero", "A whole number cannot be divided by 0.";
    INDEX_OUT_OF_RANGE = "index-out-of-range", "A list has no element at this index; the first index is 0.";
    NO_EFFECT = "no-effect", "The value of a statement is not used.";
    NOT_A_MACRO = "not-a-macro", "Only a macro or a function can be called.";
    NOT_DRAWN = "not-drawn", "An entity is drawn only in `Scene` or in a macro that is called there.";
    OUT_OF_RANGE = "out-of-range", "The value of an attribute is out of range.";
    POINTS_LATER = "points-later", "A variable points to another one that is assigned later.";
    TOO_LARGE = "too-large", "Strings and lists are limited to a million bytes or elements, nested lists to 256 levels.";
    TOO_MANY_LEAVES = "too-many-leaves", "All entities together have at most a million leaves.";
    TYPE_MISMATCH = "type-mismatch", "A value has the wrong type.";
    UNKNOWN_VARIABLE = "unknown-variable", "No variable of this name has been assigned.";
    WORK_LIMIT = "work-limit", "A script is limited to a million rounds of loops, calls and objects, and to 64 million expressions.";
}
