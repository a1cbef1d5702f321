//! What the fixes write: each leaves a text that means what was meant, and has no diagnostic of its own.

#[path = "support/recorder.rs"]
mod support;

use support::{parse, program_diagnostics};
use syntax::diagnostic::Diagnostic;

const PRELUDE: &str = "define t = 1; define x = 1; define y = 1; function f(q) = q; ";

/// The hint and the texts after each fix of the only diagnostic of an expression.
fn repaired(expression: &str) -> (Diagnostic, Vec<String>) {
    let source = format!("{PRELUDE}define z = {expression};");
    let mut found = parse(&source).0.diagnostics;
    assert_eq!(found.len(), 1, "{expression}: {found:?}");
    let diagnostic = found.remove(0);
    let texts = diagnostic.fixes.iter().map(|fix| {
        let mut text = source.clone();
        let place = fix.span.start as usize..fix.span.end as usize;
        text.replace_range(place, &fix.replacement);
        assert_eq!(program_diagnostics(&text), [""; 0], "{text}");
        let text = text.split("define z = ").nth(1).unwrap_or_default();
        text.trim_end_matches(';').to_owned()
    });
    let texts = texts.collect();
    (diagnostic, texts)
}

#[test]
fn a_short_argument_takes_the_whole_product() {
    for (expression, meant, read) in [
        ("cos 2pi t", "cos(2pi t)", "(cos 2) pi t"),
        ("cos 2 pi t", "cos(2 pi t)", "(cos 2) pi t"),
        ("cos 2t^2", "cos(2t^2)", "(cos 2) t^2"),
        ("exp 2cos t", "exp(2cos t)", "(exp 2) cos t"),
        ("sin 2f(x)", "sin(2f(x))", "(sin 2) f(x)"),
        ("sin 2f'x", "sin(2f'x)", "(sin 2) f'x"),
        ("sin 2(x + y)", "sin(2(x + y))", "(sin 2) (x + y)"),
        ("1 - sin 2x + y", "1 - sin(2x) + y", "1 - (sin 2) x + y"),
    ] {
        let (found, texts) = repaired(expression);
        assert_eq!(texts, [meant, read], "{expression}");
        assert!(found.fixes.iter().all(|fix| !fix.preferred));
    }
}

#[test]
fn a_short_argument_that_may_end_early_has_no_fix() {
    for (expression, message) in [
        ("sin 2x cos y", "`sin 2x` is read as `(sin 2) x`"),
        ("cos 2t (1, 0, 0)", "`cos 2t` is read as `(cos 2) t`"),
        ("sin 2x/3", "`sin 2x/3` is read as `(sin 2) x/3`"),
    ] {
        let (found, texts) = repaired(expression);
        assert_eq!(found.message, message);
        assert_eq!(texts, [""; 0], "{expression}");
    }
}

#[test]
fn a_power_of_a_value_has_brackets() {
    for (expression, meant) in [
        ("cos(x)^-1", &["(cos(x))^-1"][..]),
        ("cos(x)^2", &["(cos(x))^2", "cos^2 (x)"]),
        ("cos(t)**2", &["(cos(t))^2", "cos(t)* *2"]),
        ("x**2", &["x^2", "x* *2"]),
        ("(x + y)**2", &["(x + y)^2", "(x + y)* *2"]),
    ] {
        assert_eq!(repaired(expression).1, meant, "{expression}");
    }
}

#[test]
fn a_product_that_looks_like_something_else_has_a_fix_for_each_meaning() {
    for (expression, texts) in [
        ("1..2", &["1*.2"][..]),
        ("2. 3", &["2.3", "2*3"]),
        ("(1 2 3)", &["(1, 2, 3)", "(1*2*3)"]),
        ("[1 .5]", &["[1, .5]", "[1*.5]"]),
        ("2^xy", &["2^(xy)", "2^x y"]),
        ("e^-xy", &["e^(-xy)", "e^-x y"]),
        ("sin-1(x)", &["asin(x)", "(sin -1) (x)"]),
        ("sin-1x", &["asin x", "(sin -1) x"]),
        ("sqrt[3](x)", &["(sqrt 3)(x)"]),
    ] {
        assert_eq!(repaired(expression).1, texts, "{expression}");
    }
}

#[test]
fn a_product_with_a_function_is_not_the_inverse_of_another() {
    for (source, texts) in [
        (
            "function g(a, s) = 2asins;",
            [
                "function g(a, s) = 2a sin s;",
                "function g(a, s) = 2asin s;",
            ],
        ),
        (
            "define a = 1; function g(s) = sacoss^2;",
            [
                "define a = 1; function g(s) = sa cos s^2;",
                "define a = 1; function g(s) = sacos s^2;",
            ],
        ),
    ] {
        let found = parse(source).0.diagnostics;
        assert_eq!(found.len(), 1, "{source}: {found:?}");
        for (fix, meant) in found[0].fixes.iter().zip(texts) {
            let mut text = source.to_owned();
            let place = fix.span.start as usize..fix.span.end as usize;
            text.replace_range(place, &fix.replacement);
            assert_eq!(text, meant);
            assert_eq!(program_diagnostics(&text), [""; 0], "{text}");
        }
    }
}

#[test]
fn a_product_that_looks_like_what_it_is_has_no_warning() {
    for expression in [
        "(1 x 3)",
        "(2)(3)",
        "x^xy",
        "2^x y",
        "2^3x",
        "sqrt[3]",
        "sqrt(3)(x)",
        "1. x",
        "sin -1",
    ] {
        let source = format!("{PRELUDE}define z = {expression};");
        assert_eq!(program_diagnostics(&source), [""; 0], "{expression}");
    }
}

#[test]
fn a_fraction_of_a_power_may_have_a_sign() {
    let (found, texts) = repaired("2^-1/2");
    assert_eq!(found.message, "`a^-1/2` is read as `(a^-1)/2`");
    assert_eq!(texts, ["2^(-1/2)"]);
    assert_eq!(repaired("2^1/2").1, ["2^(1/2)"]);
}

#[test]
fn an_interval_is_written_with_the_words_of_the_language() {
    let source = "curve c(t) = (cos t, sin t, 0), 0 ≤ t ≤ 2π;";
    let found = parse(source).0.diagnostics;
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].fixes[0].replacement, "t : [0, 2pi]");
}

#[test]
fn what_replaces_a_character_does_not_run_into_its_neighbours() {
    for (source, meant) in [
        ("function f(t) = t²3;", "function f(t) = t^2 3;"),
        ("define a = 2²2;", "define a = 2^2 2;"),
        ("define a = 3³.5;", "define a = 3^3 .5;"),
        ("define a = 2²e3;", "define a = 2^2 e3;"),
        ("function f(x) = exπ;", "function f(x) = ex pi;"),
        ("function f(t) = 2πt;", "function f(t) = 2pi t;"),
        ("function f(x) = 2x√2;", "function f(x) = 2x sqrt 2;"),
    ] {
        // A name that is not defined is no matter of the characters.
        let found = parse(source).0.diagnostics;
        let fixes: Vec<_> = found.iter().flat_map(|found| &found.fixes).collect();
        let [fix] = fixes[..] else {
            panic!("{source}: {found:?}");
        };
        let place = fix.span.start as usize..fix.span.end as usize;
        let mut text = source.to_owned();
        text.replace_range(place, &fix.replacement);
        assert_eq!(text, meant);
    }
}

/// The text after all fixes that may be applied together.
fn with_all_fixes(source: &str) -> String {
    let found = parse(source).0.diagnostics;
    let mut fixes: Vec<_> = found.iter().flat_map(|found| &found.fixes).collect();
    fixes.retain(|fix| fix.all);
    fixes.sort_by_key(|fix| std::cmp::Reverse(fix.span));
    let mut text = source.to_owned();
    for fix in fixes {
        let place = fix.span.start as usize..fix.span.end as usize;
        text.replace_range(place, &fix.replacement);
    }
    text
}

#[test]
fn signs_that_touch_have_a_fix_each() {
    for (source, meant) in [
        ("define a = π²;", "define a = pi^2;"),
        ("define a = −π;", "define a = -pi;"),
        ("define a = 2√π;", "define a = 2sqrt pi;"),
        ("param r : [−π/2, π/2];", "param r : [-pi/2, pi/2];"),
        ("function f(x) = x²−1;", "function f(x) = x^2-1;"),
        ("function f(x) = x²÷2;", "function f(x) = x^2/2;"),
        (
            "curve c(t) = (t, t, t), −π≤t≤π;",
            "curve c(t) = (t, t, t), t : [-pi, pi];",
        ),
    ] {
        let text = with_all_fixes(source);
        assert_eq!(text, meant);
        assert_eq!(program_diagnostics(&text), [""; 0], "{text}");
    }
}

#[test]
fn bars_around_a_term_are_repaired_whatever_touches_them() {
    for (body, meant) in [
        ("|x|+|y|+|z|", "abs x+abs y+abs z"),
        ("|x|²+y", "(abs x)^2+y"),
        ("|x|^3+y", "(abs x)^3+y"),
        ("|x|−1", "abs x-1"),
        ("|x||y|z", "(abs x)(abs y)z"),
        ("|x - y|(z)", "(abs(x - y))(z)"),
    ] {
        let text = with_all_fixes(&format!("solid b(x, y, z) = {body};"));
        assert_eq!(text, format!("solid b(x, y, z) = {meant};"));
        assert_eq!(program_diagnostics(&text), [""; 0], "{text}");
    }
}

#[test]
fn a_sign_in_a_name_has_no_fix() {
    for source in [
        "define π = 3;",
        "define π² = 3;",
        "define a² = 3;",
        "function f(π) = 1;",
        "function f(x²) = 1;",
        "function f²(x) = 1;",
        "param τ : [0, 1];",
        "solid ×cube(x, y, z) = x;",
        "define my.name = 3;",
    ] {
        let found = parse(source).0.diagnostics;
        assert_eq!(found.len(), 1, "{source}: {found:?}");
        assert_eq!(found[0].fixes, [], "{source}");
    }
}

#[test]
fn a_set_with_a_wrong_sign_has_one_error() {
    for set in ["b - b \\ b", "b + b & b", "b + b | b"] {
        let source = format!("solid b(x, y, z) = x y z; solid c = {set};");
        let found = parse(&source).0.diagnostics;
        assert_eq!(found.len(), 1, "{set}: {found:?}");
        assert!(found[0].message.starts_with("expected `;`, found `"));
    }
}

#[test]
fn what_other_notations_mean_is_written_with_all_fixes() {
    for (source, meant) in [
        (
            "point p = (0, 0, 0), color : #f00;\ndefine a = 1;",
            "point p = (0, 0, 0), color : (1, 0, 0);\ndefine a = 1;",
        ),
        (
            "curve c(t) = (t, t, 0);\nt : [0, 2pi];",
            "curve c(t) = (t, t, 0),\nt : [0, 2pi];",
        ),
        (
            "surface s(u, v) = (u, v, 0), u : [0, 1]; v : [0, 1];",
            "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 1];",
        ),
        (
            "solid b = x^2 + y^2 + z^2 - 1;",
            "solid b(x, y, z) = x^2 + y^2 + z^2 - 1;",
        ),
        (
            "solid b(x, y, z) = x; solid c = b @ scale 1/2;",
            "solid b(x, y, z) = x; solid c = b @ scale (1/2);",
        ),
        (
            "solid b(x, y, z) = x; solid c = b @ rotate pi/2 (0, 0, 1);",
            "solid b(x, y, z) = x; solid c = b @ rotate (0, 0, pi/2);",
        ),
        ("function h(x) -> x^2;", "function h(x) = x^2;"),
        ("function h(x): x^2;", "function h(x)= x^2;"),
        ("function h x = x^2;", "function h(x) = x^2;"),
        ("function h(x) = 0,5x;", "function h(x) = 0.5x;"),
        ("light l @ (1, 2, 3);", "light l = @ (1, 2, 3);"),
        (
            "surface s(u, v) = (u, v, 0), u, v : [0, 1];",
            "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 1];",
        ),
        (
            "solid b(x, y, z) = x; solid c = b && b;",
            "solid b(x, y, z) = x; solid c = b & b;",
        ),
        (
            "curve c(t) = （t, t, t）， t : [0, 1]；",
            "curve c(t) = (t, t, t), t : [0, 1];",
        ),
        ("define a = math.pi;", "define a = pi;"),
        ("define a = 2 \\times 3;", "define a = 2 * 3;"),
        ("define a = \\left(1);", "define a = (1);"),
        ("define a = 2sin⁻¹1;", "define a = 2asin 1;"),
        (
            "define v = (1, 2); define w = v.v;",
            "define v = (1, 2); define w = v v;",
        ),
        (
            "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 1], image : earth.png;",
            "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 1], image : earth;",
        ),
    ] {
        let found = parse(source).0.diagnostics;
        assert_eq!(found.len(), 1, "{source}: {found:?}");
        let fix = &found[0].fixes[0];
        let place = fix.span.start as usize..fix.span.end as usize;
        let mut text = source.to_owned();
        text.replace_range(place, &fix.replacement);
        assert_eq!(text, meant);
        assert_eq!(program_diagnostics(&text), [""; 0], "{text}");
    }
}

/// The messages of a script that have a preferred fix or one for *Fix all*, with what it writes.
fn preferred(script: &str) -> Vec<String> {
    let document = syntax::crt::document::Document::new(script, &());
    let found = document.expect("a small text").diagnostics();
    assert!(!found.is_empty());
    let fixes = found.iter().flat_map(|found| &found.fixes);
    let preferred = fixes.filter(|fix| fix.preferred || fix.all);
    preferred.map(|fix| fix.title.clone()).collect()
}

#[test]
fn a_fix_of_a_script_that_repairs_nothing_is_not_preferred() {
    for (script, titles) in [
        (
            "Settings { title -> \"abc }\nScene { }",
            &["Insert `\"`"][..],
        ),
        (
            "Scene { Sphere ( center -> vec3(0,0,0) radius -> 1 ) }",
            &[],
        ),
        ("Scene { for (i = 0; i < 3; i = i + 1) }", &[]),
        ("Scene { a = 1; }", &["Remove `;`"]),
        ("Scene { s | s }", &[]),
    ] {
        assert_eq!(preferred(script), titles, "{script}");
    }
}
