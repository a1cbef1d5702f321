//! Solids, lights, cameras, backgrounds and attributes in an editor, at a cursor that the texts mark with `¦`.

use ide::completion::CompletionKind;
use ide::edit::apply;
use ide::geotrace::completion::{completions, describe};
use ide::geotrace::{
    GeotraceAnalysis, colour, format, hover, lens, navigation, outline, rename, semantic,
};
use ide::semantic::{Modifiers, TokenType};
use syntax::span::Span;

const STAGE: &str = "\
function ball(x,y,z) = x^2 + y^2 + z^2 - 1;
solid cube(x,y,z) = max(abs x, abs y, abs z) - 1/2, mirror : 0.1, x : [-1,1];
solid die = cube \\ ball @ scale 0.6 & [cube | ball], glass : 0.9;
light lamp = @ (2,-2,4), falloff : 5;
camera eye = (0,4,-1) @ (0,-4,1), bokeh : star;
background sky(x,y,z) = (0.1,0.2,0.3);
";

/// The text without its mark, and where the mark stood.
fn marked(text: &str) -> (GeotraceAnalysis, u32) {
    let at = text.find('¦').expect("a mark");
    let text = format!("{}{}", &text[..at], &text[at + '¦'.len_utf8()..]);
    (GeotraceAnalysis::new(text), at as u32)
}

fn labels(text: &str) -> Vec<String> {
    let (analysis, offset) = marked(text);
    let list = completions(&analysis, offset, true).list;
    list.into_iter().map(|c| c.label).collect()
}

/// The markdown of the hover at the mark.
fn told(text: &str) -> String {
    let (analysis, offset) = marked(text);
    let hover = hover::hover(&analysis, offset);
    hover.map_or_else(String::new, |(_, description)| description.markdown())
}

/// The colours of the words and set operators of a text: `word:type:modifiers`.
fn colours(text: &str) -> Vec<String> {
    let analysis = GeotraceAnalysis::new(text);
    let tokens = semantic::semantic_tokens(&analysis, Span::new(0, text.len() as u32));
    let tokens = tokens.into_iter();
    let tokens = tokens.filter(|token| token.token_type != TokenType::Number);
    let shown = tokens.map(|token| {
        let names = Modifiers::NAMES.iter().enumerate();
        let modifiers: Vec<&str> = names
            .filter(|(bit, _)| token.modifiers.0 & 1 << bit != 0)
            .map(|(_, name)| *name)
            .collect();
        let word = token.span.text(text);
        format!("{word}:{}:{}", token.token_type.name(), modifiers.join("+"))
    });
    shown.collect()
}

#[test]
fn the_programs_of_these_tests_compile() {
    let compiled = scene::geotrace::compile(STAGE);
    assert!(compiled.scene.is_some(), "{:?}", compiled.diagnostics);
}

#[test]
fn words_are_coloured_by_what_they_are_where_they_stand() {
    assert_eq!(
        colours("solid s = a \\ b @ scale 2 | [c & d];"),
        [
            "solid:keyword:",
            "s:function:declaration+solid",
            "\\:operator:",
            "scale:function:defaultLibrary",
            "|:operator:",
            "&:operator:",
        ]
    );
    let text = "light l = @ (1,2,3), power : 2;\ncamera c = (0,1,0) @ (0,0,0), bokeh : star;\nbackground b = (0,0,0);";
    assert_eq!(
        colours(text),
        [
            "light:keyword:",
            "l:variable:declaration",
            "power:property:",
            "camera:keyword:",
            "c:variable:declaration",
            "bokeh:property:",
            "star:enumMember:",
            "background:keyword:",
            "b:variable:declaration",
        ]
    );
    // Names of old programs.
    let text = "param light : [0,1]; define scale = light; curve color(radius) = (radius, scale, 0), radius : [0,1];";
    assert_eq!(
        colours(text),
        [
            "param:keyword:",
            "light:variable:declaration+param",
            "define:keyword:",
            "scale:variable:declaration",
            "light:variable:param",
            "curve:keyword:",
            "color:function:declaration+curve",
            "radius:parameter:declaration",
            "radius:parameter:",
            "scale:variable:",
            "radius:parameter:",
        ]
    );
}

#[test]
fn completion_knows_declarations_attributes_words_and_atoms() {
    let list = labels("¦");
    for word in ["solid", "light", "camera", "background"] {
        assert!(list.iter().any(|label| label == word), "{word} in {list:?}");
    }
    // Parameters first, then the attributes of a solid that are not stated.
    let list = labels("solid s(x,y,z) = x, x : [0,1], mirror : 0.5, ¦");
    assert_eq!(list[..2], ["y", "z"]);
    for word in ["color", "glass", "ior", "depth", "bump", "uv", "image"] {
        assert!(list.iter().any(|label| label == word), "{word} in {list:?}");
    }
    for word in ["x", "mirror", "power", "fov", "sin", "turn"] {
        assert!(list.iter().all(|label| label != word), "{word} in {list:?}");
    }
    let list = labels("light l = @ (0,0,1), falloff : 5, ¦;");
    assert_eq!(
        list,
        [
            "color", "radius", "power", "ambient", "angle", "soft", "size"
        ]
    );
    assert_eq!(labels("camera c = (0,1,0) @ (0,0,0), ap¦"), ["aperture"]);
    assert_eq!(labels("point p = (0,0,0), ra¦;"), ["radius"]);
    assert!(labels("define a = 1, ¦").is_empty());
    // A comma within a value is none of the declaration's.
    assert!(!labels("light l = @ (0, ¦").contains(&"power".to_owned()));

    assert_eq!(
        labels("camera c = (0,1,0) @ (0,0,0), bokeh : he¦;"),
        ["hexagon"]
    );
    let words = labels("camera c = (0,1,0) @ (0,0,0), projection : ¦;");
    assert_eq!(words, ["pinhole", "spherical", "cylindrical"]);
    assert!(labels("surface s(u,v) = (u,v,0), u : [0,1], v : [0,1], image : ¦;").is_empty());
    let list = labels("define tau = 2pi; light l = @ (0,0,1), power : ta¦;");
    assert!(list.contains(&"tau".to_owned()), "{list:?}");

    // Atoms of a set are solids and functions of two or three numbers.
    let names = "define a = 1; function f(x,y) = x; function g(x) = x; solid s(x,y,z) = x;";
    for set in ["", "s | ", "s \\ ", "s & [f | ", "(", "s @ (1,0,0) | "] {
        assert_eq!(
            labels(&format!("{names} solid t = {set}¦")),
            ["f", "s"],
            "{set}"
        );
    }
    let list = labels(&format!("{names} solid t = s @ ¦"));
    for word in ["scale", "rotate", "a", "g"] {
        assert!(list.iter().any(|label| label == word), "{word} in {list:?}");
    }
    let list = labels(&format!("{names} vector v = (1,0,0) @ ¦"));
    assert!(!list.contains(&"scale".to_owned()), "{list:?}");
}

#[test]
fn completions_of_attributes_say_what_may_stand_there() {
    let (analysis, offset) = marked("solid s(x,y,z) = x, io¦");
    let found = completions(&analysis, offset, true).list;
    // What begins so comes first; `mirror` holds the letters.
    let [ior, mirror] = &found[..] else {
        panic!("{found:?}");
    };
    assert_eq!([&*ior.label, &*mirror.label], ["ior", "mirror"]);
    assert_eq!(ior.kind, CompletionKind::Attribute);
    assert!(ior.detail.contains("1.5"), "{}", ior.detail);
    assert!(ior.insert.starts_with("ior : ") && ior.snippet, "{ior:?}");
    let plain = &completions(&analysis, offset, false).list[0];
    assert_eq!((plain.insert.as_str(), plain.snippet), ("ior : ", false));
    let told = describe(&analysis, offset, "ior").expect("a description");
    assert!(told.markdown().contains("default"), "{}", told.markdown());
}

#[test]
fn the_value_of_an_attribute_has_the_parameters_of_its_declaration() {
    for (source, label, insert) in [
        ("solid s(x,y,z) = x, u¦", "uv", "uv : ${1:(x, y)}"),
        ("solid s(a,b,c) = a, u¦", "uv", "uv : ${1:(a, b)}"),
        (
            "solid s(a,b,c) = a, bu¦",
            "bump",
            "bump : ${1:0.01sin(40c)}",
        ),
        (
            "solid s(a,b,e2) = a, bu¦",
            "bump",
            "bump : ${1:0.01sin(40 e2)}",
        ),
        (
            "solid s(x,y,z) = x; solid t = s, bu¦",
            "bump",
            "bump : ${1:0.01sin(40z)}",
        ),
        (
            "surface s(u,v) = (u,v,0), u : [0,1], v : [0,1], u¦",
            "uv",
            "uv : ${1:(u, v)}",
        ),
        (
            "surface s(p,q) = (p,q,0), p : [0,1], q : [0,1], bu¦",
            "bump",
            "bump : ${1:0.01sin(40q)}",
        ),
    ] {
        let (analysis, offset) = marked(source);
        let found = completions(&analysis, offset, true).list;
        let found = found.iter().find(|it| it.label == label);
        assert_eq!(found.map(|it| &*it.insert), Some(insert), "{source}");
    }
}

#[test]
fn hover_tells_what_a_solid_is() {
    let at = |mark: &str| {
        let place = STAGE.find(mark).expect("in the program");
        format!("{}¦{}", &STAGE[..place], &STAGE[place..])
    };
    let die = told(&at("die"));
    for part in [
        "solid die",
        "within `x : [-",
        "leaves: 2 × `cube` (plane), 2 × `ball` (quadric)",
    ] {
        assert!(die.contains(part), "{part} in {die}");
    }
    let ball = told("solid b¦all(x,y,z) = x^2 + y^2 + z^2 - 1;");
    let wanted = "within `x : [-1, 1]`, `y : [-1, 1]`, `z : [-1, 1]`";
    assert!(ball.contains(wanted), "{ball}");
    let beside = told("solid b¦all(x,y,z) = (x + 1)^2 + y^2 + z^2 - 1;");
    assert!(beside.contains("within `x : [-2, 0]`"), "{beside}");
    let ground = told("param h : [0, 1]; solid g¦round(x,y,z) = z - h;");
    assert!(ground.contains("unbounded, for `h = 0`"), "{ground}");
    let empty = told("solid n¦othing(x,y,z) = x^2 + y^2 + z^2 + 1;");
    assert!(empty.contains("empty: it contains no point"), "{empty}");
    // A box for each of a million shapes is no answer while somebody reads.
    let many =
        told("grid g : [0, 1, 1000000]; solid w¦aves(x,y,z) = sin(x+g) + x^2 + y^2 + z^2 - 1;");
    assert!(many.contains("too many instances"), "{many}");
    assert!(!many.contains("within"), "{many}");
    let cube = told(&at("cube(x"));
    assert!(cube.contains("a part"), "{cube}");
    let mirror = told(&at("mirror"));
    for part in ["mirror", "default", "0…1", "= 0.1"] {
        assert!(mirror.contains(part), "{part} in {mirror}");
    }
    assert!(mirror.contains("\nmirror : 0.1\n"), "{mirror}");
    let soft = told("light l = (1,0,0) @ (2,0,0), angle : 1, so¦ft : 0.2\n  + 0.1;");
    assert!(soft.contains("\nsoft : 0.2 + 0.1\n"), "{soft}");
    assert!(soft.contains("= 0.3"), "{soft}");
    let shape = told(&at("star"));
    assert!(shape.contains("\nbokeh : star\n"), "{shape}");
    let long = told(&format!(
        "solid s(x,y,z) = x, bu¦mp : 0{};",
        " + sin x".repeat(99)
    ));
    assert!(long.contains("\nbump\n"), "{long}");
    let lamp = told(&at("lamp"));
    assert!(lamp.contains("in all directions from (2, -2, 4)"), "{lamp}");
    let eye = told(&at("eye"));
    assert!(eye.contains("from (0, -4, 1)"), "{eye}");
    let scale = told(&at("scale"));
    assert!(scale.contains("scale"), "{scale}");
    let star = told(&at("star"));
    assert!(star.contains("bokeh"), "{star}");
    let text = format!("{STAGE}define a = cube¦(1,0.1,0.2);");
    let value = told(&text);
    assert!(value.contains("`cube(1,0.1,0.2)` = 0.5"), "{value}");
    assert!(value.contains("there the gradient is (1, 0, 0)"), "{value}");
    assert!(
        value.contains("the level surface through it has K = 0"),
        "{value}"
    );
    let ball = told("solid ball(x,y,z) = x^2 + y^2 + z^2 - 1; define a = ball¦(1, 1, 1);");
    assert!(
        ball.contains("the level surface through it has K = 0.33"),
        "{ball}"
    );
}

#[test]
fn renaming_keeps_words_that_are_no_names() {
    let text = "define colors = 1; solid b¦all(x,y,z) = x^2 - colors, color : 0.5; solid s = ball @ scale ball(1,0,0);";
    let (analysis, offset) = marked(text);
    let edits = rename::rename(&analysis, offset, "color").expect("an edit");
    assert_eq!(
        apply(analysis.text(), &edits),
        "define colors = 1; solid color(x,y,z) = x^2 - colors, color : 0.5; solid s = color @ scale color(1,0,0);"
    );
    let (analysis, offset) = marked("solid s(x,y,z) = x, co¦lor : 0.5;");
    assert!(rename::prepare(&analysis, offset).is_err());
    let (analysis, offset) = marked("solid s(x¦,y,z) = x, x : [0,1], color : x;");
    let edits = rename::rename(&analysis, offset, "w").expect("an edit");
    assert_eq!(
        apply(analysis.text(), &edits),
        "solid s(w,y,z) = w, w : [0,1], color : w;"
    );
    let (analysis, offset) = marked("solid ball(x,y) = x; solid s = ba¦ll;");
    let (_, place) = navigation::definition(&analysis, offset).expect("a definition");
    assert_eq!(place, Span::new(6, 10));
}

#[test]
fn the_outline_and_the_layout_know_the_new_declarations() {
    let analysis = GeotraceAnalysis::new(STAGE);
    let names: Vec<String> = outline::outline(&analysis)
        .into_iter()
        .map(|e| format!("{} {}{}", e.keyword, e.name, e.detail))
        .collect();
    assert_eq!(
        names,
        [
            "function ball(x, y, z)",
            "solid cube(x, y, z)",
            "solid die",
            "light lamp",
            "camera eye",
            "background sky(x, y, z)",
        ]
    );
    let text =
        "solid  s=a|b\\c&d@ scale  2@(1,0,0),mirror:0.5,\ncolor :(1,0,0) ;light l=@p,power : 2;";
    let laid_out = apply(text, &format::format(&GeotraceAnalysis::new(text), None));
    assert_eq!(
        laid_out,
        "solid s = a | b \\ c & d @ scale 2 @ (1, 0, 0), mirror : 0.5,\n    color : (1, 0, 0);\nlight l = @ p, power : 2;\n"
    );
}

#[test]
fn constant_colours_are_found_and_no_others() {
    let text = "\
point p = (0,0,0), color : (1, 0.5, 0), radius : 0.1;
solid a(x,y,z) = x, color : 0.5;
solid b(x,y,z) = x, color : (x, 0, 0), mirror : (1, 0, 0);
solid c(x,y,z) = x, color : 2(0.1, 0.1, 0.1);
light l = @ (0,0,1), color : (2, 1, 1);
background d = (0, 0, 1);
curve e(color) = (color, 0, 0), color : [0, 1];
solid f(x,y,z) = x, color : (1, 0";
    let analysis = GeotraceAnalysis::new(text);
    let found = colour::colours(&analysis);
    let found: Vec<_> = found
        .iter()
        .map(|colour| (colour.span.text(text), colour.rgb))
        .collect();
    assert_eq!(
        found,
        [
            ("(1, 0.5, 0)", [1.0, 0.5, 0.0]),
            ("0.5", [0.5; 3]),
            ("(0, 0, 1)", [0.0, 0.0, 1.0]),
        ]
    );
}

#[test]
fn lenses_offer_the_traced_view_of_what_is_drawn_and_from_each_camera() {
    let analysis = GeotraceAnalysis::new(STAGE);
    let shown: Vec<String> = lens::lenses(&analysis)
        .iter()
        .map(|lens| {
            let of = lens.object.as_deref().unwrap_or("all");
            format!("{} {} of {of}", lens.span.text(STAGE), lens.view)
        })
        .collect();
    assert_eq!(
        shown,
        [
            "die 3d of all",
            "die geodesic of die",
            "die traced of all",
            "eye traced of eye"
        ]
    );
}

#[test]
fn a_stated_colour_is_written_anew() {
    let text =
        "solid a(x,y,z) = x, color : 0.5, mirror : 0.5; point b = (0,0,0), color : (1, 0, 0);";
    let analysis = GeotraceAnalysis::new(text);
    let written = |object: &str| {
        let edit = ide::geotrace::colour::edit_colour(&analysis, object, [0.0, 0.25, 1.0]);
        edit.map(|edit| ide::edit::apply(text, &[edit]))
    };
    assert_eq!(
        written("a"),
        Ok(text.replace("color : 0.5", "color : (0, 0.25, 1)"))
    );
    assert_eq!(written("b"), Ok(text.replace("(1, 0, 0)", "(0, 0.25, 1)")));
    let refused = written("c").expect_err("there is none").to_string();
    assert_eq!(
        refused,
        "the declaration of `c` states no colour as numbers"
    );
}
