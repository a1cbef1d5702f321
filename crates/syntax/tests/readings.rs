//! How expressions are read, as golden strings of their steps in postfix order.

#[path = "support/recorder.rs"]
mod support;

use support::{parse, postfix, program_diagnostics, read};

const PRELUDE: &str =
    "define a = 1; define b = 1; define c = 1; define x = 1; define y = 1; define v = 1;
    define t = 1; define A = (1,2,3); param U : [0,1]; param V : [0,1];
    function f(u, v2) = (u, v2, 0); function N(w) = w/sqrt*w; function g(q) = q;
    curve C(s) = (s,0,0), s : [0,1];";

#[test]
fn the_readings_that_must_hold() {
    for (text, expected) in [
        ("1/2x", "1 2 / x ·"),
        ("2x/3", "2 x 3 / ·"),
        ("a b*c", "a b c * ·"),
        ("-x^2", "x 2 ^ u-"),
        ("a^b^c", "a b c ^ ^"),
        ("x^2y", "x 2 ^ y ·"),
        ("sin -x^2", "sin x 2 ^ u- @"),
        ("sin(x)^y", "sin x () y ^ @"),
        ("sin x y", "sin x @ y ·"),
        ("sin 2x", "sin 2 @ x ·"),
        ("N(A)_1", "N A () _1 @"),
        ("(N(A))_1", "N A () @ () _1"),
        ("x/sqrt*x", "x sqrt x u* @ /"),
        ("Nf_u(U,V)", "N f ∂0 U V (2) @ @"),
        ("sin^2 x", "sin 2 f^ x @"),
    ] {
        assert_eq!(read(PRELUDE, text), expected, "{text}");
    }
}

#[test]
fn operators_bind_as_the_grammar_says() {
    for (text, expected) in [
        ("1-2-3", "1 2 - 3 -"),
        ("1+2*3", "1 2 3 * +"),
        ("1*2/3*4", "1 2 * 3 / 4 *"),
        ("a b c", "a b · c ·"),
        ("a -b", "a b -"),
        ("a*-b", "a b u- *"),
        ("a**b", "a b u* *"),
        ("a//b", "a b u/ /"),
        ("-+*/a", "a u/ u* u+ u-"),
        ("/2", "2 u/"),
        ("/2x", "2 u/ x ·"),
        ("2^-x", "2 x u- ^"),
        ("2^-x^y", "2 x y ^ u- ^"),
        ("2^sin x y", "2 sin x @ ^ y ·"),
        ("sin cos x^2", "sin cos x 2 ^ @ @"),
        ("sin^2^3 x", "sin 2 3 ^ f^ x @"),
        ("sin^-x y", "sin x u- f^ y @"),
        ("sin^cos x y", "sin cos x @ f^ y @"),
        ("sin*x", "sin x u* @"),
        ("sin x/2", "sin x @ 2 /"),
        ("a sin x b", "a sin x @ · b ·"),
        ("a/b c/x", "a b / c x / ·"),
        ("a*b c*x", "a b * c x * ·"),
        ("(1,2,3)_2", "1 2 3 (3) _2"),
        ("(1,2,3)_2x", "1 2 3 (3) _2 x ·"),
        ("A_1_2^2", "A _1 _2 2 ^"),
        ("A_01", "A _1"),
        ("[a,{b}]", "a b () (2)"),
        ("((a))", "a () ()"),
        ("f_u_v2(1,2)", "f ∂0 ∂1 1 2 (2) @"),
        ("f_v2U", "f ∂1 U @"),
        ("g''x", "g ′ ′ x @"),
        ("g'_q' x", "g ′ ∂0 ′ x @"),
        ("C'^2 x", "C ′ 2 f^ x @"),
        ("sin'x", "sin ′ x @"),
        ("-1", "1 u-"),
        ("1..2", "1 0.2 ·"),
    ] {
        assert_eq!(read(PRELUDE, text), expected, "{text}");
    }
}

#[test]
fn words_are_split_by_the_longest_defined_prefix() {
    for (text, expected) in [
        ("piv", "pi v ·"),
        ("cost", "cos t @"),
        ("sinhx", "sinh x @"),
        ("asinx", "asin x @"),
        ("sin2x", "sin 2 @ x ·"),
        ("2pie", "2 pi · e ·"),
        ("2e", "2 e ·"),
        ("2e-x", "2 e · x -"),
        ("2exp x", "2 exp x @ ·"),
        ("3e-4", "0.0003"),
        ("2e3x", "2000 x ·"),
        ("aab", "a a · b ·"),
        ("expx", "exp x @"),
        ("ex", "e x ·"),
    ] {
        assert_eq!(read(PRELUDE, text), expected, "{text}");
    }
    let circle = "param o : [0, 1]; curve c(t) = (cost, sint, 0), t : [0, 2pi]; define k2 = o;";
    assert_eq!(read(circle, "ck2"), "c k2 @");
    assert_eq!(read(circle, "c'k2"), "c ′ k2 @");
}

#[test]
fn a_name_is_known_from_its_declaration_on_and_not_before() {
    let source = "define x = 1; define p = sinx; define sinx = 2; define q = sinx;";
    let (recorder, parsed) = parse(source);
    let steps = |k: usize| postfix(&recorder.declared[k].steps, &parsed, &[]);
    assert_eq!(steps(1), "sin x @");
    assert_eq!(steps(3), "sinx");
}

#[test]
fn parameters_are_variables_in_their_own_body_alone() {
    let source =
        "function f(u, uv) = u uv uvu; function g(w) = w; curve c(u) = (u, 0, 0), u : [0, 1];";
    let (recorder, parsed) = parse(source);
    assert!(
        recorder.diagnostics.is_empty(),
        "{:?}",
        program_diagnostics(source)
    );
    let declared = &recorder.declared[0];
    let steps = postfix(&declared.steps, &parsed, &declared.parameters);
    assert_eq!(steps, "u uv · uv · u ·");
    assert_eq!(
        program_diagnostics("function f(u) = u; define a = u;").len(),
        1
    );
}

#[test]
fn declaring_words_are_whole_words_only() {
    let source = "define points = 1; define pointsx = 2; define a = points pi 2points;";
    assert_eq!(program_diagnostics(source), Vec::<String>::new());
    let (recorder, parsed) = parse(source);
    let steps = postfix(&recorder.declared[2].steps, &parsed, &[]);
    assert_eq!(steps, "points pi · 2 · points ·");
}

#[test]
fn intervals_come_with_their_tags_and_kinds() {
    let source = "surface s(u,v) = (u,v,0), v : [0,1,5], u : [-1,2pi]; grid k : [0,1,3],[0,2,4];";
    let (recorder, _) = parse(source);
    let show = |k: usize| {
        let intervals = &recorder.declared[k].intervals;
        let text: Vec<String> = intervals
            .iter()
            .map(|i| {
                let tag = i.tag.map(|(tag, span)| (tag, span.text(source)));
                format!("{:?} {} {tag:?}", i.kind, i.span.text(source))
            })
            .collect();
        text.join("; ")
    };
    assert_eq!(
        show(0),
        "Grid [0,1,5] Some((Some(1), \"v\")); Range [-1,2pi] Some((Some(0), \"u\"))"
    );
    assert_eq!(show(1), "Grid [0,1,3] None; Grid [0,2,4] None");
}

#[test]
fn a_step_covers_its_operator_and_its_operands() {
    let source = "define a = 1 + sin (2, 3)_1 4;";
    let (recorder, _) = parse(source);
    let texts: Vec<&str> = recorder.declared[0]
        .steps
        .iter()
        .map(|(_, s)| s.text(source))
        .collect();
    let expected = [
        "1",
        "sin",
        "2",
        "3",
        "(2, 3)",
        "(2, 3)_1",
        "sin (2, 3)_1",
        "4",
        "sin (2, 3)_1 4",
        "1 + sin (2, 3)_1 4",
    ];
    assert_eq!(texts, expected);
    assert_eq!(recorder.declared[0].span.text(source), source);
}

#[test]
fn symbols_count_up_from_the_builtins() {
    let (recorder, parsed) =
        parse("define a = 1; function f(u,v) = u; define sin = 2; point p = (1,2,3);");
    let names: Vec<&str> = parsed
        .symbols
        .iter()
        .skip(16)
        .map(|(_, s)| &*s.name)
        .collect();
    assert_eq!(names, ["a", "f", "p"]);
    let ids: Vec<Option<u32>> = recorder
        .declared
        .iter()
        .map(|d| d.symbol.map(|s| s.0))
        .collect();
    assert_eq!(ids, [Some(16), Some(17), None, Some(18)]);
    assert_eq!(parsed.trie.get("sin").map(|id| id.0), Some(2));
}

#[test]
fn the_programs_of_the_thesis_are_read_without_a_finding() {
    let circle = "#circle and tangents
        param r : [/2, 1]; param o : [0, 2pi];
        curve c(t) = r(cost, sint, 0), t : [0, 2pi];
        grid k : [0, 2pi, 8];
        define k2 = k + o; point p = ck2; vector v = c'k2 @ p;";
    let sphere = "function f(u,v) = (sin(piv)cos(2piu), sin(piv)sin(2piu), cos(piv));
        param U : [0, 1]; param V : [0, 1]; point p = f(U,V);
        curve cu(t) = f(t, V), t : [0, 1]; curve cv(t) = f(U, t), t : [0, 1];
        function N(x) = x/sqrt*x;
        vector vu = Nf_u(U,V) @ p; vector vv = Nf_v(U,V) @ p;
        surface s(u,v) = f(u,v)*0.99, u : [0, 1], v : [0, 1];";
    for source in [circle, sphere, "", "# only a comment", " \n\t\r\n"] {
        assert_eq!(program_diagnostics(source), Vec::<String>::new());
    }
}
