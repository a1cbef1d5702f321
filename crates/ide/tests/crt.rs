//! The features of an editor on CRT scripts.

use std::sync::Arc;

use ide::crt::Crt;
use ide::edit::apply;
use ide::rename::RenameError;
use ide::{Analysis, Language};
use syntax::span::Span;

const SCRIPT: &str = "\
sphere1 = Sphere { center -> vec3(0, 0.5, 0)  radius -> 0.5 material -> Material { color -> rgb(1, 0.5, 0) } }
n = 18
max = (3 * n) / 4 + 5
myMacro = Macro (arg1) {
    i = 0
    while (i < max) {
        sphere1 <translate vec3(i*1.0, 0.0, -arg1)>
        i = i + 1        -- the next one
    }
}
Scene { myMacro(1) }
";

fn read(text: &str) -> Arc<dyn Analysis> {
    Crt.read(text)
}

fn at(text: &str, word: &str) -> u32 {
    text.find(word).expect("the word") as u32
}

#[test]
fn a_sound_script_has_no_diagnostics_and_an_outline() {
    let analysis = read(SCRIPT);
    assert_eq!(
        analysis.diagnostics().len(),
        0,
        "{:?}",
        analysis.diagnostics()
    );
    let outline = analysis.outline();
    let names: Vec<_> = outline
        .iter()
        .map(|it| format!("{} {}{}", it.keyword, it.name, it.detail))
        .collect();
    assert_eq!(
        names,
        ["Sphere sphere1", "Macro myMacro(arg1)", "Scene Scene"]
    );
    assert_eq!(analysis.folds().len(), 2);
}

#[test]
fn variables_are_renamed_in_their_scope() {
    let text =
        "i = 1\nm = Macro (a) {\n    i = 0\n    i = i + a\n    i\n}\nk = Macro (i) { i }\ni\n";
    let analysis = read(text);
    let edits = analysis.rename(0, "count").expect("a new name");
    let expected = "count = 1\nm = Macro (a) {\n    i = 0\n    i = i + a\n    i\n}\nk = Macro (i) { i }\ncount\n";
    assert_eq!(apply(text, &edits), expected);
    let inner = at(text, "i = 0");
    assert_eq!(analysis.occurrences(inner).len(), 4);
    // What may see either variable makes them one.
    let text = "i = 1\nm = Macro () { i = i + 1 }\n";
    assert_eq!(read(text).occurrences(0).len(), 3);
    // What a run may pass by does not hide the outer one.
    for body in ["if (c) { x = 1 }", "while (c) { x = 1 }", "c ? x = 1 : 2"] {
        let text = format!("x = 5\nm = Macro (c) {{\n    {body}\n    x\n}}\n");
        assert_eq!(read(&text).occurrences(0).len(), 3, "{text}");
    }
    let analysis = read(SCRIPT);
    let taken = analysis.rename(at(SCRIPT, "n = 18"), "max");
    assert!(matches!(
        taken,
        Err(RenameError::Taken { line: Some(3), .. })
    ));
    let keyword = analysis.rename(at(SCRIPT, "n = 18"), "while");
    assert!(matches!(keyword, Err(RenameError::Keyword(_))));
    assert_eq!(
        analysis.definition(at(SCRIPT, "max) {")),
        Some((
            Span::new(at(SCRIPT, "max) {"), at(SCRIPT, "max) {") + 3),
            Span::new(at(SCRIPT, "max ="), at(SCRIPT, "max =") + 3),
        ))
    );
}

#[test]
fn words_are_described() {
    let hover = |word: &str| {
        let (_, description) = read(SCRIPT).hover(at(SCRIPT, word)).expect("a description");
        description.plain()
    };
    assert!(hover("Sphere").contains("A ball"));
    assert!(hover("radius").contains("radius -> Float") && hover("radius").contains("Required"));
    assert!(hover("vec3").contains("vec3(x, y, z)"));
    assert!(hover("max").contains("max = (3 * n) / 4 + 5"));
    assert!(hover("myMacro").contains("A macro"));
    assert!(hover("while").contains("Repeats"));
}

#[test]
fn the_default_of_an_attribute_is_code_or_a_phrase() {
    for (text, word, default) in [
        ("Settings { lights -> [] }", "lights", "`[]`"),
        (
            "Settings { background -> Background {} }",
            "background",
            "white",
        ),
        (
            "m = Material { diffuse -> 1 }",
            "diffuse",
            "`1 - reflectivity - transparency`",
        ),
        (
            "s = Sphere { material -> Material {} }",
            "material",
            "`Material {}`",
        ),
        (
            "m = Material { color -> rgb(1, 0, 0) }",
            "color",
            "`rgb(0.5, 0.5, 0.5)`",
        ),
    ] {
        let (_, description) = read(text).hover(at(text, word)).expect("a description");
        let wanted = format!("Default: {default}.");
        assert!(description.markdown().contains(&wanted), "{text}");
    }
}

#[test]
fn attributes_objects_and_variables_are_completed() {
    let labels = |text: &str| -> Vec<String> {
        let list = read(text).completions(text.len() as u32, false).list;
        list.into_iter().map(|it| it.label).collect()
    };
    let attributes = labels("a = Torus { radius -> 1 ");
    assert_eq!(attributes, ["center", "tube", "normal", "material"]);
    // What is stated behind the place is not offered either.
    let text =
        "a = Torus { \n radius -> 1 material -> Material { color -> 2 } } b = Torus { tube -> 1 }";
    let list = read(text).completions(12, false).list;
    let names: Vec<&str> = list.iter().map(|it| &*it.label).collect();
    assert_eq!(names, ["center", "tube", "normal"]);
    assert_eq!(labels("a = Camera { projection -> ")[1], "\"spherical\"");
    let values = labels("ball = 3\na = Torus { radius -> b");
    assert!(values.contains(&"ball".to_owned()) && values.contains(&"Sphere".to_owned()));
    assert!(labels("").contains(&"Scene".to_owned()));
    assert!(!labels("Scene { ").contains(&"Settings".to_owned()));
    assert_eq!(labels("-- a"), [] as [String; 0]);
}

#[test]
fn a_colour_is_picked() {
    let analysis = read(SCRIPT);
    let colours = analysis.colours();
    assert_eq!(colours.len(), 1);
    assert_eq!(
        analysis.text().slice(colours[0].span).as_deref(),
        Some("rgb(1, 0.5, 0)")
    );
    assert_eq!(
        analysis.colour_texts(colours[0].span, [0.25, 1.0, 0.0]),
        ["rgb(0.25, 1, 0)"]
    );
}

#[test]
fn the_layout_has_one_attribute_a_line_and_is_stable() {
    let text = "a=Sphere{center->vec3( 0,1 ,-2 ) radius->- -1}  -- c\nb = 1 c = 2\n\n\n\nScene{\na<scale 2,rotate v>\n  +b\nif(c==2){a}\nelse {b [0](1)}\n}";
    let expected = "\
a = Sphere {
    center -> vec3(0, 1, -2)
    radius -> - -1
}  -- c
b = 1 c = 2

Scene {
    a <scale 2, rotate v>
        + b
    if (c == 2) { a }
    else { b[0](1) }
}
";
    let once = apply(text, &read(text).format(None));
    assert_eq!(once, expected);
    assert_eq!(apply(&once, &read(&once).format(None)), once);
    let faulty = "a = Sphere { radius -> }";
    assert_eq!(read(faulty).format(None), []);
}

#[test]
fn a_certificate_is_left_alone() {
    let analysis = read("-----BEGIN CERTIFICATE-----\nMIIB==\n");
    assert_eq!(analysis.diagnostics().len(), 0);
    assert_eq!(analysis.semantic_tokens(Span::new(0, 20)), []);
    assert_eq!(analysis.format(None), []);
}

/// The plain text of the description of a word.
fn hover(text: &str, word: &str) -> String {
    let found = read(text).hover(at(text, word));
    found.expect("a description").1.plain()
}

#[test]
fn a_variable_has_the_value_that_the_run_leaves_it() {
    let text = "\
i = 0
total = \"\"
while (i < 18) {
    total = total + i % 10
    i = i + 1
}
v = vec3(1, 2.5, i)
w = v
list = [1, \"a\", rgb(1, 0, 0)]
bad = 1 / 0
never = 1
if (false) { unseen = 2 }
later = never
Scene { }
";
    let i = hover(text, "i = 0");
    assert!(i.contains("assigned in 2 places, first in line 1"), "{i}");
    assert!(
        i.contains("Last value: 18, an Integer, from i = i + 1 in line 5; assigned 19 times"),
        "{i}"
    );
    let total = hover(text, "total = total");
    assert!(
        total.contains("\"012345678901234567\", a String"),
        "{total}"
    );
    // A use is described as its variable.
    assert_eq!(hover(text, "i)\n"), i);
    assert!(hover(text, "v = vec3").contains("Value: vec3(1.0, 2.5, 18.0), a Vector."));
    assert!(hover(text, "w = v").contains("Value: vec3(1.0, 2.5, 18.0), a Vector."));
    assert!(hover(text, "list").contains("Value: [1, \"a\", rgb(1.0, 0.0, 0.0)], a List."));
    assert!(hover(text, "bad").contains("No value: the run ends in an error there."));
    let dangling = hover("x = (sen)\nScene { }", "x");
    assert!(dangling.contains("No value: sen has none."), "{dangling}");
    assert!(hover(text, "unseen").contains("The run does not reach this."));
    // A script that cannot be read is not run.
    let faulty = hover("a = 1\nb = )\n", "a = 1");
    assert!(!faulty.contains("alue:"), "{faulty}");
    assert!(hover("b = t", "t").contains("The frame"));
    let long = hover("a = \"x\" * 9000 Scene { }", "a = ");
    assert!(long.contains("xxx…") && long.len() < 500, "{long}");
}

#[test]
fn the_variables_of_a_macro_have_the_values_of_its_last_call() {
    let text = "\
s = Sphere { center -> vec3(0, 0, 0) radius -> 1 }
m = Macro (size, place) {
    twice = size * 2
    alias = place
    s <scale twice, translate alias>
}
Scene { m(1, vec3(0, 0, 0)) m(4, vec3(1, 0, 0)) }
";
    assert!(hover(text, "size,").contains("Last value: 4, an Integer, in the last of 2 calls."));
    assert!(hover(text, "twice = ").contains("Last value: 8, an Integer"));
    assert!(hover(text, "alias = ").contains("Last value: vec3(1.0, 0.0, 0.0), a Vector"));
}

#[test]
fn an_entity_is_described_by_its_box() {
    let text = "\
ball = Sphere { center -> vec3(1, 2, 3) radius -> 2 }
box = Box { cornerA -> vec3(1, -1, 0) cornerB -> vec3(-1, 1, 4) }
cut = ball - box
both = ball + box
common = ball ^ box
none = ball ^ (box <translate vec3(9, 0, 0)>)
turned = box <rotate vec3(0, 0, 45)>
wall = Plane { normal -> vec3(0, 1, 0) position -> vec3(0, -1, 0) }
tower = Cylinder { base -> vec3(0, 0, 0) top -> vec3(0, 3, 0) radius -> 2 }
spire = Cone { base -> vec3(0, 0, 0) apex -> vec3(5, 0, 0) radius -> 1 }
ring = Torus { center -> vec3(0, 0, 0) radius -> 2 tube -> 0.5 }
left = ball - box ^ box
Scene { }
";
    let has = |word: &str, expected: &str| {
        let text = hover(text, word);
        assert!(text.contains(expected), "{text}");
    };
    has(
        "ball = ",
        "a Sphere; in the box x from -1 to 3, y from 0 to 4, z from 1 to 5",
    );
    has(
        "box = ",
        "a Box; in the box x from -1 to 1, y from -1 to 1, z from 0 to 4",
    );
    has(
        "cut = ",
        "a difference of 2 leaves; in the box x from -1 to 3",
    );
    has(
        "both = ",
        "a union of 2 leaves; in the box x from -1 to 3, y from -1 to 4, z from 0 to 5",
    );
    has(
        "common = ",
        "an intersection of 2 leaves; in the box x from -1 to 1, y from 0 to 1, z from 1 to 4",
    );
    has("none = ", "which is empty");
    has(
        "turned = ",
        "x from -1.41421 to 1.41421, y from -1.41421 to 1.41421, z from 0 to 4",
    );
    has("wall = ", "x without bounds, y to -1, z without bounds");
    has("tower = ", "x from -2 to 2, y from 0 to 3, z from -2 to 2");
    has("spire = ", "x from 0 to 5, y from -1 to 1, z from -1 to 1");
    has(
        "ring = ",
        "x from -2.5 to 2.5, y from -0.5 to 0.5, z from -2.5 to 2.5",
    );
    // Sums and intersections go from left to right.
    has("left = ", "an intersection of 3 leaves");
}

#[test]
fn arguments_are_written_beside_their_names() {
    let text = "m = Macro (size, place) { }\na = m(vec3(1, 2";
    let signature = |offset: usize| read(text).signature(offset as u32);
    let inner = signature(text.len()).expect("a function");
    assert_eq!((&*inner.label, inner.active), ("vec3(x, y, z)", 1));
    assert_eq!(inner.what, "builtin function");
    let (start, end) = inner.parameters[1];
    assert_eq!(&inner.label[start as usize..end as usize], "y");
    let outer = signature(text.find("vec3").expect("there")).expect("a macro");
    assert_eq!((&*outer.label, outer.active), ("m(size, place)", 0));
    assert_eq!(outer.what, "macro");
    assert_eq!(signature(5), None);
    let inside = "a = rand(1, Material { ";
    assert_eq!(read(inside).signature(inside.len() as u32), None);
    let commented = "a = rand(1, -- b";
    assert_eq!(read(commented).signature(commented.len() as u32), None);
    let modified = "m = Macro (p, q, r) { }\nm(b <scale 2, translate vec3(0, 0, 0)>, ";
    for (text, active) in [
        (format!("{modified})"), 1),
        (modified.replace(">, ", ", "), 0),
    ] {
        let found = read(&text).signature(modified.len() as u32 - 1);
        assert_eq!(found.map(|it| it.active), Some(active), "{text}");
    }
    let list = "a = rgb(1, [2, ";
    let found = read(list).signature(list.len() as u32).expect("a function");
    assert_eq!((&*found.label, found.active), ("rgb(red, green, blue)", 1));
}

#[test]
fn images_are_links() {
    let text = "a = Background { image -> \"/sky/noon.png\" }\nb = Background { image -> \"../x.png\" }\nc = \"y.png\"\n";
    let links = read(text).links();
    assert_eq!(links.len(), 1);
    assert_eq!(links[0].path, "sky/noon.png");
    let span = links[0].span;
    assert_eq!(
        &text[span.start as usize..span.end as usize],
        "/sky/noon.png"
    );
}

#[test]
fn reading_is_at_hand_before_the_run_and_an_edit_gives_the_run_up() {
    let text = "i = 0\nwhile (i < 900000) { i = i + 1 }\n1\nScene { }\n";
    let mut program = Crt.open(text).expect("small");
    let diagnostics = program
        .diagnostics_of_reading()
        .expect("a run may find more");
    assert_eq!(diagnostics.len(), 0);
    let old = program.snapshot();
    program
        .edit(Span::new(0, 0), "j = )\n")
        .expect("in the text");
    // The run of the old version has been given up before it began: nothing of it is known.
    assert_eq!(old.diagnostics().len(), 0);
    // A script that cannot be read is not run: all is known at once.
    assert!(program.diagnostics_of_reading().is_none());
    assert_eq!(program.diagnostics().len(), 1);
    program.edit(Span::new(0, 6), "").expect("in the text");
    assert!(program.diagnostics_of_reading().is_some());
    assert_eq!(program.diagnostics()[0].code.0, "no-effect");
    assert!(program.diagnostics_of_reading().is_none());
}

#[test]
fn errors_that_leave_the_tree_whole_do_not_hide_those_of_the_run() {
    let text = "s = Sphere { center -> vec3(0,0,0) radius -> 0 }
t2 = Sphere { radius -> 1 }
u = Sphere { center -> 1 radius -> 1 }
x = 1/0
w = t2
Scene { s w }
";
    let program = Crt.open(text).expect("small");
    let diagnostics = program.diagnostics();
    let codes: Vec<&str> = diagnostics.iter().map(|it| it.code.0).collect();
    assert_eq!(
        codes,
        [
            "out-of-range",
            "missing-attribute",
            "type-mismatch",
            "division-by-zero"
        ]
    );
    assert!(program.scene().scene.is_none());
}

#[test]
fn modifiers_are_completed_and_attributes_with_a_value_alone() {
    let completed = |text: &str| {
        let at = text.find('|').expect("a mark");
        let text = text.replace('|', "");
        read(&text).completions(at as u32, true).list
    };
    for text in [
        "Scene { s <t| vec3(1,0,0)> }",
        "Scene { s <|> }",
        "Scene { s <scale 2, r| vec3(1,0,0)> }",
    ] {
        let labels: Vec<String> = completed(text).into_iter().map(|it| it.label).collect();
        assert_eq!(labels, ["scale", "translate", "rotate"], "{text}");
    }
    // Behind a comparison there is a value, behind modifiers an attribute.
    let names =
        |text: &str| -> Vec<String> { completed(text).into_iter().map(|it| it.label).collect() };
    let center = "center".to_owned();
    assert!(!names("a = Sphere { radius -> 2 > |").contains(&center));
    assert!(names("a = Sphere { material -> m <scale 2> | }").contains(&center));
    // Words that would be an error.
    for (text, word, is_offered) in [
        ("|", "else", false),
        ("a = 2\nel|", "else", false),
        ("while (a) { b = 1 } |", "else", false),
        ("if (a) { b = 1 } |", "else", true),
        ("if (a) { b = 1 } else { b = 2 } |", "else", false),
        (
            "if (a) { b = 1 } else if (f(b)) { b = 2 } el|",
            "else",
            true,
        ),
        ("|", "Settings", true),
        ("Settings|", "Settings", true),
        ("Settings { }\nS|", "Settings", false),
        ("S|\nScene { }", "Scene", false),
    ] {
        assert_eq!(names(text).contains(&word.to_owned()), is_offered, "{text}");
    }
    // An editor that closes quotes leaves the cursor between them.
    for text in [
        "Camera { projection -> \"|\" }",
        "Camera { projection -> \"sph|\" }",
    ] {
        let list = completed(text);
        let labels: Vec<&str> = list.iter().map(|it| &*it.label).collect();
        assert!(labels.contains(&"spherical"), "{labels:?}");
        assert_eq!(list[0].insert, list[0].label);
    }
    assert_eq!(completed("a = \"|\"").len(), 0);
    // A parameter hides the variable of its name.
    let list = completed("x = 1\nm = Macro (x) { y = x| }");
    assert_eq!(list.iter().filter(|it| it.label == "x").count(), 1);
    let list = completed("Sphere { center -> vec3(0,0,0) rad| -> 1 }");
    let radius = list.iter().find(|it| it.label == "radius");
    let radius = radius.expect("the attribute");
    assert_eq!((radius.insert.as_str(), radius.snippet), ("radius", false));
    for (text, label) in [
        ("a = ve|(1, 2, 3)", "vec3"),
        ("Scene { Sph| { radius -> 1 } }", "Sphere"),
    ] {
        let list = completed(text);
        let found = list.iter().find(|it| it.label == label).expect("the word");
        assert_eq!((found.insert.as_str(), found.snippet), (label, false));
    }
}

#[test]
fn the_layout_keeps_line_ends_and_lines_that_are_warned_about() {
    let text = "a = 1\r\nb = 2\r\n";
    assert_eq!(read(text).format(None), []);
    let spheres = "s = Sphere { center -> vec3(0, 0, 0) }\nb = s\n";
    let text = format!("{spheres}Scene {{\n    s\n    - b\n}}\n");
    let laid_out = apply(&text, &read(&text).format(None));
    assert!(
        laid_out.ends_with("Scene {\n    s\n    - b\n}\n"),
        "{laid_out}"
    );
    assert_eq!(read(&laid_out).format(None), []);
}

#[test]
fn the_lines_of_a_range_have_the_layout_of_the_whole_text() {
    let text = "Scene {\r\nx=1 \r\n\r\n\r\n y=2\r\n}\r\n";
    let analysis = read(text);
    let formatted = |from: &str, to: &str| {
        let end = at(text, to) + to.len() as u32;
        apply(text, &analysis.format(Some(Span::new(at(text, from), end))))
    };
    let first = "Scene {\r\n    x = 1 \r\n\r\n\r\n y=2\r\n}\r\n";
    assert_eq!(formatted("x=1", "=1"), first);
    assert_eq!(formatted("=1", "1"), first);
    // Blank lines above the selected ones stay.
    let second = "Scene {\r\nx=1 \r\n\r\n\r\n    y = 2\r\n}\r\n";
    assert_eq!(formatted("y=2", "=2"), second);
    assert_eq!(formatted(" y=2", "=2"), second);
    let whole = apply(text, &analysis.format(None));
    assert_eq!(formatted("Scene", "}\r\n"), whole);
    // An object whose first line moves moves with its attributes.
    let text = "Scene {\n Sphere {\n  center -> vec3(0, 0, 0)\n  radius -> 1\n }\n}\n";
    let range = Span::new(at(text, " Sphere"), at(text, " }\n}") + 2);
    let whole = apply(text, &read(text).format(None));
    assert_eq!(apply(text, &read(text).format(Some(range))), whole);
}

#[test]
fn the_frame_is_completed_and_modifiers_before_their_bracket_is_closed() {
    let labels = |text: &str| -> Vec<String> {
        let offset = at(text, "|");
        let found = read(&text.replace('|', "")).completions(offset, false);
        found.list.into_iter().map(|it| it.label).collect()
    };
    let has = |text: &str, word: &str| labels(text).iter().any(|it| it == word);
    assert!(has("x = |\nScene { }", "t"));
    let own = labels("m = Macro (t) { x = | }");
    assert_eq!(own.iter().filter(|it| *it == "t").count(), 1);
    for text in ["Scene { x <tr|\n}", "Scene { x <|\n}", "Scene { x <tr|>\n}"] {
        assert!(has(text, "translate"), "{text}");
    }
    assert!(has("x = 1\nScene { if (1 < |) { } }", "x"), "a comparison");
    assert!(!has("x = 1\nScene { x <|> }", "x"));
    let described = read("").describe_completion(0, "t").expect("a description");
    assert!(described.plain().contains("The frame"));
}

#[test]
fn a_name_with_a_capital_letter_is_refused_with_the_rule_of_variables() {
    let text = "count = 1\nScene { }";
    let refused = read(text).rename(0, "Zahl").expect_err("a capital letter");
    assert_eq!(
        refused.to_string(),
        "`Zahl` is not a name: a variable starts with a letter a-z and has only letters a-z, A-Z and digits"
    );
}

#[test]
fn a_script_is_converted_if_it_has_no_error_at_that_t() {
    let text = "Scene { Sphere { center -> vec3(0, 0, 3) radius -> 2 - t } }";
    let analysis = read(text);
    assert!(analysis.convert(&[1.0], "a.gtr").is_ok());
    assert!(analysis.convert(&[2.0], "a.gtr").is_err());
    let text = "Scene { Sphere { center -> vec3(0, 0, 3) radius -> t } }";
    let analysis = read(text);
    assert!(analysis.convert(&[0.0], "a.gtr").is_err());
    assert!(analysis.convert(&[1.0], "a.gtr").is_ok());
}
