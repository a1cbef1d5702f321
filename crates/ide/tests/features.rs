//! What an editor shows, at a cursor that the texts mark with `|`.

use ide::fix;
use ide::geotrace::completion::completions;
use ide::geotrace::semantic::semantic_tokens;
use ide::geotrace::{GeotraceAnalysis, colour, hints, hover, lens, navigation, outline, signature};
use ide::semantic::{Modifiers, TokenType};
use syntax::span::Span;

/// The text without its mark, and where the mark stood.
fn marked(text: &str) -> (GeotraceAnalysis, u32) {
    let at = text.find('|').expect("a mark");
    let text = format!("{}{}", &text[..at], &text[at + 1..]);
    (GeotraceAnalysis::new(text), at as u32)
}

fn whole(analysis: &GeotraceAnalysis) -> Span {
    Span::new(0, analysis.text().len() as u32)
}

fn labels(text: &str) -> (String, Vec<String>) {
    let (analysis, offset) = marked(text);
    let found = completions(&analysis, offset, true);
    assert!(found.is_complete, "of a short text everything is listed");
    let labels = found.list.into_iter().map(|c| c.label).collect();
    (found.range.text(analysis.text()).to_owned(), labels)
}

#[test]
fn colours_tell_what_a_name_is_and_where_it_is_introduced() {
    let analysis = GeotraceAnalysis::new(
        "param r : [1,2]; grid k : [0,1,3];\nsurface s(u,v) = (rcosu, k, v^2), u : [0,1], v : [0,1]; # ∂",
    );
    let shown: Vec<String> = semantic_tokens(&analysis, whole(&analysis))
        .into_iter()
        .filter(|t| !matches!(t.token_type, TokenType::Operator | TokenType::Number))
        .map(|t| {
            let names = Modifiers::NAMES.iter().enumerate();
            let modifiers: Vec<&str> = names
                .filter(|(bit, _)| t.modifiers.0 & 1 << bit != 0)
                .map(|(_, name)| *name)
                .collect();
            format!(
                "{}:{}:{}",
                t.span.text(analysis.text()),
                t.token_type.name(),
                modifiers.join("+")
            )
        })
        .collect();
    assert_eq!(
        shown,
        [
            "param:keyword:",
            "r:variable:declaration+param",
            "grid:keyword:",
            "k:variable:declaration+grid",
            "surface:keyword:",
            "s:function:declaration+surface",
            "u:parameter:declaration",
            "v:parameter:declaration",
            "r:variable:param",
            "cos:function:defaultLibrary",
            "u:parameter:",
            "k:variable:grid",
            "v:parameter:",
            "u:parameter:",
            "v:parameter:",
            "# ∂:comment:",
        ]
    );
}

#[test]
fn a_range_gives_the_tokens_that_touch_it_and_no_more() {
    let analysis = GeotraceAnalysis::new("define a = 1;\ndefine b = 2;\ndefine c = a + b;");
    let second = Span::new(14, 27);
    let spans: Vec<&str> = semantic_tokens(&analysis, second)
        .iter()
        .map(|t| t.span.text(analysis.text()))
        .collect();
    assert_eq!(spans, ["define", "b", "2"]);
}

#[test]
fn completions_are_those_that_match_what_is_written() {
    let (range, found) =
        labels("param coil : [0, 1]; function tor(t, x) = t; define a = tor(1, co|");
    assert_eq!(range, "co");
    assert_eq!(found[..3], ["cos", "cosh", "coil"]);
    assert!(found.contains(&"acos".to_owned()), "{found:?}");
    assert!(!found.contains(&"abs".to_owned()), "{found:?}");
    let (_, found) = labels("sf|");
    assert_eq!(found, ["surface"]);
}

#[test]
fn hover_at_an_application_tells_its_value_and_the_curvature_there() {
    let sphere = "surface s(u, v) = 2(cos u cos v, sin u cos v, sin v), u : [0, 1], v : [0, 1];";
    let shown = |text: &str| -> Vec<String> {
        let (analysis, offset) = marked(&format!("{sphere} {text}"));
        let (_, description) = hover::hover(&analysis, offset).expect("a name");
        description.text
    };
    let text = shown("param a : [0, 1]; point p = s|(a, 0);");
    assert_eq!(text[0], "`s(a, 0)` = (2, 0, 0), for `a = 0`");
    assert_eq!(
        text[1],
        "there K = 0.25, E = 4, F = 0, G = 4, from exact derivatives"
    );
    let text =
        shown("param b : [1, 2], [0, 3]; param a = 0.5 : [0, 1]; point p = s|(a, b_2 - b_2);");
    assert!(
        text[0].ends_with(", for `b = (1, 0)`, `a = 0.5`"),
        "{text:?}"
    );
    let text = shown("param a = 0.5 : [0, 1]; define c| = 4 a;");
    assert_eq!(text[0], "= 2, for `a = 0.5`");
    let stretched = "surface w|(u, v) = (a u, k v, 0), u : [0, 1], v : [0, 1];";
    let text = shown(&format!(
        "param a = 3 : [1, 4]; param unread : [0, 1]; grid k : [2, 4, 3]; {stretched}"
    ));
    assert!(text[1].contains("E = 9, F = 0, G = 4"), "{text:?}");
    assert!(text[1].ends_with(", for `a = 3`, `k = 2`"), "{text:?}");
    let many = "param a : [0, 1]; param b : [0, 1]; param c : [0, 1]; param d : [0, 1]; param f : [0, 1]; param g : [0, 1];";
    let text = shown(&format!("{many} define sum| = a + b + c + d + f + g;"));
    assert!(
        text[0].ends_with("`d = 0` and 2 more at their start"),
        "{text:?}"
    );
    let text = shown("vector w = s|_u(0, 0) @ s(0, 0);");
    assert_eq!(text[0], "`s_u(0, 0)` = (0, 2, 0)");
    assert!(!text[1].contains("there"), "{text:?}");
    // An argument that is a parameter has no value.
    let text = shown("curve c(t) = s|(t, 0), t : [0, 1];");
    assert!(text[0].starts_with("over"), "{text:?}");
    let text = shown("geodesic g(t) : s = (1, 0) @ (0, 0), t : [0, 1]; point p = s(g|(1));");
    assert_eq!(text[0], "`g(1)` = (0.5, 0)");
}

#[test]
fn hover_tells_values_signatures_and_geometry() {
    let tell = |text: &str| {
        let (analysis, offset) = marked(text);
        hover::hover(&analysis, offset).map(|(_, d)| d.markdown())
    };
    let told = tell("define tau = 2pi;\ndefine x = ta|u/2;").expect("a hover");
    assert!(
        told.contains("define tau") && told.contains("= 6.2832"),
        "{told}"
    );
    let told = tell("define x = s|in 2;").expect("a hover");
    assert!(
        told.contains("sin x") && told.contains("derivative: `x' cos x"),
        "{told}"
    );
    for (name, derivative) in [
        ("sqrt", "x'/(2 sqrt x)"),
        ("tan", "x'/cos^2 x"),
        ("tanh", "x'/cosh^2 x"),
        ("exp", "x' exp x"),
    ] {
        let told = tell(&format!("define x = |{name} 2;")).expect("a hover");
        assert!(
            told.contains(&format!("derivative: `{derivative}`")),
            "{told}"
        );
    }
    let torus = "surface s|(u,v) = ((2+cosv)cosu, (2+cosv)sinu, sinv), u : [0,2pi], v : [0,2pi];";
    let told = tell(torus).expect("a hover");
    // At v = pi: E = (2−1)², F = 0, G = 1, K = cos v/(2+cos v) = −1.
    for part in [
        "E = 1, F = 0, G = 1",
        "K = -1",
        "u = 0 and u = 6.2832 are glued; v = 0 and v = 6.2832 are glued",
        "regular",
    ] {
        assert!(told.contains(part), "{part} in {told}");
    }
    let sphere = "surface s|(u,v) = (sinv cosu, sinv sinu, cosv), u : [0,2pi], v : [0,pi];";
    let told = tell(sphere).expect("a hover");
    assert!(
        told.contains("EG − F² vanishes at v = 0, v = 3.1416"),
        "{told}"
    );
    assert!(told.contains("smooth pole"), "{told}");
    let cone = "surface c|(u,v) = (v cosu, v sinu, v), u : [0,2pi], v : [0,2];";
    let told = tell(cone).expect("a hover");
    assert!(told.contains("v = 0 is the tip of a cone"), "{told}");
    let strip = "surface m|(u,v) = ((2+v cos(u/2))cosu, (2+v cos(u/2))sinu, v sin(u/2)), u : [0,2pi], v : [-1,1];";
    let told = tell(strip).expect("a hover");
    assert!(
        told.contains("u = 0 and u = 6.2832 are glued with a reversal"),
        "{told}"
    );
    // The curvature of a large sphere is no rounding, as it would be beside E.
    let large = "surface s|(u,v) = 2000(cosu cosv, sinu cosv, sinv), u : [0,1], v : [0,1];";
    let told = tell(large).expect("a hover");
    assert!(told.contains("Gaussian curvature K = 2.5000e-7"), "{told}");
    // A metric has a form and a curvature, too; a crease in the middle has neither.
    let half_plane = "metric h|(x,y) = (1, 0, 1)/y^2, x : [-1,1], y : [1,3];";
    let told = tell(half_plane).expect("a hover");
    assert!(
        told.contains("E = 0.25, F = 0, G = 0.25; Gaussian curvature K = -1"),
        "{told}"
    );
    let roof = "surface r|(u,v) = (u, v, abs u), u : [-1,1], v : [-1,1];";
    let told = tell(roof).expect("a hover");
    assert!(
        told.contains("at u = 0.1, v = 0.2: E = 2, F = 0, G = 1"),
        "{told}"
    );
    let told = tell("surface l|(u,v) = (u, u, u), u : [0,1], v : [0,1];").expect("a hover");
    assert!(told.contains("EG − F² vanishes everywhere"), "{told}");
    let told = tell("function f(x) = |x;").expect("a hover");
    assert!(
        told.contains("a parameter of the function `f(x)`"),
        "{told}"
    );
    let told = tell("# The radius.\nparam r : [1,2];\ndefine d = 2|r;").expect("a hover");
    assert!(
        told.contains("The radius.") && told.contains("`[1,2]`"),
        "{told}"
    );
    assert_eq!(tell("define x = 1 |+ 2;"), None);
    assert_eq!(tell("define x = no|thing;"), None);
}

#[test]
fn completion_offers_what_fits_at_the_place() {
    let (range, list) = labels("define a = 1;\nsu|");
    assert_eq!(range, "su");
    assert!(list.contains(&"surface".to_owned()) && !list.contains(&"sin".to_owned()));

    let (range, list) = labels("define radius = 1;\nfunction f(x) = 2ra|");
    assert_eq!(range, "ra");
    assert_eq!(list, ["radius"]);
    let (_, list) = labels("define radius = 1;\nfunction f(x) = 2 |");
    for name in ["radius", "x", "sin", "pi"] {
        assert!(list.contains(&name.to_owned()), "{name} in {list:?}");
    }
    assert!(
        !list.contains(&"f".to_owned()),
        "a function does not see itself"
    );

    let (_, list) = labels("define a = |;\ndefine later = 1;");
    assert!(
        !list.contains(&"later".to_owned()),
        "what stands below is not defined yet"
    );

    let (_, list) = labels("function f(a,b) = a b;\ndefine x = f_|(1,2);");
    assert_eq!(list, ["a", "b"]);

    let (_, list) = labels("surface s(u,v) = (u,v,0), u : [0,1], |");
    assert_eq!(list[..2], ["v", "color"]);
    let (_, list) = labels("surface s(u,v) = (u,v,0), |v : [0,1]");
    assert_eq!(list[..3], ["u", "v", "color"]);

    let above = "param rad : [0, 1]; grid kk : [0, 1, 3]; define rest = 2; define rr = rad;";
    for text in [
        "curve c(t) = (t, t, t), t : [0, r|]",
        "param p : [0, r|]",
        "grid p : [0, 1, 3], [r|",
    ] {
        let (_, list) = labels(&format!("{above} {text}"));
        assert!(list.contains(&"rest".to_owned()), "{list:?}");
        for name in ["rad", "kk", "rr"] {
            assert!(!list.contains(&name.to_owned()), "{name} in {list:?}");
        }
    }
    let (_, list) = labels("# a comm|ent");
    assert!(list.is_empty());
    let (_, list) = labels("define |");
    assert!(list.is_empty(), "a new name is the writer's");

    let text = "define a = 1; surface s(u,v) = (u,v,0), u : [0,1], v : [0,1]; geodesic g(t) : |";
    assert_eq!(labels(text).1, ["s"]);
    // The start and the direction of a geodesic do not depend on its parameter; its attributes do.
    for (rest, is_offered) in [
        ("(1, |", false),
        ("(1, 0) @ (|", false),
        ("(1, 0) @ (0, 0), t : [0,1], color : (1, |", true),
    ] {
        let (_, list) = labels(&text.replace('|', &format!("s = {rest}")));
        assert_eq!(list.contains(&"t".to_owned()), is_offered, "{rest}");
    }

    let (_, list) = labels(&format!("{above} param b = |"));
    for (name, is_offered) in [("rest", true), ("rad", false), ("kk", false), ("rr", false)] {
        assert_eq!(list.contains(&name.to_owned()), is_offered, "{name}");
    }
    // A component of a vector is no derivative.
    let derivatives = "function f(a,b) = a b;\nfunction g(v) = f";
    assert_eq!(labels(&format!("{derivatives}_a_|")).1, ["a", "b"]);
    assert!(labels(&format!("{derivatives} v_|")).1.is_empty());

    let background = "background".to_owned();
    assert!(labels("define a = 1;\nba|").1.contains(&background));
    assert!(labels("background|").1.contains(&background));
    assert!(!labels("background b = 1;\nba|").1.contains(&background));
}

#[test]
fn completed_words_are_split_where_the_word_already_is() {
    // `2piv` with `v` and `vel` at hand: `pi` is done with, `ve` is being written.
    let (range, list) = labels("define vel = 1;\nfunction f(v) = 2pive|");
    assert!(list.contains(&"vel".to_owned()));
    assert_eq!(range, "ve");
}

#[test]
fn completion_in_a_long_text_lists_the_names_that_go_on_from_what_is_written() {
    let mut text = String::new();
    for k in 0..3_000 {
        text.push_str(&format!("define a{k} = {k};\ndefine b{k} = a{k} + 1;\n"));
    }
    let middle = text.find("define b1499").expect("a declaration");
    let ask = |written: &str| {
        let mut text = text.clone();
        text.insert_str(middle, &format!("define new = 2{written};\n"));
        let analysis = GeotraceAnalysis::new(&text);
        let offset = (middle + "define new = 2".len() + written.len()) as u32;
        let found = completions(&analysis, offset, true);
        assert_eq!(found.range.text(&text), written);
        assert!(!found.is_complete);
        let labels = found.list.into_iter().map(|c| c.label);
        labels.collect::<Vec<_>>()
    };
    let builtins = scene::geotrace::builtin_count() as usize;
    // Nothing is written: what has just been declared is near.
    let near = ask("");
    assert_eq!(near.len(), builtins + 256);
    assert_eq!(near.last().map(String::as_str), Some("a1499"));
    // Too many begin so: some of them. They all stand above.
    let some = ask("b1");
    assert_eq!(some.len(), 256);
    let number = |name: &String| name[1..].parse::<u32>().expect("a number");
    assert!(
        some.iter()
            .all(|name| name.starts_with("b1") && number(name) < 1_499)
    );
    // All of those that go on; what stands below is not known yet.
    let mut wanted: Vec<String> = (140..=149).map(|k| format!("a{k}")).collect();
    wanted.extend((1_400..1_500).map(|k| format!("a{k}")));
    wanted.push("a14".to_owned());
    wanted.sort();
    let mut found = ask("a14");
    found.sort();
    assert_eq!(found, wanted);
    assert_eq!(ask("a1499"), ["a1499"]);
}

#[test]
fn signature_help_counts_the_arguments() {
    let help = |text: &str| {
        let (analysis, offset) = marked(text);
        signature::signature(&analysis, offset)
    };
    let text = "function f(a,b) = a b; define x = f(1, sin(2), |3);";
    let signature = help(text).expect("a signature");
    assert_eq!((signature.label.as_str(), signature.active), ("f(a, b)", 2));
    assert_eq!(signature.parameters, [(2, 3), (5, 6)]);
    let signature = help("function f(a,b) = a b; define x = f_a(1, |2);").expect("a signature");
    assert_eq!((signature.label.as_str(), signature.active), ("f(a, b)", 1));
    let signature = help("define x = sin(|2);").expect("a signature");
    assert_eq!(
        (signature.label.as_str(), signature.what.as_str()),
        ("sin(x)", "builtin function")
    );
    let two = "function f(a,b) = a b; function g(t) =";
    for (text, label, active) in [
        ("f^2(1, |2);", "f(a, b)", 1),
        ("f_a^-1(1, |2);", "f(a, b)", 1),
        ("sin^t(|2);", "sin(x)", 0),
    ] {
        let signature = help(&format!("{two} {text}")).expect("a signature");
        assert_eq!(
            (signature.label.as_str(), signature.active),
            (label, active)
        );
    }
    // A variable before a bracket is a factor.
    for text in [
        "sin t (t + |1);",
        "f_a t(t, |1);",
        "2 sin t^2 (|1);",
        "t^2 (|1);",
    ] {
        assert_eq!(help(&format!("{two} {text}")), None, "{text}");
    }
    assert_eq!(help("define x = (1, |2);"), None);
    assert_eq!(help("define x = sin( # of wh|at\n2);"), None);
}

#[test]
fn definitions_and_occurrences_follow_names_and_parameters() {
    let (analysis, offset) =
        marked("define ab = 1;\nfunction f(x) = x ab + a|bx;\ndefine c = f_x 1;");
    let (used, place) = navigation::definition(&analysis, offset).expect("a definition");
    assert_eq!((used.text(analysis.text()), place), ("ab", Span::new(7, 9)));
    let spans: Vec<u32> = navigation::occurrences(&analysis, offset)
        .iter()
        .map(|o| o.span.start)
        .collect();
    assert_eq!(spans, [7, 33, 38]);
    let (analysis, offset) =
        marked("define ab = 1;\nfunction f(|x) = x ab + abx;\ndefine c = f_x 1;");
    let occurrences = navigation::occurrences(&analysis, offset);
    let shown: Vec<(u32, bool)> = occurrences
        .iter()
        .map(|o| (o.span.start, o.introduces))
        .collect();
    assert_eq!(shown, [(26, true), (31, false), (40, false), (56, false)]);
}

#[test]
fn the_outline_the_folds_and_the_selection_follow_the_declarations() {
    let text = "# One\n# two\nsurface s(u,v) = (u,\n  v, 0), u : [0,1], v : [0,1];\ndefine a = 2(1 + 3);\n";
    let analysis = GeotraceAnalysis::new(text);
    let names: Vec<String> = outline::outline(&analysis)
        .into_iter()
        .map(|e| format!("{} {}{}", e.keyword, e.name, e.detail))
        .collect();
    assert_eq!(names, ["surface s(u, v)", "define a"]);
    let folds: Vec<(&str, bool)> = outline::folds(&analysis)
        .iter()
        .map(|f| {
            (
                f.span.text(text).split_whitespace().next().unwrap_or(""),
                f.comment,
            )
        })
        .collect();
    assert_eq!(folds, [("#", true), ("surface", false)]);
    let at = text.find("3)").expect("the three") as u32;
    let chain: Vec<&str> = outline::selection(&analysis, at)
        .iter()
        .map(|s| s.text(text))
        .collect();
    assert_eq!(
        chain[..5],
        ["3", "1 + 3", "(1 + 3)", "2(1 + 3)", "define a = 2(1 + 3);"]
    );
    assert_eq!(chain.len(), 6);
}

#[test]
fn hints_show_how_words_are_split_and_what_defines_are() {
    let analysis = GeotraceAnalysis::new(
        "define a = 2pi;\nfunction f(v) = piv + cosv;\nparam r : [0,1];\ndefine b = 2r;\ndefine c = 3;",
    );
    let shown: Vec<(u32, String)> = hints::hints(&analysis, whole(&analysis))
        .into_iter()
        .map(|h| (h.offset, h.label))
        .collect();
    assert_eq!(
        shown,
        [
            (14, "= 6.2832".to_owned()),
            (34, "·".to_owned()),
            (41, " ".to_owned())
        ]
    );
    // What an attribute of a solid reads is not part of its value.
    let text = "param s : [0,1];\nsolid d(x,y,z) = x, color : (s, 0, 0), x : [0, 1];\ndefine a = d(2,0,0);";
    let analysis = GeotraceAnalysis::new(text);
    let shown = hints::hints(&analysis, whole(&analysis)).into_iter();
    assert_eq!(shown.map(|it| it.label).collect::<Vec<_>>(), ["= 2"]);
}

#[test]
fn a_derivative_is_applied() {
    let text = "function f(u,v) = u v;\ndefine a = (1, 2);\ndefine d = f_ua;";
    let analysis = GeotraceAnalysis::new(text);
    let split = text.len() as u32 - 2;
    // The word in front may lie outside the range that is asked for.
    for range in [whole(&analysis), Span::new(split - 1, text.len() as u32)] {
        let hints = hints::hints(&analysis, range);
        let hint = hints
            .iter()
            .find(|hint| hint.offset == split)
            .expect("a hint");
        assert_eq!(hint.tooltip, "read as `u` applied to `a`");
    }
}

#[test]
fn a_colour_that_holds_a_comment_is_not_picked() {
    let colours = |text: &str| colour::colours(&GeotraceAnalysis::new(text)).len();
    let point = "point p = (0, 0, 0), color : ";
    assert_eq!(colours(&format!("{point}(1, 0.5, 0); # red")), 1);
    assert_eq!(colours(&format!("{point}(1, # red\n0.5, 0);")), 0);
}

#[test]
fn mistakes_come_with_the_edits_that_mend_them() {
    let mended = |text: &str, title: &str| {
        let analysis = GeotraceAnalysis::new(text);
        let fixes = fix::fixes(analysis.diagnostics(), whole(&analysis));
        let titles: Vec<&str> = fixes.iter().map(|f| f.title.as_str()).collect();
        let fix = fixes.iter().find(|f| f.title == title);
        let fix = fix.unwrap_or_else(|| panic!("{title} in {titles:?}"));
        ide::edit::apply(text, &fix.edits)
    };
    assert_eq!(
        mended("define a = coss 1;", "Change to `cos`"),
        "define a = cos 1;"
    );
    assert_eq!(
        mended("define a = 1\ndefine b = 2;", "Insert `;`"),
        "define a = 1;\ndefine b = 2;"
    );
    assert_eq!(
        mended("function f(x) = sin 2x;", "Write `sin(2x)`"),
        "function f(x) = sin(2x);"
    );
    assert_eq!(
        mended(
            "function f(x) = sinx;\ndefine sinx = 1;",
            "Insert a space above"
        ),
        "function f(x) = sin x;\ndefine sinx = 1;"
    );
}

#[test]
fn lenses_offer_the_views_of_surfaces() {
    let analysis = GeotraceAnalysis::new(
        "surface s(u,v) = (u,v,0), u : [0,1], v : [0,1];\nmetric h(u,v) = (1,0,1), u : [0,1], v : [0,1];",
    );
    let shown: Vec<String> = lens::lenses(&analysis)
        .iter()
        .map(|l| format!("{} {}", l.span.text(analysis.text()), l.title))
        .collect();
    assert_eq!(shown, ["s 3D", "s geodesic view", "h geodesic view"]);
}

#[test]
fn no_word_is_offered_where_only_a_new_name_may_stand() {
    for text in [
        "function f(|",
        "curve c(|",
        "geodesic g(|",
        "background s(|",
        "surface s(u, s|",
        "param r | : [0,1];",
    ] {
        assert_eq!(labels(text).1, [""; 0], "{text}");
    }
    let (_, list) = labels("param r : [0,1]; curve c(t) = (t,r,0), t : [0, |];");
    assert!(list.contains(&"pi".to_owned()), "{list:?}");
    assert!(!list.contains(&"t".to_owned()), "{list:?}");
}

#[test]
fn a_word_whose_rest_is_written_is_completed_alone() {
    for (text, word) in [
        ("curve c(t) = (t,t,0), t : [0,1], mir| : 0.3;", "mirror"),
        ("sur| s(u,v) = (u,v,0), u : [0,1], v : [0,1];", "surface"),
    ] {
        let (analysis, offset) = marked(text);
        let found = completions(&analysis, offset, true).list;
        let first = &found[0];
        assert_eq!((first.insert.as_str(), first.snippet), (word, false));
    }
}

#[test]
fn an_undefined_curvature_is_said_to_be_undefined() {
    let (analysis, offset) =
        marked("surface s(u,v) = (u,u^3,v^3), u : [-1,1], v : [-1,1]; point p = s|(0,0);");
    let (_, description) = hover::hover(&analysis, offset).expect("a name");
    assert_eq!(
        description.text[1],
        "there K = undefined, E = 1, F = 0, G = 0, from exact derivatives"
    );
    let (analysis, offset) =
        marked("surface s(u,v) = (u,v,abs u), u : [-1,1], v : [-1,1]; point p = s|(0,0.5);");
    let (_, description) = hover::hover(&analysis, offset).expect("a name");
    assert!(
        description.text[1].contains("(0, 0.5) lies on a crease"),
        "{:?}",
        description.text
    );
}

#[test]
fn the_signature_of_an_extreme_has_any_number_of_arguments() {
    for (text, active) in [("point p = max(1,|", 1), ("point p = max(1,2,3,4,|", 2)] {
        let (analysis, offset) = marked(text);
        let found = signature::signature(&analysis, offset).expect("a signature");
        assert_eq!(
            (found.label.as_str(), found.active),
            ("max(a, b, …)", active)
        );
    }
}
