//! The codes of the parser's diagnostics, with their explanations.

use crate::codes::codes;
use crate::diagnostic::Code;

codes! {
    AFTER_SCENE = "after-scene", "Nothing may follow the block `Scene`.";
    BAD_CHARACTER = "bad-character", "A character that is not allowed outside comments and strings.";
    BAD_ESCAPE = "bad-escape", "After the `\\` of a string comes one of Java's escapes.";
    BAD_NUMBER = "bad-number", "A `.` without digits.";
    CONTINUES_LINE = "continues-line", "A line that begins with `+`, `-`, `^`, `[` or `(` continues the line above.";
    DROPPED_FRACTION = "dropped-fraction", "`/` of two whole numbers is a whole number.";
    DUPLICATE_ATTRIBUTE = "duplicate-attribute", "An object states an attribute twice: the last one counts.";
    DUPLICATE_PARAMETER = "duplicate-parameter", "A macro names the same parameter twice.";
    INTEGER_TOO_LARGE = "integer-too-large", "A whole number is at most 2147483647.";
    MISSING_ATTRIBUTE = "missing-attribute", "An object does not state an attribute that it needs.";
    MISSING_OPERAND = "missing-operand", "An expression lacks an operand.";
    NO_SCENE = "no-scene", "A script without a block `Scene` draws nothing.";
    NOT_ASSIGNABLE = "not-assignable", "The left side of `=` must be a name.";
    NUMBER_OUT_OF_RANGE = "number-out-of-range", "A number is too large for a 64-bit floating-point number.";
    SECOND_BLOCK = "second-block", "A script has one block `Settings` and one block `Scene`.";
    TOO_DEEP = "too-deep", "A script is nested deeper than the limit.";
    UNCLOSED_BRACKET = "unclosed-bracket", "A bracket is not closed.";
    UNCLOSED_STRING = "unclosed-string", "A string ends in the line in which it begins.";
    UNEXPECTED_TOKEN = "unexpected-token", "The grammar does not allow this token here.";
    UNKNOWN_ATTRIBUTE = "unknown-attribute", "The object does not have this attribute.";
    UNKNOWN_OBJECT = "unknown-object", "There is no object of this name.";
}

/// The codes of errors that leave the tree complete: such a script can be run, to find its run-time errors.
pub const OF_WHOLE_TREES: &[Code] = &[
    AFTER_SCENE,
    DUPLICATE_PARAMETER,
    MISSING_ATTRIBUTE,
    SECOND_BLOCK,
    UNKNOWN_OBJECT,
];
