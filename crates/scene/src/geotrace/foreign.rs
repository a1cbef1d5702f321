//! Words of other notations, with their equivalents.

use syntax::geotrace::symbols::{ForeignWord, NO_CONDITIONS};

const fn written(word: &'static str, hint: &'static str, replacement: &'static str) -> ForeignWord {
    ForeignWord {
        word,
        is_applied: None,
        hint,
        replacement: Some(replacement),
        is_of_sets: false,
    }
}

const fn explained(word: &'static str, hint: &'static str) -> ForeignWord {
    ForeignWord {
        word,
        is_applied: None,
        hint,
        replacement: None,
        is_of_sets: false,
    }
}

const fn of_sets(word: &'static str, hint: &'static str) -> ForeignWord {
    ForeignWord {
        is_of_sets: true,
        ..explained(word, hint)
    }
}

/// The name of a colour.
macro_rules! colour {
    ($word:literal, $value:literal) => {
        ForeignWord {
            word: $word,
            is_applied: Some(false),
            hint: concat!(
                "a colour is its red, green and blue, each from 0 to 1: write `",
                $value,
                "`"
            ),
            replacement: Some($value),
            is_of_sets: false,
        }
    };
}

const LENGTH: &str = "write `sqrt*v` for the length of a vector v: `*v` is v·v";
const INFINITE: &str = "there is no infinite number: an interval has two ends";
const UNDEFINED: &str = "no name means an undefined value: `0/0` is undefined";
const ROUNDS: &str =
    "no builtin function rounds: all of them are continuous where they are defined";
const UNION: &str = "the points of either are `a | b`, in a `solid` without parameters";
const INTERSECTION: &str = "the points of both are `a & b`, in a `solid` without parameters";
const DIFFERENCE: &str =
    "the points of a that are not of b are `a \\ b`, in a `solid` without parameters";
const MOVED: &str = "a solid is moved by a vector: `a @ (1, 0, 0)`";
const SHAPE: &str =
    "a solid is where a function is not positive: `solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;`";
const DERIVATIVE: &str = "a derivative is written at the function's name: `f' x`, or `f_x(x, y)` for one of several parameters";

/// The table.
pub(crate) const FOREIGN_WORDS: &[ForeignWord] = &[
    written("ln", "the natural logarithm is `log`", "log"),
    written("arcsin", "the inverse of `sin` is `asin`", "asin"),
    written("arccos", "the inverse of `cos` is `acos`", "acos"),
    written("arctan", "the inverse of `tan` is `atan`", "atan"),
    written("arctg", "the inverse of `tan` is `atan`", "atan"),
    written("tg", "the tangent is `tan`", "tan"),
    written("tau", "write `2pi`", "(2pi)"),
    explained(
        "lg",
        "`log` is the natural logarithm: write `log(x)/log 10` for base 10",
    ),
    explained(
        "log10",
        "`log` is the natural logarithm: write `log(x)/log 10` for base 10",
    ),
    explained(
        "log2",
        "`log` is the natural logarithm: write `log(x)/log 2` for base 2",
    ),
    explained("asinh", "write `log(x + sqrt(x^2 + 1))`"),
    explained("acosh", "write `log(x + sqrt(x^2 - 1))`"),
    explained("atanh", "write `log((1 + x)/(1 - x))/2`"),
    explained("sech", "write `1/cosh x`"),
    explained("csch", "write `1/sinh x`"),
    explained("coth", "write `1/tanh x`"),
    explained("pow", "a power is written `a^b`"),
    explained("cbrt", "write `x^(1/3)`, which is undefined below 0"),
    explained("hypot", "write `sqrt(x^2 + y^2)`"),
    explained("diff", DERIVATIVE),
    explained("derivative", DERIVATIVE),
    explained("dx", DERIVATIVE),
    explained("dt", DERIVATIVE),
    explained("sec", "write `1/cos x`"),
    explained("csc", "write `1/sin x`"),
    explained("cosec", "write `1/sin x`"),
    explained("cot", "write `1/tan x`"),
    explained("cotan", "write `1/tan x`"),
    explained("ctg", "write `1/tan x`"),
    explained(
        "atan2",
        "write `2atan(y/(sqrt(x^2 + y^2) + x))` for the angle of (x, y)",
    ),
    ForeignWord {
        is_applied: Some(false),
        ..explained(
            "max",
            "it is a function before a bracket: write `max(a, b)`",
        )
    },
    ForeignWord {
        is_applied: Some(false),
        ..explained(
            "min",
            "it is a function before a bracket: write `min(a, b)`",
        )
    },
    of_sets("union", UNION),
    of_sets("intersection", INTERSECTION),
    of_sets("intersect", INTERSECTION),
    of_sets("difference", DIFFERENCE),
    of_sets("cup", UNION),
    of_sets("or", UNION),
    of_sets("cap", INTERSECTION),
    of_sets("and", INTERSECTION),
    of_sets("setminus", DIFFERENCE),
    of_sets("minus", DIFFERENCE),
    of_sets("subtract", DIFFERENCE),
    of_sets("translate", MOVED),
    of_sets("move", MOVED),
    of_sets("sphere", SHAPE),
    of_sets("box", SHAPE),
    explained("norm", LENGTH),
    explained("length", LENGTH),
    explained(
        "dot",
        "two vectors side by side, `v w`, are their dot product",
    ),
    explained("cross", "the cross product is written `v * w`"),
    explained("inf", INFINITE),
    explained("infinity", INFINITE),
    explained("oo", INFINITE),
    explained("nan", UNDEFINED),
    explained("NaN", UNDEFINED),
    explained("sign", "write `x/abs x`, which is undefined at 0"),
    explained("sgn", "write `x/abs x`, which is undefined at 0"),
    explained("floor", ROUNDS),
    explained("ceil", ROUNDS),
    explained("round", ROUNDS),
    explained("mod", ROUNDS),
    explained("if", NO_CONDITIONS),
    explained("then", NO_CONDITIONS),
    explained("else", NO_CONDITIONS),
    explained("If", NO_CONDITIONS),
    explained("iff", NO_CONDITIONS),
    explained("ifelse", NO_CONDITIONS),
    explained("cases", NO_CONDITIONS),
    explained("piecewise", NO_CONDITIONS),
    explained("Piecewise", NO_CONDITIONS),
    ForeignWord {
        is_applied: Some(true),
        ..written(
            "rgb",
            "a colour is a vector: write `(1, 0, 0)`, each part from 0 to 1",
            "",
        )
    },
    ForeignWord {
        is_applied: Some(true),
        ..written("vec3", "a vector is written `(1, 2, 3)`", "")
    },
    colour!("red", "(1, 0, 0)"),
    colour!("green", "(0, 0.5, 0)"),
    colour!("blue", "(0, 0, 1)"),
    colour!("yellow", "(1, 1, 0)"),
    colour!("orange", "(1, 0.65, 0)"),
    colour!("cyan", "(0, 1, 1)"),
    colour!("magenta", "(1, 0, 1)"),
    colour!("purple", "(0.5, 0, 0.5)"),
    colour!("pink", "(1, 0.75, 0.8)"),
    colour!("brown", "(0.65, 0.16, 0.16)"),
    colour!("gold", "(1, 0.84, 0)"),
    colour!("white", "(1, 1, 1)"),
    colour!("gray", "(0.5, 0.5, 0.5)"),
    colour!("grey", "(0.5, 0.5, 0.5)"),
    colour!("black", "(0, 0, 0)"),
    ForeignWord {
        is_applied: Some(false),
        ..explained("i", "numbers are real: a complex number is a pair `(x, y)`")
    },
    ForeignWord {
        is_applied: Some(true),
        ..explained(
            "K",
            "no builtin gives the curvature: the command `measure` and the window show it",
        )
    },
    ForeignWord {
        is_applied: Some(true),
        ..explained("at", "a position follows `@`")
    },
];

#[cfg(test)]
mod tests {
    use super::FOREIGN_WORDS;

    #[test]
    fn each_word_is_explained_once_and_means_nothing_here() {
        for (k, foreign) in FOREIGN_WORDS.iter().enumerate() {
            let word = foreign.word;
            assert!(
                FOREIGN_WORDS[..k].iter().all(|it| it.word != word),
                "{word}"
            );
            let source = format!("define result = {word}(2);");
            let found = crate::geotrace::compile(&source).diagnostics;
            let hints: Vec<&str> = found.iter().filter_map(|it| it.hint.as_deref()).collect();
            match foreign.is_applied {
                Some(false) => assert!(!hints.contains(&foreign.hint), "{word}: {hints:?}"),
                _ => assert!(hints.contains(&foreign.hint), "{word}: {hints:?}"),
            }
            // A replacement stands for the word wherever it stands.
            if let Some(text) = foreign.replacement {
                let source = format!("define result = 3 {text}(0.5)^2;");
                assert!(!crate::geotrace::compile(&source).has_errors(), "{text}");
            }
        }
    }

    #[test]
    fn in_a_set_only_words_of_sets_are_explained() {
        let ball = "solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;";
        for (set, hint) in [
            ("ball \\ gold", None),
            ("round", None),
            ("union(ball, ball)", Some("`a | b`")),
            ("sphere", Some("solid ball(x, y, z)")),
        ] {
            let found = crate::geotrace::compile(&format!("{ball}\nsolid c = {set};")).diagnostics;
            let found = found.first().expect("an error");
            let told = found.hint.as_deref();
            assert_eq!(told.is_some(), hint.is_some(), "{set}: {told:?}");
            assert!(
                told.unwrap_or_default().contains(hint.unwrap_or_default()),
                "{told:?}"
            );
            assert_eq!(found.fixes, [], "{set}");
        }
    }

    #[test]
    fn a_declaration_of_another_notation_has_one_message() {
        let ball = "solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;";
        for (source, hint) in [
            ("solid b = x^2 + y^2 + z^2 - 1;", "solid b(x, y, z)"),
            ("solid b(x, y, z) = |x| - 1;", "abs x"),
            ("solid c = max(ball, ball @ (1, 0, 0));", "a & b"),
            ("solid c = min(ball, ball @ (1, 0, 0));", "a | b"),
            ("solid c = ball @ scale 1/2;", "scale (1/2)"),
            ("solid c = ball @ rotate pi/2 (0, 0, 1);", "(0, 0, pi/2)"),
            ("surface s(x, y, z) = x^2 - 1;", "solid s(x, y, z)"),
            ("vector v = (0, 0, 0) -> (1, 1, 1);", "direction @ origin"),
            ("function h(x) -> x^2;", "`=`"),
            (
                "metric h(x, y) = (dx^2 + dy^2)/y^2, x : [0, 1], y : [1, 2];",
                "(E, F, G)",
            ),
            ("curve c(t) = (cos t, sin t, 0);\nt : [0, 2pi];", "`,`"),
        ] {
            let source = format!("{ball}\n{source}");
            let found = crate::geotrace::compile(&source).diagnostics;
            let [found] = &found[..] else {
                panic!("{source}: {found:?}");
            };
            let told = found.hint.as_deref().unwrap_or_default();
            assert!(told.contains(hint), "{source}: {told}");
        }
    }
}
