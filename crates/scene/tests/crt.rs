//! CRT scripts: values, types, scopes, emission, limits, and the scenes that they leave.

use scene::crt::{Evaluated, ScriptRun, evaluate, run};
use scene::{ParamValues, Shape};
use std::sync::Arc;
use syntax::crt::document::Document;
use syntax::crt::tree::Script;

fn script(text: &str) -> Script {
    let document = Document::new(text, &()).expect("short");
    document.snapshot().script()
}

fn ran(text: &str) -> ScriptRun {
    run(&script(text), text)
}

fn codes(text: &str) -> Vec<&'static str> {
    let found = ran(text).diagnostics.into_iter();
    found.map(|diagnostic| diagnostic.code.0).collect()
}

fn value(text: &str, expression: &str) -> Result<Evaluated, Vec<&'static str>> {
    let expression = syntax::crt::parse_expression(expression).expect("an expression");
    let found = evaluate(&script(text), text, 0.0, &expression);
    found.map_err(|all| all.into_iter().map(|it| it.code.0).collect())
}

#[test]
fn operators_have_the_types_and_levels_of_the_page() {
    let rows = [
        ("1 + 2 * 3", "Integer", "7"),
        ("7 / 2", "Integer", "3"),
        ("-7 / 2", "Integer", "-3"),
        ("-7 % 3", "Integer", "-1"),
        ("7 / 2.0", "Float", "3.5"),
        ("2147483647 + 1", "Integer", "-2147483648"),
        ("\"a\" + 1.0", "String", "\"a1.0\""),
        ("1 + \"a\" + true", "String", "\"1atrue\""),
        ("\"ab\" * 3", "String", "\"ababab\""),
        ("vec3(1, 2, 3) * 2", "Vector", "vec3(2.0, 4.0, 6.0)"),
        (
            "-vec3(1, 2, 3) + vec3(1, 1, 1)",
            "Vector",
            "vec3(0.0, -1.0, -2.0)",
        ),
        ("rgb(1, 0.5, 0) / 2", "Color", "rgb(0.5, 0.25, 0.0)"),
        ("1 == 1.0", "Boolean", "true"),
        ("\"1\" == 1", "Boolean", "false"),
        ("[1, 2] == [1.0, 2]", "Boolean", "true"),
        ("1 < 2 && !(2 < 1) || false", "Boolean", "true"),
        ("true ? 1 : 2", "Integer", "1"),
        ("[1, [2, 3]][1][0]", "Integer", "2"),
        ("length([1, 2, 3]) + floor(2.5)", "Integer", "5"),
        ("length(vec3(3, 4, 0))", "Float", "5.0"),
        ("rand(0, 1)", "Float", "0.6599297847448217"),
        ("t", "Float", "0.0"),
    ];
    for (expression, kind, text) in rows {
        let found = value("", expression).expect(expression);
        assert_eq!((found.kind, &*found.text), (kind, text), "{expression}");
    }
    let faults = [
        ("1 / 0", "division-by-zero"),
        ("1 % 0", "division-by-zero"),
        ("1 + true", "type-mismatch"),
        ("1 ? 2 : 3", "type-mismatch"),
        ("[1][1]", "index-out-of-range"),
        ("[1][1.0]", "type-mismatch"),
        ("sin(1, 2)", "argument-count"),
        ("sin(true)", "type-mismatch"),
        ("nothing", "unknown-variable"),
        ("1(2)", "not-a-macro"),
        ("\"abc\" * 1000000", "too-large"),
    ];
    for (expression, code) in faults {
        assert_eq!(value("", expression), Err(vec![code]), "{expression}");
    }
}

#[test]
fn a_lone_name_is_pointed_to() {
    let text = "b = 1\na = b\nc = b + 0\nb = 5";
    assert_eq!(value(text, "a").expect("a").text, "5");
    assert_eq!(value(text, "c").expect("c").text, "1");
    assert_eq!(codes(text), ["points-later"]);
    assert_eq!(codes("a = 1\nb = a\na = b"), ["circular-variable"]);
    let both = value("a = b = 1", "a + b").expect("both");
    assert_eq!(both.text, "2");
}

#[test]
fn pointers_that_lead_nowhere_are_errors_where_they_stand() {
    let text = "ball = 1\ns = bal\nt2 = s\nx = t2 + 1";
    let found = ran(text).diagnostics;
    let [error] = &found[..] else {
        panic!("{found:?}");
    };
    assert_eq!(error.code.0, "unknown-variable");
    assert_eq!(error.span.text(text), "bal");
    assert_eq!(error.message, "no variable `bal` has been assigned");
    // A name that is assigned later is one that a pointer may have had in mind, wherever it points from.
    assert_eq!(codes("a = b\nb = 3"), ["points-later"]);
    let both = codes("c = 1\na = c\nd = c\nc = 2");
    assert_eq!(both, ["points-later", "points-later"]);
    let chain: String = (1..=2_000)
        .map(|k| format!("a{k} = a{}\n", k - 1))
        .collect();
    let long = codes(&format!("a0 = 1\n{chain}x = a2000 + 1"));
    assert_eq!(long, ["too-large"]);
}

#[test]
fn names_of_failed_statements_are_not_reported_again() {
    for text in [
        "a = 1 / 0\nb = a + 1",
        "if (true) { a = 1 / 0 }\nb = a + 1",
        "i = 0\nwhile (i < 3) { c = 1 / 0  a = 2  i = i + 1 }\nb = a + 1",
        "Scene { if (true) { a = 1 / 0 } a }",
        "q = [1, (a = 1 / 0)]\nb = a + q[0]",
    ] {
        assert_eq!(codes(text), ["division-by-zero"], "{text}");
    }
    // A value from before could lead to errors that the script does not have without this one.
    let old = "a = 0\nif (true) { b = [1, 2][5]  a = 1 }\nc = [1, 2][a - 1]\n";
    assert_eq!(codes(old), ["index-out-of-range"]);
    assert_eq!(value(old, "c"), Err(vec![]));
}

#[test]
fn an_open_range_is_told_without_its_end() {
    for (text, word) in [
        (
            "SpotLight { origin -> v pointing -> v color -> rgb(1, 1, 1) angle -> 0 }",
            "angle",
        ),
        ("Camera { position -> v pointing -> v fov -> 0 }", "fov"),
    ] {
        let found = ran(&format!("v = vec3(0, 0, 0)\na = {text}\n")).diagnostics;
        let messages: Vec<&str> = found.iter().map(|it| &*it.message).collect();
        assert_eq!(
            messages,
            [format!("`{word}` must be > 0 and ≤ 360, but this is 0")]
        );
    }
}

#[test]
fn macros_emit_in_scopes_of_their_own() {
    let text = "
s = Sphere { center -> vec3(0, 0, 0) radius -> 1 }
n = 3
m = Macro (k) {
    i = 0
    n = 100
    while (i < k) { s <translate vec3(2 * i, 0, 0)> i = i + 1 }
}
row = m(n)
Scene { m(2) row s s - Box { cornerA -> vec3(0, 0, 0) cornerB -> vec3(1, 1, 1) } }";
    let run = ran(text);
    assert_eq!(run.diagnostics, []);
    let names: Vec<&str> = run.scene.objects.iter().map(|it| &*it.name).collect();
    assert_eq!(names, ["7:21", "7:21", "row", "row", "row", "s", "10:20"]);
    assert_eq!(value(text, "n").expect("n").text, "3");
    let solid = run.scene.objects[6].shape.solid().expect("a solid");
    let leaves: Vec<&str> = solid.leaves.iter().map(|leaf| &*leaf.name).collect();
    assert_eq!(leaves, ["s", "Box 10:24"]);
}

#[test]
fn idle_statements_are_named() {
    let ball = "Sphere { center -> vec3(0, 0, 0) radius -> 1 }";
    assert_eq!(codes(ball), ["not-drawn"]);
    assert_eq!(codes("1 + 2"), ["no-effect"]);
    assert_eq!(codes("Scene { 1 }"), ["no-effect"]);
    assert_eq!(codes(&format!("Scene {{ {ball} }}")), [""; 0]);
    let bad = "Scene { Sphere { center -> 1 radius -> 0 } }";
    assert_eq!(codes(bad), ["type-mismatch", "out-of-range"]);
}

#[test]
fn limits_end_in_errors() {
    assert_eq!(codes("while (true) { }"), ["work-limit"]);
    // Each round copies the string: 10,000 rounds of one that is 256 × 200 bytes long are two millions.
    let copies = |rounds: u32| {
        codes(&format!(
            "r = \"a\" * 51200  k = 0  while (k < {rounds}) {{ s = r + \"b\"  k = k + 1 }}"
        ))
    };
    assert_eq!(copies(4_900), [] as [&str; 0]);
    assert_eq!(copies(10_000), ["work-limit"]);
    // An object costs as much as a round.
    let objects = |rounds: u32| {
        codes(&format!(
            "k = 0  while (k < {rounds}) {{ m = Material {{ diffuse -> 0.5 }}  k = k + 1 }}"
        ))
    };
    assert_eq!(objects(499_000), [] as [&str; 0]);
    assert_eq!(objects(501_000), ["work-limit"]);
    // Lists share their elements here: there are 2¹⁰⁰ ways to compare.
    let doubled = "l = [1]\ni = 0\nwhile (i < 100) { l = [l, l] i = i + 1 }\nx = l == l";
    assert_eq!(codes(doubled), ["work-limit"]);
    let compared = "s = \"a\" * 1000000\ni = 0\nwhile (true) { b = s == s  i = length(s) }";
    assert_eq!(codes(compared), ["work-limit"]);
    // What a round evaluates counts too.
    let wide = format!("i = 0\nwhile (true) {{ {} }}", "i = i + 1 ".repeat(100));
    assert_eq!(codes(&wide), ["work-limit"]);
    // So does each variable of a chain of pointers.
    let chain: String = (1..1000).map(|k| format!("a{k} = a{}\n", k - 1)).collect();
    let sums = "b = 0 ".to_owned() + &"b = a999 + a999 ".repeat(40);
    let chained = format!("a0 = 1\n{chain}i = 0\nwhile (i < 2000) {{ i = i + 1 {sums} }}");
    assert_eq!(codes(&chained), ["work-limit"]);
    assert_eq!(codes("m = Macro () { m() }\nm()"), ["call-depth"]);
    assert_eq!(
        codes("a = \"ab\"\nwhile (true) { a = a + a }"),
        ["too-large"]
    );
    assert_eq!(codes("a = []\nwhile (true) { a = [a] }"), ["too-large"]);
    let leaves = "s = Sphere { center -> vec3(0,0,0) radius -> 1 }\nwhile (true) { s = s + s }";
    assert_eq!(codes(leaves), ["too-many-leaves"]);
    // Deep sets are dropped without recursion.
    let deep = "s = Sphere { center -> vec3(0,0,0) radius -> 1 }\ne = s + s\ni = 0
while (i < 100000) { e = e + s i = i + 1 }\nScene { e }";
    assert_eq!(ran(deep).diagnostics, []);
}

#[test]
fn each_t_runs_the_script_anew() {
    let text = "s = Sphere { center -> vec3(0,0,0) radius -> 1 }
Scene { i = 0 while (i < t) { s <translate vec3(i, 2, 3)> i = i + 1 } }";
    let scene = Arc::new(ran(text).scene);
    assert_eq!(scene.objects.len(), 0);
    let mut params = ParamValues::initial(&scene);
    params.set(&scene, "t", &[4.0]).expect("in range");
    let later = scene.at(&params);
    assert_eq!(later.objects.len(), 4);
    assert_eq!(later.at(&ParamValues::initial(&scene)).objects.len(), 0);
    let solid = later.objects[1].shape.solid().expect("a solid");
    let map = solid.leaves[0].map.0;
    let at = map.map(|row| later.graph.value(row[3]).expect("a number"));
    assert_eq!(at, [1.0, 3.0, 2.0], "y and z have changed places");
}

#[test]
fn settings_are_those_of_the_picture() {
    let text = "Settings { gamma -> 2.2 supersampling -> 2 dofsamples -> 4 recursiondepth -> 5
lights -> [PointLight { origin -> vec3(1,2,3) color -> rgb(1,1,1) falloff -> 9 }] }\nScene { }";
    let run = ran(text);
    assert_eq!(run.diagnostics, []);
    let picture = run.scene.picture.expect("a picture");
    assert_eq!((picture.gamma, picture.bounces), (2.2, 5));
    assert_eq!((picture.supersampling, picture.lens_samples), (2, 4));
    let kinds: Vec<&str> = run.scene.stage.iter().map(|it| it.shape.kind()).collect();
    assert_eq!(kinds, ["light", "camera", "background"]);
    let Shape::Light(light) = run.scene.stage[0].shape else {
        panic!("a light");
    };
    let place = light.position.expect("a place");
    assert_eq!(
        place.map(|k| run.scene.graph.value(k)),
        [1.0, 3.0, 2.0].map(Some)
    );
}

#[test]
fn the_errors_of_a_run_belong_to_its_scene_and_name_t() {
    let text =
        "a = [1, 2]\nx = a[floor(t)]\nScene { Sphere { center -> vec3(0, 0, 3) radius -> x } }";
    let scene = Arc::new(ran(text).scene);
    assert_eq!(scene.check_run(), Ok(()));
    let mut params = ParamValues::initial(&scene);
    params.set(&scene, "t", &[3.0]).expect("in range");
    let error = scene.at(&params).check_run().expect_err("no element 3");
    let message = "there is no element 3: the last one is 1 (at t = 3)";
    assert_eq!((error.0.len(), error.to_string()), (1, message.to_owned()));
    // At t = 0 an error is an error of that run only.
    let text = "x = nothing + 1\nScene { Sphere { center -> vec3(0, 0, 3) radius -> t } }";
    let run = ran(text);
    let messages: Vec<&str> = run.diagnostics.iter().map(|it| &*it.message).collect();
    assert_eq!(
        messages,
        [
            "no variable `nothing` has been assigned",
            "`radius` must be > 0, but this is 0 (at t = 0)"
        ]
    );
}

#[test]
fn a_pointer_to_a_name_that_is_never_assigned_is_a_warning() {
    let found = |text| -> Vec<String> {
        let found = ran(text).diagnostics.into_iter();
        found
            .map(|it| format!("{:?} {} {}", it.severity, it.span.text(text), it.message))
            .collect()
    };
    let text = "grin = 1 x = sen y = x z = grin
m = Macro () { colour = gren later = (grin) }
Scene { m() m() }";
    assert_eq!(
        found(text),
        [
            "Warning sen no variable `sen` has been assigned",
            "Warning gren no variable `gren` has been assigned",
        ]
    );
    // A use of it is an error, and a name that is assigned later none.
    assert_eq!(
        found("a = b c = a + 1 d = e e = 2"),
        [
            "Error b no variable `b` has been assigned",
            "Hint d = e this points to `e`, which is assigned later: it then has that value",
        ]
    );
    // A name whose assignment had an error has been reported.
    assert_eq!(found("a = 1 / 0 b = a").len(), 1);
}

#[test]
fn a_string_is_shown_as_a_literal_of_a_script() {
    for literal in [
        r#""e\u0301 \ud83d\udc68\u200d\ud83d\udc69""#,
        r#""\"\\ \n\r\t\u0001""#,
    ] {
        let shown = value("", literal).expect("a string").text;
        assert_eq!(value("", &shown).expect(&shown).text, shown);
        let is_plain = |c: char| !c.is_control();
        assert!(shown.chars().all(is_plain), "{shown:?}");
    }
    let shown = value("", r#""e\u0301\u0001""#).expect("a string").text;
    assert_eq!(shown, "\"e\u{301}\\u0001\"");
}
