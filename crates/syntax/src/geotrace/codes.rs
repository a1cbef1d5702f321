//! The codes of the parser's diagnostics, with their explanations.

use crate::codes::codes;
use crate::diagnostic::Code;

codes! {
    ATTRIBUTE_NOT_HERE = "attribute-not-here", "This kind of declaration does not have this attribute.";
    ATTRIBUTE_RANGE = "attribute-range", "The value of an attribute lies in its range, or is one of its words.";
    BAD_CHARACTER = "bad-character", "A character that is not allowed outside comments.";
    BAD_NUMBER = "bad-number", "A `.` without digits.";
    COMPONENT_INDEX = "component-index", "After the `_` of a value comes a positive integer.";
    DUPLICATE_ATTRIBUTE = "duplicate-attribute", "A declaration states each attribute once.";
    DUPLICATE_PARAMETER = "duplicate-parameter", "A parameter list names the same parameter twice.";
    EXPECTED_DECLARATION = "expected-declaration", "A declaration begins with one of the keywords.";
    MISMATCHED_BRACKET = "mismatched-bracket", "A bracket is closed by a bracket of another kind.";
    MISSING_ARGUMENT = "missing-argument", "A function has no operand.";
    MISSING_INTERVAL = "missing-interval", "A curve, a surface, a metric or a geodesic needs an interval for each of its parameters.";
    MISSING_SEMICOLON = "missing-semicolon", "A declaration ends without its `;`.";
    MISSING_TAG = "missing-tag", "An interval of a domain begins with the parameter that it is for.";
    NAME_TAKEN = "name-taken", "A new name must be free: names are never redefined and parameters never shadow.";
    NAME_TOO_LONG = "name-too-long", "A name has at most 255 characters.";
    NO_PARAMETERS = "no-parameters", "A builtin function has no named parameters to differentiate by.";
    NUMBER_OUT_OF_RANGE = "number-out-of-range", "A number is too large for a 64-bit floating-point number.";
    NUMBER_UNDERFLOW = "number-underflow", "A number is so small that it is read as 0.";
    SURPRISING_READING = "surprising-reading", "Legal, but probably not read as intended.";
    TOO_DEEP = "too-deep", "An expression is nested deeper than the limit.";
    UNCLOSED_BRACKET = "unclosed-bracket", "A bracket is not closed before the declaration ends.";
    UNDEFINED_NAME = "undefined-name", "A word that is not defined here.";
    UNEXPECTED_TOKEN = "unexpected-token", "The grammar does not allow this token here.";
    UNKNOWN_ATTRIBUTE = "unknown-attribute", "A word after a `,` of a declaration that is neither one of its parameters nor an attribute.";
    UNKNOWN_PARAMETER = "unknown-parameter", "A partial derivative by a name that is not a parameter of the function.";
    UNKNOWN_TAG = "unknown-tag", "An interval's tag is not one of the parameters.";
}
